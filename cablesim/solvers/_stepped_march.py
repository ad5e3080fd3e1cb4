"""Along lines of uniform pieces of equal length, each with the weight of the piece of the design that it replaces.

Lines are told as those of `cablesim.physics.built_line`, lengths in units of k; every piece is an arc of its own
catenary (`cablesim.physics.composite`, C2).
"""

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.compiled import compiled
from cablesim.physics.built_line import weight_to
from cablesim.physics.composite import extent, tension_less
from cablesim.solvers._built_march import DISTANCE, RATE, SHORTFALL

# Longest part of a piece, in u, that is searched for two maxima of the stress; halvings of it, for the top is flat.
PART = 0.25
HALVINGS = 30


def stepped_sums(sections: int, low: Array, high: Array, thinnest: Array, force: Array, vertical: Array) -> Array:
    """What `sums_along` gives, for lines of uniform pieces; (scenario, 3)."""
    found = np.empty((low.size, 3))
    _sums(sections, low, high, thinnest, force, vertical, found)
    return found


def stepped_positions(
    from_first: Array, sections: int, low: Array, high: Array, thinnest: Array, force: Array, vertical: Array
) -> tuple[Array, Array]:
    """x and z at fractions of the length, in their order, from the first end; (scenario, place)."""
    x, z = np.empty(from_first.shape), np.empty(from_first.shape)
    _positions(from_first, sections, low, high, thinnest, force, vertical, x, z)
    return x, z


def largest_stresses(sections: int, low: Array, high: Array, thinnest: Array, force: Array, vertical: Array) -> Array:
    """Largest tension over the cross-section of the design, over the permitted stress."""
    found = np.empty(low.size)
    _largest_stresses(sections, low, high, thinnest, force, vertical, found)
    return found


@compiled
def _sums(sections, low, high, thinnest, force, vertical, found):
    for i in range(low.size):
        r, scale = force[i], np.hypot(force[i], vertical[i])
        length = (high[i] - low[i]) / sections
        found[i] = 0.0
        v_1 = vertical[i] + weight_to(low[i], thinnest[i])
        t_1 = np.hypot(r, v_1)
        for j in range(sections):
            v_2 = vertical[i] + weight_to(_joint(low[i], high[i], j + 1, sections), thinnest[i])
            t_2 = np.hypot(r, v_2)
            share = length / (t_1 + t_2)
            found[i, SHORTFALL] += share * (tension_less(t_1, v_1, r) + tension_less(t_2, v_2, r))
            found[i, RATE] += (
                share * scale * ((r / t_1) * (r / t_2) + _less_than_one(r / t_1, v_1 / t_1, r / t_2, v_2 / t_2))
            )
            found[i, DISTANCE] += extent(length, v_2 - v_1, r, v_1, v_2)[0]
            v_1, t_1 = v_2, t_2


@compiled
def _less_than_one(cos_1, sin_1, cos_2, sin_2):
    """1 - sin_1 sin_2, of which nothing would be left for two steep ends: from 1 - (sin_1 sin_2)^2."""
    product = sin_1 * sin_2
    return (cos_1**2 + (sin_1 * cos_2) ** 2) / (1.0 + product) if product > 0.0 else 1.0 - product


@compiled
def _positions(from_first, sections, low, high, thinnest, force, vertical, x, z):
    for i in range(low.size):
        length = (high[i] - low[i]) / sections
        across, up, j = 0.0, 0.0, 0
        v_1 = vertical[i] + weight_to(low[i], thinnest[i])
        v_2 = vertical[i] + weight_to(_joint(low[i], high[i], 1, sections), thinnest[i])
        for k in range(from_first.shape[1]):
            while j < sections - 1 and from_first[i, k] * sections >= j + 1:
                dx, dz, _ = extent(length, v_2 - v_1, force[i], v_1, v_2)
                across, up, j, v_1 = across + dx, up + dz, j + 1, v_2
                v_2 = vertical[i] + weight_to(_joint(low[i], high[i], j + 1, sections), thinnest[i])
            part = from_first[i, k] * sections - j
            weight = part * (v_2 - v_1)
            dx, dz, _ = extent(part * length, weight, force[i], v_1, v_1 + weight)
            x[i, k], z[i, k] = across + dx, up + dz


@compiled
def _largest_stresses(sections, low, high, thinnest, force, vertical, found):
    for i in range(low.size):
        length = (high[i] - low[i]) / sections
        v_1 = vertical[i] + weight_to(low[i], thinnest[i])
        found[i] = np.hypot(force[i], v_1) / np.cosh(thinnest[i] + low[i])
        for j in range(sections):
            u = thinnest[i] + _joint(low[i], high[i], j, sections)
            v_2 = vertical[i] + weight_to(_joint(low[i], high[i], j + 1, sections), thinnest[i])
            piece = (u, v_1, (v_2 - v_1) / length, force[i])
            found[i] = max(found[i], _largest_stress(length, piece))
            v_1 = v_2


@compiled
def _largest_stress(length, piece):
    """Of a piece, its beginning apart. Where |V| > r the stress has one maximum at most.

    Elsewhere it has two at most in parts in which neither the slope nor u changes sign: there its second derivative,
    the difference of two functions with their tops at V = 0 and at u = 0, changes sign once.
    """
    u, start, growth, force = piece
    before = min(max((-force - start) / growth, 0.0), length)
    beyond = min(max((force - start) / growth, 0.0), length)
    largest = 0.0
    level, thinnest = min(max(-start / growth, before), beyond), min(max(-u, before), beyond)
    one, other = min(level, thinnest), max(level, thinnest)
    for here, there in ((0.0, before), (before, one), (one, other), (other, beyond), (beyond, length)):
        parts = int(np.ceil((there - here) / PART))
        for k in range(parts):
            first, last = here + (there - here) * k / parts, here + (there - here) * (k + 1) / parts
            turn = _turn(first, last, piece)
            for begin, end in ((first, turn), (turn, last)):
                largest = max(largest, _stress(_highest(begin, end, piece), piece))
                largest = max(largest, _stress(end, piece))
    return largest


@compiled
def _turn(first, last, piece):
    """Where the rise of the stress begins to grow or to fall, so that on either side it passes through zero once."""
    growing = _growth_of_rise(first, piece) > 0.0
    if growing == (_growth_of_rise(last, piece) > 0.0):
        return last
    for _ in range(HALVINGS):
        middle = 0.5 * (first + last)
        if growing == (_growth_of_rise(middle, piece) > 0.0):
            first = middle
        else:
            last = middle
    return last


@compiled
def _highest(first, last, piece):
    """Where the stress is largest between two points, with one maximum at most; the first point does not count."""
    if _rise_of_stress(last, piece) >= 0.0:
        return last
    for _ in range(HALVINGS):
        middle = 0.5 * (first + last)
        if _rise_of_stress(middle, piece) > 0.0:
            first = middle
        else:
            last = middle
    return last


@compiled
def _stress(part, piece):
    u, start, growth, force = piece
    return np.hypot(force, start + growth * part) / np.cosh(u + part)


@compiled
def _rise_of_stress(part, piece):
    """d log(T / cosh(u)) / du."""
    u, start, growth, force = piece
    vertical = start + growth * part
    tension = np.hypot(force, vertical)
    return (vertical / tension) * (growth / tension) - np.tanh(u + part)


@compiled
def _growth_of_rise(part, piece):
    """d^2 log(T / cosh(u)) / du^2."""
    u, start, growth, force = piece
    vertical = start + growth * part
    tension = np.hypot(force, vertical)
    change = growth / tension
    return change**2 * ((force / tension) ** 2 - (vertical / tension) ** 2) - 1.0 / np.cosh(u + part) ** 2


@compiled
def _joint(low, high, number, sections):
    """Place of a joint, the ends being the first and the last."""
    return low + (high - low) * number / sections if number < sections else high
