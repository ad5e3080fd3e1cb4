"""What the checks of a scene say of its scenarios, as flags beside their status."""

from typing import Any

import numpy as np
import xarray as xr

from cablesim.config.check_file import Check, Limit, Monotone
from cablesim.database.reading import scene_lookup, with_components
from cablesim.expressions import EQUAL_WITHIN, Term, parse
from cablesim.status import Status, Verdict, flag_attributes


def check_flags(check: Check, dataset: xr.Dataset) -> xr.DataArray:
    """A `Verdict` as int8 for each scenario, over the dimensions of the dataset's status, with CF attributes.

    The dataset is in memory and may be a part of a scene: some methods, or a block of the design. It must hold the
    methods that the check names, and all of the axis that a value is monotone along. Raises InputError for a name that
    it does not have.
    """
    parts = with_components(dataset)
    holds, known = _limit(check, parts) if isinstance(check, Limit) else _monotone(check, parts)
    known = known & _solved(dataset)
    flags = np.where(known, np.where(holds, Verdict.passed, Verdict.failed), Verdict.unknown).astype(np.int8)
    return xr.DataArray(flags, dataset.status.coords, dataset.status.dims, check.name, check_attributes(check))


def check_attributes(check: Check) -> dict[str, Any]:
    """The CF attributes of its flags."""
    return flag_attributes(Verdict, check.words)


def _limit(limit: Limit, dataset: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    """Where the condition holds, and where all its numbers are finite."""
    scene, own = scene_lookup(dataset), limit.terms

    def lookup(name: str) -> Term | None:
        return own[name] if name in own else scene(name)

    condition = parse(limit.condition)
    return _by_scenario(condition.select(lookup), dataset), _by_scenario(condition.known(lookup), dataset)


def _monotone(check: Monotone, dataset: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    """Where the value does not go the wrong way after the last solved scenario before it, and where it is finite."""
    values = _by_scenario(parse(check.formula).evaluate(scene_lookup(dataset)), dataset)
    finite = np.isfinite(values)
    axis = dataset.status.dims.index(check.along)
    order = np.argsort(dataset[check.along].values)
    rising, solved = (np.moveaxis(a, axis, -1)[..., order] for a in (values, finite & _solved(dataset)))
    with np.errstate(invalid="ignore"):
        change = rising - _before(rising, solved)
    tolerance = EQUAL_WITHIN * np.abs(rising)
    wrong = change < -tolerance if check.sense == "increasing" else change > tolerance
    return np.moveaxis(~wrong[..., np.argsort(order)], -1, axis), finite


def _before(values: np.ndarray, solved: np.ndarray) -> np.ndarray:
    """The value of the last solved scenario before each along the last axis; NaN where there is none."""
    latest = np.maximum.accumulate(np.where(solved, np.arange(values.shape[-1]), -1), axis=-1)
    found = np.where(latest < 0, np.nan, np.take_along_axis(values, np.maximum(latest, 0), axis=-1))
    return np.concatenate([np.full_like(found[..., :1], np.nan), found[..., :-1]], axis=-1)


def _solved(dataset: xr.Dataset) -> np.ndarray:
    return dataset.status.values == Status.ok


def _by_scenario(values: Any, dataset: xr.Dataset) -> np.ndarray:
    """Values for every scenario and method, also where they are the same along some axis."""
    return xr.DataArray(values).broadcast_like(dataset.status).transpose(*dataset.status.dims).values
