"""Lines between two supports: the exact and the elastic catenary, the level formulas, and how far these can be used."""

import numpy as np

from cablesim.batch import Results, solve
from cablesim.hunt._case import Case, Judge
from cablesim.hunt._draw import few_nodes, mixed, shared, signed, spread
from cablesim.hunt._precise import PRECISION, excess_of_squares, extended, log_sinhc, off, sinhc_excess
from cablesim.numerics import Array
from cablesim.physics.level_span import FORMULAS

LEVEL = ("catenary_parabolic", "catenary_series", "catenary_handbook")
SOLVERS = ("catenary_exact", "catenary_elastic", *LEVEL, "catenary_limit_ratio")
# What the exact line promises: all but the last four digits.
EXACT = 1e-12
# What the elastic line promises, of any strain and slack.
ELASTIC = 1e-10
# A closed formula of a dozen operations on floats.
CLOSED = 1e-14
# Laws that hold between answers which each have the rounding of some ten operations.
LAW = 1e-13
# So much longer is the line that must be less taut.
LONGER = 1.001
NEWTON_STEPS = 40
# Instead of nothing, under nothing.
TINY = 1e-300
# Elastic equations are nearly linear in the logarithms, and are started from the answer to be judged.
POLISHING_STEPS = 8
SMALL_STEP = 1e-6
# The limit of a formula is a root that is found to this part of itself, and at so many shorter lines it must keep
# what it promises.
ROOT, PLACES = 1e-9, 24


def draw(solver: str, size: int, rng: np.random.Generator) -> list[Case]:
    """Lines by their length and, at other supports, by their length ratio; formulas by the error permitted."""
    if solver == "catenary_limit_ratio":
        return [
            Case(solver, {"permitted_error": spread(rng, n, 1e-9, 1e3)}, {"formula": formula})
            for n, formula in zip(shared(size, len(FORMULAS)), FORMULAS, strict=True)
            if n
        ]
    by_ratio, by_length = shared(size, 2)
    cases = [_by_length(solver, by_length, rng), _by_ratio(solver, by_ratio, rng)]
    return [Case(solver, values, few_nodes(solver)) for values in cases if len(values["span"])]


def judges(solver: str) -> dict[str, Judge]:
    """Invariants, and the solver's own equations at higher precision."""
    if solver == "catenary_limit_ratio":
        return {"limit": limit_is_kept}
    if solver in LEVEL:
        return {"closure": closes, "second": level_formula}
    second: Judge = exact_line if solver == "catenary_exact" else elastic_line
    return {"closure": closes, "energy": energy, "mirror": mirror, "monotone": monotone, "second": second}


# ---- what is drawn ----


def _slack(rng: np.random.Generator, size: int) -> Array:
    """Length over chord less one: a hair, anything, immense, and sometimes too short."""
    hair = 2.0**-52 * rng.integers(1, 64, size)
    too_short = -spread(rng, size, 1e-16, 0.9)
    some = spread(rng, size, 1e-6, 10.0)
    return mixed(rng, hair, spread(rng, size, 1e-15, 1e-3), some, some, spread(rng, size, 1.0, 1e8), too_short)


def _by_length(solver: str, size: int, rng: np.random.Generator) -> dict[str, Array]:
    span = mixed(rng, spread(rng, size, 1.0, 1e3), spread(rng, size, 1e-9, 1e9))
    slope = mixed(
        rng,
        np.zeros(size),
        rng.uniform(-2.0, 2.0, size),
        signed(rng, spread(rng, size, 1e-12, 1e-2)),
        signed(rng, spread(rng, size, 2.0, 1e7)),
    )
    rise = np.zeros(size) if solver in LEVEL else slope * span
    length = np.hypot(span, rise) * (1.0 + _slack(rng, size))
    values = _others(solver, size, rng) | {"span": span, "line_length": length}
    return _stretchy(values | ({} if solver in LEVEL else {"rise": rise}), length, solver, rng)


def _by_ratio(solver: str, size: int, rng: np.random.Generator) -> dict[str, Array]:
    """At one level, where a length ratio says more of the slack than a length can."""
    span = mixed(rng, spread(rng, size, 1.0, 1e3), spread(rng, size, 1e-9, 1e9))
    values = _others(solver, size, rng) | {"span": span, "length_ratio": 1.0 + _slack(rng, size)}
    return _stretchy(values, span * values["length_ratio"], solver, rng)


def _others(solver: str, size: int, rng: np.random.Generator) -> dict[str, Array]:
    return {"weight_per_length": mixed(rng, spread(rng, size, 0.1, 1e4), spread(rng, size, 1e-12, 1e12))}


def _stretchy(values: dict[str, Array], length: Array, solver: str, rng: np.random.Generator) -> dict[str, Array]:
    """With an axial stiffness of 0.1 to 1e15 times the weight."""
    if solver != "catenary_elastic":
        return values
    size = length.size
    over_weight = mixed(rng, spread(rng, size, 1e2, 1e6), spread(rng, size, 0.1, 1e15))
    return values | {"axial_stiffness": over_weight * values["weight_per_length"] * length}


# ---- laws ----


def _length(case: Case) -> Array:
    p = case.parameters
    return p["line_length"] if "line_length" in p else p["length_ratio"] * p["span"]


def _rise(case: Case) -> Array:
    return case.parameters.get("rise", np.zeros(case.size))


def closes(case: Case, results: Results) -> Array:
    """The profile ends at the supports, relative to the longest distance on it."""
    profile = results.outputs["profile"]
    ends = np.column_stack([case.parameters["span"], np.zeros(case.size), _rise(case)])
    size = np.linalg.norm(profile, axis=2).max(axis=1)
    miss = np.linalg.norm(profile[:, -1] - ends, axis=1) + np.linalg.norm(profile[:, 0], axis=1)
    # An inextensible line is summed up over its length, an elastic one over what it is stretched to.
    return miss / (EXACT * np.maximum(size, results.outputs.get("stretched_length", _length(case))))


def energy(case: Case, results: Results) -> Array:
    """T_B - T_A + (T_B^2 - T_A^2) / 2 EA = w h."""
    p, found = case.parameters, results.outputs
    tension_A, tension_B = extended(found["tension_A"]), extended(found["tension_B"])
    weight = extended(p["weight_per_length"]) * _rise(case)
    gain, scale = tension_B - tension_A, tension_A + tension_B
    if "axial_stiffness" in p:
        stretch = scale / (2 * extended(p["axial_stiffness"]))
        gain, scale = gain * (1 + stretch), scale * (1 + stretch)
    return (np.abs(gain - weight) / (EXACT * np.maximum(scale, np.abs(weight)))).astype(float)


def mirror(case: Case, results: Results) -> Array:
    """With its ends swapped a line has the same tensions, swapped, and its vertex on the other side."""
    p, found = case.parameters, results.outputs
    other = case.solve(rise=-_rise(case)).outputs
    same = {"tension_A": "tension_B", "tension_B": "tension_A", "sag": "sag", "drop": "drop"}
    same["horizontal_tension"] = "horizontal_tension"
    miss = np.max([off(other[a], found[b]) for a, b in same.items()], axis=0)
    # Far away from a line that is nearly straight, the vertex is known to a part of its distance.
    distance = np.abs(found["vertex_x"]) + p["span"]
    vertex = np.abs(p["span"] - other["vertex_x"] - found["vertex_x"]) / distance
    return np.fmax(miss, vertex) / LAW


def monotone(case: Case, results: Results) -> Array:
    """A longer line is less taut."""
    name = "line_length" if "line_length" in case.parameters else "length_ratio"
    longer = case.solve(("horizontal_tension",), **{name: case.parameters[name] * LONGER})
    less = longer.outputs["horizontal_tension"] < results.outputs["horizontal_tension"]
    return np.where(less, 0.0, np.inf)


# ---- second answers ----


def _exact_excess(case: Case) -> np.ndarray:
    p = case.parameters
    if "line_length" in p:
        return excess_of_squares(p["line_length"], p["span"], _rise(case))
    ratio = extended(p["length_ratio"])
    return (ratio - 1) * (ratio + 1) * extended(p["span"]) ** 2


def exact_line(case: Case, results: Results) -> Array:
    """The catenary in extended precision: log(sinh(lambda) / lambda) by Newton's method, convex, from below."""
    span, rise = extended(case.parameters["span"]), extended(_rise(case))
    target = np.log1p(_exact_excess(case) / span**2) / 2
    angle = np.sqrt(6 * target)
    for _ in range(NEWTON_STEPS):
        slope = np.where(angle < SMALL_STEP, angle / 3, 1 / np.tanh(angle) - 1 / angle)
        angle = angle - (log_sinhc(angle) - target) / slope
    length = extended(_length(case))
    mean = np.arcsinh(rise / span / (1 + sinhc_excess(angle)))
    precision = np.full(case.size, EXACT)
    return _worst_of_curve(case, results, angle, mean, length, extended(np.zeros(case.size)), precision)


def elastic_line(case: Case, results: Results) -> Array:
    """The elastic catenary in extended precision: h^2 / (1 + e coth)^2 + l^2 sinh^2 / (lambda + e)^2 = L^2."""
    p = case.parameters
    span, rise, length = extended(p["span"]), extended(_rise(case)), extended(_length(case))
    if "length_ratio" in p:
        length = extended(p["length_ratio"]) * span
    strain = extended(p["weight_per_length"]) * length / (2 * extended(p["axial_stiffness"]))

    def log_ratio(angle: np.ndarray) -> np.ndarray:
        rho, growth = strain / angle, 1 + sinhc_excess(angle)
        vertical = rise / (1 + rho * np.cosh(angle) / growth)
        return np.log(np.hypot(vertical, span * growth / (1 + rho)) / length)

    angle = span / (2 * extended(results.outputs["catenary_parameter"])) - strain
    angle = np.maximum(angle, PRECISION * strain)
    for _ in range(POLISHING_STEPS):
        here = log_ratio(angle)
        slope = (log_ratio(angle * (1 + SMALL_STEP)) - here) / SMALL_STEP
        angle = angle * np.exp(np.clip(-here / slope, -1, 1))
    mean = np.arcsinh(rise / span * (angle + strain) / (np.sinh(angle) + strain * np.cosh(angle)))
    # The equation in its plain form feels lambda by its slope: as little as it does, so little of lambda is known.
    precision = (ELASTIC + 16 * PRECISION * (1 + 1 / slope)).astype(float)
    return _worst_of_curve(case, results, angle, mean, length, strain, precision)



def _worst_of_curve(
    case: Case,
    results: Results,
    angle: np.ndarray,
    mean: np.ndarray,
    length: np.ndarray,
    strain: np.ndarray,
    precision: Array,
) -> Array:
    """By how much any output differs from the same of a curve known by lambda, mu and e."""
    p, found = case.parameters, results.outputs
    span, weight = extended(p["span"]), extended(p["weight_per_length"])
    a = span / (2 * (angle + strain))
    stretch = 2 * a * strain / length  # H / EA
    upper = np.abs(mean) + angle
    expected = {
        "catenary_parameter": a,
        "horizontal_tension": weight * a,
        "tension_A": weight * a * np.cosh(mean - angle),
        "tension_B": weight * a * np.cosh(mean + angle),
        "max_tension": weight * a * np.cosh(upper),
        "drop": 2 * a * np.sinh(upper / 2) ** 2 + a * stretch * np.sinh(upper) ** 2 / 2,
        "stretched_length": length
        + a * stretch * (2 * angle + np.sinh(2 * angle) * np.cosh(2 * mean)) / 2,
    }
    worst = np.max([off(found[name], value) for name, value in expected.items()], axis=0)
    vertex = a * ((angle - mean) + stretch * np.sinh(angle - mean))
    far = a * ((angle + np.abs(mean)) + stretch * np.sinh(upper))
    worst = np.fmax(worst, off(found["vertex_x"], vertex, far))
    return np.fmax(worst, (np.abs(_sag(case, a, angle, strain, stretch) / found["sag"] - 1)).astype(float)) / (
        precision
    )


def _sag(case: Case, a: np.ndarray, angle: np.ndarray, strain: np.ndarray, stretch: np.ndarray) -> np.ndarray:
    """Below the chord, where the slope is that of the chord, counted from the upper support.

    The line at mid-angle leans less than its chord by a share of lag / (lambda + e + lag).
    """
    slope = np.abs(extended(_rise(case)) / extended(case.parameters["span"]))
    lag = angle * sinhc_excess(angle) + 2 * strain * np.sinh(angle / 2) ** 2
    less = slope * lag / (angle + strain + lag)
    mean = slope - less
    secant = np.hypot(1, slope)
    leaned = np.arcsinh(less * (slope + mean) / np.maximum(slope * np.hypot(1, mean) + mean * secant, TINY))
    turn = angle - leaned
    rigid = a * (2 * secant * np.sinh(turn / 2) ** 2 + slope * turn * sinhc_excess(turn))
    gain = secant * np.sinh(turn) + 2 * slope * np.sinh(turn / 2) ** 2
    return rigid + a * stretch * gain**2 / 2


def level_formula(case: Case, results: Results) -> Array:
    """The formulas of the docstrings, in extended precision from the exact slack."""
    p, found = case.parameters, results.outputs
    span, weight = extended(p["span"]), extended(p["weight_per_length"])
    if "line_length" in p:
        slack = extended(p["line_length"]) - span
    else:
        slack = (extended(p["length_ratio"]) - 1) * span
    if case.solver == "catenary_series":
        y = _series_root(slack / span)
        a = span / (2 * np.sqrt(y))
        sag = span**2 / (8 * a) + span**4 / (384 * a**3)
        tension = weight * (a + sag)
    else:
        sag = np.sqrt((6 if case.solver == "catenary_parabolic" else 3) * span * slack) / 4
        a = span**2 / (8 * sag)
        tension = weight * span / 2 * np.sqrt(1 + (span / (4 * sag)) ** 2)
    expected = {"catenary_parameter": a, "horizontal_tension": weight * a, "sag": sag, "drop": sag}
    expected |= {name: tension for name in ("tension_A", "tension_B", "max_tension")} | {"vertex_x": span / 2}
    return np.max([off(found[name], value) for name, value in expected.items()], axis=0) / CLOSED


def _series_root(excess: np.ndarray) -> np.ndarray:
    """The positive y of y^2/120 + y/6 = L/l - 1, in the form that keeps small ones: y = 6 e 2 / (1 + root)."""
    return 12 * excess / (1 + np.sqrt(1 + 6 * excess / 5))


def limit_is_kept(case: Case, results: Results) -> Array:
    """At the limit the error is the permitted one, and for no shorter line it is more."""
    formula, permitted = f"catenary_{case.options['formula']}", case.parameters["permitted_error"]
    worst = np.zeros(case.size)
    for limit, output in (("sag_limit_ratio", "sag"), ("tension_limit_ratio", "max_tension")):
        ratio = results.outputs[limit]
        beyond, before = (_error(formula, output, 1.0 + (ratio - 1.0) * part) for part in (1 + ROOT, 1 - ROOT))
        # Rounding of sag and tension, four digits, makes errors of errors.
        room = EXACT + 2.0 * np.abs(beyond - before)
        worst = np.fmax(worst, np.abs(_error(formula, output, ratio) - permitted) / room)
        for part in np.geomspace(1e-6, 1.0, PLACES, endpoint=False):
            over = _error(formula, output, 1.0 + (ratio - 1.0) * part) - permitted
            worst = np.fmax(worst, over / room)
    return worst


def _error(formula: str, output: str, ratio: Array) -> Array:
    line = {"span": 1.0, "weight_per_length": 1.0, "length_ratio": ratio}
    found, exact = (solve(name, line, outputs=(output,)).outputs[output] for name in (formula, "catenary_exact"))
    return np.abs(1.0 - found / exact)
