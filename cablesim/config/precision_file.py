"""The `work_precision` part of a scene file: whose error is set against whose run time, and how both are measured."""

from dataclasses import dataclass

from cablesim.config.document import Node
from cablesim.config.rehearsal import Rehearsal
from cablesim.quantities import SHORT, quantity

MOST_REPEATS = 1000
# Runs of each method, and seconds after which it has had enough of them.
REPEATS, SECONDS = 5, 2.0


@dataclass(frozen=True)
class WorkPrecision:
    """The output whose error counts, how well the reference is known, and how often methods are timed.

    The error of the reference is its difference from the method `check`, or a relative number, known otherwise. A
    method is run `repeats` times, fewer only where that takes more than `seconds`.
    """

    output: str
    check: str | None
    reference_error: float
    repeats: int
    seconds: float


def read_work_precision(node: Node, names: Rehearsal, reference: str | None) -> WorkPrecision:
    """Read it. Raises InputError for an unknown output or method, and where the reference's error is not told."""
    keys = node.mapping(("output",), ("check", "reference_error", "repeats", "seconds"))
    if ("check" in keys) == ("reference_error" in keys):
        node.fail("how well the reference is known is told by check: METHOD or by reference_error: NUMBER")
    outputs = tuple(name for name in names.outputs if quantity(name).dims in SHORT)
    check = None
    if "check" in keys:
        if reference is None:
            keys["check"].fail("a method can only check a method: the reference is a table")
        others = tuple(name for name in names.methods if name != reference)
        check = keys["check"].choice(others)
    return WorkPrecision(
        output=keys["output"].choice(outputs),
        check=check,
        reference_error=_positive(keys["reference_error"], "1") if "reference_error" in keys else 0.0,
        repeats=keys["repeats"].whole(1, MOST_REPEATS) if "repeats" in keys else REPEATS,
        seconds=_positive(keys["seconds"], "s") if "seconds" in keys else SECONDS,
    )


def _positive(node: Node, unit: str) -> float:
    value = node.number(unit)
    if value <= 0.0:
        node.fail(f"a number > 0 is expected, not {value:g}")
    return value
