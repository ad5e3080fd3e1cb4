"""Hyperbolic functions of small arguments, without cancellation, and the inverse that every catenary needs.

`sinh(x) - x` loses every digit as x -> 0, which is where a taut line lives. Below `SERIES_LIMIT` the Taylor series is
used; its truncation error there is below 1e-17 of the sum.
"""

import math
from collections.abc import Callable

import numpy as np

from cablesim.numerics import Array

SERIES_LIMIT = 1.0
# sinh(x)/x - 1 = sum of x^(2n)/(2n+1)!, n >= 1; at x = 1 the tenth term is 1e-18 of the first.
SINH_SERIES = tuple(1.0 / math.factorial(2 * n + 1) for n in range(1, 10))
# cosh(x) - sinh(x)/x = sum of 2n/(2n+1)! x^(2n), n >= 1.
COSH_SERIES = tuple(2.0 * n / math.factorial(2 * n + 1) for n in range(1, 10))

# sinh overflows above 710; a line that needs more is longer than 1e300 spans.
LARGEST_ARGUMENT = 700.0
HALLEY_STEPS = 2


def sinhc_excess(x: Array) -> Array:
    """sinh(x)/x - 1."""
    return _by_size(x, SINH_SERIES, lambda x: np.sinh(x) / x - 1.0)


def cosh_sinhc_difference(x: Array) -> Array:
    """cosh(x) - sinh(x)/x."""
    return _by_size(x, COSH_SERIES, lambda x: np.cosh(x) - np.sinh(x) / x)


def cosh_excess(x: Array) -> Array:
    """cosh(x) - 1."""
    half = np.sinh(0.5 * x)
    return 2.0 * half * half


def log_cosh(x: Array) -> Array:
    """log(cosh(x)), also where cosh overflows."""
    size = np.abs(x)
    return np.where(size < 1.0, np.log1p(cosh_excess(size)), size + np.log1p(np.exp(-2.0 * size)) - np.log(2.0))


def asinh_increment(start: Array, step: Array) -> Array:
    """asinh(start + step) - asinh(start), for a step however small beside the start.

    From sinh(u - v) = sinh u cosh v - cosh u sinh v. Where both ends have one sign the difference of the two products
    is written as (end**2 - start**2) over their sum, which cancels nothing.
    """
    end = start + step
    forward, backward = end * np.sqrt(1.0 + start * start), start * np.sqrt(1.0 + end * end)
    with np.errstate(divide="ignore", invalid="ignore"):
        one_sided = step * (end + start) / (forward + backward)
    return np.arcsinh(np.where(start * end > 0.0, one_sided, forward - backward))


def inverse_sinhc_excess(excess: Array) -> Array:
    """The x > 0 with sinh(x)/x - 1 = excess > 0.

    Halley's method on log(sinh(x)/x) = t, t = log(1 + excess), which is almost linear for large x. The start
    x**2 = 6 t + 1.2 t**2 has the two leading terms for small t and is within 9 % up to the overflow of sinh, so a
    fixed number of steps reaches the last digit everywhere (measured in the tests). The slope q = x coth(x) - 1
    follows from q (2 + q) = x**2 - 1 + (x / sinh(x))**2.
    """
    log_ratio = np.log1p(excess)
    x = np.minimum(np.sqrt(log_ratio * (6.0 + 1.2 * log_ratio)), LARGEST_ARGUMENT)
    for _ in range(HALLEY_STEPS):
        ratio_excess = sinhc_excess(x)
        inverse = 1.0 / (1.0 + ratio_excess)
        deficit = ratio_excess * inverse * (1.0 + inverse)
        square = x * x - deficit
        slope = square / (1.0 + np.sqrt(1.0 + square))
        newton = np.log1p((ratio_excess - excess) / (1.0 + excess)) / slope
        x = x - x * newton / (1.0 - 0.5 * newton * deficit / slope)
    return x


def _by_size(x: Array, series: tuple[float, ...], direct: Callable[[Array], Array]) -> Array:
    """The series where |x| is small, the direct formula elsewhere; the latter is evaluated for those alone."""
    large = np.flatnonzero(np.abs(x) >= SERIES_LIMIT)
    if large.size == x.size:
        return direct(x)
    values = _sum(series, x * x)
    if large.size:
        values.flat[large] = direct(x.flat[large])
    return values


def _sum(coefficients: tuple[float, ...], square: Array) -> Array:
    total = coefficients[-1] * square
    for coefficient in coefficients[-2::-1]:
        total += coefficient
        total *= square
    return total
