"""Random composite lines, and lines solved that must be; the laws that they hang by are those of `cablesim hunt`."""

import numpy as np

from cablesim.batch import default_outputs, solve
from cablesim.hunt._composite_laws import Lines, length, weight
from cablesim.solver import load_solver
from cablesim.status import Status

# One of the two is given; the other is an answer.
GIVEN = ("horizontal_tension", "horizontal_distance")
# The share of its weight that steel keeps in water, by the handbook on towing.
IN_WATER = 0.87
OUTPUTS = default_outputs(load_solver("composite_line"))
SHAPE = ("profile", "profile_tension", "profile_section")


def random_lines(size: int, seed: int, given: str, most: int = 20) -> Lines:
    """Lines of one to `most` sections, 3 decades of lengths and 5 of weights, steep and level, slack and taut.

    The tension is 1e-3 to 1e4 of the weight, or the chord is shorter than the line by 1e-9 of it to 90 %.
    """
    rng = np.random.default_rng(seed)
    missing = np.arange(most) >= rng.integers(1, most + 1, size)[:, None]
    lengths = np.where(missing, np.nan, 10.0 ** rng.uniform(0.0, 3.0, (size, most)))
    weights = np.where(missing, np.nan, 10.0 ** rng.uniform(-1.0, 4.0, (size, most)))
    line = {"section_length": lengths, "section_weight": weights}
    slope = np.where(rng.random(size) < 0.2, 0.0, rng.uniform(-0.9, 0.9, size))
    if given == "horizontal_tension":
        tension = weight(line) * 10.0 ** rng.uniform(-3.0, 4.0, size)
        return line | {"rise": slope * length(line), given: tension}
    chord = length(line) * (1.0 - 10.0 ** rng.uniform(-9.0, np.log10(0.9), size))
    return line | {"rise": slope * chord, given: chord * np.sqrt(1.0 - slope * slope)}


def solved(line: Lines, outputs: tuple[str, ...] = (), nodes: int = 101, solver: str = "composite_line") -> Lines:
    """Outputs of lines that must all be solved; all but the profile, unless others are asked for."""
    known = load_solver(solver)
    options = {"nodes": nodes} if "nodes" in known.options else {}
    found = solve(solver, line, options, outputs or tuple(name for name in known.outputs if name not in SHAPE))
    assert (found.status == Status.ok).all()
    return found.outputs
