"""Plane line in a uniform stream by Pode's functions: closed form for the tension, quadrature for the rest.

    T da/ds = p cos a - K_n sin a |sin a|,   dT/ds = f_s K_n + p sin a                                (M11)

The line must lie in the vertical plane of the stream (x, z), without lay angle. From a known force the angle at the
other end follows from the length, or from the depth, along one monotone integral; between two given ends the angles at
both ends follow from direction and length of the chord. A floating line is the mirror image of a heavy one, still water
is the limit of a critical angle of 90 deg, the neutral line that of 0. A line on the other side of the singular angle
is the same line walked from its other end.

The tension is a difference of logarithms, which friction makes huge near the singular angles of a nearly weightless
line: one whose tension would keep less than ten digits is out of domain.

Reference: L. Pode, David Taylor Model Basin report 687, 1951; Handbook on ropes and fishing gear (in Chinese), sections
3-4 and 3-5.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.newton import System, damped_newton
from cablesim.physics.stream import critical_angle
from cablesim.solver import Solution
from cablesim.solvers._pode_march import (
    HORIZONTAL,
    LENGTH,
    TENSION,
    VERTICAL,
    angles,
    end_slopes,
    logits,
    packed,
    pode_integrals,
    tension_logarithms,
    walk,
)
from cablesim.solvers._stream_ends import InnerForce, force_between_ends
from cablesim.solvers._stream_line import LONGEST_FOR_DEPTH, OUTPUTS, TURN, SolvedLine, march_seconds
from cablesim.solvers._stream_line import Nodes as Options
from cablesim.solvers._stream_line import StreamLine as Parameters
from cablesim.status import Status

__all__ = ["OUTPUTS", "Options", "Parameters", "solve"]

SECONDS_PER_SCENARIO = 2e-4
COMPILED = True
ITERATES = True

# Accuracy of the estimate from which the two angles of a line between given ends are refined, and of the result.
ESTIMATE, TOLERANCE = 1e-8, 1e-13
# A force or chord that leaves the plane by less than this part of itself does so by rounding alone.
IN_PLANE = 1e-12
# A tension is worth the rounding of its logarithm, and that of u times how steep it is; it must be this much.
WORTH = 1e-10
# A turn of the force at A by TURN may move B by MOST_GROWTH times that of the length.
MOST_GROWTH = 1e6


@dataclass(frozen=True)
class Plane:
    """The lines as Pode's plane has them: heavy, walked against the stream.

    `mirror` is -1 for a floating line, `direction` of the walk from A is -1 towards smaller u, `load` is M = K_n / cos.
    """

    lines: Array
    load: Array
    mirror: Array
    direction: Array
    critical: Array

    def logit(self, force: Array, stream: Array) -> Array:
        """u of the tangents of forces (scenario, 3)."""
        against = -np.einsum("ij,ij->i", force[:, :2], stream)
        sign = -self.direction
        angle = np.arctan2(sign * self.mirror * force[:, 2], sign * against)
        return logits(np.where(angle < self.critical, angle + 2.0 * np.pi, angle), self.critical)


@dataclass(frozen=True)
class PodeLine(SolvedLine):
    """From u at A over the integrals (scenario, 4) to B, in units of T_A / M."""

    plane: Plane
    start: Array
    end: Array
    integrals: Array
    closing_error: Array

    @property
    def position_B(self) -> Array:
        return self._position(self.integrals)

    @property
    def force_B(self) -> Array:
        return self.force_of(self.end, self.tension_A * np.exp(self.integrals[:, TENSION]))

    @property
    def max_tension(self) -> Array:
        # The tension has no maximum inside: it falls, and then rises.
        return np.maximum(self.tension_A, self.tension_B)

    @property
    def lowest_point(self) -> Array:
        return self._peak(np.full(self.start.size, np.pi), 2, -1.0)

    @property
    def farthest_point(self) -> Array:
        return self._peak(np.full(self.start.size, 0.5 * np.pi), 0, 1.0)

    @property
    def steps(self) -> Array:
        return np.ceil(np.abs(self.end - self.start))

    @cached_property
    def shape(self) -> tuple[Array, Array]:
        fraction = np.linspace(0.0, 1.0, self.nodes)[1:-1]
        inner = fraction * self.integrals[:, LENGTH, None]
        ones = np.ones(self.start.size)
        _, found = walk(self.start, self.plane.direction, self.plane.lines, LENGTH, ones, inner)
        found = np.concatenate([np.zeros((len(found), 1, 4)), found, self.integrals[:, None]], axis=1)
        positions = np.stack([self._position(found[:, i]) for i in range(self.nodes)], axis=1)
        return positions, self.tension_A[:, None] * np.exp(found[:, :, TENSION])

    def _position(self, integrals: Array) -> Array:
        unit = self.tension_A / self.plane.load
        across = -(unit * integrals[:, HORIZONTAL])[:, None] * self.loads.direction
        return np.column_stack([across, unit * self.plane.mirror * integrals[:, VERTICAL]])

    def force_of(self, u: Array, tension: Array) -> Array:
        """Force vectors of tangents at u."""
        angle = angles(u, self.plane.lines)
        signed = -self.plane.direction * tension
        across = -(signed * np.cos(angle))[:, None] * self.loads.direction
        return np.column_stack([across, signed * self.plane.mirror * np.sin(angle)])

    def _peak(self, angle: Array, component: int, sign: float) -> Array:
        """The point at an angle where the line has it, or the end that is greater in a component."""
        inner = logits(angle, self.plane.critical)
        between = (inner - self.start) * (inner - self.end) < 0.0
        at = np.where(between, inner, self.start)
        integrals = pode_integrals(self.start, at, self.plane.lines)
        integrals[:, :3] *= np.where(between, -1.0, 0.0)[:, None]
        candidates = np.stack([np.zeros((at.size, 3)), self._position(integrals), self.position_B])
        downstream = np.einsum("kij,ij->ki", candidates[:, :, :2], self.loads.direction)
        heights = candidates[:, :, 2] if component == 2 else downstream
        return candidates[np.argmax(sign * heights, axis=0), np.arange(at.size)]


def seconds_of(p: Parameters, options: Options) -> Array:
    return march_seconds(p, SECONDS_PER_SCENARIO, 2.5e-5)


def solve(p: Parameters, options: Options) -> Solution:
    return _between_ends(p, options) if p.position_B is not None else _from_end(p, options)


def _from_end(p: Parameters, options: Options) -> Solution:
    plane, start = _plane(p, p.force_A)
    tension = np.linalg.norm(p.force_A, axis=1)
    unit = tension / plane.load
    if p.depth is None:
        which, sign, target = LENGTH, np.ones(p.size), p.line_length / unit
    else:
        which, sign, target = VERTICAL, plane.mirror, p.depth / unit
    ends, walked = walk(start, plane.direction, plane.lines, which, sign, target[:, None])
    end, integrals = ends[:, 0], walked[:, 0]
    # Nearly straight, or near a singular angle, u at both ends is nearly the same, and its rounding a part of the line:
    # of the integrals only the ratios are sure, and one of them is given.
    with np.errstate(divide="ignore", invalid="ignore"):
        integrals[:, :TENSION] *= (target / (sign * integrals[:, which]))[:, None]
    length = p.line_length if p.depth is None else unit * integrals[:, LENGTH]
    line = PodeLine(p.force_A, length, p.loads, options.nodes, plane, start, end, integrals, np.zeros(p.size))
    if p.depth is not None:
        line = replace(line, closing_error=np.abs(line.position_B[:, 2] - p.depth))
    reached = np.isfinite(end) & (length > 0.0) & (p.depth is None or length <= LONGEST_FOR_DEPTH * p.depth)
    inside = _in_plane(p, p.force_A) & (tension > 0.0) & np.isfinite(start) & _keeps_digits(plane, start)
    status = np.full(p.size, Status.out_of_domain, dtype=np.int8)
    met = np.flatnonzero(inside & reached)
    status[met[_is_told(line, met)]] = Status.ok
    if p.depth is not None:
        missed = np.flatnonzero(inside & ~reached)
        status[missed[_never_rises(plane, start, p.depth / unit, missed)]] = Status.infeasible
    return Solution(status, line, np.ones(p.size, dtype=np.int32))


def _between_ends(p: Parameters, options: Options) -> Solution:
    chord, length = p.feasible_ends
    estimate = force_between_ends(chord, length, p.loads, ESTIMATE)
    plane, inner = _plane(p, estimate.force)
    ends = _ends_from_inside(plane, inner, estimate, length)
    points = damped_newton(_closing(plane, p, chord / length[:, None]), ends, TOLERANCE)
    start, end = points.x.T.copy()
    integrals = pode_integrals(start, end, plane.lines)
    integrals[:, :3] *= np.column_stack([plane.direction, -np.ones(p.size), -np.ones(p.size)])
    tension = plane.load * length / integrals[:, LENGTH]
    line = PodeLine(
        np.zeros_like(chord), length, p.loads, options.nodes, plane, start, end, integrals, np.zeros(p.size)
    )
    line = replace(line, force_A=line.force_of(start, tension))
    line = replace(line, closing_error=np.linalg.norm(line.position_B - p.position_B, axis=1))
    status = p.fate_of_ends
    status = np.where(_in_plane(p, p.position_B) | (status == Status.infeasible), status, Status.out_of_domain)
    kept = _keeps_digits(plane, start) & _keeps_digits(plane, end)
    status = np.where((status == Status.ok) & ~kept & points.converged, Status.out_of_domain, status)
    failed = (status == Status.ok) & ~(points.converged & estimate.converged)
    return Solution(np.where(failed, Status.not_converged, status).astype(np.int8), line, points.iterations)


def _plane(p: Parameters, force: Array) -> tuple[Plane, Array]:
    """The plane of each line and u of its tangent at A; u is NaN at the critical angle itself."""
    weight, drag = p.weight_per_length, p.loads.normal_drag
    critical = critical_angle(np.abs(weight), drag)
    ratio = np.where(drag > 0.0, p.loads.tangential_drag / np.where(drag > 0.0, drag, 1.0), 0.0)
    load = (np.abs(weight) + drag) / (np.sin(critical) ** 2 + np.cos(critical))
    lines = packed(critical, ratio, p.friction_law)
    forward = Plane(lines, load, np.where(weight < 0.0, -1.0, 1.0), -np.ones(p.size), critical)
    start = forward.logit(force, p.loads.direction)
    plane = replace(forward, direction=np.where(np.isfinite(start), -1.0, 1.0))
    return plane, plane.logit(force, p.loads.direction)


def _in_plane(p: Parameters, vector: Array) -> np.ndarray:
    """Whether a line with this force or chord stays in the vertical plane of the stream, with loads that Pode knows."""
    across = vector[:, 1] * p.loads.direction[:, 0] - vector[:, 0] * p.loads.direction[:, 1]
    known = (p.loads.magnitude > 0.0) & ((p.loads.normal_drag > 0.0) | (p.loads.tangential_drag == 0.0))
    return known & (p.loads.lateral_drag == 0.0) & (np.abs(across) <= IN_PLANE * np.linalg.norm(vector, axis=1))


def _keeps_digits(plane: Plane, u: Array) -> np.ndarray:
    """Whether the tension at u is sure to `WORTH`: near a singular angle its logarithm is as steep as it is large."""
    rounding = np.finfo(float).eps * (1.0 + np.abs(u))
    return rounding * np.abs(tension_logarithms(u, plane.lines)) <= WORTH


def _is_told(line: PodeLine, rows: np.ndarray) -> np.ndarray:
    """Whether the direction at A of some lines tells the place of B: behind a slack part its last digits may decide."""
    plane, start, lines = line.plane, line.start[rows], line.plane.lines[rows]
    turn = TURN / np.sin(angles(start, lines) - plane.critical[rows])
    turned = np.where(start > 0.0, start - turn, start + turn)
    target = (line.line_length / line.tension_A * plane.load)[rows, None]
    _, walked = walk(turned, plane.direction[rows], lines, LENGTH, np.ones(rows.size), target)
    # Of the integrals only the ratios are sure.
    before, after = (
        sums[:, HORIZONTAL : VERTICAL + 1] / sums[:, LENGTH, None] for sums in (line.integrals[rows], walked[:, 0])
    )
    return np.linalg.norm(after - before, axis=1) <= MOST_GROWTH * TURN


def _never_rises(plane: Plane, start: Array, depth: Array, rows: np.ndarray) -> np.ndarray:
    """Whether lines that do not reach a depth really never do, and not only leave the range of u before."""
    longest = LONGEST_FOR_DEPTH * depth[rows, None]
    ends, _ = walk(start[rows], plane.direction[rows], plane.lines[rows], LENGTH, np.ones(rows.size), longest)
    return (plane.mirror[rows] < 0.0) | np.isfinite(ends[:, 0])


def _ends_from_inside(plane: Plane, inner: Array, estimate: InnerForce, length: Array) -> Array:
    """u at A and B (scenario, 2) of lines known inside: near a singular angle a length says more of u than a force."""
    per_length = plane.load / np.linalg.norm(estimate.force, axis=1)
    forth = np.ones(length.size)
    back = walk(inner, -plane.direction, plane.lines, LENGTH, forth, (estimate.at * per_length)[:, None])[0]
    onward = walk(inner, plane.direction, plane.lines, LENGTH, forth, ((length - estimate.at) * per_length)[:, None])[0]
    return np.hstack([back, onward])


def _closing(plane: Plane, p: Parameters, chord: Array) -> System:
    """The chord over the length, as both follow from the angles at A and B, less the given ones."""
    against = -np.einsum("ij,ij->i", chord[:, :2], p.loads.direction)
    wanted = np.column_stack([against, plane.mirror * chord[:, 2]])

    def system(u: Array, which: np.ndarray) -> tuple[Array, Array]:
        lines, sign = plane.lines[which], -plane.direction[which, None]
        start, end = np.ascontiguousarray(u[:, 0]), np.ascontiguousarray(u[:, 1])
        integrals = pode_integrals(start, end, lines)
        length = integrals[:, LENGTH, None]
        found = sign * integrals[:, HORIZONTAL : VERTICAL + 1] / length
        at_start, at_end = end_slopes(start, start, lines), end_slopes(end, start, lines)
        by_start = -(sign * at_start[:, 1:] - found * at_start[:, :1]) / length
        by_end = (sign * at_end[:, 1:] - found * at_end[:, :1]) / length
        return found - wanted[which], np.stack([by_start, by_end], axis=2)

    return system
