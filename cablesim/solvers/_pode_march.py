"""Quadrature of Pode's integrals between two angles, and the search for the angle at which one of them is reached."""

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.compiled import compiled
from cablesim.numerics.quadrature import FEW_POINTS, FEW_WEIGHTS, POINTS, WEIGHTS
from cablesim.physics.pode import (
    CRITICAL,
    U_RIGHT,
    U_STRAIGHT,
    WIDTH,
    angle_of_logit,
    logit_of_angle,
    pack,
    slopes,
    tension_logarithm,
    tension_rate,
)

PANEL = 1.5
# A panel so narrow needs only the rule of fewer points.
NARROW = 0.6
# Over a panel the tension may change by this much of its logarithm; then sixteen points give it to 1e-14.
STEEPEST = 5.0
# Far more than it takes to lead the tension out of the range of floats, unless it is steep and flat in turns.
MOST_PANELS = 20_000
# Beyond this the distance to a singular angle leaves the range of floats.
LARGEST_LOGIT = 600.0
NEWTON_STEPS = 60
LENGTH, HORIZONTAL, VERTICAL, TENSION = range(4)


def packed(critical: Array, friction: Array, laws: np.ndarray, tail: Array | None = None) -> Array:
    """Many lines as `cablesim.physics.pode` reads them; `tail` is what floats leave out of the critical angles."""
    lines = np.empty((critical.size, WIDTH))
    _pack_all(critical, np.zeros_like(critical) if tail is None else tail, friction, laws, lines)
    return lines


def logits(angle: Array, critical: Array, tail: Array | None = None) -> Array:
    """u of many angles; NaN outside the domain."""
    u = np.empty(angle.size)
    _logits(angle, critical, np.zeros_like(critical) if tail is None else tail, u)
    return u


def pode_integrals(start: Array, end: Array, lines: Array) -> Array:
    """From u = `start` to `end`: length, horizontal and vertical distance in T_start / M, log of T_end / T_start.

    Shape (scenario, 4).
    """
    found = np.empty((start.size, 4))
    _integrals(start, end, lines, found)
    return found


def end_slopes(u: Array, start: Array, lines: Array) -> Array:
    """d/du of length, horizontal and vertical distance at u, in units of T_start / M; shape (scenario, 3)."""
    found = np.empty((u.size, 3))
    _end_slopes(u, start, lines, found)
    return found


def tension_logarithms(u: Array, lines: Array) -> Array:
    """log(T) at many u, for each line up to a constant."""
    found = np.empty(u.size)
    _tension_logarithms(u, lines, found)
    return found


def angles(u: Array, lines: Array) -> Array:
    """Angles of many u."""
    found = np.empty(u.size)
    _angles(u, lines, found)
    return found


def walk(start: Array, direction: Array, lines: Array, which: int, sign: Array, target: Array) -> tuple[Array, Array]:
    """u at which `sign` times integral `which`, walked in a direction from `start`, first rises to each target > 0.

    `target` has shape (scenario, stop), rising along the stops.

    Returns u (scenario, stop) and what was walked to there (scenario, stop, 4) as `pode_integrals` has it, along the
    line as it goes in this direction; NaN from the first target on that is not reached.
    """
    u, found = np.empty(target.shape), np.empty((*target.shape, 4))
    _walk_all(start, direction, lines, which, sign, target, u, found)
    return u, found


@compiled
def _pack_all(critical, tail, friction, laws, lines):
    for i in range(critical.size):
        pack(critical[i], tail[i], friction[i], laws[i], lines[i])


@compiled
def _logits(angle, critical, tail, u):
    for i in range(angle.size):
        u[i] = logit_of_angle(angle[i], critical[i], tail[i])


@compiled
def _tension_logarithms(u, lines, found):
    for i in range(u.size):
        found[i] = tension_logarithm(u[i], lines[i])


@compiled
def _angles(u, lines, found):
    for i in range(u.size):
        found[i] = angle_of_logit(u[i], lines[i, CRITICAL])


@compiled
def _end_slopes(u, start, lines, found):
    for i in range(u.size):
        found[i, 0], found[i, 1], found[i, 2] = slopes(u[i], lines[i], tension_logarithm(start[i], lines[i]))


@compiled
def _integrals(start, end, lines, found):
    for i in range(start.size):
        line, sums = lines[i], found[i]
        reference = tension_logarithm(start[i], line)
        if not (abs(start[i]) <= LARGEST_LOGIT and abs(end[i]) <= LARGEST_LOGIT):
            sums[:] = np.nan
            continue
        sums[:3] = 0.0
        direction = 1.0 if end[i] >= start[i] else -1.0
        here = start[i]
        for _ in range(MOST_PANELS):
            there = _panel_end(here, end[i], direction, line)
            _add_panel(here, there, line, reference, sums)
            here = there
            if here == end[i] or not np.isfinite(sums[LENGTH]):
                break
        if here != end[i]:
            sums[:] = np.nan
            continue
        sums[TENSION] = tension_logarithm(end[i], line) - reference


@compiled
def _panel_end(here, end, direction, line):
    """Where a panel that begins at `here` ends: after its length, at a corner or at the end of the integral."""
    there = here + direction * PANEL
    steepness = PANEL * max(tension_rate(here, line), tension_rate(there, line))
    if steepness > STEEPEST:
        there = here + direction * PANEL * STEEPEST / steepness
    for corner in (line[U_RIGHT], line[U_STRAIGHT]):
        if (corner - here) * direction > 0.0 and (there - corner) * direction > 0.0:
            there = corner
    return end if (there - end) * direction >= 0.0 else there


@compiled
def _add_panel(here, there, line, reference, sums):
    width = there - here
    points, weights = (FEW_POINTS, FEW_WEIGHTS) if abs(width) <= NARROW else (POINTS, WEIGHTS)
    for k in range(points.size):
        length, across, up = slopes(here + width * points[k], line, reference)
        weight = width * weights[k]
        sums[LENGTH] += weight * length
        sums[HORIZONTAL] += weight * across
        sums[VERTICAL] += weight * up


@compiled
def _walk_all(start, direction, lines, which, sign, target, u, found):
    sums, before, panel = np.empty(3), np.empty(3), np.empty(3)
    for i in range(start.size):
        line = lines[i]
        reference = tension_logarithm(start[i], line)
        here = start[i]
        sums[:] = 0.0
        for k in range(target.shape[1]):
            here = _reach(here, direction[i], line, reference, which, sign[i], target[i, k], sums, before, panel)
            u[i, k] = here
            found[i, k, :3] = sums
            found[i, k, TENSION] = tension_logarithm(here, line) - reference


@compiled
def _reach(here, direction, line, reference, which, sign, target, sums, before, panel):
    """Walk on from `here`, adding to `sums`, until `sign * sums[which]` rises to the target; NaN if it never does."""
    if target == 0.0:
        return here
    for _ in range(MOST_PANELS):
        if not abs(here) < LARGEST_LOGIT:
            break
        there = _panel_end(here, direction * 2.0 * LARGEST_LOGIT, direction, line)
        before[:] = sums
        _walk(here, there, direction, line, reference, sums, panel)
        if not np.isfinite(sums[LENGTH]):
            break
        if sign * sums[which] >= target:
            return _within(here, there, direction, line, reference, which, sign, target, before, sums, panel)
        here = there
    sums[:] = np.nan
    return np.nan


@compiled
def _walk(here, there, direction, line, reference, sums, panel):
    """Add a panel: length counted along the walk, distances as the line itself goes in this direction.

    Walked towards smaller u the line points along its angle, towards larger u the other way.
    """
    panel[:] = 0.0
    _add_panel(here, there, line, reference, panel)
    sums[LENGTH] += direction * panel[LENGTH]
    sums[HORIZONTAL] -= panel[HORIZONTAL]
    sums[VERTICAL] -= panel[VERTICAL]


@compiled
def _within(here, there, direction, line, reference, which, sign, target, before, sums, panel):
    """Newton's method, kept within a panel over which the integral is monotone."""
    low, high = here, there
    x = here + (there - here) * (sign * target - before[which]) / (sums[which] - before[which])
    for _ in range(NEWTON_STEPS):
        sums[:] = before
        _walk(here, x, direction, line, reference, sums, panel)
        miss = sign * sums[which] - target
        if abs(miss) <= 4e-16 * target:
            return x
        low, high = (low, x) if miss > 0.0 else (x, high)
        length, _, up = slopes(x, line, reference)
        step = x - miss / (direction * length if which == LENGTH else -sign * up)
        if not min(low, high) < step < max(low, high):
            step = 0.5 * (low + high)
        if step == x or abs(high - low) <= 1e-15 * abs(x):
            return x
        x = step
    return x
