"""Height of waves for safe towing: the handbook's example, distances given and computed, and what is refused."""

import numpy as np
import pytest

from cablesim.batch import solve
from cablesim.numerics import Array
from cablesim.status import Status
from tests.composite_check import IN_WATER, solved
from tests.helpers import PUBLISHED, draw, read_table, rows

SOLVER = "tow_wave_height"
# A line like those of the handbook, in which distances are computed.
TOW = {
    "hook_pull": 118e3,
    "breaking_strength": 2 * 388e3,
    "diameter": 0.05,
    "section_length": [300.0, 75.0],
    "section_weight": [IN_WATER * 76.0, IN_WATER * 687.0],
}


def answers(line: dict[str, object]) -> dict[str, Array]:
    """Outputs of lines that must all be solved."""
    found = solve(SOLVER, line)
    assert (found.status == Status.ok).all()
    return found.outputs


def published() -> dict[str, Array]:
    """The example in the first row and ten tasks, in SI."""
    table = read_table(PUBLISHED / "tow_wave_height.csv")
    return {
        "hook_pull": 1e3 * table["hook_pull_kN"],
        "breaking_strength": 1e3 * table["breaking_strength_kN"],
        "line_length": table["line_length_m"],
        "distance_calm": table["distance_calm_m"],
        "distance_jerk": table["distance_jerk_m"],
        "diameter": 1e-3 * table["diameter_mm"],
    }


def test_the_example_of_the_handbook_is_met_to_its_digits() -> None:
    """2.1 m of elasticity and 4.6 m of weight are 6.7 m."""
    table = rows(read_table(PUBLISHED / "tow_wave_height.csv"), 0)
    found = answers(rows(published(), slice(0, 1)))
    for name, values in found.items():
        if name in ("elastic_elongation", "weight_elongation", "wave_height"):
            assert values[0] == pytest.approx(table[f"{name}_m"], abs=0.05), name
    assert found["elastic_elongation"][0] == pytest.approx(342e3 * 600.0 / (3.6e10 * 0.052**2), rel=1e-15)


def test_the_ten_tasks_have_waves_between_one_and_eleven_metres() -> None:
    """Tasks 131 to 140; their answers are not printed."""
    found = answers(rows(published(), slice(1, None)))
    np.testing.assert_allclose(found["wave_height"], found["elastic_elongation"] + found["weight_elongation"])
    assert found["wave_height"].min() > 1.0 and found["wave_height"].max() < 11.0


def test_the_modulus_of_the_handbook_is_the_default() -> None:
    """36 kN/mm2 of the square of the diameter; twice as stiff a wire stretches half as much."""
    line = published()
    by_default, given, stiff = (
        answers(line | more) for more in ({}, {"wire_modulus": 3.6e10}, {"wire_modulus": 7.2e10})
    )
    for name in by_default:
        np.testing.assert_array_equal(by_default[name], given[name], err_msg=name)
    np.testing.assert_array_equal(stiff["elastic_elongation"], 0.5 * given["elastic_elongation"])
    np.testing.assert_array_equal(stiff["weight_elongation"], given["weight_elongation"])


def test_distances_given_as_they_are_computed_lead_to_the_same() -> None:
    line = draw(SOLVER, 2000, seed=1, problem=1)
    line["breaking_strength"] = np.maximum(line["breaking_strength"], 2.5 * line["hook_pull"])
    computed = answers(line)
    given = {name: values for name, values in line.items() if not name.startswith("section")}
    given |= {name: computed[name] for name in ("distance_calm", "distance_jerk")}
    given["line_length"] = line["section_length"][:, 0]
    for name, values in answers(given).items():
        np.testing.assert_array_equal(values, computed[name], err_msg=name)


def test_the_distances_are_those_of_the_composite_line_between_level_ends() -> None:
    line = draw(SOLVER, 2000, seed=2, problem=1)
    line["breaking_strength"] = np.maximum(line["breaking_strength"], 2.5 * line["hook_pull"])
    found = answers(line)
    lists = {name: line[name] for name in ("section_length", "section_weight")}
    for name, tension in (("distance_calm", line["hook_pull"]), ("distance_jerk", 0.5 * line["breaking_strength"])):
        expected = solved(lists | {"horizontal_tension": tension}, ("horizontal_distance",))["horizontal_distance"]
        np.testing.assert_array_equal(found[name], expected, err_msg=name)


def test_the_play_of_the_handbook_is_computed_from_its_sections() -> None:
    """Example V: 374.72 m less 372.10 m are 2.62 m; 2.612 m here."""
    play = rows(read_table(PUBLISHED / "towline_play.csv"), 0)
    found = answers(TOW)
    assert found["weight_elongation"][0] == pytest.approx(play["play_m"], abs=0.01)
    assert found["elastic_elongation"][0] == pytest.approx(270e3 * 300.0 / (3.6e10 * 0.05**2), rel=1e-15)


def test_only_the_wire_the_first_section_stretches() -> None:
    reversed_lists = {name: TOW[name][::-1] for name in ("section_length", "section_weight")}
    one, other = answers(TOW), answers(TOW | reversed_lists)
    np.testing.assert_allclose(other["elastic_elongation"], one["elastic_elongation"] * 75.0 / 300.0, rtol=1e-15)
    # The same line from its other end.
    np.testing.assert_allclose(other["weight_elongation"], one["weight_elongation"], rtol=1e-12)


def test_waves_may_be_higher_for_a_stronger_line_and_less_so_for_a_greater_pull() -> None:
    stronger = answers(TOW | {"breaking_strength": np.linspace(3e5, 2e6, 100)})
    assert (np.diff(stronger["wave_height"]) > 0.0).all()
    harder = answers(TOW | {"hook_pull": np.linspace(1e4, 3.8e5, 100)})
    assert (np.diff(harder["wave_height"]) < 0.0).all()


@pytest.mark.parametrize(
    "changed",
    [
        {"hook_pull": 440e3},
        {"hook_pull": 500e3},
        {"distance_jerk": 595.1},
        {"breaking_strength": 1.0},
    ],
)
def test_a_line_that_is_pulled_beyond_half_its_strength_or_shrinks_in_the_jerk_is_infeasible(
    changed: dict[str, float],
) -> None:
    line = rows(published(), slice(0, 1)) | {name: np.array([value]) for name, value in changed.items()}
    found = solve(SOLVER, line)
    assert found.status == Status.infeasible
    for name, values in found.outputs.items():
        assert np.isnan(values).all(), name


def test_a_line_that_gives_nothing_by_its_weight_still_stretches() -> None:
    found = answers(rows(published(), slice(0, 1)) | {"distance_jerk": np.array([595.2])})
    assert found["weight_elongation"] == 0.0
    np.testing.assert_array_equal(found["wave_height"], found["elastic_elongation"])


def test_half_the_strength_must_exceed_the_pull_where_sections_are_given_too() -> None:
    found = solve(SOLVER, TOW | {"hook_pull": [388e3, 400e3, 387e3]})
    np.testing.assert_array_equal(found.status, [Status.infeasible, Status.infeasible, Status.ok])


def test_a_line_that_is_just_a_little_stronger_than_its_pull_is_feasible() -> None:
    pull = np.random.default_rng(3).uniform(2e4, 3e5, 2000)
    strength = 2.0 * pull * (1.0 + 1e-14)
    assert (0.5 * strength > pull).all()
    found = solve(SOLVER, TOW | {"hook_pull": pull, "breaking_strength": strength})
    assert (found.status == Status.ok).all()
