"""Judges for every solver, from the table of quantities alone: units do not matter, and neither do neighbours.

Lengths, masses and times are scaled by even powers of two, so that products, quotients and square roots scale without
rounding: where a formula is right in its dimensions, its answers scale to the last bits however ill-conditioned it is.
"""

import re

import numpy as np

from cablesim.batch import Results
from cablesim.hunt._case import Case, Judge
from cablesim.numerics import Array
from cablesim.quantities import VECTOR, quantity
from cablesim.status import Status

# By these the units of length, mass and time are smaller.
SCALES = (2.0**20, 2.0**-10, 2.0**6)
# Powers of length, mass and time.
DIMENSIONS = {
    "1": (0, 0, 0),
    "rad": (0, 0, 0),
    "m": (1, 0, 0),
    "m2": (2, 0, 0),
    "kg": (0, 1, 0),
    "s": (0, 0, 1),
    "N": (1, 1, -2),
    "Pa": (-1, 1, -2),
}
# Logarithms and functions of the mathematical library need not scale to the last bit, and some of them enter sums.
SCALED = 1e-12
# As many scenarios of a case are solved alone.
ALONE = 2


def unit_factor(name: str) -> float:
    """What a quantity is multiplied with when the units are made smaller by SCALES."""
    factor = 1.0
    for unit, power in re.findall(r"([A-Za-z]+|1)(-?\d*)", quantity(name).unit):
        for scale, exponent in zip(SCALES, DIMENSIONS[unit], strict=True):
            factor *= scale ** (exponent * int(power or 1))
    return factor


def units(case: Case, results: Results) -> Array:
    """By how much an answer in other units is another one."""
    scaled = {
        name: values if values.dtype.kind == "U" else values * unit_factor(name)
        for name, values in case.parameters.items()
    }
    other = case.solve(tuple(results.outputs), **scaled)
    miss = np.where(other.status == Status.ok, 0.0, np.inf)
    for name, values in results.outputs.items():
        miss = np.fmax(miss, _change(name, values, other.outputs[name] / unit_factor(name)) / SCALED)
    return miss


def neighbours(case: Case, results: Results) -> Array:
    """Whether a scenario solved alone has another answer, in any bit; only of a few."""
    miss = np.full(case.size, np.nan)
    for i in range(min(ALONE, case.size)):
        alone = case.rows(slice(i, i + 1)).solve(tuple(results.outputs))
        same = alone.status[0] == Status.ok and all(
            _same(values[i], alone.outputs[name][0]) for name, values in results.outputs.items()
        )
        miss[i] = 0.0 if same else np.inf
    return miss


JUDGES: dict[str, Judge] = {"units": units, "neighbours": neighbours}


def _change(name: str, values: Array, others: Array) -> Array:
    """The largest change of an output, relative to the largest value of it in its scenario."""
    if quantity(name).dims[-1:] == VECTOR:
        values, change = np.linalg.norm(values, axis=-1), np.linalg.norm(values - others, axis=-1)
    else:
        change = np.abs(values - others)
    size, change = (np.abs(each).reshape(len(each), -1) for each in (values, change))
    largest = np.fmax.reduce(size, axis=1)
    return np.fmax.reduce(change, axis=1) / np.where(largest > 0.0, largest, 1.0)


def _same(values: Array, others: Array) -> bool:
    """Whether they are the same; lists may have been padded by those of longer lines."""
    return np.array_equal(values[: len(others)] if values.ndim else values, others, equal_nan=True)
