"""What the errors of explicit steps are, of many lines side by side, and how long a step they want.

A step's error is what the change of acceleration over it adds to places, and by them to tensions.
"""

import math

from cablesim.numerics.compiled import compiled
from cablesim.numerics.lanes import LANES
from cablesim.physics.nodal_line import (
    ACCELERATION,
    ELEMENT_ROWS,
    LINEAR,
    NODE_ROWS,
    PIECE,
    TINY,
)
from cablesim.solvers._wave_pack import (
    ACCEPTED,
    NEW,
    OLD_ACCELERATION,
    PERIOD,
    PLACE_SCALE,
    STEP,
    TENSION_SCALE,
    TIME,
)

# Parts of a period: the longest step, and how often the error is judged at least; most steps between two judgements.
LONGEST, JUDGED, STEPS_JUDGED = 1.0 / 40.0, 1.0 / 50.0, 32.0
# Error of a step in tolerances that is let pass, and what follows for the step.
LET_PASS, GROWTH, SHRINK = 3.0, 2.0, 0.2
# Beside the rows of the pack, a lane has the step that its error wants, steps and time since that was judged, whether
# that is due, the longest step for vibrations, and the top end's place at rest.
WANTED, SINCE, JUDGED_AT, DUE, LIMIT, REST = range(6)
OWN_ROWS = REST + 3
# Rows of room to work in where `find_defects` leaves the largest.
PULL_DEFECT, PLACE_DEFECT = 7, 8


@compiled
def judge_lanes(pack, own, is_leapfrog, rtol, count, width):
    """Where it is time, judge the error of a lane's step, and how long a step that wants."""
    L, lane, is_due = LANES, pack.lane, False
    for w in range(width):
        own[SINCE * L + w] += lane[ACCEPTED * L + w]
        late = lane[TIME * L + w] - own[JUDGED_AT * L + w] >= JUDGED * lane[PERIOD * L + w]
        due = (lane[ACCEPTED * L + w] > 0.0) & (late | (own[SINCE * L + w] >= STEPS_JUDGED))
        own[DUE * L + w] = 1.0 if due else 0.0
        is_due |= due
    if not is_due:
        return
    find_defects(pack.nodes, pack.elements, pack.line, pack.method, pack.carry, count, width)
    for w in range(width):
        if own[DUE * L + w] > 0.0:
            place = pack.carry[PLACE_DEFECT * L + w] / lane[PLACE_SCALE * L + w]
            pull = pack.carry[PULL_DEFECT * L + w] / lane[TENSION_SCALE * L + w]
            # The Runge-Kutta method's error is the same to the power of 4/3, about.
            error = max(place, pull) / (LET_PASS * (rtol if is_leapfrog else (10.0 * rtol) ** 0.75))
            factor = min(GROWTH, max(SHRINK, (error + 1e-10) ** (-1.0 / 3.0)))
            own[WANTED * L + w] = min(LONGEST * lane[PERIOD * L + w], factor * pack.method[STEP * L + w])
            own[SINCE * L + w], own[JUDGED_AT * L + w] = 0.0, lane[TIME * L + w]


@compiled
def find_defects(nodes, elements, line, method, room, count, width):
    """What the change of acceleration adds over a step to places, and to tensions by that, at most.

    Tensions are smoothed along the line by (1 4 6 4 1)/16: waves of two elements' length are the mesh's. The first
    rows of `room` are the last four elements' tensions and the last node's place.
    """
    L, R, E = LANES, NODE_ROWS * LANES, ELEMENT_ROWS * LANES
    room[: 9 * L] = 0.0
    for e in range(count):
        ends, out = nodes[R * e : R * (e + 2)], elements[E * e : E * (e + 1)]
        is_inner = 1.0 if e < count - 1 else 0.0
        for w in range(width):
            h, piece = method[STEP * L + w], line[PIECE * L + w]
            sixth = is_inner * h * h / 6.0
            rx = sixth * (ends[R + ACCELERATION * L + w] - ends[R + OLD_ACCELERATION * L + w])
            ry = sixth * (ends[R + (ACCELERATION + 1) * L + w] - ends[R + (OLD_ACCELERATION + 1) * L + w])
            rz = sixth * (ends[R + (ACCELERATION + 2) * L + w] - ends[R + (OLD_ACCELERATION + 2) * L + w])
            dx, dy, dz = ends[R + w] - ends[w], ends[R + L + w] - ends[L + w], ends[R + 2 * L + w] - ends[2 * L + w]
            length = math.sqrt(dx * dx + dy * dy + dz * dz) + TINY
            longer = dx * (rx - room[4 * L + w]) + dy * (ry - room[5 * L + w]) + dz * (rz - room[6 * L + w])
            slope = line[LINEAR * L + w] / (piece * length) if out[NEW * L + w] > 0.0 else 0.0
            a, b, c, d, now = room[w], room[L + w], room[2 * L + w], room[3 * L + w], slope * longer
            pull = abs(a + now + 4.0 * (b + d) + 6.0 * c) / 16.0
            place = math.sqrt(rx * rx + ry * ry + rz * rz)
            room[w], room[L + w], room[2 * L + w], room[3 * L + w] = b, c, d, now
            room[4 * L + w], room[5 * L + w], room[6 * L + w] = rx, ry, rz
            most, furthest = room[PULL_DEFECT * L + w], room[PLACE_DEFECT * L + w]
            room[PULL_DEFECT * L + w] = pull if pull > most else most
            room[PLACE_DEFECT * L + w] = place if place > furthest else furthest
