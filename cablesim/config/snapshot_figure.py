"""Figures of kind `snapshots` and `animation`: the line through a period, coloured by its tension."""

from typing import Any

from cablesim.config.axis_labels import label_keys, output_label, read_labels, side_label
from cablesim.config.document import Node
from cablesim.config.figure_parts import Stage, check_stored, read_across, read_panels, read_view

OUTPUTS = ("snapshots", "snapshot_tension", "profile")


def read_snapshots(node: Node, stage: Stage) -> dict[str, Any]:
    """Panels, one for each value of `at`, each of one scenario and one method."""
    look = ("view", "magnify", "titles", "across", *label_keys("x", "y", "value"))
    keys = node.mapping(("kind",), ("at", "point", "method", *look))
    check_stored(node, stage, "snapshots", OUTPUTS)
    panels, view = read_panels(node, keys, stage), read_view(keys)
    labels = {axis: side_label("snapshots", side) for axis, side in zip("xy", view, strict=True)}
    labels["value"] = output_label("tension", "snapshot_tension", "kN")
    return {
        "panels": panels,
        "across": read_across(keys, len(panels)),
        "method": _read_method(node, keys, stage),
        "view": view,
        "labels": read_labels(keys, labels),
        "magnify": _read_magnify(keys["magnify"]) if "magnify" in keys else 1.0,
    }


def _read_method(node: Node, keys: dict[str, Node], stage: Stage) -> str:
    if "method" in keys:
        return keys["method"].choice(stage.names.methods)
    if len(stage.names.methods) > 1:
        node.fail(f"snapshots are those of one method: choose 'method' among {', '.join(stage.names.methods)}")
    return stage.names.methods[0]


def _read_magnify(node: Node) -> float:
    """By how much the motion is drawn too large."""
    factor = node.number("1")
    if factor <= 0.0:
        node.fail(f"a number > 0 is expected, not {factor:g}")
    return factor
