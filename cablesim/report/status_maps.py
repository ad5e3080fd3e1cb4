"""Maps of the fate of every scenario: a colour for each status, told in words with counts, a panel for each method."""

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.colors import BoundaryNorm, ListedColormap

from cablesim.config.figure_file import Figure
from cablesim.config.scene import Scene
from cablesim.database.reading import of_method, status_words
from cablesim.report.colours import STATUS_COLOURS
from cablesim.report.drawing import LEGEND, NOTE, PAGE, ascending, cell_edges, evaluated, plain, word
from cablesim.status import Status

# In inches: how high a panel is, a row of one and the least of all, and labels, title and legend.
PANEL, ROW, LEAST, AROUND = 2.0, 0.3, 0.8, 1.7


def draw_status_map(scene: Scene, dataset: xr.Dataset, figure: Figure) -> Any:
    """A panel for each method, or where only one side is asked for, one panel with a row for each."""
    settings = figure.settings
    methods, words = settings["methods"], status_words(dataset)
    chosen = dataset.isel(settings["position"])
    fates = [of_method(chosen.status, method) for method in methods]
    drawn = _panels(chosen, fates, figure) if "y" in settings else _rows(chosen, fates, figure)
    _name_statuses(drawn, np.concatenate([fate.values.ravel() for fate in fates]), words)
    return drawn


def _panels(dataset: xr.Dataset, fates: list[xr.DataArray], figure: Figure) -> Any:
    settings = figure.settings
    columns = min(settings["across"], len(fates))
    rows = -(-len(fates) // columns)
    size = (PAGE, PANEL * rows + AROUND)
    drawn, grid = plt.subplots(rows, columns, figsize=size, sharex=True, sharey=True, squeeze=False)
    x, y = (evaluated(dataset, settings[name], figure.label(name)) for name in ("x", "y"))
    for axes, fate, method in zip(grid.flat, fates, settings["methods"], strict=False):
        _paint(axes, x, y, fate, settings)
        axes.set_title(plain(word(method)), fontsize=LEGEND)
    for axes in grid[:, 0]:
        axes.set_ylabel(figure.label("y").text)
    # Below the last panel of each column, which need not be in the last row.
    for axes in grid.flat[max(len(fates) - columns, 0) : len(fates)]:
        axes.set_xlabel(figure.label("x").text)
        axes.tick_params(labelbottom=True)
    for axes in grid.flat[len(fates) :]:
        axes.remove()
    return drawn


def _rows(dataset: xr.Dataset, fates: list[xr.DataArray], figure: Figure) -> Any:
    settings = figure.settings
    drawn, axes = plt.subplots(figsize=(PAGE, max(ROW * len(fates), LEAST) + AROUND))
    numbers = xr.DataArray(np.arange(len(fates)), dims="method")
    x = evaluated(dataset, settings["x"], figure.label("x"))
    _paint(axes, x, numbers, xr.concat(fates, "method"), settings)
    axes.set_yticks(numbers.values, [plain(word(method)) for method in settings["methods"]])
    axes.invert_yaxis()
    axes.set_xlabel(figure.label("x").text)
    return drawn


def _paint(axes: Any, x: xr.DataArray, y: xr.DataArray, fates: xr.DataArray, settings: dict[str, Any]) -> None:
    """A cell for each scenario."""
    x, y, fates = ascending(x, y, fates)
    colours = ListedColormap([STATUS_COLOURS[status] for status in Status])
    norm = BoundaryNorm(np.arange(len(Status) + 1) - 0.5, len(Status))
    edges = [cell_edges(side.values, name in settings["log"]) for name, side in (("x", x), ("y", y))]
    axes.pcolormesh(*edges, fates.values, cmap=colours, norm=norm, rasterized=True)
    for name, set_scale in (("x", axes.set_xscale), ("y", axes.set_yscale)):
        if name in settings["log"]:
            set_scale("log")
    axes.grid(visible=False)


def _name_statuses(drawn: Any, fates: np.ndarray, words: tuple[str, ...]) -> None:
    """A legend of the statuses that occur, in words, with their numbers."""
    counts = np.bincount(fates, minlength=len(words))
    found = [Status[name] for name, count in zip(words, counts, strict=True) if count]
    handles = [plt.Rectangle((0, 0), 1, 1, facecolor=STATUS_COLOURS[status], edgecolor="#888888") for status in found]
    labels = [f"{word(status.name)} ({counts[status]} of {fates.size}): {status.sentence}" for status in found]
    drawn.legend(handles, labels, loc="outside lower left", fontsize=NOTE)
