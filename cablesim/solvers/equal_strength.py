"""Line of equal strength: its cross-section grows with its tension, so that its stress is the same everywhere.

    y = -k ln cos(x / k),  s = k ln tan(pi/4 + x / 2k),  |x| < pi k / 2,  k = strength / weight per volume       (M7)

Cross-section and tension grow as 1 / cos(x / k). Both ends lie on this one curve, whose width is pi k: a span of pi k
or more is infeasible. Between supports phi = x / k is phi_mid -+ l / 2k with tan(phi_mid) = tanh(h / 2k) / tan(l / 2k);
all outputs are closed formulas (`cablesim.physics.equal_strength`, E1), right to a few units in the last place of the
inputs, also next to pi k. The cross-sections at the ends differ by exp(h / k): where h / k exceeds 700 that is beyond
the range of floats (out_of_domain).

`area_ratio_A` and `area_ratio_B` are cross-sections over the one that carries the horizontal force alone;
`saved_weight_fraction` is what is saved against a line of the same length as thick as the thicker end everywhere.

Reference: "Differential equations of equilibrium of a thread", in Introduction to the mechanics of flexible threads (in
Russian), pp. 98-100: Coriolis' chain of equal resistance.
"""

from dataclasses import dataclass

import numpy as np

from cablesim.numerics import Array
from cablesim.parameters import Batch, option, parameter
from cablesim.physics.equal_strength import EqualStrengthLine, missing_span
from cablesim.solver import Solution
from cablesim.status import Status

OUTPUTS = (
    "drop",
    "line_length",
    "area_ratio_A",
    "area_ratio_B",
    "saved_weight_fraction",
    "weight_over_force",
    "vertex_x",
    "profile",
    "profile_area_ratio",
    "profile_weight",
)
SECONDS_PER_SCENARIO = 1e-6


@dataclass(frozen=True)
class Parameters(Batch):
    strength_length: Array = parameter(above=0.0, typical=(1e3, 1e4))
    span: Array = parameter(above=0.0, typical=(10.0, 1e4))
    rise: Array = parameter(default=0.0, typical=(-3e3, 3e3))


@dataclass(frozen=True)
class Options:
    nodes: int = option(101, at_least=2, at_most=100_000, meaning="nodes of the profile")


def solve(p: Parameters, options: Options) -> Solution:
    feasible = missing_span(p.strength_length, p.span) > 0.0
    # An infeasible line gets the span of a feasible one: its status says what its numbers are worth.
    span = np.where(feasible, p.span, p.strength_length)
    line = EqualStrengthLine(options.nodes, p.strength_length, span, p.rise)
    return Solution(np.where(feasible, Status.ok, Status.infeasible).astype(np.int8), line)
