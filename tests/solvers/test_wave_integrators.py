"""Integrators of lines in waves: agreement, and orders, longest steps and options of those beside the first."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from cablesim.batch import solve
from cablesim.errors import InputError
from cablesim.numerics import Array
from cablesim.solver import load_solver
from cablesim.status import Status
from tests.wave_check import CASE, SNAPPING

SOLVER = "wave_line"
PLACES = ("anchor", "middle", "top")
TENSIONS = tuple(f"{kind}_{place}_tension" for place in PLACES for kind in ("max", "min", "mean"))
# Multistep formulas of a higher order are unstable where vibrations are not damped.
OTHERS = {"leapfrog": {}, "rk4": {}, "gear": {"max_order": 2}, "adams": {"max_order": 2}}
EACH_OTHER = pytest.mark.parametrize("method", OTHERS)
EACH_EXPLICIT = pytest.mark.parametrize("method", ["leapfrog", "rk4"])
EACH_MULTISTEP = pytest.mark.parametrize("method", ["gear", "adams"])
# Never slack, in waves and a stream or in still water; laws that stiffen and soften.
TAUT = CASE | {
    "length_ratio": [0.97, 0.98, 0.99, 0.99, 0.975, 0.985],
    "linear_stiffness": [1e6, 2e6, 4e6, 3e6, 1.5e6, 2e6],
    "stiffness_ratio": [0.0, 0.0, 2.0, -2.0, 5.0, 0.0],
    "wave_period": [5.4, 8.0, 11.0, 6.5, 9.0, 4.3],
    "top_amplitude": [0.5, 1.0, 0.7, 0.4, 0.6, 0.3],
    "wave_height": [0.0, 1.0, 2.0, 0.0, 1.0, 0.5],
    "heading": [0.0, 0.5, -1.0, 2.0, 0.3, -2.5],
    "stream_speed": [0.0, 0.3, 0.0, 0.5, 0.2, 0.0],
    "internal_damping": [0.0, 0.0, 1e4, 0.0, 0.0, 1e4],
    "duration": 30.0,
}
# Soft and short of elements, so that single precision does not hide the errors of long steps.
SOFT = CASE | {
    "length_ratio": 0.9,
    "linear_stiffness": 3e5,
    "wave_period": 5.4,
    "duration": 21.6,
    "ramp": 21.6,
    "top_amplitude": 10.0,
}


def history(method: str, time_step: float) -> Array:
    found = solve(
        SOLVER, SOFT, {"segments": 4, "integrator": method, "time_step": time_step, "samples": 97}, ("history",)
    )
    assert (found.status == Status.ok).all()
    return found.outputs["history"][0].astype(float)


def statuses(line: dict[str, Any], **options: Any) -> Array:
    """How lines end; those that fail have no numbers, and no others are not finite."""
    found = solve(SOLVER, line, options, TENSIONS)
    for values in found.outputs.values():
        assert np.array_equal(np.isfinite(values), found.status == Status.ok)
    return found.status


@EACH_OTHER
@pytest.mark.parametrize("mass", ["consistent", "lumped"])
def test_integrators_agree_to_ten_times_the_tolerance(method, mass):
    given = {"segments": 10, "mass": mass, "rtol": 1e-4}
    first, other = (
        solve(SOLVER, TAUT, given | options, TENSIONS).outputs
        for options in ({}, {"integrator": method} | OTHERS[method])
    )
    for name in TENSIONS:
        # Measured 6e-5 at most.
        assert (np.abs(other[name] - first[name]) < 1e-3 * first["max_top_tension"]).all(), name


@pytest.mark.parametrize(("method", "order", "count"), [("leapfrog", 2.0, 240), ("rk4", 4.0, 120)])
def test_explicit_methods_have_their_orders(method, order, count):
    runs = [history(method, 5.4 / count / parts) for parts in (1, 2, 4)]
    coarse, fine = (np.sqrt(((after - before) ** 2).mean()) for before, after in pairwise(runs))
    # The next order at these steps.
    assert np.log2(coarse / fine) == pytest.approx(order, abs=0.3)


@EACH_EXPLICIT
@pytest.mark.parametrize("mass", ["consistent", "lumped"])
def test_a_fixed_step_is_taken_up_to_the_stable_one_and_not_beyond(method, mass):
    piece = 0.9971136116 * 200.0 * np.sqrt(2.0) / 20
    highest = 2.0 / piece * np.sqrt(1e7 / 3.0) * (np.sqrt(3.0) if mass == "consistent" else 1.0)
    limit = (2.0 if method == "leapfrog" else 2.6) / highest
    options = {"segments": 20, "integrator": method, "mass": mass}
    line = CASE | {"duration": 20.0, "top_amplitude": 0.5}
    assert statuses(line, **options, time_step=0.95 * limit) == [Status.ok]
    for share in (1.05, 2.0, 30.0):
        assert statuses(line, **options, time_step=share * limit) == [Status.not_converged]


def test_leapfrog_takes_steps_below_the_limit_of_vibrations_where_a_line_is_slack():
    piece = 1.000466477 * 200.0 * np.sqrt(2.0) / 20
    limit = piece / np.sqrt(1e8 / 3.0)
    options = {"segments": 20, "integrator": "leapfrog", "mass": "lumped"}
    line = SNAPPING | {"duration": 20.0}
    assert statuses(line, **options, time_step=0.35 * limit) == [Status.ok]
    assert statuses(line, **options, time_step=0.6 * limit) == [Status.not_converged]
    by_itself = solve(SOLVER, line, options, ("energy_error",))
    assert by_itself.status == [Status.ok]
    # With 0.8 of the limit the error is 1.
    assert by_itself.outputs["energy_error"] < 1e-3


@EACH_OTHER
def test_the_first_steps_are_no_extremes(method):
    # All is recorded from the start; nothing moves before the ramp has begun.
    line, options = CASE | {"duration": 2.0, "ramp": 20.0}, {"segments": 6, "integrator": method, "mass": "lumped"}
    found = solve(SOLVER, line | {"motion_phase": [0.0, 3.0]}, options, (*TENSIONS, "static_top_tension")).outputs
    for place in PLACES:
        assert (found[f"max_{place}_tension"] < 1.5 * found["static_top_tension"]).all()
        assert (found[f"min_{place}_tension"] > 0.5 * found["static_top_tension"]).all()


@pytest.mark.parametrize("method", ["leapfrog", "gear", "adams"])
def test_snapshots_and_histories_are_those_of_the_most_accurate_integrator(method):
    options, names = {"segments": 10, "mass": "lumped", "rtol": 1e-4, "phases": 7}, ("snapshots", "history")
    best, other = (
        solve(SOLVER, TAUT, options | {"integrator": name} | OTHERS[name], names).outputs for name in ("rk4", method)
    )
    # Of the top's amplitude of up to 1 m: the implicit methods are 2 mm off. Of the largest tension: ten tolerances.
    assert np.abs(other["snapshots"] - best["snapshots"]).max() < 3e-3
    assert np.abs(other["history"] - best["history"]).max() < 1e-3 * best["history"].max()


@EACH_MULTISTEP
def test_multistep_lines_do_not_depend_on_their_neighbours(method):
    lines = {name: np.array(value)[:3] if np.ndim(value) else value for name, value in TAUT.items()} | {"duration": 5.0}
    options = {"segments": 6, "integrator": method, "mass": "lumped"} | OTHERS[method]
    together = solve(SOLVER, lines, options, TENSIONS).outputs
    alone = solve(
        SOLVER, {name: value[1] if np.ndim(value) else value for name, value in lines.items()}, options, TENSIONS
    )
    for name in TENSIONS:
        assert alone.outputs[name][0] == together[name][1]


@EACH_OTHER
def test_work_is_bounded(method):
    line, options = CASE | {"duration": 5.0}, {"segments": 6, "integrator": method, "mass": "lumped"}
    assert statuses(line, **options, most_steps=20) == [Status.not_converged]
    enough = solve(SOLVER, line, options, ("steps", "rhs_evaluations"))
    assert enough.status == [Status.ok]
    assert enough.outputs["rhs_evaluations"] >= enough.outputs["steps"] > 20


def test_gear_of_high_order_collapses_on_stiff_vibrations_that_are_not_damped():
    line = CASE | {"duration": 20.0, "top_amplitude": 0.3}
    # With order 2 there are some 400.
    few = {"integrator": "gear", "mass": "lumped", "segments": 50, "most_steps": 2000}
    assert statuses(line, **few) == [Status.not_converged]
    assert statuses(line, **few, max_order=2) == [Status.ok]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"integrator": "euler"}, "euler"),
        ({"integrator": "gear", "max_order": 6}, "max_order is at most 5"),
        ({"integrator": "rk4", "max_order": 2}, "max_order is an option of gear and adams only"),
        ({"integrator": "adams", "time_step": 0.1}, "takes no time_step"),
    ],
)
def test_options_that_an_integrator_does_not_have_are_errors(options, words):
    with pytest.raises(InputError, match=words):
        load_solver(SOLVER).make_options(options)
