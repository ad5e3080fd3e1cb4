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
    return f"| {fault.name} | {outcome.injected} | {outcome.survived} | {lost} | {fault.recovery} | {outcome.figures} |"


def write_rows(found: dict[str, str]) -> None:
    """Replace the lines of these faults in the page; the others stay."""
    lines = PAGE.read_text(encoding="utf-8").splitlines() if PAGE.exists() else []
    known = {fault.name: line for fault in FAULTS for line in lines if line.startswith(f"| {fault.name} |")} | found
    rows = [known[fault.name] for fault in FAULTS if fault.name in known]
    PAGE.write_text(HEAD + "\n".join(rows) + "\n", encoding="utf-8")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--only", default="", help="Faults with this in their names; their lines alone are replaced.")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    failed = False
    for fault in (fault for fault in FAULTS if asked.only in fault.name):
        start = perf_counter()
        with tempfile.TemporaryDirectory() as folder:
            outcome = fault.inject(Path(folder), fault.full, asked.seed)
        print(row(fault, outcome), f"  {perf_counter() - start:.0f} s", *outcome.failures[:20], sep="\n", flush=True)
        write_rows({fault.name: row(fault, outcome)})
        failed |= bool(outcome.failures)
    return int(failed)


if __name__ == "__main__":
    raise SystemExit(main())
