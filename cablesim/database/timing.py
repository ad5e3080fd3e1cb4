"""Run times of the methods of a scene: warm, repeated, in turns, on one thread, apart from the results.

All methods are run in one process, one after the other and over again, so that a busy minute of the machine falls on
all of them. A run is a batch of all scenarios of the scene that differ to the method; a short one is repeated within a
measurement until a clock can tell. The first call, which loads or compiles machine code, is measured apart.
"""

import json
import math
import statistics
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from cablesim import batch
from cablesim.config.method import Method
from cablesim.config.precision_file import WorkPrecision
from cablesim.config.scene import Scene
from cablesim.design import expand
from cablesim.errors import EnvironmentFault
from cablesim.files import Condition, check, enter_in_ledger, write_text
from cablesim.machine import machine
from cablesim.solver import installed

# A measurement takes at least so long.
SHORTEST = 0.01
# Scenarios that are solved alone as well, spread over the scene, and the seconds after which these are enough.
ALONE, ENOUGH = 5, 0.1
THREADS = 1
# The group of a dataset that holds what was measured.
MEASURED = "measured"


@dataclass(frozen=True)
class Timing:
    """Seconds of one method: of each timed run and of one scenario alone, per scenario, and of the first call."""

    runs: tuple[float, ...]
    alone: float
    first_call: float

    @property
    def median(self) -> float:
        return statistics.median(self.runs)


@dataclass(frozen=True)
class Timings:
    """What was measured in a scene, by method, and where."""

    machine: str
    import_seconds: float
    methods: dict[str, Timing]


def measure(scene: Scene, wanted: WorkPrecision, import_seconds: float) -> Timings:
    """Time every method of a scene but the reference, of whose error nothing is known."""
    reference = scene.reference.method if scene.reference else None
    called = [_Called(scene, method) for method in scene.methods if method.name != reference]
    for _ in range(wanted.repeats):
        for one in called:
            if len(one.spent) < wanted.repeats and sum(one.spent) < wanted.seconds:
                one.run()
    packages = {method.solver.requires for method in scene.methods} - {""}
    present = sorted(package for package in packages if installed(package))
    where = machine("numpy", "scipy", "numba", *present)
    return Timings(where, import_seconds, {one.name: one.timing() for one in called})


def write_timings(path: Path, timings: Timings) -> None:
    """Write the file, whole; those of other content go."""
    text = json.dumps(asdict(timings), indent=1) + "\n"
    for old in path.parent.glob(f"{path.name.split('.', 1)[0]}.*.json"):
        old.unlink()
    write_text(path, text)
    enter_in_ledger(path)


def read_timings(path: Path) -> Timings:
    """Read a file of timings. Raises EnvironmentFault for one that is missing or not what was written."""
    condition = check(path).condition
    if condition is not Condition.whole:
        raise EnvironmentFault(f"{path}: {condition.value}; run the study again")
    try:
        stored = json.loads(path.read_text(encoding="utf-8"))
        methods = {
            name: Timing(tuple(one["runs"]), one["alone"], one["first_call"]) for name, one in stored["methods"].items()
        }
        return Timings(stored["machine"], stored["import_seconds"], methods)
    except (OSError, ValueError, KeyError, TypeError) as problem:
        raise EnvironmentFault(f"{path}: cannot be read ({problem}); remove it and run the study again") from None


class _Called:
    """A method, its scenarios, and the seconds that its runs took."""

    def __init__(self, scene: Scene, method: Method):
        axes = (axis.only(method.columns) for axis in scene.design.axes)
        fixed = {name: value for name, value in scene.fixed.items() if name in method.columns}
        columns = {**fixed, **expand(tuple(axis for axis in axes if axis is not None))}
        self.name, self.method, self.outputs = method.name, method, scene.outputs
        self.parameters = method.solver.from_columns(columns)
        start = perf_counter()
        self.seconds(self.parameters.part(slice(0, 1)))
        self.first_call = perf_counter() - start
        once = self.seconds(self.parameters)
        self.calls = math.ceil(SHORTEST / once)
        self.spent = [once] if self.calls == 1 else []

    def seconds(self, parameters: Any) -> float:
        """What solving takes, without what is compiled or loaded first."""
        return batch.run(self.method.solver, parameters, self.method.made_options, self.outputs).seconds

    def run(self) -> None:
        self.spent.append(sum(self.seconds(self.parameters) for _ in range(self.calls)))

    def timing(self) -> Timing:
        runs = tuple(seconds / self.calls / self.parameters.size for seconds in self.spent)
        return Timing(runs, statistics.median(self.singles()), self.first_call)

    def singles(self) -> list[float]:
        """Some scenarios solved alone, fewer where one takes long."""
        taken: list[float] = []
        for row in np.unique(np.linspace(0, self.parameters.size - 1, ALONE).astype(int)):
            if sum(taken) < ENOUGH:
                taken.append(self.seconds(self.parameters.part(slice(row, row + 1))))
        return taken
