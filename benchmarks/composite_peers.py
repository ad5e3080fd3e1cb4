"""The other ways to a composite line: MoorPy, SciPy on the same closed equations, a reference in 30 digits.

Each takes one line at a time and gives the tensions at its ends, and is set up as well as we know how: equations in
scaled unknowns and, as an alternative to NumPy, in plain floats; first guesses from a uniform line of the same weight;
for MoorPy joints that start on the chord, two nodes a section, and no more stiffness than negligible stretch needs.
"""

import math
from collections.abc import Callable
from typing import Any

import mpmath as mp
import numpy as np
from moorpy.subsystem import Subsystem
from scipy.optimize import brentq, fsolve

from cablesim.numerics import Array

Line = dict[str, Any]
Reach = Callable[[float, float, Any, Any], tuple[float, float]]

GRAVITY = 9.81
# Lines for MoorPy hang this deep, clear of the surface, and the seabed is out of reach.
DEPTH = 3000.0
SEABED = 10_000.0
# A stiff line stretches by this share of what it is longer than its chord; its tensions are then off by half of it.
STRETCH = 1e-3
XTOL = 1e-10
DIGITS = 30
FAILED = np.full(2, np.nan)


# MoorPy


def subsystem(line: Line) -> Subsystem:
    """The line as MoorPy has it, joints on the chord."""
    lengths, rise, distance = line["section_length"], line["rise"], line["horizontal_distance"]
    end_A, end_B = np.array([-distance, 0.0, -DEPTH]), np.array([0.0, 0.0, rise - DEPTH])
    stiffness = axial_stiffness(line)
    types = [
        {"name": f"section {k}", "m": weight / GRAVITY, "d_vol": 0.0, "EA": stiffness}
        for k, weight in enumerate(line["section_weight"])
    ]
    # An empty table of line properties spares it the reading of its own.
    system = Subsystem(depth=SEABED, g=GRAVITY, span=distance, z_fair=rise - DEPTH, lineProps={})
    system.makeGeneric(list(lengths), types, suspended=1, nSegs=1)
    system.setEndPosition(end_A, 0)
    system.setEndPosition(end_B, 1)
    for point, share in zip(system.pointList[1:-1], np.cumsum(lengths) / np.sum(lengths), strict=False):
        point.setPosition(end_A + share * (end_B - end_A))
    return system


def axial_stiffness(line: Line) -> float:
    """Enough for negligible stretch at about the tension of a parabola; with more, MoorPy converges less often."""
    length, weight = np.sum(line["section_length"]), np.dot(line["section_length"], line["section_weight"])
    slack = 1.0 - math.hypot(line["horizontal_distance"], line["rise"]) / length
    return weight * (1.0 / math.sqrt(24.0 * slack) + 0.5) / (STRETCH * slack)


def by_moorpy(line: Line, tolerance: float) -> Array:
    """Tensions at A and B, joints in balance to a tolerance in metres (0: MoorPy's own); NaN where it gives up."""
    system = subsystem(line)
    try:
        system.staticSolve(tol=tolerance)
    except Exception:
        # Whatever it raises, from its own errors to a singular matrix, it has not solved the line.
        return FAILED
    return np.array([system.TA, system.TB])


# SciPy on the closed equations


def by_fsolve(line: Line, reach: Reach) -> Array:
    """Tensions at A and B from both equations in log H and the vertical tension at A; NaN where it says it failed."""
    rise, distance, weights, length, hung = _unpacked(line)

    def gaps(state: Array) -> tuple[float, float]:
        x, z = reach(hung[-1] * math.exp(state[0]), hung[-1] * state[1], weights, hung)
        return (x - distance) / length, (z - rise) / length

    start = _uniform_start(rise, distance, length, hung[-1])
    try:
        (log_tension, lift), _, flag, _ = fsolve(gaps, start, full_output=True, xtol=XTOL)
    except ArithmeticError:
        return FAILED
    return _end_tensions(hung[-1] * math.exp(log_tension), hung[-1] * lift, hung[-1]) if flag == 1 else FAILED


def by_brentq(line: Line) -> Array:
    """Tensions at A and B where H is given, from the vertical tension at A, which has a bracket."""
    rise, horizontal, weights, length, hung = _unpacked(line)
    highest = horizontal * rise / math.sqrt(length**2 - rise**2)
    vertical = brentq(
        lambda v: in_floats(horizontal, v, weights, hung)[1] - rise, highest - hung[-1], highest, rtol=XTOL
    )
    return _end_tensions(horizontal, vertical, hung[-1])


def in_floats(horizontal: float, vertical: float, weights: list[float], hung: list[float]) -> tuple[float, float]:
    """Where B is from A, section by section."""
    x = z = 0.0
    slope = vertical / horizontal
    angle, secant = math.asinh(slope), math.hypot(1.0, slope)
    for weight, below in zip(weights, hung[1:], strict=True):
        scale, slope = horizontal / weight, (vertical + below) / horizontal
        angle_before, angle = angle, math.asinh(slope)
        secant_before, secant = secant, math.hypot(1.0, slope)
        x += scale * (angle - angle_before)
        z += scale * (secant - secant_before)
    return x, z


def in_arrays(horizontal: float, vertical: float, weights: Array, hung: Array) -> tuple[float, float]:
    """The same in NumPy."""
    slopes, scales = (vertical + hung) / horizontal, horizontal / weights
    return scales @ np.diff(np.arcsinh(slopes)), scales @ np.diff(np.hypot(1.0, slopes))


def _unpacked(line: Line) -> tuple[Any, ...]:
    """Rise, distance or H, weights, length, and what hangs between A and each joint: in arrays if the line is."""
    lengths, weights, rise, given = line.values()
    if isinstance(lengths, list):
        hung = [0.0]
        for length, weight in zip(lengths, weights, strict=True):
            hung.append(hung[-1] + length * weight)
        return rise, given, weights, sum(lengths), hung
    return rise, given, weights, lengths.sum(), np.concatenate([[0.0], np.cumsum(lengths * weights)])


def _uniform_start(rise: float, distance: float, length: float, weight: float) -> tuple[float, float]:
    """log H and the vertical tension at A, over the weight, of about a uniform line: sinh(lambda) = k lambda."""
    k = math.sqrt(length**2 - rise**2) / distance
    angle = math.sqrt(6.0 * (k - 1.0)) if k < 1.5 else math.log(2.0 * k) + math.log(math.log(2.0 * k))
    return math.log(0.5 * distance / (length * angle)), 0.5 * (rise / math.tanh(angle) / length - 1.0)


def _end_tensions(horizontal: float, vertical: float, weight: float) -> Array:
    return np.array([math.hypot(horizontal, vertical), math.hypot(horizontal, vertical + weight)])


# The reference


def in_digits(line: Line, near: Array) -> Array:
    """Tensions at A and B in 30 digits, from the tensions nearby."""
    with mp.workdps(DIGITS):
        lengths, weights = ([mp.mpf(value) for value in line[name]] for name in ("section_length", "section_weight"))
        rise, weight = mp.mpf(line["rise"]), mp.fdot(lengths, weights)
        # T_B^2 - T_A^2 = (2 V_A + W) W
        vertical = 0.5 * ((near[1] - near[0]) * (near[1] + near[0]) / weight - weight)

        def reach(horizontal: mp.mpf, upward: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
            x = z = mp.mpf(0)
            for length, each in zip(lengths, weights, strict=True):
                slope, upward = upward / horizontal, upward + each * length
                x += horizontal / each * (mp.asinh(upward / horizontal) - mp.asinh(slope))
                z += horizontal / each * (mp.hypot(1, upward / horizontal) - mp.hypot(1, slope))
            return x, z

        if "horizontal_tension" in line:
            horizontal = mp.mpf(line["horizontal_tension"])
            vertical = mp.findroot(lambda v: reach(horizontal, v)[1] - rise, (vertical, vertical + weight * 1e-6))
        else:
            distance, start = mp.mpf(line["horizontal_distance"]), mp.sqrt(mp.mpf(near[0]) ** 2 - vertical**2)
            horizontal, vertical = mp.findroot(
                lambda *state: [a - b for a, b in zip(reach(*state), (distance, rise), strict=True)], (start, vertical)
            )
        return np.array([float(mp.hypot(horizontal, v)) for v in (vertical, vertical + weight)])
