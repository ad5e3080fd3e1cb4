"""Interactive pictures of the line in waves: the path of its middle, and the line through the last period."""

from collections.abc import Iterator
from typing import Any

import altair as alt
import numpy as np
import xarray as xr

from cablesim.config.figure_file import Figure
from cablesim.config.scene import Scene
from cablesim.report.colours import PALETTE
from cablesim.report.drawing import styled
from cablesim.report.page.columns import Columns, column
from cablesim.report.page.panel import (
    Panel,
    box,
    fading,
    height_over_width,
    joined,
    rows,
    scenario_number,
    styled_lines,
)
from cablesim.report.page.places import PLACE, extent, factors, framed, in_view, place_columns, titles
from cablesim.report.snapshots import SLACK, Motion, motions_of

REST = {"color": "#222222", "strokeDash": [5, 4], "strokeWidth": 1.2}
FAINT = 0.08


def orbit_panels(scene: Scene, dataset: xr.Dataset, figure: Figure) -> list[Panel]:
    """The path of the middle of the line through the last period, closed, around the place at rest."""
    settings, parts = figure.settings, []
    styles = styled(settings["shapes"], settings["methods"])
    for style in styles:
        path = in_view(style.line(dataset).orbit, settings["view"], factors(figure, "xy"))
        closed = np.concatenate([path, path[:, :1]], axis=1)
        parts.append(place_columns(closed, style.label, scenario_number(dataset, style.shape)))
    data: dict[str, Columns] = {"rows": joined(parts), "rest": {"x": [0.0], "y": [0.0]}}
    ranges = box(*extent(data.values()))
    choice, opacity = fading()
    path = rows().mark_line(point=True).encode(x="x:Q", y="y:Q", order="node:Q", opacity=opacity, tooltip=PLACE)
    rest = rows("rest").mark_point(shape="cross", size=90, color="black", filled=True).encode(x="x:Q", y="y:Q")
    layers = [path.encode(**styled_lines(styles)).add_params(choice), rest]
    return [Panel(framed(layers, ranges, titles(figure, "xy")), data, aspect=height_over_width(ranges))]


def snapshot_panels(scene: Scene, dataset: xr.Dataset, figure: Figure) -> list[Panel]:
    """The line at the phases of the last period, each element in the colour of its tension; dashed at rest."""
    settings = figure.settings
    drawn = list(_motions(dataset, figure))
    ranges = box(*extent(columns for data in drawn for columns in data.values()))
    highest = max((t for data in drawn for t in data["rows"]["tension"] if t is not None), default=1.0)
    elements = _elements(figure, highest, dataset.sizes["phase"])
    layers = [elements, rows("rest").mark_line(**REST).encode(x="x:Q", y="y:Q", order="node:Q")]
    chart = framed(layers, ranges, titles(figure, "xy"))
    moved = f" (motion × {settings['magnify']:g})" if settings["magnify"] != 1.0 else ""
    aspect = height_over_width(ranges)
    return [
        Panel(chart, data, panel.title + moved, aspect=aspect)
        for panel, data in zip(settings["panels"], drawn, strict=True)
    ]


def _elements(figure: Figure, highest: float, phases: int) -> Any:
    """Elements of all phases, or of the one that the slider is at; orange where there is next to no tension."""
    title = figure.label("value").plain
    legend = alt.Legend(title=title, direction="horizontal")
    shades = alt.Color("tension:Q", scale=alt.Scale(scheme="viridis", domain=[0, highest]), legend=legend)
    colour = alt.condition(f"datum.tension < {SLACK * highest:.6g}", alt.value(PALETTE[1]), shades)
    slider = alt.binding_range(min=0, max=phases, step=1, name="moment of the period (0: all) ")
    moment = alt.param(name="moment", value=0, bind=slider)
    shown = alt.condition("moment === 0 || datum.moment === moment", alt.value(1.0), alt.value(FAINT))
    tooltip = [alt.Tooltip("tension:Q", title=title, format=".4~g"), alt.Tooltip("phase:Q", format=".2f")]
    rule = rows().mark_rule(strokeWidth=1.6).encode(x="x:Q", y="y:Q", x2="x2", y2="y2")
    return rule.encode(color=colour, opacity=shown, tooltip=tooltip).add_params(moment)


def _motions(dataset: xr.Dataset, figure: Figure) -> Iterator[dict[str, Columns]]:
    shapes = [shape for panel in figure.settings["panels"] for shape in panel.shapes]
    for motion, shape in zip(motions_of(dataset, figure), shapes, strict=True):
        yield _columns(motion, scenario_number(dataset, shape))


def _columns(motion: Motion, number: int) -> dict[str, Columns]:
    """The elements of a line at every phase, and the line at rest."""
    rest, places, tension = motion
    phases, elements = places.shape[0], places.shape[1] - 1
    return {
        "rows": {
            "x": column(places[:, :-1, 0]),
            "y": column(places[:, :-1, 1]),
            "x2": column(places[:, 1:, 0]),
            "y2": column(places[:, 1:, 1]),
            "tension": column(0.5 * (tension[:, :-1] + tension[:, 1:]), 4),
            "moment": np.repeat(np.arange(1, phases + 1), elements).tolist(),
            "phase": column(np.repeat(np.arange(phases) / phases, elements), 4),
            "scenario": [number] * (phases * elements),
        },
        "rest": {"x": column(rest[:, 0]), "y": column(rest[:, 1]), "node": list(range(len(rest)))},
    }
