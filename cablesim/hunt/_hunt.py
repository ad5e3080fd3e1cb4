"""The hunt itself: scenarios drawn, solved and judged chunk by chunk, and what came of it counted."""

import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np

from cablesim.batch import Results
from cablesim.errors import InputError, nearest
from cablesim.hunt import _generic
from cablesim.hunt._case import Case, Judge
from cablesim.hunt._draw import draw_any, number_of_sections
from cablesim.quantities import LIST, is_list, quantity
from cablesim.solver import load_solver, solver_names
from cablesim.status import Status

# Scenarios drawn at once, by a seed of their own: so many are worth the start, and parts of a hunt are made of them.
CHUNK = 5000
# Share of a solver in all scenarios, by the seconds that one takes it (at least): lines in waves take as long as
# thousands of others, and those that are marched along as long as hundreds.
SHARES = ((1e-2, 0.2), (1e-4, 1.0), (0.0, 5.0))


@dataclass(frozen=True)
class Wrong:
    """A scenario that is wrong in silence: a case of one, the judge and by how much it missed what is allowed."""

    case: Case
    judge: str
    miss: float


@dataclass
class Tally:
    """What was found of one solver."""

    solver: str
    statuses: np.ndarray = field(default_factory=lambda: np.zeros(len(Status), dtype=int))
    wrong: list[Wrong] = field(default_factory=list)
    worst: dict[str, float] = field(default_factory=dict)
    judged: dict[str, int] = field(default_factory=dict)
    number_wrong: int = 0

    @property
    def scenarios(self) -> int:
        """How many were solved, whatever became of them."""
        return int(self.statuses.sum())

    def add(self, case: Case, status: np.ndarray, misses: dict[str, np.ndarray]) -> list[Wrong]:
        """Count a case; `misses` are those of its scenarios that are ok, `case` has only them. Returns those wrong."""
        self.statuses += np.bincount(status, minlength=len(Status))
        found = np.zeros(int((status == Status.ok).sum()), dtype=bool)
        new: list[Wrong] = []
        for judge, miss in misses.items():
            self.judged[judge] = self.judged.get(judge, 0) + int(np.isfinite(miss).sum() + np.isinf(miss).sum())
            self.worst[judge] = max(self.worst.get(judge, 0.0), float(np.fmax.reduce(miss, initial=0.0)))
            new += [Wrong(case.rows(slice(i, i + 1)), judge, float(miss[i])) for i in np.flatnonzero(miss > 1.0)]
            found |= miss > 1.0
        self.wrong += new
        self.number_wrong += int(found.sum())
        return new


@cache
def families() -> dict[str, ModuleType]:
    """The module that knows each solver, by solver: every module in the folder without an underscore is a family."""
    names = sorted(path.stem for path in Path(__file__).parent.glob("*.py") if not path.stem.startswith("_"))
    modules = [import_module(f"cablesim.hunt.{name}") for name in names]
    return {solver: module for module in modules for solver in module.SOLVERS}


def draw(solver: str, size: int, rng: np.random.Generator) -> list[Case]:
    """Scenarios of a solver by its family, or by what it declares where none knows it."""
    family = families().get(solver)
    return family.draw(solver, size, rng) if family else draw_any(solver, size, rng)


def judges(solver: str) -> dict[str, Judge]:
    """By name: those of all solvers, and those of the family."""
    family = families().get(solver)
    return _generic.JUDGES | (family.judges(solver) if family else {})


def chosen(names: tuple[str, ...]) -> tuple[str, ...]:
    """The solvers asked for, or all. Raises InputError for an unknown one."""
    for name in names:
        if name not in solver_names():
            raise InputError(f"unknown solver '{name}': {nearest(name, solver_names())}")
    return tuple(dict.fromkeys(names)) or tuple(solver_names())


def shares(solvers: tuple[str, ...], scenarios: int) -> dict[str, int]:
    """How many of all scenarios each solver gets, at least one."""
    weights = {solver: _weight(solver) for solver in solvers}
    each = scenarios / sum(weights.values())
    return {solver: max(1, round(each * weight)) for solver, weight in weights.items()}


def hunt(solver: str, scenarios: int, seed: int, part: tuple[int, int], tell: Callable[[Wrong], None]) -> Tally:
    """Hunt one solver: part (I, N) takes every N-th chunk. `tell` is told of what is wrong as soon as it is found."""
    tally = Tally(solver)
    for size, rng in _chunks(solver, scenarios, seed, part):
        for case in draw(solver, size, rng):
            for wrong in _judge(case, tally):
                tell(wrong)
    return tally


def judge(case: Case, results: Results) -> dict[str, np.ndarray]:
    """The misses by all judges of scenarios that are ok."""
    with np.errstate(all="ignore"):
        return {name: each(case, results) for name, each in judges(case.solver).items()}


def _judge(case: Case, tally: Tally) -> list[Wrong]:
    results = case.solve(_outputs(case))
    ok = results.status == Status.ok
    sound = case.rows(ok)
    answers = _of_sound(results, ok, sound)
    return tally.add(sound, results.status, judge(sound, answers) if ok.any() else {})


def _of_sound(results: Results, ok: np.ndarray, sound: Case) -> Results:
    """The results of scenarios that are ok, lists as wide as the longest line among them."""
    longest = int(number_of_sections(sound.parameters).max(initial=0)) if any(map(is_list, sound.parameters)) else 0
    outputs = {
        name: values[ok][:, : longest] if quantity(name).dims[:1] == LIST else values[ok]
        for name, values in results.outputs.items()
    }
    return Results(outputs, results.status[ok], results.iterations[ok], results.seconds)


def _outputs(case: Case) -> tuple[str, ...]:
    """All but histories, which only the family of lines in waves looks at, and asks for itself."""
    solver = load_solver(case.solver)
    return tuple(
        name for name in solver.answered(solver.make_options(case.options)) if not quantity(name).is_history
    )


def _chunks(
    solver: str, scenarios: int, seed: int, part: tuple[int, int]
) -> Iterator[tuple[int, np.random.Generator]]:
    for number, first in enumerate(range(0, scenarios, CHUNK)):
        if number % part[1] == part[0] - 1:
            yield min(CHUNK, scenarios - first), np.random.default_rng([seed, zlib.crc32(solver.encode()), number])


def _weight(solver: str) -> float:
    loaded = load_solver(solver)
    seconds = loaded.seconds_per_scenario(loaded.make_options({}))
    return next(share for least, share in SHARES if seconds >= least)
