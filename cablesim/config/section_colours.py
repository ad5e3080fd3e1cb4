"""How a figure of profiles tells the sections of lines apart: a colour for each section, or for each weight."""

from dataclasses import dataclass

import numpy as np

from cablesim import units
from cablesim.config.document import Node
from cablesim.config.rehearsal import Rehearsal
from cablesim.numerics import Array
from cablesim.quantities import component_names, quantity

# What sections are drawn from: the one a node is in, where they meet, where the line is lowest.
SECTION_OUTPUTS = ("profile_section", "joint_position", "lowest_point")
# Where colour tells sections apart, the curves of a panel have only their dashes.
MOST_DASHES = 4
MOST_COLOURS = 8


@dataclass(frozen=True)
class SectionColours:
    """What each colour stands for, and the weights in N/m that have one, in ascending order, where weights do."""

    labels: tuple[str, ...]
    weights: tuple[float, ...] = ()

    def numbers(self, weights: Array) -> list[int]:
        """The number of the colour of each section of a line."""
        if not self.weights:
            return list(range(weights.size))
        return [int(np.abs(np.subtract(self.weights, weight)).argmin()) for weight in weights]


def read_colours(
    keys: dict[str, Node], names: Rehearsal, positions: list[dict[str, int]], curves: int
) -> SectionColours | None:
    """The colours of the lines at some positions of the design, `curves` of them in a panel; None if nobody asked."""
    if "colour" not in keys:
        if "names" in keys:
            keys["names"].fail("names are those of sections or of weights: they need the key 'colour'")
        return None
    by = keys["colour"].choice(("section", "weight"))
    _check(keys["colour"], names, curves)
    weights = np.array([_weights(names, position) for position in positions])
    given = np.isfinite(weights)
    known = np.unique(weights[given]) if by == "weight" else weights.T[given.any(axis=0)]
    if len(known) > MOST_COLOURS:
        keys["colour"].fail(f"at most {MOST_COLOURS} colours can be told apart, not {len(known)}")
    called = _read_names(keys["names"], len(known), by) if "names" in keys else ()
    if by == "weight":
        labels = [", ".join((*called[i : i + 1], _range(np.array(weight)))) for i, weight in enumerate(known)]
        return SectionColours(tuple(labels), tuple(known.tolist()))
    called = called or tuple(f"section {number}" for number in range(1, len(known) + 1))
    return SectionColours(tuple(f"{name}, {_range(own)}" for name, own in zip(called, known, strict=True)))


def _check(node: Node, names: Rehearsal, curves: int) -> None:
    missing = [name for name in SECTION_OUTPUTS if name not in names.outputs]
    if missing:
        node.fail(f"sections are drawn from the outputs {', '.join(SECTION_OUTPUTS)}: {missing[0]} is missing")
    if curves > MOST_DASHES:
        node.fail(f"at most {MOST_DASHES} curves of a panel can be told apart by their dashes, not {curves}")


def _read_names(node: Node, count: int, by: str) -> tuple[str, ...]:
    called = tuple(entry.text(60) for entry in node.sequence())
    if len(called) != count:
        node.fail(f"a name for each {by} is expected: {count}, not {len(called)}")
    return called


def _weights(names: Rehearsal, position: dict[str, int]) -> list[float]:
    """The weights per length of the sections of a scenario; NaN after the last one."""
    found = dict(names.fixed)
    for axis in names.design.axes:
        found |= {name: float(values[position[axis.name]]) for name, values in axis.columns.items()}
    return [found.get(name, float("nan")) for name in component_names("section_weight", names.sections)]


def _range(weights: Array) -> str:
    low, high = (f"{value:.4g}" for value in (np.nanmin(weights), np.nanmax(weights)))
    unit = units.shown(quantity("section_weight").unit)
    return f"{low} {unit}" if low == high else f"{low} to {high} {unit}"
