"""Error-free arithmetic against rational numbers."""

from fractions import Fraction
from math import isqrt

import numpy as np
import pytest

from cablesim.numerics import Array
from cablesim.numerics.exact import excess_of_squares, two_product, two_square, two_sum

EPS = np.finfo(float).eps


def spread(rng: np.random.Generator, size: int, decades: float = 60.0) -> Array:
    """Floats of both signs over the magnitudes that parameters may have."""
    return rng.choice([-1.0, 1.0], size) * 10.0 ** rng.uniform(-decades, decades, size)


def assert_exact(parts: tuple[Array, Array], expected: list[Fraction]) -> None:
    high, low = parts
    assert [Fraction(a) + Fraction(b) for a, b in zip(high, low, strict=True)] == expected
    np.testing.assert_array_equal(high + low, high)  # the second part is the rounding of the first


@pytest.mark.parametrize("decades", [0.5, 16.0, 60.0])
def test_a_sum_and_its_rounding_error_make_up_the_exact_sum(decades: float) -> None:
    """Of any two floats, the first the larger or the smaller, of one sign or nearly cancelling."""
    rng = np.random.default_rng(1)
    a, b = spread(rng, 2000, decades), spread(rng, 2000, decades)
    nearly = -a * (1.0 + EPS * rng.integers(-3, 4, 2000))
    for other in (b, nearly):
        assert_exact(two_sum(a, other), [Fraction(x) + Fraction(y) for x, y in zip(a, other, strict=True)])


def test_a_sum_does_not_depend_on_the_order_and_nothing_is_lost_beside_zero() -> None:
    rng = np.random.default_rng(8)
    a, b = spread(rng, 2000, 20.0), spread(rng, 2000, 20.0)
    for one, other in zip(two_sum(a, b), two_sum(b, a), strict=True):
        np.testing.assert_array_equal(one, other)
    np.testing.assert_array_equal(two_sum(a, np.zeros(2000)), (a, np.zeros(2000)))


def test_a_product_and_its_rounding_error_make_up_the_exact_product() -> None:
    rng = np.random.default_rng(2)
    a, b = spread(rng, 2000), spread(rng, 2000)
    assert_exact(two_product(a, b), [Fraction(x) * Fraction(y) for x, y in zip(a, b, strict=True)])


def test_a_square_and_its_rounding_error_make_up_the_exact_square() -> None:
    a = spread(np.random.default_rng(3), 2000)
    assert_exact(two_square(a), [Fraction(x) ** 2 for x in a])


def exact_excess(length: Array, tail: Array, span: Array, rise: Array) -> list[Fraction]:
    given = zip(length, tail, span, rise, strict=True)
    return [(Fraction(a) + Fraction(b)) ** 2 - Fraction(c) ** 2 - Fraction(d) ** 2 for a, b, c, d in given]


def relative_errors(found: Array, exact: list[Fraction]) -> Array:
    return np.array([float(abs(Fraction(f) / e - 1)) for f, e in zip(found, exact, strict=True)])


def test_an_excess_of_squares_keeps_its_digits_down_to_one_part_in_ten_to_the_fifteen() -> None:
    rng = np.random.default_rng(4)
    span, rise = 10.0 ** rng.uniform(-3, 3, 3000), spread(rng, 3000, decades=3.0)
    longer = rng.choice([-0.5, 1.0], 3000) * 10.0 ** rng.uniform(-15, 0, 3000)
    length = np.hypot(span, rise) * (1.0 + longer)
    tail = length * EPS * rng.uniform(-0.5, 0.5, 3000)
    exact = exact_excess(length, tail, span, rise)
    resolved = np.array([abs(e) > EPS * Fraction(L) ** 2 for e, L in zip(exact, length, strict=True)])
    assert resolved.sum() > 2500
    assert relative_errors(excess_of_squares(length, tail, span, rise), exact)[resolved].max() <= 2.0 * EPS


def test_the_excess_of_a_product_is_that_of_the_exact_product() -> None:
    """A line of 1 + 1e-12 spans, whatever the span."""
    span = np.random.default_rng(5).uniform(1.0, 1e3, 500)
    ratio = np.full(500, 1.0 + 1e-12)
    level = np.zeros(500)
    exact = [(Fraction(ratio[0]) ** 2 - 1) * Fraction(value) ** 2 for value in span]
    found = excess_of_squares(*two_product(ratio, span), span, level)
    assert relative_errors(found, exact).max() <= 2.0 * EPS


def test_the_excess_of_a_right_triangle_is_exactly_zero() -> None:
    """(m^2 + k^2)^2 = (m^2 - k^2)^2 + (2 m k)^2 with sides of 53 bits, whose squares no float can hold."""
    rng = np.random.default_rng(6)
    m, k = rng.integers(2**25, 67_108_864, 5000), rng.integers(1, 67_108_864, 5000)
    long, short, other = (np.abs(side).astype(float) for side in (m * m + k * k, m * m - k * k, 2 * m * k))
    np.testing.assert_array_equal(excess_of_squares(long, np.zeros(5000), short, other), np.zeros(5000))


@pytest.mark.parametrize("longer", [0, 1])
def test_the_sign_of_the_excess_is_right_for_the_integer_lengths_next_to_any_chord(longer: int) -> None:
    rng = np.random.default_rng(7)
    spans, rises = (rng.integers(1, 2**52, 3000).tolist() for _ in range(2))
    lengths = [isqrt(a * a + b * b) + longer for a, b in zip(spans, rises, strict=True)]
    columns = [np.array(values, dtype=float) for values in (lengths, [0] * 3000, spans, rises)]
    expected = [(e > 0) - (e < 0) for e in exact_excess(*columns)]
    np.testing.assert_array_equal(np.sign(excess_of_squares(*columns)), expected)
