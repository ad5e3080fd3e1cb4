"""Two-point problem of a line in a stream: the force at A of a line of given length between two given ends.

The unknown is the force where the line is slackest, not at an end: from there the line is integrated to both ends, and
errors of the unknown shrink on the way instead of growing. It starts from the catenary that the line would be under a
uniform load, is found by damped Newton with the exact derivatives of the integration, and, where that fails, by
following the line while its load turns from the uniform one into its own, or while it is paid out from nearly taut.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.hyperbolic import inverse_sinhc_excess
from cablesim.numerics.newton import Points, damped_newton
from cablesim.physics.stream import StreamLoads
from cablesim.solvers._stream_march import march
from cablesim.solvers._stream_step import REACHED

# Accuracy of the integration while Newton is still on its way.
COARSE, CLOSE_ENOUGH = 1e-5, 1e-3
SMALLEST_SLACK = 1e-6
# The tolerance of a step in units of the accuracy asked for, which many steps have to keep; and the least that helps.
ACCURACY, SMALLEST_TOLERANCE = 0.1, 1e-13
# Steps of the integration change from one try to the next, and may leave an end this many tolerances away.
NOISE = 5.0
# A catenary with its ends nearer to one load line than this part of its slack has no shape to start from.
NARROWEST = 1e-3
# Nearer than this it hangs straight down from its ends, folded where hardly this part of its load is left as tension.
FOLDED, TRACE = 1e-12, 1e-16
MOST_CONTINUATION_STEPS = 120
SMALLEST_CONTINUATION_STEP = 1e-3
LARGEST_CONTINUATION_STEP = 0.25
TAUT = 1.0 + 1e-3
# Chord, length and loads of the lines `which` at a share of the way.
Stage = Callable[[np.ndarray, Array], tuple[Array, Array, StreamLoads]]


@dataclass(frozen=True)
class Anchor:
    """The unknown of the two-point problem: force (n, 3) at the arc length `at` (n,) from A."""

    force: Array
    at: Array


@dataclass(frozen=True)
class InnerForce:
    """Force (n, 3) at the arc length `at` (n,) from A, where the line is slackest; whether B is met; integrations.

    `rtol` (n,) is the tolerance of the integration that gives the tension to the accuracy asked for.
    """

    force: Array
    at: Array
    converged: np.ndarray
    iterations: np.ndarray
    rtol: Array


def force_between_ends(chord: Array, length: Array, loads: StreamLoads, rtol: float) -> InnerForce:
    """The force of lines whose B is at `chord` (n, 3) from A; every line must be longer than its chord."""
    fine = integration_tolerance(chord, length, rtol)
    anchor = catenary_start(chord, length, loads, uniform_load(chord, length, loads))
    points, anchor = _solve(anchor, chord, length, loads, fine)
    work = points.iterations
    for follow in (_by_load, _by_length):
        failed = np.flatnonzero(~points.converged)
        if not failed.size:
            break
        part = (chord[failed], length[failed], loads.take(failed))
        found, steps = follow(*part)
        again, moved = _solve(found, *part, fine[failed])
        points = _replaced(points, failed, again)
        anchor.force[failed], anchor.at[failed] = moved.force, moved.at
        work[failed] += again.iterations + steps
    return InnerForce(points.x, anchor.at, points.converged, work, fine)


def integration_tolerance(chord: Array, length: Array, rtol: float) -> Array:
    """Tolerance of position that gives the tension to `rtol`: the tension of a taut line follows from its slack."""
    slack = 1.0 - np.linalg.norm(chord, axis=1) / length
    return np.maximum(ACCURACY * rtol * slack, SMALLEST_TOLERANCE)


def uniform_load(chord: Array, length: Array, loads: StreamLoads) -> Array:
    """A uniform load (n, 3) like the line's own: that of its chord and, as far as it is slack, of a line across."""
    distance = np.linalg.norm(chord, axis=1)
    upright = np.array([0.0, 0.0, 1.0])
    tangent = np.where(distance[:, None] > 0.0, chord / np.maximum(distance, 1e-300)[:, None], upright)
    across = loads.steady.copy()
    across[:, :2] += 0.5 * loads.normal_drag[:, None] * loads.direction
    share = (distance / length)[:, None]
    return share * loads.on_straight_line(tangent) + (1.0 - share) * across


def catenary_start(chord: Array, length: Array, loads: StreamLoads, uniform: Array) -> Anchor:
    """Force of an inextensible catenary under the uniform load, at its vertex or the end that is nearest to it."""
    weight = np.linalg.norm(uniform, axis=1)
    up = -uniform / np.maximum(weight, 1e-300)[:, None]
    rise = np.einsum("ij,ij->i", chord, up)
    across = chord - rise[:, None] * up
    span = np.linalg.norm(across, axis=1)
    sideways = np.where((span > 1e-9 * length)[:, None], across, _perpendicular(up, loads))
    sideways /= np.linalg.norm(sideways, axis=1)[:, None]
    level = np.sqrt(np.maximum(length**2 - rise**2, 1e-12 * length**2))
    folded = span <= FOLDED * length
    span = np.minimum(np.maximum(span, NARROWEST * level), level * (1.0 - 1e-12))
    half_angle = inverse_sinhc_excess(level / span - 1.0)
    parameter = span / (2.0 * half_angle)
    slope = np.sinh(np.arctanh(np.clip(rise / length, -1.0 + 1e-12, 1.0 - 1e-12)) - half_angle)
    at = np.clip(-parameter * slope, 0.0, length)
    force = weight[:, None] * (parameter[:, None] * sideways + (parameter * slope + at)[:, None] * up)
    at = np.where(folded, 0.5 * (length - rise), at)
    force[folded] = TRACE * (weight * length)[folded, None] * up[folded]
    return Anchor(force, at)


def _perpendicular(up: Array, loads: StreamLoads) -> Array:
    """A direction at a right angle to the load: along the stream as far as that can be."""
    along = np.column_stack([loads.direction, np.zeros(len(up))])
    along = along - np.einsum("ij,ij->i", along, up)[:, None] * up
    other = np.column_stack([-loads.direction[:, 1], loads.direction[:, 0], np.zeros(len(up))])
    return np.where((np.linalg.norm(along, axis=1) > 1e-6)[:, None], along, other)


def _solve(anchor: Anchor, chord: Array, length: Array, loads: StreamLoads, rtol: Array) -> tuple[Points, Anchor]:
    """Newton with a coarse integration, the unknown moved to where the line is slackest, then with a fine one."""
    first, close = _on_the_way(chord, length)
    coarse = _newton(anchor, chord, length, loads, first, close)
    anchor = _slackest(coarse.x, anchor.at, length, loads, first)
    fine = _newton(anchor, chord, length, loads, rtol, rtol)
    return Points(fine.x, fine.residual, fine.residual <= NOISE * rtol, coarse.iterations + fine.iterations), anchor


def _on_the_way(chord: Array, length: Array) -> tuple[Array, Array]:
    """Tolerances of integration and end while Newton is on its way; a taut line needs finer ones to be seen at all."""
    slack = np.maximum(1.0 - np.linalg.norm(chord, axis=1) / length, SMALLEST_SLACK)
    return COARSE * slack, CLOSE_ENOUGH * slack


def _newton(anchor: Anchor, chord: Array, length: Array, loads: StreamLoads, rtol: Array, tolerance: Array) -> Points:
    def system(force: Array, which: np.ndarray) -> tuple[Array, Array]:
        own, at = loads.take(which), anchor.at[which]
        onward = march(force, length[which] - at, own, rtol[which], sensitive=True)
        back = march(force, -at, own, rtol[which], sensitive=True)
        scale = 1.0 / length[which]
        miss = (onward.position - back.position - chord[which]) * scale[:, None]
        miss[(onward.end != REACHED) | (back.end != REACHED)] = np.nan
        return miss, (onward.by_force - back.by_force) * scale[:, None, None]

    return damped_newton(system, anchor.force, tolerance)


def _slackest(force: Array, at: Array, length: Array, loads: StreamLoads, rtol: Array) -> Anchor:
    """The same lines, known by their force where their tension is least."""
    onward, back = march(force, length - at, loads, rtol), march(force, -at, loads, rtol)
    ahead = np.linalg.norm(onward.slack_force, axis=1) <= np.linalg.norm(back.slack_force, axis=1)
    shift = np.where(ahead, onward.slack_length, back.slack_length)
    return Anchor(np.where(ahead[:, None], onward.slack_force, back.slack_force), np.clip(at + shift, 0.0, length))


def _by_load(chord: Array, length: Array, loads: StreamLoads) -> tuple[Anchor, np.ndarray]:
    """From the catenary under a uniform load to the line under its own."""
    uniform = uniform_load(chord, length, loads)
    start = catenary_start(chord, length, loads, uniform)

    def stage(which: np.ndarray, share: Array) -> tuple[Array, Array, StreamLoads]:
        return chord[which], length[which], loads.take(which).blended(uniform[which], share)

    return _follow(start, stage)


def _by_length(chord: Array, length: Array, loads: StreamLoads) -> tuple[Anchor, np.ndarray]:
    """From a nearly taut line to one of full length, paid out between the same ends."""
    taut = np.minimum(TAUT * np.linalg.norm(chord, axis=1), length)
    start = catenary_start(chord, taut, loads, uniform_load(chord, taut, loads))
    first = _newton(start, chord, taut, loads, *_on_the_way(chord, taut))
    start = Anchor(first.x, start.at / taut)

    def stage(which: np.ndarray, share: Array) -> tuple[Array, Array, StreamLoads]:
        return chord[which], taut[which] * (length[which] / taut[which]) ** share, loads.take(which)

    return _follow(start, stage, relative=True)


def _follow(start: Anchor, stage: Stage, relative: bool = False) -> tuple[Anchor, np.ndarray]:
    """Follow solutions from share 0 to 1 with steps that grow after a success and shrink after a failure."""
    n = len(start.at)
    force, at = start.force.copy(), start.at.copy()
    share, step, work = np.zeros(n), np.full(n, 0.1), np.zeros(n, dtype=np.int32)
    active = np.arange(n)
    for _ in range(MOST_CONTINUATION_STEPS):
        active = active[(share[active] < 1.0) & (step[active] >= SMALLEST_CONTINUATION_STEP)]
        if not active.size:
            break
        goal = np.minimum(1.0, share[active] + step[active])
        chord, length, loads = stage(active, goal)
        where = at[active] * length if relative else at[active]
        rtol, tolerance = _on_the_way(chord, length)
        found = _newton(Anchor(force[active], where), chord, length, loads, rtol, tolerance)
        work[active] += found.iterations
        good = found.converged
        done = active[good]
        moved = _slackest(found.x[good], where[good], length[good], loads.take(good), rtol[good])
        force[done], at[done] = moved.force, moved.at / length[good] if relative else moved.at
        share[done] = goal[good]
        step[done] = np.minimum(2.0 * step[done], LARGEST_CONTINUATION_STEP)
        step[active[~good]] *= 0.25
    _, length, _ = stage(np.arange(n), share)
    return Anchor(force, at * length if relative else at), work


def _replaced(points: Points, which: np.ndarray, better: Points) -> Points:
    """`points` with some of them solved again."""
    for name in ("x", "residual", "converged", "iterations"):
        getattr(points, name)[which] = getattr(better, name)
    return points
