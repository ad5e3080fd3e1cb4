"""Check a folder of results: files against their ledgers, and a sample of scenarios against a new computation.

Nothing is changed: what is damaged or missing is computed again by the next run of the study.
"""

import math
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import xarray as xr

from cablesim import batch
from cablesim.database.compare import relative_change
from cablesim.database.gather import as_wide, stored_type
from cablesim.database.reading import read_dataset, scene_paths
from cablesim.errors import EnvironmentFault, InputError
from cablesim.files import Condition, check
from cablesim.plan import ScenePlan, read_plan
from cablesim.shards import Placement, Recipe
from cablesim.solver import installed, load_solver
from cablesim.sources import source_digest
from cablesim.study import Layout


@dataclass
class Verdict:
    """What was found of a scene: the condition of its files, and of the scenarios that were computed once more."""

    scene: str
    shards: Counter[Condition] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)
    recomputed: int = 0
    differing: int = 0
    largest: float = 0.0
    notes: list[str] = field(default_factory=list)

    def fault(self, path: Path, condition: Condition) -> None:
        """Note a file that is not what was written."""
        self.faults.append(f"{path}: {condition.value}")


@dataclass(frozen=True)
class _Point:
    """A scenario of a method: its place in the dataset, and in the shard that answers it."""

    method: int
    place: tuple[int, ...]
    inside: tuple[int, ...]


def verify(layout: Layout, sample: int, seed: int, tolerance: float) -> Iterator[Verdict]:
    """A verdict for each scene of a folder; `sample` scenarios of each are computed once more.

    A scenario differs if its status does, or an output by more than the relative `tolerance`.
    Raises InputError where there is no such folder.
    """
    names = {*scene_paths(layout.root), *(path.name for path in layout.root.glob("shards/*") if path.is_dir())}
    for number, scene in enumerate(sorted(names)):
        verdict = Verdict(scene)
        plan = _check_files(layout, verdict)
        if plan is not None and sample:
            _recompute(layout, plan, verdict, sample, np.random.default_rng([seed, number]), tolerance)
        yield verdict


def _check_files(layout: Layout, verdict: Verdict) -> ScenePlan | None:
    """Look at the dataset and all shards of a scene; the plan of the dataset, where both are whole."""
    dataset, plan = layout.dataset(verdict.scene), None
    condition = check(dataset).condition
    if condition is Condition.whole:
        plan = _plan_of(layout, dataset, verdict)
    else:
        verdict.fault(dataset, condition)
    folder = layout.shards(verdict.scene)
    paths = {*folder.glob("*.nc"), *(folder / f"{digest}.nc" for digest in (plan.recipes if plan else ()))}
    for path in sorted(paths):
        condition = check(path).condition
        verdict.shards[condition] += 1
        if condition is not Condition.whole:
            verdict.fault(path, condition)
    return plan


def _plan_of(layout: Layout, dataset: Path, verdict: Verdict) -> ScenePlan | None:
    """The plan that a dataset was made by."""
    try:
        return read_plan(layout.plans / f"{verdict.scene}.{read_dataset(dataset).attrs.get('plan', '')}.npz")
    except (EnvironmentFault, InputError) as problem:
        verdict.notes.append(f"nothing computed again: {problem}")
        return None


def _recompute(
    layout: Layout, plan: ScenePlan, verdict: Verdict, sample: int, draw: np.random.Generator, tolerance: float
) -> None:
    """Solve a random sample of scenarios from their recipes, and compare with what the dataset says."""
    dataset = read_dataset(layout.dataset(verdict.scene))
    shape = dataset.status.shape
    places = draw.choice(math.prod(shape), size=min(sample, math.prod(shape)), replace=False)
    asked: dict[str, list[_Point]] = defaultdict(list)
    for place in np.stack(np.unravel_index(np.sort(places), shape), axis=1).tolist():
        method = plan.methods[place[0]]
        for placement in method.placements:
            inside = _inside(placement, [place[1:][position] for position in method.positions])
            if inside is not None:
                asked[placement.recipe.digest].append(_Point(place[0], tuple(place), inside))
                break
    for digest, points in asked.items():
        recipe = plan.recipes[digest]
        if _can_be_solved(recipe, verdict):
            _compare(dataset, recipe, points, verdict, tolerance)


def _inside(placement: Placement, point: list[int]) -> tuple[int, ...] | None:
    """Where a point of a method's design is in a shard; None where it is not in it."""
    inside = [0] * len(placement.recipe.axes)
    for own, axis, source, target in zip(point, placement.axis, placement.source, placement.target, strict=True):
        found = np.flatnonzero(target == own)
        if not found.size:
            return None
        if axis >= 0:
            inside[axis] = int(source[found[0]])
    return tuple(inside)


def _can_be_solved(recipe: Recipe, verdict: Verdict) -> bool:
    """Whether the solver is there; what has changed about it since is told."""
    try:
        solver = load_solver(recipe.solver)
    except InputError:
        verdict.notes.append(f"the solver {recipe.solver} is no more")
        return False
    if solver.requires and not installed(solver.requires):
        verdict.notes.append(f"{recipe.solver} needs {solver.requires}, which is not installed")
        return False
    if source_digest(recipe.solver) != recipe.sources:
        verdict.notes.append(f"the code of {recipe.solver} has changed since")
    return True


def _compare(dataset: xr.Dataset, recipe: Recipe, points: list[_Point], verdict: Verdict, tolerance: float) -> None:
    solver = load_solver(recipe.solver)
    at = np.array([point.inside for point in points], dtype=np.int64).reshape(len(points), len(recipe.axes))
    varying = {name: own[at[:, i]] for i, axis in enumerate(recipe.axes) for name, own in axis.columns.items()}
    fixed = {name: np.full(len(points), value) for name, value in recipe.fixed.items()}
    parameters = solver.from_columns({**fixed, **varying})
    found = batch.run(solver, parameters, solver.make_options(recipe.options), recipe.outputs)
    outputs = [name for name in recipe.outputs if name in dataset]
    for row, point in enumerate(points):
        stored = dataset.isel(dict(zip(dataset.status.dims, point.place, strict=True)))
        changes = [
            relative_change(stored[name].values, as_wide(name, own[row : row + 1], dataset.sizes.get("section", 0))[0])
            for name in outputs
            for own in (found.outputs[name].astype(stored_type(name)),)
        ]
        worst = max((float(np.max(change, initial=0.0)) for change in changes), default=0.0)
        verdict.recomputed += 1
        verdict.largest = max(verdict.largest, worst)
        verdict.differing += int(stored.status) != int(found.status[row]) or worst > tolerance
