"""Line in a uniform stream by SciPy: `solve_ivp` along the line, inside `fsolve` where both ends are given.

What an engineer would write: the right-hand side of M12 in plain floats; between two ends, shooting from a catenary
under the uniform load that the straight chord would feel. Corners of the friction law are not looked for.

Reference: docs/models.md, M12 and M13 without lay angle; E. Hairer, S. Norsett, G. Wanner, Solving Ordinary
Differential Equations I; A. Hindmarsh, LSODA.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cablesim.numerics import Array
from cablesim.parameters import option
from cablesim.peers._each import Answer, Line, solve_each
from cablesim.physics.stream import FRICTION_LAWS
from cablesim.solver import Solution
from cablesim.solvers._stream_line import StreamLine as Parameters
from cablesim.solvers._stream_line import march_seconds

__all__ = ["OUTPUTS", "Options", "Parameters", "solve"]

Slope = Callable[[float, Array], tuple[float, ...]]

OUTPUTS = ("position_B", "force_A", "force_B", "tension_A", "tension_B", "max_tension")
SECONDS_PER_SCENARIO = 7e-3
SCHEMES = ("LSODA", "DOP853", "RK45", "Radau", "BDF")
# Of the integration, in that of the shooting; and of the shortest distance that a difference quotient can tell.
INNER, DIFFERENCE = 0.1, 1e-8
# A line that misses its end by more tolerances than this is none.
MISS = 10.0


@dataclass(frozen=True)
class Options:
    """Numerical options."""

    scheme: str = option("LSODA", one_of=SCHEMES, meaning="method of solve_ivp")
    rtol: float = option(1e-6, at_least=1e-13, at_most=0.1, meaning="relative tolerance of steps and of shooting")


def seconds_of(p: Parameters, options: Options) -> Array:
    return march_seconds(p, SECONDS_PER_SCENARIO, 3e-4)


def solve(p: Parameters, options: Options) -> Solution:
    return solve_each(p, OUTPUTS, lambda line: _answer(line, options))


def _answer(line: Line, options: Options) -> Answer:
    if line["lay_angle"] or line["heading"] or "depth" in line:
        return None
    shot = "position_B" in line
    force = shooting(line, options) if shot else line["force_A"]
    last, largest = _integrated(line, force, options.scheme, INNER * options.rtol if shot else options.rtol)
    return {
        "position_B": last[:3],
        "force_A": force,
        "force_B": last[3:],
        "tension_A": np.linalg.norm(force),
        "tension_B": np.linalg.norm(last[3:]),
        "max_tension": largest,
    }


def shooting(line: Line, options: Options) -> Array:
    """Force at A of a line between two ends. Raises ArithmeticError where it is not found."""
    from scipy.optimize import fsolve

    length, end, rtol = line["line_length"], line["position_B"], options.rtol
    scale = typical_load(line) * length

    def misses(force: Array) -> Array:
        return (_integrated(line, scale * force, options.scheme, INNER * rtol)[0][:3] - end) / length

    guess = first_guess(line) / scale
    force, _, flag, words = fsolve(misses, guess, full_output=True, xtol=INNER * rtol, epsfcn=DIFFERENCE)
    if flag != 1 or np.linalg.norm(misses(force)) > MISS * rtol:
        raise ArithmeticError(words)
    return scale * force


def _integrated(line: Line, force: Array, scheme: str, rtol: float) -> tuple[Array, float]:
    """Place and force at B, and the largest tension at a step's end."""
    from scipy.integrate import solve_ivp

    length = line["line_length"]
    small = rtol * 0.1 * np.repeat([length, typical_load(line) * length], 3)
    start = np.concatenate([np.zeros(3), force])
    found = solve_ivp(line_slope(line), (0.0, length), start, scheme, rtol=rtol, atol=small)
    if not found.success:
        raise ArithmeticError(found.message)
    return found.y[:, -1], float(np.linalg.norm(found.y[3:], axis=0).max())


def line_slope(line: Line) -> Slope:
    """The right-hand side: position grows along the force, the force falls by the load."""
    weight, normal, along = line["weight_per_length"], *drag(line)
    law = FRICTION_LAWS[int(line["friction_law"])]

    def slope(_: float, state: Array) -> tuple[float, ...]:
        *_, fx, fy, fz = state.tolist()
        tension = math.sqrt(fx * fx + fy * fy + fz * fz)
        x, y, z = fx / tension, fy / tension, fz / tension
        across = normal * math.sqrt(max(1.0 - x * x, 0.0))
        friction = {"constant": math.copysign(1.0, x), "cosine_squared": x * abs(x), "zero": 0.0}[law]
        pull = along * friction - across * x
        return x, y, z, -(across + pull * x), -pull * y, weight - pull * z

    return slope


def drag(line: Line) -> tuple[float, float]:
    """Normal and tangential drag per length."""
    half = 0.5 * line["fluid_density"] * line["stream_speed"] ** 2 * line["diameter"]
    return line["normal_drag_coefficient"] * half, line["tangential_drag_coefficient"] * half


def typical_load(line: Line) -> float:
    """Weight and drag per length."""
    return abs(line["weight_per_length"]) + sum(drag(line))


def first_guess(line: Line) -> Array:
    """Force at A of the catenary under the load that the straight chord would feel."""
    from scipy.optimize import brentq

    length, chord = line["line_length"], line["position_B"]
    load = -np.array(line_slope(line)(0.0, np.concatenate([np.zeros(3), chord]))[3:])
    magnitude = np.linalg.norm(load)
    up = -load / magnitude
    rise = chord @ up
    across = chord - rise * up
    # A chord along the load has no span; a small one stands for it.
    span = max(np.linalg.norm(across), 1e-2 * length)
    ratio = math.sqrt(length**2 - rise**2) / span
    half = brentq(lambda x: math.log(math.sinh(x) / x / max(ratio, 1.0 + 1e-9)), 1e-6, 50.0)
    sideways = across / max(np.linalg.norm(across), 1e-9 * length)
    return 0.5 * magnitude * (span / half * sideways + (rise / math.tanh(half) - length) * up)
