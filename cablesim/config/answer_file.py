"""The `answer` of a scene file: text with formulas in braces, rehearsed before anything is solved.

`{formula}`, `{formula:format}` or `{formula:format unit}`: a formula over all scenarios (`cablesim.reductions`) that
gives one number or one word, Python's format of a number, and a unit that the number is written in.
"""

import re
from dataclasses import dataclass, replace
from functools import partial
from itertools import zip_longest
from typing import TYPE_CHECKING

import numpy as np

from cablesim import units
from cablesim.config.document import Node
from cablesim.config.figure_parts import Stage
from cablesim.config.method import find_series
from cablesim.config.rehearsal import Rehearsal
from cablesim.config.table import Table
from cablesim.errors import InputError, nearest
from cablesim.expressions import BARE, WORDS, Evaluation, Expression, Function, Term
from cablesim.quantities import SHORT, quantity
from cablesim.reductions import ANY, CONDITION, NUMBER, REDUCTIONS, VALUE, Reduction

if TYPE_CHECKING:
    from lark import Tree

LONGEST = 5000
# Names of an answer's own: how many scenarios there are, and what `work_precision` advises.
SCENARIOS, ADVICE = "scenarios", "advice"
# Functions of an answer's own: cells of the audit that have a flag, and the order of the series that a method is in.
CELLS, ORDER = "cells", "order"
ALL_CELLS = "all"
# Dimensions within a scenario that a reduction may run along.
WITHIN = {"section", "node"}
_FORMAT = re.compile(r"\s*(,?(?:\.[0-9]{1,2})?[defg])(?:\s+(\S.*?))?\s*")
_PLACEHOLDER = re.compile(r"\{([^{}]*)\}")


@dataclass(frozen=True)
class Placeholder:
    """A formula; how its number is written ("" for a word) and in which unit ("" for SI, unwritten)."""

    formula: str
    number: str
    unit: str


@dataclass(frozen=True)
class Answer:
    """The text as it stands in the file, and its parts; formulas may use the columns of a table."""

    text: str
    parts: tuple[str | Placeholder, ...]
    table: Table | None


def read_answer(node: Node, stage: Stage, table: Table | None, flags: tuple[str, ...]) -> Answer:
    """The answer of a scene, whose audited cells have the `flags`.

    Raises InputError naming file, line and key for what could not be told.
    """
    text = node.text(LONGEST)
    values = {SCENARIOS: Term(float(stage.names.design.size), BARE)}
    if stage.timed:
        values[ADVICE] = Term("advice", WORDS)
    names = replace(stage.names, table=table, values=values)
    functions = _rehearsed(names) | _own(stage, flags)
    parts = node.located(_read_parts, text)
    return Answer(text, tuple(_check(node, part, names, functions) for part in parts), table)


def _read_parts(text: str) -> list[str | Placeholder]:
    """Plain text and placeholders, in turns. Raises InputError for a brace that is not closed or not opened."""
    plain, formulas = _PLACEHOLDER.split(text)[::2], _PLACEHOLDER.split(text)[1::2]
    for part in plain:
        for brace in re.findall(r"[{}].{0,30}", part):
            raise InputError(f"'{brace[0]}' without its other half, at '{brace}'")
    return [part for pair in zip_longest(plain, map(_placeholder, formulas)) for part in pair if part]


def _placeholder(text: str) -> Placeholder:
    formula, colon, written = text.partition(":")
    if not colon:
        return Placeholder(formula, "", "")
    format = _FORMAT.fullmatch(written)
    if format is None:
        raise InputError(f"'{written.strip():.40}' is no format: write .3g, .1f or d, and a unit after it if wanted")
    return Placeholder(formula, format[1], format[2] or "")


def _check(node: Node, part: str | Placeholder, names: Rehearsal, functions: dict[str, Function]) -> str | Placeholder:
    if isinstance(part, str):
        return part
    term, along = node.located(names.answer, part.formula, functions, bool(part.unit))
    if along:
        hint = f"take the largest({part.formula.strip():.60}), or one value(..., condition)"
        node.fail(f"'{part.formula.strip():.80}' varies along {' and '.join(sorted(along))}: {hint}")
    if term.unit == WORDS and part.number:
        node.fail(f"'{part.formula.strip():.80}' is a word: it has no format")
    if part.unit:
        node.located(unit_factor, part.unit, term.unit)
    return part


def unit_factor(written: str, unit: str) -> float:
    """What a number in `unit` is divided by to be in the written one. Raises InputError if these do not fit."""
    if unit != BARE:
        return units.factor(written, unit)
    return units.factor(written, "1" if written == "%" else units.base_unit(written))


def _rehearsed(names: Rehearsal) -> dict[str, Function]:
    """The reductions, of stand-ins: each checks that what it is taken of is what it can be taken of."""
    return {name: partial(_rehearse, names, reduction) for name, reduction in REDUCTIONS.items()}


def _rehearse(names: Rehearsal, reduction: Reduction, evaluation: Evaluation, arguments: tuple["Tree", ...]) -> Term:
    terms = reduction.read(evaluation, arguments)
    kinds = reduction.takes[: len(terms)]
    along = [names.varies(term.values) for term in terms]
    for dims in along:
        _check_within(evaluation.text, names, dims - WITHIN if reduction.name != VALUE else dims)
    points = _points(names, [Expression(evaluation.text, tree) for tree in _conditions(kinds, arguments)])
    if reduction.name == VALUE:
        _check_single(evaluation.text, along[0], points)
    elif kinds[:2] == (NUMBER, ANY) and along[1] - along[0].union(*along[2:]):
        more = min(along[1] - along[0].union(*along[2:]))
        raise InputError(f"'{evaluation.text}': the second argument of {reduction.name} also varies along {more}")
    return replace(reduction.reduce(*terms), words=())


def _conditions(kinds: tuple[str, ...], arguments: tuple["Tree", ...]) -> list["Tree"]:
    return [tree for kind, tree in zip(kinds, arguments, strict=True) if kind == CONDITION]


def _check_within(text: str, names: Rehearsal, dims: set[str]) -> None:
    for dim in sorted(dims - names.scenario_dims):
        hint = ": take a component, as in force_B_z" if dim == "component" else ""
        raise InputError(f"'{text}': this has many values a scenario, along {dim}{hint}")


def _points(names: Rehearsal, conditions: list[Expression]) -> dict[str, np.ndarray]:
    """Which points of each axis, and which methods, meet all parts of the conditions that speak of it alone.

    Raises InputError where a value is asked for that no point has.
    """
    points = {axis: np.ones(size, dtype=bool) for axis, size in names.sizes.items()}
    for part in (part for condition in conditions for part in condition.conjuncts):
        for axis in points:
            met = _met(part, names, axis)
            if met is None:
                continue
            if part.is_equality and not met.any():
                raise InputError(f"'{part.text}': no scenario has this {' or '.join(part.names)}")
            points[axis] &= met
    return points


def _met(condition: Expression, names: Rehearsal, axis: str) -> np.ndarray | None:
    """Which points of an axis meet a condition; None where it does not speak of this axis alone."""
    try:
        met = condition.select(lambda name: names.coordinate(axis, name))
    except InputError:
        return None
    return met if np.shape(met) else None


def _check_single(text: str, along: set[str], points: dict[str, np.ndarray]) -> None:
    for axis in sorted(along):
        if points[axis].sum() != 1:
            raise InputError(
                f"'{text}': value is of one scenario, not of {points[axis].sum()} along {axis}: choose one with =="
            )


def _own(stage: Stage, flags: tuple[str, ...]) -> dict[str, Function]:
    """The functions of what reports know, rehearsed."""
    known = (*flags, ALL_CELLS)
    outputs = tuple(name for name in stage.names.outputs if quantity(name).dims in SHORT)
    series = find_series(stage.methods, stage.reference)

    def cells(evaluation: Evaluation, arguments: tuple["Tree", ...]) -> Term:
        (flag,) = words(evaluation, CELLS, arguments, 1)
        if not stage.audited:
            raise InputError(f"'{evaluation.text}': no published table in this scene: it has no audited cells")
        _check_known(evaluation.text, flag, known)
        return Term(1.0, BARE)

    def order(evaluation: Evaluation, arguments: tuple["Tree", ...]) -> Term:
        method, output = words(evaluation, ORDER, arguments, 2)
        _check_known(evaluation.text, output, outputs)
        names = [one.name for found in series for one in found.methods]
        _check_known(evaluation.text, method, [name for name in names if names.count(name) == 1])
        return Term(1.0, "1")

    return {CELLS: cells, ORDER: order}


def words(evaluation: Evaluation, function: str, arguments: tuple["Tree", ...], number: int) -> list[str]:
    """The words that a function is given. Raises InputError where they are too few or too many."""
    if len(arguments) != number:
        raise InputError(f"'{evaluation.text}': {function} takes {number} word{'s' * (number > 1)}")
    return [evaluation.word(argument) for argument in arguments]


def _check_known(text: str, word: str, known: tuple[str, ...] | list[str]) -> None:
    if word not in known:
        raise InputError(f"'{text}': unknown word '{word}': {nearest(word, known)}")
