"""Run a solver over a batch of scenarios: in blocks that stay in the processor's cache, with only the wanted outputs.

What comes back is plain arrays; a failed scenario is NaN in every output, and no scenario depends on its neighbours.
"""

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from cablesim.numerics import Array
from cablesim.quantities import LIST, SHORT, numbers_per_scenario, quantity
from cablesim.solver import Solution, Solver, load_solver
from cablesim.status import Status

# Large enough that calls cost little, small enough that the arrays of a vectorised solver stay in the cache (measured).
BLOCK = 16384
# Of the outputs of a block, in memory: profiles and histories make blocks smaller.
MOST_NUMBERS = 2**25


@dataclass(frozen=True)
class Results:
    """Outputs by name, each of shape (scenario, ...); status and iterations of shape (scenario,); seconds in all."""

    outputs: dict[str, Array]
    status: np.ndarray
    iterations: np.ndarray
    seconds: float


def solve(solver: str, parameters: dict[str, Any], options: dict[str, Any] | None = None, outputs: Any = ()) -> Results:
    """Solve scenarios: `parameters` are scalars or arrays of one length, in SI.

    `outputs` defaults to all but profiles and histories.

    A vector is given as (3,), as (n, 3) or by its components (`force_A_x`, ...), a word as text. A list (one number for
    each section of the line) is given once for all scenarios, or as one list a scenario, which may differ in length.
    Raises InputError for anything unknown, missing or impossible in the request.
    """
    chosen = load_solver(solver)
    made = chosen.make_options(options or {})
    wanted = tuple(outputs) or default_outputs(chosen, made)
    chosen.check_outputs(wanted, made)
    return run(chosen, chosen.make_parameters(parameters), made, wanted)


def default_outputs(solver: Solver, options: Any = None) -> tuple[str, ...]:
    """The outputs that are one number, one vector or one number a section per scenario, with some options or any."""
    answered = solver.outputs if options is None else solver.answered(options)
    return tuple(name for name in answered if quantity(name).dims in SHORT)


def run(solver: Solver, parameters: Any, options: Any, outputs: tuple[str, ...]) -> Results:
    """Solve a batch that has been checked."""
    size = parameters.size
    status = np.empty(size, dtype=np.int8)
    iterations = np.zeros(size, dtype=np.int32)
    values: dict[str, Array] = {}
    if solver.compiled:
        _warm(solver, parameters.part(slice(0, 1)), options, outputs)
    block = _block_size(solver, parameters, options, outputs)
    start = perf_counter()
    for first in range(0, size, block):
        rows = slice(first, min(first + block, size))
        solution, found = _solve_block(solver, parameters.part(rows), options, outputs)
        status[rows] = _final_status(solution.status, [_own(name, v, parameters, rows) for name, v in found.items()])
        if solver.iterates:
            iterations[rows] = solution.iterations
        failed = np.flatnonzero(status[rows] != Status.ok)
        for name, value in found.items():
            if name not in values:
                values[name] = np.empty((size, *value.shape[1:]), dtype=value.dtype)
            values[name][rows] = value
            if failed.size:
                values[name][rows][failed] = np.nan
    return Results(values, status, iterations, perf_counter() - start)


def _block_size(solver: Solver, parameters: Any, options: Any, outputs: tuple[str, ...]) -> int:
    lists = any(LIST[0] in quantity(name).dims for name in outputs)
    sizes = {**solver.sizes(options), LIST[0]: int(parameters.sections.max())} if lists else solver.sizes(options)
    return max(1, min(BLOCK, MOST_NUMBERS // max(1, numbers_per_scenario(outputs, sizes))))


def _warm(solver: Solver, parameters: Any, options: Any, outputs: tuple[str, ...]) -> None:
    """Let a solver compile what it will need."""
    warm = getattr(solver.module, "warm", None)
    if warm is None:
        _solve_block(solver, parameters, options, outputs)
        return
    with np.errstate(all="ignore"):
        warm(parameters, options, outputs)


def _solve_block(
    solver: Solver, parameters: Any, options: Any, outputs: tuple[str, ...]
) -> tuple[Solution, dict[str, Array]]:
    with np.errstate(all="ignore"):
        solution = solver.solve(parameters, options, outputs)
        # Before anything is checked: what is too large for a float32 is not finite.
        return solution, {name: np.asarray(getattr(solution.answer, name), quantity(name).dtype) for name in outputs}


def _own(name: str, value: Array, parameters: Any, rows: slice) -> Array:
    """An output with 0 for the sections that a line does not have."""
    if quantity(name).dims[:1] != LIST:
        return value
    missing = np.arange(value.shape[1]) >= parameters.sections[rows, None]
    return np.where(missing.reshape(*missing.shape, *(1,) * (value.ndim - 2)), 0.0, value)


def _final_status(status: np.ndarray, found: list[Array]) -> np.ndarray:
    """A number that is not finite is never a result, whatever the solver says of it."""
    if all(np.isfinite(np.sum(value)) for value in found):
        return status
    finite = np.ones(status.shape, dtype=bool)
    for value in found:
        finite &= np.isfinite(value.reshape(len(value), -1)).all(axis=1) if value.ndim > 1 else np.isfinite(value)
    return np.where(finite | (status != Status.ok), status, Status.out_of_domain)
