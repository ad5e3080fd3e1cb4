"""Ask a scene for scenarios: a condition, columns, a format. Only netCDF has room for profiles and histories."""

import io
import json
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from cablesim.database.reading import flag_words, select, with_components
from cablesim.errors import InputError, nearest
from cablesim.quantities import OWN_DIMS, QUANTITIES, SHORT

FORMATS = ("table", "csv", "json", "parquet", "netcdf")
TABLE_ROWS = 200


def query(dataset: xr.Dataset, condition: str | None, columns: tuple[str, ...] = ()) -> pd.DataFrame:
    """The scenarios for which a condition holds: one row for each method and scenario, in the dataset's order.

    Raises InputError for an unknown name, a wrong unit or a condition that cannot be read.
    """
    dataset = with_components(dataset)
    chosen = _columns(dataset, columns)
    dims = dataset.status.dims
    mask = _mask(dataset, condition)
    where = dict(zip(dims, np.nonzero(mask), strict=True))
    return pd.DataFrame({name: _values(dataset, name, where) for name in chosen})


def query_netcdf(dataset: xr.Dataset, condition: str | None, columns: tuple[str, ...] = ()) -> bytes:
    """The answer to a query as a netCDF file, with what has many values a scenario: profiles and histories."""
    long = [str(name) for name in dataset.data_vars if _is_long(dataset[str(name)])]
    short = tuple(name for name in columns if name not in long)
    asked = [name for name in columns or long if name in long]
    table = query(dataset, condition, short) if short or not columns else pd.DataFrame()
    chosen = _mask(dataset, condition)
    arrays = {name: _long_values(dataset[name], chosen) for name in asked}
    return _as_netcdf(table, arrays, _own_coords(dataset, asked))


def units_of(table: pd.DataFrame) -> dict[str, str]:
    """The SI unit of each column of numbers that has one."""
    numbers = table.select_dtypes("number").columns
    return {str(name): QUANTITIES[str(name)].unit for name in numbers if name in QUANTITIES}


def render(table: pd.DataFrame, form: str) -> bytes:
    """The table in one of the formats of tables."""
    writers = {"table": _as_table, "csv": _as_csv, "json": _as_json, "parquet": _as_parquet}
    return writers[form](table)


def _mask(dataset: xr.Dataset, condition: str | None) -> np.ndarray:
    if condition is None:
        return np.ones(dataset.status.shape, dtype=bool)
    holds = select(dataset, condition)
    extra = [dim for dim in holds.dims if dim not in dataset.status.dims]
    if extra:
        raise InputError(f"'{condition}' varies along {extra[0]}: a condition must give one answer a scenario")
    return holds.broadcast_like(dataset.status).transpose(*dataset.status.dims).values


def _columns(dataset: xr.Dataset, columns: tuple[str, ...]) -> list[str]:
    scenario_dims = set(dataset.status.dims)
    known = [str(name) for name in dataset.variables if set(dataset[name].dims) <= scenario_dims]
    for name in columns:
        if name in dataset.data_vars and _is_long(dataset[name]):
            raise InputError(f"'{name}' has many values a scenario: only --format netcdf has room for them")
        if name not in known:
            raise InputError(f"no column '{name}': {nearest(name, known)}")
    coords = [name for name in known if name in dataset.coords and dataset[name].ndim > 0]
    return list(columns) or [*coords, *(name for name in known if name in dataset.data_vars)]


def _values(dataset: xr.Dataset, name: str, where: dict[Any, np.ndarray]) -> np.ndarray:
    variable = dataset[name]
    values = variable.values[tuple(where[dim] for dim in variable.dims)]
    if variable.ndim == 0:
        values = np.full(len(next(iter(where.values()))), variable.values)
    words = flag_words(variable)
    return np.array(words)[values] if words else values


def _as_table(table: pd.DataFrame) -> bytes:
    from tabulate import tabulate

    units = units_of(table)
    heads = [f"{name}\n[{units[name]}]" if units.get(name, "1") != "1" else name for name in table.columns]
    body = tabulate(table.head(TABLE_ROWS).to_numpy().tolist(), heads, floatfmt=".8g", numalign="right")
    more = (
        f"\n... and {len(table) - TABLE_ROWS} more rows: ask for --format csv to have them all"
        if len(table) > TABLE_ROWS
        else ""
    )
    return f"{body}{more}\n".encode()


def _as_csv(table: pd.DataFrame) -> bytes:
    return table.to_csv(index=False, lineterminator="\n").encode()


def _as_json(table: pd.DataFrame) -> bytes:
    finite = table.astype(object).where(table.notna(), None)
    rows = finite.to_dict("records")
    return (json.dumps({"units": units_of(table), "rows": rows}) + "\n").encode()


def _as_parquet(table: pd.DataFrame) -> bytes:
    buffer = io.BytesIO()
    table.to_parquet(buffer, index=False, engine="pyarrow")
    return buffer.getvalue()


def _is_long(values: xr.DataArray) -> bool:
    return values.name in QUANTITIES and QUANTITIES[str(values.name)].dims not in SHORT


def _long_values(values: xr.DataArray, mask: np.ndarray) -> xr.Variable:
    """The scenarios that were asked for, in the order of the rows of a table."""
    own = QUANTITIES[str(values.name)].dims
    whole = values.transpose(..., *own)
    return xr.Variable(("scenario", *own), whole.values[mask], values.attrs)


def _own_coords(dataset: xr.Dataset, names: list[str]) -> dict[str, xr.Variable]:
    dims = {dim for name in names for dim in QUANTITIES[name].dims}
    return {dim: dataset[dim].variable for dim in OWN_DIMS if dim in dims and dim in dataset.coords}


def _as_netcdf(table: pd.DataFrame, long: dict[str, xr.Variable], coords: dict[str, xr.Variable]) -> bytes:
    dataset = xr.Dataset({name: ("scenario", _plain(table[name])) for name in table.columns} | long, coords)
    for name, unit in units_of(table).items():
        dataset[name].attrs = {"units": unit, "long_name": QUANTITIES[name].meaning}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "query.nc"
        text = {str(name): {"dtype": "S1"} for name, v in dataset.variables.items() if v.dtype.kind == "U"}
        dataset.to_netcdf(path, engine="netcdf4", encoding=text)
        return path.read_bytes()


def _plain(values: pd.Series) -> np.ndarray:
    return values.to_numpy() if values.dtype.kind in "fiu" else values.to_numpy(dtype=str)
