"""What the interactive figures share: panels, colours, marks that can be clicked, and how far a panel can be moved."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import altair as alt
import numpy as np
import xarray as xr

from cablesim.config.figure_file import Figure
from cablesim.config.figure_parts import Shape
from cablesim.report.colours import PALETTE, PIXEL_DASHES
from cablesim.report.drawing import Styled
from cablesim.report.page.columns import Columns, Grid, column

# Height of the area of a panel in pixels, unless its scales are equal.
HEIGHT = 240
NOTHING: Columns = {"x": [], "y": [], "series": []}
GREY = "#DDDDDD"
# Room beyond the outermost points where both scales are given.
MARGIN = 0.04
# A logarithmic side of fewer decades has plain numbers.
FEW_DECADES = 3.0
# On a logarithmic side.
MOST_NUMBERS = 9


@dataclass(frozen=True)
class Panel:
    """One chart with the columns of its data by name, what stands above it, and its shape.

    A column `scenario` holds the number of the scenario that a mark stands for: a click shows it. `aspect` is the
    height of the area over its width, where scales are equal.
    """

    chart: Any
    data: Mapping[str, Columns | Grid]
    title: str = ""
    height: int = HEIGHT
    aspect: float | None = None

    @property
    def content(self) -> dict[str, Any]:
        """As JSON: the specification without what all charts have."""
        spec = self.chart.to_dict()
        shown = {key: value for key, value in spec.items() if key not in ("$schema", "config", "datasets")}
        return {"title": self.title, "spec": shown, "data": self.data, "height": self.height, "aspect": self.aspect}


def rows(name: str = "rows") -> Any:
    """A chart of the columns that are called by this name."""
    return alt.Chart(alt.NamedData(name))


def scenario_numbers(dataset: xr.Dataset) -> xr.DataArray:
    """The running number of each scenario along the axes of the design, the method left out."""
    axes = [dim for dim in dataset.status.dims if dim != "method"]
    sizes = [dataset.sizes[axis] for axis in axes]
    return xr.DataArray(np.arange(int(np.prod(sizes))).reshape(sizes), dims=axes)


def scenario_number(dataset: xr.Dataset, shape: Shape) -> int:
    """The number of one scenario."""
    axes = [str(dim) for dim in dataset.status.dims if dim != "method"]
    place = [shape.position[axis] for axis in axes]
    return int(np.ravel_multi_index(place, [dataset.sizes[axis] for axis in axes]))


def palette(names: list[str]) -> Any:
    """A scale of colours, in the order of the names."""
    return alt.Scale(domain=names, range=[PALETTE[i % len(PALETTE)] for i in range(len(names))])


def coloured(names: list[str], colours: list[str] | None = None) -> Any:
    """Colours of the series, which fade where another is chosen in the legend."""
    chosen = alt.Scale(domain=names, range=colours) if colours else palette(names)
    legend = None if len(names) < 2 else alt.Legend(title=None, symbolType="stroke")
    return alt.Color("series:N", scale=chosen, sort=None, legend=legend)


def dashed(names: list[str], dashes: list[int], by: str = "series:N") -> Any:
    """Dashes of the series, by their numbers, in the same legend as their colours."""
    legend = alt.Legend(title=None, symbolType="stroke") if len(names) > 1 else None
    shown = alt.Scale(domain=names, range=[PIXEL_DASHES[number % len(PIXEL_DASHES)] for number in dashes])
    return alt.StrokeDash(by, scale=shown, sort=None, legend=legend)


def styled_lines(styles: list[Styled]) -> dict[str, Any]:
    """The channels that tell curves apart, as the figures in print do."""
    labels = [style.label for style in styles]
    return {
        "color": coloured(labels, [PALETTE[style.colour] for style in styles]),
        "strokeDash": dashed(labels, [style.dashes for style in styles]),
    }


def movable(chart: Any) -> Any:
    """Drag with the mouse to move, wheel with ctrl to zoom, double click to go back; fingers scroll the page."""
    return chart.add_params(
        alt.selection_interval(
            bind="scales",
            name="view",
            translate="[pointerdown[event.pointerType === 'mouse'], window:pointerup] > window:pointermove!",
            zoom="wheel![event.ctrlKey]",
        )
    )


def fading() -> tuple[Any, Any]:
    """A choice in the legend, and the opacity of marks by it."""
    choice = alt.selection_point(fields=["series"], bind="legend", name="chosen")
    return choice, alt.condition(choice, alt.value(1.0), alt.value(0.1))


def joined(parts: list[Columns]) -> Columns:
    """Columns below each other."""
    first = parts[0] if parts else NOTHING
    return {name: [value for part in parts for value in part[name]] for name in first}


def printed_points(figure: Figure) -> Columns:
    """The points of a printed table, a series for each of its formulas."""
    points = figure.settings["points"]
    if points is None:
        return NOTHING
    x = points.table.evaluate(points.x) * figure.label("x").factor
    found = {label: points.table.evaluate(formula) * figure.label("y").factor for label, formula in points.y.items()}
    return {
        "x": column(np.tile(x, len(found))),
        "y": column(np.concatenate(list(found.values()))),
        "series": [label for label in found for _ in range(len(x))],
    }


def hollow(points: Columns) -> Any:
    """Printed points, hollow, beside the curves that they belong to."""
    names = list(dict.fromkeys(points["series"]))
    mark = rows("points").mark_point(filled=False, size=45, strokeWidth=1.6)
    # The scale of strokes is another than that of colours, so that printed points have a legend of their own.
    stroke = alt.Stroke("series:N", sort=None, scale=palette(names), legend=alt.Legend(title=None, symbolType="circle"))
    return mark.encode(x="x:Q", y="y:Q", stroke=stroke, tooltip=["series:N", "x:Q", "y:Q"])


def scale(values: Any, logarithmic: bool, **about: Any) -> dict[str, Any]:
    """The scale of a side, and where it has numbers: at powers of ten where the values span many."""
    if not logarithmic:
        return {"scale": alt.Scale(zero=False, **about)}
    axis = alt.Axis(format=log_format(values))
    if spans_decades(values):
        axis["values"] = powers_of_ten(values)
    return {"scale": alt.Scale(type="log", **about), "axis": axis}


def log_format(values: Any) -> str:
    """How numbers on a logarithmic scale are written: as powers of ten where they span many."""
    return "~e" if spans_decades(values) else "~g"


def spans_decades(values: Any) -> bool:
    """Whether positive values span so many decades that numbers between their powers are too many."""
    known = _positive(values)
    return bool(known.size and known.max() > known.min() * 10.0**FEW_DECADES)


def powers_of_ten(values: Any) -> list[float]:
    """Powers of ten around positive values, evenly chosen where they are many."""
    known = np.log10(_positive(values))
    first, last = math.floor(known.min()), math.ceil(known.max())
    step = math.ceil((last - first) / MOST_NUMBERS)
    return [float(f"1e{power}") for power in range(first, last + 1, step)]


def _positive(values: Any) -> np.ndarray:
    return np.array([value for value in values if value is not None and value > 0.0])


def box(*sides: np.ndarray) -> list[list[float]]:
    """A range for each side that holds all its values, with a margin; around nothing, from 0 to 1."""
    return [_range(values) for values in sides]


def height_over_width(ranges: list[list[float]], stretch: float = 1.0) -> float:
    """The shape of an area whose scales are equal, but for heights drawn too large by a factor."""
    (left, right), (bottom, top) = ranges
    return stretch * (top - bottom) / (right - left)


def _range(values: np.ndarray) -> list[float]:
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    room = MARGIN * (high - low) or 0.5
    return [float(f"{low - room:.6g}"), float(f"{high + room:.6g}")]
