"""Figures of a scene, as its file asks for them: curves, maps, profiles and the picture of an audit. SVG and PNG."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import xarray as xr

from cablesim.config.figure_file import Figure
from cablesim.config.scene import Scene
from cablesim.database.reading import evaluate, of_method, select, written
from cablesim.errors import InputError
from cablesim.files import written_whole
from cablesim.quantities import QUANTITIES, component_names
from cablesim.report.audit import AGREES, MISPRINT, ROUNDED_KEY, audit_table

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.colors import BoundaryNorm, ListedColormap, LogNorm

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
MOST_CELLS = 600
FLAG_COLOURS = {AGREES: "#E8E8E8", ROUNDED_KEY: "#E69F00", MISPRINT: "#D55E00"}


def draw_figures(scene: Scene, dataset: xr.Dataset, folder: Path) -> None:
    """Draw every figure of a scene. Raises InputError, naming the figure, where it cannot."""
    drawers = {"curves": _curves, "map": _map, "profiles": _profiles, "audit": _audit}
    for figure in scene.figures:
        with plt.rc_context(STYLE):
            try:
                drawn = drawers[figure.kind](scene, dataset, figure)
            except InputError as problem:
                raise InputError(f"{scene.path}: figures.{figure.name}: {problem}") from None
            _save(drawn, folder / f"{scene.name}_{figure.name}")


def _save(figure: Any, stem: Path) -> None:
    for suffix, settings in (
        (".svg", {"metadata": {"Date": None}}),
        (".png", {"dpi": 150, "metadata": {"Software": None}}),
    ):
        path = stem.with_suffix(suffix)
        with written_whole(path) as temporary:
            figure.savefig(temporary, format=suffix[1:], **settings)
    plt.close(figure)


def _curves(scene: Scene, dataset: xr.Dataset, figure: Figure) -> Any:
    settings = figure.settings
    chosen = dataset if "where" not in settings else dataset.where(select(dataset, settings["where"]))
    drawn, axes = plt.subplots()
    draw = _shaded_curves if settings["each"] else _coloured_curves
    draw(axes, chosen, settings)
    _printed_points(scene, axes, settings["points"])
    _scales(axes, settings["log"])
    formulas = list(settings["y"].values())
    axes.set(
        title=_plain(scene.title),
        xlabel=_plain(settings["x_label"]) if "x_label" in settings else _label(settings["x"]),
        ylabel=_plain(settings["y_label"])
        if "y_label" in settings
        else _label(formulas[0])
        if len(formulas) == 1
        else "",
    )
    lines = len(axes.get_legend_handles_labels()[0])
    if lines > MOST_LEGEND_LINES:
        axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.0, 0.5))
    elif lines > 1:
        axes.legend()
    return drawn


def _coloured_curves(axes: Any, dataset: xr.Dataset, settings: dict[str, Any]) -> None:
    """One curve for each formula, told apart by colour."""
    for number, (label, formula) in enumerate(settings["y"].items()):
        axes.plot(*_points(dataset, settings["x"], formula), label=_plain(label), color=PALETTE[number % len(PALETTE)])


def _shaded_curves(axes: Any, dataset: xr.Dataset, settings: dict[str, Any]) -> None:
    """A curve for each point of an axis, told apart by shade; formulas by dashes."""
    name = settings["each"]
    shades = plt.get_cmap("viridis")(np.linspace(0.0, 0.92, dataset.sizes[name]))
    for number, (label, formula) in enumerate(settings["y"].items()):
        dashes = DASHES[number % len(DASHES)]
        for i, shade in enumerate(shades):
            part = dataset.isel({name: i})
            value = f"{_word(name)} = {_point(part, name)}" if number == 0 else None
            axes.plot(*_points(part, settings["x"], formula), label=value, color=shade, linestyle=dashes)
        if len(settings["y"]) > 1:
            axes.plot([], [], label=_plain(label), color="black", linestyle=dashes)


def _point(part: xr.Dataset, axis: str) -> str:
    """A point of an axis in words: a number, a word, or the components of a vector."""
    return ", ".join(written(part[name]) for name in component_names(axis))


def _points(dataset: xr.Dataset, x: str, y: str) -> tuple[np.ndarray, np.ndarray]:
    along, across = xr.broadcast(evaluate(dataset, x), evaluate(dataset, y))
    return along.values.ravel(), across.values.ravel()


def _printed_points(scene: Scene, axes: Any, points: dict[str, str]) -> None:
    table = scene.published.table if scene.published else scene.reference.table if scene.reference else None
    if not points or table is None:
        return
    x = table.evaluate(points["x"])
    for number, (label, formula) in enumerate((k, v) for k, v in points.items() if k != "x"):
        colour = PALETTE[number % len(PALETTE)]
        axes.plot(x, table.evaluate(formula), "o", color=colour, markerfacecolor="white", label=_plain(label))


def _map(scene: Scene, dataset: xr.Dataset, figure: Figure) -> Any:
    settings = figure.settings
    value = evaluate(dataset, settings["value"])
    if "where" in settings:
        value = value.where(select(dataset, settings["where"]))
    value = value.isel(method=0, drop=True) if "method" in value.dims else value
    x, y = evaluate(dataset, settings["x"]), evaluate(dataset, settings["y"])
    missing, scenarios = int((~np.isfinite(value)).sum()), value.size
    # More cells than pixels cost time and show nothing.
    steps = {axis.dims[0]: slice(None, None, math.ceil(axis.size / MOST_CELLS)) for axis in (x, y)}
    x, y, value = x.isel({x.dims[0]: steps[x.dims[0]]}), y.isel({y.dims[0]: steps[y.dims[0]]}), value.isel(steps)
    value = value.transpose(*y.dims, *x.dims)
    drawn, axes = plt.subplots()
    finite = value.values[np.isfinite(value.values)]
    logarithmic = "value" in settings["log"]
    positive = finite[finite > 0.0] if logarithmic else finite
    norm = LogNorm(positive.min(), positive.max()) if logarithmic and positive.size else None
    shown = np.ma.masked_invalid(np.where(value.values > 0.0, value.values, np.nan) if logarithmic else value.values)
    axes.set_facecolor("#DDDDDD")
    mesh = axes.pcolormesh(x.values, y.values, shown, norm=norm, shading="nearest", cmap="viridis", rasterized=True)
    drawn.colorbar(mesh, ax=axes, label=_plain(settings.get("label", settings["value"])))
    _scales(axes, settings["log"].replace("value", "").strip())
    axes.grid(visible=False)
    note = f"\ngrey: no solution ({missing} of {scenarios})" if missing and "where" not in settings else ""
    axes.set(title=_plain(scene.title) + note, xlabel=_label(settings["x"]), ylabel=_label(settings["y"]))
    return drawn


def _profiles(scene: Scene, dataset: xr.Dataset, figure: Figure) -> Any:
    """The shape of every method at some values of one parameter, one panel each."""
    panels = list(_profile_panels(dataset, figure.settings["at"]))
    drawn, grid = plt.subplots(1, len(panels), figsize=(3.2 * len(panels) + 1, 3.0), sharey=True, squeeze=False)
    for axes, (heading, panel) in zip(grid[0], panels, strict=True):
        for number, method in enumerate(panel.method.values):
            profile = of_method(panel.profile, method)
            style = {"color": PALETTE[number % len(PALETTE)], "linestyle": DASHES[number % 4]}
            axes.plot(profile.sel(component="x"), profile.sel(component="z"), label=str(method), **style)
        axes.set(title=heading, xlabel="x [m]", aspect="equal")
    grid[0][0].set_ylabel("z [m]")
    grid[0][0].legend(loc="upper center")
    drawn.suptitle(_plain(scene.title))
    return drawn


def _profile_panels(dataset: xr.Dataset, at: dict[str, list[float | str]]) -> Iterator[tuple[str, xr.Dataset]]:
    """The scenarios at, or nearest to, the wanted values of the one parameter."""
    name, values = next(iter(at.items()))
    for value in values:
        points = dataset[name].values
        where = int((points == value).argmax() if isinstance(value, str) else np.abs(points - value).argmin())
        yield f"{_word(name)} {written(dataset[name][where])}", dataset.isel({dataset[name].dims[0]: where})


def _audit(scene: Scene, dataset: xr.Dataset, figure: Figure) -> Any:
    """Every cell of the printed table, coloured by its flag, with the printed value in it."""
    table = audit_table(scene, dataset)
    columns = list(dict.fromkeys(table["column"]))
    rows = sorted(set(table["row"]))
    flags = list(FLAG_COLOURS)
    colours = np.full((len(rows), len(columns)), np.nan)
    drawn, axes = plt.subplots(figsize=(1.35 * len(columns) + 1.5, 0.24 * len(rows) + 1.6))
    for cell in table.to_dict("records"):
        i, j = rows.index(cell["row"]), columns.index(cell["column"])
        colours[i, j] = flags.index(cell["flag"])
        wrong = cell["flag"] == MISPRINT
        exact = f"  ({cell['exact_at_argument']:.5g})" if wrong else ""
        axes.text(
            j,
            i,
            cell["printed"] + exact,
            ha="center",
            va="center",
            fontsize=7,
            fontweight="bold" if wrong else "normal",
        )
    palette = ListedColormap(list(FLAG_COLOURS.values()))
    axes.imshow(np.ma.masked_invalid(colours), aspect="auto", cmap=palette, norm=BoundaryNorm(np.arange(-0.5, 3), 3))
    axes.set_xticks(range(len(columns)), [_word(name) for name in columns], rotation=20, ha="left", fontsize=8)
    axes.xaxis.tick_top()
    axes.set_yticks(range(len(rows)), [str(row) for row in rows], fontsize=7)
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    counts = table["flag"].value_counts()
    handles = [plt.Rectangle((0, 0), 1, 1, color=colour) for colour in FLAG_COLOURS.values()]
    labels = [f"{flag} ({counts.get(flag, 0)})" for flag in FLAG_COLOURS]
    labels[flags.index(MISPRINT)] += ": printed (exact)"
    drawn.legend(handles, labels, loc="outside lower center", ncols=3)
    drawn.suptitle(_plain(scene.title))
    return drawn


def _scales(axes: Any, log: str) -> None:
    """Logarithmic axes, where there is anything positive to show on them."""
    lines = [line.get_xydata() for line in axes.get_lines()]
    points = np.concatenate([np.asarray(line) for line in lines]) if lines else np.ones((1, 2))
    for column, (name, set_scale) in enumerate((("x", axes.set_xscale), ("y", axes.set_yscale))):
        if name in log and (points[:, column] > 0.0).any():
            set_scale("log", nonpositive="mask")


def _label(formula: str) -> str:
    """The label of a quantity where a formula is just its name; else the formula itself."""
    return QUANTITIES[formula].label if formula in QUANTITIES else _plain(formula.replace("_", " "))


def _plain(text: str) -> str:
    """A user's text as it stands: a dollar sign starts no formula."""
    return text.replace("$", r"\$")


def _word(name: str) -> str:
    return name.replace("_", " ")
