"""Join the shards of a scene into one labelled dataset, by integer place, never by comparing floats.

Shards are read in groups by Dask; the dataset is written by one writer without Dask, because only that gives the same
bytes every time.
"""

import json
import math
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from cablesim.config.scene import Scene
from cablesim.database.shard_file import check_shards, chunk_sizes, read_shard
from cablesim.database.timing import THREADS, Timing, Timings
from cablesim.files import written_whole
from cablesim.parameters import ParameterSpec
from cablesim.plan import ScenePlan
from cablesim.quantities import COMPONENTS, LIST, PLACES, QUANTITIES, component_names, quantity, section_number
from cablesim.shards import Placement
from cablesim.sources import source_digest
from cablesim.status import Status

NOT_COUNTED = -1
# Shards held in memory beside the dataset they go into.
SHARDS_AT_ONCE = 8
MEASURED = "measured"
# What is measured of every scenario, and of every method that is timed: what each is in a `Timing`.
RUN_TIME = "run_time"
TIMED: dict[str, Callable[[Timing], float]] = {
    "run_time_lowest": lambda timing: min(timing.runs),
    "run_time_highest": lambda timing: max(timing.runs),
    "run_time_alone": lambda timing: timing.alone,
    "first_call_time": lambda timing: timing.first_call,
    "repeats": lambda timing: float(len(timing.runs)),
}
WHOLE = {"status": np.dtype(np.int8), "iterations": np.dtype(np.int32)}


def collect(
    scene: Scene, plan: ScenePlan, shards: Path, revision: str, timings: Timings | None = None
) -> tuple[xr.Dataset, xr.Dataset]:
    """The dataset of a scene and, apart from it, what was measured. Raises EnvironmentFault for a damaged shard."""
    variables, run_time = _gather(scene, plan, shards)
    coords = _coordinates(scene)
    data = {name: (dims, values, _attributes(name)) for name, (dims, values) in variables.items()}
    dataset = xr.Dataset(data, coords, _provenance(scene, revision))
    dims = ("method", *(axis.name for axis in scene.design.axes))
    measured = xr.Dataset({RUN_TIME: (dims, run_time, _attributes(RUN_TIME))})
    return dataset, measured if timings is None else _with_timings(measured, scene, timings)


def _with_timings(measured: xr.Dataset, scene: Scene, timings: Timings) -> xr.Dataset:
    """The run times of methods that were timed instead of those of their shards, and what else was measured."""
    names = [method.name for method in scene.methods]
    for name, timing in timings.methods.items():
        measured[RUN_TIME][names.index(name)] = timing.median
    found = {
        variable: [of(timings.methods[name]) if name in timings.methods else math.nan for name in names]
        for variable, of in TIMED.items()
    }
    about = {"machine": timings.machine, "threads": THREADS, "import_seconds": timings.import_seconds}
    new = {variable: ("method", np.array(values), _attributes(variable)) for variable, values in found.items()}
    return measured.assign(new).assign_attrs(about)


def write_dataset(path: Path, dataset: xr.Dataset, measured: xr.Dataset) -> None:
    """Write both into one file, the measured values as a group of their own."""
    with written_whole(path) as temporary:
        dataset.to_netcdf(temporary, engine="netcdf4", encoding=_encoding(dataset))
        measured.to_netcdf(temporary, engine="netcdf4", encoding=_encoding(measured), mode="a", group=MEASURED)


def _gather(scene: Scene, plan: ScenePlan, shards: Path) -> tuple[dict[str, Any], np.ndarray]:
    """Every variable of the scene as one array over (method, axes..., its own dimensions)."""
    import dask

    shape = (len(scene.methods), *scene.design.shape)
    arrays: dict[str, np.ndarray] = {}
    run_time = np.zeros(shape, dtype=np.float32)
    names = (*scene.outputs, *WHOLE)
    seconds = check_shards(shards / f"{digest}.nc" for digest in plan.recipes)
    placed = [(number, part.positions, item) for number, part in enumerate(plan.methods) for item in part.placements]
    for first in range(0, len(placed), SHARDS_AT_ONCE):
        group = placed[first : first + SHARDS_AT_ONCE]
        paths = [shards / f"{placement.recipe.digest}.nc" for _, _, placement in group]
        # One thread: HDF5 serialises all reading behind one lock anyway, and threads around it have crashed.
        read = dask.compute(*(dask.delayed(read_shard)(path, names) for path in paths), scheduler="synchronous")
        for (number, positions, placement), path, values in zip(group, paths, read, strict=True):
            share = seconds[path] / max(1, math.prod(placement.recipe.shape))
            values = {name: _as_wide(name, own, scene.sections) for name, own in values.items()}
            _place(arrays, run_time, number, positions, placement, values, share)
    for number, method in enumerate(scene.methods):
        if not method.solver.iterates:
            arrays["iterations"][number] = NOT_COUNTED
    if (arrays["iterations"] == NOT_COUNTED).all():
        del arrays["iterations"]
    dims = ("method", *(axis.name for axis in scene.design.axes))
    return {name: ((*dims, *_own_dims(name)), values) for name, values in arrays.items()}, run_time


def _own_dims(name: str) -> tuple[str, ...]:
    return QUANTITIES[name].dims if name in QUANTITIES else ()


def _as_wide(name: str, values: np.ndarray, sections: int) -> np.ndarray:
    """An output over sections with as many as the scene has: a shard has those of its own lines."""
    dims = _own_dims(name)
    if dims[:1] != LIST:
        return values
    axis = values.ndim - len(dims)
    own = values[(slice(None),) * axis + (slice(sections),)]
    missing = [(0, sections - own.shape[axis] if i == axis else 0) for i in range(own.ndim)]
    return np.pad(own, missing, constant_values=np.nan)


def _place(
    arrays: dict[str, np.ndarray],
    run_time: np.ndarray,
    number: int,
    positions: tuple[int, ...],
    placement: Placement,
    values: dict[str, np.ndarray],
    seconds: float,
) -> None:
    """Put a shard where it belongs; a method that ignores an axis has the same answer all along it."""
    dimensions = run_time.ndim - 1
    axes: list[Any] = [slice(None)] * dimensions
    for position, target in zip(positions, placement.target, strict=True):
        axes[position] = _as_slice(target)
    for name, own in values.items():
        block = _in_design_order(own, placement, positions, dimensions)
        if name not in arrays:
            arrays[name] = np.empty(run_time.shape + block.shape[dimensions:], dtype=block.dtype)
        _assign(arrays[name][number], axes, block)
    _assign(run_time[number], axes, np.full((1,) * dimensions, seconds, dtype=np.float32))


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


def _coordinates(scene: Scene) -> dict[str, Any]:
    coords: dict[str, Any] = {
        "method": ("method", _words(tuple(m.name for m in scene.methods)), {"long_name": "method"})
    }
    for axis in scene.design.axes:
        for name, values in axis.columns.items():
            if section_number(name) and name != axis.name:
                continue
            coords[name] = (axis.name, *_parameter(scene.parameters[name], values))
        if axis.name not in axis.columns:
            coords[axis.name] = (
                axis.name,
                np.arange(axis.size, dtype=np.int32),
                {"long_name": f"number of the {axis.name}"},
            )
        for name, values in axis.labels.items():
            is_word = values.dtype.kind == "U"
            coords[name] = (
                axis.name,
                _words(tuple(values)) if is_word else values.astype(np.int32),
                {"long_name": LABELS[name]},
            )
    for name, value in scene.fixed.items():
        if not section_number(name):
            coords[name] = ((), *_parameter(scene.parameters[name], np.array(value)))
    if scene.sections:
        numbers = np.arange(1, scene.sections + 1, dtype=np.int32)
        coords["section"] = ("section", numbers, {"long_name": "number of the section, from A to B"})
        coords |= {name: _list(scene, name) for name, spec in scene.parameters.items() if spec.listed}
    return coords | _own_coordinates(scene)


def _own_coordinates(scene: Scene) -> dict[str, Any]:
    """Coordinates of the dimensions that values have within one scenario."""
    sizes = scene.methods[0].sizes
    phases, times = sizes.get("phase", 1), sizes.get("time", 1)
    known = {
        "component": (_words(COMPONENTS), "component of a vector"),
        "place": (_words(PLACES), "where along the line"),
        "phase": (np.arange(phases) / phases, "part of the last period that has passed"),
        "time": (np.arange(times, dtype=np.int32), "number of the time; the times are history_time"),
    }
    used = {dim for name in scene.outputs for dim in quantity(name).dims}
    return {dim: (dim, values, {"long_name": words}) for dim, (values, words) in known.items() if dim in used}


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
    return (*(axis.name for axis in axes), *LIST), values, _attributes(name)


def _parameter(spec: ParameterSpec, values: np.ndarray) -> tuple[np.ndarray, dict[str, Any]]:
    """Values and attributes of a coordinate; a word is stored as text, beside all that it might be."""
    if not spec.words:
        return values, _attributes(spec.name)
    return spec.restored(values), {"long_name": quantity(spec.name).meaning, "words": " ".join(spec.words)}


LABELS = {
    "row": "row of the published table",
    "key": "column of the published table that decides the scenario",
    "rounding": "whether the key is taken as printed, or moved half a unit of its last digit",
}


def _words(words: tuple[str, ...]) -> np.ndarray:
    return np.array(words, dtype=str)


def _attributes(name: str) -> dict[str, Any]:
    if name == "status":
        words = " ".join(status.name for status in Status)
        flags = np.array([int(status) for status in Status], dtype=np.int8)
        return {"long_name": "fate of the scenario", "flag_values": flags, "flag_meanings": words}
    row = quantity(name)
    attributes = {"units": row.unit, "long_name": row.meaning}
    if row.standard_name:
        attributes["standard_name"] = row.standard_name
    if name == "iterations":
        attributes["comment"] = f"{NOT_COUNTED} where the method does not count any"
    return attributes


def _provenance(scene: Scene, revision: str) -> dict[str, Any]:
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
        "design": scene.design.kind,
        "methods": json.dumps(methods, sort_keys=True),
        "reference": scene.reference.name if scene.reference else "none",
    }
    if scene.question:
        attributes["comment"] = scene.question
    if scene.design.seed is not None:
        attributes["seed"] = scene.design.seed
    return attributes


def _chunks(name: str, shape: tuple[int, ...]) -> tuple[int, ...]:
    """Chunks of a variable; a history is read one scenario at a time."""
    if name not in QUANTITIES or not QUANTITIES[name].is_history:
        return chunk_sizes(shape)
    scenario_dims = len(shape) - len(QUANTITIES[name].dims)
    return (*(1,) * scenario_dims, *chunk_sizes(shape[scenario_dims:]))


def _encoding(dataset: xr.Dataset) -> dict[str, Any]:
    encoding: dict[str, Any] = {}
    for name, variable in dataset.variables.items():
        settings: dict[str, Any] = {}
        if variable.dims and variable.dtype.kind != "U":
            settings |= {
                "zlib": True,
                "complevel": 1,
                "shuffle": True,
                "fletcher32": True,
                "chunksizes": _chunks(str(name), variable.shape),
            }
        if variable.dtype.kind == "U":
            # Fixed-width characters, which every netCDF reader understands.
            settings |= {"dtype": "S1", "char_dim_name": f"{name}_width"}
        elif name in dataset.coords or variable.dtype.kind != "f":
            settings["_FillValue"] = None
        encoding[str(name)] = settings
    return encoding
