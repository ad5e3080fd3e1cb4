"""Equilibrium of a line of straight elastic elements under a uniform load that gives way to drag.

As in `_wave_uniform`, with the drag D of an element, which like its weight acts with one half on either node: inside

    T_j t_j - T_{j-1} t_{j-1} + (D(t_{j-1}) + D(t_j)) / 2 - w h z = 0,    D = h (C_n |u_n| u_n + C_t |u_t| u_t),   (E2)

u_t = (u.t) t, u_n = u - u_t, h the unstretched length of an element. Newton's method for nodes and tensions together,
3x3 block-tridiagonal, in which no element turns much in a step. Where that is not enough the share of the true drag
grows from 0 to 1 in steps, and where that is not enough the nodes resist their steps, less and less.

An element is its vector and one number: its tension or, where that is negative, how slack it is; so slackness is exact.
Stiffnesses enter the matrix up to a bound that its rounding can bear: that changes steps, not answers.
"""

import numpy as np

from cablesim.numerics.compiled import compiled
from cablesim.solvers._wave_uniform import (
    LINEAR,
    LOAD_X,
    LOAD_Y,
    LOAD_Z,
    NORMAL,
    QUADRATIC,
    TANGENTIAL,
    UX,
    UY,
    UZ,
    WEIGHT,
    norm,
    strain_of,
)

# Steps of Newton's method, with and without resistance; changes of the share of the drag, and the smallest.
NEWTON_STEPS, MOST_STEPS, MOST_SHARES, LEAST_STRIDE = 25, 200, 60, 1e-4
# Resistances that are tried, in loads of an element over its length.
DAMPINGS = (1.0, 0.1, 0.01)
# What counts as nothing: mismatches of strain, forces in loads of an element and as a part of the largest tension. In
# the second half of the steps more is ENOUGH.
MISMATCH, FORCE, ROUNDING, ENOUGH = 1e-14, 1e-14, 2e-15, 1e-10
# The greatest turn of an element in one step, and the length below which a slack one may turn more.
TURN, SHORT = 0.4, 1e-2
# Bound of the stiffnesses in the matrix, over the largest tension; the second over the slackness of the line as well.
STIFFEST, STIFFEST_TAUT = 1e8, 1e2
# Of an element: its load and the derivative of that by its vector; its stiffness plus and minus half of that, its pull
# and what the mismatch adds to that. Of a node: its step if the next one stays, and by the next one's.
LOAD_SIZE = 12
RIGHT, LEFT, PULL, CHANGE, ELEMENT_SIZE = 0, 9, 18, 21, 24
NODE_SIZE = 12


@compiled
def dragged_line(line, vectors, tension, forces, elements, nodes):
    """From the line under uniform load to the one with drag; whether that was found, and the number of steps."""
    kept_vectors, kept_tension = vectors.copy(), tension.copy()
    share, stride, count = 0.0, 1.0, 0
    for _ in range(MOST_SHARES):
        target = min(1.0, share + stride)
        good, steps = _newton(line, target, 0.0, vectors, tension, forces, elements, nodes)
        count += steps
        if good and target == 1.0:
            return True, count
        if good:
            share, stride = target, 2.0 * stride
            kept_vectors[:], kept_tension[:] = vectors, tension
        else:
            stride *= 0.25
            vectors[:], tension[:] = kept_vectors, kept_tension
        if stride < LEAST_STRIDE:
            break
    for damping in DAMPINGS:
        vectors[:], tension[:] = kept_vectors, kept_tension
        good, steps = _newton(line, 1.0, damping, vectors, tension, forces, elements, nodes)
        count += steps
        if good:
            return True, count
    return False, count


@compiled
def _newton(line, share, damping, vectors, tension, forces, elements, nodes):
    """Equilibrium under a share of the drag and the rest of the uniform load; whether it was found, and the steps.

    With `damping` the nodes feel a resistance against their steps, which grows and falls with what is left over.
    """
    matrix = np.empty((3, 7))
    most = MOST_STEPS if damping > 0.0 else NEWTON_STEPS
    before = np.inf
    for count in range(most):
        loads(line, vectors, share, forces)
        mismatch, largest = _assemble(line, vectors, tension, forces, elements)
        left = _eliminate(forces, elements, damping, nodes, matrix)
        if not (left < np.inf and mismatch < np.inf):
            return False, count
        strict = count < most // 2
        force, gap = (FORCE + ROUNDING * largest, MISMATCH) if strict else (ENOUGH * largest, ENOUGH)
        if left <= force and mismatch <= gap:
            return True, count
        _step(line, vectors, tension, nodes)
        damping *= min(2.0, max(0.3, left / before)) if before < np.inf else 1.0
        before = left
    return False, most


@compiled
def loads(line, vectors, share, forces):
    """Load of every element with a share of the true drag, and its derivative by the element's vector."""
    ux, uy, uz = line[UX], line[UY], line[UZ]
    cn, ct, rest = share * line[NORMAL], share * line[TANGENTIAL], 1.0 - share
    for e in range(vectors.shape[0]):
        f, length = forces[e], max(norm(vectors[e]), 1e-300)
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
def left_over(vectors, tension, forces, node):
    """The force left over on a node inside."""
    total = 0.0
    left, right = max(tension[node - 1], 0.0), max(tension[node], 0.0)
    a, b = left / max(norm(vectors[node - 1]), 1e-300), right / max(norm(vectors[node]), 1e-300)
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
        stretched += norm(vectors[e])
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

    Returns the largest mismatch, over the length if that is more than 1, and the largest tension.
    """
    stiffest, largest = _stiffest(vectors, tension)
    mismatch = 0.0
    for e in range(tension.size):
        row, f = elements[e], forces[e]
        length = max(norm(vectors[e]), 1e-300)
        stiffness, gap = _element(length, tension[e], line, stiffest)
        mismatch = max(mismatch, abs(gap) / max(length, 1.0))
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
def _eliminate(forces, elements, damping, nodes, matrix):
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
            matrix[k, k] += damping
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
    for j in range(n - 1, -1, -1):
        total = 0.0
        for k in range(3):
            after = nodes[j + 1, k] if j < n - 1 else 0.0
            if 0 < j < n - 1:
                for m in range(3):
                    nodes[j, k] += nodes[j, 3 + 3 * k + m] * nodes[j + 1, m]
            total += (after - nodes[j, k]) ** 2
        turn = max(turn, total / max(norm(vectors[j]) ** 2, SHORT**2))
    share = min(1.0, TURN / np.sqrt(turn)) if turn > 0.0 else 1.0
    for e in range(n):
        length = max(norm(vectors[e]), 1e-300)
        stiffness, longer = _element(length, tension[e], line, stiffest)
        for k in range(3):
            change = (nodes[e + 1, k] if e < n - 1 else 0.0) - nodes[e, k]
            longer += vectors[e, k] / length * change
            nodes[e, 3 + k] = change
        tension[e] += share * stiffness * longer
        for k in range(3):
            vectors[e, k] += share * nodes[e, 3 + k]
