"""Error-free arithmetic: products and differences of squares that keep the digits a plain float loses.

A line one part in 10^12 longer than its chord is described by the last four digits of the inputs; `L**2 - l**2 - h**2`
in plain floats returns noise there. These functions carry the rounding errors along (Dekker 1971, *A floating-point
technique for extending the available precision*, Numer. Math. 18, 224-242).
"""

from cablesim.numerics import Array

# Veltkamp's constant for a 53-bit significand: splits a float into two halves of 26 bits.
SPLITTER = 2.0**27 + 1.0


def two_sum(a: Array, b: Array) -> tuple[Array, Array]:
    """a + b as (rounded sum, rounding error), exactly, whichever is larger."""
    total = a + b
    shared = total - a
    return total, (a - (total - shared)) + (b - shared)


def two_product(a: Array, b: Array) -> tuple[Array, Array]:
    """a * b as (rounded product, rounding error), exactly while nothing overflows or underflows."""
    product = a * b
    a_high, a_low = _halves(a)
    b_high, b_low = _halves(b)
    return product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low


def two_square(a: Array) -> tuple[Array, Array]:
    """a**2 as (rounded square, rounding error)."""
    square = a * a
    high, low = _halves(a)
    return square, ((high * high - square) + 2.0 * high * low) + low * low


def excess_of_squares(length: Array, tail: Array | None, span: Array, rise: Array) -> Array:
    """(length + tail)**2 - span**2 - rise**2, correct to a few units in the last place even when it nearly vanishes.

    Below 1e-16 length**2 (a chord between two floats) the error stays below 1e-32 length**2, and so the sign is right.
    `tail` is the part of the length too small for the float `length` to hold (None where there is none).
    """
    length_high, length_low = two_square(length)
    span_high, span_low = two_square(span)
    rise_high, rise_low = two_square(rise)
    partial = length_high - span_high
    # The rounding error of this difference, exactly, where length >= span; elsewhere the result is plainly negative.
    error = (length_high - partial) - span_high
    # Exact where it nearly vanishes; where it does not, its rounding is no worse than that of the result.
    total = partial - rise_high
    error += length_low - span_low - rise_low
    return total + error if tail is None else total + (error + (2.0 * length + tail) * tail)


def _halves(a: Array) -> tuple[Array, Array]:
    scaled = SPLITTER * a
    high = scaled - (scaled - a)
    return high, a - high
