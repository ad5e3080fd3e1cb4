"""Whether a study fits on the machine, and what of it would: told in one line before anything is computed."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from cablesim.config.document import read_document
from cablesim.config.scene import Scene
from cablesim.costs import Sizes, dataset_bytes
from cablesim.design import Axis
from cablesim.errors import EnvironmentFault
from cablesim.estimate import Estimate, SceneEstimate, StudyEstimate, estimate_scene
from cablesim.files import free_bytes
from cablesim.machine import available_memory
from cablesim.plan import ScenePlan
from cablesim.quantities import LONG, quantity
from cablesim.shards import plan_methods

SECONDS_PER_HOUR = 3600.0
# Attempts to find a number of points that fits; digits that it is told with; and the fewest points of an axis.
ATTEMPTS, DIGITS, FEWEST = 60, 2, 2
# A number of points is tried that would take this part of the room; the next one is at most this part of the last.
CLOSE, LESS = 0.98, 0.95
# A scene whose answers take so many times the disk is refused unseen: its plan alone would take long.
VAST = 4.0


@dataclass(frozen=True)
class Room:
    """What there is: bytes on the disk, of memory, and seconds; None where that does not matter."""

    disk: int
    memory: int | None = None
    seconds: float | None = None


@dataclass(frozen=True)
class _Lack:
    """Something that does not suffice: in words, what of an estimate it is, and how much there is."""

    needs: str
    has: str
    of: Callable[[Estimate], float]
    limit: float


def room_at(folder: Path, hours: float | None = None) -> Room:
    """The room of this machine, for results in a folder that need not be there yet."""
    return Room(free_bytes(folder), available_memory(), None if hours is None else hours * SECONDS_PER_HOUR)


def refuse_what_does_not_fit(found: StudyEstimate, room: Room, folder: Path) -> None:
    """Raises EnvironmentFault, with what is needed, what there is, and what would fit, where a study does not fit."""
    for lack in _lacks(found, room, folder):
        scene = max(found.scenes, key=lambda scene: lack.of(found.of(scene)))
        offers = list(_offers(found, scene, room, folder))
        fitting = f"; it fits with {' or '.join(offers)}" if offers else "; no smaller number of scenarios fits"
        all_of = f"{len(found.scenes)} scenes, most of all " if len(found.scenes) > 1 else ""
        raise EnvironmentFault(f"{all_of}{scene.scene.path}: {lack.needs}, {lack.has}{fitting}")


def refuse_vast(scene: Scene, folder: Path) -> None:
    """Raises EnvironmentFault, with what would fit, where shards and dataset of a scene are far beyond the disk."""
    free, needed = free_bytes(folder), 2.0 * dataset_bytes(Sizes(scene, 0.0))
    if needed > VAST * free:
        axis = max(scene.design.axes, key=lambda axis: axis.size)
        points = _rounded(LESS * free / needed * axis.size)
        fitting = f"it fits with {_axis_words(scene, axis, points)}" if points >= FEWEST else "no part of it fits"
        lack = f"needs {size_words(needed)} on the disk, {size_words(free)} are free at {folder}"
        raise EnvironmentFault(f"{scene.path}: {lack}; {fitting}")


def _lacks(found: StudyEstimate, room: Room, folder: Path) -> Iterator[_Lack]:
    total = found.total
    if total.disk_bytes > room.disk:
        has = f"{size_words(room.disk)} are free at {folder}"
        yield _Lack(f"needs {size_words(total.disk_bytes)} on the disk", has, lambda e: e.disk_bytes, room.disk)
    if room.memory is not None and total.together_bytes > room.memory:
        needs = f"needs {size_words(total.together_bytes)} of memory on {found.cores} cores"
        yield _Lack(needs, f"{size_words(room.memory)} are free", lambda e: e.together_bytes, room.memory)
    if room.seconds is not None and total.seconds > room.seconds:
        needs = f"needs {duration_words(total.seconds)} on {found.cores} cores"
        yield _Lack(needs, f"{duration_words(room.seconds)} are given", lambda e: e.seconds, room.seconds)


def _fits(found: StudyEstimate, room: Room, folder: Path) -> bool:
    return next(_lacks(found, room, folder), None) is None


def _offers(found: StudyEstimate, large: SceneEstimate, room: Room, folder: Path) -> Iterator[str]:
    """What to change so that all fits, the least first; each by itself is enough."""
    scene = large.scene
    fewer = next((n for n in range(found.cores - 1, 0, -1) if _fits(replace(found, cores=n), room, folder)), None)
    if fewer is not None:
        yield f"--cores {fewer}"
    long = [name for name in scene.outputs if not LONG.isdisjoint(quantity(name).dims)]
    rest = tuple(name for name in scene.outputs if name not in long)
    if long and rest and _fits(_with(found, large, replace(scene, outputs=rest)), room, folder):
        yield f"outputs without {', '.join(f'`{name}`' for name in long)}"
    axis = max(scene.design.axes, key=lambda axis: axis.size)
    points = _most_points(found, large, axis, partial(_lacks, room=room, folder=folder))
    if points is not None:
        yield _axis_words(scene, axis, points)
    parts = (replace(found, scenes=found.scenes[:n]) for n in range(len(found.scenes) - 1, 0, -1))
    part = next((part for part in parts if _fits(part, room, folder)), None)
    if part is not None and points is None:
        yield f"the first {len(part.scenes)} of {len(found.scenes)} scenes"


def _most_points(
    found: StudyEstimate, large: SceneEstimate, axis: Axis, lacks: Callable[[StudyEstimate], Iterator[_Lack]]
) -> int | None:
    """How many points of an axis fit; None where not even a few do."""
    points, tried = axis.size, found
    for _ in range(ATTEMPTS):
        lack = next(lacks(tried), None)
        if lack is None:
            return points
        shares = [lack.limit / lack.of(tried.total) for lack in lacks(tried)]
        points = _rounded(points * min(LESS, max(CLOSE * min(shares), 0.01)))
        if points < FEWEST:
            return None
        tried = _with(found, large, _shortened(large.scene, axis, points))
    return None


def _with(found: StudyEstimate, large: SceneEstimate, other: Scene) -> StudyEstimate:
    """The study with another scene in the place of one, all of which is to be computed."""
    plan = ScenePlan(other.name, "", plan_methods(other, ()))
    own = estimate_scene(other, plan, None, found.rates)
    return replace(found, scenes=tuple(own if scene is large else scene for scene in found.scenes))


def _shortened(scene: Scene, axis: Axis, points: int) -> Scene:
    some = axis.take(np.linspace(0, axis.size - 1, points).astype(int))
    axes = tuple(some if other is axis else other for other in scene.design.axes)
    return replace(scene, design=replace(scene.design, axes=axes))


def _rounded(points: float) -> int:
    """A round number that is not larger."""
    whole = int(points)
    unit = 10 ** max(len(str(whole)) - DIGITS, 0)
    return whole // unit * unit


def _axis_words(scene: Scene, axis: Axis, points: int) -> str:
    """The change in the words of the scene file."""
    if scene.design.kind == "sample":
        return f"num: {points} instead of {axis.size}"
    if scene.design.kind == "cases":
        return f"{points} cases instead of {axis.size}"
    given = read_document(scene.path).value["design"]["grid"].get(axis.name)
    if isinstance(given, dict) and "num" in given:
        return f"{axis.name}: {{num: {points - (axis.size - given['num'])}}} instead of {given['num']}"
    return f"{points} values of {axis.name} instead of {axis.size}"


def duration_words(seconds: float) -> str:
    """A time as people say it."""
    if seconds < 120.0:
        return f"{max(seconds, 1.0):.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 7200.0 else f"{seconds / SECONDS_PER_HOUR:.1f} h"


def size_words(size: float) -> str:
    """Bytes as people say them."""
    for unit in ("bytes", "kB", "MB", "GB"):
        if size < 1000.0:
            return f"{size:.3g} {unit}"
        size /= 1000.0
    return f"{size:.3g} TB"
