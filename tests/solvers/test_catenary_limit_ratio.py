"""The length ratio at which an approximate formula reaches its permitted error."""

import mpmath as mp
import numpy as np
import pytest

from cablesim.batch import Results, default_outputs, solve
from cablesim.solver import load_solver
from cablesim.status import Status

SOLVER = load_solver("catenary_limit_ratio")
# Output of a hanging line behind each limit.
LIMITED = {"sag_limit_ratio": "sag", "tension_limit_ratio": "max_tension"}
PERMITTED = np.array([0.001, 0.01, 0.03, 0.1, 0.2])


def limits(formula: str = "parabolic", permitted: np.ndarray = PERMITTED) -> Results:
    return solve(SOLVER.name, {"permitted_error": permitted}, {"formula": formula})


def textbook_root(output: str, permitted: float) -> mp.mpf:
    """L / l where the parabola is off by `permitted`: a bracketed root in x = l / 2a, all in units of the span."""
    with mp.workdps(30):
        return _ratio(mp.findroot(lambda x: _error(output, x) - mp.mpf(permitted), (0.01, 3), solver="anderson"))


def _ratio(x: mp.mpf) -> mp.mpf:
    return mp.sinh(x) / x


def _error(output: str, x: mp.mpf) -> mp.mpf:
    flat_sag = mp.sqrt(6 * (_ratio(x) - 1)) / 4
    if output == "sag":
        return abs(1 - flat_sag / ((mp.cosh(x) - 1) / (2 * x)))
    return abs(1 - mp.sqrt(1 + 1 / (16 * flat_sag**2)) / 2 / (mp.cosh(x) / (2 * x)))


def test_the_limit_for_three_per_cent_of_tension_is_sharper_than_the_graph_it_was_read_from() -> None:
    """The paper reads 1.07 off its figure 5."""
    found = limits(permitted=np.array([0.03])).outputs["tension_limit_ratio"][0]
    assert found == pytest.approx(1.0743387, abs=0.5e-7)


@pytest.mark.parametrize("permitted", [0.001, 0.03, 0.2])
@pytest.mark.parametrize("limit", LIMITED)
def test_ten_digits_agree_with_an_independent_root(limit: str, permitted: float) -> None:
    found = limits(permitted=np.array([permitted])).outputs[limit][0]
    expected = float(textbook_root(LIMITED[limit], permitted) - 1)
    assert found - 1.0 == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("formula", ["parabolic", "series"])
@pytest.mark.parametrize("limit", LIMITED)
def test_at_the_limit_the_error_is_the_permitted_one(limit: str, formula: str) -> None:
    found = limits(formula)
    assert (found.status == Status.ok).all()
    error = _measured_error(formula, LIMITED[limit], found.outputs[limit])
    np.testing.assert_allclose(error, PERMITTED, rtol=1e-9)  # an error of 0.001 has 13 digits left


@pytest.mark.parametrize("formula", ["parabolic", "series"])
@pytest.mark.parametrize("limit", LIMITED)
def test_below_the_limit_the_error_is_permitted_everywhere(limit: str, formula: str) -> None:
    for permitted, ratio in zip(PERMITTED, limits(formula).outputs[limit], strict=True):
        below = 1.0 + (ratio - 1.0) * np.linspace(0.001, 0.999, 500)
        assert _measured_error(formula, LIMITED[limit], below).max() < permitted


def _measured_error(formula: str, output: str, ratio: np.ndarray) -> np.ndarray:
    line = {"span": 7.0, "weight_per_length": 3.0, "length_ratio": ratio}
    names = (f"catenary_{formula}", "catenary_exact")
    approximate, exact = (solve(name, line).outputs[output] for name in names)
    return np.abs(1.0 - approximate / exact)


def test_more_permitted_error_permits_more_slack() -> None:
    permitted = np.geomspace(1e-3, 0.2, 200)
    for formula in ("parabolic", "series"):
        for name, values in limits(formula, permitted).outputs.items():
            assert (np.diff(values) > 0.0).all(), (formula, name)


def test_the_handbook_keeps_no_error_below_that_of_its_tension_in_a_taut_line() -> None:
    """41 %, and 29 % in sag; that its tension happens to be right at some greater slack does not count."""
    found = limits("handbook", np.linspace(0.001, 0.41, 60))
    assert (found.status == Status.infeasible).all()
    for name in default_outputs(SOLVER):
        assert np.isnan(found.outputs[name]).all()


def test_a_limit_that_is_too_small_to_be_told_is_not_called_impossible() -> None:
    """The parabola is right to 1e-9 up to L/l - 1 = 3e-9, before the ladder begins; the handbook is nowhere."""
    tiny = np.array([1e-9])
    assert limits("parabolic", tiny).status == Status.out_of_domain
    assert limits("handbook", tiny).status == Status.infeasible


def test_the_handbook_keeps_an_error_of_half() -> None:
    """Its tension starts 41 % too large, and grows too small with slack."""
    found = limits("handbook", np.array([0.5]))
    assert found.status == Status.ok
    for limit, output in LIMITED.items():
        np.testing.assert_allclose(_measured_error("handbook", output, found.outputs[limit]), 0.5, rtol=1e-12)


def test_a_scenario_does_not_depend_on_its_neighbours() -> None:
    permitted = np.geomspace(1e-3, 0.2, 5000)
    together = limits(permitted=permitted).outputs
    for i in (0, 1, 777, 4095, 4096, 4999):
        alone = limits(permitted=permitted[i : i + 1]).outputs
        for name, values in alone.items():
            assert values[0] == together[name][i], name
