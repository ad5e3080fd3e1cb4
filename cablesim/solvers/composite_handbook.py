"""Tow line of wire and chain as the handbook solves it: a corrected parabolic vertex, then arcs of catenaries.

Between two ships at one level, wire at A and chain at B. The wire from the joint to the vertex is

    l_x = (l_m^2 - (1 - 0.87 alpha) (w_c / w_m) l_c^2) / (2 (l_m + l_c)),   alpha = exp(-a_c / l_c),   a_c = H / w_c,

alpha being tabulated in the handbook and read as zero where a_c / l_c >= 4. The handbook's line for l_x is lost in the
copy that we have: this one gives both of its printed vertices (160.5 m; 56.46 m with alpha = 0.0721, as its table has
it for the printed parameters, where the example prints 0.0734).
Distance, sags and tensions follow from the vertex exactly, but the two ends come out at different levels:
`closing_error` is the difference of the two sags, which the handbook wants small. Out of domain unless there are just
two sections.

Reference: handbook on towing (in Russian), sections III and V, and the table of its correction coefficient alpha.
"""

from dataclasses import dataclass

import numpy as np

from cablesim.numerics import Array
from cablesim.parameters import parameter
from cablesim.solver import Solution
from cablesim.solvers._composite_line import OUTPUTS, Options, Sections, hang_from_vertex
from cablesim.status import Status

__all__ = ["OUTPUTS", "Options", "Parameters", "solve"]

SECONDS_PER_SCENARIO = 2e-7
COMPILED = True
LARGEST_RATIO = 4.0
# The share of its weight that steel keeps in water, by the handbook; here it was found from the printed vertices.
CORRECTED_SHARE = 0.87


@dataclass(frozen=True)
class Parameters(Sections):
    horizontal_tension: Array = parameter(above=0.0, typical=(1e3, 1e6))


def solve(p: Parameters, options: Options) -> Solution:
    wire, chain = _first_two(p.section_length)
    wire_weight, chain_weight = _first_two(p.section_weight)
    ratio = p.horizontal_tension / chain_weight / chain
    alpha = np.where(ratio < LARGEST_RATIO, np.exp(-ratio), 0.0)
    pulled_down = (1.0 - CORRECTED_SHARE * alpha) * (chain_weight / wire_weight) * chain * chain
    from_joint = (wire * wire - pulled_down) / (2.0 * (wire + chain))
    level = np.zeros_like(wire)
    line = hang_from_vertex(p, p.horizontal_tension, level, -wire_weight * (wire - from_joint), options)
    return Solution(np.where(p.sections == 2, Status.ok, Status.out_of_domain).astype(np.int8), line)


def _first_two(lists: Array) -> Array:
    """The first two sections of every line, NaN where there is only one; shape (2, scenario)."""
    return np.pad(lists, ((0, 0), (0, 1)), constant_values=np.nan)[:, :2].T
