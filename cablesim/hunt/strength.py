"""Lines of equal strength, as designed, as loaded and as made, and their uniform rival."""

from dataclasses import replace

import numpy as np

from cablesim import batch
from cablesim.batch import Results
from cablesim.hunt import _anything, _loaded
from cablesim.hunt._case import Case, Judge
from cablesim.hunt._precise import OPERATIONS, ROUNDING, longer, worst, worst_of
from cablesim.hunt._strength_draw import strength_lines
from cablesim.hunt._strength_reference import design_of, equal_strength, thin_line, uniform_strength
from cablesim.numerics import Array
from cablesim.status import Status

LOADED = ("equal_strength_loaded", "stepped_strength")
SOLVERS = ("equal_strength", "uniform_strength", *LOADED)
WEIGHTS = {"uniform_strength": 0.5, "equal_strength_loaded": 0.1, "stepped_strength": 0.2}
MIRRORED = {
    "area_ratio_A": "area_ratio_B",
    "area_ratio_B": "area_ratio_A",
    "stress_ratio_A": "stress_ratio_B",
    "stress_ratio_B": "stress_ratio_A",
}
# The part of a line that is solved alone: three eighths.
PART, PIECES = 3, 8
# Of what has lost more of its digits than leaves three, nothing can be said.
FEW_DIGITS = 1e-3
# No parameter is less, in any unit.
NARROWEST = 1e-50


def draw(solver: str, size: int, rng: np.random.Generator) -> list[Case]:
    """Scenarios of a solver of the family."""
    return strength_lines(solver, size, rng)


def judges(solver: str) -> dict[str, Judge]:
    """The judges of a solver, laws first."""
    own: dict[str, dict[str, Judge]] = {
        "equal_strength": {
            "balance": out_of_balance,
            "mirror": other_in_a_mirror,
            "part": other_alone,
            "reference": off_equal_strength,
        },
        "uniform_strength": {
            "strength": off_the_strength,
            "mirror": other_in_a_mirror,
            "catenary": off_the_catenary,
            "reference": off_uniform_strength,
        },
    }
    return {**_anything.judges(solver), **own.get(solver, {}), **_loaded.judges(solver)}


def off_equal_strength(case: Case, found: Results) -> Array:
    """Of all answers: how far they are from those in longer floats; exp multiplies the rounding of h / k by it."""
    line = design_of(case)
    return worst_of(found, equal_strength(line), _rounding(case))


def out_of_balance(case: Case, found: Results) -> Array:
    """Cross-sections that do not go as exp(h / k), or whose vertical forces sqrt(A^2 - 1) do not hold the weight."""
    out = {name: longer(values) for name, values in found.outputs.items()}
    first, last, weight = (out[name] for name in ("area_ratio_A", "area_ratio_B", "weight_over_force"))
    rise = longer(case.parameters["rise"]) / case.parameters["strength_length"]
    rounding = _rounding(case)
    growth = np.abs(np.log(last / first) - rise) / (rounding * (1.0 + np.abs(rise)))
    forces = [np.sqrt(np.maximum((area - 1.0) * (area + 1.0), 0.0)) for area in (first, last)]
    signs = np.sign(out["vertex_x"]), np.sign(case.parameters["span"] - out["vertex_x"])
    # Of a cross-section of nearly 1 the root keeps half of the digits.
    unknown = sum(
        rounding * area**2 / np.maximum(force, np.sqrt(rounding) * area)
        for area, force in zip((first, last), forces, strict=True)
    )
    return worst(growth, np.abs(signs[0] * forces[0] + signs[1] * forces[1] - weight) / unknown)


def other_alone(case: Case, found: Results) -> Array:
    """By how much the cross-section at A differs if the first part of the line hangs between its own ends.

    Its ends have the rounding of u, of which the cross-section is cosh(u); of a part that is nearly as wide as can be
    what is missing to pi k loses digits.
    """
    nodes = replace(case, options={"nodes": PIECES + 1}).solve(("profile",)).outputs["profile"]
    # A line so steep that nothing of its width is left in floats is not judged.
    wide = nodes[:, PART, 0] > NARROWEST
    part = case.solve(("area_ratio_A",), span=np.where(wide, nodes[:, PART, 0], NARROWEST), rise=nodes[:, PART, 2])
    apart = np.abs(part.outputs["area_ratio_A"] / found.outputs["area_ratio_A"] - 1.0)
    thickest = np.maximum(found.outputs["area_ratio_A"], found.outputs["area_ratio_B"])
    widest = np.pi * case.parameters["strength_length"]
    magnified = widest / np.maximum(widest - nodes[:, PART, 0], ROUNDING * widest)
    allowed = _rounding(case) * (1.0 + np.arccosh(np.maximum(thickest, 1.0))) * magnified
    judged = wide & (allowed < FEW_DIGITS)
    return np.where(judged, np.where(part.status == Status.ok, apart / allowed, np.inf), np.nan)


def other_in_a_mirror(case: Case, found: Results) -> Array:
    """By how much the line with its ends exchanged differs."""
    ours, span = found.outputs, case.parameters["span"]
    mirrored = case.solve(tuple(ours), rise=-case.parameters["rise"]).outputs
    plain = [name for name in ours if name not in ("vertex_x", "saved_weight_fraction")]
    misses = [np.abs(mirrored[MIRRORED.get(name, name)] / ours[name] - 1.0) for name in plain]
    saved = np.abs(mirrored["saved_weight_fraction"] - ours["saved_weight_fraction"])
    across = np.abs(span - mirrored["vertex_x"] - ours["vertex_x"]) / (span + np.abs(ours["vertex_x"]))
    return worst(*misses, saved, across) / _rounding(case)


def off_the_strength(case: Case, found: Results) -> Array:
    """How far the stress at the upper end, w (a + drop), is from the permitted one, w k.

    The drop has the rounding of the angle u there, cosh(u) being the area ratio.
    """
    k, area = (longer(case.parameters["strength_length"]), longer(found.outputs["area_ratio_A"]))
    angle = 1.0 + np.arccosh(np.maximum(found.outputs["area_ratio_A"], 1.0))
    return np.asarray(np.abs(1.0 / area + found.outputs["drop"] / k - 1.0), dtype=float) / (_rounding(case) * angle)


def off_the_catenary(case: Case, found: Results) -> Array:
    """How far the largest tension of a hanging line of this length is from the strength; its slack loses digits."""
    k, length = case.parameters["strength_length"], found.outputs["line_length"]
    ends = {name: case.parameters[name] for name in ("span", "rise")}
    line = {**ends, "line_length": length, "weight_per_length": np.ones(case.size)}
    hung = batch.solve("catenary_exact", line, {}, ("max_tension",))
    chord = np.hypot(ends["span"], ends["rise"])
    allowed = 4.0 * _rounding(case) * length / np.maximum(length - chord, ROUNDING * length)
    apart = np.abs(hung.outputs["max_tension"] / k - 1.0)
    return np.where(allowed < FEW_DIGITS, np.where(hung.status == Status.ok, apart / allowed, np.inf), np.nan)


def off_uniform_strength(case: Case, found: Results) -> Array:
    """How far all answers are from those in longer floats; where both lines meet, half of the digits are known."""
    line = design_of(case)
    thin = thin_line(line.span, line.rise)
    rounding = _rounding(case) * (1.0 + np.asarray(thin.upper, dtype=float))
    slope = np.abs(np.asarray(thin.slope, dtype=float))
    allowed = (1.0 + 2.0 * (1.0 + np.asarray(thin.upper, dtype=float)) / (slope + np.sqrt(2.0 * rounding))) * rounding
    miss = worst_of(found, uniform_strength(line, thin), allowed)
    return np.where(thin.excess > rounding, np.inf, miss)


def _rounding(case: Case) -> Array:
    """Of a chain of operations, with exp(h / k) in it."""
    return OPERATIONS * ROUNDING * (1.0 + np.abs(case.parameters["rise"]) / case.parameters["strength_length"])
