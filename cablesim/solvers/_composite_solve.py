"""The two equations of a composite line: given the horizontal tension, or the horizontal distance.

With H given, z grows with the vertical tension at any point: one bracketed unknown. With the distance given, log H is
found outside of that, from k = sqrt(L^2 - z^2) / x: for a uniform line, log sinh(lambda) with sinh(lambda) / lambda = k
falls by exactly one where log H grows by one, for others nearly so. The two equations are the gradient of a strictly
convex function, the complementary energy, so there is one solution and no other.

What keeps the digits: the state is the vertical tension at the joint where it is least, and is summed from there
outwards; for taut lines it is measured from the direction of the chord, Y = V - m H with m = rise / distance, and k - 1
comes from what the line is longer than its chord, summed section by section.
"""

from typing import NamedTuple

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.compiled import compiled
from cablesim.numerics.exact import excess_of_squares, two_sum
from cablesim.physics.composite import extent, tension_less, turn_excess

# Lines with k below this are measured from their chord.
TAUT = 1.1
HEIGHT_STEPS = 200
DISTANCE_STEPS = 100
# A Newton step in V this small beside T leaves an error of its square.
HEIGHT_STEP = 1e-8
INSIDE = 1.0 - 1e-6
# In so many steps the bracket or the gap must halve, or the bracket is halved.
PATIENCE = 4
# Rounding of a height, beside the room that the line leaves above or below itself.
ROUNDING = 4e-16
# A step in log H this small is the last: the secant's error is far smaller.
TENSION_STEP = 1e-11
# Slopes that a secant may have. A uniform line has -1; one that hangs as a polygon under a point load hardly any.
STEEPEST, FLATTEST = -20.0, -1e-9
# Until both sides are known, H changes by no more than this factor's logarithm.
LONGEST_STEP = 5.0


def solve_for_tension(
    lengths: Array, weights: Array, sections: np.ndarray, rise: Array, horizontal: Array
) -> tuple[Array, np.ndarray, np.ndarray, np.ndarray]:
    """Vertical tension at the joints, feasible, converged and evaluations, for lines of given horizontal tension."""
    above, below = rooms(*totals(lengths, sections), rise)
    vertical = np.full((lengths.shape[0], lengths.shape[1] + 1), np.nan)
    converged, evaluations = np.zeros(sections.size, dtype=bool), np.zeros(sections.size, dtype=np.int32)
    feasible = (above > 0.0) & (below > 0.0)
    _solve_heights(
        lengths, weights, sections, rise, above, below, horizontal, feasible, vertical, converged, evaluations
    )
    return vertical, feasible, converged, evaluations


def solve_for_distance(
    lengths: Array, weights: Array, sections: np.ndarray, rise: Array, distance: Array
) -> tuple[Array, Array, np.ndarray, np.ndarray, np.ndarray]:
    """Horizontal tension, and what `solve_for_tension` gives, for lines of given horizontal distance."""
    total, tail = totals(lengths, sections)
    above, below = rooms(total, tail, rise)
    excess = excess_of_squares(total, tail, distance, rise)
    vertical = np.full((lengths.shape[0], lengths.shape[1] + 1), np.nan)
    horizontal = np.full(sections.size, np.nan)
    converged, evaluations = np.zeros(sections.size, dtype=bool), np.zeros(sections.size, dtype=np.int32)
    feasible = (excess > 0.0) & (above > 0.0) & (below > 0.0)
    _solve_distances(
        lengths, weights, sections, rise, above, below, distance, excess, total, feasible,
        horizontal, vertical, converged, evaluations,
    )  # fmt: skip
    return horizontal, vertical, feasible, converged, evaluations


def totals(lengths: Array, sections: np.ndarray) -> tuple[Array, Array]:
    """Length of every line as a float, and the part that the float cannot hold."""
    total, tail = np.zeros(sections.size), np.zeros(sections.size)
    for column in lengths.T:
        total, error = two_sum(total, np.where(np.isnan(column), 0.0, column))
        tail = tail + error
    return two_sum(total, tail)


def rooms(total: Array, tail: Array, rise: Array) -> tuple[Array, Array]:
    """Length less rise, and length plus rise."""
    less, less_tail = two_sum(total, -rise)
    more, more_tail = two_sum(total, rise)
    return less + (less_tail + tail), more + (more_tail + tail)


class Place(NamedTuple):
    """The rise of B above A, and the length of the line less and plus it."""

    rise: float
    above: float
    below: float


class Chord(NamedTuple):
    """What a taut line is measured from: its distance, its chord, how much longer it is than that, and its length.

    All zero for a line that is not taut.
    """

    distance: float
    length: float
    slack: float
    total: float


NOT_TAUT = Chord(0.0, 0.0, 0.0, 0.0)


@compiled
def _solve_heights(
    lengths, weights, sections, rise, above, below, horizontal, feasible, vertical, converged, evaluations
):
    for i in range(sections.size):
        if feasible[i]:
            n = sections[i]
            line, heavy, state = lengths[i, :n], weights[i, :n], vertical[i, : n + 1]
            place = Place(rise[i], above[i], below[i])
            _start_height(line, heavy, place, horizontal[i], 0.0, state)
            converged[i], evaluations[i] = _meet_height(line, heavy, place, NOT_TAUT, horizontal[i], state)


@compiled
def _solve_distances(
    lengths, weights, sections, rise, above, below, distance, excess, total, feasible,
    horizontal, vertical, converged, evaluations,
):  # fmt: skip
    for i in range(sections.size):
        if feasible[i]:
            n = sections[i]
            line, heavy, state = lengths[i, :n], weights[i, :n], vertical[i, : n + 1]
            place, chord = Place(rise[i], above[i], below[i]), NOT_TAUT
            log_ratio = 0.5 * np.log1p(excess[i] / (distance[i] * distance[i]))
            if log_ratio < np.log(TAUT):
                across = np.sqrt(distance[i] * distance[i] + rise[i] * rise[i])
                chord = Chord(distance[i], across, excess[i] / (total[i] + across), total[i])
            horizontal[i], converged[i], evaluations[i] = _meet_distance(line, heavy, place, chord, log_ratio, state)
            for j in range(state.size):
                state[j] += _slope(place, chord) * horizontal[i]


@compiled
def _slope(place, chord):
    """The slope of what the state is measured from."""
    return place.rise / chord.distance if chord.distance > 0.0 else 0.0


@compiled
def _meet_distance(line, heavy, place, chord, log_ratio, state):
    """H with the wanted log k. Returns also whether it was found, and evaluations; leaves the state of that H."""
    wanted = _straightness(log_ratio)
    lean = place.rise / np.sqrt(place.above) / np.sqrt(place.below) - _slope(place, chord)
    horizontal = _start_tension(line, heavy, place, wanted)
    _start_height(line, heavy, place, horizontal, _slope(place, chord), state)
    low, high, width, step, before, evaluations = 0.0, np.inf, np.inf, 0.0, 0.0, 0
    for count in range(DISTANCE_STEPS):
        met, used = _meet_height(line, heavy, place, chord, horizontal, state)
        evaluations += used
        if not met:
            break
        off = _straightness(_log_ratio(line, heavy, place, chord, horizontal, state)) - wanted
        if off > 0.0:
            low = horizontal
        else:
            high = horizontal
        step, before = _secant_step(off, before, step), off
        done = abs(step) <= TENSION_STEP
        if low > 0.0 and high < np.inf and not done:
            to_low, to_high = np.log(low / horizontal), np.log(high / horizontal)
            done = to_high - to_low <= TENSION_STEP
            # A secant that leaves the bracket, or hardly narrows it, gives way to the middle.
            if not to_low < step < to_high or (count % 3 == 2 and to_high - to_low > 0.5 * width):
                step = 0.5 * (to_low + to_high)
            if count % 3 == 2:
                width = to_high - to_low
        grown = horizontal * np.exp(step)
        for j in range(state.size):
            state[j] += lean * (grown - horizontal)
        horizontal = grown
        if done:
            met, used = _meet_height(line, heavy, place, chord, horizontal, state)
            return horizontal, met, evaluations + used
    return horizontal, False, evaluations


@compiled
def _secant_step(off, before, step):
    """The step in log H that leads to zero on the line through the last two points; with slope -1 from the first."""
    slope = (off - before) / step if step != 0.0 else -1.0
    if not STEEPEST < slope < FLATTEST:
        slope = -1.0
    return min(max(-off / slope, -LONGEST_STEP), LONGEST_STEP)


@compiled
def _straightness(log_ratio):
    """log sinh(lambda), nearly, of log(sinh(lambda) / lambda)."""
    angle = np.sqrt(log_ratio * (6.0 + 1.2 * log_ratio))
    return angle - np.log(2.0) + np.log(-np.expm1(-2.0 * angle))


@compiled
def _start_tension(line, heavy, place, straightness):
    """H of the uniform line that, pulled taut, would be as long: its weight is sqrt(12) standard deviations of V."""
    total = 0.5 * (place.above + place.below)
    mean, square, hung = 0.0, 0.0, 0.0
    for j in range(line.size):
        weight = heavy[j] * line[j]
        mean += line[j] * (hung + 0.5 * weight)
        hung += weight
    mean /= total
    hung = -mean
    for j in range(line.size):
        weight = heavy[j] * line[j]
        square += line[j] * (hung * hung + hung * weight + weight * weight / 3.0)
        hung += weight
    spread = np.sqrt(12.0 * square / total)
    return spread * np.sqrt(place.above) * np.sqrt(place.below) / (2.0 * total * np.exp(straightness))


@compiled
def _start_height(line, heavy, place, horizontal, slope, state):
    """Vertical tensions as if the line were taut, or, where it is slack, as if it hung straight down to its vertex."""
    hung, moment = 0.0, 0.0
    for j in range(line.size):
        weight = heavy[j] * line[j]
        moment += line[j] * (hung + 0.5 * weight)
        hung += weight
    lean, total = place.rise / np.sqrt(place.above) / np.sqrt(place.below), 0.5 * (place.above + place.below)
    start = horizontal * lean - moment / total
    if horizontal < 0.25 * hung:
        start, left = 0.0, 0.5 * place.above
        for j in range(line.size):
            length = min(left, line[j])
            start -= heavy[j] * length
            left -= length
    state[0] = start - slope * horizontal
    for j in range(line.size):
        state[j + 1] = state[j] + heavy[j] * line[j]


@compiled
def _meet_height(line, heavy, place, chord, horizontal, state):
    """Move the vertical tensions until B is at its height. Returns whether it is, and evaluations."""
    slope, hung = _slope(place, chord), 0.0
    for j in range(line.size):
        hung += heavy[j] * line[j]
    lean, total = place.rise / np.sqrt(place.above) / np.sqrt(place.below), 0.5 * (place.above + place.below)
    room = min(place.above, place.below)
    # Where the bracket ends, from the state: the same for every joint, and as fine as the least of them.
    to_high = horizontal * (lean - slope) - state[0]
    to_low = to_high - hung
    margin = 1e-9 * (hung + abs(to_high) + abs(state[0]))
    to_low, to_high = to_low - margin, to_high + margin
    width, last_gap = np.inf, np.inf
    for count in range(HEIGHT_STEPS):
        if chord.distance > 0.0:
            gap, rate = _taut_gap(line, heavy, place, chord, horizontal, state)
            step = -gap / rate
        else:
            gap, rate, upward, downward = _gap(line, heavy, place, horizontal, state)
            step = -gap / rate
            if horizontal > hung:
                # The slope of the chord is nearly linear in V.
                square = upward * downward
                off = 0.5 * (downward - upward) / np.sqrt(square) - lean
                if abs(off) > 1e-3 * (1.0 + abs(lean)):
                    step = -off * square * np.sqrt(square) / (total * total * rate)
        if gap > 0.0:
            to_high = 0.0
        else:
            to_low = 0.0
        least = _least(state)
        upright = state[least] + slope * horizontal
        enough = HEIGHT_STEP * np.sqrt(horizontal * horizontal + upright * upright)
        done = abs(step) <= enough or (abs(gap) <= ROUNDING * room and chord.distance == 0.0)
        # A step right to the end of the bracket would come back from there: slopes change at once at H = 0.
        inside = INSIDE * to_low < step < INSIDE * to_high
        if count % PATIENCE == PATIENCE - 1:
            inside &= to_high - to_low <= 0.5 * width or abs(gap) <= 0.5 * last_gap
            width, last_gap = to_high - to_low, abs(gap)
        if not inside and not done:
            step = 0.5 * (to_low + to_high)
        to_low, to_high = to_low - step, to_high - step
        _shift(line, heavy, state, least, step)
        if done:
            return True, count + 1
    return False, HEIGHT_STEPS


@compiled
def _least(state):
    """The joint where the state is nearest to zero."""
    least = 0
    for j in range(state.size):
        if abs(state[j]) < abs(state[least]):
            least = j
    return least


@compiled
def _shift(line, heavy, state, joint, step):
    """Change the state at a joint, and sum it anew from there outwards."""
    state[joint] += step
    for j in range(joint, line.size):
        state[j + 1] = state[j] + heavy[j] * line[j]
    for j in range(joint, 0, -1):
        state[j - 1] = state[j] - heavy[j - 1] * line[j - 1]


@compiled
def _gap(line, heavy, place, horizontal, state):
    """z - rise, dz/dV, length less z and length plus z."""
    upward, downward, z, rate = 0.0, 0.0, 0.0, 0.0
    square = horizontal * horizontal
    v_1 = state[0]
    t_1 = np.sqrt(square + v_1 * v_1)
    for j in range(line.size):
        v_2 = state[j + 1]
        t_2 = np.sqrt(square + v_2 * v_2)
        share = line[j] / (t_1 + t_2)
        upward += share * (tension_less(t_1, v_1, horizontal) + tension_less(t_2, v_2, horizontal))
        downward += share * (tension_less(t_1, -v_1, horizontal) + tension_less(t_2, -v_2, horizontal))
        z += share * (v_1 + v_2)
        rate += share * _rate(square, v_1, v_2, t_1, t_2)
        v_1, t_1 = v_2, t_2
    # What is small decides how well the gap is known: the height, or the room that is left above or below.
    if place.above < abs(place.rise):
        return place.above - upward, rate, upward, downward
    if place.below < abs(place.rise):
        return downward - place.below, rate, upward, downward
    return z - place.rise, rate, upward, downward


@compiled
def _rate(square, v_1, v_2, t_1, t_2):
    """(H^2 + T_1 T_2 - V_1 V_2) / (T_1 T_2), free of cancellation."""
    tensions, verticals = t_1 * t_2, v_1 * v_2
    if verticals <= 0.0:
        return (square + tensions - verticals) / tensions
    return square * (1.0 + (square + v_1 * v_1 + v_2 * v_2) / (tensions + verticals)) / tensions


@compiled
def _taut_gap(line, heavy, place, chord, horizontal, state):
    """z - rise and dz/dV of a taut line."""
    offset, deficit, rate = _taut_sums(line, heavy, place, chord, horizontal, state)
    return (chord.distance * offset + place.rise * (chord.slack - deficit)) / chord.length, rate


@compiled
def _taut_sums(line, heavy, place, chord, horizontal, state):
    """How far B is off the chord, across it, how much shorter the line reaches along it than it is long, and dz/dV."""
    along, across = chord.distance / chord.length, place.rise / chord.length
    slope, square = _slope(place, chord), horizontal * horizontal
    offset, deficit, rate = 0.0, 0.0, 0.0
    v_1 = state[0] + slope * horizontal
    t_1 = np.sqrt(square + v_1 * v_1)
    lost_1 = _lost(along * state[0], along * horizontal + across * v_1, t_1)
    for j in range(line.size):
        v_2 = state[j + 1] + slope * horizontal
        t_2 = np.sqrt(square + v_2 * v_2)
        lost_2 = _lost(along * state[j + 1], along * horizontal + across * v_2, t_2)
        share = line[j] / (t_1 + t_2)
        turn = 2.0 * horizontal * turn_excess(horizontal, v_1, v_2, t_1, t_2, heavy[j] * line[j])
        offset += share * (along * (state[j] + state[j + 1]) - across * turn)
        deficit += share * (lost_1 + lost_2 - along * turn)
        rate += share * _rate(square, v_1, v_2, t_1, t_2)
        v_1, t_1, lost_1 = v_2, t_2, lost_2
    return offset, deficit, rate


@compiled
def _lost(across, along, tension):
    """Tension less its part along the chord, from both its parts."""
    return across * across / (tension + along) if along > 0.0 else tension - along


@compiled
def _log_ratio(line, heavy, place, chord, horizontal, state):
    """log k of the line as it hangs, B being at its height."""
    if chord.distance > 0.0:
        offset, deficit, _ = _taut_sums(line, heavy, place, chord, horizontal, state)
        x = (chord.distance * (chord.total - deficit) - place.rise * offset) / chord.length
        return 0.5 * np.log1p((deficit * (2.0 * chord.total - deficit) - offset * offset) / (x * x))
    x = 0.0
    for j in range(line.size):
        x += extent(line[j], heavy[j] * line[j], horizontal, state[j], state[j + 1])[0]
    return 0.5 * (np.log(place.above / x) + np.log(place.below / x))
