"""Line in a uniform stream in its plane: Pode's functions in closed form and as integrals (docs/models.md, M10, M11).

The angle a is that of the tangent above the direction of tow, that is against the stream. With the critical angle a_c,
c_1 = cos(a_c) and M = K_n / c_1 = p / sin(a_c)^2, the equations of the line read for 0 <= a <= pi

    T da/ds = M E(a),  dT/ds = f_s K_n + p sin(a),  E = (cos(a) - c_1) (1 + c_1 cos(a)) = c_1 D(a),

regular from the neutral line (a_c = 0) to still water (a_c = pi/2). Beyond pi they are those of b = a - pi with E and
the direction of the line reversed. All lines have their angles between a_c and pi + a_c, where a falls along the line,
or are such lines walked from their other end. Friction changes its sign at pi/2.

The angle is carried as u = log(tan((a - a_c) / 2)): the distances to both singular angles, a_c and pi + a_c, then keep
all their digits, sines and cosines are algebraic in exp(u), and every integrand is smooth on a scale of one.
"""

import numpy as np

from cablesim.numerics.compiled import compiled
from cablesim.physics.stream import CONSTANT, COSINE_SQUARED, ZERO

# pi as a float and what the float leaves out.
PI, PI_TAIL = np.pi, 1.2246467991473532e-16
# Nearer to a singular angle than this part of itself an angle may as well be that angle.
ROUNDING = 2.0 * np.finfo(float).eps
# What a line's angles and tensions need to know of it, packed by `pack`.
CRITICAL, FRICTION, LAW, COSINE, SINE, HALF_COSINE, HALF_SINE, SCALE, U_RIGHT, U_STRAIGHT, BEFORE, BEYOND, WIDTH = (
    range(13)
)


@compiled
def pack(critical, tail, friction, law, line):
    """Critical angle, friction ratio and law of a line, and what follows from them alone, into `line` of size WIDTH.

    `tail` is what the float leaves out of the critical angle.

    BEFORE and BEYOND are what joins the antiderivatives of the tension at pi/2, where friction changes its sign, and at
    pi; U_RIGHT and U_STRAIGHT are u there.
    """
    line[CRITICAL], line[FRICTION], line[LAW] = critical, friction, law
    line[COSINE], line[SINE] = np.cos(critical) - tail * np.sin(critical), np.sin(critical)
    line[HALF_COSINE], line[HALF_SINE] = np.cos(0.5 * critical), np.sin(0.5 * critical)
    line[SCALE] = 1.0 / (1.0 + line[COSINE] ** 2)
    right = 0.5 * PI - critical + (0.5 * PI_TAIL - tail)
    line[U_RIGHT] = np.log(np.tan(0.5 * right)) if right > 0.0 else -np.inf
    line[U_STRAIGHT] = -np.log(np.tan(0.5 * critical)) if critical > 0.0 else np.inf
    line[BEFORE], line[BEYOND] = 0.0, 0.0
    if right > 0.0:
        first, second = np.sin(0.25 * PI + 0.5 * critical), np.sin(0.5 * right)
        upright = np.sqrt(0.5)
        before = log_tension(0.5 * PI, upright, upright, first, second, 1.0, line)
        line[BEFORE] = before - log_tension(0.5 * PI, upright, upright, first, second, -1.0, line)
    if critical > 0.0:
        straight = log_tension(PI, 1.0, 0.0, line[HALF_COSINE], line[HALF_COSINE], -1.0, line)
        turned = log_tension(0.0, 0.0, 1.0, line[HALF_SINE], line[HALF_SINE], 1.0, line)
        line[BEYOND] = straight + line[BEFORE] - turned


@compiled
def logit_of_angle(angle, critical, tail):
    """u of an angle; NaN at the singular angles, as near to them as the angle is rounded, and beyond them."""
    low = angle - critical - tail
    # Differences of near numbers are exact: those of angle and pi above pi/2, those of angle and a_c below it.
    high = (critical - (angle - PI)) + (PI_TAIL + tail) if angle > 0.5 * PI else (PI - low) + PI_TAIL
    if not (low > ROUNDING * angle and high > ROUNDING * angle):
        return np.nan
    return np.log(np.tan(0.5 * low)) if low < high else -np.log(np.tan(0.5 * high))


@compiled
def angle_of_logit(u, critical):
    """Angle of u."""
    return critical + 2.0 * np.arctan(np.exp(u)) if u < 0.0 else critical + (PI - 2.0 * np.arctan(np.exp(-u)))


@compiled
def half_angles(u, line):
    """Sines and cosines at u: of (a - a_c) / 2 and of a / 2."""
    power = np.exp(-abs(u))
    greater = 1.0 / np.sqrt(1.0 + power * power)
    sine, cosine = (power * greater, greater) if u < 0.0 else (greater, power * greater)
    half_sine = sine * line[HALF_COSINE] + cosine * line[HALF_SINE]
    half_cosine = cosine * line[HALF_COSINE] - sine * line[HALF_SINE]
    return sine, cosine, half_sine, half_cosine


@compiled
def log_tension(x, half_sine, half_cosine, first, second, side, line):
    """Antiderivative of (side f_law c_1 + sin(a_c)^2 sin(x)) / E(x): the logarithm of the tension, in closed form.

    x is an angle of the first two quadrants, or of the third less pi, with sine and cosine of x / 2 and the sines
    `first` of (x + a_c) / 2 and `second` of |x - a_c| / 2. With J1 = int dx / (cos x - c_1) and
    K2 = int dx / (1 + c_1 cos x) all three laws are sums of J1, K2 and logarithms.
    """
    c_1, sine, half = line[COSINE], line[SINE], line[HALF_SINE]
    ratio = first * second / (half * half + c_1 * half_cosine * half_cosine)
    weight = -sine * sine * line[SCALE] * np.log(ratio) if sine > 0.0 else 0.0
    if line[LAW] == ZERO or line[FRICTION] == 0.0:
        return weight
    if sine > 0.0:
        growth = half_cosine * half if x > line[CRITICAL] else line[HALF_COSINE] * half_sine
        j_1 = np.log1p(2.0 * growth / second) / sine
        # Rounding may turn the sign of the cosine at pi, where the quotient is infinite.
        k_2 = 2.0 * np.arctan(half * half_sine / abs(line[HALF_COSINE] * half_cosine)) / sine
    else:
        j_1, k_2 = half_cosine / half_sine, half_sine / half_cosine
    if line[LAW] == CONSTANT:
        return weight + side * line[FRICTION] * c_1 * line[SCALE] * (j_1 - c_1 * k_2)
    return weight + side * line[FRICTION] * (x + line[SCALE] * (c_1**3 * j_1 - k_2))


@compiled
def tension_logarithm(u, line):
    """log(T) at u up to a constant that is one for all angles."""
    return _tension_logarithm(u, *half_angles(u, line), line)


@compiled
def _tension_logarithm(u, sine, cosine, half_sine, half_cosine, line):
    angle = angle_of_logit(u, line[CRITICAL]) if line[LAW] == COSINE_SQUARED else 0.5 * PI
    if u > line[U_STRAIGHT]:
        first = sine * line[SINE] - cosine * line[COSINE]
        beta = angle - PI if line[LAW] == COSINE_SQUARED else 0.0
        return log_tension(beta, -half_cosine, half_sine, first, cosine, 1.0, line) + line[BEYOND]
    first = sine * line[COSINE] + cosine * line[SINE]
    if u >= line[U_RIGHT]:
        return log_tension(angle, half_sine, half_cosine, first, sine, -1.0, line) + line[BEFORE]
    return log_tension(angle, half_sine, half_cosine, first, sine, 1.0, line)


@compiled
def _turn(u, sine, cosine, half_sine, half_cosine, line):
    """|da/du / E|: arc length on a walk along u, in units of T / M."""
    half = line[HALF_SINE]
    if u > line[U_STRAIGHT]:
        first = sine * line[SINE] - cosine * line[COSINE]
        return 0.5 * sine / (first * (half * half + line[COSINE] * half_sine * half_sine))
    first = sine * line[COSINE] + cosine * line[SINE]
    return 0.5 * cosine / (first * (half * half + line[COSINE] * half_cosine * half_cosine))


@compiled
def tension_rate(u, line):
    """|d log(T) / du|: how steep the integrands are, which a light line with friction makes very steep near a = pi."""
    sine, cosine, half_sine, half_cosine = half_angles(u, line)
    across = half_cosine * half_cosine - half_sine * half_sine
    friction = 0.0
    if line[LAW] == CONSTANT:
        friction = line[FRICTION] * line[COSINE]
    elif line[LAW] == COSINE_SQUARED:
        friction = line[FRICTION] * line[COSINE] * across * across
    outside = u > line[U_STRAIGHT] or u < line[U_RIGHT]
    pull = (friction if outside else -friction) + 2.0 * line[SINE] ** 2 * half_sine * abs(half_cosine)
    return abs(pull) * _turn(u, sine, cosine, half_sine, half_cosine, line)


@compiled
def slopes(u, line, reference):
    """d/du of length, horizontal and vertical distance in units of T_0 / M, with `reference` = log(T_0).

    Positive length: along increasing u, that is along a line walked from B to A.
    """
    sine, cosine, half_sine, half_cosine = half_angles(u, line)
    tension = np.exp(_tension_logarithm(u, sine, cosine, half_sine, half_cosine, line) - reference)
    length = tension * _turn(u, sine, cosine, half_sine, half_cosine, line)
    along, up = half_cosine * half_cosine - half_sine * half_sine, 2.0 * half_sine * half_cosine
    return length, length * along, length * up
