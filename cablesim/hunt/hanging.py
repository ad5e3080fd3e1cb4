"""Hanging lines, exact, elastic and approximate: balance, closure, mirror, halves, order, and long-float references."""

from dataclasses import replace
from functools import partial

import numpy as np

from cablesim.batch import Results
from cablesim.hunt import _anything, _limit_ratio
from cablesim.hunt._case import Case, Judge
from cablesim.hunt._hanging_draw import hanging_lines, permitted_errors
from cablesim.hunt._hanging_reference import catenary, hung_ends, level_formula, line_of
from cablesim.hunt._precise import OPERATIONS, ROUNDING, longer, worst, worst_of
from cablesim.numerics import Array
from cablesim.status import Status

CURVES = ("catenary_exact", "catenary_elastic")
FORMULAS = {f"catenary_{name}": name for name in ("parabolic", "series", "handbook")}
SOLVERS = (*CURVES, *FORMULAS, "catenary_limit_ratio")
WEIGHTS = {"catenary_elastic": 0.5, "catenary_limit_ratio": 0.3}
# Of what has lost more of its digits than leaves three, nothing can be said.
FEW_DIGITS = 1e-3
# The part of a line that is solved alone: three eighths, a float that rounds nothing.
PART, PIECES = 3, 8
# By what a line is made longer.
LONGER = 1.0 + 2.0**-10
# Of L / l - 1, and of its square: no relative error of a formula in sag or tension is more. The first terms have 0.35
# (sag) and 1 / 3 or less (tension) of L / l - 1 for the parabola.
FIRST, SECOND = 1.0, 2.0
SMALL_SLACK = 0.05


def draw(solver: str, size: int, rng: np.random.Generator) -> list[Case]:
    """Scenarios of a solver of the family."""
    if solver == "catenary_limit_ratio":
        return permitted_errors(size, rng)
    return [hanging_lines(solver, size, rng)]


def judges(solver: str) -> dict[str, Judge]:
    """The judges of a solver, laws first."""
    own: dict[str, Judge]
    if solver in CURVES:
        own = {
            "balance": out_of_balance,
            "mirror": other_in_a_mirror,
            "part": other_alone,
            "longer": tauter_when_longer,
            "reference": off_the_catenary,
        }
    elif solver in FORMULAS:
        order = {} if solver == "catenary_handbook" else {"order": off_its_order}
        own = {"balance": out_of_level_balance, **order, "reference": partial(off_the_formula, FORMULAS[solver])}
    else:
        own = {"permitted": _limit_ratio.off_the_permitted_error, "below": _limit_ratio.more_below}
    return {**_anything.judges(solver), **own}


def off_the_catenary(case: Case, found: Results) -> Array:
    """Of all answers: how far they are from those in longer floats.

    A few units in the last place are promised; cosh and sinh make the rounding of an angle u one of u times as much.
    What is left of L^2 - l^2 - h^2 is known to 1e-32 L^2.
    """
    line = line_of(case)
    answers, angle = catenary(line)
    allowed = OPERATIONS * ROUNDING * (1.0 + angle) + ROUNDING**2 * np.where(line.strain == 0.0, line.sharpness, 0.0)
    return worst_of(found, answers, allowed)


def off_the_formula(name: str, case: Case, found: Results) -> Array:
    """Of all answers of an approximate formula: how far they are from what is printed, in longer floats."""
    line = line_of(case)
    return worst_of(found, level_formula(name, line), OPERATIONS * ROUNDING + ROUNDING**2 * line.sharpness)


def out_of_balance(case: Case, found: Results) -> Array:
    """How far the ends are from where these tensions hold them (M6), with V from T_B^2 - T_A^2 = V_B^2 - V_A^2.

    Both tensions are known to some roundings, which leaves V uncertain by (T_A^2 + T_B^2) / w L of them: of lines that
    are nearly weightless beside their tension nothing, and they are not judged.
    """
    line = line_of(case)
    horizontal, first, last = (longer(found.outputs[name]) for name in ("horizontal_tension", "tension_A", "tension_B"))
    weight = line.weight * line.length
    force = 0.5 * ((last - first) * (last + first) / weight + weight)
    ends, rounding = hung_ends(line, horizontal, force), OPERATIONS * ROUNDING
    unknown = rounding * (first**2 + last**2) / weight
    across = rounding * (2.0 * ends.a + line.span + ends.a * ends.angles) + unknown * ends.across_by_force
    up = rounding * (np.abs(line.rise) + line.span + line.length) + unknown * ends.up_by_force
    misses = worst(np.abs(ends.across - line.span) / across, np.abs(ends.up - line.rise) / up)
    return np.where(unknown < FEW_DIGITS * np.maximum(first, last), misses, np.nan)


def out_of_level_balance(case: Case, found: Results) -> Array:
    """How far a formula is from its own balance: T^2 = H^2 + (w l / 2)^2 of the parabola, T = H + w f of the series."""
    out = {name: longer(values) for name, values in found.outputs.items()}
    weight, span = (longer(case.parameters[name]) for name in ("weight_per_length", "span"))
    largest, horizontal = out["max_tension"], out["horizontal_tension"]
    if case.solver == "catenary_series":
        expected = horizontal + weight * out["sag"]
    else:
        expected = np.hypot(horizontal, 0.5 * weight * span)
    same = [np.abs(out[name] - largest) / largest for name in ("tension_A", "tension_B")]
    return worst(np.abs(expected - largest) / largest, *same) / (OPERATIONS * ROUNDING)


def off_its_order(case: Case, found: Results) -> Array:
    """Of lines with little slack: the error over the leading power of L / l - 1 that the formula has."""
    line = line_of(case)
    slack = np.asarray(line.excess / (line.length + line.span) / line.span, dtype=float)
    power = FIRST * slack if case.solver == "catenary_parabolic" else SECOND * slack**2
    exact, _ = catenary(line)
    errors = [np.abs(found.outputs[name] / exact[name].value - 1.0) for name in ("sag", "max_tension")]
    allowed = power + OPERATIONS * ROUNDING + ROUNDING**2 * line.sharpness
    return np.where(slack < SMALL_SLACK, worst(*errors) / allowed, np.nan)


def other_in_a_mirror(case: Case, found: Results) -> Array:
    """By how much the line with its ends exchanged differs; of roundings, which cosh multiplies by the angle."""
    ours = found.outputs
    mirrored = case.solve(tuple(ours), rise=-case.parameters["rise"]).outputs
    names = {"tension_A": "tension_B", "tension_B": "tension_A"}
    plain = [name for name in ours if name != "vertex_x"]
    misses = [np.abs(mirrored[names.get(name, name)] - ours[name]) / np.abs(ours[name]) for name in plain]
    across = np.abs(case.parameters["span"] - mirrored["vertex_x"] - ours["vertex_x"])
    size = case.parameters["span"] + np.abs(ours["vertex_x"]) + np.abs(mirrored["vertex_x"])
    return worst(*misses, across / size) / (OPERATIONS * ROUNDING * (1.0 + _angle(found)))


def other_alone(case: Case, found: Results) -> Array:
    """By how much the horizontal tension changes if a part of the line hangs between its own ends.

    Its end is known to roundings of the whole length, and the tension goes with its slack and its span: only judged
    where that leaves three digits.
    """
    nodes = replace(case, options={"nodes": PIECES + 1}).solve(("profile",)).outputs["profile"]
    given = {name: values for name, values in case.parameters.items() if name != "length_ratio"}
    length = np.asarray(line_of(case).length * PART / PIECES, dtype=float)
    part = replace(
        case, parameters={**given, "span": nodes[:, PART, 0], "rise": nodes[:, PART, 2], "line_length": length}
    )
    alone = part.solve(("horizontal_tension",))
    apart = np.abs(alone.outputs["horizontal_tension"] / found.outputs["horizontal_tension"] - 1.0)
    lost = (1.0 + _angle(found)) * (1.0 + line_of(part).sharpness) + length / part.parameters["span"]
    allowed = 2.0 * OPERATIONS * ROUNDING * lost
    return np.where(allowed < FEW_DIGITS, np.where(alone.status == Status.ok, apart / allowed, np.inf), np.nan)


def tauter_when_longer(case: Case, found: Results) -> Array:
    """Infinite where a longer line has more horizontal tension."""
    name = "length_ratio" if "length_ratio" in case.parameters else "line_length"
    longer_line = case.solve(("horizontal_tension",), **{name: LONGER * case.parameters[name]}).outputs
    ours = found.outputs["horizontal_tension"]
    return np.where(longer_line["horizontal_tension"] <= ours * (1.0 + OPERATIONS * ROUNDING), 0.0, np.inf)


def _angle(found: Results) -> Array:
    """|u| at the steeper end, from cosh(u) = T / H."""
    return np.arccosh(np.maximum(found.outputs["max_tension"] / found.outputs["horizontal_tension"], 1.0))
