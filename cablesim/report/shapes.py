"""Pictures of the line itself: profiles in a plane, and a view in space."""

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

from cablesim.config.figure_file import Figure
from cablesim.config.figure_parts import Shape
from cablesim.config.scene import Scene
from cablesim.report.colours import PALETTE
from cablesim.report.drawing import NOTE, PAGE, curves, draw_points, legend
from cablesim.report.sections import draw_sections, section_legend

# In inches: of a page's width what is not panels, and how high a panel is.
AROUND = 1.0
LOWEST, HIGHEST = 1.6, 5.0
# Of the box around lines in space, beside its longest side.
THINNEST = 0.6
# A panel that is stretched by a factor of its own: at most how high it is beside its width.
FLATTEST = 0.3
STRETCHES = (1.0, 2.0, 5.0)
LEGEND_COLUMN = 2.4


def draw_profiles(scene: Scene, dataset: xr.Dataset, figure: Figure) -> Any:
    """Shapes of the line, in panels of one scale, or of a scale of their own where each is stretched by its factor."""
    settings = figure.settings
    panels, columns, shared = settings["panels"], settings["across"], settings["stretch"] is not None
    rows = -(-len(panels) // columns)
    drawn, grid = plt.subplots(rows, columns, sharex=shared and rows > 1, sharey=shared, squeeze=False)
    used, spare = grid.flat[: len(panels)], grid.flat[len(panels) :]
    for axes, (heading, shapes) in zip(used, panels, strict=True):
        _draw_panel(axes, dataset, shapes, figure)
        stretch = settings["stretch"] or own_stretch(axes.dataLim.width, axes.dataLim.height)
        axes.set_aspect(stretch, adjustable="box" if shared and len(panels) > 1 else "datalim")
        axes.set_title(heading)
        if not shared:
            axes.set_title("" if stretch == 1.0 else f"heights × {stretch:g}", fontsize=NOTE, loc="right")
    for axes in spare:
        axes.remove()
    _label_panels(drawn, grid, figure)
    if len(panels) > 1:
        drawn.set_size_inches(*_size(grid, settings))
    _add_legend(drawn, used[0], settings)
    return drawn


def _label_panels(drawn: Any, grid: Any, figure: Figure) -> None:
    """Labels of the axes, each once for panels in a column or a row."""
    x_label, y_label = figure.label("x").text, figure.label("y").text
    stretch, panels = figure.settings["stretch"], len(figure.settings["panels"])
    y_label += "" if stretch in (None, 1.0) else f", drawn × {stretch:g}"
    for axes in grid.flat[max(0, panels - grid.shape[1]) : panels]:
        axes.set(xlabel=x_label)
    if len(grid) > 1:
        drawn.supylabel(y_label)
    else:
        grid[0][0].set(ylabel=y_label)


def own_stretch(width: float, height: float) -> float:
    """The largest of 1, 2, 5, 10, ... by which heights may be stretched so that the panel stays flat."""
    if not (width > 0.0 and height > 0.0):
        return 1.0
    wanted = max(1.0, FLATTEST * width / height)
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(power * max(step for step in STRETCHES if step * power <= wanted))


def _size(grid: Any, settings: dict[str, Any]) -> tuple[float, float]:
    """Width and height of a figure of several panels, so that they fill it."""
    rows, columns = grid.shape
    panel = (PAGE - AROUND) / columns
    if settings["stretch"] is None:
        return PAGE, (panel * FLATTEST + 0.8) * rows + 1.4
    limits = [(axes.get_xlim(), axes.get_ylim()) for axes in grid.flat[: len(settings["panels"])]]
    width = max(right - left for (left, right), _ in limits)
    height = settings["stretch"] * max(top - bottom for _, (bottom, top) in limits)
    return PAGE, rows * float(np.clip(panel * height / width, LOWEST, HIGHEST)) + 1.6


def _draw_panel(axes: Any, dataset: xr.Dataset, shapes: list[Shape], figure: Figure) -> None:
    settings = figure.settings
    if settings["colours"] is not None:
        draw_sections(axes, dataset, shapes, figure)
    else:
        sides = [(component, figure.label(axis).factor) for axis, component in zip("xy", settings["view"], strict=True)]
        for line, style in curves(dataset, shapes, settings["methods"]):
            axes.plot(*(line.profile.sel(component=component) * factor for component, factor in sides), **style)
    draw_points(axes, figure)


def _add_legend(drawn: Any, first: Any, settings: dict[str, Any]) -> None:
    """A legend for all panels, of which the first speaks for the others."""
    if settings["colours"] is not None:
        handles = section_legend(settings)
        columns = int(drawn.get_figwidth() / LEGEND_COLUMN)
        drawn.legend(handles=handles, loc="outside lower center", ncols=columns)
    elif len(settings["panels"]) == 1:
        legend(first)
    else:
        drawn.legend(*first.get_legend_handles_labels(), loc="outside lower center", ncols=4)


def draw_spatial(scene: Scene, dataset: xr.Dataset, figure: Figure) -> Any:
    """The line in space, with its shadow on the floor and the stream as arrows."""
    drawn = plt.figure(figsize=(PAGE, 5.5))
    axes: Any = drawn.add_subplot(projection="3d", computed_zorder=False)
    shapes = figure.settings["shapes"]
    lines = list(curves(dataset, shapes, figure.settings["methods"]))
    low, high = _box(np.concatenate([line.profile.values for line, _ in lines]))
    for line, style in lines:
        x, y, z = line.profile.transpose("component", "node").values
        axes.plot(x, y, np.full_like(z, low[2]), color="#999999", linewidth=1.0, zorder=1)
        for node in (0, -1):
            axes.plot(x[[node] * 2], y[[node] * 2], [low[2], z[node]], color="#BBBBBB", linewidth=0.7, zorder=1)
        axes.plot(x, y, z, zorder=3, **style)
    _stream_arrows(axes, dataset, shapes, low, high)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set(xlabel=figure.label("x").text, ylabel=figure.label("y").text, zlabel=figure.label("z").text)
    axes.set_box_aspect(high - low, zoom=1.0)
    axes.locator_params(nbins=5)
    drawn.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return drawn


def _box(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Limits around points, not too thin in any direction; around nothing, a unit box."""
    finite = points[np.isfinite(points).all(axis=1)]
    low, high = (finite.min(axis=0), finite.max(axis=0)) if finite.size else (np.zeros(3), np.ones(3))
    side = np.maximum(high - low, THINNEST * max((high - low).max(), 1e-9))
    middle = (low + high) / 2
    return middle - 0.55 * side, middle + 0.55 * side


def _stream_arrows(axes: Any, dataset: xr.Dataset, shapes: list[Shape], low: np.ndarray, high: np.ndarray) -> None:
    """An arrow on the floor for each direction of the stream, in the colour of the line if there are several."""
    turned = "heading" in dataset.coords
    headings = [float(dataset.heading.isel(_own(dataset.heading, shape))) if turned else 0.0 for shape in shapes]
    different = list(dict.fromkeys(headings))
    length, start = 0.2 * (high - low)[:2].min(), low[:2] + 0.2 * (high - low)[:2]
    for heading in different:
        colour = PALETTE[headings.index(heading) % len(PALETTE)] if len(different) > 1 else "black"
        step = length * np.array([np.cos(heading), np.sin(heading)])
        axes.quiver(*start, low[2], *step, 0.0, color=colour, linewidth=1.5, zorder=2)
    words = "waves and stream" if "wave_period" in dataset.coords else "the stream"
    axes.plot([], [], [], color="none", label=f"{'arrow' if len(different) == 1 else 'arrows'}: {words}")


def _own(values: xr.DataArray, shape: Shape) -> dict[str, int]:
    """The position of a shape on the axes that a coordinate has."""
    return {axis: position for axis, position in shape.position.items() if axis in values.dims}
