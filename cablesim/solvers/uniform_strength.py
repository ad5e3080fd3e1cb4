"""Uniform line that is just strong enough: the rival of the line of equal strength over the same span.

    T_max / w = a cosh(x / a) = k at the upper support,  k = strength / weight per volume

A catenary between the same supports, under the same horizontal force, of the one cross-section whose largest stress is
the permitted one. Of two such lines the lighter is taken. There is none where the span is too wide: level, above
2 / sinh(1.19968) = 1.32549 k, where x = 1.19968 solves x tanh(x) = 1; with a rise, sooner (`infeasible`). One equation
in one unknown (`cablesim.physics.uniform_strength`, E2), solved by bracketed Newton. Towards the widest span the two
lines meet: at it only half of the digits are known.

`area_ratio_A` and `area_ratio_B`, both k / a, are over the cross-section that carries the horizontal force alone.

Reference: "Comparison of experimental and theoretical catenary lines", equations 3-11, with the stress of the line of
equal resistance in Introduction to the mechanics of flexible threads (in Russian), pp. 98-100.
"""

import numpy as np

from cablesim.physics.uniform_strength import UniformStrengthLine, thin_half_angle
from cablesim.solver import Solution
from cablesim.solvers.equal_strength import Options, Parameters
from cablesim.status import Status

__all__ = ["OUTPUTS", "Options", "Parameters", "solve"]

OUTPUTS = (
    "drop",
    "line_length",
    "area_ratio_A",
    "area_ratio_B",
    "saved_weight_fraction",
    "weight_over_force",
    "vertex_x",
    "profile",
)
SECONDS_PER_SCENARIO = 4e-6
ITERATES = True


def solve(p: Parameters, options: Options) -> Solution:
    roots, feasible = thin_half_angle(p.strength_length, p.span, p.rise)
    line = UniformStrengthLine(options.nodes, p.strength_length, p.span, p.rise, roots.x)
    found = np.where(roots.converged, Status.ok, Status.not_converged)
    return Solution(np.where(feasible, found, Status.infeasible).astype(np.int8), line, roots.iterations)
