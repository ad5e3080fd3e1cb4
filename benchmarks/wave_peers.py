"""A line whose top is moved in still water, against MoorDyn: peaks on the same meshes, processor time at one accuracy.

The line and what MoorDyn does differently are described in `wave_moordyn.py`. Extremes are those of the force on the
top end over the last five periods.
"""

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from measure import Costs, interleaved, markdown, measure, revision
from wave_moordyn import (
    CASES,
    CONVERGED,
    HAS_MOORDYN,
    LINE,
    PRACTICAL,
    SCHEME,
    SNAPPING,
    TOP_TENSION,
    Case,
    Extremes,
    Line,
    extremes,
    moordyn_extremes,
    moordyn_run,
)

from cablesim import batch
from cablesim.machine import machine
from cablesim.numerics import Array
from cablesim.solver import load_solver
from cablesim.status import Status

# What is timed: nearly slack, and jerked taut.
TIMED = (Case(1e7, 100), Case(SNAPPING, 100))
MASSES = ("consistent", "lumped")
PERMITTED_ERROR = 5e-3
RTOLS = (3e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)
EXACT = {"integrator": "rk4"}
SAMPLES_PER_SECOND = 1000
TOGETHER, SPREAD = 256, 0.02
MILLI = 1e-3
ENDS = ("max_top_tension", "min_top_tension", "max_anchor_tension", "min_anchor_tension", "static_top_tension")


def solving(given: Line, options: dict[str, Any], outputs: tuple[str, ...] = ENDS) -> Callable[[], dict[str, Array]]:
    """A call that solves lines which have been checked, with compiled kernels: what is timed."""
    solver = load_solver("wave_line")
    parameters, chosen = solver.make_parameters(given), solver.make_options(options)
    solver.module.warm(parameters, chosen, outputs)

    def solve() -> dict[str, Array]:
        with np.errstate(all="ignore"):
            answer = solver.solve(parameters, chosen, outputs).answer
            return {name: getattr(answer, name) for name in outputs}

    return solve


def our_extremes(given: Line, options: dict[str, Any]) -> Extremes:
    """Extremes over all steps, and the averaged peak from a dense history; of one line, NaN if it is not solved."""
    samples = round(SAMPLES_PER_SECOND * LINE["duration"]) + 1
    wanted = (*ENDS, "history", "history_time")
    solution = batch.solve("wave_line", given, {**options, "samples": samples}, wanted)
    if solution.status[0] != Status.ok:
        return Extremes(np.nan, np.nan, np.nan)
    found = solution.outputs
    averaged = extremes(found["history_time"][0], found["history"][0, :, 2].astype(float)).averaged
    return Extremes(found["max_top_tension"][0], found["min_top_tension"][0], averaged)


def compared_table() -> str:
    """Peaks and minima of MoorDyn and of ours on the same meshes."""
    rows = []
    for case in CASES:
        theirs = moordyn_extremes(case, CONVERGED if case.converges else PRACTICAL)
        for mass in MASSES:
            ours = our_extremes(case.line, {"segments": case.segments, "mass": mass})
            tensions = (theirs.highest, ours.highest, theirs.averaged, ours.averaged)
            rows.append(
                (
                    f"{case}, {mass}",
                    *(f"{value / 1e3:.3f}" for value in tensions),
                    f"{ours.highest / theirs.highest - 1.0:+.2%}",
                    f"{ours.averaged / theirs.averaged - 1.0:+.2%}",
                    f"{(ours.lowest - theirs.lowest) / TOP_TENSION:+.2%}",
                )
            )
    head = ("", "peak, kN: MoorDyn", "ours", "averaged peak, kN: MoorDyn", "ours", "peak", "averaged peak", "minimum")
    return markdown(head, rows)


def timed_table(repeats: int) -> str:
    """Processor time at one accuracy: MoorDyn's largest stable step, ours alone and in batches with either mass."""
    rows = []
    for case in TIMED:
        ways = [way for mass in MASSES for way in _ways(case, {"segments": case.segments, "mass": mass})]
        theirs: list[float] = []
        actions: dict[str, Callable[[], object]] = {way.name: way.solve for way in ways}
        if HAS_MOORDYN:
            actions[SCHEME] = partial(_note_moordyn, theirs, case)
        costs = interleaved(actions, repeats)
        if theirs:
            rows.append((f"{case}: MoorDyn, {SCHEME}", *_moordyn_cells(case, theirs), "1"))
        rows += [(f"{case}: {way.name}", *_cells(way, costs[way.name], theirs)) for way in ways]
    head = ("", "ms per line: median (min .. max)", "processor ms", "peak's error", "minimum's error", "times faster")
    return markdown(head, rows)


@dataclass(frozen=True)
class Way:
    """Lines that are solved in one call, and the errors of the one that the others are spread about."""

    name: str
    lines: int
    solve: Callable[[], object]
    errors: tuple[float, float]


def _ways(case: Case, mesh: dict[str, Any]) -> list[Way]:
    """Alone and together, with the tolerance that is fastest of those that are accurate."""
    given = case.line
    exact = our_extremes(given, {**mesh, **EXACT})
    found = {rtol: _errors(our_extremes(given, {**mesh, "rtol": rtol}), exact, case) for rtol in RTOLS}
    accurate = [rtol for rtol in RTOLS if max(found[rtol]) <= PERMITTED_ERROR] or RTOLS[-1:]
    alone = {rtol: solving(given, {**mesh, "rtol": rtol}) for rtol in accurate}
    rtol = min(accurate, key=lambda rtol: min(measure(alone[rtol]).cpu for _ in range(3)))
    together = solving(given | {"top_amplitude": amplitudes()}, {**mesh, "rtol": rtol})
    name = f"{mesh['mass']} mass, rtol {rtol:g}"
    return [
        Way(name, 1, alone[rtol], found[rtol]),
        Way(f"{name}, one of {TOGETHER}", TOGETHER, together, found[rtol]),
    ]


def amplitudes() -> Array:
    """Spread, so that no two lines of a batch take the same steps."""
    return np.linspace(1.0 - SPREAD, 1.0 + SPREAD, TOGETHER) * LINE["top_amplitude"]


def _note_moordyn(seconds: list[float], case: Case) -> None:
    seconds.append(moordyn_run(case, PRACTICAL).seconds)


def _moordyn_cells(case: Case, seconds: list[float]) -> tuple[str, ...]:
    found, exact = (moordyn_extremes(case, part) for part in (PRACTICAL, CONVERGED))
    low, middle, high = (f"{value / MILLI:.3g}" for value in (min(seconds), np.median(seconds), max(seconds)))
    return f"{middle} ({low} .. {high})", middle, *_percent(_errors(found, exact, case))


def _cells(way: Way, cost: Costs, theirs: list[float]) -> tuple[str, ...]:
    seconds = cost.cpu / way.lines
    ratio = f"{np.median(theirs) / seconds:.3g}" if theirs else ""
    return cost.spread(MILLI * way.lines), f"{seconds / MILLI:.3g}", *_percent(way.errors), ratio


def _percent(pair: tuple[float, float]) -> tuple[str, str]:
    return f"{pair[0]:.2%}", f"{pair[1]:.2%}"


def _errors(found: Extremes, exact: Extremes, case: Case) -> tuple[float, float]:
    """Of peak and minimum, each to itself; of a line that snaps, of the averaged peak, and the minimum to the rest."""
    if not case.converges:
        return abs(found.averaged / exact.averaged - 1.0), abs(found.lowest - exact.lowest) / TOP_TENSION
    return abs(found.highest / exact.highest - 1.0), abs(found.lowest / exact.lowest - 1.0)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--repeats", type=int, default=3)
    given = parser.parse_args()
    packages = ("numpy", "numba", *(("moordyn",) if HAS_MOORDYN else ()))
    print(machine(*packages), f"revision {revision()}, {given.repeats} repeats in turns", sep="; ", end="\n\n")
    if HAS_MOORDYN:
        print(compared_table(), end="\n\n", flush=True)
    else:
        print("MoorDyn is not installed here, so it was left out (`pip install moordyn`).", end="\n\n")
    print(timed_table(given.repeats))


if __name__ == "__main__":
    main()
