"""Ask scenes for scenarios: a condition, the nearest ones, an order, columns. The answer comes in pieces, as tables.

Only netCDF has room for profiles and histories; `ask_long` reads them for the scenarios that were found.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np
import pandas as pd
import xarray as xr

from cablesim.database.pieces import (
    PLACE,
    SCENE,
    Asked,
    Order,
    Request,
    in_order,
    is_long,
    known_columns,
    pieces,
    prepare,
)
from cablesim.database.reading import with_components
from cablesim.database.scan import Selection, blocks, read
from cablesim.errors import InputError

__all__ = ["NO_FILES", "Answer", "Order", "Request", "ask", "ask_long", "query"]

R = TypeVar("R")

# Of an answer that must be in memory as a whole.
MOST_BYTES = 2**28
NO_FILES: Mapping[str, Path] = MappingProxyType({})


@dataclass(frozen=True)
class Answer:
    """The pieces of a table, none of them kept; its columns and their units, and what a miss should tell.

    `finished` makes the same pieces once more, each given to a function where it is made; None where that is here.
    """

    pieces: Iterator[pd.DataFrame]
    columns: tuple[str, ...]
    units: dict[str, str]
    scenarios: int
    notes: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    finished: Callable[[Callable[[pd.DataFrame], Any]], Iterator[Any]] | None = None

    def each(self, function: Callable[[pd.DataFrame], R]) -> Iterator[R]:
        """A function of each piece; on a Dask cluster its workers do that, too, if the rows are in no order."""
        return map(function, self.pieces) if self.finished is None else self.finished(function)

    def table(self) -> pd.DataFrame:
        """All of it in memory. Raises InputError where it is too long for that."""
        return _joined(self.pieces)


def query(dataset: xr.Dataset, condition: str | None, columns: tuple[str, ...] = ()) -> pd.DataFrame:
    """The scenarios of one dataset for which a condition holds: a row for each method and scenario, in its order.

    Raises InputError for an unknown name, a wrong unit or a condition that cannot be read.
    """
    return ask({"": dataset}, Request(condition, columns)).table()


def ask(
    datasets: Mapping[str, xr.Dataset],
    request: Request,
    skipping: bool = False,
    files: Mapping[str, Path] = NO_FILES,
) -> Answer:
    """Ask one scene or several; of several, the first column tells the scene, and only common columns are shown.

    `skipping` leaves out scenes that do not know what is asked for. `files` are those that hold the very datasets: on a
    Dask cluster, if this process is connected to one, they are opened once more. Raises InputError for what no scene
    knows.
    """
    if request.limit is not None and request.limit < 1:
        raise InputError(f"a limit is a whole number of at least 1, not {request.limit}")
    asked, left_out, problem = [], [], None
    for name, dataset in datasets.items():
        try:
            asked.append(prepare(name, dataset, request, files.get(name)))
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
    columns = ((SCENE,) if many else ()) + asked[0].columns
    whole = bool(request.order) or request.limit is not None

    def finished(function: Callable[[pd.DataFrame], R]) -> Iterator[R]:
        return (made for one in asked for made in pieces(one, many, partial(_finish, columns, function)))

    found = (piece for one in asked for piece in pieces(one, many, _as_found))
    return Answer(
        (_shown(columns, piece) for piece in _ordered(found, request)),
        columns,
        _units(asked[0]),
        sum(one.dataset.status.size for one in asked),
        tuple(dict.fromkeys(note for one in asked for note in one.selection.notes)),
        tuple(left_out),
        None if whole else finished,
    )


def ask_long(dataset: xr.Dataset, request: Request, file: Path | None = None) -> tuple[Answer, dict[str, xr.Variable]]:
    """The answer of one scene, and over `scenario` its profiles and histories: those asked for, or all."""
    dataset = with_components(dataset)
    known = [str(name) for name in dataset.data_vars if is_long(dataset[str(name)])]
    wanted = tuple(name for name in request.columns or known if name in known)
    short = tuple(name for name in request.columns if name not in known)
    one = prepare("", dataset, replace(request, columns=short or ("status",) if request.columns else ()), file)
    found = _joined(_ordered(pieces(one, False, _as_found), request))
    columns = one.columns if short or not request.columns else ()
    answer = Answer(iter([found[list(columns)]]), columns, _units(one), dataset.status.size, one.selection.notes)
    places = found[PLACE].to_numpy(dtype=np.int64)
    return answer, {name: _long_values(dataset, name, places) for name in wanted}


def _units(asked: Asked) -> dict[str, str]:
    """The units of the columns that have one."""
    return {n: asked.dataset[n].attrs["units"] for n in asked.columns if "units" in asked.dataset[n].attrs}


def _common(asked: list[Asked]) -> tuple[str, ...]:
    """The columns that all scenes have; of parameters those that vary in any of them, or from one to the other."""
    shared = [
        name for name in known_columns(asked[0].dataset) if all(name in known_columns(one.dataset) for one in asked)
    ]
    fixed = {name for name in shared if not any(one.dataset[name].ndim for one in asked)}
    same = {name for name in fixed if len({one.dataset[name].item() for one in asked}) == 1}
    return tuple(name for name in shared if name not in same)


def _ordered(found: Iterator[pd.DataFrame], request: Request) -> Iterator[pd.DataFrame]:
    """The rows in the order that is asked for, as many as are asked for."""
    if not request.order:
        yield from found if request.limit is None else _first(found, request.limit)
        return
    if request.limit is None:
        yield in_order(_joined(found), request)
        return
    best = next(found)
    for piece in found:
        best = in_order(pd.concat([best, piece]) if len(best) else piece, request).head(request.limit)
    yield best


def _first(pieces: Iterator[pd.DataFrame], limit: int) -> Iterator[pd.DataFrame]:
    for piece in pieces:
        yield piece.head(limit)
        limit -= len(piece)
        if limit <= 0:
            return


def _shown(columns: tuple[str, ...], piece: pd.DataFrame) -> pd.DataFrame:
    """Without what is ours alone."""
    return piece[list(columns)].reset_index(drop=True)


def _as_found(piece: pd.DataFrame) -> pd.DataFrame:
    return piece


def _finish(columns: tuple[str, ...], function: Callable[[pd.DataFrame], R], piece: pd.DataFrame) -> R:
    return function(_shown(columns, piece))


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
