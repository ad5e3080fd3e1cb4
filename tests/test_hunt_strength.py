"""The hunt among lines of equal strength: nothing is found, and every judge catches an answer that is wrong."""

import numpy as np
import pytest

from cablesim.hunt import strength
from cablesim.hunt._case import Case
from cablesim.hunt._loaded import PROMISED
from cablesim.hunt._precise import ROUNDING
from tests.hunting import SpoiledCase, assert_nothing_wrong, misses

# Ten times what is allowed of lines of rises of the order of k, and of those of which 1e-12 is promised.
WRONG, WRONG_LOADED = 1.0 + 2000.0 * ROUNDING, 1.0 + 10.0 * PROMISED


def some_lines(solver: str) -> Case:
    k = np.array([1000.0, 3000.0, 200.0])
    line = {"strength_length": k, "span": k * [1.0, 0.3, 0.6], "rise": k * [0.0, 0.3, -0.4]}
    if solver in strength.LOADED:
        line |= {"force_ratio": np.array([0.3, 1.0, 4.0]), "arc_fraction": np.array([0.2, 0.5, 1.0])}
    return Case(solver, line, {"sections": 7} if solver == "stepped_strength" else {})


@pytest.mark.parametrize("solver", strength.SOLVERS)
def test_a_small_hunt_finds_nothing(solver: str) -> None:
    assert_nothing_wrong(solver, 300, least_ok=0.6)


@pytest.mark.parametrize(
    ("judge", "output"),
    [
        ("balance", "area_ratio_B"),
        ("balance", "weight_over_force"),
        ("mirror", "drop"),
        ("part", "area_ratio_A"),
        *(("reference", name) for name in ("drop", "line_length", "vertex_x", "saved_weight_fraction")),
    ],
)
def test_a_wrong_line_of_equal_strength_is_caught(judge: str, output: str) -> None:
    assert (misses(some_lines("equal_strength"), judge) <= 1.0).all()
    assert (misses(some_lines("equal_strength"), judge, output, 1.0 + 10.0 * (WRONG - 1.0)) > 1.0).any()


@pytest.mark.parametrize(
    ("judge", "output"),
    [
        ("strength", "drop"),
        ("mirror", "line_length"),
        ("catenary", "line_length"),
        *(("reference", name) for name in ("area_ratio_A", "drop", "vertex_x", "weight_over_force")),
    ],
)
def test_a_wrong_uniform_line_is_caught(judge: str, output: str) -> None:
    assert (misses(some_lines("uniform_strength"), judge) <= 1.0).all()
    assert (misses(some_lines("uniform_strength"), judge, output, 1.0 + 10.0 * (WRONG - 1.0)) > 1.0).any()


@pytest.mark.parametrize("solver", strength.LOADED)
@pytest.mark.parametrize(
    ("judge", "output", "factor"),
    [
        ("mirror", "horizontal_distance", WRONG_LOADED),
        ("ends", "horizontal_distance", WRONG_LOADED),
        ("largest", "max_stress_ratio", 1.0 - 1e-3),
        ("largest", "max_stress_ratio", 1.0 + 1e-3),
        ("force", "horizontal_distance", 1.01),
        *(("reference", f"stress_ratio{end}", WRONG_LOADED) for end in ("", "_A", "_B")),
        ("reference", "horizontal_distance", WRONG_LOADED),
    ],
)
def test_a_wrong_loaded_line_is_caught(solver: str, judge: str, output: str, factor: float) -> None:
    assert (misses(some_lines(solver), judge) <= 1.0).all()
    assert (misses(some_lines(solver), judge, output, factor) > 1.0).any()


def test_a_line_that_is_not_as_designed_under_the_force_of_the_design_is_caught() -> None:
    right = some_lines("equal_strength_loaded")
    wrong = SpoiledCase(right.solver, right.parameters, right.options, "max_stress_ratio", WRONG_LOADED)
    assert (misses(right, "design") <= 1.0).all()
    assert (misses(wrong, "design") > 1.0).all()
