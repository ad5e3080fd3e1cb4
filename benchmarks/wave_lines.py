"""Lines in waves: what a scenario costs alone, in batches and by each integrator, and what a first call costs.

The line is that of `wave_moordyn.py`, 50 elements, through 60 s, in four states: taut with EA = 1e7 N and 1e8 N, nearly
slack, and jerked taut in every period. In batches the amplitudes are spread by 2 % to either side, so that no two
scenarios take the same steps. Errors are of the peak and of the minimum of the force on the top end over the last five
periods, relative to the peak, against `rk4` at a fifth of its stable step. Peaks of the line that is jerked taut are
those of the mean over 0.1 s: see `wave_moordyn.py`.
"""

import argparse
import math
import os
import statistics
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from measure import Costs, interleaved, markdown, revision
from stream_lines import first_call
from wave_moordyn import CONVERGED, LINE, SNAPPING, Case, Extremes, Line, largest_step
from wave_peers import SPREAD, TOGETHER, our_extremes, solving

from cablesim.machine import machine
from cablesim.solvers._wave_line import ORDERS

Options = dict[str, Any]

MILLI = 1e-3
SEGMENTS = 50
THREADS = (1, 2)
STATES = (
    ("taut, EA 1e7 N", 1e7, 0.3),
    ("taut, EA 1e8 N", SNAPPING, 0.1),
    ("nearly slack", 1e7, 1.57),
    ("jerked taut", SNAPPING, 1.57),
)
RTOLS = (1e-2, 1e-3, 1e-4)
EXPLICIT = ("leapfrog", "rk4")
# A consistent mass makes the largest frequency larger by the square root of 3.
CONSISTENT = math.sqrt(3.0)


def moved(stiffness: float, amplitude: float) -> Line:
    return Case(stiffness, SEGMENTS).line | {"top_amplitude": amplitude}


def many(given: Line) -> Line:
    return given | {"top_amplitude": np.linspace(1.0 - SPREAD, 1.0 + SPREAD, TOGETHER) * given["top_amplitude"]}


@contextmanager
def threads(number: int) -> Iterator[None]:
    """Solvers look at this whenever they are called."""
    before = os.environ.get("OMP_NUM_THREADS")
    os.environ["OMP_NUM_THREADS"] = str(number)
    try:
        yield
    finally:
        if before is None:
            del os.environ["OMP_NUM_THREADS"]
        else:
            os.environ["OMP_NUM_THREADS"] = before


# Alone and together


def batch_table(repeats: int) -> str:
    """A scenario alone, and one of many on one thread and on two."""
    rows = []
    for name, stiffness, amplitude in STATES:
        given = moved(stiffness, amplitude)
        alone, together = (solving(lines, {"segments": SEGMENTS}) for lines in (given, many(given)))
        actions: dict[str, Callable[[], object]] = {"alone": alone}
        for number in THREADS:
            actions[_label(number)] = lambda number=number, together=together: _on(number, together)
        costs = interleaved(actions, repeats)
        rows += [_batch_row(name, key, costs[key], 1 if key == "alone" else TOGETHER) for key in actions]
    return markdown(("", "ms per line: median (min .. max)", "processor ms", "lines per second"), rows)


def _label(number: int) -> str:
    return f"one of {TOGETHER}, {number} thread{'s' if number > 1 else ''}"


def _on(number: int, solve: Callable[[], object]) -> None:
    with threads(number):
        solve()


def _batch_row(name: str, key: str, cost: Costs, count: int) -> tuple[str, ...]:
    return f"{name}, {key}", cost.spread(MILLI * count), f"{cost.cpu / count / MILLI:.3g}", f"{count / cost.wall:.3g}"


# Integrators


def integrator_table(repeats: int) -> str:
    """Cost and error of each integrator; explicit ones with the step that they choose."""
    rows = []
    for name, stiffness, amplitude in STATES:
        exact = _found(stiffness, amplitude, exact_options(stiffness))
        for options in choices():
            cost, steps = _timed(moved(stiffness, amplitude), options, repeats)
            found = _found(stiffness, amplitude, options)
            rows.append(
                (f"{name}: {_words(options)}", f"{cost / MILLI:.3g}", f"{steps:.0f}", *_errors(found, exact, name))
            )
    return markdown(("", "processor ms", "steps", "peak's error", "minimum's error"), rows)


def choices() -> list[Options]:
    """The default integrator with its tolerances, the multistep ones with theirs of 1e-3, and the explicit ones."""
    default = [{"integrator": "generalized_alpha", "rtol": rtol} for rtol in RTOLS]
    multistep = [
        {"integrator": name, "rtol": 1e-3, "most_steps": 20_000, **more}
        for name in ORDERS
        for more in ({}, {"max_order": 2})
    ]
    return default + multistep + [{"integrator": name} for name in EXPLICIT]


def exact_options(stiffness: float) -> Options:
    step = CONVERGED * largest_step(Case(stiffness, SEGMENTS)) / CONSISTENT
    return {"integrator": "rk4", "time_step": step}


def _found(stiffness: float, amplitude: float, options: Options) -> Extremes:
    return our_extremes(moved(stiffness, amplitude), {"segments": SEGMENTS, **options})


def _timed(given: Line, options: Options, repeats: int) -> tuple[float, float]:
    solve = solving(given, {"segments": SEGMENTS, **options}, ("max_top_tension", "min_top_tension", "steps"))
    cost = interleaved({"": solve}, repeats)[""].cpu
    return cost, float(solve()["steps"][0])


def _words(options: Options) -> str:
    words = {"integrator": "{}", "rtol": "rtol {:g}", "max_order": "order up to {}"}
    return ", ".join(words[key].format(value) for key, value in options.items() if key in words)


def _errors(found: Extremes, exact: Extremes, name: str) -> tuple[str, str]:
    snaps = name == STATES[-1][0]
    peaks = [extremes.averaged if snaps else extremes.highest for extremes in (found, exact)]
    size = exact.highest
    if np.isnan(found.highest):
        return "not solved", "not solved"
    return f"{abs(peaks[0] - peaks[1]) / size:.1e}", f"{abs(found.lowest - exact.lowest) / size:.1e}"


# First calls


def first_call_table(repeats: int) -> str:
    """What the first call in a fresh process costs, with an empty cache of compiled kernels and with a filled one."""
    arguments = ("wave_line", moved(*STATES[2][1:]), {"segments": SEGMENTS})
    with tempfile.TemporaryDirectory() as cache:
        cold = first_call(*arguments, cache)
        warm = [first_call(*arguments, cache) for _ in range(repeats)]
    imported, called, again = (statistics.median(times) for times in zip(*warm, strict=True))
    row = ("wave_line", f"{imported:.3g}", f"{cold[1]:.3g}", f"{called:.3g}", f"{again / MILLI:.3g}")
    head = ("", "import of cablesim.batch s", "first call, compiling s", "first call, loading s", "second call ms")
    return markdown(head, [row])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--repeats", type=int, default=3)
    given = parser.parse_args()
    print(machine("numpy", "numba", "scipy"), f"revision {revision()}, {given.repeats} repeats in turns", sep="; ")
    print(f"\nDuration {LINE['duration']:g} s, {SEGMENTS} elements, rtol 1e-3 where none is said.\n")
    for table in (batch_table, integrator_table, first_call_table):
        print(table(given.repeats), end="\n\n", flush=True)


if __name__ == "__main__":
    main()
