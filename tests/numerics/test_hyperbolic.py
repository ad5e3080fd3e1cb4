"""Hyperbolic functions against mpmath, from arguments where nothing is left of them to where they overflow."""

from collections.abc import Callable

import mpmath as mp
import numpy as np
import pytest

from cablesim.numerics import Array
from cablesim.numerics.hyperbolic import (
    SERIES_LIMIT,
    asinh_increment,
    cosh_excess,
    cosh_sinhc_difference,
    inverse_sinhc_excess,
    log_cosh,
    sinhc_excess,
)

EPS = np.finfo(float).eps
DIGITS = 60
# Both sides of the change from series to formula, and the formula where it cancels most.
ARGUMENTS = np.concatenate(
    [np.geomspace(1e-8, 700.0, 400), np.geomspace(0.9, 1.2, 200), np.nextafter(SERIES_LIMIT, [0.0, 1.0, 2.0])]
)

TEXTBOOK = {
    sinhc_excess: lambda x: mp.sinh(x) / x - 1,
    cosh_sinhc_difference: lambda x: mp.cosh(x) - mp.sinh(x) / x,
    cosh_excess: lambda x: mp.cosh(x) - 1,
    log_cosh: lambda x: mp.log(mp.cosh(x)),
}


def worst_error(found: Array, exact: Callable[..., mp.mpf], *arguments: Array) -> float:
    """Largest relative error; the exact function is given the float arguments at their exact values."""
    with mp.workdps(DIGITS):
        pairs = zip(found, *arguments, strict=True)
        return max(float(abs(mp.mpf(value) / exact(*map(mp.mpf, given)) - 1)) for value, *given in pairs)


# Just above the limit of the series, sinh(x)/x - 1 = 0.18 has lost a factor of 6 to cancellation.
@pytest.mark.parametrize(
    ("function", "units"), [(sinhc_excess, 6.0), (cosh_sinhc_difference, 4.0), (cosh_excess, 2.0), (log_cosh, 4.0)]
)
def test_no_digits_are_lost_at_any_argument(function: Callable[[Array], Array], units: float) -> None:
    assert worst_error(function(ARGUMENTS), TEXTBOOK[function], ARGUMENTS) <= units * EPS


@pytest.mark.parametrize("function", TEXTBOOK)
def test_an_argument_does_not_depend_on_its_neighbours(function: Callable[[Array], Array]) -> None:
    alone = np.array([function(np.array([x]))[0] for x in ARGUMENTS])
    np.testing.assert_array_equal(function(ARGUMENTS), alone)


@pytest.mark.parametrize("function", TEXTBOOK)
def test_they_are_even_and_vanish_at_zero(function: Callable[[Array], Array]) -> None:
    np.testing.assert_array_equal(function(-ARGUMENTS), function(ARGUMENTS))
    assert function(np.zeros(1))[0] == 0.0


def test_the_inverse_is_right_to_two_units_in_the_last_place_over_all_floats() -> None:
    excess = np.geomspace(1e-16, 1e300, 1500)
    assert worst_error(inverse_sinhc_excess(excess), _inverse, excess) <= 4e-16


def _inverse(excess: mp.mpf) -> mp.mpf:
    """x with sinh(x) / x = 1 + excess: Newton from above on a convex function."""
    log_ratio = mp.log1p(excess)
    x = min(mp.sqrt(6 * excess), log_ratio + 2 * mp.log(2 + log_ratio) + 1)
    for _ in range(12):
        x -= (mp.sinh(x) - x - x * excess) / (mp.cosh(x) - 1 - excess)
    return x


def test_an_increment_of_asinh_keeps_its_digits_however_small_it_is() -> None:
    rng = np.random.default_rng(1)
    start = rng.choice([-1.0, 1.0], 3000) * 10.0 ** rng.uniform(-8, 8, 3000)
    step = 10.0 ** rng.uniform(-14, 8, 3000)
    # A third of the steps end close to zero, on either side.
    across = 1.0 + rng.choice([-1.0, 1.0], 1000) * 10.0 ** rng.uniform(-15, 0, 1000)
    start[:1000], step[:1000] = -np.abs(start[:1000]), np.abs(start[:1000]) * across
    found = asinh_increment(start, step)
    assert worst_error(found, lambda a, b: mp.asinh(a + b) - mp.asinh(a), start, step) <= 4.0 * EPS


def test_an_increment_of_asinh_is_antisymmetric_and_zero_for_no_step() -> None:
    start, step = np.array([-3.0, 0.0, 2.0]), np.array([0.5, 1e-9, 7.0])
    np.testing.assert_array_equal(asinh_increment(-start, -step), -asinh_increment(start, step))
    np.testing.assert_array_equal(asinh_increment(start, np.zeros(3)), np.zeros(3))
