"""Lines of sections that are hardly longer than their chord: their tension from their slack, to second order.

With P the pull along the chord, W(s) the weight between A and s, and m2 and m3 the mean square and cube of what W
differs from its mean by, a line of length L on a chord of direction (cos b, sin b) is longer than it by

    L cos^2 b m2 / (2 P^2) (1 - 2 sin b m3 / (m2 P)),   H = P cos b,

but for terms that are smaller by the square of W / P.
"""

from fractions import Fraction

import numpy as np

from cablesim.hunt._composite_laws import Lines, length
from cablesim.numerics import Array

# Slacks, in lengths, that are looked at: others are for the second method.
TAUT = 1e-6


def slack(line: Lines) -> Array:
    """How much longer than its chord each line is, to all digits."""
    rows = zip(line["section_length"], line["horizontal_distance"], line["rise"], strict=True)
    excess: Array = np.array([_excess(lengths[np.isfinite(lengths)], x, z) for lengths, x, z in rows])
    return excess / (length(line) + np.hypot(line["horizontal_distance"], line["rise"]))


def taut_tension(line: Lines, slack: Array) -> tuple[Array, Array]:
    """H of taut lines, and about how far off it is, relative to it."""
    chord = np.hypot(line["horizontal_distance"], line["rise"])
    cosine, sine = line["horizontal_distance"] / chord, line["rise"] / chord
    share = line["section_length"] / length(line)[:, None]
    load = line["section_weight"] * line["section_length"]
    before = np.cumsum(load, axis=1) - load
    before = before - np.nansum(share * (before + 0.5 * load), axis=1)[:, None]
    after = before + load
    square = np.nansum(share * (before**2 + before * after + after**2) / 3.0, axis=1)
    cube = np.nansum(share * (before + after) * (before**2 + after**2) / 4.0, axis=1)
    level = cosine * np.sqrt(square * length(line) / (2.0 * slack))
    largest = np.nanmax(np.maximum(np.abs(before), np.abs(after)), axis=1)
    return cosine * (level - sine * cube / square), (largest / level) ** 2


def _excess(lengths: Array, x: float, z: float) -> np.longdouble:
    """L^2 - x^2 - z^2."""
    total = sum(Fraction(float(part)) for part in lengths)
    excess = total**2 - Fraction(float(x)) ** 2 - Fraction(float(z)) ** 2
    return np.longdouble(float(excess))
