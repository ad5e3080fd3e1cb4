"""Line of equal strength between two supports: its cross-section grows so that its stress is the same everywhere (M7).

Notation: k = strength / weight per volume, span l, rise h, b = l / 2k, e = h / 2k. With x and s from the vertex, the
slope is tan(phi) = sinh(u) with phi = x / k and u = s / k, so the cross-section grows as cosh(u) = 1 / cos(phi). On the
line u grows from mu - lambda to mu + lambda, and with D = sqrt(sin(b)^2 + sinh(e)^2)

    sinh(lambda) = D / cos(b),  cosh(lambda) = cosh(e) / cos(b),  sinh(mu) = sinh(e) / sin(b),  cosh(mu) = D / sin(b),
    tan(phi_mid) = tanh(e) / tan(b),  cosh(u) = exp(-+e) D / (sin(b) cos(b)) at A and B.                            (E1)

Everything below is a sum or product of positive terms, except where a quantity passes through zero.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.exact import two_product
from cablesim.numerics.hyperbolic import cosh_sinhc_difference, log_cosh

# What the float of pi leaves out of pi.
PI_TAIL = 1.2246467991473532e-16


def missing_span(strength_length: Array, span: Array) -> Array:
    """pi k - l, to the last digits even where it nearly vanishes; positive where a line of equal strength exists."""
    product, error = two_product(np.full_like(span, np.pi), strength_length)
    return (product - span) + (error + PI_TAIL * strength_length)


@dataclass(frozen=True)
class EqualStrengthLine:
    """A line of equal strength, arrays of one entry per scenario; each quantity is computed when it is first asked for.

    Cross-sections are over the one that carries the horizontal force alone, weights over the horizontal force.
    """

    nodes: int
    strength_length: Array
    span: Array
    rise: Array

    @cached_property
    def half_angle(self) -> Array:
        """lambda, half of the line's length over k."""
        return np.arcsinh(self._reach / self._cosine)

    @cached_property
    def mean_angle(self) -> Array:
        """mu, the mean of u at the two supports."""
        return np.arcsinh(np.sinh(self.half_rise) / self._sine)

    @cached_property
    def half_rise(self) -> Array:
        """e."""
        return 0.5 * self.rise / self.strength_length

    @cached_property
    def slack(self) -> Array:
        """lambda - |e|, half of what the line is longer than its rise, over k: from sinh(lambda)^2 - sinh(e)^2."""
        sloped = np.cosh(self.half_rise) * self._sine / self._cosine
        return np.arcsinh(sloped / np.sinh(self.half_angle + np.abs(self.half_rise)) * sloped)

    @cached_property
    def line_length(self) -> Array:
        return 2.0 * self.strength_length * self.half_angle

    @cached_property
    def drop(self) -> Array:
        return self.strength_length * log_cosh(np.abs(self.mean_angle) + self.half_angle)

    @cached_property
    def vertex_x(self) -> Array:
        up, across = np.sinh(self.half_rise) * self._cosine**2, np.cosh(self.half_rise) * self._sine**2
        return self.strength_length * np.arctan2(across - up, np.exp(self.half_rise) * self._sine * self._cosine)

    @property
    def area_ratio_A(self) -> Array:
        return np.exp(-self.half_rise) * self._mean_area_ratio

    @property
    def area_ratio_B(self) -> Array:
        return np.exp(self.half_rise) * self._mean_area_ratio

    @cached_property
    def weight_over_force(self) -> Array:
        """sinh(u_B) - sinh(u_A)."""
        return 2.0 * self._mean_area_ratio * self._reach

    @cached_property
    def saved_weight_fraction(self) -> Array:
        """1 - (sinh u_B - sinh u_A) / (2 lambda cosh u) with u at the upper end."""
        level = self._cosine * cosh_sinhc_difference(self.half_angle)
        size = np.abs(self.half_rise)
        return np.exp(-size) * (level + np.sinh(size))

    @cached_property
    def profile(self) -> Array:
        """Nodes at equal steps of length, as x, y and z from A; shape (scenario, node, component)."""
        start, turn, middle = self._angle_A[:, None], self._half_turn, self._middle
        k = self.strength_length[:, None]
        x = 2.0 * k * np.arctan(np.sinh(turn) / np.cosh(middle))
        change = 2.0 * np.sinh(np.abs(middle)) * np.sinh(turn)
        z = np.copysign(k * np.log1p(change / np.cosh(np.minimum(np.abs(start), np.abs(middle + turn)))), middle)
        return np.stack([x, np.zeros_like(x), z], axis=-1)

    @property
    def profile_area_ratio(self) -> Array:
        return np.cosh(self._middle + self._half_turn)

    @property
    def profile_weight(self) -> Array:
        """sinh(u) - sinh(u_A)."""
        return 2.0 * np.cosh(self._middle) * np.sinh(self._half_turn)

    @property
    def _angle_A(self) -> Array:
        return self.mean_angle - self.half_angle

    @cached_property
    def _half_turn(self) -> Array:
        """Half the change of u from A to the nodes."""
        return self.half_angle[:, None] * np.linspace(0.0, 1.0, self.nodes)

    @cached_property
    def _middle(self) -> Array:
        """The mean of u at A and at the nodes."""
        return self._angle_A[:, None] + self._half_turn

    @cached_property
    def _sine(self) -> Array:
        """sin(b)."""
        return np.sin(0.5 * self.span / self.strength_length)

    @cached_property
    def _cosine(self) -> Array:
        """cos(b), from its complement where that is smaller."""
        missing = missing_span(self.strength_length, self.span)
        near = missing < self.span
        half = 0.5 * np.where(near, missing, self.span) / self.strength_length
        return np.where(near, np.sin(half), np.cos(half))

    @cached_property
    def _reach(self) -> Array:
        """D."""
        return np.hypot(self._sine, np.sinh(self.half_rise))

    @cached_property
    def _mean_area_ratio(self) -> Array:
        """Geometric mean of the ratios at A and B."""
        return self._reach / (self._sine * self._cosine)
