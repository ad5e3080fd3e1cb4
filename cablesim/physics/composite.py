"""Composite line: sections of different weight in series, each an arc of its own catenary (docs/models.md, M8).

Notation: horizontal tension H, the same everywhere; vertical tension V, growing by the weight tau = w l over a section;
T = sqrt(H^2 + V^2). With 1 and 2 the ends of a section, S = (T_1 + T_2) / 2 and q = tau / (T_1 + T_2),

    x = l (H / S) atanh(q) / q,  z = l (V_1 + V_2) / (2 S),                                       (C2)
    dz/dV = l (H^2 + T_1 T_2 - V_1 V_2) / (2 S T_1 T_2).

These keep their digits for short, light and nearly straight sections: atanh(q) is half the change of asinh(V / H).
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.compiled import compiled

# atanh(q)/q - 1 = sum of q^(2n)/(2n+1), n >= 1; at q = SERIES_LIMIT the fourteenth term is 1e-16 of the first.
SERIES = tuple(1.0 / (2 * n + 1) for n in range(13, 0, -1))
SERIES_LIMIT = 0.25


@compiled
def tension_less(tension, vertical, horizontal):
    """T - V."""
    return tension - vertical if vertical <= 0.0 else horizontal * horizontal / (tension + vertical)


@compiled
def turn_excess(horizontal, vertical_1, vertical_2, tension_1, tension_2, weight):
    """atanh(q)/q - 1 of a section."""
    q = weight / (tension_1 + tension_2)
    if q < SERIES_LIMIT:
        square, total = q * q, 0.0
        for coefficient in SERIES:
            total = square * (total + coefficient)
        return total
    rest = tension_less(tension_1, -vertical_1, horizontal) + tension_less(tension_2, vertical_2, horizontal)
    return 0.5 * np.log1p(2.0 * weight / rest) / q - 1.0


@compiled
def extent(length, weight, horizontal, vertical_1, vertical_2):
    """x and z over a section, and the tension at its far end."""
    tension_1 = np.sqrt(horizontal * horizontal + vertical_1 * vertical_1)
    tension_2 = np.sqrt(horizontal * horizontal + vertical_2 * vertical_2)
    share = 2.0 * length / (tension_1 + tension_2)
    turn = turn_excess(horizontal, vertical_1, vertical_2, tension_1, tension_2, weight)
    return share * horizontal * (1.0 + turn), 0.5 * share * (vertical_1 + vertical_2), tension_2


@dataclass(frozen=True)
class CompositeLine:
    """Solved lines; each quantity is computed when it is first asked for.

    `section_length` and `section_weight` (scenario, section) are NaN beyond the `sections` of a line, and so is
    `vertical` (scenario, section + 1), the vertical tension at A and at the far end of every section. `distance` and
    `rise` are those that were asked for, where they were (else None): the line meets them to rounding.
    """

    nodes: int
    section_length: Array
    section_weight: Array
    sections: np.ndarray
    horizontal_tension: Array
    vertical: Array
    rise: Array
    distance: Array | None = None

    @cached_property
    def horizontal_distance(self) -> Array:
        return self._ends[:, 0] if self.distance is None else self.distance

    @cached_property
    def tension_A(self) -> Array:
        return self._joint_tension[:, 0]

    @cached_property
    def tension_B(self) -> Array:
        return self._joint_tension[np.arange(self.sections.size), self.sections]

    @cached_property
    def max_tension(self) -> Array:
        """At an end: the vertical tension grows from A to B."""
        return np.maximum(self.tension_A, self.tension_B)

    @cached_property
    def lowest_point(self) -> Array:
        return self._embedded(self._extremes[:, :2])

    @property
    def vertex_s(self) -> Array:
        return self._extremes[:, 2]

    @property
    def vertex_section(self) -> Array:
        return self._extremes[:, 3]

    @property
    def closing_error(self) -> Array:
        """How far B is from the height that it should have."""
        return np.abs(self._ends[:, 1] - self.rise)

    @property
    def joint_tension(self) -> Array:
        return self._joint_tension[:, 1:]

    @cached_property
    def joint_position(self) -> Array:
        return self._embedded(self._joints)

    @property
    def profile(self) -> Array:
        """Nodes at equal steps of length."""
        return self._embedded(self._shape[:, :, :2])

    @property
    def profile_tension(self) -> Array:
        return self._shape[:, :, 2]

    @property
    def profile_section(self) -> Array:
        return self._shape[:, :, 3]

    @cached_property
    def _joint_tension(self) -> Array:
        return np.hypot(self.horizontal_tension[:, None], self.vertical)

    @cached_property
    def _joints(self) -> Array:
        """x and z at the far end of every section."""
        found = np.full((*self.section_length.shape, 2), np.nan)
        _joints(*self._state, found)
        return found

    @cached_property
    def _ends(self) -> Array:
        return self._joints[np.arange(self.sections.size), self.sections - 1]

    @cached_property
    def _extremes(self) -> Array:
        """x and z of the lowest point, arc length and section of the vertex."""
        found = np.empty((self.sections.size, 4))
        _extremes(*self._state, found)
        return found

    @cached_property
    def _shape(self) -> Array:
        """x, z, tension and number of the section at every node."""
        found = np.empty((self.sections.size, self.nodes, 4))
        _shapes(*self._state, found)
        return found

    @property
    def _state(self) -> tuple[Array, Array, np.ndarray, Array, Array]:
        return self.section_length, self.section_weight, self.sections, self.horizontal_tension, self.vertical

    @staticmethod
    def _embedded(plane: Array) -> Array:
        """x and z as x, y and z; y is missing where they are."""
        x, z = plane[..., 0], plane[..., 1]
        return np.stack([x, np.where(np.isnan(x), np.nan, 0.0), z], axis=-1)


@compiled
def _joints(lengths, weights, sections, horizontal, vertical, found):
    for i in range(sections.size):
        x, z = 0.0, 0.0
        for j in range(sections[i]):
            weight = weights[i, j] * lengths[i, j]
            dx, dz, _ = extent(lengths[i, j], weight, horizontal[i], vertical[i, j], vertical[i, j + 1])
            x, z = x + dx, z + dz
            found[i, j, 0], found[i, j, 1] = x, z


@compiled
def _extremes(lengths, weights, sections, horizontal, vertical, found):
    for i in range(sections.size):
        last = sections[i]
        if vertical[i, 0] >= 0.0:
            found[i, :2] = 0.0
            found[i, 2] = -vertical[i, 0] / weights[i, 0]
            found[i, 3] = 0.0 if vertical[i, 0] > 0.0 else 1.0
            continue
        x, z, s = 0.0, 0.0, 0.0
        for j in range(last):
            length, above = lengths[i, j], vertical[i, j + 1] >= 0.0
            if above:
                length = -vertical[i, j] / weights[i, j]
            end = 0.0 if above else vertical[i, j + 1]
            dx, dz, _ = extent(length, weights[i, j] * length, horizontal[i], vertical[i, j], end)
            x, z, s = x + dx, z + dz, s + length
            found[i, 3] = j + 1
            if above:
                break
        if vertical[i, last] < 0.0:
            s -= vertical[i, last] / weights[i, last - 1]
            found[i, 3] = last + 1
        found[i, 0], found[i, 1], found[i, 2] = x, z, s


@compiled
def _shapes(lengths, weights, sections, horizontal, vertical, found):
    nodes = found.shape[1]
    for i in range(sections.size):
        total = 0.0
        for j in range(sections[i]):
            total += lengths[i, j]
        x, z, s, j = 0.0, 0.0, 0.0, 0
        found[i, 0] = (0.0, 0.0, np.sqrt(horizontal[i] ** 2 + vertical[i, 0] ** 2), 1.0)
        for k in range(1, nodes):
            here = total * k / (nodes - 1) - s
            while j < sections[i] - 1 and (here > lengths[i, j] or k == nodes - 1):
                weight = weights[i, j] * lengths[i, j]
                dx, dz, _ = extent(lengths[i, j], weight, horizontal[i], vertical[i, j], vertical[i, j + 1])
                x, z, s, here, j = x + dx, z + dz, s + lengths[i, j], here - lengths[i, j], j + 1
            if k == nodes - 1:
                here = lengths[i, j]
            weight = weights[i, j] * here
            end = vertical[i, j + 1] if k == nodes - 1 else vertical[i, j] + weight
            dx, dz, tension = extent(here, weight, horizontal[i], vertical[i, j], end)
            found[i, k, 0], found[i, k, 1], found[i, k, 2], found[i, k, 3] = x + dx, z + dz, tension, j + 1.0
