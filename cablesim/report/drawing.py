"""What all figures share: their style and colours, legends, printed points, and words as they stand."""

import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
import xarray as xr

from cablesim.config.figure_file import Figure, Points
from cablesim.config.figure_parts import Shape
from cablesim.config.scene import Scene
from cablesim.database.reading import evaluate, written
from cablesim.errors import InputError
from cablesim.labels import Label, lowered
from cablesim.quantities import component_names
from cablesim.report.colours import DASHES, PALETTE

matplotlib.use("Agg")

# In inches: a page of a journal is 178 mm wide. In points: text, titles of panels and labels; legends; notes.
PAGE = 7.0
TEXT, LEGEND, NOTE = 10, 9, 8
STYLE: Any = {
    "figure.figsize": (PAGE, 4.5),
    "figure.constrained_layout.use": True,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "legend.frameon": False,
    # Letters of a journal, with symbols in the same; what they lack is taken from the other.
    "font.family": ["STIXGeneral", "DejaVu Sans"],
    "mathtext.fontset": "stix",
    "font.size": TEXT,
    "axes.titlesize": TEXT,
    "figure.titlesize": TEXT + 1,
    "figure.labelsize": TEXT,
    "legend.fontsize": LEGEND,
    # The same figure must be the same bytes: no random ids, no clock.
    "svg.hashsalt": "cablesim",
    "svg.fonttype": "path",
    # Letters that can be searched and edited: TrueType fonts, embedded.
    "pdf.fonttype": 42,
}
MOST_LEGEND_LINES = 8
# Of values that have a colour each; and where the shades of curves end, before they are too pale.
MOST_STEPS, LIGHTEST = 8, 0.92
LETTERS_PER_INCH = 13
LETTERS_PER_HANDLE = 10


def legend(axes: Any) -> None:
    """A legend where there is something to tell apart, beside the axes where it is long."""
    lines = len(axes.get_legend_handles_labels()[0])
    if lines > MOST_LEGEND_LINES:
        axes.legend(fontsize=NOTE, loc="center left", bbox_to_anchor=(1.0, 0.5))
    elif lines > 1:
        axes.legend()


@dataclass(frozen=True)
class Styled:
    """A curve: one scenario of one method, how it is called, and the numbers of its colour and its dashes."""

    shape: Shape
    method: str
    label: str
    colour: int
    dashes: int

    def line(self, dataset: xr.Dataset) -> xr.Dataset:
        """Its scenario."""
        return dataset.isel(self.shape.position).sel({"method": self.method}, drop=True)


def styled(shapes: list[Shape], methods: tuple[str, ...]) -> list[Styled]:
    """Curves of a panel: scenarios differ in colour, methods in dashes; where there is but one of either, in both."""
    return [
        Styled(
            shape,
            method,
            ", ".join([shape.label] * bool(shape.label) + [method] * (len(methods) > 1 or not shape.label)),
            (i if len(shapes) > 1 else j) % len(PALETTE),
            (j if len(methods) > 1 else i) % len(DASHES),
        )
        for i, shape in enumerate(shapes)
        for j, method in enumerate(methods)
    ]


def curves(
    dataset: xr.Dataset, shapes: list[Shape], methods: tuple[str, ...]
) -> Iterator[tuple[xr.Dataset, dict[str, Any]]]:
    """One scenario of one method for each curve, and how it is drawn."""
    for one in styled(shapes, methods):
        style = {"label": plain(one.label), "color": PALETTE[one.colour], "linestyle": DASHES[one.dashes]}
        yield one.line(dataset), style


def panel_legend(drawn: Any, panels: Any) -> None:
    """A legend for all panels, of which the first speaks for the others."""
    if len(panels) == 1:
        legend(panels[0])
        return
    handles, labels = panels[0].get_legend_handles_labels()
    if len(handles) > 1:
        columns = int(LETTERS_PER_INCH * drawn.get_figwidth() / (max(map(len, labels)) + LETTERS_PER_HANDLE))
        drawn.legend(handles, labels, loc="outside lower center", ncols=max(1, columns))


def headline(drawn: Any, scene: Scene) -> None:
    """The title of the scene above a figure, in lines as wide as it is."""
    width = int(LETTERS_PER_INCH * drawn.get_figwidth())
    drawn.suptitle(plain(textwrap.fill(scene.title, width)))


def draw_points(axes: Any, figure: Figure) -> None:
    """Points of a printed table, hollow, beside the curves that they belong to."""
    points: Points | None = figure.settings["points"]
    if points is None:
        return
    x = points.table.evaluate(points.x) * figure.label("x").factor
    for number, (label, formula) in enumerate(points.y.items()):
        colour = PALETTE[number % len(PALETTE)]
        y = points.table.evaluate(formula) * figure.label("y").factor
        axes.plot(x, y, "o", color=colour, markerfacecolor="white", label=plain(label))


def plain(text: str) -> str:
    """A user's text as it stands: a dollar sign starts no formula, and raised digits are powers."""
    return lowered(text.replace("$", r"\$"))


def value_in_words(value: xr.DataArray, label: Label, unit: str) -> str:
    """A value with the unit that its label asks for, written as it is shown: in TeX, or plain."""
    shown = written(value if value.dtype.kind in "SUOT" else value * label.factor)
    return f"{shown}{'' if unit in ('', '°') else ' '}{unit}"


def point_in_words(part: xr.Dataset, axis: str, label: Label, unit: str) -> str:
    """A point of an axis in words: a number, a word, or the components of a vector."""
    return ", ".join(value_in_words(part[name], label, unit) for name in component_names(axis))


def shades(number: int) -> np.ndarray:
    """Colours of so many curves that are told apart by shade, dark to light."""
    return np.asarray(matplotlib.colormaps["viridis"](np.linspace(0.0, LIGHTEST, number)))


def are_steps(values: np.ndarray) -> bool:
    """Whether finite values are a few whole numbers, which have a colour each."""
    return bool(values.size and (values == np.round(values)).all() and 0 < np.ptp(values) <= MOST_STEPS)


def evaluated(dataset: xr.Dataset, formula: str, label: Label) -> xr.DataArray:
    """The values of a formula in the unit of its axis."""
    values = evaluate(dataset, formula)
    return values if label.factor == 1.0 else values * label.factor


def ascending(x: xr.DataArray, y: xr.DataArray, value: xr.DataArray) -> tuple[xr.DataArray, xr.DataArray, xr.DataArray]:
    """The sides of a map in ascending order, and its values (y, x) along them."""
    orders = {str(side.dims[0]): np.argsort(side.values, kind="stable") for side in (x, y)}
    x, y = (side.isel({side.dims[0]: orders[str(side.dims[0])]}) for side in (x, y))
    return x, y, value.isel(orders).transpose(*y.dims, *x.dims)


def cell_edges(values: np.ndarray, is_logarithmic: bool) -> np.ndarray:
    """Edges of the cells around ascending values: half way between them on the scale that is shown.

    Raises InputError for values that a logarithmic scale cannot show.
    """
    if is_logarithmic and not (values > 0.0).all():
        raise InputError(f"a logarithmic side of a map needs values above 0, not {values.min():g}")
    places = np.log(values) if is_logarithmic else values
    half = 0.5 * np.diff(places) if places.size > 1 else np.array([0.5])
    edges = np.concatenate([[places[0] - half[0]], places[:-1] + half, [places[-1] + half[-1]]])
    return np.exp(edges) if is_logarithmic else edges


def word(name: str) -> str:
    """A name as words."""
    return name.replace("_", " ")
