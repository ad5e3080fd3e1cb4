"""Numbers of more digits than the solvers have, for second answers: extended precision where the machine has it.

Where it has not (`np.longdouble` is a double there), the allowances grow with PRECISION, and judge less.
"""

import numpy as np

from cablesim.numerics import Array

# Extended numbers are rounded by this part of themselves.
PRECISION = float(np.finfo(np.longdouble).eps)
# Splits a float into a half of 26 bits and a rest, whose products are exact in extended precision.
SPLITTER = 2.0**27 + 1.0
# sinh(x)/x - 1 = x^2/6 (1 + x^2/20 (1 + ...)): from below this on so many terms leave nothing.
SERIES_BELOW, SERIES_TERMS = 1.0, 12


def extended(values: Array) -> np.ndarray:
    """The same numbers with room for more digits."""
    return np.asarray(values, dtype=np.longdouble)


def excess_of_squares(length: Array, span: Array, rise: Array) -> np.ndarray:
    """length**2 - span**2 - rise**2, from exact products of halves, summed with what every sum leaves out."""
    total = rest = extended(np.zeros_like(length))
    for sign, values in ((1, length), (-1, span), (-1, rise)):
        high, low = _halves(values)
        for term in (sign * high * high, sign * 2 * high * low, sign * low * low):
            longer = total + term
            shared = longer - total
            rest = rest + ((total - (longer - shared)) + (term - shared))
            total = longer
    return total + rest


def sinhc_excess(x: np.ndarray) -> np.ndarray:
    """sinh(x) / x - 1."""
    square = np.minimum(x, SERIES_BELOW) ** 2
    total = np.ones_like(square)
    for n in range(SERIES_TERMS, 1, -1):
        total = 1 + total * square / (2 * n * (2 * n + 1))
    return np.where(x < SERIES_BELOW, total * square / 6, np.sinh(x) / x - 1)


def log_sinhc(x: np.ndarray) -> np.ndarray:
    """log(sinh(x) / x)."""
    far = np.maximum(x, SERIES_BELOW)
    return np.where(
        x < SERIES_BELOW,
        np.log1p(sinhc_excess(np.minimum(x, SERIES_BELOW))),
        far - np.log(2 * far) + np.log1p(-np.exp(-2 * far)),
    )


def off(found: Array, expected: np.ndarray, scale: np.ndarray | float = 0.0) -> Array:
    """By how much an answer is off, relative to what it should be, or to a scale where that is larger."""
    return (np.abs(extended(found) - expected) / np.maximum(np.abs(expected), scale)).astype(float)


def _halves(values: Array) -> tuple[np.ndarray, np.ndarray]:
    turned = SPLITTER * values
    high = turned - (turned - values)
    return extended(high), extended(values - high)
