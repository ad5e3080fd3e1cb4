"""Printed tables of a scene, in the layout that its file asks for: pages in Markdown, and the same numbers as CSV."""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
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
    across = list(table[printed.across].unique()) if printed.across else []
    table = table[table[columns].notna().any(axis=1)]
    for name in columns:
        table[name] = [_cell(value, printed.digits, printed.decimals.get(name)) for value in table[name]]
    if printed.across is not None:
        table = _spread(printed, table, [at for at in across if at in set(table[printed.across])])
    for name in (*printed.pages, printed.rows):
        table[name] = [_short(value) for value in table[name]]
    return table.rename(columns={name: _head(name, printed) for name in table.columns})


def _values(printed: PrintedTable, dataset: xr.Dataset) -> pd.DataFrame:
    """A row for each scenario: what names it, and its cells, in the units of print."""
    dataset = with_components(dataset)
    chosen = dataset.isel(printed.position)
    heads = {name: chosen[name] for name in printed.heads}
    if printed.source and printed.names:
        names = np.array(printed.source.columns[printed.names])[chosen.row.values]
        heads[printed.rows] = xr.DataArray(names, dims=printed.rows)
    cells = {name: evaluate(chosen, formula, printed.source) for name, formula in printed.columns.items()}
    if printed.where:
        kept = select(chosen, printed.where, printed.source)
        cells = {name: value.where(kept) for name, value in cells.items()}
    if METHOD not in printed.heads:
        cells = {name: of_only_method(value) for name, value in cells.items()}
    arrays = xr.broadcast(*heads.values(), *cells.values())
    table = pd.DataFrame({name: array.values.ravel() for name, array in zip({**heads, **cells}, arrays, strict=True)})
    for name, unit in printed.units.items():
        table[name] /= units.factor(unit, str(printed.base_unit(name)))
    return table


def _spread(printed: PrintedTable, table: pd.DataFrame, values: list[object]) -> pd.DataFrame:
    """The columns once for each value of the parameter that runs across, in the order of the scene."""
    across, lines = str(printed.across), [*printed.pages, printed.rows]
    wide = table.pivot(index=lines, columns=across, values=list(printed.columns))
    wide = wide.reindex(columns=pd.MultiIndex.from_product([list(printed.columns), values]))
    wide = wide.reindex(table.set_index(lines).index.unique()).fillna(NO_SOLUTION)
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
    if name == printed.rows and printed.names:
        return printed.names
    unit, called = printed.unit(name), printed.words.get(name, name)
    return f"{called} [{unit}]" if unit else called


def _place(name: str, value: str, printed: PrintedTable) -> str:
    """A parameter and its value: `critical angle 30 deg`."""
    return f"{printed.words.get(name, name.replace('_', ' '))} {value} {printed.unit(name)}".strip()


def _cell(value: float, digits: int, decimals: int | None) -> str:
    """A number with all its digits or decimals, zeros at the end too; a missing one as a dash."""
    if pd.isna(value):
        return NO_SOLUTION
    if decimals is None:
        return f"{value:#.{digits}g}".rstrip(".")
    text = f"{value:.{decimals}f}"
    return text if float(text) else text.lstrip("-")


def _short(value: object) -> str:
    """A value of a parameter, without the rounding error that a change of units may leave."""
    if isinstance(value, float):
        return NO_SOLUTION if math.isnan(value) else f"{value:.10g}"
    return str(value)
