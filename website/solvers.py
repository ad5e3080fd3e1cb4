"""A page for each solver and each adapter to another program: what it is given, can be told, and answers."""

import ast
import inspect
import re

from cablesim import units
from cablesim.parameters import OptionSpec, ParameterSpec
from cablesim.quantities import COMPONENTS, quantity
from cablesim.solver import Solver, load_solver, peer_names, solver_names
from website.places import SOLVERS
from website.text import table

INDEX = """# Solvers

Each is one method, a module in `cablesim/solvers/`. [Theory](../../theory/index.md) has the equations, `cablesim
describe SOLVER` prints what these pages say.
"""


def pages() -> dict[str, str]:
    """Pages by their place."""
    ours, others = ([load_solver(name) for name in names()] for names in (solver_names, peer_names))
    index = f"{INDEX}\n{_list(ours)}\n## Other people's programs, to compare with\n\n{_list(others)}"
    return {
        f"{SOLVERS}/index.md": index,
        **{f"{SOLVERS}/{solver.name}.md": page(solver, solver in ours) for solver in (*ours, *others)},
    }


def page(solver: Solver, is_ours: bool) -> str:
    """Theory in a word, parameters, options and outputs."""
    theory = f"Equations, assumptions and traps: [theory](../../theory/{chapter(solver.name)}.md#{solver.name}).\n\n"
    given = f"Given: {solver.problems}.\n\n" if solver.problems else ""
    options = f"## Options\n\n{_options(solver)}\n" if solver.options else ""
    return (
        f"# `{solver.name}`\n\n{text(solver)}\n\n{theory if is_ours else ''}## Parameters\n\n{given}"
        f"{_parameters(solver)}\n{options}## Outputs\n\n{_outputs(solver)}"
    )


def text(solver: Solver) -> str:
    """The docstring as Markdown: what is indented is set as it stands."""
    docstring = inspect.cleandoc(ast.get_docstring(ast.parse(inspect.getsource(solver.module))) or "")
    return re.sub(r"(?m)^Reference:", "**Reference:**", docstring)


CHAPTERS = {
    "catenary": "hanging",
    "equal": "strength",
    "uniform": "strength",
    "stepped": "strength",
    "composite": "towing",
    "tow": "towing",
    "wave": "waves",
}


def chapter(solver: str) -> str:
    """The page of the theory that a solver is in."""
    return CHAPTERS.get(solver.partition("_")[0], "stream")


def _list(solvers: list[Solver]) -> str:
    return table(("solver", ""), ((f"[`{solver.name}`]({solver.name}.md)", solver.summary) for solver in solvers))


def _parameters(solver: Solver) -> str:
    heads = ("parameter", "symbol", "unit", "meaning", "allowed", "if left out")
    rows = (
        (
            f"`{s.name}`",
            f"${quantity(s.name).symbol}$",
            units.shown(quantity(s.name).unit),
            quantity(s.name).meaning,
            _allowed(s),
            _left_out(s),
        )
        for s in solver.parameters.values()
    )
    return table(heads, rows)


def _allowed(spec: ParameterSpec) -> str:
    if spec.words:
        return ", ".join(f"`{word}`" for word in spec.words)
    kind = f"vector {', '.join(COMPONENTS)}" if spec.vector else "a number for each section" if spec.listed else ""
    return ", ".join(filter(None, (kind, " and ".join(spec.limits))))


def _left_out(spec: ParameterSpec) -> str:
    if spec.default is not None:
        return f"`{spec.default}`" if spec.words else f"{spec.default:g}"
    return spec.otherwise or (f"`{spec.instead_of}` is given" if spec.instead_of else "")


def _options(solver: Solver) -> str:
    heads = ("option", "meaning", "allowed", "default")
    return table(heads, ((f"`{o.name}`", o.meaning, o.allowed, _default(o)) for o in solver.options.values()))


def _default(option: OptionSpec) -> str:
    return f"`{option.default}`"


def _outputs(solver: Solver) -> str:
    rows = (quantity(name) for name in solver.outputs)
    heads = ("output", "symbol", "unit", "meaning", "over")
    return table(
        heads, ((f"`{r.name}`", f"${r.symbol}$", units.shown(r.unit), r.meaning, ", ".join(r.dims)) for r in rows)
    )
