"""Lines built for equal strength as they hang under another force, once more: other panels, another search.

A line is seen so that its second end is the higher one; places are counted from its thinnest place, tensions are over
the horizontal force of the design, lengths over k.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize.elementwise import find_root

from cablesim.hunt._case import Case
from cablesim.hunt._precise import longer
from cablesim.hunt._strength_reference import design_of
from cablesim.numerics import Array

# Panels of equal steps in u, and of equal steps in asinh(V / r): no singularity of the integrands is nearer to a panel
# than 1.4 of its halves, where both steps are at most one.
EVEN, STEEP = 48, 64
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(12)


@dataclass(frozen=True)
class Hung:
    """Lines and their loads, and with `vertical` how they hang: the vertical tension at the thinnest place."""

    k: Array
    rise: Array
    slack: Array
    low: Array
    high: Array
    thinnest: Array
    force: Array
    vertical: Array | None = None

    @property
    def length(self) -> Array:
        return self.high - self.low

    def rows(self, which: np.ndarray) -> "Hung":
        """Some of the lines."""
        return Hung(**{name: values[which] for name, values in self.__dict__.items() if values is not None})

    def weight(self, place: Array) -> Array:
        """From the thinnest place; (scenario, place)."""
        return 2.0 * np.cosh(self.thinnest[:, None] + 0.5 * place) * np.sinh(0.5 * place)

    def steepest(self) -> Array:
        """V / r of a straight line to the second end that is as long."""
        return self.rise / np.sqrt(self.slack * (self.length + self.rise))


# Of lines, with vertical tensions: their length less their rise, and their horizontal distance.
Sums = Callable[[Hung, Array], tuple[Array, Array]]


def hung_line(case: Case) -> Hung:
    """The lines of a case."""
    design = design_of(case)
    rise, force = np.abs(design.rise), longer(case.parameters["force_ratio"])
    first = design.upper_angle - design.length
    low = np.minimum(first, 0.0)
    return Hung(
        *(np.asarray(v, dtype=float) for v in (design.k, rise, design.slack, low)),
        *(np.asarray(v, dtype=float) for v in (low + design.length, np.maximum(first, 0.0), force)),
    )


def vertical_tension(line: Hung, sums: Sums) -> Array:
    """At the thinnest place, so that the line is as much longer than its rise as it was built; NaN where not found.

    If all of the line is as steep as a straight one, or less, it ends no higher than it must, and the other way round.
    """

    def too_steep(steepness: Array, row: Array) -> Array:
        some = line.rows(row.astype(int))
        return some.slack - sums(some, some.force * np.sinh(steepness))[0]

    ends = line.weight(np.stack([line.high, line.low], axis=1)) / line.force[:, None]
    bracket = [np.arcsinh(line.steepest() - ends[:, end]) for end in (0, 1)]
    margin = [1e-9 * (1.0 + np.abs(angle)) for angle in bracket]
    found = find_root(
        too_steep, (bracket[0] - margin[0], bracket[1] + margin[1]), args=(np.arange(line.low.size, dtype=float),)
    )
    return np.where(found.success, line.force * np.sinh(found.x), np.nan)


def smooth_sums(line: Hung, vertical: Array) -> tuple[Array, Array]:
    """Integrals of 1 - V / T and of r / T over panels."""
    edges = _edges(line, vertical)
    half = 0.5 * np.diff(edges, axis=1)
    places = (edges[:, :-1] + half)[:, :, None] + half[:, :, None] * POINTS
    up = vertical[:, None] + line.weight(places.reshape(len(places), -1))
    force = line.force[:, None]
    tension = np.hypot(force, up)
    weights = (half[:, :, None] * WEIGHTS).reshape(up.shape)
    return (weights * _lost(force, up, tension)).sum(axis=1), (weights * force / tension).sum(axis=1)


def stepped_sums(sections: int) -> Sums:
    """Of arcs of catenaries: V_2 - V_1 = w l, z = l (V_1 + V_2) / (T_1 + T_2), x = l r (v_2 - v_1) / (V_2 - V_1)."""

    def sums(line: Hung, vertical: Array) -> tuple[Array, Array]:
        joints = line.low[:, None] + line.length[:, None] * np.linspace(0.0, 1.0, sections + 1)
        weight = longer(line.weight(joints))
        up, force, piece = vertical[:, None] + weight, longer(line.force)[:, None], longer(line.length) / sections
        tension = np.hypot(force, up)
        pairs = tension[:, :-1] + tension[:, 1:]
        lost = _lost(force, up, tension) * tension
        shortfall = piece * ((lost[:, :-1] + lost[:, 1:]) / pairs).sum(axis=1)
        gain = np.diff(weight, axis=1)
        # tanh of half of the change of asinh(V / r), which loses no digits of light pieces.
        quotient = gain / pairs
        turn = np.where(
            quotient < 0.5, 2.0 * np.arctanh(np.minimum(quotient, 0.5)), np.diff(np.arcsinh(up / force), axis=1)
        )
        across = piece * (force * turn / gain).sum(axis=1)
        return np.asarray(shortfall, dtype=float), np.asarray(across, dtype=float)

    return sums


def resolved(line: Hung) -> np.ndarray:
    """Where steps are at most one, whatever the vertical tension."""
    ends = line.weight(np.stack([line.low, line.high], axis=1))
    steepest = np.arcsinh((np.diff(ends, axis=1)[:, 0] + np.abs(line.steepest()) * line.force) / line.force)
    return (line.length <= EVEN) & (2.0 * steepest <= STEEP)


def _lost(force: Array, up: Array, tension: Array) -> Array:
    """1 - V / T."""
    return np.where(up > 0.0, (force / tension) * (force / (tension + np.abs(up))), 1.0 - up / tension)


def _edges(line: Hung, vertical: Array) -> Array:
    """Of panels: even ones and those of equal steps in asinh(V / r) together."""
    low, high, force = line.low[:, None], line.high[:, None], line.force[:, None]
    ends = vertical[:, None] + line.weight(np.concatenate([low, high], axis=1))
    first, last = (np.arcsinh(ends[:, end] / line.force)[:, None] for end in (0, 1))
    weights = force * np.sinh(first + (last - first) * np.linspace(0.0, 1.0, STEEP + 1)) - vertical[:, None]
    steep = np.arcsinh(np.sinh(line.thinnest)[:, None] + weights) - line.thinnest[:, None]
    even = low + (high - low) * np.linspace(0.0, 1.0, EVEN + 1)
    return np.sort(np.concatenate([even, np.clip(steep, low, high)], axis=1), axis=1)
