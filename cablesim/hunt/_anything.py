"""What holds for every static solver, whatever it solves: units do not matter, and neither do neighbours.

Used for all families, and alone for a solver that has none.
"""

import numpy as np

from cablesim import batch, units
from cablesim.batch import Results
from cablesim.hunt._case import Case, Judge
from cablesim.numerics import Array
from cablesim.parameters import ParameterSpec
from cablesim.quantities import quantity
from cablesim.solver import load_solver

# Powers of two by which lengths, masses and times are multiplied: floats keep all their digits.
SCALES = {"[length]": 2.0**5, "[mass]": 2.0**-7, "[time]": 2.0**3}
# Scaled numbers are the same numbers with another exponent; what is added to 1 or compared may round otherwise.
SAME = 1e-9
# What an output is called that is itself what is left over: rounding, in other units another one.
ERROR = "_error"
# Scenarios of a case that are solved alone as well.
ALONE = 3
MOST_SECTIONS = 6


def judges(solver: str) -> dict[str, Judge]:
    """The judges of every static solver."""
    return {"neighbours": other_bits_alone, "units": other_answer_in_other_units}


def draw(solver: str, size: int, rng: np.random.Generator) -> list[Case]:
    """From the declared ranges, of one of the solver's problems each time."""
    loaded = load_solver(solver)
    problems = loaded.module.Parameters.PROBLEMS or ((),)
    asked = problems[int(rng.integers(len(problems)))]
    left_out = {name for group in problems for name in group} - set(asked)
    wanted = [s for s in loaded.parameters.values() if s.instead_of is None and s.name not in left_out]
    return [Case(solver, {spec.name: _spread(spec, size, rng) for spec in wanted}, {})]


def other_bits_alone(case: Case, found: Results) -> Array:
    """Infinite where a scenario solved alone has other bits than among others; not judged but for the first few."""
    miss = np.full(case.size, np.nan)
    for row in range(min(ALONE, case.size)):
        alone = case.rows(slice(row, row + 1)).solve(tuple(found.outputs))
        pairs = ((alone.outputs[name][0], values[row]) for name, values in found.outputs.items())
        miss[row] = (
            0.0 if all(_same(own, among[: len(own)] if np.ndim(own) else among) for own, among in pairs) else np.inf
        )
    return miss


def other_answer_in_other_units(case: Case, found: Results) -> Array:
    """How far answers in other units are from the same answers, relative to the greatest of their kind."""
    scaled = {
        name: values if values.dtype.kind in "US" else values * scale(name) for name, values in case.parameters.items()
    }
    other = batch.solve(case.solver, scaled, case.options, tuple(found.outputs))
    miss = np.zeros(case.size)
    for name, values in found.outputs.items():
        if name.endswith(ERROR):
            continue
        ours = other.outputs[name] / scale(name)
        largest = np.maximum(np.abs(ours), np.abs(values))
        with np.errstate(invalid="ignore", divide="ignore"):
            apart = np.abs(ours - values) / largest
        apart = np.where(largest == 0.0, 0.0, apart).reshape(case.size, -1)
        miss = np.fmax(miss, np.nanmax(apart, axis=1, initial=0.0))
    return np.where(other.status == 0, miss / SAME, np.inf)


def scale(name: str) -> float:
    """By how much a quantity is greater in the other units."""
    exponents = units.dimensions(quantity(name).unit)
    return float(np.prod([SCALES[base] ** power for base, power in exponents.items()]))


def _same(one: Array, other: Array) -> bool:
    return np.array_equal(one, other, equal_nan=True)


def _spread(spec: ParameterSpec, size: int, rng: np.random.Generator) -> np.ndarray:
    """Numbers, words, vectors or lists of a parameter, logarithmic where that makes sense."""
    if spec.words:
        return rng.choice(spec.words, size)
    low, high = spec.typical or (0.1, 10.0)
    shape = (size, 3) if spec.vector else (size, MOST_SECTIONS) if spec.listed else (size,)
    if low > 0.0:
        return np.exp(rng.uniform(np.log(low), np.log(high), shape))
    return rng.uniform(low, high, shape)
