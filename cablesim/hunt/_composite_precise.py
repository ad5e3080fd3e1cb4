"""Lines of sections in floats of 64 bits of mantissa, and how far the rounding of a double moves them.

A second method: every section by the catenary's own functions, the height met by halving, the distance by Newton's
steps. There is one solution only, so that whatever is found is the one.
"""

from dataclasses import dataclass

import numpy as np

from cablesim.hunt._composite_laws import Lines, length, number, weight
from cablesim.numerics import Array

# A bracket of the vertical tension is halved so often that nothing is left of it in a long double.
HALVINGS = 70
# Newton's steps in log H from an answer: each of them doubles the digits. None is longer than this.
NEWTON_STEPS, LONGEST = 5, 2.0
# Below this atanh(q) / q keeps its digits, above it the difference of two asinh does.
SMALL_TURN = 0.25
# A turn at which it is 1, for arcs of no length.
FAINTEST = 1e-300
EPS = float(np.finfo(float).eps)
LONG_EPS = float(np.finfo(np.longdouble).eps)


def longer(line: Lines) -> Lines:
    """The same numbers with room for more digits."""
    return {name: np.asarray(values, dtype=np.longdouble) for name, values in line.items()}


@dataclass(frozen=True)
class Hung:
    """Lines as they hang from given horizontal tensions (scenario, 1) and vertical tensions (scenario, joint)."""

    line: Lines
    H: Array
    V: Array

    @property
    def T(self) -> Array:
        return np.hypot(self.H, self.V)

    @property
    def x(self) -> Array:
        """Horizontal extent of every section."""
        s, w, T = self.line["section_length"], self.line["section_weight"], self.T
        both = T[:, 1:] + T[:, :-1]
        q = w * s / both
        gentle = np.clip(q, FAINTEST, SMALL_TURN)
        bent = 2.0 * s * self.H / both * np.arctanh(gentle) / gentle
        turned = self.H / w * np.diff(np.arcsinh(self.V / self.H), axis=1)
        return np.where(q < SMALL_TURN, bent, turned)

    @property
    def z(self) -> Array:
        """Rise of every section."""
        T = self.T
        return self.line["section_length"] * (self.V[:, 1:] + self.V[:, :-1]) / (T[:, 1:] + T[:, :-1])

    @property
    def distance(self) -> Array:
        return np.nansum(self.x, axis=1)

    @property
    def height(self) -> Array:
        return np.nansum(self.z, axis=1)

    def rates(self) -> tuple[Array, Array, Array]:
        """How x grows with H, x with V or z with H, and z with V, all at the other held."""
        (T_1, T_2), (V_1, V_2) = ((ends[:, :-1], ends[:, 1:]) for ends in (self.T, self.V))
        share, square = self.line["section_length"] / (T_1 * T_2 * (T_1 + T_2)), self.H**2
        # T_1 T_2 - V_1 V_2 + H^2, which cancels where the line is steep.
        same_side = square * (1.0 + (square + V_1**2 + V_2**2) / (T_1 * T_2 + np.maximum(V_1 * V_2, 0.0)))
        z_V = share * np.where(V_1 * V_2 > 0.0, same_side, T_1 * T_2 - V_1 * V_2 + square)
        x_V = -share * self.H * (V_1 + V_2)
        return np.nansum(self.x / self.H - z_V, axis=1), np.nansum(x_V, axis=1), np.nansum(z_V, axis=1)

    def stiffness(self) -> Array:
        """How x grows with H while B stays at its height."""
        x_H, x_V, z_V = self.rates()
        return x_H - x_V * x_V / z_V

    def places(self) -> Array:
        """x and z of A and of the far end of every section."""
        return np.pad(np.cumsum(np.stack([self.x, self.z], axis=2), axis=1), ((0, 0), (1, 0), (0, 0)))

    def unsure(self, part: float, force: Array) -> Array:
        """How far places may be off: a part of the length, and what an error of a force turns the sections by."""
        s, T = self.line["section_length"], self.T
        return part * length(self.line) + np.nansum(4.0 * s / (T[:, 1:] + T[:, :-1]), axis=1) * force

    def outputs(self) -> Lines:
        """What a solver answers, but for profiles."""
        rows, last = np.arange(len(self.V)), number(self.line)
        T, places = self.T, self.places()
        section, s, lowest = self._vertex(places)
        return {
            "horizontal_tension": self.H[:, 0],
            "horizontal_distance": self.distance,
            "tension_A": T[:, 0],
            "tension_B": T[rows, last],
            "max_tension": np.nanmax(T, axis=1),
            "joint_tension": T[:, 1:],
            "joint_position": places[:, 1:],
            "closing_error": np.abs(self.height - self.line["rise"]),
            "vertex_section": section,
            "vertex_s": s,
            "lowest_point": lowest,
        }

    def _vertex(self, places: Array) -> tuple[Array, Array, Array]:
        """Its section, its place along the line, continued beyond the ends, and the lowest point of the line."""
        rows, last = np.arange(len(self.V)), number(self.line)
        hangs = np.nansum(self.V < 0.0, axis=1)
        own = np.clip(hangs, 1, last) - 1
        w = self.line["section_weight"]
        at = np.pad(np.cumsum(self.line["section_length"], axis=1), ((0, 0), (1, 0)))[rows, own]
        V = self.V[rows, own]
        arc = Hung(
            {"section_length": (-V / w[rows, own])[:, None], "section_weight": w[rows, own][:, None]},
            self.H,
            np.column_stack([V, np.zeros_like(V)]),
        )
        inside = (hangs > 0) & (hangs <= last)
        # The arc of a vertex before A is turned around; nobody looks at it.
        lowest = np.where(hangs[:, None] == 0, 0.0, places[rows, last])
        with np.errstate(invalid="ignore"):
            vertex = places[rows, own] + np.column_stack([arc.x[:, 0], arc.z[:, 0]])
        section = np.where((hangs == 0) & (self.V[:, 0] == 0.0), 1, hangs)
        return section, at - V / w[rows, own], np.where(inside[:, None], vertex, lowest)


def hung_from(line: Lines, H: Array, vertical_A: Array) -> Hung:
    """Lines from the vertical tension at A on."""
    hung = np.cumsum(line["section_weight"] * line["section_length"], axis=1)
    return Hung(line, H[:, None], vertical_A[:, None] + np.pad(hung, ((0, 0), (1, 0))))


def meet_height(line: Lines, H: Array) -> Hung:
    """Lines with this horizontal tension and B at its height, which grows with the vertical tension at A."""
    total, rise = length(line), line["rise"]
    lean = H * rise / np.sqrt((total - rise) * (total + rise))
    low, high = lean - weight(line) * (1.0 + EPS) - np.abs(lean) * EPS, lean + (np.abs(lean) + weight(line)) * EPS
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        above = hung_from(line, H, middle).height > rise
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    return hung_from(line, H, 0.5 * (low + high))


def meet_distance(line: Lines, H: Array, moved: np.ndarray) -> Hung:
    """Lines between their ends, found from a horizontal tension that is nearly right; it is moved where asked."""
    for _ in range(NEWTON_STEPS):
        hung = meet_height(line, H)
        step = (line["horizontal_distance"] - hung.distance) / (hung.stiffness() * H)
        H = np.where(moved, H * np.exp(np.clip(step, -LONGEST, LONGEST)), H)
    return meet_height(line, H)
