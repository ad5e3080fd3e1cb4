"""Lines in a uniform stream by every method: judged by mirrors and restarts, then each by a method of another kind.

A line of known force through a slack part feels the last digit of that force; so what a judge allows grows with how
much the answer changes when the given force, end and length are changed by a little (`_growth`).
"""

from dataclasses import replace
from typing import Any

import numpy as np

from cablesim import batch
from cablesim.batch import Results
from cablesim.hunt import _anything
from cablesim.hunt._case import Case, Judge, rows_of
from cablesim.hunt._stream_check import loads_on, misfits, norm
from cablesim.hunt._stream_draw import PLANE, draw, loads
from cablesim.numerics import Array
from cablesim.status import Status

__all__ = ["SOLVERS", "WEIGHTS", "draw", "judges"]

SOLVERS = ("stream_line", "segment_line", "angle_line", "pode_line", "pode_table_line")
# They take milliseconds, most of it the judges.
WEIGHTS = dict.fromkeys(SOLVERS, 0.05)
# What solved lines must have in common that only the order of rounding tells apart.
ROUNDING = 1e-12
# What lines that were integrated to 1e-12 promise.
INTEGRATED = 1e-10
# A piece of a line amplifies what was integrated to 1e-12 by as much as its ends differ in tension.
PIECE = 1e-8
NODES, MANY_NODES = 9, 129
# By this part of themselves force, end and length are changed to see what an answer is sensitive to. What changes by
# more than MOST of itself for it is not judged.
CHANGE, MOST = 1e-7, 1e-2
# A force that is rounded a few times is off by this part of itself.
ROUNDING_OF_FORCE = 1e-15
# Coarse and fine steps of the angle form may differ by this; its errors are smaller still.
ANGLE_RTOL = 1e-6
ANSWERS = ("position_B", "force_A", "force_B", "line_length")
# Changes are tried so often, and what was not tried may grow more than that.
TRIALS, ROOM = 3, 30.0
# A tension below this part of load times length is the trace with which a line without a pull begins.
TRACE = 1e-11


def judges(solver: str) -> dict[str, Judge]:
    """Laws, and a method of another kind."""
    laws: dict[str, Judge] = {**_anything.judges(solver), "closure": closes}
    if solver == "pode_table_line":
        return {**laws, "turn": turned}
    own: dict[str, Judge] = {
        "stream_line": midpoint_steps,
        "segment_line": polygon,
        "angle_line": integrated_line,
        "pode_line": integrated_line,
    }
    return {**laws, "mirror": mirror, "turn": turned, "restart": restart, "second": own[solver]}


# ---- laws ----


def closes(case: Case, found: Results) -> Array:
    """The end or the depth that was given is met, and `closing_error` tells by how much it is not."""
    out, p = found.outputs, case.parameters
    if "position_B" in p:
        miss = norm(out["position_B"] - p["position_B"])
        told = out["closing_error"]
        if case.solver == "pode_table_line":  # a table misses by what it is worth, and says so
            return np.maximum(miss - told, 0.0) / (ROUNDING * p["line_length"])
        return np.maximum(miss, np.abs(miss - told)) / (INTEGRATED * p["line_length"])
    if "depth" in p:
        return np.abs(out["position_B"][:, 2] - p["depth"]) / (
            INTEGRATED * np.maximum(p["depth"], norm(out["position_B"]))
        )
    return np.where(out["closing_error"] == 0.0, 0.0, np.inf)


def mirror(case: Case, found: Results) -> Array:
    """Seen in a mirror upright along x everything has another y, the strands another hand."""
    given = {name: -case.parameters[name] for name in ("heading", "lay_angle")}
    for name in ("force_A", "position_B"):
        if name in case.parameters:
            given[name] = case.parameters[name] * [1.0, -1.0, 1.0]
    other = case.solve(ANSWERS, **given)
    seen = {name: values * [1.0, -1.0, 1.0] if values.ndim == 2 else values for name, values in other.outputs.items()}
    return _apart(case, found, seen, _same_fate(other.status)) / _allowed(case, found, _kept(case))


def turned(case: Case, found: Results) -> Array:
    """Turned by a right angle about the vertical it is the same line."""
    quarter = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    given = {"heading": case.parameters["heading"] + 0.5 * np.pi}
    given |= {n: case.parameters[n] @ quarter for n in ("force_A", "position_B") if n in case.parameters}
    other = case.solve(ANSWERS, **given)
    seen = {n: values @ quarter.T if values.ndim == 2 else values for n, values in other.outputs.items()}
    return _apart(case, found, seen, _same_fate(other.status)) / _allowed(case, found, _kept(case))


def restart(case: Case, found: Results) -> Array:
    """From the answered force over the answered length every method ends where it says that it does."""
    again, ok = _from_force(case, found, case.solver, case.options)
    base = INTEGRATED if case.solver in ("stream_line", "pode_line") else 0.0
    apart = _apart(case, found, again, np.where(ok, Status.ok, -1))
    return apart / (base + _allowed_from_force(case, found, ROUNDING))


# ---- second methods ----


def midpoint_steps(case: Case, found: Results) -> Array:
    """From node to node by extrapolated midpoint steps of the equations as the book has them."""
    miss = misfits(case.parameters, found.outputs, NODES, **case.options)
    # Of two equal tensions rounding tells which is slacker, and a long piece may be followed against its stable sense.
    missed = np.flatnonzero(miss > PIECE)
    if missed.size:
        miss[missed] = misfits(case.rows(missed).parameters, rows_of(found, missed).outputs, MANY_NODES, **case.options)
    # Nothing is known of what is too long to be followed or takes too many steps, nor where `_apart` does not judge.
    followed = np.isfinite(_allowed_from_force(case, found, 1.0)) & np.isfinite(miss)
    return np.where(followed, miss / PIECE, np.nan)


def integrated_line(case: Case, found: Results) -> Array:
    """The integrated line from the answered force over the answered length."""
    again, ok = _from_force(case, found, "stream_line", {})
    base = ANGLE_RTOL if case.solver == "angle_line" else INTEGRATED
    apart = _apart(case, found, again, np.where(ok, Status.ok, -1))
    return apart / (base + _rounded(case, found, again) + _allowed_from_force(case, found, ROUNDING))


def _rounded(case: Case, found: Results, integrated: dict[str, Array]) -> Array:
    """What rounding of the force changes of the integrated line, with room.

    Nearly weightless and pulled along the stream a line's tension falls to exp(-1000) of itself; behind that a change
    by rounding turns the line about as far as one by `CHANGE` does, and `_growth` makes too little of it.
    """
    own = replace(found, outputs=found.outputs | integrated)
    change = ROUNDING_OF_FORCE * np.random.default_rng(2).normal(size=(case.size, 3))
    other, ok = _from_force(case, own, "stream_line", {}, change)
    apart = _apart(case, own, other, np.where(ok, Status.ok, -1))
    return ROOM * np.where(np.isfinite(apart), apart, 0.0)


def polygon(case: Case, found: Results) -> Array:
    """M14 step by step in extended precision, with the loads as the book has them."""
    force, length = found.outputs["force_A"], found.outputs["line_length"]
    pull = np.where(force.any(axis=1, keepdims=True), force, np.nan)
    position, end, largest = _march(case, pull, length)
    seen = {"position_B": position, "force_B": end, "force_A": force, "line_length": length}
    apart = _apart(case, found, seen, np.zeros(case.size))
    peak = np.abs(found.outputs["max_tension"] - largest) / found.outputs["max_tension"]
    return np.maximum(apart, peak) / _allowed_from_force(case, found, ROUNDING)


def _march(case: Case, force: Array, length: Array) -> tuple[Array, Array, Array]:
    p, segments = case.parameters, case.options["segments"]
    here, place = force.T.astype(np.longdouble), np.zeros((3, length.size), dtype=np.longdouble)
    step, largest = length.astype(np.longdouble) / segments, np.sqrt((here * here).sum(axis=0))
    for _ in range(segments):
        load = loads_on(_unit(here), p)
        if case.options["variant"] == "midpoint":
            tangent = _unit(here - 0.5 * step * load)
            here = here - step * loads_on(tangent, p)
        else:
            here = here - step * load
            tangent = _unit(here)
        place = place + step * tangent
        largest = np.maximum(largest, np.sqrt((here * here).sum(axis=0)))
    return place.T.astype(float), here.T.astype(float), largest.astype(float)


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.sqrt((vectors * vectors).sum(axis=0))


# ---- what is compared, and what is allowed ----


def _from_force(
    case: Case, found: Results, solver: str, options: dict[str, Any], change: Array | float = 0.0
) -> tuple[dict[str, Array], np.ndarray]:
    """The answers of a method to the answered force and length; and which it has. Without a pull there is none.

    The force may be changed by a part of itself.
    """
    force, length = found.outputs["force_A"], found.outputs["line_length"]
    pulled = np.asarray(force.any(axis=1) & np.isfinite(length))
    given = {n: v for n, v in case.parameters.items() if n not in ("position_B", "depth", "line_length")}
    given["force_A"] = np.where(pulled[:, None], force + norm(force)[:, None] * change, 1.0)
    given["line_length"] = np.where(pulled, length, 1.0)
    again = batch.solve(solver, given, options, ANSWERS)
    return again.outputs, pulled & (again.status == Status.ok)


def _apart(case: Case, found: Results, seen: dict[str, Array], status: Array) -> Array:
    """The largest difference, of places relative to the length and of forces to the largest tension.

    Infinite where only one of them has a solution; not judged where `status` is negative, nor where there is no
    tension but the trace with which a line without any pull begins, nor where the law of friction has a jump.
    """
    out = found.outputs
    largest, length = out["max_tension"], out["line_length"]
    miss = np.abs(length - seen["line_length"]) / length
    for name, scale in (("position_B", length), ("force_A", largest), ("force_B", largest)):
        miss = np.maximum(miss, norm(out[name] - seen[name]) / scale)
    judged = (status >= 0) & (largest > TRACE * loads(case.parameters)[0] * length) & ~_at_corner(case, out["force_A"])
    return np.where(judged, np.where(status == Status.ok, miss, np.inf), np.nan)


def _at_corner(case: Case, force: Array) -> np.ndarray:
    """Whether a line begins at a right angle to the stream, where constant friction jumps as rounding will have it."""
    p = case.parameters
    along = force[:, 0] * np.cos(p["heading"]) + force[:, 1] * np.sin(p["heading"])
    return (p["friction_law"] == "constant") & (np.abs(along) <= ROUNDING * norm(force))


def _kept(case: Case) -> float:
    """What images keep: of a nearly straight line the angle form knows the turn only as a difference of angles."""
    return ANGLE_RTOL if case.solver == "angle_line" else ROUNDING


def _same_fate(status: Array) -> Array:
    """Not judged is a line whose image has no answer: it lies at a threshold, on either side of which rounding puts it.

    A failure that says so is no wrong answer.
    """
    return np.where(status == Status.ok, Status.ok, -1)


def _allowed(case: Case, found: Results, base: float) -> Array:
    """`base` times what the answer is sensitive to; NaN where that is too much to be judged."""
    rng = np.random.default_rng(1)
    answers = [_changed(case, rng) for _ in range(TRIALS)]
    return base * _growth(case, found, answers)


def _allowed_from_force(case: Case, found: Results, base: float) -> Array:
    """The same of the line that starts with the answered force; for plane methods, by one that may leave the plane."""
    solver, options = ("stream_line", {}) if case.solver in PLANE else (case.solver, case.options)
    rng = np.random.default_rng(1)
    answers = []
    for _ in range(TRIALS):
        outputs, ok = _from_force(case, found, solver, options, CHANGE * rng.normal(size=(case.size, 3)))
        answers.append((outputs, np.where(ok, Status.ok, -1)))
    return base * _growth(case, found, answers)


def _growth(case: Case, found: Results, answers: list[tuple[dict[str, Array], np.ndarray]]) -> Array:
    """By how many times changes grow, with room for those that were not tried."""
    grown = np.max([_apart(case, found, *answer) for answer in answers], axis=0)
    return np.where(grown < MOST, ROOM * (1.0 + grown / CHANGE), np.nan)


def _changed(case: Case, rng: np.random.Generator) -> tuple[dict[str, Array], np.ndarray]:
    """The answers to parameters that are changed by a little; lines in a plane stay in it."""
    changed = {}
    for name in {"force_A", "position_B", "line_length", "depth", "weight_per_length"} & set(case.parameters):
        values = case.parameters[name]
        change = CHANGE * rng.normal(size=values.shape[:1])
        if values.ndim == 1 or case.solver == "pode_table_line":  # which knows ends above one another only
            changed[name] = (values.T * (1.0 + change)).T
        elif case.solver in PLANE:
            along = [np.cos(case.parameters["heading"]), np.sin(case.parameters["heading"]), np.zeros(case.size)]
            changed[name] = values + (norm(values) * change * along).T
            changed[name][:, 2] += CHANGE * norm(values) * rng.normal(size=case.size)
        else:
            changed[name] = values + norm(values)[:, None] * CHANGE * rng.normal(size=values.shape)
    other = case.solve(ANSWERS, **changed)
    return other.outputs, other.status
