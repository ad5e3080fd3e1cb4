"""Judges of a line in waves at rest: the equilibrium that it starts from, from its places and tensions alone.

The tensions of the elements follow from those at the nodes, which are means of two, by one number that leaves the
least force over; so an equilibrium is judged without the law of the line, and the law by itself.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cablesim.batch import Results
from cablesim.hunt._case import Case
from cablesim.hunt._wave_lines import given_or_standard
from cablesim.numerics import Array
from cablesim.physics.waves import GRAVITY

OUTPUTS = (
    "profile",
    "profile_tension",
    "static_anchor_tension",
    "static_middle_tension",
    "static_top_tension",
    "max_top_tension",
)
# A march so short, in periods, that it costs nothing; only what there is before it is looked at.
MOMENT = 1e-3
# Newton's method leaves 1e-10 of the largest tension, and the nodes are many.
LEFT_OVER = 1e-9
# Roundings of a place that enter a length; and part of a line's length within which its ends are met.
ROUNDINGS, CLOSING = 16.0 * np.finfo(float).eps, 1e-13


@dataclass(frozen=True)
class Rest:
    """Lines at rest, by scenario."""

    given: dict[str, Array]
    outputs: dict[str, Array]

    @cached_property
    def profile(self) -> Array:
        return self.outputs["profile"]

    @property
    def count(self) -> int:
        return self.profile.shape[1] - 1

    @cached_property
    def piece(self) -> Array:
        """Unstretched length of an element (scenario, 1)."""
        chord = self.given["depth"] / np.sin(self.given["chord_angle"])
        return (self.given["length_ratio"] * chord / self.count)[:, None]

    @cached_property
    def lengths(self) -> Array:
        return np.linalg.norm(np.diff(self.profile, axis=1), axis=2)

    @cached_property
    def tangents(self) -> Array:
        return np.diff(self.profile, axis=1) / self.lengths[:, :, None]

    @cached_property
    def loads(self) -> Array:
        """Weight and drag of the stream on every element (scenario, element, 3)."""
        g = self.given
        heading, speed = g["heading"], g["stream_speed"]
        stream = (speed * [np.cos(heading), np.sin(heading), 0.0 * heading]).T[:, None]
        along = (stream * self.tangents).sum(axis=2, keepdims=True) * self.tangents
        across = stream - along
        drag = g["normal_drag"][:, None, None] * np.linalg.norm(across, axis=2, keepdims=True) * across
        drag = drag + g["tangential_drag"][:, None, None] * np.linalg.norm(along, axis=2, keepdims=True) * along
        weight = (g["mass_per_length"] - g["fluid_density"] * g["area"]) * GRAVITY
        return self.piece[:, :, None] * (drag - weight[:, None, None] * [0.0, 0.0, 1.0])

    @cached_property
    def tensions(self) -> Array:
        """Of the elements (scenario, element)."""
        sign = (-1.0) ** np.arange(self.count)
        means = self.outputs["profile_tension"][:, 1:-1]
        part = sign * np.concatenate([0.0 * self.piece, np.cumsum(-2.0 * sign[:-1] * means, axis=1)], axis=1)
        fixed, free = self._left_over(part) + self._node_loads, self._left_over(sign + 0.0 * part)
        share = -(fixed * free).sum(axis=(1, 2)) / (free * free).sum(axis=(1, 2))
        return part + share[:, None] * sign

    @property
    def _node_loads(self) -> Array:
        return 0.5 * (self.loads[:, 1:] + self.loads[:, :-1])

    def _left_over(self, tensions: Array) -> Array:
        """What tensions leave over at the inner nodes (scenario, node, 3)."""
        return np.diff(tensions[:, :, None] * self.tangents, axis=1)

    @cached_property
    def left_over(self) -> Array:
        return self._left_over(self.tensions) + self._node_loads

    @cached_property
    def rounding(self) -> Array:
        """What a strain may be off (scenario, 1) because places are rounded and ends are met so closely only."""
        return ROUNDINGS + (ROUNDINGS + CLOSING) * self.lengths.sum(axis=1)[:, None] / self.piece

    @cached_property
    def size(self) -> Array:
        """Largest force that there is (scenario,)."""
        largest = np.maximum(self.outputs["profile_tension"].max(axis=1), self.outputs["static_top_tension"])
        return np.maximum(largest, np.linalg.norm(self.loads, axis=2).max(axis=1))


def at_rest(case: Case) -> Rest:
    """Lines before they are moved; NaN is what is not known of those that are not solved."""
    period = case.parameters["wave_period"]
    found = case.solve(OUTPUTS, duration=MOMENT * period)
    return Rest(given_or_standard(case.parameters), found.outputs)


def over(values: Array, allowed: Array) -> Array:
    """Values in units of what is allowed; nothing is no miss, whatever is allowed."""
    return np.divide(values, allowed, out=np.zeros(np.broadcast(values, allowed).shape), where=values != 0.0)


def balance(case: Case, found: Results) -> Array:
    """Forces on every inner node, over the largest there is."""
    rest = at_rest(case)
    left = np.linalg.norm(rest.left_over, axis=2).max(axis=1)
    return over(left, (LEFT_OVER + rest.count * ROUNDINGS) * rest.size)


def closure(case: Case, found: Results) -> Array:
    """The ends of the line are where anchor and top are, within the rounding of its places."""
    rest = at_rest(case)
    depth, angle = rest.given["depth"], rest.given["chord_angle"]
    top = np.column_stack([depth * np.cos(angle) / np.sin(angle), 0.0 * depth, depth])
    miss = np.linalg.norm(rest.profile[:, -1] - top, axis=1) + np.linalg.norm(rest.profile[:, 0], axis=1)
    return miss / (ROUNDINGS * np.linalg.norm(top, axis=1))


def law(case: Case, found: Results) -> Array:
    """Every element pulls by the law of the line at its length, but for the rounding and closing of that."""
    rest = at_rest(case)
    linear = rest.given["linear_stiffness"][:, None]
    quadratic = linear * rest.given["stiffness_ratio"][:, None]
    taut = np.maximum(rest.lengths / rest.piece - 1.0, 0.0)
    slope = linear + 2.0 * np.abs(quadratic) * (taut + rest.rounding)
    allowed = LEFT_OVER * rest.size[:, None] + slope * rest.rounding
    return over(np.abs(rest.tensions - (linear + quadratic * taut) * taut), allowed).max(axis=1)


def supports(case: Case, found: Results) -> Array:
    """Anchor and top carry the tension of their elements and half the load on these, and the middle its tension."""
    rest = at_rest(case)
    n = rest.count
    first = np.linalg.norm(rest.tensions[:, :1] * rest.tangents[:, 0] + 0.5 * rest.loads[:, 0], axis=1)
    last = np.linalg.norm(-rest.tensions[:, -1:] * rest.tangents[:, -1] + 0.5 * rest.loads[:, -1], axis=1)
    middle = 0.5 * (rest.tensions[:, (n - 1) // 2] + rest.tensions[:, n // 2])
    said = [found.outputs[f"static_{place}_tension"] for place in ("anchor", "middle", "top")]
    miss = np.abs(np.array([first, middle, last]) - said).max(axis=0)
    return over(miss, (LEFT_OVER + rest.count * ROUNDINGS) * rest.size)


def no_compression(case: Case, found: Results) -> Array:
    """No element pushes; those of which the tension is nothing but rounding are without."""
    rest = at_rest(case)
    return over(np.maximum(-rest.tensions, 0.0).max(axis=1), (LEFT_OVER + rest.count * ROUNDINGS) * rest.size)
