"""Laws that lines of sections hang by, asked of answers: forces counted from the vertex, arcs of catenaries."""

import numpy as np

from cablesim.numerics import Array

Lines = dict[str, np.ndarray]


def length(line: Lines) -> Array:
    return np.nansum(line["section_length"], axis=1)


def weight(line: Lines) -> Array:
    return np.nansum(line["section_length"] * line["section_weight"], axis=1)


def number(line: Lines) -> np.ndarray:
    """How many sections every line has."""
    return np.isfinite(line["section_length"]).sum(axis=1)


def joints(line: Lines) -> Array:
    """Arc length at A and at the far end of every section, NaN beyond the line; shape (scenario, section + 1)."""
    return _from_a(line["section_length"])


def vertical(line: Lines, found: Lines, s: Array) -> Array:
    """Vertical tension at arc lengths (scenario, place): the weight between there and the vertex.

    Summed over what lies between them of every section, so that heavy sections elsewhere do not round it; the end
    sections continue beyond the ends.
    """
    place, w = joints(line), np.nan_to_num(line["section_weight"])
    low, high = place[:, :-1].copy(), place[:, 1:].copy()
    low[:, 0] = -np.inf
    high[np.arange(len(place)), number(line) - 1] = np.inf
    low, high = np.nan_to_num(low, neginf=-np.inf), np.nan_to_num(high, posinf=np.inf)
    return sum(
        w[:, [i]] * (np.clip(s, low[:, [i]], high[:, [i]]) - np.clip(found["vertex_s"], low[:, i], high[:, i])[:, None])
        for i in range(w.shape[1])
    )


def misfits(line: Lines, found: Lines) -> dict[str, Array]:
    """What is left of every condition of equilibrium, relative to the largest tension, or to the length of the line.

    tension: T = hypot(H, V) at every joint and at A, with V the weight from the vertex; rise: w (z_2 - z_1) = T_2 - T_1
    over every section; arc: s^2 - (z_2 - z_1)^2 = (2 a sinh((x_2 - x_1) / 2 a))^2; end: B is where it should be.
    """
    largest, total = found["max_tension"][:, None], length(line)[:, None]
    s, w, H = line["section_length"], line["section_weight"], found["horizontal_tension"][:, None]
    V = vertical(line, found, joints(line))
    T = np.hypot(H, V)
    tension = np.column_stack([found["tension_A"], found["joint_tension"]]) - T
    place = np.pad(found["joint_position"][:, :, [0, 2]], ((0, 0), (1, 0), (0, 0)))
    x, z = np.diff(place, axis=1).transpose(2, 0, 1)
    rise = z - s * (V[:, 1:] + V[:, :-1]) / (T[:, 1:] + T[:, :-1])
    half_turn = 0.5 * x * w / H
    # A place known to 1 of the line is an arc known to cosh(turn / 2) of it.
    arc = (s * s - z * z - (2.0 * H / w * np.sinh(half_turn)) ** 2) / (s * np.cosh(half_turn))
    end = place[np.arange(len(place)), number(line)] - np.column_stack([found["horizontal_distance"], line["rise"]])
    return {
        "tension": np.nanmax(np.abs(tension) / largest, axis=1),
        "rise": np.nanmax(np.abs(rise) / total, axis=1),
        "arc": np.nanmax(np.abs(arc) / total, axis=1),
        "end": np.max(np.abs(end) / total, axis=1),
    }


def _from_a(shares: Array) -> Array:
    return np.pad(np.cumsum(shares, axis=1), ((0, 0), (1, 0)))
