"""A wrong formula, kept so that its error can be seen: L = l + 16 f^2 / 3l.

    f = sqrt(3 l (L - l)) / 4,  H = w l^2 / 8f,  T_max = (w l / 2) sqrt(1 + l^2 / 16 f^2)

It circulates in a handbook that the reference corrects; the factor is 8/3, not 16/3. Its sag is 29 % too small however
small the sag is. Do not design with it: use `catenary_exact`.

Reference: "Comparison of experimental and theoretical catenary lines", introduction.
"""

from cablesim.physics.level_span import handbook
from cablesim.solver import Solution
from cablesim.solvers._hanging_line import OUTPUTS, Options, solve_level
from cablesim.solvers._hanging_line import LevelLine as Parameters

__all__ = ["OUTPUTS", "SECONDS_PER_SCENARIO", "Options", "Parameters", "solve"]

SECONDS_PER_SCENARIO = 3e-8


def solve(p: Parameters, options: Options) -> Solution:
    return solve_level(handbook, p, options)
