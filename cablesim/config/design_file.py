"""The `design` part of a scene file: a grid, a list of cases or a sample, turned into axes in SI."""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from cablesim import units
from cablesim.config.document import Node
from cablesim.config.table import Table, read_table
from cablesim.design import SCENARIO, Axis, Design
from cablesim.errors import InputError, nearest
from cablesim.numerics import Array
from cablesim.parameters import ParameterSpec, nearest_parameter
from cablesim.quantities import COMPONENTS, MOST_SECTIONS, component_names

MOST_SCENARIOS = 200_000_000
# Generated axis values are rounded to this many significant digits, so that 1.01 means 1.01 and not its neighbour.
AXIS_DIGITS = 12

# Parameters by every name that they, or their components, may be given by.
Specs = dict[str, ParameterSpec]
Columns = dict[str, Array]


def read_design(node: Node, parameters: Specs) -> tuple[Design, tuple[Table, ...]]:
    """The design and the tables it was read from."""
    keys = node.mapping(optional=("grid", "cases", "sample"))
    if len(keys) != 1:
        node.fail("exactly one of grid, cases and sample is expected")
    kind, entry = next(iter(keys.items()))
    readers = {"grid": _read_grid, "cases": _read_cases, "sample": _read_sample}
    axes, tables, seed = readers[kind](entry, parameters)
    _check_size(entry, math.prod(axis.size for axis in axes))
    return Design(kind, axes, seed), tables


def _read_grid(node: Node, parameters: Specs) -> tuple[tuple[Axis, ...], tuple[Table, ...], None]:
    entries = node.mapping(optional=None)
    if not entries:
        node.fail("the grid is empty: at least one axis is needed")
    _check_size(node, math.prod(_length(entry) for entry in entries.values()))
    axes: list[Axis] = []
    for name, entry in entries.items():
        columns = _read_axis(entry, _spec(entry, name, parameters))
        for axis in axes:
            _check_new(entry, columns, axis.columns)
        axes.append(Axis(name, columns))
    return tuple(axes), (), None


def _check_new(node: Node, columns: Columns, others: Columns) -> None:
    for name in columns.keys() & others.keys():
        node.fail(f"'{name}' is given twice")


def _length(node: Node) -> int:
    """How many values an axis will have, as far as it can be told before they are made."""
    if isinstance(node.value, list):
        return len(node.value)
    num = node.value.get("num") if isinstance(node.value, dict) else None
    return num if isinstance(num, int) and num > 0 else 1


def _check_size(node: Node, size: int) -> None:
    if size > MOST_SCENARIOS:
        node.fail(f"{size} scenarios are too many: at most {MOST_SCENARIOS}")


def read_values(nodes: list[Node], spec: ParameterSpec) -> Columns:
    """The values of a parameter, one a node, as the columns that a design holds."""
    if spec.listed:
        return _read_lists(nodes, spec)
    points = np.array([_read_value(node, spec) for node in nodes])
    return {column.name: values for column, values in zip(spec.columns, points.T.copy(), strict=True)}


def _read_value(node: Node, spec: ParameterSpec) -> tuple[float, ...]:
    if spec.words:
        return (spec.stored(node.choice(spec.words)),)
    if not spec.vector:
        return (node.number(spec.unit),)
    entries = node.sequence()
    if len(entries) != len(COMPONENTS):
        node.fail(f"{spec.name} has three components ({', '.join(COMPONENTS)}), not {len(entries)}")
    return tuple(entry.number(spec.unit) for entry in entries)


def _read_lists(nodes: list[Node], spec: ParameterSpec) -> Columns:
    """A column for each section, NaN where a list has ended."""
    for node in nodes:
        if len(node.sequence()) > MOST_SECTIONS:
            node.fail(f"{len(node.sequence())} sections are too many: at most {MOST_SECTIONS}")
    lists = spec.read([[entry.number(spec.unit) for entry in node.sequence()] for node in nodes])
    return {column.name: values for column, values in zip(spec.columns, lists.T.copy(), strict=False)}


def check_values(node: Node, spec: ParameterSpec, columns: Columns) -> None:
    """Raises InputError, with the place, unless every column of a parameter is within its bounds."""
    for column in spec.columns:
        if column.name in columns:
            node.located(column.check, columns[column.name])


def _read_axis(node: Node, spec: ParameterSpec) -> Columns:
    if spec.listed:
        node.fail(f"an axis has no whole lists: vary one section, as {spec.name}_2, or give the lists as cases")
    if isinstance(node.value, list):
        columns = read_values(node.sequence(), spec)
    elif spec.words or spec.vector:
        node.fail(f"a list of {'words' if spec.words else 'vectors'} is expected")
    else:
        columns = {spec.name: _spaced(node, spec)}
    check_values(node, spec, columns)
    _check_different(node, spec, np.column_stack(list(columns.values())))
    return columns


def _spaced(node: Node, spec: ParameterSpec) -> Array:
    keys = node.mapping(("start", "stop", "num"), ("spacing", "origin", "also"))
    num = keys["num"].whole(2, 100_000_000)
    start, stop, origin, logarithmic = _read_range(node, keys, spec)
    spaced = np.geomspace if logarithmic else np.linspace
    scale = _scale(keys, spec)
    values = origin + scale * _rounded(spaced((start - origin) / scale, (stop - origin) / scale, num))
    if "also" in keys:
        extra = np.array([entry.number(spec.unit) for entry in keys["also"].sequence()])
        values = np.unique(np.concatenate([values, extra]))
    return values


def _scale(keys: dict[str, Node], spec: ParameterSpec) -> float:
    """What the values are rounded in: the unit that start and stop are written in, so that 30 deg is 30 deg."""
    written = {units.unit_of(keys[name].value) for name in ("start", "stop")}
    return units.factor(written.pop(), spec.unit) if len(written) == 1 and units.BARE not in written else 1.0


def _read_range(node: Node, keys: dict[str, Node], spec: ParameterSpec) -> tuple[float, float, float, bool]:
    """Start, stop, origin, and whether the distance from the origin is spaced logarithmically."""
    start, stop = keys["start"].number(spec.unit), keys["stop"].number(spec.unit)
    origin = keys["origin"].number(spec.unit) if "origin" in keys else 0.0
    logarithmic = "spacing" in keys and keys["spacing"].choice(("linear", "log")) == "log"
    if not start < stop:
        node.fail(f"start must be less than stop, not {start:g} and {stop:g} {spec.unit}")
    if logarithmic and not start > origin:
        node.fail(f"logarithmic spacing needs start > {origin:g}, not {start:g}")
    return start, stop, origin, logarithmic


def _rounded(values: Array) -> Array:
    scale = 10.0 ** (AXIS_DIGITS - 1 - np.floor(np.log10(np.maximum(np.abs(values), 1e-280))))
    return np.round(values * scale) / scale


def _check_different(node: Node, spec: ParameterSpec, points: Array) -> None:
    ordered = points[np.lexsort(points.T)]
    repeated = (ordered[1:] == ordered[:-1]).all(axis=1)
    if repeated.any():
        point = ordered[int(np.argmax(repeated))]
        shown = spec.words[int(point[0])] if spec.words else ", ".join(f"{value:.17g}" for value in point)
        node.fail(f"the value {shown} appears {int((points == point).all(axis=1).sum())} times")


def _read_cases(node: Node, parameters: Specs) -> tuple[tuple[Axis, ...], tuple[Table, ...], None]:
    if isinstance(node.value, dict):
        return _read_case_table(node, parameters)
    rows = [entry.mapping(optional=None) for entry in node.sequence()]
    names = list(rows[0])
    if not names:
        node.fail("a case needs at least one parameter")
    columns: Columns = {}
    for name in names:
        spec = _spec(rows[0][name], name, parameters)
        for entry, row in zip(node.sequence(), rows, strict=True):
            if set(row) != set(names):
                entry.fail(f"every case must have the same parameters: {', '.join(names)}")
        found = read_values([row[name] for row in rows], spec)
        check_values(node, spec, found)
        _check_new(node, found, columns)
        columns |= found
    return (Axis(SCENARIO, columns),), (), None


def _read_case_table(node: Node, parameters: Specs) -> tuple[tuple[Axis, ...], tuple[Table, ...], None]:
    """One scenario a row; or, with `keys`, one for each way to read the row.

    A key is taken at its printed value and at both ends of the rounding of its last digit.
    """
    keys = node.mapping(("table",), ("columns", "keys"))
    if "keys" in keys and "columns" in keys:
        node.fail("either columns or keys is expected, not both")
    table = read_table(keys["table"])
    try:
        if "keys" in keys:
            axis = _keyed_axis(keys["keys"], table, parameters)
        else:
            axis = _table_axis(keys.get("columns"), node, table, parameters)
    except InputError as problem:
        if str(problem).startswith(node.file):
            raise
        node.fail(str(problem))
    return (axis,), (table,), None


def _table_axis(columns: Node | None, node: Node, table: Table, parameters: Specs) -> Axis:
    formulas = columns.mapping(optional=None) if columns else {}
    names = list(formulas) or list(table.columns)
    values = {}
    for name in names:
        place = formulas.get(name, node)
        spec = _column_spec(place, name, parameters)
        values[name] = _from_table(table, formulas[name].formula() if name in formulas else name, spec)
        place.located(spec.check, values[name])
    return Axis(SCENARIO, values, {"row": np.arange(table.rows)})


def _from_table(table: Table, formula: str, spec: ParameterSpec) -> Array:
    """A parameter for every row: a formula over the columns, or a word: the column of that name, or the word itself."""
    if not spec.words:
        return table.evaluate(formula, spec.unit)
    texts = table.columns.get(formula, (formula,) * table.rows)
    for row, text in enumerate(texts):
        if text not in spec.words:
            raise InputError(f"{table.path}: row {row + 1}: unknown value {text!r:.60}: {nearest(text, spec.words)}")
    return np.array([spec.stored(text) for text in texts])


def _keyed_axis(node: Node, table: Table, parameters: Specs) -> Axis:
    if not node.mapping(optional=None):
        node.fail("at least one key is needed")
    values: dict[str, list[Array]] = {}
    labels: dict[str, list[np.ndarray]] = {"row": [], "key": [], "rounding": []}
    for key, entry in node.mapping(optional=None).items():
        if key not in table.columns:
            entry.fail(f"the table has no column '{key}': {nearest(key, table.columns)}")
        formulas = {name: formula.formula() for name, formula in entry.mapping(optional=None).items()}
        if not formulas or (values and set(formulas) != set(values)):
            given = ", ".join(formulas) or "none"
            entry.fail(f"every key must give the same parameters, at least one; this one gives {given}")
        for rounding, shift in ROUNDINGS.items():
            moved = shifted(table, key, shift)
            for name, formula in formulas.items():
                spec = _column_spec(entry, name, parameters)
                values.setdefault(name, []).append(_from_table(moved, formula, spec))
                entry.located(spec.check, values[name][-1])
            labels["row"].append(np.arange(table.rows))
            labels["key"].append(np.full(table.rows, key))
            labels["rounding"].append(np.full(table.rows, rounding))
    columns, words = ({name: np.concatenate(v) for name, v in parts.items()} for parts in (values, labels))
    return Axis(SCENARIO, columns, words)


# A printed number stands for any number within half a unit of its last digit.
ROUNDINGS = {"printed": 0.0, "down": -0.5, "up": 0.5}


def shifted(table: Table, column: str, digits: float) -> Table:
    """The table with the printed values of one column moved by some units of their last digit."""
    cells = table.columns[column]
    moved = tuple(repr(float(c) + digits * float(u)) if c else c for c, u in zip(cells, last_digit(cells), strict=True))
    return replace(table, columns={**table.columns, column: moved})


def last_digit(cells: tuple[str, ...]) -> Array:
    """One unit in the last printed digit of each cell: 0.01 for "2.50"."""
    return np.array([10.0 ** -len(cell.split(".")[1]) if "." in cell else 1.0 for cell in cells])


def _read_sample(node: Node, parameters: Specs) -> tuple[tuple[Axis, ...], tuple[Table, ...], int]:
    """Quasi-random or Latin hypercube points in a box; `spacing: log` samples the logarithm."""
    from scipy.stats import qmc

    keys = node.mapping(("method", "num", "seed", "ranges"))
    method = keys["method"].choice(("sobol", "latin_hypercube"))
    num, seed = keys["num"].whole(1, MOST_SCENARIOS), keys["seed"].whole(0, 2**32 - 1)
    ranges = keys["ranges"].mapping(optional=None)
    if not ranges:
        keys["ranges"].fail("at least one parameter is needed")
    engines: dict[str, Any] = {"sobol": qmc.Sobol, "latin_hypercube": qmc.LatinHypercube}
    engine = engines[method](len(ranges), rng=np.random.default_rng(seed))
    # Sobol's sequence is balanced in powers of two; its first `num` points are taken.
    drawn = 2 ** math.ceil(math.log2(num)) if method == "sobol" else num
    points = engine.random(drawn)[:num]
    columns = {}
    for (name, entry), unit_values in zip(ranges.items(), points.T, strict=True):
        spec = _column_spec(entry, name, parameters)
        if spec.words:
            entry.fail("a word has no range: vary it along an axis of a grid, or among cases")
        columns[name] = _stretch(entry, spec, unit_values)
        entry.located(spec.check, columns[name])
    return (Axis(SCENARIO, columns),), (), seed


def _stretch(node: Node, spec: ParameterSpec, unit_values: Array) -> Array:
    keys = node.mapping(("start", "stop"), ("spacing", "origin"))
    start, stop, origin, logarithmic = _read_range(node, keys, spec)
    if not logarithmic:
        return start + (stop - start) * unit_values
    return origin + (start - origin) * ((stop - origin) / (start - origin)) ** unit_values


def _spec(node: Node, name: str, parameters: Specs) -> ParameterSpec:
    if name not in parameters:
        node.fail(f"no method has a parameter '{name}': {nearest_parameter(name, parameters)}")
    return parameters[name]


def _column_spec(node: Node, name: str, parameters: Specs) -> ParameterSpec:
    """A parameter that is one column; a vector is asked for its components, a list for its sections."""
    spec = _spec(node, name, parameters)
    if spec.listed:
        node.fail(f"'{name}' is a list: give {', '.join(component_names(name, 2))}, ...")
    if spec.vector:
        node.fail(f"'{name}' is a vector: give {', '.join(component_names(name))}")
    return spec
