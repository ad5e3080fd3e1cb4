"""Wrong printed tables, places and figures of lines in a stream: refused with one line, nothing is written."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.cli.helpers import Answer, assert_refused, scene, tree

Ask = Callable[..., Answer]
# The input, and the phrases that its refusal must contain.
Case = tuple[str, tuple[str, ...]]

TWO_AXES = {"design": "{grid: {length_ratio: [1.1, 1.2], rise: [0 m, 0.1 m]}}"}
SERIES = {
    "design": "{grid: {stream_speed: [1, 2]}}",
    "fixed": "{force_A: [-50, 0, 250], line_length: 50, weight_per_length: 2, diameter: 0.01, fluid_density: 1000,"
    " normal_drag_coefficient: 1.2, tangential_drag_coefficient: 0.03}",
    "methods": {
        "exact": {"solver": "pode_line"},
        **{f"n{n}": {"solver": "segment_line", "options": {"segments": n}} for n in (4, 8, 16)},
    },
    "reference": "exact",
    "outputs": "[position_B]",
}


def printed(*phrases: str, design: str = TWO_AXES["design"], **settings: object) -> Case:
    """A good table with some of its keys replaced, or left out (None)."""
    look = {"rows": "length_ratio", "pages": ["rise"], "columns": ["sag"], **settings}
    return scene(design=design, tables={"look": {k: v for k, v in look.items() if v is not None}}), phrases


def profiles(*phrases: str, kind: str = "profiles", **settings: object) -> Case:
    return scene(**TWO_AXES, outputs="[sag, profile]", figures={"look": {"kind": kind, **settings}}), phrases


def convergence(*phrases: str, parts: dict[str, object] | None = None, **settings: object) -> Case:
    look = {"kind": "convergence", "output": "position_B", "against": "segments", **settings}
    figures = {"look": {key: value for key, value in look.items() if value is not None}}
    return scene(**{**SERIES, **(parts or {})}, figures=figures), phrases


TABLES = {
    "an unknown key": printed("asked.yaml", "tables.look.colums", "columns", colums=["sag"]),
    "a list of tables": (scene(tables="[sag]"), ("tables", "a list")),
    "a path for a table's name": (scene(tables="{../look: {rows: length_ratio, columns: [sag]}}"), ("../look", "name")),
    "the name of a table that every scene has": (
        scene(tables="{errors: {rows: length_ratio, columns: [sag]}}"),
        ("tables.errors", "another name"),
    ),
    "a unit of a word": (
        scene(
            **{**SERIES, "design": "{grid: {stream_speed: [1], friction_law: [constant, zero]}}"},
            tables={
                "look": {"rows": "friction_law", "columns": ["exact.position_B_x"], "units": {"friction_law": "%"}}
            },
        ),
        ("tables.look.units.friction_law", "friction_law"),
    ),
    "no rows": printed("tables.look", "'rows'", rows=None),
    "no columns": printed("tables.look", "'columns'", columns=None),
    "no column in the list": printed("tables.look.columns", "empty", columns=[]),
    "a column twice": printed("tables.look.columns", "twice", columns=["sag", "sag"]),
    "an unknown column": printed("tables.look.columns", "sog", "sag", columns=["sog"]),
    "a column of words": printed("tables.look.columns", "status", columns=["status"]),
    "code for a column": printed("tables.look.columns", columns={"sag": "__import__('os')"}),
    "rows of what does not vary": printed("tables.look.rows", "'span'", rows="span"),
    "rows and pages of the same": printed("tables.look", "twice", pages=["length_ratio"]),
    "an axis that is not shown": printed("tables.look", "rise", "point", pages=None),
    "an axis that is shown and chosen": printed("tables.look", "rise", "point", point={"rise": 0}),
    "a point that is not on its axis": printed("tables.look.point.rise", "0.2", pages=None, point={"rise": "0.2 m"}),
    "a point in another unit": printed("tables.look.point.rise", "kg", pages=None, point={"rise": "0 kg"}),
    "a point of what does not vary": printed("tables.look.point.span", "span", pages=None, point={"span": 2.5}),
    "no digits": printed("tables.look.digits", "from 1 to 15", "0", digits=0),
    "half a digit": printed("tables.look.digits", "2.5", digits=2.5),
    "a unit of another dimension": printed("tables.look.units.sag", "kg", units={"sag": "kg"}),
    "an unknown unit": printed("tables.look.units.sag", "smoot", units={"sag": "smoot"}),
    "a unit of what is not shown": printed("tables.look.units", "drop", units={"drop": "m"}),
    "a unit of a formula": printed("tables.look.units", "double", columns={"double": "2 * sag"}, units={"double": "m"}),
    "a condition that is a value": printed("tables.look.where", "condition", where="sag"),
    "rows that cannot be told apart": printed(
        "tables.look",
        "same length_ratio",
        design="{cases: [{length_ratio: 1.1, rise: 0}, {length_ratio: 1.1, rise: 0.1}]}",
        pages=None,
    ),
    "no choice among methods": (
        scene(
            methods="{exact: {solver: catenary_exact}, other: {solver: catenary_parabolic}}",
            tables={"look": {"rows": "length_ratio", "columns": ["sag"]}},
        ),
        ("tables.look.columns", "which method?"),
    ),
    "a profile in a cell": (
        scene(outputs="[profile]", tables={"look": {"rows": "length_ratio", "columns": ["profile"]}}),
        ("tables.look.columns", "along"),
    ),
}

FIGURES = {
    "profiles at two values of two axes": profiles("figures.look", "rise", "'point'", at={"length_ratio": [1.1]}),
    "profiles at a value that is not there": profiles(
        "figures.look.at.length_ratio[0]", "1.15", "nearest", at={"length_ratio": [1.15]}, point={"rise": 0}
    ),
    "profiles at two parameters": profiles("figures.look.at", "one parameter", at={"length_ratio": [1.1], "rise": [0]}),
    "profiles by an unknown method": profiles(
        "figures.look.methods[0]", "exakt", at={"length_ratio": [1.1]}, point={"rise": 0}, methods=["exakt"]
    ),
    "profiles from an unknown side": profiles(
        "figures.look.view", "zx", "xz", at={"length_ratio": [1.1]}, point={"rise": 0}, view="zx"
    ),
    "profiles with points of no table": profiles(
        "figures.look.points", "table", at={"length_ratio": [1.1]}, point={"rise": 0}, points={"x": 1, "printed": 2}
    ),
    "points of a table out of the folder": profiles(
        "figures.look.points.table",
        "below the folder",
        at={"length_ratio": [1.1]},
        point={"rise": 0},
        points={"table": "../outside.csv", "x": 1, "printed": 2},
    ),
    "a view in space of every scenario": profiles("figures.look", "'each'", kind="spatial"),
    "a view in space with panels": profiles("figures.look.at", "each", kind="spatial", at={"rise": [0]}),
    "curves with an axis left over": (
        scene(**TWO_AXES, figures={"look": {"kind": "curves", "x": "length_ratio", "y": "sag", "point": {}}}),
        ("figures.look.y", "length_ratio and rise"),
    ),
    "curves at a point that is not there": (
        scene(**TWO_AXES, figures={"look": {"kind": "curves", "x": "length_ratio", "y": "sag", "point": {"rise": 3}}}),
        ("figures.look.point.rise", "3"),
    ),
    "curves for each point of an axis of which one is chosen": (
        scene(
            **TWO_AXES,
            figures={"look": {"kind": "curves", "x": "length_ratio", "y": "sag", "each": "rise", "point": {"rise": 0}}},
        ),
        ("figures.look.each", "rise"),
    ),
    "an unknown key of a convergence": convergence("figures.look.outputs", "output", outputs="position_B"),
    "a convergence of nothing": convergence("figures.look", "'output'", output=None),
    "a convergence of what is no output": convergence("figures.look.output", "force_B", output="force_B"),
    "a convergence against an option of no series": convergence("figures.look.against", "nodes", against="nodes"),
    "a convergence without a reference": convergence("figures.look", "reference", parts={"reference": None}),
    "a convergence of two methods": convergence(
        "figures.look",
        "three methods",
        parts={"methods": {name: entry for name, entry in SERIES["methods"].items() if name != "n16"}},
    ),
    "cells that are off and called right": (
        scene(published="{table: tables/lines.csv, columns: {sag_printed: sag}, off: agrees}"),
        ("published.off", "agrees"),
    ),
}


@pytest.mark.parametrize("case", [*TABLES.values(), *FIGURES.values()], ids=[*TABLES, *FIGURES])
def test_a_scene_is_refused_that_has(case: Case, here: Path, ask: Ask) -> None:
    text, phrases = case
    (here / "asked.yaml").write_text(text)
    before = tree(here.parent)
    assert_refused(ask("run", "asked.yaml"), "asked.yaml", *phrases)
    assert tree(here.parent) == before
