"""Random lines in waves over the whole box of `stiff_extremes`: how many are solved, how long they take, what is wrong.

    python -m benchmarks.wave_check [--lines 2000] [--seed 1] [--finer 0.2] [--limit 120] [--write FILE]

Every scenario is solved alone, in a process that is killed after so many seconds of CPU time. Judges are the balance of
energy and, for a part of the scenarios, the same run at a tenth of the tolerance.
"""

import argparse
import csv
import multiprocessing
import signal
from collections.abc import Iterator
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from cablesim.batch import solve
from cablesim.status import Status
from tests.wave_check import random_scenarios, scenario

RTOL = 1e-3
PEAKS = ("max_top_tension", "max_middle_tension", "max_anchor_tension")
OUTPUTS = (
    *PEAKS,
    "min_top_tension",
    "static_top_tension",
    "static_residual",
    "slack_fraction",
    "snap_count",
    "max_strain",
    "energy_error",
    "steps",
    "rejected_steps",
    "rhs_evaluations",
)

Row = dict[str, Any]


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--lines", type=int, default=2000)
    options.add_argument("--first", type=int, default=0, help="scenario to begin with")
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--finer", type=float, default=0.2, help="share of the scenarios that are solved twice")
    options.add_argument("--limit", type=float, default=120.0, help="CPU seconds after which a run is given up")
    options.add_argument("--write", type=Path, default=Path("wave_check.csv"))
    given = options.parse_args()
    every = round(1.0 / given.finer) if given.finer > 0.0 else given.lines + 1
    tasks = []
    for i in range(given.first, given.lines):
        tasks += [(i, RTOL)] + ([(i, 0.1 * RTOL)] if i % every == 0 else [])
    line, options = random_scenarios(given.lines, given.seed)
    names = ["i", "rtol", "status", "seconds", *OUTPUTS, *options, *line]
    with given.write.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, names)
        table.writeheader()
        for row in run(tasks, line, options, given.limit):
            table.writerow(row)
            file.flush()


def run(tasks: list[tuple[int, float]], line: Row, options: Row, limit: float) -> Iterator[Row]:
    """What became of each task; a worker that dies is replaced, and its task said to have been killed."""
    rest = list(tasks)
    while rest:
        ours, theirs = multiprocessing.Pipe()
        worker = multiprocessing.Process(target=work, args=(theirs, rest, line, options, limit))
        worker.start()
        theirs.close()
        while rest:
            (i, rtol), about = rest[0], {}
            try:
                about = ours.recv()
            except EOFError:
                worker.join()
                about = {"status": f"killed by {-(worker.exitcode or 0)}", "seconds": limit}
            given, chosen = scenario(line, options, i)
            yield {"i": i, "rtol": rtol, **about, **chosen} | {name: value.item() for name, value in given.items()}
            rest.pop(0)
            if not worker.is_alive() and worker.exitcode:
                break
        worker.join()


def work(pipe: Any, tasks: list[tuple[int, float]], line: Row, options: Row, limit: float) -> None:
    # The default action of the alarm ends a process even within compiled code.
    signal.signal(signal.SIGPROF, signal.SIG_DFL)
    solve_one(line, options, *tasks[0], most_steps=1)  # compiles and loads the kernels
    for i, rtol in tasks:
        signal.setitimer(signal.ITIMER_PROF, limit)
        row = solve_one(line, options, i, rtol)
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        pipe.send(row)


def solve_one(line: Row, options: Row, i: int, rtol: float, **more: Any) -> Row:
    given, chosen = scenario(line, options, i)
    start = process_time()
    found = solve("wave_line", given, {**chosen, "rtol": rtol, **more}, OUTPUTS)
    seconds = process_time() - start
    about = {"status": Status(found.status[0]).name, "seconds": seconds}
    return about | {name: np.asarray(value).item() for name, value in found.outputs.items()}


if __name__ == "__main__":
    main()
