"""Tension against time."""

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

from cablesim.config.figure_file import Figure
from cablesim.config.figure_parts import Shape
from cablesim.config.scene import Scene
from cablesim.errors import InputError
from cablesim.report.drawing import PAGE, curves, panel_legend, plain

# Of one panel, in inches.
HEIGHT = 2.1


def draw_history(scene: Scene, dataset: xr.Dataset, figure: Figure) -> Any:
    """Panels below each other, or so many side by side, with the same scales."""
    settings = figure.settings
    panels, columns = settings["panels"], settings["across"]
    _check_window(dataset, settings["from"])
    rows = -(-len(panels) // columns)
    drawn, grid = plt.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    drawn.set_size_inches(PAGE, HEIGHT * rows + 1.8)
    used, spare = grid.flat[: len(panels)], grid.flat[len(panels) :]
    for axes, (title, shapes) in zip(used, panels, strict=True):
        _draw_panel(axes, dataset, shapes, figure)
        axes.set_title(plain(title))
    for axes in spare:
        axes.remove()
    for axes in used[-columns:]:
        axes.tick_params(labelbottom=True)
        axes.set(xlabel=figure.label("x").text)
    limits = (settings[end] and settings[end] * figure.label("x").factor for end in ("from", "to"))
    used[0].set_xlim(*limits)
    drawn.supylabel(figure.label("y").text)
    panel_legend(drawn, used)
    return drawn


def _check_window(dataset: xr.Dataset, first: float | None) -> None:
    """Raises InputError if all histories have ended before the first time that is to be shown."""
    times = dataset.history_time.values
    last = np.max(times, where=np.isfinite(times), initial=0.0)
    if first is not None and first >= last > 0.0:
        raise InputError(f"no history reaches {first:g} s: the longest ends at {last:g} s")


def _draw_panel(axes: Any, dataset: xr.Dataset, shapes: list[Shape], figure: Figure) -> None:
    settings = figure.settings
    first, last = settings["from"] or 0.0, settings["to"] or np.inf
    for line, style in curves(dataset, shapes, settings["methods"]):
        times, tension = line.history_time.values, line.history.sel(place=settings["place"]).values
        shown = (times >= first) & (times <= last)
        x, y = times[shown] * figure.label("x").factor, tension[shown] * figure.label("y").factor
        axes.plot(x, y, linewidth=1.2, **style)
