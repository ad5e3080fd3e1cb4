"""Go through the scenarios of a dataset block by block, and only where a condition may hold.

What a condition says of one dimension alone (`span == 20 m and method == exact`) is decided first and once; what is
left is decided block by block, from the variables that it names. So a dataset may be larger than memory.
"""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import xarray as xr

from cablesim import units
from cablesim.database.reading import name_is_unknown, of_scenarios, readable, scene_lookup
from cablesim.database.shard_file import chunk_sizes
from cablesim.errors import InputError, nearest
from cablesim.expressions import WORDS, Expression, Lookup, Term, UnknownName, parse

# Scenarios of a block, where one number each is read of them.
BLOCK = 2**19

Points = dict[str, np.ndarray]
Ranges = tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Selection:
    """Points of each dimension, and conditions that are still to be decided scenario by scenario."""

    points: Points
    conditions: tuple[Expression, ...] = ()
    notes: tuple[str, ...] = ()


def narrow(dataset: xr.Dataset, condition: str | None, near: tuple[tuple[str, str], ...] = ()) -> Selection:
    """What is left after all that is said of one dimension alone, and what a miss should tell.

    `near` are parameters and values: of each dimension the points nearest to them are kept.
    Raises InputError for unknown names, wrong units and conditions with more than one answer a scenario.
    """
    everywhere = {str(dim): np.arange(dataset.sizes[dim]) for dim in dataset.status.dims}
    selection = Selection(everywhere)
    if condition is not None:
        whole = parse(condition)
        _check(dataset, whole, Expression.select)
        for part in whole.conjuncts:
            selection = _narrowed(dataset, part, selection)
    return _nearest(dataset, near, selection) if near else selection


def check_key(dataset: xr.Dataset, formula: str) -> Expression:
    """A formula with one value or label a scenario. Raises InputError for any other."""
    expression = parse(formula)
    _check(dataset, expression, Expression.key)
    return expression


def holds(dataset: xr.Dataset, selection: Selection, points: Points) -> np.ndarray:
    """Where the conditions of a selection hold at some points, as an array over the dimensions of the status."""
    lookup = lookup_at(dataset, points)
    shape = {dim: points[dim].size for dim in points}
    found = np.ones(tuple(shape.values()), dtype=bool)
    for condition in selection.conditions:
        found &= spread(condition.select(lookup), shape)
        if not found.any():
            break
    return found


def spread(values: Any, shape: dict[str, int]) -> np.ndarray:
    """Values over all dimensions of the status, in their order."""
    return xr.Variable((), values).set_dims(shape).values if np.ndim(values) == 0 else values.set_dims(shape).values


def blocks(selection: Selection, sizes: dict[str, int], width: int = 1) -> Iterator[Points]:
    """The points of a selection in blocks: of at most BLOCK numbers where a scenario has `width` of them."""
    for ranges in block_ranges(selection, sizes, width):
        yield points_within(selection, sizes, ranges)


def block_ranges(selection: Selection, sizes: dict[str, int], width: int = 1) -> Iterator[Ranges]:
    """The same blocks as the range of each dimension, which takes no memory; none without points of the selection."""
    chunks = chunk_sizes(tuple(sizes.values()))
    lengths = []
    room = max(1, BLOCK // max(1, width))
    for size, chunk in zip(reversed(sizes.values()), reversed(chunks), strict=True):
        length = min(size, room)
        # Whole chunks, so that none is read twice.
        lengths.append(length - length % chunk if size > length > chunk else max(1, length))
        room = max(1, room // max(1, size))
    ranges = [
        [(first, first + length) for first in range(0, size, length)]
        for size, length in zip(sizes.values(), reversed(lengths), strict=True)
    ]
    for block in itertools.product(*ranges):
        if all(inside.size for inside in points_within(selection, sizes, block).values()):
            yield block


def points_within(selection: Selection, sizes: dict[str, int], ranges: Ranges) -> Points:
    """The points of a selection in a range of each dimension."""
    return {
        dim: selection.points[dim][slice(*np.searchsorted(selection.points[dim], bounds))]
        for dim, bounds in zip(sizes, ranges, strict=True)
    }


def lookup_at(dataset: xr.Dataset, points: Points) -> Lookup:
    """What names mean at some points: each is read once, as a variable without coordinates."""
    whole = scene_lookup(dataset)

    @cache
    def lookup(name: str) -> Term | None:
        term = whole(name)
        return None if term is None else replace(term, values=read(term.values, points))

    return lookup


def read(values: xr.DataArray, points: Points) -> xr.Variable:
    """Values at some points, read as one piece and then picked from. Raises EnvironmentFault where that fails."""
    inside = {dim: own for dim, own in points.items() if dim in values.dims}
    pieces = {dim: slice(int(own[0]), int(own[-1]) + 1) if own.size else slice(0, 0) for dim, own in inside.items()}
    with readable(values.encoding.get("source", values.name)):
        piece = values.variable.isel(pieces).load()
    gaps = {dim: own - own[0] for dim, own in inside.items() if own.size and own.size < piece.sizes[dim]}
    return piece.isel(gaps)


def _check(dataset: xr.Dataset, expression: Expression, answer: Any) -> None:
    """Evaluate at no point at all: names, units and dimensions are wrong there as anywhere."""
    found = _at_no_point(dataset, expression, answer)
    found = found.values if isinstance(found, Term) else found
    for dim in getattr(found, "dims", ()):
        if dim not in dataset.status.dims:
            raise InputError(f"'{expression.text}' varies along {dim}: one answer a scenario is needed")


def _at_no_point(dataset: xr.Dataset, expression: Expression, answer: Any) -> Any:
    nowhere = {str(dim): np.arange(0) for dim in dataset.status.dims}
    try:
        return answer(expression, lookup_at(dataset, nowhere))
    except UnknownName as unknown:
        raise name_is_unknown(dataset, unknown.name) from None


def _narrowed(dataset: xr.Dataset, part: Expression, selection: Selection) -> Selection:
    """The selection with one more condition, decided now if it is about one dimension alone."""
    dims = getattr(_at_no_point(dataset, part, Expression.select), "dims", ())
    if len(dims) > 1:
        return replace(selection, conditions=(*selection.conditions, part))
    found = part.select(lookup_at(dataset, {}))
    dim = str(dims[0]) if dims else next(iter(selection.points))
    mask = np.broadcast_to(np.asarray(getattr(found, "values", found)), dataset.sizes[dim])
    notes = selection.notes if mask.any() else (*selection.notes, *_miss(dataset, part))
    points = selection.points[dim]
    return replace(selection, points={**selection.points, dim: points[mask[points]]}, notes=notes)


def _miss(dataset: xr.Dataset, part: Expression) -> Iterator[str]:
    """What there is instead of a value that no scenario has."""
    asked = part.equality
    if asked is None or asked.name not in dataset.coords or dataset[asked.name].dtype.kind not in "fi":
        return
    values = dataset[asked.name]
    known = np.unique(values.values[np.isfinite(values.values)])
    unit = asked.unit or values.attrs.get("units", "1")
    scale = units.factor(unit, values.attrs.get("units", "1")) if asked.unit else 1.0
    shown = "" if unit == "1" else f" {unit}"
    below, above = known[known < asked.value][-1:], known[known > asked.value][:1]
    neighbours = [f"{value / scale:.9g}{shown}" for value in (*below, *above)]
    if neighbours:
        told = (
            f"the neighbours are {' and '.join(neighbours)}" if len(neighbours) == 2 else f"nearest is {neighbours[0]}"
        )
        yield f"no scenario has {asked.name} = {asked.value / scale:.9g}{shown}: {told}"


def _nearest(dataset: xr.Dataset, near: tuple[tuple[str, str], ...], selection: Selection) -> Selection:
    """The points that are nearest to values: on each axis by itself, of cases and samples by all values together.

    Differences count by the range of each parameter; all points that are equally near are kept.
    """
    distance: dict[str, np.ndarray] = {}
    for name, text in near:
        values = _parameter(dataset, name)
        try:
            wanted = units.to_si(text, values.attrs.get("units", "1"))
        except InputError as problem:
            raise InputError(f"nearest {name}: {problem}") from None
        for dim in map(str, values.dims):
            own = values.values[selection.points[dim]]
            width = np.ptp(values.values) or 1.0
            with np.errstate(over="ignore"):
                distance[dim] = np.hypot(distance.get(dim, 0.0), (own - wanted) / width)
    points = {
        dim: own[distance[dim] <= distance[dim].min() * (1.0 + 5e-10)] if dim in distance and own.size else own
        for dim, own in selection.points.items()
    }
    return replace(selection, points=points)


def _parameter(dataset: xr.Dataset, name: str) -> xr.DataArray:
    known = [
        str(n) for n, v in dataset.coords.items() if v.dtype.kind in "fi" and v.ndim < 2 and of_scenarios(v, dataset)
    ]
    if name not in known:
        raise InputError(f"nearest {name}: no such parameter: {nearest(name, known)}")
    return dataset[name]


def as_values(term: Term) -> Any:
    """The values of a term; labels as words."""
    coded = term.unit == WORDS and term.values.dtype.kind == "i"
    return term.values.copy(data=np.array(term.words)[term.values.values]) if coded else term.values
