"""Random parameters: from the ranges that a solver declares, and stretched far beyond them within its bounds."""

import numpy as np

from cablesim.hunt._case import Case
from cablesim.numerics import Array
from cablesim.parameters import ParameterSpec
from cablesim.quantities import is_list
from cablesim.solver import load_solver

MOST_SECTIONS = 6
# Nodes of a profile: enough to judge a shape by, few enough for a million of them.
NODES = 9
# By how much the typical ranges are stretched at either end.
STRETCH = 1e3


def problems(solver: str) -> tuple[tuple[str, ...], ...]:
    """The groups of parameters of which a solver takes one; a single empty group where there is no choice."""
    return load_solver(solver).module.Parameters.PROBLEMS or ((),)


def draw_declared(
    solver: str, size: int, rng: np.random.Generator, problem: int = 0, stretch: float = 1.0
) -> dict[str, np.ndarray]:
    """Random parameters of one of a solver's problems from the ranges that it declares; none that replaces another.

    A line of sections has one to six of them, its lists are NaN after the last.
    """
    left_out = {name for group in problems(solver) for name in group} - set(problems(solver)[problem])
    declared = load_solver(solver).parameters.values()
    wanted = [s for s in declared if s.instead_of is None and s.name not in left_out]
    values = {spec.name: _spread(spec, size, rng, stretch) for spec in wanted}
    return values | _ragged({spec.name: values[spec.name] for spec in wanted if spec.listed}, size, rng)


def draw_any(solver: str, size: int, rng: np.random.Generator) -> list[Case]:
    """Cases of a solver of which nothing is known but what it declares: every problem, half of them stretched."""
    kinds = [(problem, stretch) for problem in range(len(problems(solver))) for stretch in (1.0, STRETCH)]
    sizes = shared(size, len(kinds))
    drawn = [draw_declared(solver, n, rng, *kind) for n, kind in zip(sizes, kinds, strict=True) if n]
    return [Case(solver, values, few_nodes(solver)) for values in drawn]


def few_nodes(solver: str) -> dict[str, int]:
    """The options that keep a profile short."""
    return {"nodes": NODES} if "nodes" in load_solver(solver).options else {}


def shared(size: int, parts: int) -> list[int]:
    """A number in parts that differ by one at most."""
    return [size // parts + (part < size % parts) for part in range(parts)]


def spread(rng: np.random.Generator, size: int, low: float, high: float) -> Array:
    """Numbers spread evenly by their logarithm."""
    return np.exp(rng.uniform(np.log(low), np.log(high), size))


def mixed(rng: np.random.Generator, *choices: Array) -> Array:
    """For every scenario the value of one of the choices."""
    return np.stack(choices)[rng.integers(len(choices), size=choices[0].size), np.arange(choices[0].size)]


def signed(rng: np.random.Generator, values: Array) -> Array:
    """The values with a sign by chance."""
    return values * rng.choice([-1.0, 1.0], values.shape)


def number_of_sections(values: dict[str, np.ndarray]) -> np.ndarray:
    """How many sections each of the drawn lines has."""
    return np.isfinite(next(value for name, value in values.items() if is_list(name))).sum(axis=1)


def _ragged(lists: dict[str, Array], size: int, rng: np.random.Generator) -> dict[str, Array]:
    """The lists with as many sections for each line as chance will have it, the same in all of them."""
    if not lists:
        return {}
    ended = np.arange(MOST_SECTIONS) >= rng.integers(1, MOST_SECTIONS + 1, size)[:, None]
    return {name: np.where(ended, np.nan, values) for name, values in lists.items()}


def _spread(spec: ParameterSpec, size: int, rng: np.random.Generator, stretch: float) -> np.ndarray:
    if spec.words:
        return rng.choice(spec.words, size)
    low, high = spec.typical or (spec.default, spec.default)
    shape = (size, 3) if spec.vector else (size, MOST_SECTIONS) if spec.listed else size
    if spec.vector or not spec.listed and (spec.above is None or low <= 0.0):
        return _bounded(spec, rng.uniform(low, high, shape) * np.exp(rng.uniform(0.0, np.log(stretch), shape)))
    return _bounded(spec, np.exp(rng.uniform(np.log(low / stretch), np.log(high * stretch), shape)))


def _bounded(spec: ParameterSpec, values: Array) -> Array:
    """The values moved into the declared bounds."""
    for bound, inside in ((spec.above, np.inf), (spec.below, -np.inf)):
        if bound is not None:
            limit = np.nextafter(bound, inside)
            values = np.maximum(values, limit) if inside > 0.0 else np.minimum(values, limit)
    return np.clip(values, spec.at_least, spec.at_most) if (spec.at_least, spec.at_most) != (None, None) else values
