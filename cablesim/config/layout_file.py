"""The `tables` part of a scene file: printed tables, as a book or a ship's officer has them."""

import re
from dataclasses import dataclass, field, replace

import numpy as np

from cablesim import units
from cablesim.config.document import Node
from cablesim.config.place_file import Wish, positions, read_point
from cablesim.config.rehearsal import METHOD, Rehearsal
from cablesim.config.table import Table, read_table
from cablesim.design import SCENARIO, Axis
from cablesim.errors import nearest
from cablesim.quantities import QUANTITIES, quantity

# Names of the tables that every scene has.
TAKEN = (
    "errors", "tensions", "values", "status", "effort", "checks", "orders", "audit", "work_precision", "fastest",
    "answer",
)  # fmt: skip
DIGITS = 6
MOST_DIGITS = 15
AS_IT_STANDS = re.compile(r"\s*(?:\w+\.)?(\w+)\s*")


@dataclass(frozen=True)
class PrintedTable:
    """A page for each point of `pages`, a line for each value of `rows`, a column for each formula.

    Rows without an answer are left out, and those for which `where` does not hold.
    With `across`, each column is repeated for every value of one more parameter. `position` fixes the axes of which the
    table shows one point only; `units` are those that it is printed in, where they are not SI. Columns have `decimals`,
    or else `digits`; parameters are called by their `words`, or else by their names. Where the lines are named by a
    column of the `source` of the cases, `names` is that column.
    """

    name: str
    rows: str
    columns: dict[str, str]
    pages: tuple[str, ...]
    across: str | None
    digits: int
    where: str | None = None
    position: dict[str, int] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    decimals: dict[str, int] = field(default_factory=dict)
    words: dict[str, str] = field(default_factory=dict)
    source: Table | None = None
    names: str | None = None

    @property
    def heads(self) -> tuple[str, ...]:
        """The parameters that name a cell."""
        return (*self.pages, self.rows, *((self.across,) if self.across else ()))

    def base_unit(self, head: str) -> str | None:
        """The SI unit of a parameter, or of a column that is a quantity as it stands."""
        meant = AS_IT_STANDS.fullmatch(self.columns.get(head, head))
        return quantity(meant[1]).unit if meant and meant[1] in QUANTITIES else None

    def unit(self, head: str) -> str:
        """The unit in which it is printed; none for a plain number or a formula."""
        unit = self.units.get(head, self.base_unit(head))
        return "" if unit in (None, "1") else str(unit)


def read_printed_tables(node: Node, names: Rehearsal) -> tuple[PrintedTable, ...]:
    """The printed tables of a scene. Raises InputError naming file, line and key for what cannot be printed."""
    tables = []
    for name, entry in node.named_entries().items():
        if name in TAKEN:
            entry.fail(f"every scene has a table '{name}' of its own: choose another name")
        tables.append(_read_table(name, entry, names))
    return tuple(tables)


def _read_table(name: str, node: Node, names: Rehearsal) -> PrintedTable:
    keys = node.mapping(
        ("rows", "columns"), ("pages", "across", "point", "where", "digits", "decimals", "units", "words", "table")
    )
    source = _read_source(keys["table"], names) if "table" in keys else None
    names = replace(names, table=source)
    varying = (METHOD, *(column for axis in names.design.axes for column in (axis.name, *axis.columns)))
    own_names = tuple(column for column in (source.columns if source else ()) if column not in varying)
    rows = keys["rows"].choice((*varying, *own_names))
    columns = _read_columns(keys["columns"])
    table = PrintedTable(
        name=name,
        rows=SCENARIO if rows in own_names else rows,
        columns=columns,
        pages=tuple(entry.choice(varying) for entry in keys["pages"].sequence()) if "pages" in keys else (),
        across=keys["across"].choice(varying) if "across" in keys else None,
        digits=keys["digits"].whole(1, MOST_DIGITS) if "digits" in keys else DIGITS,
        where=keys["where"].formula() if "where" in keys else None,
        decimals=_read_decimals(keys["decimals"], columns) if "decimals" in keys else {},
        source=source,
        names=rows if rows in own_names else None,
    )
    if len(set(table.heads)) < len(table.heads):
        node.fail("a parameter is named twice among rows, pages and across")
    _check_names(keys["rows"], table)
    _check_cells(keys, table, names)
    return replace(
        table,
        position=_read_position(node, read_point(keys, names), table, names),
        units=_read_units(keys["units"], table, names) if "units" in keys else {},
        words=_read_words(keys["words"], table) if "words" in keys else {},
    )


def _read_source(node: Node, names: Rehearsal) -> Table:
    """The table that the cases of the scene were read from, for its columns to be printed beside ours."""
    source = read_table(node)
    rows = names.design.axes[0].labels.get("row")
    if rows is None or rows.max() + 1 != source.rows:
        node.fail("the scene's cases come from no table with the same rows")
    return source


def _read_decimals(node: Node, columns: dict[str, str]) -> dict[str, int]:
    chosen = {}
    for name, entry in node.mapping(optional=None).items():
        if name not in columns:
            entry.fail(f"this table has no column '{name}': {nearest(name, columns)}")
        chosen[name] = entry.whole(0, MOST_DIGITS)
    return chosen


def _read_words(node: Node, table: PrintedTable) -> dict[str, str]:
    chosen = {}
    for name, entry in node.mapping(optional=None).items():
        if name not in table.heads:
            entry.fail(f"this table has no parameter '{name}': {nearest(name, table.heads)}")
        chosen[name] = entry.text(60)
    return chosen


def _check_names(node: Node, table: PrintedTable) -> None:
    """With columns across, each line is one, so that its name must be its own."""
    if (
        table.across
        and table.source
        and table.names
        and len(set(table.source.columns[table.names])) < table.source.rows
    ):
        node.fail(f"several rows have the same {table.names}: with 'across', each line needs a name of its own")


def _read_columns(node: Node) -> dict[str, str]:
    """A list of outputs, or a formula for each head."""
    if isinstance(node.value, list):
        entries = {entry.text(): entry for entry in node.sequence()}
        if len(entries) < len(node.value):
            node.fail("a column is listed twice")
    else:
        entries = node.mapping(optional=None)
    if not entries:
        node.fail("at least one column is needed")
    return {head: entry.formula() for head, entry in entries.items()}


def _check_cells(keys: dict[str, Node], table: PrintedTable, names: Rehearsal) -> None:
    """Every formula must have one value for a cell."""
    for formula in table.columns.values():
        _check_dims(keys["columns"], keys["columns"].located(names.number, formula), table, names)
    if table.where is not None:
        _check_dims(keys["where"], keys["where"].located(names.condition, table.where), table, names)


def _check_dims(node: Node, along: set[str], table: PrintedTable, names: Rehearsal) -> None:
    if METHOD in along and len(names.methods) > 1 and METHOD not in table.heads:
        node.fail("which method? choose one, as in method.output, or have a row for each")
    for dim in along - {METHOD} - {axis.name for axis in names.design.axes}:
        node.fail(f"a cell has one value, this has many along {dim}")


def _read_position(node: Node, wishes: list[Wish], table: PrintedTable, names: Rehearsal) -> dict[str, int]:
    """Where the axes stand that the table does not run along. Every cell must be one scenario."""
    found = {}
    for axis in names.design.axes:
        shown = [head for head in table.heads if head == axis.name or head in axis.columns]
        left = positions(wishes, axis)
        if shown and left.size == axis.size:
            _check_distinct(node, axis, shown)
        elif left.size == 1 and not shown:
            found[axis.name] = int(left[0])
        else:
            node.fail(f"{axis.name} must be among rows, pages and across, or have one value under point")
    return found


def _check_distinct(node: Node, axis: Axis, shown: list[str]) -> None:
    if axis.name in shown:
        return
    points = Axis(axis.name, {name: axis.columns[name] for name in shown})
    if np.unique(points.key).size < axis.size:
        node.fail(f"several scenarios have the same {' and '.join(shown)}: name more parameters")


def _read_units(node: Node, table: PrintedTable, names: Rehearsal) -> dict[str, str]:
    words = {name for name, spec in names.parameters.items() if spec.words}
    heads = [head for head in (*table.heads, *table.columns) if head not in words]
    known = {head: unit for head in heads if (unit := table.base_unit(head)) is not None}
    chosen = {}
    for name, entry in node.mapping(optional=None).items():
        if name not in known:
            entry.fail(f"nothing in this table is called '{name}' and has a unit: {nearest(name, known)}")
        chosen[name] = entry.text()
        entry.located(units.factor, chosen[name], known[name])
    return chosen
