"""Methods of a scene, and the series among them: one solver at growing effort, whose order can be measured."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from cablesim.solver import Solver

# Fewer methods than these say nothing about an order.
SHORTEST_SERIES = 3


@dataclass(frozen=True)
class Method:
    """A named solver with its options; `ignores` are the design's parameters that it lacks or does without."""

    name: str
    solver: Solver
    options: dict[str, Any]
    ignores: frozenset[str]

    @property
    def columns(self) -> set[str]:
        """The parameters that it has and does not ignore, as designs hold them."""
        return set(self.solver.columns) - self.ignores

    @cached_property
    def made_options(self) -> Any:
        """The options as the solver takes them."""
        return self.solver.make_options(self.options)

    @property
    def changed_options(self) -> dict[str, Any]:
        """The options in which it differs from its solver's defaults."""
        defaults = {name: spec.default for name, spec in self.solver.options.items()}
        return {name: value for name, value in self.options.items() if value != defaults[name]}

    @property
    def sizes(self) -> dict[str, int]:
        """The lengths of its outputs' own dimensions."""
        return self.solver.sizes(self.made_options)

    @property
    def seconds_per_scenario(self) -> float:
        """The measured cost of its solver, with its options."""
        return self.solver.seconds_per_scenario(self.made_options)


@dataclass(frozen=True)
class Series:
    """Methods that differ in one numerical option alone, in the order of its values."""

    solver: str
    option: str
    shared: dict[str, Any]
    methods: tuple[Method, ...]

    @property
    def values(self) -> tuple[float, ...]:
        return tuple(float(method.options[self.option]) for method in self.methods)

    @property
    def counts_work(self) -> bool:
        """Whether a larger value is more work (a number of segments) and not less (a tolerance)."""
        return all(isinstance(method.options[self.option], int) for method in self.methods)


def find_series(methods: tuple[Method, ...], reference: str | None) -> tuple[Series, ...]:
    """The series among the methods of a scene, the reference left out."""
    others = [method for method in methods if method.name != reference]
    found = (series for method in others for series in _series_from(method, others))
    return tuple(series for series in found if len(series.methods) >= SHORTEST_SERIES)


def series_names(series: tuple[Series, ...]) -> list[str]:
    """A name for each series: its solver, and the options in which it differs from the others."""
    names = []
    for one in series:
        others = [other.shared for other in series if other.solver == one.solver]
        told = [o for o, value in one.shared.items() if any(other.get(o) != value for other in others)]
        names.append(", ".join([one.solver, *(f"{option}={one.shared[option]}" for option in told)]))
    return names


def _series_from(first: Method, methods: list[Method]) -> Iterator[Series]:
    """The series that a method is the first of, in the order of the scene."""
    for option, value in first.options.items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            continue
        shared = _without(first, option)
        alike = [m for m in methods if m.solver is first.solver and _without(m, option) == shared]
        if alike[0] is first:
            yield Series(first.solver.name, option, shared, tuple(sorted(alike, key=lambda m: m.options[option])))


def _without(method: Method, option: str) -> dict[str, Any]:
    return {name: value for name, value in method.options.items() if name != option}
