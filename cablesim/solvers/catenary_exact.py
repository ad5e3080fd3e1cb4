"""Exact catenary: an inextensible line between two supports at any levels.

    y = a (cosh(x / a) - 1),  a = H / w                                                        (M1)
    sinh(lambda) = k lambda,  k = sqrt(L^2 - h^2) / l,  lambda = l / 2a                        (M2)
    T = w a cosh(x / a);  supports at x / a = asinh(h / (l k)) -+ lambda                       (M3)

Perfectly flexible, uniform, under its weight alone. Solved for every length longer than the chord, from 1e-12 of the
chord to 1e6 spans and beyond, to a few units in the last place of the float64 inputs; L <= chord is infeasible.
`length_ratio` may replace `line_length` and then means exactly ratio * span.

Reference: "Comparison of experimental and theoretical catenary lines", equations 3-11.
"""

import numpy as np

from cablesim.numerics.hyperbolic import inverse_sinhc_excess
from cablesim.physics.catenary import Catenary
from cablesim.solver import Solution
from cablesim.solvers import _hanging_line
from cablesim.solvers._hanging_line import HangingLine as Parameters
from cablesim.solvers._hanging_line import Options
from cablesim.status import Status

OUTPUTS = (*_hanging_line.OUTPUTS, "stretched_length")
SECONDS_PER_SCENARIO = 1e-7


def solve(p: Parameters, options: Options) -> Solution:
    excess = p.excess
    feasible = excess > 0.0
    if not feasible.all():
        # An infeasible line gets the numbers of some feasible one: NaN is slow, and its status says what it is worth.
        excess = np.where(feasible, excess, p.span * p.span)
    level_length = np.sqrt(p.span * p.span + excess)
    ratio_excess = excess / (p.span * (level_length + p.span))
    half_angle = inverse_sinhc_excess(ratio_excess)
    curve = Catenary(
        options.nodes, p.span, p.weight_per_length, p.rise, p.length, half_angle, ratio_excess=ratio_excess
    )
    return Solution(np.where(feasible, Status.ok, Status.infeasible).astype(np.int8), curve)
