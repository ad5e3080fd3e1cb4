"""Orders of methods, measured: how the error of an output falls along each series of methods of a scene."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd
import xarray as xr

from cablesim.config.method import Series, find_series, series_names
from cablesim.config.scene import Scene
from cablesim.database.reading import magnitude, of_method
from cablesim.numerics import Array
from cablesim.quantities import SHORT, quantity


@dataclass(frozen=True)
class Convergence:
    """Along a series: the option's values, the largest errors of an output, the orders between them, the run times."""

    series: Series
    errors: Array
    orders: Array
    run_times: Array

    @property
    def order(self) -> float:
        """The order of the series: the median, which neither coarse steps nor rounding errors decide."""
        known = self.orders[np.isfinite(self.orders)]
        return float(np.median(known)) if known.size else float("nan")


def order_table(scene: Scene, dataset: xr.Dataset) -> pd.DataFrame:
    """A row for each method of each series and each output; nothing where the scene has no series."""
    return pd.DataFrame(list(_rows(scene, dataset)))


def convergences(scene: Scene, dataset: xr.Dataset, output: str) -> dict[str, Convergence]:
    """How an output converges along each series, by the name of the series."""
    reference = scene.reference.method if scene.reference else None
    series = find_series(scene.methods, reference) if reference else ()
    return {
        name: _measure(one, dataset, output, str(reference))
        for name, one in zip(series_names(series), series, strict=True)
    }


def _rows(scene: Scene, dataset: xr.Dataset) -> Iterator[dict[str, object]]:
    for output in (name for name in scene.outputs if quantity(name).dims in SHORT):
        for name, found in convergences(scene, dataset, output).items():
            for i, value in enumerate(found.series.values):
                yield {
                    "series": name,
                    "option": found.series.option,
                    "value": value,
                    "output": output,
                    "largest relative error": found.errors[i],
                    "order": found.orders[i],
                    "run_time [s]": found.run_times[i],
                }


def _measure(series: Series, dataset: xr.Dataset, output: str, reference: str) -> Convergence:
    """Errors over the scenarios that every method of the series has solved, so that they are comparable."""
    exact = of_method(dataset[output], reference)
    relative = [
        (magnitude(of_method(dataset[output], m.name) - exact) / magnitude(exact)).values for m in series.methods
    ]
    common = np.isfinite(relative).all(axis=0)
    errors = np.array([found[common].max() if common.any() else np.nan for found in relative])
    run_times = np.array([float(of_method(dataset.run_time, method.name).mean()) for method in series.methods])
    return Convergence(series, errors, _orders(series, errors), run_times)


def _orders(series: Series, errors: Array) -> Array:
    """The order of each method against the one before it; none for the first."""
    with np.errstate(divide="ignore", invalid="ignore"):
        slopes = np.diff(np.log(errors)) / np.diff(np.log(series.values))
    return np.concatenate([[np.nan], -slopes if series.counts_work else slopes])
