"""Marching many lines through time side by side with explicit steps: leapfrog and the Runge-Kutta method.

A step is a part of the longest stable one, or shorter where the error wants it; it is never taken back. Every step is
recorded. A fixed step longer than the longest stable one gives up, and so does a line whose motion is not finite.
"""

import math
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from cablesim.numerics.compiled import compiled
from cablesim.numerics.lanes import LANES
from cablesim.numerics.threads import thread_count
from cablesim.physics.nodal_line import (
    ACCELERATION,
    ELEMENT_ROWS,
    LINEAR,
    NODE_ROWS,
    OTHER_SHARE,
    PIECE,
    PLACE,
    VELOCITY,
)
from cablesim.physics.waves import FLUID_SIZE, STREAM_X, STREAM_Y, top_motion
from cablesim.solvers._wave_explicit_step import (
    begin_stages,
    correct_velocities,
    end_stages,
    leap,
    next_stage,
    stable_step,
)
from cablesim.solvers._wave_forces import FOUND_ROWS, LOOSEST, POWER, accelerate
from cablesim.solvers._wave_pack import (
    ACCEPTED,
    END,
    EVALUATIONS,
    GAVE_UP,
    LAST_STEP,
    NEW,
    NEXT_STEP,
    OLD_ACCELERATION,
    OLD_PLACE,
    OUT_OF_STEPS,
    PAST1,
    PERIOD,
    PLACE_SCALE,
    POWER_IN,
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
from cablesim.solvers._wave_step import find_fluid, keep_forces, step_to_meet

# Part of the longest stable step that is taken.
SAFETY = 0.9
# Part of it that leapfrog takes while a line has been slack lately: where elements slacken and snap, its energy grows
# with steps well below the limit for vibrations (peaks 3 times too large at 0.7 of it, 3 % at 0.35).
SLACK_SHARE, SLACK_FOR = 0.4, 0.5
# Parts of a period: the longest step, how often the error is judged at least, and a time that is as good as another.
LONGEST, JUDGED, SAME_TIME = 1.0 / 40.0, 1.0 / 50.0, 1e-9
STEPS_JUDGED = 32.0
# Error of a step in tolerances that is let pass, and what follows for the step.
LET_PASS, GROWTH, SHRINK = 3.0, 2.0, 0.2
# Beside the rows of the pack, a lane has the step that its error wants, and steps and time since that was judged.
WANTED, SINCE, JUDGED_AT = range(3)
OWN_ROWS = 3


def march_all(is_leapfrog: bool, problem: Problem, has_waves: bool, options: Any, records: Records) -> Marched:
    """March all scenarios on the threads that there are; neither their number nor the batch changes any result."""
    size = len(problem.lines)
    fates = np.zeros((size, 4))
    threads = max(1, min(thread_count(), size))
    width = min(LANES, -(-size // threads))
    limits = np.array([options.rtol, options.time_step, options.most_steps])
    with ThreadPoolExecutor(threads) as pool:
        work = [
            pool.submit(march, problem, has_waves, is_leapfrog, limits, records, fates, first, threads, width)
            for first in range(threads)
        ]
        for part in work:
            part.result()
    fate, steps, rejected, evaluations = fates.T
    return Marched(fate, steps, rejected, evaluations, records)


def leapfrog(problem: Problem, has_waves: bool, options: Any, records: Records) -> Marched:
    return march_all(True, problem, has_waves, options, records)


def rk4(problem: Problem, has_waves: bool, options: Any, records: Records) -> Marched:
    return march_all(False, problem, has_waves, options, records)


@compiled
def march(problem, has_waves, is_leapfrog, limits, records, fates, first, stride, width):
    """March every `stride`th scenario from `first` on, `width` at a time.

    `limits` are the tolerance, a fixed step (0: by stability and error) and the most steps. Written: `records`, and
    `fates` (scenario, 4): fate, steps, rejected steps (none), evaluations.
    """
    rtol, fixed, most_steps = limits
    count = problem.tensions.shape[1]
    pack, tally = make_pack(count), np.zeros(TALLY_ROWS * LANES)
    found, own = np.zeros(FOUND_ROWS * LANES), np.zeros(OWN_ROWS * LANES)
    is_lumped = problem.lines[0, OTHER_SHARE] == 0.0
    queue, busy = first, 0
    for w in range(width):
        busy += load(pack, tally, own, w, queue, problem, count)
        queue += stride
    while busy:
        for w in range(width):
            set_step(pack, w)
        keep_tensions(pack.elements, count, width)
        if is_leapfrog:
            leap(pack.nodes, pack.method, pack.lane[LAST_STEP * LANES : (LAST_STEP + 1) * LANES], count, width)
        else:
            take_stages(pack, problem, found, has_waves, is_lumped, count, width)
        evaluate(pack, problem, found, 1.0, has_waves, is_lumped, count, width)
        for w in range(width):
            pack.lane[POWER_IN * LANES + w] = found[POWER * LANES + w]
            keep_forces(pack, w, count)
        note_elements(pack.elements, pack.method, pack.lane, tally, count, width)
        for w in range(width):
            if pack.lane[ACCEPTED * LANES + w] > 0.0:
                if records.history.shape[1] > 0:
                    note_history(pack, tally, w, records, count)
                note_ends(pack, tally, w)
            if pack.lane[SCENARIO * LANES + w] >= 0.0:
                advance(pack, found, w)
                choose_step(pack, found, own, w, is_leapfrog, rtol, fixed, count)
                fate = fate_of(pack, found, w, is_leapfrog, fixed, most_steps)
                if fate >= 0.0:
                    unload(pack, tally, w, is_leapfrog, records, fates, fate, count)
                    busy += load(pack, tally, own, w, queue, problem, count) - 1
                    queue += stride


@compiled
def load(pack, tally, own, w, scenario, problem, count):
    """Give a lane a scenario; 0 where there is none left. Its first step has no length: that finds accelerations."""
    pack.lane[ACCEPTED * LANES + w] = 0.0
    pack.lane[LAST_STEP * LANES + w] = pack.method[STEP * LANES + w] = 0.0
    if scenario >= len(problem.lines):
        pack.lane[SCENARIO * LANES + w] = -1.0
        pack.lane[NEXT_STEP * LANES + w] = 0.0
        return 0
    load_state(pack, w, scenario, problem)
    begin_tally(pack, tally, w, problem.supports[scenario])
    for e in range(count):
        for k in range(FLUID_SIZE):
            pack.fluid[(FLUID_SIZE * e + k) * LANES + w] = 0.0
        pack.fluid[FLUID_SIZE * e * LANES + w] = pack.wave[STREAM_X * LANES + w]
        pack.fluid[(FLUID_SIZE * e + 1) * LANES + w] = pack.wave[STREAM_Y * LANES + w]
    pack.lane[SLACK_UNTIL * LANES + w] = -1.0
    own[WANTED * LANES + w] = LONGEST * pack.lane[PERIOD * LANES + w]
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
def keep_tensions(elements, count, width):
    L, E = LANES, ELEMENT_ROWS * LANES
    for e in range(count):
        own = elements[E * e : E * (e + 1)]
        for w in range(width):
            own[PAST1 * L + w] = own[NEW * L + w]


@compiled
def take_stages(pack, problem, found, has_waves, is_lumped, count, width):
    """All of a Runge-Kutta step but the evaluation at its end."""
    begin_stages(pack.nodes, pack.method, count, width)
    evaluate(pack, problem, found, 0.5, has_waves, is_lumped, count, width)
    next_stage(pack.nodes, pack.method, 0.5, count, width)
    evaluate(pack, problem, found, 0.5, has_waves, is_lumped, count, width)
    next_stage(pack.nodes, pack.method, 1.0, count, width)
    evaluate(pack, problem, found, 1.0, has_waves, is_lumped, count, width)
    end_stages(pack.nodes, pack.method, count, width)


@compiled
def evaluate(pack, problem, found, share, has_waves, is_lumped, count, width):
    """Tensions and accelerations a share of the step on."""
    move_ends(pack, problem, share, count, width)
    if has_waves:
        find_fluid(pack, count, width)
    accelerate(pack.nodes, pack.fluid, pack.line, pack.elements, pack.carry, found, is_lumped, count, width)
    for w in range(width):
        pack.lane[EVALUATIONS * LANES + w] += 1.0


@compiled
def move_ends(pack, problem, share, count, width):
    """Each lane's time, and where its top end is then."""
    L = LANES
    top = pack.nodes[NODE_ROWS * L * count :]
    for w in range(width):
        scenario = int(pack.lane[SCENARIO * L + w])
        pack.times[w] = pack.lane[TIME * L + w] + share * pack.method[STEP * L + w]
        if scenario < 0:
            continue
        top_motion(pack.times[w], pack.motion, w, pack.top)
        for k in range(3):
            top[(OLD_PLACE + k) * L + w] = top[(PLACE + k) * L + w]
            top[(PLACE + k) * L + w] = problem.starts[scenario, count, k] + pack.top[k * L + w]
            top[(VELOCITY + k) * L + w] = pack.top[(3 + k) * L + w]
            top[(ACCELERATION + k) * L + w] = pack.top[(6 + k) * L + w]


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
def choose_step(pack, found, own, w, is_leapfrog, rtol, fixed, count):
    """How long the next step of a lane is."""
    lane, step, period = pack.lane, pack.method[STEP * LANES + w], pack.lane[PERIOD * LANES + w]
    if fixed > 0.0:
        lane[NEXT_STEP * LANES + w] = fixed
        return
    own[SINCE * LANES + w] += 1.0
    due = lane[TIME * LANES + w] - own[JUDGED_AT * LANES + w] >= JUDGED * period
    if step > 0.0 and (due or own[SINCE * LANES + w] >= STEPS_JUDGED):
        own[SINCE * LANES + w], own[JUDGED_AT * LANES + w] = 0.0, lane[TIME * LANES + w]
        tolerance = LET_PASS * rtol if is_leapfrog else LET_PASS * (10.0 * rtol) ** 0.75
        error = defect(pack, w, count) / tolerance
        factor = min(GROWTH, max(SHRINK, (error + 1e-10) ** (-1.0 / 3.0)))
        own[WANTED * LANES + w] = min(LONGEST * period, factor * step)
    safe = SAFETY * longest_step(pack, found, w, is_leapfrog)
    lane[NEXT_STEP * LANES + w] = min(safe, own[WANTED * LANES + w])


@compiled
def longest_step(pack, found, w, is_leapfrog):
    """The longest step with which a lane's energy does not grow: of a line with slack elements, too."""
    longest = stable_step(pack.line, found, w, is_leapfrog)
    return (
        SLACK_SHARE * longest
        if is_leapfrog and pack.lane[TIME * LANES + w] < pack.lane[SLACK_UNTIL * LANES + w]
        else longest
    )


@compiled
def defect(pack, w, count):
    """What the change of acceleration adds to places, and to tensions by that, in their scales, over a step.

    Tensions are smoothed along the line, (1 2 1)/4 twice: waves of two elements' length are the mesh's.
    """
    L, R, line = LANES, NODE_ROWS * LANES, pack.line
    h, piece = pack.method[STEP * L + w], line[PIECE * L + w]
    sixth = h * h / 6.0
    place, pull, a, b, c, d = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    lx, ly, lz = 0.0, 0.0, 0.0
    for e in range(count):
        ends = pack.nodes[R * e : R * (e + 2)]
        rx, ry, rz = 0.0, 0.0, 0.0
        if e < count - 1:
            rx = sixth * (ends[R + ACCELERATION * L + w] - ends[R + OLD_ACCELERATION * L + w])
            ry = sixth * (ends[R + (ACCELERATION + 1) * L + w] - ends[R + (OLD_ACCELERATION + 1) * L + w])
            rz = sixth * (ends[R + (ACCELERATION + 2) * L + w] - ends[R + (OLD_ACCELERATION + 2) * L + w])
        dx, dy, dz = ends[R + w] - ends[w], ends[R + L + w] - ends[L + w], ends[R + 2 * L + w] - ends[2 * L + w]
        length = math.sqrt(dx * dx + dy * dy + dz * dz) + 1e-300
        place = max(place, abs(rx), abs(ry), abs(rz))
        now = (dx * (rx - lx) + dy * (ry - ly) + dz * (rz - lz)) / length
        if pack.elements[(ELEMENT_ROWS * e + NEW) * L + w] <= 0.0:
            now = 0.0
        pull = max(pull, abs(a + now + 4.0 * (b + d) + 6.0 * c) / 16.0)
        a, b, c, d = b, c, d, now
        lx, ly, lz = rx, ry, rz
    slope = line[LINEAR * L + w] / piece
    return max(place / pack.lane[PLACE_SCALE * L + w], slope * pull / pack.lane[TENSION_SCALE * L + w])


@compiled
def fate_of(pack, found, w, is_leapfrog, fixed, most_steps):
    """How a lane's scenario has ended; negative where it goes on."""
    lane = pack.lane
    if not (math.isfinite(found[POWER * LANES + w]) and math.isfinite(lane[TOP_NOW * LANES + w])):
        return GAVE_UP
    if fixed > longest_step(pack, found, w, is_leapfrog):
        return GAVE_UP
    if lane[TIME * LANES + w] >= lane[END * LANES + w]:
        return SOLVED
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
