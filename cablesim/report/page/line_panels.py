"""Interactive pictures of the line itself: profiles, and views of a line in space."""

from typing import Any

import xarray as xr

from cablesim.config.figure_file import Figure
from cablesim.config.figure_parts import Shape
from cablesim.config.scene import Scene
from cablesim.report.drawing import styled
from cablesim.report.page.columns import Columns
from cablesim.report.page.panel import (
    Panel,
    box,
    fading,
    height_over_width,
    hollow,
    joined,
    printed_points,
    rows,
    scenario_number,
    styled_lines,
)
from cablesim.report.page.places import PLACE, extent, factors, framed, in_view, place_columns, titles
from cablesim.report.page.section_layers import section_layers
from cablesim.report.shapes import own_stretch

SPATIAL_VIEWS = {"xz": "from the side", "yz": "along the stream", "xy": "from above"}


def profile_panels(scene: Scene, dataset: xr.Dataset, figure: Figure) -> list[Panel]:
    """Shapes of the line; scales are equal but for the factor that heights are drawn too large by."""
    settings = figure.settings
    in_sections = settings["colours"] is not None
    drawn = [
        section_layers(dataset, panel.shapes, figure)
        if in_sections
        else _lines(dataset, panel.shapes, figure, settings["view"], "xy")
        for panel in settings["panels"]
    ]
    printed = printed_points(figure)
    shared = settings["stretch"] is not None
    common = box(*extent([printed, *(columns for _, data in drawn for columns in data.values())]))
    panels = []
    for panel, (layers, data) in zip(settings["panels"], drawn, strict=True):
        ranges = common if shared else box(*extent([printed, *data.values()]))
        stretch = settings["stretch"] or own_stretch(*(high - low for low, high in ranges))
        if printed["x"]:
            layers, data = [*layers, hollow(printed)], {**data, "points": printed}
        heading = panel.title + ("" if stretch == 1.0 else f" (heights × {stretch:g})")
        chart = framed(layers, ranges, titles(figure, "xy"))
        panels.append(Panel(chart, data, heading, aspect=height_over_width(ranges, stretch)))
    return panels


def spatial_panels(scene: Scene, dataset: xr.Dataset, figure: Figure) -> list[Panel]:
    """Lines in space from three sides."""
    panels = []
    for view, words in SPATIAL_VIEWS.items():
        layers, data = _lines(dataset, figure.settings["shapes"], figure, view, view)
        ranges = box(*extent(data.values()))
        chart = framed(layers, ranges, titles(figure, view))
        panels.append(Panel(chart, data, words, aspect=height_over_width(ranges)))
    return panels


def _lines(
    dataset: xr.Dataset, shapes: list[Shape], figure: Figure, view: str, sides: str
) -> tuple[list[Any], dict[str, Columns]]:
    """A line for each curve; `sides` are what the labels of the view's components are called by."""
    styles, scaled = styled(shapes, figure.settings["methods"]), factors(figure, sides)
    parts = [
        place_columns(
            in_view(style.line(dataset).profile, view, scaled), style.label, scenario_number(dataset, style.shape)
        )
        for style in styles
    ]
    choice, opacity = fading()
    line = rows().mark_line(strokeWidth=1.8).encode(x="x:Q", y="y:Q", order="node:Q", opacity=opacity, tooltip=PLACE)
    return [line.encode(**styled_lines(styles)).add_params(choice)], {"rows": joined(parts)}
