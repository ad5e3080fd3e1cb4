"""Scenarios that are hunted together, and what a judge is."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cablesim import batch
from cablesim.batch import Results
from cablesim.numerics import Array


@dataclass(frozen=True)
class Case:
    """Scenarios of one solver with the same options; parameters as `batch.solve` takes them, one entry or row each."""

    solver: str
    parameters: dict[str, np.ndarray]
    options: dict[str, Any]

    @property
    def size(self) -> int:
        return len(next(iter(self.parameters.values())))

    def solve(self, outputs: tuple[str, ...] = (), **changed: Any) -> Results:
        """Solve them, with some parameters changed."""
        return batch.solve(self.solver, {**self.parameters, **changed}, self.options, outputs)

    def rows(self, which: Any) -> "Case":
        """Some of the scenarios."""
        return replace(self, parameters={name: values[which] for name, values in self.parameters.items()})

    def command(self, row: int) -> str:
        """What to type to solve one of them again, to the last digit."""
        given = " ".join(f"{name}={_typed(values[row])}" for name, values in self.parameters.items())
        options = "".join(f" --option {name}={value}" for name, value in self.options.items())
        return f"cablesim solve {self.solver} {given}{options}"


# Of a case of which every scenario is ok, and its results: by how much each misses, in units of what is allowed. More
# than 1 is wrong, NaN is not judged.
Judge = Callable[[Case, Results], Array]


def rows_of(results: Results, which: np.ndarray) -> Results:
    """Some of the scenarios of results."""
    outputs = {name: values[which] for name, values in results.outputs.items()}
    return Results(outputs, results.status[which], results.iterations[which], results.seconds)


def _typed(value: Any) -> str:
    if np.ndim(value):
        return ",".join(repr(float(part)) for part in value if np.isfinite(part))
    return str(value) if isinstance(value, str) else repr(float(value))
