"""The rows of a scene that answer a question, in pieces: a block of its scenarios each, here or on a Dask cluster."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, TypeVar
from uuid import uuid4

import numpy as np
import pandas as pd
import xarray as xr

from cablesim.database.cluster import is_connected, map_in_order
from cablesim.database.reading import flag_words, of_scenarios, open_dataset, with_components
from cablesim.database.scan import (
    Points,
    Ranges,
    Selection,
    as_values,
    block_ranges,
    check_key,
    holds,
    lookup_at,
    narrow,
    points_within,
    read,
    spread,
)
from cablesim.errors import EnvironmentFault, InputError, nearest
from cablesim.expressions import Expression
from cablesim.files import recorded_digest
from cablesim.quantities import QUANTITIES, SHORT

R = TypeVar("R")

SCENE = "scene"
# Columns of our own, which no name can be: where a row is in the dataset, and what it is ordered by.
PLACE, KEY = "place ", "key "


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
class Asked:
    """A scene and what of it is asked; `file` is that of the dataset, if it is nothing but what is in a file."""

    name: str
    dataset: xr.Dataset
    request: Request
    selection: Selection
    columns: tuple[str, ...]
    orders: tuple[tuple[Expression, bool], ...]
    file: Path | None = None

    @property
    def sizes(self) -> dict[str, int]:
        return {str(dim): size for dim, size in self.dataset.status.sizes.items()}


def prepare(name: str, dataset: xr.Dataset, request: Request, file: Path | None = None) -> Asked:
    """A request understood for a scene. Raises InputError for what the scene does not know."""
    dataset = with_components(dataset)
    columns = tuple(_columns(dataset, request.columns))
    selection = narrow(dataset, request.condition, request.near)
    orders = tuple((check_key(dataset, order.formula), order.descending) for order in request.order)
    return Asked(name, dataset, request, selection, columns, orders, file)


def known_columns(dataset: xr.Dataset) -> list[str]:
    """What has one value a scenario: parameters first, then what was answered."""
    return [str(n) for n in (*dataset.coords, *dataset.data_vars) if of_scenarios(dataset[n], dataset)]


def _columns(dataset: xr.Dataset, columns: tuple[str, ...]) -> list[str]:
    known = known_columns(dataset)
    for name in columns:
        if name in dataset.data_vars and is_long(dataset[name]):
            raise InputError(f"'{name}' has many values a scenario: only --format netcdf has room for them")
        if name not in known:
            raise InputError(f"no column '{name}': {nearest(name, known)}")
    return list(columns) or [name for name in known if name in dataset.data_vars or dataset[name].ndim > 0]


def pieces(asked: Asked, named: bool, finish: Callable[[pd.DataFrame], R]) -> Iterator[R]:
    """The rows of a scene, block by block and finished where they are found; the first piece may have none.

    With an order or a limit, a piece has no more rows than the answer will have.
    """
    nowhere = {dim: np.arange(0) for dim in asked.sizes}
    yield finish(_rows(asked, nowhere, np.ones((0,) * len(nowhere), dtype=bool), named))
    ranges = block_ranges(asked.selection, asked.sizes)
    if asked.file is not None and is_connected():
        found = map_in_order(partial(_piece_of_file, _Question.of(asked), named, finish), ranges)
    else:
        found = map(partial(_piece, asked, named, finish), ranges)
    yield from (piece for piece in found if piece is not None)


def in_order(table: pd.DataFrame, request: Request) -> pd.DataFrame:
    """The rows in the order that is asked for; as they are where none is."""
    keys = [f"{KEY}{number}" for number in range(len(request.order))]
    ascending = [not order.descending for order in request.order]
    return table.sort_values(keys, ascending=ascending, kind="stable") if keys else table


@dataclass(frozen=True)
class _Question:
    """What a worker needs to know to prepare the same: it opens the file itself, once for each question."""

    file: Path
    digest: str
    scene: str
    request: Request
    number: str = field(default_factory=lambda: uuid4().hex)

    @classmethod
    def of(cls, asked: Asked) -> "_Question":
        file = Path(str(asked.file)).absolute()
        return cls(file, recorded_digest(file), asked.name, replace(asked.request, columns=asked.columns))


def _piece_of_file(question: _Question, named: bool, finish: Callable[[pd.DataFrame], R], ranges: Ranges) -> R | None:
    return _piece(_opened(question), named, finish, ranges)


@lru_cache(maxsize=2)
def _opened(question: _Question) -> Asked:
    """The question, prepared on a worker. Raises EnvironmentFault where it does not see the file that is meant."""
    dataset = open_dataset(question.file, cache=False)
    if recorded_digest(question.file) != question.digest:
        raise EnvironmentFault(f"{question.file}: another file is here")
    return prepare(question.scene, dataset, question.request, question.file)


def _piece(asked: Asked, named: bool, finish: Callable[[pd.DataFrame], R], ranges: Ranges) -> R | None:
    """The rows of a block, finished; None where it has none."""
    points = points_within(asked.selection, asked.sizes, ranges)
    found = holds(asked.dataset, asked.selection, points)
    if not found.any():
        return None
    rows = _rows(asked, points, found, named)
    limit = asked.request.limit
    return finish(rows if limit is None else in_order(rows, asked.request).head(limit))


def _rows(asked: Asked, points: Points, found: np.ndarray, named: bool) -> pd.DataFrame:
    """A piece of the table: the columns, where the rows are in the dataset, and what they are ordered by."""
    where = dict(zip(points, np.nonzero(found), strict=True))
    rows = next(iter(where.values())).size
    columns: dict[str, Any] = {SCENE: pd.Series(np.full(rows, asked.name), dtype="str")} if named else {}
    for name in asked.columns:
        columns[name] = _picked(asked.dataset[name], points, where, rows)
    at = [points[dim][own] for dim, own in where.items()]
    columns[PLACE] = np.ravel_multi_index(at, tuple(asked.sizes.values())) if rows else np.arange(0)
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


def is_long(values: xr.DataArray) -> bool:
    """Whether a scenario has many values of it: a profile or a history."""
    return values.name in QUANTITIES and QUANTITIES[str(values.name)].dims not in SHORT
