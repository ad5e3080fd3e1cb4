"""Join the shards of a scene into one labelled dataset.

The file is written part by part by one writer, so that a dataset larger than memory can be made and the same inputs
give the same bytes. Scenarios whose shard is missing or damaged are in it as `not_run`.
"""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr

from cablesim.config.check_file import Check, Monotone
from cablesim.config.scene import Scene
from cablesim.database.checks import check_attributes, check_flags
from cablesim.database.gather import Arrays, Part, Shards, gather, own_dims, own_shape, parts, stored_type
from cablesim.database.labels import attributes_of, coordinates, provenance
from cablesim.database.shard_file import STORAGE, chunk_sizes, small_chunk_cache
from cablesim.database.timing import MEASURED, THREADS, Timing, Timings
from cablesim.files import Checked, check, enter_in_ledger, written_whole
from cablesim.plan import ScenePlan
from cablesim.quantities import QUANTITIES, RUN_TIME

# Scenarios of a slab that is checked at once.
SLAB = 2**20
# What is measured of every method that is timed: what each is in a `Timing`.
TIMED: dict[str, Callable[[Timing], float]] = {
    "run_time_lowest": lambda timing: min(timing.runs),
    "run_time_highest": lambda timing: max(timing.runs),
    "run_time_alone": lambda timing: timing.alone,
    "first_call_time": lambda timing: timing.first_call,
    "repeats": lambda timing: float(len(timing.runs)),
}
MEASURED_NAMES = (RUN_TIME, *TIMED)


def collect(
    path: Path, scene: Scene, plan: ScenePlan, folder: Path, revision: str, timings: Timings | None = None
) -> dict[Path, Checked]:
    """Write the dataset of a scene, what was measured as a group of its own, and its ledger.

    Returns the shards that could not be used: their scenarios are `not_run`.
    """
    shards = Shards(folder, {digest: check(folder / f"{digest}.nc") for digest in plan.recipes})
    with written_whole(path) as temporary:
        given = coordinates(scene)
        _write_coordinates(temporary, given, provenance(scene, plan.digest, revision))
        with small_chunk_cache(), netCDF4.Dataset(temporary, "a") as file:
            _name_coordinates(file, given, _create_answers(file, scene))
            _write_values(file, scene, plan, shards, timings)
        _write_checks(temporary, scene)
    lost = {shards.path(digest): checked for digest, checked in shards.checked.items() if not checked.whole}
    enter_in_ledger(path, complete=not lost)
    return lost


def _write_coordinates(path: Path, given: dict[str, Any], attributes: dict[str, Any]) -> None:
    """The file with all that is not answered. Written as variables: `coordinates` says later whose they are."""
    dataset = xr.Dataset(coords=given, attrs=attributes).reset_coords()
    dataset.to_netcdf(path, engine="netcdf4", encoding={str(n): _encoding(n, v) for n, v in dataset.variables.items()})


def _answers(scene: Scene) -> tuple[str, ...]:
    """What is stored of every scenario, but for checks and what is measured."""
    counted = ("iterations",) if any(method.solver.iterates for method in scene.methods) else ()
    return (*scene.outputs, "status", *counted)


def _create_answers(file: Any, scene: Scene) -> list[Any]:
    """Empty variables for all that is answered, and for the flags of checks."""
    flags = [_create(file, scene, one.name, np.dtype(np.int8), check_attributes(one)) for one in scene.checks]
    return [*(_create_known(file, scene, name) for name in _answers(scene)), *flags]


def _write_values(file: Any, scene: Scene, plan: ScenePlan, shards: Shards, timings: Timings | None) -> None:
    measured = _create_measured(file, scene, timings)
    ranges: dict[str, list[float]] = {}
    for part in parts(scene, (*_answers(scene), RUN_TIME)):
        values = gather(scene, plan, part, shards)
        _use_timings(values, scene, part, timings)
        for name, array in values.items():
            variable = measured if name == RUN_TIME else file.variables[name]
            variable[part.method, part.rows] = array
            if array.dtype.kind == "f" and np.isfinite(array).any():
                lowest, highest = np.nanmin(array), np.nanmax(array)
                known = ranges.get(name, [lowest, highest])
                ranges[name] = [min(lowest, known[0]), max(highest, known[1])]
    for name, (lowest, highest) in ranges.items():
        variable = measured if name == RUN_TIME else file.variables[name]
        variable.actual_range = np.array([lowest, highest], dtype=variable.dtype)


def _write_checks(path: Path, scene: Scene) -> None:
    """What the checks say of the values that are in the file, a slab of the design at a time."""
    if not scene.checks:
        return
    with small_chunk_cache(), xr.open_dataset(path, engine="netcdf4", cache=False) as dataset:
        flags = {one.name: _flags(one, dataset, scene) for one in scene.checks}
    with netCDF4.Dataset(path, "a") as file:
        for name, values in flags.items():
            file.variables[name][...] = values


def _flags(one: Check, dataset: xr.Dataset, scene: Scene) -> np.ndarray:
    """The flags of a check; slabs are along another axis than the one that values are monotone along."""
    along = one.along if isinstance(one, Monotone) else None
    axis = next((axis for axis in scene.design.axes if axis.name != along), None)
    flags = np.empty(dataset.status.shape, dtype=np.int8)
    if axis is None:
        return check_flags(one, dataset).values
    rows = max(1, SLAB * axis.size // max(1, flags.size))
    position = dataset.status.dims.index(axis.name)
    for first in range(0, axis.size, rows):
        slab = slice(first, first + rows)
        flags[(slice(None),) * position + (slab,)] = check_flags(one, dataset.isel({axis.name: slab})).values
    return flags


def _create_known(file: Any, scene: Scene, name: str) -> Any:
    """An empty variable for a quantity."""
    return _create(file, scene, name, stored_type(name), attributes_of(name))


def _create(file: Any, scene: Scene, name: str, kind: np.dtype, attributes: dict[str, Any]) -> Any:
    """An empty variable over method, axes and its own dimensions."""
    shape = (len(scene.methods), *scene.design.shape, *own_shape(scene, name))
    dims = ("method", *(axis.name for axis in scene.design.axes), *own_dims(name))
    known = file.dimensions.keys() | (file.parent.dimensions.keys() if file.parent else set())
    for dim, size in zip(dims, shape, strict=True):
        if dim not in known:
            file.createDimension(dim, size)
    blank = np.nan if kind.kind == "f" else False
    settings = {**STORAGE, "chunksizes": _chunks(name, shape)}
    variable = file.createVariable(name, kind, dims, fill_value=blank, **settings)
    variable.setncatts(attributes)
    return variable


def _create_measured(file: Any, scene: Scene, timings: Timings | None) -> Any:
    """The group of what was measured, whole but for the run times of scenarios, which are returned to be filled."""
    group = file.createGroup(MEASURED)
    run_time = _create_known(group, scene, RUN_TIME)
    if timings is not None:
        group.setncatts({"machine": timings.machine, "threads": THREADS, "import_seconds": timings.import_seconds})
        names = [method.name for method in scene.methods]
        for name, of in TIMED.items():
            variable = group.createVariable(name, "f8", ("method",), fill_value=np.nan, **STORAGE)
            variable.setncatts(attributes_of(name))
            variable[:] = [of(timings.methods[n]) if n in timings.methods else math.nan for n in names]
    return run_time


def _use_timings(values: Arrays, scene: Scene, part: Part, timings: Timings | None) -> None:
    """The run time of a method that was timed, instead of what its shards took."""
    timed = timings.methods.get(scene.methods[part.method].name) if timings else None
    if timed is not None and RUN_TIME in values:
        values[RUN_TIME][...] = timed.median


def _name_coordinates(file: Any, given: dict[str, Any], variables: list[Any]) -> None:
    """Say, as CF does, which variables are coordinates of which; those of none are told in the file's attributes.

    Words are named even where they have the name of a dimension: to CF only numbers are coordinates by their name.
    """
    others = {
        name: {dims} if isinstance(dims, str) else set(dims)
        for name, (dims, values, _) in given.items()
        if name not in file.dimensions or values.dtype.kind == "U"
    }
    for variable in variables:
        own = [name for name, dims in others.items() if dims <= set(variable.dimensions)]
        if own:
            variable.coordinates = " ".join(own)
    widest = set().union(*(variable.dimensions for variable in variables))
    left = [name for name, dims in others.items() if not dims <= widest]
    if left:
        file.coordinates = " ".join(left)


def _chunks(name: str, shape: tuple[int, ...]) -> tuple[int, ...]:
    """Chunks of a variable; a history is read one scenario at a time."""
    if name not in QUANTITIES or not QUANTITIES[name].is_history:
        return chunk_sizes(shape)
    scenario_dims = len(shape) - len(own_dims(name))
    return (*(1,) * scenario_dims, *chunk_sizes(shape[scenario_dims:]))


def _encoding(name: Any, variable: xr.Variable) -> dict[str, Any]:
    """How a coordinate is stored; words as characters of fixed width, which every netCDF reader understands."""
    if variable.dtype.kind == "U":
        return {"dtype": "S1", "char_dim_name": f"{name}_width", **(STORAGE if variable.dims else {})}
    sizes = {"chunksizes": chunk_sizes(variable.shape), **STORAGE} if variable.dims else {}
    return {"_FillValue": None, **sizes}
