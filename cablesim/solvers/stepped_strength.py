"""Line of equal strength as it can be made: of uniform pieces, under any horizontal force.

Of `sections` pieces of equal length, each with the weight of the piece of the design that it replaces: a composite line
(M8), the ends of which keep their rise. The stress is the tension over the cross-section of the design at the same
point, so all answers converge to those of `equal_strength_loaded`, with the square of the length of a piece. One
monotone equation, by bracketed Newton. The largest stress is searched for within every piece, where it exceeds that of
the joints by up to an eighth of the square of the piece over k.

Reference: Introduction to the mechanics of flexible threads (in Russian), pp. 98-100 (the chain of a deep-water
anchor), with the composite line of the handbook on towing (in Russian), section III.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cablesim.numerics import Array
from cablesim.parameters import option
from cablesim.solver import Solution
from cablesim.solvers import equal_strength
from cablesim.solvers._built_line import OUTPUTS, HungLine, built_line, fate
from cablesim.solvers._built_line import LoadedLine as Parameters
from cablesim.solvers._built_march import DISTANCE, vertical_tension
from cablesim.solvers._stepped_march import largest_stresses, stepped_positions, stepped_sums

__all__ = ["OUTPUTS", "Options", "Parameters", "solve"]

COMPILED = True
ITERATES = True


@dataclass(frozen=True)
class Options(equal_strength.Options):
    sections: int = option(10, at_least=1, at_most=1_000_000, meaning="uniform pieces that the line is made of")


@dataclass(frozen=True)
class SteppedLine(HungLine):
    """With the weight of the design at the joints, and spread evenly between them."""

    sections: int

    def vertical_at(self, from_first: Array) -> Array:
        piece = np.minimum(np.floor(from_first * self.sections), self.sections - 1)
        part = from_first * self.sections - piece
        before, after = (self.line.weights(self.line.places(joint / self.sections)) for joint in (piece, piece + 1.0))
        return self.vertical[:, None] + (1.0 - part) * before + part * after

    def positions(self, from_first: Array) -> tuple[Array, Array]:
        return stepped_positions(from_first, self.sections, *self._state)

    @cached_property
    def horizontal_distance(self) -> Array:
        return self.line.design.strength_length * stepped_sums(self.sections, *self._state)[:, DISTANCE]

    @cached_property
    def max_stress_ratio(self) -> Array:
        return largest_stresses(self.sections, *self._state)

    @property
    def _state(self) -> tuple[Array, Array, Array, Array, Array]:
        line = self.line
        return line.low, line.high, line.thinnest, line.force_ratio, self.vertical


def seconds_per_scenario(options: Options) -> float:
    return 6e-6 + 1.5e-6 * options.sections


def solve(p: Parameters, options: Options) -> Solution:
    line = built_line(p)

    def sums(vertical: Array, which: np.ndarray) -> Array:
        columns = (line.low[which], line.high[which], line.thinnest[which], line.force_ratio[which])
        return stepped_sums(options.sections, *columns, vertical)

    vertical, roots = vertical_tension(line, sums, (line.high - line.low) / options.sections)
    hung = SteppedLine(options.nodes, line, p.arc_fraction, vertical, options.sections)
    return Solution(fate(p, roots), hung, roots.iterations)
