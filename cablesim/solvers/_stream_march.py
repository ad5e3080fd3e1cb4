"""Marching along many lines in a stream from a known force, forwards or backwards, to a length or up to a depth."""

from dataclasses import dataclass

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.compiled import compiled
from cablesim.numerics.dop853 import STAGES
from cablesim.physics.stream import FULL, PLAIN, StreamLoads
from cablesim.solvers._stream_step import (
    COVERED,
    PEAKS,
    REACHED,
    SLACKEST,
    advance,
    keep_peaks,
    sides_at,
    start,
    tension,
)


@dataclass(frozen=True)
class March:
    """Where a march ended: arrays of shape (scenario, ...).

    `force` and `position` (scenario, 3), `length` the arc length covered, `by_force` d(position)/d(first force) of
    shape (scenario, 3, 3), `peaks` (scenario, peak, 4) the largest tension, the lowest point and the one farthest
    downstream (value, then x, y, z), `steps` taken, `slack_length` and `slack_force` where the tension was least,
    `end` why it ended.
    """

    force: Array
    position: Array
    length: Array
    by_force: Array
    peaks: Array
    steps: np.ndarray
    slack_length: Array
    slack_force: Array
    end: np.ndarray


def march(
    force: Array,
    length: Array,
    loads: StreamLoads,
    rtol: float | Array,
    *,
    depth: Array | None = None,
    sensitive: bool = False,
) -> March:
    """Integrate many lines from their first force (scenario, 3) over a signed arc length (scenario,).

    With `depth` a march ends where it first rises to that height, and `length` is the most it may take.
    """
    n = length.size
    result = March(
        np.empty((n, 3)),
        np.empty((n, 3)),
        np.empty(n),
        np.empty((n, 3, 3)),
        np.empty((n, PEAKS, 4)),
        np.zeros(n, dtype=np.int64),
        np.empty(n),
        np.empty((n, 3)),
        np.zeros(n, dtype=np.int64),
    )
    targets = np.full(n, np.nan) if depth is None else depth
    tolerances = np.ascontiguousarray(np.broadcast_to(rtol, n), dtype=float)
    _march_all(
        np.ascontiguousarray(force), np.ascontiguousarray(length), targets, loads.packed, loads.friction_law,
        tolerances, FULL if sensitive else PLAIN, result.force, result.position, result.length, result.by_force,
        result.peaks, result.steps, result.slack_length, result.slack_force, result.end,
    )  # fmt: skip
    return result


def moved_by_turn(force: Array, turn: float, end: March, loads: StreamLoads, rtol: float, rows: np.ndarray) -> Array:
    """How far, in lengths of the line, B of some lines moves when the first force is turned aside by a small angle.

    Infinite where the turned line is lost on its way, zero without a length.
    """
    force, length = force[rows], end.length[rows]
    size = np.linalg.norm(force, axis=1)[:, None]
    with np.errstate(all="ignore"):
        # To one side and upwards at once: a line may be steady in a plane and not across it.
        side = np.cross(force, np.where(np.abs(force[:, 2:]) > 0.8 * size, [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]))
        other = march(force + turn * (side + np.cross(side, force) / size), length, loads.take(rows), rtol)
        moved = np.linalg.norm(other.position - end.position[rows], axis=1) / length
    return np.where(length > 0.0, np.where(other.end == REACHED, moved, np.inf), 0.0)


def trace(force: Array, at: Array, length: Array, loads: StreamLoads, rtol: Array, nodes: int) -> tuple[Array, Array]:
    """Positions from A and force vectors (scenario, node, 3) at equal steps of arc length.

    `force` is known at the arc length `at` from A.
    """
    n = length.size
    positions, forces = np.empty((n, nodes, 3)), np.empty((n, nodes, 3))
    _trace_all(np.ascontiguousarray(force), at, length, loads.packed, loads.friction_law, rtol, positions, forces)
    return positions - positions[:, :1], forces


@compiled
def _march_all(
    force, length, depth, packed, laws, rtol, size, force_end, position, covered, by_force, peaks, steps,
    slack_length, slack_force, end,
):  # fmt: skip
    y, stages, trial = np.empty(size), np.empty((STAGES + 1, size)), np.empty(size)
    slackest = np.empty(4)
    for i in range(length.size):
        start(y, force[i], size)
        peaks[i] = -np.inf
        sides = sides_at(y, packed[i], 1.0 if length[i] >= 0.0 else -1.0, depth[i])
        slackest[:] = tension(y), y[0], y[1], y[2]
        progress = np.zeros(3)
        keep_peaks(y, packed[i], peaks[i])
        end[i], steps[i] = advance(
            y, progress, length[i], abs(length[i]), depth[i], packed[i], laws[i], sides, rtol[i], size, stages,
            trial, slackest, peaks[i],
        )  # fmt: skip
        for k in range(3):
            force_end[i, k], position[i, k], slack_force[i, k] = y[k], y[3 + k], slackest[1 + k]
        covered[i], slack_length[i] = progress[COVERED], progress[SLACKEST]
        if size == FULL:
            for j in range(3):
                for k in range(3):
                    by_force[i, j, k] = y[15 + 3 * j + k]


@compiled
def _trace_all(force, at, length, packed, laws, rtol, positions, forces):
    """Both ways from where the force is known; positions are counted from there."""
    nodes = positions.shape[1]
    for i in range(length.size):
        first = int(np.ceil(at[i] / length[i] * (nodes - 1)))
        _trace(force[i], at[i], length[i], packed[i], laws[i], rtol[i], first, nodes, 1, positions[i], forces[i])
        _trace(force[i], at[i], length[i], packed[i], laws[i], rtol[i], first - 1, -1, -1, positions[i], forces[i])


@compiled
def _trace(force, at, length, line, law, rtol, first, stop, step, positions, forces):
    """The nodes from `first` up or down to before `stop`."""
    y, stages, trial = np.empty(PLAIN), np.empty((STAGES + 1, PLAIN)), np.empty(PLAIN)
    slackest, peaks = np.zeros(4), np.empty((PEAKS, 4))
    start(y, force, PLAIN)
    sides = sides_at(y, line, float(step), np.nan)
    progress = np.zeros(3)
    for node in range(first, stop, step):
        target = length * node / (len(positions) - 1) - at
        advance(y, progress, target, length, np.nan, line, law, sides, rtol, PLAIN, stages, trial, slackest, peaks)
        for k in range(3):
            positions[node, k], forces[node, k] = y[3 + k], y[k]
