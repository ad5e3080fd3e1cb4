"""Lists, all the way from a scene or a command to shards, datasets, queries, tables and figures."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from cablesim.config.scene import read_scene
from cablesim.costs import BESIDE, Sizes
from cablesim.database.query import query
from cablesim.database.reading import evaluate, open_scene, select
from cablesim.errors import InputError
from cablesim.plan import read_plan
from cablesim.quantities import MOST_SECTIONS
from cablesim.report.tables import error_table
from cablesim.steps import run_scene
from cablesim.study import Layout
from tests.cli.helpers import Answer, assert_refused, rendered, scene, tree

Ask = Callable[..., Answer]
JOINED = {
    "design": "{grid: {section_length_2: [0.5 m, 50 m], tension_A: [1 kN, 2 kN, 3 kN]}}",
    "fixed": "{section_length_1: 400 m, section_weight: [80 N/m, 600]}",
    "methods": "{one: {solver: joined_line}}",
    "outputs": "[tension_B, joint_tension]",
}
# Three lines of different numbers of sections; the last is too short for its depth.
CASES = [
    {"section_length": ["400 m", "50 m"], "section_weight": [80, 600]},
    {"section_length": [300], "section_weight": [70]},
    {"section_length": [1, 2, 3], "section_weight": [7, 8, 9]},
]
RAGGED = {"design": {"cases": CASES}, "fixed": "{tension_A: 1 kN, depth: 100 m}"}
TABLE = """wire_length,chain_length [cm],wire,chain,pull
400,5000,80,600,1000
300,,70,,2000
350,2550,75,610,500
"""
COLUMNS = {
    "section_length_1": "wire_length",
    "section_length_2": "chain_length",
    "section_weight_1": "wire",
    "section_weight_2": "2 * chain / 2",
    "tension_A": "pull",
}

pytestmark = pytest.mark.usefixtures("pulled_line")


def joined(**parts: object) -> str:
    return scene(**{**JOINED, **parts})


def run(folder: Path, **parts: object) -> xr.Dataset:
    path = folder / "joined.yaml"
    path.write_text(joined(**parts))
    run_scene(read_scene(path), Layout(folder / "results"), lambda step, done, total: None)
    return open_scene(folder / "results", "joined")


def recipes(folder: Path) -> dict[str, tuple[int, ...]]:
    """The shapes of all shards that any plan has named."""
    plans = (folder / "results").glob("**/*.npz")
    return {digest: recipe.shape for plan in plans for digest, recipe in read_plan(plan).recipes.items()}


# ---- datasets ----


def test_a_grid_over_one_section_has_one_coordinate_for_each_list(tmp_path):
    found = run(tmp_path)
    assert found.joint_tension.dims == ("method", "section_length_2", "tension_A", "section")
    assert found.section_length.dims == ("section_length_2", "section")
    assert found.section_length.values.tolist() == [[400.0, 0.5], [400.0, 50.0]]
    assert found.section_weight.dims == ("section",)
    assert found.section.dtype == np.int32
    assert found.section.values.tolist() == [1, 2]
    expected = {"method", "section", "section_length", "section_length_2", "section_weight", "tension_A"}
    assert set(found.coords) == expected
    assert found.section_length.attrs["units"] == "m"
    np.testing.assert_allclose(found.joint_tension.values[0, :, 1], [[34000, 34300], [34000, 64000]])


def test_axes_over_two_sections_make_a_list_over_both(tmp_path):
    grid = "{grid: {section_length_1: [100, 200, 300], section_length_2: [1, 2]}}"
    found = run(tmp_path, design=grid, fixed="{tension_A: 1, section_weight: [1, 1]}")
    assert found.section_length.dims == ("section_length_1", "section_length_2", "section")
    assert found.section_length.values[2, 1].tolist() == [300.0, 2.0]
    np.testing.assert_allclose(found.tension_B.values[0], [[102, 103], [202, 203], [302, 303]])
    lengths = query(found, "section_length_1 == 200 m", ("section_length_1", "section_length_2"))
    assert lengths.to_numpy().tolist() == [[200.0, 1.0], [200.0, 2.0]]


def test_cases_may_differ_in_length_and_are_padded(tmp_path):
    found = run(tmp_path, **RAGGED)
    assert found.status.values.tolist() == [[0, 0, 1]]
    assert found.section_length.dims == ("scenario", "section")
    nan = np.nan
    np.testing.assert_array_equal(found.section_length, [[400, 50, nan], [300, nan, nan], [1, 2, 3]])
    np.testing.assert_array_equal(found.joint_tension[0], [[33000, 63000, nan], [22000, nan, nan], [nan, nan, nan]])
    assert "section_length_1" not in found.variables


def test_cases_come_from_columns_of_a_table_whose_empty_cells_end_a_line(tmp_path):
    (tmp_path / "lines.csv").write_text(TABLE)
    found = run(tmp_path, design={"cases": {"table": "lines.csv", "columns": COLUMNS}}, fixed=None)
    np.testing.assert_allclose(found.section_length[:, 1], [50.0, np.nan, 25.5])
    np.testing.assert_allclose(found.tension_B[0], [63000, 23000, 26750 + 610 * 25.5])
    (tmp_path / "lines.csv").write_text("section_length_1,section_weight_1,tension_A\n1,2,3\n")
    found = run(tmp_path, design={"cases": {"table": "lines.csv"}}, fixed=None)
    assert found.tension_B.values.tolist() == [[5.0]]


def test_a_sample_draws_sections(tmp_path):
    ranges = "{section_length_2: {start: 1 m, stop: 50 m, spacing: log}, section_weight_1: {start: 70, stop: 90}}"
    design = f"{{sample: {{method: sobol, num: 8, seed: 1, ranges: {ranges}}}}}"
    found = run(tmp_path, design=design, fixed="{section_length_1: 10, section_weight_2: 600, tension_A: 1}")
    assert found.section_length.dims == found.section_weight.dims == ("scenario", "section")
    assert (found.section_length.values[:, 0] == 10.0).all()
    assert len(set(found.section_length.values[:, 1])) == 8
    expected = 1.0 + (found.section_length * found.section_weight).sum("section")
    np.testing.assert_allclose(found.tension_B[0], expected)


def test_fixed_lists_vary_along_nothing(tmp_path):
    fixed = "{section_length: [400 m, 0.05 km], section_weight: [80, 600]}"
    found = run(tmp_path, design="{grid: {tension_A: [1 kN, 2 kN]}}", fixed=fixed)
    assert found.section_length.dims == ("section",)
    assert found.section_length.values.tolist() == [400.0, 50.0]
    assert found.joint_tension.values[0].tolist() == [[33000.0, 63000.0], [34000.0, 64000.0]]


def test_the_dataset_opens_without_us(tmp_path):
    run(tmp_path, **RAGGED)
    with xr.open_dataset(tmp_path / "results" / "joined.nc") as plain:
        assert plain.section_weight.dims == ("scenario", "section")
        assert plain.joint_tension.sel(section=1).values.tolist()[0][:2] == [33000.0, 22000.0]
        assert np.isnan(plain.section_weight.values[1, 1])


# ---- growth ----


def test_a_case_with_more_sections_computes_that_case_alone(tmp_path):
    run(tmp_path, **{**RAGGED, "design": {"cases": CASES[:2]}})
    first = recipes(tmp_path)
    assert list(first.values()) == [(2,)]
    wider = run(tmp_path, **RAGGED)
    second = recipes(tmp_path)
    assert sorted(second.values()) == [(1,), (2,)]
    assert wider.joint_tension.shape == (1, 3, 3)
    assert wider.tension_B.values[0, :2].tolist() == [63000.0, 22000.0]
    # Without the longer line again, and with the first alone, out of the shard that knows both.
    assert run(tmp_path, **{**RAGGED, "design": {"cases": CASES[:2]}}).joint_tension.shape == (1, 2, 2)
    assert run(tmp_path, **{**RAGGED, "design": {"cases": CASES[1:2]}}).joint_tension.values.tolist() == [[[22000.0]]]
    assert recipes(tmp_path) == second


def test_a_shard_of_longer_lines_serves_a_scene_of_shorter_ones(tmp_path):
    run(tmp_path, **RAGGED)
    first = recipes(tmp_path)
    shorter = run(tmp_path, **{**RAGGED, "design": {"cases": [CASES[1], CASES[0]]}})
    assert recipes(tmp_path) == first
    np.testing.assert_array_equal(shorter.joint_tension[0], [[22000, np.nan], [33000, 63000]])
    assert shorter.section.size == 2


def test_a_case_that_differs_in_its_last_section_only_is_another(tmp_path):
    run(tmp_path, **{**RAGGED, "design": {"cases": [CASES[0]]}})
    longer = {"section_length": [400, 50, 7], "section_weight": [80, 600, 1]}
    found = run(tmp_path, **{**RAGGED, "design": {"cases": [CASES[0], longer]}})
    assert found.tension_B.values.tolist() == [[63000.0, 63007.0]]
    assert sorted(recipes(tmp_path).values()) == [(1,), (1,)]


def test_a_value_more_of_a_section_computes_it_alone(tmp_path):
    run(tmp_path)
    run(tmp_path, design="{grid: {section_length_2: [5 m, 0.5 m, 50 m], tension_A: [1 kN, 2 kN, 3 kN]}}")
    assert sorted(recipes(tmp_path).values()) == [(1, 3), (2, 3)]


# ---- formulas, queries, tables, figures ----


def test_sections_have_names_in_formulas_and_queries(tmp_path):
    found = run(tmp_path, **RAGGED)
    assert select(found, "section_length_2 > 1 m").values.tolist() == [True, False, True]
    ratio = evaluate(found, "one.joint_tension_2 / one.joint_tension_1").values
    np.testing.assert_allclose(ratio, [63 / 33, np.nan, np.nan])
    table = query(found, "section_length_2 > 40 m")
    assert table[["scenario", "section_length_2", "joint_tension_2"]].to_numpy().tolist() == [[0.0, 50.0, 63000.0]]
    with pytest.raises(InputError, match="unknown name 'section_length_4': did you mean section_length_"):
        select(found, "section_length_4 > 1 m")
    with pytest.raises(InputError, match="varies along section: one answer a scenario is needed"):
        query(found, "section_length > 1 m")
    with pytest.raises(InputError, match="no column 'joint_tension': did you mean joint_tension_"):
        query(found, None, ("joint_tension",))


def test_a_query_shows_a_missing_section_as_nothing(tmp_path):
    dataset, columns = run(tmp_path, **RAGGED), ("section_length_2", "section_weight_3")
    assert rendered(dataset, "csv", *columns).decode() == f"{','.join(columns)}\nm,N m-1\n50.0,\n,\n2.0,9.0\n"
    found = json.loads(rendered(dataset, "json", *columns))
    assert found["rows"][1] == {"section_length_2": None, "section_weight_3": None}
    assert found["units"] == {"section_length_2": "m", "section_weight_3": "N m-1"}


@pytest.mark.parametrize("form", ["table", "csv", "json", "parquet", "netcdf"])
def test_every_format_takes_lists(form, ask: Ask, tmp_path):
    run(tmp_path, **RAGGED)
    out = tmp_path / "out"
    answer = ask("query", tmp_path / "results", "joined", "section_length_1 > 2 m", "--format", form, "--output", out)
    assert answer.code == 0, answer.err
    assert b"section_length_3" in out.read_bytes()


def test_a_query_by_a_section_of_a_grid(ask: Ask, tmp_path):
    run(tmp_path)
    asked = ("section_length_2 == 50 m and tension_A == 2 kN", "--columns", "section_length_1,joint_tension_2")
    answer = ask("query", tmp_path / "results", "joined", *asked, "--format", "csv")
    assert answer.text == "section_length_1,joint_tension_2\nm,N\n400.0,64000.0\n"


def test_value_and_tension_tables_show_sections(tmp_path):
    run(tmp_path, **RAGGED)
    for name in ("values", "tensions"):
        table = pd.read_csv(tmp_path / "results" / "tables" / f"joined_{name}.csv")
        np.testing.assert_array_equal(table["joint_tension_2"], [63000.0, np.nan, np.nan])
        np.testing.assert_array_equal(table["section_length_3"], [np.nan, np.nan, 3.0])


def test_the_error_of_a_list_is_the_largest_of_its_sections(tmp_path):
    found = run(tmp_path, **RAGGED, methods="{one: {solver: joined_line}, two: {solver: joined_line}}", reference="one")
    off = found.joint_tension.values
    off[1, 0] += [330.0, 630.0, 0.0]
    off[1, 1] += [440.0, 0.0, 0.0]
    table = error_table(read_scene(tmp_path / "joined.yaml"), found).set_index("output")
    row = table.loc["joint_tension"]
    assert (row["scenarios"], row["absolute max"]) == (2, 630.0)
    # 440 N of 22 kN.
    assert row["relative max"] == pytest.approx(0.02)
    assert row["worst at"] == "section_length_1=300, section_weight_1=70"


def test_a_table_is_a_reference_for_a_section(tmp_path):
    (tmp_path / "lines.csv").write_text(TABLE)
    reference = "{table: lines.csv, columns: {joint_tension_1: 80 * wire_length + pull}}"
    design = {"cases": {"table": "lines.csv", "columns": COLUMNS}}
    found = run(tmp_path, design=design, fixed=None, reference=reference)
    table = error_table(read_scene(tmp_path / "joined.yaml"), found)
    assert table["output"].tolist() == ["joint_tension_1"]
    assert table["absolute max"].tolist() == [3000.0]


def test_printed_tables_and_figures_know_sections(tmp_path):
    figures = {
        "tension": {"kind": "curves", "x": "tension_A", "y": "joint_tension_2 - joint_tension_1"}
        | {"each": "section_length_2"},
        "along": {"kind": "curves", "x": "section", "y": "joint_tension", "each": "section_length_2"}
        | {"point": {"tension_A": "2 kN"}, "where": "section_length_1 > 100 m"},
    }
    tables = {"book": {"rows": "tension_A", "across": "section_length_2", "columns": ["joint_tension_2"]}}
    run(tmp_path, figures=figures, tables=tables)
    assert (tmp_path / "results" / "figures" / "joined_along.svg").exists()
    book = (tmp_path / "results" / "tables" / "joined_book.csv").read_text().splitlines()
    assert book[0].split(",")[1:] == [
        '"joint_tension_2 [N]',
        ' section length 2 0.5 m"',
        '"joint_tension_2 [N]',
        ' section length 2 50 m"',
    ]
    assert book[2] == "2000,34300.0,64000.0"


def test_a_printed_table_of_cases_shows_where_a_line_has_ended(tmp_path):
    tables = {
        "book": {"rows": "section_length_2", "pages": ["section_length_1"], "columns": ["tension_B"]},
        "point": {"rows": "section_length_1", "columns": ["tension_B"], "where": "section_length_2 < 100 m"},
    }
    run(tmp_path, **RAGGED, tables=tables)
    book = (tmp_path / "results" / "tables" / "joined_book.csv").read_text().splitlines()
    assert book == ["section_length_1 [m],section_length_2 [m],tension_B [N]", "400,50,63000.0", "300,-,22000.0"]
    point = (tmp_path / "results" / "tables" / "joined_point.csv").read_text().splitlines()
    assert point[1:] == ["400,63000.0"]


def test_runs_are_compared_by_lists_of_any_length(ask: Ask, tmp_path):
    for name, cases in (("a", CASES), ("b", CASES[::-1]), ("c", CASES[:2])):
        (tmp_path / name).mkdir()
        run(tmp_path / name, **{**RAGGED, "design": {"cases": cases}})
    assert ask("compare", tmp_path / "a" / "results", tmp_path / "b" / "results").code == 0
    answer = ask("compare", tmp_path / "a" / "results", tmp_path / "c" / "results")
    assert answer.code == 1
    rows = {row.split("|")[2].strip(): row.split("|")[3:7] for row in answer.text.splitlines() if "joined" in row}
    assert [int(cell) for cell in rows["joint_tension"]] == [2, 1, 0, 0]


def test_check_counts_a_list_by_the_sections_of_the_longest_line(ask: Ask, tmp_path):
    path = tmp_path / "joined.yaml"
    sizes = []
    for outputs in ("[tension_B]", "[joint_tension]"):
        path.write_text(joined(**RAGGED, outputs=outputs))
        assert ask("check", path).code == 0
        sizes.append(Sizes(read_scene(path), 0.0).payload - 3 * BESIDE)
    assert sizes == [3 * 8, 3 * 3 * 8]


def test_a_method_without_lists_ignores_them_whole(tmp_path):
    ignores = "[section_length, section_weight, tension_A]"
    methods = f"{{one: {{solver: joined_line, ignores: [force_A]}}, rope: {{solver: pulled_line, ignores: {ignores}}}}}"
    asked = {"fixed": "{section_length_1: 400 m, section_weight: [80, 600], force_A: [0, 3, 4], depth: 8 m}"}
    found = run(tmp_path, **asked, methods=methods, outputs="[line_length]")
    np.testing.assert_allclose(found.line_length[:, :, 0], [[400.5, 450.0], [10.0, 10.0]])
    assert sorted(recipes(tmp_path).values()) == [(), (2, 3)]
    with pytest.raises(InputError, match=r"ignores\[1\]: no scenario has a parameter 'joint_tension'"):
        run(tmp_path, **asked, methods=methods.replace("section_weight,", "joint_tension,"), outputs="[line_length]")


# ---- the command for one scenario ----


def test_solve_takes_lists_with_units_and_prints_them_with_commas(ask: Ask):
    given = ("section_length=400 m, 0.05 km", "section_weight=80,600", "tension_A=1 kN")
    assert "joint_tension          33000, 63000 N" in ask("solve", "joined_line", *given).text
    answer = ask("solve", "joined_line", *given, "--json")
    assert answer.code == 0
    assert json.loads(answer.text)["joint_tension"] == [33000.0, 63000.0]
    parts = ("section_length_1=400 m", "section_length_2=50", "section_weight=80,600", "tension_A=1 kN")
    assert ask("solve", "joined_line", *parts, "--json").text == answer.text


def test_solve_takes_a_list_of_one(ask: Ask):
    answer = ask("solve", "joined_line", "section_length=300", "section_weight=70", "tension_A=1", "depth=400")
    assert answer.code == 1
    assert "joint_tension                     - N" in answer.text


def test_describe_says_what_is_a_list(ask: Ask):
    text = ask("describe", "joined_line").text
    assert "length of each section, from A to B (> 0, list, one number a section)" in text
    assert "(over section)" in text


SOLVE = {
    "other lengths": (("section_length=1,2", "section_weight=1"), "the same number of sections: they have 2 and 1"),
    "nothing between commas": (("section_length=1,,2", "section_weight=1,2"), "section_length: '' is not a number"),
    "a wrong unit": (("section_length=1,2 kg", "section_weight=1,2"), "section_length: the unit 'kg'"),
    "what is out of bounds": (("section_length=1,-2", "section_weight=1,2"), "> 0 m: it is -2 m in section 2"),
    "a gap": (("section_length_1=1", "section_length_3=1", "section_weight=1"), "section_length_2 must be given"),
    "whole and in part": (
        ("section_length=1", "section_length_1=1", "section_weight=1"),
        "section_length is given twice",
    ),
    "an unknown section": (("section_length_0=1", "section_weight=1"), "no parameter 'section_length_0': did you mean"),
    "a misspelt list": (("section_lenth=1", "section_weight=1"), "did you mean section_length"),
    "no list": (("section_weight=1",), "missing parameter section_length [m]"),
}


@pytest.mark.parametrize(("given", "phrase"), SOLVE.values(), ids=SOLVE)
def test_a_wrong_list_is_refused(given, phrase, ask: Ask):
    assert_refused(ask("solve", "joined_line", "tension_A=1", *given), phrase)


def ragged(*cases: dict[str, object]) -> dict[str, object]:
    return {**RAGGED, "design": {"cases": list(cases)}}


def fixed(text: str) -> dict[str, object]:
    return {"design": "{grid: {tension_A: [1]}}", "fixed": text}


def from_table(rows: str, **more: str) -> dict[str, object]:
    """Cases from rows of two lengths and two weights."""
    head = "section_length_1,section_length_2,section_weight_1,section_weight_2\n"
    return {"table": head + rows, "design": {"cases": {"table": "asked.csv"}}, "fixed": "{tension_A: 1}", **more}


SCENES = {
    "an axis of whole lists": (
        {"design": "{grid: {section_length: [[1, 2], [3, 4]]}}"},
        "asked.yaml:2",
        "grid.section_length",
        "vary one section, as section_length_2, or give the lists as cases",
    ),
    "a range of lists": (
        {"design": "{grid: {section_length: {start: 1, stop: 2, num: 3}}}"},
        "grid.section_length",
        "vary one section",
    ),
    "a sampled list": (
        {"design": "{sample: {method: sobol, num: 2, seed: 1, ranges: {section_length: {start: 1, stop: 2}}}}"},
        "ranges.section_length",
        "'section_length' is a list: give section_length_1, section_length_2, ...",
    ),
    "a list that is a number": (
        fixed("{section_length: 3 m}"),
        "asked.yaml:3",
        "fixed.section_length",
        "a list is expected",
    ),
    "an empty list": (fixed("{section_length: []}"), "fixed.section_length", "the list is empty"),
    "a list of lists": (fixed("{section_length: [[1, 2]]}"), "fixed.section_length[0]", "[1, 2] is not a number"),
    "a wrong unit in a list": (fixed("{section_length: [1, 2 kg]}"), "fixed.section_length[1]", "kg"),
    "nothing in a list": (fixed("{section_length: [1, null, 2]}"), "fixed.section_length[1]", "None is not a number"),
    "no number in a list": (fixed("{section_length: [1, .nan, 2]}"), "fixed.section_length[1]", "nan"),
    "a section out of bounds": (
        fixed("{section_length: [1, -2 m], section_weight: [1, 1]}"),
        "fixed.section_length",
        "section_length_2 must be finite and > 0 m: it is -2 m",
    ),
    "too many sections": (
        fixed(f"{{section_length: {[1] * (MOST_SECTIONS + 1)}}}"),
        "fixed.section_length",
        f"{MOST_SECTIONS + 1} sections are too many: at most {MOST_SECTIONS}",
    ),
    "a section beyond the most": (
        fixed(f"{{section_length_{MOST_SECTIONS + 1}: 1}}"),
        f"'section_length_{MOST_SECTIONS + 1}': did you mean section_length",
    ),
    "fixed lists of other lengths": (
        fixed("{section_length: [1, 2], section_weight: [1, 2, 3]}"),
        "asked.yaml:3",
        "fixed",
        "section_length and section_weight must have the same number of sections: they have 2 and 3",
    ),
    "a section that is missing": (
        fixed("{section_length_1: 1, section_length_3: 3, section_weight: [1, 2, 3]}"),
        "methods.one",
        "section_length has 3 sections: section_length_2 must be given as well",
    ),
    "a list whole and in part": (
        fixed("{section_length: [1, 2], section_length_2: 3, section_weight: [1, 2]}"),
        "fixed.section_length_2",
        "'section_length_2' is given twice",
    ),
    "a section fixed and varied": (
        {"fixed": "{section_length: [1, 2], section_weight: [1, 2]}"},
        "fixed.section_length",
        "'section_length_2' varies",
    ),
    "a section more than the other list has": (
        {
            "design": "{grid: {section_length_3: [1]}}",
            "fixed": "{section_length: [1, 2], section_weight: [1, 2], tension_A: 1}",
        },
        "design",
        "the same number of sections: they have 3 and 2",
    ),
    "a section on an axis and one too few weights": (
        {
            "design": "{grid: {section_length_2: [1, 2]}}",
            "fixed": "{section_length_1: 1, section_weight: [1], tension_A: 1}",
        },
        "asked.yaml:2",
        "design",
        "must have the same number of sections: 2 of 2 lines have not (first: scenario 0, 2 and 1)",
    ),
    "cases with lists of other lengths": (
        ragged(CASES[0], {"section_length": [1], "section_weight": [1, 2]}),
        "asked.yaml:2",
        "design",
        "1 of 2 lines have not (first: scenario 1, 1 and 2)",
    ),
    "cases whose list another parameter's fixed list does not fit": (
        {
            "design": {"cases": [{"section_length": [1]}, {"section_length": [1, 2]}]},
            "fixed": "{tension_A: 1, section_weight: [1, 2]}",
        },
        "design",
        "first: scenario 0, 1 and 2",
    ),
    "a case with a section out of bounds": (
        ragged(CASES[0], {"section_length": [1, 2], "section_weight": [1, -2]}),
        "design.cases",
        "section_weight_2 must be finite and >= 0 N m-1: 1 of 2 are not (first: scenario 1, -2 N m-1)",
    ),
    "a table with a gap in a line": (
        from_table("1,2,3,4\n,2,,4\n"),
        "design.cases",
        "section_length_1 must be finite and > 0 m: 1 of 2 are not (first: scenario 1, nan m)",
    ),
    "a table whose lists end at other places": (
        from_table("1,2,3,4\n1,2,3,\n"),
        "asked.yaml:2",
        "design",
        "the same number of sections: 1 of 2 lines have not (first: scenario 1, 2 and 1)",
    ),
    "a table with a column that no line has": (from_table("1,,3,\n1,,3,\n"), "section_length_2 has no values"),
    "a table with a hole before the end": (
        {
            "table": "a,b,c\n1,2,3\n1,,3\n",
            "design": {
                "cases": {"table": "asked.csv", "columns": {f"section_length_{i}": "abc"[i - 1] for i in (1, 2, 3)}}
            },
            "fixed": "{tension_A: 1, section_weight: [1, 2, 3]}",
        },
        "asked.yaml",
        "design",
        "section_length must be finite and > 0 m: 1 of 2 are not (first: scenario 1, nan m in section 2)",
    ),
    "a wanted list that is given": ({"outputs": "[section_length]"}, "outputs[0]", "section_length"),
    "a figure of a whole list": (
        {"figures": "{look: {kind: curves, x: tension_A, y: joint_tension, each: section_length_2}}"},
        "figures.look",
        "section and tension_A",
    ),
    "a printed table of a whole list": (
        {"tables": "{book: {rows: tension_A, across: section_length_2, columns: [joint_tension]}}"},
        "tables.book",
        "many along section",
    ),
    "a figure of a section that no line has": (
        {"figures": "{look: {kind: curves, x: tension_A, y: joint_tension_3, each: section_length_2}}"},
        "figures.look",
        "unknown name 'joint_tension_3': did you mean joint_tension_",
    ),
    "a point of a section that is not there": (
        {"figures": "{look: {kind: curves, x: tension_A, y: tension_B, point: {section_length_2: 40 m}}}"},
        "figures.look.point.section_length_2",
        "no scenario has section length 2 40 m: the nearest is 50 in SI",
    ),
}


@pytest.mark.parametrize(("parts", "phrases"), [(p, f) for p, *f in SCENES.values()], ids=SCENES)
def test_a_scene_with_a_wrong_list_is_refused(parts, phrases, ask: Ask, here: Path):
    (here / "asked.csv").write_text(parts.get("table", ""))
    (here / "asked.yaml").write_text(joined(**{key: part for key, part in parts.items() if key != "table"}))
    before = tree(here)
    assert_refused(ask("run", "asked.yaml"), "asked.yaml", *phrases)
    assert tree(here) == before
