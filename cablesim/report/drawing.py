"""What all figures share: their style and colours, legends, printed points, and words as they stand."""

import math
import textwrap
from typing import Any

import matplotlib
import xarray as xr

from cablesim.config.figure_file import Points
from cablesim.config.scene import Scene
from cablesim.database.reading import written
from cablesim.quantities import QUANTITIES

matplotlib.use("Agg")

# Okabe and Ito's palette: distinct for every kind of colour vision.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#999999")
DASHES = ("-", "--", "-.", ":")
STYLE: Any = {
    "figure.figsize": (7.0, 4.5),
    "figure.constrained_layout.use": True,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "legend.frameon": False,
    "font.size": 10,
    # The same figure must be the same bytes: no random ids, no clock.
    "svg.hashsalt": "cablesim",
    "svg.fonttype": "path",
}
MOST_LEGEND_LINES = 8
LETTERS_PER_INCH = 11


def legend(axes: Any) -> None:
    """A legend where there is something to tell apart, beside the axes where it is long."""
    lines = len(axes.get_legend_handles_labels()[0])
    if lines > MOST_LEGEND_LINES:
        axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.0, 0.5))
    elif lines > 1:
        axes.legend()


def headline(drawn: Any, scene: Scene) -> None:
    """The title of the scene above a figure, in lines as wide as it is."""
    width = int(LETTERS_PER_INCH * drawn.get_figwidth())
    drawn.suptitle(plain(textwrap.fill(scene.title, width)), fontsize=11)


def draw_points(axes: Any, points: Points | None) -> None:
    """Points of a printed table, hollow, beside the curves that they belong to."""
    if points is None:
        return
    x = points.table.evaluate(points.x)
    for number, (label, formula) in enumerate(points.y.items()):
        colour = PALETTE[number % len(PALETTE)]
        axes.plot(x, points.table.evaluate(formula), "o", color=colour, markerfacecolor="white", label=plain(label))


def plain(text: str) -> str:
    """A user's text as it stands: a dollar sign starts no formula."""
    return text.replace("$", r"\$")


def value_in_words(value: xr.DataArray) -> str:
    """A value of a coordinate with its unit, as a legend shows it: angles in degrees."""
    unit = QUANTITIES[str(value.name)].unit if value.name in QUANTITIES else "1"
    if unit == "rad":
        return f"{math.degrees(value.item()):.6g}°"
    return written(value) if unit == "1" else f"{written(value)} {unit.replace('-1', '⁻¹')}"


def word(name: str) -> str:
    """A name as words."""
    return name.replace("_", " ")
