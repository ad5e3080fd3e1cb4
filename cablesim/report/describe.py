"""A solver or a scene in words, from its own docstring and the table of quantities."""

import ast
import inspect
from typing import TYPE_CHECKING

from cablesim.quantities import COMPONENTS, quantity
from cablesim.solver import Solver

if TYPE_CHECKING:
    import xarray as xr


def description(solver: Solver) -> str:
    """Theory, parameters, options and outputs of a solver."""
    docstring = inspect.cleandoc(ast.get_docstring(ast.parse(inspect.getsource(solver.module))) or "")
    return "\n".join([docstring, "", *_parameters(solver), *_options(solver), *_outputs(solver)])


def scene_line(name: str, dataset: "xr.Dataset") -> str:
    """One line on a scene's dataset: its size and the fate of its scenarios."""
    axes = " x ".join(f"{dim} {dataset.sizes[dim]}" for dim in dataset.status.dims)
    flagged = int((dataset.status != 0).sum())
    fate = "all solved" if not flagged else f"{flagged} flagged"
    return f"{name:<20} {dataset.status.size:>9} scenarios ({axes}), {fate}: {dataset.attrs['title']}"


def scene_table(name: str, dataset: "xr.Dataset", answer: str = "") -> str:
    """What a scene holds: title, question and answer, then its methods, parameters, outputs and fates."""
    from cablesim.database.catalogue import describe

    rows = describe(name, dataset)
    shown = rows[rows["kind"] != "scene"].drop(columns=["scene", "digest"])
    title = [f"{dataset.attrs['title']} ({dataset.status.size} scenarios)", dataset.attrs.get("comment", ""), answer]
    body = shown.astype(object).where(shown.notna(), "").to_markdown(index=False, floatfmt=".6g")
    return "\n".join([*filter(None, title), "", body])


def _parameters(solver: Solver) -> list[str]:
    lines = ["Parameters:"]
    for spec in solver.parameters.values():
        notes = [" and ".join(spec.limits)] if spec.limits else []
        notes += [f"vector {', '.join(COMPONENTS)}"] if spec.vector else []
        notes += ["list, one number a section"] if spec.listed else []
        notes += [f"one of {', '.join(spec.words)}"] if spec.words else []
        notes += [f"default {_default(spec.default)}"] if spec.default is not None else []
        notes += [f"if left out: {spec.otherwise}"] if spec.otherwise else []
        notes += [f"instead of {spec.instead_of}"] if spec.instead_of else []
        lines.append(_line(spec.name, ", ".join(notes)))
    return [*lines, f"  Given: {solver.problems}."] if solver.problems else lines


def _default(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:g}"


def _options(solver: Solver) -> list[str]:
    if not solver.options:
        return []
    return [
        "Options:",
        *(f"  {o.name:<20} {o.meaning} ({o.allowed}; default {o.default})" for o in solver.options.values()),
    ]


def _outputs(solver: Solver) -> list[str]:
    return [
        "Outputs:",
        *(
            _line(name, f"over {', '.join(quantity(name).dims)}" if quantity(name).dims else "")
            for name in solver.outputs
        ),
    ]


def _line(name: str, notes: str) -> str:
    row = quantity(name)
    return f"  {name:<20} [{row.unit}] {row.meaning}" + (f" ({notes})" if notes else "")
