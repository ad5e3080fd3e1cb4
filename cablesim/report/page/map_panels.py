"""Interactive maps: a value, or the fate of every scenario, over two axes. A cell stands for its scenario."""

import math
from dataclasses import dataclass
from typing import Any

import altair as alt
import numpy as np
import xarray as xr

from cablesim.config.figure_file import Figure
from cablesim.config.scene import Scene
from cablesim.database.reading import of_method, of_only_method, select, status_words
from cablesim.report.colours import STATUS_COLOURS
from cablesim.report.drawing import are_steps, cell_edges, evaluated, word
from cablesim.report.page.columns import Columns, Grid, column
from cablesim.report.page.panel import GREY, Panel, log_format, rows, scale, scenario_numbers
from cablesim.status import Status

# More cells than these are thinned, evenly along both sides.
MOST_CELLS = 10_000
ROW_HEIGHT, PANEL_HEIGHT = 22, 160
# Stands out from every shade and status.
STROKE = "#E7298A"


@dataclass(frozen=True)
class Side:
    """A side of a map: the axis of the design, the points of it that are shown, in ascending order, and their edges."""

    dim: str
    order: np.ndarray
    columns: Columns
    step: int = 1


def map_panels(scene: Scene, dataset: xr.Dataset, figure: Figure) -> list[Panel]:
    """One panel: the value as a colour; grey where there is none."""
    settings = figure.settings
    chosen = dataset.isel(settings["position"])
    value = evaluated(chosen, settings["value"], figure.label("value"))
    if "where" in settings:
        value = value.where(select(chosen, settings["where"]))
    if "value" in settings["log"]:
        value = value.where(value > 0.0)
    sides = _sides(chosen, figure)
    cells = _cells(of_only_method(value), sides)
    title = figure.label("value").plain
    shades = _shades(cells, title, "value" in settings["log"])
    colour = alt.condition("!isValid(datum.value)", alt.value(GREY), shades)
    tooltip = [*_place(figure), alt.Tooltip("value:Q", title=title, format=".4~g")]
    data = _grid(scenario_numbers(dataset).isel(settings["position"]), sides, {"value": column(cells)})
    return [Panel(_rectangles(figure, sides, colour, tooltip), {"rows": data}, _thinned(sides))]


def status_panels(scene: Scene, dataset: xr.Dataset, figure: Figure) -> list[Panel]:
    """A panel for each method, or one with a row for each."""
    settings = figure.settings
    chosen = dataset.isel(settings["position"])
    numbers = scenario_numbers(dataset).isel(settings["position"])
    fates = {method: of_method(chosen.status, method) for method in settings["methods"]}
    colour = _fate_colours(fates, status_words(dataset))
    sides = _sides(chosen, figure)
    words = np.array([word(name) for name in status_words(dataset)])
    grids = {
        method: _grid(numbers, sides, {"status": words[_cells(fate, sides).astype(int)].ravel().tolist()})
        for method, fate in fates.items()
    }
    if len(sides) == 1:
        return [_fates_in_rows(grids, colour, figure, _thinned(sides))]
    chart = _rectangles(figure, sides, colour, [*_place(figure), alt.Tooltip("status:N")])
    titles = {method: ", ".join(filter(None, (word(method), _thinned(sides)))) for method in grids}
    return [Panel(chart, {"rows": grid}, titles[method], PANEL_HEIGHT) for method, grid in grids.items()]


def _fate_colours(fates: dict[str, xr.DataArray], words: tuple[str, ...]) -> Any:
    """The colours of the statuses that occur."""
    found = [words[i] for i in sorted({int(v) for fate in fates.values() for v in np.unique(fate.values)})]
    shades = alt.Scale(domain=[word(name) for name in found], range=[STATUS_COLOURS[Status[name]] for name in found])
    legend = alt.Legend(title=None, symbolType="square", symbolStrokeColor="#888888")
    return alt.Color("status:N", sort=None, scale=shades, legend=legend)


def _fates_in_rows(grids: dict[str, Grid], colour: Any, figure: Figure, thinned: str) -> Panel:
    """A row of cells for each method."""
    fates = [fate for grid in grids.values() for fate in grid["cells"]["status"]]
    along = next(iter(grids.values()))["along"]
    grid = {"along": along, "up": {"method": [word(method) for method in grids]}, "cells": {"status": fates}}
    chart = _marks().encode(
        x=_edge(figure, "x", along),
        x2="x2",
        y=alt.Y("method:N", sort=None, title=None, axis=alt.Axis(labelOverlap=False)),
        color=colour,
        tooltip=[alt.Tooltip("x:Q", title=figure.label("x").plain, format="~g"), "method:N", "status:N"],
    )
    return Panel(chart, {"rows": grid}, thinned, ROW_HEIGHT * len(grids))


def _rectangles(figure: Figure, sides: list[Side], colour: Any, tooltip: list[Any]) -> Any:
    channels = {name: _edge(figure, name, one.columns) for name, one in zip("xy", sides, strict=True)}
    return _marks().encode(x2="x2", y2="y2", color=colour, tooltip=tooltip, **channels)


def _marks() -> Any:
    """Cells, of which the one that was clicked last has an edge."""
    picked = alt.selection_point(name="picked", fields=["scenario"], empty=False)
    edge = alt.condition(picked, alt.value(STROKE), alt.value(None))
    return rows().mark_rect(strokeWidth=2, cursor="pointer", invalid="show").encode(stroke=edge).add_params(picked)


def _thinned(sides: list[Side]) -> str:
    """What is to be said of a map that is thinned."""
    step = sides[0].step
    return f"one in {step} points of each side" if step > 1 else ""


def _edge(figure: Figure, name: str, columns: Columns) -> Any:
    channel = alt.X if name == "x" else alt.Y
    return channel(
        f"{name}1:Q", title=figure.label(name).plain, **scale(columns[name], name in figure.settings["log"], nice=False)
    )


def _place(figure: Figure) -> list[Any]:
    return [alt.Tooltip(f"{name}:Q", title=figure.label(name).plain, format="~g") for name in ("x", "y")]


def _sides(dataset: xr.Dataset, figure: Figure) -> list[Side]:
    """What runs along and, if anything does, up: thin enough for a page."""
    settings = figure.settings
    sides = {name: evaluated(dataset, settings[name], figure.label(name)) for name in "xy" if name in settings}
    step = math.ceil((math.prod(values.size for values in sides.values()) / MOST_CELLS) ** (1 / len(sides)))
    return [_side(name, values, step, name in settings["log"]) for name, values in sides.items()]


def _side(name: str, values: xr.DataArray, step: int, is_logarithmic: bool) -> Side:
    dim = str(values.dims[0])
    order = np.arange(0, values.size, step)
    order = order[np.argsort(values.values[order], kind="stable")]
    ends = cell_edges(values.values[order], is_logarithmic)
    columns = {name: column(values.values[order]), f"{name}1": column(ends[:-1], 7), f"{name}2": column(ends[1:], 7)}
    return Side(dim, order, columns, step)


def _cells(values: xr.DataArray, sides: list[Side]) -> np.ndarray:
    """The values of the cells, row by row."""
    return (
        values.isel({side.dim: side.order for side in sides}).transpose(*(side.dim for side in reversed(sides))).values
    )


def _grid(numbers: xr.DataArray, sides: list[Side], cells: Columns) -> Grid:
    """The rows of a map as its sides and cells. The number of a cell's scenario is the sum of those of its sides."""
    own = np.atleast_2d(_cells(numbers, sides))
    along = {**sides[0].columns, "scenario": own[0].tolist()}
    up = {**sides[1].columns, "scenario": (own[:, 0] - own[0, 0]).tolist()} if len(sides) > 1 else {}
    return {"along": along, "up": up, "cells": cells}


def _shades(values: np.ndarray, title: str, logarithmic: bool) -> Any:
    """Viridis, in steps where the values are a few whole numbers."""
    known = values[np.isfinite(values)]
    numbers = log_format(known) if logarithmic else "~g"
    legend = alt.Legend(title=title, titleLimit=0, format=numbers, direction="horizontal", symbolType="square")
    if are_steps(known) and not logarithmic:
        return alt.Color("value:O", scale=alt.Scale(scheme="viridis"), legend=legend)
    shades = alt.Scale(scheme="viridis", type="log") if logarithmic else alt.Scale(scheme="viridis", zero=False)
    return alt.Color("value:Q", scale=shades, legend=legend)
