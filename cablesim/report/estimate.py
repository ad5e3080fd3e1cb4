"""What `cablesim check` says: what was understood of a scene or a study, and what it takes."""

from cablesim.config.scene import Scene
from cablesim.estimate import Estimate, SceneEstimate, StudyEstimate
from cablesim.fitting import duration_words, size_words


def study_lines(name: str, found: StudyEstimate) -> str:
    """A line for each scene, and their sum; of a single scene each method and the sum."""
    if len(found.scenes) == 1:
        return "\n".join([*_scene_lines(found.scenes[0]), _sum_line(found)])
    width = max(len(scene.scene.name) for scene in found.scenes)
    lines = [f"{scene.scene.name:<{width}}  {_short(found.of(scene))}" for scene in found.scenes]
    return "\n".join([*lines, f"{name}: {len(found.scenes)} scenes, all valid", _sum_line(found)])


def _scene_lines(found: SceneEstimate) -> list[str]:
    scene = found.scene
    lines = [
        f"{scene.path}: valid",
        f"  {scene.title}",
        f"  {scene.design.kind}: {_axes(scene)} = {scene.size} scenarios",
    ]
    for one in found.methods:
        solving = f"{one.scenarios} to solve in {one.shards} shard(s), about {duration_words(one.seconds)}"
        lines.append(f"  {one.method.name} ({one.method.solver.name}): {solving}")
    if found.timing:
        lines.append(f"  timing the methods, alone on the machine: about {duration_words(found.timing[0].seconds)}")
    return lines


def _sum_line(found: StudyEstimate) -> str:
    total = found.total
    if not total.jobs:
        return "  all is there: nothing to compute"
    time = f"{total.jobs} jobs, about {duration_words(total.seconds)} on {found.cores} cores"
    memory = f"{size_words(total.memory_bytes)} of memory for the largest, {size_words(total.together_bytes)} in all"
    processor = duration_words(total.processor_seconds)
    return f"  in all {time} ({processor} of processors), {memory}, {size_words(total.disk_bytes)} on disk"


def _short(one: Estimate) -> str:
    if not one.jobs:
        return "all is there"
    told = (duration_words(one.seconds), size_words(one.memory_bytes), size_words(one.disk_bytes))
    return f"{one.scenarios:>8} to solve, {one.jobs} jobs, {', '.join(told)}"


def _axes(scene: Scene) -> str:
    return " x ".join(f"{axis.name} {axis.size}" for axis in scene.design.axes)
