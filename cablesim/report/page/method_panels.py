"""Interactive figures of methods: convergence, error against run time, and audits of printed tables."""

from typing import Any

import altair as alt
import numpy as np
import xarray as xr

from cablesim.config.figure_file import RUN_TIME, Figure
from cablesim.config.scene import AGREES, MISPRINT, ROUNDED_KEY, Scene
from cablesim.report.audit import audit_table
from cablesim.report.drawing import word
from cablesim.report.figures import FLAG_COLOURS
from cablesim.report.orders import convergences
from cablesim.report.page.columns import Columns, column
from cablesim.report.page.panel import Panel, coloured, dashed, fading, joined, movable, palette, rows, scale
from cablesim.report.precision import TARGETS, WorkAndPrecision, Worth, changed_options, work_and_precision
from cablesim.report.precision_figure import FRONT, LEAST, groups

DIAGRAM_HEIGHT, CELL_HEIGHT = 360, 15
MOST_ROWS = 60
UNTOLD = "#B8B8B8"
# More than there are colours, so that both together tell apart.
MARKS = (
    "circle", "square", "diamond", "triangle-down", "cross", "triangle-up", "triangle-right", "triangle-left", "arrow",
    "wedge", "stroke",
)  # fmt: skip


def convergence_panels(scene: Scene, dataset: xr.Dataset, figure: Figure) -> list[Panel]:
    """Largest error of an output along each series of methods, against the option or the run time."""
    settings = figure.settings
    against, output = settings["against"], settings["output"]
    found = convergences(scene, dataset, output)
    parts = []
    for name, one in found.items():
        if against not in (one.series.option, RUN_TIME):
            continue
        x = one.run_times * figure.label("x").factor if against == RUN_TIME else np.array(one.series.values)
        label = f"{word(name)}: order {one.order:.2f}"
        methods = [method.name for method in one.series.methods]
        parts.append(
            {
                "x": column(x),
                "y": column(one.errors * figure.label("y").factor),
                "series": [label] * len(x),
                "method": methods,
            }
        )
    return [_log_lines(joined(parts), figure)]


def _log_lines(data: Columns, figure: Figure) -> Panel:
    names = list(dict.fromkeys(data["series"]))
    choice, opacity = fading()
    line = rows().mark_line(point=True, strokeWidth=1.6)
    chart = line.encode(
        **_log_axes(figure, data),
        color=coloured(names),
        strokeDash=dashed(names, list(range(len(names)))),
        opacity=opacity,
        tooltip=["method:N", "x:Q", alt.Tooltip("y:Q", format=".3~g"), alt.Tooltip("series:N", title=" ")],
    )
    return Panel(movable(chart.add_params(choice)), {"rows": data}, height=DIAGRAM_HEIGHT)


def _log_axes(figure: Figure, data: Columns) -> dict[str, Any]:
    """Both sides, logarithmic."""
    return {
        "x": alt.X("x:Q", title=figure.label("x").plain, **scale(data["x"], True, padding=8)),
        "y": alt.Y("y:Q", title=figure.label("y").plain, **scale(data["y"], True, padding=8)),
    }


def precision_panels(scene: Scene, dataset: xr.Dataset, figure: Figure) -> list[Panel]:
    """Methods that differ in one option are joined; the front in grey; open marks where not everything is solved."""
    found = work_and_precision(scene, dataset)
    parts = [_group(name, members) for name, members in groups(scene, found, figure.settings["join"]).items()]
    data = joined(parts)
    names = list(dict.fromkeys(data["series"]))
    choice, opacity = fading()
    x, y = _log_axes(figure, data).values()
    legend = alt.Legend(title=None)
    colour = alt.Color("series:N", sort=None, scale=palette(names), legend=legend)
    front = rows("front").mark_line(interpolate="step-after", color=FRONT, strokeWidth=6).encode(x=x, y=y)
    line = rows().mark_line(strokeWidth=1.2).encode(x=x, y=y, color=colour, opacity=opacity, order="order:Q")
    spread = rows().mark_rule().encode(x="lowest:Q", x2="highest", y=y, color=colour, opacity=opacity)
    tooltip = [
        "method:N",
        "options:N",
        alt.Tooltip("x:Q", title="seconds a scenario", format=".3~s"),
        alt.Tooltip("y:Q", title="largest error", format=".2~e"),
        "solved:N",
    ]
    forms = alt.Scale(domain=names, range=[MARKS[i % len(MARKS)] for i in range(len(names))])
    shape = alt.Shape("series:N", sort=None, scale=forms, legend=legend)
    fill = alt.condition("datum.all", colour, alt.value("white"))
    mark = rows().mark_point(size=70, strokeWidth=1.6, opacity=1)
    point = mark.encode(x=x, y=y, color=colour, fill=fill, shape=shape, opacity=opacity, tooltip=tooltip)
    targets = rows("targets").mark_rule(strokeDash=[2, 3], color="#555555").encode(y=alt.Y("y:Q"))
    told = rows("told").mark_rule(color=UNTOLD, strokeWidth=3).encode(y="y:Q", tooltip="words:N")
    layers = [front, targets, told, line, spread, movable(point.add_params(choice))]
    tables = {"rows": data, "front": _front(found), "targets": {"y": list(TARGETS)}, "told": _told(found)}
    return [Panel(alt.layer(*layers), tables, height=DIAGRAM_HEIGHT)]


def _group(name: str, members: list[Worth]) -> Columns:
    return {
        "x": column([one.run_time for one in members]),
        "y": column([max(one.largest, LEAST) for one in members]),
        "lowest": column([one.times["run_time_lowest"] for one in members]),
        "highest": column([one.times["run_time_highest"] for one in members]),
        "order": list(range(len(members))),
        "series": [name] * len(members),
        "method": [one.name for one in members],
        "options": [changed_options(one.method) or "as they are" for one in members],
        "solved": [f"{one.solved} of {one.errors.size}" for one in members],
        "all": [bool(one.solves_all) for one in members],
    }


def _front(found: WorkAndPrecision) -> Columns:
    return {
        "x": column([one.run_time for one in found.front]),
        "y": column([max(one.largest, found.least_told, LEAST) for one in found.front]),
    }


def _told(found: WorkAndPrecision) -> Columns:
    """Where errors end that the reference can tell; nothing where it tells all that are drawn."""
    if not found.least_told > LEAST:
        return {"y": [], "words": []}
    return {"y": column([found.least_told]), "words": ["errors below this are not told apart from the reference's own"]}


def audit_panels(scene: Scene, dataset: xr.Dataset, figure: Figure) -> list[Panel]:
    """Every printed cell in the colour of its verdict; of a long table only the rows in which one does not agree."""
    table = audit_table(scene, dataset)
    off = scene.published.off if scene.published else MISPRINT
    flags = [AGREES, ROUNDED_KEY, off]
    if table["row"].nunique() > MOST_ROWS:
        table = table[table["row"].isin(table.loc[table["flag"] != AGREES, "row"])]
    head = str(table.columns[1])
    counts = table["flag"].value_counts()
    words = {flag: f"{flag} ({counts.get(flag, 0)})" for flag in flags}
    data: Columns = {
        "row": table["row"].tolist(),
        "head": table[head].astype(str).tolist(),
        "column": [word(name) for name in table["column"]],
        "printed": table["printed"].astype(str).tolist(),
        "ours": column(table["exact_at_argument"].to_numpy(), 8),
        "difference": column(table["difference"].to_numpy()),
        "verdict": [words[flag] for flag in table["flag"]],
    }
    verdicts = alt.Scale(domain=list(words.values()), range=list(FLAG_COLOURS))
    base = rows().encode(
        x=alt.X(
            "column:N",
            sort=None,
            title=None,
            axis=alt.Axis(orient="top", labelAngle=-25, labelLimit=140, labelOverlap=False),
        ),
        y=alt.Y("row:O", title="row", axis=alt.Axis(labelOverlap=False)),
    )
    legend = alt.Legend(title=None, symbolType="square")
    cells = base.mark_rect(stroke="white").encode(
        color=alt.Color("verdict:N", sort=None, scale=verdicts, legend=legend)
    )
    tooltip: list[Any] = [alt.Tooltip("head:N", title=word(head)), "column:N", "printed:N", "ours:Q", "difference:Q"]
    words_in_cells = base.mark_text(fontSize=9).encode(text="printed:N", tooltip=[*tooltip, "verdict:N"])
    height = CELL_HEIGHT * table["row"].nunique()
    return [
        Panel(alt.layer(cells.encode(tooltip=[*tooltip, "verdict:N"]), words_in_cells), {"rows": data}, height=height)
    ]
