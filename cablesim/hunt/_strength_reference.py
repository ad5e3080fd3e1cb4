"""Lines of equal strength and just strong enough ones once more, in longer floats and from other forms.

All is told by the angle g between the line at its upper end and the vertical: with d = l / k and m = pi - d

    cot(g) = (exp(|h| / k) - cos(d)) / sin(d),

from y = -k ln cos(x / k) at both ends; at the lower end that angle is m - g, and the cross-sections are 1 / sin.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cablesim.hunt._case import Case
from cablesim.hunt._precise import Answer, increasing_root, log_sinhc, longer, pi_times_less
from cablesim.numerics import Array


@dataclass(frozen=True)
class Design:
    """Lines of equal strength; lengths in units of k."""

    k: Array
    span: Array
    missing: Array
    rise: Array

    @cached_property
    def cotangent(self) -> Array:
        return (np.expm1(np.abs(self.rise)) + 2.0 * np.sin(0.5 * self.span) ** 2) / self._sine

    @cached_property
    def upper(self) -> Array:
        """g."""
        return np.arctan2(1.0, self.cotangent)

    @cached_property
    def lower_area(self) -> Array:
        return 1.0 / np.where(self._narrow, np.sin(self.span + self.upper), np.sin(self.missing - self.upper))

    @cached_property
    def upper_area(self) -> Array:
        return np.hypot(1.0, self.cotangent)

    @cached_property
    def length(self) -> Array:
        """From k ln tan(pi / 4 + x / 2k) at both ends."""
        return np.log1p(np.sin(0.5 * self.span) / (self._half_lower * np.sin(0.5 * self.upper)))

    @cached_property
    def slack(self) -> Array:
        """Length less rise."""
        rest = np.sin(0.25 * self.span + 0.5 * self.upper) * np.sin(0.25 * self.span)
        return 2.0 * np.log1p(2.0 * rest / self._half_lower)

    @cached_property
    def weight(self) -> Array:
        return self._sine * self.upper_area * self.lower_area

    @cached_property
    def upper_angle(self) -> Array:
        """u at the upper end; at the lower one it is less by the length."""
        return np.arcsinh(self.cotangent)

    @cached_property
    def vertex(self) -> Array:
        """From end A."""
        from_upper = np.arctan(self.cotangent)
        return np.where(self.rise >= 0.0, self.span - from_upper, from_upper)

    @cached_property
    def saved(self) -> Array:
        """Of short lines from the mean of cosh(u) by the formula for the sum of angles."""
        short = np.minimum(self.length, 1.0)
        little = np.tanh(self.upper_angle) * 2.0 * np.sinh(0.5 * short) ** 2 / short - np.expm1(log_sinhc(short))
        return np.where(self.length < 1.0, little, 1.0 - self.weight / (self.length * self.upper_area))

    @property
    def _narrow(self) -> np.ndarray:
        return self.span < self.missing

    @property
    def _sine(self) -> Array:
        return np.sin(np.minimum(self.span, self.missing))

    @property
    def _half_lower(self) -> Array:
        """sin of half the angle at the lower end."""
        wide = np.sin(0.5 * (self.missing - self.upper))
        return np.where(self._narrow, np.cos(0.5 * (self.span + self.upper)), wide)


def design_of(case: Case) -> Design:
    """The lines of a case as they were designed."""
    k, span, rise = (case.parameters[name] for name in ("strength_length", "span", "rise"))
    long = longer(k)
    return Design(long, longer(span) / long, pi_times_less(k, span) / long, longer(rise) / long)


def equal_strength(line: Design) -> dict[str, Answer]:
    """Answers of the line of equal strength."""
    areas = line.lower_area, line.upper_area
    first, last = (np.where(line.rise >= 0.0, *pair) for pair in (areas, areas[::-1]))
    plain = {
        "drop": 0.5 * line.k * np.log1p(line.cotangent**2),
        "line_length": line.k * line.length,
        "area_ratio_A": first,
        "area_ratio_B": last,
        "saved_weight_fraction": line.saved,
        "weight_over_force": line.weight,
    }
    across = Answer(line.k * line.vertex, line.k * (np.abs(line.vertex) + line.span))
    return {name: Answer(value, np.abs(value)) for name, value in plain.items()} | {"vertex_x": across}


@dataclass(frozen=True)
class Thin:
    """The thinner of two uniform lines that are just strong enough: lambda, |u| above, the slope of log G there.

    `excess` is the logarithm of the least possible stress over the permitted one, positive where there is no line.
    """

    half_angle: Array
    mean: Array
    upper: Array
    slope: Array
    excess: Array


def thin_line(span: Array, rise: Array) -> Thin:
    """Spans and rises over k; where there is no line, the one of least stress."""
    lean = np.abs(rise) / span

    def mean(x: Array) -> Array:
        return np.arcsinh(lean * np.exp(-log_sinhc(x)))

    def slope(x: Array) -> Array:
        middle = mean(x)
        return x * np.tanh(middle + x) * (1.0 + np.tanh(middle) * (1.0 / x - 1.0 / np.tanh(x))) - 1.0

    def stress(x: Array) -> Array:
        u = mean(x) + x
        return u + np.log1p(np.exp(-2.0 * u)) + np.log(0.25 * span / x)

    least = increasing_root(slope, span.size)
    x = increasing_root(lambda x: np.where(x < least, -stress(x), 1.0), span.size)
    return Thin(x, mean(x), mean(x) + x, slope(x), stress(least))


def uniform_strength(line: Design, thin: Thin) -> dict[str, Answer]:
    """Answers of the uniform line that is just strong enough."""
    x, mean, upper = thin.half_angle, np.copysign(thin.mean, line.rise), thin.upper
    a = 0.5 * line.span / x
    length = np.hypot(line.rise, 2.0 * a * np.sinh(x))
    plain = {
        "drop": 2.0 * line.k * a * np.sinh(0.5 * upper) ** 2,
        "line_length": line.k * length,
        "area_ratio_A": 1.0 / a,
        "area_ratio_B": 1.0 / a,
        "weight_over_force": length / a,
    }
    nothing = {"saved_weight_fraction": Answer(np.zeros_like(a), np.ones_like(a))}
    across = Answer(line.k * a * (x - mean), line.k * a * (x + np.abs(mean)))
    return {name: Answer(value, np.abs(value)) for name, value in plain.items()} | {"vertex_x": across} | nothing
