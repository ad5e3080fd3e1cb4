"""Composite tow line by SciPy: the closed equations in plain floats, by `fsolve`, or by `brentq` where H is given.

What an engineer would write: where the sections end one after another (M8) in the logarithm of the horizontal tension
and the vertical tension at A, started from a uniform line of the same weight.

Reference: docs/models.md, M8; MINPACK's hybrd by way of scipy.optimize.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from cablesim.numerics import Array
from cablesim.parameters import option
from cablesim.peers._each import Answer, Line, solve_each
from cablesim.solver import Solution
from cablesim.solvers._composite_line import TowLine as Parameters

__all__ = ["OUTPUTS", "Options", "Parameters", "solve"]

Reach = Callable[[float, float, Any, Any], tuple[float, float]]

OUTPUTS = ("tension_A", "tension_B", "max_tension")
SECONDS_PER_SCENARIO = 6e-5


@dataclass(frozen=True)
class Options:
    """Numerical options."""

    xtol: float = option(1.49012e-8, at_least=0.0, meaning="relative change of the unknowns at which it stops")


def solve(p: Parameters, options: Options) -> Solution:
    return solve_each(p, OUTPUTS, lambda line: _answer(line, options.xtol))


def _answer(line: Line, xtol: float) -> Answer:
    floats = {name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in line.items()}
    found = by_fsolve(floats, in_floats, xtol) if "horizontal_distance" in line else by_brentq(floats, xtol)
    return None if found is None else {"tension_A": found[0], "tension_B": found[1], "max_tension": max(found)}


def by_fsolve(line: Line, reach: Reach, xtol: float) -> Array | None:
    """Tensions at A and B from both equations in log H and the vertical tension at A; None where it says it failed."""
    from scipy.optimize import fsolve

    rise, distance, weights, length, hung = _unpacked(line, "horizontal_distance")

    def gaps(state: Array) -> tuple[float, float]:
        x, z = reach(hung[-1] * math.exp(state[0]), hung[-1] * state[1], weights, hung)
        return (x - distance) / length, (z - rise) / length

    start = _uniform_start(rise, distance, length, hung[-1])
    (log_tension, lift), _, flag, _ = fsolve(gaps, start, full_output=True, xtol=xtol)
    return _end_tensions(hung[-1] * math.exp(log_tension), hung[-1] * lift, hung[-1]) if flag == 1 else None


def by_brentq(line: Line, xtol: float) -> Array:
    """Tensions at A and B where H is given, from the vertical tension at A, which has a bracket."""
    from scipy.optimize import brentq

    rise, horizontal, weights, length, hung = _unpacked(line, "horizontal_tension")
    highest = horizontal * rise / math.sqrt(length**2 - rise**2)
    vertical = brentq(
        lambda v: in_floats(horizontal, v, weights, hung)[1] - rise, highest - hung[-1], highest, rtol=xtol
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
    return float(scales @ np.diff(np.arcsinh(slopes))), float(scales @ np.diff(np.hypot(1.0, slopes)))


def _unpacked(line: Line, given: str) -> tuple[Any, ...]:
    """Rise, what is given, weights, length, and what hangs between A and each joint: in arrays if the line is."""
    lengths, weights, rise = line["section_length"], line["section_weight"], line["rise"]
    if isinstance(lengths, list):
        hung = [0.0]
        for length, weight in zip(lengths, weights, strict=True):
            hung.append(hung[-1] + length * weight)
        return rise, line[given], weights, sum(lengths), hung
    return rise, line[given], weights, lengths.sum(), np.concatenate([[0.0], np.cumsum(lengths * weights)])


def _uniform_start(rise: float, distance: float, length: float, weight: float) -> tuple[float, float]:
    """log H and the vertical tension at A, over the weight, of about a uniform line: sinh(lambda) = k lambda."""
    k = math.sqrt(length**2 - rise**2) / distance
    angle = math.sqrt(6.0 * (k - 1.0)) if k < 1.5 else math.log(2.0 * k) + math.log(math.log(2.0 * k))
    return math.log(0.5 * distance / (length * angle)), 0.5 * (rise / math.tanh(angle) / length - 1.0)


def _end_tensions(horizontal: float, vertical: float, weight: float) -> Array:
    return np.array([math.hypot(horizontal, vertical), math.hypot(horizontal, vertical + weight)])
