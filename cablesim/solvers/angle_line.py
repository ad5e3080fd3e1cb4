"""Angle form of the line in a stream, as the source integrates it: kept to show where it breaks down.

    cos a = +-sqrt(1 - cos^2 b - cos^2 g),  dT/ds = -(q_x cos a + q_y cos b + q_z cos g)
    db/ds = (q_y - cos b q.t) / (T sin b),   dg/ds = (q_z - cos g q.t) / (T sin g)

with a, b, g the angles of the tangent to the stream, across it and to the vertical, and the loads q of `stream_line`.
The third cosine is a square root, so it cannot change its sign along the line (the source takes the positive root; here
the root has the sign that it has at A), and the form divides by sin b and sin g. Where the line comes to stand across
the stream, or along one of the other axes, the scenario is `out_of_domain`; where twice as long steps give another
answer than `rtol` allows, `not_converged`. Classical Runge-Kutta steps of order 4.

Reference: Handbook on ropes and fishing gear (in Chinese), section 3-3.
"""

from dataclasses import dataclass, replace

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
from cablesim.status import Status

__all__ = ["OUTPUTS", "Options", "Parameters", "solve"]

COMPILED = True
ITERATES = True
# Below this sine a division by it is one by zero.
SMALLEST_SINE = 1e-8
NOWHERE = np.full(3, np.nan)
# Parts of the state: position in the axes of the stream, tension, b and g.
ALONG, ACROSS, UP, TENSION, BETA, GAMMA = range(6)


@dataclass(frozen=True)
class Options(_stream_line.Nodes):
    """Numerical options."""

    segments: int = option(400, at_least=2, at_most=1_000_000, meaning="steps of equal length")
    rtol: float = option(1e-6, at_least=1e-12, at_most=1e-2, meaning="largest change when the steps are halved")


def seconds_per_scenario(options: Options) -> float:
    return 5e-6 * options.segments


def seconds_of(p: Parameters, options: Options) -> Array:
    return _stream_line.march_seconds(p, seconds_per_scenario(options), 4e-7 * options.segments)


def solve(p: Parameters, options: Options) -> Solution:
    def march(force: Array, length: Array, loads: StreamLoads, nodes: int, segments: int = options.segments) -> Joints:
        joints = Joints.empty(length.size, nodes)
        _march_all(
            np.ascontiguousarray(force), length, loads.packed, loads.friction_law, segments, joints.position,
            joints.force, joints.peaks, joints.profile, joints.profile_tension, joints.broken,
        )  # fmt: skip
        return joints

    solution = solve_polygon(p, march, options.segments, options.nodes)
    line = solution.answer
    coarse = march(line.pull, line.line_length, line.loads, 0, max(1, options.segments // 2))
    moved = np.linalg.norm(coarse.position - line.position_B, axis=1) / line.line_length
    turned = np.linalg.norm(coarse.force - line.force_B, axis=1) / line.tension_B
    rough = (solution.status == Status.ok) & ~((moved <= options.rtol) & (turned <= options.rtol) & ~coarse.broken)
    return replace(solution, status=np.where(rough, Status.not_converged, solution.status).astype(np.int8))


@compiled
def _march_all(force, length, packed, laws, segments, position_end, force_end, peaks, profile, tensions, broken):
    y, trial, slopes = np.empty(6), np.empty(6), np.empty((4, 6))
    joint, before, q = np.empty(PLAIN), np.empty(PLAIN), np.empty(3)
    for i in range(length.size):
        line, law, h = packed[i], laws[i], length[i] / segments
        side = _start(force[i], line, y)
        _joint(y, side, line, joint)
        before[:], peaks[i] = joint, -np.inf
        note_joint(joint, 0, segments, line, before, peaks[i], profile[i], tensions[i])
        sound = True
        for j in range(segments):
            sound = sound and _rates(y, side, h, line, law, q, slopes[0])
            for stage in range(1, 4):
                for k in range(6):
                    trial[k] = y[k] + (h if stage == 3 else 0.5 * h) * slopes[stage - 1, k]
                sound = sound and _rates(trial, side, 0.0, line, law, q, slopes[stage])
            if not sound:
                break
            for k in range(6):
                y[k] += h / 6.0 * (slopes[0, k] + 2.0 * slopes[1, k] + 2.0 * slopes[2, k] + slopes[3, k])
            _joint(y, side, line, joint)
            note_joint(joint, j + 1, segments, line, before, peaks[i], profile[i], tensions[i])
        broken[i] = not sound
        force_end[i], position_end[i] = (joint[:3], joint[3:]) if sound else (NOWHERE, NOWHERE)


@compiled
def _start(force, line, y):
    """The state at A; returns the sign that the third cosine is to keep."""
    tension = np.sqrt(force[0] ** 2 + force[1] ** 2 + force[2] ** 2)
    along = force[0] * line[EX] + force[1] * line[EY]
    y[:3], y[TENSION] = 0.0, tension
    y[BETA] = np.arccos((force[1] * line[EX] - force[0] * line[EY]) / tension)
    y[GAMMA] = np.arccos(force[2] / tension)
    return 1.0 if along > 0.0 else -1.0


@compiled
def _tangent(y, side):
    """Cosines along the stream, across it and up; the first is NaN where the other two leave no room for it."""
    across, up = np.cos(y[BETA]), np.cos(y[GAMMA])
    return side * np.sqrt(1.0 - across * across - up * up), across, up


@compiled
def _joint(y, side, line, joint):
    """Force and position in the axes of the scenario."""
    along, across, up = _tangent(y, side)
    ex, ey = line[EX], line[EY]
    joint[0], joint[1] = y[TENSION] * (along * ex - across * ey), y[TENSION] * (along * ey + across * ex)
    joint[2], joint[5] = y[TENSION] * up, y[UP]
    joint[3], joint[4] = y[ALONG] * ex - y[ACROSS] * ey, y[ALONG] * ey + y[ACROSS] * ex


@compiled
def _rates(y, side, h, line, law, q, dy):
    """d/ds of the state into `dy`; False where the form breaks down, or will before a step of size h is done."""
    along, across, up = _tangent(y, side)
    sine_b, sine_g = np.sin(y[BETA]), np.sin(y[GAMMA])
    if not (along == along and y[TENSION] > 0.0 and min(sine_b, sine_g) > SMALLEST_SINE):
        return False
    ex, ey = line[EX], line[EY]
    load(along * ex - across * ey, along * ey + across * ex, up, line, law, side, q)
    q_along, q_across = q[0] * ex + q[1] * ey, q[1] * ex - q[0] * ey
    pull = q_along * along + q_across * across + q[2] * up
    dy[ALONG], dy[ACROSS], dy[UP], dy[TENSION] = along, across, up, -pull
    dy[BETA] = (q_across - across * pull) / (y[TENSION] * sine_b)
    dy[GAMMA] = (q[2] - up * pull) / (y[TENSION] * sine_g)
    # Where the true cosine passes through zero, the root only touches it and returns: a wrong line that looks sound.
    return side * (along - h * (q_along - along * pull) / y[TENSION]) > 0.0 or h == 0.0
