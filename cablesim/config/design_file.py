"""The `design` part of a scene file: a grid, a list of cases or a sample, turned into axes in SI."""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from cablesim.config.document import Node
from cablesim.config.table import Table, read_table
from cablesim.design import SCENARIO, Axis, Design
from cablesim.errors import InputError, nearest
from cablesim.numerics import Array
from cablesim.parameters import ParameterSpec

MOST_SCENARIOS = 200_000_000
# Generated axis values are rounded to this many significant digits, so that 1.01 means 1.01 and not its neighbour.
AXIS_DIGITS = 12

Specs = dict[str, ParameterSpec]


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
    axes = []
    for name, entry in entries.items():
        values = _read_axis(entry, _spec(entry, name, parameters))
        axes.append(Axis(name, {name: values}))
    return tuple(axes), (), None


def _length(node: Node) -> int:
    """How many values an axis will have, as far as it can be told before they are made."""
    if isinstance(node.value, list):
        return len(node.value)
    num = node.value.get("num") if isinstance(node.value, dict) else None
    return num if isinstance(num, int) and num > 0 else 1


def _check_size(node: Node, size: int) -> None:
    if size > MOST_SCENARIOS:
        node.fail(f"{size} scenarios are too many: at most {MOST_SCENARIOS}")


def _read_axis(node: Node, spec: ParameterSpec) -> Array:
    if isinstance(node.value, list):
        entries = node.sequence()
        values = np.array([entry.number(spec.unit) for entry in entries])
        _check_axis(node, spec, values)
        return values
    keys = node.mapping(("start", "stop", "num"), ("spacing", "origin", "also"))
    num = keys["num"].whole(2, 100_000_000)
    start, stop, origin, logarithmic = _read_range(node, keys, spec)
    spaced = np.geomspace if logarithmic else np.linspace
    values = origin + _rounded(spaced(start - origin, stop - origin, num))
    if "also" in keys:
        extra = np.array([entry.number(spec.unit) for entry in keys["also"].sequence()])
        values = np.unique(np.concatenate([values, extra]))
    _check_axis(node, spec, values)
    return values


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


def _check_axis(node: Node, spec: ParameterSpec, values: Array) -> None:
    node.located(spec.check, values)
    unique, counts = np.unique(values, return_counts=True)
    if unique.size < values.size:
        node.fail(f"the value {unique[np.argmax(counts > 1)]:.17g} appears {counts.max()} times")


def _read_cases(node: Node, parameters: Specs) -> tuple[tuple[Axis, ...], tuple[Table, ...], None]:
    if isinstance(node.value, dict):
        return _read_case_table(node, parameters)
    rows = [entry.mapping(optional=None) for entry in node.sequence()]
    names = list(rows[0])
    if not names:
        node.fail("a case needs at least one parameter")
    columns: dict[str, Array] = {}
    for name in names:
        spec = _spec(rows[0][name], name, parameters)
        for entry, row in zip(node.sequence(), rows, strict=True):
            if set(row) != set(names):
                entry.fail(f"every case must have the same parameters: {', '.join(names)}")
        columns[name] = np.array([row[name].number(spec.unit) for row in rows])
        node.located(spec.check, columns[name])
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
        spec = _spec(place, name, parameters)
        values[name] = table.evaluate(formulas[name].formula() if name in formulas else name, spec.unit)
        place.located(spec.check, values[name])
    return Axis(SCENARIO, values, {"row": np.arange(table.rows)})


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
                spec = _spec(entry, name, parameters)
                values.setdefault(name, []).append(moved.evaluate(formula, spec.unit))
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
        spec = _spec(entry, name, parameters)
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
        node.fail(f"no method has a parameter '{name}': {nearest(name, parameters)}")
    return parameters[name]
