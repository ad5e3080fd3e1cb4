"""Open what a study has made, and give its names a meaning in formulas and conditions."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from cablesim.config.document import is_name
from cablesim.config.scene import Reference
from cablesim.config.table import Table
from cablesim.database.probe import probe
from cablesim.database.shard_file import small_chunk_cache
from cablesim.database.timing import MEASURED
from cablesim.design import SCENARIO
from cablesim.errors import CablesimError, EnvironmentFault, InputError, nearest
from cablesim.expressions import BARE, WORDS, Expression, Lookup, Term, UnknownName, parse
from cablesim.files import is_vouched_for
from cablesim.quantities import component_names, is_list, is_vector, list_name, quantity

# Of a dataset that is read into memory as a whole.
MOST_BYTES = 2**27


def scene_paths(results: Path) -> dict[str, Path]:
    """The datasets of a results folder by scene. Raises InputError if there is no such folder."""
    if not results.is_dir():
        raise InputError(f"{results}: no such folder of results")
    return {path.stem: path for path in sorted(results.glob("*.nc")) if is_name(path.stem)}


def scene_path(results: Path, scene: str) -> Path:
    """The dataset of a scene. Raises InputError, with the nearest names, for an unknown one."""
    paths = scene_paths(results)
    if scene not in paths:
        raise _no_scene(results, scene, paths)
    return paths[scene]


def _no_scene(results: Path, scene: str, known: Iterable[str]) -> InputError:
    return InputError(f"{results}: no scene '{scene}': {nearest(scene, known)}")


def open_scene(results: Path, scene: str) -> xr.Dataset:
    """A scene's dataset, the measured run time beside the rest.

    Raises InputError, with the nearest names, for an unknown scene; EnvironmentFault for a file that cannot be read.
    """
    return read_dataset(scene_path(results, scene))


def open_scenes(results: Path, names: str) -> dict[str, xr.Dataset]:
    """The datasets of scenes that are named as `chosen_paths` takes them."""
    return {scene: read_dataset(path) for scene, path in chosen_paths(results, names).items()}


def chosen_paths(results: Path, names: str) -> dict[str, Path]:
    """Datasets by scene: of one, of several separated by commas, or of those that a pattern with `*` and `?` fits.

    Raises InputError, with the nearest names, where there is no such scene.
    """
    paths = scene_paths(results)
    chosen: dict[str, Path] = {}
    for name in names.split(","):
        fitting = {scene: path for scene, path in paths.items() if fnmatchcase(scene, name.strip())}
        if not fitting:
            raise _no_scene(results, name.strip(), paths)
        chosen |= fitting
    return chosen


def is_pattern(names: str) -> bool:
    """Whether scenes are asked for by a pattern."""
    return "*" in names or "?" in names


def open_dataset(path: Path, **options: Any) -> xr.Dataset:
    """A dataset file and its group of measured values as one lazy dataset, with the attributes of both.

    Raises EnvironmentFault for a file that is not the one in its ledger, is no dataset of ours, or cannot be read. One
    without a ledger, copied by itself, is opened.
    """
    with readable(path), small_chunk_cache():
        if not is_vouched_for(path):
            probe(path)
        dataset, measured = (
            xr.open_dataset(path, engine="netcdf4", group=group, **options) for group in (None, MEASURED)
        )
        whole = dataset.assign(measured.variables).assign_attrs(measured.attrs)
    lacking = sorted({"method", "status"} - whole.variables.keys() | {"title", "methods"} - whole.attrs.keys())
    if lacking:
        raise EnvironmentFault(f"{path}: not a dataset of a scene: it has no {lacking[0]}")

    def close() -> None:
        dataset.close()
        measured.close()

    whole.set_close(close)
    return whole


@contextmanager
def readable(path: Path | str) -> Iterator[None]:
    """Whatever goes wrong while a file is read is an EnvironmentFault: libraries raise anything of a damaged one."""
    try:
        yield
    except CablesimError:
        raise
    except Exception as problem:
        raise EnvironmentFault(f"{path}: cannot be read ({str(problem) or type(problem).__name__})") from None


def read_dataset(path: Path) -> xr.Dataset:
    """The same, in memory if it is small; of a large one each variable is read when it is asked for, and not kept."""
    whole = open_dataset(path, cache=False)
    if whole.nbytes > MOST_BYTES:
        return whole
    with readable(path), whole:
        loaded = whole.load()
    if not loaded.status.isin(range(len(status_words(loaded)))).all():
        raise EnvironmentFault(f"{path}: damaged (some status is none of {', '.join(status_words(loaded))})")
    return loaded


def of_scenarios(values: xr.DataArray, dataset: xr.Dataset) -> bool:
    """Whether values are one for each scenario, or for scenarios along some dimensions, or for all."""
    return set(values.dims) <= set(dataset.status.dims)


def of_method(values: xr.DataArray, method: str) -> xr.DataArray:
    """One method's values. Given as a dict, because `sel(method=...)` means nearest-neighbour look-up to xarray."""
    return values.sel({"method": str(method)}, drop=True)


def of_only_method(values: xr.DataArray) -> xr.DataArray:
    """Values without their method, where the scene has but one."""
    return values.isel(method=0, drop=True) if "method" in values.dims else values


def reference_values(reference: Reference, dataset: xr.Dataset, output: str) -> xr.DataArray:
    """What an output is measured against, by scenario."""
    if reference.table is None:
        return of_method(dataset[output], str(reference.method))
    values = reference.table.evaluate(reference.columns[output], quantity(output).unit)
    return xr.DataArray(values[dataset.row.values], dims="scenario")


def magnitude(values: xr.DataArray) -> xr.DataArray:
    """The absolute value of a number, the length of a vector."""
    if "component" not in values.dims:
        return abs(values)
    return values.reduce(np.linalg.norm, "component")


def with_components(dataset: xr.Dataset) -> xr.Dataset:
    """The dataset with each vector and each list also by its parts: `force_B` as `force_B_x`, `force_B_y`, `force_B_z`.

    Those of `section_length` are `section_length_1`, `section_length_2`, ..., NaN where a line has fewer sections.
    """
    given, answered = (
        {part: values for whole in group.values() for part, values in _parts(whole).items()}
        for group in (dataset.coords, dataset.data_vars)
    )
    own = {name: values for name, values in given.items() if name not in dataset.coords}
    return dataset.assign_coords(own).assign(answered)


def _parts(values: xr.DataArray) -> dict[str, xr.DataArray]:
    """The parts of a vector or a list; one part varies along the axis of another in form only."""
    name = str(values.name)
    if not (is_vector(name) or is_list(name)) or quantity(name).dims[0] not in values.dims:
        return {}
    dim = quantity(name).dims[0]
    others = {str(axis): 0 for axis in values.dims if list_name(str(axis)) == name}
    return {
        part: values.isel({**others, dim: i}, drop=True).assign_attrs(long_name=quantity(part).meaning)
        for i, part in enumerate(component_names(name, values.sizes[dim]))
    }


def running_numbers(values: xr.Dataset | xr.DataArray) -> set[str]:
    """The dimensions whose coordinate only counts: scenarios, and points of an axis of vectors."""
    return {str(dim) for dim in values.dims if dim == SCENARIO or is_vector(str(dim))}


def written(value: xr.DataArray, digits: int = 6) -> str:
    """A single value as text: a word as it is, a number with some digits."""
    item = value.item()
    return item if isinstance(item, str) else f"{item:.{digits}g}"


def flag_words(values: xr.DataArray) -> tuple[str, ...]:
    """The words that a variable of flags stands for, by its numbers; none for any other variable."""
    return tuple(values.attrs.get("flag_meanings", "").split())


def status_words(dataset: xr.Dataset) -> tuple[str, ...]:
    """The words that the dataset's own status numbers stand for."""
    return flag_words(dataset.status)


def scene_lookup(dataset: xr.Dataset, table: Table | None = None) -> Lookup:
    """What names mean in a formula over a scene.

    `sag` is the output (over all methods), `exact.sag` that of one method, `length_ratio` a coordinate, `status` and
    `method` words, and `table.sag_m` a column of the scene's table, row by row.
    """

    def lookup(name: str) -> Term | None:
        head, _, tail = name.rpartition(".")
        if head == "table" and table is not None:
            return _of_table(dataset, table, tail)
        if head:
            return _of_method(dataset, head, tail)
        if name not in dataset.variables:
            return None
        return _term(dataset[name])

    return lookup


def evaluate(dataset: xr.Dataset, formula: str, table: Table | None = None) -> xr.DataArray:
    """The value of a formula over a scene. Raises InputError, with the nearest names, for an unknown one."""
    return _explained(dataset, parse(formula), Expression.evaluate, table)


def select(dataset: xr.Dataset, condition: str, table: Table | None = None) -> xr.DataArray:
    """Where a condition holds, on the dataset's names and a table's. Raises InputError as `evaluate` does."""
    return _explained(dataset, parse(condition), Expression.select, table)


def _explained(
    dataset: xr.Dataset, expression: Expression, answer: Callable[[Expression, Lookup], Any], table: Table | None
) -> xr.DataArray:
    # Parts of vectors and lists are made only where something is asked for that is not there as it is.
    if any(name.rpartition(".")[2] not in dataset.variables for name in expression.names):
        dataset = with_components(dataset)
    try:
        return xr.DataArray(answer(expression, scene_lookup(dataset, table)))
    except UnknownName as unknown:
        raise name_is_unknown(dataset, unknown.name) from None


def name_is_unknown(dataset: xr.Dataset, name: str) -> InputError:
    """What to say of a name that stands for nothing in a dataset: the nearest ones."""
    methods, outputs = dataset.method.values.tolist(), [str(output) for output in dataset.data_vars]
    names = [*map(str, dataset.variables), *(f"{m}.{output}" for m in methods for output in outputs)]
    return InputError(f"unknown name '{name}': {nearest(name, names)}")


def _of_method(dataset: xr.Dataset, method: str, name: str) -> Term | None:
    if method not in dataset.method.values or name not in dataset.variables or "method" not in dataset[name].dims:
        return None
    return _term(of_method(dataset[name], method))


def _of_table(dataset: xr.Dataset, table: Table, column: str) -> Term:
    """A column by scenario: of cases by their row, of a grid along the axis that the first column is, NaN elsewhere."""
    if "row" in dataset.variables:
        term = table.term(column, dataset.row.values)
        return replace(term, values=xr.DataArray(term.values, dims="scenario"))
    axis = next(iter(table.columns))
    values = np.full(dataset.sizes[axis], np.nan)
    values[rows_on_axis(dataset, table)] = table.numbers(column)
    return Term(xr.DataArray(values, dims=axis), BARE)


def rows_on_axis(dataset: xr.Dataset, table: Table) -> np.ndarray:
    """The point of each row of a table on the axis that its first column is. Raises InputError where there is none."""
    axis = next(iter(table.columns))
    if axis not in dataset.dims:
        raise InputError(f"{table.path}: its first column, {axis}, must be an axis of the scene")
    printed, values = table.numbers(axis), dataset[axis].values
    where: np.ndarray = np.abs(values[:, None] - printed).argmin(axis=0)
    for row in np.flatnonzero(values[where] != printed):
        raise InputError(f"{table.path}: row {row + 1}: {axis} = {printed[row]:g} is not on the scene's axis")
    return where


def _term(values: xr.DataArray) -> Term:
    if flag_words(values):
        return Term(values, WORDS, flag_words(values))
    if values.dtype.kind in "SUOT":
        known = values.attrs["words"].split() if "words" in values.attrs else np.unique(values)
        return Term(values, WORDS, tuple(str(word) for word in known))
    return Term(values, values.attrs.get("units", BARE))
