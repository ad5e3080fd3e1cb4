"""Elastic catenary: a line that obeys Hooke's law, between two supports at any levels, slack or taut.

    x = (H/w) [asinh(V/H) - asinh((V - w L)/H)] + H L / EA
    z = (H/w) [sqrt(1 + (V/H)^2) - sqrt(1 + ((V - w L)/H)^2)] + (V L - w L^2 / 2) / EA        (M6)

with L the unstretched length and V the vertical force at B. Any length is feasible, also shorter than the chord: the
line then stretches. Reduced to one equation in one unknown (`cablesim.physics.catenary`, C1), which has one root and
is solved by bracketed Newton. Linear elasticity; strains are not limited, so check them against the material.

Reference: H. M. Irvine, Cable Structures, MIT Press 1981, section 2.2.
"""

from dataclasses import dataclass

import numpy as np

from cablesim.numerics import Array
from cablesim.parameters import parameter
from cablesim.physics.catenary import Catenary, elastic_half_angle
from cablesim.solver import Solution
from cablesim.solvers import _hanging_line
from cablesim.solvers._hanging_line import HangingLine, Options
from cablesim.status import Status

OUTPUTS = (*_hanging_line.OUTPUTS, "stretched_length")
SECONDS_PER_SCENARIO = 2e-7
ITERATES = True


@dataclass(frozen=True)
class Parameters(HangingLine):
    axial_stiffness: Array = parameter(above=0.0, typical=(1e4, 1e9))


def solve(p: Parameters, options: Options) -> Solution:
    length = p.length
    strain = 0.5 * p.weight_per_length * length / p.axial_stiffness
    roots = elastic_half_angle(p.excess, p.span, p.rise, length, strain)
    curve = Catenary(options.nodes, p.span, p.weight_per_length, p.rise, length, roots.x, strain)
    status = np.where(roots.converged, Status.ok, Status.not_converged).astype(np.int8)
    return Solution(status, curve, roots.iterations)
