"""Scene files: one question each, read strictly, with everything checked against the solvers before anything runs."""

import hashlib
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from cablesim.config.design_file import read_design
from cablesim.config.document import Node, is_name, read_document
from cablesim.config.table import Table, read_table
from cablesim.design import Design
from cablesim.errors import InputError, nearest
from cablesim.expressions import parse
from cablesim.solver import ParameterSpec, Solver, check_given, load_solver

FIGURE_KINDS = ("curves", "map", "profiles", "audit")


@dataclass(frozen=True)
class Method:
    """A named solver with its options; `ignores` are the design's parameters that it has no use for."""

    name: str
    solver: Solver
    options: dict[str, Any]
    ignores: frozenset[str]

    @property
    def parameters(self) -> set[str]:
        return set(self.solver.parameters)


@dataclass(frozen=True)
class Published:
    """A printed table and how its columns follow from our outputs: a formula for each column that is to be audited.

    `within` is how many units in the last printed digit still count as agreement; `printed_to` gives the resolution of
    columns that were printed in another form than the table has them (an angle in seconds of arc, say).
    """

    table: Table
    columns: dict[str, str]
    within: float
    printed_to: dict[str, float]


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
class Figure:
    """What a picture shows; the settings were checked for their kind."""

    name: str
    kind: str
    settings: dict[str, Any]


@dataclass(frozen=True)
class Scene:
    """A scene file, read and checked."""

    name: str
    path: Path
    title: str
    question: str
    design: Design
    fixed: dict[str, float]
    methods: tuple[Method, ...]
    reference: Reference | None
    outputs: tuple[str, ...]
    published: Published | None
    figures: tuple[Figure, ...]
    tables: tuple[Table, ...]

    @property
    def size(self) -> int:
        """Number of scenarios, each solved by every method."""
        return self.design.size

    @cached_property
    def digest(self) -> str:
        """Digest of the scene file and the tables it names."""
        digest = hashlib.sha256(self.path.read_bytes())
        for table in self.tables:
            digest.update(table.digest.encode())
        return digest.hexdigest()[:16]


def read_scene(path: Path) -> Scene:
    """Read a scene file. Raises InputError naming file, line and key for anything unknown, missing or impossible."""
    if not is_name(path.stem) or path.suffix not in (".yaml", ".yml"):
        raise InputError(f"{path}: a scene file is named like formula_error.yaml (letters, digits, underscores)")
    root = read_document(path)
    required = ("title", "design", "methods", "outputs")
    keys = root.mapping(required, ("question", "fixed", "reference", "published", "figures"))
    methods = _read_methods(keys["methods"])
    parameters = _parameters(methods)
    design, tables = read_design(keys["design"], parameters)
    fixed = _read_fixed(keys["fixed"], parameters, design) if "fixed" in keys else {}
    outputs = _read_outputs(keys["outputs"], methods)
    reference = _read_reference(keys["reference"], methods, outputs) if "reference" in keys else None
    published = _read_published(keys["published"]) if "published" in keys else None
    figures = _read_figures(keys["figures"], outputs) if "figures" in keys else ()
    _check_methods(keys["methods"], methods, design, fixed)
    used = [*tables, *(item.table for item in (reference, published) if item is not None and item.table is not None)]
    return Scene(
        name=path.stem,
        path=path,
        title=keys["title"].text(),
        question=keys["question"].text() if "question" in keys else "",
        design=design,
        fixed=fixed,
        methods=methods,
        reference=reference,
        outputs=outputs,
        published=published,
        figures=figures,
        tables=tuple({table.path: table for table in used}.values()),
    )


def _read_methods(node: Node) -> tuple[Method, ...]:
    entries = node.mapping(optional=None)
    if not entries:
        node.fail("at least one method is needed")
    return tuple(_read_method(name, entry) for name, entry in entries.items())


def _read_method(name: str, node: Node) -> Method:
    if not is_name(name):
        node.fail(f"{name!r:.60} is not a name (letters, digits, underscores; starting with a letter)")
    keys = node.mapping(("solver",), ("options", "ignores"))
    solver = located(keys["solver"], load_solver, keys["solver"].text())
    options = (
        {key: entry.value for key, entry in keys["options"].mapping(optional=None).items()} if "options" in keys else {}
    )
    made = located(keys.get("options", node), solver.make_options, options)
    ignores = frozenset(entry.text() for entry in keys["ignores"].sequence()) if "ignores" in keys else frozenset()
    for ignored in ignores & set(solver.parameters):
        keys["ignores"].fail(f"{solver.name} has the parameter '{ignored}': it cannot ignore it")
    return Method(name, solver, {option: getattr(made, option) for option in solver.options}, ignores)


def _parameters(methods: tuple[Method, ...]) -> dict[str, ParameterSpec]:
    return {name: spec for method in methods for name, spec in method.solver.parameters.items()}


def _read_fixed(node: Node, parameters: dict[str, ParameterSpec], design: Design) -> dict[str, float]:
    fixed = {}
    for name, entry in node.mapping(optional=None).items():
        if name not in parameters:
            entry.fail(f"no method has a parameter '{name}': {nearest(name, parameters)}")
        if name in design.parameters:
            entry.fail(f"'{name}' varies in the design: it cannot be fixed as well")
        fixed[name] = entry.number(parameters[name].unit)
        located(entry, parameters[name].check, np.array([fixed[name]]))
    return fixed


def _read_outputs(node: Node, methods: tuple[Method, ...]) -> tuple[str, ...]:
    names = []
    for entry in node.sequence():
        name = entry.text()
        if name in names:
            entry.fail(f"the output '{name}' is listed twice")
        for method in methods:
            located(entry, method.solver.check_outputs, (name,))
        names.append(name)
    return tuple(names)


def _read_reference(node: Node, methods: tuple[Method, ...], outputs: tuple[str, ...]) -> Reference:
    if isinstance(node.value, str):
        return Reference(method=node.choice(tuple(method.name for method in methods)))
    keys = node.mapping(("table",), ("columns",))
    table = read_table(keys["table"])
    if "columns" in keys:
        columns = {name: entry.text() for name, entry in keys["columns"].mapping(optional=None).items()}
        for name in columns:
            if name not in outputs:
                keys["columns"].fail(f"'{name}' is not an output of this scene: {nearest(name, outputs)}")
    else:
        columns = {name: name for name in table.columns if name in outputs}
    if not columns:
        node.fail("no column of the table is an output of this scene: say which with columns: {output: formula}")
    for formula in columns.values():
        located(node, table.evaluate, formula)
    return Reference(table=table, columns=columns)


def _read_published(node: Node) -> Published:
    keys = node.mapping(("table", "columns"), ("within", "printed_to"))
    table = read_table(keys["table"])
    columns = {name: _formula(entry) for name, entry in keys["columns"].mapping(optional=None).items()}
    printed_to = {}
    for part in ("columns", "printed_to"):
        for name, entry in keys[part].mapping(optional=None).items() if part in keys else ():
            if name not in table.columns:
                entry.fail(f"the table has no column '{name}': {nearest(name, table.columns)}")
            if part == "printed_to":
                printed_to[name] = entry.number("1")
    within = keys["within"].number("1") if "within" in keys else 0.5
    return Published(table, columns, within, printed_to)


def _read_figures(node: Node, outputs: tuple[str, ...]) -> tuple[Figure, ...]:
    figures = []
    for name, entry in node.mapping(optional=None).items():
        if not is_name(name):
            entry.fail(f"{name!r:.60} is not a name (letters, digits, underscores; starting with a letter)")
        kind = entry.mapping(("kind",), None)["kind"].choice(FIGURE_KINDS)
        figures.append(Figure(name, kind, _FIGURE_READERS[kind](entry)))
        if kind == "profiles" and "profile" not in outputs:
            entry.fail("a figure of profiles needs the output 'profile'")
    return tuple(figures)


def _read_curves(node: Node) -> dict[str, Any]:
    keys = node.mapping(("kind", "x", "y"), ("where", "points", "log", "x_label", "y_label", "each"))
    lines = keys["y"].mapping(optional=None) if isinstance(keys["y"].value, dict) else {"": keys["y"]}
    settings: dict[str, Any] = {
        "x": _formula(keys["x"]),
        "y": {name: _formula(entry) for name, entry in lines.items()},
        "log": keys["log"].choice(("x", "y", "xy")) if "log" in keys else "",
        "points": {},
    }
    if "points" in keys:
        settings["points"] = {name: entry.text() for name, entry in keys["points"].mapping(("x",), None).items()}
    return settings | _texts(keys, ("x_label", "y_label", "each")) | _condition(keys)


def _read_map(node: Node) -> dict[str, Any]:
    keys = node.mapping(("kind", "x", "y", "value"), ("log", "label", "where"))
    settings = {name: _formula(keys[name]) for name in ("x", "y", "value")}
    settings["log"] = (
        keys["log"].choice(("x", "y", "xy", "value", "x value", "y value", "xy value")) if "log" in keys else ""
    )
    return settings | _texts(keys, ("label",)) | _condition(keys)


def _read_profiles(node: Node) -> dict[str, Any]:
    keys = node.mapping(("kind",), ("at",))
    at = (
        {name: [item.value for item in entry.sequence()] for name, entry in keys["at"].mapping(optional=None).items()}
        if "at" in keys
        else {}
    )
    return {"at": at}


def _read_audit(node: Node) -> dict[str, Any]:
    node.mapping(("kind",))
    return {}


_FIGURE_READERS = {"curves": _read_curves, "map": _read_map, "profiles": _read_profiles, "audit": _read_audit}


def _texts(keys: dict[str, Node], names: tuple[str, ...]) -> dict[str, str]:
    return {name: keys[name].text() for name in names if name in keys}


def _condition(keys: dict[str, Node]) -> dict[str, str]:
    return {"where": _formula(keys["where"])} if "where" in keys else {}


def _formula(node: Node) -> str:
    text = str(node.value) if isinstance(node.value, int | float) else node.text()
    located(node, parse, text)
    return text


def _check_methods(node: Node, methods: tuple[Method, ...], design: Design, fixed: dict[str, float]) -> None:
    """Every method must have, or say that it ignores, every parameter; and be given all it needs."""
    given = design.parameters | set(fixed)
    for method in methods:
        place = node.mapping(optional=None)[method.name]
        for name in sorted(given - method.parameters - method.ignores):
            place.fail(f"{method.solver.name} has no parameter '{name}': say 'ignores: [{name}]' if that is meant")
        located(place, check_given, method.solver.module.Parameters, given & method.parameters)


def located(node: Node, check: Any, *arguments: Any) -> Any:
    """Call something that knows nothing of files; its InputError gets the place of the value."""
    try:
        return check(*arguments)
    except InputError as problem:
        node.fail(str(problem))
