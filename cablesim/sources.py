"""The sources that decide what a solver or a step of the workflow makes, as a digest that names it."""

import ast
import hashlib
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from cablesim.solver import PACKAGE, installed, load_solver, source

# Where a solver's numbers come from.
NUMBERS = ("physics", "numerics", "solvers", "peers")
# Where what the steps write of them comes from.
STEP_PARTS = ("database", "report", "reductions", "expressions", "units", "quantities", "labels", "status")
# Where scene files are read, but what axes are called is said.
LABELS = (
    "config/axis_labels",
    "config/figure_file",
    "config/history_figure",
    "config/orbit_figure",
    "config/snapshot_figure",
    "config/status_figure",
)


def source_digest(name: str) -> str:
    """Digest of everything that decides a solver's numbers: its module and what it imports of physics and numerics.

    Results are named by it, so editing a solver reruns what it solved and nothing else. That of a peer tells which
    version of its program is installed as well, or that none is.
    """
    code = code_digest((source(name).relative_to(PACKAGE).with_suffix("").as_posix(),), NUMBERS)
    requires = load_solver(name).requires
    if not requires:
        return code
    return hashlib.sha256(f"{code} {requires} {installed(requires)}".encode()).hexdigest()[:16]


@cache
def code_digest(modules: tuple[str, ...], parts: tuple[str, ...]) -> str:
    """Digest of some modules and, transitively, of what they import from the named parts of the package.

    Only code counts: a comment, a docstring or the layout of the source changes nothing.
    """
    digest = hashlib.sha256()
    for path in sorted(_sources(modules, parts)):
        digest.update(f"{path.relative_to(PACKAGE).as_posix()}\0{_read(path).code}\0".encode())
    return digest.hexdigest()[:16]


def _sources(modules: tuple[str, ...], parts: tuple[str, ...]) -> set[Path]:
    """The files of the modules and, transitively, of what they import from the parts."""
    found: set[Path] = set()
    todo = [PACKAGE / f"{module}.py" for module in modules]
    while todo:
        path = todo.pop()
        if path in found:
            continue
        found.add(path)
        wanted = [module for module in _read(path).imported if module.split("/")[0] in parts]
        files = [PACKAGE / file for module in wanted for file in (f"{module}.py", f"{module}/__init__.py")]
        todo += [file for file in files if file.exists()]
    return found


@dataclass(frozen=True)
class _Source:
    """A module without its docstrings, as a syntax tree in words, and what it imports of this package, as paths."""

    code: str
    imported: frozenset[str]


@cache
def _read(path: Path) -> _Source:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    imported: set[str] = set()
    for node in ast.walk(tree):
        imported |= _imported(node)
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node) is not None:
            node.body = node.body[1:]
    return _Source(ast.dump(tree), frozenset(imported))


def _imported(node: ast.AST) -> set[str]:
    """Modules of this package that a statement imports, as paths below the package."""
    if isinstance(node, ast.ImportFrom) and node.module == "cablesim":
        return {alias.name for alias in node.names}
    if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("cablesim."):
        base = node.module.removeprefix("cablesim.").replace(".", "/")
        return {base, *(f"{base}/{alias.name}" for alias in node.names)}
    if isinstance(node, ast.Import):
        names = [alias.name for alias in node.names if alias.name.startswith("cablesim.")]
        return {name.removeprefix("cablesim.").replace(".", "/") for name in names}
    return set()
