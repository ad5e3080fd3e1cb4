"""The design of a scene: axes whose product is the set of scenarios.

An axis carries one or more parameters that vary together along it. A grid has one parameter an axis; a list of cases or
a sample is a single axis `scenario` along which all its parameters vary. So one algebra serves all three.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from cablesim.numerics import Array

SCENARIO = "scenario"


@dataclass(frozen=True)
class Axis:
    """`columns`: the parameters that vary along it, in SI, all of one length. `labels`: what else names its points.

    A list has a column for each section, NaN where a line has fewer.
    """

    name: str
    columns: dict[str, Array]
    labels: dict[str, np.ndarray] = field(default_factory=dict)

    @property
    def size(self) -> int:
        return len(next(iter(self.columns.values())))

    def take(self, where: np.ndarray) -> "Axis":
        """Some of its points."""
        return Axis(self.name, {name: values[where] for name, values in self.columns.items()})

    @property
    def key(self) -> np.ndarray:
        """One comparable value for each point, the bytes of its parameters: equal means equal to the last bit."""
        rows = np.column_stack([self.columns[name] for name in sorted(self.columns)]) + 0.0
        # Zeros of either sign are equal, and so are NaN of any bits.
        rows[np.isnan(rows)] = np.nan
        return np.ascontiguousarray(rows).view(np.dtype((np.void, rows.shape[1] * 8))).ravel()

    def padded(self, names: Iterable[str]) -> "Axis":
        """The axis with columns of these names too: NaN where it had none, as sections that no line has."""
        missing = {name: np.full(self.size, np.nan) for name in names if name not in self.columns}
        return Axis(self.name, {**self.columns, **missing})

    def only(self, parameters: set[str]) -> "Axis | None":
        """The axis without the parameters that a method does not have; None if none is left."""
        kept = {name: values for name, values in self.columns.items() if name in parameters}
        return Axis(self.name, kept) if kept else None


@dataclass(frozen=True)
class Design:
    """The axes, in the order of the dataset's dimensions; `kind` is grid, cases or sample."""

    kind: str
    axes: tuple[Axis, ...]
    seed: int | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(axis.size for axis in self.axes)

    @property
    def size(self) -> int:
        return math.prod(self.shape)

    @property
    def parameters(self) -> set[str]:
        return {name for axis in self.axes for name in axis.columns}


def expand(axes: tuple[Axis, ...]) -> dict[str, Array]:
    """Every parameter for every point of the product of axes, flattened in C order."""
    shape = tuple(axis.size for axis in axes)
    expanded = {}
    for position, axis in enumerate(axes):
        view = tuple(-1 if i == position else 1 for i in range(len(axes)))
        for name, values in axis.columns.items():
            expanded[name] = np.broadcast_to(values.reshape(view), shape).ravel()
    return expanded
