"""Hanging line between two supports: exact, elastic and approximate shapes (docs/models.md, equations M1-M6).

Notation: span l, rise h = z_B - z_A, unstretched length L, weight per length w, axial stiffness EA; W = w L / 2 is half
the weight and e = W / EA its strain. Along the line the slope is dz/dx = sinh(u), and u grows from u_A = mu - lambda
to u_B = mu + lambda. The two equations of the elastic catenary (M6) then read

    tanh(mu) = (h / L) / (1 + e coth(lambda)),    sech(mu) = (l / L) sinh(lambda) / (lambda + e),    (C1)

and H = W (l / L) / (lambda + e). With e = 0 this is the inextensible catenary (M2): sinh(lambda) / lambda = k with
k = sqrt(L^2 - h^2) / l. Everything below is written so that nothing cancels, from lines 1e-12 longer than their chord
to 1e6 spans.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.hyperbolic import asinh_increment, cosh_excess, cosh_sinhc_difference, sinhc_excess
from cablesim.numerics.roots import Roots, newton_bracketed
from cablesim.physics.curve import HangingCurve, Shape


@dataclass(frozen=True)
class Catenary(HangingCurve):
    """A solved catenary, arrays of one entry per scenario; each quantity is computed when it is first asked for.

    `half_angle` is lambda; `strain` is e, the float 0 for the inextensible line; `ratio_excess` is
    sinh(lambda) / lambda - 1 where it is known already.
    """

    rise: Array
    line_length: Array
    half_angle: Array
    strain: Array | float = 0.0
    ratio_excess: Array | None = None

    @cached_property
    def catenary_parameter(self) -> Array:
        return self.span / (2.0 * (self.half_angle + self.strain))

    @cached_property
    def horizontal_tension(self) -> Array:
        return self.weight_per_length * self.catenary_parameter

    @cached_property
    def tension_A(self) -> Array:
        return self.horizontal_tension * np.cosh(self.mean_angle - self.half_angle)

    @cached_property
    def tension_B(self) -> Array:
        return self.horizontal_tension * np.cosh(self.mean_angle + self.half_angle)

    @cached_property
    def max_tension(self) -> Array:
        return np.maximum(self.tension_A, self.tension_B)

    @cached_property
    def drop(self) -> Array:
        rigid = self.catenary_parameter * cosh_excess(self._upper_angle)
        if self._inextensible:
            return rigid
        return rigid + 0.5 * self.catenary_parameter * self._stretch * np.sinh(self._upper_angle) ** 2

    @cached_property
    def vertex_x(self) -> Array:
        rigid = self.catenary_parameter * (self.half_angle - self.mean_angle)
        if self._inextensible:
            return rigid
        return rigid + self.catenary_parameter * self._stretch * np.sinh(self.half_angle - self.mean_angle)

    @cached_property
    def sag(self) -> Array:
        """Greatest vertical distance below the chord, where the line is parallel to it.

        Measured from the support on the side where the sum has positive terms only: phi is the change of u from the
        point to that support.
        """
        phi = self.half_angle - np.abs(self._parallel_angle)
        chord_slope = np.abs(self.rise / self.span)
        secant = np.sqrt(1.0 + chord_slope * chord_slope)
        rigid = self.catenary_parameter * (secant * cosh_excess(phi) + chord_slope * phi * sinhc_excess(phi))
        if self._inextensible:
            return rigid
        slope_change = secant * np.sinh(phi) + chord_slope * cosh_excess(phi)
        return rigid + 0.5 * self.catenary_parameter * self._stretch * slope_change * slope_change

    @cached_property
    def stretched_length(self) -> Array:
        """L + (1/EA) * integral of T ds = L + (H^2 / 2 w EA) (2 lambda + sinh(2 lambda) cosh(2 mu))."""
        if self._inextensible:
            return self.line_length
        arc = 2.0 * self.half_angle + np.sinh(2.0 * self.half_angle) * np.cosh(2.0 * self.mean_angle)
        return self.line_length + 0.5 * self.catenary_parameter * self._stretch * arc

    @cached_property
    def mean_angle(self) -> Array:
        """mu, the mean of u at the two supports."""
        return np.arcsinh(self._mean_slope)

    @cached_property
    def shape(self) -> Shape:
        """Nodes at equal steps of unstretched length."""
        fraction = np.linspace(0.0, 1.0, self.nodes)
        a, stretch = self.catenary_parameter[:, None], self._stretch[:, None]
        angle_A = (self.mean_angle - self.half_angle)[:, None]
        slope_A = np.sinh(angle_A)
        slope_step = (self.line_length / self.catenary_parameter)[:, None] * fraction
        turn = asinh_increment(slope_A, slope_step)
        slope = slope_A + slope_step
        x = a * (turn + stretch * slope_step)
        z = a * (
            2.0 * np.sinh(angle_A + 0.5 * turn) * np.sinh(0.5 * turn) + 0.5 * stretch * slope_step * (slope + slope_A)
        )
        return Shape(x, z, self.horizontal_tension[:, None] * np.sqrt(1.0 + slope * slope))

    @property
    def _inextensible(self) -> bool:
        return isinstance(self.strain, float)

    @cached_property
    def _stretch(self) -> Array:
        """H / EA."""
        return self.catenary_parameter * self.strain / (0.5 * self.line_length)

    @cached_property
    def _mean_slope(self) -> Array:
        """sinh(mu) = (h / l) (lambda + e) / (sinh lambda + e cosh lambda)."""
        taut = self.half_angle + self.strain
        return self.rise / self.span * (taut / (taut + self._lag))

    @cached_property
    def _slope_deficit(self) -> Array:
        """1 - sinh(mu) / (h / l): how much less the line leans at mid-angle than its chord; small when taut."""
        return self._lag / (self.half_angle + self.strain + self._lag)

    @cached_property
    def _lag(self) -> Array:
        """sinh lambda + e cosh lambda - (lambda + e)."""
        ratio_excess = sinhc_excess(self.half_angle) if self.ratio_excess is None else self.ratio_excess
        rigid = self.half_angle * ratio_excess
        return rigid if self._inextensible else rigid + self.strain * cosh_excess(self.half_angle)

    @cached_property
    def _parallel_angle(self) -> Array:
        """asinh(h / l) - mu: u where the line is parallel to its chord, measured from the mean."""
        return asinh_increment(self._mean_slope, self.rise / self.span * self._slope_deficit)

    @cached_property
    def _upper_angle(self) -> Array:
        """|u| at the upper support."""
        return np.abs(self.mean_angle) + self.half_angle


def elastic_half_angle(excess: Array, span: Array, rise: Array, line_length: Array, strain: Array) -> Roots:
    """lambda of the elastic catenary; `excess` is L^2 - l^2 - h^2, negative for a line shorter than its chord.

    Eliminating mu from (C1) leaves h^2 / (1 + e coth lambda)^2 + l^2 sinh^2 lambda / (lambda + e)^2 = L^2, whose left
    side grows with lambda: one root for every e > 0. With rho = e / lambda, g = sinh(lambda) / lambda - 1,
    q = lambda coth(lambda) - 1 and p = rho q / (1 + rho), left side minus right side is, free of cancellation,

        (l^2 g (2 + g) - h^2 p (2 + p) / (1 + p)^2 - excess - L^2 rho (2 + rho)) / (1 + rho)^2.

    What is solved is log(left side / right side) = 0: smooth, and nearly linear in log(lambda) for taut lines.
    """
    length_2, rise_2, excess = (line_length / span) ** 2, (rise / span) ** 2, excess / span**2

    def equation(x: Array, which: np.ndarray) -> tuple[Array, Array]:
        rho, g = strain[which] / x, sinhc_excess(x)
        q = cosh_sinhc_difference(x) / (1.0 + g)
        p = rho * q / (1.0 + rho)
        vertical = rise_2[which] / (1.0 + p) ** 2
        horizontal = (1.0 + g) ** 2
        difference = g * (2.0 + g) - vertical * p * (2.0 + p) - excess[which] - length_2[which] * rho * (2.0 + rho)
        value = np.log1p(difference / (length_2[which] * (1.0 + rho) ** 2))
        vertical_slope = vertical * rho / (horizontal * (1.0 + rho) * (1.0 + p))
        horizontal_slope = horizontal * (q + rho / (1.0 + rho))
        return value, 2.0 * (vertical_slope + horizontal_slope) / (vertical + horizontal)

    chord = np.sqrt(1.0 + rise_2)
    return newton_bracketed(equation, *_elastic_bracket(chord, np.sqrt(length_2), excess, strain))


def _elastic_bracket(chord: Array, length: Array, excess: Array, strain: Array) -> tuple[Array, Array, Array]:
    """Low, high and start for lambda, lengths in spans.

    Low: for lambda <= 1, sinh(lambda) <= 1.1753 lambda, so the left side is at most (1.1753 chord / (1 + rho))^2.
    High: l sinh(lambda) <= L (lambda + e), iterated from above. The start is the largest or smallest of three limits:
    slack rigid, taut elastic (Hooke's spring), and in between.
    """
    reach = length / (1.1753 * chord)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        low = np.where(reach < 1.0, np.minimum(1.0, strain * reach / (1.0 - reach)), 1.0) * 0.999
        log_ratio = 0.5 * np.log1p(np.maximum(excess, 0.0))
        slack = np.sqrt(log_ratio * (6.0 + 1.2 * log_ratio))
        taut = np.where(excess < 0.0, strain * length * (chord + length) / np.maximum(-excess, 1e-300), np.inf)
    high = np.full_like(low, 700.0)
    for _ in range(6):
        high = np.arcsinh(length * (high + strain))
    start = np.minimum(np.maximum(slack, np.cbrt(6.0 * length**2 * strain)), taut)
    low, high = np.minimum(low, 0.999 * start), 1.001 * high
    return low, high, np.clip(start, low, high)
