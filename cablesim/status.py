"""The fate of a scenario. Stored as int8 beside every result, with these words as CF flag meanings."""

from enum import IntEnum


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


SENTENCES = {
    Status.ok: "solved",
    Status.infeasible: "no equilibrium exists for these parameters",
    Status.not_converged: "the method ran out of steps before it reached its accuracy",
    Status.out_of_domain: "outside the range in which the method can represent an answer",
    Status.unavailable: "the package that this method calls is not installed (pip install cablesim[peers])",
    Status.not_run: "not computed yet, or its file was lost: run the study again",
}
