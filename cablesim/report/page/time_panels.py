"""Interactive histories: tension against time."""

from typing import Any

import altair as alt
import numpy as np
import xarray as xr

from cablesim.config.figure_file import Figure
from cablesim.config.scene import Scene
from cablesim.report.drawing import NEWTONS_PER_KILONEWTON, Styled, styled
from cablesim.report.page.columns import Columns, column
from cablesim.report.page.panel import Panel, fading, joined, movable, rows, scenario_numbers, styled_lines

HEIGHT = 160
# How far the scale reaches beside the highest tension.
ABOVE = 1.04


def history_panels(scene: Scene, dataset: xr.Dataset, figure: Figure) -> list[Panel]:
    """Panels with the same scales."""
    settings, panels = figure.settings, []
    numbers = scenario_numbers(dataset)
    title = settings.get("y_label", f"tension at the {settings['place']} [kN]")
    drawn = []
    for panel in settings["panels"]:
        styles = styled(panel.shapes, settings["methods"])
        drawn.append((panel.title, styles, joined([_line(dataset, one, numbers, settings) for one in styles])))
    highest = max((t for *_, data in drawn for t in data["y"] if t is not None), default=1.0)
    for heading, styles, data in drawn:
        choice, opacity = fading()
        line = rows().mark_line(strokeWidth=1.4)
        chart = line.encode(
            x=alt.X("x:Q", title=settings.get("x_label", "time [s]"), scale=alt.Scale(zero=False, nice=False)),
            y=alt.Y("y:Q", title=title, scale=alt.Scale(domain=[0, ABOVE * highest], nice=False)),
            opacity=opacity,
            tooltip=[alt.Tooltip("series:N", title=" "), "x:Q", alt.Tooltip("y:Q", format=".4~g")],
            **styled_lines(styles),
        )
        panels.append(Panel(movable(chart.add_params(choice)), {"rows": data}, heading, HEIGHT))
    return panels


def _line(dataset: xr.Dataset, style: Styled, numbers: xr.DataArray, settings: dict[str, Any]) -> Columns:
    line = style.line(dataset)
    times = line.history_time.values
    shown = (times >= (settings["from"] or 0.0)) & (times <= (settings["to"] or np.inf))
    tension = line.history.sel(place=settings["place"]).values[shown] / NEWTONS_PER_KILONEWTON
    number = int(numbers.isel(style.shape.position).item())
    return {
        "x": column(times[shown]),
        "y": column(tension),
        "series": [style.label] * tension.size,
        "scenario": [number] * tension.size,
    }
