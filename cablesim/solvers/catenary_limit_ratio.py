"""The largest length ratio at which an approximate formula for a level line keeps a permitted error.

    |1 - f_approx / f| <= eta  and  |1 - T_approx / T| <= eta  for all length ratios up to the limit       (M5)

Both errors depend on L/l alone. The limit is where the error first exceeds eta: found on a ladder of lambda = l / 2a
and refined by Chandrupatla's method. A formula that is off by more than eta from the start has no limit: infeasible.
Of a right formula errors below some 1e-7 have their limit before the ladder begins: out_of_domain.

Reference: "Comparison of experimental and theoretical catenary lines", equations 19-20 and figure 5.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.optimize.elementwise import find_root

from cablesim.numerics import Array
from cablesim.numerics.hyperbolic import sinhc_excess
from cablesim.parameters import Batch, option, parameter
from cablesim.physics.catenary import Catenary
from cablesim.physics.level_span import FORMULAS
from cablesim.solver import Solution
from cablesim.status import Status

OUTPUTS = ("sag_limit_ratio", "tension_limit_ratio")
SECONDS_PER_SCENARIO = 2.5e-6
# From L/l - 1 = 2e-7, where every error of a right formula is far below any permitted one, to L/l = 1e19.
LADDER = np.geomspace(1e-3, 50.0, 2000)
# A formula that is no more wrong than this where the ladder begins becomes right before it.
RIGHT = 1e-6


@dataclass(frozen=True)
class Parameters(Batch):
    permitted_error: Array = parameter(above=0.0, typical=(1e-3, 0.2))


@dataclass(frozen=True)
class Options:
    formula: str = option("parabolic", one_of=tuple(FORMULAS), meaning="the formula whose error is limited")


@dataclass(frozen=True)
class Limits:
    sag_limit_ratio: Array
    tension_limit_ratio: Array


def solve(p: Parameters, options: Options) -> Solution:
    limits = Limits(*(_limit(options.formula, output, p.permitted_error) for output in ("sag", "max_tension")))
    found = np.isfinite(limits.sag_limit_ratio) & np.isfinite(limits.tension_limit_ratio)
    missing = np.where(p.permitted_error < _least_resolved(options.formula), Status.out_of_domain, Status.infeasible)
    return Solution(np.where(found, Status.ok, missing).astype(np.int8), limits)


def _limit(formula: str, output: str, permitted: Array) -> Array:
    """Length ratio at which the error first exceeds the permitted one; NaN where it never does, or always."""
    first_above = np.searchsorted(_worst_so_far(formula, output), permitted, side="right")
    inside = (first_above > 0) & (first_above < LADDER.size)
    above = np.where(inside, first_above, 1)
    error = _error(formula, output)
    root = find_root(
        lambda x, eta: error(x) - eta, (LADDER[above - 1], LADDER[above]), args=(np.where(inside, permitted, np.nan),)
    )
    return 1.0 + sinhc_excess(np.where(inside & root.success, root.x, np.nan))


def _least_resolved(formula: str) -> float:
    """The least permitted error whose limits are on the ladder; zero of a formula that is wrong."""
    starts = [float(_worst_so_far(formula, output)[0]) for output in ("sag", "max_tension")]
    return max(starts) if max(starts) < RIGHT else 0.0


@cache
def _worst_so_far(formula: str, output: str) -> Array:
    return np.maximum.accumulate(_error(formula, output)(LADDER))


def _error(formula: str, output: str) -> Callable[[Array], Array]:
    """Relative error of an output as a function of lambda, for a line of unit span and weight."""

    def error(half_angle: Array) -> Array:
        shape = np.shape(half_angle)
        x = np.atleast_1d(half_angle)
        one, excess = np.ones_like(x), sinhc_excess(x)
        exact = Catenary(2, one, one, np.zeros_like(x), 1.0 + excess, x)
        approximate = FORMULAS[formula](2, one, one, excess)
        return np.abs(1.0 - getattr(approximate, output) / getattr(exact, output)).reshape(shape)

    return error
