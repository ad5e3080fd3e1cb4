"""The plan of a scene: which shards to compute and where each goes.

Written once for each content of the scene and read by every later step, so that all of them speak of the same shards.

A plan is an .npz file: a JSON head, and the points of every axis and placement as arrays.
"""

import hashlib
import json
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from cablesim.config.scene import Scene
from cablesim.design import Axis
from cablesim.errors import CablesimError, EnvironmentFault, InputError
from cablesim.files import written_whole
from cablesim.shards import SECONDS_PER_SHARD, MethodPlan, Placement, Recipe, plan_methods
from cablesim.sources import source_digest

FORMAT = 1


@dataclass(frozen=True)
class ScenePlan:
    """The shards of every method of a scene; `digest` names the content it was made from."""

    scene: str
    digest: str
    methods: tuple[MethodPlan, ...]

    @cached_property
    def recipes(self) -> dict[str, Recipe]:
        """Every shard by its digest."""
        return {p.recipe.digest: p.recipe for method in self.methods for p in method.placements}

    @property
    def bundles(self) -> dict[str, tuple[str, ...]]:
        """Shards that are worth a job together, in their order, by a digest of their names."""
        bundles: list[list[str]] = []
        room = 0.0
        for digest, recipe in self.recipes.items():
            if not bundles or recipe.seconds > room:
                bundles.append([])
                room = SECONDS_PER_SHARD
            bundles[-1].append(digest)
            room -= recipe.seconds
        return {hashlib.sha256(" ".join(shards).encode()).hexdigest()[:24]: tuple(shards) for shards in bundles}

    @property
    def scenarios(self) -> int:
        """Scenarios in all shards, each counted once for each method that solves it."""
        return sum(recipe.scenarios for recipe in self.recipes.values())


def plan_digest(scene: Scene) -> str:
    """Digest of what a plan depends on: the scene, its tables, and the sources of its solvers."""
    digest = hashlib.sha256(f"{FORMAT} {scene.digest}".encode())
    for method in scene.methods:
        digest.update(source_digest(method.solver.name).encode())
    return digest.hexdigest()[:16]


def plan_scene(scene: Scene, folder: Path) -> ScenePlan:
    """The plan of a scene, from `folder` if it is there already, made and written there if not."""
    path = plan_path(folder, scene.name, plan_digest(scene))
    plan = _kept(path)
    if plan is None:
        plan = make_plan(scene, folder)
        _write(path, plan)
    return plan


def make_plan(scene: Scene, folder: Path) -> ScenePlan:
    """The same, but nothing is written."""
    digest = plan_digest(scene)
    kept = _kept(plan_path(folder, scene.name, digest))
    if kept is not None:
        return kept
    others = (_kept(other) for other in sorted(folder.glob(f"{scene.name}.*.npz")))
    known = (recipe for other in others if other is not None for recipe in other.recipes.values())
    return ScenePlan(scene.name, digest, plan_methods(scene, known))


def _kept(path: Path) -> ScenePlan | None:
    """The plan in a file; None where there is none, or a damaged one, which can be made again."""
    try:
        return read_plan(path)
    except CablesimError:
        return None


def plan_path(folder: Path, scene: str, digest: str) -> Path:
    """Where the plan of a scene's content is kept."""
    return folder / f"{scene}.{digest}.npz"


def read_plan(path: Path) -> ScenePlan:
    """Read a plan. Raises EnvironmentFault where the file is damaged or another's, InputError where it is missing."""
    if not path.is_file():
        raise InputError(f"{path}: no such plan")
    try:
        plan = _read(path)
    # A damaged archive makes its readers raise almost anything.
    except Exception as problem:
        reason = str(problem) or type(problem).__name__
        raise EnvironmentFault(f"{path}: damaged ({reason}); delete it and run the study again") from None
    if path.name != plan_path(path.parent, plan.scene, plan.digest).name:
        raise EnvironmentFault(f"{path}: foreign (it is the plan of {plan.scene}, {plan.digest}); delete it")
    return plan


def _read(path: Path) -> ScenePlan:
    with zipfile.ZipFile(path) as archive:
        if any(member.compress_type != zipfile.ZIP_STORED for member in archive.infolist()):
            raise ValueError("it is compressed, as no plan is")
    with np.load(path, allow_pickle=False) as stored:
        arrays = {name: stored[name] for name in stored.files}
    head = json.loads(arrays.pop("head").tobytes())
    recipes = {digest: _recipe(digest, entry, arrays) for digest, entry in head["recipes"].items()}
    for digest, recipe in recipes.items():
        if recipe.digest != digest:
            raise ValueError(f"the shard {digest} is another's")
    methods = tuple(_method(i, entry, recipes, arrays) for i, entry in enumerate(head["methods"]))
    return ScenePlan(head["scene"], head["digest"], methods)


def _write(path: Path, plan: ScenePlan) -> None:
    recipes = {digest: _recipe_head(recipe) for digest, recipe in plan.recipes.items()}
    methods = [
        {
            "method": m.method,
            "positions": m.positions,
            "placements": [{"recipe": p.recipe.digest, "axis": p.axis} for p in m.placements],
        }
        for m in plan.methods
    ]
    head = json.dumps({"scene": plan.scene, "digest": plan.digest, "recipes": recipes, "methods": methods}).encode()
    arrays = dict(_arrays(plan))
    with written_whole(path) as temporary, temporary.open("wb") as file:
        np.savez(file, allow_pickle=False, head=np.frombuffer(head, dtype=np.uint8), **arrays)


def _arrays(plan: ScenePlan) -> Iterator[tuple[str, np.ndarray]]:
    for digest, recipe in plan.recipes.items():
        for i, axis in enumerate(recipe.axes):
            for name, values in axis.columns.items():
                yield f"{digest}/{i}/{name}", values
    for i, method in enumerate(plan.methods):
        for j, placement in enumerate(method.placements):
            for k, (source, target) in enumerate(zip(placement.source, placement.target, strict=True)):
                yield f"source/{i}/{j}/{k}", source
                yield f"target/{i}/{j}/{k}", target


def _recipe_head(recipe: Recipe) -> dict[str, Any]:
    return {
        "solver": recipe.solver,
        "sources": recipe.sources,
        "options": recipe.options,
        "outputs": recipe.outputs,
        "fixed": {name: value.hex() for name, value in recipe.fixed.items()},
        "axes": [[axis.name, list(axis.columns)] for axis in recipe.axes],
    }


def _recipe(digest: str, head: dict[str, Any], arrays: dict[str, np.ndarray]) -> Recipe:
    axes = tuple(
        Axis(axis, {name: arrays[f"{digest}/{i}/{name}"] for name in names})
        for i, (axis, names) in enumerate(head["axes"])
    )
    fixed = {name: float.fromhex(value) for name, value in head["fixed"].items()}
    return Recipe(head["solver"], head["sources"], head["options"], tuple(head["outputs"]), fixed, axes)


def _method(i: int, head: dict[str, Any], recipes: dict[str, Recipe], arrays: dict[str, np.ndarray]) -> MethodPlan:
    placements = []
    for j, entry in enumerate(head["placements"]):
        dims = range(len(entry["axis"]))
        source = tuple(arrays[f"source/{i}/{j}/{k}"] for k in dims)
        target = tuple(arrays[f"target/{i}/{j}/{k}"] for k in dims)
        placements.append(Placement(recipes[entry["recipe"]], tuple(entry["axis"]), source, target))
    return MethodPlan(head["method"], tuple(head["positions"]), tuple(placements))
