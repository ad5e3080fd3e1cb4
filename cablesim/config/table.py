"""CSV tables beside a scene: published values and lists of cases. Lines starting with # say where they come from."""

import csv
import hashlib
import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from cablesim import units
from cablesim.config.document import Node, read_text
from cablesim.errors import InputError, nearest
from cablesim.expressions import BARE, WORDS, Term, UnknownName, parse

LARGEST_TABLE = 200_000_000
_CELL = re.compile(units.NUMBER)
_HEAD = re.compile(r"\s*([A-Za-z_][A-Za-z0-9_]*)\s*(?:\[([^\]]{1,40})\])?\s*")


@dataclass(frozen=True)
class Table:
    """Columns of text as printed; `units` holds the unit of a column whose head names one, as in `span [mm]`."""

    path: Path
    source: str
    columns: dict[str, tuple[str, ...]]
    units: dict[str, str]
    digest: str

    @property
    def rows(self) -> int:
        return len(next(iter(self.columns.values())))

    @cached_property
    def _numbers(self) -> dict[str, np.ndarray]:
        return {}

    def numbers(self, column: str) -> np.ndarray:
        """A column as floats, in SI if its head names a unit; empty cells are NaN.

        Raises InputError for an unknown column or a cell that is no number.
        """
        if column not in self.columns:
            raise InputError(f"{self.path}: no column '{column}': {nearest(column, self.columns)}")
        if column not in self._numbers:
            unit = self.units.get(column)
            scale = units.factor(unit, units.base_unit(unit)) if unit else 1.0
            cells = enumerate(self.columns[column])
            self._numbers[column] = scale * np.array([self._number(column, row, cell) for row, cell in cells])
        return self._numbers[column]

    def words(self, column: str) -> tuple[str, ...]:
        """The different cells of a column that has others than numbers; none for a column of numbers."""
        cells = self.columns[column]
        numeric = all(not cell.strip() or _CELL.fullmatch(cell) for cell in cells)
        return () if numeric else tuple(dict.fromkeys(cells))

    def term(self, column: str, rows: np.ndarray) -> Term:
        """What a column has in some rows: numbers, or words."""
        words = self.words(column) if column in self.columns else ()
        return (
            Term(np.array(self.columns[column])[rows], WORDS, words)
            if words
            else Term(self.numbers(column)[rows], BARE)
        )

    def evaluate(self, formula: str, unit: str = BARE) -> np.ndarray:
        """A formula over the columns, one value a row.

        Raises InputError for an unknown column, or where the columns have units and do not give `unit`.
        """
        expression = parse(formula)
        for name in expression.names:
            self.numbers(name)
        try:
            term = expression.term(self._term, checking=bool(self.units))
        except UnknownName as unknown:
            raise InputError(
                f"{self.path}: no column '{unknown.name}': {nearest(unknown.name, self.columns)}"
            ) from None
        if BARE not in (unit, term.unit) and not units.compatible(unit, term.unit):
            raise InputError(f"{self.path}: '{formula}' is in {term.unit}, a value in {unit} is expected")
        return np.broadcast_to(np.asarray(term.values, dtype=float), (self.rows,)).copy()

    def _term(self, name: str) -> Term:
        unit = self.units.get(name)
        return Term(self.numbers(name), units.base_unit(unit) if unit else BARE)

    def _number(self, column: str, row: int, cell: str) -> float:
        if not cell.strip():
            return float("nan")
        number = float(cell) if _CELL.fullmatch(cell) else None
        if number is None:
            raise InputError(f"{self.path}: row {row + 1}, column '{column}': {cell[:40]!r} is not a number")
        if not np.isfinite(number):
            raise InputError(f"{self.path}: row {row + 1}, column '{column}': {cell[:40]!r} is not a finite number")
        return number


def read_table(node: Node) -> Table:
    """The table that a scene names: a CSV file below the scene's own folder."""
    name = node.text()
    folder = Path(node.file).parent
    path = folder / name
    inside = not Path(name).is_absolute() and ".." not in Path(name).parts
    if not inside or not path.resolve().is_relative_to(folder.resolve()):
        node.fail(f"'{name}' must be a file below the folder of the scene")
    try:
        return _parse(path, read_text(path, LARGEST_TABLE))
    except InputError as problem:
        node.fail(str(problem))


def _parse(path: Path, text: str) -> Table:
    lines = text.splitlines()
    source = " ".join(line.lstrip("# ").strip() for line in lines if line.startswith("#"))
    try:
        rows = [row for row in csv.reader(line for line in lines if not line.startswith("#")) if row]
    except csv.Error as problem:
        raise InputError(f"{path}: not a table that can be read ({problem})") from None
    if len(rows) < 2:
        raise InputError(f"{path}: a head and at least one row are expected")
    heads = [_HEAD.fullmatch(head) for head in rows[0]]
    if not all(heads):
        wrong = next(text for text, head in zip(rows[0], heads, strict=True) if not head)
        raise InputError(f"{path}: the head {wrong[:40]!r} must be a name, or a name and a unit such as 'span [mm]'")
    names = [head[1] for head in heads if head]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"{path}: the column '{name}' appears twice")
    for number, row in enumerate(rows[1:], start=1):
        if len(row) != len(names):
            raise InputError(f"{path}: row {number} has {len(row)} cells, the head {len(names)}")
    columns = {
        name: tuple(cell.strip() for cell in cells)
        for name, cells in zip(names, zip(*rows[1:], strict=True), strict=True)
    }
    given = {head[1]: head[2] for head in heads if head and head[2]}
    for name, unit in given.items():
        if not units.is_known(unit):
            raise InputError(f"{path}: column '{name}': unknown unit '{unit}'")
    return Table(path, source, columns, given, hashlib.sha256(text.encode()).hexdigest()[:16])
