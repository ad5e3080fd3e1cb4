"""Wrong inputs: each is refused with one line that says what is wrong and where, and nothing is written.

A case is its name, the input, and what the line must contain beside the file: the key, the value, the unit or the
nearest valid name.
"""

import subprocess
import sys
import sysconfig
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from cablesim.errors import CablesimError
from cablesim.parameters import ParameterSpec
from cablesim.solver import Solver, load_solver, solver_names
from cablesim.study import read_study
from cablesim.workflow import plan_study
from tests.cli.helpers import Answer, assert_refused, call, scene, tree
from tests.helpers import draw, problems

Ask = Callable[..., Answer]
# The input, and the phrases that its refusal must contain.
Case = tuple[str | bytes, tuple[str, ...]]


def fixed(values: str, *phrases: str) -> Case:
    return scene(fixed=f"{{{values}}}"), phrases


def grid(axes: str, *phrases: str, **parts: object) -> Case:
    return scene(design=f"{{grid: {axes}}}", **parts), phrases


def cases(entry: str, *phrases: str, **parts: object) -> Case:
    return scene(design=f"{{cases: {entry}}}", **parts), phrases


def sample(*phrases: str, method="sobol", num="8", seed="1", ranges="{length_ratio: {start: 1.1, stop: 2}}") -> Case:
    given = {"method": method, "num": num, "seed": seed, "ranges": ranges}
    entries = ", ".join(f"{key}: {value}" for key, value in given.items() if value is not None)
    return scene(design=f"{{sample: {{{entries}}}}}"), phrases


def method(entry: str, *phrases: str, **parts: object) -> Case:
    return scene(methods=f"{{exact: {entry}}}", **parts), phrases


def published(entry: str, *phrases: str, **parts: object) -> Case:
    return scene(published=f"{{{entry}}}", **parts), phrases


def reference(entry: str, *phrases: str, **parts: object) -> Case:
    return scene(reference=f"{{{entry}}}", **parts), phrases


def curves(*phrases: str, **settings: object) -> Case:
    look = {"kind": "curves", "x": "length_ratio", "y": "exact.sag", **settings}
    return scene(figures={"look": {key: value for key, value in look.items() if value is not None}}), phrases


def relief(*phrases: str, design="{grid: {length_ratio: [1.1, 1.2], rise: [0, 0.1]}}", **settings: object) -> Case:
    look = {"kind": "map", "x": "length_ratio", "y": "rise", "value": "sag", **settings}
    return scene(design=design, figures={"look": {key: v for key, v in look.items() if v is not None}}), phrases


def fates(*phrases: str, design="{grid: {length_ratio: [1.1, 1.2], rise: [0, 0.1]}}", **settings: object) -> Case:
    look = {"kind": "status_map", "x": "length_ratio", "y": "rise", **settings}
    return scene(design=design, figures={"look": {key: v for key, v in look.items() if v is not None}}), phrases


def profiles(*phrases: str, outputs: str = "[sag, profile]", **settings: object) -> Case:
    return scene(outputs=outputs, figures={"look": {"kind": "profiles", **settings}}), phrases


HACK = "__import__('os').system('touch hacked')"
LIMIT_RATIO = {
    "design": "{grid: {permitted_error: [0.1]}}",
    "fixed": None,
    "outputs": "[sag_limit_ratio]",
}
SPAN_TABLE = {"fixed": "{length_ratio: 1.1, weight_per_length: 3 N/m}"}

# ---- scene files: values and units ----

VALUES = {
    "a length in kilograms": fixed("span: 2.5 kg, weight_per_length: 3", "asked.yaml:3", "fixed.span", "kg", "in m"),
    "a force for a force per length": fixed("span: 2.5, weight_per_length: 3 kN", "fixed.weight_per_length", "kN"),
    "an unknown unit": fixed("span: 2.5 metro, weight_per_length: 3", "fixed.span", "metro"),
    "a logarithmic unit": fixed("span: 2.5, weight_per_length: 3 dB/m", "fixed.weight_per_length", "dB/m"),
    "decibels for a ratio": grid("{length_ratio: [1 dB]}", "design.grid.length_ratio[0]", "dB"),
    "code for a unit": fixed(f'span: "2.5 {HACK}", weight_per_length: 3', "fixed.span", "__import__"),
    "not a number": fixed("span: .nan, weight_per_length: 3", "fixed.span", "nan"),
    "not a number as a word": fixed("span: nan m, weight_per_length: 3", "fixed.span", "nan"),
    "an infinite number": fixed("span: .inf, weight_per_length: 3", "fixed.span", "inf"),
    "a number that overflows": fixed("span: 1e999 m, weight_per_length: 3", "fixed.span", "1e999"),
    "a whole number of 400 digits": fixed(f"span: {10**400}, weight_per_length: 3", "fixed.span", "finite"),
    "a whole number of 5000 digits": fixed(f"span: {'9' * 5000}, weight_per_length: 3", "asked.yaml"),
    "a negative length": fixed("span: -2.5 m, weight_per_length: 3", "asked.yaml:3", "fixed.span", "> 0 m", "-2.5"),
    "a length of zero": fixed("span: 0, weight_per_length: 3", "fixed.span", "> 0 m"),
    "a length beyond every magnitude": fixed("span: 1e61, weight_per_length: 3", "fixed.span", "1e+61"),
    "a word where a number is wanted": fixed("span: long, weight_per_length: 3", "fixed.span", "long"),
    "true where a number is wanted": fixed("span: true, weight_per_length: 3", "fixed.span", "True"),
    "nothing where a number is wanted": fixed("span: , weight_per_length: 3", "fixed.span", "None"),
    "a list where a number is wanted": fixed("span: [1, 2], weight_per_length: 3", "fixed.span", "[1, 2]"),
    "a clock time where a number is wanted": fixed("span: 12:30:00, weight_per_length: 3", "fixed.span", "12:30:00"),
    "a decimal comma": fixed('span: "2,5 m", weight_per_length: 3', "fixed.span", "2,5 m"),
    "a negative value on an axis": grid("{length_ratio: [1.1, -1.2]}", "design.grid.length_ratio", "> 0", "-1.2"),
    "an axis value in metres for a plain number": grid("{length_ratio: [1.1 m]}", "design.grid.length_ratio[0]", "m"),
    "an axis start in newtons for metres": grid("{rise: {start: 1 N, stop: 2 m, num: 3}}", "design.grid.rise.start"),
    "a number where a title is wanted": (scene(title="3"), ("asked.yaml:1", "title", "text is expected")),
    "a date where a title is wanted": (scene(title="2001-01-01"), ("title", "text is expected")),
    "an empty title": (scene(title='""'), ("title", "text is expected")),
    "a control character in the title": (scene(title='"a\\x07b"'), ("title", "printable")),
    "a title of ten thousand letters": (scene(title="a" * 10_000), ("title", "400")),
    "a question that is a list": (scene(question="[why]"), ("question", "a list")),
}

# ---- scene files: keys ----

UNKNOWN_KEYS = {
    "an unknown key": (scene(ouputs="[sag]"), ("asked.yaml:6", "'ouputs'", "did you mean outputs?")),
    "an unknown key in the design": (scene(design="{gird: {}}"), ("asked.yaml:2", "design.gird", "grid")),
    "an unknown parameter on an axis": grid("{lenght_ratio: [1.1]}", "design.grid.lenght_ratio", "length_ratio"),
    "an unknown key of an axis": grid(
        "{length_ratio: {start: 1.1, stop: 2, nums: 3}}", "design.grid.length_ratio.nums", "num"
    ),
    "an unknown spacing": grid(
        "{length_ratio: {start: 1.1, stop: 2, num: 3, spacing: logarithmic}}", "length_ratio.spacing", "log", "linear"
    ),
    "an unknown parameter in a case": cases("[{lenght_ratio: 1.1}]", "design.cases[0].lenght_ratio", "length_ratio"),
    "an unknown key of a table of cases": cases("{table: tables/lines.csv, rows: 3}", "design.cases.rows"),
    "an unknown parameter sampled": sample("ranges.lenght_ratio", "length_ratio", ranges="{lenght_ratio: {}}"),
    "an unknown key of a range": sample(
        "ranges.length_ratio.num", ranges="{length_ratio: {start: 1, stop: 2, num: 3}}"
    ),
    "an unknown fixed parameter": fixed("spam: 2.5 m, weight_per_length: 3", "asked.yaml:3", "fixed.spam", "span"),
    "an unknown key of a method": method("{solver: catenary_exact, option: {}}", "methods.exact.option", "options"),
    "an unknown option": method("{solver: catenary_exact, options: {node: 5}}", "methods.exact.options", "nodes"),
    "an ignored parameter that no solver has": method(
        "{solver: catenary_exact, ignores: [axial_stifness]}", "methods.exact.ignores", "axial_stifness"
    ),
    "an unknown key of the reference": reference("table: tables/lines.csv, column: {}", "reference.column", "columns"),
    "an unknown key of a published table": published(
        "table: tables/lines.csv, columns: {}, withn: 1", "published.withn", "within"
    ),
    "an unknown key of curves": curves("figures.look.xlabel", "x_label", xlabel="x"),
    "an unknown key of a map": relief("figures.look.colour", colour="red"),
    "an unknown key of profiles": profiles("figures.look.where", where="sag > 1"),
    "an unknown key of an audit": (scene(figures="{look: {kind: audit, x: sag}}"), ("figures.look.x",)),
    "an unknown kind of figure": (scene(figures="{look: {kind: curve}}"), ("figures.look.kind", "'curve'", "curves")),
    "a key that is a number": fixed("1: 2", "fixed", "1"),
    "a key that is a list": fixed("[span]: 2", "fixed", "span"),
    "a key that is a mapping": fixed("{span: 1}: 2", "fixed", "span"),
    "a key that cannot be printed": fixed('"sp\\ud83dan": 2', "fixed", "ud83d"),
    "a key that is nothing": fixed("~: 2", "fixed", "None"),
    "a key of ten thousand letters": (scene(fixed=f"\n  ? {'a' * 10_000}\n  : 1"), ("fixed", "aaaa", "span")),
    "a merge key": fixed("<<: {span: 2.5}, weight_per_length: 3", "asked.yaml:3", "<<"),
    "a key given twice": (scene() + "title: Again\n", ("asked.yaml:6", "title", "duplicate")),
    "a parameter given twice": fixed("span: 1, span: 2, weight_per_length: 3", "asked.yaml:3", "span"),
    "an axis given twice": grid("{length_ratio: [1.1], length_ratio: [1.2]}", "asked.yaml:2", "length_ratio"),
}

MISSING_KEYS = {
    "no title": (scene(title=None), ("asked.yaml", "'title'")),
    "no design": (scene(design=None), ("asked.yaml", "'design'")),
    "no methods": (scene(methods=None), ("asked.yaml", "'methods'")),
    "no outputs": (scene(outputs=None), ("asked.yaml", "'outputs'")),
    "no solver": method("{options: {nodes: 5}}", "methods.exact", "'solver'"),
    "no stop": grid("{length_ratio: {start: 1.1, num: 3}}", "design.grid.length_ratio", "'stop'"),
    "no number of points": grid("{length_ratio: {start: 1.1, stop: 2}}", "design.grid.length_ratio", "'num'"),
    "a sample without a seed": sample("design.sample", "'seed'", seed=None),
    "a sample without ranges": sample("design.sample", "'ranges'", ranges=None),
    "a range without an end": sample("ranges.length_ratio", "'stop'", ranges="{length_ratio: {start: 1.1}}"),
    "no table of cases": cases("{columns: {length_ratio: length_ratio}}", "design.cases", "'table'"),
    "a published table without columns": published("table: tables/lines.csv", "published", "'columns'"),
    "a reference without a table": reference("columns: {sag: sag_printed}", "reference", "'table'"),
    "a figure without a kind": (scene(figures="{look: {x: sag}}"), ("figures.look", "'kind'")),
    "curves without y": curves("figures.look", "'y'", y=None),
    "a map without a value": relief("figures.look", "'value'", value=None),
    "points without x": curves("figures.look.points", "'x'", points={"printed": "sag_printed"}),
    "a parameter missing": fixed("span: 2.5", "methods.exact", "weight_per_length", "N m-1"),
    "neither length nor length ratio": grid("{rise: [0, 1]}", "methods.exact", "line_length", "length_ratio"),
}

# ---- scene files: the design ----

DESIGNS = {
    "two kinds of design": (scene(design="{grid: {rise: [0]}, cases: [{rise: 0}]}"), ("asked.yaml:2", "exactly one")),
    "an empty design": (scene(design="{}"), ("design", "exactly one")),
    "an empty grid": grid("{}", "asked.yaml:2", "design.grid", "empty"),
    "an axis without values": grid("{length_ratio: []}", "design.grid.length_ratio", "empty"),
    "an axis that is one number": grid("{length_ratio: 1.1}", "design.grid.length_ratio", "a number"),
    "a value twice on an axis": grid("{length_ratio: [1.1, 1.2, 1.1]}", "design.grid.length_ratio", "1.1", "2 times"),
    "a value twice in two units": grid("{rise: [1 m, 100 cm]}", "design.grid.rise", "2 times"),
    "zero twice with two signs": grid("{rise: [0.0, -0.0]}", "design.grid.rise", "2 times"),
    "start after stop": grid("{rise: {start: 2, stop: 1 m, num: 3}}", "design.grid.rise", "start", "stop", "2", "1"),
    "start equal to stop": grid("{rise: {start: 1, stop: 1, num: 3}}", "design.grid.rise", "start", "stop"),
    "one point between two ends": grid("{rise: {start: 0, stop: 1, num: 1}}", "design.grid.rise.num", "2"),
    "a fraction of a point": grid("{rise: {start: 0, stop: 1, num: 2.5}}", "design.grid.rise.num", "2.5"),
    "points between ends too close to tell them apart": grid(
        "{length_ratio: {start: 1, stop: 1.000000000000001, num: 100}}", "design.grid.length_ratio", "times"
    ),
    "logarithmic spacing from zero": grid(
        "{rise: {start: 0, stop: 1, num: 3, spacing: log}}", "design.grid.rise", "logarithmic", "0"
    ),
    "logarithmic spacing through zero": grid(
        "{rise: {start: -1, stop: 1, num: 3, spacing: log}}", "design.grid.rise", "logarithmic", "-1"
    ),
    "logarithmic spacing through its origin": grid(
        "{rise: {start: 1, stop: 3, num: 3, spacing: log, origin: 2}}", "design.grid.rise", "logarithmic", "2"
    ),
    "too many points": grid("{rise: {start: 0, stop: 1, num: 1000000001}}", "design.grid", "1000000001"),
    "too many scenarios": grid(
        "{rise: {start: 0, stop: 1, num: 20000}, length_ratio: {start: 1.1, stop: 2, num: 20000}}",
        "design.grid",
        "400000000",
    ),
    "far too many scenarios": grid(
        "{rise: {start: 0, stop: 1, num: 90000000}, length_ratio: {start: 1.1, stop: 2, num: 90000000}}",
        "design.grid",
        "8100000000000000",
    ),
    "a parameter both fixed and varied": (
        scene(fixed="{span: 2.5 m, weight_per_length: 3, length_ratio: 1.1}"),
        ("asked.yaml:3", "fixed.length_ratio", "varies"),
    ),
    "both length and length ratio": (
        scene(fixed="{span: 2.5 m, weight_per_length: 3, line_length: 3 m}"),
        ("methods.exact", "line_length", "length_ratio"),
    ),
    "both length and length ratio as axes": grid("{length_ratio: [1.1], line_length: [3]}", "line_length", "exact"),
    "no cases": cases("[]", "design.cases", "empty"),
    "a case without parameters": cases("[{}]", "design.cases", "at least one"),
    "cases that are numbers": cases("[1.1, 1.2]", "design.cases[0]", "a mapping"),
    "cases of different parameters": cases("[{length_ratio: 1.1}, {rise: 1}]", "design.cases[1]", "length_ratio"),
    "a negative length ratio among the cases": cases("[{length_ratio: 1.1}, {length_ratio: -1}]", "design.cases", "-1"),
    "an unknown way to sample": sample("design.sample.method", "sobel", "sobol", method="sobel"),
    "a sample of none": sample("design.sample.num", "0", num="0"),
    "a sample too large": sample("design.sample.num", "1000000001", num="1000000001"),
    "a negative seed": sample("design.sample.seed", "-1", seed="-1"),
    "a seed that is a word": sample("design.sample.seed", "lucky", seed="lucky"),
    "a sample of nothing": sample("design.sample.ranges", "at least one", ranges="{}"),
    "a range from its end to its start": sample("ranges.length_ratio", ranges="{length_ratio: {start: 2, stop: 1}}"),
    "a logarithmic range through zero": sample(
        "ranges.rise", "logarithmic", ranges="{rise: {start: -1, stop: 1, spacing: log}}"
    ),
    "a range in the wrong unit": sample("length_ratio.stop", "kg", ranges="{length_ratio: {start: 1, stop: 2 kg}}"),
    "both length and length ratio sampled": sample(
        "line_length",
        "length_ratio",
        ranges="{length_ratio: {start: 1, stop: 2}, line_length: {start: 1, stop: 2}}",
    ),
}

# ---- scene files: methods, outputs, references, figures ----

METHODS = {
    "an unknown solver": method("{solver: catenary_exakt}", "asked.yaml:4", "methods.exact.solver", "catenary_exact"),
    "a solver by its path": method("{solver: ../solvers/catenary_exact}", "methods.exact.solver", "../solvers"),
    "a solver that is a part of others": method("{solver: _hanging_line}", "methods.exact.solver", "_hanging_line"),
    "a solver that is a number": method("{solver: 3}", "methods.exact.solver", "text is expected"),
    "no method at all": (scene(methods="{}"), ("asked.yaml:4", "methods", "at least one")),
    "a list of methods": (scene(methods="[catenary_exact]"), ("methods", "a list")),
    "a method that is only its solver's name": method("catenary_exact", "methods.exact", "a mapping"),
    "a method of upper case": (scene(methods="{Exact: {solver: catenary_exact}}"), ("methods.Exact", "name")),
    "a method with a path for its name": (scene(methods="{../exact: {solver: catenary_exact}}"), ("../exact", "name")),
    "options that are a list": method("{solver: catenary_exact, options: [nodes]}", "methods.exact.options", "a list"),
    "an option of text where a number is wanted": method(
        "{solver: catenary_exact, options: {nodes: many}}", "methods.exact.options", "nodes", "many"
    ),
    "an option that is a fraction": method("{solver: catenary_exact, options: {nodes: 2.5}}", "nodes", "2.5"),
    "an option that is true": method("{solver: catenary_exact, options: {nodes: true}}", "nodes", "True"),
    "an option that is not a number": method("{solver: catenary_exact, options: {nodes: .nan}}", "nodes", "nan"),
    "an option out of range": method("{solver: catenary_exact, options: {nodes: 1}}", "nodes", "from 2 to 100000", "1"),
    "a million million nodes": method(
        "{solver: catenary_exact, options: {nodes: 1000000000000}}", "nodes", outputs="[profile]"
    ),
    "an option that is no known word": method(
        "{solver: catenary_limit_ratio, options: {formula: cubic}}", "formula", "cubic", "parabolic", **LIMIT_RATIO
    ),
    "an option of a number where a word is wanted": method(
        "{solver: catenary_limit_ratio, options: {formula: 3}}", "formula", "parabolic", **LIMIT_RATIO
    ),
    "a solver that lacks a parameter of the design": (
        scene(
            methods="{exact: {solver: catenary_exact}, level: {solver: catenary_parabolic}}",
            design="{grid: {rise: [0], length_ratio: [1.1]}}",
        ),
        ("methods.level", "catenary_parabolic", "'rise'"),
    ),
    "a parameter ignored by a solver that has it": method(
        "{solver: catenary_exact, ignores: [rise]}", "methods.exact.ignores", "rise"
    ),
    "methods whose profiles have different nodes": (
        scene(
            methods="{coarse: {solver: catenary_exact, options: {nodes: 5}},"
            " fine: {solver: catenary_exact, options: {nodes: 9}}}",
            outputs="[profile]",
        ),
        ("methods", "nodes"),
    ),
    "an unknown output": (scene(outputs="[sag, sog]"), ("asked.yaml:5", "outputs[1]", "'sog'", "sag")),
    "an output twice": (scene(outputs="[sag, sag]"), ("outputs[1]", "sag", "twice")),
    "no output": (scene(outputs="[]"), ("outputs", "empty")),
    "an output that is not in a list": (scene(outputs="sag"), ("outputs", "a list is expected")),
    "an output that is a number": (scene(outputs="[3]"), ("outputs[0]", "text is expected")),
    "an output that one of the methods lacks": (
        scene(methods="{exact: {solver: catenary_exact}, limit: {solver: catenary_limit_ratio}}"),
        ("outputs[0]", "catenary_limit_ratio", "'sag'"),
    ),
    "an unknown reference": (scene(reference="exakt"), ("asked.yaml:6", "reference", "exakt", "exact")),
    "an empty reference": (scene(reference=""), ("reference", "nothing")),
    "a reference to a column that is not there": reference(
        "table: tables/lines.csv, columns: {sag: sag_prnted}", "reference", "sag_prnted", "sag_printed"
    ),
    "a reference for what is no output": reference(
        "table: tables/lines.csv, columns: {drop: sag_printed}", "reference.columns", "drop"
    ),
    "a table as the reference of a grid": reference(
        "table: tables/lines.csv, columns: {sag: sag_printed}", "asked.yaml:6", "reference"
    ),
    "a reference of more rows than cases": reference(
        "table: tables/longer.csv, columns: {sag: sag_printed}",
        "reference",
        "tables/longer.csv",
        design="{cases: [{length_ratio: 1.1}, {length_ratio: 1.2}]}",
    ),
    "a reference of fewer rows than cases": reference(
        "table: tables/lines.csv, columns: {sag: sag_printed}",
        "reference",
        "tables/lines.csv",
        design="{cases: {table: tables/longer.csv, columns: {length_ratio: length_ratio}}}",
    ),
}

FIGURES = {
    "a figure with a path for its name": (scene(figures="{../look: {kind: audit}}"), ("figures", "../look", "name")),
    "a list of figures": (scene(figures="[curves]"), ("figures", "a list")),
    "code in a figure": curves("asked.yaml:6", "figures.look.y", "__import__", y=HACK),
    "code in a figure's condition": curves("figures.look.where", where="sag.__class__ > 1"),
    "code in the points of a figure": curves("figures.look.points", points={"x": "length_ratio", "printed": HACK}),
    "a formula of a figure that ends too early": curves("figures.look.x", "length_ratio -", x="length_ratio -"),
    "an unknown name in a figure": curves(
        "asked.yaml:6", "figures.look", "lenth_ratio", "length_ratio", x="lenth_ratio"
    ),
    "an unknown method in a figure": curves("figures.look", "cubic.sag", y="cubic.sag"),
    "a figure of an output that the scene does not have": curves("figures.look", "drop", y="exact.drop"),
    "a figure of words": curves("figures.look", "status", y="status"),
    "a figure of a condition": curves("figures.look", "sag > 1", y="sag > 1"),
    "a figure of profiles as numbers": (
        scene(outputs="[profile]", figures={"look": {"kind": "curves", "x": "length_ratio", "y": "profile"}}),
        ("figures.look", "profile"),
    ),
    "curves of nothing": curves("figures.look.y", y={}),
    "a figure's condition that is a value": curves("figures.look", "sag", "condition", where="sag"),
    "a figure's condition in the wrong unit": curves("figures.look", "kg", where="sag > 1 kg"),
    "curves for each value of what is no axis": curves("figures.look", "rise", each="rise"),
    "curves on an unknown scale": curves("figures.look.log", "both", log="both"),
    "points without a table": curves("figures.look", "points", points={"x": "length_ratio", "printed": "sag"}),
    "curves over two axes": (
        scene(
            design="{grid: {length_ratio: [1.1, 1.2], rise: [0, 1]}}",
            figures={"look": {"kind": "curves", "x": "length_ratio", "y": "exact.sag"}},
        ),
        ("figures.look.y", "length_ratio and rise", "each"),
    ),
    "a map of statuses of one axis": fates("figures.look.y", "both sides", y="2 * length_ratio"),
    "a map of statuses over a constant": fates("figures.look.y", "a side of a map varies along one axis", y="span"),
    "a map of statuses over an answer": fates("figures.look.x", "a side of a map varies along one axis", x="sag"),
    "a map of statuses that vary along a third axis": fates("figures.look", "length_ratio", "point", x="rise", y=None),
    "a map of statuses on an unknown scale": fates("figures.look.log", "all", log="all"),
    "a map of statuses with a logarithmic side that is none": fates(
        "figures.look.log", "y", y=None, log="y", point={"rise": 0}
    ),
    "a map of statuses of an unknown method": fates("figures.look.methods", "cubic", methods=["cubic"]),
    "a map of one axis": relief("figures.look", design="{grid: {length_ratio: [1.1, 1.2]}}", y="span"),
    "a map over twice the same axis": relief("figures.look", y="length_ratio"),
    "a map over constants": relief("figures.look", x="1", y="2"),
    "profiles of a scene without them": profiles("figures.look", "profile", outputs="[sag]"),
    "profiles nowhere": profiles("figures.look", "'at'"),
    "profiles at what does not vary": profiles("figures.look", "rise", at={"rise": [1]}),
    "profiles at a word": profiles("figures.look.at", "wide", at={"length_ratio": ["wide"]}),
    "profiles at no values": profiles("figures.look.at.length_ratio", "empty", at={"length_ratio": []}),
    "an audit of no published table": (scene(figures="{look: {kind: audit}}"), ("figures.look", "published")),
    "code in a published column": published(
        f'table: tables/lines.csv, columns: {{sag_printed: "{HACK}"}}', "published.columns.sag_printed", "__import__"
    ),
    "a published column that is not in the table": published(
        "table: tables/lines.csv, columns: {sag_prnted: sag}", "published.columns.sag_prnted", "sag_printed"
    ),
    "an unknown name in a published column": published(
        "table: tables/lines.csv, columns: {sag_printed: exact.sug}", "published.columns.sag_printed", "exact.sug"
    ),
    "a condition for a published column": published(
        "table: tables/lines.csv, columns: {sag_printed: exact.sag > 1}", "published.columns.sag_printed"
    ),
    "a published table without a column to audit": published("table: tables/lines.csv, columns: {}", "published"),
    "a published row that is not on the axis": published(
        "table: tables/longer.csv, columns: {sag_printed: exact.sag}", "asked.yaml:6", "row 3", "1.3"
    ),
    "a published table of another axis": published(
        "table: tables/lines.csv, columns: {sag_printed: exact.sag}",
        "asked.yaml",
        "length_ratio",
        design="{grid: {span: [1, 2]}}",
        fixed="{length_ratio: 1.1, weight_per_length: 3}",
    ),
    "agreement within less than nothing": published(
        "table: tables/lines.csv, columns: {sag_printed: exact.sag}, within: -1", "published.within", "-1"
    ),
    "a resolution of print below zero": published(
        "table: tables/lines.csv, columns: {sag_printed: exact.sag}, printed_to: {sag_printed: -1}", "printed_to", "-1"
    ),
}

# ---- tables beside a scene ----


def table(name: str, *phrases: str, **parts: object) -> Case:
    return cases(f"{{table: {name}, columns: {{length_ratio: length_ratio}}}}", "design.cases", *phrases, **parts)


TABLES = {
    "a table that is not there": table("tables/nothing.csv", "tables/nothing.csv"),
    "a table in a folder above": table("../outside.csv", "../outside.csv", "below the folder"),
    "a table in a folder above by a detour": table("tables/../../outside.csv", "tables/../../outside.csv"),
    "a table by its absolute path": table("/etc/passwd", "/etc/passwd", "below the folder"),
    "a table behind a link out of the folder": table("tables/link.csv", "tables/link.csv", "below the folder"),
    "a table in a linked folder": table("linked/outside.csv", "linked/outside.csv", "below the folder"),
    "a table that is a folder": table("tables/folder.csv", "tables/folder.csv"),
    "a table that is a device": table("/dev/zero", "/dev/zero"),
    "a table with a name of 300 letters": table("a" * 300, "aaa"),
    "a table that is a number": table("3", "design.cases.table", "text is expected"),
    "an empty table": table("tables/empty.csv", "tables/empty.csv"),
    "a table without rows": table("tables/head_only.csv", "tables/head_only.csv", "row"),
    "a ragged row": table("tables/ragged.csv", "tables/ragged.csv", "row 2", "1", "2"),
    "a word in a column of numbers": table("tables/words.csv", "tables/words.csv", "row 2", "length_ratio", "long"),
    "a number with underscores in a table": table("tables/python_number.csv", "row 1", "length_ratio", "1_1"),
    "a number in a table that overflows": table("tables/overflow.csv", "row 1", "length_ratio", "1.1e999"),
    "an empty cell for a parameter": table("tables/gap.csv", "length_ratio", "nan"),
    "a column twice": table("tables/twice.csv", "tables/twice.csv", "length_ratio", "twice"),
    "a head that is no name": table("tables/bad_head.csv", "tables/bad_head.csv", "length ratio"),
    "a table that is not UTF-8": table("tables/latin.csv", "tables/latin.csv", "UTF-8"),
    "a binary table": table("tables/binary.csv", "tables/binary.csv", "UTF-8"),
    "a cell of 200000 digits": table("tables/huge_cell.csv", "tables/huge_cell.csv"),
    "a column that is not in the table": cases(
        "{table: tables/lines.csv, columns: {length_ratio: lenth_ratio}}", "design.cases", "lenth_ratio", "length_ratio"
    ),
    "a column that is no parameter": cases("{table: tables/lines.csv}", "design.cases", "sag_printed"),
    "code for a column": cases(
        f'{{table: tables/lines.csv, columns: {{length_ratio: "{HACK}"}}}}', "design.cases", "__import__"
    ),
    "a condition for a column": cases(
        "{table: tables/lines.csv, columns: {length_ratio: length_ratio > 1}}", "design.cases", "length_ratio > 1"
    ),
    "a column of lengths in kilograms": cases("{table: tables/spans.csv}", "design.cases", "span", "kg", **SPAN_TABLE),
    "a column in an unknown unit": cases("{table: tables/strange_unit.csv}", "span", "smoot", **SPAN_TABLE),
    "a column in half a unit": cases("{table: tables/broken_unit.csv}", "span", "m (", **SPAN_TABLE),
    "a table read by no key": cases("{table: tables/lines.csv, keys: {}}", "design.cases.keys"),
    "a key that gives no parameter": cases(
        "{table: tables/lines.csv, keys: {length_ratio: {}}}", "design.cases.keys.length_ratio"
    ),
    "a key that is not in the table": cases(
        "{table: tables/lines.csv, keys: {lenth_ratio: {length_ratio: lenth_ratio}}}",
        "keys.lenth_ratio",
        "length_ratio",
    ),
    "keys that give different parameters": cases(
        "{table: tables/lines.csv,"
        " keys: {length_ratio: {length_ratio: length_ratio}, sag_printed: {rise: sag_printed}}}",
        "design.cases.keys",
        "rise",
    ),
    "both keys and columns": cases(
        "{table: tables/lines.csv, columns: {length_ratio: length_ratio},"
        " keys: {length_ratio: {length_ratio: length_ratio}}}",
        "design.cases",
        "keys",
        "columns",
    ),
    "a published table out of the folder": published("table: ../outside.csv, columns: {}", "published.table", "../"),
    "a reference table out of the folder": reference("table: tables/link.csv", "reference.table", "tables/link.csv"),
}

# ---- files that are no scene at all ----

BOMB = "a: &a [x, x]\nb: &b [*a, *a]\nc: &c [*b, *b]\nd: [*c, *c]\n"

DOCUMENTS = {
    "an empty file": ("", ("empty",)),
    "nothing but a comment": ("# title: none\n", ("empty",)),
    "a word": ("catenary\n", ("a mapping",)),
    "a list": ("- title\n- design\n", ("a mapping",)),
    "a table for a scene": (b"length_ratio,sag\n1.1,0.5\n", ("a mapping",)),
    "a tag": (scene(outputs="!!python/object/apply:os.system ['touch hacked']"), ("asked.yaml:5", "tag")),
    "a tag of a set": (scene(outputs="!!set {sag}"), ("asked.yaml:5", "tag")),
    "an anchor": (scene(outputs="&names [sag]"), ("asked.yaml:5", "anchor")),
    "an alias": (scene(outputs="*names"), ("asked.yaml:5", "alias")),
    "aliases that grow": (BOMB, ("asked.yaml:1", "anchor")),
    "a directive": ("%YAML 1.1\n---\n" + scene(), ("asked.yaml:1", "directive")),
    "a hundred thousand brackets": ("title: " + "[" * 100_000, ("asked.yaml:1", "nested")),
    "three hundred levels": ("".join(" " * i + "a:\n" for i in range(300)), ("asked.yaml:13", "nested")),
    "a list of four hundred thousand outputs": (scene(outputs=f"[{'sog, ' * 390_000}]"), ("asked.yaml",)),
    "a file of three million bytes": (scene() + "# " + "x" * 3_000_000, ("asked.yaml", "bytes")),
    "two documents": (scene() + "---\n" + scene(), ("asked.yaml:6", "document")),
    "tabs for spaces": ("title: Lines\ndesign:\n\tgrid: {rise: [1]}\n", ("asked.yaml:3", "\\t")),
    "a bracket that is not closed": (scene(outputs="[sag"), ("asked.yaml:6",)),
    "a quote that is not closed": (scene(title='"Lines'), ("asked.yaml",)),
    "bytes": (bytes(range(256)), ("UTF-8",)),
    "a letter that is not UTF-8": ("title: \N{MICRO SIGN}\n".encode("latin-1"), ("UTF-8",)),
    "letters of two bytes": (scene().encode("utf-16"), ("UTF-8",)),
    "a zero byte": (scene() + "\0", ("asked.yaml",)),
    "an escape sequence": (scene(title="\x1b[31mred"), ("asked.yaml",)),
}

SCENES = VALUES | UNKNOWN_KEYS | MISSING_KEYS | DESIGNS | METHODS | FIGURES | TABLES | DOCUMENTS


@pytest.mark.parametrize("command", ["check", "run"])
@pytest.mark.parametrize(("content", "phrases"), SCENES.values(), ids=SCENES.keys())
def test_a_scene_is_refused_that_has(
    content: str | bytes, phrases: tuple[str, ...], command: str, here: Path, ask: Ask
) -> None:
    (here / "asked.yaml").write_bytes(content if isinstance(content, bytes) else content.encode())
    before = tree(here.parent)
    assert_refused(ask(command, "asked.yaml"), "asked.yaml", *phrases)
    assert tree(here.parent) == before


def test_the_scene_that_all_of_these_are_made_from_is_good(here: Path, ask: Ask) -> None:
    assert ask("check", "good.yaml").code == 0


# ---- names of scene files ----

NAMES = ("Scene.yaml", "two words.yaml", "1st.yaml", "_hidden.yaml", "schön.yaml", "scene.txt", "scene", "a.b.yaml")


@pytest.mark.parametrize("command", ["check", "run"])
@pytest.mark.parametrize("name", [*NAMES, f"{'a' * 65}.yaml"])
def test_a_scene_file_is_refused_that_is_called(name: str, command: str, here: Path, ask: Ask) -> None:
    (here / name).write_text(scene())
    before = tree(here)
    assert_refused(ask(command, name), name, "letters, digits, underscores")
    assert tree(here) == before


@pytest.mark.parametrize("name", ["nothing.yaml", "folder.yaml", "loop.yaml", "tables", "", ".", "/dev/null"])
def test_a_scene_file_is_refused_that_is_none(name: str, here: Path, ask: Ask) -> None:
    (here / "folder.yaml").mkdir()
    (here / "loop.yaml").symlink_to("loop.yaml")
    before = tree(here)
    assert_refused(ask("run", name), name)
    assert tree(here) == before


# ---- study files ----

STUDIES = {
    "an empty file": ("", ("config.yaml", "empty")),
    "no name": ("scenes: [good]\n", ("'study'",)),
    "no scenes": ("study: one\n", ("'scenes'",)),
    "an empty list of scenes": ("study: one\nscenes: []\n", ("config.yaml:2", "scenes", "empty")),
    "a scene that is not in a list": ("study: one\nscenes: good\n", ("config.yaml:2", "a list")),
    "an unknown key": ("study: one\nscenes: [good]\ncores: 4\n", ("config.yaml:3", "'cores'")),
    "a misspelt key": ("study: one\nscene: [good]\n", ("config.yaml:2", "'scene'", "scenes")),
    "a key given twice": ("study: one\nscenes: [good]\nstudy: two\n", ("config.yaml:3", "study")),
    "a scene listed twice": ("study: one\nscenes: [good, good]\n", ("config.yaml:2", "scenes[1]", "good", "twice")),
    "an unknown scene": ("study: one\nscenes: [godo]\n", ("config.yaml:2", "scenes[0]", "godo", "did you mean good?")),
    "a scene by its file name": ("study: one\nscenes: [good.yaml]\n", ("scenes[0]", "good.yaml", "name")),
    "a scene by a path": ("study: one\nscenes: [../scenes/good]\n", ("scenes[0]", "../scenes/good", "name")),
    "a scene by an absolute path": ("study: one\nscenes: [/etc/passwd]\n", ("scenes[0]", "/etc/passwd", "name")),
    "a scene that is a number": ("study: one\nscenes: [3]\n", ("scenes[0]", "3", "name")),
    "a scene that is a folder": ("study: one\nscenes: [folder]\n", ("folder.yaml",)),
    "a scene with a mistake in it": ("study: one\nscenes: [good, bad]\n", ("bad.yaml:3", "fixed.span", "> 0 m")),
    "a name that is a path": ("study: ../../one\nscenes: [good]\n", ("config.yaml:1", "study", "../../one")),
    "a name that is a number": ("study: 1\nscenes: [good]\n", ("config.yaml:1", "study", "1")),
    "a name of upper case": ("study: One\nscenes: [good]\n", ("config.yaml:1", "study", "One")),
    "an alias": ("study: &one one\nscenes: [*one]\n", ("config.yaml:1", "anchor")),
    "a tag": ("study: !!str one\nscenes: [good]\n", ("config.yaml:1", "tag")),
    "bytes": (bytes(range(256)), ("config.yaml", "UTF-8")),
}


def write_study(folder: Path, content: str | bytes) -> Path:
    (folder / "config" / "scenes" / "folder.yaml").mkdir(parents=True)
    (folder / "config" / "scenes" / "good.yaml").write_text(scene())
    (folder / "config" / "scenes" / "bad.yaml").write_text(scene(fixed="{span: -1, weight_per_length: 3}"))
    config = folder / "config" / "config.yaml"
    config.write_bytes(content if isinstance(content, bytes) else content.encode())
    return config.relative_to(folder)


@pytest.mark.parametrize(("content", "phrases"), STUDIES.values(), ids=STUDIES.keys())
def test_a_study_is_refused_that_has(content: str | bytes, phrases: tuple[str, ...], here: Path) -> None:
    config = write_study(here, content)
    before = tree(here.parent)
    with pytest.raises(CablesimError) as refusal:
        plan_study(config)
    assert refusal.value.exit_code == 2
    assert "\n" not in str(refusal.value)
    for phrase in phrases:
        assert phrase in str(refusal.value)
    assert tree(here.parent) == before


@pytest.mark.parametrize("name", ["nothing.yaml", "tables"])
def test_a_study_file_is_refused_that_is_none(name: str, here: Path) -> None:
    with pytest.raises(CablesimError, match=name) as refusal:
        read_study(Path(name))
    assert refusal.value.exit_code == 2


# ---- command lines ----

LINE = ("catenary_exact", "span=2.5", "line_length=3", "weight_per_length=3")
LONG = "a" * 5000


def solve(*arguments: str) -> tuple[str, ...]:
    return ("solve", *arguments)


COMMANDS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "nothing at all": ((), ("command",)),
    "a group without a command": (("step",), ("command",)),
    "an unknown command": (("slove", *LINE), ("slove", "solve")),
    "an unknown flag": (("check", "good.yaml", "--colour"), ("--colour",)),
    "an argument too many": (("check", "good.yaml", "again.yaml"), ("again.yaml",)),
    "an argument too few": (("describe",), ("SOLVER",)),
    "a flag without its value": (solve(*LINE, "--option"), ("--option",)),
    "an unknown solver to describe": (("describe", "catenry_exact"), ("catenry_exact", "did you mean catenary_exact")),
    "an unknown solver": (solve("catenry_exact", *LINE[1:]), ("catenry_exact", "did you mean catenary_exact")),
    "an empty solver": (solve("", *LINE[1:]), ("solver",)),
    "a solver of five thousand letters": (("describe", LONG), ("unknown solver", "aaa")),
    "a solver by its path": (solve("../solvers/catenary_exact", *LINE[1:]), ("../solvers/catenary_exact",)),
    "a solver that is a module": (solve("os", *LINE[1:]), ("'os'",)),
    "an unknown parameter": (solve(*LINE, "spam=1"), ("'spam'", "did you mean span?")),
    "an unknown option": (solve(*LINE, "--option", "node=5"), ("'node'", "did you mean nodes?")),
    "a name without =": (solve(*LINE, "rise"), ("rise", "name=value")),
    "a value without a name": (solve(*LINE, "=3"), ("=3", "name=value")),
    "a parameter twice": (solve(*LINE, "span=3"), ("span", "twice")),
    "an option twice": (solve(*LINE, "--option", "nodes=5", "--option", "nodes=6"), ("nodes", "twice")),
    "a unit of the wrong dimension": (solve(*LINE, "rise=3 kg"), ("rise", "kg", "in m")),
    "an unknown unit": (solve(*LINE, "rise=3 smoots"), ("rise", "smoots")),
    "a logarithmic unit": (solve(*LINE, "rise=3 dB/m"), ("rise", "dB/m")),
    "a word for a number": (solve(*LINE, "rise=high"), ("rise", "high")),
    "a value that is not a number": (solve(*LINE, "rise=nan"), ("rise", "nan")),
    "an infinite value": (solve(*LINE, "rise=inf"), ("rise", "inf")),
    "a value that overflows": (solve(*LINE, "rise=1e999"), ("rise", "1e999")),
    "an empty value": (solve(*LINE, "rise="), ("rise",)),
    "two values for one": (solve(*LINE, "rise=1,2"), ("rise", "1,2")),
    "code for a value": (solve(*LINE, f"rise={HACK}"), ("rise", "__import__")),
    "a value of five thousand letters": (solve(*LINE, f"rise={LONG}"), ("rise", "aaa")),
    "a name of five thousand letters": (solve(*LINE, f"{LONG}=1"), ("aaa", "span")),
    "lines and colours in a value": (solve(*LINE, "rise=\n3\x1b[31m"), ("rise",)),
    "lines and colours in a name": (solve(*LINE, "ri\nse\x1b[31m=3"), ("catenary_exact",)),
    "a negative span": (solve(LINE[0], "span=-2.5", *LINE[2:]), ("span", "> 0 m", "-2.5")),
    "a span of zero": (solve(LINE[0], "span=0 km", *LINE[2:]), ("span", "> 0 m")),
    "a missing parameter": (solve(*LINE[:3]), ("weight_per_length", "N m-1")),
    "no parameters": (solve(LINE[0]), ("span",)),
    "both length and length ratio": (solve(*LINE, "length_ratio=1.2"), ("line_length", "length_ratio")),
    "a word for an option": (solve(*LINE, "--option", "nodes=many"), ("nodes", "many")),
    "a fraction for an option": (solve(*LINE, "--option", "nodes=2.5"), ("nodes", "2.5")),
    "an option out of range": (solve(*LINE, "--option", "nodes=1"), ("nodes", "from 2 to 100000")),
    "a million million nodes": (solve(*LINE, "--option", "nodes=1000000000000", "--outputs", "profile"), ("nodes",)),
    "an unknown output": (solve(*LINE, "--outputs", "sog"), ("'sog'", "sag")),
    "an empty output": (solve(*LINE, "--outputs", "sag,,drop"), ("sag,,drop",)),
    "no output": (solve(*LINE, "--outputs", ""), ("names",)),
    "a results folder that is not there": (("scenes", "nothing"), ("nothing", "no such folder")),
    "a results folder that is a file": (("scenes", "good.yaml"), ("good.yaml", "no such folder")),
    "a results folder with a name too long": (("scenes", LONG), ("aaa",)),
    "a query of a results folder that is not there": (("query", "nothing", "tiny"), ("nothing", "no such folder")),
    "a query of results without scenes": (("query", "tables", "tiny"), ("tables", "tiny")),
    "a comparison with nothing": (("compare", "tables", "nothing"), ("nothing", "no such folder")),
    "a tolerance that is no number": (("compare", "tables", "tables", "--tolerance", "x"), ("--tolerance", "x")),
    "a negative tolerance": (("compare", "tables", "tables", "--tolerance", "-1"), ("tolerance", "-1")),
    "a tolerance that is not a number": (("compare", "tables", "tables", "--tolerance", "nan"), ("tolerance", "nan")),
    "a step of a scene that is not there": (("step", "sample", "nothing.yaml", "results"), ("nothing.yaml",)),
    "a step of a plan that is not there": (("step", "solve", "nothing.npz", "shards", "abc"), ("nothing.npz",)),
    "a step of an unknown kind": (("step", "colect", "good.yaml", "results"), ("colect", "collect")),
}


@pytest.mark.parametrize(("arguments", "phrases"), COMMANDS.values(), ids=COMMANDS.keys())
def test_a_command_line_is_refused_that_has(
    arguments: tuple[str, ...], phrases: tuple[str, ...], here: Path, ask: Ask
) -> None:
    before = tree(here.parent)
    assert_refused(ask(*arguments), *phrases)
    assert tree(here.parent) == before


# ---- every parameter and option of every solver, on the command line and in scenes ----

Given = dict[str, str]


def text(value: np.ndarray) -> str:
    """A number, a word, a vector or a list, as long as it is, as a command line takes it."""
    return ",".join(str(part) for part in np.ravel(value).tolist() if part == part)


def good_values(solver: Solver, name: str) -> Given:
    """A good scenario of the first problem that has this parameter, without any that it replaces."""
    spec = solver.parameters.get(name)
    groups = problems(solver.name)
    chosen = next((k for k, group in enumerate(groups) if name in group), 0)
    values = {key: text(value[0]) for key, value in draw(solver.name, 1, seed=1, problem=chosen).items()}
    if spec and spec.instead_of:
        del values[spec.instead_of]
        values[name] = str(spec.typical[0])
    return values


def wrong_values(spec: ParameterSpec) -> list[tuple[str, tuple[str, ...]]]:
    """What no value of a parameter may be, and what must be said of it."""
    if spec.words:
        return [(spec.words[0][:-1], ("unknown value", spec.words[0])), ("2", ("unknown value '2'",)), ("", ())]
    everywhere = [
        ("1 kg", ("kg",)),
        ("1 smoots", ("smoots",)),
        ("wide", ("wide",)),
        ("nan", ("nan",)),
        ("1e61", ("1e+61",)),
    ]
    if spec.vector:
        components = [(f"1,{value},3", phrases) for value, phrases in everywhere]
        return [*components, ("1,2", ("three components",)), ("1,2,3,4", ("three components",)), ("1,,3", ())]
    bounds = [(spec.above, 0.0, ">"), (spec.at_least, -1e-9, ">="), (spec.below, 0.0, "<"), (spec.at_most, 1e-9, "<=")]
    outside = [(str(at + step), (f"{sign} {at:g}",)) for at, step, sign in bounds if at is not None]
    if spec.listed:
        sections = [(f"1,{value}", phrases) for value, phrases in (*everywhere, *outside)]
        return [*sections, ("1,,3", ()), ("1,2,", ()), ("", ())]
    return [*everywhere, *outside, ("1,2", ("1,2",)), ("", ())]


SOLVERS = [load_solver(name) for name in solver_names()]
PARAMETERS = [(solver, name) for solver in SOLVERS for name in solver.parameters]
OPTIONS = [(solver, name) for solver in SOLVERS for name in solver.options]


def named(pairs: list[tuple[Solver, str]]) -> list[str]:
    return [f"{solver.name} {name}" for solver, name in pairs]


def assignments(values: Given) -> tuple[str, ...]:
    return tuple(f"{name}={value}" for name, value in values.items())


def as_scene(solver: Solver, values: Given, options: Given | None = None) -> str:
    """A scene of one case, with all values fixed but one, which is a number if there is any."""
    specs = solver.parameters
    lists = {name for name, value in values.items() if "," in value or (name in specs and specs[name].listed and value)}
    given = {name: value.split(",") if name in lists else value for name, value in values.items()}
    axis = next((name for name in values if name in specs and name not in lists), next(iter(values)))
    return scene(
        design={"cases": [{axis: given.pop(axis)}]},
        fixed=given,
        methods={"asked": {"solver": solver.name, **({"options": options} if options else {})}},
        outputs=[name for name in solver.outputs if name not in values][-1:],
    )


@pytest.mark.parametrize(("solver", "name"), PARAMETERS, ids=named(PARAMETERS))
def test_no_wrong_value_of_a_parameter_is_taken(solver: Solver, name: str, here: Path, ask: Ask) -> None:
    good = good_values(solver, name)
    before = tree(here.parent)
    for value, phrases in wrong_values(solver.parameters[name]):
        assert_refused(ask("solve", solver.name, *assignments(good | {name: value})), name, *phrases)
    assert tree(here.parent) == before


@pytest.mark.parametrize(("solver", "name"), PARAMETERS, ids=named(PARAMETERS))
def test_no_wrong_value_of_a_parameter_is_taken_from_a_scene(solver: Solver, name: str, here: Path, ask: Ask) -> None:
    good = good_values(solver, name)
    for value, phrases in wrong_values(solver.parameters[name]):
        (here / "asked.yaml").write_text(as_scene(solver, good | {name: value}))
        before = tree(here.parent)
        assert_refused(ask("run", "asked.yaml"), "asked.yaml", name, *(phrase for phrase in phrases if phrase != "1,2"))
        assert tree(here.parent) == before


@pytest.mark.parametrize(("solver", "name"), PARAMETERS, ids=named(PARAMETERS))
def test_a_misspelt_or_repeated_parameter_is_refused(solver: Solver, name: str, here: Path, ask: Ask) -> None:
    good = good_values(solver, name)
    misspelt = {**good, name[:-2] + name[-1]: good[name]}
    assert_refused(ask("solve", solver.name, *assignments(misspelt)), "did you mean", name)
    assert_refused(ask("solve", solver.name, *assignments(good), f"{name}={good[name]}"), name, "twice")
    (here / "asked.yaml").write_text(as_scene(solver, misspelt))
    assert_refused(ask("run", "asked.yaml"), "asked.yaml", name[:-2] + name[-1], name)


@pytest.mark.parametrize(("solver", "name"), PARAMETERS, ids=named(PARAMETERS))
def test_a_missing_parameter_is_asked_for(solver: Solver, name: str, here: Path, ask: Ask) -> None:
    """One with a default may be missing, or one that says what happens otherwise, and what would replace that."""
    good = good_values(solver, name)
    given = {key: value for key, value in good.items() if key != name}
    spec = solver.parameters[name]
    if spec.may_be_missing or (spec.instead_of and solver.parameters[spec.instead_of].may_be_missing):
        assert ask("solve", solver.name, *assignments(given)).code in (0, 1)
        return
    wanted = spec.instead_of or name
    assert_refused(ask("solve", solver.name, *assignments(given)), wanted)
    if given:  # a scene is one of something
        (here / "asked.yaml").write_text(as_scene(solver, given))
        assert_refused(ask("run", "asked.yaml"), "asked.yaml", "methods.asked", wanted)


VECTORS = [(solver, name) for solver, name in PARAMETERS if solver.parameters[name].vector]


@pytest.mark.parametrize(("solver", "name"), VECTORS, ids=named(VECTORS))
def test_a_vector_in_part_is_refused(solver: Solver, name: str, here: Path, ask: Ask) -> None:
    good = good_values(solver, name)
    whole = good.pop(name)
    cases = [
        ({f"{name}_x": "1", f"{name}_z": "2"}, f"{name}_y must be given"),
        ({f"{name}_w": "1", name: whole}, f"{name}_w"),
        ({f"{name}_x": "1", name: whole}, "given twice"),
        ({f"{name}_x": "1 kg", f"{name}_y": "1", f"{name}_z": "1"}, "kg"),
        ({f"{name}_x": "1,2", f"{name}_y": "1", f"{name}_z": "1"}, "1,2"),
    ]
    for parts, phrase in cases:
        assert_refused(ask("solve", solver.name, *assignments(good | parts)), phrase)
        (here / "asked.yaml").write_text(as_scene(solver, good | parts))
        assert_refused(ask("run", "asked.yaml"), "asked.yaml", *([phrase] if phrase != "1,2" else []))


LISTS = [(solver, name) for solver, name in PARAMETERS if solver.parameters[name].listed]


@pytest.mark.parametrize(("solver", "name"), LISTS, ids=named(LISTS))
def test_a_list_in_part_is_refused(solver: Solver, name: str, here: Path, ask: Ask) -> None:
    good = good_values(solver, name)
    whole = good.pop(name)
    more = "1,2,3,4,5,6,7"
    cases = [
        ({f"{name}_1": "1", f"{name}_3": "2"}, f"{name} has 3 sections: {name}_2 must be given"),
        ({f"{name}_1": "1", name: whole}, "given twice"),
        ({f"{name}_1": "1", f"{name}_2": "1 kg"}, "kg"),
        ({f"{name}_0": "1", name: whole}, f"did you mean {name}"),
        ({f"{name}_101": "1", name: whole}, f"did you mean {name}"),
        ({name: more}, "must have the same number of sections: they have "),
    ]
    for parts, phrase in cases:
        assert_refused(ask("solve", solver.name, *assignments(good | parts)), phrase)
        (here / "asked.yaml").write_text(as_scene(solver, good | parts))
        assert_refused(ask("run", "asked.yaml"), "asked.yaml", phrase)


CHOICES = [(solver, name) for solver, name in PARAMETERS if any(name in group for group in problems(solver.name)[:-1])]


@pytest.mark.parametrize(("solver", "name"), CHOICES, ids=named(CHOICES))
def test_parameters_of_no_problem_or_of_two_are_refused(solver: Solver, name: str, here: Path, ask: Ask) -> None:
    good = good_values(solver, name)
    alternatives = {key for group in problems(solver.name) for key in group}
    rest = {key: value for key, value in good.items() if key not in alternatives}
    everything = {
        key: value
        for k in range(len(problems(solver.name)))
        for key, value in good_values_of_problem(solver, k).items()
    }
    in_part = [rest | {name: good[name]}] if (name,) not in problems(solver.name) else []
    for given in (rest, *in_part, everything):
        expected = " and ".join(problems(solver.name)[0])
        assert_refused(ask("solve", solver.name, *assignments(given)), f"give {expected}, or", "given: ")
        (here / "asked.yaml").write_text(as_scene(solver, given))
        assert_refused(ask("run", "asked.yaml"), "asked.yaml", "methods.asked", "given: ")


def good_values_of_problem(solver: Solver, number: int) -> Given:
    return {key: text(value[0]) for key, value in draw(solver.name, 1, seed=1, problem=number).items()}


@pytest.mark.parametrize(("solver", "name"), OPTIONS, ids=named(OPTIONS))
def test_no_wrong_value_of_an_option_is_taken(solver: Solver, name: str, here: Path, ask: Ask) -> None:
    good, option = good_values(solver, ""), solver.options[name]
    wrong = ["nan", "", "1 m", "1,2", "many"]
    if not option.one_of:
        bounds = ((option.at_least, -1), (option.at_most, 1))
        wrong += [str(at + step) for at, step in bounds if at is not None] + ["inf"]
    if isinstance(option.default, int):
        wrong.append("2.5")
    for value in wrong:
        answer = ask("solve", solver.name, *assignments(good), "--option", f"{name}={value}")
        assert_refused(answer, name, value)
        (here / "asked.yaml").write_text(as_scene(solver, good, {name: value}))
        assert_refused(ask("run", "asked.yaml"), "asked.yaml", "methods.asked", name)
    misspelt = ask("solve", solver.name, *assignments(good), "--option", f"{name[:-2] + name[-1]}={option.default}")
    assert_refused(misspelt, "did you mean", name)


# ---- queries ----

QUERIES: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "an unknown scene": (("tinny",), ("'tinny'", "did you mean tiny?")),
    "a scene by its file name": (("tiny.nc",), ("tiny.nc",)),
    "a scene by a path": (("../results/tiny",), ("../results/tiny",)),
    "an empty scene": (("",), ("no scene",)),
    "an unknown format": (("tiny", "--format", "xml"), ("'xml'", "csv", "json", "parquet")),
    "an empty format": (("tiny", "--format", ""), ("csv",)),
    "an unknown column": (("tiny", "--columns", "sog"), ("'sog'", "sag")),
    "an empty column": (("tiny", "--columns", "sag,,max_tension"), ("sag,,max_tension",)),
    "no column": (("tiny", "--columns", ""), ("names",)),
    "a column with many values a scenario": (("tiny", "--columns", "profile"), ("profile",)),
    "a column of a method": (("tiny", "--columns", "exact.sag"), ("exact.sag",)),
    "an unknown column for a file": (("tiny", "--columns", "sog", "--output", "out.csv"), ("sog",)),
    "two conditions": (("tiny", "sag > 1", "sag < 2"), ("sag < 2",)),
}


@pytest.mark.parametrize(("arguments", "phrases"), QUERIES.values(), ids=QUERIES.keys())
def test_a_query_is_refused_that_has(
    arguments: tuple[str, ...], phrases: tuple[str, ...], in_study: Path, ask: Ask
) -> None:
    before = tree(in_study)
    assert_refused(ask("query", "results", *arguments), *phrases)
    assert tree(in_study) == before


def test_a_step_is_refused_for_a_shard_that_is_not_in_the_plan(in_study: Path, ask: Ask) -> None:
    plan = next(Path("results", "plans").iterdir())
    before = tree(in_study)
    assert_refused(ask("step", "solve", plan, "shards", "0" * 24), str(plan), "0" * 24)
    assert tree(in_study) == before


# ---- conditions of a query ----

CONDITIONS = {
    "a call of code": (HACK, "__import__"),
    "a call of code inside a comparison": (f"sag > {HACK}", "__import__"),
    "an opened file": ("open('hacked', 'w') == 1", "open"),
    "an attribute": ("sag.values > 1", "sag.values"),
    "an attribute of a class": ("sag.__class__ > 1", "sag.__class__"),
    "a chain of attributes": ("().__class__.__bases__ == 1", "column 2"),
    "a lambda": ("(lambda: 1)() == 1", "column 8"),
    "a comprehension": ("[s for s in sag] == 1", "column 1"),
    "a subscript": ("sag[0] > 1", "column 4"),
    "an f-string": ("f'{sag}' == 1", "column 2"),
    "a semicolon": ("sag > 1; touch hacked", "; touch hack"),
    "backticks": ("`touch hacked`", "`touch hacke"),
    "a dollar sign": ("$(touch hacked) > 1", "$(touch hack"),
    "a dunder name": ("__builtins__ > 1", "__builtins__"),
    "an assignment": ("sag = 1", "column 5"),
    "a walrus": ("(sag := 1) > 0", "column 6"),
    "an import": ("import os", "column 8"),
    "a comment": ("sag > 1 # all", "# all"),
    "a query of another language": ("sag > 1; DROP TABLE scenes", "; DROP TABLE"),
    "an escape from a query of another language": ("sag > 1' OR '1'='1", "column 8"),
    "a sign of another alphabet": ("sag \N{FULLWIDTH GREATER-THAN SIGN} 1", "column 5"),
    "a zero byte": ("sag > 1\0", "column 8"),
    "ten thousand characters": ("sag > 1 or " * 1000 + "sag > 1", "too long"),
    "ten thousand parentheses": ("(" * 10_000 + "sag > 1" + ")" * 10_000, "too long"),
    "two hundred negations": ("not " * 200 + "sag > 1", "nested"),
    "two hundred powers": ("2 ** " * 180 + "2 > sag", "nested"),
    "four hundred open parentheses": ("(" * 400 + "sag > 1", "cannot read"),
    "a unit of the wrong dimension": ("sag > 20 kN", "in m", "kg"),
    "a unit of the wrong dimension in a sum": ("sag + 2 N > 1", "in m", "kg"),
    "a unit of the wrong dimension in a product": ("sag * span > 3 m", "m**2"),
    "a unit of the wrong dimension in a root": ("sqrt(sag) > 1 m", "m**0.5"),
    "a unit in an exponent": ("sag ** (2 m) > 1 m", "m"),
    "the sine of a force": ("sin(2 kN) > 0.1", "sin", "kg"),
    "an unknown unit": ("sag > 20 smoots", "smoots"),
    "a logarithmic unit": ("sag > 3 dB/m", "dB/m"),
    "an unknown name": ("sog > 1 m", "'sog'", "did you mean sag"),
    "an unknown method": ("exakt.sag > 1", "exakt.sag", "exact"),
    "an unknown output of a method": ("exact.sog > 1", "exact.sog"),
    "not a number": ("sag > nan", "nan"),
    "a number that overflows": ("sag > 1e999", "1e999"),
    "a word compared with a number": ("status > 1", "word"),
    "a word equal to a number": ("status == 0", "word"),
    "a number compared with a word": ("sag == ok", "ok"),
    "a word in a sum": ("method + 1 > 2", "word"),
    "words in order": ("status > ok", "=="),
    "an unknown status": ("status == infeasable", "infeasable", "infeasible"),
    "an unknown method as a word": ("method == exakt", "exakt", "exact"),
    "two kinds of words": ("status == method", "word"),
    "a word and a word": ("'ok' == 'ok'", "ok"),
    "a value and no condition": ("sag", "condition"),
    "a number and no condition": ("1 m", "condition"),
    "a sum and no condition": ("sag + 1 m", "condition"),
    "a value joined to a condition": ("sag > 1 and max_tension", "and"),
    "a negated value": ("not sag", "not"),
    "a condition used as a number": ("(sag > 1) + 1 > 0", "condition"),
    "a condition compared with a number": ("(sag > 1) > 0", "condition"),
    "a chain of comparisons": ("0.5 m < sag < 1 m", "column 13"),
    "a parenthesis too few": ("((sag > 1)", "cannot read"),
    "a parenthesis too many": ("sag > 1)", "column 8"),
    "two comparisons in a row": ("sag > > 1", "column 7"),
    "half a comparison": ("sag >", "cannot read"),
    "half of an and": ("sag > 1 and", "cannot read"),
    "an unknown function": ("sine(sag) > 1", "'sine'", "sin"),
    "too few arguments": ("min(sag) > 1", "min", "2 arguments"),
    "too many arguments": ("abs(sag, 1) > 1", "abs", "1 argument"),
    "no arguments": ("sqrt() > 1", "column 6"),
    "a function without arguments": ("sqrt > 1", "sqrt"),
    "an answer for each node": ("profile > 1 m", "node"),
    "nothing in it": ("", "empty"),
    "a space in it": (" ", "empty"),
}


@pytest.mark.parametrize("case", CONDITIONS.values(), ids=CONDITIONS.keys())
def test_a_condition_is_refused_that_has(case: tuple[str, ...], in_study: Path, ask: Ask) -> None:
    condition, *phrases = case
    before = tree(in_study)
    assert_refused(ask("query", "results", "tiny", condition, "--format", "csv"), *phrases)
    assert tree(in_study) == before


# ---- the installed command ----

INSTALLED = {
    "an unknown solver": (("describe", "catenry_exact"), "catenary_exact"),
    "a table out of the folder": (("run", "asked.yaml"), "../outside.csv"),
    "bytes that are no text": (("solve", "catenary_exact", b"span=\xff"), "span"),
    "a condition with code": (("query", "tables", "tiny", HACK), "tiny"),
}


@pytest.mark.parametrize(("arguments", "phrase"), INSTALLED.values(), ids=INSTALLED.keys())
def test_the_installed_command_refuses(arguments: tuple[str | bytes, ...], phrase: str, here: Path) -> None:
    (here / "asked.yaml").write_text(scene(reference="{table: ../outside.csv}"))
    before = tree(here.parent)
    command = Path(sysconfig.get_path("scripts")) / "cablesim"
    done = subprocess.run([command, *arguments], cwd=here, capture_output=True, timeout=60, check=False)
    assert_refused(Answer(done.returncode, done.stdout, done.stderr.decode()), phrase)
    assert tree(here.parent) == before


def test_the_module_refuses_as_the_command_does(here: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "cablesim", "check", "nothing.yaml"],
        cwd=here,
        capture_output=True,
        timeout=60,
        check=False,
    )
    assert_refused(Answer(done.returncode, done.stdout, done.stderr.decode()), "nothing.yaml")
    assert call(("--version",)) == 0
