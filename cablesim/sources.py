"""The sources that decide what a solver or a step of the workflow makes, as a digest that names it."""

import ast
import hashlib
from functools import cache
from pathlib import Path

from cablesim.solver import PACKAGE, installed, load_solver, source

# Where a solver's numbers come from.
NUMBERS = ("physics", "numerics", "solvers", "peers")


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
        digest.update(f"{path.relative_to(PACKAGE).as_posix()}\0{_code(path)}\0".encode())
    return digest.hexdigest()[:16]


def _code(path: Path) -> str:
    """A module without its docstrings, as a syntax tree in words."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node) is not None:
            node.body = node.body[1:]
    return ast.dump(tree)


def _sources(modules: tuple[str, ...], parts: tuple[str, ...]) -> set[Path]:
    """The files of the modules and, transitively, of what they import from the parts."""
    found: set[Path] = set()
    todo = [PACKAGE / f"{module}.py" for module in modules]
    while todo:
        path = todo.pop()
        if path in found:
            continue
        found.add(path)
        wanted = [module for module in _imported(path) if module.split("/")[0] in parts]
        files = [PACKAGE / file for module in wanted for file in (f"{module}.py", f"{module}/__init__.py")]
        todo += [file for file in files if file.exists()]
    return found


def _imported(path: Path) -> set[str]:
    """Modules of this package that a file imports, as paths below the package."""
    modules = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module == "cablesim":
            modules |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("cablesim."):
            base = node.module.removeprefix("cablesim.").replace(".", "/")
            modules |= {base, *(f"{base}/{alias.name}" for alias in node.names)}
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names if alias.name.startswith("cablesim.")]
            modules |= {name.removeprefix("cablesim.").replace(".", "/") for name in names}
    return modules
