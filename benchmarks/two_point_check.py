"""Random lines in a stream between two points: how many are solved, and whether another method agrees with each.

    python -m benchmarks.two_point_check [--lines 10000] [--seed 1]

Every solved line is followed from node to node by extrapolated midpoint steps of the equations (tests/stream_check.py).
A line is wrong if a piece misses the next node by more than 1e-8 of the tension there, or of the length of the line.
"""

import argparse
from time import perf_counter

import numpy as np

from cablesim.batch import solve
from cablesim.hunt._stream_check import Check, check, random_problems
from cablesim.status import Status
from tests.helpers import rows

WRONG = 1e-8
# Lines followed at once: few enough that their pieces stay in memory.
TOGETHER = 500


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--lines", type=int, default=10_000)
    options.add_argument("--seed", type=int, default=1)
    given = options.parse_args()
    problems = random_problems(given.lines, given.seed)
    solve("stream_line", rows(problems, slice(1)))  # loads the compiled kernels
    start = perf_counter()
    found = solve("stream_line", problems)
    seconds = perf_counter() - start
    parts = [check(rows(problems, slice(i, i + TOGETHER))) for i in range(0, given.lines, TOGETHER)]
    report(parts, found.iterations, seconds)


def report(parts: list[Check], iterations: np.ndarray, seconds: float) -> None:
    status, closing, misfit = (
        np.concatenate([getattr(part, name) for part in parts]) for name in ("status", "closing", "misfit")
    )
    solved = status == Status.ok
    print(f"lines         {status.size}")
    print(f"solved        {solved.sum()} ({solved.mean():.3%})")
    for fate in Status:
        if fate != Status.ok:
            print(f"{fate.name:<14}{(status == fate).sum()}")
    print(f"wrong         {(misfit[solved] > WRONG).sum()}")
    print(f"worst misfit  {misfit[solved].max():.1e}, of a closing error {closing[solved].max():.1e}")
    print(f"seconds       {seconds:.1f} ({seconds / status.size:.1e} a line), at most {iterations.max()} integrations")


if __name__ == "__main__":
    main()
