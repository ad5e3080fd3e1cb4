"""Second-order series of the catenary for level supports.

    L = l + l^3 / 24a^2 + l^5 / 1920a^4,  y = x^2 / 2a + x^4 / 24a^3,  T_max = w (a + f)       (M4, next order)

One more term than the parabola in both series (the paper stops at the first): solved for a in closed form, with the
vertical force and the tension of the exact line, w (a + f).

Reference: "Comparison of experimental and theoretical catenary lines", equations 11-13.
"""

from cablesim.physics.level_span import series
from cablesim.solver import Solution
from cablesim.solvers._hanging_line import OUTPUTS, Options, solve_level
from cablesim.solvers._hanging_line import LevelLine as Parameters

__all__ = ["OUTPUTS", "SECONDS_PER_SCENARIO", "Options", "Parameters", "solve"]

SECONDS_PER_SCENARIO = 3e-8


def solve(p: Parameters, options: Options) -> Solution:
    return solve_level(series, p, options)
