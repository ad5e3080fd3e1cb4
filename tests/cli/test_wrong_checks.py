"""Wrong checks of a scene: refused with one line, nothing is written; and what a run says of good ones."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.cli.helpers import Answer, assert_refused, scene, tree

Ask = Callable[..., Answer]
LIMIT = {"limit": "max_tension < 3 N * safety", "with": {"safety": 2}}
MONOTONE = {"monotone": "sag", "along": "length_ratio", "sense": "increasing"}
CASES = "{cases: [{length_ratio: 1.1}, {length_ratio: 1.2}]}"
STREAM = {
    "design": "{grid: {friction_law: [constant, zero], force_A: [[0, 0, 300], [100, 0, 300]]}}",
    "fixed": "{line_length: 20, weight_per_length: 1, diameter: 0.01, fluid_density: 1000, stream_speed: 1,"
    " normal_drag_coefficient: 1.2, tangential_drag_coefficient: 0.03}",
    "methods": "{exact: {solver: stream_line}}",
    "outputs": "[position_B]",
}
WRONG = {
    "an unknown key": (LIMIT | {"where": "sag > 0"}, ("checks.look.where", "with")),
    "nothing in it": ({}, ("checks.look", "limit", "monotone")),
    "values alone": ({"with": {"safety": 2}}, ("checks.look", "limit", "monotone")),
    "a limit and a value that grows": (LIMIT | MONOTONE, ("checks.look.monotone", "with")),
    "a list": (["sag > 0"], ("checks.look", "a list")),
    "a value": ("sag", ("checks.look", "condition")),
    "a number": (5, ("checks.look", "condition")),
    "an unknown name": ("sagg > 0", ("checks.look", "sagg", "did you mean sag")),
    "an unknown name in a limit": (LIMIT | {"limit": "max_tension < safty"}, ("checks.look.limit", "safty", "safety")),
    "an unknown method": ("exakt.sag > 0", ("checks.look", "exakt.sag", "exact.sag")),
    "code for a condition": ("__import__('os')", ("checks.look", "__import__")),
    "another unit": ("sag < 3 kg", ("checks.look", "kg")),
    "another unit in a value": ({"limit": "sag < most", "with": {"most": "3 kg"}}, ("checks.look.limit", "kg")),
    "a profile": ("profile > 0", ("checks.look", "component")),
    "the run time": ("run_time < 1", ("checks.look", "run_time", "measured")),
    "the run time of a method": (MONOTONE | {"monotone": "exact.run_time"}, ("checks.look.monotone", "measured")),
    "no name of the scene": (
        {"limit": "safety > 1", "with": {"safety": 2}},
        ("checks.look.limit", "no name of the scene"),
    ),
    "numbers alone": ("2 > 1", ("checks.look", "no name of the scene")),
    "a list of values": (LIMIT | {"with": [2]}, ("checks.look.with", "a list")),
    "a value that is not used": (
        LIMIT | {"with": {"safety": 2, "breaking_strength": 3}},
        ("checks.look.with.breaking_strength", "safety"),
    ),
    "a quantity in another unit": (
        {"limit": "max_tension < breaking_strength", "with": {"breaking_strength": "80 m"}},
        ("checks.look.with.breaking_strength", "N"),
    ),
    "a value in an unknown unit": (LIMIT | {"with": {"safety": "2 smoot"}}, ("checks.look.with.safety", "smoot")),
    "a word for a value": (LIMIT | {"with": {"safety": "two"}}, ("checks.look.with.safety", "number")),
    "an endless value": (LIMIT | {"with": {"safety": 1e999}}, ("checks.look.with.safety", "Infinity")),
    "a value of a parameter's name": (LIMIT | {"with": {"span": 2}}, ("checks.look.with.span", "another name")),
    "a value of an output's name": (LIMIT | {"with": {"sag": 2}}, ("checks.look.with.sag", "another name")),
    "a value of a method's name": (LIMIT | {"with": {"exact": 2}}, ("checks.look.with.exact", "another name")),
    "a value called status": (LIMIT | {"with": {"status": 2}}, ("checks.look.with.status", "another name")),
    "a vector for a value": (LIMIT | {"with": {"force_A": 2}}, ("checks.look.with.force_A", "single number")),
    "a value with a bad name": (LIMIT | {"with": {"a-b": 2}}, ("checks.look.with.a-b", "name")),
    "no axis": ({"monotone": "sag", "sense": "increasing"}, ("checks.look", "'along'")),
    "no sense": ({"monotone": "sag", "along": "length_ratio"}, ("checks.look", "'sense'")),
    "another sense": (MONOTONE | {"sense": "rising"}, ("checks.look.sense", "rising", "increasing")),
    "what is no axis": (MONOTONE | {"along": "span"}, ("checks.look.along", "span", "length_ratio")),
    "an unknown value": (MONOTONE | {"monotone": "sagg"}, ("checks.look.monotone", "sagg", "sag")),
    "a profile that grows": (MONOTONE | {"monotone": "profile"}, ("checks.look.monotone", "component")),
    "a word that grows": (MONOTONE | {"monotone": "status"}, ("checks.look.monotone", "status")),
    "a condition that grows": (MONOTONE | {"monotone": "sag > 0"}, ("checks.look.monotone", "condition")),
    "a value that does not vary": (MONOTONE | {"monotone": "span"}, ("checks.look.monotone", "length_ratio")),
}
NAMES = ("sag", "span", "length_ratio", "exact", "status", "method", "table", "run_time", "iterations", "node", "drop")
NAMES = (*NAMES, "max_tension", "ok", "failed", "measured", "scenario", "rise", "method_width")


def refused(ask: Ask, here: Path, text: str, *phrases: str) -> None:
    (here / "asked.yaml").write_text(text)
    before = tree(here)
    assert_refused(ask("run", "asked.yaml"), "asked.yaml", *phrases)
    assert tree(here) == before


@pytest.mark.parametrize(("check", "phrases"), WRONG.values(), ids=WRONG)
def test_a_check_is_refused_that_is_or_has(check: object, phrases: tuple[str, ...], here: Path, ask: Ask) -> None:
    refused(ask, here, scene(outputs="[sag, max_tension, profile]", checks={"look": check}), *phrases)


@pytest.mark.parametrize("name", NAMES)
def test_a_name_that_means_something_else_is_refused(name: str, here: Path, ask: Ask) -> None:
    refused(ask, here, scene(checks={name: "sag > 0"}), f"checks.{name}", "another name")


@pytest.mark.parametrize("name", ["Deep", "too deep", "../deep", "1st", "_deep"])
def test_a_name_that_is_none_is_refused(name: str, here: Path, ask: Ask) -> None:
    refused(ask, here, scene(checks={name: "sag > 0"}), "checks", name)


def test_checks_are_a_mapping(here: Path, ask: Ask) -> None:
    refused(ask, here, scene(checks=["sag > 0"]), "checks", "a mapping")


def test_cases_have_no_order(here: Path, ask: Ask) -> None:
    refused(ask, here, scene(design=CASES, checks={"look": MONOTONE}), "checks.look.along", "grid", "cases")


@pytest.mark.parametrize("axis", ["friction_law", "force_A"])
def test_words_and_vectors_have_no_order(axis: str, here: Path, ask: Ask) -> None:
    check = {"monotone": "position_B_x", "along": axis, "sense": "increasing"}
    refused(ask, here, scene(**STREAM, checks={"look": check}), "checks.look.along", axis, "increase")


@pytest.mark.parametrize("condition", ["position_B > 0", "friction_law == zro"])
def test_vectors_and_unknown_words_are_not_judged(condition: str, here: Path, ask: Ask) -> None:
    refused(ask, here, scene(**STREAM, checks={"look": condition}), "checks.look")


def test_the_line_of_a_wrong_check_is_told(here: Path, ask: Ask) -> None:
    refused(ask, here, scene() + "checks:\n  deep: sag > 0\n  look:\n    limit: sagg > 0\n", "asked.yaml:9: ")


def test_a_wrong_word_for_a_flag_is_refused(here: Path, ask: Ask) -> None:
    figures = {"look": {"kind": "curves", "x": "length_ratio", "y": "sag", "where": "deep == fails"}}
    refused(ask, here, scene(checks={"deep": "sag > 0"}, figures=figures), "figures.look.where", "fails", "failed")


def test_a_table_may_not_be_called_checks(here: Path, ask: Ask) -> None:
    tables = {"checks": {"rows": "length_ratio", "columns": ["sag"]}}
    refused(ask, here, scene(tables=tables), "tables.checks", "another name")


def test_a_run_ends_with_a_line_for_each_check_and_the_answer(here: Path, ask: Ask) -> None:
    checks = {"deep": "sag > 0.6 m", "grows": MONOTONE}
    grid = "{grid: {length_ratio: [0.9, 1.1, 1.2]}}"
    (here / "asked.yaml").write_text(scene(design=grid, checks=checks, answer="'{count(status == ok)} hang.'"))
    answer = ask("run", "asked.yaml", "--out", "results")
    assert answer.code == 1
    assert answer.text.splitlines()[-3:] == [
        "deep: 1 passed, 1 failed, 1 unknown",
        "grows: 2 passed, 0 failed, 1 unknown",
        "2 hang.",
    ]


def test_a_failed_check_is_no_error(here: Path, ask: Ask) -> None:
    (here / "asked.yaml").write_text(scene(checks={"deep": "sag > 100 m"}))
    assert ask("run", "asked.yaml", "--out", "results").code == 0
