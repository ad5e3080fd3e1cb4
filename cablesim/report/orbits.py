"""The path of the middle of the line through the last period."""

from typing import Any

import matplotlib.pyplot as plt
import xarray as xr

from cablesim.config.figure_file import Figure
from cablesim.config.scene import Scene
from cablesim.report.drawing import curves, legend


def draw_orbit(scene: Scene, dataset: xr.Dataset, figure: Figure) -> Any:
    """Closed paths around the place at rest, a cross; a dot for each phase, a larger one where the period begins."""
    settings = figure.settings
    across, up = settings["view"]
    drawn, axes = plt.subplots()
    for line, style in curves(dataset, settings["shapes"], settings["methods"]):
        path = line.orbit.isel(phase=[*range(line.sizes["phase"]), 0])
        x = path.sel(component=across).values * figure.label("x").factor
        y = path.sel(component=up).values * figure.label("y").factor
        axes.plot(x, y, marker=".", markersize=4, **style)
        axes.plot(x[0], y[0], marker="o", markersize=5, color=style["color"])
    axes.plot(0.0, 0.0, marker="+", color="black", markersize=9)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel=figure.label("x").text, ylabel=figure.label("y").text)
    legend(axes)
    return drawn
