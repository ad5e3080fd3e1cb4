"""The fate of a scenario, and what a check says of it. Stored as int8 with these words as CF flag meanings."""

from enum import IntEnum
from typing import Any

import numpy as np


class Status(IntEnum):
    """A result is trusted only where the status is `ok`; every other status means NaN in every output."""

    ok = 0
    infeasible = 1
    not_converged = 2
    out_of_domain = 3
    unavailable = 4
    not_run = 5

    @property
    def sentence(self) -> str:
        return SENTENCES[self]


class Verdict(IntEnum):
    """What a check says of a scenario: unknown where it was not solved, or a number that counts is not finite."""

    passed = 0
    failed = 1
    unknown = 2


SENTENCES = {
    Status.ok: "solved",
    Status.infeasible: "no equilibrium exists for these parameters",
    Status.not_converged: "the method ran out of steps before it reached its accuracy",
    Status.out_of_domain: "outside the range in which the method can represent an answer",
    Status.unavailable: "the package that this method calls is not installed (pip install cablesim[peers])",
    Status.not_run: "not computed yet, or its file was lost: run the study again",
}


def flag_attributes(kind: type[IntEnum], meaning: str) -> dict[str, Any]:
    """The CF attributes of an int8 variable that holds members of an enumeration."""
    return {
        "long_name": meaning,
        "flag_values": np.array([int(member) for member in kind], dtype=np.int8),
        "flag_meanings": " ".join(member.name for member in kind),
    }


def status_attributes() -> dict[str, Any]:
    """Those of the status of a scenario."""
    return flag_attributes(Status, "fate of the scenario")
