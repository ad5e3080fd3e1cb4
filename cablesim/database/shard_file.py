"""The netCDF file of one job, written with netCDF4 alone: a solve step that imports no more starts in half the time."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from cablesim import batch
from cablesim.batch import Results
from cablesim.design import Axis, expand
from cablesim.errors import EnvironmentFault
from cablesim.files import enter_in_ledger, written_whole
from cablesim.quantities import quantity
from cablesim.shards import Recipe
from cablesim.solver import load_solver
from cablesim.status import status_attributes

# Values in a chunk: large enough to compress well, small enough to read a part.
CHUNK = 2**17
# Bytes of a variable that netCDF keeps: some chunks.
CHUNK_CACHE = 2**22
# What every array in a file of ours is stored with: compressed a little, and with a checksum for each chunk.
STORAGE = {"zlib": True, "complevel": 1, "shuffle": True, "fletcher32": True}


def solve_recipe(recipe: Recipe) -> Results:
    """Solve every scenario of a shard, in C order of its axes."""
    solver = load_solver(recipe.solver)
    parameters = solver.from_columns({**recipe.fixed, **expand(recipe.axes)})
    return batch.run(solver, parameters, solver.make_options(recipe.options), recipe.outputs)


def write_shard(path: Path, recipe: Recipe, results: Results) -> None:
    """Write a shard and enter it, with the measured time, in its ledger."""
    import netCDF4

    shape = recipe.shape
    with written_whole(path) as temporary, netCDF4.Dataset(temporary, "w", format="NETCDF4") as file:
        file.setncatts({"Conventions": "CF-1.11", "solver": recipe.solver, "sources": recipe.sources})
        file.setncatts({"title": f"A shard of {recipe.solver}", "history": "solved by cablesim; undated"})
        file.setncattr("options", json.dumps(recipe.options, sort_keys=True))
        file.setncattr("fixed", json.dumps(recipe.fixed, sort_keys=True))
        dims = tuple(_dimension(axis) for axis in recipe.axes)
        for dim, axis in zip(dims, recipe.axes, strict=True):
            file.createDimension(dim, axis.size)
            for name, values in axis.columns.items():
                _write(file, name, (dim,), values)
        given = " ".join(name for name in file.variables if name not in dims)
        for name, values in results.outputs.items():
            for size, dim in zip(values.shape[1:], quantity(name).dims, strict=True):
                if dim not in file.dimensions:
                    file.createDimension(dim, size)
            _write(file, name, (*dims, *quantity(name).dims), values.reshape((*shape, *values.shape[1:])))
        _write(file, "status", dims, results.status.reshape(shape))
        _write(file, "iterations", dims, results.iterations.reshape(shape))
        for name in (*results.outputs, "status", "iterations") if given else ():
            file.variables[name].coordinates = given
    enter_in_ledger(path, results.seconds)


def read_shard(path: Path, names: tuple[str, ...]) -> dict[str, np.ndarray]:
    """Variables of a checked shard as arrays in its own axes. Raises EnvironmentFault for one that cannot be read."""
    import netCDF4

    try:
        with netCDF4.Dataset(path) as file:
            file.set_auto_mask(False)
            return {name: file.variables[name][...] for name in names}
    except (OSError, RuntimeError, KeyError, IndexError) as problem:
        raise EnvironmentFault(f"{path}: cannot be read ({problem}); run the study again") from None


@contextmanager
def small_chunk_cache() -> Iterator[None]:
    """Files that are opened here keep little of what was read or written.

    netCDF would keep up to 64 MB of every variable, which for many variables is more than a whole study should take.
    """
    import netCDF4

    usual = netCDF4.get_chunk_cache()
    netCDF4.set_chunk_cache(CHUNK_CACHE, *usual[1:])
    try:
        yield
    finally:
        netCDF4.set_chunk_cache(*usual)


def chunk_sizes(shape: tuple[int, ...]) -> tuple[int, ...]:
    """Whole trailing dimensions as far as a chunk holds them."""
    chunks, room = [], CHUNK
    for size in reversed(shape):
        chunks.append(max(1, min(size, room)))
        room = max(1, room // max(1, size))
    return tuple(reversed(chunks))


def _dimension(axis: Axis) -> str:
    """The name of the dimension of an axis: another than its own if its values do not all rise or all fall.

    Numbers with the name of their dimension are in order, says CF; words, which are numbers here, need not be.
    """
    change = np.diff(axis.columns.get(axis.name, ()))
    return axis.name if (change > 0).all() or (change < 0).all() else f"{axis.name}_number"


def _write(file: Any, name: str, dims: tuple[str, ...], values: np.ndarray) -> None:
    settings = {**STORAGE, "chunksizes": chunk_sizes(values.shape)} if dims else {}
    variable = file.createVariable(name, values.dtype, dims, fill_value=False, **settings)
    variable[...] = values
    variable.setncatts(status_attributes() if name == "status" else quantity(name).attributes)
