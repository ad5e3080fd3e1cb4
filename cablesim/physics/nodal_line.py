"""A line of straight elements between nodes: the forces on it, and how they change with its motion.

Element e joins the nodes e and e + 1. With d the vector between them, t = d/|d| and the strain eps = |d|/h - 1,

    T = (C_eps eps + C_eps1 eps^2 + c d(eps)/dt) H(eps), never below 0                              (M15)
    M a = +-T t + h/2 [ (m - rho F) g + C_n |u_n| u_n + C_t |u_t| u_t + (rho F + C_a P) a_f ]         (M16)

where u is the velocity and a_f the acceleration of the fluid at the middle of the element, u relative to the line, u_t
its part along t and u_n across it, P = 1 - t t' (or 1, if the added mass is isotropic). The part of T with c is at most
as large as the rest of it, so that T is continuous where an element tightens. The mass matrix of an element is
h (m + C_a P) times [[1/3, 1/6], [1/6, 1/3]] (consistent) or [[1/2, 0], [0, 1/2]] (lumped).

Everything is done for `width` lines side by side (see `numerics.lanes`); all arrays are flat, with a last index LANES
long that is the lane.
"""

import math

from cablesim.numerics.compiled import compiled
from cablesim.numerics.lanes import LANES

# What a line is, each a row of one number a lane.
(
    PIECE,  # unstretched length h of an element
    MASS,  # mass per length, with all added mass that does not depend on the direction
    ADDED,  # added mass per length
    ADDED_TANGENT,  # that part of it which the line does not carry along itself
    DISPLACED,  # displaced mass of fluid per length, rho F
    WEIGHT,  # weight less buoyancy per length
    LINEAR,
    QUADRATIC,
    DAMPING,
    NORMAL_DRAG,
    TANGENT_DRAG,
    OWN_SHARE,  # of the mass of an element that a node feels by its own acceleration: 1/3 or 1/2
    OTHER_SHARE,  # ... by that of the element's other node: 1/6 or 0
) = range(13)
LINE_ROWS = 13

# What is known of an element after `assemble`. Symmetric 3 x 3 blocks are xx, xy, xz, yy, yz, zz.
OWN = 0  # derivative of what is left over at a node by its own place
OTHER = 6  # ... by the place of the other node
LEFT = 12  # force less inertia at the left node
RIGHT = 15
TANGENT = 18
UNBOUND = 21  # tension, below zero where the element is slack: what it would be if it were stiff there
SLOPE = 22  # of the tension by the element's length, where it is taut
STRAIN = 23
POWER = 24  # of all forces that have no potential but internal damping
HELD = 25  # given: the tension as last corrected; zero where that leaves the element slack

# Rows of an element from here on belong to whoever marches the line.
FREE_ELEMENT = 26
ELEMENT_ROWS = 37

# What is known of a node, each three rows, and what elimination leaves of it: D^-1 B by rows, and D^-1 r.
PLACE = 0
VELOCITY = 3
ACCELERATION = 6
CHANGE = 9
FACTORED = 12
FREE_NODE = 24
NODE_ROWS = 42
TINY = 1e-300


@compiled
def tension(strain, rate, linear, quadratic, damping, piece, rate_factor):
    """Tension; its derivative by the element's length, if it is taut; the part of it that damping has; and the tension
    that the law goes on to where it is slack, which is below zero there.
    """
    law = (linear + quadratic * strain) * strain
    viscous = damping * rate / piece
    stiffness = (linear + 2.0 * quadratic * max(strain, 0.0)) / piece
    is_bound = (viscous > law) & (viscous > 0.0)
    viscous = law if is_bound else viscous
    slope = 2.0 * stiffness if is_bound else stiffness + rate_factor * damping / piece
    unbound = law + viscous if strain > 0.0 else slope * strain * piece
    found = unbound if unbound > 0.0 else 0.0
    return found, slope, found - (law if strain > 0.0 else 0.0), unbound


@compiled
def drag(ux, uy, uz, tx, ty, tz, normal, tangent):
    """Drag of a flow u on an element of the direction t; the flow across it, and how fast that and the rest are."""
    along = ux * tx + uy * ty + uz * tz
    nx, ny, nz = ux - along * tx, uy - along * ty, uz - along * tz
    across, speed = math.sqrt(nx * nx + ny * ny + nz * nz), abs(along)
    by_n, by_t = normal * across, tangent * speed * along
    return by_n * nx + by_t * tx, by_n * ny + by_t * ty, by_n * nz + by_t * tz, nx, ny, nz, across, speed


@compiled
def assemble(nodes, fluid, line, factors, elements, count, width):
    """Fill `elements` (element, ELEMENT_ROWS, lane) for the places, velocities and accelerations in `nodes`.

    `fluid` (element, 6, lane) is the fluid's velocity and acceleration at the middle of each element; `factors` (2,
    lane) are the derivatives of velocity and of acceleration by place that the integrator implies.

    Which elements are tight, and how much their tension resists turning, is told by `HELD`, as if tensions were unknown
    beside the places; the forces are those of the law. Where a step moves an element across itself, its length alone
    would for a while say any tension, or none.
    """
    L, R = LANES, NODE_ROWS * LANES
    for e in range(count):
        ends = nodes[NODE_ROWS * L * e : NODE_ROWS * L * (e + 2)]
        flow, out = fluid[6 * L * e : 6 * L * (e + 1)], elements[ELEMENT_ROWS * L * e : ELEMENT_ROWS * L * (e + 1)]
        for w in range(width):
            by_v, by_a = factors[w], factors[L + w]
            h = line[PIECE * L + w]
            dx, dy, dz = (
                ends[R + PLACE * L + w] - ends[PLACE * L + w],
                ends[R + (PLACE + 1) * L + w] - ends[(PLACE + 1) * L + w],
                ends[R + (PLACE + 2) * L + w] - ends[(PLACE + 2) * L + w],
            )
            length = math.sqrt(dx * dx + dy * dy + dz * dz)
            inverse = 1.0 / (length + TINY)
            tx, ty, tz = dx * inverse, dy * inverse, dz * inverse
            lx, ly, lz = ends[VELOCITY * L + w], ends[(VELOCITY + 1) * L + w], ends[(VELOCITY + 2) * L + w]
            rx, ry, rz = ends[R + VELOCITY * L + w], ends[R + (VELOCITY + 1) * L + w], ends[R + (VELOCITY + 2) * L + w]
            strain = length / h - 1.0
            rate = tx * (rx - lx) + ty * (ry - ly) + tz * (rz - lz)
            _, slope, _, unbound = tension(
                strain, rate, line[LINEAR * L + w], line[QUADRATIC * L + w], line[DAMPING * L + w], h, by_v
            )
            held = out[HELD * L + w]
            is_tight = held > 0.0
            pull = unbound if is_tight else 0.0

            # drag on the middle of the element, and its derivative by velocity
            mx, my, mz = 0.5 * (lx + rx), 0.5 * (ly + ry), 0.5 * (lz + rz)
            ux, uy, uz = flow[w] - mx, flow[L + w] - my, flow[2 * L + w] - mz
            normal, tangent = h * line[NORMAL_DRAG * L + w], h * line[TANGENT_DRAG * L + w]
            px, py, pz, nx, ny, nz, across, along = drag(ux, uy, uz, tx, ty, tz, normal, tangent)
            edge = 0.25 * by_v * normal / (across + TINY)
            round_ = 0.25 * by_v * normal * across
            axial = 0.5 * by_v * tangent * along - round_

            # what the accelerated fluid does
            gx, gy, gz = flow[3 * L + w], flow[4 * L + w], flow[5 * L + w]
            carried = h * (line[DISPLACED * L + w] + line[ADDED * L + w])
            lost = h * line[ADDED_TANGENT * L + w]
            swept = lost * (gx * tx + gy * ty + gz * tz)
            px += carried * gx - swept * tx
            py += carried * gy - swept * ty
            pz += carried * gz - swept * tz

            # inertia at the left and the right node
            own, other = line[OWN_SHARE * L + w], line[OTHER_SHARE * L + w]
            ax, ay, az = ends[ACCELERATION * L + w], ends[(ACCELERATION + 1) * L + w], ends[(ACCELERATION + 2) * L + w]
            bx, by, bz = (
                ends[R + ACCELERATION * L + w],
                ends[R + (ACCELERATION + 1) * L + w],
                ends[R + (ACCELERATION + 2) * L + w],
            )
            qx, qy, qz = own * ax + other * bx, own * ay + other * by, own * az + other * bz
            sx, sy, sz = other * ax + own * bx, other * ay + own * by, other * az + own * bz
            qt, st = lost * (qx * tx + qy * ty + qz * tz), lost * (sx * tx + sy * ty + sz * tz)
            mass = h * line[MASS * L + w]
            added = h * line[ADDED * L + w]

            half_weight = 0.5 * h * line[WEIGHT * L + w]
            out[LEFT * L + w] = pull * tx + 0.5 * px - mass * qx + qt * tx
            out[(LEFT + 1) * L + w] = pull * ty + 0.5 * py - mass * qy + qt * ty
            out[(LEFT + 2) * L + w] = pull * tz + 0.5 * pz - mass * qz + qt * tz - half_weight
            out[RIGHT * L + w] = -pull * tx + 0.5 * px - mass * sx + st * tx
            out[(RIGHT + 1) * L + w] = -pull * ty + 0.5 * py - mass * sy + st * ty
            out[(RIGHT + 2) * L + w] = -pull * tz + 0.5 * pz - mass * sz + st * tz - half_weight

            # derivatives: inertia and drag act on both nodes alike, tension with opposite signs
            shear = held * inverse
            stiff = (slope if is_tight else 0.0) - shear
            lone, joint = by_a * own, by_a * other
            self_round, pair_round = lone * mass + round_ + shear, joint * mass + round_ - shear
            self_axial, pair_axial = axial - lone * lost + stiff, axial - joint * lost - stiff
            out[OWN * L + w] = self_round + self_axial * tx * tx + edge * nx * nx
            out[(OWN + 1) * L + w] = self_axial * tx * ty + edge * nx * ny
            out[(OWN + 2) * L + w] = self_axial * tx * tz + edge * nx * nz
            out[(OWN + 3) * L + w] = self_round + self_axial * ty * ty + edge * ny * ny
            out[(OWN + 4) * L + w] = self_axial * ty * tz + edge * ny * nz
            out[(OWN + 5) * L + w] = self_round + self_axial * tz * tz + edge * nz * nz
            out[OTHER * L + w] = pair_round + pair_axial * tx * tx + edge * nx * nx
            out[(OTHER + 1) * L + w] = pair_axial * tx * ty + edge * nx * ny
            out[(OTHER + 2) * L + w] = pair_axial * tx * tz + edge * nx * nz
            out[(OTHER + 3) * L + w] = pair_round + pair_axial * ty * ty + edge * ny * ny
            out[(OTHER + 4) * L + w] = pair_axial * ty * tz + edge * ny * nz
            out[(OTHER + 5) * L + w] = pair_round + pair_axial * tz * tz + edge * nz * nz

            out[TANGENT * L + w] = tx
            out[(TANGENT + 1) * L + w] = ty
            out[(TANGENT + 2) * L + w] = tz
            out[UNBOUND * L + w] = unbound
            out[SLOPE * L + w] = slope
            out[STRAIN * L + w] = strain
            left_power = lx * (added * qx - qt * tx) + ly * (added * qy - qt * ty) + lz * (added * qz - qt * tz)
            right_power = rx * (added * sx - st * tx) + ry * (added * sy - st * ty) + rz * (added * sz - st * tz)
            out[POWER * L + w] = px * mx + py * my + pz * mz - left_power - right_power


@compiled
def solve_inner(elements, nodes, carry, count, width):
    """The change of place of the inner nodes that leaves no force over, to first order.

    Elimination from the first to the last inner node, each block by L D L'; then back. The end nodes do not move.
    `carry` (9, lane) is room to work in.
    """
    L, R = LANES, NODE_ROWS * LANES
    for w in range(9 * L):
        carry[w] = 0.0
    for j in range(1, count):
        before, after = ELEMENT_ROWS * L * (j - 1), ELEMENT_ROWS * L * j
        left, right = elements[before:after], elements[after : after + ELEMENT_ROWS * L]
        kept = nodes[R * j + FACTORED * L : R * (j + 1)]
        for w in range(width):
            # the block of this node, and its factors
            xx = left[OWN * L + w] + right[OWN * L + w] - carry[w]
            xy = left[(OWN + 1) * L + w] + right[(OWN + 1) * L + w] - carry[L + w]
            xz = left[(OWN + 2) * L + w] + right[(OWN + 2) * L + w] - carry[2 * L + w]
            yy = left[(OWN + 3) * L + w] + right[(OWN + 3) * L + w] - carry[3 * L + w]
            yz = left[(OWN + 4) * L + w] + right[(OWN + 4) * L + w] - carry[4 * L + w]
            zz = left[(OWN + 5) * L + w] + right[(OWN + 5) * L + w] - carry[5 * L + w]
            d1 = 1.0 / xx
            l21, l31 = xy * d1, xz * d1
            d2 = 1.0 / (yy - l21 * xy)
            l32 = (yz - l31 * xy) * d2
            d3 = 1.0 / (zz - l31 * xz - l32 * (yz - l31 * xy))

            # columns of L^-1 B, and L^-1 r
            bxx, bxy, bxz = (
                right[OTHER * L + w],
                right[(OTHER + 1) * L + w],
                right[(OTHER + 2) * L + w],
            )
            byy, byz, bzz = (
                right[(OTHER + 3) * L + w],
                right[(OTHER + 4) * L + w],
                right[(OTHER + 5) * L + w],
            )
            rx = left[RIGHT * L + w] + right[LEFT * L + w] - carry[6 * L + w]
            ry = left[(RIGHT + 1) * L + w] + right[(LEFT + 1) * L + w] - carry[7 * L + w]
            rz = left[(RIGHT + 2) * L + w] + right[(LEFT + 2) * L + w] - carry[8 * L + w]
            x2, y2, z2 = bxy - l21 * bxx, byy - l21 * bxy, byz - l21 * bxz
            x3, y3, z3 = bxz - l31 * bxx - l32 * x2, byz - l31 * bxy - l32 * y2, bzz - l31 * bxz - l32 * z2
            r2 = ry - l21 * rx
            r3 = rz - l31 * rx - l32 * r2

            # D^-1 of them
            gx1, gy1, gz1, s1 = bxx * d1, bxy * d1, bxz * d1, rx * d1
            gx2, gy2, gz2, s2 = x2 * d2, y2 * d2, z2 * d2, r2 * d2
            gx3, gy3, gz3, s3 = x3 * d3, y3 * d3, z3 * d3, r3 * d3

            # what is left of this node in the next one's block and force
            carry[w] = bxx * gx1 + x2 * gx2 + x3 * gx3
            carry[L + w] = bxx * gy1 + x2 * gy2 + x3 * gy3
            carry[2 * L + w] = bxx * gz1 + x2 * gz2 + x3 * gz3
            carry[3 * L + w] = bxy * gy1 + y2 * gy2 + y3 * gy3
            carry[4 * L + w] = bxy * gz1 + y2 * gz2 + y3 * gz3
            carry[5 * L + w] = bxz * gz1 + z2 * gz2 + z3 * gz3
            carry[6 * L + w] = bxx * s1 + x2 * s2 + x3 * s3
            carry[7 * L + w] = bxy * s1 + y2 * s2 + y3 * s3
            carry[8 * L + w] = bxz * s1 + z2 * s2 + z3 * s3

            # back through L'
            gx2, gy2, gz2, s2 = gx2 - l32 * gx3, gy2 - l32 * gy3, gz2 - l32 * gz3, s2 - l32 * s3
            kept[w] = gx1 - l21 * gx2 - l31 * gx3
            kept[L + w] = gy1 - l21 * gy2 - l31 * gy3
            kept[2 * L + w] = gz1 - l21 * gz2 - l31 * gz3
            kept[3 * L + w] = gx2
            kept[4 * L + w] = gy2
            kept[5 * L + w] = gz2
            kept[6 * L + w] = gx3
            kept[7 * L + w] = gy3
            kept[8 * L + w] = gz3
            kept[9 * L + w] = s1 - l21 * s2 - l31 * s3
            kept[10 * L + w] = s2
            kept[11 * L + w] = s3
    for w in range(3 * L):
        nodes[CHANGE * L + w] = 0.0
        nodes[R * count + CHANGE * L + w] = 0.0
    for j in range(count - 1, 0, -1):
        kept = nodes[R * j : R * (j + 2)]
        for w in range(width):
            x, y, z = kept[R + CHANGE * L + w], kept[R + (CHANGE + 1) * L + w], kept[R + (CHANGE + 2) * L + w]
            for row in range(3):
                f = (FACTORED + 3 * row) * L + w
                kept[(CHANGE + row) * L + w] = kept[(FACTORED + 9 + row) * L + w] - (
                    kept[f] * x + kept[f + L] * y + kept[f + 2 * L] * z
                )
