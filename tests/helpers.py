"""What the tests share: tables beside them, parameters drawn from the declared ranges, and relative errors."""

import csv
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import netCDF4
import numpy as np

from cablesim.files import enter_in_ledger
from cablesim.numerics import Array
from cablesim.parameters import ParameterSpec
from cablesim.quantities import is_list
from cablesim.solver import load_solver

FOLDER = Path(__file__).parent
REFERENCE = FOLDER / "reference"
PUBLISHED = FOLDER.parent / "config" / "scenes" / "tables"
MOST_SECTIONS = 6
# Methods for lines in the vertical plane of the stream only.
PLANE_METHODS = ("pode_line", "pode_table_line")
# Methods for heavy lines with B straight above A only.
UPRIGHT_METHODS = ("pode_table_line",)


def read_table(path: Path) -> dict[str, Array]:
    """Columns of a CSV file by name, as numbers (empty cells NaN) or else as words; lines with # tell the source."""
    with path.open(encoding="utf-8", newline="") as file:
        head, *rows = csv.reader(line for line in file if not line.startswith("#"))
    return {name: _column(cells) for name, cells in zip(head, zip(*rows, strict=True), strict=True)}


@contextmanager
def rewritten(path: Path) -> Iterator[netCDF4.Dataset]:
    """A dataset to be changed, and entered in its ledger as if it had been written so."""
    with netCDF4.Dataset(path, "a") as file:
        yield file
    enter_in_ledger(path)


def problems(solver: str) -> tuple[tuple[str, ...], ...]:
    """The groups of parameters of which a solver takes one; a single empty group where there is no choice."""
    return load_solver(solver).module.Parameters.PROBLEMS or ((),)


def draw(solver: str, size: int, seed: int, problem: int = 0) -> dict[str, np.ndarray]:
    """Random parameters of one of a solver's problems from the ranges that it declares; none that replaces another.

    Lines of a plane method lie in its plane, those of one for upright chords have such a chord. A line of sections has
    one to six of them, its lists are NaN after the last.
    """
    rng = np.random.default_rng(seed)
    left_out = {name for group in problems(solver) for name in group} - set(problems(solver)[problem])
    declared = load_solver(solver).parameters.values()
    wanted = [s for s in declared if s.instead_of is None and s.name not in left_out]
    values = {spec.name: _spread(spec, size, rng) for spec in wanted}
    values |= _ragged({spec.name: values[spec.name] for spec in wanted if spec.listed}, size, rng)
    values = in_plane(values) if solver in PLANE_METHODS else values
    return upright(values) if solver in UPRIGHT_METHODS else values


def number_of_sections(values: dict[str, np.ndarray]) -> np.ndarray:
    """How many sections each of the drawn lines has."""
    return np.isfinite(next(value for name, value in values.items() if is_list(name))).sum(axis=1)


def in_plane(line: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Lines in a stream along x, without lay angle, moved into the vertical plane of the stream."""
    flat = {name: values * [1.0, 0.0, 1.0] for name, values in line.items() if values.ndim == 2}
    straight = {name: np.zeros_like(line[name]) for name in ("heading", "lay_angle") if name in line}
    return line | flat | straight


def upright(line: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The same lines made heavy, and B moved straight above A."""
    chord = np.linalg.norm(line["position_B"], axis=1)[:, None] * [0.0, 0.0, 1.0]
    return line | {"position_B": chord, "weight_per_length": np.abs(line["weight_per_length"])}


def rows(columns: dict[str, np.ndarray], which: np.ndarray | int | slice) -> dict[str, np.ndarray]:
    """Some of the scenarios."""
    return {name: values[which] for name, values in columns.items()}


def relative_error(found: Array, expected: Array, scale: Array | float = 0.0) -> Array:
    """Error relative to the expected value, or to `scale` where that is larger."""
    return np.abs(found - expected) / np.maximum(np.abs(expected), scale)


def _column(cells: tuple[str, ...]) -> np.ndarray:
    try:
        return np.array([float(cell or "nan") for cell in cells])
    except ValueError:
        return np.array(cells)


def _ragged(lists: dict[str, Array], size: int, rng: np.random.Generator) -> dict[str, Array]:
    """The lists with as many sections for each line as chance will have it, the same in all of them."""
    if not lists:
        return {}
    ended = np.arange(MOST_SECTIONS) >= rng.integers(1, MOST_SECTIONS + 1, size)[:, None]
    return {name: np.where(ended, np.nan, values) for name, values in lists.items()}


def _spread(spec: ParameterSpec, size: int, rng: np.random.Generator) -> np.ndarray:
    if spec.words:
        return rng.choice(spec.words, size)
    low, high = spec.typical
    if spec.vector:
        return rng.uniform(low, high, (size, 3))
    if spec.listed:
        return np.exp(rng.uniform(np.log(low), np.log(high), (size, MOST_SECTIONS)))
    if spec.above is None or low <= 0.0:
        return rng.uniform(low, high, size)
    return np.exp(rng.uniform(np.log(low), np.log(high), size))
