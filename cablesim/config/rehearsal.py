"""A dress rehearsal of a scene's formulas, while it is read: do the names exist, the units fit, the axes suffice?

Every name stands for an array that is two long along each of its dimensions and one long along the others, so that the
dimensions of a formula can be read off the shape of its value. Nothing is solved.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from cablesim import units
from cablesim.config.table import Table
from cablesim.design import SCENARIO, Design
from cablesim.errors import InputError, nearest
from cablesim.expressions import BARE, WORDS, Function, Term, UnknownName, parse
from cablesim.parameters import ParameterSpec
from cablesim.quantities import (
    LIST,
    OWN_DIMS,
    RUN_TIME,
    TABLE,
    component_names,
    is_list,
    list_name,
    most_sections,
    quantity,
)
from cablesim.status import Status, Verdict

METHOD = "method"
# Units that formulas are told in, the simplest first.
KNOWN_UNITS = tuple(dict.fromkeys(row.unit for row in TABLE))
T = TypeVar("T")


def table_axis(table: Table, design: Design) -> str:
    """The axis along which the rows of a table lie: that of the cases, or the axis that its first column is."""
    return SCENARIO if design.kind != "grid" else next(iter(table.columns))


@dataclass(frozen=True)
class Rehearsal:
    """What the names of a scene will stand for.

    `values` are numbers that a formula of its own has names for, `checks` the names of checks, whose flags are words.
    """

    design: Design
    fixed: dict[str, float]
    parameters: dict[str, ParameterSpec]
    methods: tuple[str, ...]
    outputs: tuple[str, ...]
    table: Table | None = None
    values: dict[str, Term] = field(default_factory=dict)
    checks: tuple[str, ...] = ()

    def number(self, formula: str) -> set[str]:
        """The dimensions along which a formula varies. Raises InputError for an unknown name or a wrong unit."""
        return self.varies(self._answered(lambda: parse(formula).evaluate(self.lookup)))

    def unit(self, formula: str) -> str:
        """The SI unit of a formula, "1" for a plain number. Raises InputError as `number` does."""
        unit = self._answered(lambda: parse(formula).unit(self.lookup))
        return unit if unit in KNOWN_UNITS else units.simplest(unit, KNOWN_UNITS)

    def condition(self, text: str) -> set[str]:
        """The dimensions along which a condition varies. Raises InputError as `number` does."""
        has_units = any(value.unit != BARE for value in self.values.values())
        return self.varies(self._answered(lambda: parse(text).select(self.lookup, has_units)))

    def answer(self, formula: str, functions: Mapping[str, Function], checking: bool) -> tuple[Term, set[str]]:
        """What a formula of an answer gives, and the dimensions along which it varies. Raises as `number` does."""
        term = self._answered(lambda: parse(formula).answer(self.lookup, functions, checking))
        return term, self.varies(term.values)

    def lookup(self, name: str) -> Term | None:
        """The stand-in for a name; None where it stands for nothing."""
        head, _, tail = name.rpartition(".")
        if head == "table" and self.table is not None and tail in self.table.columns:
            return self._of_table(tail, self.table)
        if head:
            return self._of_method(tail) if head in self.methods else None
        if name in self.values:
            return self.values[name]
        if name == METHOD:
            return Term(self._words((METHOD,), self.methods), WORDS, self.methods)
        if name == "status":
            return self._flags(self._scenario_dims, tuple(status.name for status in Status))
        if name in self.checks:
            return self._flags(self._scenario_dims, tuple(verdict.name for verdict in Verdict))
        if name in self.answers:
            return self._output(name, (METHOD,))
        if name in LIST and self.sections:
            return Term(self._along(LIST), BARE)
        if is_list(name) and f"{name}_1" in self._given:
            return Term(self._along((*self._along_list(name), *LIST)), quantity(name).unit)
        if list_name(name) and name in self._given and name not in self._dims:
            return self._parameter(name, tuple(set(self._along_list(list_name(name))) & {SCENARIO}))
        for axis in self.design.axes:
            if name in axis.columns:
                return self._parameter(name, (axis.name,))
            if name == axis.name or axis.labels.get(name, np.array("")).dtype.kind == "i":
                return Term(self._along((axis.name,)), BARE)
            if name in axis.labels:
                words = tuple(np.unique(axis.labels[name]).tolist())
                return Term(self._words((axis.name,), words), WORDS, words)
        return self._parameter(name, ()) if name in self.fixed else None

    def coordinate(self, axis: str, name: str) -> Term | None:
        """What a name stands for along one axis, or along the methods, for real; None where that is nothing."""
        if axis == METHOD:
            return Term(np.array(self.methods), WORDS, self.methods) if name == METHOD else None
        head, _, tail = name.rpartition(".")
        points = next(one for one in self.design.axes if one.name == axis)
        if head == "table" and self.table is not None and tail in self.table.columns:
            rows = points.labels.get("row")
            return self.table.term(tail, rows) if rows is not None else None
        if name in points.columns:
            words = self.parameters[name].words
            values = points.columns[name]
            return (
                Term(np.array(words)[values.astype(int)], WORDS, words) if words else Term(values, quantity(name).unit)
            )
        if name == axis:
            return Term(np.arange(points.size), BARE)
        labels = points.labels.get(name)
        if labels is None:
            return None
        return Term(labels, BARE) if labels.dtype.kind == "i" else Term(labels, WORDS, tuple(np.unique(labels)))

    @property
    def sizes(self) -> dict[str, int]:
        """The number of methods, and of points along each axis."""
        return {METHOD: len(self.methods), **{axis.name: axis.size for axis in self.design.axes}}

    @property
    def scenario_dims(self) -> set[str]:
        """Methods and axes."""
        return set(self.sizes)

    @cached_property
    def sections(self) -> int:
        """The largest number of sections of a line."""
        return most_sections(self._given)

    @cached_property
    def answers(self) -> tuple[str, ...]:
        """The outputs, vectors and lists also by their parts, and the run time."""
        components = (name for output in self.outputs for name in component_names(output, self.sections))
        return tuple(dict.fromkeys((*self.outputs, *components, RUN_TIME)))

    @cached_property
    def _given(self) -> set[str]:
        return self.design.parameters | set(self.fixed)

    @property
    def _scenario_dims(self) -> tuple[str, ...]:
        return (METHOD, *(axis.name for axis in self.design.axes))

    @property
    def _dims(self) -> tuple[str, ...]:
        return (*self._scenario_dims, *OWN_DIMS)

    def _of_table(self, column: str, table: Table) -> Term:
        dims = (table_axis(table, self.design),)
        if self.design.kind == "grid":
            table.numbers(column)
        words = table.words(column)
        return self._flags(dims, words) if words else Term(self._along(dims), BARE)

    def _along_list(self, name: str) -> tuple[str, ...]:
        """The axes along which any section of a list varies."""
        return tuple(
            axis.name for axis in self.design.axes if any(list_name(column) == name for column in axis.columns)
        )

    def _parameter(self, name: str, dims: tuple[str, ...]) -> Term:
        words = self.parameters[name].words
        return self._flags(dims, words) if words else Term(self._along(dims), quantity(name).unit)

    def _of_method(self, name: str) -> Term | None:
        if name in self.checks:
            return self._flags(self._scenario_dims[1:], tuple(verdict.name for verdict in Verdict))
        return self._output(name, ()) if name in self.answers else None

    def _output(self, name: str, leading: tuple[str, ...]) -> Term:
        dims = (*leading, *self._scenario_dims[1:], *quantity(name).dims)
        return Term(self._along(dims), quantity(name).unit)

    def _flags(self, dims: tuple[str, ...], words: tuple[str, ...]) -> Term:
        return Term(self._words(dims, words), WORDS, words)

    def _along(self, dims: tuple[str, ...]) -> np.ndarray:
        return np.ones([2 if dim in dims else 1 for dim in self._dims])

    def _words(self, dims: tuple[str, ...], words: tuple[str, ...]) -> np.ndarray:
        return np.full([2 if dim in dims else 1 for dim in self._dims], words[0])

    def varies(self, value: Any) -> set[str]:
        """The dimensions along which a stand-in varies."""
        shape = np.shape(value)
        return {dim for dim, size in zip(self._dims, shape, strict=True) if size > 1} if shape else set()

    def _answered(self, answer: Callable[[], T]) -> T:
        try:
            return answer()
        except UnknownName as unknown:
            raise InputError(f"unknown name '{unknown.name}': {nearest(unknown.name, self._names)}") from None

    @property
    def _names(self) -> list[str]:
        varying = [name for axis in self.design.axes for name in (axis.name, *axis.columns, *axis.labels)]
        qualified = [f"{method}.{answer}" for method in self.methods for answer in (*self.answers, *self.checks)]
        return [*self.answers, *qualified, *varying, *self.fixed, *self.values, *self.checks, METHOD, "status"]
