"""Composite tow line by MoorPy: a `Subsystem` of sections whose joints it brings into balance.

Joints start on the chord, two nodes a section, stiffness for negligible stretch and no more, because with more it
converges less often: tensions are off by half of STRETCH. `tolerance` is in metres; 0 is its own choice.

Reference: M. Hall et al., MoorPy, National Renewable Energy Laboratory (github.com/NREL/MoorPy).
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from cablesim.parameters import option
from cablesim.peers._each import Answer, Line, solve_each
from cablesim.solver import Solution
from cablesim.solvers._composite_line import TowLine as Parameters

__all__ = ["OUTPUTS", "REQUIRES", "Options", "Parameters", "solve"]

REQUIRES = "moorpy"
OUTPUTS = ("tension_A", "tension_B", "max_tension")
SECONDS_PER_SCENARIO = 5e-2
GRAVITY = 9.81
# Lines hang this deep, clear of the surface, and the seabed is out of reach.
DEPTH, SEABED = 3000.0, 10_000.0
# A line stretches by this share of what it is longer than its chord; its tensions are then off by half of it.
STRETCH = 1e-3


@dataclass(frozen=True)
class Options:
    """Numerical options."""

    tolerance: float = option(0.0, at_least=0.0, meaning="by how much joints may miss their balance, in m; 0: its own")


def solve(p: Parameters, options: Options) -> Solution:
    return solve_each(p, OUTPUTS, lambda line: end_tensions(line, options.tolerance), REQUIRES)


def end_tensions(line: Line, tolerance: float) -> Answer:
    if "horizontal_distance" not in line:
        return None
    system = subsystem(line)
    system.staticSolve(tol=tolerance)
    return {"tension_A": system.TA, "tension_B": system.TB, "max_tension": max(system.TA, system.TB)}


def subsystem(line: Line) -> Any:
    """The line as MoorPy has it."""
    from moorpy.subsystem import Subsystem

    lengths, rise, distance = line["section_length"], line["rise"], line["horizontal_distance"]
    end_A, end_B = np.array([-distance, 0.0, -DEPTH]), np.array([0.0, 0.0, rise - DEPTH])
    stiffness = axial_stiffness(line)
    types = [
        {"name": f"section {k}", "m": weight / GRAVITY, "d_vol": 0.0, "EA": stiffness}
        for k, weight in enumerate(line["section_weight"])
    ]
    # An empty table of line properties spares it the reading of its own.
    system = Subsystem(depth=SEABED, g=GRAVITY, span=distance, z_fair=rise - DEPTH, lineProps={})
    system.makeGeneric(list(lengths), types, suspended=1, nSegs=1)
    system.setEndPosition(end_A, 0)
    system.setEndPosition(end_B, 1)
    for point, share in zip(system.pointList[1:-1], np.cumsum(lengths) / np.sum(lengths), strict=False):
        point.setPosition(end_A + share * (end_B - end_A))
    return system


def axial_stiffness(line: Line) -> float:
    """Enough for negligible stretch at about the tension of a parabola."""
    length, weight = np.sum(line["section_length"]), np.dot(line["section_length"], line["section_weight"])
    slack = 1.0 - math.hypot(line["horizontal_distance"], line["rise"]) / length
    return weight * (1.0 / math.sqrt(24.0 * slack) + 0.5) / (STRETCH * slack)
