"""Interactive curves of formulas along an axis of the design."""

from typing import Any

import altair as alt
import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.colors import to_hex

from cablesim.config.figure_file import Figure
from cablesim.config.scene import Scene
from cablesim.database.reading import evaluate, select
from cablesim.quantities import component_names
from cablesim.report.drawing import value_in_words, word
from cablesim.report.page.columns import Columns, column
from cablesim.report.page.panel import (
    DASHES,
    Panel,
    coloured,
    fading,
    hollow,
    joined,
    movable,
    printed_points,
    rows,
    scale,
    scenario_numbers,
)
from cablesim.report.page.sides import side


def curve_panels(scene: Scene, dataset: xr.Dataset, figure: Figure) -> list[Panel]:
    """One panel: a line for each formula, or for each point of an axis, and the points of a printed table."""
    settings = figure.settings
    chosen = dataset.isel(settings["position"])
    numbers = scenario_numbers(dataset).isel(settings["position"])
    if "where" in settings:
        chosen = chosen.where(select(chosen, settings["where"]))
    draw = _along if settings["each"] else _formulas
    data, channels = draw(chosen, numbers, settings)
    x, y = (_axis(settings, name, data[name]) for name in ("x", "y"))
    tooltip = [
        alt.Tooltip("series:N", title=" "),
        alt.Tooltip("x:Q", title=side(settings, "x"), format="~g"),
        alt.Tooltip("y:Q", title=title(settings, "y") or "value", format="~g"),
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
        tables["points"] = printed_points(settings["points"])
        layers.append(hollow(tables["points"]).encode(x=x, y=y))
    return [Panel(alt.layer(*layers), tables)]


def _axis(settings: dict[str, Any], name: str, values: list[Any]) -> Any:
    channel = alt.X if name == "x" else alt.Y
    return channel(f"{name}:Q", title=title(settings, name), **scale(values, name in settings["log"]))


def title(settings: dict[str, Any], name: str) -> str:
    """What stands at a side: nothing where several formulas share it and the scene has no words for them."""
    if name == "x" or "y_label" in settings:
        return side(settings, name)
    formulas = list(settings["y"].values())
    return side({"y": formulas[0]}, "y") if len(formulas) == 1 else ""


def _formulas(dataset: xr.Dataset, numbers: xr.DataArray, settings: dict[str, Any]) -> tuple[Columns, dict[str, Any]]:
    """One line for each formula, told apart by colour."""
    lines = [
        _line(dataset, numbers, settings, label or side({"y": formula}, "y"), formula)
        for label, formula in settings["y"].items()
    ]
    return joined(lines), {"color": coloured([line["series"][0] for line in lines if line["series"]])}


def _along(dataset: xr.Dataset, numbers: xr.DataArray, settings: dict[str, Any]) -> tuple[Columns, dict[str, Any]]:
    """A line for each point of an axis, told apart by shade; formulas by dashes."""
    axis = settings["each"]
    called = settings.get("each_label", word(axis))
    shades = [to_hex(shade) for shade in plt.get_cmap("viridis")(np.linspace(0.0, 0.92, dataset.sizes[axis]))]
    lines, series = [], {}
    for i, shade in enumerate(shades):
        part, own = dataset.isel({axis: i}), numbers.isel({axis: i})
        value = f"{called} = {', '.join(value_in_words(part[name]) for name in component_names(axis))}"
        series[value] = shade
        for label, formula in settings["y"].items():
            line = _line(part, own, settings, value, formula)
            lines.append({**line, "formula": [label] * len(line["x"])})
    channels = {"color": coloured(list(series), list(series.values()))}
    if len(settings["y"]) > 1:
        channels["strokeDash"] = alt.StrokeDash(
            "formula:N",
            sort=None,
            scale=alt.Scale(domain=list(settings["y"]), range=[DASHES[i % len(DASHES)] for i in range(len(lines))]),
            legend=alt.Legend(title=None, symbolType="stroke"),
        )
    return joined(lines), channels


def _line(dataset: xr.Dataset, numbers: xr.DataArray, settings: dict[str, Any], series: str, formula: str) -> Columns:
    """The points of one line: places where there is no value part it."""
    along, across = xr.broadcast(evaluate(dataset, settings["x"]), evaluate(dataset, formula))
    found = numbers.broadcast_like(along.isel(method=0, drop=True) if "method" in along.dims else along)
    x, y = along.values.ravel(), across.values.ravel()
    for name, values in (("x", x), ("y", y)):
        if name in settings["log"]:
            x, y = np.where(values > 0.0, x, np.nan), np.where(values > 0.0, y, np.nan)
    return {
        "x": column(x),
        "y": column(y),
        "series": [series] * x.size,
        "node": list(range(x.size)),
        "scenario": column(found.values),
    }
