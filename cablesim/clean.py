"""What a folder of results holds that its study no longer needs: shards and plans of earlier scenes and earlier code.

They are kept as long as nobody asks for their removal, because going back to an earlier scene then computes nothing.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from cablesim.config.scene import Scene
from cablesim.files import discard, ledger, parts
from cablesim.held import held
from cablesim.plan import make_plan
from cablesim.study import Layout

PLAN, SHARD, PART = "plan of an earlier scene or code", "superseded shard", "left by a job that was killed"


@dataclass(frozen=True)
class Leftover:
    """A file, what it is, and its size with that of its ledger."""

    path: Path
    scene: str
    what: str
    bytes: int


def leftovers(scenes: tuple[Scene, ...], layout: Layout) -> list[Leftover]:
    """The files of these scenes that nothing needs, plans first; other scenes in the folder are not looked at."""
    left = [Leftover(path, "", PART, _size(path)) for path in parts(layout.root)]
    return [*(found for scene in scenes for found in _of_scene(scene, layout)), *left]


def strangers(scenes: tuple[Scene, ...], layout: Layout) -> list[str]:
    """Scenes that have shards in the folder and are none of these."""
    known = {scene.name for scene in scenes}
    return sorted(path.name for path in layout.root.glob("shards/*") if path.is_dir() and path.name not in known)


def remove(found: list[Leftover], layout: Layout) -> None:
    """Remove files. Raises EnvironmentFault where a study is running here.

    Plans go first: an earlier plan without its shards would make a later one ask for them again.
    """
    with held(layout.root):
        for leftover in sorted(found, key=lambda one: one.what != PLAN):
            discard(leftover.path)


def _of_scene(scene: Scene, layout: Layout) -> Iterator[Leftover]:
    plan = make_plan(scene, layout.plans)
    for path in sorted(layout.plans.glob(f"{scene.name}.*.npz")):
        if path != layout.plan(plan):
            yield Leftover(path, scene.name, PLAN, _size(path))
    for path in sorted(layout.shards(scene.name).glob("*.nc")):
        if path.stem not in plan.recipes:
            yield Leftover(path, scene.name, SHARD, _size(path))


def _size(path: Path) -> int:
    return sum(one.stat().st_size for one in (path, ledger(path)) if one.exists())
