"""Bracketed Newton's method on many equations at once."""

import numpy as np
import pytest

from cablesim.numerics import Array
from cablesim.numerics.roots import Roots, newton_bracketed

TARGETS = np.geomspace(1e-12, 1e12, 97)


def powers(targets: Array, exponent: float = 3.0) -> tuple[Array, Array, Array]:
    """Low, high and start, a poor one, for x**exponent = target."""
    root = targets ** (1.0 / exponent)
    return root * 1e-6, root * 1e4, np.full_like(root, 1.0).clip(root * 1e-6, root * 1e4)


def power_equation(targets: Array, exponent: float = 3.0):
    def equation(x: Array, which: np.ndarray) -> tuple[Array, Array]:
        return x**exponent - targets[which], exponent * x**exponent

    return equation


def solve_powers(targets: Array, **settings: float) -> Roots:
    return newton_bracketed(power_equation(targets), *powers(targets), **settings)


def test_roots_are_found_to_the_last_digits() -> None:
    found = solve_powers(TARGETS)
    assert found.converged.all()
    # The step after one of 1e-9 is of 1e-18: what is left is the rounding of x^3 - target.
    np.testing.assert_allclose(found.x, np.cbrt(TARGETS), rtol=4.0 * np.finfo(float).eps)


def test_an_equation_that_is_linear_in_log_x_takes_one_step_and_one_to_see_it() -> None:
    def equation(x: Array, which: np.ndarray) -> tuple[Array, Array]:
        return np.log(x / TARGETS[which]), np.ones_like(x)

    found = newton_bracketed(equation, TARGETS * 1e-9, TARGETS * 1e9, TARGETS * 1e6)
    assert found.converged.all() and (found.iterations <= 2).all()
    np.testing.assert_allclose(found.x, TARGETS, rtol=1e-14)


def test_a_start_on_the_root_stays_there() -> None:
    targets = np.array([8.0, 27.0])
    start = np.array([2.0, 3.0])
    found = newton_bracketed(power_equation(targets), 0.5 * start, 2.0 * start, start)
    np.testing.assert_array_equal(found.x, start)
    np.testing.assert_array_equal(found.iterations, [1, 1])


def test_an_equation_on_which_newton_fails_is_halved_to_its_root() -> None:
    """Newton's method on the arc tangent of log x diverges from beyond 1.39."""

    def equation(x: Array, which: np.ndarray) -> tuple[Array, Array]:
        return np.arctan(np.log(x)), 1.0 / (1.0 + np.log(x) ** 2)

    low, high, start = (np.array([x]) for x in (np.exp(-30.0), np.exp(40.0), np.exp(20.0)))
    found = newton_bracketed(equation, low, high, start)
    assert found.converged.all()
    assert found.x[0] == pytest.approx(1.0, rel=1e-15)


def test_every_root_stays_in_its_bracket() -> None:
    seen = []

    def equation(x: Array, which: np.ndarray) -> tuple[Array, Array]:
        seen.append((x.copy(), which.copy()))
        return power_equation(TARGETS)(x, which)

    low, high, start = powers(TARGETS)
    newton_bracketed(equation, low, high, start)
    for x, which in seen:
        assert (x >= low[which]).all() and (x <= high[which]).all()


def test_too_few_steps_are_reported_and_not_more_are_taken() -> None:
    most = 4
    found, enough = solve_powers(TARGETS, most=most), solve_powers(TARGETS)
    np.testing.assert_array_equal(found.converged, enough.iterations <= most)
    np.testing.assert_array_equal(found.iterations, np.minimum(enough.iterations, most))
    assert found.converged.any() and not found.converged.all()


def test_an_equation_without_a_number_is_given_up_and_the_others_go_on() -> None:
    def equation(x: Array, which: np.ndarray) -> tuple[Array, Array]:
        value, slope = power_equation(TARGETS)(x, which)
        return np.where(which == 5, np.nan, value), slope

    found = newton_bracketed(equation, *powers(TARGETS), most=60)
    np.testing.assert_array_equal(np.flatnonzero(~found.converged), [5])
    assert found.iterations[5] == 60


def test_converged_equations_are_not_evaluated_again() -> None:
    evaluations = np.zeros(TARGETS.size, dtype=int)

    def equation(x: Array, which: np.ndarray) -> tuple[Array, Array]:
        evaluations[which] += 1
        return power_equation(TARGETS)(x, which)

    found = newton_bracketed(equation, *powers(TARGETS))
    np.testing.assert_array_equal(evaluations, found.iterations)
    assert found.iterations.min() < found.iterations.max()


def test_an_equation_does_not_depend_on_its_neighbours() -> None:
    together = solve_powers(TARGETS)
    for i in range(0, TARGETS.size, 8):
        alone = solve_powers(TARGETS[i : i + 1])
        assert alone.x[0] == together.x[i] and alone.iterations[0] == together.iterations[i]


def test_the_callers_brackets_are_left_alone() -> None:
    bracket = powers(TARGETS)
    before = [values.copy() for values in bracket]
    newton_bracketed(power_equation(TARGETS), *bracket)
    for values, untouched in zip(bracket, before, strict=True):
        np.testing.assert_array_equal(values, untouched)
