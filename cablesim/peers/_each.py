"""What adapters share: one line at a time, an answer or none, whatever the program prints or raises, silenced."""

import contextlib
import importlib
import io
import os
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from cablesim.quantities import quantity
from cablesim.solver import Solution
from cablesim.status import Status

Line = dict[str, Any]
# Numbers of a line's answer by output; None where the program has not found it.
Answer = Mapping[str, Any] | None
COMPONENTS = 3


def lines(p: Any) -> Iterator[Line]:
    """The parameters of each line: floats, words as their position, arrays of vectors, and lists without their NaN."""
    given = {f.name: value for f in fields(p) if (value := getattr(p, f.name)) is not None}
    for row in range(p.size):
        yield {name: _own(value[row]) for name, value in given.items()}


def singles(p: Any) -> Iterator[Any]:
    """Each line as a batch of one."""
    return (p.part(slice(row, row + 1)) for row in range(p.size))


def solve_each(
    p: Any,
    outputs: tuple[str, ...],
    answer: Callable[[Any], Answer],
    module: str = "",
    split: Callable[[Any], Iterator[Any]] = lines,
) -> Solution:
    """Ask for one line after the other; all are `unavailable` where the module that the program comes as is missing."""
    found = {name: np.full((p.size, COMPONENTS) if quantity(name).dims else p.size, np.nan) for name in outputs}
    if module and not is_there(module):
        return Solution(np.full(p.size, Status.unavailable, dtype=np.int8), SimpleNamespace(**found))
    status = np.full(p.size, Status.not_converged, dtype=np.int8)
    for row, line in enumerate(split(p)):
        numbers = _asked(answer, line)
        if numbers is not None and all(np.isfinite(numbers[name]).all() for name in outputs):
            status[row] = Status.ok
            for name in outputs:
                found[name][row] = numbers[name]
    return Solution(status, SimpleNamespace(**found))


def is_there(module: str) -> bool:
    """Whether a module can be imported."""
    try:
        importlib.import_module(module)
    except ImportError:
        return False
    return True


@contextlib.contextmanager
def silenced() -> Iterator[None]:
    """MoorPy prints its iterations, warns, and enters the debugger where it fails: no output, and an exception."""

    def give_up() -> None:
        raise ArithmeticError

    before, sys.breakpointhook = sys.breakpointhook, give_up
    try:
        with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        sys.breakpointhook = before


@contextlib.contextmanager
def muted() -> Iterator[None]:
    """MoorDyn's library writes to the process's own output, past Python's."""
    sys.stdout.flush()
    kept = {stream: os.dup(stream) for stream in (1, 2)}
    try:
        with Path(os.devnull).open("wb") as nowhere:
            for stream in kept:
                os.dup2(nowhere.fileno(), stream)
        yield
    finally:
        for stream, copy in kept.items():
            os.dup2(copy, stream)
            os.close(copy)


def _asked(answer: Callable[[Any], Answer], line: Any) -> Answer:
    with silenced():
        try:
            return answer(line)
        except Exception:
            # Whatever it raises, from its own errors to a singular matrix, it has not solved the line.
            return None


def _own(value: Any) -> Any:
    return value[~np.isnan(value)] if np.ndim(value) else value.item()
