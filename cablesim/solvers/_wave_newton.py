"""Newton's method for one step of many lines side by side.

It ends where the next correction of any tension or place would be a small part of the tolerance, by the rate at which
corrections shrink, and no element passed through zero tension in the last one. Of each lane everything is kept as it
was when that lane had converged, so that no lane sees the others.

Tensions are iterated beside the places: an element is tight where the last correction left it so, and resists turning
by the tension that this led to, not by what its length of the moment would say. That makes lines converge in a few
iterations that are so stiff that every step passes through lengths they could not have.

Reference: D. Magisano, L. Leonetti, G. Garcea, Comput. Methods Appl. Mech. Eng. 313 (2017) 986.
"""

import math

from cablesim.numerics.compiled import compiled
from cablesim.numerics.lanes import LANES
from cablesim.physics.nodal_line import (
    ACCELERATION,
    CHANGE,
    ELEMENT_ROWS,
    LEFT,
    NODE_ROWS,
    OTHER,
    PIECE,
    PLACE,
    POWER,
    RIGHT,
    SLOPE,
    STRAIN,
    TANGENT,
    TINY,
    UNBOUND,
    VELOCITY,
    assemble,
    solve_inner,
)
from cablesim.solvers._wave_pack import (
    ACCELERATION_BY_PLACE,
    ACTIVE,
    ALL_MOVES,
    ANCHOR_NOW,
    CONVERGED,
    CORRECTION,
    EVALUATIONS,
    LARGEST_MISS,
    LARGEST_MOVE,
    LARGEST_SHIFT,
    MIDDLE_NOW,
    NEW,
    NEW_STRAIN,
    PAST1,
    PLACE_NEW,
    PLACE_SCALE,
    POWER_IN,
    POWER_NOW,
    POWER_TURNED,
    SHIFTED,
    TENSION_SCALE,
    TOP_NOW,
    VELOCITY_BY_PLACE,
)
from cablesim.solvers._wave_step import extrapolated, find_fluid

MOST_ITERATIONS = 16
# What the next correction may still be, in tolerances; a correction so many times the last one, and beyond the
# tolerance, is the end.
LEFT_OVER = 0.3
DIVERGES = 10.0
# Tensions start from a parabola through the last three, at most so many times the last one or that part of it.
MOST_CHANGE = 5.0


@compiled
def iterate(pack, has_waves, rtol, count, width):
    """Newton's method, until it has ended in all lanes."""
    start(pack.elements, pack.method, count, width)
    for _ in range(MOST_ITERATIONS):
        if has_waves:
            find_fluid(pack, count, width)
        assemble(pack.nodes, pack.fluid, pack.line, pack.method, pack.elements, count, width)
        solve_inner(pack.elements, pack.nodes, pack.carry, count, width)
        for row in (LARGEST_SHIFT, LARGEST_MISS, LARGEST_MOVE, ALL_MOVES):
            pack.lane[row * LANES : (row + 1) * LANES] = 0.0
        clear_power(pack.lane, pack.method, width)
        measure(pack.nodes, pack.elements, pack.line, pack.method, pack.lane, count, width)
        move(pack.nodes, pack.method, pack.lane, count, width)
        busy = False
        for w in range(width):
            if pack.method[ACTIVE * LANES + w] > 0.0:
                settle(pack, w, rtol, count)
                busy |= pack.method[ACTIVE * LANES + w] > 0.0
        if not busy:
            return


@compiled
def start(elements, method, count, width):
    """Tensions to begin with; elements that are slack are taken to stay so."""
    L = LANES
    for e in range(count):
        own = elements[ELEMENT_ROWS * L * e : ELEMENT_ROWS * L * (e + 1)]
        for w in range(width):
            last = own[PAST1 * L + w]
            found = extrapolated(own, method, w)
            own[NEW * L + w] = min(max(found, last / MOST_CHANGE), MOST_CHANGE * last)


@compiled
def clear_power(lane, method, width):
    for w in range(width):
        if method[ACTIVE * LANES + w] > 0.0:
            lane[POWER_IN * LANES + w] = 0.0


@compiled
def measure(nodes, elements, line, method, lane, count, width):
    """Tensions and strains after the correction, the largest correction, and the largest pass through zero."""
    L, R = LANES, NODE_ROWS * LANES
    for e in range(count):
        ends = nodes[R * e : R * (e + 2)]
        own = elements[ELEMENT_ROWS * L * e : ELEMENT_ROWS * L * (e + 1)]
        for w in range(width):
            dx = ends[R + CHANGE * L + w] - ends[CHANGE * L + w]
            dy = ends[R + (CHANGE + 1) * L + w] - ends[(CHANGE + 1) * L + w]
            dz = ends[R + (CHANGE + 2) * L + w] - ends[(CHANGE + 2) * L + w]
            longer = own[TANGENT * L + w] * dx + own[(TANGENT + 1) * L + w] * dy + own[(TANGENT + 2) * L + w] * dz
            across = dx * dx + dy * dy + dz * dz - longer * longer
            unbound, strain = own[UNBOUND * L + w], own[STRAIN * L + w]
            found = unbound + own[SLOPE * L + w] * longer
            is_tight = own[NEW * L + w] > 0.0
            pull, kept = unbound if is_tight else 0.0, found if found > 0.0 else 0.0
            # What the correction stretches the element by at second order, by moving its ends across it.
            turned = own[SLOPE * L + w] * across / (2.0 * line[PIECE * L + w] * (1.0 + strain)) if found > 0.0 else 0.0
            miss = kept - found if is_tight else kept
            miss = turned if turned > miss else miss
            shift = abs(kept - pull)
            is_active = method[ACTIVE * L + w] > 0.0
            own[NEW * L + w] = kept if is_active else own[NEW * L + w]
            own[NEW_STRAIN * L + w] = strain + longer / line[PIECE * L + w] if is_active else own[NEW_STRAIN * L + w]
            lane[LARGEST_SHIFT * L + w] = shift if shift > lane[LARGEST_SHIFT * L + w] else lane[LARGEST_SHIFT * L + w]
            lane[LARGEST_MISS * L + w] = miss if miss > lane[LARGEST_MISS * L + w] else lane[LARGEST_MISS * L + w]
            lane[POWER_IN * L + w] += own[POWER * L + w] if is_active else 0.0


@compiled
def move(nodes, method, lane, count, width):
    """Correct the inner nodes of the lanes that are not done."""
    L = LANES
    for j in range(1, count):
        node = nodes[NODE_ROWS * L * j : NODE_ROWS * L * (j + 1)]
        for k in range(3):
            own = node[k * L :]
            for w in range(width):
                change = own[CHANGE * L + w] if method[ACTIVE * L + w] > 0.0 else 0.0
                own[PLACE * L + w] += change
                own[VELOCITY * L + w] += method[VELOCITY_BY_PLACE * L + w] * change
                own[ACCELERATION * L + w] += method[ACCELERATION_BY_PLACE * L + w] * change
                own[SHIFTED * L + w] += change / method[PLACE_NEW * L + w]
                size = abs(change)
                lane[ALL_MOVES * L + w] += size
                lane[LARGEST_MOVE * L + w] = size if size > lane[LARGEST_MOVE * L + w] else lane[LARGEST_MOVE * L + w]


@compiled
def settle(pack, w, rtol, count):
    """Decide whether Newton's method has ended in a lane; if it converged, keep the forces on its ends."""
    lane = pack.lane
    lane[EVALUATIONS * LANES + w] += 1.0
    scale = rtol * lane[TENSION_SCALE * LANES + w]
    size = max(
        lane[LARGEST_SHIFT * LANES + w] / scale, lane[LARGEST_MOVE * LANES + w] / (rtol * lane[PLACE_SCALE * LANES + w])
    )
    last = lane[CORRECTION * LANES + w]
    # By how much corrections shrink is not known after the first one.
    shrinks = size / (last + TINY) if last >= 0.0 else 1.0
    lane[CORRECTION * LANES + w] = size
    if not math.isfinite(lane[ALL_MOVES * LANES + w]) or (shrinks > DIVERGES and size > 1.0):
        pack.method[ACTIVE * LANES + w] = 0.0
    elif shrinks * size <= LEFT_OVER and lane[LARGEST_MISS * LANES + w] <= LEFT_OVER * scale:
        pack.method[ACTIVE * LANES + w] = 0.0
        lane[CONVERGED * LANES + w] = 1.0
        keep_forces(pack, w, count)


@compiled
def keep_forces(pack, w, count):
    """Forces of the supports on the end nodes, the tension in the middle and the power of all that has no potential."""
    L, R, E = LANES, NODE_ROWS * LANES, ELEMENT_ROWS * LANES
    first, last = pack.elements[:E], pack.elements[E * (count - 1) : E * count]
    inner, outer, top = pack.nodes[R : 2 * R], pack.nodes[R * (count - 1) : R * count], pack.nodes[R * count :]
    anchor, pull, given, power = 0.0, 0.0, 0.0, pack.lane[POWER_IN * L + w]
    for k in range(3):
        force = first[(LEFT + k) * L + w] - coupled(first, inner, k, w)
        anchor += force * force
        force = last[(RIGHT + k) * L + w] - coupled(last, outer, k, w)
        pull += force * force
        given -= force * top[(VELOCITY + k) * L + w]
    before, after = pack.elements[E * ((count - 1) // 2) :], pack.elements[E * (count // 2) :]
    pack.lane[ANCHOR_NOW * L + w], pack.lane[TOP_NOW * L + w] = math.sqrt(anchor), math.sqrt(pull)
    pack.lane[MIDDLE_NOW * L + w] = 0.5 * (before[NEW * L + w] + after[NEW * L + w])
    pack.lane[POWER_NOW * L + w], pack.lane[POWER_TURNED * L + w] = power + given, abs(power) + abs(given)


@compiled
def coupled(element, node, k, w):
    """A component of the force that the last correction of a node took from the other end of its element."""
    rows = (0, 1, 2) if k == 0 else ((1, 3, 4) if k == 1 else (2, 4, 5))
    total = 0.0
    for i in range(3):
        total += element[(OTHER + rows[i]) * LANES + w] * node[(CHANGE + i) * LANES + w]
    return total
