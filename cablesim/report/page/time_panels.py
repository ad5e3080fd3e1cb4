"""Interactive histories: tension against time."""

import altair as alt
import numpy as np
import xarray as xr

from cablesim.config.figure_file import Figure
from cablesim.config.scene import Scene
from cablesim.report.drawing import Styled, styled
from cablesim.report.page.columns import Columns, column
from cablesim.report.page.panel import Panel, fading, joined, movable, rows, scenario_number, styled_lines

HEIGHT = 160
# How far the scale reaches beside the highest tension.
ABOVE = 1.04


def history_panels(scene: Scene, dataset: xr.Dataset, figure: Figure) -> list[Panel]:
    """Panels with the same scales."""
    settings, panels = figure.settings, []
    drawn = []
    for panel in settings["panels"]:
        styles = styled(panel.shapes, settings["methods"])
        drawn.append((panel.title, styles, joined([_line(dataset, one, figure) for one in styles])))
    highest = max((t for *_, data in drawn for t in data["y"] if t is not None), default=1.0)
    for heading, styles, data in drawn:
        choice, opacity = fading()
        line = rows().mark_line(strokeWidth=1.4)
        chart = line.encode(
            x=alt.X("x:Q", title=figure.label("x").plain, scale=alt.Scale(zero=False, nice=False)),
            y=alt.Y("y:Q", title=figure.label("y").plain, scale=alt.Scale(domain=[0, ABOVE * highest], nice=False)),
            opacity=opacity,
            tooltip=[alt.Tooltip("series:N", title=" "), "x:Q", alt.Tooltip("y:Q", format=".4~g")],
            **styled_lines(styles),
        )
        panels.append(Panel(movable(chart.add_params(choice)), {"rows": data}, heading, HEIGHT))
    return panels


def _line(dataset: xr.Dataset, style: Styled, figure: Figure) -> Columns:
    settings = figure.settings
    line = style.line(dataset)
    times = line.history_time.values
    shown = (times >= (settings["from"] or 0.0)) & (times <= (settings["to"] or np.inf))
    tension = line.history.sel(place=settings["place"]).values[shown] * figure.label("y").factor
    return {
        "x": column(times[shown] * figure.label("x").factor),
        "y": column(tension),
        "series": [style.label] * tension.size,
        "scenario": [scenario_number(dataset, style.shape)] * tension.size,
    }
