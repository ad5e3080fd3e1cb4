"""Lines of sections: each section in a colour of its own, with the joints and the lowest point marked."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.lines import Line2D

from cablesim.config.figure_file import Figure
from cablesim.config.figure_parts import Shape
from cablesim.report.colours import DASHES, PALETTE
from cablesim.report.drawing import LEGEND, NOTE, plain

JOINT: Any = {"marker": "o", "color": "black", "markerfacecolor": "white", "markersize": 5.5, "linestyle": ""}
LOWEST: Any = {"marker": "v", "color": "black", "markersize": 7, "linestyle": ""}
GREY = "#555555"
# Room for words above and below the line, beside its height.
MARGIN = 0.2


def draw_sections(axes: Any, dataset: xr.Dataset, shapes: list[Shape], figure: Figure) -> None:
    """The lines of a panel, told apart by dashes; where there is but one, the place of its lowest point is written."""
    settings = figure.settings
    view, factors = list(settings["view"]), [figure.label(axis).factor for axis in "xy"]
    lines = [(shape, method) for shape in shapes for method in settings["methods"]]
    for (shape, method), dashes in zip(lines, DASHES, strict=False):
        line = dataset.isel(shape.position).sel({"method": method}, drop=True)
        joints = line.joint_position.dropna("section").sel(component=view).values * factors
        numbers = settings["colours"].numbers(line.section_weight.values[: len(joints)])
        for number, part in zip(numbers, section_parts(line, joints, view, factors), strict=True):
            axes.plot(*part.T, color=PALETTE[number], linestyle=dashes, linewidth=2.0)
        axes.plot(*joints[:-1].T, **JOINT)
        lowest = line.lowest_point.sel(component=view).values * factors
        axes.plot(*lowest, **LOWEST)
        axes.margins(y=MARGIN)
        if len(lines) == 1 and joints.size:
            _write_ends(axes, line, view, factors)
            units = dict.fromkeys(figure.label(axis).shown_unit for axis in "xy")
            words = f"({lowest[0]:.1f}, {lowest[1]:.2f}) {', '.join(units)}".replace("-", "−")
            axes.annotate(words, lowest, (0, -7), textcoords="offset points", ha="center", va="top", fontsize=NOTE)


def section_legend(settings: dict[str, Any]) -> list[Line2D]:
    """What the legend shows: sections or weights, marks, and the dashes of what is told apart by them."""
    labels = settings["colours"].labels
    sections = [
        Line2D([], [], color=colour, linewidth=2.0, label=plain(label))
        for label, colour in zip(labels, PALETTE, strict=False)
    ]
    marks = [Line2D([], [], label="joint", **JOINT), Line2D([], [], label="lowest point", **LOWEST)]
    shapes, methods = settings["panels"][0][1], settings["methods"]
    labels = [", ".join(filter(None, (shape.label, method))) for shape in shapes for method in methods]
    told = zip(labels, DASHES, strict=False) if len(labels) > 1 else ()
    return [*sections, *marks, *(_sample(plain(label), dashes) for label, dashes in told)]


def _sample(label: str, dashes: Any) -> Line2D:
    return Line2D([], [], color=GREY, linestyle=dashes, label=label)


def section_parts(line: xr.Dataset, joints: np.ndarray, view: list[str], factors: list[float]) -> Iterator[np.ndarray]:
    """The points of each section of a line, from joint to joint; shape (point, 2)."""
    nodes = line.profile.sel(component=view).transpose("node", "component").values * factors
    numbers = line.profile_section.values
    start = nodes[:1]
    for number, end in enumerate(joints, start=1):
        yield np.concatenate([start, nodes[numbers == number], [end]])
        start = end[None]


def _write_ends(axes: Any, line: xr.Dataset, view: list[str], factors: list[float]) -> None:
    ends = line.profile.sel(component=view).isel(node=[0, -1]).transpose("node", "component").values
    ends = ends * factors
    for letter, end in zip("AB", ends, strict=True):
        axes.annotate(letter, end, (0, 4), textcoords="offset points", ha="center", fontweight="bold", fontsize=LEGEND)
