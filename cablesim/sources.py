"""The sources that decide a solver's numbers, as a digest that names its results."""

import ast
import hashlib
from functools import cache
from pathlib import Path

from cablesim.solver import FOLDER, PACKAGE


@cache
def source_digest(name: str) -> str:
    """Digest of everything that decides a solver's numbers: its module and what it imports of physics and numerics.

    Results are named by it, so editing a solver reruns what it solved and nothing else. Only code counts: a comment, a
    docstring or the layout of the source changes no number.
    """
    digest = hashlib.sha256()
    for path in sorted(_sources(FOLDER / f"{name}.py")):
        digest.update(f"{path.relative_to(PACKAGE).as_posix()}\0{_code(path)}\0".encode())
    return digest.hexdigest()[:16]


def _code(path: Path) -> str:
    """A module without its docstrings, as a syntax tree in words."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node) is not None:
            node.body = node.body[1:]
    return ast.dump(tree)


def _sources(start: Path) -> set[Path]:
    """The module and, transitively, the modules of `physics`, `numerics` and `solvers` that it imports."""
    found: set[Path] = set()
    todo = [start]
    while todo:
        path = todo.pop()
        if path in found:
            continue
        found.add(path)
        todo += [file for module in _imported(path) for file in _files(module) if file.exists()]
    return found


def _files(module: str) -> list[Path]:
    """Where a module of `physics`, `numerics` or `solvers` may lie; nothing for any other."""
    if module.split("/")[0] not in ("physics", "numerics", "solvers"):
        return []
    return [PACKAGE / f"{module}.py", PACKAGE / module / "__init__.py"]


def _imported(path: Path) -> set[str]:
    """Modules of this package that a file imports, as paths below the package."""
    modules = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("cablesim."):
            base = node.module.removeprefix("cablesim.").replace(".", "/")
            modules |= {base, *(f"{base}/{alias.name}" for alias in node.names)}
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names if alias.name.startswith("cablesim.")]
            modules |= {name.removeprefix("cablesim.").replace(".", "/") for name in names}
    return modules
