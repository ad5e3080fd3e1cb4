"""Marching many lines through time side by side with explicit steps: leapfrog and the Runge-Kutta method.

A step is a part of the longest stable one, or shorter where the error wants it; it is never taken back. Every step is
recorded. A fixed step longer than the longest stable one gives up, and so does a line whose motion is not finite.
"""

import math
from typing import Any

import numpy as np

from cablesim.numerics.compiled import compiled
from cablesim.numerics.elementary import sine_cosine
from cablesim.numerics.lanes import LANES
from cablesim.physics.nodal_line import (
    ACCELERATION,
    ELEMENT_ROWS,
    LEFT,
    NODE_ROWS,
    OTHER,
    OTHER_SHARE,
    PLACE,
    RIGHT,
    VELOCITY,
)
from cablesim.physics.waves import FLUID_SIZE, OMEGA, RATE, START, STREAM_X, STREAM_Y, C, S, ramp_at
from cablesim.solvers._wave_explicit_judge import (
    JUDGED_AT,
    LIMIT,
    LONGEST,
    OWN_ROWS,
    REST,
    SINCE,
    WANTED,
    judge_lanes,
)
from cablesim.solvers._wave_explicit_step import (
    begin_stages,
    correct_velocities,
    end_stages,
    find_limits,
    leap,
    next_stage,
)
from cablesim.solvers._wave_forces import FOUND_ROWS, LOOSEST, POWER, accelerate
from cablesim.solvers._wave_lanes import march_all
from cablesim.solvers._wave_pack import (
    ACCEPTED,
    ANCHOR_NOW,
    BEGUN,
    BEYOND,
    BEYOND_LAW,
    END,
    EVALUATIONS,
    GAVE_UP,
    LAST_STEP,
    MIDDLE_NOW,
    NEW,
    NEXT_STEP,
    OLD_PLACE,
    OLD_VELOCITY,
    OUT_OF_STEPS,
    OUT_OF_TIME,
    PAST1,
    PERIOD,
    POWER_NOW,
    POWER_TURNED,
    SCENARIO,
    SLACK_UNTIL,
    SOLVED,
    STEP,
    STEPS,
    TENSION_SCALE,
    TIME,
    TOP_NOW,
    WINDOW,
    Marched,
    Problem,
    Records,
    load_state,
    make_pack,
)
from cablesim.solvers._wave_record import (
    TALLY_ROWS,
    begin_tally,
    finish_tally,
    note_elements,
    note_ends,
    note_history,
)
from cablesim.solvers._wave_step import find_fluid, step_to_meet

# Part of the longest stable step that is taken.
SAFETY = 0.9
# Part of it that leapfrog takes while a line has been slack lately: where elements slacken and snap, its energy grows
# with steps well below the limit for vibrations (peaks 3 times too large at 0.7 of it, 3 % at 0.35).
SLACK_SHARE, SLACK_FOR = 0.4, 0.5
# A part of a period that is as good as none.
SAME_TIME = 1e-9


def leapfrog(problem: Problem, has_waves: bool, options: Any, records: Records) -> Marched:
    return march_all(march, problem, has_waves, options, records, True)


def rk4(problem: Problem, has_waves: bool, options: Any, records: Records) -> Marched:
    return march_all(march, problem, has_waves, options, records, False)


@compiled
def march(problem, has_waves, limits, clock, records, fates, first, stride, width, is_leapfrog):
    """March every `stride`th scenario from `first` on, `width` at a time: see `march_all`."""
    rtol, fixed, part, most_steps, most_seconds = limits
    count = problem.tensions.shape[1]
    pack, tally = make_pack(count), np.zeros(TALLY_ROWS * LANES)
    found, own = np.zeros(FOUND_ROWS * LANES), np.ones(OWN_ROWS * LANES)
    is_lumped = problem.lines[0, OTHER_SHARE] == 0.0
    queue, busy = first, 0
    for w in range(width):
        busy += load(pack, tally, own, w, queue, problem, count, clock[0])
        queue += stride
    while busy:
        for w in range(width):
            set_step(pack, w)
        keep_old(pack.nodes, pack.elements, count, width)
        if is_leapfrog:
            leap(pack.nodes, pack.method, pack.lane[LAST_STEP * LANES : (LAST_STEP + 1) * LANES], count, width)
        else:
            take_stages(pack, own, found, has_waves, is_lumped, count, width)
        evaluate(pack, own, found, 1.0, has_waves, is_lumped, count, width)
        find_supports(pack.nodes, pack.elements, pack.lane, found, count, width)
        note_elements(pack.elements, pack.method, pack.lane, tally, count, width)
        find_limits(pack.line, found, own[LIMIT * LANES : (LIMIT + 1) * LANES], is_leapfrog, width)
        judge_lanes(pack, own, is_leapfrog, rtol, count, width)
        for w in range(width):
            if pack.lane[ACCEPTED * LANES + w] > 0.0:
                if records.history.shape[1] + records.orbit.shape[1] > 0:
                    note_history(pack, tally, w, records, count)
                note_ends(pack, tally, w)
            if pack.lane[SCENARIO * LANES + w] >= 0.0:
                advance(pack, found, w)
                longest = longest_step(pack.lane, own, w, is_leapfrog)
                most = part * min(SAFETY * longest, LONGEST * pack.lane[PERIOD * LANES + w])
                wanted = min(most, own[WANTED * LANES + w])
                pack.lane[NEXT_STEP * LANES + w] = fixed if fixed > 0.0 else wanted
                fate = fate_of(pack, found, w, fixed, longest, most_steps, most_seconds, clock[0])
                if fate >= 0.0:
                    unload(pack, tally, w, is_leapfrog, records, fates, fate, count)
                    busy += load(pack, tally, own, w, queue, problem, count, clock[0]) - 1
                    queue += stride


@compiled
def load(pack, tally, own, w, scenario, problem, count, now):
    """Give a lane a scenario; 0 where there is none left. Its first step has no length: that finds accelerations."""
    pack.lane[ACCEPTED * LANES + w] = 0.0
    pack.lane[LAST_STEP * LANES + w] = pack.method[STEP * LANES + w] = 0.0
    if scenario >= len(problem.lines):
        pack.lane[SCENARIO * LANES + w] = -1.0
        pack.lane[NEXT_STEP * LANES + w] = 0.0
        return 0
    load_state(pack, w, scenario, problem)
    pack.lane[BEGUN * LANES + w] = now
    begin_tally(pack, tally, w, problem.supports[scenario])
    for e in range(count):
        for k in range(FLUID_SIZE):
            pack.fluid[(FLUID_SIZE * e + k) * LANES + w] = 0.0
        pack.fluid[FLUID_SIZE * e * LANES + w] = pack.wave[STREAM_X * LANES + w]
        pack.fluid[(FLUID_SIZE * e + 1) * LANES + w] = pack.wave[STREAM_Y * LANES + w]
    pack.lane[SLACK_UNTIL * LANES + w] = -1.0
    own[WANTED * LANES + w] = LONGEST * pack.lane[PERIOD * LANES + w]
    for k in range(3):
        own[(REST + k) * LANES + w] = problem.starts[scenario, count, k]
    own[SINCE * LANES + w] = own[JUDGED_AT * LANES + w] = 0.0
    return 1


@compiled
def set_step(pack, w):
    """The length of the next step of a lane: none where it has just begun, or has no scenario."""
    lane = pack.lane
    step, time = lane[NEXT_STEP * LANES + w], lane[TIME * LANES + w]
    if step > 0.0:
        step = step_to_meet(time, step, lane[WINDOW * LANES + w], lane[END * LANES + w])
    pack.method[STEP * LANES + w] = step
    lane[ACCEPTED * LANES + w] = 1.0 if step > 0.0 else 0.0


@compiled
def keep_old(nodes, elements, count, width):
    """What the integrator does not keep itself: tensions, and where the top end is."""
    L, E = LANES, ELEMENT_ROWS * LANES
    top = nodes[NODE_ROWS * L * count :]
    for k in range(3):
        for w in range(width):
            top[(OLD_PLACE + k) * L + w] = top[(PLACE + k) * L + w]
            top[(OLD_VELOCITY + k) * L + w] = top[(VELOCITY + k) * L + w]
    for e in range(count):
        own = elements[E * e : E * (e + 1)]
        for w in range(width):
            own[PAST1 * L + w] = own[NEW * L + w]


@compiled
def take_stages(pack, own, found, has_waves, is_lumped, count, width):
    """All of a Runge-Kutta step but the evaluation at its end."""
    begin_stages(pack.nodes, pack.method, count, width)
    evaluate(pack, own, found, 0.5, has_waves, is_lumped, count, width)
    next_stage(pack.nodes, pack.method, 0.5, count, width)
    evaluate(pack, own, found, 0.5, has_waves, is_lumped, count, width)
    next_stage(pack.nodes, pack.method, 1.0, count, width)
    evaluate(pack, own, found, 1.0, has_waves, is_lumped, count, width)
    end_stages(pack.nodes, pack.method, count, width)


@compiled
def evaluate(pack, own, found, share, has_waves, is_lumped, count, width):
    """Tensions and accelerations a share of the step on."""
    move_tops(pack.nodes, pack.motion, pack.times, pack.lane, pack.method, own, share, count, width)
    if has_waves:
        find_fluid(pack, count, width)
    accelerate(pack.nodes, pack.fluid, pack.line, pack.elements, pack.carry, found, is_lumped, count, width)
    for w in range(width):
        pack.lane[EVALUATIONS * LANES + w] += 1.0


@compiled
def move_tops(nodes, motion, times, lane, method, own, share, count, width):
    """Each lane's time, and where its top end is then: `physics.waves.top_motion` of all lanes."""
    L = LANES
    top = nodes[NODE_ROWS * L * count :]
    for w in range(width):
        time = lane[TIME * L + w] + share * method[STEP * L + w]
        omega = motion[OMEGA * L + w]
        ramp, rate, bend = ramp_at(time, motion[START * L + w], motion[RATE * L + w])
        sine, cosine = sine_cosine(omega * time)
        times[w] = time
        for k in range(3):
            c, s = motion[(C + k) * L + w], motion[(S + k) * L + w]
            here, turned = c * cosine + s * sine, omega * (s * cosine - c * sine)
            top[(PLACE + k) * L + w] = own[(REST + k) * L + w] + ramp * here
            top[(VELOCITY + k) * L + w] = ramp * turned + rate * here
            top[(ACCELERATION + k) * L + w] = bend * here + 2.0 * rate * turned - ramp * omega * omega * here


@compiled
def find_supports(nodes, elements, lane, found, count, width):
    """`keep_forces` of all lanes: forces on the ends, the tension in the middle, all power without a potential."""
    L, R, E = LANES, NODE_ROWS * LANES, ELEMENT_ROWS * LANES
    first, last = elements[:E], elements[E * (count - 1) : E * count]
    before, after = elements[E * ((count - 1) // 2) :], elements[E * (count // 2) :]
    inner, outer, top = nodes[R : 2 * R], nodes[R * (count - 1) : R * count], nodes[R * count : R * (count + 1)]
    for w in range(width):
        ax, ay, az = support(first, inner, LEFT, w)
        bx, by, bz = support(last, outer, RIGHT, w)
        lane[ANCHOR_NOW * L + w] = math.sqrt(ax * ax + ay * ay + az * az)
        lane[TOP_NOW * L + w] = math.sqrt(bx * bx + by * by + bz * bz)
        lane[MIDDLE_NOW * L + w] = 0.5 * (before[NEW * L + w] + after[NEW * L + w])
        power = found[POWER * L + w]
        given = -(bx * top[VELOCITY * L + w] + by * top[(VELOCITY + 1) * L + w] + bz * top[(VELOCITY + 2) * L + w])
        lane[POWER_NOW * L + w], lane[POWER_TURNED * L + w] = power + given, abs(power) + abs(given)


@compiled
def support(element, node, side, w):
    """The force on an end of the line; what the other node's acceleration takes from it is not in the element's yet."""
    L = LANES
    x, y, z = node[ACCELERATION * L + w], node[(ACCELERATION + 1) * L + w], node[(ACCELERATION + 2) * L + w]
    xx, xy, xz = element[OTHER * L + w], element[(OTHER + 1) * L + w], element[(OTHER + 2) * L + w]
    yy, yz, zz = element[(OTHER + 3) * L + w], element[(OTHER + 4) * L + w], element[(OTHER + 5) * L + w]
    return (
        element[side * L + w] - (xx * x + xy * y + xz * z),
        element[(side + 1) * L + w] - (xy * x + yy * y + yz * z),
        element[(side + 2) * L + w] - (xz * x + yz * y + zz * z),
    )


@compiled
def advance(pack, found, w):
    """A lane goes on to the end of its step."""
    lane = pack.lane
    step = pack.method[STEP * LANES + w]
    lane[TIME * LANES + w] += step
    lane[LAST_STEP * LANES + w] = step
    lane[STEPS * LANES + w] += lane[ACCEPTED * LANES + w]
    lane[TENSION_SCALE * LANES + w] = max(lane[TENSION_SCALE * LANES + w], lane[TOP_NOW * LANES + w])
    if found[LOOSEST * LANES + w] <= 0.0:
        lane[SLACK_UNTIL * LANES + w] = lane[TIME * LANES + w] + SLACK_FOR * lane[PERIOD * LANES + w]
    # Where the lane has met a time, it is there to the last bit.
    for row in (WINDOW, END):
        if abs(lane[TIME * LANES + w] - lane[row * LANES + w]) < SAME_TIME * lane[PERIOD * LANES + w]:
            lane[TIME * LANES + w] = lane[row * LANES + w]


@compiled
def longest_step(lane, own, w, is_leapfrog):
    """The longest step with which a lane's energy does not grow: of a line with slack elements, too."""
    is_slack = lane[TIME * LANES + w] < lane[SLACK_UNTIL * LANES + w]
    return own[LIMIT * LANES + w] * (SLACK_SHARE if is_leapfrog and is_slack else 1.0)


@compiled
def fate_of(pack, found, w, fixed, longest, most_steps, most_seconds, now):
    """How a lane's scenario has ended; negative where it goes on."""
    lane = pack.lane
    if not (math.isfinite(found[POWER * LANES + w]) and math.isfinite(lane[TOP_NOW * LANES + w])):
        return GAVE_UP
    if fixed > longest:
        return GAVE_UP
    if lane[BEYOND * LANES + w] > 0.0:
        return BEYOND_LAW
    if lane[TIME * LANES + w] >= lane[END * LANES + w]:
        return SOLVED
    if now - lane[BEGUN * LANES + w] > most_seconds:
        return OUT_OF_TIME
    return OUT_OF_STEPS if lane[STEPS * LANES + w] >= most_steps else -1.0


@compiled
def unload(pack, tally, w, is_leapfrog, records, fates, fate, count):
    """Write what a lane knows of its scenario."""
    scenario = int(pack.lane[SCENARIO * LANES + w])
    if is_leapfrog:
        correct_velocities(pack.nodes, w, pack.lane[LAST_STEP * LANES + w], count)
    finish_tally(pack, tally, w, records, count)
    fates[scenario, 0] = fate
    fates[scenario, 1], fates[scenario, 2] = pack.lane[STEPS * LANES + w], 0.0
    fates[scenario, 3] = pack.lane[EVALUATIONS * LANES + w]
