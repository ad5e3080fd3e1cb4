"""The line of equal strength: its curve, its forces and its length along the profile, its limits and symmetries."""

from functools import cache

import mpmath as mp
import numpy as np
import pytest

from cablesim.batch import Results, default_outputs, solve
from cablesim.numerics import Array
from cablesim.numerics.quadrature import POINTS, WEIGHTS
from cablesim.solver import load_solver
from cablesim.status import Status
from tests.helpers import REFERENCE, read_table, relative_error, rows

SOLVER = load_solver("equal_strength")
# A few hundred units in the last place: closed formulas of a dozen rounded operations, and hyperbolic functions whose
# arguments of up to 20 make twenty of each rounding error.
ROUNDING = 1e-13
NODES = 41


@cache
def lines() -> dict[str, Array]:
    """From spans of a millionth of the widest to a billionth below it, level and with rises of up to 300 spans."""
    rng = np.random.default_rng(1)
    strength = 10.0 ** rng.uniform(2.0, 4.0, 1500)
    narrow, wide = 10.0 ** rng.uniform(-6.0, -0.1, 500), 1.0 - 10.0 ** rng.uniform(-9.0, -0.5, 500)
    span = strength * np.pi * np.concatenate([narrow, wide, rng.uniform(0.01, 0.99, 500)])
    rise = span * 10.0 ** rng.uniform(-6.0, 2.5, 1500) * rng.choice([-1.0, 0.0, 1.0], 1500)
    return {"strength_length": strength, "span": span, "rise": np.clip(rise, -20.0 * strength, 20.0 * strength)}


@cache
def solved() -> Results:
    found = solve(SOLVER.name, lines(), {"nodes": NODES}, SOLVER.outputs)
    assert (found.status == Status.ok).all()
    return found


def angles() -> tuple[Array, Array]:
    """Slope angles at A and B, from where the vertex is."""
    k, span, vertex = lines()["strength_length"], lines()["span"], solved().outputs["vertex_x"]
    return -vertex / k, (span - vertex) / k


# ---- references ----


@pytest.mark.parametrize(
    "output",
    ["drop", "line_length", "area_ratio_A", "area_ratio_B", "weight_over_force", "saved_weight_fraction"],
)
def test_every_output_keeps_the_promised_digits(output: str) -> None:
    table = read_table(REFERENCE / "strength_lines.csv")
    found = solve(SOLVER.name, {name: table[name] for name in ("strength_length", "span", "rise")})
    assert (found.status == Status.ok).all()
    assert relative_error(found.outputs[output], table[output]).max() <= ROUNDING


# ---- the curve and its forces ----


def test_both_ends_lie_on_the_curve() -> None:
    """y = -k ln cos(x / k): away from its asymptotes, at which cos loses the digits of x."""
    line, (start, end) = lines(), angles()
    inside = np.maximum(np.abs(start), np.abs(end)) < 1.5
    assert inside.sum() > 300
    change = line["strength_length"] * np.log(np.cos(start) / np.cos(end))
    # Near 1.5 an error of the angle of one in 1e16 is 15 in 1e16 of the logarithm, which is summed from two.
    assert (np.abs(change - line["rise"]) / line["strength_length"])[inside].max() <= ROUNDING


def test_the_length_is_the_integral_of_the_secant() -> None:
    line, (start, end) = lines(), angles()
    # A panel of sixteen points is right to 1e-15 where the pole of the secant is farther away than 0.7 of its width.
    easy = np.maximum(np.abs(start), np.abs(end)) + 0.7 * (end - start) < 0.5 * np.pi
    assert easy.sum() > 300
    points = start[:, None] + (end - start)[:, None] * POINTS
    length = line["span"] * np.sum(WEIGHTS / np.cos(points), axis=1)
    assert relative_error(solved().outputs["line_length"], length)[easy].max() <= ROUNDING


def test_the_cross_section_is_that_of_the_tension() -> None:
    """T^2 = H^2 + V^2 at every node, T as the cross-section, V growing by the weight between the nodes."""
    out = solved().outputs
    tension, weight = out["profile_area_ratio"], out["profile_weight"]
    # V at A, from the tensions at both ends and the weight between: T_B^2 - T_A^2 = W (2 V_A + W).
    total = out["weight_over_force"]
    start = ((out["area_ratio_B"] / total) ** 2 - (out["area_ratio_A"] / total) ** 2 - 1.0) * 0.5 * total
    vertical = start[:, None] + weight
    largest = np.maximum(np.maximum(out["area_ratio_A"], out["area_ratio_B"]), total)[:, None]
    # Where the line is short and steep V_A is the difference of numbers that are larger by T / W.
    scale = largest**2 * np.maximum(1.0, largest / total[:, None])
    assert (np.abs(tension**2 - 1.0 - vertical**2) / scale).max() <= ROUNDING


def test_the_profile_ends_with_the_scalar_outputs() -> None:
    line, out = lines(), solved().outputs
    profile, scale = out["profile"], np.maximum(line["span"], out["drop"])
    assert (
        (profile[:, 0] == 0.0).all() and (profile[:, :, 1] == 0.0).all() and (out["profile_weight"][:, 0] == 0.0).all()
    )
    assert relative_error(profile[:, -1, 0], line["span"]).max() <= ROUNDING
    assert (np.abs(profile[:, -1, 2] - line["rise"]) / scale).max() <= ROUNDING
    for node, name in ((0, "area_ratio_A"), (-1, "area_ratio_B")):
        assert relative_error(out["profile_area_ratio"][:, node], out[name]).max() <= ROUNDING
    assert relative_error(out["profile_weight"][:, -1], out["weight_over_force"]).max() <= ROUNDING


def test_the_nodes_divide_the_line_equally() -> None:
    """A chord of an arc s of curvature at most 1/k is no shorter than s (1 - (s / k)^2 / 24), and no longer than s."""
    line, out = lines(), solved().outputs
    step = out["line_length"] / (NODES - 1)
    pieces = np.linalg.norm(np.diff(out["profile"], axis=1), axis=2)
    bend = (step / line["strength_length"]) ** 2 / 24.0
    rounding = ROUNDING * out["line_length"]
    assert (pieces <= (step + rounding)[:, None]).all()
    assert (pieces >= (step * (1.0 - bend) - rounding)[:, None]).all()


def test_the_logarithm_of_the_cross_section_grows_with_height() -> None:
    """By one over every k: the work of gravity on a line of one stress, drawn through its own shape."""
    height = solved().outputs["profile"][:, :, 2] / lines()["strength_length"][:, None]
    area = solved().outputs["profile_area_ratio"]
    growth = np.log(area / area[:, :1])
    assert (np.abs(growth - height) / np.maximum(1.0, np.abs(height).max(axis=1, keepdims=True))).max() <= ROUNDING


def test_the_saved_weight_is_what_is_missing_to_a_line_of_the_thicker_end() -> None:
    line, out = lines(), solved().outputs
    thick = np.maximum(out["area_ratio_A"], out["area_ratio_B"]) * out["line_length"] / line["strength_length"]
    saved = 1.0 - out["weight_over_force"] / thick
    np.testing.assert_allclose(out["saved_weight_fraction"], saved, rtol=0.0, atol=ROUNDING)


# ---- limits ----


def test_a_short_level_line_saves_a_twelfth_of_the_square_of_its_span() -> None:
    """cosh(x) - sinh(x) / x = x^2 / 3 + x^4 / 30 with x = l / 2k; the next terms are smaller by x^2 < 1e-8."""
    ratio = np.geomspace(1e-12, 1e-4, 50)
    saved = solve(SOLVER.name, {"strength_length": 1.0, "span": ratio}).outputs["saved_weight_fraction"]
    np.testing.assert_allclose(saved, ratio**2 / 12.0, rtol=1e-8)


def test_a_short_line_is_the_parabola_of_a_uniform_one() -> None:
    """a = k where hardly anything is added to the cross-section: the terms left out are of the order of (l / k)^2."""
    line = {"span": 10.0, "rise": [-4.0, 0.0, 3.0]}
    found = solve(SOLVER.name, {**line, "strength_length": 1e8}).outputs
    chord = np.hypot(10.0, line["rise"])
    assert relative_error(found["line_length"], chord).max() <= 1e-14
    level = 10.0**2 / (8.0 * 1e8)
    np.testing.assert_allclose(found["drop"][1], level, rtol=1e-14)


def test_the_widest_span_is_pi_k_to_the_last_digit() -> None:
    rng = np.random.default_rng(2)
    strength = 10.0 ** rng.uniform(-3.0, 6.0, 200)
    nearest = np.pi * strength
    for span in (np.nextafter(nearest, 0.0), nearest, np.nextafter(nearest, np.inf)):
        found = solve(SOLVER.name, {"strength_length": strength, "span": span})
        with mp.workdps(40):
            exists = [bool(mp.mpf(x) < mp.pi * mp.mpf(k)) for x, k in zip(span, strength, strict=True)]
        np.testing.assert_array_equal(found.status == Status.ok, exists)


def test_a_line_one_float_narrower_than_pi_k_is_as_thick_as_its_complement_says() -> None:
    span = np.nextafter(np.pi, 0.0)
    found = solve(SOLVER.name, {"strength_length": 1.0, "span": span}).outputs["area_ratio_B"]
    with mp.workdps(40):
        exact = 1 / mp.cos(mp.mpf(span) / 2)
    assert found[0] == pytest.approx(float(exact), rel=ROUNDING)


@pytest.mark.parametrize("rise", [0.0, 3.0, -800.0, 1e9])
def test_spans_of_pi_k_or_more_are_infeasible_at_any_rise(rise: float) -> None:
    found = solve(SOLVER.name, {"strength_length": 1.0, "span": [np.nextafter(np.pi, 4.0), 4.0, 1e40], "rise": rise})
    assert (found.status == Status.infeasible).all()
    for name in default_outputs(SOLVER):
        assert np.isnan(found.outputs[name]).all(), name


def test_rises_that_need_a_cross_section_beyond_all_floats_are_out_of_domain() -> None:
    found = solve(SOLVER.name, {"strength_length": 1.0, "span": 1.0, "rise": [600.0, 900.0, -900.0, 1e50]})
    np.testing.assert_array_equal(found.status, [Status.ok, *[Status.out_of_domain] * 3])


# ---- symmetries ----


def test_a_line_seen_in_a_mirror_is_the_mirrored_line() -> None:
    line, out = lines(), solved().outputs
    mirrored = solve(SOLVER.name, line | {"rise": -line["rise"]}, {"nodes": NODES}, SOLVER.outputs).outputs
    for one, other in (("area_ratio_A", "area_ratio_B"), ("area_ratio_B", "area_ratio_A")):
        np.testing.assert_array_equal(mirrored[one], out[other])
    for name in ("drop", "line_length", "saved_weight_fraction", "weight_over_force"):
        np.testing.assert_array_equal(mirrored[name], out[name], err_msg=name)
    assert relative_error(mirrored["vertex_x"], line["span"] - out["vertex_x"], line["span"]).max() <= ROUNDING
    assert relative_error(mirrored["profile_area_ratio"][:, ::-1], out["profile_area_ratio"]).max() <= ROUNDING


def test_longer_lines_scale_exactly() -> None:
    """By a power of two, so that no input is rounded and equality is exact."""
    line, out = lines(), solved().outputs
    scaled = solve(SOLVER.name, {name: 8.0 * value for name, value in line.items()}, {"nodes": NODES}, SOLVER.outputs)
    for name, value in scaled.outputs.items():
        factor = 8.0 if name in ("drop", "line_length", "vertex_x", "profile") else 1.0
        np.testing.assert_array_equal(value, factor * out[name], err_msg=name)


def test_the_number_of_nodes_does_not_change_the_line() -> None:
    some = rows(lines(), slice(100))
    coarse, fine = (solve(SOLVER.name, some, {"nodes": n}, SOLVER.outputs).outputs for n in (2, 11))
    assert fine["profile"].shape == (100, 11, 3)
    for name in default_outputs(SOLVER):
        np.testing.assert_array_equal(coarse[name], fine[name], err_msg=name)
    np.testing.assert_array_equal(coarse["profile"][:, -1], fine["profile"][:, -1])
