"""What a hunt says: a line and a command for everything wrong, a table for every solver, and a file of the tables."""

import csv
import io
import shlex
from pathlib import Path

import numpy as np

from cablesim.files import write_text
from cablesim.hunt._hunt import Tally, Wrong
from cablesim.status import Status

HEAD = ("solver", "scenarios", *(status.name for status in Status), "wrong", "judge", "judged", "worst_miss")


def command(wrong: Wrong) -> str:
    """The command that solves the scenario again, to the last digit."""
    case = wrong.case
    values = [f"{name}={_text(value[0])}" for name, value in case.parameters.items()]
    options = [part for name, value in case.options.items() for part in ("--option", f"{name}={value}")]
    return shlex.join(["cablesim", "solve", case.solver, *values, *options])


def wrong_line(wrong: Wrong) -> str:
    """What is wrong, and how to see it."""
    missed = f"{wrong.miss:.3g} times what is allowed"
    return f"WRONG {wrong.case.solver}: {wrong.judge} misses by {missed}\n  {command(wrong)}"


def summary(tally: Tally) -> str:
    """A solver's counts and the worst miss of each judge."""
    counts = ", ".join(f"{tally.statuses[status]} {status.name}" for status in Status if tally.statuses[status])
    head = f"{tally.solver}: {tally.scenarios} scenarios ({counts}), {tally.number_wrong} wrong"
    return "\n".join([head, *(f"  {judge:<24} worst {worst:.3g}" for judge, worst in tally.worst.items())])


def write_tallies(path: Path, tallies: list[Tally]) -> None:
    """One row for every judge of every solver, as CSV."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(HEAD)
    for tally in tallies:
        counts = (tally.solver, tally.scenarios, *tally.statuses, tally.number_wrong)
        table.writerows((*counts, judge, tally.judged[judge], f"{worst:.4g}") for judge, worst in tally.worst.items())
    write_text(path, text.getvalue())


def _text(value: np.ndarray) -> str:
    """Every digit; a list ends where its line does."""
    if value.dtype.kind == "U":
        return str(value)
    return ",".join(repr(float(part)) for part in np.atleast_1d(value) if not np.isnan(part))
