"""Audit of a printed table: every cell's exact value, the difference, and what is to be made of it.

agrees        within the given number of units in the last printed digit
rounded key   off, but just what follows from another column of the row: the printed argument was rounded too hard
misprint      off, and not explained by the row's own argument

A row may be read by several of its columns (its keys). The one that explains the most cells is the row's argument; the
first key counts as it is printed, the others within the rounding of their last digit.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd
import xarray as xr

from cablesim.config.design_file import ROUNDINGS, last_digit
from cablesim.config.scene import Published, Scene
from cablesim.database.reading import evaluate
from cablesim.errors import InputError
from cablesim.numerics import Array

AGREES, ROUNDED_KEY, MISPRINT = "agrees", "rounded key", "misprint"
# Printed numbers are decimal, ours binary: a difference of exactly half a unit must not be decided by that.
SLACK = 1e-9


@dataclass(frozen=True)
class Reading:
    """The table's cells as they follow from one key: exact values at the printed key, and their range over its rounding."""

    key: str
    exact: dict[str, Array]
    low: dict[str, Array]
    high: dict[str, Array]


def audit_table(scene: Scene, dataset: xr.Dataset) -> pd.DataFrame:
    """One row for each cell of the published table. Raises InputError if the table cannot be matched to the scene."""
    published = scene.published
    if published is None:
        return pd.DataFrame()
    readings = _readings(published, dataset) if "key" in dataset.variables else [_plain_reading(published, dataset)]
    table = published.table
    printed = {name: table.numbers(name) for name in published.columns}
    unit = {name: last_digit(table.columns[name]) for name in published.columns}
    room = {name: np.maximum(unit[name] * published.within, published.printed_to.get(name, 0.0)) for name in printed}
    explained = [_explained(reading, printed, room) for reading in readings]
    best = _best_reading(readings, explained, printed, unit, published.within)
    rows = []
    for row in range(table.rows):
        chosen = readings[best[row]]
        for name in published.columns:
            if not np.isfinite(printed[name][row]):
                continue
            off = (printed[name][row] - readings[0].exact[name][row]) / unit[name][row]
            flag = _flag(name, row, off, published.within, readings, explained, best)
            rows.append(
                {
                    "row": row + 1,
                    **{key: table.columns[key][row] for key in (_row_name(published, dataset),)},
                    "column": name,
                    "printed": table.columns[name][row],
                    "exact": readings[0].exact[name][row],
                    "difference": printed[name][row] - readings[0].exact[name][row],
                    "units_off": off,
                    "flag": flag,
                    "row_argument": chosen.key,
                    "exact_at_argument": chosen.exact[name][row],
                }
            )
    return pd.DataFrame(rows)


def _flag(name, row, off, within, readings, explained, best) -> str:
    if name != readings[0].key and abs(off) <= within + SLACK:
        return AGREES
    if name == readings[0].key:
        return AGREES if best[row] == 0 or explained[best[row]][name][row] else ROUNDED_KEY
    return (
        ROUNDED_KEY
        if best[row] != 0 and (explained[best[row]][name][row] or name == readings[best[row]].key)
        else MISPRINT
    )


def _best_reading(readings, explained, printed, unit, within) -> Array:
    """The key of each row: as printed, unless another key explains more of the row's cells."""
    scores = []
    for number, reading in enumerate(readings):
        cells = [
            explained[number][name]
            if number
            else np.abs(printed[name] - reading.exact[name]) <= (within + SLACK) * unit[name]
            for name in printed
        ]
        scores.append(np.sum(cells, axis=0))
    return np.argmax(scores, axis=0)


def _explained(reading: Reading, printed: dict[str, Array], room: dict[str, Array]) -> dict[str, np.ndarray]:
    """Which cells follow from the key, within the rounding of the key and of the cell."""
    return {
        name: (values >= reading.low[name] - room[name] * (1 + SLACK))
        & (values <= reading.high[name] + room[name] * (1 + SLACK))
        for name, values in printed.items()
    }


def _readings(published: Published, dataset: xr.Dataset) -> list[Reading]:
    keys = list(dict.fromkeys(str(key) for key in dataset.key.values))
    cells = {name: evaluate(dataset, formula, published.table) for name, formula in published.columns.items()}
    return [_reading(key, cells, dataset) for key in keys]


def _reading(key: str, cells: dict[str, xr.DataArray], dataset: xr.Dataset) -> Reading:
    parts = {rounding: _part(cells, dataset, key, rounding) for rounding in ROUNDINGS}
    names = list(cells)
    stacked = {name: np.stack([parts[rounding][name] for rounding in ROUNDINGS]) for name in names}
    low = {name: stacked[name].min(axis=0) for name in names}
    high = {name: stacked[name].max(axis=0) for name in names}
    return Reading(key, parts["printed"], low, high)


def _part(cells: dict[str, xr.DataArray], dataset: xr.Dataset, key: str, rounding: str) -> dict[str, Array]:
    chosen = np.flatnonzero((dataset.key.values == key) & (dataset.rounding.values == rounding))
    order = chosen[np.argsort(dataset.row.values[chosen])]
    return {name: _over_scenarios(value).values[order] for name, value in cells.items()}


def _plain_reading(published: Published, dataset: xr.Dataset) -> Reading:
    """Rows matched by the printed values of the scene's own axes, or row by row."""
    where = _rows_in(published, dataset)
    cells = {name: evaluate(dataset, formula, published.table) for name, formula in published.columns.items()}
    exact = {name: _over_scenarios(value).values[where] for name, value in cells.items()}
    return Reading(_row_name(published, dataset), exact, exact, exact)


def _rows_in(published: Published, dataset: xr.Dataset) -> np.ndarray:
    if "row" in dataset.variables:
        return np.argsort(dataset.row.values)
    axis = _row_name(published, dataset)
    printed, values = published.table.numbers(axis), dataset[axis].values
    where = np.abs(values[:, None] - printed).argmin(axis=0)
    for row in np.flatnonzero(values[where] != printed):
        raise InputError(
            f"{published.table.path}: row {row + 1}: {axis} = {printed[row]:g} is not on the axis of the scene"
        )
    return where


def _row_name(published: Published, dataset: xr.Dataset) -> str:
    """The column that names a row: the first one."""
    return next(iter(published.table.columns))


def _over_scenarios(value: xr.DataArray) -> xr.DataArray:
    return value.isel(method=0, drop=True) if "method" in value.dims else value
