"""A dress rehearsal of a scene's formulas, while it is read: do the names exist, the units fit, the axes suffice?

Every name stands for an array that is two long along each of its dimensions and one long along the others, so that the
dimensions of a formula can be read off the shape of its value. Nothing is solved.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeVar

import numpy as np

from cablesim import units
from cablesim.config.table import Table
from cablesim.design import SCENARIO, Design
from cablesim.errors import InputError, nearest
from cablesim.expressions import BARE, WORDS, Term, UnknownName, parse
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
        return self._varies(self._answered(lambda: parse(formula).evaluate(self.lookup)))

    def unit(self, formula: str) -> str:
        """The SI unit of a formula, "1" for a plain number. Raises InputError as `number` does."""
        unit = self._answered(lambda: parse(formula).unit(self.lookup))
        return unit if unit in KNOWN_UNITS else units.simplest(unit, KNOWN_UNITS)

    def condition(self, text: str) -> set[str]:
        """The dimensions along which a condition varies. Raises InputError as `number` does."""
        has_units = any(value.unit != BARE for value in self.values.values())
        return self._varies(self._answered(lambda: parse(text).select(self.lookup, has_units)))

    def lookup(self, name: str) -> Term | None:
        """The stand-in for a name; None where it stands for nothing."""
        head, _, tail = name.rpartition(".")
        if head == "table" and self.table is not None and tail in self.table.columns:
            return Term(self._along((SCENARIO,)), BARE)
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

    def _varies(self, value: np.ndarray) -> set[str]:
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
