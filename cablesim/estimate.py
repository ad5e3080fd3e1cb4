"""What a study will cost, before it runs: scenarios, jobs, time, memory and disk, from measured rates.

Solving takes what the ledgers of the folder say where the same method was solved there before, and what its solver
declares where not. What is in the folder already is not counted again. All other rates were measured with the default
profile on two cores of an AMD EPYC (`benchmarks/estimates.py` compares estimates with what studies take).
"""

import json
import math
import os
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from cablesim.config.scene import Scene
from cablesim.errors import EnvironmentFault
from cablesim.files import check, free_bytes, ledger
from cablesim.plan import ScenePlan
from cablesim.quantities import bytes_per_scenario
from cablesim.shards import MOST_BYTES, Recipe
from cablesim.study import Layout

# Seconds of a processor: Snakemake and the plans, for each scene there, for each job, for each figure.
START, PER_SCENE, PER_JOB, PER_FIGURE = 2.2, 0.04, 1.2, 0.35
# Seconds for each byte of outputs: writing a shard, collecting it, and what tables and each figure look at.
WRITE, COLLECT, SUMMARISE, DRAW = 16e-9, 21e-9, 5e-9, 10e-9
# Jobs of a scene besides solving: collecting, tables, figures; and one for the whole study, the catalogue.
JOBS_OF_SCENE, JOBS_OF_STUDY = 3, 1
# Bytes on disk: of a file beside its outputs, of a figure; and of the outputs the part that is left when they are
# compressed, in a shard and again in the dataset. The dataset and tables of a scene are as many files more.
PER_FILE, FIGURE_FILES, COMPRESSED = 25_000, 250_000, 0.65
FILES_OF_SCENE = 10
# Bytes of memory: a process that solves, one that draws, and of the outputs at hand there are so many copies.
SOLVING, DRAWING, COPIES = 220_000_000, 320_000_000, 3.0
# Of Snakemake for each job.
GRAPH_PER_JOB = 40_000
# Of what is free, as much may be asked for; and what is said to fit is a little less than what would just do.
SHARE, MARGIN = 0.95, 0.98


@dataclass(frozen=True)
class SceneEstimate:
    """What a scene costs in a folder: the seconds that new shards take, the bytes of all, and whether all is done."""

    scene: Scene
    plan: ScenePlan
    seconds: dict[str, float]
    bytes: dict[str, int]
    done: bool

    @property
    def new(self) -> int:
        """Scenarios that are still to be solved, each counted once for every method."""
        return sum(self.plan.recipes[digest].scenarios for digest in self.seconds)

    @property
    def bundles(self) -> list[float]:
        """Seconds of the jobs that solve, their start included."""
        work = ([self.seconds[s] for s in shards if s in self.seconds] for shards in self.plan.bundles.values())
        return [PER_JOB + sum(seconds) for seconds in work if seconds]

    @property
    def jobs(self) -> int:
        return len(self.bundles) + (0 if self.done else JOBS_OF_SCENE)

    @property
    def rest(self) -> float:
        """Seconds of a processor besides solving: timing, collecting, tables and figures."""
        if self.done:
            return 0.0
        timed = len(self.scene.methods) * self.scene.work_precision.seconds if self.scene.work_precision else 0.0
        figures, everything = len(self.scene.figures), sum(self.bytes.values())
        return (
            timed + PER_JOB * JOBS_OF_SCENE + PER_FIGURE * figures + (COLLECT + SUMMARISE + DRAW * figures) * everything
        )

    @property
    def processor_seconds(self) -> float:
        return sum(self.bundles) + self.rest

    def least_seconds(self, cores: int) -> float:
        """On the clock, with all cores for this scene: it is solved first, and the rest is one step after the other."""
        return max([sum(self.bundles) / cores, *self.bundles]) + self.rest if self.bundles else self.rest

    @property
    def memory(self) -> int:
        """Bytes of the largest process."""
        at_once = max((self.bytes[digest] for digest in self.seconds), default=0)
        drawn = min(sum(self.bytes.values()), MOST_BYTES)
        return int(max(SOLVING + COPIES * at_once, DRAWING + COPIES * drawn))

    @property
    def growing_disk(self) -> float:
        """Bytes of outputs that are still to be written, to shards and to the dataset."""
        stored = sum(self.bytes[digest] for digest in self.seconds) + sum(self.bytes.values())
        return 0.0 if self.done else COMPRESSED * stored

    @property
    def fixed_disk(self) -> float:
        """Bytes of files and figures, however many scenarios there are."""
        files = len(self.seconds) + FILES_OF_SCENE
        return 0.0 if self.done else PER_FILE * files + FIGURE_FILES * len(self.scene.figures)

    @property
    def disk(self) -> int:
        return int(self.fixed_disk + self.growing_disk)


@dataclass(frozen=True)
class Estimate:
    """What a study costs on some cores: seconds on the clock and of processors, bytes of memory and disk."""

    scenes: tuple[SceneEstimate, ...]
    cores: int

    @property
    def scenarios(self) -> int:
        return sum(scene.plan.scenarios for scene in self.scenes)

    @property
    def jobs(self) -> int:
        return sum(scene.jobs for scene in self.scenes) + JOBS_OF_STUDY

    @property
    def start(self) -> float:
        """Before the first job."""
        return START + PER_SCENE * len(self.scenes)

    @property
    def processor_seconds(self) -> float:
        return self.start + PER_JOB * JOBS_OF_STUDY + sum(scene.processor_seconds for scene in self.scenes)

    @property
    def seconds(self) -> float:
        """The cores share the work, but no scene is done sooner than its steps are, one after the other."""
        shared = (self.processor_seconds - self.start) / self.cores
        return self.start + max([shared, *(scene.least_seconds(self.cores) for scene in self.scenes)])

    @property
    def memory(self) -> int:
        """Of the largest process."""
        return max([SOLVING + GRAPH_PER_JOB * self.jobs, *(scene.memory for scene in self.scenes)])

    @property
    def disk(self) -> int:
        return sum(scene.disk for scene in self.scenes)


def estimate_study(planned: Iterable[tuple[Scene, ScenePlan]], layout: Layout, cores: int | None = None) -> Estimate:
    """What the scenes of a study, each with its plan, cost in a folder of results; nothing is written."""
    workers = cores or os.cpu_count() or 1
    return Estimate(tuple(_estimate(scene, plan, layout) for scene, plan in planned), workers)


def refuse_vast(scene: Scene, layout: Layout) -> None:
    """Raises EnvironmentFault for outputs that cannot fit on the disk, before a plan is made of them.

    A plan of so many shards may take hours by itself; what is there already may be a part of what is needed.
    """
    there = sum(path.stat().st_size for path in layout.shards(scene.name).glob("*.nc"))
    room = there + SHARE * free_bytes(layout.root)
    sizes = [{**method.sizes, "section": scene.sections} for method in scene.methods]
    needed = 2 * COMPRESSED * scene.size * sum(1 + bytes_per_scenario(scene.outputs, own) for own in sizes)
    if needed > room + there:
        raise _refusal(scene, f"{size(needed)} on disk are needed, {size(room)} are free", room / needed)


def refuse_what_does_not_fit(estimate: Estimate, layout: Layout, hours: float = math.inf) -> None:
    """Raises EnvironmentFault, with what would fit, where disk, memory or the hours do not suffice."""
    import psutil

    disk, memory = SHARE * free_bytes(layout.root), SHARE * psutil.virtual_memory().available
    if estimate.disk > disk:
        told = f"{size(estimate.disk)} on disk are needed, {size(disk)} are free"
        scene = max(estimate.scenes, key=lambda one: one.disk)
        raise _refusal(scene.scene, told, (scene.disk - estimate.disk + disk - scene.fixed_disk) / scene.growing_disk)
    if estimate.memory > memory:
        told = f"{size(estimate.memory)} of memory are needed, {size(memory)} are free"
        scene = max(estimate.scenes, key=lambda one: one.memory)
        raise _refusal(scene.scene, told, (memory - max(SOLVING, DRAWING)) / (COPIES * sum(scene.bytes.values())))
    if estimate.seconds > 3600.0 * hours:
        told = f"{duration(estimate.seconds)} are needed, {hours:g} h are given"
        scene = max(estimate.scenes, key=lambda one: one.processor_seconds)
        raise _refusal(scene.scene, told, 3600.0 * hours / estimate.seconds)


def _refusal(scene: Scene, told: str, share: float) -> EnvironmentFault:
    """What to say of a scene of which only a part would fit: how many points of its longest axis."""
    axis = max(scene.design.axes, key=lambda axis: axis.size)
    fitting = int(MARGIN * share * axis.size)
    instead = f"with {fitting} instead of {axis.size} points of {axis.name} it would fit"
    return EnvironmentFault(
        f"{scene.path}: {told}; {instead if fitting >= 1 else 'not even a small part of this scene would fit'}"
    )


def _estimate(scene: Scene, plan: ScenePlan, layout: Layout) -> SceneEstimate:
    folder = layout.shards(scene.name)
    rates = _measured(plan, layout)
    sizes = {digest: _bytes(scene, recipe) for digest, recipe in plan.recipes.items()}
    seconds = {
        digest: _seconds(recipe, rates) + WRITE * sizes[digest]
        for digest, recipe in plan.recipes.items()
        if not ledger(folder / f"{digest}.nc").exists()
    }
    return SceneEstimate(scene, plan, seconds, sizes, not seconds and check(layout.dataset(scene.name)).whole)


def _bytes(scene: Scene, recipe: Recipe) -> int:
    """The outputs of a shard, with the status."""
    sizes = next(m.sizes for m in scene.methods if m.solver.name == recipe.solver)
    return recipe.scenarios * (1 + bytes_per_scenario(recipe.outputs, {**sizes, "section": scene.sections}))


def _key(recipe: Recipe) -> str:
    """The same solver with the same options."""
    return f"{recipe.solver} {json.dumps(recipe.options, sort_keys=True)}"


def _seconds(recipe: Recipe, rates: dict[str, float]) -> float:
    """What a shard will take to solve."""
    rate = rates.get(_key(recipe))
    return recipe.seconds if rate is None else rate * recipe.scenarios


def _measured(plan: ScenePlan, layout: Layout) -> dict[str, float]:
    """Seconds for a scenario, by what shards of the same method took in this folder."""
    seconds: dict[str, float] = defaultdict(float)
    scenarios: dict[str, int] = defaultdict(int)
    for digest, recipe in plan.recipes.items():
        taken = _taken(layout.shards(plan.scene) / f"{digest}.nc")
        if taken > 0.0:
            seconds[_key(recipe)] += taken
            scenarios[_key(recipe)] += recipe.scenarios
    return {key: seconds[key] / scenarios[key] for key in seconds}


def _taken(shard: Path) -> float:
    try:
        return float(json.loads(ledger(shard).read_text(encoding="utf-8"))["seconds"])
    except (OSError, ValueError, KeyError, TypeError):
        return 0.0


def duration(seconds: float) -> str:
    """Seconds in words."""
    if seconds < 120.0:
        return f"{max(seconds, 1.0):.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 7200.0 else f"{seconds / 3600.0:.1f} h"


def size(size: float) -> str:
    """Bytes in words."""
    for unit in ("bytes", "kB", "MB", "GB"):
        if size < 1000.0:
            return f"{size:.3g} {unit}"
        size /= 1000.0
    return f"{size:.3g} TB"
