"""What the solvers of a line hanging between two supports share: its parameters and how exactly its length is known."""

from dataclasses import dataclass

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.exact import excess_of_squares, two_product
from cablesim.parameters import Batch, option, parameter
from cablesim.physics.level_span import Formula
from cablesim.solver import Solution
from cablesim.status import Status


@dataclass(frozen=True)
class LevelLine(Batch):
    """A line between supports at one level."""

    span: Array = parameter(above=0.0, typical=(1.0, 1e3))
    weight_per_length: Array = parameter(above=0.0, typical=(0.1, 1e4))
    line_length: Array = parameter(above=0.0, typical=(1.0, 3e3))
    length_ratio: Array = parameter(above=0.0, typical=(0.9, 3.0), instead_of="line_length")

    @property
    def length(self) -> Array:
        """Line length, given or from the length ratio."""
        return self._length_and_tail[0]

    @property
    def excess(self) -> Array:
        """length**2 - span**2, exact to the last digits."""
        return excess_of_squares(*self._length_and_tail, self.span, np.zeros_like(self.span))

    @property
    def _length_and_tail(self) -> tuple[Array, Array | None]:
        """Length as a float and the part that the float cannot hold: a ratio of 1 + 1e-12 means exactly that."""
        if self.length_ratio is not None:
            return two_product(self.length_ratio, self.span)
        return self.line_length, None


@dataclass(frozen=True)
class HangingLine(LevelLine):
    """A line between supports at any two levels."""

    rise: Array = parameter(default=0.0, typical=(-3e2, 3e2))

    @property
    def excess(self) -> Array:
        """length**2 - span**2 - rise**2, exact to the last digits; not positive for a line no longer than its chord."""
        return excess_of_squares(*self._length_and_tail, self.span, self.rise)


OUTPUTS = (
    "catenary_parameter",
    "horizontal_tension",
    "tension_A",
    "tension_B",
    "max_tension",
    "sag",
    "drop",
    "vertex_x",
    "profile",
    "profile_tension",
)


@dataclass(frozen=True)
class Options:
    """Numerical options of a hanging line: none of them changes a scalar output."""

    nodes: int = option(101, at_least=2, at_most=100_000, meaning="nodes of the profile")


def solve_level(formula: Formula, p: LevelLine, options: Options) -> Solution:
    """Apply an approximate formula; a line no longer than its span has no such shape."""
    excess = p.excess
    feasible = excess > 0.0
    slack = np.where(feasible, excess, np.nan) / (p.length + p.span)
    status = np.where(feasible, Status.ok, Status.infeasible).astype(np.int8)
    return Solution(status, formula(options.nodes, p.span, p.weight_per_length, slack))
