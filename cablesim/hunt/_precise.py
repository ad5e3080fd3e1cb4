"""Arithmetic with more digits than the solvers have, for references of a million scenarios.

Differences that cancel are taken between fractions, which are exact; the rest is done in floats of 64 bits of mantissa.
"""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from cablesim.batch import Results
from cablesim.numerics import Array

ROUNDING = float(np.finfo(float).eps)
# Roundings that a chain of some dozen operations may leave.
OPERATIONS = 16.0
# Sixty digits of pi.
PI = Fraction(3141592653589793238462643383279502884197169399375105820974944, 10**60)
# Between these lie the logarithms of all roots that are sought; halvings that leave less than a rounding.
LOWEST, HIGHEST, HALVINGS = -200.0, 9.0, 72


@dataclass(frozen=True)
class Answer:
    """A number, and what its error is measured by."""

    value: Array
    scale: Array


def longer(values: Array) -> Array:
    """The same numbers with room for more digits."""
    return np.asarray(values, dtype=np.longdouble)


def excess_of_squares(length: Array, ratio: Array | None, span: Array, rise: Array) -> Array:
    """length^2 - span^2 - rise^2, with all its digits; where there is a ratio, the length is ratio times span."""
    fractions = [_fractions(values) for values in (length if ratio is None else ratio, span, rise)]
    lines = zip(*fractions, strict=True)
    if ratio is None:
        return _rounded([long * long - across * across - up * up for long, across, up in lines])
    return _rounded([(times * times - 1) * across * across - up * up for times, across, up in lines])


def pi_times_less(factor: Array, less: Array) -> Array:
    """pi times a factor, less another number, with all its digits."""
    return _rounded([PI * one - other for one, other in zip(_fractions(factor), _fractions(less), strict=True)])


def increasing_root(function: Callable[[Array], Array], size: int) -> Array:
    """Positive roots of increasing functions, by bisection of the logarithm."""
    low, high = np.full(size, LOWEST, dtype=np.longdouble), np.full(size, HIGHEST, dtype=np.longdouble)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        above = function(np.exp(middle)) > 0.0
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    return np.exp(0.5 * (low + high))


def log_sinhc(x: Array) -> Array:
    """log(sinh(x) / x) in longer floats, from its series where x is small."""
    square, term = x * x, np.ones_like(x)
    small = np.zeros_like(x)
    for n in range(1, 14):
        term = term * np.minimum(square, 1.0) / (2 * n * (2 * n + 1))
        small = small + term
    large = np.maximum(x, 1.0)
    return np.where(x < 1.0, np.log1p(small), large + np.log1p(-np.exp(-2.0 * large)) - np.log(2.0 * large))


def worst(*misses: Array) -> Array:
    """The largest of some misses in every scenario."""
    return np.max(np.stack([np.asarray(miss, dtype=float) for miss in misses]), axis=0)


def worst_of(found: Results, answers: dict[str, Answer], allowed: Array) -> Array:
    """The largest miss of all outputs, over what is allowed of the scale of each."""
    return worst(
        *(np.abs(v - answers[name].value) / (answers[name].scale * allowed) for name, v in found.outputs.items())
    )


def _fractions(values: Array) -> list[Fraction]:
    return [Fraction(float(value)) for value in values]


def _rounded(values: list[Fraction]) -> Array:
    """Fractions as longer floats, by the float nearest to each and what that leaves out."""
    nearest = [float(value) for value in values]
    rest = [float(value - Fraction(near)) for value, near in zip(values, nearest, strict=True)]
    return longer(np.array(nearest)) + longer(np.array(rest))
