"""Marching many lines through time side by side, each with steps of its own.

The error of a step is judged by what the method adds to the places, and by the distance of every element's tension from
the parabola through its last three. A lane that has finished its scenario takes the next one of the queue, so that
lines which snap do not keep the others waiting. No lane sees anything of another.
"""

from typing import Any

import numpy as np

from cablesim.numerics.compiled import compiled
from cablesim.numerics.lanes import LANES
from cablesim.physics.nodal_line import ACCELERATION, ELEMENT_ROWS, NODE_ROWS, PLACE, VELOCITY
from cablesim.physics.waves import FLUID_SIZE, START, STREAM_X, STREAM_Y
from cablesim.solvers._wave_lanes import march_all
from cablesim.solvers._wave_newton import iterate
from cablesim.solvers._wave_pack import (
    ACCEPTED,
    BEGUN,
    BEYOND,
    BEYOND_LAW,
    CONVERGED,
    END,
    EVALUATIONS,
    GAVE_UP,
    LAST_STEP,
    NEW,
    NEXT_STEP,
    OLD_ACCELERATION,
    OLD_PLACE,
    OLD_SHIFTED,
    OLD_VELOCITY,
    OUT_OF_STEPS,
    OUT_OF_TIME,
    PAST1,
    PAST2,
    PAST3,
    PERIOD,
    PLACE_ERROR,
    PLACE_SCALE,
    REJECTED,
    RESCALED,
    RHO,
    SCENARIO,
    SHIFT_TIME,
    SHIFTED,
    SLACK_NOW,
    SLACK_UNTIL,
    SOLVED,
    STEP,
    STEP_BEFORE,
    STEPS,
    TENSION_ERROR,
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
    note_damping,
    note_elements,
    note_ends,
    note_history,
)
from cablesim.solvers._wave_step import RHO_SLACK, judge, move_ends, predict, rho_of, set_method

# Error of a step in tolerances that is let pass, and how the next step follows from it.
LET_PASS = 3.0
GROWTH, SHRINK, SAFETY, AFTER_FAILURE, WORTH_CHANGE = 2.0, 0.2, 0.9, 0.25, 1.6
FIRST_STEPS_PER_PERIOD, FIRST_AFTER_JERK = 100.0, 1e-3
# Parts of a period: a step shorter than this is a failure, and a line counts as slack for this long.
LEAST_STEP, SLACK_FOR = 1e-12, 0.5


def generalized_alpha(problem: Problem, has_waves: bool, options: Any, records: Records) -> Marched:
    return march_all(march, problem, has_waves, options, records)


@compiled
def march(problem, has_waves, limits, clock, records, fates, first, stride, width):
    """March every `stride`th scenario from `first` on, `width` at a time: see `march_all`."""
    rtol, fixed, part, most_steps, most_seconds = limits
    count = problem.tensions.shape[1]
    pack, tally = make_pack(count), np.zeros(TALLY_ROWS * LANES)
    queue, busy = first, 0
    for w in range(width):
        busy += load(pack, tally, w, queue, problem, fixed, count, clock[0])
        queue += stride
    while busy:
        for w in range(width):
            if pack.lane[SCENARIO * LANES + w] >= 0.0:
                set_method(pack, w, fixed, part)
        predict(pack.nodes, pack.method, count, width)
        move_ends(pack, problem, count, width)
        iterate(pack, has_waves, rtol, count, width)
        judge(pack.nodes, pack.elements, pack.method, pack.lane, count, width)
        for w in range(width):
            if pack.lane[SCENARIO * LANES + w] >= 0.0:
                decide(pack, w, rtol, fixed)
        note_elements(pack.elements, pack.method, pack.lane, tally, count, width)
        for w in range(width):
            if pack.lane[ACCEPTED * LANES + w] > 0.0:
                if records.history.shape[1] + records.orbit.shape[1] > 0:
                    note_history(pack, tally, w, records, count)
                note_ends(pack, tally, w)
                note_damping(pack, tally, w, count)
                advance(pack, w)
        accept(pack.nodes, pack.elements, pack.lane, count, width)
        for w in range(width):
            fate = fate_of(pack, w, most_steps, most_seconds, clock[0])
            if fate >= 0.0:
                unload(pack, tally, w, records, fates, fate, count)
                busy += load(pack, tally, w, queue, problem, fixed, count, clock[0]) - 1
                queue += stride


@compiled
def load(pack, tally, w, scenario, problem, fixed, count, now):
    """Give a lane a scenario; 0 where there is none left."""
    if scenario >= len(problem.lines):
        pack.lane[SCENARIO * LANES + w] = -1.0
        pack.lane[ACCEPTED * LANES + w] = 0.0
        return 0
    load_state(pack, w, scenario, problem)
    pack.lane[BEGUN * LANES + w] = now
    begin_tally(pack, tally, w, problem.supports[scenario])
    for e in range(count):
        for k in range(FLUID_SIZE):
            pack.fluid[(FLUID_SIZE * e + k) * LANES + w] = 0.0
        pack.fluid[FLUID_SIZE * e * LANES + w] = pack.wave[STREAM_X * LANES + w]
        pack.fluid[(FLUID_SIZE * e + 1) * LANES + w] = pack.wave[STREAM_Y * LANES + w]
    step = fixed if fixed > 0.0 else pack.lane[PERIOD * LANES + w] / FIRST_STEPS_PER_PERIOD
    # Accelerations are zero before; without a ramp they jump, and a short step bears that.
    if fixed == 0.0 and problem.motions[scenario, START] > 0.0:
        step *= FIRST_AFTER_JERK
    pack.lane[NEXT_STEP * LANES + w] = step
    pack.lane[LAST_STEP * LANES + w] = pack.lane[STEP_BEFORE * LANES + w] = step
    rho = pack.lane[RHO * LANES + w] = rho_of(pack, w, problem.starts[scenario])
    pack.lane[SHIFT_TIME * LANES + w] = step * (rho - 1.0) / (rho + 1.0)
    pack.lane[SLACK_UNTIL * LANES + w] = -1.0
    return 1


@compiled
def decide(pack, w, rtol, fixed):
    """Accept the step of a lane or not, and how long the next one is."""
    lane = pack.lane
    step = pack.method[STEP * LANES + w]
    if lane[CONVERGED * LANES + w] == 0.0:
        lane[ACCEPTED * LANES + w] = 0.0
        lane[NEXT_STEP * LANES + w] = AFTER_FAILURE * step
    elif fixed > 0.0:
        lane[ACCEPTED * LANES + w] = 1.0
        lane[NEXT_STEP * LANES + w] = min(fixed, GROWTH * step)
    else:
        of_tension = lane[TENSION_ERROR * LANES + w] / lane[TENSION_SCALE * LANES + w]
        error = max(of_tension, lane[PLACE_ERROR * LANES + w] / lane[PLACE_SCALE * LANES + w]) / (LET_PASS * rtol)
        factor = min(GROWTH, max(SHRINK, SAFETY * (error + 1e-10) ** (-1.0 / 3.0)))
        if lane[ACCEPTED * LANES + w] == 0.0 and lane[STEPS * LANES + w] > 0.0:
            factor = min(factor, 1.0)
        lane[ACCEPTED * LANES + w] = 1.0 if error <= 1.0 else 0.0
        # A change of the step makes vibrations ring that it does not resolve.
        if error <= 1.0 and factor < WORTH_CHANGE and lane[RHO * LANES + w] == RHO_SLACK:
            factor = 1.0
        lane[NEXT_STEP * LANES + w] = factor * step
    if lane[ACCEPTED * LANES + w] == 0.0:
        lane[REJECTED * LANES + w] += 1.0


@compiled
def advance(pack, w):
    """A lane goes on to the end of its accepted step."""
    lane, m = pack.lane, pack.method
    lane[TIME * LANES + w] = pack.times[w]
    lane[STEP_BEFORE * LANES + w] = lane[LAST_STEP * LANES + w]
    lane[LAST_STEP * LANES + w] = m[STEP * LANES + w]
    lane[SHIFT_TIME * LANES + w] *= m[RESCALED * LANES + w]
    lane[STEPS * LANES + w] += 1.0
    lane[TENSION_SCALE * LANES + w] = max(lane[TENSION_SCALE * LANES + w], lane[TOP_NOW * LANES + w])
    if lane[SLACK_NOW * LANES + w] > 0.0:
        lane[SLACK_UNTIL * LANES + w] = lane[TIME * LANES + w] + SLACK_FOR * lane[PERIOD * LANES + w]
    # Where the lane has met a time, it is there to the last bit.
    for row in (WINDOW, END):
        if abs(lane[TIME * LANES + w] - lane[row * LANES + w]) < LEAST_STEP * lane[PERIOD * LANES + w]:
            lane[TIME * LANES + w] = lane[row * LANES + w]


@compiled
def accept(nodes, elements, lane, count, width):
    """What is new becomes old, in the lanes that accepted their step."""
    L = LANES
    for j in range(count + 1):
        node = nodes[NODE_ROWS * L * j : NODE_ROWS * L * (j + 1)]
        for k in range(3):
            own = node[k * L :]
            for w in range(width):
                is_new = lane[ACCEPTED * L + w] > 0.0
                own[OLD_SHIFTED * L + w] = own[SHIFTED * L + w] if is_new else own[OLD_SHIFTED * L + w]
                own[OLD_PLACE * L + w] = own[PLACE * L + w] if is_new else own[OLD_PLACE * L + w]
                own[OLD_VELOCITY * L + w] = own[VELOCITY * L + w] if is_new else own[OLD_VELOCITY * L + w]
                own[OLD_ACCELERATION * L + w] = own[ACCELERATION * L + w] if is_new else own[OLD_ACCELERATION * L + w]
    for e in range(count):
        own = elements[ELEMENT_ROWS * L * e : ELEMENT_ROWS * L * (e + 1)]
        for w in range(width):
            is_new = lane[ACCEPTED * L + w] > 0.0
            own[PAST3 * L + w] = own[PAST2 * L + w] if is_new else own[PAST3 * L + w]
            own[PAST2 * L + w] = own[PAST1 * L + w] if is_new else own[PAST2 * L + w]
            own[PAST1 * L + w] = own[NEW * L + w] if is_new else own[PAST1 * L + w]


@compiled
def fate_of(pack, w, most_steps, most_seconds, now):
    """How a lane's scenario has ended; negative where it goes on, or where there is none."""
    lane = pack.lane
    if lane[SCENARIO * LANES + w] < 0.0:
        return -1.0
    if lane[BEYOND * LANES + w] > 0.0:
        return BEYOND_LAW
    if lane[TIME * LANES + w] >= lane[END * LANES + w]:
        return SOLVED
    if lane[NEXT_STEP * LANES + w] < LEAST_STEP * lane[PERIOD * LANES + w]:
        return GAVE_UP
    if now - lane[BEGUN * LANES + w] > most_seconds:
        return OUT_OF_TIME
    return OUT_OF_STEPS if lane[STEPS * LANES + w] + lane[REJECTED * LANES + w] >= most_steps else -1.0


@compiled
def unload(pack, tally, w, records, fates, fate, count):
    """Write what a lane knows of its scenario."""
    scenario = int(pack.lane[SCENARIO * LANES + w])
    finish_tally(pack, tally, w, records, count)
    fates[scenario, 0] = fate
    for i, row in enumerate((STEPS, REJECTED, EVALUATIONS)):
        fates[scenario, 1 + i] = pack.lane[row * LANES + w]
