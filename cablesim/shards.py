"""Which shards make up a scene: blocks of the design, named by what they contain.

A shard is one method's answer on a block, the product of some points of each axis. Its name is a digest of the solver's
sources, its options, the outputs and every parameter value, so a shard that exists is the right one, whatever scene
file, axis order or clock led to it. A new plan first takes what earlier plans have already named and covers only the
rest with new blocks: adding a value anywhere on an axis computes that value alone.
"""

import hashlib
import json
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from cablesim.config.method import Method
from cablesim.config.scene import Scene
from cablesim.design import Axis
from cablesim.quantities import bytes_per_scenario, section_number
from cablesim.solver import installed, load_solver
from cablesim.sources import source_digest

# A job pays about a second for its start; ten seconds of work keep that below a tenth.
SECONDS_PER_SHARD = 10.0
MOST_SCENARIOS = 500_000
MOST_BYTES = 256_000_000
# Scenarios of a shard that are looked at, if the solver tells them apart.
LOOKED_AT = 256
# The golden section: steps of this part of the design meet the values of every axis evenly.
STEP = 0.6180339887498949


@dataclass(frozen=True)
class Recipe:
    """All that decides the numbers of a shard."""

    solver: str
    sources: str
    options: dict[str, Any]
    outputs: tuple[str, ...]
    fixed: dict[str, float]
    axes: tuple[Axis, ...]

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(axis.size for axis in self.axes)

    @property
    def scenarios(self) -> int:
        return math.prod(self.shape)

    @cached_property
    def seconds(self) -> float:
        """What it will take, by the solver's measured cost."""
        solver = load_solver(self.solver)
        return self.scenarios * solver.seconds_per_scenario(solver.make_options(self.options))

    @cached_property
    def expected_seconds(self) -> float:
        """The same, told by its parameters where the solver tells scenarios apart; 0 where its program is missing."""
        solver = load_solver(self.solver)
        if solver.requires and not installed(solver.requires):
            return 0.0
        if not solver.tells_scenarios_apart:
            return self.seconds
        some = solver.from_columns({**self.fixed, **self._some_points})
        return self.scenarios * float(np.mean(solver.seconds_of(some, solver.make_options(self.options))))

    @property
    def _some_points(self) -> dict[str, np.ndarray]:
        """Parameters of some scenarios, spread over the shard."""
        chosen = np.arange(self.scenarios)
        if self.scenarios > LOOKED_AT:
            chosen = ((np.arange(LOOKED_AT) + 0.5) * STEP % 1.0 * self.scenarios).astype(int)
        places = np.unravel_index(chosen, self.shape) if self.shape else ()
        return {
            name: values[place]
            for axis, place in zip(self.axes, places, strict=True)
            for name, values in axis.columns.items()
        }

    @cached_property
    def digest(self) -> str:
        head = [
            self.solver,
            self.sources,
            self.options,
            sorted(self.outputs),
            {k: v.hex() for k, v in self.fixed.items()},
        ]
        digest = hashlib.sha256(json.dumps(head, sort_keys=True).encode())
        for axis in self.axes:
            for name in sorted(axis.columns):
                digest.update(f"|{axis.name}.{name}.{axis.size}|".encode() + axis.columns[name].tobytes())
        return digest.hexdigest()[:24]


@dataclass(frozen=True)
class Placement:
    """Where a shard goes, for each axis of the method's design.

    `axis` is the position of that axis in the shard (-1 where the shard holds it as a fixed value), `source` the points
    to take there and `target` the points of the design that they answer.
    """

    recipe: Recipe
    axis: tuple[int, ...]
    source: tuple[np.ndarray, ...]
    target: tuple[np.ndarray, ...]


@dataclass(frozen=True)
class MethodPlan:
    """The shards of one method, and the axes of the design that matter to it, by position."""

    method: str
    positions: tuple[int, ...]
    placements: tuple[Placement, ...]


def plan_methods(scene: Scene, known: Iterable[Recipe]) -> tuple[MethodPlan, ...]:
    """Cover the design of a scene, method by method, with known recipes first and new blocks for what is left."""
    known = tuple({recipe.digest: recipe for recipe in known}.values())
    return tuple(_plan_method(scene, method, known) for method in scene.methods)


def _plan_method(scene: Scene, method: Method, known: tuple[Recipe, ...]) -> MethodPlan:
    own = [(i, own) for i, axis in enumerate(scene.design.axes) if (own := axis.only(method.columns)) is not None]
    axes = tuple(axis for _, axis in own)
    blank = Recipe(
        method.solver.name,
        source_digest(method.solver.name),
        method.options,
        tuple(sorted(scene.outputs)),
        _fixed(method, scene.fixed, axes),
        (),
    )
    open_points = np.ones(tuple(axis.size for axis in axes), dtype=bool)
    placements = []
    for recipe in sorted((r for r in known if _answers(r, blank)), key=lambda r: (-r.scenarios, r.digest)):
        placement = _place(recipe, blank.fixed, axes)
        if placement is not None and open_points[np.ix_(*placement.target)].any():
            open_points[np.ix_(*placement.target)] = False
            placements.append(placement)
    limit = scenarios_per_shard(method, scene.outputs, scene.sections)
    for block in _blocks(open_points, limit):
        taken = tuple(axis.take(points) for axis, points in zip(axes, block, strict=True))
        recipe = Recipe(blank.solver, blank.sources, blank.options, blank.outputs, blank.fixed, taken)
        everything = tuple(np.arange(points.size) for points in block)
        placements.append(Placement(recipe, tuple(range(len(axes))), everything, block))
    return MethodPlan(method.name, tuple(i for i, _ in own), tuple(placements))


def scenarios_per_shard(method: Method, outputs: tuple[str, ...], sections: int) -> int:
    """How many scenarios are worth a job: by the solver's measured cost, and by the memory its outputs take."""
    size = bytes_per_scenario(outputs, {**method.sizes, "section": sections})
    by_time = SECONDS_PER_SHARD / method.seconds_per_scenario
    return max(1, int(min(by_time, MOST_SCENARIOS, MOST_BYTES / max(size, 1))))


def _fixed(method: Method, fixed: dict[str, float], axes: tuple[Axis, ...]) -> dict[str, float]:
    """Every parameter that does not vary, defaults included, so that a default spelled out is no other scenario."""
    varying = {name for axis in axes for name in axis.columns}
    defaults = {
        name: spec.stored(spec.default)
        for name, spec in method.solver.columns.items()
        if spec.default is not None and name not in varying
    }
    return {**defaults, **{name: value + 0.0 for name, value in fixed.items() if name in method.columns}}


def _answers(recipe: Recipe, blank: Recipe) -> bool:
    """Whether a recipe is for the same solver, sources and options, and has the outputs."""
    same = (recipe.solver, recipe.sources, recipe.options) == (blank.solver, blank.sources, blank.options)
    return same and set(blank.outputs) <= set(recipe.outputs)


def _place(recipe: Recipe, fixed: dict[str, float], axes: tuple[Axis, ...]) -> Placement | None:
    """Where a known shard meets the design; None where it does not."""
    by_parameters = {_parameters(axis): i for i, axis in enumerate(recipe.axes)}
    left = dict(recipe.fixed)
    position, source, target = [], [], []
    for axis in axes:
        theirs = by_parameters.pop(_parameters(axis), -1)
        if theirs >= 0:
            shard_axis = recipe.axes[theirs]
        elif set(axis.columns) <= set(left):
            shard_axis = Axis(axis.name, {name: np.array([left.pop(name)]) for name in axis.columns})
        else:
            return None
        in_theirs, in_ours = _meet(shard_axis, axis)
        if not in_ours.size:
            return None
        position.append(theirs)
        source.append(in_theirs)
        target.append(in_ours)
    if by_parameters or left != fixed:
        return None
    return Placement(recipe, tuple(position), tuple(source), tuple(target))


def _parameters(axis: Axis) -> frozenset[str]:
    """What tells an axis from others; lists by their first section, whatever the longest list there has."""
    return frozenset(name for name in axis.columns if section_number(name) < 2) or frozenset(axis.columns)


def _meet(theirs: Axis, ours: Axis) -> tuple[np.ndarray, np.ndarray]:
    """Positions of the points that two axes share: in theirs, and in ours."""
    theirs, ours = theirs.padded(ours.columns), ours.padded(theirs.columns)
    pairs = ((theirs.columns[name], values) for name, values in ours.columns.items())
    if theirs.size == ours.size and all(np.array_equal(one, other, equal_nan=True) for one, other in pairs):
        everywhere = np.arange(ours.size)
        return everywhere, everywhere
    _, in_theirs, in_ours = np.intersect1d(theirs.key, ours.key, assume_unique=False, return_indices=True)
    return in_theirs, in_ours


def _blocks(open_points: np.ndarray, limit: int) -> Iterator[tuple[np.ndarray, ...]]:
    """The open points as products of positions, each of at most `limit` points."""
    for block in _rectangles(open_points):
        yield from _split(block, limit)


def _rectangles(mask: np.ndarray) -> Iterator[tuple[np.ndarray, ...]]:
    """An exact cover of the true points by products: slices that look alike along the first axis are taken together."""
    if mask.all():
        yield tuple(np.arange(size) for size in mask.shape)
    elif mask.ndim == 1:
        if mask.any():
            yield (np.flatnonzero(mask),)
    else:
        alike: dict[bytes, list[int]] = {}
        for i, part in enumerate(mask):
            alike.setdefault(np.packbits(part).tobytes(), []).append(i)
        for positions in alike.values():
            for rest in _rectangles(mask[positions[0]]):
                yield (np.array(positions), *rest)


def _split(block: tuple[np.ndarray, ...], limit: int, even: bool = True) -> Iterator[tuple[np.ndarray, ...]]:
    """Cut along the longest axis until all pieces are small enough; an even number first, as that of cores is."""
    size = math.prod(points.size for points in block)
    if size <= limit:
        yield block
        return
    longest = max(range(len(block)), key=lambda i: block[i].size)
    points = block[longest].size
    pieces = math.ceil(points / max(1, limit * points // size))
    pieces = min(points, pieces + pieces % 2 * even)
    for piece in np.array_split(block[longest], pieces):
        yield from _split((*block[:longest], piece, *block[longest + 1 :]), limit, even=False)
