"""Figures of a scene, as its file asks for them. SVG, PDF and PNG; curves, maps, orders and audits are drawn here."""

import math
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.colors import BoundaryNorm, ListedColormap, LogNorm
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from cablesim.config.figure_file import Figure
from cablesim.config.scene import AGREES, MISPRINT, ROUNDED_KEY, Scene
from cablesim.database.reading import of_only_method, select
from cablesim.errors import InputError
from cablesim.files import written_whole
from cablesim.quantities import RUN_TIME
from cablesim.report.animations import save_animation
from cablesim.report.audit import audit_table
from cablesim.report.colours import DASHES, PALETTE
from cablesim.report.drawing import (
    NOTE,
    PAGE,
    STYLE,
    are_steps,
    ascending,
    cell_edges,
    draw_points,
    evaluated,
    headline,
    legend,
    plain,
    point_in_words,
    shades,
    word,
)
from cablesim.report.histories import draw_history
from cablesim.report.orbits import draw_orbit
from cablesim.report.orders import convergences
from cablesim.report.precision_figure import draw_work_precision
from cablesim.report.shapes import draw_profiles, draw_spatial
from cablesim.report.snapshots import draw_snapshots
from cablesim.report.status_maps import draw_status_map

MOST_CELLS = 600
# Of an audit, in inches: its legend must fit.
LEAST_WIDTH = PAGE
# A logarithmic axis of fewer decades has numbers between the powers of ten.
FEW_DECADES = 3.0
# Of formulas whose values are not joined by lines.
MARKS = "osD^v"
# Of cells that agree, that follow from a rounded key, that are off.
FLAG_COLOURS = ("#E8E8E8", "#E69F00", "#D55E00")


# No clock and no random ids in any of them.
FORMATS: dict[str, dict[str, Any]] = {
    ".png": {"dpi": 150, "metadata": {"Software": None}},
    ".svg": {"metadata": {"Date": None}},
    ".pdf": {"metadata": {"CreationDate": None}},
}


def draw_figures(scene: Scene, dataset: xr.Dataset, folder: Path) -> None:
    """Draw every figure of a scene. Raises InputError, naming the figure, where it cannot."""
    drawers = {
        "curves": _curves,
        "map": _map,
        "status_map": draw_status_map,
        "profiles": draw_profiles,
        "spatial": draw_spatial,
        "history": draw_history,
        "orbit": draw_orbit,
        "work_precision": draw_work_precision,
        "snapshots": draw_snapshots,
        "animation": draw_snapshots,
        "convergence": _convergence,
        "audit": _audit,
    }
    for figure in scene.figures:
        with plt.rc_context(STYLE):
            try:
                drawn = drawers[figure.kind](scene, dataset, figure)
            except InputError as problem:
                raise InputError(f"{scene.path}: figures.{figure.name}: {problem}") from None
            headline(drawn, scene)
            stem = folder / f"{scene.name}_{figure.name}"
            _save(drawn, stem)
            if figure.kind == "animation":
                save_animation(drawn, dataset, figure, stem.with_suffix(".gif"))


def _save(figure: Any, stem: Path) -> None:
    """The figure in each of its formats, of one layout."""
    for suffix, settings in FORMATS.items():
        path = stem.with_suffix(suffix)
        with written_whole(path) as temporary:
            figure.savefig(temporary, format=suffix[1:], **settings)
        _keep_layout(figure)
    plt.close(figure)


def _keep_layout(figure: Any) -> None:
    """What is laid out once stays: the same places in all formats, and no work done again."""
    with plt.rc_context({"figure.constrained_layout.use": False}):
        figure.set_layout_engine(None)


def _curves(scene: Scene, dataset: xr.Dataset, figure: Figure) -> Any:
    settings = figure.settings
    chosen = dataset.isel(settings["position"])
    chosen = chosen.where(select(chosen, settings["where"])) if "where" in settings else chosen
    drawn, axes = plt.subplots()
    draw = _shaded_curves if settings["each"] else _coloured_curves
    draw(axes, chosen, figure)
    draw_points(axes, figure)
    _scales(axes, settings["log"])
    axes.set(xlabel=figure.label("x").text, ylabel=figure.label("y").text)
    legend(axes)
    return drawn


def _coloured_curves(axes: Any, dataset: xr.Dataset, figure: Figure) -> None:
    """One curve for each formula, told apart by colour."""
    settings = figure.settings
    for number, (label, formula) in enumerate(settings["y"].items()):
        style: Any = {"color": PALETTE[number % len(PALETTE)], "linestyle": DASHES[number % len(DASHES)]}
        if settings["draw"] == "marks":
            style |= {"linestyle": "", "marker": MARKS[number % len(MARKS)]}
        axes.plot(*_points(dataset, figure, formula), label=plain(label), **style)


def _shaded_curves(axes: Any, dataset: xr.Dataset, figure: Figure) -> None:
    """A curve for each point of an axis, told apart by shade; formulas by dashes."""
    settings, called = figure.settings, figure.label("each")
    name = settings["each"]
    for number, (label, formula) in enumerate(settings["y"].items()):
        dashes = DASHES[number % len(DASHES)]
        for i, shade in enumerate(shades(dataset.sizes[name])):
            part = dataset.isel({name: i})
            value = f"{called.words} = {point_in_words(part, name, called, called.tex_unit)}" if number == 0 else None
            axes.plot(*_points(part, figure, formula), label=value, color=shade, linestyle=dashes)
        if len(settings["y"]) > 1:
            axes.plot([], [], label=plain(label), color="black", linestyle=dashes)


def _points(dataset: xr.Dataset, figure: Figure, formula: str) -> tuple[np.ndarray, np.ndarray]:
    x, y = (figure.settings["x"], figure.label("x")), (formula, figure.label("y"))
    along, across = xr.broadcast(evaluated(dataset, *x), evaluated(dataset, *y))
    return along.values.ravel(), across.values.ravel()


def _map(scene: Scene, dataset: xr.Dataset, figure: Figure) -> Any:
    settings = figure.settings
    dataset = dataset.isel(settings["position"])
    value = evaluated(dataset, settings["value"], figure.label("value"))
    if "where" in settings:
        value = value.where(select(dataset, settings["where"]))
    value = of_only_method(value)
    x, y = (evaluated(dataset, settings[name], figure.label(name)) for name in ("x", "y"))
    missing, scenarios = int((~np.isfinite(value)).sum()), value.size
    # More cells than pixels cost time and show nothing.
    steps = {axis.dims[0]: slice(None, None, math.ceil(axis.size / MOST_CELLS)) for axis in (x, y)}
    x, y, value = x.isel({x.dims[0]: steps[x.dims[0]]}), y.isel({y.dims[0]: steps[y.dims[0]]}), value.isel(steps)
    x, y, value = ascending(x, y, value)
    drawn, axes = plt.subplots()
    finite = value.values[np.isfinite(value.values)]
    logarithmic = "value" in settings["log"]
    positive = finite[finite > 0.0] if logarithmic else finite
    norm: Any = LogNorm(positive.min(), positive.max()) if logarithmic and positive.size else _steps(finite)
    shown = np.ma.masked_invalid(np.where(value.values > 0.0, value.values, np.nan) if logarithmic else value.values)
    axes.set_facecolor("#DDDDDD")
    edges = [cell_edges(side.values, name in settings["log"]) for name, side in (("x", x), ("y", y))]
    mesh = axes.pcolormesh(*edges, shown, norm=norm, cmap="viridis", rasterized=True)
    ticks = None if norm is None or logarithmic else norm.boundaries[:-1] + 0.5
    bar = drawn.colorbar(mesh, ax=axes, label=figure.label("value").text, ticks=ticks)
    if logarithmic and positive.size:
        _count_few_decades(bar.ax.yaxis, positive.min(), positive.max())
    if settings["contours"]:
        levels = [level * figure.label("value").factor for level in settings["contours"]]
        lines = axes.contour(x.values, y.values, shown, levels=levels, colors="white", linewidths=1.2)
        axes.clabel(lines, fmt="%g", fontsize=NOTE)
    _scales(axes, settings["log"].replace("value", "").strip())
    axes.grid(visible=False)
    note = f"grey: no solution ({missing} of {scenarios})" if missing and "where" not in settings else ""
    axes.set(xlabel=figure.label("x").text, ylabel=figure.label("y").text)
    axes.set_title(note, fontsize=NOTE)
    return drawn


def _steps(values: np.ndarray) -> BoundaryNorm | None:
    """A colour for each value, where they are a few whole numbers."""
    return BoundaryNorm(np.arange(values.min(), values.max() + 2.0) - 0.5, 256) if are_steps(values) else None


def _convergence(scene: Scene, dataset: xr.Dataset, figure: Figure) -> Any:
    """Largest error of an output along each series of methods, against the option or the run time."""
    settings = figure.settings
    against, output = settings["against"], settings["output"]
    drawn, axes = plt.subplots()
    found = convergences(scene, dataset, output)
    shown = {n: f for n, f in found.items() if against in (f.series.option, RUN_TIME)}
    for number, (name, one) in enumerate(shown.items()):
        x = one.run_times * figure.label("x").factor if against == RUN_TIME else np.array(one.series.values)
        style: Any = {"color": PALETTE[number % len(PALETTE)], "linestyle": DASHES[number % len(DASHES)]}
        axes.plot(
            x, one.errors * figure.label("y").factor, marker="o", label=f"{word(name)}: order {one.order:.2f}", **style
        )
    _scales(axes, "xy")
    axes.set(xlabel=figure.label("x").text, ylabel=figure.label("y").text)
    axes.legend()
    return drawn


def _audit(scene: Scene, dataset: xr.Dataset, figure: Figure) -> Any:
    """Every cell of the printed table, coloured by its flag, with the printed value in it."""
    table = audit_table(scene, dataset)
    columns = list(dict.fromkeys(table["column"]))
    rows = sorted(set(table["row"]))
    off = scene.published.off if scene.published else MISPRINT
    shades = dict(zip((AGREES, ROUNDED_KEY, off), FLAG_COLOURS, strict=True))
    flags = list(shades)
    colours = np.full((len(rows), len(columns)), np.nan)
    drawn, axes = plt.subplots(figsize=(max(1.35 * len(columns) + 1.5, LEAST_WIDTH), 0.24 * len(rows) + 1.6))
    for cell in table.to_dict("records"):
        i, j = rows.index(cell["row"]), columns.index(cell["column"])
        colours[i, j] = flags.index(cell["flag"])
        wrong = cell["flag"] == off
        exact = f"  ({cell['exact_at_argument']:.5g})" if wrong else ""
        axes.text(
            j,
            i,
            cell["printed"] + exact,
            ha="center",
            va="center",
            fontsize=NOTE,
            fontweight="bold" if wrong else "normal",
        )
    palette = ListedColormap(list(shades.values()))
    axes.imshow(np.ma.masked_invalid(colours), aspect="auto", cmap=palette, norm=BoundaryNorm(np.arange(-0.5, 3), 3))
    axes.set_xticks(range(len(columns)), [word(name) for name in columns], rotation=20, ha="left", fontsize=NOTE)
    axes.xaxis.tick_top()
    axes.set_yticks(range(len(rows)), _row_names(table, rows, columns), fontsize=NOTE)
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    counts = table["flag"].value_counts()
    handles = [plt.Rectangle((0, 0), 1, 1, color=colour) for colour in shades.values()]
    labels = [f"{flag} ({counts.get(flag, 0)})" for flag in shades]
    labels[flags.index(off)] += ": printed (computed)"
    drawn.legend(handles, labels, loc="outside lower center", ncols=3)
    return drawn


def _row_names(table: pd.DataFrame, rows: list[int], columns: list[str]) -> list[str]:
    """The first column of the printed table, where it names the rows and is not audited itself; else their numbers."""
    head = str(table.columns[1])
    names = dict(zip(table["row"], table[head], strict=True))
    return [f"{word(head)} {names[row]}" if head not in columns else str(row) for row in rows]


def _scales(axes: Any, log: str) -> None:
    """Logarithmic axes, where there is anything positive to show on them."""
    lines = [line.get_xydata() for line in axes.get_lines()]
    points = np.concatenate([np.asarray(line) for line in lines]) if lines else np.ones((1, 2))
    sides = (("x", axes.set_xscale, axes.get_xlim, axes.xaxis), ("y", axes.set_yscale, axes.get_ylim, axes.yaxis))
    for column, (name, set_scale, limits, axis) in enumerate(sides):
        if name in log and (points[:, column] > 0.0).any():
            set_scale("log", nonpositive="mask")
            _count_few_decades(axis, *limits())


def _count_few_decades(axis: Any, low: float, high: float) -> None:
    """Numbers between the powers of ten, where there are few of these."""
    if high < low * 10.0**FEW_DECADES:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())
