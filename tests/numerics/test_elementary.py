"""Sine, cosine and exponential without branches against mpmath, and the same bits in vectors as alone."""

import mpmath as mp
import numba
import numpy as np
import pytest

from cablesim.numerics import Array
from cablesim.numerics.elementary import (
    LARGEST_ANGLE,
    LARGEST_EXPONENT,
    LEAST_EXPONENT,
    exponential,
    sine_cosine,
)
from cablesim.numerics.lanes import LANES

DIGITS = 40
RNG = np.random.default_rng(3)
# Up to a turn; large ones, and the doubles next to the zeros of sine and cosine.
SMALL = np.concatenate([RNG.uniform(-6.3, 6.3, 3000), [0.0, -0.0, 1e-300, 1e-9, 0.25 * np.pi, -0.25 * np.pi]])
LARGE = np.concatenate(
    [
        RNG.uniform(-LARGEST_ANGLE, LARGEST_ANGLE, 2000),
        RNG.integers(-600_000, 600_000, 2000) * (0.5 * np.pi),
        [LARGEST_ANGLE, -LARGEST_ANGLE],
    ]
)
EXPONENTS = np.concatenate(
    [
        RNG.uniform(LEAST_EXPONENT, LARGEST_EXPONENT, 3000),
        RNG.uniform(-2.0, 2.0, 3000),
        np.array([0.0, -0.0, 1e-300, 1e-9, 0.5 * np.log(2.0), -0.5 * np.log(2.0), LEAST_EXPONENT, LARGEST_EXPONENT]),
    ]
)


@numba.njit(error_model="numpy")
def in_vectors(x, sine, cosine, exponent):
    # The length is not known to the compiler, which then makes vector code (see waves.fluid_at).
    for i in range(x.size):
        sine[i], cosine[i] = sine_cosine(x[i])
    for i in range(x.size):
        exponent[i] = exponential(x[i])


def values(x: Array) -> Array:
    found = np.empty((3, x.size))
    in_vectors(x, *found)
    return found


def units_off(found: Array, x: Array, function: str) -> Array:
    """Errors in units of the last place of the true value."""
    with mp.workdps(DIGITS):
        true = [getattr(mp, function)(mp.mpf(float(value))) for value in x]
        errors = [float(abs(mp.mpf(float(y)) - t)) for y, t in zip(found, true, strict=True)]
    return np.array(errors) / np.spacing(np.abs(np.array([float(t) for t in true])))


# A tenth more than the largest errors of 200,000 random arguments: 1.28 and 1.35, 2.06 and 2.31, 1.00.
PROMISES = (
    (0, "sin", SMALL, 1.5),
    (1, "cos", SMALL, 1.5),
    (0, "sin", LARGE, 2.5),
    (1, "cos", LARGE, 2.5),
    (2, "exp", EXPONENTS, 1.1),
)


@pytest.mark.parametrize(("row", "function", "arguments", "promised"), PROMISES)
def test_errors_are_below_what_is_promised(row, function, arguments, promised):
    assert units_off(values(arguments)[row], arguments, function).max() <= promised


def test_bits_are_the_same_in_vectors_and_alone():
    x = np.concatenate([SMALL[:503], LARGE[:500], EXPONENTS[:1000]])
    alone = np.array([(*sine_cosine(value), exponential(value)) for value in x]).T
    assert np.array_equal(values(x), alone)


def test_a_lane_does_not_see_the_others():
    x = RNG.uniform(-50.0, 50.0, LANES)
    spoilt = np.full(LANES, np.nan)
    spoilt[3] = x[3]
    assert np.array_equal(values(spoilt)[:, 3], values(x)[:, 3])


def test_infinite_angles_have_no_sine_and_nan_stays_nan():
    sine, cosine, _ = values(np.array([np.inf, -np.inf, np.nan]))
    assert np.isnan(sine).all() and np.isnan(cosine).all()
    assert np.isnan(exponential(np.nan))


def test_the_exponential_is_held_at_its_bounds():
    assert exponential(-np.inf) == exponential(-1e5) == exponential(LEAST_EXPONENT) > 0.0
    assert exponential(np.inf) == exponential(1e5) == exponential(LARGEST_EXPONENT) < np.inf
