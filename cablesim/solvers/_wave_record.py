"""What is kept of a line while it moves: extremes and means over the window, energy, and histories if they are asked.

The window are the last whole periods, which every quantity but the largest strain and the balance of energy is for.
Between steps the square of a tension at an end or in the middle is a parabola through the ends of this step and of the
last: where the force of an end turns about and nearly vanishes, its square is smooth, the tension itself is not.
"""

import numpy as np

from cablesim.numerics.compiled import compiled
from cablesim.numerics.lanes import LANES
from cablesim.physics.nodal_line import (
    ADDED,
    DAMPING,
    ELEMENT_ROWS,
    LINEAR,
    MASS,
    NODE_ROWS,
    OTHER_SHARE,
    OWN_SHARE,
    PIECE,
    PLACE,
    QUADRATIC,
    VELOCITY,
    WEIGHT,
    tension,
)
from cablesim.solvers._wave_pack import (
    ACCEPTED,
    ANCHOR_NOW,
    BEYOND,
    END,
    LARGEST,
    LARGEST_STRAIN,
    LEAST,
    NEW,
    NEW_STRAIN,
    OLD_PLACE,
    OLD_VELOCITY,
    PAST1,
    PERIOD,
    PLACE_SCALE,
    POWER_NOW,
    POWER_TURNED,
    SCENARIO,
    SLACK_TIME,
    SNAPS,
    STEP,
    TENSION_SCALE,
    TIME,
    WAS_SLACK,
    WINDOW,
)

# Tallies of a lane: three numbers each for anchor, middle and top, then the rest.
BEFORE, EARLIER, MOST, LOWEST, SUM = 0, 3, 6, 9, 12
PEAK, LEAST_PEAK = 15, 18  # largest of the running period, and the least of those of the periods before
(
    PERIOD_END,
    POWER_BEFORE,
    WORK,
    TURNED_BEFORE,
    TURNOVER,  # integral of that
    ENERGY,
    NEXT_SAMPLE,
    NEXT_PHASE,
    EARLIER_STEP,
    SNAP_TENSION,
    GREATEST_STRAIN,  # at which a softening law has its greatest tension
    TALLY_ROWS,
) = range(21, 33)

# A parabola through three values turns at most so many times their larger difference beyond the middle one, if one step
# is at most twice the other; where they differ by more, after a jerk, it would turn anywhere.
MOST_REACH = 1.0 / 3.0
# An element snaps where it is pulled from nothing to this part of the static tension at the top.
SNAP_SHARE = 0.05


@compiled
def begin_tally(pack, tally, w, supports):
    """A lane begins a scenario, at rest; `supports` are the tensions at anchor, middle and top then."""
    for row in range(TALLY_ROWS):
        tally[row * LANES + w] = 0.0
    for c in range(3):
        tally[(LOWEST + c) * LANES + w] = np.inf
        tally[(LEAST_PEAK + c) * LANES + w] = np.inf
        tally[(BEFORE + c) * LANES + w] = supports[c]
    tally[PERIOD_END * LANES + w] = pack.lane[WINDOW * LANES + w] + pack.lane[PERIOD * LANES + w]
    tally[SNAP_TENSION * LANES + w] = SNAP_SHARE * supports[2]
    quadratic = pack.line[QUADRATIC * LANES + w]
    greatest = -0.5 * pack.line[LINEAR * LANES + w] / quadratic if quadratic < 0.0 else np.inf
    tally[GREATEST_STRAIN * LANES + w] = greatest
    elements = pack.elements.size // (ELEMENT_ROWS * LANES)
    for e in range(elements):
        pack.elements[(ELEMENT_ROWS * e + LEAST) * LANES + w] = np.inf
    tally[ENERGY * LANES + w] = energy(pack, w, elements)


@compiled
def energy(pack, w, count):
    """Kinetic energy of the line without the fluid, elastic energy, and weight times height, of one lane."""
    line, total = pack.line, 0.0
    piece, mass = line[PIECE * LANES + w], line[MASS * LANES + w] - line[ADDED * LANES + w]
    own, other = line[OWN_SHARE * LANES + w], line[OTHER_SHARE * LANES + w]
    linear, quadratic = line[LINEAR * LANES + w], line[QUADRATIC * LANES + w]
    for e in range(count):
        ends = pack.nodes[NODE_ROWS * LANES * e : NODE_ROWS * LANES * (e + 2)]
        squares = 0.0
        for k in range(3):
            left, right = ends[(VELOCITY + k) * LANES + w], ends[(NODE_ROWS + VELOCITY + k) * LANES + w]
            squares += own * (left * left + right * right) + 2.0 * other * left * right
        strain = strain_at(ends, PLACE, piece, w)
        height = 0.5 * (ends[(PLACE + 2) * LANES + w] + ends[(NODE_ROWS + PLACE + 2) * LANES + w])
        elastic = (0.5 * linear + quadratic * strain / 3.0) * strain * strain if strain > 0.0 else 0.0
        total += piece * (0.5 * mass * squares + elastic + line[WEIGHT * LANES + w] * height)
    return total


@compiled
def note_elements(elements, method, lane, tally, count, width):
    """Extremes, slack time and snaps of every element after a step that a lane accepted.

    `lane` has the time before the step, which lies within the window or before it.
    """
    L = LANES
    for e in range(count):
        own = elements[ELEMENT_ROWS * L * e : ELEMENT_ROWS * L * (e + 1)]
        for w in range(width):
            is_accepted = lane[ACCEPTED * L + w] > 0.0
            is_noted = is_accepted & (lane[TIME * L + w] >= lane[WINDOW * L + w])
            pull, strain, slack = own[NEW * L + w], own[NEW_STRAIN * L + w], own[WAS_SLACK * L + w]
            is_more = is_noted & (pull > own[LARGEST * L + w])
            is_less = is_noted & (pull < own[LEAST * L + w])
            own[LARGEST * L + w] = pull if is_more else own[LARGEST * L + w]
            own[LEAST * L + w] = pull if is_less else own[LEAST * L + w]
            is_longer = is_accepted & (strain > own[LARGEST_STRAIN * L + w])
            own[LARGEST_STRAIN * L + w] = strain if is_longer else own[LARGEST_STRAIN * L + w]
            is_beyond = is_accepted & (strain > tally[GREATEST_STRAIN * L + w])
            lane[BEYOND * L + w] = 1.0 if is_beyond else lane[BEYOND * L + w]
            share = (0.5 if pull <= 0.0 else 0.0) + (0.5 if own[PAST1 * L + w] <= 0.0 else 0.0)
            own[SLACK_TIME * L + w] += share * method[STEP * L + w] if is_noted else 0.0
            is_snap = is_noted & (slack > 0.0) & (pull > tally[SNAP_TENSION * L + w])
            own[SNAPS * L + w] += 1.0 if is_snap else 0.0
            slack = 1.0 if pull <= 0.0 else (0.0 if pull > tally[SNAP_TENSION * L + w] else slack)
            own[WAS_SLACK * L + w] = slack if is_accepted else own[WAS_SLACK * L + w]


@compiled
def note_ends(pack, tally, w):
    """Tensions of anchor, middle and top, and the work done, after an accepted step of one lane."""
    lane, h = pack.lane, pack.method[STEP * LANES + w]
    time, window = lane[TIME * LANES + w], lane[WINDOW * LANES + w]
    before = tally[EARLIER_STEP * LANES + w]
    if time >= tally[PERIOD_END * LANES + w]:
        end_period(tally, w)
        tally[PERIOD_END * LANES + w] += lane[PERIOD * LANES + w]
    for c in range(3):
        now = lane[(ANCHOR_NOW + c) * LANES + w]
        last, earlier = tally[(BEFORE + c) * LANES + w], tally[(EARLIER + c) * LANES + w]
        if time >= window:
            most, least = max(now, tally[(PEAK + c) * LANES + w]), min(now, tally[(LOWEST + c) * LANES + w])
            if before > 0.0 and time - before >= window and (last - earlier) * (now - last) < 0.0:
                bend, rise = curvature(tally, w, c, now, h), now * now - last * last
                turn = last * last - (rise / h - bend * h) ** 2 / (4.0 * bend)
                reach = MOST_REACH * max(abs(rise), abs(last * last - earlier * earlier))
                turn = np.sqrt(max(min(max(turn, last * last - reach), last * last + reach), 0.0))
                most, least = max(most, turn), min(least, turn)
            tally[(PEAK + c) * LANES + w], tally[(LOWEST + c) * LANES + w] = most, least
            tally[(SUM + c) * LANES + w] += 0.5 * h * (now + last)
        tally[(EARLIER + c) * LANES + w], tally[(BEFORE + c) * LANES + w] = last, now
    tally[EARLIER_STEP * LANES + w] = h
    power, last = lane[POWER_NOW * LANES + w], tally[POWER_BEFORE * LANES + w]
    tally[WORK * LANES + w] += 0.5 * h * (power + last)
    turned = lane[POWER_TURNED * LANES + w]
    tally[TURNOVER * LANES + w] += 0.5 * h * (turned + tally[TURNED_BEFORE * LANES + w])
    tally[POWER_BEFORE * LANES + w], tally[TURNED_BEFORE * LANES + w] = power, turned


@compiled
def end_period(tally, w):
    """The largest tensions of a period of the window are known."""
    for c in range(3):
        peak = tally[(PEAK + c) * LANES + w]
        tally[(MOST + c) * LANES + w] = max(peak, tally[(MOST + c) * LANES + w])
        tally[(LEAST_PEAK + c) * LANES + w] = min(peak, tally[(LEAST_PEAK + c) * LANES + w])
        tally[(PEAK + c) * LANES + w] = 0.0


@compiled
def spread_of_periods(tally, w):
    """Largest difference of the largest tensions of periods, at one place, over the largest of all."""
    most, spread = 0.0, 0.0
    for c in range(3):
        peak = tally[(MOST + c) * LANES + w]
        most, spread = max(most, peak), max(spread, peak - tally[(LEAST_PEAK + c) * LANES + w])
    return spread / most if spread > 0.0 else 0.0


@compiled
def note_damping(pack, tally, w, count):
    """Work of internal damping over an accepted step of one lane, whose nodes are still where they were before, too.

    It is taken over the change of length: velocities of a line too stiff to stretch do not belong to its places.
    """
    line = pack.line
    if line[DAMPING * LANES + w] == 0.0:
        return
    piece, work = line[PIECE * LANES + w], 0.0
    for e in range(count):
        ends = pack.nodes[NODE_ROWS * LANES * e : NODE_ROWS * LANES * (e + 2)]
        own = pack.elements[ELEMENT_ROWS * LANES * e : ELEMENT_ROWS * LANES * (e + 1)]
        now, last = strain_at(ends, PLACE, piece, w), strain_at(ends, OLD_PLACE, piece, w)
        viscous = own[NEW * LANES + w] - elastic_pull(line, now, w)
        viscous += own[PAST1 * LANES + w] - elastic_pull(line, last, w)
        work -= 0.5 * viscous * piece * (now - last)
    tally[WORK * LANES + w] += work
    tally[TURNOVER * LANES + w] += abs(work)


@compiled
def strain_at(ends, row, piece, w):
    """Strain of an element whose nodes are where their rows from `row` on say."""
    square = 0.0
    for k in range(3):
        square += (ends[(NODE_ROWS + row + k) * LANES + w] - ends[(row + k) * LANES + w]) ** 2
    return np.sqrt(square) / piece - 1.0


@compiled
def elastic_pull(line, strain, w):
    law = tension(strain, 0.0, line[LINEAR * LANES + w], line[QUADRATIC * LANES + w], 0.0, line[PIECE * LANES + w], 0.0)
    return law[0]


@compiled
def curvature(tally, w, c, now, h):
    """Half the second derivative of the parabola through three squares of a tension; 0 in the first step."""
    before = tally[EARLIER_STEP * LANES + w]
    if before == 0.0:
        return 0.0
    last, earlier = tally[(BEFORE + c) * LANES + w], tally[(EARLIER + c) * LANES + w]
    return ((now * now - last * last) / h - (last * last - earlier * earlier) / before) / (before + h)


@compiled
def note_history(pack, tally, w, records, count):
    """Samples and shapes whose times lie within an accepted step of one lane; its state of before is still there."""
    L, lane = LANES, pack.lane
    scenario, time, h = int(lane[SCENARIO * L + w]), lane[TIME * L + w], pack.method[STEP * L + w]
    end, period = lane[END * L + w], lane[PERIOD * L + w]
    samples, phases = records.history.shape[1], records.orbit.shape[1]
    sample = int(tally[NEXT_SAMPLE * L + w])
    while sample < samples and sample * end / (samples - 1) <= time + h * (1.0 + 1e-9):
        share = min((sample * end / (samples - 1) - time) / h, 1.0)
        for c in range(3):
            bend = share * (share - 1.0) * h * h * curvature(tally, w, c, lane[(ANCHOR_NOW + c) * L + w], h)
            last, now = tally[(BEFORE + c) * L + w], lane[(ANCHOR_NOW + c) * L + w]
            square = last * last + share * (now * now - last * last) + bend
            records.history[scenario, sample, c] = np.sqrt(max(square, 0.0))
        sample += 1
    tally[NEXT_SAMPLE * L + w] = sample
    phase = int(tally[NEXT_PHASE * L + w])
    while phase < phases and end - period * (1.0 - phase / phases) <= time + h * (1.0 + 1e-9):
        share = min(max((end - period * (1.0 - phase / phases) - time) / h, 0.0), 1.0)
        note_shape(pack, w, records, scenario, phase, share, count)
        phase += 1
    tally[NEXT_PHASE * L + w] = phase


@compiled
def note_shape(pack, w, records, scenario, phase, share, count):
    """Places, by their velocities too, and tensions at a part of the step."""
    h = pack.method[STEP * LANES + w]
    for j in range(count + 1):
        node = pack.nodes[NODE_ROWS * LANES * j : NODE_ROWS * LANES * (j + 1)]
        for k in range(3):
            last, now = node[(OLD_PLACE + k) * LANES + w], node[(PLACE + k) * LANES + w]
            leaving = h * node[(OLD_VELOCITY + k) * LANES + w] - (now - last)
            arriving = h * node[(VELOCITY + k) * LANES + w] - (now - last)
            bend = share * (1.0 - share) * ((1.0 - share) * leaving - share * arriving)
            records.shapes[scenario, phase, j, k] = last + share * (now - last) + bend
    for e in range(count):
        element = pack.elements[ELEMENT_ROWS * LANES * e : ELEMENT_ROWS * LANES * (e + 1)]
        last, now = element[PAST1 * LANES + w], element[NEW * LANES + w]
        records.pulls[scenario, phase, e] = last + share * (now - last)
    for k in range(3):
        middle = records.shapes[scenario, phase, count // 2, k] + records.shapes[scenario, phase, (count + 1) // 2, k]
        records.orbit[scenario, phase, k] = 0.5 * middle


@compiled
def finish_tally(pack, tally, w, records, count):
    """A lane's scenario is over: its row of the records."""
    L, scenario = LANES, int(pack.lane[SCENARIO * LANES + w])
    span = pack.lane[END * L + w] - pack.lane[WINDOW * L + w]
    end_period(tally, w)
    for c in range(3):
        records.ends[scenario, c, 0] = tally[(MOST + c) * L + w]
        records.ends[scenario, c, 1] = tally[(LOWEST + c) * L + w]
        records.ends[scenario, c, 2] = tally[(SUM + c) * L + w] / span
    slack, snaps, strain = 0.0, 0.0, 0.0
    for e in range(count):
        element = pack.elements[ELEMENT_ROWS * L * e : ELEMENT_ROWS * L * (e + 1)]
        slack += element[SLACK_TIME * L + w] / (count * span)
        snaps = max(snaps, element[SNAPS * L + w])
        strain = max(strain, element[LARGEST_STRAIN * L + w])
        records.extremes[scenario, e, 0] = element[LARGEST * L + w]
        records.extremes[scenario, e, 1] = element[LEAST * L + w]
    gain = energy(pack, w, count) - tally[ENERGY * L + w]
    # A line that hardly moves turns over nothing but errors that are within the tolerances.
    size = max(tally[TURNOVER * L + w], abs(gain))
    size = max(size, pack.lane[TENSION_SCALE * L + w] * pack.lane[PLACE_SCALE * L + w])
    records.line[scenario, 0], records.line[scenario, 1], records.line[scenario, 2] = slack, snaps, strain
    records.line[scenario, 3] = abs(gain - tally[WORK * L + w]) / size
    records.line[scenario, 4] = spread_of_periods(tally, w)
