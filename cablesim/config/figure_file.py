"""The `figures` part of a scene file: what each picture shows, rehearsed before anything is solved."""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from cablesim.config.axis_labels import (
    error_label,
    formula_label,
    label_keys,
    output_label,
    parameter_label,
    read_labels,
    side_label,
)
from cablesim.config.document import Node
from cablesim.config.figure_parts import (
    Stage,
    check_sides,
    check_stored,
    read_across,
    read_methods,
    read_number,
    read_panels,
    read_shapes,
    read_view,
)
from cablesim.config.history_figure import read_history
from cablesim.config.method import find_series
from cablesim.config.orbit_figure import read_orbit
from cablesim.config.place_file import fixed_axes
from cablesim.config.section_colours import read_colours
from cablesim.config.snapshot_figure import read_snapshots
from cablesim.config.status_figure import read_status_map
from cablesim.config.table import Table, read_table
from cablesim.labels import Label
from cablesim.quantities import COMPONENTS, RUN_TIME, SHORT, quantity

AUTOMATIC = "auto"


@dataclass(frozen=True)
class Figure:
    """What a picture shows; the settings were checked for their kind."""

    name: str
    kind: str
    settings: dict[str, Any]

    def label(self, axis: str) -> Label:
        """What stands beside an axis: x, y, in space z, or the value that colours of a map show."""
        labels: dict[str, Label] = self.settings["labels"]
        return labels[axis]


@dataclass(frozen=True)
class Points:
    """Points of a printed table: a formula for x, and one for each label."""

    table: Table
    x: str
    y: dict[str, str]


def read_figures(node: Node, stage: Stage) -> tuple[Figure, ...]:
    """The figures of a scene. Raises InputError naming file, line and key for what cannot be drawn."""
    readers = {
        "curves": _read_curves,
        "map": _read_map,
        "status_map": read_status_map,
        "profiles": _read_profiles,
        "spatial": _read_spatial,
        "history": read_history,
        "orbit": read_orbit,
        "snapshots": read_snapshots,
        "animation": read_snapshots,
        "convergence": _read_convergence,
        "audit": _read_audit,
        "work_precision": _read_work_precision,
    }
    figures = []
    for name, entry in node.named_entries().items():
        kind = entry.mapping(("kind",), None)["kind"].choice(tuple(readers))
        figures.append(Figure(name, kind, readers[kind](entry, stage)))
    return tuple(figures)


def _read_curves(node: Node, stage: Stage) -> dict[str, Any]:
    look = ("points", "log", "draw", *label_keys("x", "y", "each"))
    keys = node.mapping(("kind", "x", "y"), ("where", "point", "each", *look))
    lines = keys["y"].mapping(optional=None) if isinstance(keys["y"].value, dict) else {"": keys["y"]}
    if not lines:
        keys["y"].fail("at least one formula is needed")
    each = keys["each"].choice(tuple(axis.name for axis in stage.names.design.axes)) if "each" in keys else None
    position = fixed_axes(keys, stage.names)
    if each in position:
        keys["each"].fail(f"one point of {each} is chosen already, under point")
    x, along_x = read_number(keys["x"], stage)
    formulas = {}
    for name, entry in lines.items():
        formulas[name], along_y = read_number(entry, stage)
        along = sorted((along_x | along_y) - {each, *position})
        if len(along) != 1:
            entry.fail(
                f"a curve varies along one axis, not {' and '.join(along) or 'none'}: choose with each, or a method"
            )
    labels = {
        "x": formula_label([keys["x"]], stage.names),
        "y": formula_label(list(lines.values()), stage.names),
        **({"each": parameter_label(each)} if each else {}),
    }
    return {
        "x": x,
        "y": formulas,
        "each": each,
        "position": position,
        "labels": read_labels(keys, labels),
        "points": _read_points(keys["points"], stage, labels) if "points" in keys else None,
        "log": keys["log"].choice(("x", "y", "xy")) if "log" in keys else "",
        "draw": keys["draw"].choice(("lines", "marks")) if "draw" in keys else "lines",
        **_where(keys, stage),
    }


def _read_points(node: Node, stage: Stage, labels: dict[str, Label]) -> Points:
    """Printed points: from a table of their own, else from the one that the scene is audited or measured against.

    They are in the SI units of the axes, as everything is.
    """
    entries = node.mapping(("x",), None)
    table = read_table(entries.pop("table")) if "table" in entries else stage.points
    if table is None:
        node.fail("points need a table: here, or as the published or the reference table of the scene")
    formulas = {name: entry.formula() for name, entry in entries.items()}
    for name, formula in formulas.items():
        node.located(table.evaluate, formula, labels["x" if name == "x" else "y"].unit)
    return Points(table, formulas.pop("x"), formulas)


def _read_map(node: Node, stage: Stage) -> dict[str, Any]:
    look = ("log", "contours", *label_keys("x", "y", "value"))
    keys = node.mapping(("kind", "x", "y", "value"), ("where", "point", *look))
    settings: dict[str, Any] = {"position": fixed_axes(keys, stage.names)}
    along = {}
    for name in ("x", "y", "value"):
        settings[name], varies = read_number(keys[name], stage)
        along[name] = varies - set(settings["position"])
    check_sides(keys, {name: along[name] for name in ("x", "y")})
    others = sorted(along["value"] - along["x"] - along["y"])
    if others:
        keys["value"].fail(f"the value also varies along {others[0]}: choose one, as in method.output")
    logs = ("x", "y", "xy", "value", "x value", "y value", "xy value")
    log = keys["log"].choice(logs) if "log" in keys else ""
    labels = {name: formula_label([keys[name]], stage.names) for name in ("x", "y", "value")}
    return {
        **settings,
        "log": log,
        "labels": read_labels(keys, labels),
        "contours": _read_contours(keys["contours"], labels["value"].unit) if "contours" in keys else (),
        **_where(keys, stage),
    }


def _read_contours(node: Node, unit: str) -> tuple[float, ...]:
    """Values that lines are drawn at, in SI and in ascending order."""
    values = tuple(entry.number(unit) for entry in node.sequence())
    if any(after <= before for before, after in pairwise(values)):
        node.fail("values in ascending order are expected")
    return values


def _read_profiles(node: Node, stage: Stage) -> dict[str, Any]:
    """Panels, one for each value of `at`; in each a curve for each value of `each` and for each method."""
    look = ("view", "points", "titles", "across", "stretch", "colour", "names", *label_keys("x", "y"))
    keys = node.mapping(("kind",), ("at", "each", "point", "methods", *look))
    _check_profiles(node, stage)
    panels, methods = read_panels(node, keys, stage), read_methods(keys, stage)
    positions = [shape.position for panel in panels for shape in panel.shapes]
    view = read_view(keys)
    labels = {axis: side_label("profile", side) for axis, side in zip("xy", view, strict=True)}
    return {
        "panels": panels,
        "across": read_across(keys, len(panels)),
        "methods": methods,
        "view": view,
        "labels": read_labels(keys, labels),
        "stretch": _read_stretch(keys["stretch"]) if "stretch" in keys else 1.0,
        "colours": read_colours(keys, stage.names, positions, len(panels[0].shapes) * len(methods)),
        "points": _read_points(keys["points"], stage, labels) if "points" in keys else None,
    }


def _check_profiles(node: Node, stage: Stage) -> None:
    check_stored(node, stage, "profiles", ("profile",))


def _read_stretch(node: Node) -> float | None:
    """By how much heights are drawn too large; None where each panel has a factor of its own."""
    if node.value == AUTOMATIC:
        return None
    factor = node.number("1")
    if factor <= 0.0:
        node.fail(f"a number > 0, or {AUTOMATIC}, is expected, not {factor:g}")
    return factor


def _read_spatial(node: Node, stage: Stage) -> dict[str, Any]:
    keys = node.mapping(("kind",), ("each", "point", "methods"))
    _check_profiles(node, stage)
    return {
        "shapes": read_shapes(node, keys, None, stage),
        "methods": read_methods(keys, stage),
        # There is room for letters alone.
        "labels": {side: replace(side_label("profile", side), words="") for side in COMPONENTS},
    }


def _read_convergence(node: Node, stage: Stage) -> dict[str, Any]:
    """The error of an output, against the option that methods of the scene differ in, or against their run time."""
    keys = node.mapping(("kind", "output", "against"), label_keys("x", "y"))
    if stage.reference is None:
        node.fail("an error needs a method as the scene's reference")
    outputs = tuple(name for name in stage.names.outputs if quantity(name).dims in SHORT)
    options = tuple(dict.fromkeys(series.option for series in find_series(stage.methods, stage.reference)))
    if not options:
        node.fail("three methods or more that differ in one numerical option alone are needed")
    output, against = keys["output"].choice(outputs), keys["against"].choice((*options, RUN_TIME))
    labels = {"x": parameter_label(against), "y": error_label(output)}
    return {"output": output, "against": against, "labels": read_labels(keys, labels)}


def _read_audit(node: Node, stage: Stage) -> dict[str, Any]:
    node.mapping(("kind",))
    if not stage.audited:
        node.fail("a figure of an audit needs a published table")
    return {}


def _read_work_precision(node: Node, stage: Stage) -> dict[str, Any]:
    """Methods that differ in one option alone are joined; where they make a net, `join` says along which option."""
    keys = node.mapping(("kind",), ("join",))
    if stage.timed is None:
        node.fail("a figure of error against run time needs the scene's work_precision")
    options = tuple(dict.fromkeys(series.option for series in find_series(stage.methods, stage.reference)))
    return {
        "join": keys["join"].choice(options) if "join" in keys else None,
        "labels": {"x": output_label("run time a scenario", RUN_TIME), "y": error_label(stage.timed)},
    }


def _where(keys: dict[str, Node], stage: Stage) -> dict[str, str]:
    if "where" not in keys:
        return {}
    keys["where"].located(stage.names.condition, keys["where"].formula())
    return {"where": keys["where"].formula()}
