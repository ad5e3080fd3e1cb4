"""Tableau of Dormand and Prince's explicit Runge-Kutta method of order 8 with error estimates of order 5 and 3.

Taken from SciPy, which has it from the authors. Order 8, twelve stages.

Reference: E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed., section II.5.
"""

import numpy as np
from scipy.integrate import DOP853

STAGES = DOP853.n_stages
ORDER = DOP853.order
# Row i: the weights of earlier slopes in stage i; the last row gives the end of the step.
WEIGHTS = np.vstack([DOP853.A, DOP853.B])
# The error estimates also use the slope at the end of the step, which is the first stage of the next.
E3 = np.ascontiguousarray(DOP853.E3)
E5 = np.ascontiguousarray(DOP853.E5)
SAFETY = 0.9
SMALLEST_FACTOR, LARGEST_FACTOR = 0.2, 10.0
EXPONENT = -1.0 / 8.0
