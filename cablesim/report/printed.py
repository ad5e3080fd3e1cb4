"""Printed tables of a scene, in the layout that its file asks for: pages in Markdown, and the same numbers as CSV."""

import math
from collections.abc import Iterator
from pathlib import Path

import pandas as pd
import xarray as xr

from cablesim import units
from cablesim.config.layout_file import PrintedTable
from cablesim.config.rehearsal import METHOD
from cablesim.config.scene import Scene
from cablesim.database.reading import evaluate, of_only_method, select, with_components
from cablesim.files import write_text

NO_SOLUTION = "-"


def write_printed_tables(folder: Path, scene: Scene, dataset: xr.Dataset) -> None:
    """Write every printed table as one Markdown file and one CSV file."""
    for printed in scene.printed:
        table = printed_table(printed, dataset)
        stem = f"{scene.name}_{printed.name}"
        write_text(folder / f"{stem}.csv", table.to_csv(index=False, lineterminator="\n"))
        write_text(folder / f"{stem}.md", "\n\n".join(_pages(scene, printed, table)) + "\n")


def printed_table(printed: PrintedTable, dataset: xr.Dataset) -> pd.DataFrame:
    """The table as text: what names a row in front, then a column for each formula. Rows without an answer are out."""
    table = _values(printed, dataset)
    columns = list(printed.columns)
    table = table[table[columns].notna().any(axis=1)]
    if printed.across is not None:
        table = _spread(printed, table)
        columns = [name for name in table.columns if name not in printed.heads]
    for name in columns:
        table[name] = [_digits(value, printed.digits) for value in table[name]]
    for name in (*printed.pages, printed.rows):
        table[name] = [_short(value) for value in table[name]]
    return table.rename(columns={name: _head(name, printed) for name in table.columns})


def _values(printed: PrintedTable, dataset: xr.Dataset) -> pd.DataFrame:
    """A row for each scenario: what names it, and its cells, in the units of print."""
    dataset = with_components(dataset)
    shown = dataset.where(select(dataset, printed.where)) if printed.where else dataset
    chosen = shown.isel(printed.position)
    heads = {name: chosen[name] for name in printed.heads}
    cells = {name: evaluate(chosen, formula) for name, formula in printed.columns.items()}
    if METHOD not in printed.heads:
        cells = {name: of_only_method(value) for name, value in cells.items()}
    arrays = xr.broadcast(*heads.values(), *cells.values())
    table = pd.DataFrame({name: array.values.ravel() for name, array in zip({**heads, **cells}, arrays, strict=True)})
    for name, unit in printed.units.items():
        table[name] /= units.factor(unit, str(printed.base_unit(name)))
    return table


def _spread(printed: PrintedTable, table: pd.DataFrame) -> pd.DataFrame:
    """The columns once for each value of the parameter that runs across."""
    across = str(printed.across)
    wide = table.pivot(index=[*printed.pages, printed.rows], columns=across, values=list(printed.columns))
    pairs = wide.columns.to_frame(index=False).to_numpy()
    wide.columns = pd.Index([f"{_head(name, printed)}, {_place(across, _short(at), printed)}" for name, at in pairs])
    return wide.reset_index()


def _pages(scene: Scene, printed: PrintedTable, table: pd.DataFrame) -> Iterator[str]:
    yield f"# {scene.title}"
    heads = [_head(name, printed) for name in printed.pages]
    if not heads:
        yield _markdown(table)
        return
    for _, page in table.groupby(heads, sort=False):
        values = page[heads].iloc[0]
        yield "## " + ", ".join(_place(n, v, printed) for n, v in zip(printed.pages, values, strict=True))
        yield _markdown(page.drop(columns=heads))


def _markdown(table: pd.DataFrame) -> str:
    return str(table.to_markdown(index=False, disable_numparse=True, stralign="right"))


def _head(name: str, printed: PrintedTable) -> str:
    """A column's head with its unit, as tables beside scenes have it: `angle [deg]`."""
    unit = printed.unit(name)
    return f"{name} [{unit}]" if unit else name


def _place(name: str, value: str, printed: PrintedTable) -> str:
    """A parameter and its value: `critical angle 30 deg`."""
    return f"{name.replace('_', ' ')} {value} {printed.unit(name)}".strip()


def _digits(value: float, digits: int) -> str:
    """A number with all its digits, zeros at the end too; a missing one as a dash."""
    return NO_SOLUTION if pd.isna(value) else f"{value:#.{digits}g}".rstrip(".")


def _short(value: object) -> str:
    """A value of a parameter, without the rounding error that a change of units may leave."""
    if isinstance(value, float):
        return NO_SOLUTION if math.isnan(value) else f"{value:.10g}"
    return str(value)
