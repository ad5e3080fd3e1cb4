"""Composite line as one catenary: every section given the mean weight per length of the line.

The right answer for a line whose sections all weigh the same per length. With chain at one end, the vertex lies too far
from it, and the sag is far off, too great where the chain is short; `composite_line` is exact.

Reference: the approximation that a composite line is usually first estimated with; docs/models.md, M8.
"""

import numpy as np

from cablesim.solver import Solution
from cablesim.solvers._composite_line import OUTPUTS, Options, over_sections, solve_exactly
from cablesim.solvers._composite_line import TowLine as Parameters

__all__ = ["OUTPUTS", "Options", "Parameters", "solve"]

SECONDS_PER_SCENARIO = 4e-7
ITERATES = True
COMPILED = True


def solve(p: Parameters, options: Options) -> Solution:
    mean = over_sections(p.section_weight * p.section_length) / over_sections(p.section_length)
    return solve_exactly(p, np.where(np.isnan(p.section_length), np.nan, mean[:, None]), options)
