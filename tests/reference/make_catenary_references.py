"""Write the references of the hanging line, correct to 25 digits: catenary_exact.csv and catenary_elastic.csv.

    python tests/reference/make_catenary_references.py

Independent of cablesim: textbook formulas as they stand, with enough digits that nothing needs to be rearranged. The
inputs are float64 numbers taken at their exact values, so a reference is the answer to what a solver is really given.
Needs mpmath. The same seed gives the same bytes.
"""

import csv
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import mpmath as mp
import numpy as np

FOLDER = Path(__file__).parent
SEED = 20260
WORKING_DIGITS = 120  # the worst cancellation, in the sag of a line 1e-15 longer than its chord, costs about 50
CHECKED_DIGITS = 40
PRINTED_DIGITS = 25

EXACT_INPUTS = ("span", "rise", "line_length", "length_ratio", "weight_per_length")
ELASTIC_INPUTS = ("span", "rise", "line_length", "weight_per_length", "axial_stiffness")
OUTPUTS = (
    "catenary_parameter",
    "horizontal_tension",
    "tension_A",
    "tension_B",
    "max_tension",
    "sag",
    "drop",
    "vertex_x",
    "stretched_length",
)

Row = dict[str, float | None]
Answer = dict[str, mp.mpf]


def main() -> None:
    rng = np.random.default_rng(SEED)
    mp.mp.dps = WORKING_DIGITS
    _write("catenary_exact.csv", EXACT_SOURCE, EXACT_INPUTS, list(exact_rows(rng)), exact_answer)
    _write("catenary_elastic.csv", ELASTIC_SOURCE, ELASTIC_INPUTS, list(elastic_rows(rng)), elastic_answer)


EXACT_SOURCE = f"""\
# Inextensible catenary between two supports, inputs exactly as printed (SI), outputs rounded to {PRINTED_DIGITS} digits
# made by make_catenary_references.py with mpmath at {WORKING_DIGITS} digits: sinh(x) = k x, k = sqrt(L^2 - h^2) / l,
# then tensions, sag and vertex from y = a cosh(x / a); length_ratio stands for line_length = length_ratio * span
"""
ELASTIC_SOURCE = f"""\
# Elastic catenary between two supports, inputs exactly as printed (SI), outputs rounded to {PRINTED_DIGITS} digits
# made by make_catenary_references.py with mpmath at {WORKING_DIGITS} digits: the two equations of Irvine (Cable
# Structures, 1981, section 2.2) solved for the forces H and V to {CHECKED_DIGITS} digits, then integrals along the line
"""


# ---- what is asked ----


def exact_rows(rng: np.random.Generator) -> Iterator[Row]:
    excesses = np.geomspace(1e-12, 1e6, 60)
    for excess in excesses:
        yield _exact_row(rng, lambda span: 0.0, excess)
        yield {**_exact_row(rng, lambda span: 0.0, excess), "line_length": None, "length_ratio": float(1.0 + excess)}
        yield _exact_row(rng, lambda span: span * _signed(rng, -12, -3), excess)
        yield _exact_row(rng, lambda span: span * _signed(rng, -2, 0), excess)
        yield _exact_row(rng, lambda span: span * _signed(rng, 0, 1.35), excess)
    for excess in np.geomspace(1e-9, 1e6, 40):
        yield _inclined_ratio_row(rng, float(1.0 + excess))
    for ratio in np.geomspace(23.0, 1e6, 30):
        yield _steep_row(rng, ratio)
    for excess in np.geomspace(1e-15, 1e-12, 30):
        yield _exact_row(rng, lambda span: span * _signed(rng, -1, 1), excess, least=2)


def elastic_rows(rng: np.random.Generator) -> Iterator[Row]:
    for excess in np.geomspace(1e-9, 1e6, 120):
        yield _elastic_row(rng, excess, 10.0 ** rng.uniform(-12, 1))
    for slope in np.geomspace(30.0, 1e6, 20):  # two supports almost above each other
        strain = 10.0 ** rng.uniform(-12, 1)
        yield _elastic_row(rng, 10.0 ** rng.uniform(-2, 1), strain, float(slope * rng.choice([-1.0, 1.0])))
    for strain in np.geomspace(1e-12, 10.0, 110):
        yield _elastic_row(rng, -0.5 * 10.0 ** rng.uniform(-9, 0), strain)
    for excess in np.geomspace(1e-15, 1e-6, 40):
        yield _elastic_row(rng, excess, 10.0 ** rng.uniform(-12, 1))
        yield _elastic_row(rng, -excess, 10.0 ** rng.uniform(-12, 1))
    for strain in np.geomspace(1e-12, 10.0, 14):  # length equal to the chord, to the last digit
        triangle = {"span": 3.0, "rise": float(rng.choice([-4.0, 4.0])), "line_length": 5.0}
        yield {**_elastic_row(rng, 0.0, strain), **triangle}


def _exact_row(rng: np.random.Generator, rise_of: Callable[[float], float], excess: float, least: int = 0) -> Row:
    """A line longer than its chord by `excess` of it, and by no fewer than `least` units in the last place."""
    span = _log_uniform(rng, 0, 3)
    rise = float(rise_of(span))
    chord = float(np.hypot(span, rise))
    length = max(chord * (1.0 + excess), chord + least * np.spacing(chord))
    return _exact_inputs(rng, span, rise, length)


def _inclined_ratio_row(rng: np.random.Generator, ratio: float) -> Row:
    """A line given by its length ratio, with a rise that leaves between all and 0.001 of the largest possible one."""
    span = _log_uniform(rng, 0, 3)
    part = rng.choice([-1.0, 1.0]) * (1.0 - _log_uniform(rng, -3, 0))
    rise = span * np.sqrt((ratio - 1.0) * (ratio + 1.0)) * part
    return {**_exact_inputs(rng, span, float(rise), None), "length_ratio": ratio}


def _steep_row(rng: np.random.Generator, ratio: float) -> Row:
    """A line whose rise is 0.999 of its length."""
    span = _log_uniform(rng, 0, 3)
    return _exact_inputs(rng, span, float(0.999 * ratio * span * rng.choice([-1.0, 1.0])), float(ratio * span))


def _exact_inputs(rng: np.random.Generator, span: float, rise: float, length: float | None) -> Row:
    weight = _log_uniform(rng, -1, 4)
    length = None if length is None else float(length)
    return dict(zip(EXACT_INPUTS, (span, rise, length, None, weight), strict=True))


def _elastic_row(rng: np.random.Generator, excess: float, strain: float, slope: float | None = None) -> Row:
    """`strain` is that of the whole weight hung from one end; without a slope of the chord one line in six is level."""
    span, weight = _log_uniform(rng, 0, 3), _log_uniform(rng, -1, 4)
    if slope is None:
        slope = 0.0 if rng.random() < 1 / 6 else _signed(rng, -3, 1)
    rise = float(span * slope)
    length = float(np.hypot(span, rise) * (1.0 + excess))
    return dict(zip(ELASTIC_INPUTS, (span, rise, length, weight, float(weight * length / strain)), strict=True))


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(10.0 ** rng.uniform(low, high))


def _signed(rng: np.random.Generator, low: float, high: float) -> float:
    return float(rng.choice([-1.0, 1.0])) * _log_uniform(rng, low, high)


# ---- what is answered ----


def exact_answer(row: Row) -> Answer:
    span, h, w = (mp.mpf(row[name]) for name in ("span", "rise", "weight_per_length"))
    length = span * mp.mpf(row["length_ratio"]) if row["line_length"] is None else mp.mpf(row["line_length"])
    half_angle = _root_of_sinh(mp.sqrt(length**2 - h**2) / span)
    a = span / (2 * half_angle)
    x_A = a * mp.asinh(h / (2 * a * mp.sinh(half_angle))) - span / 2
    x_B = x_A + span
    x_parallel = a * mp.asinh(h / span)
    y_A, y_B, y_parallel = (a * mp.cosh(x / a) for x in (x_A, x_B, x_parallel))
    _require(y_B - y_A - h, span + abs(h))
    _require(a * (mp.sinh(x_B / a) - mp.sinh(x_A / a)) - length, length)
    sag = y_A + h / span * (x_parallel - x_A) - y_parallel
    return _answer(a, w * a, w * y_A, w * y_B, w * max(y_A, y_B), sag, max(y_A, y_B) - a, -x_A, length)


def _root_of_sinh(k: mp.mpf) -> mp.mpf:
    """x > 0 with sinh(x) = k x: Newton from above, where a convex function lets it only descend."""
    x = mp.sqrt(6 * (k - 1))
    large = mp.log(2 * k)
    if large > 2:
        x = min(x, large + 2 * mp.log(large))
    for _ in range(60):
        x -= (mp.sinh(x) - k * x) / (mp.cosh(x) - k)
    _require((mp.sinh(x) - k * x) / (mp.cosh(x) - k), x)
    return x


def elastic_answer(row: Row) -> Answer:
    line = ElasticLine(*(mp.mpf(row[name]) for name in ELASTIC_INPUTS))
    H, V = line.forces()
    tension_A, tension_B = mp.hypot(H, line.lower(V)), mp.hypot(H, V)
    s_vertex = -line.lower(V) / line.weight
    s_parallel = s_vertex + H * line.rise / (line.span * line.weight)
    (x_vertex, z_vertex), (x_parallel, z_parallel) = (line.place(H, V, s) for s in (s_vertex, s_parallel))
    sag = line.rise / line.span * x_parallel - z_parallel
    drop = max(line.rise, mp.mpf(0)) - z_vertex
    stretched = line.length + line.integral_of_tension(H, V) / line.stiffness
    a = H / line.weight
    return _answer(a, H, tension_A, tension_B, max(tension_A, tension_B), sag, drop, x_vertex, stretched)


@dataclass(frozen=True)
class ElasticLine:
    """Irvine's elastic catenary; V is the vertical force at B, and s runs along the unstretched line from A."""

    span: mp.mpf
    rise: mp.mpf
    length: mp.mpf
    weight: mp.mpf
    stiffness: mp.mpf

    def lower(self, V: mp.mpf) -> mp.mpf:
        """Vertical force in the line at A, upward positive towards B."""
        return V - self.weight * self.length

    def place(self, H: mp.mpf, V: mp.mpf, s: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
        """x and z at s: the integrals of H (1/T + 1/EA) and V(s) (1/T + 1/EA), V(s) = V_A + w s."""
        w, V_A = self.weight, self.lower(V)
        V_s = V_A + w * s
        x = H / w * (mp.asinh(V_s / H) - mp.asinh(V_A / H)) + H * s / self.stiffness
        z = (mp.hypot(H, V_s) - mp.hypot(H, V_A)) / w + (V_A * s + w * s**2 / 2) / self.stiffness
        return x, z

    def integral_of_tension(self, H: mp.mpf, V: mp.mpf) -> mp.mpf:
        def primitive(v: mp.mpf) -> mp.mpf:
            return (v * mp.hypot(H, v) + H**2 * mp.asinh(v / H)) / 2

        return (primitive(V) - primitive(self.lower(V))) / self.weight

    def integral_of_tension_squared(self, H: mp.mpf, V: mp.mpf) -> mp.mpf:
        return H**2 * self.length + (V**3 - self.lower(V) ** 3) / (3 * self.weight)

    def energy(self, H: mp.mpf, V: mp.mpf) -> mp.mpf:
        """Complementary energy, less the work of the forces at the place where the end belongs."""
        inside = self.integral_of_tension(H, V) + self.integral_of_tension_squared(H, V) / (2 * self.stiffness)
        return inside - H * self.span - V * self.rise

    def flexibility(self, H: mp.mpf, V: mp.mpf) -> mp.matrix:
        """Derivatives of the place of the end to the forces."""
        w, V_A, soft = self.weight, self.lower(V), self.length / self.stiffness
        T_A, T_B = mp.hypot(H, V_A), mp.hypot(H, V)
        turn, sines = mp.asinh(V / H) - mp.asinh(V_A / H), V / T_B - V_A / T_A
        cross = H / w * (1 / T_B - 1 / T_A)
        return mp.matrix([[(turn - sines) / w + soft, cross], [cross, sines / w + soft]])

    def forces(self) -> tuple[mp.mpf, mp.mpf]:
        """H and V that put the end of the line where it belongs.

        The energy is convex in the forces and its gradient is the error of the end's place, so Newton's method that
        never lets the energy grow finds the one solution from any start.
        """
        H, V = self.weight * self.length / 2, self.weight * (self.length + self.rise) / 2
        for _ in range(400):
            x, z = self.place(H, V, self.length)
            error = mp.matrix([x - self.span, z - self.rise])
            step = -mp.lu_solve(self.flexibility(H, V), error)
            if abs(step[0]) < mp.mpf(10) ** -(CHECKED_DIGITS + 10) * H:
                _require(mp.norm(error), self.length)
                return H, V
            H, V = self._damped(H, V, step)
        raise ArithmeticError(f"no forces found for {self}")

    def _damped(self, H: mp.mpf, V: mp.mpf, step: mp.matrix) -> tuple[mp.mpf, mp.mpf]:
        before, part = self.energy(H, V), mp.mpf(1)
        close = mp.norm(step) < mp.mpf(10) ** -20 * mp.hypot(H, V)  # there rounding may decide which energy is less
        while H + part * step[0] <= 0 or (not close and self.energy(H + part * step[0], V + part * step[1]) > before):
            part /= 2
        return H + part * step[0], V + part * step[1]


def _require(error: mp.mpf, scale: mp.mpf) -> None:
    if not abs(error) < mp.mpf(10) ** -CHECKED_DIGITS * scale:
        raise ArithmeticError(f"an equation is met only to {mp.nstr(error / scale, 3)}")


def _answer(*values: mp.mpf) -> Answer:
    return dict(zip(OUTPUTS, values, strict=True))


# ---- how it is written ----


def _write(name: str, source: str, inputs: tuple[str, ...], rows: list[Row], answer: Callable[[Row], Answer]) -> None:
    with (FOLDER / name).open("w", encoding="utf-8", newline="") as file:
        file.write(source)
        table = csv.writer(file, lineterminator="\n")
        table.writerow((*inputs, *OUTPUTS))
        for row in rows:
            values = answer(row)
            given = ["" if row[name] is None else repr(row[name]) for name in inputs]
            table.writerow(given + [mp.nstr(values[name], PRINTED_DIGITS) for name in OUTPUTS])


if __name__ == "__main__":
    main()
