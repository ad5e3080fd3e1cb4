"""Write the frequencies that lines in motion are tested against, correct to 20 digits: wave_frequencies.csv.

    nice python tests/reference/make_wave_references.py

Independent of cablesim. All are made dimensionless, so that each row holds for every line of its kind; `parameter` is
what the frequency depends on besides its number, `mode`, counted from 1:

- hanging_chain: omega sqrt(L / g), the zeros of J0 divided by 2; g times submerged over moving mass where they differ;
- string: omega L sqrt(m / T) across, and omega L sqrt(m / EA) along a line whose ends are fixed: n pi;
- bar_free: omega L sqrt(m / EA) along a line with one end free: (n - 1/2) pi;
- string_lumped, string_consistent: the same as `string` for `parameter` equal elements;
- shallow_symmetric: omega l sqrt(m / H) of an elastic line of small sag between fixed ends at distance l, symmetric and
  in its plane, `parameter` lambda^2 = (q l / H)^2 l EA / (H L_e), q the weight per length across the chord,
  L_e = l (1 + 8 (sag / l)^2): Irvine and Caughey (1974), tan(w / 2) = w / 2 - (4 / lambda^2) (w / 2)^3;
- shallow_antisymmetric: the antisymmetric ones, 2 n pi, whatever lambda^2 is.

For an extensible string L is the unstretched length and T / stretch takes the place of T. Needs mpmath.
"""

import csv
from collections.abc import Iterator
from pathlib import Path

import mpmath as mp

FOLDER = Path(__file__).parent
WORKING_DIGITS = 50
CHECKED_DIGITS = 30
PRINTED_DIGITS = 20
MODES = 8
ELEMENTS = (10, 20, 40, 80)
SYMMETRIC_MODES = 4
# From a taut string through the first and the second crossing, 4 pi^2 and 16 pi^2, to a line that does not stretch.
LAMBDA_SQUARED = (
    "0.01",
    "0.1",
    "1",
    "3",
    "10",
    "20",
    "30",
    "50",
    "70",
    "100",
    "150",
    "200",
    "400",
    "1000",
    "1e4",
    "1e6",
)

SOURCE = f"""\
# Natural frequencies of lines, dimensionless, rounded to {PRINTED_DIGITS} digits; made with mpmath at {WORKING_DIGITS}
# digits by make_wave_references.py, which tells what each kind and its parameter mean. Checked to 1e-{CHECKED_DIGITS}:
# each shallow_symmetric one solves 1 + lambda^2 sum of 8 / (n pi)^2 / ((n pi)^2 - w^2) over odd n = 0, the equation of
# the modes of a string that are coupled by the added tension; those of elements solve the problem of their matrices
"""

Row = tuple[str, str, int, mp.mpf]


def main() -> None:
    with (FOLDER / "wave_frequencies.csv").open("w", encoding="utf-8", newline="") as file:
        file.write(SOURCE)
        table = csv.writer(file, lineterminator="\n")
        table.writerow(("kind", "parameter", "mode", "frequency"))
        with mp.workdps(WORKING_DIGITS):
            for kind, parameter, mode, frequency in rows():
                table.writerow((kind, parameter, mode, mp.nstr(frequency, PRINTED_DIGITS)))


def rows() -> Iterator[Row]:
    numbers = range(1, MODES + 1)
    yield from (("hanging_chain", "", n, mp.besseljzero(0, n) / 2) for n in numbers)
    yield from (("string", "", n, n * mp.pi) for n in numbers)
    yield from (("bar_free", "", n, (n - mp.mpf(1) / 2) * mp.pi) for n in numbers)
    for elements in ELEMENTS:
        yield from (("string_lumped", str(elements), n, _lumped(n, elements)) for n in numbers)
        yield from (("string_consistent", str(elements), n, _consistent(n, elements)) for n in numbers)
    for given in LAMBDA_SQUARED:
        yield from (
            ("shallow_symmetric", given, n, symmetric_frequency(mp.mpf(given), n))
            for n in range(1, SYMMETRIC_MODES + 1)
        )
    yield from (("shallow_antisymmetric", "", n, 2 * n * mp.pi) for n in numbers)


# ---- the string of equal elements, by its matrices' common eigenvectors sin(n pi j / N) ----


def _lumped(n: int, elements: int) -> mp.mpf:
    return _checked(2 * elements * mp.sin(n * mp.pi / (2 * elements)), n, elements, mp.mpf(0))


def _consistent(n: int, elements: int) -> mp.mpf:
    cos = mp.cos(n * mp.pi / elements)
    return _checked(elements * mp.sqrt(6 * (1 - cos) / (2 + cos)), n, elements, mp.mpf(1) / 6)


def _checked(frequency: mp.mpf, n: int, elements: int, coupling: mp.mpf) -> mp.mpf:
    """Stiffness N (-1, 2, -1) and mass (c, 1 - 2c, c) / N on the mode, at the node where it is largest."""
    node = round(elements / (2 * n)) or 1
    before, here, after = (mp.sin(n * mp.pi * (node + k) / elements) for k in (-1, 0, 1))
    force = elements * (2 * here - before - after)
    inertia = (coupling * (before + after) + (1 - 2 * coupling) * here) / elements
    _require(force - frequency**2 * inertia, force)
    return frequency


# ---- the shallow elastic line ----


def symmetric_frequency(lambda_squared: mp.mpf, mode: int) -> mp.mpf:
    """w lies between (2 mode - 1) pi and (2 mode + 1) pi, where tan(w / 2) runs once from -inf to inf."""
    low, high = ((2 * mode + side) * mp.pi / 2 for side in (-1, 1))

    def mismatch(x: mp.mpf) -> mp.mpf:
        return mp.sin(x) - (x - 4 / lambda_squared * x**3) * mp.cos(x)

    frequency = 2 * mp.findroot(mismatch, (low, high), solver="illinois", tol=mp.mpf(10) ** (-2 * CHECKED_DIGITS))
    if not 2 * low < frequency < 2 * high:
        raise ArithmeticError(f"mode {mode} at lambda^2 = {mp.nstr(lambda_squared, 5)} left its interval")
    _require(_secular(frequency, lambda_squared), mp.mpf(1))
    return frequency


def _secular(frequency: mp.mpf, lambda_squared: mp.mpf) -> mp.mpf:
    def term(k: mp.mpf) -> mp.mpf:
        square = ((2 * k - 1) * mp.pi) ** 2
        return 8 / square / (square - frequency**2)

    return 1 / lambda_squared + mp.nsum(term, [1, mp.inf])


def _require(error: mp.mpf, scale: mp.mpf) -> None:
    if not abs(error) < mp.mpf(10) ** -CHECKED_DIGITS * abs(scale):
        raise ArithmeticError(f"an equation is met only to {mp.nstr(error / scale, 3)}")


if __name__ == "__main__":
    main()
