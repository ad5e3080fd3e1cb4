"""Inject every fault many times and write the table of figures: `python -m tests.faults`, which is `make faults`."""

import argparse
import tempfile
from pathlib import Path
from time import perf_counter

from tests.faults import files, inputs, runs
from tests.faults.fault import Fault, Outcome

FAULTS: tuple[Fault, ...] = (*files.FAULTS, *inputs.FAULTS, *runs.FAULTS)
PAGE = Path(__file__).parents[2] / "docs" / "faults.md"
HEAD = """# What a study survives

Written by `make faults`. A fault is survived where the damage is found, the answer is refused in one line, or the study
is finished with the right numbers; lost shards are those that had to be computed again.

| fault | injected | survived | lost shards | recovered by | figures |
| --- | ---: | ---: | ---: | --- | --- |
"""


def row(fault: Fault, outcome: Outcome) -> str:
    """A line of the table."""
    lost = "" if outcome.lost is None else outcome.lost
    return (
        f"| {fault.name} | {outcome.injected} | {outcome.survived} | {lost} | {fault.recovery} | {outcome.figures} |\n"
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--only", default="", help="Faults with this in their names; nothing is written then.")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    rows, failed = [], False
    for fault in FAULTS:
        if asked.only not in fault.name:
            continue
        start = perf_counter()
        with tempfile.TemporaryDirectory() as folder:
            outcome = fault.inject(Path(folder), fault.full, asked.seed)
        rows.append(row(fault, outcome))
        print(rows[-1], end="", flush=True)
        print(f"  {perf_counter() - start:.0f} s", *outcome.failures[:20], sep="\n  ", flush=True)
        failed |= bool(outcome.failures)
    if not asked.only:
        PAGE.write_text(HEAD + "".join(rows), encoding="utf-8")
    return int(failed)


if __name__ == "__main__":
    raise SystemExit(main())
