"""Segment method: a line in a uniform stream as straight rigid segments, loads lumped at their ends.

    euler     F_{i+1} = F_i - q(t_i) ds,                       r_{i+1} = r_i + t_{i+1} ds             (M14)
    midpoint  t_m along F_i - q(t_i) ds / 2,  F_{i+1} = F_i - q(t_m) ds,  r_{i+1} = r_i + t_m ds

with t_i along F_i and the loads q of `stream_line`. `euler` is the method as published, of order 1; `midpoint` is of
order 2 as long as no segment crosses a corner of the friction law. Marching from A, both need a length for each segment
that is short beside tension over load: where the line is slack, use `stream_line`. (The source prints a stray factor i
in M14.)

Between given ends, and for a depth, the polygon itself meets them: Newton from the exact line, `not_converged` where no
polygon of so few segments was found.

Reference: Handbook on ropes and fishing gear (in Chinese), section 3-6.
"""

from dataclasses import dataclass

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.compiled import compiled
from cablesim.parameters import option
from cablesim.physics.stream import EX, EY, PLAIN, StreamLoads, load
from cablesim.solver import Solution
from cablesim.solvers import _stream_line
from cablesim.solvers._polygon import Joints, note_joint, solve_polygon
from cablesim.solvers._stream_line import OUTPUTS
from cablesim.solvers._stream_line import StreamLine as Parameters

__all__ = ["OUTPUTS", "Options", "Parameters", "solve"]

COMPILED = True
ITERATES = True
VARIANTS = ("euler", "midpoint")


@dataclass(frozen=True)
class Options(_stream_line.Nodes):
    """Numerical options."""

    segments: int = option(100, at_least=1, at_most=1_000_000, meaning="segments of equal length")
    variant: str = option("euler", one_of=VARIANTS, meaning="how the load of a segment is taken")


def seconds_per_scenario(options: Options) -> float:
    return 4e-4 + 2.3e-6 * options.segments


def seconds_of(p: Parameters, options: Options) -> Array:
    return _stream_line.march_seconds(p, seconds_per_scenario(options), 3e-7 + 1.4e-7 * options.segments)


def solve(p: Parameters, options: Options) -> Solution:
    midpoint = options.variant == "midpoint"

    def march(force: Array, length: Array, loads: StreamLoads, nodes: int) -> Joints:
        joints = Joints.empty(length.size, nodes)
        _march_all(
            np.ascontiguousarray(force), length, loads.packed, loads.friction_law, options.segments, midpoint,
            joints.position, joints.force, joints.peaks, joints.profile, joints.profile_tension,
        )  # fmt: skip
        return joints

    return solve_polygon(p, march, options.segments, options.nodes)


@compiled
def _march_all(force, length, packed, laws, segments, midpoint, position_end, force_end, peaks, profile, tensions):
    y, before, middle, t, q = np.empty(PLAIN), np.empty(PLAIN), np.empty(3), np.empty(3), np.empty(3)
    for i in range(length.size):
        step, line, law = length[i] / segments, packed[i], laws[i]
        y[:3], y[3:], peaks[i] = force[i], 0.0, -np.inf
        before[:] = y
        note_joint(y, 0, segments, line, before, peaks[i], profile[i], tensions[i])
        for j in range(segments):
            _load_along(y, line, law, t, q)
            if midpoint:
                for k in range(3):
                    middle[k] = y[k] - 0.5 * step * q[k]
                _load_along(middle, line, law, t, q)
            for k in range(3):
                y[k] -= step * q[k]
            if not midpoint:
                _unit(y, t)
            for k in range(3):
                y[3 + k] += step * t[k]
            note_joint(y, j + 1, segments, line, before, peaks[i], profile[i], tensions[i])
        force_end[i], position_end[i] = y[:3], y[3:]


@compiled
def _load_along(force, line, law, t, q):
    """The tangent along a force into `t`, the load on it into `q`."""
    _unit(force, t)
    c = t[0] * line[EX] + t[1] * line[EY]
    load(t[0], t[1], t[2], line, law, 1.0 if c >= 0.0 else -1.0, q)


@compiled
def _unit(force, t):
    tension = np.sqrt(force[0] * force[0] + force[1] * force[1] + force[2] * force[2])
    for k in range(3):
        t[k] = force[k] / tension
