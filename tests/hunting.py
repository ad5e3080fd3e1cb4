"""What the tests of the hunt share: answers that are spoiled, to see whether a judge catches them."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cablesim.batch import Results
from cablesim.hunt._case import Case
from cablesim.hunt._hunt import hunt, judges_of


@dataclass(frozen=True)
class SpoiledCase(Case):
    """A case of a solver with an output that is wrong by a factor, for judges that solve it again themselves."""

    spoiled: str = ""
    factor: float = 1.0

    def solve(self, outputs: tuple[str, ...] = (), **changed: Any) -> Results:
        return spoil(super().solve(outputs, **changed), self.spoiled, self.factor)


def spoil(found: Results, output: str, factor: float) -> Results:
    """The same answers with one output, if it is among them, wrong by a factor."""
    right = found.outputs
    return replace(found, outputs={name: v * factor if name == output else v for name, v in right.items()})


def misses(case: Case, judge: str, output: str = "", factor: float = 1.0) -> np.ndarray:
    """What a judge says of answers with one output that is wrong by a factor."""
    return judges_of(case.solver)[judge](case, spoil(case.solve(), output, factor))


def assert_nothing_wrong(solver: str, scenarios: int, least_ok: float) -> None:
    """A small hunt finds nothing, and not for lack of answers."""
    (found,) = hunt((solver,), scenarios, seed=11)
    assert found.wrong == 0, found.told
    assert found.status["ok"] >= least_ok * found.scenarios
    # Every judge has judged some.
    assert min(found.judged.values()) > 0
