"""Quadrature along lines that were built for equal strength, and the search for the force that meets their rise.

With T the tension, V its vertical part and r its horizontal one, dz/du = V / T and dx/du = r / T. In the complex plane
they are singular where V = -+i r, which is T away from V. As |sinh(u + t) - sinh(u)| <= cosh(u) (exp(|t|) - 1), no
singularity is nearer to u than log(1 + T / cosh(u)): the panels are as long as that allows.
"""

from collections.abc import Callable

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.compiled import compiled
from cablesim.numerics.quadrature import POINTS, WEIGHTS
from cablesim.numerics.roots import Roots, newton_bracketed
from cablesim.physics.built_line import BuiltLine, area_at, weight_to

# Of the distance to the nearest singularity: what is left of it is then 0.7 of the panel.
PANEL = 0.58
# A kink narrower than so many units in the last place of where it is cannot be resolved.
NARROWEST = 8.0 * np.finfo(float).eps
# What makes the bracket of the force wider than rounding.
MARGIN = 1e-9
SHORTFALL, RATE, DISTANCE = range(3)


# Function of (vertical, which): integrals as of `sums_along` for the lines `which` with these vertical tensions.
Sums = Callable[[Array, np.ndarray], Array]


def vertical_tension(line: BuiltLine, sums: Sums, grain: Array | float = 0.0) -> tuple[Array, Roots]:
    """Vertical tension at the thinnest places, with which the rise of the ends is met, and how it was found.

    The unknown is x = exp(asinh(V / r)). What is solved is the length beyond the rise, which no steep line loses.
    `grain` is the length, over k, of pieces within which the weight need not be that of the design.
    """
    force = line.force_ratio

    def equation(x: Array, which: np.ndarray) -> tuple[Array, Array]:
        found = sums(_vertical(force[which], x), which)
        return 2.0 * line.design.slack[which] - found[:, SHORTFALL], found[:, RATE]

    # Where all of the line is steeper than a straight one would be, its end is too high, and where all is less steep,
    # too low. As 1 - V / T > 1 before the lowest point, this is no farther from the first end than twice the slack.
    farthest = np.minimum(line.low + 2.0 * line.design.slack + grain, line.high)
    ends = line.weights(np.stack([line.high, line.low, farthest], axis=1)) / force[:, None]
    least, most = np.maximum(line.steepness - ends[:, 0], -ends[:, 2]), line.steepness - ends[:, 1]
    bracket = (1.0 - MARGIN) * np.exp(np.arcsinh(least)), (1.0 + MARGIN) * np.exp(np.arcsinh(most))
    design = np.exp(np.arcsinh(np.sinh(line.thinnest) / force))
    roots = newton_bracketed(equation, *bracket, np.clip(design, *bracket))
    return _vertical(force, roots.x), roots


def sums_along(low: Array, high: Array, thinnest: Array, force: Array, vertical: Array) -> Array:
    """Integrals over u from `low` to `high`, shape (scenario, 3); NaN for a line with a kink beyond resolution.

    Of 1 - V / T, what the line is longer than it rises; of its rate of fall with asinh(V / r); and of r / T.
    """
    found = np.empty((low.size, 3))
    _sums(low, high, thinnest, force, vertical, found)
    return found


def positions(places: Array, thinnest: Array, force: Array, vertical: Array) -> tuple[Array, Array]:
    """x and z over k at places that follow each other along the line, from the first of them; (scenario, place)."""
    x, z = np.empty(places.shape), np.empty(places.shape)
    _positions(places, thinnest, force, vertical, x, z)
    return x, z


def _vertical(force: Array, x: Array) -> Array:
    return 0.5 * force * (x - 1.0 / x)


@compiled
def _sums(low, high, thinnest, force, vertical, found):
    for i in range(low.size):
        here = low[i]
        scale = np.hypot(force[i], vertical[i])
        found[i] = 0.0
        while here < high[i]:
            width = _panel(here, high[i], thinnest[i], force[i], vertical[i])
            for k in range(POINTS.size):
                up = vertical[i] + weight_to(here + width * POINTS[k], thinnest[i])
                tension = np.hypot(force[i], up)
                across = force[i] / tension
                shortfall = 1.0 - up / tension if up <= 0.0 else across * (force[i] / (tension + up))
                found[i, SHORTFALL] += width * WEIGHTS[k] * shortfall
                found[i, RATE] += width * WEIGHTS[k] * across * across * (scale / tension)
                found[i, DISTANCE] += width * WEIGHTS[k] * across
            here = high[i] if width == high[i] - here else here + width


@compiled
def _positions(places, thinnest, force, vertical, x, z):
    for i in range(places.shape[0]):
        x[i, 0], z[i, 0] = 0.0, 0.0
        for j in range(1, places.shape[1]):
            x[i, j], z[i, j] = x[i, j - 1], z[i, j - 1]
            here, there = places[i, j - 1], places[i, j]
            while here < there:
                width = _panel(here, there, thinnest[i], force[i], vertical[i])
                for k in range(POINTS.size):
                    up = vertical[i] + weight_to(here + width * POINTS[k], thinnest[i])
                    tension = np.hypot(force[i], up)
                    x[i, j] += width * WEIGHTS[k] * (force[i] / tension)
                    z[i, j] += width * WEIGHTS[k] * (up / tension)
                here = there if width == there - here else here + width


@compiled
def _panel(here, end, thinnest, force, vertical):
    """Width of the panel that begins at `here`; NaN, which ends the march, where it is too narrow."""
    tension = np.hypot(force, vertical + weight_to(here, thinnest))
    width = PANEL * np.log1p(tension / area_at(here, thinnest))
    if width >= end - here:
        return end - here
    return width if width > NARROWEST * abs(here) else np.nan
