"""Line built for equal strength under another horizontal force: its stress is no longer the same everywhere.

    V = H_0 (sinh(s / k) + c),  H = r H_0,  dx/ds = H / T,  dz/ds = V / T,  T = sqrt(H^2 + V^2)                 (M7)

with s from the vertex of the design. The ends keep their rise, which gives c; their horizontal distance is an answer.
The stress over the permitted one is sqrt(r^2 + (sinh(s / k) + c)^2) / cosh(s / k): 1 everywhere for r = 1 alone. Its
largest value is at an end, or where its derivative vanishes (`cablesim.physics.built_line`, E3). c follows from one
monotone equation, by bracketed Newton; the integrals are Gauss-Legendre sums over panels that shrink towards the kink
that a small force leaves at the lowest point. Relative errors below 1e-12 for r from 0.001 to 1000.

Reference: "Differential equations of equilibrium of a thread", in Introduction to the mechanics of flexible threads (in
Russian), pp. 98-100: the chain of a deep-water anchor when the wind changes.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cablesim.numerics import Array
from cablesim.parameters import parameter
from cablesim.physics.built_line import BuiltLine
from cablesim.physics.equal_strength import EqualStrengthLine, missing_span
from cablesim.solver import Solution
from cablesim.solvers import equal_strength
from cablesim.solvers._built_march import DISTANCE, positions, sums_along, vertical_tension
from cablesim.solvers.equal_strength import Options
from cablesim.status import Status

__all__ = ["OUTPUTS", "Options", "Parameters", "solve"]

OUTPUTS = (
    "horizontal_distance",
    "max_stress_ratio",
    "stress_ratio",
    "stress_ratio_A",
    "stress_ratio_B",
    "profile",
    "profile_stress_ratio",
)
SECONDS_PER_SCENARIO = 1e-4
COMPILED = True
ITERATES = True


@dataclass(frozen=True)
class Parameters(equal_strength.Parameters):
    force_ratio: Array = parameter(above=0.0, typical=(0.05, 5.0))
    arc_fraction: Array = parameter(at_least=0.0, at_most=1.0, default=0.5, typical=(0.0, 1.0))


@dataclass(frozen=True)
class LoadedLine:
    """The line as it hangs; `vertical` is the vertical tension at its thinnest place."""

    nodes: int
    line: BuiltLine
    arc_fraction: Array
    vertical: Array

    @cached_property
    def horizontal_distance(self) -> Array:
        sums = sums_along(self.line.low, self.line.high, *self._state)
        return self.line.design.strength_length * sums[:, DISTANCE]

    @property
    def stress_ratio(self) -> Array:
        return self._stresses(self.line.places(self.arc_fraction[:, None]))[:, 0]

    @property
    def stress_ratio_A(self) -> Array:
        return self._end_stresses[:, 0]

    @property
    def stress_ratio_B(self) -> Array:
        return self._end_stresses[:, 1]

    @cached_property
    def max_stress_ratio(self) -> Array:
        inside = self._stresses(self.line.highest_stress_place(self.vertical)[:, None])[:, 0]
        return np.maximum(inside, np.maximum(self.stress_ratio_A, self.stress_ratio_B))

    @cached_property
    def profile(self) -> Array:
        """Nodes at equal steps of length."""
        along = self._nodes.copy()
        along[self.line.falling] = along[self.line.falling, ::-1]
        x, z = positions(along, *self._state)
        k = self.line.design.strength_length[:, None]
        return self.line.profile(k * x, k * z)

    @property
    def profile_stress_ratio(self) -> Array:
        return self._stresses(self._nodes)

    @cached_property
    def _end_stresses(self) -> Array:
        return self._stresses(self.line.places(np.array([0.0, 1.0])))

    @cached_property
    def _nodes(self) -> Array:
        return self.line.places(np.linspace(0.0, 1.0, self.nodes))

    def _stresses(self, places: Array) -> Array:
        return self.line.stresses(places, self.vertical[:, None] + self.line.weights(places))

    @property
    def _state(self) -> tuple[Array, Array, Array]:
        return self.line.thinnest, self.line.force_ratio, self.vertical


def solve(p: Parameters, options: Options) -> Solution:
    feasible = missing_span(p.strength_length, p.span) > 0.0
    span = np.where(feasible, p.span, p.strength_length)
    line = BuiltLine(EqualStrengthLine(options.nodes, p.strength_length, span, p.rise), p.force_ratio)
    vertical, roots = vertical_tension(line)
    found = np.where(roots.converged, Status.ok, Status.not_converged)
    status = np.where(feasible, found, Status.infeasible).astype(np.int8)
    return Solution(status, LoadedLine(options.nodes, line, p.arc_fraction, vertical), roots.iterations)
