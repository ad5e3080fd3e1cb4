"""Newton's method, damped, for many small systems of equations at once: solved ones leave the loop."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cablesim.numerics import Array

# Function of (x, which): residuals (n, d) and Jacobians (n, d, d) of the systems `which` at the points x (n, d).
System = Callable[[Array, np.ndarray], tuple[Array, Array]]
# A step is halved at most this often; what then does not reduce the residual is given up.
HALVINGS = 12
# The residual must fall by this part of what the linear model promises.
ENOUGH = 1e-4


@dataclass(frozen=True)
class Points:
    """x (n, d), the length of its residual (n,), whether that is within the tolerance, and evaluations (n,)."""

    x: Array
    residual: Array
    converged: np.ndarray
    iterations: np.ndarray


def damped_newton(system: System, start: Array, tolerance: float | Array, most: int = 30) -> Points:
    """Points at which the residual is no longer than `tolerance` (per system, or one for all).

    A full step where it reduces the residual, else one halved until it does: bounded work for any start.
    """
    x = start.copy()
    n = len(x)
    limit = np.broadcast_to(np.asarray(tolerance, dtype=float), (n,))
    active = np.arange(n)
    value, jacobian = system(x, active)
    residual = _length(value)
    iterations = np.ones(n, dtype=np.int32)
    step_share = np.ones(n)
    newton = _step(value, jacobian)
    for _ in range(most):
        unsolved = (residual[active] > limit[active]) & np.isfinite(residual[active])
        active = active[unsolved & (step_share[active] > 2.0**-HALVINGS)]
        if not active.size:
            break
        trial = x[active] + step_share[active, None] * newton[active]
        found, slope = system(trial, active)
        iterations[active] += 1
        size = _length(found)
        better = size <= (1.0 - ENOUGH * step_share[active]) * residual[active]
        accepted = active[better]
        x[accepted], residual[accepted] = trial[better], size[better]
        newton[accepted] = _step(found[better], slope[better])
        step_share[accepted] = np.minimum(1.0, 4.0 * step_share[accepted])
        step_share[active[~better]] *= 0.5
    return Points(x, residual, residual <= limit, iterations)


def _step(value: Array, jacobian: Array) -> Array:
    """Newton's step of each system; NaN, which no step is taken with, where the Jacobian is singular."""
    usable = np.isfinite(np.sum(value, axis=1)) & np.isfinite(np.sum(jacobian, axis=(1, 2)))
    usable &= np.abs(np.linalg.det(np.where(usable[:, None, None], jacobian, np.eye(value.shape[1])))) > 0.0
    step = np.full_like(value, np.nan)
    if usable.any():
        step[usable] = np.linalg.solve(jacobian[usable], -value[usable, :, None])[:, :, 0]
    return step


def _length(value: Array) -> Array:
    length = np.sqrt(np.einsum("ij,ij->i", value, value))
    return np.where(np.isfinite(length), length, np.inf)
