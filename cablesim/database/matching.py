"""Which scenarios of two datasets are the same: by their parameters, to the last bit, dimension by dimension.

No table of all scenarios is made: a method is matched by its name, a point of an axis by the parameters that vary along
it. What varies in one dataset and is fixed in the other is an axis of one point there.
"""

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd
import xarray as xr

from cablesim.database.reading import of_scenarios, running_numbers
from cablesim.database.scan import Points


@dataclass(frozen=True)
class Match:
    """The points that two datasets share along each dimension, in A and in B, and how many scenarios that makes."""

    in_a: Points
    in_b: Points
    both: int
    removed: int
    added: int


class OtherDesignError(Exception):
    """Scenarios that cannot be matched, because other parameters tell them apart, or along other dimensions."""


def match(a: xr.Dataset, b: xr.Dataset) -> Match:
    """Match the scenarios of two datasets, given with components. Raises OtherDesignError where that has no meaning."""
    keys_a, keys_b = _keys(a), _keys(b)
    if keys_a != keys_b:
        raise OtherDesignError(f"other parameters: {', '.join(sorted(keys_a ^ keys_b))}")
    in_a, in_b = {}, {}
    for dim in dict.fromkeys(str(dim) for dim in (*a.status.dims, *b.status.dims)):
        names = sorted(name for name in keys_a if dim in (*a[name].dims, *b[name].dims))
        in_a[dim], in_b[dim] = _meet(_points(a, dim, names), _points(b, dim, names), names)
    fixed = [name for name in keys_a if a[name].ndim == b[name].ndim == 0]
    same = all(_is_same(a[name].item(), b[name].item()) for name in fixed)
    both = math.prod(own.size for own in in_a.values()) if same else 0
    return Match(in_a, in_b, both, a.status.size - both, b.status.size - both)


def _keys(dataset: xr.Dataset) -> set[str]:
    """What identifies a scenario: its method and parameters, not its running number."""
    return {str(n) for n, values in dataset.coords.items() if of_scenarios(values, dataset)} - running_numbers(dataset)


def _points(dataset: xr.Dataset, dim: str, names: list[str]) -> pd.DataFrame:
    """The parameters of every point along a dimension, and its place; one point where the dataset has no such one."""
    size = dataset.sizes.get(dim, 1)
    columns = {}
    for name in names:
        values = dataset[name]
        if values.dims not in ((), (dim,)):
            raise OtherDesignError(f"other design: {name} varies along {', '.join(map(str, values.dims))}, too")
        columns[name] = values.values if values.ndim else np.full(size, values.values)
    return pd.DataFrame(columns | {"place": np.arange(size)})


def _is_same(a: object, b: object) -> bool:
    """Also of two that are no numbers."""
    return a == b or (a != a and b != b)


def _meet(a: pd.DataFrame, b: pd.DataFrame, names: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """The places of the points that two tables share, in the order of the first; equal ones by their turn."""
    a, b = (table.assign(repeat=table.groupby(names, dropna=False).cumcount()) for table in (a, b))
    both = a.merge(b, on=[*names, "repeat"]).sort_values("place_x")
    return both["place_x"].to_numpy(dtype=np.int64), both["place_y"].to_numpy(dtype=np.int64)
