"""Ask scenes for scenarios: a condition, the nearest ones, an order, columns. The answer comes in pieces, as tables.

Only netCDF has room for profiles and histories; `ask_long` reads them for the scenarios that were found.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from cablesim.database.reading import flag_words, of_scenarios, with_components
from cablesim.database.scan import (
    Points,
    Selection,
    as_values,
    blocks,
    check_key,
    holds,
    lookup_at,
    narrow,
    read,
    spread,
)
from cablesim.errors import InputError, nearest
from cablesim.expressions import Expression
from cablesim.quantities import QUANTITIES, SHORT

SCENE = "scene"
# Columns of our own, which no name can be: where a row is in the dataset, and what it is ordered by.
PLACE, KEY = "place ", "key "
# Of an answer that must be in memory as a whole.
MOST_BYTES = 2**28


@dataclass(frozen=True)
class Order:
    """A formula by which scenarios are ordered."""

    formula: str
    descending: bool = False

    @classmethod
    def read(cls, text: str) -> "Order":
        """A formula, perhaps with `desc` or `asc` behind it."""
        formula, _, word = text.strip().rpartition(" ")
        return cls(formula, word == "desc") if formula and word in ("asc", "desc") else cls(text)


@dataclass(frozen=True)
class Request:
    """What is asked: of the scenarios for which `condition` holds, those nearest to some values, in an order."""

    condition: str | None = None
    columns: tuple[str, ...] = ()
    near: tuple[tuple[str, str], ...] = ()
    order: tuple[Order, ...] = ()
    limit: int | None = None


@dataclass(frozen=True)
class Answer:
    """The pieces of a table, none of them kept; its columns and their units, and what a miss should tell."""

    pieces: Iterator[pd.DataFrame]
    columns: tuple[str, ...]
    units: dict[str, str]
    scenarios: int
    notes: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()

    def table(self) -> pd.DataFrame:
        """All of it in memory. Raises InputError where it is too long for that."""
        return _joined(self.pieces)


@dataclass(frozen=True)
class _Asked:
    """A scene and what of it is asked."""

    name: str
    dataset: xr.Dataset
    selection: Selection
    columns: tuple[str, ...]
    orders: tuple[tuple[Expression, bool], ...] = field(default=())


def query(dataset: xr.Dataset, condition: str | None, columns: tuple[str, ...] = ()) -> pd.DataFrame:
    """The scenarios of one dataset for which a condition holds: a row for each method and scenario, in its order.

    Raises InputError for an unknown name, a wrong unit or a condition that cannot be read.
    """
    return ask({"": dataset}, Request(condition, columns)).table()


def ask(datasets: Mapping[str, xr.Dataset], request: Request, skipping: bool = False) -> Answer:
    """Ask one scene or several; of several, the first column tells the scene, and only common columns are shown.

    `skipping` leaves out scenes that do not know what is asked for. Raises InputError for what none of them knows.
    """
    if request.limit is not None and request.limit < 1:
        raise InputError(f"a limit is a whole number of at least 1, not {request.limit}")
    asked, left_out, problem = [], [], None
    for name, dataset in datasets.items():
        try:
            asked.append(_prepared(name, with_components(dataset), request))
        except InputError as reason:
            if not skipping:
                raise InputError(f"scene {name}: {reason}" if len(datasets) > 1 else str(reason)) from None
            left_out.append(name)
            problem = problem or reason
    if not asked:
        raise problem or InputError("no scene is asked")
    many = len(datasets) > 1
    if many and not request.columns:
        asked = [replace(one, columns=_common(asked)) for one in asked]
    pieces = (piece for one in asked for piece in _pieces(one, many))
    columns = ((SCENE,) if many else ()) + asked[0].columns
    return Answer(
        _shown(_ordered(pieces, request), columns),
        columns,
        _units(asked[0]),
        sum(one.dataset.status.size for one in asked),
        tuple(dict.fromkeys(note for one in asked for note in one.selection.notes)),
        tuple(left_out),
    )


def ask_long(dataset: xr.Dataset, request: Request) -> tuple[Answer, dict[str, xr.Variable]]:
    """The answer of one scene, and over `scenario` its profiles and histories: those asked for, or all."""
    dataset = with_components(dataset)
    known = [str(name) for name in dataset.data_vars if _is_long(dataset[str(name)])]
    wanted = tuple(name for name in request.columns or known if name in known)
    short = tuple(name for name in request.columns if name not in known)
    one = _prepared("", dataset, replace(request, columns=short or ("status",) if request.columns else ()))
    found = _joined(_ordered(_pieces(one, False), request))
    columns = one.columns if short or not request.columns else ()
    answer = Answer(iter([found[list(columns)]]), columns, _units(one), dataset.status.size, one.selection.notes)
    places = found[PLACE].to_numpy(dtype=np.int64)
    return answer, {name: _long_values(dataset, name, places) for name in wanted}


def _prepared(name: str, dataset: xr.Dataset, request: Request) -> _Asked:
    columns = tuple(_columns(dataset, request.columns))
    selection = narrow(dataset, request.condition, request.near)
    orders = tuple((check_key(dataset, order.formula), order.descending) for order in request.order)
    return _Asked(name, dataset, selection, columns, orders)


def _known(dataset: xr.Dataset) -> list[str]:
    """What has one value a scenario: parameters first, then what was answered."""
    return [str(n) for n in (*dataset.coords, *dataset.data_vars) if of_scenarios(dataset[n], dataset)]


def _common(asked: list[_Asked]) -> tuple[str, ...]:
    """The columns that all scenes have; of parameters those that vary in any of them, or from one to the other."""
    shared = [name for name in _known(asked[0].dataset) if all(name in _known(one.dataset) for one in asked)]
    fixed = {name for name in shared if not any(one.dataset[name].ndim for one in asked)}
    same = {name for name in fixed if len({one.dataset[name].item() for one in asked}) == 1}
    return tuple(name for name in shared if name not in same)


def _columns(dataset: xr.Dataset, columns: tuple[str, ...]) -> list[str]:
    known = _known(dataset)
    for name in columns:
        if name in dataset.data_vars and _is_long(dataset[name]):
            raise InputError(f"'{name}' has many values a scenario: only --format netcdf has room for them")
        if name not in known:
            raise InputError(f"no column '{name}': {nearest(name, known)}")
    return list(columns) or [name for name in known if name in dataset.data_vars or dataset[name].ndim > 0]


def _units(asked: _Asked) -> dict[str, str]:
    """The units of the columns that have one."""
    return {n: asked.dataset[n].attrs["units"] for n in asked.columns if "units" in asked.dataset[n].attrs}


def _pieces(asked: _Asked, named: bool) -> Iterator[pd.DataFrame]:
    """The rows of a scene, block by block; the first piece is there even if it has none."""
    sizes = {str(dim): size for dim, size in asked.dataset.status.sizes.items()}
    nowhere = {dim: np.arange(0) for dim in sizes}
    yield _rows(asked, nowhere, np.ones((0,) * len(sizes), dtype=bool), sizes, named)
    for points in blocks(asked.selection, sizes):
        found = holds(asked.dataset, asked.selection, points)
        if found.any():
            yield _rows(asked, points, found, sizes, named)


def _rows(asked: _Asked, points: Points, found: np.ndarray, sizes: dict[str, int], named: bool) -> pd.DataFrame:
    """A piece of the table: the columns, where the rows are in the dataset, and what they are ordered by."""
    where = dict(zip(points, np.nonzero(found), strict=True))
    rows = next(iter(where.values())).size
    columns: dict[str, Any] = {SCENE: pd.Series(np.full(rows, asked.name), dtype="str")} if named else {}
    for name in asked.columns:
        columns[name] = _picked(asked.dataset[name], points, where, rows)
    at = [points[dim][own] for dim, own in where.items()]
    columns[PLACE] = np.ravel_multi_index(at, tuple(sizes.values())) if rows else np.arange(0)
    lookup = lookup_at(asked.dataset, points)
    for number, (formula, _) in enumerate(asked.orders):
        shape = {dim: own.size for dim, own in points.items()}
        columns[f"{KEY}{number}"] = spread(as_values(formula.key(lookup)), shape)[found]
    return pd.DataFrame(columns)


def _picked(values: xr.DataArray, points: Points, where: dict[str, np.ndarray], rows: int) -> pd.Series:
    """Values of the rows; flags as words."""
    block = read(values, points)
    own = block.values[tuple(where[str(dim)] for dim in block.dims)] if block.ndim else np.full(rows, block.values)
    words = flag_words(values)
    own = np.array(words)[own] if words else own
    # Said outright, because an empty column of words would be one of anything.
    return pd.Series(own) if own.dtype.kind in "fiub" else pd.Series(own, dtype="str")


def _ordered(pieces: Iterator[pd.DataFrame], request: Request) -> Iterator[pd.DataFrame]:
    """The rows in the order that is asked for, as many as are asked for."""
    if not request.order:
        yield from pieces if request.limit is None else _first(pieces, request.limit)
        return
    keys = [f"{KEY}{number}" for number in range(len(request.order))]
    ascending = [not order.descending for order in request.order]

    def ordered(table: pd.DataFrame) -> pd.DataFrame:
        return table.sort_values(keys, ascending=ascending, kind="stable")

    if request.limit is None:
        yield ordered(_joined(pieces))
        return
    best = next(pieces)
    for piece in pieces:
        best = ordered(pd.concat([best, piece]) if len(best) else piece).head(request.limit)
    yield best


def _first(pieces: Iterator[pd.DataFrame], limit: int) -> Iterator[pd.DataFrame]:
    for piece in pieces:
        yield piece.head(limit)
        limit -= len(piece)
        if limit <= 0:
            return


def _shown(pieces: Iterator[pd.DataFrame], columns: tuple[str, ...]) -> Iterator[pd.DataFrame]:
    """Without what is ours alone."""
    return (piece[list(columns)].reset_index(drop=True) for piece in pieces)


def _joined(pieces: Iterator[pd.DataFrame]) -> pd.DataFrame:
    """All pieces as one table. Raises InputError where that takes too much memory."""
    held: list[pd.DataFrame] = []
    size = 0
    for piece in pieces:
        held.append(piece)
        size += int(piece.memory_usage().sum())
        if size > MOST_BYTES:
            raise InputError(
                f"the answer takes more than {MOST_BYTES // 2**20} MiB of memory: narrow it, choose columns or give a"
                " limit; in formats csv, json and parquet it may be of any length, as long as it is in no order"
            )
    filled = [piece for piece in held if len(piece)] or held[:1]
    return pd.concat(filled, ignore_index=True)


def _is_long(values: xr.DataArray) -> bool:
    return values.name in QUANTITIES and QUANTITIES[str(values.name)].dims not in SHORT


def _long_values(dataset: xr.Dataset, name: str, places: np.ndarray) -> xr.Variable:
    """A profile or history of the scenarios at some places of the dataset, in their order."""
    values = dataset[name]
    own = [str(dim) for dim in values.dims if dim not in dataset.status.dims]
    sizes = {str(dim): size for dim, size in dataset.status.sizes.items()}
    shape = tuple(values.sizes[dim] for dim in own)
    if places.size * int(np.prod(shape)) * values.dtype.itemsize > MOST_BYTES:
        raise InputError(f"'{name}' of {places.size} scenarios takes more than {MOST_BYTES // 2**20} MiB: give a limit")
    found = np.empty((places.size, *shape), dtype=values.dtype)
    at = dict(zip(sizes, np.unravel_index(places, tuple(sizes.values())), strict=True))
    everywhere = Selection({dim: np.unique(own_points) for dim, own_points in at.items()})
    for points in blocks(everywhere, sizes, int(np.prod(shape))) if places.size else ():
        inside = np.flatnonzero(np.all([np.isin(at[dim], points[dim]) for dim in sizes], axis=0))
        if inside.size:
            block = read(values.transpose(*sizes, *own), points).values
            found[inside] = block[tuple(np.searchsorted(points[dim], at[dim][inside]) for dim in sizes)]
    return xr.Variable(("scenario", *own), found, values.attrs)
