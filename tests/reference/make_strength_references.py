"""Write the references of the line of equal strength, correct to 20 digits: strength_lines.csv.

    nice python tests/reference/make_strength_references.py

Independent of cablesim. The line that is everywhere under the permitted stress carries V = H sinh(s / k) and
T = H cosh(s / k), s from the vertex of its curve y = -k ln cos(x / k); its slope is angle = x / k, so sinh(s / k) =
tan(angle), and its cross-section is 1 / cos(angle) of the one at the vertex. Through ends `span` and `rise` apart there
is one such curve: cos(angle_B) / cos(angle_A) = exp(-rise / k), angle_B - angle_A = span / k give

    tan(mean of the angles) = tanh(rise / 2k) / tan(span / 2k).

The line so built keeps its weight under another horizontal force r H: then V = H (sinh(s / k) + c), with the c that
lets the ends keep their rise, the integral of V / T along the line, T = hypot(r H, V); their horizontal distance is
that of r H / T, and the stress over the permitted one is T / (H cosh(s / k)). Needs mpmath. The same seed gives the
same bytes.
"""

import csv
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path

import mpmath as mp
import numpy as np

FOLDER = Path(__file__).parent
SEED = 20263
DESIGN_DIGITS = 700  # 1 - tanh(rise / 2k) is exp(-rise / k), and rise is up to 600 k
WORKING_DIGITS = 60
QUADRATURE_DIGITS = 45
CHECKED_DIGITS = 38
PRINTED_DIGITS = 20
POINTS = 40  # of Gauss and Legendre, on each piece
ARC_FRACTIONS = ("0", "0.25", "0.5", "0.75", "1")

INPUTS = ("strength_length", "span", "rise", "force_ratio")
OUTPUTS = (
    "drop",
    "line_length",
    "area_ratio_A",
    "area_ratio_B",
    "weight_over_force",
    "saved_weight_fraction",
    "distance_over_span",
    "max_stress_ratio",
    "stress_ratio",
)

SOURCE = f"""\
# Lines of equal strength between two ends, inputs exactly as printed (SI), outputs rounded to {PRINTED_DIGITS} digits;
# made by make_strength_references.py with mpmath: y = -k ln cos(x/k) through both ends, k = strength_length (permitted
# stress over weight per volume). drop: of the vertex of the curve below the upper end, though it need not lie on the
# line; area ratios: to the cross-section that carries the horizontal force alone; saved_weight_fraction: against an
# equally long line as thick as the thicker end everywhere; weight_over_force: under the force of the design.
# The last three: of the line so built when the horizontal force is force_ratio times that of the design and the ends
# keep their rise: horizontal distance of the ends over span, and stress over the permitted one, the largest anywhere,
# and at {", ".join(ARC_FRACTIONS)} of the length from A. Checked: the integrals of dx and dz along the line, over arc
# length and over asinh(V/H), agree with each other and with the design to 1e-{CHECKED_DIGITS} of the length
"""

Row = dict[str, str | float]


def main() -> None:
    rng = np.random.default_rng(SEED)
    with (FOLDER / "strength_lines.csv").open("w", encoding="utf-8", newline="") as file:
        file.write(SOURCE)
        table = csv.writer(file, lineterminator="\n")
        table.writerow(("family", *INPUTS, *OUTPUTS))
        for row in rows(rng):
            table.writerow([row["family"], *(repr(row[name]) for name in INPUTS), *answer(row)])


# ---- what is asked ----


def rows(rng: np.random.Generator) -> Iterator[Row]:
    for _ in range(150):
        yield _row(rng, "random", _log_uniform(rng, 1e-3, 0.999), rng.uniform(-2.0, 2.0))
    for share in np.geomspace(1e-3, 0.999, 8):
        yield _row(rng, "level", share, 0.0)
    for share in (1e-3, 0.1, 0.9):
        yield _row(rng, "design_force", share, rng.uniform(-2.0, 2.0), 1.0)
    for steepness in (-1e3, -30.0, 30.0, 1e3):
        for rise in (1e-3, 1.0, 30.0, 600.0):  # in units of k
            yield _row(rng, "steep", min(rise / abs(steepness) / np.pi, 0.999), steepness)
    for share in (1e-12, 1e-9, 1e-6, 1 - 1e-6, 1 - 1e-9, 1 - 1e-12):
        for slope in (0.0, rng.uniform(-2.0, 2.0)):
            yield _row(rng, "short" if share < 0.5 else "long", share, slope)
    for force_ratio in (1e-3, 1e-2, 1e2, 1e3):
        for share in (0.01, 0.5, 0.99):
            yield _row(rng, "extreme_force", share, rng.uniform(-2.0, 2.0), force_ratio)


def _row(
    rng: np.random.Generator, family: str, share: float, steepness: float, force_ratio: float | None = None
) -> Row:
    """A line given by span over pi k, the largest that there is, and by rise over span."""
    k = _log_uniform(rng, 10.0, 1e5)
    span = float(share * np.pi * k)
    force_ratio = _log_uniform(rng, 0.05, 5.0) if force_ratio is None else force_ratio
    values = (k, span, float(steepness * span), force_ratio)
    return {"family": family, **dict(zip(INPUTS, values, strict=True))}


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


# ---- the design ----


def answer(row: Row) -> Iterator[str]:
    k, span, rise, force_ratio = (mp.mpf(row[name]) for name in INPUTS)
    with mp.workdps(DESIGN_DIGITS):
        design = Design(k, *_end_angles(span / k, rise / k))
        answers = [*design.answers()]
    with mp.workdps(WORKING_DIGITS):
        line = BuiltLine(*(mp.asinh(+mp.tan(angle)) for angle in (design.angle_A, design.angle_B)))
        line.check(span / k, rise / k)
        c = line.closing(rise / k, force_ratio)
        distance = line.distance(force_ratio, c)
        answers += [distance * k / span, line.largest_stress(force_ratio, c)]
        stresses = [line.stress(line.place(mp.mpf(part)), force_ratio, c) for part in ARC_FRACTIONS]
    yield from map(_printed, answers)
    yield " ".join(map(_printed, stresses))


def _end_angles(span: mp.mpf, rise: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
    mean = mp.atan(mp.tanh(rise / 2) / mp.tan(span / 2))
    return mean - span / 2, mean + span / 2


@dataclass(frozen=True)
class Design:
    k: mp.mpf
    angle_A: mp.mpf
    angle_B: mp.mpf

    def answers(self) -> Iterator[mp.mpf]:
        area_A, area_B = 1 / mp.cos(self.angle_A), 1 / mp.cos(self.angle_B)
        thickest = max(area_A, area_B)
        length = mp.asinh(mp.tan(self.angle_B)) - mp.asinh(mp.tan(self.angle_A))
        weight = mp.tan(self.angle_B) - mp.tan(self.angle_A)
        yield self.k * mp.log(thickest)
        yield self.k * length
        yield from (area_A, area_B, weight)
        yield 1 - weight / (thickest * length)


# ---- the line so built, under another force; lengths in units of k, forces in units of that of the design ----


@dataclass(frozen=True)
class BuiltLine:
    """The line between two arc lengths from the vertex that it was designed with; V = sinh(s) + c, H = r."""

    s_A: mp.mpf
    s_B: mp.mpf

    def length(self) -> mp.mpf:
        return self.s_B - self.s_A

    def place(self, part: mp.mpf) -> mp.mpf:
        return self.s_A + part * self.length()

    def distance(self, r: mp.mpf, c: mp.mpf) -> mp.mpf:
        """By arc length, and checked by asinh(V / H)."""
        distance, rise, _ = self._integrals(r, c)
        angles = [mp.asinh((mp.sinh(s) + c) / r) for s in (self.s_A, self.s_B)]
        other_distance, other_rise = _integral(lambda p: _rates_of_angle(p, r, c), *angles)
        _require(distance - other_distance, self.length())
        _require(rise - other_rise, self.length())
        return distance

    def check(self, span: mp.mpf, rise: mp.mpf) -> None:
        """Under the force of the design the ends are where they were designed to be."""
        x, z, _ = self._integrals(mp.mpf(1), mp.mpf(0))
        _require(x - span, self.length())
        _require(z - rise, self.length())

    def closing(self, rise: mp.mpf, r: mp.mpf) -> mp.mpf:
        """The c with which the line rises by `rise`: its slope passes that of a straight line between A and B."""
        straight = r * rise / mp.sqrt(self.length() ** 2 - rise**2)
        lowest, highest = straight - mp.sinh(self.s_B), straight - mp.sinh(self.s_A)

        def error(c: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
            _, z, slope = self._integrals(r, c)
            return z - rise, slope

        start = min(max(mp.mpf(0), lowest), highest)
        low = high = start
        while low > lowest and error(low)[0] > 0:
            low = max(lowest, low - (start + r - low))
        while high < highest and error(high)[0] < 0:
            high = min(highest, high + (high + r - start))
        return _root(error, low, high, mp.mpf(10) ** -CHECKED_DIGITS * r)

    def stress(self, s: mp.mpf, r: mp.mpf, c: mp.mpf) -> mp.mpf:
        return mp.hypot(r, mp.sinh(s) + c) / mp.cosh(s)

    def largest_stress(self, r: mp.mpf, c: mp.mpf) -> mp.mpf:
        """At an end, or where its square, (r^2 + c^2 + 1) / 2 + q cos(2 angle) + c sin(2 angle), is largest.

        Here sinh(s) = tan(angle) and q = (r^2 + c^2 - 1) / 2. Checked at places that are close to each other in angle.
        """
        top = mp.asinh(mp.tan(mp.atan2(c, (r**2 + c**2 - 1) / 2) / 2))
        places = [self.s_A, self.s_B, *([top] if self.s_A < top < self.s_B else [])]
        largest = max(self.stress(s, r, c) for s in places)
        angle_A, angle_B = (mp.atan(mp.sinh(s)) for s in (self.s_A, self.s_B))
        inner = [mp.asinh(mp.tan(angle)) for angle in mp.linspace(angle_A, angle_B, 402)[1:-1]]
        searched = max(self.stress(s, r, c) for s in (self.s_A, self.s_B, *inner))
        if not largest * (1 - mp.mpf("1e-3")) < searched < largest * (1 + mp.mpf(10) ** -CHECKED_DIGITS):
            raise ArithmeticError(f"largest stress {mp.nstr(largest)}, but {mp.nstr(searched)} was found")
        return largest

    def _integrals(self, r: mp.mpf, c: mp.mpf) -> list[mp.mpf]:
        """Horizontal distance, rise, and what the rise gains by c."""
        return _integral(lambda s: _rates_of_length(s, r, c), self.s_A, self.s_B)


def _rates_of_length(s: mp.mpf, r: mp.mpf, c: mp.mpf) -> list[mp.mpf]:
    V = mp.sinh(s) + c
    T = mp.sqrt(r**2 + V**2)
    return [r / T, V / T, r**2 / T**3]


def _rates_of_angle(p: mp.mpf, r: mp.mpf, c: mp.mpf) -> list[mp.mpf]:
    """V = r sinh(p), so ds = r cosh(p) dp / cosh(s), cosh(s) = hypot(1, V - c)."""
    V = r * mp.sinh(p)
    rate = r / mp.sqrt(1 + (V - c) ** 2)
    return [rate, rate * V / r]


def _integral(rates: Callable[[mp.mpf], list[mp.mpf]], low: mp.mpf, high: mp.mpf) -> list[mp.mpf]:
    """Gauss and Legendre's rule, on pieces that are halved until the halves together agree with the whole.

    The first division is where hyperbolic functions of either sign change, so that no piece hides a bend.
    """
    knots = sorted({low, high, *(mp.mpf(knot) for knot in range(-8, 9, 2) if low < knot < high)})
    tolerance = mp.mpf(10) ** -QUADRATURE_DIGITS
    todo = [(a, b, _gauss(rates, a, b)) for a, b in pairwise(knots)]
    total = [mp.mpf(0)] * len(todo[0][2])
    while todo:
        a, b, whole = todo.pop()
        middle = (a + b) / 2
        halves = [(a, middle, _gauss(rates, a, middle)), (middle, b, _gauss(rates, middle, b))]
        sums = [one + other for one, other in zip(halves[0][2], halves[1][2], strict=True)]
        if all(abs(x - y) <= tolerance * (b - a) for x, y in zip(whole, sums, strict=True)):
            total = [x + y for x, y in zip(total, sums, strict=True)]
        else:
            todo += halves
    return total


def _gauss(rates: Callable[[mp.mpf], list[mp.mpf]], a: mp.mpf, b: mp.mpf) -> list[mp.mpf]:
    half = (b - a) / 2
    values = zip(*(rates(a + half * (1 + node)) for node, _ in _nodes()), strict=True)
    return [half * mp.fdot(value, (weight for _, weight in _nodes())) for value in values]


@cache
def _nodes() -> list[tuple[mp.mpf, mp.mpf]]:
    """Nodes, where the polynomial of Legendre of degree POINTS is zero, and weights on (-1, 1)."""
    with mp.workdps(WORKING_DIGITS + 10):
        nodes = []
        for node in map(mp.mpf, np.polynomial.legendre.leggauss(POINTS)[0]):
            for _ in range(5):
                value, slope = _legendre(node)
                node -= value / slope
            nodes.append((node, 2 / ((1 - node**2) * _legendre(node)[1] ** 2)))
    return nodes


def _legendre(x: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
    before, value = mp.mpf(1), x
    for degree in range(2, POINTS + 1):
        before, value = value, ((2 * degree - 1) * x * value - (degree - 1) * before) / degree
    return value, POINTS * (x * value - before) / (x**2 - 1)


def _root(function: Callable[[mp.mpf], tuple[mp.mpf, mp.mpf]], low: mp.mpf, high: mp.mpf, tolerance: mp.mpf) -> mp.mpf:
    """Where an increasing function, given with its slope, is zero.

    Newton's method, with the bracket halved instead where a step leaves it or is not half as long as the one before.
    """
    x, last = (low + high) / 2, high - low
    for _ in range(1000):
        value, slope = function(x)
        low, high = (x, high) if value < 0 else (low, x)
        step = -value / slope
        if abs(step) < tolerance:
            return x + step
        if not (low < x + step < high and abs(step) < last / 2):
            step = (low + high) / 2 - x
        x, last = x + step, abs(step)
    raise ArithmeticError("no root found")


def _require(error: mp.mpf, scale: mp.mpf) -> None:
    if not abs(error) < mp.mpf(10) ** -CHECKED_DIGITS * scale:
        raise ArithmeticError(f"an equation is met only to {mp.nstr(error / scale, 3)}")


def _printed(value: mp.mpf) -> str:
    return str(mp.nstr(value, PRINTED_DIGITS))


if __name__ == "__main__":
    main()
