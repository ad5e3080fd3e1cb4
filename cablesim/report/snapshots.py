"""The line at the phases of the last period, coloured by its tension."""

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize

from cablesim.config.figure_file import Figure
from cablesim.config.scene import Scene
from cablesim.report.drawing import plain

COLOURS = "viridis"
# Of one panel, and of all side by side, in inches.
PANEL, LEAST_WIDTH = 3.6, 6.0
LOWEST, HIGHEST = 1.5, 5.0


def draw_snapshots(scene: Scene, dataset: xr.Dataset, figure: Figure) -> Any:
    """Panels of one scale and one bar of colours; the line at rest is dashed."""
    settings = figure.settings
    panels, columns = settings["panels"], settings["across"]
    rows = -(-len(panels) // columns)
    chosen = dataset.sel({"method": settings["method"]}, drop=True)
    lines = [chosen.isel(shape.position) for panel in panels for shape in panel.shapes]
    norm = _norm([line.snapshot_tension.values * figure.label("value").factor for line in lines])
    drawn, grid = plt.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    used, spare = grid.flat[: len(panels)], grid.flat[len(panels) :]
    for axes, panel, line in zip(used, panels, lines, strict=True):
        _draw_line(axes, line, norm, figure)
        axes.set_aspect("equal", adjustable="box" if len(panels) > 1 else "datalim")
        axes.set_title(plain(panel.title), fontsize=10)
    for axes in spare:
        axes.remove()
    drawn.set_size_inches(*_size(grid))
    _label(grid, used, figure)
    motion = f"; motion × {settings['magnify']:g}" if settings["magnify"] != 1.0 else ""
    drawn.colorbar(ScalarMappable(norm, COLOURS), ax=list(used), label=f"{figure.label('value').text}{motion}")
    return drawn


def _norm(tensions: list[np.ndarray]) -> Normalize:
    """Colours from no tension to the largest."""
    highest = max(float(np.max(values, where=np.isfinite(values), initial=0.0)) for values in tensions)
    return Normalize(0.0, highest or 1.0)


def _draw_line(axes: Any, line: xr.Dataset, norm: Normalize, figure: Figure) -> None:
    """Every phase with a colour for each element: the mean tension of its ends."""
    settings = figure.settings
    view, factors = list(settings["view"]), [figure.label(axis).factor for axis in "xy"]
    rest = line.profile.sel(component=view).transpose("node", "component").values * factors
    places = line.snapshots.sel(component=view).transpose("phase", "node", "component").values * factors
    places = rest + settings["magnify"] * (places - rest)
    tension = line.snapshot_tension.transpose("phase", "node").values * figure.label("value").factor
    axes.plot(*rest.T, color="black", linestyle="--", linewidth=1.0, zorder=3)
    elements = np.stack([places[:, :-1], places[:, 1:]], axis=2).reshape(-1, 2, 2)
    values = (0.5 * (tension[:, :-1] + tension[:, 1:])).ravel()
    axes.add_collection(LineCollection(list(elements), array=values, norm=norm, cmap=COLOURS, linewidths=1.3))
    axes.autoscale_view()


def _size(grid: Any) -> tuple[float, float]:
    """Width and height of the figure, so that lines of equal scale fill its panels."""
    rows, columns = grid.shape
    panel = max(PANEL, LEAST_WIDTH / columns)
    (left, right), (bottom, top) = grid[0][0].get_xlim(), grid[0][0].get_ylim()
    height = float(np.clip(panel * (top - bottom) / (right - left), LOWEST, HIGHEST))
    return panel * columns + 1.3, height * rows + 1.0


def _label(grid: Any, used: Any, figure: Figure) -> None:
    """Labels of the axes, each once for panels in a column or a row."""
    for axes in used[-grid.shape[1] :]:
        axes.tick_params(labelbottom=True)
        axes.set(xlabel=figure.label("x").text)
    for axes in grid[:, 0]:
        axes.set(ylabel=figure.label("y").text)
