"""Steps along one line in a stream: the compiled integration of M12 from a known force, forwards or backwards.

Dormand-Prince steps of order 8 (`cablesim.numerics.dop853`) with their size controlled by the error of force and
position. The loads have a corner where the line stands at a right angle to the stream (the friction law changes its
side) and, in a plane, where it lies along the stream (|sin a|); a step that would cross one is cut to end there, so the
order is kept. The work is bounded.
"""

import numpy as np

from cablesim.numerics.compiled import compiled
from cablesim.numerics.dop853 import E3, E5, EXPONENT, LARGEST_FACTOR, SAFETY, SMALLEST_FACTOR, STAGES, WEIGHTS
from cablesim.physics.stream import EX, EY, FULL, KB, KN, KT, PLAIN, QZ, ZERO, rates

MOST_STEPS = 20_000
# The part of an error of order 5 that is counted at least as the error of order 8. Along a helix the usual mixture of
# the estimates of order 5 and 3 says 1e-4 of it where a tenth of it is left.
LEAST_SHARE = 0.03
SMALLEST_STEP = 1e-15
# Why a march ended.
REACHED, NOT_REACHED, TOO_MANY_STEPS = range(3)
# What a march keeps of its progress: arc length covered, size of the next step, where the tension was least.
COVERED, STEP, SLACKEST = range(3)
# What may happen within a step; each is a function of the state that changes its sign.
RIGHT_ANGLE, LEVEL, DEPTH = range(3)
ROOT_STEPS = 60
# Two heights nearer than this are the same but for rounding.
FLAT = 1e-13
# What a march keeps the greatest of.
TENSION_PEAK, LOWEST, FARTHEST, PEAKS = 0, 1, 2, 3


@compiled
def start(y, force, size):
    y[:] = 0.0
    for k in range(3):
        y[k] = force[k]
        if size == FULL:
            y[6 + 4 * k] = 1.0


@compiled
def sides_at(y, line, direction, depth):
    """On which side of a right angle to the stream, and of the level, the line starts; 0 where the latter is no corner.

    F.e falls all along a line in a stream, F.z rises by its weight: that decides for a line that starts in a corner.
    Where a depth is looked for, steps end at the level in space, too: so the height is monotone within each. A plumb
    line in still water is never level: it folds where it has no tension, and no step may end there.
    """
    along = y[0] * line[EX] + y[1] * line[EY]
    across = y[1] * line[EX] - y[0] * line[EY]
    downstream = along > 0.0 or (along == 0.0 and direction < 0.0)
    upward = y[2] > 0.0 or (y[2] == 0.0 and line[QZ] * direction < 0.0)
    plumb = y[0] == 0.0 and y[1] == 0.0 and line[KN] == 0.0
    corner = (across == 0.0 and line[KB] == 0.0) or np.isfinite(depth)
    level = (1.0 if upward else -1.0) if corner and not plumb else 0.0
    return np.array([1.0 if downstream else -1.0, level])


@compiled
def _event(kind, y, line, depth):
    if kind == RIGHT_ANGLE:
        return y[0] * line[EX] + y[1] * line[EY]
    if kind == LEVEL:
        return y[2]
    return y[5] - depth


@compiled
def tension(y):
    return np.sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2])


@compiled
def _step(y, h, line, law, side, size, stages, trial):
    """One step of size h from `y` into `trial`; `stages[0]` holds the slope at the start, the last that at the end."""
    for stage in range(1, STAGES + 1):
        for k in range(size):
            trial[k] = 0.0
        for j in range(stage):
            weight = WEIGHTS[stage, j]
            if weight != 0.0:
                for k in range(size):
                    trial[k] += weight * stages[j, k]
        for k in range(size):
            trial[k] = y[k] + h * trial[k]
        rates(trial, stages[stage], line, law, side, size)


@compiled
def _error(y, h, stages, trial, rtol, length):
    """Estimated error of a step over what is allowed: of force relative to the least tension, of position to length."""
    allowed_force = rtol * min(tension(y), tension(trial))
    fifth, third = 0.0, 0.0
    for k in range(PLAIN):
        five, three = 0.0, 0.0
        for j in range(STAGES + 1):
            five += E5[j] * stages[j, k]
            three += E3[j] * stages[j, k]
        allowed = allowed_force if k < 3 else rtol * length
        fifth += (five / allowed) ** 2
        third += (three / allowed) ** 2
    if fifth == 0.0 and third == 0.0:
        return 0.0
    return abs(h) * np.sqrt(fifth / PLAIN) * max(np.sqrt(fifth / (fifth + 0.01 * third)), LEAST_SHARE)


@compiled
def advance(y, progress, target, length, depth, line, law, sides, rtol, size, stages, trial, slackest, peaks):
    """March `y` on to the arc length `target`; `progress` holds what is covered, the step, and where it was slackest.

    Returns why it ended and the steps taken. `slackest` keeps the least tension and its force, `peaks` what March says.
    """
    direction = 1.0 if target >= progress[COVERED] else -1.0
    rates(y, stages[0], line, law, sides[0], size)
    if progress[STEP] == 0.0:
        progress[STEP] = 0.05 * min(length, tension(y) / (_slope(stages) + 1e-300))
    unit = length
    for steps in range(MOST_STEPS):
        left = target - progress[COVERED]
        if left * direction <= 0.0:
            return (REACHED if np.isnan(depth) else NOT_REACHED), steps
        h = direction * min(progress[STEP], abs(left))
        last = abs(left) <= progress[STEP]
        _step(y, h, line, law, sides[0], size, stages, trial)
        if np.isfinite(depth):
            unit = max(depth, progress[COVERED])
        error = _error(y, h, stages, trial, rtol, unit)
        smallest = abs(h) <= SMALLEST_STEP * unit
        if not error <= 1.0 and not smallest:
            progress[STEP] = abs(h) * (max(SMALLEST_FACTOR, SAFETY * error**EXPONENT) if error < np.inf else 0.1)
            continue
        if not error < np.inf and smallest:
            return TOO_MANY_STEPS, steps
        factor = LARGEST_FACTOR if error == 0.0 else min(LARGEST_FACTOR, SAFETY * error**EXPONENT)
        happened = -1
        for kind in range(3):
            if _happens(kind, y, trial, line, depth, law, sides):
                h, happened, last = _cut(kind, y, h, line, law, depth, sides, size, stages, trial), kind, False
        progress[STEP] = max(abs(h) * factor, progress[STEP] if happened >= 0 or last else 0.0)
        if size == PLAIN:
            _note_peaks(y, h, line, law, sides[0], stages, trial, peaks)
        for k in range(size):
            y[k], stages[0, k] = trial[k], stages[STAGES, k]
        progress[COVERED] = target if last else progress[COVERED] + h
        if tension(y) < slackest[0]:
            slackest[:] = tension(y), y[0], y[1], y[2]
            progress[SLACKEST] = progress[COVERED]
        if happened == DEPTH:
            return REACHED, steps + 1
        if happened == RIGHT_ANGLE:
            _turn_side(y, line, law, sides, size, stages)
        elif happened == LEVEL:
            sides[1] = -sides[1]
            y[2] = 0.0
            rates(y, stages[0], line, law, sides[0], size)
    return TOO_MANY_STEPS, MOST_STEPS


@compiled
def _slope(stages):
    return np.sqrt(stages[0, 0] ** 2 + stages[0, 1] ** 2 + stages[0, 2] ** 2)


@compiled
def _happens(kind, y, trial, line, depth, law, sides):
    if kind == DEPTH:
        return y[5] < depth <= trial[5]
    if kind == RIGHT_ANGLE:
        return law != ZERO and line[KT] > 0.0 and _event(kind, trial, line, depth) * sides[0] < 0.0
    return sides[1] != 0.0 and trial[2] * sides[1] < 0.0


@compiled
def _cut(kind, y, h, line, law, depth, sides, size, stages, trial):
    """The part of a step that ends where an event happens (Illinois' false position); `trial` is left there."""
    low, high = 0.0, h
    at_low, at_high = _event(kind, y, line, depth), _event(kind, trial, line, depth)
    scale = 1e-15 * (depth if kind == DEPTH else tension(y))
    for _ in range(ROOT_STEPS):
        apart = at_low * at_high < 0.0
        middle = high - at_high * (high - low) / (at_high - at_low) if apart else 0.5 * (low + high)
        _step(y, middle, line, law, sides[0], size, stages, trial)
        value = _event(kind, trial, line, depth)
        if abs(value) <= scale or abs(high - low) <= 1e-15 * abs(h):
            return middle
        if value * at_high < 0.0:
            low, at_low = high, at_high
        else:
            at_low *= 0.5
        high, at_high = middle, value
    return middle


@compiled
def _turn_side(y, line, law, sides, size, stages):
    """Beyond a right angle friction points the other way; derivatives by the first force jump with it (saltation)."""
    before = np.empty(3)
    for k in range(3):
        before[k] = stages[STAGES, k]
    sides[0] = -sides[0]
    rates(y, stages[0], line, law, sides[0], PLAIN)
    if size != FULL:
        return
    fall = before[0] * line[EX] + before[1] * line[EY]
    for j in range(3):
        turn = (y[6 + j] * line[EX] + y[9 + j] * line[EY]) / fall
        for k in range(3):
            y[6 + 3 * k + j] += (stages[0, k] - before[k]) * turn
    rates(y, stages[0], line, law, sides[0], FULL)


@compiled
def _note_peaks(y, h, line, law, side, stages, trial, peaks):
    """The peaks of a step: at its end, or inside where what is to be greatest rises at first and falls at the end."""
    keep_peaks(trial, line, peaks)
    for kind in range(PEAKS):
        rise = _rise(kind, y, stages[0], line) * h
        fall = _rise(kind, trial, stages[STAGES], line) * h
        if rise > 0.0 > fall:
            _climb(kind, y, h, line, law, side, stages, rise, fall, peaks)


@compiled
def _climb(kind, y, h, line, law, side, stages, rise, fall, peaks):
    """Find a peak inside a step by Illinois' false position.

    A peak is flat: its height says little of its place, so the place where the rise ends is taken unless it is lower.
    """
    inner, slopes = np.empty(PLAIN), np.empty((STAGES + 1, PLAIN))
    slopes[0] = stages[0, :PLAIN]
    low, high = 0.0, h
    for _ in range(ROOT_STEPS):
        middle = low + (high - low) * rise / (rise - fall)
        _step(y, middle, line, law, side, PLAIN, slopes, inner)
        rate = _rise(kind, inner, slopes[STAGES], line) * h
        if rate > 0.0:
            low, rise, fall = middle, rate, 0.5 * fall
        elif rate < 0.0:
            high, fall, rise = middle, rate, 0.5 * rise
        if abs(high - low) <= 1e-14 * abs(h) or rate == 0.0:
            break
    height = _height(kind, inner, line)
    if height >= peaks[kind, 0] - FLAT * abs(height):
        peaks[kind] = height, inner[3], inner[4], inner[5]


@compiled
def _rise(kind, y, dy, line):
    """d/ds, up to a positive factor, of what is to be greatest: tension, depth below the start, distance downstream."""
    if kind == TENSION_PEAK:
        return y[0] * dy[0] + y[1] * dy[1] + y[2] * dy[2]
    if kind == LOWEST:
        return -y[2]
    return y[0] * line[EX] + y[1] * line[EY]


@compiled
def _height(kind, y, line):
    if kind == TENSION_PEAK:
        return tension(y)
    return -y[5] if kind == LOWEST else y[3] * line[EX] + y[4] * line[EY]


@compiled
def keep_peaks(y, line, peaks):
    for kind in range(PEAKS):
        height = _height(kind, y, line)
        if height > peaks[kind, 0]:
            peaks[kind] = height, y[3], y[4], y[5]
