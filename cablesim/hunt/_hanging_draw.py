"""Hanging lines of all lengths: slack, taut, upright, level, tiny and huge, stiff and soft."""

import numpy as np

from cablesim.hunt._case import Case
from cablesim.numerics import Array

# Decades: of the size of a line and of its weight; of its slack over its chord; of its rise over its span.
SIZES, USUAL_SIZES = (-12.0, 12.0), (0.0, 3.5)
SLACKS, USUAL_SLACKS = (-13.0, 8.0), (-3.0, 0.5)
SLOPES = (-9.0, 4.0)
# Of half the weight over the stiffness; of the chord over the length of lines that are stretched to reach it.
STRAINS = (-16.0, 3.0)
# Permitted errors; that of the handbook is never below 0.4.
ERRORS = (-3.0, -0.5), (-7.0, 0.0)


def hanging_lines(solver: str, size: int, rng: np.random.Generator) -> Case:
    """Lines with a length, or with the ratio of their length to their span."""
    level = solver not in ("catenary_exact", "catenary_elastic")
    span, weight = (decades(size, rng, USUAL_SIZES, SIZES) for _ in range(2))
    slope = np.zeros(size) if level else _slopes(size, rng)
    chord, slack = np.hypot(1.0, slope), decades(size, rng, USUAL_SLACKS, SLACKS)
    if solver == "catenary_elastic":
        stretched = rng.random(size) < 0.4
        slack = np.where(stretched, -slack / (1.0 + slack), slack)
        slack = np.where(rng.random(size) < 0.05, 0.0, slack)
    else:
        slack = np.where(rng.random(size) < 0.01, -slack / (1.0 + slack), slack)
    ratio = chord * (1.0 + slack)
    given = {"span": span, "weight_per_length": weight}
    given |= {"length_ratio": ratio} if rng.random() < 0.5 else {"line_length": ratio * span}
    given |= {} if level else {"rise": slope * span}
    if solver == "catenary_elastic":
        given["axial_stiffness"] = 0.5 * weight * ratio * span / decades(size, rng, (-6.0, -1.0), STRAINS)
    return Case(solver, given, {})


def permitted_errors(size: int, rng: np.random.Generator) -> list[Case]:
    """For each formula errors from those that are hardly more than nothing to those that are all."""
    cases = []
    for formula in ("parabolic", "series", "handbook"):
        some = size // 3 + (formula == "parabolic") * (size % 3)
        error = decades(some, rng, *ERRORS)
        cases.append(Case("catenary_limit_ratio", {"permitted_error": error}, {"formula": formula}))
    return [case for case in cases if case.size]


def _slopes(size: int, rng: np.random.Generator) -> Array:
    """Level for some, steep or hardly leaning to either side for others."""
    slope = 10.0 ** rng.uniform(*SLOPES, size) * rng.choice([-1.0, 1.0], size)
    return np.where(rng.random(size) < 0.2, 0.0, np.where(rng.random(size) < 0.4, rng.normal(size=size), slope))


def decades(size: int, rng: np.random.Generator, usual: tuple[float, float], all_: tuple[float, float]) -> Array:
    """Powers of ten: half of them of usual size, half of any."""
    return 10.0 ** np.where(rng.random(size) < 0.5, rng.uniform(*usual, size), rng.uniform(*all_, size))
