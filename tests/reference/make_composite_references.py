"""Write the references of the composite line, correct to 20 digits: composite_lines.csv and composite_extremes.csv.

    nice python tests/reference/make_composite_references.py

Independent of cablesim. Along an inextensible line the horizontal force H is constant and the vertical force V grows
by w_i l_i over section i, and the line runs along (H, V). With T = hypot(H, V) a section therefore advances by the
integrals of H / T and V / T:

    x_i = (H / w_i) [asinh(V / H)]    z_i = [T] / w_i    [ ]: at its B end less at its A end.

The unknowns are V_A and, where the distance is given, H. They minimise the integral of T along the line less
H x - V_A z, which is strictly convex: z grows with V_A, and x with H at the z that is given. So V_A is found within a
bracket that is known beforehand, and H, in an outer loop, within one that is widened until it holds. Needs mpmath. The
same seed gives the same bytes.
"""

import csv
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from itertools import accumulate, pairwise
from math import nextafter
from pathlib import Path

import mpmath as mp
import numpy as np

FOLDER = Path(__file__).parent
SEED = 20262
WORKING_DIGITS = 120
SOLVED_DIGITS = 60  # of ln H, and of V_A beside H and the weight
CHECKED_DIGITS = (
    45  # more than 30, as H of a line 1e-15 longer than its chord is known to 15 digits less than the place
)
PRINTED_DIGITS = 20

COLUMNS = (
    "family",
    "given",
    "section_length",
    "section_weight",
    "rise",
    "horizontal_tension",
    "horizontal_distance",
    "tension_A",
    "tension_B",
    "max_tension",
    "lowest_point_x",
    "lowest_point_z",
    "vertex_s",
    "vertex_section",
    "joint_tension",
)

SOURCE = f"""\
# Inextensible lines of sections of different weight in series from end A (the origin) to end B; SI. Inputs exactly as
# printed: section_length, section_weight (per length; both lists from A to B), rise of B above A, and the one of
# horizontal_tension and horizontal_distance that is named in `given`. All else is answers, rounded to {PRINTED_DIGITS}
# digits; made by make_composite_references.py with mpmath at {WORKING_DIGITS} digits: x = (H/w) [asinh(V/H)] and
# z = [T]/w of each section, with V growing by w l over it, solved for V at A (and H) within brackets.
# lowest_point: of the line, its ends included; joint_tension: at the B end of each section; vertex_s: arc length from
# A to where V = 0, on the continued catenary of the end section if below 0 or above the length of the line;
# vertex_section: 0 before A, 1, 2, ... on the line (at A: the first; at a joint or at B: the section that ends there),
# one more than the number of sections beyond B
"""
EXTREMES = """\
# Family no_line: the ends are as far apart as the line is long, or farther, and there is no answer
"""


def main() -> None:
    mp.mp.dps = WORKING_DIGITS
    rng = np.random.default_rng(SEED)
    _write("composite_lines.csv", SOURCE, random_lines(rng))
    _write("composite_extremes.csv", SOURCE + EXTREMES, extreme_lines(rng))


# ---- a line and what is asked of it ----


@dataclass(frozen=True)
class Line:
    """A line in which one of H and the distance is given, as float64 numbers that stand for their exact values."""

    family: str
    lengths: tuple[float, ...]
    weights: tuple[float, ...]
    rise: float
    tension: float | None = None
    distance: float | None = None

    def exists(self) -> bool:
        """Whether the line is longer than the least distance of its ends, exactly."""
        return _squared(self.lengths) > Fraction(self.rise) ** 2 + Fraction(self.distance or 0.0) ** 2


def random_lines(rng: np.random.Generator) -> Iterator[Line]:
    for _ in range(500):
        lengths, weights = _sections(rng, int(rng.integers(1, 21)))
        yield _tensioned("random", lengths, weights, rng.uniform(-0.95, 0.95), _log_uniform(rng, -3, 4))
    for _ in range(500):
        lengths, weights = _sections(rng, int(rng.integers(1, 21)))
        yield _stretched("random", lengths, weights, rng.uniform(-0.9, 0.9), _log_uniform(rng, -9, np.log10(0.99)))


def extreme_lines(rng: np.random.Generator) -> Iterator[Line]:
    families = (
        symmetric,
        whole_numbers,
        vertex_outside,
        tiny_section,
        weight_jump,
        heavy_section,
        nearly_straight,
        excess_below_rounding,
        very_slack,
        nearly_vertical,
        extreme_tension,
        extreme_units,
        one_section,
        many_sections,
        no_line,
    )
    for family in families:
        yield from family(rng)


def symmetric(rng: np.random.Generator) -> Iterator[Line]:
    """Level lines, the same from either end, whose vertex is therefore at the joint in the middle."""
    for ratio in (1e-6, 1e-3, 1e-1, 1.0, 1e1, 1e3, 1e6):
        lengths, weights = (half + half[::-1] for half in _sections(rng, 3))
        yield _tensioned("symmetric", lengths, weights, 0.0, ratio)
    for excess in (1e-12, 1e-6, 1e-2, 0.5, 0.99):
        lengths, weights = (half + half[::-1] for half in _sections(rng, 3))
        yield _stretched("symmetric", lengths, weights, 0.0, excess)


def whole_numbers(_: np.random.Generator) -> Iterator[Line]:
    """With H = 15, tensions are whole numbers at V = 0, 8, 20, 36, 112: a vertex exactly at a joint, at A or at B."""
    for forces, weights in (
        ((0, 8, 20, 36), (1, 2, 4)),
        ((0, 112), (8,)),
        ((0, 36, 112), (0.5, 64)),
        ((-36, -20, -8, 0), (4, 2, 1)),
        ((-112, 0), (0.125,)),
        ((-20, 0, 8), (0.25, 16)),
        ((-8, 0, 20, 112), (1, 1, 1024)),
        ((-112, -20, 0, 36), (2, 0.0625, 2)),
        ((-36, -8, 0, 8, 20), (1, 2, 4, 8)),
        ((-8, 0, 112), (2.0**-10, 2.0**10)),
    ):
        tensions = [float(np.hypot(15, force)) for force in forces]
        lengths = [(b - a) / weight for (a, b), weight in zip(pairwise(forces), weights, strict=True)]
        rise = sum((b - a) / weight for (a, b), weight in zip(pairwise(tensions), weights, strict=True))
        yield Line("whole_numbers", tuple(lengths), tuple(map(float, weights)), rise, tension=15.0)


def vertex_outside(rng: np.random.Generator) -> Iterator[Line]:
    for ratio in (1e1, 1e3, 1e6, 1e9):
        for rise in (-0.999, -0.3, 0.3, 0.999):
            yield _tensioned("vertex_outside", *_sections(rng, 4), rise, ratio)


def tiny_section(rng: np.random.Generator) -> Iterator[Line]:
    for share in (1e-9, 1e-12):
        for place in (0, 2, 4):
            lengths, weights = _sections(rng, 5)
            lengths = _with(lengths, place, share * sum(lengths))
            yield from _both(rng, "tiny_section", lengths, weights)


def weight_jump(rng: np.random.Generator) -> Iterator[Line]:
    """Neighbours whose weights are far apart, in either order."""
    for ratio in (1e-6, 1e-3, 1e3, 1e6):
        for sections in (2, 5):
            lengths, weights = _sections(rng, sections)
            weights = tuple(float(weights[0] * ratio ** (i % 2)) for i in range(sections))
            yield from _both(rng, "weight_jump", lengths, weights)


def heavy_section(rng: np.random.Generator) -> Iterator[Line]:
    """A heavy section at A, in the middle or at B, down to one so short that it is a weight hung on the line."""
    for ratio in (1e3, 1e6):
        for share in (0.3, 1e-3, 1e-6):
            for place in (0, 1, 2):
                lengths, weights = _sections(rng, 3)
                lengths = _with(lengths, place, share * sum(lengths))
                weights = _with(weights, place, ratio * weights[place])
                yield from _both(rng, "heavy_section", lengths, weights)


def nearly_straight(rng: np.random.Generator) -> Iterator[Line]:
    for excess in (1e-13, 1e-14, 1e-15):
        for slope in (-0.9, -0.1, 0.0, 0.5):
            for sections in (2, 6):
                yield _stretched("nearly_straight", *_sections(rng, sections), slope, excess)


def excess_below_rounding(_: np.random.Generator) -> Iterator[Line]:
    """Lines longer than their chords by less than the sums of their sections can show in float64."""
    for excess in (1e-16, 1e-18, 1e-24):
        yield Line("excess_below_rounding", (3.0, excess, 2.0), (2.0, 700.0, 5.0), 0.0, distance=5.0)
        yield Line("excess_below_rounding", (2.0, 3.0, excess), (10.0, 0.5, 3.0), -3.0, distance=4.0)
    yield Line("excess_below_rounding", (0.1,) * 10, (1.0, 3.0) * 5, 0.0, distance=1.0)


def very_slack(rng: np.random.Generator) -> Iterator[Line]:
    for distance in (1e-6, 1e-9):
        for rise in (-0.9, -0.5, 0.0, 0.5, 0.99):
            lengths, weights = _sections(rng, 4)
            length = sum(lengths)
            yield Line("very_slack", lengths, weights, rise * length, distance=distance * length)


def nearly_vertical(rng: np.random.Generator) -> Iterator[Line]:
    for rise in (-(1.0 - 1e-9), 1.0 - 1e-9):
        for ratio in (1e-9, 1e-6, 1e-3, 1.0):
            yield _tensioned("nearly_vertical", *_sections(rng, 3), rise, ratio)
        for part in (1e-6, 1e-3, 0.5, 0.999):
            lengths, weights = _sections(rng, 3)
            length = sum(lengths)
            farthest = length * np.sqrt((1.0 - rise) * (1.0 + rise))
            yield Line("nearly_vertical", lengths, weights, rise * length, distance=float(part * farthest))


def extreme_tension(rng: np.random.Generator) -> Iterator[Line]:
    for ratio in (1e-12, 1e-9, 1e-6, 1e6, 1e9, 1e12):
        for rise in (-0.8, 0.0, 0.5):
            yield _tensioned("extreme_tension", *_sections(rng, 4), rise, ratio)


def extreme_units(rng: np.random.Generator) -> Iterator[Line]:
    for size in (1e-6, 1e6):
        for heaviness in (1e-6, 1.0, 1e6):
            lengths, weights = (tuple(10.0 ** rng.uniform(-1, 1, 4)) for _ in range(2))
            lengths = tuple(float(size * length) for length in lengths)
            weights = tuple(float(heaviness * weight) for weight in weights)
            yield from _both(rng, "extreme_units", lengths, weights)


def one_section(rng: np.random.Generator) -> Iterator[Line]:
    for _ in range(3):
        yield from _both(rng, "one_section", *_sections(rng, 1))


def many_sections(rng: np.random.Generator) -> Iterator[Line]:
    yield from _both(rng, "many_sections", *_sections(rng, 100))


def no_line(_: np.random.Generator) -> Iterator[Line]:
    lengths, weights = (3.0, 2.0), (10.0, 40.0)
    for rise in (-5.0, 5.0, nextafter(5.0, 6.0), -7.0):
        yield Line("no_line", lengths, weights, rise, tension=100.0)
    for distance, rise in ((5.0, 0.0), (4.0, 3.0), (3.0, -4.0), (nextafter(4.0, 5.0), 3.0), (1.0, 5.0), (6.0, 0.0)):
        yield Line("no_line", lengths, weights, rise, distance=distance)
    rounded_up = (1.0, *(1.2e-16,) * 3)  # the float64 sum from A to B is 1 + 6.7e-16
    yield Line("no_line", rounded_up, (1.0,) * 4, 0.0, distance=1.0 + 4.4e-16)


def _sections(rng: np.random.Generator, sections: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    lengths, weights = 10.0 ** rng.uniform(0, 3, sections), 10.0 ** rng.uniform(-1, 4, sections)
    return tuple(lengths.tolist()), tuple(weights.tolist())


def _tensioned(
    family: str, lengths: tuple[float, ...], weights: tuple[float, ...], rise_ratio: float, tension_ratio: float
) -> Line:
    """A line given by H over the weight of the line and rise over its length."""
    weight = float(np.dot(lengths, weights))
    return Line(family, lengths, weights, float(rise_ratio * sum(lengths)), tension=float(tension_ratio * weight))


def _stretched(
    family: str, lengths: tuple[float, ...], weights: tuple[float, ...], slope: float, excess: float
) -> Line:
    """A line given by the sine of its chord's slope and by what the chord lacks of the length, relative to it."""
    chord = sum(lengths) * (1.0 - excess)
    distance, rise = float(chord * np.sqrt(1.0 - slope**2)), float(chord * slope)
    while _squared(lengths) <= Fraction(distance) ** 2 + Fraction(rise) ** 2:
        distance = nextafter(distance, 0.0)
    return Line(family, lengths, weights, rise, distance=distance)


def _both(
    rng: np.random.Generator, family: str, lengths: tuple[float, ...], weights: tuple[float, ...]
) -> Iterator[Line]:
    """The same sections under some H, and over some distance."""
    yield _tensioned(family, lengths, weights, rng.uniform(-0.9, 0.9), _log_uniform(rng, -2, 2))
    yield _stretched(family, lengths, weights, rng.uniform(-0.9, 0.9), _log_uniform(rng, -4, -0.1))


def _with(values: tuple[float, ...], place: int, value: float) -> tuple[float, ...]:
    return *values[:place], float(value), *values[place + 1 :]


def _squared(lengths: Iterable[float]) -> Fraction:
    return sum(map(Fraction, lengths), Fraction(0)) ** 2


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(10.0 ** rng.uniform(low, high))


# ---- the answer ----


@dataclass(frozen=True)
class Shape:
    """The line under the forces H and V_A; forces, tensions, angles asinh(V / H) and places at A and each B end."""

    lengths: list[mp.mpf]
    weights: list[mp.mpf]
    H: mp.mpf
    V_A: mp.mpf
    forces: list[mp.mpf] = field(init=False)
    tensions: list[mp.mpf] = field(init=False)

    def __post_init__(self) -> None:
        loads = (weight * length for weight, length in zip(self.weights, self.lengths, strict=True))
        object.__setattr__(self, "forces", list(accumulate(loads, initial=self.V_A)))
        object.__setattr__(self, "tensions", [mp.sqrt(self.H**2 + V**2) for V in self.forces])

    @cached_property
    def angles(self) -> list[mp.mpf]:
        return [mp.asinh(V / self.H) for V in self.forces]

    @cached_property
    def sines(self) -> list[mp.mpf]:
        return [V / T for V, T in zip(self.forces, self.tensions, strict=True)]

    @cached_property
    def x(self) -> list[mp.mpf]:
        return [self.H * x for x in self._sums(self.angles)]

    @cached_property
    def z(self) -> list[mp.mpf]:
        return self._sums(self.tensions)

    def dz_dV(self) -> mp.mpf:
        return self._sums(self.sines)[-1]

    def dx_dH(self) -> mp.mpf:
        """Along the lines whose B end keeps its height: V_A follows H."""
        alone = self._sums(self.angles)[-1] - self.dz_dV()
        dz_dH = self._sums([self.H / T for T in self.tensions])[-1]
        return alone - dz_dH**2 / self.dz_dV()

    def _sums(self, values: list[mp.mpf]) -> list[mp.mpf]:
        """Of the growth of a value over each section divided by its weight, from A to each of its places."""
        growths = ((b - a) / weight for (a, b), weight in zip(pairwise(values), self.weights, strict=True))
        return list(accumulate(growths, initial=mp.mpf(0)))


def solve(line: Line) -> Shape:
    lengths, weights = list(map(mp.mpf, line.lengths)), list(map(mp.mpf, line.weights))
    if line.tension is not None:
        return _under_tension(lengths, weights, mp.mpf(line.rise), mp.mpf(line.tension))
    return _over_distance(lengths, weights, mp.mpf(line.rise), mp.mpf(line.distance))


def _under_tension(lengths: list[mp.mpf], weights: list[mp.mpf], rise: mp.mpf, H: mp.mpf) -> Shape:
    """The line that rises by `rise`: its slope falls short of that of a straight line at A, and exceeds it at B."""
    weight = mp.fdot(lengths, weights)
    straight = H * rise / mp.sqrt(mp.fsum(lengths) ** 2 - rise**2)

    def error(V_A: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
        shape = Shape(lengths, weights, H, V_A)
        return shape.z[-1] - rise, shape.dz_dV()

    V_A = _root(error, straight - weight, straight, mp.mpf(10) ** -SOLVED_DIGITS * min(H, weight))
    return Shape(lengths, weights, H, V_A)


def _over_distance(lengths: list[mp.mpf], weights: list[mp.mpf], rise: mp.mpf, distance: mp.mpf) -> Shape:
    def error(log_H: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
        shape = _under_tension(lengths, weights, rise, mp.exp(log_H))
        return shape.x[-1] - distance, shape.H * shape.dx_dH()

    start = mp.log(mp.fdot(lengths, weights))
    low, high = start - 1, start + 1
    while error(low)[0] > 0:
        low -= start + 1 - low
    while error(high)[0] < 0:
        high += high - (start - 1)
    log_H = _root(error, low, high, mp.mpf(10) ** -SOLVED_DIGITS)
    return _under_tension(lengths, weights, rise, mp.exp(log_H))


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


def check(line: Line, shape: Shape) -> None:
    """Require that the ends are where they belong, and of each section what is true of any arc of its catenary.

    With a = H / w an arc of length l, width x and height z has l^2 - z^2 = (2 a sinh(x / 2a))^2 and
    z / l = tanh(the mean of asinh(V / H) at its ends).
    """
    length = mp.fsum(shape.lengths)
    _require(shape.z[-1] - line.rise, length)
    if line.distance is not None:
        _require(shape.x[-1] - line.distance, mp.mpf(line.distance))
    x, z = ([b - a for a, b in pairwise(places)] for places in (shape.x, shape.z))
    middle = [(a + b) / 2 for a, b in pairwise(shape.angles)]
    for i, (l_i, w_i) in enumerate(zip(shape.lengths, shape.weights, strict=True)):
        a = shape.H / w_i
        _require(2 * a * mp.sinh(x[i] / (2 * a)) * mp.cosh(middle[i]) - l_i, l_i)
        _require(mp.sqrt(l_i**2 - z[i] ** 2) - 2 * a * mp.sinh(x[i] / (2 * a)), l_i)
        _require(z[i] - l_i * mp.tanh(middle[i]), l_i)


def _require(error: mp.mpf, scale: mp.mpf) -> None:
    if not abs(error) < mp.mpf(10) ** -CHECKED_DIGITS * scale:
        raise ArithmeticError(f"an equation is met only to {mp.nstr(error / scale, 3)}")


@dataclass(frozen=True)
class Vertex:
    s: mp.mpf
    section: int
    lowest: tuple[mp.mpf, mp.mpf]


def vertex(shape: Shape) -> Vertex:
    """Where V = 0, to a tolerance far below any V that is not zero for a reason."""
    tolerance = mp.mpf(10) ** -CHECKED_DIGITS * min(shape.H, shape.forces[-1] - shape.V_A)
    V = [mp.mpf(0) if abs(force) < tolerance else force for force in shape.forces]
    s = list(accumulate(shape.lengths, initial=mp.mpf(0)))
    if V[0] >= 0:
        return Vertex(-V[0] / shape.weights[0], 0 if V[0] > 0 else 1, (mp.mpf(0), mp.mpf(0)))
    if V[-1] < 0:
        return Vertex(s[-1] - V[-1] / shape.weights[-1], len(V), (shape.x[-1], shape.z[-1]))
    section = next(i for i, force in enumerate(V) if force >= 0)
    before, weight, H = section - 1, shape.weights[section - 1], shape.H
    x = shape.x[before] - H / weight * shape.angles[before]
    z = shape.z[before] + (H - shape.tensions[before]) / weight
    return Vertex(s[before] - V[before] / weight, section, (x, z))


# ---- how it is written ----


def _write(name: str, source: str, lines: Iterable[Line]) -> None:
    with (FOLDER / name).open("w", encoding="utf-8", newline="") as file:
        file.write(source)
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        table.writerows(map(_row, lines))


def _row(line: Line) -> list[str]:
    answers = [""] * (len(COLUMNS) - 5)
    if line.exists():
        shape = solve(line)
        check(line, shape)
        answers = _answers(shape)
    if line.tension is not None:
        given, answers[0] = "horizontal_tension", repr(line.tension)
    else:
        given, answers[1] = "horizontal_distance", repr(line.distance)
    sections = [" ".join(map(repr, values)) for values in (line.lengths, line.weights)]
    return [line.family, given, *sections, repr(line.rise), *answers]


def _answers(shape: Shape) -> list[str]:
    turn = vertex(shape)
    ends = shape.tensions[0], shape.tensions[-1]
    before = [shape.H, shape.x[-1], *ends, max(ends), *turn.lowest, turn.s]
    return [*map(_printed, before), str(turn.section), " ".join(map(_printed, shape.tensions[1:]))]


def _printed(value: mp.mpf) -> str:
    return str(mp.nstr(value, PRINTED_DIGITS))


if __name__ == "__main__":
    main()
