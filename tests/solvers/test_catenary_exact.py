"""The exact catenary against 25-digit references, its limits, what it refuses, and the published sags."""

from functools import cache

import numpy as np
import pytest

from cablesim.batch import Results, default_outputs, solve
from cablesim.numerics import Array
from cablesim.solver import load_solver
from cablesim.status import Status
from tests.helpers import PUBLISHED, REFERENCE, draw, read_table, relative_error, rows

SOLVER = load_solver("catenary_exact")
# What the solver promises: all but the last four digits, of any line from 1e-12 longer than its chord to 1e6 spans.
PROMISED = 1e-12
ROUNDING = 1e-14
# Span, rise and chord of 53 bits each, exact as floats although their squares are not.
PYTHAGORAS = tuple(float(n) for n in (90000001**2 - 30000002**2, 2 * 90000001 * 30000002, 90000001**2 + 30000002**2))


@cache
def reference(given: str) -> tuple[dict[str, Array], Results]:
    """The reference lines whose length is given by one of its two names, and what the solver says of them."""
    table = read_table(REFERENCE / "catenary_exact.csv")
    expected = rows(table, np.isfinite(table[given]))
    return expected, solve(SOLVER.name, {name: expected[name] for name in ("span", "rise", "weight_per_length", given)})


@pytest.mark.parametrize("given", ["line_length", "length_ratio"])
@pytest.mark.parametrize("output", default_outputs(SOLVER))
def test_every_output_keeps_the_promised_digits(output: str, given: str) -> None:
    expected, found = reference(given)
    assert (found.status == Status.ok).all()
    scale = expected["span"] if output == "vertex_x" else 0.0  # passes through zero
    assert relative_error(found.outputs[output], expected[output], scale).max() <= PROMISED


def test_the_references_reach_from_taut_to_slack_and_from_level_to_steep() -> None:
    """Guards the reference file: a promise is worth what it was measured on."""
    for given in ("line_length", "length_ratio"):
        expected, _ = reference(given)
        over_chord = expected["stretched_length"] / np.hypot(expected["span"], expected["rise"]) - 1.0
        steepness = expected["rise"] / expected["stretched_length"]
        assert over_chord.size >= 100
        assert over_chord.min() < 2e-12 and over_chord.max() > 9e5
        assert steepness.min() < -0.9 and steepness.max() > 0.9 and (steepness == 0.0).sum() >= 50


# ---- what has no answer ----


@pytest.mark.parametrize(
    ("span", "rise", "length"),
    [
        (3.0, 4.0, 5.0),
        (3.0, -4.0, 5.0),
        (2.5, 0.0, 2.5),
        (0.1, 0.0, 0.1),
        PYTHAGORAS,
        (10.0, 3.0, 1.0),
        (1.0, 0.0, 1.0 - 2.0**-53),
    ],
)
def test_a_line_no_longer_than_its_chord_is_infeasible(span: float, rise: float, length: float) -> None:
    line = {"span": span, "rise": rise, "line_length": length, "weight_per_length": 1.0}
    found = solve(SOLVER.name, line, outputs=SOLVER.outputs)
    assert found.status == Status.infeasible
    for name, values in found.outputs.items():
        assert np.isnan(values).all(), name


def test_a_length_ratio_of_one_is_infeasible() -> None:
    found = solve(SOLVER.name, {"span": [0.1, 3.0], "length_ratio": [1.0, 0.5], "weight_per_length": 1.0})
    assert (found.status == Status.infeasible).all()


def test_only_infeasible_lines_are_nan() -> None:
    line = draw(SOLVER.name, 5000, seed=1)
    found = solve(SOLVER.name, line, {"nodes": 5}, SOLVER.outputs)
    feasible = line["line_length"] > np.hypot(line["span"], line["rise"])
    assert 1000 < feasible.sum() < 4000
    np.testing.assert_array_equal(found.status, np.where(feasible, Status.ok, Status.infeasible))
    for name, values in found.outputs.items():
        number = np.isfinite(values.reshape(5000, -1))
        np.testing.assert_array_equal(number, np.broadcast_to(feasible[:, None], number.shape), err_msg=name)


# ---- limits ----


@pytest.mark.parametrize(("span", "rise", "chord"), [(3.0, 4.0, 5.0), (3.0, -4.0, 5.0), (2.5, 0.0, 2.5)])
def test_a_line_one_unit_in_the_last_place_longer_than_its_chord_is_a_flat_parabola(
    span: float, rise: float, chord: float
) -> None:
    length = np.nextafter(chord, np.inf)
    found = solve(SOLVER.name, {"span": span, "rise": rise, "line_length": length, "weight_per_length": 2.0})
    assert found.status == Status.ok
    sag = np.sqrt(3.0 / 8.0 * (length - chord) * chord**3 / span**2)  # the next term is smaller by the strain, 1e-16
    tension = 2.0 * chord * span / (8.0 * sag)
    assert relative_error(found.outputs["sag"], sag) <= ROUNDING
    assert relative_error(found.outputs["horizontal_tension"], tension) <= ROUNDING


def test_the_smallest_length_ratio_above_one_is_a_flat_parabola_over_any_span() -> None:
    span = np.random.default_rng(1).uniform(1.0, 1000.0, 1000)
    ratio = np.nextafter(1.0, 2.0)
    found = solve(SOLVER.name, {"span": span, "length_ratio": ratio, "weight_per_length": 1.0})
    np.testing.assert_allclose(found.outputs["sag"], span * np.sqrt(3.0 / 8.0 * (ratio - 1.0)), rtol=ROUNDING)


def test_the_tensions_of_a_line_of_a_billion_spans_still_balance_its_weight() -> None:
    """T_A + T_B = w L coth(l / 2a) and T_B - T_A = w h, at any length: here up to 1e15 spans."""
    rng = np.random.default_rng(2)
    span, ratio = 10.0 ** rng.uniform(-3, 6, 5000), 10.0 ** rng.uniform(0, 15, 5000)
    length = span * ratio
    rise = rng.uniform(-0.99, 0.99, 5000) * np.sqrt(length**2 - span**2)
    found = solve(SOLVER.name, {"span": span, "rise": rise, "line_length": length, "weight_per_length": 1.0})
    assert (found.status == Status.ok).all()
    out = found.outputs
    sum_of_tensions = length / np.tanh(span / (2.0 * out["catenary_parameter"]))
    assert relative_error(out["tension_A"] + out["tension_B"], sum_of_tensions).max() <= PROMISED
    assert relative_error(out["tension_B"] - out["tension_A"], rise, out["max_tension"]).max() <= PROMISED


@pytest.mark.parametrize("ratio", [1e15, 1e30, 1e59])
def test_a_line_longer_than_anyone_asks_for_is_finite_or_out_of_domain(ratio: float) -> None:
    found = solve(SOLVER.name, {"span": 1.0, "rise": 0.1, "line_length": ratio, "weight_per_length": 1.0})
    numbers = np.array([values[0] for values in found.outputs.values()])
    assert found.status in (Status.ok, Status.out_of_domain)
    assert np.isfinite(numbers).all() if found.status == Status.ok else np.isnan(numbers).all()


# ---- published values ----


def test_the_sags_of_the_published_experiment_are_met_to_their_last_digit() -> None:
    """Table 1 of the paper: three decimals of a metre, and one decimal of the error of the rounded sag in per cent."""
    table = read_table(PUBLISHED / "catenary_sag_experiment.csv")
    line = {"span": 2.5, "length_ratio": table["length_ratio"], "weight_per_length": 1.0}
    sag = solve(SOLVER.name, line, outputs=("sag",)).outputs["sag"]
    error_percent = 100.0 * (1.0 - np.round(sag, 3) / table["sag_measured_m"])
    assert np.abs(sag - table["sag_computed_m"]).max() <= 0.5e-3
    assert np.abs(error_percent - table["error_percent"]).max() <= 0.05
