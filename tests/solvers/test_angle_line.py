"""The angle form: right wherever it says so, and honest about where it breaks down."""

from functools import cache

import numpy as np
import pytest

from cablesim.batch import Results, solve
from cablesim.hunt._stream_check import LOADED_ROPE, norm, random_problems
from cablesim.solver import load_solver
from cablesim.status import Status
from tests.helpers import draw, rows

RTOL = 1e-6
LINE = LOADED_ROPE | {"line_length": 50.0}


@cache
def lines(problem: int) -> tuple[dict[str, np.ndarray], Results, Results]:
    """Two thousand random lines with what the angle form and the integrated line say of them."""
    line = random_problems(2000, seed=1) if problem == 2 else draw("angle_line", 2000, seed=1, problem=problem)
    return line, solve("angle_line", line), solve("stream_line", line)


@pytest.mark.parametrize("problem", [0, 1], ids=["over a length", "to a depth"])
def test_every_line_that_is_called_solved_agrees_with_the_integrated_line(problem: int) -> None:
    _, found, expected = lines(problem)
    ok = found.status == Status.ok
    assert ok.sum() > 1000 and (expected.status[ok] == Status.ok).all()
    length, tension = expected.outputs["line_length"], expected.outputs["max_tension"]
    # The change on halving the steps is fifteen times the error that is left, and was allowed to be RTOL.
    assert (norm(found.outputs["position_B"] - expected.outputs["position_B"])[ok] <= RTOL * length[ok]).all()
    assert (norm(found.outputs["force_B"] - expected.outputs["force_B"])[ok] <= RTOL * tension[ok]).all()
    assert (np.abs(found.outputs["line_length"] - length)[ok] <= RTOL * length[ok]).all()


def test_every_line_between_two_points_that_is_called_solved_is_the_integrated_line() -> None:
    """The tension of a taut line is as sure as its slack, of which an error of RTOL of the length takes a part."""
    line, found, expected = lines(2)
    ok = found.status == Status.ok
    assert ok.sum() > 500 and (expected.status[ok] == Status.ok).all()
    slack = 1.0 - norm(line["position_B"]) / line["line_length"]
    for name in ("force_A", "force_B"):
        error = norm(found.outputs[name] - expected.outputs[name]) / expected.outputs["max_tension"]
        assert (error[ok] <= RTOL / slack[ok]).all(), name
    assert (found.outputs["closing_error"][ok] <= 1e-11 * line["line_length"][ok]).all()


@pytest.mark.parametrize("problem", [0, 1, 2], ids=["over a length", "to a depth", "between two ends"])
def test_no_line_that_turns_across_the_stream_is_called_solved(problem: int) -> None:
    """The component of the force along the stream falls all along a line, so its signs at the ends tell."""
    line, found, expected = lines(problem)
    stream = np.column_stack([np.cos(line["heading"]), np.sin(line["heading"]), np.zeros(2000)])
    along = [np.einsum("ij,ij->i", expected.outputs[name], stream) for name in ("force_A", "force_B")]
    turns = (expected.status == Status.ok) & (along[0] * along[1] < 0.0)
    assert turns.sum() > 100
    assert not (found.status[turns] == Status.ok).any()
    stays = (expected.status == Status.ok) & ~turns
    # What fails without turning is slack or passes along another axis.
    assert (found.status[stays] == Status.ok).mean() > 0.9


def test_failed_lines_are_nan_and_say_why() -> None:
    for problem in (0, 1, 2):
        _, found, expected = lines(problem)
        failed = found.status != Status.ok
        for name, values in found.outputs.items():
            assert np.isnan(values[failed]).all() and np.isfinite(values[~failed]).all(), name
        infeasible = expected.status == Status.infeasible
        assert (found.status[infeasible] == Status.infeasible).all()
        assert not (found.status[~infeasible] == Status.infeasible).any()


def test_the_error_falls_with_order_four() -> None:
    line, found, expected = lines(0)
    smooth = (found.status == Status.ok) & (line["friction_law"] != "constant")
    some, exact = rows(line, smooth), expected.outputs["position_B"][smooth]
    coarse, fine = (
        norm(solve("angle_line", some, {"segments": n, "rtol": 1e-2}).outputs["position_B"] - exact) for n in (50, 100)
    )
    coarse, fine = coarse / some["line_length"], fine / some["line_length"]
    measured = (coarse > 1e-8) & (coarse < 1e-4)
    assert measured.sum() > 40
    # Lines turn by up to a right angle, so at 50 steps the next term still tells on single ones.
    assert np.median(np.log2(coarse[measured] / fine[measured])) == pytest.approx(4.0, abs=0.1)


BREAKDOWNS = {
    "a third cosine that changes its sign": {"force_A": [100.0, 0.0, 50.0], "line_length": 200.0},
    "a third cosine that changes its sign in space": {"force_A": [100.0, 40.0, 50.0], "line_length": 200.0},
    "a tangent straight up at its end": {"force_A": [0.0, 0.0, 100.0]},
    "a tangent straight down at its end": {"force_A": [0.0, 0.0, -1000.0]},
    "a tangent across the stream at its end": {"force_A": [0.0, 100.0, 0.0]},
    "a tangent that passes the vertical": {"force_A": [50.0, 0.0, 500.0]},
}


@pytest.mark.parametrize("given", BREAKDOWNS.values(), ids=BREAKDOWNS)
def test_a_line_is_out_of_domain_that_has(given: dict[str, object]) -> None:
    assert solve("stream_line", LINE | given).status == Status.ok
    found = solve("angle_line", LINE | given, outputs=load_solver("angle_line").outputs)
    assert found.status == Status.out_of_domain
    for name, values in found.outputs.items():
        assert np.isnan(values).all(), name


def test_too_few_steps_for_the_accuracy_are_reported() -> None:
    line = LINE | {"force_A": [-30.0, 10.0, -20.0], "line_length": 200.0}
    found = [solve("angle_line", line, {"segments": n, "rtol": 1e-9}).status[0] for n in (40, 20_000)]
    assert found == [Status.not_converged, Status.ok]
