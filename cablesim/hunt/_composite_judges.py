"""Judges of lines of sections: equilibrium, the line from its other end and cut up, and a second, longer method."""

import numpy as np

from cablesim.batch import Results
from cablesim.hunt._case import Case
from cablesim.hunt._composite_laws import Lines, length, misfits, number, vertical, weight
from cablesim.hunt._composite_precise import EPS, LONG_EPS, Hung, hung_from, longer, meet_distance, meet_height
from cablesim.hunt._composite_taut import TAUT, slack, taut_tension
from cablesim.numerics import Array

# The tension of a line so taut that its slack tells it to this part is taken from there.
SECURE = 1e-9
# What `composite_line` promises of its digits; a hundred times what is measured.
PROMISED = 1e-11
# What tests measure of its residuals.
BALANCED = 1e-12
# Up to this ratio of sqrt(L^2 - z^2) to x, slack is counted from the chord, and no digits are lost.
SLACK = 1.05
# A turn beyond which its exponential need not be known.
LARGEST_TURN = 100.0
# Roundings of a sum of sections.
SUMMED = 16.0


def line_of(case: Case) -> Lines:
    """The line that a solver hangs, in longer floats: for one of mean weights, that of those."""
    line = longer(case.parameters)
    line.setdefault("rise", np.zeros(case.size, dtype=np.longdouble))
    if case.solver == "composite_mean_weight":
        mean = (weight(line) / length(line))[:, None]
        line["section_weight"] = np.where(np.isnan(line["section_length"]), np.nan, mean)
    return line


def equilibrium(case: Case, found: Results) -> Array:
    """Tensions and arcs follow from the vertex that is told; the end is met by methods that do not say otherwise.

    Allowed is what the tests measure, and what the rounding of the vertex, and of our arc lengths, is worth where the
    line is heavy.
    """
    line, answers = line_of(case), answers_of(case, found)
    left = misfits(line, answers)
    dV = 4.0 * EPS * _heaviness_at_vertex(line, answers) * np.abs(answers["vertex_s"])
    dV = dV + SUMMED * LONG_EPS * length(line) * np.nanmax(line["section_weight"], axis=1)
    T = np.column_stack([answers["tension_A"], answers["joint_tension"]])
    swing = np.nanmax(4.0 * line["section_length"] * dV[:, None] / (T[:, 1:] + T[:, :-1]), axis=1) / length(line)
    allowed = {"tension": BALANCED + dV / answers["max_tension"], "rise": BALANCED + swing}
    allowed["arc"] = BALANCED + swing + _turn_rounding(line, answers["horizontal_tension"])
    if case.solver in ("composite_line", "composite_mean_weight"):
        allowed["end"] = np.full(case.size, BALANCED)
    return np.max([left[kind] / allowed[kind] for kind in allowed], axis=0).astype(float)


def _turn_rounding(line: Lines, H: Array) -> Array:
    """What a rounding of places makes of an arc, over the length: much where a heavy section turns within it."""
    arc = 2.0 * H[:, None] / line["section_weight"]
    turned = np.expm1(np.minimum(4.0 * EPS * length(line)[:, None] / arc, LARGEST_TURN))
    return np.nanmax(arc * turned, axis=1) / length(line)


def second_method(case: Case, found: Results) -> Array:
    """Answers against those of long doubles."""
    line, answers = line_of(case), answers_of(case, found)
    hung, dH, dV = reference(case.solver, line, answers)
    expected = hung.outputs()
    return worst(
        misses_of_tensions(answers, expected, dH, dV),
        _places(hung, answers, expected, dH, dV),
        _vertex(line, hung, answers, dV),
    )


def answers_of(case: Case, found: Results) -> Lines:
    """All but the profile, also what is answered only to those who ask for it."""
    asked = tuple(name for name in ("joint_position",) if name not in found.outputs)
    return longer(found.outputs | (case.solve(asked).outputs if asked else {}))


def reference(solver: str, line: Lines, answers: Lines) -> tuple[Hung, Array, Array]:
    """The line, and how much its horizontal and vertical tension may be off by."""
    if solver == "composite_handbook":
        return _by_the_handbook(line)
    if solver == "composite_parabolic":
        return _by_the_parabola(line)
    if "horizontal_tension" in line:
        hung = meet_height(line, line["horizontal_tension"])
        return hung, 0.0 * hung.H[:, 0], height_rounding(line, hung)
    by_slack, off = _by_slack(line)
    hung = meet_distance(line, np.where(off < SECURE, by_slack, answers["horizontal_tension"]), off >= SECURE)
    return hung, *_distance_rounding(line, hung, off)


def height_rounding(line: Lines, hung: Hung) -> Array:
    """The solver meets B to a few roundings of the room that the line has above or below; we to our own."""
    room = np.minimum(length(line) - line["rise"], length(line) + line["rise"])
    return SUMMED * EPS * room / hung.rates()[2] + _own_rounding(line, hung)


def _own_rounding(line: Lines, hung: Hung) -> Array:
    """How well the halvings know the vertical tension: to what it is the sum of, and to what B moves by then."""
    summed = weight(line) + np.max(np.abs(np.nan_to_num(hung.V)), axis=1)
    return SUMMED * LONG_EPS * (length(line) / hung.rates()[2] + summed)


def _by_slack(line: Lines) -> tuple[Array, Array]:
    """H of lines that are taut, and how far off it is; infinitely for others."""
    H, off = np.ones_like(line["rise"]), np.full_like(line["rise"], np.inf)
    chord = np.hypot(line["horizontal_distance"], line["rise"])
    taut = np.flatnonzero(length(line) - chord < TAUT * chord)
    some = {name: values[taut] for name, values in line.items()}
    H[taut], off[taut] = taut_tension(some, slack(some))
    return H, off


def _distance_rounding(line: Lines, hung: Hung, off: Array) -> tuple[Array, Array]:
    _, x_V, z_V = hung.rates()
    H = hung.H[:, 0]
    ours = (SUMMED * LONG_EPS * length(line) + np.abs(x_V) * _own_rounding(line, hung)) / hung.stiffness()
    # Where the line is not taut, a rounding of a length moves the vertex, and one of the distance the tension.
    theirs = SUMMED * EPS * line["horizontal_distance"] + np.abs(x_V) * height_rounding(line, hung)
    slack_line = (length(line) - line["rise"]) * (length(line) + line["rise"]) > (
        SLACK * line["horizontal_distance"]
    ) ** 2
    dH = PROMISED * H + np.where(off < SECURE, off * H, ours) + np.where(slack_line, theirs / hung.stiffness(), 0.0)
    return dH, height_rounding(line, hung) + np.abs(x_V / z_V) * dH


def _by_the_handbook(line: Lines) -> tuple[Hung, Array, Array]:
    wire, chain = line["section_length"].T
    light, heavy = line["section_weight"].T
    H = line["horizontal_tension"]
    ratio = H / (heavy * chain)
    fictive = (1.0 - np.longdouble(0.87) * np.where(ratio < 4.0, np.exp(-ratio), 0.0)) * (heavy / light) * chain**2
    from_joint = (wire**2 - fictive) / (2.0 * (wire + chain))
    dV = 16.0 * EPS * light * (wire + (wire**2 + fictive) / (2.0 * (wire + chain)))
    return hung_from(line, H, light * (from_joint - wire)), 0.0 * H, dV


def _by_the_parabola(line: Lines) -> tuple[Hung, Array, Array]:
    total, H, rise = length(line), line["horizontal_tension"], line["rise"]
    hung = line["section_weight"] * line["section_length"]
    mean = np.nansum(line["section_length"] * (np.cumsum(hung, axis=1) - 0.5 * hung), axis=1) / total
    square = (total - rise) * (total + rise)
    lean = H * rise / np.sqrt(square)
    # The room beside the chord is known to a rounding of the length.
    dV = SUMMED * EPS * (weight(line) + np.abs(lean) * total**2 / square)
    return hung_from(line, H, lean - mean), 0.0 * H, dV


def misses_of_tensions(answers: Lines, expected: Lines, dH: Array, dV: Array) -> Array:
    misses = []
    for name in ("horizontal_tension", "tension_A", "tension_B", "max_tension", "joint_tension"):
        off = np.abs(answers[name] - expected[name]).reshape(len(dH), -1)
        allowed = PROMISED * expected[name].reshape(len(dH), -1)
        allowed = allowed + (dH + (0.0 if name == "horizontal_tension" else dV))[:, None]
        misses.append(np.nanmax(off / allowed, axis=1))
    return worst(*misses)


def _places(hung: Hung, answers: Lines, expected: Lines, dH: Array, dV: Array) -> Array:
    allowed = hung.unsure(PROMISED, dH + dV)
    joint = np.nanmax(np.abs(answers["joint_position"][:, :, ::2] - expected["joint_position"]), axis=(1, 2))
    moved = np.abs(answers["vertex_s"] - expected["vertex_s"])
    lowest = np.max(np.abs(answers["lowest_point"][:, ::2] - expected["lowest_point"]), axis=1) - moved
    distance = np.abs(answers["horizontal_distance"] - expected["horizontal_distance"])
    closing = np.abs(answers["closing_error"] - expected["closing_error"])
    return worst(*(miss / allowed for miss in (joint, lowest, distance, closing)))


def _vertex(line: Lines, hung: Hung, answers: Lines, dV: Array) -> Array:
    """The vertical tension at A by the place that is told, and whether the section is one that is level somewhere."""
    at_A = vertical(line, answers, np.zeros((len(dV), 1)))[:, 0]
    allowed = dV + PROMISED * (np.abs(hung.V[:, 0]) + _heaviness_at_vertex(line, answers) * np.abs(answers["vertex_s"]))
    V = np.column_stack([-np.inf * np.ones_like(dV), hung.V, np.full_like(dV, np.nan)])
    rows, section, last = np.arange(len(dV)), answers["vertex_section"].astype(int), number(line)
    V[rows, last + 2] = np.inf
    level = (V[rows, section] <= allowed) & (V[rows, section + 1] >= -allowed)
    return np.where(level, np.abs(at_A - hung.V[:, 0]) / allowed, np.inf)


def _heaviness_at_vertex(line: Lines, answers: Lines) -> Array:
    own = np.clip(answers["vertex_section"].astype(int), 1, number(line)) - 1
    return line["section_weight"][np.arange(len(own)), own]


def worst(*misses: Array) -> Array:
    return np.max(np.stack([np.asarray(miss, dtype=float) for miss in misses]), axis=0)
