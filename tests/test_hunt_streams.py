"""The hunt of lines in a stream: a small one finds nothing, and each judge catches a spoiled answer."""

from dataclasses import replace

import numpy as np
import pytest

from cablesim.batch import Results
from cablesim.hunt import streams
from cablesim.hunt._case import Case, rows_of
from cablesim.hunt._hunt import hunt
from cablesim.status import Status

SIZE = 24
SPOILED = {"closure": "position_B", "mirror": "force_A", "turn": "force_A", "restart": "force_B", "second": "force_B"}


def solved(solver: str) -> tuple[Case, Results]:
    """Lines between given ends that are ok."""
    case = streams.draw(solver, 3 * SIZE, np.random.default_rng(4))[-1]
    results = case.solve()
    ok = results.status == Status.ok
    return case.rows(ok), rows_of(results, ok)


@pytest.mark.parametrize("solver", ["stream_line", "segment_line"])
@pytest.mark.parametrize("judge", SPOILED)
def test_an_answer_that_is_off_by_a_ten_thousandth_is_caught(solver: str, judge: str) -> None:
    """Where the answer is not too sensitive to be judged so closely: most are not."""
    case, found = solved(solver)
    name = SPOILED[judge]
    spoiled = replace(found, outputs=found.outputs | {name: found.outputs[name] * (1.0 + 1e-4)})
    with np.errstate(all="ignore"):
        right, wrong = (streams.judges(solver)[judge](case, each) for each in (found, spoiled))
    judged = np.isfinite(right)
    assert judged.sum() >= 5
    assert (right[judged] <= 1.0).all()
    assert (wrong[judged] > 1.0).mean() > 0.5


def test_a_small_hunt_finds_nothing() -> None:
    found = list(hunt(("stream_line", "segment_line"), 120, seed=1))
    assert [one.wrong for one in found] == [0, 0]
    assert all(one.status["ok"] >= 30 for one in found)
