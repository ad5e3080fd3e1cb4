"""What a study still has to do and what that takes, before it is done: jobs, time, memory and disk.

Solving takes what the solvers declare. Where shards of the same solver and options are in the results already, what
these took is set against what was declared for them, and the rest is expected to be off by as much. How designs are
cut into shards does not depend on it. Nothing is written.
"""

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from heapq import nlargest
from pathlib import Path

from cablesim import costs
from cablesim.config.method import Method
from cablesim.config.precision_file import WorkPrecision
from cablesim.config.scene import Scene
from cablesim.costs import Job, Sizes
from cablesim.files import ledger
from cablesim.plan import ScenePlan, make_plan, plan_path, read_plan
from cablesim.shards import Recipe
from cablesim.study import Layout

# Less measured time than this says nothing, and plans larger than this are not read for it.
LEAST_MEASURED, LARGEST_READ = 0.1, 50_000_000
# A run of a method that is timed is at least as long, in seconds (database.timing).
SHORTEST_RUN = 0.01


@dataclass(frozen=True)
class Estimate:
    """What is still to be done. Memory is that of the largest process; `together` that of all that run at a time."""

    scenarios: int
    jobs: int
    seconds: float
    processor_seconds: float
    memory_bytes: int
    together_bytes: int
    disk_bytes: int


@dataclass(frozen=True)
class MethodEstimate:
    """What solving by one method takes: scenarios and shards that are not there yet, and seconds."""

    method: Method
    scenarios: int
    shards: int
    seconds: float


@dataclass(frozen=True)
class SceneEstimate:
    """The jobs that a scene still asks for: bundles of shards, timing (alone on the machine), collecting, reporting."""

    scene: Scene
    methods: tuple[MethodEstimate, ...]
    solving: tuple[Job, ...]
    timing: tuple[Job, ...]
    collecting: tuple[Job, ...]
    reporting: tuple[Job, ...]
    disk: float

    @cached_property
    def jobs(self) -> tuple[Job, ...]:
        return (*self.solving, *self.timing, *self.collecting, *self.reporting)

    @property
    def chain(self) -> float:
        """Seconds of what has to be done one after the other."""
        return sum(max((job.seconds for job in jobs), default=0.0) for jobs in self._phases) + len(self._phases) * (
            costs.JOB_SECONDS
        )

    def together(self, cores: int) -> float:
        """Memory of the jobs that run at the same time."""
        return max(
            (sum(nlargest(cores, (job.memory for job in jobs))) for jobs in (*self._phases, self.timing)), default=0.0
        )

    @property
    def _phases(self) -> tuple[tuple[Job, ...], ...]:
        return tuple(jobs for jobs in (self.solving, self.collecting, self.reporting) if jobs)


@dataclass(frozen=True)
class StudyEstimate:
    """The scenes of a study, and what they take on some cores, one by one and all together."""

    scenes: tuple[SceneEstimate, ...]
    cores: int
    rates: "Rates"

    def of(self, *scenes: SceneEstimate) -> Estimate:
        """What some of the scenes take, run by themselves."""
        jobs = [job for scene in scenes for job in scene.jobs]
        if jobs:
            made = (Sizes(scene.scene, _plan_bytes(scene)) for scene in scenes if scene.reporting)
            jobs += [costs.catalogue_job(), costs.report_job(made)]
        alone = sum(job.seconds for scene in scenes for job in scene.timing)
        start = costs.START_SECONDS + max((Sizes(s.scene, 0.0).imports.seconds for s in scenes), default=0.0)
        work = sum(job.seconds for job in jobs) + costs.JOB_SECONDS * len(jobs)
        wall = max((work - alone) / self.cores, max((scene.chain for scene in scenes), default=0.0))
        main = costs.MAIN_BYTES + max((Sizes(s.scene, _plan_bytes(s)).read for s in scenes), default=0.0)
        most = max((scene.together(self.cores) for scene in scenes), default=0.0)
        several = sum(nlargest(self.cores, (max((j.memory for j in s.jobs), default=0.0) for s in scenes)))
        return Estimate(
            scenarios=sum(method.scenarios for scene in scenes for method in scene.methods),
            jobs=len(jobs),
            seconds=start + alone + wall,
            processor_seconds=start + work,
            memory_bytes=round(max(main, *(job.memory for job in jobs), 0.0)),
            together_bytes=round(main + max(most, several)),
            disk_bytes=round(sum(scene.disk for scene in scenes) + (costs.PAGE_BYTES if jobs else 0)),
        )

    @cached_property
    def total(self) -> Estimate:
        return self.of(*self.scenes)


def estimate_study(
    scenes: Sequence[Scene], layout: Layout, cores: int, plans: Sequence[ScenePlan] | None = None
) -> StudyEstimate:
    """What scenes still take whose results are in a folder, on so many cores; plans are read or made, never written."""
    made = plans if plans is not None else [make_plan(scene, layout.plans) for scene in scenes]
    rates = Rates(layout, made)
    return StudyEstimate(
        tuple(estimate_scene(scene, plan, layout, rates) for scene, plan in zip(scenes, made, strict=True)),
        cores,
        rates,
    )


class Rates:
    """Seconds of shards: as declared, times how much those took that are in the results already."""

    def __init__(self, layout: Layout | None = None, plans: Iterable[ScenePlan] = ()) -> None:
        self._declared: dict[str, tuple[float, float]] = {}
        if layout is not None:
            self._measure(layout, plans)

    def seconds(self, recipe: Recipe) -> float:
        """What a shard is expected to take."""
        expected, took = self._declared.get(_kind(recipe), (0.0, 0.0))
        factor = took / expected if took >= LEAST_MEASURED and expected > 0.0 else 1.0
        return recipe.expected_seconds * factor

    def _measure(self, layout: Layout, plans: Iterable[ScenePlan]) -> None:
        for plan in plans:
            folder = layout.shards(plan.scene)
            if not folder.is_dir():
                continue
            for digest, recipe in _recipes(plan, layout).items():
                took = _ledger_seconds(folder / f"{digest}.nc")
                if took > 0.0:
                    expected, before = self._declared.get(_kind(recipe), (0.0, 0.0))
                    self._declared[_kind(recipe)] = (expected + recipe.expected_seconds, before + took)


def estimate_scene(scene: Scene, plan: ScenePlan, layout: Layout | None, rates: Rates) -> SceneEstimate:
    """What a scene still asks for; without a folder of results, all of it."""
    folder, recipes = layout.shards(scene.name) if layout else None, plan.recipes
    there = {digest for digest in recipes if folder and _is_there(folder / f"{digest}.nc")}
    seconds = {digest: rates.seconds(recipe) for digest, recipe in recipes.items() if digest not in there}
    known = dict(zip((m.method for m in plan.methods), scene.methods, strict=True))
    owner = {p.recipe.digest: known[m.method] for m in reversed(plan.methods) for p in m.placements}
    count = {digest: recipes[digest].scenarios for digest in seconds}
    sizes = Sizes(scene, costs.plan_bytes(scene, plan.scenarios))
    bundles = [
        [(owner[d], count[d], seconds[d]) for d in shards if d not in there]
        for name, shards in plan.bundles.items()
        if not (layout and there.issuperset(shards) and layout.stamp(scene.name, "solve", name).exists())
    ]
    is_new = bool(seconds) or layout is None or not plan_path(layout.plans, plan.scene, plan.digest).exists()

    def wanted(step: str, job: Job) -> tuple[Job, ...]:
        return (job,) if layout is None or is_new or not layout.stamps(scene.name, step) else ()

    own = [(m, [d for d in seconds if owner[d] is m]) for m in scene.methods]
    methods = tuple(MethodEstimate(m, sum(count[d] for d in ds), len(ds), sum(seconds[d] for d in ds)) for m, ds in own)
    collecting = wanted("collect", costs.collect_job(sizes))
    disk = sum(costs.shard_bytes(scene, owner[d], count[d]) for d in seconds)
    disk += costs.dataset_bytes(sizes) + sizes.plan_bytes if collecting else 0.0
    return SceneEstimate(
        scene,
        methods,
        tuple(costs.solve_job(scene, work, sizes.plan_bytes) for work in bundles),
        _timing(scene, methods) if collecting and scene.work_precision else (),
        collecting,
        (*wanted("summarise", costs.summarise_job(sizes)), *wanted("figures", costs.figures_job(sizes))),
        disk,
    )


def _timing(scene: Scene, methods: tuple[MethodEstimate, ...]) -> tuple[Job, ...]:
    wanted = scene.work_precision
    assert wanted is not None
    reference = scene.reference.method if scene.reference else None
    taken = sum(_timed(scene, one.method, wanted) for one in methods if one.method.name != reference)
    return (Job(costs.COLLECT + costs.LOAD_SECONDS + taken, costs.READ_BYTES + costs.LOAD_BYTES),)


def _timed(scene: Scene, method: Method, wanted: WorkPrecision) -> float:
    """Solving once, then again as often as is asked or as time allows."""
    once = scene.size * method.seconds_per_scenario
    run = max(once, SHORTEST_RUN)
    return once + max(run, min(wanted.repeats * run, wanted.seconds + run))


def _recipes(plan: ScenePlan, layout: Layout) -> dict[str, Recipe]:
    """The shards of a plan and of the earlier plans of its scene."""
    found = dict(plan.recipes)
    for path in sorted(layout.plans.glob(f"{plan.scene}.*.npz")):
        if path != plan_path(layout.plans, plan.scene, plan.digest) and path.stat().st_size < LARGEST_READ:
            found |= read_plan(path).recipes
    return found


def _kind(recipe: Recipe) -> str:
    return f"{recipe.solver} {json.dumps(recipe.options, sort_keys=True)}"


def _is_there(path: Path) -> bool:
    """Whether a shard is, by its name: what it holds is looked at when the study starts."""
    return path.is_file() and ledger(path).is_file()


def _ledger_seconds(path: Path) -> float:
    try:
        return float(json.loads(ledger(path).read_text(encoding="utf-8"))["seconds"]) if _is_there(path) else 0.0
    except (OSError, ValueError, KeyError, TypeError):
        return 0.0


def _plan_bytes(estimate: SceneEstimate) -> float:
    return costs.plan_bytes(estimate.scene, sum(method.scenarios for method in estimate.methods))
