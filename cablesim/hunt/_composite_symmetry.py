"""Judges of lines of sections by other lines that must hang alike, or a little higher, or not at all."""

import numpy as np

from cablesim.batch import Results
from cablesim.hunt._case import Case
from cablesim.hunt._composite_judges import PROMISED, answers_of, line_of, misses_of_tensions, reference, worst
from cablesim.hunt._composite_laws import Lines, length, number
from cablesim.hunt._composite_precise import longer
from cablesim.hunt._composite_taut import slack
from cablesim.numerics import Array
from cablesim.status import Status

# By how much a line is pulled harder, or its ends are moved together.
CHANGE = 1e-3


def other_end(case: Case, found: Results) -> Array:
    """The line hung from B to A has the same tensions; each of both lines may be off by what one may."""
    other = case.solve((), **turned(case))
    backwards = np.column_stack([other.outputs["tension_A"], other.outputs["joint_tension"]])
    same = other.outputs | {
        "tension_A": other.outputs["tension_B"],
        "tension_B": other.outputs["tension_A"],
        "joint_tension": np.take_along_axis(backwards, _backwards(case.parameters), axis=1),
    }
    return _apart(case, found, other.status == Status.ok, same)


def halves(case: Case, found: Results) -> Array:
    """The line of twice as many sections, each of half the length, is the same line."""
    lists = {
        "section_length": np.repeat(0.5 * case.parameters["section_length"], 2, axis=1),
        "section_weight": np.repeat(case.parameters["section_weight"], 2, axis=1),
    }
    other = case.solve((), **lists)
    same = other.outputs | {"joint_tension": other.outputs["joint_tension"][:, 1::2]}
    return _apart(case, found, other.status == Status.ok, same)


def harder_pull(case: Case, found: Results) -> Array:
    """A line pulled harder reaches farther, and one that reaches less far is pulled less; equal is allowed."""
    line, answers = line_of(case), answers_of(case, found)
    _, dH, _ = reference(case.solver, line, answers)
    if "horizontal_tension" in case.parameters:
        other = case.solve(horizontal_tension=case.parameters["horizontal_tension"] * (1.0 + CHANGE))
        less = answers["horizontal_distance"] - other.outputs["horizontal_distance"]
        return np.where(other.status == Status.ok, less / (PROMISED * length(line)), np.inf).clip(0.0).astype(float)
    other = case.solve(horizontal_distance=case.parameters["horizontal_distance"] * (1.0 - CHANGE))
    more = other.outputs["horizontal_tension"] - answers["horizontal_tension"]
    return np.where(other.status == Status.ok, more / dH, np.inf).clip(0.0).astype(float)


def existence(case: Case, found: Results) -> Array:
    """Infinite where there is no such line, by exact arithmetic: it is no longer than its chord, or than its rise."""
    line = longer(case.parameters)
    chord = line if "horizontal_distance" in line else line | {"horizontal_distance": 0.0 * line["rise"]}
    return np.where(slack(chord) > 0.0, 0.0, np.inf)


def turned(case: Case) -> Lines:
    """The lists from B to A, and the rise of A above B if there is one."""
    lists = {name: case.parameters[name] for name in ("section_length", "section_weight")}
    back = {name: np.take_along_axis(values, _backwards(case.parameters), axis=1) for name, values in lists.items()}
    return back | ({"rise": -case.parameters["rise"]} if "rise" in case.parameters else {})


def _backwards(line: Lines) -> np.ndarray:
    """Which section comes where from the other end; those missing stay where they are."""
    place, last = np.arange(line["section_length"].shape[1]), number(line)[:, None]
    return np.where(place < last, last - 1 - place, place)


def _apart(case: Case, found: Results, solved: np.ndarray, same: Lines) -> Array:
    """How far the tensions and the distance of two lines that are the same are apart; twice what one may be off by."""
    line, answers = line_of(case), answers_of(case, found)
    hung, dH, dV = reference(case.solver, line, answers)
    tensions = misses_of_tensions(answers, longer(same), dH, dV)
    distance = np.abs(answers["horizontal_distance"] - same["horizontal_distance"]) / hung.unsure(PROMISED, dH + dV)
    return np.where(solved, 0.5 * worst(tensions, distance), np.inf)
