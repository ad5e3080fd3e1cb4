"""Equilibrium of a line of straight elastic elements between two fixed points under a uniform load.

Element e joins nodes e and e + 1; d is its vector, l its length, 1 when slack, t = d / l. It pulls with
T = C e + C1 e^2 at the strain e = l - 1 > 0 and with nothing below. Half of its load f, of size 1, acts on either node.
Then its pull is

    T t = M + ((N - 1) / 2 - e) f,    sum over e of (1 + strain(T)) t = B - A,                                     (E1)

where the pull M of the middle is unknown: two numbers in the plane of chord and load. The gap between the sides of the
second equation is the gradient of a convex function of M, the complementary energy, so Newton's method with a line
search finds it, or brackets do, for elements as soft or as stiff as they may be. The function has a kink where an
element pulls with nothing. Its minimum is there if two legs hang side by side, less than an element apart; that is
tested first.

A softening law (C1 < 0) has a greatest tension. Here it goes on beyond, rising slowly, so that the energy is convex: a
line that then exceeds the greatest tension has no equilibrium under its own law.
"""

import numpy as np

from cablesim.numerics.compiled import compiled

# Columns of packed lines: everything in units of an element's length and of its load.
X, Y, Z, UX, UY, UZ, WEIGHT, LOAD_X, LOAD_Y, LOAD_Z, NORMAL, TANGENTIAL, LINEAR, QUADRATIC = range(14)
# Slope of the law beyond its greatest tension, as a part of the stiffness at zero strain.
BEYOND = 0.05
MOST_STEPS, NEWTON_STEPS, HALVINGS = 200, 25, 20
# Gaps that count as none, over the length of the line, and brackets that are as narrow as numbers allow.
GAP, ROUNDING = 1e-14, 2e-15
# A pull that counts as none, and one that no search goes beyond.
SMALLEST, HUGE = 1e-100, 1e100


@compiled
def uniform_line(line, vectors, tension, legs):
    """Vectors and tensions of the elements; whether they were found, and the number of steps.

    A tension below zero says how slack an element is. `legs` is room for n + 1 numbers.
    """
    n = tension.size
    chord = norm(line[X : Z + 1])
    ax, ay, az = line[X] / chord, line[Y] / chord, line[Z] / chord
    along = line[LOAD_X] * ax + line[LOAD_Y] * ay + line[LOAD_Z] * az
    bx, by, bz = line[LOAD_X] - along * ax, line[LOAD_Y] - along * ay, line[LOAD_Z] - along * az
    across = np.sqrt(bx * bx + by * by + bz * bz)
    if across > 0.0:
        bx, by, bz = bx / across, by / across, bz / across
    if _folded(line, vectors, tension, legs):
        return True, 0
    pull_a, pull_b, count = _middle_pull(chord, along, across, n, line[LINEAR], line[QUADRATIC])
    for e in range(n):
        back = 0.5 * (n - 1) - e
        p, q = pull_a + back * along, pull_b + back * across
        tension[e] = np.sqrt(p * p + q * q)
        length = 1.0 + strain_of(tension[e], line[LINEAR], line[QUADRATIC])[0]
        p, q = (p / tension[e] * length, q / tension[e] * length) if tension[e] > 0.0 else (chord / n, 0.0)
        vectors[e, 0], vectors[e, 1], vectors[e, 2] = p * ax + q * bx, p * ay + q * by, p * az + q * bz
    return np.isfinite(pull_a + pull_b), count


@compiled
def _folded(line, vectors, tension, legs):
    """Two legs along the load with an element between them that has no tension, if that is the line's equilibrium."""
    n = tension.size
    fx, fy, fz = line[LOAD_X], line[LOAD_Y], line[LOAD_Z]
    down = line[X] * fx + line[Y] * fy + line[Z] * fz
    sx, sy, sz = line[X] - down * fx, line[Y] - down * fy, line[Z] - down * fz
    aside = sx * sx + sy * sy + sz * sz
    if aside > 1.0 or fx * fx + fy * fy + fz * fz == 0.0:
        return False
    legs[0] = 0.0
    for e in range(n):
        legs[e + 1] = legs[e] + 1.0 + strain_of(e + 1.0, line[LINEAR], line[QUADRATIC])[0]
    for bottom in range(n):
        gap = down - legs[bottom] + legs[n - 1 - bottom]
        if gap * gap + aside <= 1.0:
            _hang_legs(bottom, fx, fy, fz, legs, vectors, tension)
            vectors[bottom, 0], vectors[bottom, 1], vectors[bottom, 2] = gap * fx + sx, gap * fy + sy, gap * fz + sz
            tension[bottom] = norm(vectors[bottom]) - 1.0
            return True
    return False


@compiled
def _hang_legs(bottom, fx, fy, fz, legs, vectors, tension):
    """Elements on either side of the lowest one, along the load and against it; `legs` are lengths from the bottom."""
    for e in range(tension.size):
        k = abs(bottom - e)
        tension[e] = float(k)
        length = legs[k] - legs[max(k - 1, 0)]
        length = length if e < bottom else -length
        vectors[e, 0], vectors[e, 1], vectors[e, 2] = length * fx, length * fy, length * fz


@compiled
def _middle_pull(chord, along, across, n, linear, quadratic):
    """Pull of the middle of the line, along the chord and across it, and the number of steps."""
    slack = n / chord - 1.0
    taut = tension_of(max(-slack, 0.0), linear, quadratic)
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
    least, most = 0.0, 1.0
    while most < HUGE and _upright_gap(most, chord, along, across, n, linear, quadratic)[0] < 0.0:
        most *= 8.0
    h = 0.5 * most
    for count in range(MOST_STEPS):
        gap, rate, v, size = _upright_gap(h, chord, along, across, n, linear, quadratic)
        if gap > 0.0:
            most = h
        else:
            least = h
        if abs(gap) <= 4.0 * GAP * (size + chord) or most - least <= ROUNDING * most:
            return h * across + v * along, v * across - h * along, NEWTON_STEPS + count
        h -= gap / rate
        if not least < h < most:
            h = 0.5 * (least + most)
    return np.nan, np.nan, NEWTON_STEPS + MOST_STEPS


@compiled
def _upright_gap(h, chord, along, across, n, linear, quadratic):
    """Gap across the load and its rate by the pull across it, `h`, where the pull along it closes the gap along it.

    Also that pull and the length of the line.
    """
    x, y = chord * across, chord * along
    least, most, v = -1.0 - n, 1.0 + n, 0.0
    while most < HUGE and _gap(h, most, x, y, 0.0, 1.0, n, linear, quadratic)[1] < 0.0:
        most *= 8.0
    while least > -HUGE and _gap(h, least, x, y, 0.0, 1.0, n, linear, quadratic)[1] > 0.0:
        least *= 8.0
    for _ in range(MOST_STEPS):
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
    return gap_h, hh - hv * hv / vv, v, size


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


@compiled
def strain_of(tension, linear, quadratic):
    """Strain and its rate by tension; beyond the greatest tension of a softening law it goes on rising."""
    root = np.sqrt(1.0 + 4.0 * quadratic * tension / (linear * linear))
    if root > 0.0:
        return 2.0 * tension / (linear * (1.0 + root)), 1.0 / (linear * root)
    last = -0.5 * linear / quadratic
    return last + (tension - 0.5 * linear * last) / (BEYOND * linear), 1.0 / (BEYOND * linear)


@compiled
def tension_of(strain, linear, quadratic):
    """Its inverse, for strains above zero."""
    if quadratic < 0.0 and strain > -0.5 * linear / quadratic:
        last = -0.5 * linear / quadratic
        return 0.5 * linear * last + BEYOND * linear * (strain - last)
    return (linear + quadratic * strain) * strain


@compiled
def norm(v):
    return np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
