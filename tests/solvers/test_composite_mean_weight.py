"""One catenary of the mean weight: exact for equal weights, the exact line of that weight, and wrong as it says."""

import numpy as np
import pytest

from cablesim.batch import solve
from cablesim.hunt._composite_laws import Lines, length, weight
from cablesim.status import Status
from tests.composite_check import GIVEN, random_lines, solved
from tests.helpers import rows

SOLVER = "composite_mean_weight"
ENDS = ("horizontal_tension", "horizontal_distance", "tension_A", "tension_B", "max_tension")

given_either = pytest.mark.parametrize("given", GIVEN)


def of_mean_weight(line: Lines) -> Lines:
    """The same lines with the mean weight per length in every section."""
    mean = (weight(line) / length(line))[:, None]
    return line | {"section_weight": np.where(np.isnan(line["section_weight"]), np.nan, mean)}


@given_either
def test_it_is_exact_for_sections_of_one_weight(given: str) -> None:
    """The mean of equal numbers is rounded, and tensions with it."""
    line = of_mean_weight(random_lines(2000, seed=1, given=given))
    exact, found = solved(line), solved(line, solver=SOLVER)
    for name in ENDS:
        np.testing.assert_allclose(found[name], exact[name], rtol=1e-13, err_msg=name)
    for name in ("joint_position", "lowest_point"):
        np.testing.assert_allclose(found[name], exact[name], rtol=0, atol=1e-11 * length(line).max(), err_msg=name)


@given_either
def test_it_is_the_exact_line_of_the_mean_weight(given: str) -> None:
    line = random_lines(2000, seed=2, given=given)
    exact, found = solved(of_mean_weight(line)), solved(line, solver=SOLVER)
    for name in (*ENDS, "joint_tension"):
        np.testing.assert_allclose(found[name], exact[name], rtol=1e-13, err_msg=name)


@given_either
def test_it_is_one_catenary(given: str) -> None:
    """Of a level line the vertex is in the middle, and the sections do not show."""
    line = random_lines(500, seed=3, given=given) | {"rise": np.zeros(500)}
    line[given] = np.minimum(line[given], length(line)) if given == "horizontal_distance" else line[given]
    whole = line | {"section_length": length(line)[:, None], "section_weight": (weight(line) / length(line))[:, None]}
    exact, found = solved(whole), solved(line, solver=SOLVER)
    for name in ENDS:
        # Sums of the lengths are rounded differently, and the tightest line has a slack of 1e-9.
        np.testing.assert_allclose(found[name], exact[name], rtol=1e-6, err_msg=name)
    np.testing.assert_allclose(found["tension_A"], found["tension_B"], rtol=1e-12)


def test_with_a_chain_at_one_end_its_vertex_is_too_far_from_the_chain_and_its_sag_too_great() -> None:
    """A chain of less than half the wire's length, whose weight hangs near its ship."""
    rng = np.random.default_rng(4)
    wire, wire_weight = rng.uniform(100.0, 600.0, 2000), rng.uniform(40.0, 120.0, 2000)
    chain, chain_weight = wire * rng.uniform(0.05, 0.5, 2000), wire_weight * rng.uniform(1.5, 15.0, 2000)
    line = {
        "section_length": np.column_stack([wire, chain]),
        "section_weight": np.column_stack([wire_weight, chain_weight]),
        "rise": np.zeros(2000),
    }
    line["horizontal_tension"] = weight(line) * 10.0 ** rng.uniform(-1.0, 1.5, 2000)
    exact, found = solved(line), solved(line, solver=SOLVER)
    assert (found["vertex_s"] < exact["vertex_s"]).all()
    assert (found["lowest_point"][:, 2] < exact["lowest_point"][:, 2]).all()
    assert (found["horizontal_distance"] < exact["horizontal_distance"]).all()


def test_it_refuses_what_the_exact_method_refuses() -> None:
    line = {"section_length": [2.0, 3.0], "section_weight": [1.0, 2.0], "rise": 4.0}
    distance = [3.0, np.nextafter(3.0, 0.0), 4.0]
    by_distance = solve(SOLVER, line | {"horizontal_distance": distance})
    np.testing.assert_array_equal(by_distance.status, [Status.infeasible, Status.ok, Status.infeasible])
    by_tension = solve(SOLVER, line | {"horizontal_tension": 1.0, "rise": [5.0, -5.0, 4.999]})
    np.testing.assert_array_equal(by_tension.status, [Status.infeasible, Status.infeasible, Status.ok])


@given_either
def test_a_line_among_longer_lists_is_solved_as_if_alone(given: str) -> None:
    """Bit by bit, also where lists are so long that NumPy would sum them in eight parts."""
    line = random_lines(200, seed=9, given=given)
    together = solved(line, solver=SOLVER)
    for i, sections in enumerate(np.isfinite(line["section_length"]).sum(axis=1)):
        alone = rows(line, slice(i, i + 1))
        alone |= {name: alone[name][:, :sections] for name in ("section_length", "section_weight")}
        for name, values in solved(alone, solver=SOLVER).items():
            own = together[name][i, :sections] if name.startswith("joint") else together[name][i]
            np.testing.assert_array_equal(values[0], own, err_msg=name)
