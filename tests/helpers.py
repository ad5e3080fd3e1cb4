"""What the tests share: tables beside them, parameters drawn from the declared ranges, and relative errors."""

import csv
from pathlib import Path

import numpy as np

from cablesim.numerics import Array
from cablesim.parameters import ParameterSpec
from cablesim.solver import load_solver

FOLDER = Path(__file__).parent
REFERENCE = FOLDER / "reference"
PUBLISHED = FOLDER.parent / "config" / "scenes" / "tables"


def read_table(path: Path) -> dict[str, Array]:
    """Columns of a CSV file by name, empty cells as NaN; lines that start with # say where it comes from."""
    with path.open(encoding="utf-8", newline="") as file:
        head, *rows = csv.reader(line for line in file if not line.startswith("#"))
    columns = zip(*rows, strict=True)
    return {name: np.array([float(cell or "nan") for cell in cells]) for name, cells in zip(head, columns, strict=True)}


def draw(solver: str, size: int, seed: int) -> dict[str, np.ndarray]:
    """Random parameters of a solver's first problem from the ranges that it declares; none that replaces another."""
    rng = np.random.default_rng(seed)
    chosen = load_solver(solver)
    first, *others = chosen.module.Parameters.PROBLEMS or ((),)
    left_out = {name for problem in others for name in problem} - set(first)
    wanted = [s for s in chosen.parameters.values() if s.instead_of is None and s.name not in left_out]
    return {spec.name: _spread(spec, size, rng) for spec in wanted}


def rows(columns: dict[str, np.ndarray], which: np.ndarray | int) -> dict[str, np.ndarray]:
    """Some of the scenarios."""
    return {name: values[which] for name, values in columns.items()}


def relative_error(found: Array, expected: Array, scale: Array | float = 0.0) -> Array:
    """Error relative to the expected value, or to `scale` where that is larger."""
    return np.abs(found - expected) / np.maximum(np.abs(expected), scale)


def _spread(spec: ParameterSpec, size: int, rng: np.random.Generator) -> np.ndarray:
    if spec.words:
        return rng.choice(spec.words, size)
    low, high = spec.typical
    if spec.vector:
        return rng.uniform(low, high, (size, 3))
    if spec.above is None or low <= 0.0:
        return rng.uniform(low, high, size)
    return np.exp(rng.uniform(np.log(low), np.log(high), size))
