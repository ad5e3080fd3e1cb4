"""The judge of profiles: nodes at equal steps of length, each on the arc of its section in longer floats."""

import numpy as np

from cablesim.batch import Results
from cablesim.hunt._case import Case
from cablesim.hunt._composite_judges import PROMISED, answers_of, line_of, reference, worst
from cablesim.hunt._composite_laws import Lines, length, number
from cablesim.hunt._composite_precise import EPS, Hung, longer
from cablesim.numerics import Array

OUTPUTS = ("profile", "profile_tension", "profile_section")
# A node this many roundings of the length from a joint may be in either section.
BESIDE = 8.0


def profile(case: Case, found: Results) -> Array:
    """Places as well as those of joints, tensions as well as theirs, and the right section of every node."""
    shape = longer(case.solve(OUTPUTS).outputs)
    line, answers = line_of(case), answers_of(case, found)
    hung, dH, dV = reference(case.solver, line, answers)
    misses = [_misses(hung, shape, node, dH + dV) for node in range(shape["profile_tension"].shape[1])]
    return worst(*misses)


def _misses(hung: Hung, shape: Lines, node: int, force: Array) -> Array:
    """Of one node of every line."""
    line, rows = hung.line, np.arange(len(force))
    s = length(line) * node / (shape["profile_tension"].shape[1] - 1)
    joints = np.pad(np.cumsum(line["section_length"], axis=1), ((0, 0), (1, 0)))
    own = np.minimum(np.nansum(joints[:, 1:] < s[:, None], axis=1), number(line) - 1)
    arc = _arc(hung, own, s - joints[rows, own])
    place = hung.places()[rows, own] + np.column_stack([arc.x[:, 0], arc.z[:, 0]])
    off = np.max(np.abs(shape["profile"][:, node, ::2] - place), axis=1) / hung.unsure(PROMISED, force)
    T = arc.T[:, 1]
    rounding = BESIDE * EPS * length(line)
    # A node is as long a way from A as sums of lengths are rounded.
    allowed = PROMISED * T + force + rounding * np.nanmax(line["section_weight"], axis=1)
    told = shape["profile_section"][:, node].astype(int) - 1
    right = (joints[rows, told] <= s + rounding) & (s - rounding <= joints[rows, told + 1])
    return np.where(right, worst(off, np.abs(shape["profile_tension"][:, node] - T) / allowed), np.inf)


def _arc(hung: Hung, own: np.ndarray, part: Array) -> Hung:
    """The first part of one section of every line."""
    rows = np.arange(len(own))
    w, V = hung.line["section_weight"][rows, own], hung.V[rows, own]
    piece = {"section_length": part[:, None], "section_weight": w[:, None]}
    return Hung(piece, hung.H, np.column_stack([V, V + w * part]))
