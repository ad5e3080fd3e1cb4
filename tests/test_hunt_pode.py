"""The hunt of Pode's functions: a small one finds nothing, and each judge catches a spoiled answer."""

from dataclasses import replace

import numpy as np
import pytest

from cablesim.hunt import pode
from cablesim.hunt._case import rows_of
from cablesim.hunt._hunt import hunt
from cablesim.status import Status


@pytest.mark.parametrize(
    ("judge", "name", "factor"), [("chord", "xi", 1e3), ("by parts", "eta", 1.01), ("second", "tau", 1.01)]
)
def test_a_spoiled_function_is_caught(judge: str, name: str, factor: float) -> None:
    case = pode.draw("pode_functions", 60, np.random.default_rng(2))[0]
    found = case.solve()
    ok = found.status == Status.ok
    case, found = case.rows(ok), rows_of(found, ok)
    spoiled = replace(found, outputs=found.outputs | {name: factor * found.outputs[name]})
    right, wrong = (pode.judges("pode_functions")[judge](case, each) for each in (found, spoiled))
    judged = np.isfinite(right)
    assert (right[judged] <= 1.0).all()
    assert (wrong[judged] > 1.0).mean() > 0.5


def test_a_small_hunt_finds_nothing() -> None:
    found = next(hunt(("pode_functions",), 300, seed=1))
    assert found.wrong == 0
    assert found.status["ok"] >= 250
