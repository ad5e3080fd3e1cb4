"""Hanging lines once more, in longer floats and from other forms of their equations than the solvers use.

Notation of `cablesim.physics.catenary`: half the angle lambda, half the weight over the axial stiffness e.
"""

from dataclasses import dataclass

import numpy as np

from cablesim.hunt._case import Case
from cablesim.hunt._precise import Answer, excess_of_squares, increasing_root, log_sinhc, longer
from cablesim.numerics import Array

# Instead of nothing where nothing is divided by it, and of the square of the length.
TINY, LEAST_EXCESS = 1e-300, 1e-40


@dataclass(frozen=True)
class Line:
    """The given numbers of hanging lines, in longer floats."""

    span: Array
    rise: Array
    length: Array
    weight: Array
    excess: Array
    strain: Array

    @property
    def sharpness(self) -> Array:
        """By how much what is left of L^2 - l^2 - h^2 magnifies the rounding of L^2."""
        square = self.length**2
        return np.asarray(square / np.maximum(np.abs(self.excess), LEAST_EXCESS * square), dtype=float)


def line_of(case: Case) -> Line:
    """The lines of a case, whichever solver and problem it is for."""
    given = case.parameters
    span, rise = given["span"], given.get("rise", np.zeros(case.size))
    ratio = given.get("length_ratio")
    length = longer(given["line_length"]) if ratio is None else longer(ratio) * longer(span)
    weight = longer(given["weight_per_length"])
    strain = 0.5 * weight * length / given["axial_stiffness"] if "axial_stiffness" in given else np.zeros_like(length)
    excess = excess_of_squares(given.get("line_length", length), ratio, span, rise)
    return Line(longer(span), longer(rise), length, weight, excess, strain)


def half_angle(line: Line) -> Array:
    """lambda: the root of h^2 / (1 + e coth x)^2 + l^2 (sinh x / (x + e))^2 = L^2.

    Of lines that are not far shorter than their chord h^2 + l^2 is taken from both sides, for what is left of L^2 is
    known exactly.
    """
    rise_2, length_2, excess = ((part / line.span**2) for part in (line.rise**2, line.length**2, line.excess))
    short = excess < -length_2

    def equation(x: Array) -> Array:
        vertical, horizontal = (
            -2.0 * np.log1p(line.strain / np.tanh(x)),
            2.0 * (log_sinhc(x) - np.log1p(line.strain / x)),
        )
        whole = rise_2 * np.exp(vertical) + np.exp(horizontal) - length_2
        return np.where(short, whole, rise_2 * np.expm1(vertical) + np.expm1(horizontal) - excess)

    return increasing_root(equation, line.span.size)


def catenary(line: Line) -> tuple[dict[str, Answer], Array]:
    """Answers of the exact and the elastic catenary, and the largest angle |u| of each."""
    x, e = half_angle(line), line.strain
    a = line.span / (2.0 * (x + e))
    mean = np.arcsinh(line.rise / line.span * (x + e) / (np.sinh(x) + e * np.cosh(x)))
    first, last, upper = mean - x, mean + x, np.abs(mean) + x
    ends = line.weight * a * np.cosh(first), line.weight * a * np.cosh(last)
    # Of stretched, steep lines the lower end has what the upper one leaves, which goes with the rounding of w L / EA.
    largest = np.maximum(*ends)
    stretch = a * a * e / line.length
    vertex, spread = (a * turn + 2.0 * stretch * np.sinh(turn) for turn in (x - mean, x + np.abs(mean)))
    arc = 2.0 * x + np.sinh(2.0 * x) * np.cosh(2.0 * mean)
    return {
        "catenary_parameter": _plain(a),
        "horizontal_tension": _plain(line.weight * a),
        "tension_A": Answer(ends[0], np.where(e > 0.0, largest, ends[0])),
        "tension_B": Answer(ends[1], np.where(e > 0.0, largest, ends[1])),
        "max_tension": _plain(largest),
        "sag": _plain(_sag(line, a, stretch, x)),
        "drop": _plain(2.0 * a * np.sinh(0.5 * upper) ** 2 + stretch * np.sinh(upper) ** 2),
        "vertex_x": Answer(vertex, spread),
        "stretched_length": _plain(line.length + stretch * arc),
    }, np.asarray(upper, dtype=float)


@dataclass(frozen=True)
class Ends:
    """Where end B is by M6, what changes that, and the sum of the angles |u| of both ends."""

    a: Array
    across: Array
    up: Array
    across_by_force: Array
    up_by_force: Array
    angles: Array


def hung_ends(line: Line, horizontal: Array, force: Array) -> Ends:
    """Where end B is if the line hangs under a horizontal tension and a vertical force at B."""
    a, weight = horizontal / line.weight, line.weight * line.length
    low, high = force - weight, force
    angles, tensions = (
        [np.arcsinh(up / horizontal) for up in (low, high)],
        [np.hypot(horizontal, up) for up in (low, high)],
    )
    stretch = 2.0 * line.strain / weight * line.length
    # T_B - T_A = (V_B^2 - V_A^2) / (T_A + T_B), which loses no digits of taut lines.
    climb = line.length * (low + high) / (tensions[0] + tensions[1])
    return Ends(
        a,
        a * (angles[1] - angles[0]) + horizontal * stretch,
        climb + 0.5 * (low + high) * stretch,
        a * np.abs(1.0 / tensions[1] - 1.0 / tensions[0]),
        np.abs(high / tensions[1] - low / tensions[0]) / line.weight + stretch,
        np.abs(angles[0]) + np.abs(angles[1]),
    )


def level_formula(name: str, line: Line) -> dict[str, Answer]:
    """Answers of the approximate formulas as they are printed (M4)."""
    span, slack = line.span, line.excess / (line.length + line.span)
    if name == "series":
        return _series(line, slack)
    sag = np.sqrt((6.0 if name == "parabolic" else 3.0) * span * slack) / 4.0
    horizontal = line.weight * span**2 / (8.0 * sag)
    return _level(line, sag, horizontal, 0.5 * line.weight * span * np.sqrt(1.0 + span**2 / (16.0 * sag**2)))


def _series(line: Line, slack: Array) -> dict[str, Answer]:
    """1 / a^2 is the root of l^5 y^2 / 1920 + l^3 y / 24 = L - l, here by Newton's method from above."""
    excess = slack / line.span
    y = np.minimum(24.0 * excess, np.sqrt(1920.0 * excess))
    for _ in range(8):
        y = y - (y * y / 1920.0 + y / 24.0 - excess) / (y / 960.0 + 1.0 / 24.0)
    a = line.span / np.sqrt(y)
    sag = line.span**2 / (8.0 * a) + line.span**4 / (384.0 * a**3)
    return _level(line, sag, line.weight * a, line.weight * (a + sag))


def _level(line: Line, sag: Array, horizontal: Array, largest: Array) -> dict[str, Answer]:
    tensions = dict.fromkeys(("tension_A", "tension_B", "max_tension"), largest)
    shape = {"sag": sag, "drop": sag, "vertex_x": 0.5 * line.span, "catenary_parameter": horizontal / line.weight}
    return {name: _plain(value) for name, value in {**tensions, **shape, "horizontal_tension": horizontal}.items()}


def _sag(line: Line, a: Array, stretch: Array, x: Array) -> Array:
    """Below the chord where the curve is parallel to it, from the upper end; phi is the change of u between them."""
    slope, taut = np.abs(line.rise / line.span), x + line.strain
    lag = x * np.expm1(log_sinhc(x)) + 2.0 * line.strain * np.sinh(0.5 * x) ** 2
    mean = slope * taut / (taut + lag)
    secant, mean_secant = np.hypot(1.0, slope), np.hypot(1.0, mean)
    # asinh(slope) - asinh(mean), of which taut lines have nothing left to plain floats of any length.
    shift = np.arcsinh(slope * lag / (taut + lag) * (slope + mean) / (slope * mean_secant + mean * secant + TINY))
    phi = x - shift
    rigid = 2.0 * secant * np.sinh(0.5 * phi) ** 2 + slope * phi * np.expm1(log_sinhc(phi))
    return a * rigid + stretch * (secant * np.sinh(phi) + 2.0 * slope * np.sinh(0.5 * phi) ** 2) ** 2


def _plain(value: Array) -> Answer:
    return Answer(value, np.abs(value))
