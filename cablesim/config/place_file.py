"""Places in a design: the scenario that a picture or a printed table is about, by values of what varies."""

from dataclasses import dataclass

import numpy as np

from cablesim.config.design_file import read_values
from cablesim.config.document import Node
from cablesim.config.rehearsal import Rehearsal
from cablesim.design import Axis
from cablesim.errors import nearest
from cablesim.expressions import EQUAL_WITHIN
from cablesim.numerics import Array


@dataclass(frozen=True)
class Wish:
    """One value asked for: which points of an axis have it, and how the scene file put it."""

    axis: str
    points: np.ndarray
    words: str


def read_wish(node: Node, name: str, names: Rehearsal) -> Wish:
    """The points of an axis at which a varying parameter, or a case of a number, has a value."""
    axis = _axis(node, name, names)
    if name in axis.columns or name in names.parameters:
        asked = read_values([node], names.parameters[name])
        held = axis.columns
    else:
        asked = {name: np.array([node.whole(0, axis.size - 1)], dtype=float)}
        held = {name: np.arange(axis.size, dtype=float)}
    points = np.all([_equal(held[column], value) for column, value in asked.items()], axis=0)
    words = f"{name.replace('_', ' ')} {_text(node)}"
    if not points.any():
        words_of = names.parameters[name].words if name in names.parameters else ()
        node.fail(f"no scenario has {words}" + ("" if words_of else _nearest_value(name, held, asked)))
    return Wish(axis.name, points, words)


def read_wishes(node: Node, names: Rehearsal) -> list[Wish]:
    """A wish for each value of one parameter: `{heading: [0 deg, 45 deg]}`."""
    entries = node.mapping(optional=None)
    if len(entries) != 1:
        node.fail("one parameter and its values are expected")
    name, entry = next(iter(entries.items()))
    return [read_wish(item, name, names) for item in entry.sequence()]


def read_point(keys: dict[str, Node], names: Rehearsal) -> list[Wish]:
    """The wishes under the key `point`, one for each parameter that it mentions."""
    if "point" not in keys:
        return []
    return [read_wish(entry, name, names) for name, entry in keys["point"].mapping(optional=None).items()]


def positions(wishes: list[Wish], axis: Axis) -> np.ndarray:
    """The points of an axis at which every wish is met."""
    masks = [wish.points for wish in wishes if wish.axis == axis.name]
    return np.flatnonzero(np.all([np.ones(axis.size, dtype=bool), *masks], axis=0))


def fixed_axes(keys: dict[str, Node], names: Rehearsal) -> dict[str, int]:
    """The positions that `point` chooses, on the axes that it speaks of."""
    wishes = read_point(keys, names)
    asked = [axis for axis in names.design.axes if axis.name in {wish.axis for wish in wishes}]
    return {axis.name: _only(keys["point"], wishes, axis) for axis in asked}


def place(node: Node, wishes: list[Wish], names: Rehearsal) -> dict[str, int]:
    """The one scenario that the wishes leave, as a position on each axis. Raises InputError if it is not one."""
    return {axis.name: _only(node, wishes, axis) for axis in names.design.axes}


def _only(node: Node, wishes: list[Wish], axis: Axis) -> int:
    left = positions(wishes, axis)
    if left.size != 1:
        count = f"{left.size} scenarios are left" if left.size else "no scenario is left"
        node.fail(f"{count} along {axis.name}: choose one with 'at', 'each' or 'point'")
    return int(left[0])


def _axis(node: Node, name: str, names: Rehearsal) -> Axis:
    axes = {known: axis for axis in names.design.axes for known in (axis.name, *axis.columns)}
    if name not in axes:
        node.fail(f"'{name}' does not vary in this scene: {nearest(name, axes)}")
    return axes[name]


def _equal(values: Array, asked: Array) -> np.ndarray:
    return np.isclose(values, asked, rtol=EQUAL_WITHIN, atol=0.0)


def _text(node: Node) -> str:
    """A value as the scene file has it, in the unit that was chosen there."""
    return ", ".join(map(str, node.value)) if isinstance(node.value, list) else str(node.value)


def _nearest_value(name: str, held: dict[str, Array], asked: dict[str, Array]) -> str:
    if name not in held:
        return ""
    values = held[name]
    return f": the nearest is {values[np.nanargmin(np.abs(values - asked[name]))]:.12g} in SI"
