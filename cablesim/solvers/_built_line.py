"""What the solvers of a line built for equal strength share, whatever force it hangs under."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.roots import Roots
from cablesim.parameters import parameter
from cablesim.physics.built_line import BuiltLine
from cablesim.physics.equal_strength import EqualStrengthLine, missing_span
from cablesim.solvers import equal_strength
from cablesim.status import Status

OUTPUTS = (
    "horizontal_distance",
    "max_stress_ratio",
    "stress_ratio",
    "stress_ratio_A",
    "stress_ratio_B",
    "profile",
    "profile_stress_ratio",
)


@dataclass(frozen=True)
class LoadedLine(equal_strength.Parameters):
    """A line of equal strength, the force that it hangs under, and a place that is looked at."""

    force_ratio: Array = parameter(above=0.0, typical=(0.05, 5.0))
    arc_fraction: Array = parameter(at_least=0.0, at_most=1.0, default=0.5, typical=(0.0, 1.0))


@dataclass(frozen=True)
class HungLine(ABC):
    """The line as it hangs; `vertical` is the vertical tension at its thinnest place.

    Places are given as fractions of the length from the first end (`BuiltLine`); (scenario, place).
    """

    nodes: int
    line: BuiltLine
    arc_fraction: Array
    vertical: Array

    @abstractmethod
    def vertical_at(self, from_first: Array) -> Array:
        """Vertical tension at some places."""

    @abstractmethod
    def positions(self, from_first: Array) -> tuple[Array, Array]:
        """x and z over k at places that follow each other, from the first end."""

    @property
    @abstractmethod
    def horizontal_distance(self) -> Array:
        """Of the two ends."""

    @property
    @abstractmethod
    def max_stress_ratio(self) -> Array:
        """Anywhere on the line."""

    @property
    def stress_ratio(self) -> Array:
        return self.stresses(self.line.from_first(self.arc_fraction[:, None]))[:, 0]

    @property
    def stress_ratio_A(self) -> Array:
        return self._end_stresses[:, 0]

    @property
    def stress_ratio_B(self) -> Array:
        return self._end_stresses[:, 1]

    @cached_property
    def profile(self) -> Array:
        """Nodes at equal steps of length."""
        fractions = np.tile(np.linspace(0.0, 1.0, self.nodes), (self.vertical.size, 1))
        x, z = self.positions(fractions)
        k = self.line.design.strength_length[:, None]
        return self.line.profile(k * x, k * z)

    @property
    def profile_stress_ratio(self) -> Array:
        return self.stresses(self.line.from_first(np.linspace(0.0, 1.0, self.nodes)))

    def stresses(self, from_first: Array) -> Array:
        """Tension over the cross-section of the design, over the permitted stress."""
        return self.line.stresses(self.line.places(from_first), self.vertical_at(from_first))

    @cached_property
    def _end_stresses(self) -> Array:
        return self.stresses(self.line.from_first(np.array([0.0, 1.0])))


def built_line(p: LoadedLine) -> BuiltLine:
    """The lines as built; those whose design does not exist have the span of one that does."""
    span = np.where(missing_span(p.strength_length, p.span) > 0.0, p.span, p.strength_length)
    return BuiltLine(EqualStrengthLine(2, p.strength_length, span, p.rise), p.force_ratio)


def fate(p: LoadedLine, roots: Roots) -> np.ndarray:
    """The status of every scenario."""
    found = np.where(roots.converged, Status.ok, Status.not_converged)
    return np.where(missing_span(p.strength_length, p.span) > 0.0, found, Status.infeasible).astype(np.int8)
