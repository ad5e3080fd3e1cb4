"""The line at the phases of the last period, coloured by its tension."""

from typing import Any, NamedTuple

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize

from cablesim.config.figure_file import Figure
from cablesim.config.scene import Scene
from cablesim.report.colours import PALETTE
from cablesim.report.drawing import PAGE, plain

# Nearly no tension, beside the largest, has a colour of its own.
SLACK, SLACK_ON_BAR = 0.01, 0.04
COLOURS = plt.get_cmap("viridis").with_extremes(under=PALETTE[1])
# In inches: of a page's width what is not panels, and how high a panel is.
AROUND = 1.3
LOWEST, HIGHEST = 1.5, 5.0


class Motion(NamedTuple):
    """A line through a period, in the units of its figure: at rest (node, side), in motion (phase, node, side).

    `tension` is (phase, node).
    """

    rest: np.ndarray
    places: np.ndarray
    tension: np.ndarray


def draw_snapshots(scene: Scene, dataset: xr.Dataset, figure: Figure) -> Any:
    """Panels of one scale and one bar of colours; the line at rest is dashed."""
    settings, motions = figure.settings, motions_of(dataset, figure)
    panels, columns = settings["panels"], settings["across"]
    rows = -(-len(panels) // columns)
    norm = _norm([motion.tension for motion in motions])
    drawn, grid = plt.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    used, spare = grid.flat[: len(panels)], grid.flat[len(panels) :]
    for axes, panel, motion in zip(used, panels, motions, strict=True):
        axes.plot(*motion.rest.T, color="black", linestyle="--", linewidth=1.0, zorder=3)
        axes.add_collection(coloured(motion.places, motion.tension, norm))
        axes.autoscale_view()
        axes.set_aspect("equal", adjustable="box" if len(panels) > 1 else "datalim")
        axes.set_title(plain(panel.title))
    for axes in spare:
        axes.remove()
    drawn.set_size_inches(*_size(grid))
    _label(grid, used, figure)
    slack = any((colour_values(motion.tension, norm) < 0.0).any() for motion in motions)
    extend = "min" if slack else "neither"
    bar = drawn.colorbar(ScalarMappable(norm, COLOURS), ax=list(used), extend=extend, extendfrac=SLACK_ON_BAR)
    motion_note = f"motion × {settings['magnify']:g}" if settings["magnify"] != 1.0 else ""
    slack_note = f"orange: below {SLACK:.0%}" if slack else ""
    bar.set_label("; ".join(filter(None, (figure.label("value").text, motion_note, slack_note))))
    return drawn


def motions_of(dataset: xr.Dataset, figure: Figure) -> list[Motion]:
    """The line of each panel."""
    chosen = dataset.sel({"method": figure.settings["method"]}, drop=True)
    shapes = [shape for panel in figure.settings["panels"] for shape in panel.shapes]
    return [_motion(chosen.isel(shape.position), figure) for shape in shapes]


def coloured(places: np.ndarray, tension: np.ndarray, norm: Normalize, **style: Any) -> LineCollection:
    """Elements of a line at some phases, in the colours of their tension."""
    style = {"norm": norm, "cmap": COLOURS, "linewidths": 1.3, **style}
    return LineCollection(elements(places), array=colour_values(tension, norm), **style)


def elements(places: np.ndarray) -> list[np.ndarray]:
    """The two ends of every element, phase by phase."""
    return list(np.stack([places[:, :-1], places[:, 1:]], axis=2).reshape(-1, 2, 2))


def colour_values(tension: np.ndarray, norm: Normalize) -> np.ndarray:
    """What the elements are coloured by: the mean tension of their ends; less than nothing where it is hardly any."""
    mean = 0.5 * (tension[:, :-1] + tension[:, 1:])
    return np.where(mean < SLACK * float(norm.vmax or 1.0), -1.0, mean).ravel()


def _norm(tensions: list[np.ndarray]) -> Normalize:
    """Colours from no tension to the largest."""
    highest = max(float(np.max(values, where=np.isfinite(values), initial=0.0)) for values in tensions)
    return Normalize(0.0, highest or 1.0)


def _motion(line: xr.Dataset, figure: Figure) -> Motion:
    view, factors = list(figure.settings["view"]), [figure.label(axis).factor for axis in "xy"]
    rest = line.profile.sel(component=view).transpose("node", "component").values * factors
    places = line.snapshots.sel(component=view).transpose("phase", "node", "component").values * factors
    tension = line.snapshot_tension.transpose("phase", "node").values * figure.label("value").factor
    return Motion(rest, rest + figure.settings["magnify"] * (places - rest), tension)


def _size(grid: Any) -> tuple[float, float]:
    """Width and height of the figure, so that lines of equal scale fill its panels."""
    rows, columns = grid.shape
    panel = (PAGE - AROUND) / columns
    (left, right), (bottom, top) = grid[0][0].get_xlim(), grid[0][0].get_ylim()
    height = float(np.clip(panel * (top - bottom) / (right - left), LOWEST, HIGHEST))
    return PAGE, height * rows + 1.0


def _label(grid: Any, used: Any, figure: Figure) -> None:
    """Labels of the axes, each once for panels in a column or a row."""
    for axes in used[-grid.shape[1] :]:
        axes.tick_params(labelbottom=True)
        axes.set(xlabel=figure.label("x").text)
    for axes in grid[:, 0]:
        axes.set(ylabel=figure.label("y").text)
