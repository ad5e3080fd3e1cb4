"""Sine, cosine and exponential without branches or tables, for loops over scenarios that run side by side.

The functions of a mathematical library are calls, and a loop with a call is not made of vector instructions. These are
plain sums and products, so that a loop `for lane in range(LANES)` around them becomes vector code; as nothing is
contracted or reordered, a number has the same bits in any lane and on any machine. Arguments are first moved next to
zero by a multiple of pi/2 or log 2 that is kept in parts, so short that their products are exact (Cody and Waite).

Largest errors in units of the last place, measured against forty digits: sine and cosine 1.4 up to a turn and 2.4 up to
`LARGEST_ANGLE`, next to their zeros as well; the exponential 1.0 from `LEAST_EXPONENT` to `LARGEST_EXPONENT`.
"""

import numpy as np

from cablesim.numerics.compiled import compiled

# Angles up to which a multiple of pi/2 times its first two parts is exact.
LARGEST_ANGLE = 1e6
# Beyond these the exponential is that of the bound: the results are not far from the least and largest numbers.
LEAST_EXPONENT, LARGEST_EXPONENT = -708.0, 709.0

# Adding it leaves the nearest integer in the last bits of the sum.
ROUNDING = 6755399441055744.0
QUARTER_TURNS = 0.6366197723675814
QUARTER_TURN = (1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21)
OCTAVES = 1.4426950408889634
OCTAVE = (0.6931471805598903, 5.497923018708371e-14)
EXPONENT_BIAS = 1023

# sin(r) / r - 1 over r^2 and cos(r) - 1 + r^2/2 over r^4 up to pi/4, from fdlibm (Sun Microsystems, 1993); the error of
# either sum is below 2^-57.
SINE = (
    -1.66666666666666324348e-01,
    8.33333333332248946124e-03,
    -1.98412698298579493134e-04,
    2.75573137070700676789e-06,
    -2.50507602534068634195e-08,
    1.58969099521155010221e-10,
)
COSINE = (
    4.16666666666666019037e-02,
    -1.38888888888741095749e-03,
    2.48015872894767294178e-05,
    -2.75573143513906633035e-07,
    2.08757232129817482790e-09,
    -1.13596475577881948265e-11,
)
# (exp(r) - 1 - r) / r^2 through the Chebyshev points of |r| <= log(2) / 2; error 2e-17.
EXPONENTIAL = (
    0.5000000000000001,
    0.16666666666666669,
    0.041666666666623824,
    0.008333333333330039,
    0.0013888888917367081,
    0.00019841269863171557,
    2.4801521057868204e-05,
    2.7557268276905696e-06,
    2.7620201591031547e-07,
    2.5100472505694996e-08,
)


@compiled
def sine_cosine(x: float) -> tuple[float, float]:
    """sin(x), cos(x); NaN for inf and NaN."""
    shifted = np.float64(x * QUARTER_TURNS + ROUNDING)
    turns = shifted - ROUNDING
    quarter = shifted.view(np.int64)
    r = ((x - turns * QUARTER_TURN[0]) - turns * QUARTER_TURN[1]) - turns * QUARTER_TURN[2]
    q = r * r
    s = SINE[3] + q * (SINE[4] + q * SINE[5])
    s = r + r * q * (SINE[0] + q * (SINE[1] + q * (SINE[2] + q * s)))
    c = COSINE[3] + q * (COSINE[4] + q * COSINE[5])
    c = 1.0 - (0.5 * q - q * q * (COSINE[0] + q * (COSINE[1] + q * (COSINE[2] + q * c))))
    sine = c if quarter & 1 else s
    cosine = s if quarter & 1 else c
    return (-sine if quarter & 2 else sine), (-cosine if (quarter + 1) & 2 else cosine)


@compiled
def exponential(x: float) -> float:
    """exp(x), held at its values at the bounds beyond them; NaN for NaN."""
    x = LEAST_EXPONENT if x < LEAST_EXPONENT else x
    x = LARGEST_EXPONENT if x > LARGEST_EXPONENT else x
    shifted = np.float64(x * OCTAVES + ROUNDING)
    octaves = shifted - ROUNDING
    r = (x - octaves * OCTAVE[0]) - octaves * OCTAVE[1]
    s = EXPONENTIAL[6] + r * (EXPONENTIAL[7] + r * (EXPONENTIAL[8] + r * EXPONENTIAL[9]))
    s = EXPONENTIAL[2] + r * (EXPONENTIAL[3] + r * (EXPONENTIAL[4] + r * (EXPONENTIAL[5] + r * s)))
    s = 1.0 + (r + r * r * (EXPONENTIAL[0] + r * (EXPONENTIAL[1] + r * s)))
    return s * np.int64((shifted.view(np.int64) + EXPONENT_BIAS) << 52).view(np.float64)
