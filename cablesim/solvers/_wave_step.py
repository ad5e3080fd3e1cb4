"""One step of many lines side by side by the generalised-alpha method, each with its own length of step.

    M a' = f';  x' = x + h v + h^2 ((1/2 - beta) q + beta q'),  v' = v + h ((1 - gamma) q + gamma q')
    (1 - alpha_m) q' + alpha_m q = (1 - alpha_f) a' + alpha_f a

This is Arnold and Bruels' form, which is of second order for any mass matrix; q is the acceleration at a time shifted
by theta h, theta = alpha_m - alpha_f, and is shifted anew where the step changes. Motion that the step does not
resolve loses all but a part rho of its amplitude each step.

Motion that a line's own length dictates is found with velocities that lag by |1/6 - theta/2 - beta| h^2 a'. Where the
step of a line too stiff to stretch changes, its velocities are given the lag of the new one: with the old one they
would stretch it, and it would ring.

References: J. Chung, G. Hulbert, J. Appl. Mech. 60 (1993) 371; M. Arnold, O. Bruels, Multibody Syst. Dyn. 18 (2007)
185.
"""

import math

from cablesim.numerics.compiled import compiled
from cablesim.numerics.lanes import LANES
from cablesim.physics.nodal_line import (
    ACCELERATION,
    ADDED_TANGENT,
    ELEMENT_ROWS,
    LINEAR,
    MASS,
    NODE_ROWS,
    PIECE,
    PLACE,
    VELOCITY,
)
from cablesim.physics.waves import fluid_at, top_motion
from cablesim.solvers._wave_pack import (
    ACCELERATION_BY_PLACE,
    ACCELERATION_NEW,
    ACCELERATION_OLD,
    ACCELERATION_PAST,
    ACTIVE,
    CONVERGED,
    CORRECTION,
    DISTANCE,
    END,
    EXTRAPOLATED1,
    EXTRAPOLATED2,
    EXTRAPOLATED3,
    LAST_STEP,
    NEW,
    NEXT_STEP,
    OLD_ACCELERATION,
    OLD_PLACE,
    OLD_SHIFTED,
    OLD_VELOCITY,
    PAST1,
    PAST2,
    PAST3,
    PERIOD,
    PLACE_DEFECT,
    PLACE_ERROR,
    PLACE_NEW,
    PLACE_OLD,
    RELAGGED,
    RESCALED,
    RHO,
    SCENARIO,
    SHIFT_TIME,
    SHIFTED,
    SLACK_NOW,
    SLACK_UNTIL,
    START_SHIFTED,
    STEP,
    STEP_BEFORE,
    TENSION_DEFECT,
    TENSION_ERROR,
    TENSION_SCALE,
    TIME,
    VELOCITY_BY_PLACE,
    VELOCITY_NEW,
    VELOCITY_OLD,
    WINDOW,
)

# rho of a line that is taut, and of one that has been slack within half a period: a snap would ring on for ever in the
# shortest waves of the mesh. A hanging line too stiff for steps to resolve vibrations along it has the second at all
# times: there the tension only keeps the length, and every change of the step would make it ring. It is such a line
# where so long a step turns its lowest vibration along by more than 1, and where the sag resists the ends' moving apart
# so many times less than the elasticity (Irvine's lambda^2).
RHO_TAUT, RHO_SLACK = 0.7, 0.0
RESOLVED_STEP, HANGS = 1.0 / 64.0, 1e3
STEPS_PER_PERIOD = 16.0
# A step that would leave less than this part of itself to a time that is to be met goes there at once.
NEARLY = 0.01


@compiled
def set_method(pack, w, fixed, part):
    """The length of the next step of a lane, and the numbers of the method that follow from it."""
    m, lane = pack.method, pack.lane
    time = lane[TIME * LANES + w]
    h = step_to_meet(time, lane[NEXT_STEP * LANES + w], lane[WINDOW * LANES + w], lane[END * LANES + w])
    if fixed == 0.0:
        h = min(h, part * lane[PERIOD * LANES + w] / STEPS_PER_PERIOD)
    rho = RHO_SLACK if time < lane[SLACK_UNTIL * LANES + w] else lane[RHO * LANES + w]
    alpha_m, alpha_f = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
    theta = alpha_m - alpha_f
    gamma, beta = 0.5 - theta, 0.25 * (1.0 - theta) ** 2
    m[STEP * LANES + w] = h
    m[PLACE_NEW * LANES + w], m[PLACE_OLD * LANES + w] = beta * h * h, (0.5 - beta) * h * h
    m[VELOCITY_NEW * LANES + w], m[VELOCITY_OLD * LANES + w] = gamma * h, (1.0 - gamma) * h
    m[ACCELERATION_NEW * LANES + w] = (1.0 - alpha_m) / (1.0 - alpha_f)
    m[ACCELERATION_OLD * LANES + w] = alpha_m / (1.0 - alpha_f)
    m[ACCELERATION_PAST * LANES + w] = -alpha_f / (1.0 - alpha_f)
    m[VELOCITY_BY_PLACE * LANES + w] = gamma / (beta * h)
    m[ACCELERATION_BY_PLACE * LANES + w] = m[ACCELERATION_NEW * LANES + w] / (beta * h * h)
    m[RESCALED * LANES + w] = theta * h / lane[SHIFT_TIME * LANES + w]
    defect = abs(beta + 0.5 * theta - 1.0 / 6.0)
    last, lag = lane[LAST_STEP * LANES + w], defect * h * h
    m[PLACE_DEFECT * LANES + w] = lag
    is_bound = (lane[RHO * LANES + w] == RHO_SLACK) & (time >= lane[SLACK_UNTIL * LANES + w])
    m[RELAGGED * LANES + w] = (defect * last * last - lag) / lane[SHIFT_TIME * LANES + w] if is_bound else 0.0
    set_extrapolation(m, w, h, last, lane[STEP_BEFORE * LANES + w], defect)
    m[ACTIVE * LANES + w] = 1.0
    lane[CONVERGED * LANES + w] = 0.0
    lane[CORRECTION * LANES + w] = -1.0


@compiled
def rho_of(pack, w, start):
    """rho of a line whose nodes are at `start` (node, 3) in equilibrium."""
    line, count = pack.line, len(start) - 1
    length, linear = count * line[PIECE * LANES + w], line[LINEAR * LANES + w]
    chord, sag = start[count] - start[0], 0.0
    for j in range(1, count):
        way = start[j] - start[0]
        sag = max(sag, (way**2).sum() - (way * chord).sum() ** 2 / (chord**2).sum())
    stiffer = 64.0 * sag / length**2 * linear / pack.lane[TENSION_SCALE * LANES + w]
    carried = line[MASS * LANES + w] - line[ADDED_TANGENT * LANES + w]
    turn = math.pi * math.sqrt(linear / carried) / length * RESOLVED_STEP * pack.lane[PERIOD * LANES + w]
    return RHO_SLACK if (stiffer > HANGS) & (turn > 1.0) else RHO_TAUT


@compiled
def step_to_meet(time, step, window, end):
    """A step that does not pass the next of two times, and does not leave a tiny one before it."""
    rest = (window if time < window else end) - time
    if step > (1.0 - NEARLY) * rest:
        return rest
    return 0.5 * rest if step > 0.5 * rest else step


@compiled
def set_extrapolation(m, w, h, last, before, defect):
    """A parabola through the last three tensions, and the error of the method over the distance from it."""
    two, three = last + before, h + last + before
    m[EXTRAPOLATED1 * LANES + w] = (h + last) * three / (last * two)
    m[EXTRAPOLATED2 * LANES + w] = -h * three / (last * before)
    m[EXTRAPOLATED3 * LANES + w] = h * (h + last) / (before * two)
    m[TENSION_DEFECT * LANES + w] = 6.0 * defect * h * h / ((h + last) * three)


@compiled
def extrapolated(element, method, w):
    """What the last three tensions of an element lead to."""
    return (
        method[EXTRAPOLATED1 * LANES + w] * element[PAST1 * LANES + w]
        + method[EXTRAPOLATED2 * LANES + w] * element[PAST2 * LANES + w]
        + method[EXTRAPOLATED3 * LANES + w] * element[PAST3 * LANES + w]
    )


@compiled
def predict(nodes, method, count, width):
    """Places, velocities and accelerations of the inner nodes if q stays what it was."""
    L = LANES
    for j in range(1, count):
        node = nodes[NODE_ROWS * L * j : NODE_ROWS * L * (j + 1)]
        for k in range(3):
            own = node[k * L :]
            for w in range(width):
                a0 = own[OLD_ACCELERATION * L + w]
                more = own[OLD_SHIFTED * L + w] - a0
                q, v0 = (
                    a0 + method[RESCALED * L + w] * more,
                    own[OLD_VELOCITY * L + w] + method[RELAGGED * L + w] * more,
                )
                own[START_SHIFTED * L + w] = q
                own[SHIFTED * L + w] = q
                way = method[STEP * L + w] * v0 + (method[PLACE_OLD * L + w] + method[PLACE_NEW * L + w]) * q
                own[PLACE * L + w] = own[OLD_PLACE * L + w] + way
                own[VELOCITY * L + w] = v0 + (method[VELOCITY_OLD * L + w] + method[VELOCITY_NEW * L + w]) * q
                change = (method[ACCELERATION_NEW * L + w] + method[ACCELERATION_OLD * L + w]) * q
                own[ACCELERATION * L + w] = change + method[ACCELERATION_PAST * L + w] * a0


@compiled
def move_ends(pack, problem, count, width):
    """Each lane's time at the end of the step, and where its top end is then."""
    L = LANES
    top = pack.nodes[NODE_ROWS * L * count :]
    for w in range(width):
        scenario = int(pack.lane[SCENARIO * L + w])
        pack.times[w] = pack.lane[TIME * L + w] + pack.method[STEP * L + w]
        if scenario < 0:
            continue
        top_motion(pack.times[w], pack.motion, w, pack.top)
        for k in range(3):
            top[(PLACE + k) * L + w] = problem.starts[scenario, count, k] + pack.top[k * L + w]
            top[(VELOCITY + k) * L + w] = pack.top[(3 + k) * L + w]
            top[(ACCELERATION + k) * L + w] = pack.top[(6 + k) * L + w]


@compiled
def find_fluid(pack, count, width):
    """Velocity and acceleration of the fluid at the middle of the elements."""
    L = LANES
    for e in range(count):
        ends = pack.nodes[NODE_ROWS * L * e : NODE_ROWS * L * (e + 2)]
        middle = pack.points[3 * L * e : 3 * L * (e + 1)]
        for k in range(3):
            for w in range(width):
                middle[k * L + w] = 0.5 * (ends[k * L + w] + ends[(NODE_ROWS + k) * L + w])
    fluid_at(pack.times[:width], pack.points, count, pack.wave, pack.fluid)


@compiled
def judge(nodes, elements, method, lane, count, width):
    """Estimate the errors of the step, and see whether any element is slack."""
    L = LANES
    for w in range(width):
        lane[TENSION_ERROR * L + w] = lane[PLACE_ERROR * L + w] = lane[SLACK_NOW * L + w] = 0.0
    for e in range(count):
        own = elements[ELEMENT_ROWS * L * e : ELEMENT_ROWS * L * (e + 1)]
        for w in range(width):
            own[DISTANCE * L + w] = own[NEW * L + w] - extrapolated(own, method, w)
            lane[SLACK_NOW * L + w] += 0.0 if own[NEW * L + w] > 0.0 else 1.0
    for e in range(count):
        judge_tension(elements, method, lane, e, count, width)
    for j in range(1, count):
        node = nodes[NODE_ROWS * L * j : NODE_ROWS * L * (j + 1)]
        for k in range(3):
            own = node[k * L :]
            for w in range(width):
                error = method[PLACE_DEFECT * L + w] * abs(own[SHIFTED * L + w] - own[START_SHIFTED * L + w])
                lane[PLACE_ERROR * L + w] = error if error > lane[PLACE_ERROR * L + w] else lane[PLACE_ERROR * L + w]


@compiled
def judge_tension(elements, method, lane, e, count, width):
    """The error of the tension of an element and its neighbours, (1 4 6 4 1)/16 of each; the line's ends mirror it.

    Waves of two elements' length, which are the mesh's and not the line's, have no part in that.
    """
    L, size = LANES, ELEMENT_ROWS * LANES
    before2, before1 = mirrored(e - 2, count), mirrored(e - 1, count)
    after1, after2 = mirrored(e + 1, count), mirrored(e + 2, count)
    a = elements[size * before2 + DISTANCE * L : size * before2 + (DISTANCE + 1) * L]
    b = elements[size * before1 + DISTANCE * L : size * before1 + (DISTANCE + 1) * L]
    c = elements[size * e + DISTANCE * L : size * e + (DISTANCE + 1) * L]
    d = elements[size * after1 + DISTANCE * L : size * after1 + (DISTANCE + 1) * L]
    f = elements[size * after2 + DISTANCE * L : size * after2 + (DISTANCE + 1) * L]
    for w in range(width):
        error = method[TENSION_DEFECT * L + w] * abs(a[w] + f[w] + 4.0 * (b[w] + d[w]) + 6.0 * c[w]) / 16.0
        lane[TENSION_ERROR * L + w] = error if error > lane[TENSION_ERROR * L + w] else lane[TENSION_ERROR * L + w]


@compiled
def mirrored(e, count):
    """The number of an element, beyond the ends of the line counted back from there."""
    inside = -1 - e if e < 0 else (2 * count - 1 - e if e >= count else e)
    return min(max(inside, 0), count - 1)
