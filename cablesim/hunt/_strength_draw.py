"""Lines of equal strength of all widths and rises, and the forces that they hang under."""

import numpy as np

from cablesim.hunt._case import Case
from cablesim.hunt._hanging_draw import decades
from cablesim.numerics import Array

# Decades: of the strength length; of the span over the widest, and of what is missing to it.
SIZES, USUAL_SIZES = (-12.0, 12.0), (2.0, 4.0)
NARROW, NEARLY_WIDEST = (-12.0, -0.5), (-13.0, -0.3)
# Of the rise over the strength length; lines of more rise than e^10 have no use, but must not be wrong.
RISES, USUAL_RISES = (-12.0, 1.0), (-2.0, 0.3)
STEEPEST = 500.0
# Of the force over that of the design, as far as digits are promised, and beyond.
FORCES, MORE_FORCES = (-3.0, 3.0), (-8.0, 8.0)
# Over k, level.
WIDEST_UNIFORM = 1.3254868386983632
SECTIONS = (1, 2, 3, 7, 10, 40)


def strength_lines(solver: str, size: int, rng: np.random.Generator) -> list[Case]:
    """Lines of one of the solvers."""
    given = _designs(size, rng)
    if solver == "equal_strength":
        return [Case(solver, given, {})]
    if solver == "uniform_strength":
        return [Case(solver, _low_enough(given), {})]
    given |= _loads(size, rng)
    if solver == "equal_strength_loaded":
        return [Case(solver, given, {})]
    whole = Case(solver, given, {})
    parts = [whole.rows(slice(first, None, len(SECTIONS))) for first in range(len(SECTIONS))]
    return [Case(solver, p.parameters, {"sections": n}) for p, n in zip(parts, SECTIONS, strict=True) if p.size]


def _designs(size: int, rng: np.random.Generator) -> dict[str, Array]:
    strength = decades(size, rng, USUAL_SIZES, SIZES)
    narrow, missing = 10.0 ** rng.uniform(*NARROW, size), 10.0 ** rng.uniform(*NEARLY_WIDEST, size)
    kinds = [narrow, 1.0 - missing, rng.uniform(0.01, 0.99, size), 1.0 + missing]
    share = np.choose(rng.choice(4, size, p=[0.3, 0.3, 0.39, 0.01]), kinds)
    rise = decades(size, rng, USUAL_RISES, RISES) * rng.choice([-1.0, 0.0, 1.0], size, p=[0.4, 0.2, 0.4])
    rise = np.where(rng.random(size) < 0.02, rng.uniform(-STEEPEST, STEEPEST, size), rise)
    return {"strength_length": strength, "span": share * np.pi * strength, "rise": rise * strength}


def _low_enough(given: dict[str, Array]) -> dict[str, Array]:
    """Spans up to the widest of a uniform line, and no rises above the strength length, which it cannot have."""
    k, rise = given["strength_length"], given["rise"]
    return given | {"span": given["span"] * (WIDEST_UNIFORM / np.pi), "rise": rise / (1.0 + np.abs(rise) / k)}


def _loads(size: int, rng: np.random.Generator) -> dict[str, Array]:
    force = decades(size, rng, FORCES, FORCES)
    force = np.where(rng.random(size) < 0.05, 10.0 ** rng.uniform(*MORE_FORCES, size), force)
    fraction = np.choose(rng.choice(3, size, p=[0.1, 0.1, 0.8]), [np.zeros(size), np.ones(size), rng.random(size)])
    return {"force_ratio": np.where(rng.random(size) < 0.05, 1.0, force), "arc_fraction": fraction}
