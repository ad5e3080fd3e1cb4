"""Composite line with the vertex of a parabola, its load taken along the chord; the arcs are catenaries all the same.

    V_A = H h / sqrt(L^2 - h^2) - (1/L) integral of W(s) ds,   W(s) the weight between A and s,

which is right for a line pulled straight; the vertex of a level line is then at W(s) = -V_A. From there on the
line is drawn exactly, so that it ends at a wrong height: `closing_error` says by how much. A check by the handbook's
rule (both sags must nearly agree) is a check of that.

Reference: docs/models.md, M8; compare with the handbook on towing (in Russian), section III, where chain is no burden.
"""

import numpy as np

from cablesim.solver import Solution
from cablesim.solvers._composite_line import OUTPUTS, Options, hang_from_vertex, over_sections
from cablesim.solvers._composite_line import PulledLine as Parameters
from cablesim.solvers._composite_solve import rooms, totals
from cablesim.status import Status

__all__ = ["OUTPUTS", "Options", "Parameters", "solve"]

SECONDS_PER_SCENARIO = 2e-7
COMPILED = True


def solve(p: Parameters, options: Options) -> Solution:
    total = over_sections(p.section_length)
    weight = p.section_weight * p.section_length
    before = np.cumsum(weight, axis=1) - weight
    mean = over_sections(p.section_length * (before + 0.5 * weight)) / total
    # A rounded sum of lengths may exceed a rise that the lengths do not.
    above, below = rooms(*totals(p.section_length, p.sections), p.rise)
    feasible = (above > 0.0) & (below > 0.0)
    lean = p.rise / np.sqrt(np.where(feasible, above * below, 1.0))
    line = hang_from_vertex(p, p.horizontal_tension, p.rise, p.horizontal_tension * lean - mean, options)
    return Solution(np.where(feasible, Status.ok, Status.infeasible).astype(np.int8), line)
