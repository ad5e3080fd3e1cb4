"""Figures of kind `orbit`: the path of the middle of the line through a period."""

from typing import Any

from cablesim.config.document import Node
from cablesim.config.figure_parts import Stage, check_stored, read_methods, read_shapes, read_texts, read_view


def read_orbit(node: Node, stage: Stage) -> dict[str, Any]:
    """A path for each value of `each` and for each method."""
    keys = node.mapping(("kind",), ("each", "point", "methods", "view", "x_label", "y_label"))
    check_stored(node, stage, "orbits", ("orbit",))
    return {
        "shapes": read_shapes(node, keys, None, stage),
        "methods": read_methods(keys, stage),
        "view": read_view(keys),
        **read_texts(keys, ("x_label", "y_label")),
    }
