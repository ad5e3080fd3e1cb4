"""Random lines in waves over the whole box of `stiff_extremes`: how many are solved, how long they take, what is wrong.

    python -m benchmarks.wave_check [--lines 2000] [--seed 1] [--part 0/1] [--finer 0.1] [--limit 120] [--write FILE]

Every scenario is solved alone, is to give up by itself after so many seconds (`most_seconds`), and is killed if it
takes more than twice as many of CPU time. Judges are the balance of energy and, for a part of the scenarios, the same
run at a tenth of the tolerance.
"""

import argparse
import csv
import multiprocessing
import signal
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from cablesim.batch import solve
from cablesim.hunt._wave_lines import random_scenarios, scenario
from cablesim.physics.waves import m18_amplitude
from cablesim.status import Status

RTOL = 1e-3
# Part of the energy turned over, or of the largest peak, from which on a scenario is named.
FLAGGED = 0.05
# Length over chord, and largest strain, of lines that are said to hang and to be stiff.
HANGS, STIFF = 1.03, 1e-4
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
    words = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    words.add_argument("--lines", type=int, default=2000)
    words.add_argument("--part", default="0/1", help="which of how many parts of them")
    words.add_argument("--seed", type=int, default=1)
    words.add_argument("--finer", type=float, default=0.1, help="share of the scenarios that are solved twice")
    words.add_argument("--limit", type=float, default=120.0, help="seconds after which a run gives up")
    words.add_argument("--write", type=Path, default=Path("wave_check.csv"))
    given = words.parse_args()
    every = round(1.0 / given.finer) if given.finer > 0.0 else given.lines + 1
    part, parts = (int(word) for word in given.part.split("/"))
    tasks = []
    for i in range(part, given.lines, parts):
        tasks += [(i, RTOL)] + ([(i, 0.1 * RTOL)] if i % every == 0 else [])
    line, options = random_scenarios(given.lines, given.seed)
    names = ["i", "rtol", "status", "seconds", *OUTPUTS, *options, *line]
    found = []
    with given.write.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, names)
        table.writeheader()
        for row in run(tasks, line, options, given.limit):
            table.writerow(row)
            file.flush()
            found.append(row)
    report(found)


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
                about = {"status": f"killed by {-(worker.exitcode or 0)}", "seconds": 2.0 * limit}
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
        signal.setitimer(signal.ITIMER_PROF, 2.0 * limit)
        row = solve_one(line, options, i, rtol, most_seconds=limit)
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        pipe.send(row)


def solve_one(line: Row, options: Row, i: int, rtol: float, **more: Any) -> Row:
    given, chosen = scenario(line, options, i)
    start = process_time()
    found = solve("wave_line", given, {**chosen, "rtol": rtol, **more}, OUTPUTS)
    seconds = process_time() - start
    about = {"status": Status(found.status[0]).name, "seconds": seconds}
    return about | {name: np.asarray(value).item() for name, value in found.outputs.items()}


def report(found: list[Row]) -> None:
    main, finer = ({row["i"]: row for row in found if (row["rtol"] == RTOL) is wanted} for wanted in (True, False))
    both = [i for i in finer if main[i]["status"] == finer[i]["status"] == "ok"]
    solved = [row for row in main.values() if row["status"] == "ok"]
    print("status      ", dict(Counter(row["status"] for row in main.values())))
    print("energy error", quantiles([row["energy_error"] for row in solved]))
    print(
        "peaks       ", quantiles([difference(main[i], finer[i]) for i in both]), f"between tolerances, of {len(both)}"
    )
    print("CPU seconds ", quantiles([row["seconds"] for row in main.values()]))
    for i, row in main.items():
        if reasons := flags(row, finer.get(i)):
            print(f"{i:6} {row['seconds']:8.2f} s  {', '.join(reasons)}; {', '.join(nature(row)) or 'ordinary'}")


def quantiles(values: list[float]) -> str:
    if not values:
        return "none"
    shares = (0.5, 0.9, 0.95, 0.99, 1.0)
    return " ".join(
        f"{share:.0%}: {value:.1e}" for share, value in zip(shares, np.quantile(values, shares), strict=True)
    )


def difference(row: Row, finer: Row) -> float:
    """Largest difference of the peaks of two runs, relative to the largest of all."""
    return max(abs(row[name] - finer[name]) for name in PEAKS) / max(finer[name] for name in PEAKS)


def flags(row: Row, finer: Row | None) -> list[str]:
    """What is to be looked at in a scenario."""
    if row["status"] != "ok":
        return [row["status"]]
    found = [f"energy error {row['energy_error']:.2f}"] if row["energy_error"] > FLAGGED else []
    if finer and finer["status"] == "ok" and difference(row, finer) > FLAGGED:
        found.append(f"peaks differ by {difference(row, finer):.2f}")
    return found


def nature(row: Row) -> list[str]:
    """What makes a scenario hard."""
    strain = row.get("max_strain", np.nan)
    words = {
        "snaps": row.get("snap_count", 0) > 0,
        "no drag across": row["normal_drag"] == 0.0,
        "internal damping": row["internal_damping"] > 1e-3 * row["linear_stiffness"],
        "hangs": row["length_ratio"] > HANGS,
        "stiff": strain < STIFF,
        "softens": row["stiffness_ratio"] < 0.0,
        "tossed": top_amplitude(row) > 0.2 * row["depth"],
    }
    return [word for word, is_so in words.items() if is_so]


def top_amplitude(row: Row) -> float:
    if "top_amplitude" in row:
        return row["top_amplitude"]
    return 0.5 * row["wave_height"] if "wave_height" in row else m18_amplitude(row["wave_period"])


if __name__ == "__main__":
    main()
