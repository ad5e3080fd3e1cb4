"""Line between two ends in a stream by MoorPy: drag as a uniform load, corrected until it is that of the found shape.

MoorPy replaces the drag along a line by a uniform load: its tensions are those of another problem, a percent or two
off. The line is made short, and the tensions long again, because in a current it puts its seabed 100 m below the lower
end. Its tangential coefficient refers to pi times the diameter, and its friction goes with the square of the cosine.

Reference: M. Hall et al., MoorPy, National Renewable Energy Laboratory (github.com/NREL/MoorPy).
"""

import math
from dataclasses import dataclass

import numpy as np

from cablesim.numerics import Array
from cablesim.parameters import option
from cablesim.peers._each import Answer, Line, solve_each
from cablesim.peers.ivp_line import typical_load
from cablesim.solver import Solution
from cablesim.solvers._stream_line import LineBetweenEnds as Parameters

__all__ = ["OUTPUTS", "REQUIRES", "Options", "Parameters", "solve"]

REQUIRES = "moorpy"
OUTPUTS = ("tension_A", "tension_B", "max_tension")
SECONDS_PER_SCENARIO = 2e-2
GRAVITY = 9.81
# Lines hang this deep, clear of the surface, and the seabed is out of reach; length that MoorPy is given.
DEPTH, SEABED, SHORT = 3000.0, 10_000.0, 90.0
# A stiff line stretches by this at its largest tension.
STRAIN = 5e-4
MOST_CORRECTIONS, CORRECTED = 100, 1e-6


@dataclass(frozen=True)
class Options:
    """Numerical options."""

    nodes: int = option(51, at_least=2, at_most=10_000, meaning="nodes at which drag is evaluated")
    tolerance: float = option(1e-8, at_least=0.0, meaning="by how much the ends may miss, in m")


def solve(p: Parameters, options: Options) -> Solution:
    def answer(line: Line) -> Answer:
        tensions = end_tensions(line, options)
        return {"tension_A": tensions[0], "tension_B": tensions[1], "max_tension": tensions.max()}

    return solve_each(p, OUTPUTS, answer, REQUIRES)


def end_tensions(line: Line, options: Options) -> Array:
    """At A and B; NaN where the corrections do not end."""
    import moorpy

    shorter = SHORT / line["line_length"]
    end = shorter * line["position_B"]
    system = moorpy.System(depth=SEABED, rho=line["fluid_density"], g=GRAVITY)
    system.currentMod, system.current = 1, np.array([line["stream_speed"], 0.0, 0.0])
    system.lineTypes["line"] = {
        "name": "line",
        "d_vol": line["diameter"],
        "m": mass_per_length(line),
        "EA": shorter * axial_stiffness(line),
        "w": line["weight_per_length"],
        "Cd": line["normal_drag_coefficient"],
        "CdAx": line["tangential_drag_coefficient"] / math.pi,
    }
    start = np.array([0.0, 0.0, -DEPTH])
    system.addPoint(1, start)
    system.addPoint(1, start + end)
    system.addLine(SHORT, "line", nSegs=options.nodes - 1, pointA=1, pointB=2)
    between = system.lineList[0]
    between.setEndPosition(start, 0)
    between.setEndPosition(start + end, 1)
    before = np.zeros(2)
    for _ in range(MOST_CORRECTIONS):
        between.staticSolve(tol=options.tolerance)
        found = np.array([between.TA, between.TB])
        if np.all(np.abs(found - before) < CORRECTED * found):
            return found / shorter
        before = found
    return np.full(2, np.nan)


def mass_per_length(line: Line) -> float:
    """Mass whose weight in water is the line's."""
    displaced = line["fluid_density"] * 0.25 * math.pi * line["diameter"] ** 2
    return line["weight_per_length"] / GRAVITY + displaced


def axial_stiffness(line: Line) -> float:
    """A stiffness that leaves little stretch."""
    return typical_load(line) * line["line_length"] / STRAIN
