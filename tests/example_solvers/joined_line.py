"""A line of sections that hangs straight down from B, pulled at A: just enough of a solver to try lists on.

    T_j = T_A + sum of w_i l_i from A to the end of section j,  T_B = T_j of the last section

A line that is shorter than the depth has no solution.

Reference: none; it belongs to the tests.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cablesim.numerics import Array
from cablesim.parameters import Batch, parameter
from cablesim.solver import Solution
from cablesim.status import Status

OUTPUTS = ("tension_B", "line_length", "joint_tension")
SECONDS_PER_SCENARIO = 1e-6


@dataclass(frozen=True)
class Parameters(Batch):
    section_length: Array = parameter(listed=True, above=0.0, typical=(1.0, 1e3))
    section_weight: Array = parameter(listed=True, at_least=0.0, typical=(1.0, 1e4))
    tension_A: Array = parameter(above=0.0, typical=(1.0, 1e6))
    depth: Array = parameter(at_least=0.0, typical=(0.0, 100.0), default=0.0)


@dataclass(frozen=True)
class Hanging:
    parameters: Parameters

    @cached_property
    def joint_tension(self) -> Array:
        p = self.parameters
        return p.tension_A[:, None] + np.cumsum(p.section_weight * p.section_length, axis=1)

    @cached_property
    def tension_B(self) -> Array:
        return np.fmax.reduce(self.joint_tension, axis=1)

    @cached_property
    def line_length(self) -> Array:
        return np.nansum(self.parameters.section_length, axis=1)


def solve(p: Parameters, options: object) -> Solution:
    answer = Hanging(p)
    status = np.where(answer.line_length >= p.depth, Status.ok, Status.infeasible).astype(np.int8)
    return Solution(status, answer)
