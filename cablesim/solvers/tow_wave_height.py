"""Height of the waves in which towing is safe: what the tow line can give before it is pulled to half its strength.

    h = Delta_e + Delta_w,  Delta_e = (T' - T) L / (epsilon d^2),  Delta_w = A'B' - AB                     (M9)

T is the pull at the hook in calm water and T' half the breaking strength, both taken as horizontal tensions; L is the
length of the wire, which alone stretches, and d its diameter. The distances AB at T and A'B' at T' are given, as the
handbook does; or the sections of the line are, the first of them the wire, and both distances are computed from their
lengths and weights, exactly and between ends at one level.

Infeasible where half the breaking strength is no more than the pull, or where the given distance is less in the jerk
than in calm water. The handbook's modulus of steel wire is 36 kN/mm^2 per mm^2 of diameter squared.

Reference: handbook on towing (in Russian), section IV; docs/models.md, M9.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from cablesim.numerics import Array
from cablesim.parameters import Batch, parameter
from cablesim.physics.composite import CompositeLine
from cablesim.solver import Solution
from cablesim.solvers._composite_solve import solve_for_tension
from cablesim.status import Status

OUTPUTS = ("elastic_elongation", "weight_elongation", "wave_height", "distance_calm", "distance_jerk")
SECONDS_PER_SCENARIO = 4e-7
COMPILED = True


@dataclass(frozen=True)
class Parameters(Batch):
    hook_pull: Array = parameter(above=0.0, typical=(2e4, 3e5))
    breaking_strength: Array = parameter(above=0.0, typical=(4e5, 1.2e6))
    line_length: Array = parameter(above=0.0, typical=(3e2, 9e2))
    diameter: Array = parameter(above=0.0, typical=(0.03, 0.06))
    wire_modulus: Array = parameter(above=0.0, default=3.6e10, typical=(2e10, 6e10))
    distance_calm: Array = parameter(above=0.0, typical=(3e2, 9e2))
    distance_jerk: Array = parameter(above=0.0, typical=(3e2, 9e2))
    section_length: Array = parameter(listed=True, above=0.0, typical=(1e1, 5e2))
    section_weight: Array = parameter(listed=True, above=0.0, typical=(5e1, 1e3))
    PROBLEMS: ClassVar = (("line_length", "distance_calm", "distance_jerk"), ("section_length", "section_weight"))


@dataclass(frozen=True)
class Answer:
    """What follows from the two distances."""

    p: Parameters
    distance_calm: Array
    distance_jerk: Array

    @cached_property
    def elastic_elongation(self) -> Array:
        p = self.p
        wire = p.section_length[:, 0] if p.line_length is None else p.line_length
        return (0.5 * p.breaking_strength - p.hook_pull) * wire / (p.wire_modulus * p.diameter * p.diameter)

    @cached_property
    def weight_elongation(self) -> Array:
        return self.distance_jerk - self.distance_calm

    @property
    def wave_height(self) -> Array:
        return self.elastic_elongation + self.weight_elongation


def solve(p: Parameters, options: object) -> Solution:
    feasible = 0.5 * p.breaking_strength > p.hook_pull
    found = np.ones_like(feasible)
    if p.distance_calm is not None:
        answer = Answer(p, p.distance_calm, p.distance_jerk)
        feasible &= p.distance_jerk >= p.distance_calm
    else:
        calm, calm_found = _distance(p, p.hook_pull)
        jerk, jerk_found = _distance(p, 0.5 * p.breaking_strength)
        answer, found = Answer(p, calm, jerk), calm_found & jerk_found
    status = np.select([~feasible, ~found], [Status.infeasible, Status.not_converged], Status.ok)
    return Solution(status.astype(np.int8), answer)


def _distance(p: Parameters, tension: Array) -> tuple[Array, np.ndarray]:
    """Between the ends of the line, at one level, under a horizontal tension; and whether it was found."""
    level = np.zeros_like(tension)
    vertical, _, found, _ = solve_for_tension(p.section_length, p.section_weight, p.sections, level, tension)
    line = CompositeLine(2, p.section_length, p.section_weight, p.sections, tension, vertical, level)
    return line.horizontal_distance, found
