"""Pode's functions against 25-digit references, the printed table, the equations they solve, and their limits."""

from functools import cache

import numpy as np
import pytest

from cablesim.batch import Results, solve
from cablesim.numerics import Array
from cablesim.physics.stream import FRICTION_LAWS, critical_angle
from cablesim.status import Status
from tests.helpers import REFERENCE, read_table, relative_error, rows

SOLVER = "pode_functions"
FUNCTIONS = ("tau", "sigma", "xi", "eta")
PRECISE, NEAR_SINGULAR = 1e-10, 1e-8
# Sixteen-point panels and a hundred rounded operations, on values that do not depend on an ill-conditioned angle.
ROUNDING = 1e-12


def functions(angle: Array | float, **given: object) -> dict[str, Array]:
    """The four functions, all of which must be solved."""
    found = solve(SOLVER, {"angle": angle, **given})
    assert (found.status == Status.ok).all()
    return found.outputs


def random_lines(size: int, seed: int) -> tuple[dict[str, Array], Array, Array]:
    """Lines of all three laws, and two angles of each that keep away from the ends of its domain."""
    rng = np.random.default_rng(seed)
    lines = {
        "critical_angle": rng.uniform(0.05, 1.5, size),
        "friction_ratio": rng.uniform(0.0, 0.1, size),
        "friction_law": rng.choice(FRICTION_LAWS, size),
    }
    one, other = lines["critical_angle"] + np.pi * rng.uniform(0.02, 0.98, (2, size))
    return lines, one, other


# ---- references ----


@cache
def reference(given: str) -> tuple[dict[str, Array], Results]:
    """The references that name the line by its critical angle, or its weight ratio, and what the solver says."""
    table = read_table(REFERENCE / "pode_functions.csv")
    expected = rows(table, np.isfinite(table[given]))
    names = ("angle", given, "friction_ratio", "friction_law", "reference_angle")
    return expected, solve(SOLVER, {name: expected[name] for name in names})


@pytest.mark.parametrize("given", ["critical_angle", "weight_ratio"])
@pytest.mark.parametrize("output", FUNCTIONS)
def test_every_function_keeps_the_promised_digits(output: str, given: str) -> None:
    expected, found = reference(given)
    assert (found.status == Status.ok).all()
    # xi and eta pass through zero: they are measured by what their integrands add up to without their sign.
    scale = expected["tau"] if output == "tau" else expected[f"{output}_scale"]
    error = np.abs(found.outputs[output] - expected[output]) / np.where(scale > 0.0, scale, 1.0)
    assert error[expected["near"] > 1e-2].max() <= PRECISE
    assert error[(expected["near"] >= 1e-6) & (expected["near"] <= 1e-2)].max() <= NEAR_SINGULAR
    if given == "critical_angle":  # its distance to the angle is exact; that of a rounded root of w is not
        assert error.max() <= PRECISE


def test_the_references_reach_from_the_neutral_line_to_still_water_and_to_both_singular_angles() -> None:
    """Guards the reference file: a promise is worth what it was measured on."""
    table = read_table(REFERENCE / "pode_functions.csv")
    beyond = table["angle"] > 0.5 * np.pi
    assert table["angle"].size >= 500 and set(table["friction_law"]) == set(FRICTION_LAWS)
    assert (table["near"][~beyond] < 1e-5).sum() >= 5 and (table["near"][beyond] < 1e-5).sum() >= 5
    assert np.nanmin(table["critical_angle"]) <= 1e-3 and np.nanmax(table["critical_angle"]) > 1.569
    assert np.nanmin(table["weight_ratio"]) == 0.0 and np.nanmax(table["weight_ratio"]) >= 1e6
    assert table["friction_ratio"].min() == 0.0 and table["friction_ratio"].max() >= 0.1


# ---- the printed table ----

PRINTED = [
    (90.0, "tau", 1.38698),
    (90.0, "sigma", 3.06571),
    (90.0, "xi", -2.24439),
    (90.0, "eta", 1.60605),
    (32.0, "xi", 2.33181),
    (31.0, "xi", 4.05988),
]


@pytest.mark.parametrize(("degrees", "output", "printed"), PRINTED)
def test_the_table_of_the_literature_is_met_to_every_printed_digit(degrees: float, output: str, printed: float) -> None:
    """Critical angle 30 deg, friction ratio 0.025, constant friction, counted from 180 deg."""
    found = functions(np.radians(degrees), critical_angle=np.radians(30.0), friction_ratio=0.025)
    assert round(float(found[output][0]), 5) == printed


# ---- the equations ----


def test_the_functions_solve_their_differential_equations() -> None:
    """Differences of order 4 over 2e-3 rad, 0.06 rad from all corners: an error of (2e-3 / 0.06)^4 / 30, and less."""
    lines, angle, _ = random_lines(2000, seed=1)
    h = 1e-3
    critical, friction = lines["critical_angle"], lines["friction_ratio"]
    corners = np.stack([critical, np.pi / 2 + 0 * angle, np.pi + 0 * angle, np.pi + critical])
    clear = np.abs(corners - angle).min(axis=0) > 0.06
    lines, angle, critical, friction = rows(lines, clear), angle[clear], critical[clear], friction[clear]
    around = [functions(angle + k * h, reference_angle=angle, **lines) for k in (-2, -1, 1, 2)]
    values = {name: [found[name] for found in around] for name in FUNCTIONS[1:]}
    values["log"] = [np.log(found["tau"]) for found in around]
    slope = {name: (a - 8.0 * b + 8.0 * c - d) / (12.0 * h) for name, (a, b, c, d) in values.items()}
    w = np.sin(critical) ** 2 / np.cos(critical)
    D = w * np.cos(angle) - np.sin(angle) * np.abs(np.sin(angle))
    shape = {"constant": np.sign(np.cos(angle)), "cosine_squared": np.cos(angle) * np.abs(np.cos(angle)), "zero": 0.0}
    f_s = friction * np.select([lines["friction_law"] == law for law in shape], list(shape.values()))
    tolerance = 1e-6
    for name, expected in (
        ("log", (f_s + w * np.sin(angle)) / D),
        ("sigma", 1.0 / D),
        ("xi", np.cos(angle) / D),
        ("eta", np.sin(angle) / D),
    ):
        assert (np.abs(slope[name] - expected) <= tolerance * (np.abs(expected) + 1.0 / np.abs(D))).all(), name


def test_another_reference_angle_shifts_and_scales_the_functions() -> None:
    """tau' = tau / tau_1, sigma' = (sigma - sigma_1) / tau_1 and so on, where 1 is the new reference angle."""
    lines, one, angle = random_lines(2000, seed=2)
    old, new = (functions(a, reference_angle=0.5 * np.pi + 0 * a, **lines) for a in (angle, one))
    found = functions(angle, reference_angle=one, **lines)
    np.testing.assert_allclose(found["tau"], old["tau"] / new["tau"], rtol=ROUNDING)
    for name in FUNCTIONS[1:]:
        scale = (np.abs(old["sigma"]) + np.abs(new["sigma"])) / new["tau"]
        assert (np.abs(found[name] - (old[name] - new[name]) / new["tau"]) <= ROUNDING * scale).all(), name


def test_at_the_reference_angle_the_functions_are_one_and_zero() -> None:
    lines, angle, _ = random_lines(500, seed=3)
    found = functions(angle, reference_angle=angle, **lines)
    assert (found["tau"] == 1.0).all()
    for name in FUNCTIONS[1:]:
        assert (found[name] == 0.0).all(), name


def test_the_length_is_no_shorter_than_its_chord_and_grows_with_a_falling_angle() -> None:
    lines, one, other = random_lines(2000, seed=4)
    found = functions(np.minimum(one, other), reference_angle=np.maximum(one, other), **lines)
    assert (found["sigma"] > 0.0).all() and (found["tau"] > 0.0).all()
    assert (np.hypot(found["xi"], found["eta"]) <= found["sigma"] * (1.0 + ROUNDING)).all()


def test_without_friction_the_law_of_friction_makes_no_difference() -> None:
    lines, angle, _ = random_lines(300, seed=5)
    found = {law: functions(angle, **lines | {"friction_law": law, "friction_ratio": 0.0}) for law in FRICTION_LAWS}
    for name in FUNCTIONS:
        np.testing.assert_array_equal(found["constant"][name], found["zero"][name])
        np.testing.assert_array_equal(found["cosine_squared"][name], found["zero"][name])


# ---- the domain ----


def at_and_beyond(critical: float) -> dict[str, list[float]]:
    """Angles inside and outside of the singular angles; an angle next to one of them may be that angle, rounded."""
    upper = critical + np.pi
    lower_rounded, upper_rounded = np.nextafter(critical, 10.0), np.nextafter([upper, upper], [0.0, 10.0])
    return {
        "inside": [critical + 1e-14, critical + 1e-9, 1.5, 3.0, upper - 1e-9, upper - 1e-14],
        "outside": [critical, lower_rounded, critical - 1e-9, 0.0, -1.0, upper, *upper_rounded, upper + 1e-9, 6.0, 1e9],
    }


@pytest.mark.parametrize("critical", [0.1, 0.5, 1.0, 1.4])
@pytest.mark.parametrize("name", ["angle", "reference_angle"])
def test_an_angle_at_a_singular_angle_or_beyond_is_out_of_domain(name: str, critical: float) -> None:
    other = "reference_angle" if name == "angle" else "angle"
    line = {"critical_angle": critical, "friction_ratio": 0.02, other: 2.0}
    expected = {"inside": Status.ok, "outside": Status.out_of_domain}
    for place, angles in at_and_beyond(critical).items():
        found = solve(SOLVER, {**line, name: angles})
        np.testing.assert_array_equal(found.status, expected[place], err_msg=place)
        for values in found.outputs.values():
            assert (np.isnan(values) == (place == "outside")).all()


# ---- limits ----


def test_a_neutral_line_is_the_limit_of_light_ones() -> None:
    """The weight ratio enters at first order: a thousandth of it makes a thousandth of the difference."""
    rng = np.random.default_rng(6)
    line = {"friction_ratio": rng.uniform(0.0, 0.05, 200), "friction_law": rng.choice(FRICTION_LAWS, 200)}
    angle, reference_angle = rng.uniform(0.5, 2.6, (2, 200))
    at_rest = functions(angle, reference_angle=reference_angle, weight_ratio=0.0, **line)
    for ratio in (1e-6, 1e-9, 1e-15):
        found = functions(angle, reference_angle=reference_angle, weight_ratio=ratio, **line)
        for name in FUNCTIONS:
            # The integrand changes by w cos / sin^2 of itself, so over 2 rad by at most 10 w of 1 / sin^4 < 20.
            scale = at_rest["tau"] if name == "tau" else np.abs(at_rest["sigma"])
            error = np.abs(found[name] - at_rest[name]) / scale
            assert error.max() <= 200.0 * ratio + ROUNDING, (name, ratio)


def test_a_neutral_line_without_friction_has_the_functions_of_cotangent_and_cosecant() -> None:
    """D = -sin^2: sigma = cot a - cot a_0, xi = csc a - csc a_0 with its sign, eta = ln tan(a / 2) likewise."""
    rng = np.random.default_rng(7)
    angle, start = rng.uniform(0.05, 3.09, (2, 500))
    found = functions(angle, reference_angle=start, weight_ratio=0.0, friction_ratio=0.0)
    expected = {
        "tau": np.ones(500),
        "sigma": 1.0 / np.tan(angle) - 1.0 / np.tan(start),
        "xi": 1.0 / np.sin(angle) - 1.0 / np.sin(start),
        "eta": np.log(np.tan(0.5 * start)) - np.log(np.tan(0.5 * angle)),
    }
    for name, values in expected.items():
        assert relative_error(found[name], values, 1.0 + np.abs(expected["sigma"])).max() <= ROUNDING, name


def test_a_very_heavy_line_is_a_catenary() -> None:
    """tau = cos a_0 / cos a, w sigma = cos a_0 (tan a - tan a_0) and so on, up to 1 / w of the drag that is left."""
    w = np.repeat([1e4, 1e6, 1e8], 200)
    rng = np.random.default_rng(8)
    # A catenary pulled against the stream has its tangents between 90 and 270 deg.
    angle, start = np.pi + rng.uniform(-1.2, 1.2, (2, w.size))
    found = functions(angle, reference_angle=start, weight_ratio=w, friction_ratio=0.02)
    cosine = np.cos(start)
    expected = {
        "tau": cosine / np.cos(angle),
        "sigma": cosine * (np.tan(angle) - np.tan(start)),
        "xi": cosine * (np.arcsinh(np.tan(angle)) - np.arcsinh(np.tan(start))) * -1.0,
        "eta": cosine * (1.0 / np.cos(angle) - 1.0 / np.cos(start)),
    }
    for name, values in expected.items():
        measured = found[name] * (1.0 if name == "tau" else w)
        # 1 / cos < 2.8: drag adds at most about 2.8^3 of 1 / w to the integrals; the rounded critical angle 1e-16 w.
        assert (np.abs(measured - values) <= 30.0 / w + 1e-15 * w).all(), name


def test_a_line_is_the_same_by_its_critical_angle_and_by_its_weight_ratio() -> None:
    lines, angle, start = random_lines(1000, seed=9)
    critical = lines.pop("critical_angle")
    ratio = np.sin(critical) ** 2 / np.cos(critical)
    np.testing.assert_allclose(critical_angle(ratio, np.ones(1000)), critical, rtol=ROUNDING)
    one = functions(angle, reference_angle=start, critical_angle=critical, **lines)
    other = functions(angle, reference_angle=start, weight_ratio=ratio, **lines)
    for name in FUNCTIONS:
        scale = one["tau"] if name == "tau" else np.abs(one["sigma"]) + one["tau"]
        # The rounding of the ratio moves the singular angle, which is 0.06 rad away or more.
        assert (np.abs(other[name] - one[name]) <= 100.0 * ROUNDING * scale).all(), name
