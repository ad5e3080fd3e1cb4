"""What the methods for a composite line share: its parameters, its outputs, and how statuses follow."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cablesim.numerics import Array
from cablesim.parameters import Batch, option, parameter
from cablesim.physics.composite import CompositeLine
from cablesim.solver import Solution
from cablesim.solvers._composite_solve import solve_for_distance, solve_for_tension
from cablesim.status import Status


@dataclass(frozen=True)
class Sections(Batch):
    """A line of sections, from A to B."""

    section_length: Array = parameter(listed=True, above=0.0, typical=(1.0, 1e3))
    section_weight: Array = parameter(listed=True, above=0.0, typical=(0.1, 1e4))


@dataclass(frozen=True)
class PulledLine(Sections):
    """One whose horizontal tension is given."""

    rise: Array = parameter(default=0.0, typical=(-3e2, 3e2))
    horizontal_tension: Array = parameter(above=0.0, typical=(1e3, 1e6))


@dataclass(frozen=True)
class TowLine(PulledLine):
    """One whose horizontal tension or horizontal distance is given."""

    horizontal_distance: Array = parameter(above=0.0, typical=(1.0, 3e3))
    PROBLEMS: ClassVar = (("horizontal_tension",), ("horizontal_distance",))


@dataclass(frozen=True)
class Options:
    """Numerical options: none of them changes a scalar output."""

    nodes: int = option(101, at_least=2, at_most=100_000, meaning="nodes of the profile, at equal steps of length")


OUTPUTS = (
    "horizontal_tension",
    "horizontal_distance",
    "tension_A",
    "tension_B",
    "max_tension",
    "lowest_point",
    "vertex_s",
    "vertex_section",
    "closing_error",
    "joint_tension",
    "joint_position",
    "profile",
    "profile_tension",
    "profile_section",
)


def solve_exactly(p: TowLine, weights: Array, options: Options) -> Solution:
    """Solve the line as if its sections had these weights per length."""
    if p.horizontal_tension is not None:
        tension, distance = p.horizontal_tension, None
        found = solve_for_tension(p.section_length, weights, p.sections, p.rise, tension)
    else:
        distance = p.horizontal_distance
        tension, *found = solve_for_distance(p.section_length, weights, p.sections, p.rise, distance)
    vertical, feasible, converged, evaluations = found
    line = CompositeLine(options.nodes, p.section_length, weights, p.sections, tension, vertical, p.rise, distance)
    status = np.select([~feasible, ~converged], [Status.infeasible, Status.not_converged], Status.ok)
    return Solution(status.astype(np.int8), line, evaluations)


def hang_from_vertex(p: Sections, tension: Array, rise: Array, vertical_A: Array, options: Options) -> CompositeLine:
    """Arcs of catenaries from a given vertical tension at A, wherever they end; `rise` is where they should."""
    hung = np.cumsum(p.section_weight * p.section_length, axis=1)
    vertical = vertical_A[:, None] + np.column_stack([np.zeros_like(vertical_A), hung])
    return CompositeLine(options.nodes, p.section_length, p.section_weight, p.sections, tension, vertical, rise)


def over_sections(values: Array) -> Array:
    """The sum over the sections of every line, in their order, whatever the longest line of the batch."""
    return np.nancumsum(values, axis=1)[:, -1]
