"""The answer to a scene's question, in a sentence or some, computed from its dataset.

That of the scene file, its placeholders filled in; else what can be said of any scene: the fates of its scenarios, the
errors of its methods, what its checks and its audit say, and which of its timed methods to use.
"""

import math
import re
from collections.abc import Iterator
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
import xarray as xr

from cablesim.config.answer_file import ADVICE, ALL_CELLS, CELLS, ORDER, SCENARIOS, Placeholder, unit_factor, words
from cablesim.config.document import read_text
from cablesim.config.scene import Scene
from cablesim.database.reading import name_is_unknown, scene_lookup, status_words, with_components
from cablesim.expressions import BARE, WORDS, Evaluation, Function, Lookup, Term, UnknownName, parse
from cablesim.files import write_text
from cablesim.reductions import reductions
from cablesim.report.audit import audit_table
from cablesim.report.checks import check_lines
from cablesim.report.orders import convergences
from cablesim.report.precision import advice
from cablesim.report.tables import error_table

if TYPE_CHECKING:
    from lark import Tree

NO_VALUE = "-"
# Of numbers without a format: whole ones, and others.
WHOLE, DIGITS = "d", ".3g"
LARGEST_WHOLE = 1e15


def answer(scene: Scene, dataset: xr.Dataset) -> str:
    """The answer to the question of a scene, computed from its dataset. What has no value is a dash."""
    if scene.answer is None:
        return " ".join(_sentences(scene, dataset))
    whole = with_components(dataset)
    lookup, functions = _lookup(scene, whole), _functions(scene, dataset)
    return "".join(
        part if isinstance(part, str) else _told(part, whole, lookup, functions) for part in scene.answer.parts
    )


def answer_path(folder: Path, scene: str) -> Path:
    """Where the answer of a scene is written, among its tables."""
    return folder / f"{scene}_answer.md"


def written_answer(folder: Path, scene: str) -> str:
    """The answer of a scene as it was written last; empty where it was not."""
    path = answer_path(folder, scene)
    return read_text(path).strip().rpartition("\n\n")[2] if path.is_file() else ""


def write_answer(folder: Path, scene: Scene, dataset: xr.Dataset) -> None:
    """Write title, question and answer as Markdown."""
    question = f"{scene.question}\n\n" if scene.question else ""
    write_text(answer_path(folder, scene.name), f"# {scene.title}\n\n{question}{answer(scene, dataset)}\n")


def _told(part: Placeholder, dataset: xr.Dataset, lookup: Lookup, functions: dict[str, Function]) -> str:
    try:
        term = parse(part.formula).answer(lookup, functions, bool(part.unit))
    except UnknownName as unknown:
        raise name_is_unknown(dataset, unknown.name) from None
    if isinstance(term.values, str):
        return term.values
    number = float(term.values) / (unit_factor(part.unit, term.unit) if part.unit else 1.0)
    return f"{_written(number, part.number)} {part.unit}".strip() if math.isfinite(number) else NO_VALUE


def _written(number: float, format: str) -> str:
    """A number in a format of Python's, or in as many digits as it has; zero has no sign."""
    if not format:
        format = WHOLE if number.is_integer() and abs(number) < LARGEST_WHOLE else DIGITS
    text = f"{round(number):{format}}" if format.endswith("d") else f"{number:{format}}"
    return text if re.search("[1-9]", text) else text.lstrip("-")


def _lookup(scene: Scene, dataset: xr.Dataset) -> Lookup:
    """What names mean in an answer: those of the scene, and some of its own."""
    of_scene = scene_lookup(dataset, scene.answer.table if scene.answer else None)
    own = {SCENARIOS: lambda: Term(float(scene.size), BARE), ADVICE: lambda: Term(advice(scene, dataset), WORDS)}

    @cache
    def lookup(name: str) -> Term | None:
        return own[name]() if name in own else of_scene(name)

    return lookup


def _functions(scene: Scene, dataset: xr.Dataset) -> dict[str, Function]:
    """What functions mean in an answer: reductions over all scenarios, and those of what reports know."""
    sizes = {axis.name: axis.size for axis in scene.design.axes}
    return reductions(sizes) | {CELLS: partial(_cells, scene, dataset), ORDER: partial(_order, scene, dataset)}


def _cells(scene: Scene, dataset: xr.Dataset, evaluation: Evaluation, arguments: tuple["Tree", ...]) -> Term:
    """How many cells of the audit have a flag."""
    (flag,) = words(evaluation, CELLS, arguments, 1)
    flags = audit_table(scene, dataset)["flag"]
    return Term(float(flags.size if flag == ALL_CELLS else (flags == flag).sum()), BARE)


def _order(scene: Scene, dataset: xr.Dataset, evaluation: Evaluation, arguments: tuple["Tree", ...]) -> Term:
    """The measured order of the series that a method is in."""
    method, output = words(evaluation, ORDER, arguments, 2)
    found = convergences(scene, dataset, output).values()
    orders = [one.order for one in found if method in (member.name for member in one.series.methods)]
    return Term(orders[0] if orders else math.nan, "1")


def _sentences(scene: Scene, dataset: xr.Dataset) -> Iterator[str]:
    """What can be said of any scene; of one whose methods are timed, which to use."""
    if scene.work_precision:
        yield advice(scene, dataset)
        return
    yield _fates(dataset)
    if scene.reference:
        yield from _errors(error_table(scene, dataset), scene.reference.name)
    for line in check_lines(scene, dataset):
        yield f"Check {line}."
    if scene.published:
        flags = audit_table(scene, dataset)["flag"].value_counts()
        yield f"Of {flags.sum()} printed cells: {', '.join(f'{count} {flag}' for flag, count in flags.items())}."


def _fates(dataset: xr.Dataset) -> str:
    counts = np.bincount(dataset.status.values.ravel(), minlength=1)
    flagged = [f"{n} {word}" for word, n in list(zip(status_words(dataset), counts.tolist(), strict=False))[1:] if n]
    others = f"; {', '.join(flagged)}" if flagged else ""
    return f"{counts[0]} of {counts.sum()} scenarios are solved{others}."


def _errors(table: pd.DataFrame, reference: str) -> Iterator[str]:
    """A sentence for each method, on the output in which it is most wrong."""
    for method, rows in table.groupby("method", sort=False) if len(table) else ():
        known = rows[rows["scenarios"] > 0]
        if known.empty or known["relative max"].isna().all():
            yield f"{method} has no answer to be compared with {reference}."
            continue
        worst = known.iloc[int(known["relative max"].argmax())]
        place = f", at {worst['worst at']}" if worst["worst at"] else ""
        yield (
            f"{method} differs from {reference} by up to {100 * worst['relative max']:.3g} % "
            f"({worst['output']}{place}), by {100 * worst['relative median']:.3g} % in the median."
        )
