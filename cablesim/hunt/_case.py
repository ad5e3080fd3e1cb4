"""What is hunted and what judges it: scenarios of one solver, and functions that say by how much each misses a law."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from cablesim import batch
from cablesim.batch import Results
from cablesim.numerics import Array


@dataclass(frozen=True)
class Case:
    """Scenarios of one solver with the same options: parameters as `batch.solve` takes them, one row a scenario."""

    solver: str
    parameters: dict[str, np.ndarray]
    options: dict[str, Any] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """The number of scenarios."""
        return len(next(iter(self.parameters.values())))

    def solve(self, outputs: tuple[str, ...] = (), **changed: np.ndarray) -> Results:
        """The answers to these scenarios, with some of their parameters changed."""
        return batch.solve(self.solver, self.parameters | changed, self.options, outputs)

    def rows(self, which: np.ndarray | slice) -> "Case":
        """Some of the scenarios."""
        return replace(self, parameters={name: values[which] for name, values in self.parameters.items()})


# Given a case of which every scenario is ok, and its results: by how much each scenario misses, in units of what is
# allowed. More than 1 is wrong; NaN is not judged.
Judge = Callable[[Case, Results], Array]
