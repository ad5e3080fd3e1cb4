"""The tableau of the Runge-Kutta method against SciPy's, and the order that it must have."""

import numpy as np
from scipy.integrate import DOP853

from cablesim.numerics.dop853 import E3, E5, STAGES, WEIGHTS


def test_the_numbers_are_those_of_scipy_to_the_last_digit():
    np.testing.assert_array_equal(WEIGHTS[:STAGES], DOP853.A)
    np.testing.assert_array_equal(WEIGHTS[STAGES], DOP853.B)
    np.testing.assert_array_equal(E3, DOP853.E3)
    np.testing.assert_array_equal(E5, DOP853.E5)


def test_a_step_integrates_polynomials_of_degree_seven_exactly():
    nodes, weights = WEIGHTS[:STAGES].sum(axis=1), WEIGHTS[STAGES]
    for degree in range(8):
        # Weights of size one, summed: a few roundings of 1e-16 each.
        np.testing.assert_allclose(weights @ nodes**degree, 1.0 / (degree + 1.0), rtol=1e-14)
    assert abs(weights @ nodes**8 - 1.0 / 9.0) > 1e-10
