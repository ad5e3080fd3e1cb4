"""The handbook's interpolation: its printed answers, its limit, and what it does not know."""

import numpy as np
import pytest

from cablesim.batch import solve
from cablesim.hunt._stream_check import norm
from cablesim.solver import load_solver
from cablesim.status import Status
from tests.helpers import draw, rows
from tests.solvers.test_pode_line import EXAMPLE

LINE = EXAMPLE | {"position_B": [0.0, 0.0, 30.48]}


def drooping_lines(size: int, seed: int) -> dict[str, np.ndarray]:
    """Lines of 1.3 to 3 times their chord, as the example is: longer ones leave the table at A."""
    line = draw("pode_table_line", size, seed)
    return line | {"line_length": norm(line["position_B"]) * np.random.default_rng(seed).uniform(1.3, 3.0, size)}


def test_example_4_gives_the_printed_angles() -> None:
    """31.09 and 208.43 deg: the second one was read off a table of three to five digits."""
    found = solve("pode_table_line", LINE).outputs
    assert np.degrees(found["angle_B"][0]) == pytest.approx(31.09, abs=0.005)
    assert np.degrees(found["angle_A"][0]) == pytest.approx(208.43, abs=0.01)


def test_example_4_gives_the_printed_points() -> None:
    """Lowest (-21.563, -8.034) m, farthest (-33.964, 0.84) m, from rounded angles: to a centimetre."""
    found = solve("pode_table_line", LINE).outputs
    np.testing.assert_allclose(found["lowest_point"][0], [21.563, 0.0, -8.034], atol=0.01)
    np.testing.assert_allclose(found["farthest_point"][0], [33.964, 0.0, 0.84], atol=0.011)


def test_a_finer_table_tends_to_the_exact_line_with_order_two() -> None:
    """Where the angles fall between two rows varies with the step: the order shows over many lines and a long way."""
    line = drooping_lines(100, seed=1)
    exact = solve("pode_line", line)
    errors = {}
    solved = exact.status == Status.ok
    for step in (0.5, 0.05):
        found = solve("pode_table_line", line, {"table_step": step})
        solved &= found.status == Status.ok
        errors[step] = norm(found.outputs["force_B"] - exact.outputs["force_B"]) / exact.outputs["tension_B"]
    assert solved.sum() > 30
    order = np.log10(np.median(errors[0.5][solved]) / np.median(errors[0.05][solved]))
    assert order == pytest.approx(2.0, abs=0.3)


def test_the_closing_error_tells_how_far_the_interpolation_is_off() -> None:
    line = drooping_lines(200, seed=2)
    found, exact = solve("pode_table_line", line), solve("pode_line", line)
    ok = (found.status == Status.ok) & (exact.status == Status.ok)
    assert ok.sum() > 50
    closing = found.outputs["closing_error"][ok] / line["line_length"][ok]
    error = norm(found.outputs["farthest_point"] - exact.outputs["farthest_point"])[ok] / line["line_length"][ok]
    assert np.corrcoef(np.log(closing), np.log(error))[0, 1] > 0.5


def test_a_floor_of_the_table_that_is_too_coarse_is_reported() -> None:
    line = draw("pode_table_line", 200, seed=3)
    found = solve("pode_table_line", line, {"table_step": 10.0})
    assert set(found.status) <= {Status.ok, Status.not_converged}
    assert (found.status == Status.not_converged).any()


REFUSED = {
    "a chord that leans": {"position_B": [1.0, 0.0, 30.48]},
    "a chord across the stream": {"position_B": [0.0, 1.0, 30.48]},
    "B below A": {"position_B": [0.0, 0.0, -30.48]},
    "a lay angle": {"lay_angle": 0.1},
    "still water": {"stream_speed": 0.0},
    "a floating line": {"weight_per_length": -0.3},
    "a neutral line": {"weight_per_length": 0.0},
}


@pytest.mark.parametrize("given", REFUSED.values(), ids=REFUSED)
def test_a_line_is_out_of_domain_that_has(given: dict[str, object]) -> None:
    found = solve("pode_table_line", LINE | given, outputs=load_solver("pode_table_line").outputs)
    assert found.status == Status.out_of_domain
    for name, values in found.outputs.items():
        assert np.isnan(values).all(), name


@pytest.mark.parametrize("length", [30.48, 30.0])
def test_a_line_no_longer_than_its_chord_is_infeasible(length: float) -> None:
    assert solve("pode_table_line", LINE | {"line_length": length}).status == Status.infeasible


def test_the_stream_may_have_any_heading() -> None:
    one = solve("pode_table_line", LINE).outputs
    other = solve("pode_table_line", LINE | {"heading": 1.1}).outputs
    turned = one["farthest_point"][0, 0] * np.array([np.cos(1.1), np.sin(1.1)])
    np.testing.assert_allclose(other["farthest_point"][0, :2], turned, rtol=1e-12)
    assert other["tension_B"][0] == pytest.approx(one["tension_B"][0], rel=1e-14)


def test_lines_do_not_share_their_tables() -> None:
    line = draw("pode_table_line", 50, seed=4)
    together = solve("pode_table_line", line)
    for i in (0, 7, 49):
        alone = solve("pode_table_line", rows(line, slice(i, i + 1)))
        np.testing.assert_array_equal(alone.outputs["force_A"][0], together.outputs["force_A"][i])
