"""Parabolic approximation of a line between level supports.

    L = l + 8 f^2 / 3l,  f = sqrt(6 l (L - l)) / 4,  y = 4 f x^2 / l^2
    H = w l^2 / 8f,      T_max = (w l / 2) sqrt(1 + l^2 / 16 f^2)                              (M4)

The weight is spread along the span instead of along the line: good for small sag, 1 % off in tension at L/l = 1.03 and
11 % at 1.2 (scene `formula_error`).

Reference: "Comparison of experimental and theoretical catenary lines", equations 14-18.
"""

from cablesim.physics.level_span import parabolic
from cablesim.solver import Solution
from cablesim.solvers._hanging_line import OUTPUTS, Options, solve_level
from cablesim.solvers._hanging_line import LevelLine as Parameters

__all__ = ["OUTPUTS", "SECONDS_PER_SCENARIO", "Options", "Parameters", "solve"]

SECONDS_PER_SCENARIO = 3e-8


def solve(p: Parameters, options: Options) -> Solution:
    return solve_level(parabolic, p, options)
