"""A weightless line pulled straight: just enough of a solver to try words, vectors and problem kinds on.

    position_B = L t,  t = F_A / |F_A|,  F_B = F_A times 1, 2 or 3 by the friction law

Reference: none; it belongs to the tests.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from cablesim.numerics import Array
from cablesim.parameters import Batch, option, parameter
from cablesim.solver import Solution
from cablesim.status import Status

OUTPUTS = ("position_B", "force_A", "force_B", "tension_A", "line_length", "steps", "profile")
SECONDS_PER_SCENARIO = 1e-6
COMPILED = True
CALLS: list[int] = []


@dataclass(frozen=True)
class Parameters(Batch):
    PROBLEMS: ClassVar = (("force_A", "line_length"), ("force_A", "depth"), ("position_B", "line_length"))

    line_length: Array = parameter(above=0.0, typical=(1.0, 1e2))
    friction_law: Array = parameter(words=("constant", "cosine_squared", "zero"), default="constant")
    lay_angle: Array = parameter(at_least=0.0, below=1.5, typical=(0.0, 1.0), default=0.0)
    force_A: Array = parameter(vector=True, typical=(-1e3, 1e3))
    depth: Array = parameter(typical=(-1e2, 1e2))
    position_B: Array = parameter(vector=True, typical=(-10.0, 10.0))


@dataclass(frozen=True)
class Options:
    nodes: int = option(3, at_least=2, at_most=1000, meaning="nodes of the profile")
    factor: float = option(1.0, meaning="what force_B is multiplied by")


@dataclass(frozen=True)
class Straight:
    force_A: Array
    line_length: Array
    force_B: Array
    nodes: int

    @cached_property
    def tension_A(self) -> Array:
        return np.linalg.norm(self.force_A, axis=1)

    @cached_property
    def position_B(self) -> Array:
        return self.force_A / self.tension_A[:, None] * self.line_length[:, None]

    @cached_property
    def profile(self) -> Array:
        return np.linspace(0.0, 1.0, self.nodes)[:, None] * self.position_B[:, None, :]

    @property
    def steps(self) -> Array:
        return np.ones(len(self.force_A))


def solve(p: Parameters, options: Options) -> Solution:
    CALLS.append(p.size)
    force = p.force_A if p.force_A is not None else p.position_B
    tension = np.linalg.norm(force, axis=1)
    length = p.line_length if p.line_length is not None else p.depth * tension / force[:, 2]
    force_B = options.factor * force * (1.0 + p.friction_law[:, None])
    status = np.where((tension > 0.0) & (length > 0.0), Status.ok, Status.infeasible).astype(np.int8)
    return Solution(status, Straight(force, length, force_B, options.nodes))
