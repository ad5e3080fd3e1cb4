"""Tow lines of sections in series, and the height of waves in which they may tow."""

from dataclasses import replace

import numpy as np

from cablesim.batch import Results
from cablesim.hunt import _anything
from cablesim.hunt._case import Case, Judge
from cablesim.hunt._composite_judges import equilibrium, second_method
from cablesim.hunt._tow_draw import of_two, pulled, spanned, towed
from cablesim.numerics import Array

SOLVERS = ("composite_line", "composite_mean_weight", "composite_handbook", "composite_parabolic", "tow_wave_height")


def draw(solver: str, size: int, rng: np.random.Generator) -> list[Case]:
    if solver == "tow_wave_height":
        return [towed(size, rng)]
    if solver in ("composite_line", "composite_mean_weight"):
        return [Case(solver, pulled(size // 2, rng), {}), Case(solver, spanned(size - size // 2, rng), {})]
    line = pulled(size, rng)
    if solver == "composite_handbook":
        line = of_two(line)
        del line["rise"]
    return [Case(solver, line, {})]


def judges(solver: str) -> dict[str, Judge]:
    return _anything.judges(solver) | {"units": units, "equilibrium": equilibrium, "second method": second_method}


def units(case: Case, found: Results) -> Array:
    """As for all solvers, but for the section of the vertex: beside a joint, rounding decides which it is."""
    smooth = {name: values for name, values in found.outputs.items() if name != "vertex_section"}
    return _anything.other_answer_in_other_units(case, replace(found, outputs=smooth))
