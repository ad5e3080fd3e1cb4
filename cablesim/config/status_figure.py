"""Figures of kind `status_map`: the fate of every scenario, by its word."""

from typing import Any

from cablesim.config.axis_labels import formula_label, label_keys, read_labels
from cablesim.config.document import Node
from cablesim.config.figure_parts import Stage, check_sides, read_across, read_methods, read_number
from cablesim.config.place_file import fixed_axes

MOST_BESIDE = 3


def read_status_map(node: Node, stage: Stage) -> dict[str, Any]:
    """A panel for each method over `x` and `y`; without `y` one panel with a row for each method."""
    keys = node.mapping(("kind", "x"), ("y", "point", "methods", "across", "log", *label_keys("x", "y")))
    position = fixed_axes(keys, stage.names)
    sides = {name: read_number(keys[name], stage) for name in ("x", "y") if name in keys}
    along: dict[str, set[str]] = {name: axes - set(position) for name, (_, axes) in sides.items()}
    check_sides(keys, along)
    shown = set.union(*along.values(), position)
    left = [axis.name for axis in stage.names.design.axes if axis.name not in shown]
    if left:
        node.fail(f"the status also varies along {left[0]}: choose a value under point")
    methods = read_methods(keys, stage)
    labels = {str(name): formula_label([keys[name]], stage.names) for name in sides}
    return {
        **{name: formula for name, (formula, _) in sides.items()},
        "position": position,
        "methods": methods,
        "across": read_across(keys, min(len(methods), MOST_BESIDE)),
        "log": keys["log"].choice(("x", "y", "xy") if "y" in keys else ("x",)) if "log" in keys else "",
        "labels": read_labels(keys, labels),
    }
