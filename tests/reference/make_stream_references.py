"""Write the references of a line in a uniform stream: pode_functions.csv, pode_example4.csv and stream_lines.csv.

    python tests/reference/make_stream_references.py [name of a file, ...]

Independent of cablesim: the equations as they stand, by quadrature and Taylor series with enough digits that nothing
needs to be rearranged. The inputs are float64 numbers taken at their exact values, so a reference is the answer to what
a solver is really given. Needs mpmath. The same seed gives the same bytes.
"""

import csv
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path

import mpmath as mp
import numpy as np

FOLDER = Path(__file__).parent
SEED = 20261
LAWS = ("constant", "cosine_squared", "zero")

Row = dict[str, float | str | None]
Answer = dict[str, mp.mpf]


def main() -> None:
    files = {
        "pode_functions.csv": write_pode_functions,
        "pode_example4.csv": write_pode_example4,
        "stream_lines.csv": write_stream_lines,
    }
    for name in sys.argv[1:] or files:
        files[name](FOLDER / name)


def _write(path: Path, source: str, names: Iterable[str], rows: Iterable[Iterable[str]]) -> None:
    with path.open("w", newline="") as file:
        file.write(source)
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(names)
        writer.writerows(rows)


def _shown(value: float | str | None) -> str:
    return "" if value is None else value if isinstance(value, str) else repr(value)


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(10.0 ** rng.uniform(low, high))


def _require(error: mp.mpf, scale: mp.mpf, tolerance: mp.mpf) -> None:
    if not abs(error) <= tolerance * abs(scale):
        raise ArithmeticError(f"residual {mp.nstr(error, 5)} of {mp.nstr(scale, 5)}")


# ---- Pode's functions ----

PODE_DIGITS = 55  # up to 18 of them are lost in D at 1e-9 rad from a singular angle
PODE_CHECKED = mp.mpf("1e-36")
PODE_PRINTED = 25
PODE_NODES = 36
PODE_INPUTS = ("angle", "critical_angle", "weight_ratio", "friction_ratio", "friction_law", "reference_angle")
PODE_OUTPUTS = ("tau", "sigma", "xi", "eta", "sigma_scale", "xi_scale", "eta_scale", "near")
PODE_SOURCE = f"""\
# Pode's functions of a line in a uniform stream, inputs exactly as printed (SI), outputs rounded to {PODE_PRINTED}
# digits, made by make_stream_references.py with mpmath at {PODE_DIGITS} digits: D = w cos(a) - sin(a)|sin(a)|,
# w = sin(a_c)^2 / cos(a_c), tau = exp(integral of (f_s + w sin(a)) / D), and sigma, xi, eta the integrals of tau / D,
# tau cos(a) / D, tau sin(a) / D, all from the reference angle; f_s = f sign(cos(a)) (constant), f cos(a)|cos(a)|
# (cosine_squared), 0 (zero). sigma_scale, xi_scale, eta_scale: integrals of the absolute values of the integrands;
# near: distance of the angle from the nearer of the two singular angles, a_c and pi + a_c. Checked: every piece of
# every integral agrees with its two halves, and tau with its closed form (where w > 0), to 1e-35
"""


@dataclass(frozen=True)
class Pode:
    """Quadrature in y = log(p / q), with p and q the distances from the two singular angles, a_c and pi + a_c."""

    critical_angle: mp.mpf
    weight: mp.mpf
    friction: mp.mpf
    law: str

    @classmethod
    def from_row(cls, row: Row) -> "Pode":
        friction = mp.mpf(row["friction_ratio"])
        if row["weight_ratio"] is None:
            critical = mp.mpf(row["critical_angle"])
            return cls(critical, mp.sin(critical) ** 2 / mp.cos(critical), friction, row["friction_law"])
        w = mp.mpf(row["weight_ratio"])
        return cls(mp.acos(1 / (w / 2 + mp.sqrt(1 + w**2 / 4))), w, friction, row["friction_law"])

    def distances(self, angle: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
        return angle - self.critical_angle, mp.pi + self.critical_angle - angle

    def D(self, angle: mp.mpf) -> mp.mpf:
        return self.weight * mp.cos(angle) - mp.sin(angle) * abs(mp.sin(angle))

    def functions(self, start: mp.mpf, end: mp.mpf) -> tuple[mp.mpf, list[mp.mpf]]:
        """tau; sigma, xi and eta."""
        log_tau, values, _ = self.integrals(start, end)
        return mp.exp(log_tau), values

    def integrals(self, start: mp.mpf, end: mp.mpf) -> tuple[mp.mpf, list[mp.mpf], list[mp.mpf]]:
        """log tau; sigma, xi, eta; and their scales, from `start` to `end`."""
        sign = 1 if end > start else -1
        log_tau, total, scale = mp.mpf(0), [mp.mpf(0)] * 3, [mp.mpf(0)] * 3
        low, high = min(start, end), max(start, end)
        corners = [low, *(kink for kink in (mp.pi / 2, mp.pi) if low < kink < high), high][::sign]
        for a, b in pairwise(corners):
            signs = mp.sign(mp.cos((a + b) / 2)), mp.sign(mp.sin((a + b) / 2))
            for piece in self._pieces(a, b):
                step, parts = self._settled(*piece, self._piece(*piece, signs), signs)
                tau = mp.exp(log_tau)
                total = [old + tau * part for old, part in zip(total, parts, strict=True)]
                scale = [old + abs(tau * part) for old, part in zip(scale, parts, strict=True)]
                log_tau += step
        return log_tau, total, scale

    def _pieces(self, a: mp.mpf, b: mp.mpf) -> Iterator[tuple[mp.mpf, mp.mpf]]:
        """Pieces of y no longer than one."""
        y_a, y_b = (mp.log(p / q) for p, q in map(self.distances, (a, b)))
        count = int(mp.ceil(abs(y_b - y_a)))
        places = [y_a + (y_b - y_a) * k / count for k in range(count + 1)]
        return pairwise(places)

    def _settled(self, a: mp.mpf, b: mp.mpf, whole: tuple, signs: tuple[int, int]) -> tuple[mp.mpf, list[mp.mpf]]:
        """What a piece adds, halved until the halves say the same as the whole."""
        middle = (a + b) / 2
        halves = [self._piece(a, middle, signs), self._piece(middle, b, signs)]
        joined = _joined(*halves)
        if _differ(whole, joined) <= PODE_CHECKED:
            return joined
        return _joined(self._settled(a, middle, halves[0], signs), self._settled(middle, b, halves[1], signs))

    def _piece(self, a: mp.mpf, b: mp.mpf, signs: tuple[int, int]) -> tuple[mp.mpf, list[mp.mpf]]:
        nodes, weights, running = gauss(PODE_NODES)
        half, rates, flows = (b - a) / 2, [], []
        for node in nodes:
            e = mp.exp((a + b) / 2 + half * node)
            angle = self.critical_angle + mp.pi * e / (1 + e)
            cos, sin = mp.cos_sin(angle)
            # d(angle)/dy / D
            slope = half * mp.pi * e / (1 + e) ** 2 / (self.weight * cos - signs[1] * sin**2)
            rates.append(slope * (self._along(cos, signs[0]) + self.weight * sin))
            flows.append((slope, slope * cos, slope * sin))
        taus = [mp.exp(mp.fdot(line, rates)) * weight for line, weight in zip(running, weights, strict=True)]
        return mp.fdot(weights, rates), [mp.fdot(taus, flow) for flow in zip(*flows, strict=True)]

    def _along(self, cos: mp.mpf, sign: int) -> mp.mpf:
        return {"constant": sign * self.friction, "cosine_squared": sign * self.friction * cos**2, "zero": 0}[self.law]

    def log_tau_closed(self, start: mp.mpf, end: mp.mpf) -> mp.mpf:
        """The same in closed form, for w > 0: partial fractions in cos(a), each side of 90 and 180 deg by itself."""
        low, high = min(start, end), max(start, end)
        corners = [low, *(kink for kink in (mp.pi / 2, mp.pi) if low < kink < high), high]
        total = mp.mpf(0)
        for a, b in pairwise(corners):
            signs = mp.sign(mp.cos((a + b) / 2)), mp.sign(mp.sin((a + b) / 2))
            total += self._primitive(b, *signs) - self._primitive(a, *signs)
        return total if end > start else -total

    def _primitive(self, angle: mp.mpf, cos_sign: int, sin_sign: int) -> mp.mpf:
        """With S = sin_sign, D = S (cos(a) - S k) (cos(a) + S / k), k = cos(a_c)."""
        k = mp.cos(self.critical_angle)
        one, two = sin_sign * k, -sin_sign / k
        cos, gap = mp.cos(angle), k + 1 / k
        over_one, over_two = _integral_of_pole(angle, one), _integral_of_pole(angle, two)
        plain = (over_one - over_two) / gap
        with_cos = (one * over_one - two * over_two) / gap
        squared = sin_sign * angle + plain - sin_sign * self.weight * with_cos
        along = {"constant": plain, "cosine_squared": squared, "zero": 0}[self.law]
        return cos_sign * self.friction * along - self.weight / gap * mp.log(abs((cos - one) / (cos - two)))


def _integral_of_pole(angle: mp.mpf, k: mp.mpf) -> mp.mpf:
    """A primitive of 1 / (cos(angle) - k), 0 < angle < 2 pi."""
    cos, sin = mp.cos_sin(angle / 2)
    m = mp.sqrt(abs((1 - k) / (1 + k)))
    if abs(k) < 1:
        return mp.log(abs((m * cos + sin) / (m * cos - sin))) / mp.sqrt(1 - k**2)
    return -mp.sign(k) * 2 / mp.sqrt(k**2 - 1) * mp.atan2(sin, m * cos)


def _joined(first: tuple, second: tuple) -> tuple[mp.mpf, list[mp.mpf]]:
    tau = mp.exp(first[0])
    return first[0] + second[0], [a + tau * b for a, b in zip(first[1], second[1], strict=True)]


def _differ(first: tuple, second: tuple) -> mp.mpf:
    logs = abs(first[0] - second[0]) / max(1, abs(second[0]))
    return max(logs, *(abs(a - b) / abs(b) for a, b in zip(first[1], second[1], strict=True)))


@cache
def gauss(count: int) -> tuple[list[mp.mpf], list[mp.mpf], list[list[mp.mpf]]]:
    """Gauss-Legendre nodes and weights on -1..1, and the matrix that integrates from -1 to each node."""
    nodes = [_root_of_legendre(mp.cos(mp.pi * (4 * k + 3) / (4 * count + 2)), count) for k in range(count)]
    table = [_legendre(x, count + 1) for x in nodes]
    weights = [2 * (1 - x**2) / (count * P[count - 1]) ** 2 for x, P in zip(nodes, table, strict=True)]
    # integral from -1 to x of P_k, times (2 k + 1)
    rises = [[x + 1, *(P[k + 1] - P[k - 1] for k in range(1, count))] for x, P in zip(nodes, table, strict=True)]
    running = [
        [weight * mp.fdot(rise, P[:count]) / 2 for weight, P in zip(weights, table, strict=True)] for rise in rises
    ]
    return nodes, weights, running


def _root_of_legendre(x: mp.mpf, count: int) -> mp.mpf:
    for _ in range(8):  # Newton doubles about three digits each time
        P = _legendre(x, count)
        x -= P[count] * (1 - x**2) / (count * (P[count - 1] - x * P[count]))
    return x


def _legendre(x: mp.mpf, count: int) -> list[mp.mpf]:
    P = [mp.mpf(1), x]
    for k in range(1, count):
        P.append(((2 * k + 1) * x * P[k] - k * P[k - 1]) / (k + 1))
    return P


def pode_answer(row: Row) -> Answer | None:
    """None where float64 could not hold the answer."""
    pode = Pode.from_row(row)
    start, end = mp.mpf(row["reference_angle"]), mp.mpf(row["angle"])
    if pode.weight > 0 and abs(pode.log_tau_closed(start, end)) > 600:
        return None
    if pode.weight == 0 and row["friction_law"] != "zero" and pode.friction * abs(mp.cot(end)) > 600:
        return None
    log_tau, values, scales = pode.integrals(start, end)
    if pode.weight > 0:
        _require(log_tau - pode.log_tau_closed(start, end), max(1, abs(log_tau)), mp.mpf("1e-35"))
    answer = (mp.exp(log_tau), *values, *scales, min(pode.distances(end)))
    if any(not 1e-290 < size < 1e290 for size in (answer[0], *scales)):
        return None
    return dict(zip(PODE_OUTPUTS, answer, strict=True))


def write_pode_functions(path: Path) -> None:
    mp.mp.dps = PODE_DIGITS
    check_pode_table()
    _write(path, PODE_SOURCE, (*PODE_INPUTS, *PODE_OUTPUTS), pode_lines(np.random.default_rng(SEED)))


def check_pode_table() -> None:
    """The values printed in the literature: a_c = 30 deg, f = 0.025, constant friction, from 180 deg."""
    pode = Pode(mp.pi / 6, mp.sin(mp.pi / 6) ** 2 / mp.cos(mp.pi / 6), mp.mpf("0.025"), "constant")
    log_tau, (sigma, xi, eta), _ = pode.integrals(mp.pi, mp.pi / 2)
    near = (pode.integrals(mp.pi, degrees * mp.pi / 180)[1][1] for degrees in (32, 31))
    printed = ("1.38698", "3.06571", "-2.24439", "1.60605", "2.33181", "4.05988")
    for value, text in zip((mp.exp(log_tau), sigma, xi, eta, *near), printed, strict=True):
        _require(value - mp.mpf(text), 1, mp.mpf("0.51e-5"))


def pode_lines(rng: np.random.Generator) -> Iterator[list[str]]:
    for draw in pode_draws():
        answer = None
        while answer is None:
            row = draw(rng)
            answer = pode_answer(row)
        outputs = (mp.nstr(answer[name], PODE_PRINTED, strip_zeros=False) for name in PODE_OUTPUTS)
        yield [*(_shown(row[name]) for name in PODE_INPUTS), *outputs]


def pode_draws() -> Iterator[Callable[[np.random.Generator], Row]]:
    for reference in (*[np.pi / 2] * 80, *[np.pi] * 80, *[None] * 40):
        yield lambda rng, reference=reference: _pode_row(rng, {"critical_angle": rng.uniform(0.001, 1.57)}, reference)
    for critical in (*np.geomspace(0.001, 0.1, 20), *(np.pi / 2 - np.geomspace(0.1, 0.0008, 20))):
        yield lambda rng, critical=critical: _pode_row(rng, {"critical_angle": critical}, _usual_reference(rng))
    for weight in np.geomspace(1e-6, 1e6, 120):
        yield lambda rng, weight=weight: _pode_row(rng, {"weight_ratio": weight}, _usual_reference(rng))
    for _ in range(40):
        yield lambda rng: _pode_row(rng, {"weight_ratio": 0.0}, np.pi / 2)
    for distance in (*np.geomspace(1e-2, 1e-6, 50), *[1e-9] * 5):
        yield lambda rng, distance=distance: _near_row(rng, distance, upper=False)
        yield lambda rng, distance=distance: _near_row(rng, distance, upper=True)


def _pode_row(rng: np.random.Generator, kind: dict[str, float], reference: float | None) -> Row:
    low = _critical_angle(kind)
    angle = float(low + np.pi * rng.uniform(1e-3, 1 - 1e-3))
    reference = float(low + np.pi * rng.uniform(0.1, 0.9)) if reference is None else reference
    return _pode_inputs(rng, angle, kind, reference)


def _near_row(rng: np.random.Generator, distance: float, upper: bool) -> Row:
    if rng.random() < 1 / 2:
        kind = {"critical_angle": rng.uniform(0.001, 1.57)}
    else:
        kind = {"weight_ratio": _log_uniform(rng, -4, 4)}
    low = _critical_angle(kind)
    angle = low + np.pi - distance if upper else low + distance
    return _pode_inputs(rng, angle, kind, _usual_reference(rng))


def _pode_inputs(rng: np.random.Generator, angle: float, kind: dict[str, float], reference: float) -> Row:
    friction = 0.5 if rng.random() < 1 / 10 else rng.choice([0.0, 1.0], p=[0.05, 0.95]) * rng.uniform(0.0, 0.1)
    values = {"angle": angle, **kind, "friction_ratio": friction, "reference_angle": reference}
    row: Row = dict.fromkeys(PODE_INPUTS)
    return {**row, **{name: float(value) for name, value in values.items()}, "friction_law": str(rng.choice(LAWS))}


def _critical_angle(kind: dict[str, float]) -> float:
    if "critical_angle" in kind:
        return kind["critical_angle"]
    half = kind["weight_ratio"] / 2
    return float(np.arctan2(np.sqrt(2 * half * (np.hypot(half, 1) - half)), np.hypot(half, 1) - half))


def _usual_reference(rng: np.random.Generator) -> float:
    return float(rng.choice([np.pi / 2, np.pi]))


# ---- example 4 of Pode's method: both ends and the length given ----

EXAMPLE4_PRINTED = 20
EXAMPLE4_SOURCE = f"""\
# A line of 86.36 m in a stream, its ends on one vertical, B 30.48 m above A; critical angle 30 deg, friction ratio
# 0.025, constant friction. Made by make_stream_references.py: Pode's functions by quadrature, the two angles by
# Newton's method, with mpmath at {PODE_DIGITS} digits; rounded to {EXAMPLE4_PRINTED} digits. Angles in degrees, lengths
# in m, coordinates from A in Pode's axes (x against the stream, y up), tension in units of the normal drag on 1 m
"""


def write_pode_example4(path: Path) -> None:
    mp.mp.dps = PODE_DIGITS
    answer = example4()
    check_example4(answer)
    shown = ([name, mp.nstr(value, EXAMPLE4_PRINTED, strip_zeros=False)] for name, value in answer.items())
    _write(path, EXAMPLE4_SOURCE, ("name", "value"), shown)


def example4() -> Answer:
    """With the functions taken from 180 deg: equal xi at both ends, and differences of sigma and eta in proportion."""
    degree = mp.pi / 180
    critical, length, depth = 30 * degree, mp.mpf("86.36"), mp.mpf("30.48")
    pode = Pode(critical, mp.sin(critical) ** 2 / mp.cos(critical), mp.mpf("0.025"), "constant")
    A, B = mp.mpf("208.5") * degree, mp.mpf("31.1") * degree
    for _ in range(9):
        (tau_A, at_A), (tau_B, at_B) = (pode.functions(mp.pi, angle) for angle in (A, B))
        sigma, xi, eta = (b - a for a, b in zip(at_A, at_B, strict=True))
        residual = mp.matrix([xi, depth * sigma - length * eta])
        slopes = [
            [sign * rate * mp.cos(a), sign * rate * (depth - length * mp.sin(a))]
            for sign, a, rate in ((-1, A, tau_A / pode.D(A)), (1, B, tau_B / pode.D(B)))
        ]
        step = mp.lu_solve(mp.matrix(slopes).T, -residual)
        A, B = A + step[0], B + step[1]
    _require(mp.norm(step), 1, mp.mpf("1e-33"))
    scale = length / sigma  # tension where alpha is 180 deg
    tau_90, at_90 = pode.functions(mp.pi, mp.pi / 2)
    values = {"angle_A": A / degree, "angle_B": B / degree, "tension_A": scale * tau_A, "tension_B": scale * tau_B}
    places = {"180": (mp.mpf(1), [mp.mpf(0)] * 3), "90": (tau_90, at_90)}
    for name, (tau, at) in places.items():
        s, x, y = (scale * (b - a) for a, b in zip(at_A, at, strict=True))
        values |= {f"x_{name}": x, f"y_{name}": y, f"arc_length_{name}": s, f"tension_{name}": scale * tau}
    return values


def check_example4(answer: Answer) -> None:
    known = {"angle_A": 208.5557, "angle_B": 31.0646, "x_180": -21.499, "y_180": -7.981, "x_90": -33.891, "y_90": 0.886}
    for name, value in known.items():
        _require(answer[name] - value, 1, mp.mpf("0.0006"))


# ---- lines in a stream, in space ----

LINE_PRINTED = 20
LINE_RUNS = ((45, 36, "1e-36"), (58, 46, "1e-46"))  # digits, order, local error
LINE_AGREED = "1e-25"
LINE_INPUTS = (
    "line_length",
    "weight_per_length",
    "diameter",
    "normal_drag_coefficient",
    "tangential_drag_coefficient",
    "friction_law",
    "lay_angle",
    "fluid_density",
    "stream_speed",
    "heading",
    "force_A_x",
    "force_A_y",
    "force_A_z",
)
LINE_OUTPUTS = (
    "position_B_x",
    "position_B_y",
    "position_B_z",
    "force_B_x",
    "force_B_y",
    "force_B_z",
    "tension_A",
    "tension_B",
    "max_tension",
)
LINE_SOURCE = f"""\
# Lines in a uniform stream given by the force at end A, inputs exactly as printed (SI, radians), outputs rounded to
# {LINE_PRINTED} digits; made by make_stream_references.py: Taylor series in arc length of the equations dr/ds = t,
# dF/ds = -q, t = F / |F|, q = K_n |e_p| e_p + K_t g(c) t + K_b (0.4 - 0.3 c^2) c (t x e) - (0, 0, weight_per_length),
# c = t.e, e_p = e - c t, e = (cos heading, sin heading, 0), z up, A in the origin. g = sign(c) (constant), c|c|
# (cosine_squared), 0 (zero); K = C rho V^2 d / 2 with C = C_n, C_t, 2 pi tan(lay_angle). A step ends wherever c changes
# sign or, in a plane line, t_z does. Checked: a run of order {LINE_RUNS[0][1]} in {LINE_RUNS[0][0]} digits and one of \
order {LINE_RUNS[1][1]} in {LINE_RUNS[1][0]} digits, with
# other steps, agree to {LINE_AGREED} of the length and of the tension at B; the lines in a plane (lay angle, heading
# and force_A_y 0) agree with Pode's functions by quadrature to 1e-20. max_tension: anywhere along the line
"""

Vector = list[mp.mpf]
Series = list[mp.mpf]  # Taylor coefficients


@dataclass(frozen=True)
class StreamLine:
    """A line and its stream; the drags K_n, K_t, K_b are per length."""

    length: mp.mpf
    weight: mp.mpf
    normal: mp.mpf
    tangential: mp.mpf
    lateral: mp.mpf
    law: str
    stream: Vector
    force_A: Vector
    is_plane: bool

    @classmethod
    def from_row(cls, row: Row) -> "StreamLine":
        number = {name: mp.mpf(value) for name, value in row.items() if name != "friction_law"}
        pressure = number["fluid_density"] * number["stream_speed"] ** 2 * number["diameter"] / 2
        return cls(
            number["line_length"],
            number["weight_per_length"],
            number["normal_drag_coefficient"] * pressure,
            number["tangential_drag_coefficient"] * pressure,
            2 * mp.pi * mp.tan(number["lay_angle"]) * pressure,
            row["friction_law"],
            [mp.cos(number["heading"]), mp.sin(number["heading"]), mp.mpf(0)],
            [number[f"force_A_{axis}"] for axis in "xyz"],
            row["heading"] == row["lay_angle"] == row["force_A_y"] == 0.0,
        )

    def end_B(self, order: int, tolerance: mp.mpf) -> Answer:
        s, place, force = mp.mpf(0), [mp.mpf(0)] * 3, self.force_A
        highest = tension_A = mp.norm(force)
        signs = self._first_signs()
        while s < self.length:
            step = self.expand(force, signs, order)
            reach = min(step.reach(tolerance), self.length - s)
            crossings = [self._crossing(step, k, signs[k], reach) for k in range(len(signs))]
            h = min(crossings, default=reach)
            signs = [-sign if crossing == h < reach else sign for sign, crossing in zip(signs, crossings, strict=True)]
            s = self.length if h == self.length - s else s + h
            place = [old + value(line, h) for old, line in zip(place, step.place, strict=True)]
            force = [value(line, h) for line in step.force]
            highest = max(highest, mp.norm(force), *step.peaks(h))
        return dict(zip(LINE_OUTPUTS, (*place, *force, tension_A, mp.norm(force), highest), strict=True))

    def _first_signs(self) -> list[int]:
        """Signs of c and, in a plane line, of t_z just after A; none where there is no stream."""
        if self.normal == 0:
            return []
        upward = int(mp.sign(self.force_A[2]) or mp.sign(self.weight) or 1)
        along = self.expand(self.force_A, [1, upward], 2).along
        forward = int(mp.sign(along[0]) or mp.sign(along[1]) or 1)
        return [forward, upward] if self.is_plane else [forward]

    def _crossing(self, step: "Step", which: int, sign: int, reach: mp.mpf) -> mp.mpf:
        line = (step.along, step.tangent[2])[which]
        return next(iter(falls_through_zero([sign * x for x in line], reach)), reach)

    def expand(self, force: Vector, signs: list[int], order: int) -> "Step":
        """Taylor series of everything, one coefficient after the other."""
        F, r, t = ([[x] for x in force], [[mp.mpf(0)] for _ in force], [[], [], []])
        T: Series = []
        c, c_squared, sine, lateral = [], [], [], []
        e_p, across = [[], [], []], [[], [], []]
        for k in range(order):
            T.append(_root_term(T, sum(_product(x, x, k) for x in F), k))
            for x, tangent in zip(F, t, strict=True):
                tangent.append((x[k] - mp.fdot(T[1:], tangent[::-1])) / T[0])
            q = [mp.mpf(0), mp.mpf(0), -self.weight if k == 0 else mp.mpf(0)]
            c.append(mp.fdot(self.stream, [tangent[k] for tangent in t]))
            if self.normal:
                c_squared.append(_product(c, c, k))
                for i, x in enumerate(e_p):
                    x.append((self.stream[i] if k == 0 else 0) - _product(c, t[i], k))
                if self.is_plane:
                    sine.append(signs[1] * t[2][k])
                else:
                    sine.append(_root_term(sine, sum(_product(x, x, k) for x in e_p), k))
                q = [a + self.normal * _product(sine, x, k) for a, x in zip(q, e_p, strict=True)]
                q = [a + self.tangential * x for a, x in zip(q, self._along(signs[0], c_squared, t, k), strict=True)]
            if self.lateral:
                lateral.append((2 * c[k] / 5) - 3 * _product(c_squared, c, k) / 10)
                for x, term in zip(across, _cross([tangent[k] for tangent in t], self.stream), strict=True):
                    x.append(term)
                q = [a + self.lateral * _product(lateral, x, k) for a, x in zip(q, across, strict=True)]
            for i in range(3):
                F[i].append(-q[i] / (k + 1))
                r[i].append(t[i][k] / (k + 1))
        return Step(r, F, t, T, c)

    def _along(self, sign: int, c_squared: Series, t: list[Series], k: int) -> Vector:
        """The k-th coefficient of g(c) t."""
        if self.law == "zero":
            return [mp.mpf(0)] * 3
        return [sign * (x[k] if self.law == "constant" else _product(c_squared, x, k)) for x in t]


@dataclass(frozen=True)
class Step:
    place: list[Series]
    force: list[Series]
    tangent: list[Series]
    tension: Series
    along: Series

    def reach(self, tolerance: mp.mpf) -> mp.mpf:
        """How far the last terms of force and tangent stay below the tolerance."""
        lines = [(line, self.tension[0]) for line in self.force] + [(line, mp.mpf(1)) for line in self.tangent]
        terms = [(abs(line[k]) / size, k) for line, size in lines for k in (len(line) - 1, len(line) - 2)]
        return min((mp.power(tolerance / term, mp.mpf(1) / k) for term, k in terms if term), default=mp.inf)

    def peaks(self, h: mp.mpf) -> Vector:
        """Largest tensions inside the step."""
        return [value(self.tension, s) for s in falls_through_zero(derivative(self.tension), h)]


def falls_through_zero(line: Series, reach: mp.mpf, count: int = 12) -> Iterator[mp.mpf]:
    """Where a series falls from positive to negative; two zeros close together are found by the minimum between."""
    slope = derivative(line)
    places = [reach * j / count for j in range(count + 1)]
    values, slopes = [value(line, s) for s in places], [value(slope, s) for s in places]
    for (a, b), (low, high), (down, up) in zip(*map(pairwise, (places, values, slopes)), strict=True):
        if (low > 0 or a > 0) and low >= 0 > high:
            yield bisect(line, a, b)
        elif low > 0 and high > 0 and down < 0 < up:
            middle = bisect([-x for x in slope], a, b)
            if value(line, middle) < 0:
                yield bisect(line, a, middle)


def bisect(line: Series, a: mp.mpf, b: mp.mpf) -> mp.mpf:
    """The zero of a series that is positive at `a` and negative at `b`."""
    for _ in range(mp.mp.prec + 10):
        middle = (a + b) / 2
        a, b = (middle, b) if value(line, middle) > 0 else (a, middle)
    return b


def value(line: Series, s: mp.mpf) -> mp.mpf:
    return mp.polyval(line[::-1], s)


def derivative(line: Series) -> Series:
    return [k * x for k, x in enumerate(line)][1:]


def _product(a: Series, b: Series, k: int) -> mp.mpf:
    """The k-th coefficient of a b."""
    return mp.fdot(a[: k + 1], b[k::-1])


def _root_term(root: Series, square: mp.mpf, k: int) -> mp.mpf:
    """The k-th coefficient of a square root, from those before it and the k-th coefficient of the square."""
    return mp.sqrt(square) if k == 0 else (square - mp.fdot(root[1:k], root[k - 1 : 0 : -1])) / (2 * root[0])


def _cross(a: Vector, b: Vector) -> Vector:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def line_answer(row: Row) -> Answer:
    """The second run, if the first says the same."""
    answers = []
    for digits, order, tolerance in LINE_RUNS:
        mp.mp.dps = digits
        answers.append(StreamLine.from_row(row).end_B(order, mp.mpf(tolerance)))
    first, second = answers
    for name in LINE_OUTPUTS:
        scale = row["line_length"] if name.startswith("position") else second["tension_B"]
        _require(first[name] - second[name], scale, mp.mpf(LINE_AGREED))
    check_with_pode(row, second)
    return second


def check_with_pode(row: Row, answer: Answer) -> None:
    """Arc length, place and tension of a plane line from its two angles.

    A line that floats is its mirror image; one outside the domain is inside it when followed from B to A.
    """
    line = StreamLine.from_row(row)
    if not line.is_plane or line.normal == 0:
        return
    w, mirror = abs(line.weight) / line.normal, -1 if line.weight < 0 else 1
    pode = Pode(mp.acos(1 / (w / 2 + mp.sqrt(1 + w**2 / 4))), w, line.tangential / line.normal, line.law)
    forces = [line.force_A, [answer[f"force_B_{axis}"] for axis in "xyz"]]
    angles = [mp.atan2(mirror * z, -x) for x, _, z in forces]
    low = pode.critical_angle
    sign = 1 if low < angles[0] % (2 * mp.pi) < low + mp.pi else -1
    A, B = (low + (angle - low) % mp.pi for angle in angles)
    tau, (sigma, xi, eta) = pode.functions(A, B)
    scale = answer["tension_A"] / line.normal
    for found, known, size in (
        (sign * scale * sigma, line.length, line.length),
        (-scale * xi, answer["position_B_x"], line.length),
        (mirror * scale * eta, answer["position_B_z"], line.length),
        (tau, answer["tension_B"] / answer["tension_A"], tau),
    ):
        _require(found - known, size, mp.mpf("1e-20"))


def write_stream_lines(path: Path) -> None:
    _write(path, LINE_SOURCE, (*LINE_INPUTS, *LINE_OUTPUTS), stream_lines(np.random.default_rng(SEED + 1)))


def stream_lines(rng: np.random.Generator) -> Iterator[list[str]]:
    for row in line_rows(rng):
        answer = line_answer(row)
        outputs = (mp.nstr(answer[name], LINE_PRINTED, strip_zeros=False) for name in LINE_OUTPUTS)
        yield [*(_shown(row[name]) for name in LINE_INPUTS), *outputs]


def line_rows(rng: np.random.Generator) -> Iterator[Row]:
    """Every second line starts with the stream under a low tension: these are turned round, past the corners of q."""
    for k in range(80):  # in space
        speed = 0.0 if k < 6 else None
        heading = 0.0 if k % 3 == 0 else float(rng.uniform(-np.pi, np.pi))
        lay = 0.0 if k // 2 % 2 == 0 else float(rng.uniform(0.0, np.radians(20.0)))
        direction = _direction(rng)
        if k % 2:
            direction = direction * np.sign(direction @ (np.cos(heading), np.sin(heading), 0.0))
        yield _line_row(rng, direction, heading, lay, speed, most=1.0 if k % 2 else 50.0)
    for k in range(40):  # in a plane; the last ones start exactly upright or exactly level
        angle = rng.uniform(0.0, 2 * np.pi)
        direction = np.array([abs(np.cos(angle)) if k % 2 else np.cos(angle), 0.0, np.sin(angle)])
        if k >= 34:
            direction = [np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])][k % 2] * rng.choice([-1.0, 1.0])
        speed, weight = 0.0 if k < 3 else None, 0.0 if 3 <= k < 6 else None
        yield _line_row(rng, direction, 0.0, 0.0, speed, weight, most=1.0 if k % 2 else 50.0)
    yield from peaked_rows(rng, 8)


def peaked_rows(rng: np.random.Generator, count: int) -> Iterator[Row]:
    """Light, hard-laid ropes with the largest tension between the ends.

    Without the lateral force it is always at an end; with it, only near the direction tried here, and by little.
    """
    found = 0
    while found < count:
        lay, heading = float(rng.uniform(np.radians(18.0), np.radians(20.0))), float(rng.uniform(-np.pi, np.pi))
        row = {**_line_row(rng, _direction(rng), heading, lay, None), "friction_law": "constant"}
        mp.mp.dps = 20
        row = _with_level_tension(rng, row)
        if not -20.0 <= row["weight_per_length"] <= 200.0:
            continue
        rough = StreamLine.from_row(row).end_B(14, mp.mpf("1e-14"))
        if rough["max_tension"] > max(rough["tension_A"], rough["tension_B"]) * (1 + mp.mpf("1e-6")):
            found += 1
            yield row


def _with_level_tension(rng: np.random.Generator, row: Row) -> Row:
    """The row with a weight that balances the tangential drag, and a force at A such that it does so in the middle."""
    line, side, sign = StreamLine.from_row(row), rng.choice([-1, 1]), int(rng.choice([-1, 1]))
    (cos, sin, _), tilt = line.stream, rng.uniform(0.8, 1.2, size=3) * (0.49, 0.86, 0.125)
    tangent = [sign * tilt[0] * cos + side * tilt[1] * sin, sign * tilt[0] * sin - side * tilt[1] * cos, side * tilt[2]]
    tangent = [x / mp.norm(tangent) for x in tangent]
    row = {**row, "weight_per_length": float(sign * line.tangential / tangent[2])}
    load = [-force[1] for force in StreamLine.from_row(row).expand(tangent, [sign], 2).force]
    tension = mp.norm(load) * line.length * rng.uniform(1.0, 5.0)
    force = [tension * x + q * line.length / 2 for x, q in zip(tangent, load, strict=True)]
    return {**row, **{f"force_A_{axis}": float(x) for axis, x in zip("xyz", force, strict=True)}}


def _line_row(
    rng: np.random.Generator,
    direction: np.ndarray,
    heading: float,
    lay: float,
    speed: float | None,
    weight: float | None = None,
    most: float = 50.0,
) -> Row:
    length, speed = _log_uniform(rng, 0, np.log10(3000.0)), rng.uniform(0.05, 5.0) if speed is None else speed
    weight, diameter = rng.uniform(-20.0, 200.0) if weight is None else weight, rng.uniform(0.005, 0.1)
    normal, tangential, density = rng.uniform(1.1, 1.4), rng.uniform(0.02, 0.04), 1025.0
    load = (abs(weight) + normal * density * speed**2 * diameter / 2) * length
    force = direction * load * _log_uniform(rng, np.log10(0.02), np.log10(most))
    law = str(rng.choice(LAWS, p=(0.45, 0.35, 0.2)))
    numbers = (length, weight, diameter, normal, tangential, law, lay, density, speed, heading, *force)
    return {name: x if isinstance(x, str) else float(x) + 0.0 for name, x in zip(LINE_INPUTS, numbers, strict=True)}


def _direction(rng: np.random.Generator) -> np.ndarray:
    vector = rng.normal(size=3)
    return vector / np.linalg.norm(vector)


if __name__ == "__main__":
    main()
