"""Approximate formulas for a line between supports at one level (docs/models.md, M4): of L - l and l alone.

All start from a power series of the catenary in l / a (paper, equations 12 and 13),

    y = x^2 / 2a + x^4 / 24a^3 + ...,    L = l + l^3 / 24a^2 + l^5 / 1920a^4 + ...,

and differ in how much of it they keep. Source: "Comparison of experimental and theoretical catenary lines", Automobile,
Road, Infrastructure (electronic journal), equations 1-2 and 12-18.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cablesim.numerics import Array
from cablesim.physics.curve import HangingCurve, Shape


@dataclass(frozen=True)
class LevelCurve(HangingCurve):
    """A curve y = x^2 / 2a + quartic * x^4 about its lowest point, symmetric between level supports."""

    catenary_parameter: Array
    sag: Array
    max_tension: Array
    quartic: Array

    @property
    def horizontal_tension(self) -> Array:
        return self.weight_per_length * self.catenary_parameter

    @property
    def tension_A(self) -> Array:
        return self.max_tension

    @property
    def tension_B(self) -> Array:
        return self.max_tension

    @property
    def drop(self) -> Array:
        return self.sag

    @property
    def vertex_x(self) -> Array:
        return 0.5 * self.span

    @cached_property
    def shape(self) -> Shape:
        """Nodes at equal horizontal steps; tension w sqrt(a^2 + x^2) or, with the quartic term, w (a + y)."""
        x = self.span[:, None] * (np.linspace(0.0, 1.0, self.nodes) - 0.5)
        a = self.catenary_parameter[:, None]
        y = x * x / (2.0 * a) + self.quartic[:, None] * x**4
        parabolic = np.sqrt(a * a + x * x)
        tension = self.weight_per_length[:, None] * np.where(self.quartic[:, None] == 0.0, parabolic, a + y)
        return Shape(x + 0.5 * self.span[:, None], y - self.sag[:, None], tension)


def parabolic(nodes: int, span: Array, weight_per_length: Array, slack: Array) -> LevelCurve:
    """L = l + 8 f^2 / 3l; `slack` is L - l."""
    return _parabola(nodes, span, weight_per_length, sag=np.sqrt(6.0 * span * slack) / 4.0)


def handbook(nodes: int, span: Array, weight_per_length: Array, slack: Array) -> LevelCurve:
    """L = l + 16 f^2 / 3l: wrong by a factor of two in the second term, and printed in a handbook."""
    return _parabola(nodes, span, weight_per_length, sag=np.sqrt(3.0 * span * slack) / 4.0)


def series(nodes: int, span: Array, weight_per_length: Array, slack: Array) -> LevelCurve:
    """Both series to their second term: y^2/120 + y/6 = L/l - 1 for y = (l/2a)^2, and T_max = w (a + f)."""
    excess = slack / span
    half_angle = np.sqrt(2.0 * excess / (1.0 / 6.0 + np.sqrt(1.0 / 36.0 + excess / 30.0)))
    a = span / (2.0 * half_angle)
    quartic = 1.0 / (24.0 * a**3)
    sag = span**2 / (8.0 * a) + quartic * (0.5 * span) ** 4
    return LevelCurve(nodes, span, weight_per_length, a, sag, weight_per_length * (a + sag), quartic)


def _parabola(nodes: int, span: Array, weight_per_length: Array, sag: Array) -> LevelCurve:
    """H = w l^2 / 8f and T_max = (w l / 2) sqrt(1 + l^2 / 16 f^2)."""
    a = span**2 / (8.0 * sag)
    max_tension = 0.5 * weight_per_length * span * np.sqrt(1.0 + (span / (4.0 * sag)) ** 2)
    return LevelCurve(nodes, span, weight_per_length, a, sag, max_tension, np.zeros_like(sag))


Formula = Callable[[int, Array, Array, Array], LevelCurve]
FORMULAS: dict[str, Formula] = {"parabolic": parabolic, "series": series, "handbook": handbook}
