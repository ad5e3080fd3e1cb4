"""Judges of the largest length ratio at which an approximate formula keeps a permitted error."""

from functools import cache

import numpy as np

from cablesim.batch import Results
from cablesim.hunt._case import Case
from cablesim.hunt._hanging_reference import Line, catenary, level_formula
from cablesim.hunt._precise import ROUNDING, log_sinhc, longer, worst
from cablesim.numerics import Array

# Output of a hanging line behind each limit.
LIMITED = {"sag_limit_ratio": "sag", "tension_limit_ratio": "max_tension"}
# An error is one less a quotient: it, and so what is permitted, is known to some roundings of one.
GRAIN = 16.0 * ROUNDING
# Half angles at which the error is looked at below the limit; other ones than the solver's ladder.
LOOKED_AT = np.geomspace(1.1e-3, 45.0, 1777)


def off_the_permitted_error(case: Case, found: Results) -> Array:
    """How far the error at the limit is from the permitted one; a limit is rounded, which changes the error there."""
    permitted = case.parameters["permitted_error"]
    misses = []
    for limit, output in LIMITED.items():
        ratio = longer(found.outputs[limit])
        here, beside = (_errors(case.options["formula"], times)[output] for times in (ratio, ratio * (1.0 + GRAIN)))
        misses.append(np.abs(here - permitted) / (GRAIN + np.abs(beside - here)))
    return worst(*misses)


def more_below(case: Case, found: Results) -> Array:
    """How much more than permitted the error is at smaller length ratios."""
    permitted = case.parameters["permitted_error"]
    misses = []
    for limit, output in LIMITED.items():
        ratios, most = _most_below(case.options["formula"], output)
        below = np.searchsorted(ratios, np.asarray(found.outputs[limit], dtype=float), side="left")
        known = np.where(below > 0, most[np.maximum(below - 1, 0)], 0.0)
        misses.append((known - permitted) / GRAIN)
    return np.maximum(worst(*misses), 0.0)


@cache
def _most_below(formula: str, output: str) -> tuple[Array, Array]:
    """Length ratios, and the largest error up to each."""
    ratios = np.asarray(np.exp(log_sinhc(longer(LOOKED_AT))), dtype=float)
    return ratios, np.maximum.accumulate(np.asarray(_errors(formula, longer(ratios))[output], dtype=float))


def _errors(formula: str, ratio: Array) -> dict[str, Array]:
    """Relative errors of a formula for lines of unit span and weight."""
    one = np.ones_like(ratio)
    line = Line(one, 0.0 * one, ratio, one, (ratio - 1.0) * (ratio + 1.0), 0.0 * one)
    exact, approximate = catenary(line)[0], level_formula(formula, line)
    return {name: np.abs(1.0 - approximate[name].value / exact[name].value) for name in LIMITED.values()}
