"""The hunt among hanging lines: nothing is found, and every judge catches an answer that is wrong."""

import numpy as np
import pytest

from cablesim.hunt import hanging
from cablesim.hunt._case import Case
from cablesim.hunt._precise import ROUNDING
from tests.hunting import assert_nothing_wrong, misses

# Ten times what is allowed of lines whose slack and angle are of the order of one.
WRONG = 1.0 + 2000.0 * ROUNDING


def some_lines(solver: str) -> Case:
    line = {"span": np.array([1.0, 30.0, 7.0]), "weight_per_length": np.array([2.0, 1.0, 9.0])}
    line |= {"line_length": line["span"] * [1.03, 1.3, 3.0]}
    if solver in hanging.CURVES:
        line |= {"rise": line["span"] * [0.0, 0.3, -2.0]}
    if solver == "catenary_elastic":
        line |= {"axial_stiffness": 100.0 * line["weight_per_length"] * line["line_length"]}
    return Case(solver, line, {})


@pytest.mark.parametrize("solver", hanging.SOLVERS)
def test_a_small_hunt_finds_nothing(solver: str) -> None:
    """Of limits many do not exist: the handbook keeps no error below 0.41."""
    assert_nothing_wrong(solver, 400, least_ok=0.6 if solver == "catenary_limit_ratio" else 0.95)


@pytest.mark.parametrize("solver", hanging.CURVES)
@pytest.mark.parametrize(
    ("judge", "output", "factor"),
    [
        ("balance", "tension_B", WRONG),
        ("balance", "horizontal_tension", WRONG),
        ("mirror", "sag", WRONG),
        ("part", "horizontal_tension", 1.0 + 1e-10),
        ("longer", "horizontal_tension", 0.99),
        *(("reference", name, WRONG) for name in ("sag", "drop", "vertex_x", "tension_A", "stretched_length")),
    ],
)
def test_a_wrong_curve_is_caught(solver: str, judge: str, output: str, factor: float) -> None:
    assert (misses(some_lines(solver), judge) <= 1.0).all()
    assert np.nanmax(misses(some_lines(solver), judge, output, factor)) > 1.0


@pytest.mark.parametrize("solver", hanging.FORMULAS)
@pytest.mark.parametrize(("judge", "output"), [("balance", "max_tension"), ("reference", "sag"), ("reference", "drop")])
def test_a_wrong_formula_is_caught(solver: str, judge: str, output: str) -> None:
    assert (misses(some_lines(solver), judge) <= 1.0).all()
    assert (misses(some_lines(solver), judge, output, WRONG) > 1.0).all()


@pytest.mark.parametrize("solver", ["catenary_parabolic", "catenary_series"])
def test_a_formula_of_another_order_is_caught(solver: str) -> None:
    """A tension that is ten times the slack of 0.03 too large."""
    assert misses(some_lines(solver), "order", "max_tension", 1.3)[0] > 1.0


@pytest.mark.parametrize("formula", ["parabolic", "series", "handbook"])
def test_a_wrong_limit_is_caught(formula: str) -> None:
    case = Case("catenary_limit_ratio", {"permitted_error": np.array([0.45, 0.6])}, {"formula": formula})
    for judge in ("permitted", "below"):
        assert (misses(case, judge) <= 1.0).all()
    for output in ("sag_limit_ratio", "tension_limit_ratio"):
        assert (misses(case, "permitted", output, WRONG) > 1.0).all()
        assert (misses(case, "below", output, 1.1) > 1.0).all()
