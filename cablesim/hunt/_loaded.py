"""Judges of lines that were built for equal strength and hang under another force."""

from dataclasses import replace

import numpy as np

from cablesim.batch import Results
from cablesim.hunt._case import Case, Judge
from cablesim.hunt._loaded_reference import Hung, Sums, hung_line, resolved, smooth_sums, stepped_sums, vertical_tension
from cablesim.hunt._precise import OPERATIONS, ROUNDING, longer, worst
from cablesim.numerics import Array
from cablesim.status import Status

# What `equal_strength_loaded` promises of every answer, and for which forces.
PROMISED, FORCES = 1e-12, (1e-3, 1e3)
# Of pieces in which the largest stress is looked for, and of the shape.
STRESSES, NODES = 160, 9
# Less than any distance or stress that could be asked for.
NOTHING = 1e-90
# Of the tension at the thinnest place, to see what changes with it.
STEP = 1e-4
MORE = 1.0 + 2.0**-7
ENDS = {"stress_ratio_A": "stress_ratio_B", "stress_ratio_B": "stress_ratio_A"}


def judges(solver: str) -> dict[str, Judge]:
    """The judges of a solver, laws first; none for others."""
    both: dict[str, Judge] = {
        "mirror": other_in_a_mirror,
        "ends": off_its_ends,
        "largest": not_the_largest,
        "force": nearer_under_more_force,
    }
    if solver == "equal_strength_loaded":
        return {**both, "design": off_the_design, "reference": off_the_reference}
    return {**both, "reference": off_the_reference} if solver == "stepped_strength" else {}


def other_in_a_mirror(case: Case, found: Results) -> Array:
    """By how much the line with its ends exchanged differs."""
    turned = {"rise": -case.parameters["rise"], "arc_fraction": 1.0 - case.parameters["arc_fraction"]}
    mirrored = case.solve(tuple(found.outputs), **turned).outputs
    # The place that is looked at is rounded in the mirror.
    names = [name for name in found.outputs if name != "stress_ratio"]
    misses = worst(
        *(
            np.abs(mirrored[ENDS.get(name, name)] - found.outputs[name]) / np.maximum(found.outputs[name], NOTHING)
            for name in names
        )
    )
    return misses / (PROMISED + _rounding(hung_line(case)))


def off_its_ends(case: Case, found: Results) -> Array:
    """By how much the shape misses its distance and its rise, and any of its chords is longer than its arc."""
    nodes = replace(case, options={**case.options, "nodes": NODES}).solve(("profile",)).outputs["profile"]
    length = np.asarray(longer(hung_line(case).length) * case.parameters["strength_length"], dtype=float)
    ends = np.stack([found.outputs["horizontal_distance"], np.zeros(case.size), case.parameters["rise"]], axis=1)
    chords = np.linalg.norm(np.diff(nodes, axis=1), axis=2).max(axis=1) - length / (NODES - 1)
    misses = worst(np.linalg.norm(nodes[:, -1] - ends, axis=1), chords) / length
    return misses / (PROMISED + _rounding(hung_line(case)))


def not_the_largest(case: Case, found: Results) -> Array:
    """By how much the stress at some place is more than the largest; infinite where it is less at all places.

    At a maximum the second derivative of the logarithm of the stress is above -2, so the nearest of the places, half a
    step away, has at least 1 - step^2 / 4 of it.
    """
    finest = replace(case, options={**case.options, "nodes": _nodes(case)}).solve(("profile_stress_ratio",))
    stresses, largest = finest.outputs["profile_stress_ratio"], found.outputs["max_stress_ratio"]
    ends = [found.outputs[name] for name in ("stress_ratio_A", "stress_ratio_B", "stress_ratio")]
    highest = np.maximum(stresses.max(axis=1), np.max(ends, axis=0))
    step = hung_line(case).length / (_nodes(case) - 1)
    missing = highest < largest * (1.0 - 0.25 * step**2 - PROMISED)
    return np.where(missing & (step < 1.0), np.inf, np.maximum(highest / largest - 1.0, 0.0) / PROMISED)


def nearer_under_more_force(case: Case, found: Results) -> Array:
    """Infinite where the ends come nearer to each other under more force."""
    more = case.solve(("horizontal_distance",), force_ratio=MORE * case.parameters["force_ratio"])
    ours = found.outputs["horizontal_distance"] * (1.0 - PROMISED - _rounding(hung_line(case)))
    return np.where((more.outputs["horizontal_distance"] >= ours) | (more.status != Status.ok), 0.0, np.inf)


def off_the_design(case: Case, found: Results) -> Array:
    """Under the force of the design: how far the distance is from the span, and any stress from the permitted one."""
    design = case.solve(tuple(found.outputs), force_ratio=np.ones(case.size)).outputs
    distance = np.abs(design["horizontal_distance"] / case.parameters["span"] - 1.0)
    stresses = [np.abs(values - 1.0) for name, values in design.items() if name != "horizontal_distance"]
    line = hung_line(case)
    return worst(distance, *stresses) / (PROMISED + _rounding(replace(line, force=np.ones(case.size))))


def off_the_reference(case: Case, found: Results) -> Array:
    """How far distance and stresses are from those of another search with other sums.

    What the rounding of the rise and of the weights does to the vertical tension is allowed besides.
    """
    line, force = hung_line(case), case.parameters["force_ratio"]
    judged = resolved(line) & (force >= FORCES[0]) & (force <= FORCES[1])
    miss = np.full(case.size, np.nan)
    if judged.any():
        some = {name: values[judged] for name, values in found.outputs.items()}
        miss[judged] = _misses(case.rows(judged), some, line.rows(judged))
    return miss


def _misses(case: Case, found: dict[str, Array], line: Hung) -> Array:
    sums: Sums = stepped_sums(case.options["sections"]) if "sections" in case.options else smooth_sums
    vertical = vertical_tension(line, sums)
    distance = sums(line, vertical)[1] * line.k
    falling, fraction = case.parameters["rise"] < 0.0, case.parameters["arc_fraction"]
    places = np.stack([np.zeros(case.size), np.ones(case.size), fraction], axis=1)
    sensitivity = _sensitivity(line, sums, vertical)
    stresses, unknown = _stresses(case, line, vertical, sensitivity, np.where(falling[:, None], 1.0 - places, places))
    misses = [np.abs(found["horizontal_distance"] / distance - 1.0) / (PROMISED + _rounding(line))]
    for column, name in enumerate(("stress_ratio_A", "stress_ratio_B", "stress_ratio")):
        apart = np.abs(found[name] / stresses[:, column] - 1.0)
        misses.append(apart / (PROMISED + unknown[:, column]))
    return worst(*misses)


def _sensitivity(line: Hung, sums: Sums, vertical: Array) -> Array:
    """By how much the vertical tension changes with the length that is lost to slope, per part of that."""
    step = STEP * np.hypot(line.force, vertical)
    beside = sums(line, vertical + step)[0]
    return line.slack * step / np.maximum(np.abs(beside - line.slack), NOTHING)


def _stresses(case: Case, line: Hung, vertical: Array, sensitivity: Array, from_first: Array) -> tuple[Array, Array]:
    """At fractions of the length, and what part of them rounding leaves unknown."""
    place = np.minimum(line.low[:, None] + line.length[:, None] * from_first, line.high[:, None])
    weight = line.weight(place)
    if "sections" in case.options:
        weight = _stepped_weight(case.options["sections"], line, from_first)
    up = vertical[:, None] + weight
    tension = np.hypot(line.force[:, None], up)
    lost = np.abs(up) / tension**2 * (np.abs(vertical[:, None]) + np.abs(weight) + sensitivity[:, None])
    return tension / np.cosh(line.thinnest[:, None] + place), OPERATIONS * ROUNDING * (lost + line.length[:, None])


def _stepped_weight(sections: int, line: Hung, from_first: Array) -> Array:
    """Linear between joints."""
    piece = np.minimum(np.floor(from_first * sections), sections - 1.0)
    joints = [line.low[:, None] + line.length[:, None] * (piece + end) / sections for end in (0.0, 1.0)]
    before, after = (line.weight(joint) for joint in joints)
    return before + (after - before) * (from_first * sections - piece)


def _rounding(line: Hung) -> Array:
    """Of what follows from V / r: its terms may be so much greater than the force."""
    ends = np.abs(line.weight(np.stack([line.low, line.high], axis=1))).max(axis=1)
    return OPERATIONS * ROUNDING * (1.0 + ends / line.force)


def _nodes(case: Case) -> int:
    """Nodes of which all joints are some."""
    sections = case.options.get("sections", 1)
    return int(sections * np.ceil(STRESSES / sections)) + 1
