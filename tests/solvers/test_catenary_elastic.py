"""The elastic catenary against 25-digit references, and its limits: rigid line, Hooke's spring, line at its chord."""

from functools import cache

import numpy as np
import pytest

from cablesim.batch import Results, default_outputs, solve
from cablesim.numerics import Array
from cablesim.solver import load_solver
from cablesim.status import Status
from tests.helpers import REFERENCE, draw, read_table, relative_error, rows

SOLVER = load_solver("catenary_elastic")
# Any strain from 1e-12 to 10, lines from half their chord to 1e6 chords.
PROMISED = 1e-10
ROUNDING = 1e-14
# Halving a bracket of 60 decades down to the tolerance of the method takes 37; some Newton steps come between.
ALLOWED_ITERATIONS = 50
USUAL_ITERATIONS = 8  # Newton's own convergence from a start that is right in every limit


@cache
def reference() -> tuple[dict[str, Array], Results]:
    expected = read_table(REFERENCE / "catenary_elastic.csv")
    names = ("span", "rise", "line_length", "weight_per_length", "axial_stiffness")
    return expected, solve(SOLVER.name, {name: expected[name] for name in names})


@pytest.mark.parametrize("output", default_outputs(SOLVER))
def test_every_output_keeps_the_promised_digits(output: str) -> None:
    expected, found = reference()
    assert (found.status == Status.ok).all()
    scale = expected["span"] if output == "vertex_x" else 0.0  # passes through zero
    assert relative_error(found.outputs[output], expected[output], scale).max() <= PROMISED


def test_the_references_reach_from_taut_to_slack_and_from_stiff_to_soft() -> None:
    """Guards the reference file: a promise is worth what it was measured on."""
    expected, _ = reference()
    over_chord = expected["line_length"] / np.hypot(expected["span"], expected["rise"]) - 1.0
    strain = expected["weight_per_length"] * expected["line_length"] / expected["axial_stiffness"]
    assert over_chord.min() < -0.4 and over_chord.max() > 9e5
    assert (np.abs(over_chord) < 1e-12).sum() >= 20 and (over_chord < 0.0).sum() >= 100
    assert strain.min() < 2e-12 and strain.max() > 9.0
    assert (expected["rise"] > 0.0).sum() >= 100 and (expected["rise"] < 0.0).sum() >= 100


# ---- limits ----


def test_a_line_of_boundless_stiffness_is_the_inextensible_one() -> None:
    line = draw("catenary_exact", 5000, seed=1)
    rigid = solve("catenary_exact", line)
    feasible = rigid.status == Status.ok
    elastic = solve(SOLVER.name, rows(line, feasible) | {"axial_stiffness": 1e30})
    for name, values in rows(rigid.outputs, feasible).items():
        scale = line["span"][feasible] if name == "vertex_x" else 0.0
        assert relative_error(elastic.outputs[name], values, scale).max() <= 1e-12, name


def test_a_length_ratio_means_exactly_that_many_spans() -> None:
    """1e-12 longer than the span: rounding the length to a float would change the sag in its fourth digit."""
    line = {"span": np.linspace(1.0, 999.0, 777), "length_ratio": 1.0 + 1e-12, "weight_per_length": 1.0}
    rigid = solve("catenary_exact", line)
    elastic = solve(SOLVER.name, line | {"axial_stiffness": 1e40})
    for name in ("sag", "horizontal_tension"):
        np.testing.assert_allclose(elastic.outputs[name], rigid.outputs[name], rtol=1e-12)


def test_a_taut_line_of_hardly_any_weight_is_a_spring() -> None:
    """T = EA (chord / L - 1), the sag that of a flat parabola; the weight adds (w L / T)^2 < 1e-15."""
    rng = np.random.default_rng(2)
    span, rise = rng.uniform(1.0, 1e3, 2000), rng.uniform(-3e2, 3e2, 2000)
    chord = np.hypot(span, rise)
    length, stiffness = chord * rng.uniform(0.5, 0.99, 2000), 10.0 ** rng.uniform(4, 9, 2000)
    tension = stiffness * (chord - length) / length
    weight = 1e-8 * tension / length
    line = {"span": span, "rise": rise, "line_length": length, "weight_per_length": weight}
    found = solve(SOLVER.name, line | {"axial_stiffness": stiffness})
    assert (found.status == Status.ok).all()
    out = found.outputs
    np.testing.assert_allclose(out["horizontal_tension"], tension * span / chord, rtol=ROUNDING)
    np.testing.assert_allclose(0.5 * (out["tension_A"] + out["tension_B"]), tension, rtol=ROUNDING)
    np.testing.assert_allclose(out["stretched_length"], chord, rtol=ROUNDING)
    np.testing.assert_allclose(out["sag"], weight * length * chord / (8.0 * tension), rtol=ROUNDING)


def test_a_line_as_long_as_its_chord_stretches_by_the_cube_root_of_its_softness() -> None:
    """Level: the strain H / EA equals the excess of a flat parabola, (W / H)^2 / 24, so H^3 = EA W^2 / 24."""
    W, softness = 10.0, np.array([1e-15, 1e-12])  # the next term is of the relative size of the strain
    line = {"span": 5.0, "line_length": 5.0, "weight_per_length": W / 5.0, "axial_stiffness": W / softness}
    H = solve(SOLVER.name, line).outputs["horizontal_tension"]
    assert (relative_error(H, np.cbrt(W**3 / (24.0 * softness))) <= H * softness / W).all()


def test_a_softer_line_sags_more() -> None:
    line = with_strain(draw(SOLVER.name, 4000, seed=3))
    soft = line | {"axial_stiffness": 0.5 * line["axial_stiffness"]}
    assert (solve(SOLVER.name, soft).outputs["sag"] > solve(SOLVER.name, line).outputs["sag"]).all()


def test_a_hanging_line_is_longer_than_it_was_and_than_its_chord() -> None:
    line = with_strain(draw(SOLVER.name, 4000, seed=3))
    stretched = solve(SOLVER.name, line).outputs["stretched_length"]
    assert (stretched > line["line_length"]).all()
    assert (stretched >= (1.0 - ROUNDING) * np.hypot(line["span"], line["rise"])).all()


def with_strain(line: dict[str, Array]) -> dict[str, Array]:
    """The lines so heavy or soft that rounding does not decide."""
    visible = line["weight_per_length"] * line["line_length"] > 1e-6 * line["axial_stiffness"]
    assert visible.sum() > 1000
    return rows(line, visible)


# ---- the method ----


def test_every_line_of_the_declared_ranges_is_solved_in_few_steps() -> None:
    found = solve(SOLVER.name, draw(SOLVER.name, 20_000, seed=4), outputs=("sag",))
    assert (found.status == Status.ok).all()
    assert (found.iterations >= 1).all()
    assert np.quantile(found.iterations, 0.99) <= USUAL_ITERATIONS
    assert found.iterations.max() <= ALLOWED_ITERATIONS


def test_lines_far_outside_the_declared_ranges_are_solved_in_bounded_steps() -> None:
    rng = np.random.default_rng(5)
    size = 20_000
    span = 10.0 ** rng.uniform(-3, 6, size)
    rise = span * 10.0 ** rng.uniform(-8, 8, size) * rng.choice([-1.0, 0.0, 1.0], size)
    excess = 10.0 ** rng.uniform(-16, 9, size) * rng.choice([-1.0, 1.0], size)
    length = np.hypot(span, rise) * np.maximum(0.01, 1.0 + excess)
    weight = 10.0 ** rng.uniform(-6, 6, size)
    line = {"span": span, "rise": rise, "line_length": length, "weight_per_length": weight}
    line["axial_stiffness"] = weight * length / 10.0 ** rng.uniform(-20, 4, size)
    found = solve(SOLVER.name, line)
    assert (found.status == Status.ok).all()
    assert found.iterations.max() <= ALLOWED_ITERATIONS
