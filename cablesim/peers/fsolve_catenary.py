"""Elastic catenary by SciPy: both equations in plain floats, solved by `fsolve`.

What an engineer would write: the equations M6 in the logarithm of the horizontal tension and the vertical tension at A,
started from the parabola, until `xtol`.

Reference: H. M. Irvine, Cable Structures, MIT Press 1981, section 2.2; MINPACK's hybrd by way of scipy.optimize.
"""

import math
from dataclasses import dataclass

from cablesim.parameters import option
from cablesim.peers._each import Answer, Line, solve_each
from cablesim.solver import Solution
from cablesim.solvers.catenary_elastic import Parameters

__all__ = ["OUTPUTS", "Options", "Parameters", "solve"]

OUTPUTS = ("horizontal_tension", "tension_A", "tension_B", "max_tension")
SECONDS_PER_SCENARIO = 4e-5
# Slack over length that the start is computed from, for lines that are shorter than their chord.
LEAST_SLACK = 1e-6


@dataclass(frozen=True)
class Options:
    """Numerical options."""

    xtol: float = option(1.49012e-8, at_least=0.0, meaning="relative change of the unknowns at which it stops")


def solve(p: Parameters, options: Options) -> Solution:
    return solve_each(p, OUTPUTS, lambda line: end_tensions(line, options.xtol))


def end_tensions(line: Line, xtol: float) -> Answer:
    from scipy.optimize import fsolve

    span, rise, stiffness = line["span"], line["rise"], line["axial_stiffness"]
    length = line["line_length"] if "line_length" in line else line["length_ratio"] * span
    weight = line["weight_per_length"] * length

    def gaps(state: tuple[float, float]) -> tuple[float, float]:
        horizontal, lower = weight * math.exp(state[0]), weight * state[1]
        upper = lower + weight
        arc = length * horizontal / weight
        x = arc * (math.asinh(upper / horizontal) - math.asinh(lower / horizontal)) + horizontal * length / stiffness
        z = arc * (math.hypot(1.0, upper / horizontal) - math.hypot(1.0, lower / horizontal))
        z += 0.5 * (upper * upper - lower * lower) / (weight / length * stiffness)
        return (x - span) / length, (z - rise) / length

    slack = max(1.0 - math.hypot(span, rise) / length, LEAST_SLACK)
    start = (-0.5 * math.log(24.0 * slack), 0.5 * (rise / length / math.sqrt(6.0 * slack) - 1.0))
    (log_tension, lift), _, flag, _ = fsolve(gaps, start, full_output=True, xtol=xtol)
    if flag != 1:
        return None
    horizontal, lower = weight * math.exp(log_tension), weight * lift
    tension_A, tension_B = math.hypot(horizontal, lower), math.hypot(horizontal, lower + weight)
    return {
        "horizontal_tension": horizontal,
        "tension_A": tension_A,
        "tension_B": tension_B,
        "max_tension": max(tension_A, tension_B),
    }
