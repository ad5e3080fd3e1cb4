"""Tow lines of sections in series, and the height of waves in which they may tow."""

from dataclasses import replace

import numpy as np

from cablesim.batch import Results
from cablesim.hunt import _anything, _tow_waves
from cablesim.hunt._case import Case, Judge
from cablesim.hunt._composite_judges import equilibrium, second_method
from cablesim.hunt._composite_profile import profile
from cablesim.hunt._composite_symmetry import existence, halves, harder_pull, other_end
from cablesim.hunt._tow_draw import of_two, pulled, spanned, towed
from cablesim.numerics import Array

SOLVERS = ("composite_line", "composite_mean_weight", "composite_handbook", "composite_parabolic", "tow_wave_height")
# A line between two ends takes some milliseconds, most of them for the line in longer floats.
WEIGHTS = {"composite_line": 0.3, "composite_mean_weight": 0.3}
# Profiles are of fewer nodes than this.
MOST_NODES = 12


def draw(solver: str, size: int, rng: np.random.Generator) -> list[Case]:
    """Lines pulled with a force, between two ends, or of wire and chain, and lines that tow."""
    if solver == "tow_wave_height":
        return towed(size, rng)
    options = {"nodes": int(rng.integers(2, MOST_NODES))}
    if solver in ("composite_line", "composite_mean_weight"):
        lines = (pulled(size // 2, rng), spanned(size - size // 2, rng)) if size > 1 else (pulled(size, rng),)
        return [Case(solver, line, options) for line in lines]
    line = pulled(size, rng)
    if solver == "composite_handbook":
        line = of_two(line)
        del line["rise"]
    return [Case(solver, line, options)]


def judges(solver: str) -> dict[str, Judge]:
    """Laws first; the line in longer floats last."""
    shared = _anything.judges(solver) | {"units": units}
    if solver == "tow_wave_height":
        laws = {"feasibility": _tow_waves.feasibility, "formula": _tow_waves.formula, "other end": _tow_waves.other_end}
        return shared | laws | {"second method": _tow_waves.distances}
    return shared | _laws(solver) | {"second method": second_method, "profile": profile}


def _laws(solver: str) -> dict[str, Judge]:
    """The handbook's line is of wire and chain in this order; only the exact methods meet B."""
    if solver == "composite_handbook":
        return {"equilibrium": equilibrium}
    symmetries: dict[str, Judge] = {
        "equilibrium": equilibrium,
        "existence": existence,
        "other end": other_end,
        "halves": halves,
    }
    return symmetries if solver == "composite_parabolic" else symmetries | {"harder pull": harder_pull}


def units(case: Case, found: Results) -> Array:
    """As for all solvers, but for the section of the vertex: beside a joint, rounding decides which it is."""
    smooth = {name: values for name, values in found.outputs.items() if name != "vertex_section"}
    return _anything.other_answer_in_other_units(case, replace(found, outputs=smooth))
