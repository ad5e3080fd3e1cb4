"""Write the answer to a query: a table for people, CSV, JSON and Parquet piece by piece, netCDF and Excel whole."""

import json
import tempfile
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from importlib.util import find_spec
from pathlib import Path
from typing import IO, Any

import numpy as np
import pandas as pd
import xarray as xr

from cablesim.database.query import NO_FILES, Answer, Request, ask, ask_long
from cablesim.errors import EnvironmentFault, InputError, nearest
from cablesim.quantities import OWN_DIMS, QUANTITIES

TABLE_ROWS = 200
EXCEL_ROWS = 2**20
# Formats that are not for a terminal.
BINARY = ("parquet", "netcdf", "excel")


Long = dict[str, xr.Variable]


def prepare(
    datasets: Mapping[str, xr.Dataset],
    request: Request,
    form: str,
    skipping: bool,
    files: Mapping[str, Path] = NO_FILES,
) -> tuple[Answer, Callable[[IO[bytes], bool], int]]:
    """The answer to a request and what writes it to a stream, with units or without. Raises as `ask` does."""
    if form not in FORMATS:
        raise InputError(f"unknown format '{form}': {nearest(form, FORMATS)}")
    if form != "netcdf":
        answer = ask(datasets, request, skipping, files)
        return answer, lambda stream, units: WRITERS[form](answer, stream, units)
    if len(datasets) > 1:
        raise InputError("netcdf takes one scene at a time: ask for csv, json or parquet")
    name, dataset = next(iter(datasets.items()))
    answer, long = ask_long(dataset, request, files.get(name))
    return answer, lambda stream, units: write_netcdf(answer, long, dataset, stream)


def write_table(answer: Answer, stream: IO[bytes], units: bool = True) -> int:
    """For people: the first rows, and how many more there are. Returns the number of rows, as all writers do."""
    from tabulate import tabulate

    rows, shown = 0, []
    for piece in answer.pieces:
        shown += piece.head(TABLE_ROWS - min(rows, TABLE_ROWS)).to_numpy().tolist()
        rows += len(piece)
    told = {name: unit for name, unit in answer.units.items() if unit != "1" and units}
    heads = [f"{name}\n[{told[name]}]" if name in told else name for name in answer.columns]
    body = tabulate(shown, heads, floatfmt=".8g", numalign="right")
    more = (
        f"\n... and {rows - TABLE_ROWS} more rows: ask for --format csv to have them all" if rows > TABLE_ROWS else ""
    )
    stream.write(f"{body}{more}\n".encode())
    return rows


def write_csv(answer: Answer, stream: IO[bytes], units: bool = True) -> int:
    """The names of the columns, their units unless these are unwanted, and a line a scenario."""
    rows = 0
    heads = _heads(answer, units)
    stream.write("".join(",".join(head) + "\n" for head in heads).encode())
    for number, lines in answer.each(_csv_lines):
        rows += number
        stream.write(lines)
    return rows


def _csv_lines(piece: pd.DataFrame) -> tuple[int, bytes]:
    """How many lines, and the lines."""
    return len(piece), piece.to_csv(index=False, header=False, lineterminator="\n").encode()


def write_json(answer: Answer, stream: IO[bytes], units: bool = True) -> int:
    """One object: units by column, and an object for each scenario, with null for what is no number."""
    rows = 0
    stream.write(f'{{"units": {json.dumps(answer.units if units else {})}, "rows": ['.encode())
    for number, objects in answer.each(_json_objects):
        stream.write(b", " + objects if rows and number else objects)
        rows += number
    stream.write(b"]}\n")
    return rows


def _json_objects(piece: pd.DataFrame) -> tuple[int, bytes]:
    """How many objects, and the objects with commas between them."""
    return len(piece), ", ".join(json.dumps(row) for row in _with_none(piece).to_dict("records")).encode()


def write_parquet(answer: Answer, stream: IO[bytes], units: bool = True) -> int:
    """A Parquet file; the unit of a column is in the metadata of its field."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    rows = 0
    with ExitStack() as open_files:
        writer = None
        for piece in answer.pieces:
            table = pa.Table.from_pandas(piece, preserve_index=False).replace_schema_metadata(None)
            if units:
                table = table.cast(pa.schema([_with_unit(field, answer.units) for field in table.schema]))
            writer = writer or open_files.enter_context(pq.ParquetWriter(stream, table.schema))
            writer.write_table(table)
            rows += len(piece)
    return rows


def write_excel(answer: Answer, stream: IO[bytes], units: bool = True) -> int:
    """One sheet. Raises InputError for more rows than a sheet has, EnvironmentFault where openpyxl is missing."""
    if find_spec("openpyxl") is None:
        raise EnvironmentFault("Excel files need the package openpyxl: pip install cablesim[excel]")
    import openpyxl

    book = openpyxl.Workbook(write_only=True)
    heads = _heads(answer, units)
    sheet = book.create_sheet("scenarios")
    for head in heads:
        sheet.append(head)
    rows = 0
    for piece in answer.pieces:
        rows += len(piece)
        if rows + len(heads) > EXCEL_ROWS:
            sheet.close()
            raise InputError(f"a sheet has {EXCEL_ROWS} rows: give a limit, or ask for csv or parquet")
        for row in _with_none(piece).itertuples(index=False):
            sheet.append([_unescaped(cell) for cell in row])
    book.save(stream)
    return rows


def write_netcdf(answer: Answer, long: Long, dataset: xr.Dataset, stream: IO[bytes]) -> int:
    """A netCDF file over `scenario`, with profiles and histories where they are asked for, or where all is."""
    table = answer.table()
    dims = {dim for values in long.values() for dim in values.dims}
    coords = {dim: dataset[dim].variable for dim in OWN_DIMS if dim in dims and dim in dataset.coords}
    found = xr.Dataset({name: ("scenario", _plain(table[name])) for name in table.columns} | long, coords)
    for name, unit in answer.units.items():
        meaning = {"long_name": QUANTITIES[name].meaning} if name in QUANTITIES else {}
        found[name].attrs = {"units": unit, **meaning}
    found.attrs["Conventions"] = "CF-1.11"
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "query.nc"
        text = {str(name): {"dtype": "S1"} for name, v in found.variables.items() if v.dtype.kind == "U"}
        found.to_netcdf(path, engine="netcdf4", encoding=text)
        stream.write(path.read_bytes())
    return found.sizes.get("scenario", 0)


WRITERS: dict[str, Callable[[Answer, IO[bytes], bool], int]] = {
    "table": write_table,
    "csv": write_csv,
    "json": write_json,
    "parquet": write_parquet,
    "excel": write_excel,
}
FORMATS = (*WRITERS, "netcdf")


def _heads(answer: Answer, units: bool) -> list[list[str]]:
    """The lines above the rows: names, and units where they are wanted."""
    names = list(answer.columns)
    return [names, [answer.units.get(name, "") for name in names]] if units else [names]


def _with_none(piece: pd.DataFrame) -> pd.DataFrame:
    """With None for what is no number."""
    return piece.astype(object).where(piece.notna(), None)


def _with_unit(field: Any, units: dict[str, str]) -> Any:
    return field.with_metadata({"units": units[field.name]}) if field.name in units else field


def _unescaped(cell: object) -> object:
    """A cell as it is: text that begins like a formula must not become one."""
    return f"'{cell}" if isinstance(cell, str) and cell[:1] in "=+-@" else cell


def _plain(values: pd.Series) -> np.ndarray:
    return values.to_numpy() if values.dtype.kind in "fiu" else values.to_numpy(dtype=str)
