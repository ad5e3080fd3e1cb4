"""Composite line: sections of different weight in series, exactly, given the horizontal tension or the distance.

Every section is an arc of its own catenary a_i = H / w_i; horizontal tension is common to all, slopes match at the
joints (M8). Any number of sections, ends at any levels, the vertex in any section, at a joint or outside; section
lengths and weights are lists from end A to end B. Perfectly flexible, inextensible, under its weight alone.

With the horizontal tension given, a line is feasible if it is longer than its rise; with the distance given, if it is
longer than its chord. The solution is unique, and is found for lengths, weights and tensions many orders apart. What
the equations do not fix stays uncertain: lines that are a hair longer than their chord know their tension only as well
as floats know their slack, and a line that hangs as a polygon from a point load hardly feels its distance.

`vertex_s` is the arc length from A at which the line is level. Where it is level nowhere, the end section's own
catenary is continued: `vertex_s` is negative and `vertex_section` 0 before A, beyond the length and one more than the
number of sections past B. A vertex at a joint belongs to the section before it.

Reference: handbook on towing (in Russian), sections III and V; docs/models.md, M8.
"""

from cablesim.solver import Solution
from cablesim.solvers._composite_line import OUTPUTS, Options, solve_exactly
from cablesim.solvers._composite_line import TowLine as Parameters

__all__ = ["OUTPUTS", "Options", "Parameters", "solve"]

SECONDS_PER_SCENARIO = 1e-6
ITERATES = True
COMPILED = True


def solve(p: Parameters, options: Options) -> Solution:
    return solve_exactly(p, p.section_weight, options)
