"""The interactive figures of a scene: those that its file asks for, each of one or more panels."""

from typing import Any

import xarray as xr

from cablesim.config.figure_file import Figure
from cablesim.config.scene import Scene
from cablesim.errors import InputError
from cablesim.report.drawing import word
from cablesim.report.page.curve_panels import curve_panels
from cablesim.report.page.line_panels import profile_panels, spatial_panels
from cablesim.report.page.map_panels import map_panels, status_panels
from cablesim.report.page.method_panels import audit_panels, convergence_panels, precision_panels
from cablesim.report.page.motion_panels import orbit_panels, snapshot_panels
from cablesim.report.page.time_panels import history_panels

PANELS = {
    "curves": curve_panels,
    "map": map_panels,
    "status_map": status_panels,
    "profiles": profile_panels,
    "spatial": spatial_panels,
    "history": history_panels,
    "orbit": orbit_panels,
    "snapshots": snapshot_panels,
    "animation": snapshot_panels,
    "convergence": convergence_panels,
    "work_precision": precision_panels,
    "audit": audit_panels,
}


TITLES = {
    "status_map": "Where each method finds an answer, and where not",
    "profiles": "Shape of the line",
    "spatial": "The line in space",
    "history": "Tension against time",
    "orbit": "Path of the middle of the line through the last period",
    "snapshots": "The line through the last period, in the colours of its tension",
    "animation": "The line through the last period, in the colours of its tension",
    "convergence": "How the error falls",
    "work_precision": "Error against run time",
    "audit": "Every printed value, by verdict",
}
# Those that need the whole width of the page.
WHOLE = ("work_precision", "audit", "status_map")


def page_figures(scene: Scene, dataset: xr.Dataset) -> list[dict[str, Any]]:
    """Every figure as JSON. Raises InputError, naming the figure, where one cannot be drawn."""
    found = []
    for figure in scene.figures:
        try:
            panels = PANELS[figure.kind](scene, dataset, figure)
        except InputError as problem:
            raise InputError(f"{scene.path}: figures.{figure.name}: {problem}") from None
        about = {"name": figure.name, "title": _title(scene, figure), "whole": figure.kind in WHOLE or len(panels) > 1}
        found.append({**about, "panels": [panel.content for panel in panels]})
    return found


def _title(scene: Scene, figure: Figure) -> str:
    """What a figure shows, in words of its sides."""
    if figure.kind == "curves":
        shown = figure.label("y").plain_words or " and ".join(filter(None, figure.settings["y"]))
        return f"{shown} against {figure.label('x').plain_words}"
    if figure.kind == "map":
        return figure.label("value").plain
    # The name of a figure tells it from others of its kind.
    alone = [one.kind for one in scene.figures].count(figure.kind) == 1
    return TITLES[figure.kind] + ("" if alone else f": {word(figure.name)}")
