"""A line that was built for equal strength, under another horizontal force than it was designed for.

Notation of `cablesim.physics.equal_strength`; tensions are over the horizontal force of the design. The line keeps its
cross-sections and weight, so the vertical tension grows along it as in the design, V = sinh(u) + c, while the
horizontal one is r. The stress over the permitted one is T / cosh(u) with T = sqrt(r^2 + V^2), and is stationary where

    c S^2 + (r^2 + c^2 - 1) S - c = 0,  S = sinh(u);                                                               (E3)

of the two roots the one with the sign of c is a maximum, the other a minimum.

Every line is seen so that its second end is the higher one. A place on it is d = u - u_0 from its thinnest place u_0,
the vertex of the design or the first end, because neither weight nor cross-section loses digits there.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.compiled import compiled
from cablesim.physics.equal_strength import EqualStrengthLine

# Instead of zero, where a quotient of nothing by nothing is to be nothing.
TINY = 1e-300


@compiled
def weight_to(place, thinnest):
    """Weight of the line from its thinnest place to another one, negative before it."""
    return 2.0 * np.cosh(thinnest + 0.5 * place) * np.sinh(0.5 * place)


@compiled
def area_at(place, thinnest):
    """Cross-section over the one that carries the horizontal force of the design alone."""
    return np.cosh(thinnest + place)


@dataclass(frozen=True)
class BuiltLine:
    """Lines as they were built, and the horizontal force on them over that of the design."""

    design: EqualStrengthLine
    force_ratio: Array

    @cached_property
    def falling(self) -> np.ndarray:
        """Where B is the lower end, and so the first one as the line is seen."""
        return self.design.rise < 0.0

    @cached_property
    def thinnest(self) -> Array:
        """u_0."""
        return np.maximum(self._first, 0.0)

    @cached_property
    def low(self) -> Array:
        """Place of the first end."""
        return np.minimum(self._first, 0.0)

    @cached_property
    def high(self) -> Array:
        """Place of the second end."""
        return self.low + 2.0 * self.design.half_angle

    @cached_property
    def steepness(self) -> Array:
        """V / r of a straight line to the second end, as long as this one, from tanh: |h| / L = |e| / lambda."""
        half_rise, half_angle = np.abs(self.design.half_rise), self.design.half_angle
        return half_rise / np.sqrt(self.design.slack * (half_angle + half_rise))

    def from_first(self, fractions: Array) -> Array:
        """Fractions of the length from A, as counted from the first end; (scenario, place)."""
        return np.where(self.falling[:, None], 1.0 - fractions, fractions)

    def places(self, from_first: Array) -> Array:
        """Places of fractions of the length from the first end; (scenario, place)."""
        return np.minimum(self.low[:, None] + 2.0 * self.design.half_angle[:, None] * from_first, self.high[:, None])

    def weights(self, places: Array) -> Array:
        """Weight from the thinnest place; (scenario, place)."""
        return weight_to(places, self.thinnest[:, None])

    def stresses(self, places: Array, vertical: Array) -> Array:
        """Stress over the permitted one, of vertical tensions at places; (scenario, place)."""
        return np.hypot(self.force_ratio[:, None], vertical) / area_at(places, self.thinnest[:, None])

    def highest_stress_place(self, vertical: Array) -> Array:
        """Place of the maximum of the stress (E3), or the end nearer to it; `vertical` is at the thinnest place."""
        c = vertical - np.sinh(self.thinnest)
        q = (self.force_ratio - 1.0) * (self.force_ratio + 1.0) + c * c
        root = np.hypot(q, 2.0 * c)
        rising = 2.0 * np.abs(c) / np.maximum(q + root, TINY)
        slope = np.where(q >= 0.0, rising, (root - q) / np.maximum(2.0 * np.abs(c), TINY))
        return np.clip(np.copysign(np.arcsinh(slope), c) - self.thinnest, self.low, self.high)

    def profile(self, x: Array, z: Array) -> Array:
        """Nodes from A to B, of x and z along the line as it is seen, from its first end; (scenario, node)."""
        falling = self.falling[:, None]
        across, up = (np.where(falling, values[:, -1:] - values[:, ::-1], values) for values in (x, z))
        return np.stack([across, np.zeros_like(across), np.where(falling, -up, up)], axis=-1)

    @cached_property
    def _first(self) -> Array:
        return np.abs(self.design.mean_angle) - self.design.half_angle
