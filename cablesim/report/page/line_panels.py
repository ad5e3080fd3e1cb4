"""Interactive pictures of the line itself: profiles, views of a line in space, orbits, and the line in waves."""

from typing import Any

import altair as alt
import numpy as np
import xarray as xr

from cablesim.config.figure_file import Figure
from cablesim.config.figure_parts import Shape
from cablesim.config.scene import Scene
from cablesim.report.drawing import NEWTONS_PER_KILONEWTON, PALETTE, styled
from cablesim.report.page.columns import Columns, column
from cablesim.report.page.panel import (
    DASHES,
    Panel,
    box,
    coloured,
    fading,
    height_over_width,
    hollow,
    joined,
    printed_points,
    rows,
    scenario_numbers,
    styled_lines,
)
from cablesim.report.sections import section_parts
from cablesim.report.shapes import own_stretch

SPATIAL_VIEWS = {"xz": "from the side", "yz": "along the stream", "xy": "from above"}
REST = {"color": "#222222", "strokeDash": [5, 4], "strokeWidth": 1.2}


def profile_panels(scene: Scene, dataset: xr.Dataset, figure: Figure) -> list[Panel]:
    """Shapes of the line; scales are equal but for the factor that heights are drawn too large by."""
    settings = figure.settings
    draw = _sections if settings["colours"] is not None else _lines
    drawn = [draw(dataset, panel.shapes, settings) for panel in settings["panels"]]
    printed = printed_points(settings["points"])
    shared = settings["stretch"] is not None
    common = box(*_extent([data for _, data in drawn], printed))
    panels = []
    for panel, (layers, data) in zip(settings["panels"], drawn, strict=True):
        ranges = common if shared else box(*_extent([data], printed))
        stretch = settings["stretch"] or own_stretch(*(high - low for low, high in ranges))
        if printed["x"]:
            layers, data = [*layers, hollow(printed)], {**data, "points": printed}
        title = panel.title + ("" if stretch == 1.0 else f" (heights × {stretch:g})")
        chart = _framed(layers, ranges, _titles(settings))
        panels.append(Panel(chart, data, title, aspect=height_over_width(ranges, stretch)))
    return panels


def spatial_panels(scene: Scene, dataset: xr.Dataset, figure: Figure) -> list[Panel]:
    """Lines in space from three sides."""
    settings, panels = figure.settings, []
    for view, words in SPATIAL_VIEWS.items():
        layers, data = _lines(dataset, settings["shapes"], {**settings, "view": view})
        ranges = box(*_extent([data]))
        # A view along which the line is nearly straight would be a hair: its scales differ.
        aspect = height_over_width(ranges)
        titles = [f"{component} [m]" for component in view]
        panels.append(Panel(_framed(layers, ranges, titles), data, words, aspect=aspect))
    return panels


def orbit_panels(scene: Scene, dataset: xr.Dataset, figure: Figure) -> list[Panel]:
    """The path of the middle of the line through the last period, closed, around the place at rest."""
    settings = figure.settings
    view, styles = list(settings["view"]), styled(settings["shapes"], settings["methods"])
    numbers, parts = scenario_numbers(dataset), []
    for style in styles:
        path = style.line(dataset).orbit.sel(component=view).transpose("component", "phase").values
        parts.append(_points(np.concatenate([path, path[:, :1]], axis=1), style.label, numbers, style.shape))
    data = {"rows": joined(parts)}
    ranges = box(*_extent([data], {"x": [0.0], "y": [0.0]}))
    base = _base([s.label for s in styles], **styled_lines(styles))
    rest = alt.Chart(alt.InlineData([{"x": 0, "y": 0}])).mark_point(shape="cross", size=90, color="black", filled=True)
    titles = [settings.get(f"{a}_label", f"{c} from the place at rest [m]") for a, c in zip("xy", view, strict=True)]
    chart = _framed([base.mark_line(point=True), rest.encode(x="x:Q", y="y:Q")], ranges, titles)
    return [Panel(chart, data, aspect=height_over_width(ranges))]


def snapshot_panels(scene: Scene, dataset: xr.Dataset, figure: Figure) -> list[Panel]:
    """The line at the phases of the last period, each element in the colour of its tension; dashed at rest."""
    settings = figure.settings
    chosen = dataset.sel({"method": settings["method"]}, drop=True)
    drawn = [
        _elements(chosen.isel(panel.shapes[0].position), settings, scenario_numbers(dataset), panel.shapes[0])
        for panel in settings["panels"]
    ]
    ranges = box(*_extent(drawn))
    highest = max((t for data in drawn for t in data["rows"]["tension"] if t is not None), default=1.0)
    colour = alt.Color(
        "tension:Q",
        scale=alt.Scale(scheme="viridis", domain=[0, highest]),
        legend=alt.Legend(title="tension [kN]", direction="horizontal"),
    )
    tooltip = [alt.Tooltip("tension:Q", title="tension [kN]", format=".4~g"), alt.Tooltip("phase:Q", format=".2f")]
    moved = f" (motion × {settings['magnify']:g})" if settings["magnify"] != 1.0 else ""
    panels = []
    for panel, data in zip(settings["panels"], drawn, strict=True):
        phases = sorted(set(data["rows"]["phase"]))
        slider = alt.binding_range(min=0, max=len(phases), step=1, name="moment of the period (0: all) ")
        moment = alt.param(name="moment", value=0, bind=slider)
        shown = alt.condition("moment === 0 || datum.moment === moment", alt.value(1.0), alt.value(0.08))
        rule = rows().mark_rule(strokeWidth=1.6)
        elements = rule.encode(x="x:Q", y="y:Q", x2="x2", y2="y2", color=colour, opacity=shown).add_params(moment)
        rest = rows("rest").mark_line(**REST).encode(x="x:Q", y="y:Q", order="node:Q")
        chart = _framed([elements.encode(tooltip=tooltip), rest], ranges, _titles(settings))
        panels.append(Panel(chart, data, panel.title + moved, aspect=height_over_width(ranges)))
    return panels


def _titles(settings: dict[str, Any]) -> list[str]:
    return [settings.get(f"{a}_label", f"{c} [m]") for a, c in zip("xy", settings["view"], strict=True)]


def _framed(layers: list[Any], ranges: list[list[float]], titles: list[str]) -> Any:
    """Layers with the same two scales."""
    channels = {
        name: channel(f"{name}:Q", title=title, scale=alt.Scale(domain=given, nice=False, zero=False))
        for name, channel, title, given in zip("xy", (alt.X, alt.Y), titles, ranges, strict=True)
    }
    first, *others = layers
    return alt.layer(first.encode(**channels), *others)


def _base(names: list[str], **channels: Any) -> Any:
    choice, opacity = fading()
    tooltip = [alt.Tooltip("series:N", title=" "), alt.Tooltip("x:Q", format=".4~g"), alt.Tooltip("y:Q", format=".4~g")]
    return (
        rows().encode(x="x:Q", y="y:Q", order="node:Q", opacity=opacity, tooltip=tooltip, **channels).add_params(choice)
    )


def _points(places: np.ndarray, series: str, numbers: xr.DataArray, shape: Shape) -> Columns:
    """Places of shape (2, node) as rows."""
    count = places.shape[1]
    number = int(numbers.isel(shape.position).item())
    return {
        "x": column(places[0]),
        "y": column(places[1]),
        "node": list(range(count)),
        "series": [series] * count,
        "scenario": [number] * count,
    }


def _lines(dataset: xr.Dataset, shapes: list[Shape], settings: dict[str, Any]) -> tuple[list[Any], dict[str, Columns]]:
    styles, view = styled(shapes, settings["methods"]), list(settings["view"])
    numbers, parts = scenario_numbers(dataset), []
    for style in styles:
        places = style.line(dataset).profile.sel(component=view).transpose("component", "node").values
        parts.append(_points(places, style.label, numbers, style.shape))
    line = _base([style.label for style in styles], **styled_lines(styles)).mark_line(strokeWidth=1.8)
    return [line], {"rows": joined(parts)}


def _sections(
    dataset: xr.Dataset, shapes: list[Shape], settings: dict[str, Any]
) -> tuple[list[Any], dict[str, Columns]]:
    """Each section in its colour, told apart by dashes if there are several lines; joints and the lowest point."""
    view, labels = list(settings["view"]), list(settings["colours"].labels)
    numbers, parts, marks = scenario_numbers(dataset), [], []
    styles = styled(shapes, settings["methods"])
    for style in styles:
        line = style.line(dataset)
        joints = line.joint_position.dropna("section").sel(component=view).values
        colours = settings["colours"].numbers(line.section_weight.values[: len(joints)])
        for i, (colour, part) in enumerate(zip(colours, section_parts(line, joints, view), strict=True)):
            own = _points(part.T, labels[colour], numbers, style.shape)
            parts.append({**own, "line": [style.label] * len(part), "part": [f"{style.label} {i}"] * len(part)})
        lowest = line.lowest_point.sel(component=view).values
        for words, place in [*(("joint", joint) for joint in joints[:-1]), ("lowest point", lowest)]:
            marks.append({**_points(place[:, None], words, numbers, style.shape)})
    choice, opacity = fading()
    names = [style.label for style in styles]
    line = (
        rows()
        .mark_line(strokeWidth=2.4)
        .encode(
            x="x:Q",
            y="y:Q",
            order="node:Q",
            detail="part:N",
            opacity=opacity,
            color=coloured(labels, [PALETTE[i] for i in range(len(labels))]),
            strokeDash=alt.StrokeDash(
                "line:N",
                sort=None,
                scale=alt.Scale(domain=names, range=[DASHES[i % len(DASHES)] for i in range(len(names))]),
                legend=alt.Legend(title=None, symbolType="stroke") if len(names) > 1 else None,
            ),
            tooltip=["line:N", "series:N", alt.Tooltip("x:Q", format=".4~g"), alt.Tooltip("y:Q", format=".4~g")],
        )
    )
    point = (
        rows("marks")
        .mark_point(filled=True, size=55, color="black", opacity=1)
        .encode(
            x="x:Q",
            y="y:Q",
            shape=alt.Shape(
                "series:N",
                scale=alt.Scale(domain=["joint", "lowest point"], range=["circle", "triangle-down"]),
                legend=alt.Legend(title=None),
            ),
            tooltip=[
                alt.Tooltip("series:N", title=" "),
                alt.Tooltip("x:Q", format=".4~g"),
                alt.Tooltip("y:Q", format=".4~g"),
            ],
        )
    )
    return [line.add_params(choice), point], {"rows": joined(parts), "marks": joined(marks)}


def _elements(line: xr.Dataset, settings: dict[str, Any], numbers: xr.DataArray, shape: Shape) -> dict[str, Columns]:
    view = list(settings["view"])
    rest = line.profile.sel(component=view).transpose("node", "component").values
    places = line.snapshots.sel(component=view).transpose("phase", "node", "component").values
    places = rest + settings["magnify"] * (places - rest)
    tension = line.snapshot_tension.transpose("phase", "node").values / NEWTONS_PER_KILONEWTON
    phases, elements = places.shape[0], places.shape[1] - 1
    return {
        "rows": {
            "x": column(places[:, :-1, 0]),
            "y": column(places[:, :-1, 1]),
            "x2": column(places[:, 1:, 0]),
            "y2": column(places[:, 1:, 1]),
            "tension": column(0.5 * (tension[:, :-1] + tension[:, 1:]), 4),
            "moment": np.repeat(np.arange(1, phases + 1), elements).tolist(),
            "phase": column(np.repeat(np.arange(phases) / phases, elements), 4),
            "scenario": [int(numbers.isel(shape.position).item())] * (phases * elements),
        },
        "rest": {"x": column(rest[:, 0]), "y": column(rest[:, 1]), "node": list(range(len(rest)))},
    }


def _extent(drawn: list[dict[str, Columns]], *more: Columns) -> list[np.ndarray]:
    """All numbers along x and along y."""
    found = [*(columns for data in drawn for columns in data.values()), *more]
    return [
        np.array([value for one in found for key in keys for value in one.get(key, []) if value is not None])
        for keys in (("x", "x2"), ("y", "y2"))
    ]
