"""Interactive curves of formulas along an axis of the design."""

from typing import Any

import altair as alt
import numpy as np
import xarray as xr
from matplotlib.colors import to_hex

from cablesim.config.figure_file import Figure
from cablesim.config.scene import Scene
from cablesim.database.reading import select
from cablesim.report.drawing import evaluated, point_in_words, shades
from cablesim.report.page.columns import Columns, column
from cablesim.report.page.panel import (
    Panel,
    coloured,
    dashed,
    fading,
    hollow,
    joined,
    movable,
    printed_points,
    rows,
    scale,
    scenario_numbers,
)


def curve_panels(scene: Scene, dataset: xr.Dataset, figure: Figure) -> list[Panel]:
    """One panel: a line for each formula, or for each point of an axis, and the points of a printed table."""
    settings = figure.settings
    chosen = dataset.isel(settings["position"])
    numbers = scenario_numbers(dataset).isel(settings["position"])
    if "where" in settings:
        chosen = chosen.where(select(chosen, settings["where"]))
    draw = _along if settings["each"] else _formulas
    data, channels = draw(chosen, numbers, figure)
    x, y = (_axis(figure, name, data[name]) for name in ("x", "y"))
    tooltip = [
        alt.Tooltip("series:N", title=" "),
        alt.Tooltip("x:Q", title=figure.label("x").plain, format="~g"),
        alt.Tooltip("y:Q", title=figure.label("y").plain or "value", format="~g"),
    ]
    choice, opacity = fading()
    marks = settings["draw"] == "marks"
    base = rows().encode(x=x, y=y, opacity=opacity, tooltip=tooltip, **channels)
    line = base.mark_point(filled=True, size=40) if marks else base.mark_line(strokeWidth=1.8).encode(order="node:Q")
    layers = [movable(line.add_params(choice))]
    if not marks:
        # What the pointer finds on a line.
        layers.append(rows().mark_circle(size=70, opacity=0).encode(x=x, y=y, tooltip=tooltip))
    tables = {"rows": data}
    if settings["points"] is not None:
        tables["points"] = printed_points(figure)
        layers.append(hollow(tables["points"]).encode(x=x, y=y))
    return [Panel(alt.layer(*layers), tables)]


def _axis(figure: Figure, name: str, values: list[Any]) -> Any:
    channel = alt.X if name == "x" else alt.Y
    return channel(f"{name}:Q", title=figure.label(name).plain, **scale(values, name in figure.settings["log"]))


def _formulas(dataset: xr.Dataset, numbers: xr.DataArray, figure: Figure) -> tuple[Columns, dict[str, Any]]:
    """One line for each formula, told apart by colour."""
    lines = [
        _line(dataset, numbers, figure, label or figure.label("y").plain, formula)
        for label, formula in figure.settings["y"].items()
    ]
    return joined(lines), {"color": coloured([line["series"][0] for line in lines if line["series"]])}


def _along(dataset: xr.Dataset, numbers: xr.DataArray, figure: Figure) -> tuple[Columns, dict[str, Any]]:
    """A line for each point of an axis, told apart by shade; formulas by dashes."""
    settings, called = figure.settings, figure.label("each")
    axis = settings["each"]
    lines, series = [], {}
    for i, shade in enumerate(map(to_hex, shades(dataset.sizes[axis]))):
        part, own = dataset.isel({axis: i}), numbers.isel({axis: i})
        value = f"{called.plain_words} = {point_in_words(part, axis, called, called.shown_unit)}"
        series[value] = shade
        for label, formula in settings["y"].items():
            line = _line(part, own, figure, value, formula)
            lines.append({**line, "formula": [label] * len(line["x"])})
    channels = {"color": coloured(list(series), list(series.values()))}
    if len(settings["y"]) > 1:
        channels["strokeDash"] = dashed(list(settings["y"]), list(range(len(settings["y"]))), "formula:N")
    return joined(lines), channels


def _line(dataset: xr.Dataset, numbers: xr.DataArray, figure: Figure, series: str, formula: str) -> Columns:
    """The points of one line: places where there is no value part it."""
    sides = ((figure.settings["x"], figure.label("x")), (formula, figure.label("y")))
    along, across = xr.broadcast(*(evaluated(dataset, *side) for side in sides))
    found = numbers.broadcast_like(along.isel(method=0, drop=True) if "method" in along.dims else along)
    x, y = along.values.ravel(), across.values.ravel()
    for name, values in (("x", x), ("y", y)):
        if name in figure.settings["log"]:
            x, y = np.where(values > 0.0, x, np.nan), np.where(values > 0.0, y, np.nan)
    return {
        "x": column(x),
        "y": column(y),
        "series": [series] * x.size,
        "node": list(range(x.size)),
        "scenario": column(found.values),
    }
