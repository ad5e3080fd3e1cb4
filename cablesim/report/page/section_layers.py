"""Interactive lines of sections: each section in a colour of its own, with the joints and the lowest point marked."""

from typing import Any

import altair as alt
import xarray as xr

from cablesim.config.figure_file import Figure
from cablesim.config.figure_parts import Shape
from cablesim.report.drawing import Styled, styled
from cablesim.report.page.columns import Columns
from cablesim.report.page.panel import coloured, dashed, fading, joined, rows, scenario_number
from cablesim.report.page.places import PLACE, factors, place_columns
from cablesim.report.sections import section_parts

MARKS = {"joint": "circle", "lowest point": "triangle-down"}


def section_layers(dataset: xr.Dataset, shapes: list[Shape], figure: Figure) -> tuple[list[Any], dict[str, Columns]]:
    """The lines of a panel, told apart by dashes if there are several, and their marks."""
    styles = styled(shapes, figure.settings["methods"])
    found = [_line(dataset, style, figure) for style in styles]
    names, labels = [style.label for style in styles], list(figure.settings["colours"].labels)
    choice, opacity = fading()
    line = rows().mark_line(strokeWidth=2.4).encode(x="x:Q", y="y:Q", order="node:Q", detail="part:N")
    dashes = dashed(names, [style.dashes for style in styles], "line:N")
    line = line.encode(color=coloured(labels), strokeDash=dashes, opacity=opacity, tooltip=["line:N", *PLACE])
    forms = alt.Scale(domain=list(MARKS), range=list(MARKS.values()))
    mark = rows("marks").mark_point(filled=True, size=55, color="black", opacity=1)
    shape = alt.Shape("series:N", scale=forms, legend=alt.Legend(title=None))
    layers = [line.add_params(choice), mark.encode(x="x:Q", y="y:Q", shape=shape, tooltip=PLACE)]
    data = {"rows": [part for parts, _ in found for part in parts], "marks": [m for _, marks in found for m in marks]}
    return layers, {name: joined(parts) for name, parts in data.items()}


def _line(dataset: xr.Dataset, style: Styled, figure: Figure) -> tuple[list[Columns], list[Columns]]:
    """The sections of a line, and its marks."""
    settings, scaled = figure.settings, factors(figure, "xy")
    line, view, number = style.line(dataset), list(settings["view"]), scenario_number(dataset, style.shape)
    joints = line.joint_position.dropna("section").sel(component=view).values * scaled
    colours = settings["colours"].numbers(line.section_weight.values[: len(joints)])
    sections = []
    for i, part in enumerate(section_parts(line, joints, view, scaled)):
        own = place_columns(part.T, settings["colours"].labels[colours[i]], number)
        sections.append({**own, "line": [style.label] * len(part), "part": [f"{style.label} {i}"] * len(part)})
    lowest = line.lowest_point.sel(component=view).values * scaled
    marked = [("joint", joint) for joint in joints[:-1]] + [("lowest point", lowest)]
    return sections, [place_columns(place[:, None], words, number) for words, place in marked]
