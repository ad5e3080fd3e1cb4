"""What is written beside the numbers of a dataset: coordinates, CF attributes, and where the numbers come from."""

import json
from importlib.metadata import version
from typing import Any

import numpy as np

from cablesim.config.scene import Scene
from cablesim.database.gather import NOT_COUNTED
from cablesim.parameters import ParameterSpec
from cablesim.quantities import COMPONENTS, LIST, PLACES, component_names, quantity, section_number
from cablesim.sources import source_digest
from cablesim.status import status_attributes

LABELS = {
    "row": "row of the published table",
    "key": "column of the published table that decides the scenario",
    "rounding": "whether the key is taken as printed, or moved half a unit of its last digit",
}


def coordinates(scene: Scene) -> dict[str, Any]:
    """Every coordinate as dimensions, values and attributes: what varies, what is fixed, and what numbers stand for."""
    coords: dict[str, Any] = {
        "method": ("method", _words(tuple(m.name for m in scene.methods)), {"long_name": "method"})
    }
    for axis in scene.design.axes:
        for name, values in axis.columns.items():
            if section_number(name) and name != axis.name:
                continue
            coords[name] = (axis.name, *_parameter(scene.parameters[name], values))
        if axis.name not in axis.columns:
            numbers = np.arange(axis.size, dtype=np.int32)
            coords[axis.name] = (axis.name, numbers, _named(numbers, f"number of the {axis.name}"))
        for name, values in axis.labels.items():
            shown = _words(tuple(values)) if values.dtype.kind == "U" else values.astype(np.int32)
            coords[name] = (axis.name, shown, _named(shown, LABELS[name]))
    for name, value in scene.fixed.items():
        if not section_number(name):
            coords[name] = ((), *_parameter(scene.parameters[name], np.array(value)))
    if scene.sections:
        numbers = np.arange(1, scene.sections + 1, dtype=np.int32)
        coords["section"] = ("section", numbers, _named(numbers, "number of the section, from A to B"))
        coords |= {name: _list(scene, name) for name, spec in scene.parameters.items() if spec.listed}
    return coords | _own_coordinates(scene)


def _own_coordinates(scene: Scene) -> dict[str, Any]:
    """Coordinates of the dimensions that values have within one scenario."""
    sizes = scene.methods[0].sizes
    phases = sizes.get("phase", 1)
    known = {
        "component": (_words(COMPONENTS), "component of a vector"),
        "place": (_words(PLACES), "where along the line"),
        "phase": (np.arange(phases) / phases, "part of the last period that has passed"),
    }
    used = {dim for name in scene.outputs for dim in quantity(name).dims}
    return {dim: (dim, values, _named(values, words)) for dim, (values, words) in known.items() if dim in used}


def _named(values: np.ndarray, words: str) -> dict[str, Any]:
    """The attributes of what has no unit; CF gives numbers the unit 1 and words none."""
    return {"long_name": words} if values.dtype.kind == "U" else {"units": "1", "long_name": words}


def _list(scene: Scene, name: str) -> tuple[tuple[str, ...], np.ndarray, dict[str, Any]]:
    """A listed parameter over the axes along which any of its sections varies, NaN after the end of a line."""
    names = component_names(name, scene.sections)
    axes = [axis for axis in scene.design.axes if not axis.columns.keys().isdisjoint(names)]
    values = np.full((*(axis.size for axis in axes), scene.sections), np.nan)
    for section, column in enumerate(names):
        if column in scene.fixed:
            values[..., section] = scene.fixed[column]
        for position, axis in enumerate(axes):
            if column in axis.columns:
                alone = [axis.size if i == position else 1 for i in range(len(axes))]
                values[..., section] = axis.columns[column].reshape(alone)
    return (*(axis.name for axis in axes), *LIST), values, attributes_of(name)


def _parameter(spec: ParameterSpec, values: np.ndarray) -> tuple[np.ndarray, dict[str, Any]]:
    """Values and attributes of a coordinate; a word is stored as text, beside all that it might be."""
    if not spec.words:
        return values, attributes_of(spec.name)
    return spec.restored(values), {"long_name": quantity(spec.name).meaning, "words": " ".join(spec.words)}


def _words(words: tuple[str, ...]) -> np.ndarray:
    return np.array(words, dtype=str)


def attributes_of(name: str) -> dict[str, Any]:
    """The CF attributes of a variable."""
    if name == "status":
        return status_attributes()
    attributes: dict[str, Any] = dict(quantity(name).attributes)
    if name == "iterations":
        attributes["comment"] = f"{NOT_COUNTED} where the method does not count any"
    return attributes


def provenance(scene: Scene, plan: str, revision: str) -> dict[str, Any]:
    """Global attributes: what was asked, by which code and plan it was answered, and no clock."""
    methods = {
        m.name: {"solver": m.solver.name, "options": m.options, "sources": source_digest(m.solver.name)}
        for m in scene.methods
    }
    attributes: dict[str, Any] = {
        "Conventions": "CF-1.11",
        "title": scene.title,
        "source": f"cablesim {version('cablesim')}",
        "history": "sampled, solved and collected by cablesim; undated, so that the same inputs give the same file",
        "revision": revision,
        "scene": scene.name,
        "scene_digest": scene.digest,
        "plan": plan,
        "design": scene.design.kind,
        "methods": json.dumps(methods, sort_keys=True),
        "reference": scene.reference.name if scene.reference else "none",
    }
    if scene.question:
        attributes["comment"] = scene.question
    if scene.design.seed is not None:
        attributes["seed"] = scene.design.seed
    return attributes
