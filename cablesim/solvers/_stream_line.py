"""What the solvers of a line in a uniform stream share: parameters, problem kinds and what a solved line can answer."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from cablesim.numerics import Array
from cablesim.parameters import Batch, option, parameter
from cablesim.physics.stream import FRICTION_LAWS, StreamLoads, stream_loads
from cablesim.status import Status

OUTPUTS = (
    "position_B",
    "force_A",
    "force_B",
    "tension_A",
    "tension_B",
    "max_tension",
    "angle_A",
    "angle_B",
    "lowest_point",
    "farthest_point",
    "line_length",
    "closing_error",
    "steps",
    "profile",
    "profile_tension",
)
# A depth that is not reached within this many times its own length of line counts as out of reach.
LONGEST_FOR_DEPTH = 1e6
# The force at A is turned by this, in rad, to see whether it tells where the line ends.
TURN = 1e-9
# A line without any pull at its end begins with this part of the pull that its own load could give it.
SLACK_START = 1e-13


def march_seconds(p: "StreamLine", between_ends: float, from_force: float) -> Array:
    """Seconds of each scenario: a line between two ends is marched again and again, one from a force once."""
    return np.full(p.size, between_ends if p.position_B is not None else from_force)


@dataclass(frozen=True)
class LineBetweenEnds(Batch):
    """A line in a uniform stream of known length between two known ends."""

    position_B: Array = parameter(vector=True, typical=(-50.0, 50.0))
    line_length: Array = parameter(above=0.0, typical=(100.0, 1000.0))
    weight_per_length: Array = parameter(typical=(-20.0, 200.0))
    diameter: Array = parameter(above=0.0, typical=(5e-3, 0.1))
    normal_drag_coefficient: Array = parameter(at_least=0.0, typical=(1.1, 1.4))
    tangential_drag_coefficient: Array = parameter(at_least=0.0, typical=(0.02, 0.04))
    friction_law: np.ndarray = parameter(words=FRICTION_LAWS, default="constant")
    lay_angle: Array = parameter(above=-0.5 * np.pi, below=0.5 * np.pi, default=0.0, typical=(-0.3, 0.3))
    fluid_density: Array = parameter(above=0.0, typical=(1000.0, 1030.0))
    stream_speed: Array = parameter(at_least=0.0, typical=(0.1, 5.0))
    heading: Array = parameter(default=0.0, typical=(-3.0, 3.0))

    @cached_property
    def loads(self) -> StreamLoads:
        """Drag and weight per length."""
        return stream_loads(
            self.weight_per_length,
            self.diameter,
            self.normal_drag_coefficient,
            self.tangential_drag_coefficient,
            self.friction_law,
            self.lay_angle,
            self.fluid_density,
            self.stream_speed,
            self.heading,
        )

    @property
    def has_load(self) -> np.ndarray:
        """Whether weight or drag act at all: without them a line has no shape."""
        return self.loads.magnitude > 0.0

    @cached_property
    def fate_of_ends(self) -> np.ndarray:
        """Status of lines with given ends, as far as it can be told before they are solved."""
        chord = np.linalg.norm(self.position_B, axis=1)
        fate = np.where(chord < self.line_length, Status.ok, Status.infeasible)
        return np.where(self.has_load, fate, Status.out_of_domain).astype(np.int8)

    @cached_property
    def feasible_ends(self) -> tuple[Array, Array]:
        """Chord (scenario, 3) and length; a line that has no solution gets a chord that has one."""
        usable = self.fate_of_ends == Status.ok
        some = 0.5 * self.line_length[:, None] * np.array([0.6, 0.0, 0.8])
        return np.where(usable[:, None], self.position_B, some), self.line_length


@dataclass(frozen=True)
class StreamLine(LineBetweenEnds):
    """A line in a uniform stream: from a known force over a length or up to a depth, or between two known ends."""

    PROBLEMS: ClassVar[tuple[tuple[str, ...], ...]] = (
        ("force_A", "line_length"),
        ("force_A", "depth"),
        ("position_B", "line_length"),
    )

    force_A: Array = parameter(vector=True, typical=(-1e5, 1e5))
    depth: Array = parameter(above=0.0, typical=(1.0, 100.0))

    @property
    def has_load(self) -> np.ndarray:
        """Whether weight, drag or a pull act at all: without them a line has no shape."""
        loaded = self.loads.magnitude > 0.0
        return loaded if self.force_A is None else loaded | self.force_A.any(axis=1)

    @cached_property
    def pull(self) -> Array:
        """Force at A; where it is zero, a trace of one in the direction that the line's own load gives it."""
        slack = np.flatnonzero(~self.force_A.any(axis=1))
        if not slack.size:
            return self.force_A
        force = self.force_A.copy()
        own, extent = self.loads.take(slack), self.line_length if self.depth is None else self.depth
        force[slack] = SLACK_START * (own.magnitude * extent[slack])[:, None] * own.trailing_direction
        return force


@dataclass(frozen=True)
class Nodes:
    """The option that all methods share."""

    nodes: int = option(101, at_least=2, at_most=100_000, meaning="nodes of the profile")


@dataclass(frozen=True)
class Options(Nodes):
    """Numerical options of an integrated line."""

    rtol: float = option(1e-12, at_least=1e-14, at_most=1e-2, meaning="relative accuracy of tension and position")


@dataclass(frozen=True)
class SolvedLine(ABC):
    """Lines solved by any method, arrays of one entry per scenario; each quantity is computed when it is asked for."""

    force_A: Array
    line_length: Array
    loads: StreamLoads
    nodes: int

    @property
    @abstractmethod
    def force_B(self) -> Array:
        """Force vector at B."""

    @property
    def tension_A(self) -> Array:
        return np.linalg.norm(self.force_A, axis=1)

    @property
    def tension_B(self) -> Array:
        return np.linalg.norm(self.force_B, axis=1)

    @property
    def angle_A(self) -> Array:
        return self._angle(self.force_A)

    @property
    def angle_B(self) -> Array:
        return self._angle(self.force_B)

    @property
    @abstractmethod
    def shape(self) -> tuple[Array, Array]:
        """Positions (scenario, node, 3) and tensions (scenario, node) along the line."""

    @property
    def profile(self) -> Array:
        return self.shape[0]

    @property
    def profile_tension(self) -> Array:
        return self.shape[1]

    def _angle(self, force: Array) -> Array:
        """Angle of a tangent above the direction of tow, in the vertical plane along the stream, from 0 to 2 pi."""
        against = -np.einsum("ij,ij->i", force[:, :2], self.loads.direction)
        return np.arctan2(force[:, 2], against) % (2.0 * np.pi)
