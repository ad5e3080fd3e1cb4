"""Damped Newton's method on many small systems at once."""

import numpy as np
import pytest

from cablesim.numerics import Array
from cablesim.numerics.newton import HALVINGS, damped_newton

TOLERANCE = 1e-12


def circle_and_line(radius: Array):
    """x^2 + y^2 = r^2 and y = 2 x: at r (1, 2) / sqrt(5)."""

    def system(x: Array, which: np.ndarray) -> tuple[Array, Array]:
        value = np.column_stack([(x**2).sum(axis=1) - radius[which] ** 2, x[:, 1] - 2.0 * x[:, 0]])
        jacobian = np.stack([2.0 * x, np.tile([-2.0, 1.0], (len(x), 1))], axis=1)
        return value, jacobian

    return system


def arctangents(x: Array, which: np.ndarray) -> tuple[Array, Array]:
    """Full steps diverge from beyond 1.39 in either unknown."""
    jacobian = np.zeros((len(x), 2, 2))
    jacobian[:, [0, 1], [0, 1]] = 1.0 / (1.0 + x**2)
    return np.arctan(x), jacobian


RADII = np.geomspace(1e-2, 1e2, 41)
START = np.tile([1.0, 1.0], (41, 1))


def test_solutions_are_found_to_the_tolerance() -> None:
    found = damped_newton(circle_and_line(RADII), START, TOLERANCE * RADII**2)
    assert found.converged.all() and (found.residual <= TOLERANCE * RADII**2).all()
    # The residual over the smallest slope, which is about r.
    np.testing.assert_allclose(found.x, RADII[:, None] * np.array([1.0, 2.0]) / np.sqrt(5.0), rtol=10.0 * TOLERANCE)


def test_a_linear_system_takes_one_step() -> None:
    rng = np.random.default_rng(1)
    matrices, solutions = rng.normal(size=(50, 3, 3)) + 5.0 * np.eye(3), rng.normal(size=(50, 3))

    def system(x: Array, which: np.ndarray) -> tuple[Array, Array]:
        return np.einsum("nij,nj->ni", matrices[which], x - solutions[which]), matrices[which]

    found = damped_newton(system, np.zeros((50, 3)), TOLERANCE)
    assert found.converged.all() and (found.iterations == 2).all()
    np.testing.assert_allclose(found.x, solutions, atol=TOLERANCE)


def test_a_system_on_which_full_steps_diverge_is_damped() -> None:
    found = damped_newton(arctangents, np.array([[5.0, -5.0], [1.5, 1.5], [-100.0, 0.1]]), TOLERANCE)
    assert found.converged.all()
    np.testing.assert_allclose(found.x, 0.0, atol=2.0 * TOLERANCE)


def test_a_start_on_the_solution_is_evaluated_once_and_stays_there() -> None:
    start = np.array([[3.0, 4.0]])

    def system(x: Array, which: np.ndarray) -> tuple[Array, Array]:
        return x - start[which], np.tile(np.eye(2), (len(x), 1, 1))

    found = damped_newton(system, start, TOLERANCE)
    np.testing.assert_array_equal(found.x, start)
    assert found.converged.all() and (found.iterations == 1).all()


def test_a_system_without_a_solution_is_given_up_after_bounded_work() -> None:
    def system(x: Array, which: np.ndarray) -> tuple[Array, Array]:
        return 1.0 + x**2, 2.0 * x[:, :, None]

    found = damped_newton(system, np.array([[3.0], [0.5]]), TOLERANCE, most=100)
    assert not found.converged.any()
    assert (found.residual >= 1.0).all()
    assert (found.iterations <= 101).all()


def test_a_step_is_halved_only_so_often() -> None:
    """A wrong Jacobian points uphill: no part of its step helps."""

    def system(x: Array, which: np.ndarray) -> tuple[Array, Array]:
        return x, np.full((len(x), 1, 1), -1.0)

    found = damped_newton(system, np.array([[1.0]]), TOLERANCE)
    assert not found.converged[0] and found.x[0, 0] == 1.0
    assert found.iterations[0] == 1 + HALVINGS


def test_too_few_steps_are_reported_and_not_more_are_taken() -> None:
    tolerance = TOLERANCE * RADII**2
    enough = damped_newton(circle_and_line(RADII), START, tolerance)
    most = 5
    found = damped_newton(circle_and_line(RADII), START, tolerance, most=most)
    np.testing.assert_array_equal(found.converged, enough.iterations <= most + 1)
    np.testing.assert_array_equal(found.iterations, np.minimum(enough.iterations, most + 1))
    assert found.converged.any() and not found.converged.all()


@pytest.mark.parametrize("trouble", ["nan", "singular", "infinite slope"])
def test_a_system_that_breaks_is_given_up_and_the_others_go_on(trouble: str) -> None:
    def system(x: Array, which: np.ndarray) -> tuple[Array, Array]:
        value, jacobian = circle_and_line(RADII)(x, which)
        broken = which == 7
        if trouble == "nan":
            value[broken] = np.nan
        jacobian[broken] = {"nan": 1.0, "singular": 0.0, "infinite slope": np.inf}[trouble]
        return value, jacobian

    found = damped_newton(system, START, TOLERANCE * RADII**2)
    np.testing.assert_array_equal(np.flatnonzero(~found.converged), [7])
    np.testing.assert_array_equal(found.x[7], START[7])


def test_a_step_into_no_man_s_land_is_shortened() -> None:
    """The root of x, NaN below zero: a full step from 9 leads to -9."""

    def system(x: Array, which: np.ndarray) -> tuple[Array, Array]:
        with np.errstate(invalid="ignore"):
            root = np.sqrt(x)
        return root - 0.5, 0.5 / root[:, :, None]

    found = damped_newton(system, np.array([[9.0]]), TOLERANCE)
    assert found.converged[0]
    assert found.x[0, 0] == pytest.approx(0.25, rel=4.0 * TOLERANCE)


def test_solved_systems_are_not_evaluated_again() -> None:
    evaluations = np.zeros(41, dtype=int)

    def system(x: Array, which: np.ndarray) -> tuple[Array, Array]:
        evaluations[which] += 1
        return circle_and_line(RADII)(x, which)

    found = damped_newton(system, START, TOLERANCE * RADII**2)
    np.testing.assert_array_equal(evaluations, found.iterations)
    assert found.iterations.min() < found.iterations.max()


def test_a_system_does_not_depend_on_its_neighbours() -> None:
    together = damped_newton(circle_and_line(RADII), START, TOLERANCE * RADII**2)
    for i in range(0, 41, 5):
        alone = damped_newton(circle_and_line(RADII[i : i + 1]), START[i : i + 1], TOLERANCE * RADII[i : i + 1] ** 2)
        np.testing.assert_array_equal(alone.x[0], together.x[i])
        assert alone.iterations[0] == together.iterations[i]


def test_the_callers_start_is_left_alone() -> None:
    start = START.copy()
    damped_newton(circle_and_line(RADII), start, TOLERANCE)
    np.testing.assert_array_equal(start, START)
