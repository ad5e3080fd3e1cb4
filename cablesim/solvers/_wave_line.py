"""What a line moored in waves is given: parameters, options, and the packed problem that integrators march."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from cablesim.errors import InputError
from cablesim.numerics import Array
from cablesim.parameters import Batch, option, parameter
from cablesim.physics.nodal_line import LINE_ROWS
from cablesim.physics.waves import (
    GRAVITY,
    Waves,
    ellipse_vectors,
    m18_amplitude,
    packed_motion,
    surface_vectors,
)
from cablesim.solvers._wave_pack import Problem, Records
from cablesim.solvers._wave_static import StaticLines, static_lines

# Greatest orders of the multistep integrators.
ORDERS = {"gear": 5, "adams": 12}
INTEGRATORS = ("generalized_alpha", "leapfrog", "rk4", "gear", "adams")
# Whole periods at the end that are recorded, and defaults in periods.
RECORDED_PERIODS, DURATION, RAMP = 5.0, 12.0, 2.0
# Shares of an element's mass: of a node's own acceleration, and of the other node's.
SHARES = {"consistent": (1.0 / 3.0, 1.0 / 6.0), "lumped": (0.5, 0.0)}
# Tolerances of place are relative to the amplitude, at least to this part of the chord; those of tension to the
# greatest tension at rest, at least to this part of the line's weight.
LEAST_MOVE, LEAST_PULL = 1e-3, 0.1


@dataclass(frozen=True)
class MooredLine(Batch):
    """A line from an anchor on the bottom to the surface, its top end moved by a ship, by waves or not at all."""

    PROBLEMS: ClassVar[tuple[tuple[str, ...], ...]] = ()

    depth: Array = parameter(above=0.0, typical=(50.0, 500.0))
    chord_angle: Array = parameter(above=0.0, at_most=0.5 * np.pi, typical=(0.5, 1.2))
    line_length: Array = parameter(above=0.0, typical=(100.0, 500.0))
    length_ratio: Array = parameter(above=0.0, instead_of="line_length", typical=(0.99, 1.01))
    mass_per_length: Array = parameter(above=0.0, typical=(1.0, 10.0))
    area: Array = parameter(at_least=0.0, typical=(1e-4, 1e-3))
    linear_stiffness: Array = parameter(above=0.0, typical=(1e6, 1e7))
    quadratic_stiffness: Array = parameter(typical=(0.0, 1e7), otherwise="no quadratic part")
    stiffness_ratio: Array = parameter(instead_of="quadratic_stiffness", typical=(0.0, 0.2))
    internal_damping: Array = parameter(at_least=0.0, default=0.0, typical=(0.0, 1e4))
    normal_drag: Array = parameter(at_least=0.0, typical=(5.0, 20.0))
    tangential_drag: Array = parameter(at_least=0.0, typical=(0.1, 1.0))
    added_mass_per_length: Array = parameter(at_least=0.0, default=0.0, typical=(0.1, 1.0))
    fluid_density: Array = parameter(at_least=0.0, default=1025.0, typical=(1000.0, 1030.0))
    wave_period: Array = parameter(above=0.0, typical=(4.0, 15.0))
    wave_height: Array = parameter(at_least=0.0, typical=(0.1, 3.0), otherwise="still water")
    top_amplitude: Array = parameter(
        at_least=0.0, typical=(0.1, 1.5), otherwise="by M18 from the period, or with wave_height that of the surface"
    )
    heading: Array = parameter(default=0.0, typical=(-3.0, 3.0))
    motion_angle: Array = parameter(default=0.0, typical=(-1.5, 1.5))
    axis_ratio: Array = parameter(default=0.0, at_least=-1.0, at_most=1.0, typical=(-1.0, 1.0))
    motion_phase: Array = parameter(default=0.0, typical=(-3.0, 3.0))
    stream_speed: Array = parameter(at_least=0.0, default=0.0, typical=(0.0, 1.0))
    duration: Array = parameter(above=0.0, typical=(40.0, 80.0), otherwise="12 wave periods")
    ramp: Array = parameter(at_least=0.0, typical=(5.0, 20.0), otherwise="2 wave periods")

    @cached_property
    def top(self) -> Array:
        """Top end at rest (scenario, 3); the anchor is at (0, 0, -depth)."""
        # tan(pi/2) is not infinite in floating point: the top of a vertical line is right above its anchor.
        upright = self.chord_angle >= 0.5 * np.pi
        x = np.where(upright, 0.0, self.depth / np.tan(self.chord_angle))
        return np.column_stack([x, np.zeros(self.size), np.zeros(self.size)])

    @property
    def chord(self) -> Array:
        return np.hypot(self.top[:, 0], self.depth)

    @property
    def length(self) -> Array:
        return self.line_length if self.length_ratio is None else self.length_ratio * self.chord

    @property
    def quadratic(self) -> Array:
        if self.stiffness_ratio is not None:
            return self.stiffness_ratio * self.linear_stiffness
        return np.zeros(self.size) if self.quadratic_stiffness is None else self.quadratic_stiffness

    @property
    def weight(self) -> Array:
        """Per length, less buoyancy."""
        return (self.mass_per_length - self.fluid_density * self.area) * GRAVITY

    @property
    def stream(self) -> Array:
        """Velocity of the stream (scenario, 3)."""
        along = np.column_stack([np.cos(self.heading), np.sin(self.heading), np.zeros(self.size)])
        return self.stream_speed[:, None] * along

    @property
    def has_waves(self) -> bool:
        return self.wave_height is not None

    @cached_property
    def waves(self) -> Waves:
        amplitude = np.zeros(self.size) if self.wave_height is None else 0.5 * self.wave_height
        return Waves(amplitude, self.wave_period, self.depth, self.heading)

    @cached_property
    def motion(self) -> tuple[Array, Array]:
        """c and s (scenario, 3) of the top end's motion."""
        if self.top_amplitude is None and self.has_waves:
            return surface_vectors(self.waves)
        amplitude = m18_amplitude(self.wave_period) if self.top_amplitude is None else self.top_amplitude
        return ellipse_vectors(amplitude, self.heading, self.motion_angle, self.axis_ratio, self.motion_phase)

    @property
    def ramp_time(self) -> Array:
        return RAMP * self.wave_period if self.ramp is None else self.ramp

    @property
    def end_time(self) -> Array:
        return DURATION * self.wave_period if self.duration is None else self.duration

    @property
    def window(self) -> Array:
        """When the periods that are recorded begin; at once, if the run is not longer than they are."""
        return np.maximum(self.end_time - RECORDED_PERIODS * self.wave_period, 0.0)

    def equilibrium(self, segments: int) -> StaticLines:
        return static_lines(
            self.top + self.depth[:, None] * [0.0, 0.0, 1.0],
            self.length,
            segments,
            self.weight,
            self.linear_stiffness,
            self.quadratic,
            self.normal_drag,
            self.tangential_drag,
            self.stream,
        )

    def problem(self, still: StaticLines, options: "Options") -> Problem:
        """The packed problem of lines that are in equilibrium."""
        segments = still.tension.shape[1]
        ramp, (c, s) = self.ramp_time, self.motion
        anchor = self.depth[:, None, None] * np.array([0.0, 0.0, -1.0])
        move = np.maximum(np.sqrt((c**2 + s**2).sum(axis=1)), np.maximum(self.waves.amplitude, LEAST_MOVE * self.chord))
        pull = np.maximum(still.tension.max(axis=1), LEAST_PULL * np.abs(self.weight) * self.length)
        return Problem(
            self._lines(segments, options),
            packed_motion(self.waves.omega, ramp, c, s),
            self.waves.packed(ramp, self.top, self.stream_speed),
            np.ascontiguousarray(still.position + anchor),
            still.tension,
            self._supports(still),
            np.column_stack([self.end_time, self.window, self.wave_period]),
            np.column_stack([pull, move]),
        )

    def _lines(self, segments: int, options: "Options") -> Array:
        """Rows of `physics.nodal_line`."""
        added = self.added_mass_per_length
        one = np.ones(self.size)
        own, other = SHARES[options.mass]
        columns = (
            self.length / segments,
            self.mass_per_length + added,
            added,
            added if options.added_mass == "normal" else 0.0 * one,
            self.fluid_density * self.area,
            self.weight,
            self.linear_stiffness,
            self.quadratic,
            self.internal_damping,
            self.normal_drag,
            self.tangential_drag,
            own * one,
            other * one,
        )
        rows = np.column_stack(columns)
        return rows[:, :LINE_ROWS]

    def _supports(self, still: StaticLines) -> Array:
        """Forces on anchor and top and the tension in the middle, at rest (scenario, 3)."""
        pieces = np.diff(still.position, axis=1)
        tangents = pieces / np.linalg.norm(pieces, axis=2, keepdims=True)
        segments = still.tension.shape[1]
        before, after = still.tension[:, (segments - 1) // 2], still.tension[:, segments // 2]
        first = still.tension[:, :1] * tangents[:, 0] + self._half_load(tangents[:, 0], segments)
        last = -still.tension[:, -1:] * tangents[:, -1] + self._half_load(tangents[:, -1], segments)
        ends = (np.linalg.norm(first, axis=1), 0.5 * (before + after), np.linalg.norm(last, axis=1))
        return np.column_stack(ends)

    def _half_load(self, tangent: Array, segments: int) -> Array:
        """Weight and drag of the stream on half an element (scenario, 3)."""
        along = (self.stream * tangent).sum(axis=1, keepdims=True)
        across = self.stream - along * tangent
        normal = self.normal_drag[:, None] * np.linalg.norm(across, axis=1, keepdims=True) * across
        drag = normal + self.tangential_drag[:, None] * np.abs(along) * along * tangent
        return 0.5 * (self.length / segments)[:, None] * (drag - self.weight[:, None] * [0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Options:
    """Numerical options of a line in waves."""

    segments: int = option(50, at_least=2, at_most=10_000, meaning="straight elements of the line")
    integrator: str = option("generalized_alpha", one_of=INTEGRATORS, meaning="method that marches through time")
    rtol: float = option(1e-3, at_least=1e-9, at_most=0.1, meaning="accuracy in time, relative to the largest tension")
    time_step: float = option(0.0, at_least=0.0, meaning="fixed time step in s; 0: as accuracy or stability want it")
    step_part: float = option(
        1.0, at_least=1e-3, at_most=1.0, meaning="part of the longest steps, by period and stability, that are taken"
    )
    max_order: int = option(0, at_least=0, at_most=12, meaning="greatest order of gear and adams; 0: 5 and 12")
    mass: str = option("consistent", one_of=tuple(SHARES), meaning="mass matrix of an element")
    added_mass: str = option("normal", one_of=("normal", "isotropic"), meaning="acceleration that added mass resists")
    mesh_check: str = option("no", one_of=("no", "yes"), meaning="whether all is done with half as long elements, too")
    time_check: str = option("no", one_of=("no", "yes"), meaning="whether all is done ten times as accurately, too")
    samples: int = option(600, at_least=2, at_most=1_000_000, meaning="points of a history, over the whole duration")
    phases: int = option(16, at_least=1, at_most=1000, meaning="snapshots in the last period")
    most_steps: int = option(1_000_000, at_least=1, meaning="time steps after which a scenario is given up")
    most_seconds: float = option(600.0, at_least=0.0, meaning="seconds after which a scenario is given up")

    def __post_init__(self) -> None:
        order = ORDERS.get(self.integrator, 0)
        if self.max_order > order:
            limit = f"at most {order}" if order else "an option of gear and adams only"
            raise InputError(f"max_order is {limit}, not {self.max_order} of {self.integrator}")
        if order and self.time_step > 0.0:
            raise InputError(f"{self.integrator} chooses its steps by rtol: it takes no time_step")

    @property
    def closer(self) -> "Options":
        """A tenth of the tolerance, half of a fixed step and of the longest ones, and steps enough for that."""
        return replace(
            self,
            rtol=0.1 * self.rtol,
            time_step=0.5 * self.time_step,
            step_part=0.5 * self.step_part,
            most_steps=10 * self.most_steps,
        )


def empty_records(size: int, segments: int, samples: int, phases: int) -> Records:
    """Room for what is recorded; no samples and phases where no history is asked for."""
    return Records(
        np.full((size, 3, 3), np.nan),
        np.full((size, 5), np.nan),
        np.full((size, segments, 2), np.nan),
        np.full((size, samples, 3), np.nan, dtype=np.float32),
        np.full((size, phases, 3), np.nan, dtype=np.float32),
        np.full((size, phases, segments + 1, 3), np.nan, dtype=np.float32),
        np.full((size, phases, segments), np.nan, dtype=np.float32),
    )
