"""Line in a uniform stream in its plane: Pode's functions in closed form and as integrals (docs/models.md, M10, M11).

The angle a is that of the tangent above the direction of tow, that is against the stream. With the critical angle a_c,
c_1 = cos(a_c) and M = K_n / c_1 = p / sin(a_c)^2, the equations of the line read for 0 <= a <= pi

    T da/ds = M E(a),  dT/ds = f_s K_n + p sin(a),  E = (cos(a) - c_1) (1 + c_1 cos(a)) = c_1 D(a),

regular from the neutral line (a_c = 0) to still water (a_c = pi/2). Beyond pi they are those of b = a - pi with E and
the direction of the line reversed. All lines have their angles between a_c and pi + a_c, where a falls along the line,
or are such lines walked from their other end. Friction changes its sign at pi/2.

The angle is carried as u = log((a - a_c) / (pi + a_c - a)): the distances to both singular angles then keep all their
digits, and every integrand is smooth on a scale of one.
"""

import numpy as np

from cablesim.numerics.compiled import compiled
from cablesim.physics.stream import CONSTANT, COSINE_SQUARED, ZERO

# pi as a float and what the float leaves out.
PI, PI_TAIL = np.pi, 1.2246467991473532e-16


# What a line's angles and tensions need to know of it, packed by `pack`.
CRITICAL, FRICTION, LAW, COSINE, SINE, HALF, SCALE, U_RIGHT, U_STRAIGHT, BEFORE, BEYOND, WIDTH = range(12)


@compiled
def pack(critical, friction, law, line):  # type: ignore[no-untyped-def]
    """Critical angle, friction ratio and law of a line, and what follows from them alone, into `line` of size WIDTH.

    BEFORE and BEYOND are what joins the antiderivatives of the tension at pi/2, where friction changes its sign, and at
    pi; U_RIGHT and U_STRAIGHT are u there.
    """
    line[CRITICAL], line[FRICTION], line[LAW] = critical, friction, law
    line[COSINE], line[SINE], line[HALF] = np.cos(critical), np.sin(critical), np.sin(0.5 * critical)
    line[SCALE] = 1.0 / (1.0 + line[COSINE] ** 2)
    right = 0.5 * PI - critical
    line[U_RIGHT] = np.log(right / (0.5 * PI + critical)) if right > 0.0 else -np.inf
    line[U_STRAIGHT] = np.log((PI - critical) / critical) if critical > 0.0 else np.inf
    line[BEFORE] = 0.0
    if right > 0.0:
        line[BEFORE] = log_tension(0.5 * PI, right, 1.0, line) - log_tension(0.5 * PI, right, -1.0, line)
    line[BEYOND] = 0.0
    if critical > 0.0:
        straight = log_tension(PI, PI - critical, -1.0, line) + line[BEFORE]
        line[BEYOND] = straight - log_tension(0.0, critical, 1.0, line)


@compiled
def logit_of_angle(angle, critical):  # type: ignore[no-untyped-def]
    """u of an angle; NaN at the singular angles and beyond them."""
    low = angle - critical
    # Differences of near numbers are exact: those of angle and pi above pi/2, those of angle and a_c below it.
    high = (critical - (angle - PI)) + PI_TAIL if angle > 0.5 * PI else (PI - low) + PI_TAIL
    return np.log(low / high) if low > 0.0 and high > 0.0 else np.nan


@compiled
def angle_of_logit(u, critical):  # type: ignore[no-untyped-def]
    """Angle of u, and its distances to the lower and the upper singular angle, each to its last digit."""
    power = np.exp(-abs(u))
    near, far = PI * power / (1.0 + power), PI / (1.0 + power)
    low, high = (near, far) if u < 0.0 else (far, near)
    return critical + low, low, high


@compiled
def resistance(x, distance, line):  # type: ignore[no-untyped-def]
    """|E| at an angle x of the first two quadrants; `distance` is |x - a_c|."""
    across = np.sin(0.5 * (x + line[CRITICAL])) * np.sin(0.5 * distance)
    return 4.0 * across * (line[HALF] ** 2 + line[COSINE] * np.cos(0.5 * x) ** 2)


@compiled
def log_tension(x, distance, side, line):  # type: ignore[no-untyped-def]
    """Antiderivative of (side f_law c_1 + sin(a_c)^2 sin(x)) / E(x): the logarithm of the tension, in closed form.

    With J1 = int dx / (cos x - c_1) and K2 = int dx / (1 + c_1 cos x) all three laws are sums of J1, K2 and logarithms.
    """
    critical, c_1, sine, half = line[CRITICAL], line[COSINE], line[SINE], line[HALF]
    half_sine, half_cosine, half_distance = np.sin(0.5 * x), np.cos(0.5 * x), np.sin(0.5 * distance)
    ratio = np.sin(0.5 * (x + critical)) * half_distance / (half * half + c_1 * half_cosine * half_cosine)
    weight = -sine * sine * line[SCALE] * np.log(ratio) if sine > 0.0 else 0.0
    if line[LAW] == ZERO or line[FRICTION] == 0.0:
        return weight
    if critical > 0.0:
        growth = half_cosine * half if x > critical else np.cos(0.5 * critical) * half_sine
        j_1 = np.log1p(2.0 * growth / half_distance) / sine
        k_2 = 2.0 * np.arctan2(half * half_sine, np.cos(0.5 * critical) * half_cosine) / sine
    else:
        j_1, k_2 = half_cosine / half_sine, half_sine / half_cosine
    if line[LAW] == CONSTANT:
        return weight + side * line[FRICTION] * c_1 * line[SCALE] * (j_1 - c_1 * k_2)
    return weight + side * line[FRICTION] * (x + line[SCALE] * (c_1**3 * j_1 - k_2))


@compiled
def tension_logarithm(u, line):  # type: ignore[no-untyped-def]
    """log(T) at u up to a constant that is one for all angles."""
    angle, low, high = angle_of_logit(u, line[CRITICAL])
    if u > line[U_STRAIGHT]:
        return log_tension(line[CRITICAL] - high, high, 1.0, line) + line[BEYOND]
    if u >= line[U_RIGHT]:
        return log_tension(angle, low, -1.0, line) + line[BEFORE]
    return log_tension(angle, low, 1.0, line)


@compiled
def tension_rate(u, line):  # type: ignore[no-untyped-def]
    """|d log(T) / du|: how steep the integrands are, which a light line with friction makes very steep near a = pi."""
    angle, low, high = angle_of_logit(u, line[CRITICAL])
    x, distance = (line[CRITICAL] - high, high) if u > line[U_STRAIGHT] else (angle, low)
    cosine = np.cos(x)
    friction = 0.0
    if line[LAW] == CONSTANT:
        friction = line[FRICTION] * line[COSINE]
    elif line[LAW] == COSINE_SQUARED:
        friction = line[FRICTION] * line[COSINE] * cosine * cosine
    side = 1.0 if u > line[U_STRAIGHT] or u < line[U_RIGHT] else -1.0
    pull = side * friction + line[SINE] ** 2 * np.sin(x)
    return abs(pull) / resistance(x, distance, line) * low * high / PI


@compiled
def slopes(u, line, reference):  # type: ignore[no-untyped-def]
    """d/du of length, horizontal and vertical distance in units of T_0 / M, with `reference` = log(T_0).

    Positive length: along increasing u, that is along a line walked from B to A.
    """
    angle, low, high = angle_of_logit(u, line[CRITICAL])
    x, distance = (line[CRITICAL] - high, high) if u > line[U_STRAIGHT] else (angle, low)
    length = np.exp(tension_logarithm(u, line) - reference) / resistance(x, distance, line) * low * high / PI
    return length, length * np.cos(angle), length * np.sin(angle)
