"""Figures of kind `snapshots`: the line at some phases of a period, coloured by its tension."""

from typing import Any

from cablesim.config.document import Node
from cablesim.config.figure_parts import Stage, check_stored, read_across, read_panels, read_texts, read_view

OUTPUTS = ("snapshots", "snapshot_tension", "profile")


def read_snapshots(node: Node, stage: Stage) -> dict[str, Any]:
    """Panels, one for each value of `at`, each of one scenario and one method."""
    look = ("view", "magnify", "titles", "across", "x_label", "y_label")
    keys = node.mapping(("kind",), ("at", "point", "method", *look))
    check_stored(node, stage, "snapshots", OUTPUTS)
    panels = read_panels(node, keys, stage)
    return {
        "panels": panels,
        "across": read_across(keys, len(panels)),
        "method": _read_method(node, keys, stage),
        "view": read_view(keys),
        "magnify": _read_magnify(keys["magnify"]) if "magnify" in keys else 1.0,
        **read_texts(keys, ("x_label", "y_label")),
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
