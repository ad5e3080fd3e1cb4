"""Equilibrium of a line of straight elastic elements between two fixed points, in still water or a uniform stream.

Element e joins nodes e and e + 1; d is its vector, l its length, h = L / N when slack, t = d / l. It pulls with
T = C e + C1 e^2 at the strain e = l / h - 1 > 0 and with nothing below. Half of its load acts on either node, so inside

    T_j t_j - T_{j-1} t_{j-1} + (D(t_{j-1}) + D(t_j)) / 2 - w h z = 0,    D = h (C_n |u_n| u_n + C_t |u_t| u_t),   (E1)

and the vectors d add up to that from A to B. Two methods follow each other.

1. A uniform load q stands for the drag: that of an element across the stream. The pull of element e is then
   T t = M + ((N - 1) / 2 - e) q h, where the pull M of the middle is unknown, two numbers in the plane of chord and
   load. The gap sum(d) - (B - A) is the gradient of a convex function of M, the complementary energy, so Newton's method
   with a line search finds it, or brackets do, for elements of 1e3 N and of 1e12 N. The function has a kink where an
   element pulls with nothing. Its minimum is there if two legs hang side by side, less than an element apart; that is
   tested first.
2. The uniform load gives way to the drag. Newton's method for nodes and tensions together, 3x3 block-tridiagonal; no
   element turns much in one step, and where that is not enough the share of the true drag grows from 0 to 1 in steps.
   An element is its vector d and one number: its tension or, where that is negative, how slack it is; so slackness is
   exact. Stiffnesses enter the matrix up to a bound that its rounding can bear: that changes steps, not answers.

A softening law (C1 < 0) has a greatest tension. Here it goes on beyond, rising slowly, so that the energy is convex: a
line that then exceeds the greatest tension has no equilibrium under its own law (in a stream: none that was found).
A slack line without load is in equilibrium in any shape; its answer is the limit of small weight, without tension.
"""

from dataclasses import dataclass

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.compiled import compiled

SOLVED, INFEASIBLE, NOT_CONVERGED, NOT_FINITE = range(4)
# Slope of the law beyond its greatest tension, as a part of the stiffness at zero strain.
BEYOND = 0.05
# Steps of either method and of the share of the drag.
MOST_STEPS, MOST_SHARES = 200, 60
NEWTON_STEPS, HALVINGS = 25, 20
# What counts as nothing: gaps in elements, forces in loads of an element and as a part of the largest tension. At the
# end of the steps more is ENOUGH.
GAP, FORCE, ROUNDING, ENOUGH = 1e-14, 1e-12, 2e-15, 1e-10
# The greatest turn of an element in one step.
TURN = 0.4
# Stiffness bound of the matrix, over the largest tension; times the slackness of the line, where that is small.
STIFFEST, STIFFEST_TAUT = 1e8, 1e2
# Stiffness that nothing stretches, in units of the load.
RIGID = 1e100
UP = np.array([0.0, 0.0, 1.0])
# A pull that counts as none.
SMALLEST = 1e-100
# Columns of packed lines: everything in units of an element's length and of its uniform load.
X, Y, Z, UX, UY, UZ, WEIGHT, LOAD_X, LOAD_Y, LOAD_Z, NORMAL, TANGENTIAL, LINEAR, QUADRATIC = range(14)
# Of an element: its load and the derivative of that by its vector; its stiffness plus and minus half of that, its pull
# and what the mismatch adds to that. Of a node: its step if the next one stays, and by the next one's.
LOAD_SIZE = 12
RIGHT, LEFT, PULL, CHANGE, ELEMENT_SIZE = 0, 9, 18, 21, 24
NODE_SIZE = 12


@dataclass(frozen=True)
class StaticLines:
    """Lines in equilibrium, by scenario; NaN where `fate` is not SOLVED.

    `position` (scenario, node, 3) from A, `tension` (scenario, element), `residual` the largest force left over on a
    node over the largest tension, `mismatch` the largest difference between an element's strain and that of its
    tension.
    """

    position: Array
    tension: Array
    residual: Array
    mismatch: Array
    fate: np.ndarray
    steps: np.ndarray


def static_lines(
    end: Array,
    line_length: Array,
    segments: int,
    weight_per_length: Array,
    linear_stiffness: Array,
    quadratic_stiffness: Array,
    normal_drag: Array,
    tangential_drag: Array,
    stream: Array,
) -> StaticLines:
    """Equilibrium of lines from the origin to `end` (scenario, 3) in streams (scenario, 3); all else (scenario,).

    The weight is less buoyancy, the drags are per speed squared and unstretched length. z is up.
    """
    element = line_length / segments
    packed, force = _packed(
        end / element[:, None],
        element,
        weight_per_length,
        linear_stiffness,
        quadratic_stiffness,
        np.column_stack([normal_drag, tangential_drag]),
        stream,
        segments,
    )
    size = element.size
    position, tension = np.empty((size, segments + 1, 3)), np.empty((size, segments))
    measures, fate, steps = np.empty((size, 2)), np.empty(size, dtype=np.int64), np.zeros(size, dtype=np.int64)
    _lines(packed, position, tension, measures, fate, steps)
    position *= element[:, None, None]
    position[fate == SOLVED, -1] = end[fate == SOLVED]
    tension *= force[:, None]
    return StaticLines(position, tension, measures[:, 0], measures[:, 1], fate, steps)


def _packed(
    end: Array,
    element: Array,
    weight: Array,
    linear: Array,
    quadratic: Array,
    drag: Array,
    stream: Array,
    segments: int,
) -> tuple[Array, Array]:
    """Rows in units of the element's length and a force; and that force, 0 for slack lines without load."""
    speed = np.sqrt((stream**2).sum(axis=1))
    load = (drag.max(axis=1) * speed)[:, None] * stream - weight[:, None] * UP
    size = np.sqrt((load**2).sum(axis=1))
    loaded, loose = size > 0.0, (end**2).sum(axis=1) < segments**2
    force = np.where(loaded, size * element, np.where(loose, 0.0, linear))
    # Without load the unit is the stiffness; slack lines get a weight that does not stretch them.
    unit = np.where(loaded, size, linear / element)
    shapeless = ~loaded & loose
    load = np.where(shapeless[:, None], -UP, load / unit[:, None])
    weight = np.where(shapeless, 1.0, weight / unit)
    linear, quadratic = linear / (unit * element), quadratic / (unit * element)
    linear, quadratic = np.where(shapeless, RIGID, linear), np.where(shapeless, 0.0, quadratic)
    return np.column_stack([end, stream, weight, load, drag / unit[:, None], linear, quadratic]), force


@compiled
def _lines(packed, position, tension, measures, fate, steps):
    n = tension.shape[1]
    vectors, forces, legs = np.empty((n, 3)), np.empty((n, LOAD_SIZE)), np.empty(n + 1)
    elements, nodes = np.empty((n, ELEMENT_SIZE)), np.empty((n, NODE_SIZE))
    for i in range(packed.shape[0]):
        line = packed[i]
        fate[i], count = _uniform(line, vectors, tension[i], legs)
        if fate[i] == SOLVED and line[UX] ** 2 + line[UY] ** 2 + line[UZ] ** 2 > 0.0:
            fate[i], more = _dragged(line, vectors, tension[i], forces, elements, nodes)
            count += more
        steps[i] = count
        if fate[i] == SOLVED:
            fate[i] = _finish(line, vectors, tension[i], forces, position[i], measures[i])
        if fate[i] != SOLVED:
            position[i], tension[i], measures[i] = np.nan, np.nan, np.nan


@compiled
def _finish(line, vectors, tension, forces, position, measures):
    """Nodes and what is left over; INFEASIBLE if an element pulls more than its law can."""
    n = tension.size
    _loads(line, vectors, 1.0, forces)
    largest, left, mismatch = 0.0, 0.0, 0.0
    position[0] = 0.0
    for e in range(n):
        pull = max(tension[e], 0.0)
        length = _norm(vectors[e])
        if 1.0 + 4.0 * line[QUADRATIC] * pull / line[LINEAR] ** 2 < 0.0:
            return INFEASIBLE
        largest = max(largest, pull)
        if pull > 0.0:
            mismatch = max(mismatch, abs(length - 1.0 - strain_of(pull, line[LINEAR], line[QUADRATIC])[0]))
        if e > 0:
            left = max(left, _left_over(line, vectors, tension, forces, e, 1.0))
        for k in range(3):
            position[e + 1, k] = position[e, k] + vectors[e, k]
        tension[e] = pull
    measures[0], measures[1] = left / largest if largest > 0.0 else 0.0, mismatch
    return SOLVED


@compiled
def strain_of(tension, linear, quadratic):
    """Strain and its rate by tension; beyond the greatest tension of a softening law it goes on rising."""
    root = np.sqrt(1.0 + 4.0 * quadratic * tension / (linear * linear))
    if root > 0.0:
        return 2.0 * tension / (linear * (1.0 + root)), 1.0 / (linear * root)
    last = -0.5 * linear / quadratic
    return last + (tension - 0.5 * linear * last) / (BEYOND * linear), 1.0 / (BEYOND * linear)


@compiled
def _tension_of(strain, linear, quadratic):
    if quadratic < 0.0 and strain > -0.5 * linear / quadratic:
        last = -0.5 * linear / quadratic
        return 0.5 * linear * last + BEYOND * linear * (strain - last)
    return (linear + quadratic * strain) * strain


@compiled
def _norm(v):
    return np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


# ---- uniform load ----


@compiled
def _uniform(line, vectors, tension, legs):
    """Vectors and tensions under the uniform load; fate and number of steps."""
    n = tension.size
    chord = _norm(line[X : Z + 1])
    ax, ay, az = line[X] / chord, line[Y] / chord, line[Z] / chord
    along = line[LOAD_X] * ax + line[LOAD_Y] * ay + line[LOAD_Z] * az
    bx, by, bz = line[LOAD_X] - along * ax, line[LOAD_Y] - along * ay, line[LOAD_Z] - along * az
    across = np.sqrt(bx * bx + by * by + bz * bz)
    if across > 0.0:
        bx, by, bz = bx / across, by / across, bz / across
    if not (np.isfinite(chord) and np.isfinite(along) and np.isfinite(across) and line[LINEAR] > 0.0):
        return NOT_FINITE, 0
    if _folded(line, vectors, tension, legs):
        return SOLVED, 0
    pull_a, pull_b, count = _middle_pull(chord, along, across, n, line[LINEAR], line[QUADRATIC])
    for e in range(n):
        back = 0.5 * (n - 1) - e
        p, q = pull_a + back * along, pull_b + back * across
        tension[e] = np.sqrt(p * p + q * q)
        length = 1.0 + strain_of(tension[e], line[LINEAR], line[QUADRATIC])[0]
        p, q = (p / tension[e] * length, q / tension[e] * length) if tension[e] > 0.0 else (chord / n, 0.0)
        vectors[e, 0], vectors[e, 1], vectors[e, 2] = p * ax + q * bx, p * ay + q * by, p * az + q * bz
    return (SOLVED if count >= 0 else NOT_CONVERGED), abs(count)


@compiled
def _folded(line, vectors, tension, legs):
    """Two legs along the load with an element between them that has no tension, if that is the line's equilibrium."""
    n = tension.size
    fx, fy, fz = line[LOAD_X], line[LOAD_Y], line[LOAD_Z]
    down = line[X] * fx + line[Y] * fy + line[Z] * fz
    sx, sy, sz = line[X] - down * fx, line[Y] - down * fy, line[Z] - down * fz
    if sx * sx + sy * sy + sz * sz > 1.0 or fx * fx + fy * fy + fz * fz == 0.0:
        return False
    legs[0] = 0.0
    for e in range(n):
        legs[e + 1] = legs[e] + 1.0 + strain_of(e + 1.0, line[LINEAR], line[QUADRATIC])[0]
    for bottom in range(n):
        gap = down - legs[bottom] + legs[n - 1 - bottom]
        if gap * gap + sx * sx + sy * sy + sz * sz <= 1.0:
            for e in range(n):
                size = (
                    legs[bottom - e] - legs[bottom - e - 1] if e < bottom else legs[e - bottom - 1] - legs[e - bottom]
                )
                vectors[e, 0], vectors[e, 1], vectors[e, 2] = size * fx, size * fy, size * fz
                tension[e] = abs(float(bottom - e))
            vectors[bottom, 0], vectors[bottom, 1], vectors[bottom, 2] = gap * fx + sx, gap * fy + sy, gap * fz + sz
            tension[bottom] = _norm(vectors[bottom]) - 1.0
            return True
    return False


@compiled
def _middle_pull(chord, along, across, n, linear, quadratic):
    """Pull of the middle of the line, along the chord and across it, and the number of steps."""
    slack = n / chord - 1.0
    taut = _tension_of(max(-slack, 0.0), linear, quadratic)
    sag = n * across * np.sqrt(1.0 / (24.0 * slack)) if slack > 0.0 else np.inf
    a, b = max(taut, min(sag, np.cbrt(linear * (n * across) ** 2 / 24.0)), 1e-3), 0.0
    gap_a, gap_b, aa, ab, bb, size = _gap(a, b, chord, 0.0, along, across, n, linear, quadratic)
    for count in range(NEWTON_STEPS):
        if abs(gap_a) + abs(gap_b) <= 4.0 * GAP * (size + chord):
            return a, b, count
        det = aa * bb - ab * ab
        step_a, step_b = -(bb * gap_a - ab * gap_b) / det, -(aa * gap_b - ab * gap_a) / det
        slope, share = gap_a * step_a + gap_b * step_b, 1.0
        for _ in range(HALVINGS):
            found = _gap(a + share * step_a, b + share * step_b, chord, 0.0, along, across, n, linear, quadratic)
            new = found[0] * step_a + found[1] * step_b
            if new <= -0.5 * slope:
                break
            share *= max(0.1, -slope / (new - slope)) if new < np.inf else 0.1
        a, b = a + share * step_a, b + share * step_b
        gap_a, gap_b, aa, ab, bb, size = found
    return _bracketed_pull(chord, along, across, n, linear, quadratic)


@compiled
def _bracketed_pull(chord, along, across, n, linear, quadratic):
    """The same by brackets: the part of the pull across the load is sought, for each the part along it.

    For lines near to a kink, where an element has nearly no tension and Newton's steps are tiny.
    """
    most, total = 1.0, 0
    while total < MOST_STEPS and _upright_gap(most, chord, along, across, n, linear, quadratic)[0] < 0.0:
        most *= 8.0
        total += 1
    least, h = 0.0, 0.5 * most
    for _ in range(MOST_STEPS):
        gap, rate, v, size, count = _upright_gap(h, chord, along, across, n, linear, quadratic)
        total += count
        if gap > 0.0:
            most = h
        else:
            least = h
        if abs(gap) <= 4.0 * GAP * (size + chord) or most - least <= ROUNDING * most:
            return h * across + v * along, v * across - h * along, total
        h -= gap / rate
        if not least < h < most:
            h = 0.5 * (least + most)
    return h * across + v * along, v * across - h * along, -1


@compiled
def _upright_gap(h, chord, along, across, n, linear, quadratic):
    """Gap across the load and its rate by the pull across it, `h`, where the pull along it closes the gap along it.

    Also that pull, the length of the line and the number of steps.
    """
    x, y = chord * across, chord * along
    width = 1.0 + n
    while _gap(h, width, x, y, 0.0, 1.0, n, linear, quadratic)[1] < 0.0:
        width *= 8.0
    least, most, v = -width, width, 0.0
    while _gap(h, least, x, y, 0.0, 1.0, n, linear, quadratic)[1] > 0.0:
        least *= 8.0
    for count in range(MOST_STEPS):
        gap_h, gap_v, hh, hv, vv, size = _gap(h, v, x, y, 0.0, 1.0, n, linear, quadratic)
        if gap_v > 0.0:
            most = v
        else:
            least = v
        if abs(gap_v) <= GAP * (size + chord) or most - least <= ROUNDING * (abs(most) + abs(least)):
            break
        v -= gap_v / vv
        if not least < v < most:
            v = 0.5 * (least + most)
    return gap_h, hh - hv * hv / vv, v, size, count


@compiled
def _gap(a, b, end_a, end_b, load_a, load_b, n, linear, quadratic):
    """What the elements' vectors exceed the chord by, in two directions, its derivatives by the pull, the length."""
    gap_a, gap_b, aa, ab, bb, size = -end_a, -end_b, 0.0, 0.0, 0.0, 0.0
    for e in range(n):
        back = 0.5 * (n - 1) - e
        p, q = a + back * load_a, b + back * load_b
        pull = max(np.sqrt(p * p + q * q), SMALLEST)
        strain, rate = strain_of(pull, linear, quadratic)
        length = 1.0 + strain
        p, q, turn, size = p / pull, q / pull, length / pull, size + length
        gap_a, gap_b = gap_a + length * p, gap_b + length * q
        aa, ab, bb = aa + rate * p * p + turn * q * q, ab + (rate - turn) * p * q, bb + rate * q * q + turn * p * p
    return gap_a, gap_b, aa, ab, bb, size


# ---- drag ----


@compiled
def _dragged(line, vectors, tension, forces, elements, nodes):
    """From the line under uniform load to the one with drag; fate and number of steps."""
    kept_vectors, kept_tension = vectors.copy(), tension.copy()
    share, stride, count = 0.0, 1.0, 0
    for _ in range(MOST_SHARES):
        target = min(1.0, share + stride)
        good, steps = _newton(line, target, vectors, tension, forces, elements, nodes)
        count += steps
        if good and target == 1.0:
            return SOLVED, count
        if good:
            share, stride = target, 2.0 * stride
            kept_vectors[:], kept_tension[:] = vectors, tension
        else:
            stride *= 0.25
            vectors[:], tension[:] = kept_vectors, kept_tension
    return NOT_CONVERGED, count


@compiled
def _newton(line, share, vectors, tension, forces, elements, nodes):
    """Equilibrium under a share of the drag and the rest of the uniform load; whether it was found, and the steps."""
    left, mismatch, largest = np.inf, np.inf, 1.0
    matrix = np.empty((3, 7))
    for count in range(NEWTON_STEPS):
        _loads(line, vectors, share, forces)
        mismatch, largest = _assemble(line, vectors, tension, forces, elements)
        left = _eliminate(forces, elements, nodes, matrix)
        if not (left < np.inf and mismatch < np.inf):
            return False, count
        if left <= FORCE + ROUNDING * largest and mismatch <= GAP:
            return True, count
        _step(line, vectors, tension, nodes)
    return left <= ENOUGH * largest and mismatch <= ENOUGH, NEWTON_STEPS


@compiled
def _loads(line, vectors, share, forces):
    """Load of every element with a share of the true drag, and its derivative by the element's vector."""
    ux, uy, uz = line[UX], line[UY], line[UZ]
    cn, ct, rest = share * line[NORMAL], share * line[TANGENTIAL], 1.0 - share
    for e in range(vectors.shape[0]):
        f, length = forces[e], max(_norm(vectors[e]), 1e-300)
        tx, ty, tz = vectors[e, 0] / length, vectors[e, 1] / length, vectors[e, 2] / length
        s = ux * tx + uy * ty + uz * tz
        px, py, pz = ux - s * tx, uy - s * ty, uz - s * tz
        normal = np.sqrt(px * px + py * py + pz * pz)
        by_normal, by_tangent = cn * normal, ct * abs(s) * s
        f[0] = by_normal * px + by_tangent * tx + rest * line[LOAD_X]
        f[1] = by_normal * py + by_tangent * ty + rest * line[LOAD_Y]
        f[2] = by_normal * pz + by_tangent * tz + rest * line[LOAD_Z] - share * line[WEIGHT]
        # dD = a (p . dd) + b P dd with p the normal velocity and P the projection across the line.
        turned, ratio = (2.0 * ct * abs(s) - by_normal) / length, cn * s / (normal * length) if normal > 0.0 else 0.0
        ax, ay, az = turned * tx - ratio * px, turned * ty - ratio * py, turned * tz - ratio * pz
        b = (by_tangent - by_normal * s) / length
        f[3], f[4], f[5] = ax * px + b * (1.0 - tx * tx), ax * py - b * tx * ty, ax * pz - b * tx * tz
        f[6], f[7], f[8] = ay * px - b * ty * tx, ay * py + b * (1.0 - ty * ty), ay * pz - b * ty * tz
        f[9], f[10], f[11] = az * px - b * tz * tx, az * py - b * tz * ty, az * pz + b * (1.0 - tz * tz)


@compiled
def _left_over(line, vectors, tension, forces, node, share):
    """The force left over on a node inside."""
    total = 0.0
    left, right = max(tension[node - 1], 0.0), max(tension[node], 0.0)
    a, b = left / max(_norm(vectors[node - 1]), 1e-300), right / max(_norm(vectors[node]), 1e-300)
    for k in range(3):
        part = b * vectors[node, k] - a * vectors[node - 1, k] + 0.5 * (forces[node - 1, k] + forces[node, k])
        total += part * part
    return np.sqrt(total)


@compiled
def _stiffest(vectors, tension):
    """The bound of the stiffnesses in the matrix, and the largest tension."""
    largest, stretched = 0.0, 0.0
    ex, ey, ez = 0.0, 0.0, 0.0
    for e in range(tension.size):
        largest = max(largest, tension[e])
        stretched += _norm(vectors[e])
        ex, ey, ez = ex + vectors[e, 0], ey + vectors[e, 1], ez + vectors[e, 2]
    slack = max(1.0 - np.sqrt(ex * ex + ey * ey + ez * ez) / stretched, 1e-16)
    return largest * max(STIFFEST, STIFFEST_TAUT / slack), largest


@compiled
def _element(length, tension, line, stiffest):
    """Stiffness along an element, bounded, and the strain that its tension does not explain."""
    if tension > 0.0:
        strain, rate = strain_of(tension, line[LINEAR], line[QUADRATIC])
        return min(1.0 / rate, stiffest), (length - 1.0) - strain
    # Any stiffness does for the number that says how slack it is: it pulls on nothing.
    return 1.0, (length - 1.0) - tension


@compiled
def _assemble(line, vectors, tension, forces, elements):
    """Stiffness plus and minus half the derivative of the load, pull and its change by the mismatch, of every element.

    Returns the largest mismatch and the largest tension.
    """
    stiffest, largest = _stiffest(vectors, tension)
    mismatch = 0.0
    for e in range(tension.size):
        row, f = elements[e], forces[e]
        length = max(_norm(vectors[e]), 1e-300)
        stiffness, gap = _element(length, tension[e], line, stiffest)
        mismatch = max(mismatch, abs(gap))
        pull = max(tension[e], 0.0)
        axial, across = (stiffness if tension[e] > 0.0 else 0.0), pull / length
        for k in range(3):
            t = vectors[e, k] / length
            row[PULL + k], row[CHANGE + k] = pull * t, axial * gap * t
            for m in range(3):
                both = (axial - across) * t * (vectors[e, m] / length) + (across if k == m else 0.0)
                row[RIGHT + 3 * k + m] = both + 0.5 * f[3 + 3 * k + m]
                row[LEFT + 3 * k + m] = both - 0.5 * f[3 + 3 * k + m]
    return mismatch, largest


@compiled
def _eliminate(forces, elements, nodes, matrix):
    """Equations of the nodes inside, R_j + L_{j-1} on the diagonal, -R_j and -L_{j-1} beside it, eliminated forwards.

    Leaves x_j = nodes[j, :3] + nodes[j, 3:] x_{j+1}; returns the largest force left over.
    """
    largest = 0.0
    nodes[0] = 0.0
    for j in range(1, elements.shape[0]):
        left, right, last = elements[j - 1], elements[j], nodes[j - 1]
        total = 0.0
        for k in range(3):
            over = right[PULL + k] - left[PULL + k] + 0.5 * (forces[j - 1, k] + forces[j, k])
            total += over * over
            over += right[CHANGE + k] - left[CHANGE + k]
            for m in range(3):
                known = 0.0
                for i in range(3):
                    known += left[LEFT + 3 * k + i] * last[3 + 3 * i + m]
                matrix[k, m] = right[RIGHT + 3 * k + m] + left[LEFT + 3 * k + m] - known
                matrix[k, 4 + m] = right[RIGHT + 3 * k + m]
                over += left[LEFT + 3 * k + m] * last[m]
            matrix[k, 3] = over
        largest = max(largest, total)
        _solve(matrix)
        for k in range(3):
            nodes[j, k] = matrix[k, 3]
            for m in range(3):
                nodes[j, 3 + 3 * k + m] = matrix[k, 4 + m]
    return np.sqrt(largest)


@compiled
def _solve(matrix):
    """The first three columns become those of the unit matrix."""
    for k in range(3):
        inverse = 1.0 / matrix[k, k]
        for m in range(k + 1, 7):
            matrix[k, m] *= inverse
        for i in range(3):
            if i != k:
                factor = matrix[i, k]
                for m in range(k + 1, 7):
                    matrix[i, m] -= factor * matrix[k, m]


@compiled
def _step(line, vectors, tension, nodes):
    """Nodes move, as far as no element turns too much."""
    n = tension.size
    stiffest, _ = _stiffest(vectors, tension)
    turn = 0.0
    for j in range(n - 1, 0, -1):
        total = 0.0
        for k in range(3):
            if j < n - 1:
                for m in range(3):
                    nodes[j, k] += nodes[j, 3 + 3 * k + m] * nodes[j + 1, m]
            after = nodes[j + 1, k] if j < n - 1 else 0.0
            total += (after - nodes[j, k]) ** 2
        turn = max(turn, total / max(_norm(vectors[j]) ** 2, 1e-4))
    share = min(1.0, TURN / np.sqrt(turn)) if turn > 0.0 else 1.0
    for e in range(n):
        length = max(_norm(vectors[e]), 1e-300)
        stiffness, gap = _element(length, tension[e], line, stiffest)
        longer = gap
        for k in range(3):
            change = (nodes[e + 1, k] if e < n - 1 else 0.0) - (nodes[e, k] if e > 0 else 0.0)
            longer += vectors[e, k] / length * change
            nodes[e, 3 + k] = change
        tension[e] += share * stiffness * longer
        for k in range(3):
            vectors[e, k] += share * nodes[e, 3 + k]
