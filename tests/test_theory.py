"""Equations as docs/theory prints them hold of what solvers answer, where these compute them in another form."""

import numpy as np
import pytest

from cablesim.batch import solve
from cablesim.physics.stream import FRICTION_LAWS
from cablesim.status import Status


def answers(solver: str, **line: object) -> dict[str, np.ndarray]:
    found = solve(solver, line)
    assert (found.status == Status.ok).all()
    return {name: values[0] for name, values in found.outputs.items()}


def test_c1_reduces_the_elastic_catenary_to_one_equation():
    span, rise, length, weight, stiffness = 100.0, 20.0, 101.0, 10.0, 1e5
    found = answers(
        "catenary_elastic",
        span=span,
        rise=rise,
        line_length=length,
        weight_per_length=weight,
        axial_stiffness=stiffness,
    )
    strain = weight * length / (2.0 * stiffness)
    half = weight * span / (2.0 * found["horizontal_tension"]) - strain
    lean = np.arctanh(rise / length / (1.0 + strain / np.tanh(half)))
    assert 1.0 / np.cosh(lean) == pytest.approx(span / length * np.sinh(half) / (half + strain), rel=1e-13)


def test_the_series_is_a_quadratic_equation():
    found = answers("catenary_series", span=1.0, line_length=1.3, weight_per_length=1.0)
    a = found["catenary_parameter"]
    square = (0.5 / a) ** 2
    assert square**2 / 120.0 + square / 6.0 == pytest.approx(0.3, rel=1e-13)
    assert found["sag"] == pytest.approx(1.0 / (8.0 * a) + 1.0 / (384.0 * a**3), rel=1e-13)


STRENGTH, SPAN, RISE = 3000.0, 2500.0, 400.0
DESIGN = {"strength_length": STRENGTH, "span": SPAN, "rise": RISE}


def test_e1_gives_length_and_cross_sections_of_the_line_of_equal_strength():
    found = answers("equal_strength", **DESIGN)
    b, e = SPAN / (2.0 * STRENGTH), RISE / (2.0 * STRENGTH)
    d = np.hypot(np.sin(b), np.sinh(e))
    assert np.sinh(found["line_length"] / (2.0 * STRENGTH)) == pytest.approx(d / np.cos(b), rel=1e-13)
    for end, sign in (("A", -1.0), ("B", 1.0)):
        expected = np.exp(sign * e) * d / (np.sin(b) * np.cos(b))
        assert found[f"area_ratio_{end}"] == pytest.approx(expected, rel=1e-13)


def test_e2_holds_of_the_uniform_line():
    found = answers("uniform_strength", **DESIGN)
    half = SPAN * found["area_ratio_A"] / (2.0 * STRENGTH)
    upper = np.arcsinh(RISE * half / (SPAN * np.sinh(half))) + half
    assert np.cosh(upper) / half == pytest.approx(2.0 * STRENGTH / SPAN, rel=1e-13)


def test_the_stress_under_another_force_is_largest_at_the_ends_or_in_the_middle():
    level = DESIGN | {"rise": 0.0}
    length = answers("equal_strength", **level)["line_length"]
    for force, place in ((0.5, 0.0), (2.0, 0.5)):
        found = answers("equal_strength_loaded", **level, force_ratio=force, arc_fraction=place)
        u = (place - 0.5) * length / STRENGTH
        assert found["stress_ratio"] == pytest.approx(np.hypot(force, np.sinh(u)) / np.cosh(u), rel=1e-12)
        assert found["max_stress_ratio"] == pytest.approx(found["stress_ratio"], rel=1e-12)


LENGTHS, WEIGHTS, PULL = np.array([400.0, 50.0]), np.array([80.04, 597.69]), 49e3
TOW = {"section_length": LENGTHS, "section_weight": WEIGHTS, "horizontal_tension": PULL}


def test_the_handbooks_vertex_is_where_its_formula_has_it():
    (wire, chain), (wire_weight, chain_weight) = LENGTHS, WEIGHTS
    alpha = np.exp(-PULL / chain_weight / chain)
    expected = (wire**2 - (1.0 - 0.87 * alpha) * chain_weight / wire_weight * chain**2) / (2.0 * (wire + chain))
    assert wire - answers("composite_handbook", **TOW)["vertex_s"] == pytest.approx(expected, rel=1e-12)


def test_the_parabolic_vertex_balances_moments_about_end_b():
    total, rise = LENGTHS.sum(), 10.0
    weight = WEIGHTS * LENGTHS
    mean = (LENGTHS * (np.cumsum(weight) - 0.5 * weight)).sum() / total
    vertical = PULL * rise / np.sqrt(total**2 - rise**2) - mean
    assert answers("composite_parabolic", **TOW, rise=rise)["tension_A"] == pytest.approx(np.hypot(vertical, PULL))


@pytest.mark.parametrize("law", FRICTION_LAWS)
@pytest.mark.parametrize(("start", "end", "sign"), [(0.7, 1.3, 1.0), (1.8, 2.9, -1.0)])
def test_the_tension_in_a_stream_is_the_closed_form(law, start, end, sign):
    critical, friction = 0.5, 0.03
    c, s = np.cos(critical), np.sin(critical)

    def logarithm(a: float) -> float:
        j_1 = np.log(abs(np.sin(0.5 * (a + critical)) / np.sin(0.5 * (a - critical)))) / s
        k_2 = 2.0 / s * np.arctan(np.tan(0.5 * critical) * np.tan(0.5 * a))
        weight = -(s**2) / (1.0 + c**2) * np.log(abs(np.cos(a) - c) / (1.0 + c * np.cos(a)))
        laws = {
            "constant": friction * c / (1.0 + c**2) * (j_1 - c * k_2),
            "cosine_squared": friction * (a + (c**3 * j_1 - k_2) / (1.0 + c**2)),
            "zero": 0.0,
        }
        return weight + sign * laws[law]

    line = {"critical_angle": critical, "friction_ratio": friction, "friction_law": law}
    found = answers("pode_functions", angle=end, reference_angle=start, **line)
    assert np.log(found["tau"]) == pytest.approx(logarithm(end) - logarithm(start), rel=1e-12)


def test_two_ends_in_a_stream_follow_from_differences_of_the_functions():
    length, end, drag, weight = 86.36, np.array([20.0, 0.0, 30.48]), 6.0, 1.7
    found = answers(
        "pode_line",
        position_B=end,
        line_length=length,
        weight_per_length=weight,
        diameter=0.01,
        normal_drag_coefficient=1.2,
        tangential_drag_coefficient=0.03,
        fluid_density=1000.0,
        stream_speed=1.0,
    )
    ratios = {"weight_ratio": weight / drag, "friction_ratio": 0.025, "reference_angle": 0.5 * np.pi}
    first, last = (answers("pode_functions", angle=found[f"angle_{name}"], **ratios) for name in "AB")
    unit = length / (last["sigma"] - first["sigma"])
    assert -unit * (last["xi"] - first["xi"]) == pytest.approx(end[0], rel=1e-12)
    assert unit * (last["eta"] - first["eta"]) == pytest.approx(end[2], rel=1e-12)
    assert drag * unit * first["tau"] == pytest.approx(found["tension_A"], rel=1e-12)
