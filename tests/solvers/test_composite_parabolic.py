"""The parabolic vertex of a composite line against the exact one: its order, its closing error, and what it refuses."""

import numpy as np
import pytest

from cablesim.batch import solve
from cablesim.hunt._composite_laws import Lines, length, misfits, vertical, weight
from cablesim.numerics import Array
from cablesim.status import Status
from tests.composite_check import random_lines, solved
from tests.helpers import rows

SOLVER = "composite_parabolic"


def pulled_lines(slope: float, tension_ratio: float) -> Lines:
    """Lines of five sections that rise by this part of their length, under this multiple of their weight."""
    rng = np.random.default_rng(1)
    line = {
        "section_length": 10.0 ** rng.uniform(0.0, 3.0, (200, 5)),
        "section_weight": 10.0 ** rng.uniform(-1.0, 3.0, (200, 5)),
    }
    return line | {"rise": slope * length(line), "horizontal_tension": tension_ratio * weight(line)}


def force_A(line: Lines, found: Lines) -> Array:
    return vertical(line, found, np.zeros((len(line["rise"]), 1)))[:, 0]


@pytest.mark.parametrize("slope", [-0.8, -0.1, 0.0, 0.5])
def test_the_error_of_the_vertex_falls_with_the_square_of_the_tension(slope: float) -> None:
    """Beside the vertical tension itself, and the place of the vertex, which is far away where the line is steep."""
    errors = []
    for ratio in (200.0, 400.0, 800.0):
        line = pulled_lines(slope, ratio)
        exact, found = solved(line), solved(line, solver=SOLVER)
        off = np.abs(force_A(line, found) - force_A(line, exact)) / np.abs(force_A(line, exact))
        away = np.abs(found["vertex_s"] - exact["vertex_s"]) / np.maximum(length(line), np.abs(exact["vertex_s"]))
        errors.append([np.median(off), np.median(away)])
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    np.testing.assert_allclose(orders, 2.0, atol=0.05)  # the next term is smaller by weight over tension
    assert np.max(errors[-1]) < 1e-5


@pytest.mark.parametrize(("slope", "order"), [(-0.8, 2.0), (0.0, 3.0), (0.5, 2.0)])
def test_the_closing_error_falls_with_it(slope: float, order: float) -> None:
    errors = []
    for ratio in (50.0, 100.0, 200.0):
        line = pulled_lines(slope, ratio)
        errors.append(np.median(solved(line, solver=SOLVER)["closing_error"] / length(line)))
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), order, atol=0.05)


def test_a_line_pulled_with_a_million_times_its_weight_is_the_exact_one() -> None:
    line = pulled_lines(0.3, 1e6)
    exact, found = solved(line), solved(line, solver=SOLVER)
    for name in ("tension_A", "tension_B", "max_tension", "horizontal_distance", "joint_tension"):
        np.testing.assert_allclose(found[name], exact[name], rtol=1e-10, err_msg=name)


def test_its_arcs_are_catenaries_that_end_at_the_wrong_height() -> None:
    line = random_lines(2000, seed=2, given="horizontal_tension")
    found = solved(line, solver=SOLVER)
    left = misfits(line, found)
    for kind in ("tension", "rise", "arc"):
        assert left[kind].max() <= 1e-12, kind
    height = found["joint_position"][np.arange(2000), np.isfinite(line["section_length"]).sum(axis=1) - 1, 2]
    np.testing.assert_array_equal(found["closing_error"], np.abs(height - line["rise"]))
    slack = line["horizontal_tension"] < weight(line)
    assert (left["end"][slack] > 1e-4).mean() > 0.9


def test_level_lines_of_one_section_have_their_vertex_in_the_middle() -> None:
    """By symmetry, whatever the approximation: so they are exact."""
    rng = np.random.default_rng(3)
    line = {"section_length": 10.0 ** rng.uniform(0.0, 3.0, (500, 1)), "section_weight": np.full((500, 1), 8.0)}
    line |= {"rise": np.zeros(500), "horizontal_tension": weight(line) * 10.0 ** rng.uniform(-3.0, 3.0, 500)}
    found, exact = solved(line, solver=SOLVER), solved(line)
    np.testing.assert_allclose(found["vertex_s"], 0.5 * length(line), rtol=1e-15)
    for name in ("tension_A", "tension_B", "horizontal_distance"):
        np.testing.assert_allclose(found[name], exact[name], rtol=1e-12, err_msg=name)


def test_a_line_no_longer_than_its_rise_is_infeasible() -> None:
    line = {"section_length": [2.0, 3.0], "section_weight": [1.0, 2.0], "horizontal_tension": 1.0}
    rise = np.array([5.0, -5.0, 6.0, np.nextafter(5.0, 0.0), 0.0])
    found = solve(SOLVER, line | {"rise": rise})
    np.testing.assert_array_equal(found.status, np.where(np.abs(rise) >= 5.0, Status.infeasible, Status.ok))
    for name, values in found.outputs.items():
        finite = np.isfinite(values.reshape(5, -1)).all(axis=1)
        np.testing.assert_array_equal(finite, found.status == Status.ok, err_msg=name)


def test_a_line_among_longer_lists_is_solved_as_if_alone() -> None:
    """Bit by bit, also where lists are so long that NumPy would sum them in eight parts."""
    line = random_lines(200, seed=9, given="horizontal_tension")
    together = solved(line, solver=SOLVER)
    for i, sections in enumerate(np.isfinite(line["section_length"]).sum(axis=1)):
        alone = rows(line, slice(i, i + 1))
        alone |= {name: alone[name][:, :sections] for name in ("section_length", "section_weight")}
        for name, values in solved(alone, solver=SOLVER).items():
            own = together[name][i, :sections] if name.startswith("joint") else together[name][i]
            np.testing.assert_array_equal(values[0], own, err_msg=name)


def test_a_line_is_as_long_as_its_sections_are_and_not_as_their_rounded_sum() -> None:
    """Three short sections each add a rounding of 1 to it where together they add less than two; four add none."""
    u = 2.0**-52
    line = {"section_length": [[1.0, 0.6 * u, 0.6 * u, 0.6 * u, np.nan], [1.0, 0.4 * u, 0.4 * u, 0.4 * u, 0.4 * u]]}
    line |= {"section_weight": np.where(np.isnan(line["section_length"]), np.nan, 1.0), "horizontal_tension": 1.0}
    for rise, expected in ((1.0 + 2.0 * u, [Status.infeasible] * 2), (1.0 + u, [Status.ok] * 2)):
        np.testing.assert_array_equal(solve(SOLVER, line | {"rise": rise}).status, expected)
        np.testing.assert_array_equal(solve(SOLVER, line | {"rise": -rise}).status, expected)
