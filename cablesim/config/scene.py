"""Scene files: one question each, read strictly, with everything checked against the solvers before anything runs."""

import hashlib
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from cablesim.config.answer_file import Answer, read_answer
from cablesim.config.check_file import Check, read_checks
from cablesim.config.design_file import Specs, check_values, read_design, read_values
from cablesim.config.document import Node, is_name, read_document
from cablesim.config.figure_file import Figure, read_figures
from cablesim.config.figure_parts import Stage
from cablesim.config.layout_file import PrintedTable, read_printed_tables
from cablesim.config.method import Method
from cablesim.config.precision_file import WorkPrecision, read_work_precision
from cablesim.config.rehearsal import METHOD, Rehearsal
from cablesim.config.table import Table, read_table
from cablesim.design import Design
from cablesim.errors import InputError, nearest
from cablesim.parameters import nearest_parameter
from cablesim.quantities import LONG, component_names, most_sections, quantity, section_number
from cablesim.solver import Solver, load_solver

# What the cells of an audited table are called; the last one may be called otherwise.
AGREES, ROUNDED_KEY, MISPRINT = "agrees", "rounded key", "misprint"
# Words that have a meaning of their own in formulas.
TAKEN = ("table", "method", "status", "and", "or", "not")


@dataclass(frozen=True)
class Published:
    """A printed table and how its columns follow from our outputs: a formula for each column that is to be audited.

    `within` is how many units in the last printed digit still count as agreement; `printed_to` gives the resolution of
    columns that were printed in another form than the table has them (an angle in seconds of arc, say). `off` is what a
    cell is called that is off by more: a misprint, unless the scene knows better.
    """

    table: Table
    columns: dict[str, str]
    within: float
    printed_to: dict[str, float]
    off: str


@dataclass(frozen=True)
class Reference:
    """What errors are taken against: a method of the scene, or columns of a table (formulas by output)."""

    method: str | None = None
    table: Table | None = None
    columns: dict[str, str] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """The method, or the file of the table."""
        return self.method or (self.table.path.name if self.table else "none")


@dataclass(frozen=True)
class Scene:
    """A scene file, read and checked. Words are held by their position, as `parameters` declares them.

    `content` is the digest of all that the file says, but for its answer, which decides nothing that is stored.
    """

    name: str
    path: Path
    content: str
    title: str
    question: str
    answer: Answer | None
    design: Design
    fixed: dict[str, float]
    parameters: Specs
    methods: tuple[Method, ...]
    reference: Reference | None
    outputs: tuple[str, ...]
    checks: tuple[Check, ...]
    published: Published | None
    figures: tuple[Figure, ...]
    printed: tuple[PrintedTable, ...]
    work_precision: WorkPrecision | None
    tables: tuple[Table, ...]

    @property
    def size(self) -> int:
        """Number of scenarios, each solved by every method."""
        return self.design.size

    @cached_property
    def sections(self) -> int:
        """The largest number of sections that a line of the scene has; 0 where no parameter is a list."""
        return most_sections(self.design.parameters | set(self.fixed))

    @cached_property
    def digest(self) -> str:
        """Digest of what the scene file says, but for its answer, and of the tables it names."""
        digest = hashlib.sha256(self.content.encode())
        for table in self.tables:
            digest.update(table.digest.encode())
        return digest.hexdigest()[:16]


def read_scene(path: Path) -> Scene:
    """Read a scene file. Raises InputError naming file, line and key for anything unknown, missing or impossible."""
    if not is_name(path.stem) or path.suffix not in (".yaml", ".yml"):
        raise InputError(f"{path}: a scene file is named like formula_error.yaml (letters, digits, underscores)")
    root = read_document(path)
    required = ("title", "design", "methods", "outputs")
    optional = (
        "question",
        "answer",
        "fixed",
        "checks",
        "reference",
        "published",
        "figures",
        "tables",
        "work_precision",
    )
    keys = root.mapping(required, optional)
    methods = _read_methods(keys["methods"])
    parameters = _parameters(keys["methods"], methods)
    design, tables = read_design(keys["design"], parameters)
    fixed = _read_fixed(keys["fixed"], parameters, design) if "fixed" in keys else {}
    outputs = _read_outputs(keys["outputs"], methods)
    _check_methods(keys["methods"], methods, design, fixed, outputs)
    _check_lists(keys, methods, design, fixed)
    _check_not_given(keys["outputs"], outputs, design.parameters | set(fixed))
    names = Rehearsal(design, fixed, parameters, tuple(method.name for method in methods), outputs)
    checks = read_checks(keys["checks"], names, TAKEN) if "checks" in keys else ()
    names = replace(names, checks=tuple(check.name for check in checks))
    reference = _read_reference(keys["reference"], names) if "reference" in keys else None
    published = _read_published(keys["published"], names) if "published" in keys else None
    precision = _read_precision(keys["work_precision"], names, reference) if "work_precision" in keys else None
    points = published.table if published else reference.table if reference else None
    timed = precision.output if precision else None
    stage = Stage(names, methods, reference.method if reference else None, points, published is not None, timed)
    figures = read_figures(keys["figures"], stage) if "figures" in keys else ()
    printed = read_printed_tables(keys["tables"], names) if "tables" in keys else ()
    flags = (AGREES, ROUNDED_KEY, published.off) if published else ()
    source = points or next((layout.source for layout in printed if layout.source), None) or next(iter(tables), None)
    answer = read_answer(keys["answer"], stage, source, flags) if "answer" in keys else None
    used = [
        *tables,
        *(item.table for item in (reference, published) if item is not None and item.table is not None),
        *(figure.settings["points"].table for figure in figures if figure.settings.get("points")),
        *(layout.source for layout in printed if layout.source is not None),
    ]
    return Scene(
        name=path.stem,
        path=path,
        content=root.digest(without=("answer",)),
        title=keys["title"].text(),
        question=keys["question"].text() if "question" in keys else "",
        answer=answer,
        design=design,
        fixed=fixed,
        parameters=parameters,
        methods=methods,
        reference=reference,
        outputs=outputs,
        checks=checks,
        published=published,
        figures=figures,
        printed=printed,
        work_precision=precision,
        tables=tuple({table.path: table for table in used}.values()),
    )


def _read_methods(node: Node) -> tuple[Method, ...]:
    entries = node.mapping(optional=None)
    if not entries:
        node.fail("at least one method is needed")
    return tuple(_read_method(name, entry) for name, entry in entries.items())


def _read_method(name: str, node: Node) -> Method:
    if not is_name(name) or name in TAKEN:
        node.fail(f"{name!r:.60} cannot name a method (letters, digits, underscores; not {', '.join(TAKEN)})")
    keys = node.mapping(("solver",), ("options", "ignores"))
    solver = keys["solver"].located(load_solver, keys["solver"].text())
    options = (
        {key: entry.value for key, entry in keys["options"].mapping(optional=None).items()} if "options" in keys else {}
    )
    made = keys.get("options", node).located(solver.make_options, options)
    ignores = frozenset(name for entry in _ignored(node) for name in component_names(entry.text()))
    for ignored in sorted(ignores & set(solver.columns)):
        if not _does_without(solver, ignored):
            keys["ignores"].fail(f"{solver.name} has the parameter '{ignored}': it cannot ignore it")
    return Method(name, solver, {option: getattr(made, option) for option in solver.options}, ignores)


def _does_without(solver: Solver, name: str) -> bool:
    """Whether a parameter of a solver, or the one that it stands in for, may be left out and has no default."""
    spec = solver.parameters.get(name)
    return spec is not None and solver.parameters[spec.instead_of or name].otherwise is not None


def _ignored(method: Node) -> list[Node]:
    """The parameters that a method says it ignores."""
    keys = method.mapping(optional=None)
    return keys["ignores"].sequence() if "ignores" in keys else []


def _parameters(node: Node, methods: tuple[Method, ...]) -> Specs:
    parameters: Specs = {}
    for method in methods:
        for name, spec in method.solver.names.items():
            if parameters.setdefault(name, spec).words != spec.words:
                node.fail(f"the methods know different words for {name}")
    return parameters


def _read_fixed(node: Node, parameters: Specs, design: Design) -> dict[str, float]:
    fixed: dict[str, float] = {}
    for name, entry in node.mapping(optional=None).items():
        if name not in parameters:
            entry.fail(f"no method has a parameter '{name}': {nearest_parameter(name, parameters)}")
        columns = read_values([entry], parameters[name])
        for column in columns:
            if column in design.parameters:
                entry.fail(f"'{column}' varies in the design: it cannot be fixed as well")
            if column in fixed:
                entry.fail(f"'{column}' is given twice")
        check_values(entry, parameters[name], columns)
        fixed |= {column: float(values[0]) for column, values in columns.items()}
    return fixed


def _read_outputs(node: Node, methods: tuple[Method, ...]) -> tuple[str, ...]:
    names = []
    for entry in node.sequence():
        name = entry.text()
        if name in names:
            entry.fail(f"the output '{name}' is listed twice")
        for method in methods:
            entry.located(method.solver.check_outputs, (name,), method.made_options)
        names.append(name)
    return tuple(names)


def _read_reference(node: Node, names: Rehearsal) -> Reference:
    if isinstance(node.value, str):
        return Reference(method=node.choice(names.methods))
    keys = node.mapping(("table",), ("columns",))
    table = read_table(keys["table"])
    scalars = [name for name in names.answers if not quantity(name).dims]
    if "columns" in keys:
        columns = {name: entry.text() for name, entry in keys["columns"].mapping(optional=None).items()}
        for name in columns:
            if name not in scalars:
                keys["columns"].fail(f"'{name}' is not an output of this scene: {nearest(name, scalars)}")
    else:
        columns = {name: name for name in table.columns if name in scalars}
    if not columns:
        node.fail("no column of the table is an output of this scene: say which with columns: {output: formula}")
    for output, formula in columns.items():
        node.located(table.evaluate, formula, quantity(output).unit)
    axes = names.design.axes
    rows = axes[0].labels.get("row") if len(axes) == 1 else None
    if rows is None or rows.max() + 1 != table.rows:
        node.fail(f"{table.path}: a reference table needs a design of cases read from a table with the same rows")
    return Reference(table=table, columns=columns)


def _read_precision(node: Node, names: Rehearsal, reference: Reference | None) -> WorkPrecision:
    if reference is None:
        node.fail("an error needs a reference")
    return read_work_precision(node, names, reference.method)


def _read_published(node: Node, names: Rehearsal) -> Published:
    keys = node.mapping(("table", "columns"), ("within", "printed_to", "off"))
    table = read_table(keys["table"])
    rehearsal = replace(names, table=table)
    columns = {}
    for name, entry in _entries(keys["columns"], table).items():
        columns[name] = entry.formula()
        along = entry.located(rehearsal.number, columns[name]) - ({METHOD} if len(names.methods) == 1 else set())
        if along != {axis.name for axis in names.design.axes} or len(along) != 1:
            entry.fail("one value for each row of the table is expected, along the only axis of the scene")
    if not columns:
        keys["columns"].fail("at least one column is needed")
    printed_to = {}
    for name, entry in _entries(keys["printed_to"], table).items() if "printed_to" in keys else ():
        printed_to[name] = _not_negative(entry)
    _check_rows(keys["table"], table, names.design)
    within = _not_negative(keys["within"]) if "within" in keys else 0.5
    return Published(table, columns, within, printed_to, _read_off(keys["off"]) if "off" in keys else MISPRINT)


def _read_off(node: Node) -> str:
    if node.value in (AGREES, ROUNDED_KEY):
        node.fail(f"'{node.value}' is what other cells are called")
    return node.text(40)


def _entries(node: Node, table: Table) -> dict[str, Node]:
    entries = node.mapping(optional=None)
    for name, entry in entries.items():
        if name not in table.columns:
            entry.fail(f"the table has no column '{name}': {nearest(name, table.columns)}")
    return entries


def _check_rows(node: Node, table: Table, design: Design) -> None:
    """Every row must be a scenario: by its number, or by the value of its first column on the scene's axis."""
    axis, head = design.axes[0], next(iter(table.columns))
    if "row" in axis.labels:
        if set(axis.labels["row"].tolist()) != set(range(table.rows)):
            node.fail("the scene's cases come from a table with other rows")
        return
    if head not in axis.columns:
        node.fail(f"its first column, {head}, must be an axis of the scene")
    for row, value in enumerate(table.numbers(head)):
        if value not in axis.columns[head]:
            node.fail(f"row {row + 1}: {head} = {value:g} is not on the axis of the scene")


def _not_negative(node: Node) -> float:
    value = node.number("1")
    if value < 0.0:
        node.fail(f"a number >= 0 is expected, not {value:g}")
    return value


def _check_methods(
    node: Node, methods: tuple[Method, ...], design: Design, fixed: dict[str, float], outputs: tuple[str, ...]
) -> None:
    """Every method must have, or say that it ignores, every parameter; and be given all it needs."""
    given = design.parameters | set(fixed)
    for name in outputs:
        node.located(_check_sizes, name, methods)
    for method in methods:
        place = node.mapping(optional=None)[method.name]
        for entry in _ignored(place):
            if not given & set(component_names(entry.text())):
                entry.fail(f"no scenario has a parameter '{entry.text()}': {nearest(entry.text(), given)}")
        unknown = sorted(given - method.columns - method.ignores)
        if unknown:
            meant = f"say 'ignores: [{', '.join(unknown)}]' if that is meant"
            place.fail(f"{method.solver.name} has no parameter '{unknown[0]}': {meant}")
        place.located(method.solver.check_columns, given & method.columns)
        _check_bounds(place, method, design, fixed)


def _check_sizes(output: str, methods: tuple[Method, ...]) -> None:
    """A profile or history must be as long in all methods."""
    for dim in sorted(LONG & set(quantity(output).dims)):
        lengths = [method.sizes.get(dim, 0) for method in methods]
        if len(set(lengths)) > 1:
            found = ", ".join(f"{method.name} {length}" for method, length in zip(methods, lengths, strict=True))
            raise InputError(f"all methods must have the same number of {dim}s in {output}, not {found}")


def _check_bounds(node: Node, method: Method, design: Design, fixed: dict[str, float]) -> None:
    """Methods may declare different bounds for one parameter: each must allow all values."""
    values = {name: np.array([value]) for name, value in fixed.items()}
    for axis in design.axes:
        values |= axis.columns
    for name in method.columns & values.keys():
        node.located(method.solver.columns[name].check, values[name])


def _check_lists(keys: dict[str, Node], methods: tuple[Method, ...], design: Design, fixed: dict[str, float]) -> None:
    """The lists of every line must be whole, and as long as each other.

    Along other axes than the first no length differs: cases are the only axis, and one of a grid has every value.
    """
    first, *others = design.axes
    values = {name: np.array([value]) for name, value in fixed.items()}
    values |= {name: column[:1] for axis in others for name, column in axis.columns.items()} | first.columns
    node = keys["design"] if any(map(section_number, design.parameters)) else keys.get("fixed", keys["design"])
    for method in methods:
        node.located(method.solver.check_lists, {name: values[name] for name in method.columns & values.keys()})


def _check_not_given(node: Node, outputs: tuple[str, ...], given: set[str]) -> None:
    for entry, output in zip(node.sequence(), outputs, strict=True):
        if given & set(component_names(output)):
            entry.fail(f"'{output}' is a given parameter of this scene, which the dataset has anyway: leave it out")
