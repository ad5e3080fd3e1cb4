"""The uniform line that is just strong enough: its stress, its weight, and where there is none."""

from functools import cache

import mpmath as mp
import numpy as np
import pytest

from cablesim.batch import Results, default_outputs, solve
from cablesim.numerics import Array
from cablesim.solver import load_solver
from cablesim.status import Status
from tests.helpers import relative_error, rows

SOLVER = load_solver("uniform_strength")
# Spans keep 1e-4 of the widest away from it: there errors of the stress are multiplied by some seventy, below by less.
ROUNDING = 1e-13
# x tanh(x) = 1, and the widest level span over k, 2 / sinh(x).
PEAK, WIDEST = 1.1996786402577339, 1.3254868386983632


@cache
def lines() -> dict[str, Array]:
    """Feasible lines, half of them level; those that rise are up to a thousand spans high."""
    rng = np.random.default_rng(1)
    strength = 10.0 ** rng.uniform(2.0, 4.0, 2000)
    level = WIDEST * strength[:1000] * np.concatenate([10.0 ** rng.uniform(-6.0, 0.0, 500), rng.uniform(size=500)])
    slope = 10.0 ** rng.uniform(-6.0, 3.0, 2000) * rng.choice([-1.0, 1.0], 2000)
    slope[:1000] = 0.0
    # T = w (a + height): a line higher than k is too heavy for itself.
    inclined = strength[1000:] * 10.0 ** rng.uniform(-6.0, 0.0, 1000) / np.hypot(1.0, slope[1000:])
    span = np.concatenate([level, inclined]) * (1.0 - 1e-4)
    line = {"strength_length": strength, "span": span, "rise": slope * span}
    exists = solve(SOLVER.name, line).status == Status.ok
    assert exists[:1000].all() and exists.sum() > 1700
    clear = solve(SOLVER.name, line | {"span": span * 1.0001, "rise": line["rise"] * 1.0001}).status == Status.ok
    return rows(line, exists & clear)


@cache
def solved() -> Results:
    found = solve(SOLVER.name, lines(), {"nodes": 21}, SOLVER.outputs)
    assert (found.status == Status.ok).all()
    return found


def test_it_is_the_exact_catenary_of_its_length_and_its_largest_stress_is_the_permitted_one() -> None:
    """Stress over weight per volume is tension over weight per length."""
    line, out = lines(), solved().outputs
    catenary = {name: line[name] for name in ("span", "rise")} | {"line_length": out["line_length"]}
    found = solve("catenary_exact", catenary | {"weight_per_length": 1.0}).outputs
    # A catenary follows from its length less its chord, in which the length of a taut line has lost its digits.
    slack = out["line_length"] / np.hypot(line["span"], line["rise"]) - 1.0
    drooping = slack > 1e-2
    assert drooping.sum() > 300
    for name, expected in (("max_tension", line["strength_length"]), ("drop", out["drop"])):
        assert relative_error(found[name], expected)[drooping].max() <= ROUNDING


def test_cross_section_and_weight_are_those_of_the_parameter_of_the_catenary() -> None:
    """k / a and L / a; and the largest tension w (a + drop) is w k, also where the line is taut."""
    line, out = lines(), solved().outputs
    a = line["strength_length"] / out["area_ratio_A"]
    np.testing.assert_array_equal(out["area_ratio_A"], out["area_ratio_B"])
    assert relative_error(out["weight_over_force"], out["line_length"] / a).max() <= ROUNDING
    assert relative_error(a + out["drop"], line["strength_length"]).max() <= ROUNDING


def test_of_the_two_lines_it_is_the_lighter() -> None:
    """That of smaller lambda = l / 2a, at which a lighter line has the larger stress, and a heavier one the smaller."""
    line, out = lines(), solved().outputs
    half_angle, slope = 0.5 * line["span"] * out["area_ratio_A"] / line["strength_length"], line["rise"] / line["span"]

    def stress(x: Array) -> Array:
        return np.cosh(np.arcsinh(np.abs(slope) * x / np.sinh(x)) + x) / x

    assert (stress(0.999 * half_angle) > stress(half_angle)).all()
    assert (stress(half_angle) > stress(1.001 * half_angle)).all()


def test_it_is_heavier_than_the_line_of_equal_strength() -> None:
    line, out = lines(), solved().outputs
    equal = solve("equal_strength", line).outputs
    share = line["span"] / line["strength_length"] > 1e-3
    assert (equal["weight_over_force"][share] < out["weight_over_force"][share]).all()
    thicker = np.maximum(equal["area_ratio_A"], equal["area_ratio_B"])
    assert (thicker[share] < out["area_ratio_A"][share]).all()


@pytest.mark.parametrize("slope", [0.0, 0.3, -2.0, 40.0])
def test_ten_digits_agree_with_an_independent_root(slope: float) -> None:
    span = 0.3 / np.hypot(1.0, slope)
    found = solve(SOLVER.name, {"strength_length": 1.0, "span": span, "rise": slope * span}).outputs
    with mp.workdps(30):
        wanted = 2 / mp.mpf(span)
        x = mp.findroot(
            lambda x: mp.cosh(mp.asinh(abs(slope) * x / mp.sinh(x)) + x) / x - wanted, (1e-3, 1.0), solver="anderson"
        )
        assert found["area_ratio_A"][0] == pytest.approx(float(wanted * x), rel=ROUNDING)


# ---- the widest span ----


def test_the_widest_level_span_is_found_to_the_last_digit() -> None:
    """Whether a stress is above the permitted one is a comparison of two numbers, each right to four units."""
    with mp.workdps(30):
        x = mp.findroot(lambda x: x * mp.tanh(x) - 1, 1.2)
        assert pytest.approx(float(2 / mp.sinh(x)), rel=1e-16) == WIDEST
    strength = 10.0 ** np.random.default_rng(2).uniform(-3.0, 6.0, 1000)
    eps = np.finfo(float).eps
    for share, status in ((1.0 - 4.0 * eps, Status.ok), (1.0 + 4.0 * eps, Status.infeasible)):
        found = solve(SOLVER.name, {"strength_length": strength, "span": WIDEST * share * strength})
        assert (found.status == status).all()


def test_at_the_widest_span_the_parameter_is_that_where_the_stress_is_least() -> None:
    """Where two roots meet half of the digits are known: 1e-16 of the stress is 1e-8 of the root."""
    distance = np.concatenate([[4e-16], np.geomspace(1e-15, 1e-8, 30)])
    found = solve(SOLVER.name, {"strength_length": 1.0, "span": WIDEST * (1.0 - distance)})
    assert (found.status == Status.ok).all()
    half_angle = 0.5 * WIDEST * (1.0 - distance) * found.outputs["area_ratio_A"]
    # log(cosh x / x) = least + x_0^2 (log x - log x_0)^2 / 2, with terms of the third order.
    expected = PEAK * np.exp(-np.sqrt(2.0 * distance) / PEAK)
    assert (np.abs(half_angle - expected) <= 2.0 * distance + 1e-15 / np.sqrt(distance)).all()


@pytest.mark.parametrize(
    ("span", "rise"), [(1.4, 0.0), (3.0, 0.0), (0.1, 1.0), (0.1, -1.2), (1.0, 0.6), (1e30, 0.0), (1.0, 1e3)]
)
def test_a_line_too_wide_or_too_high_does_not_exist(span: float, rise: float) -> None:
    found = solve(SOLVER.name, {"strength_length": 1.0, "span": span, "rise": rise})
    assert found.status == Status.infeasible
    assert found.iterations < 30
    for name in default_outputs(SOLVER):
        assert np.isnan(found.outputs[name]).all(), name


def test_the_line_of_equal_strength_exists_wherever_the_uniform_one_does() -> None:
    assert (solve("equal_strength", lines()).status == Status.ok).all()


# ---- symmetries ----


def test_a_line_seen_in_a_mirror_is_the_mirrored_line() -> None:
    line, out = lines(), solved().outputs
    mirrored = solve(SOLVER.name, line | {"rise": -line["rise"]}).outputs
    for name in ("drop", "line_length", "area_ratio_A", "weight_over_force"):
        np.testing.assert_array_equal(mirrored[name], out[name], err_msg=name)
    assert relative_error(mirrored["vertex_x"], line["span"] - out["vertex_x"], line["span"]).max() <= ROUNDING


def test_longer_lines_scale_exactly() -> None:
    """By a power of two, so that no input is rounded and equality is exact."""
    scaled = solve(SOLVER.name, {name: 8.0 * value for name, value in lines().items()}, {"nodes": 21}, SOLVER.outputs)
    for name, value in scaled.outputs.items():
        factor = 8.0 if name in ("drop", "line_length", "vertex_x", "profile") else 1.0
        np.testing.assert_array_equal(value, factor * solved().outputs[name], err_msg=name)


def test_the_profile_runs_from_support_to_support() -> None:
    line, profile = lines(), solved().outputs["profile"]
    supports = np.stack([line["span"], np.zeros_like(line["span"]), line["rise"]], axis=1)
    miss = np.linalg.norm(profile[:, -1] - supports, axis=1)
    assert (profile[:, 0] == 0.0).all()
    assert (miss / solved().outputs["line_length"]).max() <= ROUNDING


def test_lines_that_are_all_but_upright_are_found() -> None:
    """Of spans to 1e-15 of the rise: the stress has a valley so flat that its slope is lost beside 1."""
    slope = np.geomspace(1e3, 1e15, 60)
    line = {"strength_length": 1.0, "span": 0.3 / slope, "rise": 0.3}
    found = solve(SOLVER.name, line)
    assert (found.status == Status.ok).all()
    # Upright, the line is as thick as its own weight needs: tension goes as 1 + z / a, and the upper end has k.
    np.testing.assert_allclose(1.0 / found.outputs["area_ratio_A"] + found.outputs["drop"], 1.0, rtol=ROUNDING)
    assert (np.diff(found.outputs["area_ratio_A"]) > 0.0).all()
