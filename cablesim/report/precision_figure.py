"""The work-precision diagram: largest error of each method against its run time, with the front that nothing beats."""

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

from cablesim.config.figure_file import Figure
from cablesim.config.method import find_series, series_names
from cablesim.config.scene import Scene
from cablesim.report.colours import DASHES, PALETTE
from cablesim.report.drawing import NOTE, PAGE, word
from cablesim.report.precision import TARGETS, WorkAndPrecision, Worth, work_and_precision

# In inches: without the legend, and a row of that.
HEIGHT, ROW = 4.6, 0.17
MARKS = "osD^vP*X<>p"
# Where an error that is nothing is drawn.
LEAST = 1e-17
FRONT, UNTOLD = "#BBBBBB", "#EEEEEE"


def draw_work_precision(scene: Scene, dataset: xr.Dataset, figure: Figure) -> Any:
    """Both axes logarithmic; methods that differ in one option are joined; open marks: not everything is solved."""
    found = work_and_precision(scene, dataset)
    drawn_groups = groups(scene, found, figure.settings["join"])
    drawn, axes = plt.subplots(figsize=(PAGE, HEIGHT + ROW * (len(drawn_groups) + 1)))
    _draw_front(axes, found)
    for number, (name, members) in enumerate(drawn_groups.items()):
        _draw_group(axes, number, name, members)
    for target in TARGETS:
        axes.axhline(target, color="black", linewidth=0.5, linestyle=":", zorder=0)
    axes.set(xscale="log", yscale="log", xlabel=figure.label("x").text, ylabel=figure.label("y").text)
    low, high = axes.get_ylim()
    axes.axhspan(low, min(max(found.least_told, low), high), color=UNTOLD, zorder=0)
    axes.set_ylim(low, high)
    note = f"grey: below {found.least_told:.0e} the reference does not tell; open marks: not every scenario solved"
    axes.set_title(note, fontsize=NOTE)
    drawn.legend(fontsize=NOTE, loc="outside lower center", ncols=2)
    return drawn


def groups(scene: Scene, found: WorkAndPrecision, join: str | None) -> dict[str, list[Worth]]:
    """Series of methods, then those that stand alone, by their names in the legend; none that solve nothing."""
    known = {one.name: one for one in found.methods if one.solved}
    series = find_series(scene.methods, scene.reference.method if scene.reference else None)
    series = tuple(one for one in series if join in (None, one.option))
    groups = {
        word(name): [known[method.name] for method in one.methods if method.name in known]
        for name, one in zip(series_names(series), series, strict=True)
    }
    joined = {one.name for members in groups.values() for one in members}
    alone = {
        f"{word(name)} ({word(one.method.solver.name)})": [one] for name, one in known.items() if name not in joined
    }
    return {name: members for name, members in (groups | alone).items() if members}


def _draw_front(axes: Any, found: WorkAndPrecision) -> None:
    times = [one.run_time for one in found.front]
    errors = [max(one.largest, found.least_told) for one in found.front]
    axes.step(times, errors, where="post", color=FRONT, linewidth=6, zorder=1, label="front")


def _draw_group(axes: Any, number: int, name: str, members: list[Worth]) -> None:
    style: Any = {"color": PALETTE[number % len(PALETTE)], "linestyle": DASHES[number // len(PALETTE) % len(DASHES)]}
    mark = MARKS[number % len(MARKS)]
    x = np.array([one.run_time for one in members])
    y = np.array([max(one.largest, LEAST) for one in members])
    range_of = np.array([(one.times["run_time_lowest"], one.times["run_time_highest"]) for one in members])
    spread = np.abs(range_of - x[:, None]).T
    axes.errorbar(x, y, xerr=spread, linewidth=1, capsize=2, zorder=2, **style)
    fills = [style["color"] if one.solves_all else "white" for one in members]
    axes.scatter(x, y, c=fills, edgecolors=style["color"], marker=mark, s=36, zorder=3)
    axes.plot([], [], marker=mark, label=name, **style)
