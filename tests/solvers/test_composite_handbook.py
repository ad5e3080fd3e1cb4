"""The handbook's vertex of a tow line of wire and chain: its two printed examples, its table, its limits."""

import numpy as np
import pytest

from cablesim.batch import solve
from cablesim.hunt._composite_laws import Lines, misfits, vertical, weight
from cablesim.status import Status
from tests.composite_check import IN_WATER, SHAPE, solved
from tests.helpers import PUBLISHED, read_table

SOLVER = "composite_handbook"
# Cells of the printed table that are cut off where they should be rounded.
MISPRINTED_RATIOS = (0.50, 1.25, 1.30)


def tow_lines(tension_ratio: float | np.ndarray, size: int = 500, seed: int = 1) -> Lines:
    """Level lines of wire and of a shorter and heavier chain, under a multiple of the weight of the chain."""
    rng = np.random.default_rng(seed)
    wire, wire_weight = rng.uniform(200.0, 600.0, size), rng.uniform(60.0, 100.0, size)
    line = {
        "section_length": np.column_stack([wire, rng.uniform(20.0, 100.0, size)]),
        "section_weight": np.column_stack([wire_weight, rng.uniform(500.0, 800.0, size)]),
    }
    return line | {"horizontal_tension": tension_ratio * chain_weight(line)}


def chain_weight(line: Lines) -> np.ndarray:
    return line["section_length"][:, 1] * line["section_weight"][:, 1]


def example(name: str, weights: tuple[float, float] | None = None) -> tuple[dict[str, float], Lines]:
    """What the handbook prints of an example, and what we find with its weights in water, or with these."""
    table = read_table(PUBLISHED / "towline_examples.csv")
    printed = {key: values[table["example"] == name][0] for key, values in table.items()}
    in_air = [printed[f"{part}_weight_air_N_m"] for part in ("wire", "chain")]
    line = {
        "section_length": [printed["wire_length"], printed["chain_length"]],
        "section_weight": IN_WATER * np.array(in_air) if weights is None else weights,
        "horizontal_tension": 1e3 * printed["horizontal_tension_kN"],
    }
    return printed, solved(line, solver=SOLVER)


def test_the_first_example_is_met_to_its_digits() -> None:
    """Example III: vertex 160.5 m from the joint, sags 45.2 and 44.71 m, 435.84 m between the ships."""
    printed, found = example("III")
    sag = -found["lowest_point"][0, 2]
    other = sag + found["joint_position"][0, -1, 2]
    assert 400.0 - found["vertex_s"] == pytest.approx(printed["vertex_distance"], abs=0.05)
    # The catenary parameters are printed to a metre of 612 and of 82, a sag is as sure as half of that.
    assert sag == pytest.approx(printed["sag_wire_side"], rel=0.5 / 612 + 0.05 / 45)
    assert other == pytest.approx(printed["sag_chain_side"], rel=0.5 / 612 + 0.005 / 45)
    np.testing.assert_allclose(found["closing_error"], abs(sag - other), atol=1e-12)
    # A sum of four numbers to a centimetre.
    assert found["horizontal_distance"] == pytest.approx(printed["distance_AB"], abs=0.02)


def test_the_vertex_of_the_second_example_is_met_but_for_its_alpha() -> None:
    """Example V: 56.46 m, with alpha printed as 0.0734, which would make it 56.53 m.

    Its table, read between 2.6 and 2.7 at the printed 197/75, has 0.0721, and leads to 56.46 m; exp(-197.4/75) is
    0.0719 and leads to 56.445 m, which is what we have.
    """
    printed, found = example("V-118kN")
    assert 300.0 - found["vertex_s"] == pytest.approx(printed["vertex_distance"], abs=0.02)
    assert found["horizontal_distance"] == pytest.approx(printed["distance_AB"], abs=0.01)
    fictive = (300.0 - found["vertex_s"]) * 76.0 / 687.0
    assert fictive == pytest.approx(printed["fictive_chain_length"], abs=0.02)


def test_the_table_of_alpha_is_the_exponential_to_its_digits_but_for_three_cells() -> None:
    """0.50, 1.25 and 1.30 are printed 0.606, 0.286 and 0.272; rounded they are 0.607, 0.287 and 0.273."""
    table = read_table(PUBLISHED / "towline_alpha.csv")
    rounded = np.round(np.exp(-table["ratio"]), 3)
    wrong = rounded != table["alpha"]
    assert len(wrong) == 61
    np.testing.assert_array_equal(table["ratio"][wrong], MISPRINTED_RATIOS)
    np.testing.assert_allclose(rounded[wrong] - table["alpha"][wrong], 0.001, atol=1e-12)


@pytest.mark.parametrize("ratio", [0.05, 0.5, 1.0, 2.6, 3.999])
def test_the_vertex_is_that_of_the_corrected_formula(ratio: float) -> None:
    line = tow_lines(ratio)
    (wire, chain), (light, heavy) = line["section_length"].T, line["section_weight"].T
    corrected = 1.0 - 0.87 * np.exp(-ratio)
    expected = (wire**2 - corrected * heavy / light * chain**2) / (2.0 * (wire + chain))
    found = solved(line, solver=SOLVER)
    inside = expected > 0.0
    assert inside.sum() > 300
    np.testing.assert_allclose((wire - found["vertex_s"])[inside], expected[inside], rtol=0, atol=1e-12 * 700.0)
    # Where it is past the joint, it is drawn where the chain weighs as much.
    np.testing.assert_allclose(
        (wire - found["vertex_s"])[~inside], (expected * light / heavy)[~inside], rtol=0, atol=1e-12 * 700.0
    )


@pytest.mark.parametrize("ratio", [4.0, 10.0, 1000.0])
def test_without_a_correction_it_is_the_parabola(ratio: float) -> None:
    """alpha reads as zero from 4 on, 4 included."""
    line = tow_lines(ratio * (1.0 + 1e-12))
    found, parabola = solved(line, solver=SOLVER), solved(line | {"rise": np.zeros(500)}, solver="composite_parabolic")
    for name, values in found.items():
        if "tension" in name:
            np.testing.assert_allclose(values, parabola[name], rtol=1e-12, err_msg=name)
        else:
            np.testing.assert_allclose(values, parabola[name], rtol=0, atol=1e-12 * 700.0, err_msg=name)


def test_the_arcs_are_catenaries_that_end_at_two_levels() -> None:
    line = tow_lines(10.0 ** np.random.default_rng(2).uniform(-1.0, 1.0, 500))
    found = solved(line, (*solved(line, solver=SOLVER), *SHAPE), solver=SOLVER)
    left = misfits(line | {"rise": np.zeros(500)}, found)
    for kind in ("tension", "rise", "arc"):
        assert left[kind].max() <= 1e-12, kind
    np.testing.assert_allclose(found["closing_error"], np.abs(found["joint_position"][:, -1, 2]), rtol=1e-15)
    np.testing.assert_allclose(found["profile"][:, -1], found["joint_position"][:, -1], rtol=0, atol=1e-10)


def test_its_vertex_nears_the_exact_one_under_a_great_force() -> None:
    """With order two, once alpha is zero."""
    errors = []
    for ratio in (100.0, 200.0, 400.0):
        line = tow_lines(ratio)
        exact, found = solved(line | {"rise": np.zeros(500)}), solved(line, solver=SOLVER)
        place = [vertical(line | {"rise": np.zeros(500)}, each, np.zeros((500, 1)))[:, 0] for each in (exact, found)]
        errors.append(np.median(np.abs(place[1] - place[0]) / weight(line)))
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 2.0, atol=0.05)


def test_only_lines_of_two_sections_are_in_its_domain() -> None:
    lists = {"section_length": [[400.0], [400.0, 50.0], [300.0, 100.0, 50.0]]}
    lists |= {"section_weight": [[80.0], [80.0, 598.0], [80.0, 80.0, 598.0]]}
    found = solve(SOLVER, lists | {"horizontal_tension": 49e3})
    np.testing.assert_array_equal(found.status, [Status.out_of_domain, Status.ok, Status.out_of_domain])
    for name, values in found.outputs.items():
        finite = np.isfinite(values[:, :2] if name == "joint_tension" else values).reshape(3, -1)
        np.testing.assert_array_equal(finite.all(axis=1), [False, True, False], err_msg=name)
        np.testing.assert_array_equal(finite.any(axis=1), [False, True, False], err_msg=name)


@pytest.mark.parametrize("sections", [1, 3])
def test_a_batch_of_nothing_but_other_lines_is_out_of_domain(sections: int) -> None:
    line = {"section_length": [[100.0] * sections] * 2, "section_weight": [[50.0] * sections] * 2}
    assert (solve(SOLVER, line | {"horizontal_tension": 1e4}).status == Status.out_of_domain).all()
