"""Roots of many independent equations at once: converged ones leave the loop, the others keep their own steps."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cablesim.numerics import Array

# Function of (x, which): value and d(value)/d(log x) of the equations `which` (integer positions) at the points x.
Equation = Callable[[Array, np.ndarray], tuple[Array, Array]]


@dataclass(frozen=True)
class Roots:
    """x, whether each converged, and how many evaluations each took."""

    x: Array
    converged: np.ndarray
    iterations: np.ndarray


def newton_bracketed(
    equation: Equation, low: Array, high: Array, start: Array, tolerance: float = 1e-9, most: int = 80
) -> Roots:
    """Positive roots of functions that are negative at `low` and positive at `high`.

    Newton's step in log x where it stays inside the bracket, the geometric mean of the bracket where it does not:
    bounded work for any start. Stops after a Newton step of less than `tolerance` relative: the error it leaves is of
    the order of tolerance**2, so only rounding remains, and no time is spent on chasing that.
    """
    x, low, high = start.copy(), low.copy(), high.copy()
    converged = np.zeros(x.shape, dtype=bool)
    iterations = np.zeros(x.shape, dtype=np.int32)
    active = np.arange(x.size)
    for _ in range(most):
        here = x[active]
        with np.errstate(all="ignore"):
            value, slope = equation(here, active)
            low[active] = np.where(value < 0.0, here, low[active])
            high[active] = np.where(value > 0.0, here, high[active])
            step = here * np.exp(-value / slope)
            inside = (step >= (1.0 - tolerance) * low[active]) & (step <= (1.0 + tolerance) * high[active])
            proposal = np.where(inside, step, np.sqrt(low[active]) * np.sqrt(high[active]))
        iterations[active] += 1
        exact = value == 0.0
        x[active] = np.where(exact, here, proposal)
        done = exact | (inside & (np.abs(step - here) <= tolerance * here))
        converged[active[done]] = True
        active = active[~done]
        if active.size == 0:
            break
    return Roots(x, converged, iterations)
