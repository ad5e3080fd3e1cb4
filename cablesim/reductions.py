"""One value for all scenarios: `largest(sag)`, `count(status == ok)`, `at_largest(max_tension, rise)`.

Functions of formulas, in answers only. They go over every scenario, and every method where a formula varies with it;
what is not finite is left out. Without any value the answer is not a number.

largest(x)  smallest(x)  median(x)  mean(x)     of a number
at_largest(x, y)  at_smallest(x, y)             what y, a number or a word, is where x is largest
value(x, condition)                             x, a number or a word, of which there is one
count(condition)                                for how many scenarios it holds; for each method, if it varies with it
share(condition)                                the part for which it holds

All but count may be given a condition, as their last argument, that scenarios must meet to be taken into account.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from cablesim.errors import InputError
from cablesim.expressions import BARE, EQUAL_WITHIN, WORDS, Evaluation, Function, Term

if TYPE_CHECKING:
    from lark import Tree

NUMBER, ANY, CONDITION = "x", "y", "condition"
COUNT, VALUE = "count", "value"


@dataclass(frozen=True)
class Reduction:
    """What it is taken of, and how; where `optional`, the last argument may be left out."""

    name: str
    takes: tuple[str, ...]
    optional: bool
    reduce: Callable[..., Term]

    @property
    def usage(self) -> str:
        """How it is written."""
        whole = f"{self.name}({', '.join(self.takes)})"
        return f"{self.name}({', '.join(self.takes[:-1])}) or {whole}" if self.optional and self.takes[1:] else whole

    def read(self, evaluation: Evaluation, arguments: tuple["Tree", ...]) -> list[Term]:
        """Its arguments, evaluated. Raises InputError where they are too few, too many or of another kind."""
        if not len(self.takes) - self.optional <= len(arguments) <= len(self.takes):
            raise InputError(f"'{evaluation.text}': {self.name} is written {self.usage}")
        readers = {NUMBER: evaluation.number, ANY: evaluation.told, CONDITION: evaluation.condition}
        return [readers[kind](argument) for kind, argument in zip(self.takes, arguments, strict=False)]


def _of_values(function: Callable[[Any], Any]) -> Callable[..., Term]:
    """A function of all finite values."""

    def reduce(x: Term, where: Term | None = None) -> Term:
        values, counts = _together(x, where)
        found = values[counts & np.isfinite(values)]
        return Term(float(function(found)) if found.size else math.nan, x.unit)

    return reduce


def _at(sign: float) -> Callable[..., Term]:
    """What y is where x is largest, or smallest."""

    def reduce(x: Term, y: Term, where: Term | None = None) -> Term:
        values, told, counts = _together(x, y, where)
        counts = counts & np.isfinite(values)
        if not counts.any():
            return Term(math.nan, y.unit)
        best = int(np.argmax(np.where(counts, sign * values, -np.inf)))
        return _single(told.ravel()[best], y)

    return reduce


def _value(x: Term, where: Term | None = None) -> Term:
    values, counts = _together(x, where)
    found = values[counts]
    if x.unit != WORDS:
        found = found[np.isfinite(found)]
    if not found.size:
        return Term(math.nan, x.unit)
    others = found != found[0]
    if x.unit != WORDS:
        others &= np.abs(found - found[0]) > EQUAL_WITHIN * np.abs(found[0])
    if others.any():
        raise InputError(f"value: {1 + others.sum()} values of {found.size} differ, one is expected")
    return _single(found[0], x)


def _count(where: Term) -> Term:
    return Term(float(np.count_nonzero(where.values)), BARE)


def _share(holds: Term, where: Term | None = None) -> Term:
    true, counts = _together(holds, where)
    return Term(float(true[counts].mean()) if counts.any() else math.nan, "1")


REDUCTIONS = {
    reduction.name: reduction
    for reduction in (
        Reduction("largest", (NUMBER, CONDITION), True, _of_values(np.max)),
        Reduction("smallest", (NUMBER, CONDITION), True, _of_values(np.min)),
        Reduction("median", (NUMBER, CONDITION), True, _of_values(np.median)),
        Reduction("mean", (NUMBER, CONDITION), True, _of_values(np.mean)),
        Reduction("at_largest", (NUMBER, ANY, CONDITION), True, _at(1.0)),
        Reduction("at_smallest", (NUMBER, ANY, CONDITION), True, _at(-1.0)),
        Reduction(VALUE, (ANY, CONDITION), True, _value),
        Reduction(COUNT, (CONDITION,), False, _count),
        Reduction("share", (CONDITION, CONDITION), True, _share),
    )
}


def reductions(sizes: Mapping[str, int]) -> dict[str, Function]:
    """The functions by name, for scenarios along axes of these `sizes`."""
    return {name: _function(reduction, sizes) for name, reduction in REDUCTIONS.items()}


def _function(reduction: Reduction, sizes: Mapping[str, int]) -> Function:
    def function(evaluation: Evaluation, arguments: tuple["Tree", ...]) -> Term:
        terms = reduction.read(evaluation, arguments)
        found = reduction.reduce(*terms)
        # What a condition says of the points of one axis, it says of all scenarios along the others.
        along = getattr(terms[0].values, "dims", ())
        left = math.prod(size for axis, size in sizes.items() if axis not in along)
        return Term(left * found.values, BARE) if reduction.name == COUNT else found

    return function


def _together(*terms: Term | None) -> list[Any]:
    """Values of one shape, flat; the last are conditions, and those that are not given hold."""
    arrays = [term.values if term is not None else np.True_ for term in terms]
    if any(hasattr(array, "dims") for array in arrays):
        import xarray as xr

        arrays = [array.values for array in xr.broadcast(*map(xr.DataArray, arrays))]
    return [array.ravel() for array in np.broadcast_arrays(*arrays)]


def _single(value: Any, of: Term) -> Term:
    """A number, or the word that a label or a flag stands for."""
    if of.unit != WORDS:
        return Term(float(value), of.unit)
    return Term(of.words[int(value)] if isinstance(value, np.integer) else str(value), WORDS)
