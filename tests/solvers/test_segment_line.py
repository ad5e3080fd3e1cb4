"""The segment method against the integrated line: its two orders, its three problems, and what it cannot solve."""

from functools import cache

import numpy as np
import pytest

from cablesim.batch import Results, solve
from cablesim.hunt._stream_check import LOADED_ROPE, norm, random_problems
from cablesim.numerics import Array
from cablesim.status import Status
from tests.helpers import draw, rows

ORDERS = {"euler": 1.0, "midpoint": 2.0}
LINE = LOADED_ROPE | {"line_length": 10.0}


def problems(problem: int) -> dict[str, np.ndarray]:
    """Lines that are nowhere slack, without the corner of constant friction, which costs an order where it is met."""
    line = draw("segment_line", 400, seed=1, problem=problem)
    line["friction_law"] = np.random.default_rng(2).choice(["cosine_squared", "zero"], 400)
    if problem == 2:  # the declared ends are far within the reach of the declared lines
        line["line_length"] = norm(line["position_B"]) * np.random.default_rng(3).uniform(1.02, 1.2, 400)
    found = solve("stream_line", line, outputs=("profile_tension",))
    tension = found.outputs["profile_tension"]
    return rows(line, (found.status == Status.ok) & (tension.min(axis=1) > 0.1 * tension.max(axis=1)))


@cache
def exact(problem: int) -> tuple[dict[str, np.ndarray], Results]:
    line = problems(problem)
    return line, solve("stream_line", line)


def errors(problem: int, variant: str, segments: int) -> Array:
    """Of end B and the force there, relative to length and largest tension, and of the length where it is wanted."""
    line, expected = exact(problem)
    found = solve("segment_line", line, {"segments": segments, "variant": variant})
    assert (found.status == Status.ok).all()
    length, tension = expected.outputs["line_length"], expected.outputs["max_tension"]
    parts = [
        norm(found.outputs["position_B"] - expected.outputs["position_B"]) / length,
        norm(found.outputs["force_B"] - expected.outputs["force_B"]) / tension,
        norm(found.outputs["force_A"] - expected.outputs["force_A"]) / tension,
        np.abs(found.outputs["line_length"] - length) / length,
    ]
    return np.sqrt(sum(part**2 for part in parts))


@pytest.mark.parametrize("problem", [0, 1, 2], ids=["over a length", "to a depth", "between two ends"])
@pytest.mark.parametrize("variant", ORDERS)
def test_the_error_falls_with_the_order_of_the_method(variant: str, problem: int) -> None:
    coarse, fine = (errors(problem, variant, segments) for segments in (400, 800))
    measured = coarse > 1e-9  # below that the digits of the exact line, or of the ends that are met, stand beside it
    assert measured.sum() > 40
    order = np.log2(coarse[measured] / fine[measured])
    # The next term of the error is smaller by the turn of the line over one segment.
    assert np.median(order) == pytest.approx(ORDERS[variant], abs=0.01)
    np.testing.assert_allclose(np.percentile(order, [10, 90]), ORDERS[variant], atol=0.05)


def test_the_midpoint_is_nearer_than_the_published_variant() -> None:
    for segments in (50, 200):
        assert (errors(0, "midpoint", segments) < errors(0, "euler", segments)).mean() > 0.95


def test_one_segment_is_what_the_formula_says() -> None:
    """M14 by hand: the load at A, and the next segment along the force that is left."""
    force = np.array([30.0, 0.0, 40.0])
    found = solve("segment_line", LINE | {"friction_law": "zero", "force_A": force}, {"segments": 1})
    drag = 0.5 * 1025.0 * 0.02 * 1.2
    normal = np.array([1.0, 0.0, 0.0]) - 0.6 * np.array([0.6, 0.0, 0.8])
    load = drag * norm(normal) * normal - np.array([0.0, 0.0, 5.0])
    end = force - 10.0 * load
    np.testing.assert_allclose(found.outputs["force_B"][0], end, rtol=1e-14)
    np.testing.assert_allclose(found.outputs["position_B"][0], 10.0 * end / norm(end), rtol=1e-14)


@pytest.mark.parametrize("variant", ORDERS)
def test_weight_alone_is_carried_exactly(variant: str) -> None:
    line = draw("segment_line", 300, seed=4) | {"stream_speed": np.zeros(300)}
    found = solve("segment_line", line, {"segments": 7, "variant": variant}).outputs
    expected = line["force_A"] + (line["weight_per_length"] * line["line_length"])[:, None] * [0.0, 0.0, 1.0]
    assert (norm(found["force_B"] - expected) <= 1e-13 * found["max_tension"]).all()


@pytest.mark.parametrize("variant", ORDERS)
def test_the_polygon_is_as_long_as_the_line_and_its_nodes_lie_on_it(variant: str) -> None:
    line = draw("segment_line", 100, seed=5)
    shape = solve("segment_line", line, {"segments": 20, "variant": variant, "nodes": 21}, ("profile", "position_B"))
    pieces = norm(np.diff(shape.outputs["profile"], axis=1))
    np.testing.assert_allclose(pieces, np.repeat(line["line_length"][:, None] / 20, 20, axis=1), rtol=1e-9)
    error = norm(shape.outputs["profile"][:, -1] - shape.outputs["position_B"])
    assert (error <= 1e-13 * line["line_length"]).all()


@pytest.mark.parametrize("variant", ORDERS)
def test_between_given_ends_a_line_is_met_or_said_not_to_be(variant: str) -> None:
    """Slack lines of few segments may have no polygon near the line; more than nine in ten have."""
    line = random_problems(300, seed=6)
    found = solve("segment_line", line, {"segments": 100, "variant": variant})
    ok = found.status == Status.ok
    assert ok.mean() > 0.9
    assert set(found.status[~ok]) <= {Status.not_converged}
    miss = norm(found.outputs["position_B"] - line["position_B"])[ok]
    assert (miss <= 1e-11 * line["line_length"][ok]).all()
    np.testing.assert_allclose(found.outputs["closing_error"][ok], miss, atol=1e-15 * line["line_length"].max())


def test_a_depth_has_the_fate_that_it_has_for_the_integrated_line() -> None:
    line = draw("segment_line", 400, seed=7, problem=1)
    found, expected = solve("segment_line", line), solve("stream_line", line)
    np.testing.assert_array_equal(found.status == Status.infeasible, expected.status == Status.infeasible)
    ok = found.status == Status.ok
    assert ok.sum() > 200 and (expected.status == Status.infeasible).sum() > 5
    np.testing.assert_allclose(found.outputs["position_B"][ok, 2], line["depth"][ok], rtol=1e-11)


@pytest.mark.parametrize("length", [5.0, 4.9])
def test_a_line_no_longer_than_its_chord_is_infeasible(length: float) -> None:
    found = solve("segment_line", LINE | {"line_length": length, "position_B": [3.0, 0.0, 4.0]})
    assert found.status == Status.infeasible


@pytest.mark.parametrize("given", [{"position_B": [3.0, 0.0, 4.0]}, {"force_A": [0.0, 0.0, 0.0]}])
def test_a_line_without_any_load_has_no_shape(given: dict[str, object]) -> None:
    line = LINE | {"stream_speed": 0.0, "weight_per_length": 0.0, **given}
    assert solve("segment_line", line).status == Status.out_of_domain


def test_a_depth_that_is_only_found_behind_the_end_is_not_reached() -> None:
    """Found by the hunt: Newton's method left for a polygon of negative length, and that was answered as solved."""
    line = LOADED_ROPE | {
        "weight_per_length": 56.662676219333235,
        "diameter": 0.015752836963820602,
        "normal_drag_coefficient": 1.2225343721014129,
        "tangential_drag_coefficient": 0.022984930687927306,
        "stream_speed": 2.5201933538241015,
        "force_A": [267.6992047736044, 0.0, -316.90458421129665],
        "depth": 1.8181311119555512,
    }
    found = solve("segment_line", line, {"segments": 1, "variant": "midpoint"})
    assert found.status == Status.not_converged
    assert np.isnan(found.outputs["line_length"]).all()
