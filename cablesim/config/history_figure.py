"""Figures of kind `history`: tension against time."""

from typing import Any

from cablesim.config.axis_labels import label_keys, output_label, read_labels
from cablesim.config.document import Node
from cablesim.config.figure_parts import Stage, check_stored, read_across, read_methods, read_panels
from cablesim.quantities import PLACES


def read_history(node: Node, stage: Stage) -> dict[str, Any]:
    """Panels, one for each value of `at`; in each a curve for each value of `each` and for each method."""
    look = ("place", "from", "to", "titles", "across", *label_keys("x", "y"))
    keys = node.mapping(("kind",), ("at", "each", "point", "methods", *look))
    check_stored(node, stage, "histories", ("history", "history_time"))
    where = keys["place"].choice(PLACES) if "place" in keys else PLACES[-1]
    labels = {"x": output_label("time", "history_time"), "y": output_label(f"tension at the {where}", "history", "kN")}
    return {
        "panels": read_panels(node, keys, stage),
        "across": read_across(keys, 1),
        "methods": read_methods(keys, stage),
        "place": where,
        "labels": read_labels(keys, labels),
        **_read_times(keys),
    }


def _read_times(keys: dict[str, Node]) -> dict[str, float | None]:
    """The first and the last time that are shown; None where that is the history's own."""
    first, last = (keys[name].number("s") if name in keys else None for name in ("from", "to"))
    for name, time in (("from", first), ("to", last)):
        if time is not None and time < 0.0:
            keys[name].fail(f"a time >= 0 s is expected, not {time:g} s")
    if last is not None and last <= (first or 0.0):
        keys["to"].fail(f"a time after {first or 0.0:g} s is expected, not {last:g} s")
    return {"from": first, "to": last}
