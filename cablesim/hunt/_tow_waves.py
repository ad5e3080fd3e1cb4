"""Judges of the height of waves in which a line may tow."""

import numpy as np

from cablesim.batch import Results
from cablesim.hunt._case import Case
from cablesim.hunt._composite_judges import PROMISED, height_rounding, worst
from cablesim.hunt._composite_precise import EPS, Hung, longer, meet_height
from cablesim.hunt._composite_symmetry import turned
from cablesim.numerics import Array

# Roundings of a handful of products and differences.
A_FEW = 8.0
DISTANCES = ("distance_calm", "distance_jerk")


def formula(case: Case, found: Results) -> Array:
    """Both elongations and their sum by the handbook's formula; a difference to a rounding of what is subtracted."""
    p, answers = longer(case.parameters), longer(found.outputs)
    wire = p["section_length"][:, 0] if "section_length" in p else p["line_length"]
    elastic = (p["breaking_strength"] / 2.0 - p["hook_pull"]) * wire / (p["wire_modulus"] * p["diameter"] ** 2)
    calm, jerk = (answers[name] for name in DISTANCES)
    sizes = {"elastic_elongation": elastic, "weight_elongation": jerk, "wave_height": elastic + jerk}
    expected = sizes | {"weight_elongation": jerk - calm, "wave_height": elastic + jerk - calm}
    return worst(*(np.abs(answers[name] - expected[name]) / (A_FEW * EPS * sizes[name]) for name in sizes))


def feasibility(case: Case, found: Results) -> Array:
    """Infinite where half the strength is no more than the pull, or the line shrinks in the jerk."""
    p = case.parameters
    strong = p["breaking_strength"] > 2.0 * p["hook_pull"]
    grows = p["distance_jerk"] >= p["distance_calm"] if "distance_calm" in p else True
    return np.where(strong & grows, 0.0, np.inf)


def distances(case: Case, found: Results) -> Array:
    """Those of the line in longer floats, between level ends; or those that were given."""
    answers = found.outputs
    if "section_length" not in case.parameters:
        return np.where(np.all([answers[name] == case.parameters[name] for name in DISTANCES], axis=0), 0.0, np.inf)
    return worst(*(_off(hung, answers[name]) for name, hung in zip(DISTANCES, hung_level(case), strict=True)))


def other_end(case: Case, found: Results) -> Array:
    """Towed by its other end, the line gives as much by its weight; not judged where distances are given."""
    if "section_length" not in case.parameters:
        return np.full(case.size, np.nan)
    other = case.solve(DISTANCES, **turned(case)).outputs
    pairs = zip(DISTANCES, hung_level(case), strict=True)
    return worst(*(np.abs(found.outputs[name] - other[name]) / (2.0 * allowed(hung)) for name, hung in pairs))


def hung_level(case: Case) -> tuple[Hung, Hung]:
    """The line in calm water and in the jerk."""
    p = longer(case.parameters)
    line = {name: p[name] for name in ("section_length", "section_weight")} | {"rise": 0.0 * p["hook_pull"]}
    return meet_height(line, p["hook_pull"]), meet_height(line, p["breaking_strength"] / 2.0)


def allowed(hung: Hung) -> Array:
    """What the distance may be off by: the promised digits, and what B is off its height times the slope."""
    return PROMISED * hung.distance + np.abs(hung.rates()[1]) * height_rounding(hung.line, hung)


def _off(hung: Hung, distance: Array) -> Array:
    return np.asarray(np.abs(distance - hung.distance) / allowed(hung), dtype=float)
