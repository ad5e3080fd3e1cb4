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

from functools import cached_property

import numpy as np

from cablesim.numerics import Array
from cablesim.solver import Solution
from cablesim.solvers._built_line import OUTPUTS, HungLine, built_line, fate
from cablesim.solvers._built_line import LoadedLine as Parameters
from cablesim.solvers._built_march import DISTANCE, positions, sums_along, vertical_tension
from cablesim.solvers.equal_strength import Options

__all__ = ["OUTPUTS", "Options", "Parameters", "solve"]

SECONDS_PER_SCENARIO = 2e-5
COMPILED = True
ITERATES = True


class SmoothLine(HungLine):
    """With the weight and the cross-section of the design at every point."""

    def vertical_at(self, from_first: Array) -> Array:
        return self.vertical[:, None] + self.line.weights(self.line.places(from_first))

    def positions(self, from_first: Array) -> tuple[Array, Array]:
        return positions(self.line.places(from_first), self.line.thinnest, self.line.force_ratio, self.vertical)

    @cached_property
    def horizontal_distance(self) -> Array:
        line = self.line
        sums = sums_along(line.low, line.high, line.thinnest, line.force_ratio, self.vertical)
        return line.design.strength_length * sums[:, DISTANCE]

    @cached_property
    def max_stress_ratio(self) -> Array:
        place = self.line.highest_stress_place(self.vertical)[:, None]
        inside = self.line.stresses(place, self.vertical[:, None] + self.line.weights(place))[:, 0]
        return np.maximum(inside, np.maximum(self.stress_ratio_A, self.stress_ratio_B))


def solve(p: Parameters, options: Options) -> Solution:
    line = built_line(p)

    def sums(vertical: Array, which: np.ndarray) -> Array:
        return sums_along(line.low[which], line.high[which], line.thinnest[which], line.force_ratio[which], vertical)

    vertical, roots = vertical_tension(line, sums)
    return Solution(fate(p, roots), SmoothLine(options.nodes, line, p.arc_fraction, vertical), roots.iterations)
