"""What a scene will cost, before it runs: scenarios, shards, time and disk, from the measured rates of its solvers."""

import math

from cablesim.config.scene import Scene
from cablesim.plan import ScenePlan
from cablesim.quantities import bytes_per_scenario
from cablesim.shards import plan_methods

# Measured: a lean job starts in about a second, collecting, tables and figures take a few more for each scene.
SECONDS_PER_JOB = 1.0
SECONDS_PER_SCENE = 5.0
SECONDS_PER_BYTE = 5e-9


def estimate(scene: Scene) -> str:
    """A few lines: what was understood, and what it takes."""
    plans = plan_methods(scene, ())
    lines = [
        f"{scene.path}: valid",
        f"  {scene.title}",
        f"  {scene.design.kind}: {_axes(scene)} = {scene.size} scenarios",
    ]
    jobs = len(ScenePlan(scene.name, "", plans).bundles)
    seconds = SECONDS_PER_SCENE + SECONDS_PER_JOB * jobs
    for method, plan in zip(scene.methods, plans, strict=True):
        solved = sum(math.prod(p.recipe.shape) for p in plan.placements)
        work = solved * method.seconds_per_scenario
        seconds += work
        shards = f"{len(plan.placements)} shard(s), about {_duration(work)}"
        lines.append(f"  {method.name} ({method.solver.name}): {solved} to solve in {shards}")
    sizes = [{**method.sizes, "section": scene.sections} for method in scene.methods]
    if scene.work_precision is not None:
        timed = len(scene.methods) * scene.work_precision.seconds
        seconds += timed
        lines.append(
            f"  each method timed for up to {scene.work_precision.seconds:g} s: at most about {_duration(timed)}"
        )
    stored = 2 * scene.size * sum(bytes_per_scenario(scene.outputs, own) for own in sizes)
    seconds += stored * SECONDS_PER_BYTE
    lines.append(f"  in all about {_duration(seconds)} on one core, at most {_size(stored)} on disk")
    return "\n".join(lines)


def _axes(scene: Scene) -> str:
    return " x ".join(f"{axis.name} {axis.size}" for axis in scene.design.axes)


def _duration(seconds: float) -> str:
    if seconds < 120.0:
        return f"{max(seconds, 1.0):.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 7200.0 else f"{seconds / 3600.0:.1f} h"


def _size(size: float) -> str:
    for unit in ("bytes", "kB", "MB", "GB"):
        if size < 1000.0:
            return f"{size:.3g} {unit}"
        size /= 1000.0
    return f"{size:.3g} TB"
