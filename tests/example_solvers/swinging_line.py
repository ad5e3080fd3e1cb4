"""A straight line whose top swings: just enough of a solver to try histories and parameters that may be left out on.

    r_B(t) = Z e_z + A sin(2 pi t / T) e_x,  T_B(t) = k (1 + A/Z sin(2 pi t / T)),  half of that in the middle, 0 at A

A is top_amplitude, or else half of wave_height, or else 1 m. A line whose amplitude exceeds its depth has no solution.

Reference: none; it belongs to the tests.
"""

from dataclasses import dataclass

import numpy as np

from cablesim.numerics import Array
from cablesim.parameters import Batch, option, parameter
from cablesim.solver import Solution
from cablesim.status import Status

OUTPUTS = (
    "max_top_tension",
    "mesh_change",
    "profile",
    "profile_tension",
    "history",
    "history_time",
    "orbit",
    "snapshots",
    "snapshot_tension",
)
SHARES = np.array([0.0, 0.5, 1.0])
COMPILED = True
RECORDS = True
# What it was called for.
CALLS: list[tuple[str, int, tuple[str, ...]]] = []


@dataclass(frozen=True)
class Parameters(Batch):
    depth: Array = parameter(above=0.0, typical=(10.0, 100.0))
    wave_period: Array = parameter(above=0.0, typical=(4.0, 12.0))
    linear_stiffness: Array = parameter(above=0.0, typical=(1e3, 1e6), default=1e3)
    quadratic_stiffness: Array = parameter(typical=(-1e3, 1e3), otherwise="none")
    stiffness_ratio: Array = parameter(instead_of="quadratic_stiffness", typical=(-1.0, 1.0))
    wave_height: Array = parameter(at_least=0.0, typical=(0.0, 1.0), otherwise="no waves")
    top_amplitude: Array = parameter(at_least=0.0, typical=(0.0, 1.0), otherwise="the surface decides")
    duration: Array = parameter(above=0.0, typical=(1.0, 100.0), otherwise="12 wave periods")


@dataclass(frozen=True)
class Options:
    segments: int = option(4, at_least=1, at_most=1000, meaning="elements of the line")
    rtol: float = option(1e-3, at_least=1e-9, at_most=1.0, meaning="changes nothing")
    samples: int = option(13, at_least=2, at_most=100_000, meaning="points of a history")
    phases: int = option(4, at_least=1, at_most=1000, meaning="snapshots in a period")
    mesh_check: str = option("no", one_of=("no", "yes"), meaning="whether the elements are halved")


def seconds_per_scenario(options: Options) -> float:
    return 1e-3 * options.segments


def sizes(options: Options) -> dict[str, int]:
    return {"node": options.segments + 1, "time": options.samples, "phase": options.phases}


def answered(options: Options) -> tuple[str, ...]:
    return tuple(name for name in OUTPUTS if name != "mesh_change" or options.mesh_check == "yes")


def warm(p: Parameters, options: Options, outputs: tuple[str, ...]) -> None:
    CALLS.append(("warm", p.size, outputs))


@dataclass(frozen=True)
class Swinging:
    p: Parameters
    options: Options
    outputs: tuple[str, ...]
    amplitude: Array

    @property
    def max_top_tension(self) -> Array:
        return self._top_tension(np.ones(1))[:, 0]

    @property
    def mesh_change(self) -> Array:
        return np.zeros(self.p.size)

    @property
    def profile(self) -> Array:
        return self._positions(np.zeros(1))[:, 0]

    @property
    def profile_tension(self) -> Array:
        return self._shares * self._top_tension(np.zeros(1))

    @property
    def history_time(self) -> Array:
        duration = 12.0 * self.p.wave_period if self.p.duration is None else self.p.duration
        return np.linspace(0.0, duration, self.options.samples, axis=1)

    @property
    def history(self) -> Array:
        if "history" not in self.outputs:
            raise LookupError("a history that was not recorded")
        swing = np.sin(2.0 * np.pi * self.history_time / self.p.wave_period[:, None])
        return self._top_tension(swing)[:, :, None] * SHARES

    @property
    def orbit(self) -> Array:
        half = 0.5 * self.amplitude[:, None] * self._swings
        return np.stack([half, 0.0 * half, 0.0 * half], axis=2)

    @property
    def snapshots(self) -> Array:
        return self._positions(self._swings)

    @property
    def snapshot_tension(self) -> Array:
        return self._top_tension(self._swings)[:, :, None] * self._shares

    @property
    def _swings(self) -> Array:
        return np.sin(2.0 * np.pi * np.arange(self.options.phases) / self.options.phases)

    @property
    def _shares(self) -> Array:
        return np.linspace(0.0, 1.0, self.options.segments + 1)

    def _positions(self, swings: Array) -> Array:
        """Shape (scenario, swing, node, component)."""
        x = self.amplitude[:, None, None] * swings[:, None] * self._shares
        z = self.p.depth[:, None, None] * self._shares + 0.0 * x
        return np.stack([x, 0.0 * x, z], axis=3)

    def _top_tension(self, swings: Array) -> Array:
        """Shape (scenario, swing)."""
        return self.p.linear_stiffness[:, None] * (1.0 + (self.amplitude / self.p.depth)[:, None] * swings)


def solve(p: Parameters, options: Options, outputs: tuple[str, ...]) -> Solution:
    CALLS.append(("solve", p.size, outputs))
    amplitude = np.ones(p.size) if p.wave_height is None else 0.5 * p.wave_height
    amplitude = amplitude if p.top_amplitude is None else p.top_amplitude
    status = np.where(amplitude <= p.depth, Status.ok, Status.infeasible).astype(np.int8)
    return Solution(status, Swinging(p, options, outputs, amplitude))
