"""The `figures` part of a scene file: what each picture shows, rehearsed before anything is solved."""

from dataclasses import dataclass
from typing import Any

from cablesim.config.document import Node, is_name
from cablesim.config.rehearsal import METHOD, Rehearsal
from cablesim.config.table import Table

KINDS = ("curves", "map", "profiles", "audit")


@dataclass(frozen=True)
class Figure:
    """What a picture shows; the settings were checked for their kind."""

    name: str
    kind: str
    settings: dict[str, Any]


@dataclass(frozen=True)
class Stage:
    """What figures are checked against: names of the scene, a table with points to draw, whether it is audited."""

    names: Rehearsal
    points: Table | None
    audited: bool


def read_figures(node: Node, stage: Stage) -> tuple[Figure, ...]:
    """The figures of a scene. Raises InputError naming file, line and key for what cannot be drawn."""
    readers = {"curves": _read_curves, "map": _read_map, "profiles": _read_profiles, "audit": _read_audit}
    figures = []
    for name, entry in node.mapping(optional=None).items():
        if not is_name(name):
            entry.fail(f"{name!r:.60} is not a name (letters, digits, underscores; starting with a letter)")
        kind = entry.mapping(("kind",), None)["kind"].choice(KINDS)
        figures.append(Figure(name, kind, readers[kind](entry, stage)))
    return tuple(figures)


def _read_curves(node: Node, stage: Stage) -> dict[str, Any]:
    keys = node.mapping(("kind", "x", "y"), ("where", "points", "log", "x_label", "y_label", "each"))
    lines = keys["y"].mapping(optional=None) if isinstance(keys["y"].value, dict) else {"": keys["y"]}
    if not lines:
        keys["y"].fail("at least one formula is needed")
    each = keys["each"].choice(tuple(axis.name for axis in stage.names.design.axes)) if "each" in keys else None
    x, along_x = _number(keys["x"], stage)
    formulas = {}
    for name, entry in lines.items():
        formulas[name], along_y = _number(entry, stage)
        along = sorted((along_x | along_y) - {each})
        if len(along) != 1:
            entry.fail(
                f"a curve varies along one axis, not {' and '.join(along) or 'none'}: choose with each, or a method"
            )
    return {
        "x": x,
        "y": formulas,
        "each": each,
        "points": _read_points(keys["points"], stage) if "points" in keys else {},
        "log": keys["log"].choice(("x", "y", "xy")) if "log" in keys else "",
        **_texts(keys, ("x_label", "y_label")),
        **_where(keys, stage),
    }


def _read_points(node: Node, stage: Stage) -> dict[str, str]:
    points = {name: entry.formula() for name, entry in node.mapping(("x",), None).items()}
    if stage.points is None:
        node.fail("points need a published table or a reference table")
    for formula in points.values():
        node.located(stage.points.evaluate, formula)
    return points


def _read_map(node: Node, stage: Stage) -> dict[str, Any]:
    keys = node.mapping(("kind", "x", "y", "value"), ("log", "label", "where"))
    settings, along = {}, {}
    for name in ("x", "y", "value"):
        settings[name], along[name] = _number(keys[name], stage)
    for name in ("x", "y"):
        if len(along[name]) != 1:
            keys[name].fail("a side of a map varies along one axis")
    if along["x"] == along["y"]:
        keys["y"].fail(f"both sides of the map vary along {along['x'].pop()}")
    others = sorted(along["value"] - along["x"] - along["y"])
    if others:
        keys["value"].fail(f"the value also varies along {others[0]}: choose one, as in method.output")
    logs = ("x", "y", "xy", "value", "x value", "y value", "xy value")
    log = keys["log"].choice(logs) if "log" in keys else ""
    return {**settings, "log": log, **_texts(keys, ("label",)), **_where(keys, stage)}


def _read_profiles(node: Node, stage: Stage) -> dict[str, Any]:
    if "profile" not in stage.names.outputs:
        node.fail("a figure of profiles needs the output 'profile'")
    keys = node.mapping(("kind", "at"))
    axes = stage.names.design.axes
    if len(axes) != 1:
        node.fail("a figure of profiles needs a scene with one axis")
    entries = keys["at"].mapping(optional=None)
    if len(entries) != 1:
        keys["at"].fail("one parameter and its values are expected")
    name, entry = next(iter(entries.items()))
    if name not in axes[0].columns:
        entry.fail(f"'{name}' does not vary in this scene")
    return {"at": {name: [_read_point(item, name, stage) for item in entry.sequence()]}}


def _read_point(node: Node, name: str, stage: Stage) -> float | str:
    """A value of a varying parameter; a word must be one that occurs."""
    spec = stage.names.parameters[name]
    if not spec.words:
        return node.number(spec.unit)
    return node.choice(tuple(spec.restored(stage.names.design.axes[0].columns[name]).tolist()))


def _read_audit(node: Node, stage: Stage) -> dict[str, Any]:
    node.mapping(("kind",))
    if not stage.audited:
        node.fail("a figure of an audit needs a published table")
    return {}


def _number(node: Node, stage: Stage) -> tuple[str, set[str]]:
    """A formula and the axes along which it varies; a scene's only method needs no choosing."""
    formula = node.formula()
    along = node.located(stage.names.number, formula)
    if "node" in along:
        node.fail("a profile has many values a scenario: only a figure of kind profiles shows it")
    if "component" in along:
        node.fail("a vector has three values a scenario: take a component, as in force_B_z")
    return formula, along - {METHOD} if len(stage.names.methods) == 1 else along


def _where(keys: dict[str, Node], stage: Stage) -> dict[str, str]:
    if "where" not in keys:
        return {}
    keys["where"].located(stage.names.condition, keys["where"].formula())
    return {"where": keys["where"].formula()}


def _texts(keys: dict[str, Node], names: tuple[str, ...]) -> dict[str, str]:
    return {name: keys[name].text() for name in names if name in keys}
