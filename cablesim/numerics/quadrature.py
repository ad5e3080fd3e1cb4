"""Gauss-Legendre quadrature by panels."""

import numpy as np

# Sixteen points: a function that is analytic within 0.7 of a panel of length one is integrated to 1e-15.
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(16)
# Moved to the interval 0..1.
POINTS, WEIGHTS = 0.5 * (POINTS + 1.0), 0.5 * WEIGHTS
