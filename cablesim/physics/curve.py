"""What every hanging curve can answer, whichever formula it came from: its shape as nodes along the line."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from cablesim.numerics import Array


class Shape(NamedTuple):
    """x and z from support A, and the tension there; each of shape (scenario, node)."""

    x: Array
    z: Array
    tension: Array


@dataclass(frozen=True)
class HangingCurve(ABC):
    """A curve between two supports; subclasses give `shape`."""

    nodes: int
    span: Array
    weight_per_length: Array

    @cached_property
    @abstractmethod
    def shape(self) -> Shape:
        """The nodes of the curve."""

    @property
    def profile(self) -> Array:
        """Positions of shape (scenario, node, component)."""
        return np.stack([self.shape.x, np.zeros_like(self.shape.x), self.shape.z], axis=-1)

    @property
    def profile_tension(self) -> Array:
        return self.shape.tension
