"""Read a part of a scene's answers from its shards: by integer place, never by comparing floats.

A part is one method on a range of points of the first axis; only as much is in memory as `parts` allows.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from cablesim.config.method import Method
from cablesim.config.scene import Scene
from cablesim.database.cluster import map_in_order
from cablesim.database.shard_file import CHUNK, read_shard
from cablesim.files import Checked
from cablesim.plan import ScenePlan
from cablesim.quantities import COMPONENTS, LIST, PLACES, QUANTITIES, RUN_TIME
from cablesim.shards import Placement
from cablesim.status import Status

NOT_COUNTED = -1
# What a variable is where nothing was computed, if that is not NaN; and how it is stored, if not as its quantity is.
BLANK = {"status": int(Status.not_run), "iterations": NOT_COUNTED}
STORED: dict[str, np.dtype] = {
    "status": np.dtype(np.int8),
    "iterations": np.dtype(np.int32),
    RUN_TIME: np.dtype(np.float32),
}
# Of a part; and of the shards that are read together, which are one piece of work, and how many these are at most.
MOST_BYTES, MOST_BYTES_TOGETHER, MOST_TOGETHER = 2**27, 2**25, 32

Arrays = dict[str, np.ndarray]


@dataclass(frozen=True)
class Part:
    """Variables of one method, by its number, on some points of the first axis."""

    method: int
    rows: slice
    names: tuple[str, ...]


@dataclass(frozen=True)
class Shards:
    """The files of a plan and their condition."""

    folder: Path
    checked: dict[str, Checked]

    def path(self, digest: str) -> Path:
        return self.folder / f"{digest}.nc"


def stored_type(name: str) -> np.dtype:
    """How a variable is stored."""
    return STORED[name] if name in STORED else np.dtype(QUANTITIES[name].dtype)


def own_dims(name: str) -> tuple[str, ...]:
    """The dimensions that a variable has within one scenario."""
    return QUANTITIES[name].dims if name in QUANTITIES else ()


def own_shape(scene: Scene, name: str) -> tuple[int, ...]:
    """The lengths of those."""
    known = {"component": len(COMPONENTS), "place": len(PLACES), LIST[0]: scene.sections, **scene.methods[0].sizes}
    return tuple(known[dim] for dim in own_dims(name))


def parts(scene: Scene, names: tuple[str, ...]) -> Iterator[Part]:
    """The dataset in parts of bounded size: all variables of a method if they fit, one on some of its points if not."""
    for number in range(len(scene.methods)):
        together: list[str] = []
        room = MOST_BYTES
        for name in names:
            size = scene.size * _bytes(scene, name)
            if together and size > room:
                yield from _slabs(scene, number, tuple(together))
                together, room = [], MOST_BYTES
            together.append(name)
            room -= size
        yield from _slabs(scene, number, tuple(together))


def gather(scene: Scene, plan: ScenePlan, part: Part, shards: Shards) -> Arrays:
    """The variables of a part, each of shape (points of the part, other axes..., its own dimensions)."""
    method = scene.methods[part.method]
    shape = (part.rows.stop - part.rows.start, *scene.design.shape[1:])
    arrays = {
        name: np.full((*shape, *own_shape(scene, name)), BLANK.get(name, np.nan), dtype=stored_type(name))
        for name in part.names
    }
    placements = plan.methods[part.method].placements
    positions = plan.methods[part.method].positions
    found = [within for placement in placements if (within := _within(placement, positions, part.rows)) is not None]
    for placement, values in _read(found, _asked(part.names, method), shards):
        own = {name: as_wide(name, own, scene.sections) for name, own in values.items()}
        seconds = shards.checked[placement.recipe.digest].seconds / max(1, math.prod(placement.recipe.shape))
        _place(arrays, positions, placement, own, np.float32(seconds))
    return arrays


def _bytes(scene: Scene, name: str) -> int:
    """Of one scenario."""
    return stored_type(name).itemsize * math.prod(own_shape(scene, name))


def _slabs(scene: Scene, number: int, names: tuple[str, ...]) -> Iterator[Part]:
    """The points of the first axis in ranges that fit into memory, whole chunks where it is the only axis."""
    size, others = scene.design.shape[0], math.prod(scene.design.shape[1:])
    fitting = max(1, MOST_BYTES // max(1, others * sum(_bytes(scene, name) for name in names)))
    if others == 1 and fitting > CHUNK:
        fitting -= fitting % CHUNK
    for first in range(0, size, fitting):
        yield Part(number, slice(first, min(first + fitting, size)), names)


def _asked(names: tuple[str, ...], method: Method) -> tuple[str, ...]:
    """What is to be read from a shard: not its time, and no count of a method that does not count."""
    left_out = {RUN_TIME} if method.solver.iterates else {RUN_TIME, "iterations"}
    return tuple(name for name in names if name not in left_out)


def _read(placements: list[Placement], names: tuple[str, ...], shards: Shards) -> Iterator[tuple[Placement, Arrays]]:
    """The variables of every whole shard, some shards at a time."""
    whole = [placement for placement in placements if shards.checked[placement.recipe.digest].whole]
    groups = list(_groups(whole, names))
    paths = [[shards.path(placement.recipe.digest).absolute() for placement in group] for group in groups]
    for group, read in zip(groups, map_in_order(partial(_read_shards, names), paths), strict=True):
        yield from zip(group, read, strict=True)


def _read_shards(names: tuple[str, ...], paths: list[Path]) -> list[Arrays]:
    return [read_shard(path, names) for path in paths]


def _groups(placements: list[Placement], names: tuple[str, ...]) -> Iterator[list[Placement]]:
    """The placements in their order, as many together as fit into memory, and at least one."""
    together: list[Placement] = []
    room = 0
    for placement in placements:
        size = math.prod(placement.recipe.shape) * sum(stored_type(name).itemsize for name in names)
        if together and (size > room or len(together) == MOST_TOGETHER):
            yield together
            together = []
        room = (room if together else MOST_BYTES_TOGETHER) - size
        together.append(placement)
    if together:
        yield together


def _within(placement: Placement, positions: tuple[int, ...], rows: slice) -> Placement | None:
    """The placement on some points of the first axis, counted from the first; None where it has none of them."""
    if 0 not in positions:
        return placement
    first = positions.index(0)
    target = placement.target[first]
    inside = (target >= rows.start) & (target < rows.stop)
    if not inside.any():
        return None
    targets, sources = list(placement.target), list(placement.source)
    targets[first], sources[first] = target[inside] - rows.start, placement.source[first][inside]
    return replace(placement, source=tuple(sources), target=tuple(targets))


def as_wide(name: str, values: np.ndarray, sections: int) -> np.ndarray:
    """An output over sections with as many as the scene has: a shard has those of its own lines."""
    dims = own_dims(name)
    if dims[:1] != LIST:
        return values
    axis = values.ndim - len(dims)
    own = values[(slice(None),) * axis + (slice(sections),)]
    missing = [(0, sections - own.shape[axis] if i == axis else 0) for i in range(own.ndim)]
    return np.pad(own, missing, constant_values=np.nan)


def _place(
    arrays: Arrays, positions: tuple[int, ...], placement: Placement, values: Arrays, seconds: np.floating
) -> None:
    """Put a shard where it belongs; a method that ignores an axis has the same answer all along it."""
    dimensions = max(array.ndim - len(own_dims(name)) for name, array in arrays.items())
    axes: list[Any] = [slice(None)] * dimensions
    for position, target in zip(positions, placement.target, strict=True):
        axes[position] = _as_slice(target)
    for name, own in values.items():
        _assign(arrays[name], axes, _in_design_order(own, placement, positions, dimensions))
    if RUN_TIME in arrays:
        _assign(arrays[RUN_TIME], axes, np.full((1,) * dimensions, seconds))


def _in_design_order(values: np.ndarray, placement: Placement, positions: tuple[int, ...], axes: int) -> np.ndarray:
    """A shard's array with the axes of the design, of length one where it has none."""
    own = len(placement.recipe.axes)
    kept = [axis for axis in placement.axis if axis >= 0]
    values = values.transpose(*kept, *range(own, values.ndim))
    dimension = 0
    for axis, source in zip(placement.axis, placement.source, strict=True):
        if axis >= 0:
            if source.size != values.shape[dimension] or not np.array_equal(source, np.arange(source.size)):
                values = np.take(values, source, axis=dimension)
            dimension += 1
    shape = [1] * axes
    for axis, source, position in zip(placement.axis, placement.source, positions, strict=True):
        shape[position] = source.size if axis >= 0 else 1
    return values.reshape((*shape, *values.shape[len(kept) :]))


def _assign(array: np.ndarray, axes: list[Any], block: np.ndarray) -> None:
    """array[axes] = block, also where several axes are index arrays (which must then be taken one by one)."""
    if all(isinstance(axis, slice) for axis in axes):
        array[tuple(axes)] = block
        return
    whole = [np.arange(array.shape[i])[axis] for i, axis in enumerate(axes)]
    array[np.ix_(*whole)] = block


def _as_slice(target: np.ndarray) -> Any:
    """A run of positions as a slice, which is copied much faster than an index array."""
    if target[-1] - target[0] == target.size - 1 and np.array_equal(
        target, np.arange(target[0], target[0] + target.size)
    ):
        return slice(int(target[0]), int(target[-1]) + 1)
    return target
