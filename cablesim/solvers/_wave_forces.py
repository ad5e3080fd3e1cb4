"""Accelerations of lines side by side from their places and velocities, for integrators that solve no equations.

The formulas are those of `physics.nodal_line`. With lumped mass, the mass of a node is m 1 - c (t t' + s s') with the
directions t and s of its two elements, c being what added mass does not resist along them, and is inverted at once;
with consistent mass elimination does it.
"""

import math

from cablesim.numerics.compiled import compiled
from cablesim.numerics.lanes import LANES
from cablesim.physics.nodal_line import (
    ACCELERATION,
    ADDED,
    ADDED_TANGENT,
    CHANGE,
    DAMPING,
    DISPLACED,
    ELEMENT_ROWS,
    LEFT,
    LINEAR,
    MASS,
    NODE_ROWS,
    NORMAL_DRAG,
    OTHER,
    OTHER_SHARE,
    OWN,
    OWN_SHARE,
    PIECE,
    QUADRATIC,
    RIGHT,
    TANGENT,
    TANGENT_DRAG,
    TINY,
    VELOCITY,
    WEIGHT,
    drag,
    solve_inner,
    tension,
)
from cablesim.solvers._wave_pack import NEW, NEW_STRAIN

# What an evaluation finds out about each lane: power of the forces that have no potential, largest strain, and the
# fastest flow across and along it, and the least tension.
POWER, STRAIN, ACROSS, ALONG, LOOSEST = range(5)
FOUND_ROWS = 5


@compiled
def accelerate(nodes, fluid, line, elements, carry, found, is_lumped, count, width):
    """Accelerations of the inner nodes; `carry` (9, lane) is room to work in, `found` (FOUND_ROWS, lane) is written.

    Elements get tension and strain, the first and the last one also the force on the end of the line, as `LEFT` and
    `RIGHT`.
    """
    found[:] = 0.0
    found[STRAIN * LANES : (STRAIN + 1) * LANES] = -1.0
    found[LOOSEST * LANES : (LOOSEST + 1) * LANES] = math.inf
    if is_lumped:
        accelerate_lumped(nodes, fluid, line, elements, carry, found, count, width)
    else:
        load_elements(nodes, fluid, line, elements, found, count, width)
        solve_inner(elements, nodes, carry, count, width)
        take_accelerations(nodes, elements, line, found, count, width)


@compiled
def accelerate_lumped(nodes, fluid, line, elements, carry, found, count, width):
    """A node's acceleration is known as soon as its right element's forces are."""
    L, R, E = LANES, NODE_ROWS * LANES, ELEMENT_ROWS * LANES
    for w in range(width):
        for row in range(6):
            carry[row * L + w] = 0.0
        carry[6 * L + w] = 1.0 / line[PIECE * L + w]
        carry[7 * L + w] = 1.0 / (line[PIECE * L + w] * line[MASS * L + w])
    for e in range(count):
        ends = nodes[R * e : R * (e + 2)]
        flow, out = fluid[6 * L * e : 6 * L * (e + 1)], elements[E * e : E * (e + 1)]
        for w in range(width):
            h, per_piece, per_mass = line[PIECE * L + w], carry[6 * L + w], carry[7 * L + w]
            dx, dy, dz = (
                ends[R + w] - ends[w],
                ends[R + L + w] - ends[L + w],
                ends[R + 2 * L + w] - ends[2 * L + w],
            )
            length = math.sqrt(dx * dx + dy * dy + dz * dz)
            inverse = 1.0 / (length + TINY)
            tx, ty, tz = dx * inverse, dy * inverse, dz * inverse
            lx, ly, lz = ends[VELOCITY * L + w], ends[(VELOCITY + 1) * L + w], ends[(VELOCITY + 2) * L + w]
            rx, ry, rz = ends[R + VELOCITY * L + w], ends[R + (VELOCITY + 1) * L + w], ends[R + (VELOCITY + 2) * L + w]
            strain = length * per_piece - 1.0
            rate = tx * (rx - lx) + ty * (ry - ly) + tz * (rz - lz)
            pull, _, viscous, _ = tension(
                strain, rate, line[LINEAR * L + w], line[QUADRATIC * L + w], line[DAMPING * L + w], h, 0.0
            )
            mx, my, mz = 0.5 * (lx + rx), 0.5 * (ly + ry), 0.5 * (lz + rz)
            px, py, pz, _, _, _, across, along = drag(
                flow[w] - mx,
                flow[L + w] - my,
                flow[2 * L + w] - mz,
                tx,
                ty,
                tz,
                h * line[NORMAL_DRAG * L + w],
                h * line[TANGENT_DRAG * L + w],
            )
            gx, gy, gz = flow[3 * L + w], flow[4 * L + w], flow[5 * L + w]
            carried = h * (line[DISPLACED * L + w] + line[ADDED * L + w])
            lost = h * line[ADDED_TANGENT * L + w]
            swept = lost * (gx * tx + gy * ty + gz * tz)
            px, py, pz = px + carried * gx - swept * tx, py + carried * gy - swept * ty, pz + carried * gz - swept * tz
            half_weight = 0.5 * h * line[WEIGHT * L + w]

            # the left node: what is carried over is its left element's force on it, and that one's direction
            fx = carry[w] + pull * tx + 0.5 * px
            fy = carry[L + w] + pull * ty + 0.5 * py
            fz = carry[2 * L + w] + pull * tz + 0.5 * pz - half_weight
            sx, sy, sz = carry[3 * L + w], carry[4 * L + w], carry[5 * L + w]
            carry[w] = 0.5 * px - pull * tx
            carry[L + w] = 0.5 * py - pull * ty
            carry[2 * L + w] = 0.5 * pz - pull * tz - half_weight
            carry[3 * L + w], carry[4 * L + w], carry[5 * L + w] = tx, ty, tz
            whole, less = h * line[MASS * L + w], 0.5 * lost
            cross, diagonal = less * (tx * sx + ty * sy + tz * sz), whole - less
            ft, fs = fx * tx + fy * ty + fz * tz, fx * sx + fy * sy + fz * sz
            share = less * per_mass / (diagonal * diagonal - cross * cross)
            by_t, by_s = share * (diagonal * ft + cross * fs), share * (diagonal * fs + cross * ft)
            ax, ay, az = (
                fx * per_mass + by_t * tx + by_s * sx,
                fy * per_mass + by_t * ty + by_s * sy,
                fz * per_mass + by_t * tz + by_s * sz,
            )
            ends[ACCELERATION * L + w] = ax
            ends[(ACCELERATION + 1) * L + w] = ay
            ends[(ACCELERATION + 2) * L + w] = az
            ends[CHANGE * L + w], ends[(CHANGE + 1) * L + w], ends[(CHANGE + 2) * L + w] = fx, fy, fz
            out[NEW * L + w], out[NEW_STRAIN * L + w] = pull, strain

            # power, with the added mass of the node
            at, as_ = ax * tx + ay * ty + az * tz, ax * sx + ay * sy + az * sz
            vt, vs = lx * tx + ly * ty + lz * tz, lx * sx + ly * sy + lz * sz
            inert = h * line[ADDED * L + w] * (lx * ax + ly * ay + lz * az) - less * (at * vt + as_ * vs)
            found[POWER * L + w] += px * mx + py * my + pz * mz - viscous * rate - inert
            found[STRAIN * L + w] = strain if strain > found[STRAIN * L + w] else found[STRAIN * L + w]
            found[ACROSS * L + w] = across if across > found[ACROSS * L + w] else found[ACROSS * L + w]
            found[ALONG * L + w] = along if along > found[ALONG * L + w] else found[ALONG * L + w]
            found[LOOSEST * L + w] = pull if pull < found[LOOSEST * L + w] else found[LOOSEST * L + w]
    end_lumped(nodes, elements, line, carry, found, count, width)


@compiled
def end_lumped(nodes, elements, line, carry, found, count, width):
    """Forces on the ends of the line less the inertia of what is lumped there; the anchor does not move."""
    L, R, E = LANES, NODE_ROWS * LANES, ELEMENT_ROWS * LANES
    first, last = elements[:E], elements[E * (count - 1) : E * count]
    anchor, top = nodes[:R], nodes[R * count : R * (count + 1)]
    for w in range(width):
        half, less = 0.5 * line[PIECE * L + w], 0.5 * line[PIECE * L + w] * line[ADDED_TANGENT * L + w]
        ax, ay, az = top[ACCELERATION * L + w], top[(ACCELERATION + 1) * L + w], top[(ACCELERATION + 2) * L + w]
        vx, vy, vz = top[VELOCITY * L + w], top[(VELOCITY + 1) * L + w], top[(VELOCITY + 2) * L + w]
        tx, ty, tz = carry[3 * L + w], carry[4 * L + w], carry[5 * L + w]
        mass, along = half * line[MASS * L + w], less * (ax * tx + ay * ty + az * tz)
        last[RIGHT * L + w] = carry[w] - mass * ax + along * tx
        last[(RIGHT + 1) * L + w] = carry[L + w] - mass * ay + along * ty
        last[(RIGHT + 2) * L + w] = carry[2 * L + w] - mass * az + along * tz
        inert = half * line[ADDED * L + w] * (ax * vx + ay * vy + az * vz) - along * (tx * vx + ty * vy + tz * vz)
        found[POWER * L + w] -= inert
    for k in range(3):
        for w in range(width):
            first[(LEFT + k) * L + w] = anchor[(CHANGE + k) * L + w]
            anchor[(ACCELERATION + k) * L + w] = 0.0


@compiled
def load_elements(nodes, fluid, line, elements, found, count, width):
    """Forces and masses of the elements, as `solve_inner` wants them: its change is the acceleration.

    The last element's right node has an acceleration, which is given; of all others it is taken as zero.
    """
    L, R, E = LANES, NODE_ROWS * LANES, ELEMENT_ROWS * LANES
    for e in range(count):
        ends = nodes[R * e : R * (e + 2)]
        flow, out = fluid[6 * L * e : 6 * L * (e + 1)], elements[E * e : E * (e + 1)]
        is_last = 1.0 if e == count - 1 else 0.0
        for w in range(width):
            h = line[PIECE * L + w]
            dx, dy, dz = (
                ends[R + w] - ends[w],
                ends[R + L + w] - ends[L + w],
                ends[R + 2 * L + w] - ends[2 * L + w],
            )
            length = math.sqrt(dx * dx + dy * dy + dz * dz)
            inverse = 1.0 / (length + TINY)
            tx, ty, tz = dx * inverse, dy * inverse, dz * inverse
            lx, ly, lz = ends[VELOCITY * L + w], ends[(VELOCITY + 1) * L + w], ends[(VELOCITY + 2) * L + w]
            rx, ry, rz = ends[R + VELOCITY * L + w], ends[R + (VELOCITY + 1) * L + w], ends[R + (VELOCITY + 2) * L + w]
            strain = length / h - 1.0
            rate = tx * (rx - lx) + ty * (ry - ly) + tz * (rz - lz)
            pull, _, viscous, _ = tension(
                strain, rate, line[LINEAR * L + w], line[QUADRATIC * L + w], line[DAMPING * L + w], h, 0.0
            )
            mx, my, mz = 0.5 * (lx + rx), 0.5 * (ly + ry), 0.5 * (lz + rz)
            px, py, pz, _, _, _, across, along = drag(
                flow[w] - mx,
                flow[L + w] - my,
                flow[2 * L + w] - mz,
                tx,
                ty,
                tz,
                h * line[NORMAL_DRAG * L + w],
                h * line[TANGENT_DRAG * L + w],
            )
            gx, gy, gz = flow[3 * L + w], flow[4 * L + w], flow[5 * L + w]
            carried = h * (line[DISPLACED * L + w] + line[ADDED * L + w])
            lost = h * line[ADDED_TANGENT * L + w]
            swept = lost * (gx * tx + gy * ty + gz * tz)
            px, py, pz = px + carried * gx - swept * tx, py + carried * gy - swept * ty, pz + carried * gz - swept * tz

            ax, ay, az = (
                is_last * ends[R + ACCELERATION * L + w],
                is_last * ends[R + (ACCELERATION + 1) * L + w],
                is_last * ends[R + (ACCELERATION + 2) * L + w],
            )
            own, other = line[OWN_SHARE * L + w], line[OTHER_SHARE * L + w]
            whole, along_it = h * line[MASS * L + w], lost * (ax * tx + ay * ty + az * tz)
            qx, qy, qz = whole * ax - along_it * tx, whole * ay - along_it * ty, whole * az - along_it * tz
            half_weight = 0.5 * h * line[WEIGHT * L + w]
            out[LEFT * L + w] = pull * tx + 0.5 * px - other * qx
            out[(LEFT + 1) * L + w] = pull * ty + 0.5 * py - other * qy
            out[(LEFT + 2) * L + w] = pull * tz + 0.5 * pz - other * qz - half_weight
            out[RIGHT * L + w] = -pull * tx + 0.5 * px - own * qx
            out[(RIGHT + 1) * L + w] = -pull * ty + 0.5 * py - own * qy
            out[(RIGHT + 2) * L + w] = -pull * tz + 0.5 * pz - own * qz - half_weight
            out[OWN * L + w] = own * (whole - lost * tx * tx)
            out[(OWN + 1) * L + w] = -own * lost * tx * ty
            out[(OWN + 2) * L + w] = -own * lost * tx * tz
            out[(OWN + 3) * L + w] = own * (whole - lost * ty * ty)
            out[(OWN + 4) * L + w] = -own * lost * ty * tz
            out[(OWN + 5) * L + w] = own * (whole - lost * tz * tz)
            out[OTHER * L + w] = other * (whole - lost * tx * tx)
            out[(OTHER + 1) * L + w] = -other * lost * tx * ty
            out[(OTHER + 2) * L + w] = -other * lost * tx * tz
            out[(OTHER + 3) * L + w] = other * (whole - lost * ty * ty)
            out[(OTHER + 4) * L + w] = -other * lost * ty * tz
            out[(OTHER + 5) * L + w] = other * (whole - lost * tz * tz)
            out[TANGENT * L + w], out[(TANGENT + 1) * L + w], out[(TANGENT + 2) * L + w] = tx, ty, tz
            out[NEW * L + w], out[NEW_STRAIN * L + w] = pull, strain
            found[POWER * L + w] += px * mx + py * my + pz * mz - viscous * rate
            found[STRAIN * L + w] = strain if strain > found[STRAIN * L + w] else found[STRAIN * L + w]
            found[ACROSS * L + w] = across if across > found[ACROSS * L + w] else found[ACROSS * L + w]
            found[ALONG * L + w] = along if along > found[ALONG * L + w] else found[ALONG * L + w]
            found[LOOSEST * L + w] = pull if pull < found[LOOSEST * L + w] else found[LOOSEST * L + w]


@compiled
def take_accelerations(nodes, elements, line, found, count, width):
    """Accelerations of the inner nodes from where `solve_inner` left them, and the power of the added mass."""
    L, R, E = LANES, NODE_ROWS * LANES, ELEMENT_ROWS * LANES
    for j in range(1, count):
        node = nodes[R * j : R * (j + 1)]
        for k in range(3):
            for w in range(width):
                node[(ACCELERATION + k) * L + w] = node[(CHANGE + k) * L + w]
    for e in range(count):
        ends, out = nodes[R * e : R * (e + 2)], elements[E * e : E * (e + 1)]
        for w in range(width):
            h, own, other = line[PIECE * L + w], line[OWN_SHARE * L + w], line[OTHER_SHARE * L + w]
            ax, ay, az = ends[ACCELERATION * L + w], ends[(ACCELERATION + 1) * L + w], ends[(ACCELERATION + 2) * L + w]
            bx, by, bz = (
                ends[R + ACCELERATION * L + w],
                ends[R + (ACCELERATION + 1) * L + w],
                ends[R + (ACCELERATION + 2) * L + w],
            )
            lx, ly, lz = ends[VELOCITY * L + w], ends[(VELOCITY + 1) * L + w], ends[(VELOCITY + 2) * L + w]
            rx, ry, rz = ends[R + VELOCITY * L + w], ends[R + (VELOCITY + 1) * L + w], ends[R + (VELOCITY + 2) * L + w]
            tx, ty, tz = out[TANGENT * L + w], out[(TANGENT + 1) * L + w], out[(TANGENT + 2) * L + w]
            la, lb = lx * ax + ly * ay + lz * az, lx * bx + ly * by + lz * bz
            ra, rb = rx * ax + ry * ay + rz * az, rx * bx + ry * by + rz * bz
            lt, rt = lx * tx + ly * ty + lz * tz, rx * tx + ry * ty + rz * tz
            at, bt = ax * tx + ay * ty + az * tz, bx * tx + by * ty + bz * tz
            full = own * (la + rb) + other * (lb + ra)
            lost = own * (lt * at + rt * bt) + other * (lt * bt + rt * at)
            found[POWER * L + w] -= h * (line[ADDED * L + w] * full - line[ADDED_TANGENT * L + w] * lost)
