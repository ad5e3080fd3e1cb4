"""Figures of kind `orbit`: the path of the middle of the line through a period."""

from typing import Any

from cablesim.config.axis_labels import label_keys, read_labels, side_label
from cablesim.config.document import Node
from cablesim.config.figure_parts import Stage, check_stored, read_methods, read_shapes, read_view


def read_orbit(node: Node, stage: Stage) -> dict[str, Any]:
    """A path for each value of `each` and for each method."""
    keys = node.mapping(("kind",), ("each", "point", "methods", "view", *label_keys("x", "y")))
    check_stored(node, stage, "orbits", ("orbit",))
    view = read_view(keys)
    labels = {axis: side_label("orbit", side, "from rest") for axis, side in zip("xy", view, strict=True)}
    return {
        "shapes": read_shapes(node, keys, None, stage),
        "methods": read_methods(keys, stage),
        "view": view,
        "labels": read_labels(keys, labels),
    }
