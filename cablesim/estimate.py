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
from dataclasses import dataclass, field
from pathlib import Path

from cablesim.config.scene import Scene
from cablesim.errors import EnvironmentFault
from cablesim.files import check, free_bytes, ledger
from cablesim.plan import ScenePlan, make_plan
from cablesim.quantities import bytes_per_scenario
from cablesim.shards import MOST_BYTES, Recipe
from cablesim.study import Layout

# Seconds of a processor: Snakemake and the plans, for each scene there, for each job, for each figure.
START, PER_SCENE, PER_JOB, PER_FIGURE = 2.2, 0.04, 1.2, 0.35
# Seconds for each byte of outputs: writing a shard, collecting it, and what tables and each figure look at.
WRITE, COLLECT, SUMMARISE, DRAW = 16e-9, 21e-9, 5e-9, 10e-9
# Jobs of a scene besides solving: collecting, tables, figures; and one for the whole study, the catalogue.
JOBS_OF_SCENE, JOBS_OF_STUDY = 3, 1
# Bytes on disk: of a file beside its outputs, of a table of all values for each number in it, of a figure; and of the
# outputs the part that is left when they are compressed, in a shard and again in the dataset.
PER_FILE, PER_FIGURE_BYTES, COMPRESSED = 25_000, 250_000, 0.65
# Bytes of memory: a process that solves, one that draws, and of the outputs at hand there are so many copies.
SOLVING, DRAWING, COPIES = 220_000_000, 320_000_000, 3.0
# Of Snakemake for each job.
GRAPH_PER_JOB = 40_000
# Of what is free, as much may be asked for.
SHARE = 0.95


@dataclass(frozen=True)
class SceneEstimate:
    """What a scene costs: scenarios are counted once for each method, `new` are those that are still to be solved."""

    scene: Scene
    plan: ScenePlan
    new: int
    jobs: int
    shards: int
    solving: float
    longest: float
    rest: float
    memory: int
    disk: int


@dataclass(frozen=True)
class Estimate:
    """What a study costs on some cores: seconds on the clock and of processors, bytes of memory and disk."""

    scenes: tuple[SceneEstimate, ...]
    cores: int
    scenarios: int = field(init=False)
    jobs: int = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "scenarios", sum(scene.plan.scenarios for scene in self.scenes))
        object.__setattr__(self, "jobs", sum(scene.jobs for scene in self.scenes) + JOBS_OF_STUDY)

    @property
    def processor_seconds(self) -> float:
        work = sum(scene.solving + scene.rest for scene in self.scenes)
        return START + PER_SCENE * len(self.scenes) + PER_JOB * JOBS_OF_STUDY + work

    @property
    def seconds(self) -> float:
        """The cores share the work, but no scene is sooner done than its steps are, one after the other."""
        start = START + PER_SCENE * len(self.scenes)
        shared = start + (self.processor_seconds - start) / self.cores
        return max([shared, *(start + scene.longest for scene in self.scenes)])

    @property
    def memory(self) -> int:
        """Of the largest process."""
        return max([SOLVING + GRAPH_PER_JOB * self.jobs, *(scene.memory for scene in self.scenes)])

    @property
    def disk(self) -> int:
        return sum(scene.disk for scene in self.scenes)


def estimate_study(scenes: Iterable[Scene], layout: Layout, cores: int | None = None) -> Estimate:
    """What the scenes of a study cost in a folder of results; nothing is written."""
    workers = cores or os.cpu_count() or 1
    return Estimate(tuple(_estimate(scene, layout, workers) for scene in scenes), workers)


def refuse_what_does_not_fit(estimate: Estimate, layout: Layout, hours: float = math.inf) -> None:
    """Raises EnvironmentFault, with what would fit, where disk, memory or the hours do not suffice."""
    import psutil

    room = SHARE * free_bytes(layout.root)
    memory = SHARE * psutil.virtual_memory().available
    asked = (
        (estimate.disk, room, "on disk", "are free", lambda scene: scene.disk),
        (estimate.memory, memory, "of memory", "are free", lambda scene: scene.memory),
    )
    for needed, there, where, free, of in asked:
        if needed > there:
            largest = max(estimate.scenes, key=of)
            told = f"{size(needed)} {where} are needed, {size(there)} {free}"
            raise EnvironmentFault(f"{largest.scene.path}: {told}; {what_fits(largest.scene, there / needed)}")
    if estimate.seconds > 3600.0 * hours:
        slowest = max(estimate.scenes, key=lambda scene: scene.solving + scene.rest)
        told = f"{duration(estimate.seconds)} are needed, {hours:g} h are given"
        share = 3600.0 * hours / estimate.seconds
        raise EnvironmentFault(f"{slowest.scene.path}: {told}; {what_fits(slowest.scene, share)}")


def what_fits(scene: Scene, share: float) -> str:
    """A design that costs a part of this one: fewer points on its longest axis."""
    axis = max(scene.design.axes, key=lambda axis: axis.size)
    fitting = int(share * axis.size)
    if fitting < 1:
        return f"not even one point of {axis.name} would fit: split the scene"
    return f"with {fitting} instead of {axis.size} points of {axis.name} it would fit"


def _estimate(scene: Scene, layout: Layout, cores: int) -> SceneEstimate:
    plan = make_plan(scene, layout.plans)
    folder = layout.shards(scene.name)
    new = {digest: recipe for digest, recipe in plan.recipes.items() if not ledger(folder / f"{digest}.nc").exists()}
    done = not new and check(layout.dataset(scene.name)).whole
    rates = _measured(plan, layout)
    outputs = {digest: _bytes(scene, recipe) for digest, recipe in plan.recipes.items()}
    everything, written = sum(outputs.values()), sum(outputs[digest] for digest in new)
    solving = {digest: _seconds(recipe, rates) + WRITE * outputs[digest] for digest, recipe in new.items()}
    bundles = [sum(solving.get(shard, 0.0) for shard in shards) for shards in plan.bundles.values()]
    starts = PER_JOB * sum(seconds > 0.0 for seconds in bundles)
    timed = len(scene.methods) * scene.work_precision.seconds if scene.work_precision else 0.0
    figures = len(scene.figures)
    after = 0.0 if done else timed + PER_JOB * JOBS_OF_SCENE + COLLECT * everything
    drawn = 0.0 if done else PER_FIGURE * figures + (SUMMARISE + DRAW * figures) * everything
    shared = (sum(bundles) + starts) / cores
    first = max([shared, *(PER_JOB + seconds for seconds in bundles if seconds)]) if new else 0.0
    at_once = max([outputs[digest] for digest in new], default=0)
    return SceneEstimate(
        scene,
        plan,
        sum(math.prod(recipe.shape) for recipe in new.values()),
        sum(seconds > 0.0 for seconds in bundles) + (0 if done else JOBS_OF_SCENE),
        len(plan.recipes),
        sum(bundles) + starts,
        first + after + drawn,
        after + drawn,
        int(max(SOLVING + COPIES * at_once, DRAWING + COPIES * min(everything, MOST_BYTES))),
        0 if done else int(COMPRESSED * (written + everything) + PER_FILE * (len(new) + 2) + PER_FIGURE_BYTES * figures),
    )


def _bytes(scene: Scene, recipe: Recipe) -> int:
    """The outputs of a shard, with the status."""
    sizes = next(m.sizes for m in scene.methods if m.solver.name == recipe.solver)
    return math.prod(recipe.shape) * (1 + bytes_per_scenario(recipe.outputs, {**sizes, "section": scene.sections}))


def _key(recipe: Recipe) -> str:
    """The same solver with the same options."""
    return f"{recipe.solver} {json.dumps(recipe.options, sort_keys=True)}"


def _seconds(recipe: Recipe, rates: dict[str, float]) -> float:
    """What a shard will take to solve."""
    rate = rates.get(_key(recipe))
    return recipe.seconds if rate is None else rate * math.prod(recipe.shape)


def _measured(plan: ScenePlan, layout: Layout) -> dict[str, float]:
    """Seconds for a scenario, by what shards of the same method took in this folder."""
    seconds, scenarios = defaultdict(float), defaultdict(int)
    for digest, recipe in plan.recipes.items():
        taken = _taken(layout.shards(plan.scene) / f"{digest}.nc")
        if taken > 0.0:
            seconds[_key(recipe)] += taken
            scenarios[_key(recipe)] += math.prod(recipe.shape)
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
