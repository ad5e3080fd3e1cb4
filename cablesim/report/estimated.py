"""What was estimated, as lines to read."""

from collections.abc import Iterator

from cablesim.config.scene import Scene
from cablesim.estimate import Estimate, SceneEstimate, duration, size


def estimate_lines(estimate: Estimate) -> Iterator[str]:
    """A scene with its methods, or the scenes of a study; and what all of it takes."""
    if len(estimate.scenes) == 1:
        yield from _scene_lines(estimate.scenes[0])
    else:
        width = max(len(one.scene.name) for one in estimate.scenes)
        yield from (_line(one, width) for one in estimate.scenes)
    new, time = sum(one.new for one in estimate.scenes), duration(estimate.seconds)
    yield (
        f"in all {new} of {estimate.scenarios} scenarios to solve in {estimate.jobs} jobs: about {time} on "
        f"{estimate.cores} cores ({duration(estimate.processor_seconds)} of one), {size(estimate.memory)} of memory "
        f"for the largest process, {size(estimate.disk)} on disk"
    )


def _scene_lines(one: SceneEstimate) -> Iterator[str]:
    scene = one.scene
    yield f"{scene.path}: valid"
    yield f"  {scene.title}"
    yield f"  {scene.design.kind}: {_axes(scene)} = {scene.size} scenarios"
    for method, plan in zip(scene.methods, one.plan.methods, strict=True):
        recipes = {placement.recipe.digest: placement.recipe for placement in plan.placements}
        solved = sum(placement.recipe.scenarios for placement in plan.placements)
        work = sum(recipe.seconds for recipe in recipes.values())
        yield (
            f"  {method.name} ({method.solver.name}): {solved} to solve in {len(recipes)} shard(s), "
            f"about {duration(work)}"
        )
    if scene.work_precision is not None:
        timed = len(scene.methods) * scene.work_precision.seconds
        yield f"  each method timed for up to {scene.work_precision.seconds:g} s: at most about {duration(timed)}"


def _line(one: SceneEstimate, width: int) -> str:
    told = (
        f"{one.new} to solve in {len(one.seconds)} shard(s), about {duration(one.processor_seconds)}, {size(one.disk)}"
    )
    return f"{one.scene.name:<{width}}  {one.plan.scenarios} scenarios, {told if one.new else 'all there'}"


def _axes(scene: Scene) -> str:
    return " x ".join(f"{axis.name} {axis.size}" for axis in scene.design.axes)
