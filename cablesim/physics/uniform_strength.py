"""Uniform line between two supports that is just strong enough: its largest stress is the permitted one.

Notation: k = strength / weight per volume, span l, rise h, r = |h| / l, b = l / 2k; lambda = l / 2a with the catenary
parameter a, mu = asinh(r lambda / sinh(lambda)), and u = mu + lambda at the upper support. The largest stress is the
permitted one where a cosh(u) = k, that is

    G(lambda) = cosh(u) / lambda = 1 / b.                                                                          (E2)

log G is convex in log(lambda), with the slope

    J = lambda tanh(u) (1 - tanh(mu) c) - 1,  c = coth(lambda) - 1 / lambda:

there are two such lines, one where they meet, or none. The one of smaller lambda has the thinner cross-section, 2k / l
times lambda over the one that carries the horizontal force alone.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.hyperbolic import cosh_sinhc_difference, log_cosh, sinhc_excess
from cablesim.numerics.roots import Roots, newton_bracketed
from cablesim.physics.catenary import Catenary

# So near to where the two lines meet, in log(lambda), G is a parabola to all its digits.
NEAR = 1e-5


@dataclass(frozen=True)
class UniformStrengthLine:
    """A uniform line whose largest stress is the permitted one, arrays of one entry per scenario."""

    nodes: int
    strength_length: Array
    span: Array
    rise: Array
    half_angle: Array

    @cached_property
    def line_length(self) -> Array:
        return np.hypot(self.rise, self.span * (1.0 + sinhc_excess(self.half_angle)))

    @cached_property
    def area_ratio_A(self) -> Array:
        return 2.0 * self.strength_length * self.half_angle / self.span

    @property
    def area_ratio_B(self) -> Array:
        return self.area_ratio_A

    @cached_property
    def weight_over_force(self) -> Array:
        return 2.0 * self.half_angle * self.line_length / self.span

    @property
    def saved_weight_fraction(self) -> Array:
        """Nothing: it is as thick everywhere as at its thicker end."""
        return np.zeros_like(self.span)

    @property
    def drop(self) -> Array:
        return self._curve.drop

    @property
    def vertex_x(self) -> Array:
        return self._curve.vertex_x

    @property
    def profile(self) -> Array:
        return self._curve.profile

    @cached_property
    def _curve(self) -> Catenary:
        ones = np.ones_like(self.span)
        return Catenary(self.nodes, self.span, ones, self.rise, self.line_length, self.half_angle)


def thin_half_angle(strength_length: Array, span: Array, rise: Array) -> tuple[Roots, np.ndarray]:
    """lambda of the thinner of the two lines, and where there is one."""
    half_span, slope = 0.5 * span / strength_length, np.abs(rise / span)
    peak = _peak(slope)
    margin = -_log_stress(peak.x, slope, half_span)
    feasible = margin >= 0.0
    curvature = _stress_slopes(peak.x, slope)[1]
    distance = np.sqrt(2.0 * np.maximum(margin, 0.0) / curvature)
    near = distance < NEAR
    # Where the two lines meet, or there is none, Newton's method is given a shorter span of two lines.
    easy = np.where(near, half_span * np.exp(margin - 1.0), half_span)

    def equation(x: Array, which: np.ndarray) -> tuple[Array, Array]:
        return -_log_stress(x, slope[which], easy[which]), -_stress_slopes(x, slope[which])[0]

    # At the upper support the line is steeper than its chord: lambda = b cosh(u) > b sqrt(1 + r^2).
    low = easy * np.hypot(1.0, slope)
    roots = newton_bracketed(equation, low, peak.x, low)
    half_angle = np.where(near, peak.x * np.exp(-distance), roots.x)
    return Roots(half_angle, roots.converged & peak.converged, roots.iterations + peak.iterations), feasible


def _peak(slope: Array) -> Roots:
    """lambda at which the largest stress is least: where J = 0.

    J < 0 at lambda = 1, since its first term is less than lambda; J > 0 at 2 + 2 log(1 + r), where mu is small.
    """

    def equation(x: Array, which: np.ndarray) -> tuple[Array, Array]:
        return _stress_slopes(x, slope[which])

    high = 2.0 + 2.0 * np.log1p(slope)
    return newton_bracketed(equation, np.ones_like(slope), high, 1.2 + 0.5 * np.log1p(slope))


def _log_stress(half_angle: Array, slope: Array, half_span: Array) -> Array:
    """log(b G): of the largest stress over the permitted one."""
    return log_cosh(_mean_angle(half_angle, slope) + half_angle) + np.log(half_span / half_angle)


def _stress_slopes(half_angle: Array, slope: Array) -> tuple[Array, Array]:
    """J, and its derivative with respect to log(lambda).

    Of steep lines both are nearly zero along a wide valley: from what tanh(u), tanh(mu) and coth(lambda) differ from 1.
    """
    mean_angle, sine = _mean_angle(half_angle, slope), np.sinh(half_angle)
    mean_deficit, upper_deficit = _tanh_deficit(mean_angle), _tanh_deficit(mean_angle + half_angle)
    mean, upper = 1.0 - mean_deficit, 1.0 - upper_deficit
    c = cosh_sinhc_difference(half_angle) / sine
    lead = half_angle * (mean_deficit * c - 2.0 / np.expm1(2.0 * half_angle))  # lambda du/dlambda - 1
    first = lead - upper_deficit * (1.0 + lead)
    lagging = upper * mean * ((half_angle / sine) ** 2 + mean_deficit * (1.0 + mean) * (half_angle * c) ** 2)
    bend = mean_deficit + mean * upper_deficit + upper_deficit * (1.0 + upper) * (1.0 + lead) ** 2 + lagging
    return first, first + bend


def _tanh_deficit(angle: Array) -> Array:
    """1 - tanh."""
    return 2.0 / (1.0 + np.exp(2.0 * angle))


def _mean_angle(half_angle: Array, slope: Array) -> Array:
    return np.arcsinh(slope / (1.0 + sinhc_excess(half_angle)))
