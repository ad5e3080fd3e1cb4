"""Tables of a scene: errors against the reference, tensions by scenario, fates of the scenarios, and what they took."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from cablesim.config.scene import Scene
from cablesim.database.collect import MEASURED_NAMES
from cablesim.database.reading import (
    flag_words,
    magnitude,
    of_method,
    reference_values,
    running_numbers,
    status_words,
    with_components,
    written,
)
from cablesim.files import write_text
from cablesim.quantities import SHORT, quantity
from cablesim.status import Status

# A table that nobody can read is not written row by row: beyond this it becomes statistics, and `query` has the rows.
MOST_ROWS = 10_000
MARKDOWN_ROWS = 40
# What a method can tell of its work, and of what is left over when it is done.
EFFORTS = ("iterations", "steps", "rejected_steps", "rhs_evaluations")
LEFT_OVER = ("closing_error", "static_residual", "energy_error")


def error_table(scene: Scene, dataset: xr.Dataset) -> pd.DataFrame:
    """Absolute and relative error of every method against the reference.

    Of every output but profiles, histories, effort, and what is left over, which is an error already. The error of a
    vector is the length of the difference, that of a list the largest of its sections. Largest, median and 95 % over
    the scenarios that both solved, and where the largest relative error lies.
    """
    rows: list[dict[str, object]] = []
    if scene.reference is None:
        return pd.DataFrame(rows)
    dataset = with_components(dataset)
    stored = [n for n in scene.outputs if quantity(n).dims in SHORT and n not in (*EFFORTS, *LEFT_OVER)]
    for output in scene.reference.columns or stored:
        reference = reference_values(scene.reference, dataset, output)
        for method in scene.methods:
            if method.name == scene.reference.method:
                continue
            values = of_method(dataset[output], method.name)
            rows.append(
                {"method": method.name, "output": output, "unit": quantity(output).unit, **_errors(values, reference)}
            )
    return pd.DataFrame(rows)


def tension_table(dataset: xr.Dataset) -> pd.DataFrame:
    """The tensions by scenario; for very many scenarios their statistics by method."""
    dataset = with_components(dataset)
    names = [name for name in _scalars(dataset) if "tension" in name and quantity(name).unit == "N"]
    if not names:
        return pd.DataFrame()
    if dataset[names[0]].size > MOST_ROWS:
        return _tension_statistics(dataset, names)
    return frame(dataset, [*names, *_flags(dataset)])


def value_table(dataset: xr.Dataset) -> pd.DataFrame:
    """Every output that is one number, and the parts of vectors and lists, by scenario; nothing for very many."""
    dataset = with_components(dataset)
    names = _scalars(dataset)
    return frame(dataset, [*names, *_flags(dataset)]) if names and dataset.status.size <= MOST_ROWS else pd.DataFrame()


def _scalars(dataset: xr.Dataset) -> list[str]:
    """The outputs that are one number per scenario."""
    others = {*_flags(dataset), "iterations", *MEASURED_NAMES}
    return [str(n) for n in dataset.data_vars if n not in others and dataset[n].dims == dataset.status.dims]


def _flags(dataset: xr.Dataset) -> list[str]:
    """The status, and after it the checks."""
    flags = [str(name) for name in dataset.data_vars if flag_words(dataset[name])]
    return ["status", *(name for name in flags if name != "status")]


def status_table(dataset: xr.Dataset) -> pd.DataFrame:
    """How many scenarios of each method met which fate, and the measured time for each."""
    words = status_words(dataset)
    rows = []
    for method in dataset.method.values:
        status = of_method(dataset.status, method).values.ravel()
        counts = np.bincount(status, minlength=len(words))
        run_time = float(of_method(dataset.run_time, method).mean())
        rows.append({"method": str(method), **dict(zip(words, counts.tolist(), strict=True)), "run_time [s]": run_time})
    return pd.DataFrame(rows)


def effort_table(dataset: xr.Dataset) -> pd.DataFrame:
    """Effort and remaining errors of each method over the scenarios that it solved, and where the largest lies."""
    rows = []
    for method in dataset.method.values:
        solved = of_method(dataset.status, method) == Status.ok
        for name in (*EFFORTS, *LEFT_OVER):
            values = of_method(dataset[name], method).where(solved) if name in dataset else solved.where(False)
            found = values.values[np.isfinite(values.values)]
            if (found > 0.0).any():
                spread = {"scenarios": found.size, "median": np.median(found), "largest": found.max()}
                rows.append({"method": str(method), "quantity": name, **spread, "at": _place_of_largest(values)})
    return pd.DataFrame(rows)


def frame(dataset: xr.Dataset, names: list[str]) -> pd.DataFrame:
    """A row for each method and scenario: coordinates, then the named variables; flags as their words."""
    flat = dataset[names].reset_coords(
        [c for c in dataset.coords if c not in dataset.dims and dataset[c].ndim == 0], drop=True
    )
    table = flat.to_dataframe().reset_index()
    for name in names:
        if flag_words(dataset[name]):
            table[name] = np.array(flag_words(dataset[name]))[table[name].to_numpy()]
    leading = [c for c in table.columns if c in flat.coords]
    return table[[*leading, *names]]


def write_table(folder: Path, name: str, table: pd.DataFrame, caption: str) -> None:
    """Write a table as CSV, whole, and as Markdown, in the length that a person reads."""
    if table.empty:
        return
    csv, markdown = folder / f"{name}.csv", folder / f"{name}.md"
    write_text(csv, table.to_csv(index=False, lineterminator="\n"))
    shown = table.head(MARKDOWN_ROWS).map(lambda cell: f"{cell:.6g}" if isinstance(cell, float) else str(cell))
    more = f"\n\n{len(table) - len(shown)} more rows are in `{csv.name}`." if len(table) > len(shown) else ""
    # Printed values keep their zeros: 0.0200 is not 0.02.
    body = shown.to_markdown(index=False, disable_numparse=True)
    write_text(markdown, f"{caption}\n\n{body}{more}\n")


def _errors(values: xr.DataArray, reference: xr.DataArray) -> dict[str, object]:
    absolute = magnitude(values - reference)
    relative = absolute / magnitude(reference)
    if "section" in relative.dims:
        absolute, relative = absolute.max("section"), relative.max("section")
    found = absolute.values[np.isfinite(absolute.values)]
    found_relative = relative.values[np.isfinite(relative.values)]
    return {
        "scenarios": found.size,
        **_spread("absolute", found),
        **_spread("relative", found_relative),
        "worst at": _place_of_largest(relative),
    }


def _spread(kind: str, values: np.ndarray) -> dict[str, float]:
    levels = {"max": 1.0, "median": 0.5, "95 %": 0.95}
    return {f"{kind} {n}": float(np.quantile(values, q)) if values.size else float("nan") for n, q in levels.items()}


def _place_of_largest(relative: xr.DataArray) -> str:
    values = relative.values
    if not np.isfinite(values).any():
        return ""
    return place(relative, int(np.nanargmax(np.where(np.isfinite(values), values, -1.0))))


def place(values: xr.DataArray, position: int) -> str:
    """The coordinates of one value, whose position is that in the flattened array."""
    where = np.unravel_index(position, values.shape)
    point = values.isel(dict(zip(values.dims, (int(i) for i in where), strict=True)))
    told = [c for c in point.coords if c not in ("row", "key", "rounding") and values[c].ndim > 0]
    coords = [c for c in told if point[c].notnull()]
    named = [c for c in coords if c not in running_numbers(values)] or coords
    return ", ".join(f"{name}={written(point[name], digits=12)}" for name in named)


def _tension_statistics(dataset: xr.Dataset, names: list[str]) -> pd.DataFrame:
    return pd.DataFrame(list(_statistics_rows(dataset, names)))


def _statistics_rows(dataset: xr.Dataset, names: list[str]) -> Iterator[dict[str, object]]:
    levels = (0.0, 0.05, 0.5, 0.95, 1.0)
    for method in dataset.method.values:
        for name in names:
            values = of_method(dataset[name], method).values
            values = values[np.isfinite(values)]
            spread = np.quantile(values, levels) if values.size else np.full(len(levels), np.nan)
            heads = ("smallest", "5 %", "median", "95 %", "largest")
            yield {
                "method": str(method),
                "tension": name,
                "unit": quantity(name).unit,
                "solved": values.size,
                **dict(zip(heads, spread, strict=True)),
            }
