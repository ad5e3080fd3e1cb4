"""Explicit steps of many lines side by side, each with its own length of step, and how long a step may be.

Leapfrog is the velocity form of Stoermer's and Verlet's method: forces that depend on velocity get the velocity that
the last acceleration leads to, which is corrected when the new one is known. That costs no order, and with a force
-lambda v beside a frequency omega it is stable for omega^2 h^2 + 4 lambda h < 4.

The Runge-Kutta method is the classical one of fourth order. The evaluation at a step's end is the first of the next.

Nodes have PLACE, VELOCITY and ACCELERATION of the last evaluation, OLD_... those of the step's beginning.
"""

import math

from cablesim.numerics.compiled import compiled
from cablesim.numerics.lanes import LANES
from cablesim.physics.nodal_line import (
    ACCELERATION,
    ADDED_TANGENT,
    DAMPING,
    LINEAR,
    MASS,
    NODE_ROWS,
    NORMAL_DRAG,
    OTHER_SHARE,
    PIECE,
    PLACE,
    QUADRATIC,
    TANGENT_DRAG,
    VELOCITY,
)
from cablesim.solvers._wave_forces import ACROSS, ALONG, STRAIN
from cablesim.solvers._wave_pack import (
    OLD_ACCELERATION,
    OLD_PLACE,
    OLD_SHIFTED,
    OLD_VELOCITY,
    START_SHIFTED,
    STEP,
)

# The classical Runge-Kutta method is stable wherever |lambda h| is less, for all lambda that do not grow.
RUNGE_KUTTA_LIMIT = 2.6
# Sums of accelerations and of velocities over the stages.
SUM_ACCELERATION, SUM_VELOCITY = START_SHIFTED, OLD_SHIFTED


@compiled
def find_limits(line, found, limits, is_leapfrog, width):
    """The longest stable step of each lane, for the strain, the drag and the damping that it has now.

    The highest frequency is that of neighbours moving against each other along the line, where only the mass counts
    that added mass has no part in; where a law softens, it may be as stiff as without strain. In that motion, a
    consistent mass is a third of the lumped one.
    """
    L = LANES
    for w in range(width):
        h, all_mass = line[PIECE * L + w], line[MASS * L + w]
        mass = all_mass - line[ADDED_TANGENT * L + w]
        linear, quadratic, strain = line[LINEAR * L + w], line[QUADRATIC * L + w], found[STRAIN * L + w]
        stiffer = 2.0 * quadratic * strain if (quadratic > 0.0) & (strain > 0.0) else 0.0
        per_mass = (12.0 if line[OTHER_SHARE * L + w] > 0.0 else 4.0) / (mass * h * h)
        square, slowed = per_mass * (linear + stiffer), per_mass * line[DAMPING * L + w]
        across = line[NORMAL_DRAG * L + w] * found[ACROSS * L + w] / all_mass
        along = line[TANGENT_DRAG * L + w] * found[ALONG * L + w] / mass
        slowed += 2.0 * (across if across > along else along)
        if is_leapfrog:
            limits[w] = 2.0 / (slowed + math.sqrt(slowed * slowed + square))
        else:
            half = 0.5 * slowed
            excess = half * half - square
            fastest = half + math.sqrt(excess) if excess > 0.0 else math.sqrt(square)
            limits[w] = RUNGE_KUTTA_LIMIT / fastest


@compiled
def leap(nodes, method, last, count, width):
    """The inner nodes' places at the end of the step, and the velocities that their accelerations lead to.

    `last` (lane) is the length of the last step, whose velocities are corrected first.
    """
    L = LANES
    for j in range(1, count):
        node = nodes[NODE_ROWS * L * j : NODE_ROWS * L * (j + 1)]
        for k in range(3):
            own = node[k * L :]
            for w in range(width):
                h, a, old = method[STEP * L + w], own[ACCELERATION * L + w], own[OLD_ACCELERATION * L + w]
                x, v = own[PLACE * L + w], own[VELOCITY * L + w] + 0.5 * last[w] * (a - old)
                own[OLD_PLACE * L + w], own[OLD_VELOCITY * L + w], own[OLD_ACCELERATION * L + w] = x, v, a
                own[PLACE * L + w], own[VELOCITY * L + w] = x + h * (v + 0.5 * h * a), v + h * a


@compiled
def correct_velocities(nodes, w, last, count):
    """Velocities of one lane as they are after its last step of leapfrog."""
    for j in range(1, count):
        node = nodes[NODE_ROWS * LANES * j : NODE_ROWS * LANES * (j + 1)]
        for k in range(3):
            change = node[(ACCELERATION + k) * LANES + w] - node[(OLD_ACCELERATION + k) * LANES + w]
            node[(VELOCITY + k) * LANES + w] += 0.5 * last * change
            node[(OLD_ACCELERATION + k) * LANES + w] = node[(ACCELERATION + k) * LANES + w]


@compiled
def begin_stages(nodes, method, count, width):
    """From the beginning of the step, half a step on."""
    L = LANES
    for j in range(1, count):
        node = nodes[NODE_ROWS * L * j : NODE_ROWS * L * (j + 1)]
        for k in range(3):
            own = node[k * L :]
            for w in range(width):
                half = 0.5 * method[STEP * L + w]
                x, v, a = own[PLACE * L + w], own[VELOCITY * L + w], own[ACCELERATION * L + w]
                own[OLD_PLACE * L + w], own[OLD_VELOCITY * L + w], own[OLD_ACCELERATION * L + w] = x, v, a
                own[SUM_VELOCITY * L + w], own[SUM_ACCELERATION * L + w] = v, a
                own[PLACE * L + w], own[VELOCITY * L + w] = x + half * v, v + half * a


@compiled
def next_stage(nodes, method, share, count, width):
    """From the beginning of the step, a share of it on, with velocity and acceleration of this stage."""
    L = LANES
    for j in range(1, count):
        node = nodes[NODE_ROWS * L * j : NODE_ROWS * L * (j + 1)]
        for k in range(3):
            own = node[k * L :]
            for w in range(width):
                part = share * method[STEP * L + w]
                v, a = own[VELOCITY * L + w], own[ACCELERATION * L + w]
                own[SUM_VELOCITY * L + w] += 2.0 * v
                own[SUM_ACCELERATION * L + w] += 2.0 * a
                own[PLACE * L + w] = own[OLD_PLACE * L + w] + part * v
                own[VELOCITY * L + w] = own[OLD_VELOCITY * L + w] + part * a


@compiled
def end_stages(nodes, method, count, width):
    """The end of the step."""
    L = LANES
    for j in range(1, count):
        node = nodes[NODE_ROWS * L * j : NODE_ROWS * L * (j + 1)]
        for k in range(3):
            own = node[k * L :]
            for w in range(width):
                sixth = method[STEP * L + w] / 6.0
                v, a = own[VELOCITY * L + w], own[ACCELERATION * L + w]
                own[PLACE * L + w] = own[OLD_PLACE * L + w] + sixth * (own[SUM_VELOCITY * L + w] + v)
                own[VELOCITY * L + w] = own[OLD_VELOCITY * L + w] + sixth * (own[SUM_ACCELERATION * L + w] + a)
