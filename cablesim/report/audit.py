"""Audit of a printed table: every cell's exact value, the difference, and what is to be made of it.

agrees        within the given number of units in the last printed digit
rounded key   off, but just what follows from another column of the row: the printed argument was rounded too hard
misprint      off, and not explained by the row's own argument (or what else the scene calls that)

A row may be read by several of its columns (its keys). The one that explains the most cells is the row's argument; the
first key counts as it is printed, the others within the rounding of their last digit.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd
import xarray as xr

from cablesim.config.design_file import ROUNDINGS, last_digit
from cablesim.config.scene import AGREES, ROUNDED_KEY, Published, Scene
from cablesim.database.reading import evaluate, of_only_method, rows_on_axis
from cablesim.errors import InputError
from cablesim.numerics import Array

# Printed numbers are decimal, ours binary: a difference of exactly half a unit must not be decided by that.
SLACK = 1.0 + 1e-9


@dataclass(frozen=True)
class Reading:
    """The table as it follows from one key, all of shape (row, column).

    `exact` holds the values at the printed key, `low` and `high` their range over the key's rounding.
    """

    key: str
    exact: Array
    low: Array
    high: Array

    def explains(self, printed: Array, room: Array) -> np.ndarray:
        """Which cells follow from the key, give or take the room of a cell."""
        return (printed >= self.low - room * SLACK) & (printed <= self.high + room * SLACK)


def audit_table(scene: Scene, dataset: xr.Dataset) -> pd.DataFrame:
    """One row for each printed cell. Raises InputError if the table cannot be matched to the scene."""
    published = scene.published
    if published is None:
        return pd.DataFrame()
    table, columns = published.table, list(published.columns)
    printed = np.column_stack([table.numbers(name) for name in columns])
    unit = np.column_stack([last_digit(table.columns[name]) for name in columns])
    resolution = np.array([published.printed_to.get(name, 0.0) for name in columns])
    readings = _readings(published, dataset)
    agrees = np.abs(printed - readings[0].exact) <= published.within * unit * SLACK
    room = np.maximum(published.within * unit, resolution)
    explained = np.stack([agrees, *(reading.explains(printed, room) for reading in readings[1:])])
    argument = explained.sum(axis=2).argmax(axis=0)
    follows = explained[argument, np.arange(table.rows)] & (argument > 0)[:, None]
    flags = np.where(agrees, AGREES, np.where(follows, ROUNDED_KEY, published.off))
    if readings[0].key in columns:
        # The first key agrees with itself by definition; it is rounded where the row's real argument contradicts it.
        flags[(argument > 0) & ~follows[:, columns.index(readings[0].key)], columns.index(readings[0].key)] = (
            ROUNDED_KEY
        )
    cells = [(i, j) for i in range(table.rows) for j in range(len(columns)) if np.isfinite(printed[i, j])]
    head = next(iter(table.columns))
    rows = [
        {
            "row": i + 1,
            head: table.columns[head][i],
            "column": columns[j],
            "printed": table.columns[columns[j]][i],
            "exact": _rounded(readings[0].exact[i, j], 10),
            "difference": _rounded(printed[i, j] - readings[0].exact[i, j], 4),
            "units_off": _rounded((printed[i, j] - readings[0].exact[i, j]) / unit[i, j], 4),
            "flag": flags[i, j],
            "row_argument": readings[argument[i]].key,
            "exact_at_argument": _rounded(readings[argument[i]].exact[i, j], 10),
        }
        for i, j in cells
    ]
    return pd.DataFrame(rows)


def _rounded(value: float, digits: int) -> float:
    """More digits than any printed table has, and fewer than a reader would have to skip."""
    return float(f"{value:.{digits}g}") + 0.0


def _readings(published: Published, dataset: xr.Dataset) -> list[Reading]:
    """The table read by each of its keys; by the scene's own axis where it has none."""
    values = np.column_stack([_cells(published, dataset, formula) for formula in published.columns.values()])
    if "key" not in dataset.variables:
        exact = values[_rows_in(published, dataset)]
        return [Reading(_head(published), exact, exact, exact)]
    readings = []
    for key in dict.fromkeys(dataset.key.values.tolist()):
        parts = {rounding: values[_rows_of(dataset, key, rounding)] for rounding in ROUNDINGS}
        around = np.stack(list(parts.values()))
        readings.append(Reading(key, parts["printed"], around.min(axis=0), around.max(axis=0)))
    return readings


def _cells(published: Published, dataset: xr.Dataset, formula: str) -> Array:
    """A formula for every scenario along the scene's only axis."""
    value = of_only_method(evaluate(dataset, formula, published.table))
    if value.ndim != 1:
        raise InputError(f"'{formula}' must give one value for each row of {published.table.path}")
    return value.values


def _rows_of(dataset: xr.Dataset, key: str, rounding: str) -> np.ndarray:
    """The scenarios that read the table by a key, in the order of its rows."""
    chosen = np.flatnonzero((dataset.key.values == key) & (dataset.rounding.values == rounding))
    return chosen[np.argsort(dataset.row.values[chosen])]


def _rows_in(published: Published, dataset: xr.Dataset) -> np.ndarray:
    """The scenario of each row: by the row's number, or by the printed value of the scene's axis."""
    if "row" in dataset.variables:
        return np.argsort(dataset.row.values)
    return rows_on_axis(dataset, published.table)


def _head(published: Published) -> str:
    """The column that names a row: the first one."""
    return next(iter(published.table.columns))
