"""Lines known by their joints, and the problems of depth and of two ends for any method that marches from A."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.compiled import compiled
from cablesim.numerics.newton import damped_newton
from cablesim.physics.stream import PLAIN, StreamLoads
from cablesim.solver import Solution
from cablesim.solvers._stream_ends import force_between_ends
from cablesim.solvers._stream_line import LONGEST_FOR_DEPTH, SolvedLine, StreamLine
from cablesim.solvers._stream_march import march as exact_march
from cablesim.solvers._stream_step import FARTHEST, LOWEST, PEAKS, REACHED, TENSION_PEAK, keep_peaks, tension
from cablesim.status import Status

# The end is met to this part of the length; the exact line that Newton starts from is known to that part, too.
TOLERANCE, START = 1e-12, 1e-10
# Step of the difference quotients, relative to the tension.
DIFFERENCE = 1e-7


@dataclass(frozen=True)
class Joints:
    """What a march over many lines has found: arrays of shape (scenario, ...).

    `position` and `force` (scenario, 3) at B, `peaks` (scenario, 3, 4) as `_stream_march.March` has them, `profile` and
    `profile_tension` (scenario, node, ...) at as many nodes as were asked for, `broken` where the method broke down.
    """

    position: Array
    force: Array
    peaks: Array
    profile: Array
    profile_tension: Array
    broken: np.ndarray

    @classmethod
    def empty(cls, size: int, nodes: int) -> Self:
        """Room for a march."""
        vectors = (np.empty((size, 3)), np.empty((size, 3)), np.empty((size, PEAKS, 4)))
        return cls(*vectors, np.zeros((size, nodes, 3)), np.zeros((size, nodes)), np.zeros(size, dtype=np.bool_))


# Force at A, length, loads, nodes of the profile (0 for none).
March = Callable[[Array, Array, StreamLoads, int], Joints]


@compiled
def note_joint(y, step, steps, line, before, peaks, profile, tensions):
    """Enter joint `step` of `steps`, of force and position `y`, into peaks and profile; `before` keeps the last joint.

    Nodes lie between joints on straight segments.
    """
    keep_peaks(y, line, peaks)
    nodes, now, was = len(tensions), tension(y), tension(before)
    first = int(np.floor((step - 1) * (nodes - 1) / steps)) + 1 if step > 0 else 0
    for node in range(first, int(np.floor(step * (nodes - 1) / steps)) + 1 if nodes > 0 else 0):
        share = node * steps / (nodes - 1) - (step - 1) if step > 0 else 1.0
        tensions[node] = was + share * (now - was)
        for k in range(3):
            profile[node, k] = before[3 + k] + share * (y[3 + k] - before[3 + k])
    for k in range(PLAIN):
        before[k] = y[k]


@dataclass(frozen=True)
class PolygonLine(SolvedLine):
    """A line that was marched along; `closing_error` is the distance by which it misses the end that was given."""

    march: March
    pull: Array
    joints: Joints
    segments: int
    closing_error: Array

    @property
    def position_B(self) -> Array:
        return self.joints.position

    @property
    def force_B(self) -> Array:
        return self.joints.force

    @property
    def angle_A(self) -> Array:
        return self._angle(self.pull)

    @property
    def max_tension(self) -> Array:
        return self.joints.peaks[:, TENSION_PEAK, 0]

    @property
    def lowest_point(self) -> Array:
        return self.joints.peaks[:, LOWEST, 1:]

    @property
    def farthest_point(self) -> Array:
        return self.joints.peaks[:, FARTHEST, 1:]

    @property
    def steps(self) -> Array:
        return np.full(self.line_length.size, float(self.segments))

    @cached_property
    def shape(self) -> tuple[Array, Array]:
        joints = self.march(self.pull, self.line_length, self.loads, self.nodes)
        return joints.profile, joints.profile_tension


def solve_polygon(p: StreamLine, march: March, segments: int, nodes: int) -> Solution:
    """Solve any of the problems with a method that marches from A over a length."""
    solve = _between_ends if p.position_B is not None else _over_length if p.depth is None else _to_depth
    pull, length, status, iterations = solve(p, march)
    joints = march(pull, length, p.loads, 0)
    given = p.force_A if p.force_A is not None else pull
    line = PolygonLine(given, length, p.loads, nodes, march, pull, joints, segments, _miss(p, joints.position))
    finite = np.isfinite(joints.position).all(axis=1) & np.isfinite(joints.force).all(axis=1)
    status = np.where((status == Status.infeasible) | (finite & ~joints.broken), status, Status.out_of_domain)
    return Solution(np.where(p.has_load, status, Status.out_of_domain).astype(np.int8), line, iterations)


# Force at A, length, status and iterations.
Answer = tuple[Array, Array, np.ndarray, np.ndarray]


def _over_length(p: StreamLine, march: March) -> Answer:
    return p.pull, p.line_length, np.full(p.size, Status.ok), np.ones(p.size, dtype=np.int32)


def _to_depth(p: StreamLine, march: March) -> Answer:
    exact = exact_march(p.pull, LONGEST_FOR_DEPTH * p.depth, p.loads, START, depth=p.depth)
    reached = exact.end == REACHED

    def system(length: Array, which: np.ndarray) -> tuple[Array, Array]:
        """The end's height over the depth less one; its slope by a difference, the polygon's own."""
        longer = length * (1.0 + DIFFERENCE)
        own, pull, depth = p.loads.take(which), p.pull[which], p.depth[which, None]
        height, higher = (march(pull, part[:, 0], own, 0).position[:, 2:] for part in (length, longer))
        return height / depth - 1.0, ((higher - height) / (depth * DIFFERENCE * length))[:, :, None]

    points = damped_newton(system, np.where(reached, exact.length, p.depth)[:, None], TOLERANCE)
    # Newton may also find the depth behind A, on a line of negative length.
    fate = np.where(points.converged & (points.x[:, 0] > 0.0), Status.ok, Status.not_converged)
    return p.pull, points.x[:, 0], np.where(reached, fate, Status.infeasible), points.iterations


def _between_ends(p: StreamLine, march: March) -> Answer:
    chord, length = p.feasible_ends
    exact = force_between_ends(chord, length, p.loads, START)
    start = exact_march(exact.force, -exact.at, p.loads, START).force

    def system(force: Array, which: np.ndarray) -> tuple[Array, Array]:
        own, extent = p.loads.take(which), length[which]
        end = march(force, extent, own, 0).position
        step = DIFFERENCE * np.linalg.norm(force, axis=1)
        moved = [march(force + step[:, None] * axis, extent, own, 0).position for axis in np.eye(3)]
        jacobian = np.stack([(other - end) / step[:, None] for other in moved], axis=2)
        return (end - chord[which]) / extent[:, None], jacobian / extent[:, None, None]

    points = damped_newton(system, start, TOLERANCE)
    fate = np.where(points.converged, Status.ok, Status.not_converged)
    return points.x, length, np.where(p.fate_of_ends == Status.ok, fate, p.fate_of_ends), points.iterations


def _miss(p: StreamLine, end: Array) -> Array:
    if p.position_B is not None:
        return np.linalg.norm(end - p.position_B, axis=1)
    return np.zeros(p.size) if p.depth is None else np.abs(end[:, 2] - p.depth)
