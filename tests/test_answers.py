"""Answers: text with formulas over all scenarios, checked when a scene is read and computed from its dataset."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from cablesim.config.scene import read_scene
from cablesim.database import reading
from cablesim.database.reading import read_dataset
from cablesim.errors import InputError
from cablesim.plan import plan_digest
from cablesim.report.answer import answer
from cablesim.steps import run_scene
from cablesim.study import Layout
from cablesim.workflow import STEP_MODULES, plan_study

# Lines of the second length are too short, those of the third where there is a rise.
PROJECT = Path(__file__).parent.parent
SPANS: dict[str, Any] = {
    "title": "Spans",
    "question": "How deep do they hang?",
    "design": {"grid": {"rise": ["0 m", "4 m"], "length_ratio": [1.3, 0.9, 1.05, 1.2]}},
    "fixed": {"span": "10 m", "weight_per_length": "2 N/m"},
    "methods": {"exact": {"solver": "catenary_exact"}, "level": {"solver": "catenary_parabolic", "ignores": ["rise"]}},
    "reference": "exact",
    "outputs": ["sag", "max_tension", "profile"],
    "checks": {"shallow": "sag < 4 m"},
}


def scene(folder: Path, told: str | None, **parts: Any) -> Path:
    path = folder / "spans.yaml"
    path.write_text(json.dumps(SPANS | ({} if told is None else {"answer": told}) | parts, indent=1))
    return path


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> xr.Dataset:
    folder = tmp_path_factory.mktemp("answers")
    layout = Layout(folder / "results")
    run_scene(read_scene(scene(folder, None)), layout, lambda step, done, total: None)
    return read_dataset(layout.dataset("spans"))


def told(folder: Path, dataset: xr.Dataset, text: str, **parts: Any) -> str:
    return answer(read_scene(scene(folder, text, **parts)), dataset)


# ---- values ----


def exact(dataset: xr.Dataset, name: str = "sag") -> xr.DataArray:
    return dataset[name].sel({"method": "exact"})


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("largest(exact.sag)", lambda d: np.nanmax(exact(d))),
        ("smallest(exact.sag)", lambda d: np.nanmin(exact(d))),
        ("median(exact.sag)", lambda d: np.nanmedian(exact(d))),
        ("mean(exact.sag)", lambda d: np.nanmean(exact(d))),
        ("largest(sag)", lambda d: np.nanmax(d.sag)),
        ("largest(exact.sag, rise == 4 m)", lambda d: np.nanmax(exact(d).sel(rise=4))),
        ("largest(exact.sag) / span", lambda d: np.nanmax(exact(d)) / 10),
        ("largest(abs(1 - level.sag / exact.sag))", lambda d: np.nanmax(abs(1 - d.sag[1] / d.sag[0]))),
        ("value(exact.sag, rise == 400 cm and length_ratio == 1.2)", lambda d: exact(d).sel(rise=4, length_ratio=1.2)),
        ("at_largest(exact.max_tension, length_ratio)", lambda d: 1.05),
        ("at_smallest(exact.max_tension, length_ratio, length_ratio < 1.25)", lambda d: 1.2),
        ("share(exact.sag > 0 m)", lambda d: np.isfinite(exact(d)).mean()),
        ("share(sag > 0, method == level)", lambda d: 0.75),
        ("scenarios", lambda d: 8),
        ("largest(rise, exact.sag > 0)", lambda d: 4),
        ("largest(exact.sag - median(exact.sag))", lambda d: np.nanmax(exact(d)) - np.nanmedian(exact(d))),
    ],
)
def test_a_formula_over_all_scenarios_has_one_value(formula, expected, dataset, tmp_path):
    assert told(tmp_path, dataset, f"{{{formula}:.12g}}") == f"{float(expected(dataset)):.12g}"


@pytest.mark.parametrize(
    ("condition", "number"),
    [
        ("status == ok", 11),
        ("status == infeasible", 5),
        ("rise == 4 m", 4),
        ("rise == 4 m and length_ratio > 1.1", 2),
        ("method == exact", 8),
        ("exact.shallow == passed", 5),
    ],
)
def test_count_is_of_scenarios(condition, number, dataset, tmp_path):
    assert told(tmp_path, dataset, f"{{count({condition}):d}}") == str(number)


def test_a_condition_on_cases_counts_each_case_once(tmp_path):
    cases = {"cases": [{"span": s, "line_length": 12} for s in (9, 10, 11, 13)]}
    path = scene(
        tmp_path, "{count(span > 9.5 m)} of {scenarios}", design=cases, fixed={"weight_per_length": 2, "rise": 0}
    )
    assert solved(path, tmp_path) == "3 of 4"


def solved(path: Path, folder: Path) -> str:
    """The answer of a scene, written by a run of it."""
    layout = Layout(folder / "results")
    run_scene(read_scene(path), layout, lambda step, done, total: None)
    text = (layout.tables / f"{path.stem}_answer.md").read_text()
    return text.strip().rpartition("\n\n")[2]


@pytest.mark.parametrize(
    ("formula", "word"),
    [
        ("at_largest(max_tension, method)", "exact"),
        ("at_smallest(sag, method, rise == 0 m and length_ratio == 1.3)", "level"),
        ("value(status, method == exact and rise == 4 m and length_ratio == 0.9)", "infeasible"),
        ("value(exact.shallow, rise == 0 m and length_ratio == 1.2)", "passed"),
        ("at_largest(length_ratio, status, method == exact and rise == 0)", "ok"),
    ],
)
def test_an_answer_may_be_a_word(formula, word, dataset, tmp_path):
    assert told(tmp_path, dataset, f"{{{formula}}}") == word


@pytest.mark.parametrize(
    ("written", "text"),
    [
        ("{largest(length_ratio):.1f}", "1.3"),
        ("{largest(length_ratio):.0f %}", "130 %"),
        ("{share(status == ok):.1f %}", "68.8 %"),
        ("{weight_per_length * span:.1f N}", "20.0 N"),
        ("{value(rise, rise == 4 m):.0f cm}", "400 cm"),
        ("{1234567 * largest(rise) / 4 m:,.0f}", "1,234,567"),
        ("{acos(0):.0f deg}", "90 deg"),
        ("{-0.001 * span:.0f}", "0"),
        ("{span}", "10"),
        ("{span / 3}", "3.33"),
        ("{2e16}", "2e+16"),
    ],
)
def test_numbers_are_written_in_their_format_and_unit(written, text, dataset, tmp_path):
    assert told(tmp_path, dataset, written) == text


@pytest.mark.parametrize(
    "formula",
    [
        "{largest(exact.sag, length_ratio == 0.9):.2f m}",
        "{value(exact.sag, rise == 4 m and length_ratio == 1.05)}",
        "{at_largest(exact.sag, length_ratio, exact.sag > 1 km):.3g}",
        "{at_largest(exact.sag, status, method == exact and exact.sag > 1 km)}",
        "{median(exact.sag, exact.sag > 1 km) + 2 m}",
        "{share(exact.sag > 1 m, length_ratio > 7):.0f %}",
        "{1 / smallest(rise)}",
    ],
)
def test_what_has_no_value_is_a_dash(formula, dataset, tmp_path):
    assert told(tmp_path, dataset, formula) == "-"


def test_a_dataset_that_is_not_held_in_memory_gives_the_same(tmp_path, monkeypatch):
    text = "{largest(abs(1 - level.sag / exact.sag)):.9g} {count(status == ok)} {at_largest(max_tension, method)}"
    layout = Layout(tmp_path / "results")
    path = scene(tmp_path, text)
    run_scene(read_scene(path), layout, lambda step, done, total: None)
    held = answer(read_scene(path), read_dataset(layout.dataset("spans")))
    monkeypatch.setattr(reading, "MOST_BYTES", 0)
    assert answer(read_scene(path), read_dataset(layout.dataset("spans"))) == held


def test_a_scene_without_an_answer_tells_fates_errors_and_checks(dataset, tmp_path):
    text = answer(read_scene(scene(tmp_path, None)), dataset)
    assert text.startswith("11 of 16 scenarios are solved; 5 infeasible. level differs from exact by up to ")
    assert text.endswith("Check shallow: 11 passed, 0 failed, 5 unknown.")


def test_title_question_and_answer_are_written(tmp_path):
    assert solved(scene(tmp_path, "{scenarios} lines."), tmp_path) == "8 lines."
    written = (tmp_path / "results" / "tables" / "spans_answer.md").read_text()
    assert written == "# Spans\n\nHow deep do they hang?\n\n8 lines.\n"


def test_a_run_and_the_list_of_scenes_print_it(tmp_path):
    path = scene(tmp_path, "{count(status == ok)} lines hang.")
    for command in (["run", str(path), "--out", "results"], ["scenes", "results", "spans"]):
        run = [sys.executable, "-m", "cablesim", *command]
        printed = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, timeout=300, check=False)
        assert "\n11 lines hang.\n" in printed.stdout, printed.stderr


# ---- printed tables, audits and orders ----


@pytest.mark.parametrize(
    ("name", "phrases"),
    [
        (
            "formula_error",
            ("Of 16 printed errors of the parabola 15 hold", "at a ratio of 1.01 is printed as 0.4 %, and is 0.348 %"),
        ),
        ("limit_ratio", ("1.0898737 for the sag and 1.0743387 for the largest tension", "0 of 200 permitted errors")),
        ("chain_places", ("most play in the middle (11.07 m, and 47.4 m of sag)",)),
        ("weight_play_example", ("By 2.612 m: 2 of the 3 printed numbers",)),
        ("equal_strength_off_design", ("by order 2.00",)),
    ],
)
def test_answers_of_our_scenes_hold_what_they_are_known_for(name, phrases, tmp_path):
    text = solved(PROJECT / "config" / "scenes" / f"{name}.yaml", tmp_path)
    assert [phrase for phrase in phrases if phrase not in text] == [], text


@pytest.mark.parametrize("path", sorted((PROJECT / "config" / "scenes").glob("*.yaml")), ids=lambda path: path.stem)
def test_every_scene_of_ours_asks_a_question_and_answers_it(path):
    read = read_scene(path)
    assert read.question and read.answer is not None


# ---- what is refused ----

REFUSED = {
    "a brace that is not closed": ("so {largest(sag)", ("'{' without its other half", "{largest(sag)")),
    "a brace that is not opened": ("so sag}", ("'}' without its other half",)),
    "a placeholder in another": ("{largest({sag})}", ("without its other half",)),
    "nothing in its braces": ("{}", ("empty",)),
    "half a formula": ("{1 +}", ("column 3",)),
    "an unknown name": ("{largest(sg)}", ("unknown name 'sg'", "did you mean sag")),
    "an unknown function": ("{lrgest(sag)}", ("unknown function 'lrgest'", "did you mean largest")),
    "an unknown method": ("{largest(exat.sag)}", ("unknown name 'exat.sag'", "exact.sag")),
    "an unknown word": ("{count(status == okay)}", ("unknown word 'okay'", "did you mean ok?")),
    "an unknown word to be told": ("{at_largest(sag, metod)}", ("unknown name 'metod'", "did you mean method?")),
    "no reduction": ("{exact.sag}", ("varies along length_ratio and rise", "largest(exact.sag)")),
    "a word for each scenario": ("{status}", ("varies along",)),
    "a condition": ("{largest(sag) > 2 m}", ("a condition cannot be used as a number",)),
    "a condition for a number": ("{largest(sag > 2 m)}", ("a condition cannot be used as a number",)),
    "a number for a condition": ("{count(sag)}", ("a condition is expected",)),
    "a number for a second condition": ("{largest(sag, sag)}", ("a condition is expected",)),
    "a word for a number": ("{largest(status)}", ("a word cannot be used as a number",)),
    "too few arguments": ("{at_largest(sag)}", ("at_largest(x, y)",)),
    "too many arguments": ("{count(sag > 2 m, rise > 0 m, rise > 1 m)}", ("count(condition)",)),
    "a vector along the line": ("{largest(profile)}", ("along component",)),
    "two values": ("{value(exact.sag, rise == 4 m)}", ("value is of one scenario, not of 4 along length_ratio",)),
    "values of two methods": ("{value(sag, rise == 4 m and length_ratio == 1.2)}", ("not of 2 along method",)),
    "a value of none": ("{value(exact.sag, rise == 5 m and length_ratio == 1.2)}", ("no scenario has this rise",)),
    "a place that is no value": ("{at_largest(exact.sag, method)}", ("at_largest also varies along method",)),
    "a unit of another dimension": ("{largest(sag):.2f kN}", ("'kN' is of another dimension", "in m")),
    "an unknown unit": ("{largest(sag):.2f foo}", ("unknown unit 'foo'",)),
    "units that do not go together": ("{largest(sag + 2 N)}", ("cannot be compared with or added to",)),
    "an unknown format": ("{largest(sag):.2q}", ("'.2q' is no format", ".3g")),
    "a format of Python's for a field": ("{largest(sag):>100}", ("is no format",)),
    "a format for a word": ("{at_largest(sag, method):.3g}", ("is a word",)),
    "a count of cells without an audit": ("{cells(agrees)}", ("no published table",)),
    "an order without a series": ("{order(level, sag)}", ("unknown word 'level'",)),
    "advice where nothing is timed": ("{advice}", ("unknown name 'advice'",)),
    "a number where text is expected": (12, ("text is expected",)),
    "no text": ("", ("text is expected",)),
}  # fmt: skip


@pytest.mark.parametrize(("text", "phrases"), REFUSED.values(), ids=REFUSED)
def test_an_answer_is_refused_that_has(text, phrases, tmp_path):
    path = scene(tmp_path, text)
    with pytest.raises(InputError) as refusal:
        read_scene(path)
    message = str(refusal.value)
    line = next(i for i, line in enumerate(path.read_text().splitlines(), 1) if '"answer"' in line)
    assert message.startswith(f"{path}:{line}: answer: ") and "\n" not in message
    assert [phrase for phrase in phrases if phrase not in message] == [], message


@pytest.mark.parametrize("text", ["{largest(sag)}", "{count(status == ok)}"])
def test_reductions_are_for_answers_only(text, tmp_path):
    figures = {"one": {"kind": "curves", "x": "length_ratio", "y": text.strip("{}"), "each": "rise"}}
    with pytest.raises(InputError, match="unknown function"):
        read_scene(scene(tmp_path, None, figures=figures))


# ---- what an edit of an answer does ----


def test_an_answer_decides_no_number_and_a_question_is_in_the_dataset(tmp_path):
    before = plan_digest(read_scene(scene(tmp_path, "{scenarios} lines.")))
    assert plan_digest(read_scene(scene(tmp_path, "All {scenarios} lines."))) == before
    assert plan_digest(read_scene(scene(tmp_path, None))) == before
    assert plan_digest(read_scene(scene(tmp_path, None, question="How far?"))) != before


def test_an_edit_of_an_answer_makes_only_the_tables_out_of_date(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "config" / "scenes").mkdir(parents=True)
    (tmp_path / "config" / "config.yaml").write_text("study: small\nscenes: [spans]\n")
    stamps = []
    for text in ("{scenarios} lines.", "All {scenarios} lines."):
        scene(tmp_path / "config" / "scenes", text)
        planned = plan_study("config/config.yaml", checking=False)
        stamps.append({step: planned.scene("spans").stamp(step) for step in STEP_MODULES})
    assert {step for step in STEP_MODULES if stamps[0][step] != stamps[1][step]} == {"summarise"}
