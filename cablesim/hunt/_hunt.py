"""The hunt itself: for each solver blocks of scenarios, solved and judged, in bounded memory.

A block is drawn by solver, seed and number alone, so that a hunt in parts, or a longer one, meets the same scenarios.
"""

import importlib
import math
import zlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np

from cablesim.hunt import _anything
from cablesim.hunt._case import Case, Judge, rows_of
from cablesim.solver import load_solver, solver_names
from cablesim.status import Status

FOLDER = Path(__file__).parent
# Scenarios of a block.
BLOCK = 1000
# Of a solver, so many wrong answers are told of one by one.
MOST_TOLD = 20


@dataclass(frozen=True)
class Wrong:
    """An answer with status ok that a judge did not believe: by how many times what is allowed it missed."""

    judge: str
    miss: float
    command: str


@dataclass
class Findings:
    """What the hunt has found of one solver."""

    solver: str
    scenarios: int = 0
    status: Counter[str] = field(default_factory=Counter)
    judged: Counter[str] = field(default_factory=Counter)
    worst: dict[str, float] = field(default_factory=dict)
    wrong: int = 0
    told: list[Wrong] = field(default_factory=list)

    def add(self, case: Case, verdicts: dict[str, np.ndarray], status: np.ndarray) -> None:
        """Take note of a case: statuses of all, misses of those that are ok."""
        self.scenarios += case.size
        self.status.update(Status(int(word)).name for word in status)
        ok = np.flatnonzero(status == Status.ok)
        guilty = np.zeros(ok.size, dtype=bool)
        for name, miss in verdicts.items():
            judged = ~np.isnan(miss)
            self.judged[name] += int(judged.sum())
            self.worst[name] = max(self.worst.get(name, 0.0), float(np.max(miss[judged], initial=0.0)))
            new = (miss > 1.0) & ~guilty
            self.told += [Wrong(name, float(miss[i]), case.command(int(ok[i]))) for i in np.flatnonzero(new)]
            guilty |= new
        self.wrong += int(guilty.sum())
        del self.told[MOST_TOLD:]


@cache
def families() -> dict[str, ModuleType]:
    """The family of each solver that has one."""
    names = sorted(path.stem for path in FOLDER.glob("*.py") if not path.stem.startswith("_"))
    modules = [importlib.import_module(f"cablesim.hunt.{name}") for name in names]
    return {solver: module for module in modules for solver in module.SOLVERS}


def hunt(solvers: tuple[str, ...], scenarios: int, seed: int, part: tuple[int, int] = (0, 1)) -> Iterator[Findings]:
    """What is found of each solver; `scenarios` in all are shared by what one costs. InputError for unknown ones."""
    names = solvers or tuple(solver_names())
    weights = {name: _weight(load_solver(name).name) for name in names}
    for name in names:
        wanted = max(1, round(scenarios * weights[name] / sum(weights.values())))
        yield _hunt_one(name, wanted, seed, part)


def judges_of(solver: str) -> dict[str, Judge]:
    """The judges of a solver's family, laws first."""
    return families().get(solver, _anything).judges(solver)


def _hunt_one(solver: str, wanted: int, seed: int, part: tuple[int, int]) -> Findings:
    found, judges = Findings(solver), judges_of(solver)
    for block in range(part[0], math.ceil(wanted / BLOCK), part[1]):
        size = min(BLOCK, wanted - block * BLOCK)
        rng = np.random.default_rng((seed, zlib.crc32(solver.encode()), block))
        for case in families().get(solver, _anything).draw(solver, size, rng):
            _judge(case, judges, found)
    return found


def _judge(case: Case, judges: dict[str, Judge], found: Findings) -> None:
    results = case.solve()
    ok = results.status == Status.ok
    solved, answers = case.rows(ok), rows_of(results, ok)
    verdicts = {name: judge(solved, answers) for name, judge in judges.items()} if ok.any() else {}
    found.add(case, verdicts, results.status)


def _weight(solver: str) -> float:
    return getattr(families().get(solver), "WEIGHTS", {}).get(solver, 1.0)
