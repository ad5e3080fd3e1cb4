"""Elastic catenary by MoorPy: its function `catenary`, one call a line.

It iterates the two equations of M6 until the ends meet within `tolerance` metres, which is absolute: a short or a taut
line with the default of 1e-6 m may be off by far more than a part in a million. The seabed is put out of reach.

Reference: M. Hall et al., MoorPy, National Renewable Energy Laboratory (github.com/NREL/MoorPy).
"""

import math
from dataclasses import dataclass

from cablesim.parameters import option
from cablesim.peers._each import Answer, Line, solve_each
from cablesim.solver import Solution
from cablesim.solvers.catenary_elastic import Parameters

__all__ = ["OUTPUTS", "REQUIRES", "Options", "Parameters", "solve"]

REQUIRES = "moorpy"
OUTPUTS = ("horizontal_tension", "tension_A", "tension_B", "max_tension")
SECONDS_PER_SCENARIO = 5e-4
# Deeper than any line hangs, in lengths of line.
SEABED = 10.0


@dataclass(frozen=True)
class Options:
    """Numerical options."""

    tolerance: float = option(1e-6, at_least=0.0, meaning="by how much the ends may miss, in m")


def solve(p: Parameters, options: Options) -> Solution:
    return solve_each(p, OUTPUTS, lambda line: end_tensions(line, options.tolerance), REQUIRES)


def end_tensions(line: Line, tolerance: float) -> Answer:
    from moorpy.Catenary import catenary

    length = line["line_length"] if "line_length" in line else line["length_ratio"] * line["span"]
    fx_A, fz_A, fx_B, fz_B, _ = catenary(
        line["span"],
        line["rise"],
        length,
        line["axial_stiffness"],
        line["weight_per_length"],
        CB=-SEABED * length,
        Tol=tolerance,
    )
    tension_A, tension_B = math.hypot(fx_A, fz_A), math.hypot(fx_B, fz_B)
    return {
        "horizontal_tension": abs(fx_B),
        "tension_A": tension_A,
        "tension_B": tension_B,
        "max_tension": max(tension_A, tension_B),
    }
