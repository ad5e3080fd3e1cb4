"""Line in a uniform stream, plane or spatial: the vector form, integrated to the accuracy that is asked for.

    dr/ds = t,  dF/ds = -q,  F = T t                                                                  (M12)
    q = K_n |e_p| e_p + K_t g(t.e) t + K_b (0.4 - 0.3 (t.e)^2) (t.e) (t x e) - p z                    (M13)

with the stream along the unit vector e (heading 0: along x), e_p = e - (t.e) t, K_n and K_t the drag coefficients times
rho V^2 d / 2, K_b = 2 pi tan(lay angle) rho V^2 d / 2 and the submerged weight p, counted once. Perfectly flexible and
inextensible; any direction of stream, weight or buoyancy, or still water (the catenary).

Between two given ends it is solved by damped Newton from the catenary under a uniform load, with continuation in
reserve. At the default rtol = 1e-12 position and tension agree with 20-digit references to 1e-10 and better. Where a
line goes through a very slack part, the force at one end does not determine the other end well: an error in its last
digit grows on the way. Where a force known to rtol does not tell the place of B to 1e-6 of the length (or 100 rtol),
the line is out of domain. The two-point problem does not suffer from that: it is solved from the slack part.

Where not to rely on it: a line much lighter than its drag whose ends lie one behind the other in the stream trails as a
hairpin, with next to no tension in its bend; there, and for ends nearer than a thousandth of the length, it often gives
up (`not_converged`).

Reference: Handbook on ropes and fishing gear (in Chinese), sections 3-1 to 3-3.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cablesim.numerics import Array
from cablesim.solver import Solution
from cablesim.solvers._stream_ends import force_between_ends
from cablesim.solvers._stream_line import LONGEST_FOR_DEPTH, OUTPUTS, TURN, Options, SolvedLine, march_seconds
from cablesim.solvers._stream_line import StreamLine as Parameters
from cablesim.solvers._stream_march import March, march, moved_by_turn, trace
from cablesim.solvers._stream_step import FARTHEST, LOWEST, REACHED, TENSION_PEAK, TOO_MANY_STEPS
from cablesim.status import Status

__all__ = ["OUTPUTS", "Options", "Parameters", "solve"]

COMPILED = True
ITERATES = True

# A force at A must tell B: a turn of it, of more than its accuracy, may grow so that rtol leaves WORTH of the length at
# B or, where that is coarse, LEAST_GROWTH times itself; and B may not move by more than FARTHEST_OFF.
WORTH, LEAST_GROWTH, FARTHEST_OFF = 1e-6, 100.0, 0.1
# Through a part with a tension below FAINT of that at A the rounding of the force may grow to more than that; behind
# one below LOST of it, in a stream, nothing is left of the force but rounding.
FAINT, LOST, ROUNDING = 1e-8, 1e-13, 1e-15


@dataclass(frozen=True)
class IntegratedLine(SolvedLine):
    """Integrated both ways from the force (scenario, 3) at the arc length `at` from A."""

    rtol: Array
    force: Array
    at: Array
    onward: March
    back: March
    closing_error: Array

    @property
    def position_B(self) -> Array:
        return self.onward.position - self.back.position

    @property
    def angle_A(self) -> Array:
        # Of the pull that a line without one begins with: its own zero force has no direction.
        return self._angle(self.back.force)

    @property
    def force_B(self) -> Array:
        return self.onward.force

    @property
    def max_tension(self) -> Array:
        return np.maximum(self.onward.peaks[:, TENSION_PEAK, 0], self.back.peaks[:, TENSION_PEAK, 0])

    @property
    def lowest_point(self) -> Array:
        return self._peak(LOWEST)

    @property
    def farthest_point(self) -> Array:
        return self._peak(FARTHEST)

    @property
    def steps(self) -> Array:
        return (self.onward.steps + self.back.steps).astype(float)

    @cached_property
    def shape(self) -> tuple[Array, Array]:
        positions, forces = trace(self.force, self.at, self.line_length, self.loads, self.rtol, self.nodes)
        return positions, np.linalg.norm(forces, axis=2)

    def _peak(self, kind: int) -> Array:
        """Position from A of the greater of two peaks."""
        onward, back = self.onward.peaks[:, kind], self.back.peaks[:, kind]
        return np.where(onward[:, :1] >= back[:, :1], onward[:, 1:], back[:, 1:]) - self.back.position


def seconds_per_scenario(options: Options) -> float:
    return 8e-5 * options.rtol ** (-1.0 / 18.0)


def seconds_of(p: Parameters, options: Options) -> Array:
    return march_seconds(p, seconds_per_scenario(options), 0.18 * seconds_per_scenario(options))


def solve(p: Parameters, options: Options) -> Solution:
    if p.position_B is not None:
        return _between_ends(p, options)
    return _to_depth(p, options) if p.depth is not None else _over_length(p, options)


def _over_length(p: Parameters, options: Options) -> Solution:
    onward = march(p.pull, p.line_length, p.loads, options.rtol)
    return _from_end(p, options, onward, p.line_length, np.zeros(p.size))


def _to_depth(p: Parameters, options: Options) -> Solution:
    onward = march(p.pull, LONGEST_FOR_DEPTH * p.depth, p.loads, options.rtol, depth=p.depth)
    return _from_end(p, options, onward, onward.length, np.abs(onward.position[:, 2] - p.depth))


def _from_end(p: Parameters, options: Options, onward: March, length: Array, miss: Array) -> Solution:
    at = np.zeros(p.size)
    back, rtol = march(p.pull, at, p.loads, options.rtol), np.full(p.size, options.rtol)
    line = IntegratedLine(p.force_A, length, p.loads, options.nodes, rtol, p.pull, at, onward, back, miss)
    fates = np.array([Status.ok, Status.infeasible, Status.not_converged], dtype=np.int8)
    followed = np.flatnonzero(onward.end != TOO_MANY_STEPS)
    told = np.ones(p.size, dtype=bool)
    told[followed] = _is_told(p, onward, options.rtol, followed)
    status = np.where(p.has_load & told, fates[onward.end], Status.out_of_domain).astype(np.int8)
    return Solution(status, line, np.ones(p.size, dtype=np.int32))


def _is_told(p: Parameters, onward: March, rtol: float, rows: np.ndarray) -> np.ndarray:
    """Whether the force at A of some lines, as it is integrated, tells where they end."""
    turn, growth = max(TURN, 10.0 * rtol), max(WORTH / rtol, LEAST_GROWTH)
    moved = moved_by_turn(p.pull, turn, onward, p.loads, max(rtol, TURN), rows)
    told = moved <= min(growth * turn, FARTHEST_OFF)
    least, first = (np.linalg.norm(force[rows], axis=1) for force in (onward.slack_force, p.pull))
    ends_slack, has_drag = onward.slack_length[rows] == onward.length[rows], p.loads.normal_drag[rows] > 0.0
    told &= (least > LOST * first) | ends_slack | ~has_drag
    faint = np.flatnonzero(told & (least < FAINT * first))
    told[faint] = moved_by_turn(p.pull, ROUNDING, onward, p.loads, rtol, rows[faint]) <= growth * rtol
    return told


def _between_ends(p: Parameters, options: Options) -> Solution:
    status = p.fate_of_ends
    chord, length = p.feasible_ends
    found = force_between_ends(chord, length, p.loads, options.rtol)
    onward = march(found.force, length - found.at, p.loads, found.rtol)
    back = march(found.force, -found.at, p.loads, found.rtol)
    miss = np.linalg.norm(onward.position - back.position - p.position_B, axis=1)
    line = IntegratedLine(
        back.force, length, p.loads, options.nodes, found.rtol, found.force, found.at, onward, back, miss
    )
    solved = found.converged & (onward.end == REACHED) & (back.end == REACHED)
    status = np.where((status == Status.ok) & ~solved, Status.not_converged, status).astype(np.int8)
    return Solution(status, line, found.iterations)
