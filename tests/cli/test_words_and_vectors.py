"""Words, vectors and problem kinds, all the way from a scene or a command to tables, queries and figures."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from cablesim.config.axis_labels import parameter_label
from cablesim.config.figure_file import Figure
from cablesim.config.scene import read_scene
from cablesim.costs import BESIDE, Sizes
from cablesim.database.query import query
from cablesim.database.reading import evaluate, open_scene, select
from cablesim.errors import InputError
from cablesim.labels import quantity_label
from cablesim.plan import read_plan
from cablesim.report.tables import error_table
from cablesim.solver import load_solver
from cablesim.steps import run_scene
from cablesim.study import Layout
from tests.cli.helpers import Answer, assert_refused, rendered, scene, tree

Ask = Callable[..., Answer]
METHODS = "{one: {solver: pulled_line}, two: {solver: pulled_line, options: {factor: 1.1}}}"
PULLED = {
    "design": "{grid: {friction_law: [zero, constant], line_length: [10 m, 20 m]}}",
    "fixed": "{force_A: [0 N, 3 N, 4 N]}",
    "methods": METHODS,
    "reference": "one",
    "outputs": "[position_B, force_B, tension_A]",
}

pytestmark = pytest.mark.usefixtures("pulled_line")


def pulled(**parts: object) -> str:
    return scene(**{**PULLED, **parts})


def run(folder: Path, **parts: object) -> xr.Dataset:
    path = folder / "pulled.yaml"
    path.write_text(pulled(**parts))
    run_scene(read_scene(path), Layout(folder / "results"), lambda step, done, total: None)
    return open_scene(folder / "results", "pulled")


# ---- datasets ----


def test_a_word_is_a_word_in_the_dataset_and_its_number_decides_the_answer(tmp_path):
    found = run(tmp_path)
    assert found.friction_law.values.tolist() == ["zero", "constant"]
    assert found.tension_A.sel({"friction_law": "zero", "line_length": 10.0}).values.tolist() == [5.0, 5.0]
    assert found.friction_law.attrs["words"] == "constant cosine_squared zero"
    np.testing.assert_array_equal(
        found.force_B.sel({"method": "one", "line_length": 10.0}).values, [[0, 9, 12], [0, 3, 4]]
    )


def test_a_fixed_vector_is_three_coordinates_and_a_vector_output_has_the_dimension_component(tmp_path):
    found = run(tmp_path)
    assert [float(found[f"force_A_{c}"]) for c in "xyz"] == [0.0, 3.0, 4.0]
    assert found.position_B.dims == ("method", "friction_law", "line_length", "component")
    assert found.component.values.tolist() == ["x", "y", "z"]
    np.testing.assert_allclose(found.position_B.values[0, 0], [[0, 6, 8], [0, 12, 16]])


def test_the_dataset_opens_without_us(tmp_path):
    run(tmp_path, fixed="{force_A: [0, 3, 4], lay_angle: 10 deg}", design="{grid: {line_length: [1]}}")
    run(tmp_path, design="{grid: {line_length: [1, 2]}}", fixed="{force_A: [0, 3, 4], friction_law: zero}")
    with xr.open_dataset(tmp_path / "results" / "pulled.nc") as plain:
        assert str(plain.friction_law.values) == "zero"
        assert plain.force_B.dims == ("method", "line_length", "component")


WHOLE_AND_PARTS = [
    ("{grid: {line_length: [10]}}", "{force_A: [0, 3, 4 N]}"),
    ("{grid: {line_length: [10]}}", "{force_A_x: 0 N, force_A_y: 3, force_A_z: 4 N}"),
    ("{grid: {force_A: [[0, 3, 4]]}}", "{line_length: 10}"),
    ("{grid: {force_A_z: [4 N]}}", "{line_length: 10, force_A_x: 0 N, force_A_y: 3}"),
    ("{cases: [{force_A: [0, 3, 4]}]}", "{line_length: 10}"),
    ("{cases: [{force_A_x: 0, force_A_y: 3, force_A_z: 4}]}", "{line_length: 10}"),
    ("{cases: {table: pull.csv, columns: {force_A_y: y, force_A_z: z}}}", "{line_length: 10, force_A_x: 0}"),
]


@pytest.mark.parametrize(("design", "fixed"), WHOLE_AND_PARTS)
def test_a_vector_is_given_whole_or_by_its_components(design, fixed, tmp_path):
    (tmp_path / "pull.csv").write_text("y,z\n3,4\n")
    found = run(tmp_path, design=design, fixed=fixed)
    np.testing.assert_allclose(found.position_B.values[0].ravel(), [0, 6, 8])


def test_components_are_sampled_and_spaced(tmp_path):
    axis = "{force_A_z: {start: 1 N, stop: 2 N, num: 3}}"
    found = run(tmp_path, design=f"{{grid: {axis}}}", fixed="{line_length: 10, force_A_x: 0, force_A_y: 0}")
    np.testing.assert_allclose(found.tension_A.values[0], [1.0, 1.5, 2.0])
    sample = "{method: sobol, num: 4, seed: 1, ranges: {force_A_z: {start: 1 N, stop: 2 N}}}"
    found = run(tmp_path, design=f"{{sample: {sample}}}", fixed="{line_length: 10, force_A_x: 0, force_A_y: 0}")
    np.testing.assert_array_equal(found.tension_A.values[0], found.force_A_z.values)


def test_words_come_from_columns_of_a_table(tmp_path):
    (tmp_path / "laws.csv").write_text("length,law\n10,zero\n20,constant\n")
    columns = "{line_length: length, friction_law: law}"
    found = run(tmp_path, design=f"{{cases: {{table: laws.csv, columns: {columns}}}}}")
    assert found.friction_law.values.tolist() == ["zero", "constant"]
    (tmp_path / "laws.csv").write_text("length,law\n10,zero\n20,constnt\n")
    with pytest.raises(InputError, match="row 2: unknown value 'constnt': did you mean constant"):
        run(tmp_path, design=f"{{cases: {{table: laws.csv, columns: {columns}}}}}")


def test_an_axis_of_vectors_has_one_point_a_vector(tmp_path):
    found = run(tmp_path, design="{grid: {force_A: [[0, 3, 4], [0, 0, 2]], line_length: [10, 20, 30]}}", fixed="{}")
    assert found.tension_A.dims == ("method", "force_A", "line_length")
    assert found.force_A_z.dims == ("force_A",)
    np.testing.assert_allclose(found.tension_A.values[0, :, 0], [5.0, 2.0])


def test_every_problem_kind_is_solved(tmp_path):
    by_depth = run(tmp_path, design="{grid: {depth: [4 m, 8 m]}}", outputs="[line_length]")
    np.testing.assert_allclose(by_depth.line_length.values[0], [5.0, 10.0])
    by_end = run(tmp_path, design="{grid: {line_length: [5]}}", fixed="{position_B: [0, 3, 4]}", outputs="[force_A]")
    np.testing.assert_allclose(by_end.force_A.values[0, 0], [0, 3, 4])


def test_adding_a_word_or_a_vector_to_an_axis_computes_it_alone(tmp_path):
    def shards() -> dict[str, tuple[int, ...]]:
        plans = sorted((tmp_path / "results").glob("**/*.npz"))
        return {digest: recipe.shape for plan in plans for digest, recipe in read_plan(plan).recipes.items()}

    grid = "{{grid: {{friction_law: [{}], force_A: [{}]}}}}"
    vectors = "[0, 0, 1], [0, 0, 2]"
    run(tmp_path, design=grid.format("zero", vectors), fixed="{line_length: 1}")
    first = shards()
    run(tmp_path, design=grid.format("constant, zero", "[1, 0, 1], " + vectors), fixed="{line_length: 1}")
    new = {digest: shape for digest, shape in shards().items() if digest not in first}
    # For each of the two methods: the new word at all three vectors, the new vector at the old word.
    assert sum(int(np.prod(shape)) for shape in new.values()) == 2 * (3 + 1)


def test_a_default_word_spelled_out_is_no_other_scenario(tmp_path):
    grid = "{grid: {line_length: [1]}}"
    run(tmp_path, design=grid, fixed="{force_A: [0, 0, 1]}")
    run(tmp_path, design=grid, fixed="{force_A: [0, 0, 1], friction_law: constant, lay_angle: 0 deg}")
    assert len(list((tmp_path / "results").glob("**/shards/**/*.nc"))) == 2


# ---- formulas, queries, tables, figures ----


def test_words_and_components_have_names_in_formulas(tmp_path):
    found = run(tmp_path)
    holds = select(found, "friction_law == zero and force_B_z > 12.5 N")
    assert int(holds.sum()) == 2
    assert int(select(found, "friction_law == cosine_squared").sum()) == 0
    np.testing.assert_allclose(evaluate(found, "two.force_B_z / one.force_B_z"), 1.1)
    with pytest.raises(InputError, match="unknown word 'constnt': did you mean constant"):
        select(found, "friction_law == constnt")
    with pytest.raises(InputError, match=r"unknown name 'force_B_w': did you mean .*force_B_"):
        select(found, "force_B_w > 1 N")


def test_queries_show_words_and_components(tmp_path):
    found = run(tmp_path)
    table = query(found, "friction_law == zero and line_length == 10 m and method == one")
    assert table[["friction_law", "force_B_x", "force_B_y", "force_B_z"]].values.tolist() == [["zero", 0.0, 9.0, 12.0]]
    assert list(query(found, None, ("friction_law", "force_A_z", "force_B_x"))) == [
        "friction_law",
        "force_A_z",
        "force_B_x",
    ]
    assert json.loads(rendered(found, "json", "friction_law", "force_B_z"))["units"] == {"force_B_z": "N"}
    with pytest.raises(InputError, match="no column 'force_B': did you mean force_B_"):
        query(found, None, ("force_B",))


@pytest.mark.parametrize("form", ["table", "csv", "json", "parquet", "netcdf"])
def test_every_format_takes_words_and_components(form, ask: Ask, tmp_path):
    run(tmp_path)
    answer = ask(
        "query", tmp_path / "results", "pulled", "friction_law == zero", "--format", form, "--output", tmp_path / "out"
    )
    assert answer.code == 0, answer.err
    assert b"zero" in (tmp_path / "out").read_bytes()


def test_the_error_of_a_vector_is_the_length_of_the_difference(tmp_path):
    found = run(tmp_path)
    table = error_table(read_scene(tmp_path / "pulled.yaml"), found).set_index("output")
    assert list(table.index) == ["position_B", "force_B", "tension_A"]
    # Three times 5 N where the friction law is zero, off by a tenth.
    assert table.loc["force_B", "absolute max"] == pytest.approx(1.5)
    assert table.loc["force_B", "relative max"] == pytest.approx(0.1)
    assert table.loc["force_B", "worst at"].startswith("friction_law=")
    assert "line_length=" in table.loc["force_B", "worst at"]


def test_the_place_of_the_largest_error_on_an_axis_of_vectors_is_its_components(tmp_path):
    found = run(tmp_path, design="{grid: {force_A: [[0, 3, 4], [0, 0, 2]]}}", fixed="{line_length: 1}")
    table = error_table(read_scene(tmp_path / "pulled.yaml"), found).set_index("output")
    assert table.loc["force_B", "worst at"] == "force_A_x=0, force_A_y=3, force_A_z=4"


def test_a_table_is_a_reference_for_components(tmp_path):
    (tmp_path / "pull.csv").write_text("line_length,force_B_z,force_B_y\n10,4.4,3\n")
    columns = "{table: pull.csv, columns: {line_length: line_length}}"
    found = run(tmp_path, design=f"{{cases: {columns}}}", reference="{table: pull.csv}")
    table = error_table(read_scene(tmp_path / "pulled.yaml"), found)
    found_errors = {(row["method"], row["output"]): row["absolute max"] for row in table.to_dict("records")}
    assert found_errors[("one", "force_B_z")] == pytest.approx(0.4)
    assert found_errors[("two", "force_B_z")] == pytest.approx(0.0, abs=1e-12)
    assert found_errors[("one", "force_B_y")] == 0.0


def test_value_tables_show_components(tmp_path):
    run(tmp_path)
    head, first = (tmp_path / "results" / "tables" / "pulled_values.csv").read_text().splitlines()[:2]
    row = dict(zip(head.split(","), first.split(","), strict=True))
    assert (row["friction_law"], row["force_B_z"], row["position_B_y"]) == ("zero", "12.0", "6.0")


def curves_for(each: str) -> Figure:
    """A figure of curves as it is read."""
    labels = {"x": quantity_label("line_length"), "y": quantity_label("force_B_z"), "each": parameter_label(each)}
    return Figure("look", "curves", {"x": "line_length", "y": {"": "one.force_B_z"}, "each": each, "labels": labels})


def test_legends_say_words_and_vectors(tmp_path):
    laws = {"kind": "curves", "x": "line_length", "y": "one.force_B_z", "each": "friction_law"}
    figures = {"laws": laws, "shown": {**laws, "where": "friction_law == zero"}}
    run(tmp_path, figures=figures)
    assert (tmp_path / "results" / "figures" / "pulled_laws.svg").exists()
    from matplotlib import pyplot as plt

    from cablesim.report import figures as drawing

    found = open_scene(tmp_path / "results", "pulled")
    _, axes = plt.subplots()
    drawing._shaded_curves(axes, found, curves_for("friction_law"))
    assert axes.get_legend_handles_labels()[1] == ["friction law = zero", "friction law = constant"]
    found = run(tmp_path, design="{grid: {line_length: [1, 2], force_A: [[0, 3, 4], [0, 0, 2]]}}", fixed="{}")
    _, axes = plt.subplots()
    drawing._shaded_curves(axes, found, curves_for("force_A"))
    assert axes.get_legend_handles_labels()[1] == ["force A = 0 N, 3 N, 4 N", "force A = 0 N, 0 N, 2 N"]
    plt.close("all")


def test_profiles_are_shown_at_words(tmp_path):
    figures = {"shapes": {"kind": "profiles", "at": {"friction_law": ["zero"]}}}
    run(
        tmp_path,
        design="{grid: {friction_law: [zero, constant]}}",
        fixed="{force_A: [1, 0, 4], line_length: 3}",
        outputs="[profile]",
        figures=figures,
    )
    assert (tmp_path / "results" / "figures" / "pulled_shapes.png").exists()


def test_runs_are_compared_by_words_and_vectors(ask: Ask, tmp_path):
    axes = "{{grid: {{friction_law: [{}], force_A: [{}]}}}}"
    for name, words, vectors in (
        ("a", "zero, constant", "[0, 3, 4], [0, 0, 2]"),
        ("b", "constant, zero", "[0, 0, 2], [0, 3, 4]"),
        ("c", "constant, zero", "[0, 0, 2], [0, 3, 5]"),
    ):
        (tmp_path / name).mkdir()
        run(tmp_path / name, design=axes.format(words, vectors), fixed="{line_length: 1}")
    assert ask("compare", tmp_path / "a" / "results", tmp_path / "b" / "results").code == 0
    answer = ask("compare", tmp_path / "a" / "results", tmp_path / "c" / "results")
    assert answer.code == 1
    rows = {row.split("|")[2].strip(): row.split("|")[3:6] for row in answer.text.splitlines() if "pulled" in row}
    assert [int(cell) for cell in rows["force_B"]] == [4, 4, 4]


def test_check_counts_a_vector_as_three_numbers(ask: Ask, tmp_path):
    path = tmp_path / "pulled.yaml"
    sizes = []
    for outputs in ("[tension_A]", "[force_B]"):
        path.write_text(pulled(outputs=outputs))
        answer = ask("check", path)
        assert answer.code == 0
        assert "friction_law 2 x line_length 2 = 4 scenarios" in answer.text
        sizes.append(Sizes(read_scene(path), 0.0).payload - 8 * BESIDE)
    assert sizes == [8 * 8, 3 * 8 * 8]


BOTH = {"methods": "{wide: {solver: pulled_line}, strict: {solver: strict_line}}", "reference": "wide"}


@pytest.mark.parametrize("place", ["design", "fixed"])
def test_a_value_must_be_within_the_bounds_of_every_method(place, ask: Ask, here: Path):
    design, fixed = "line_length: [1]", "force_A: [0, 0, 1]"
    design += ", lay_angle: [0.1, 0.6]" if place == "design" else ""
    fixed += ", lay_angle: 0.6" if place == "fixed" else ""
    (here / "asked.yaml").write_text(pulled(**BOTH, design=f"{{grid: {{{design}}}}}", fixed=f"{{{fixed}}}"))
    assert_refused(ask("check", "asked.yaml"), "methods.strict", "lay_angle must be finite, >= 0 and <= 0.5 rad", "0.6")


def test_methods_that_know_different_words_are_refused(ask: Ask, here: Path, monkeypatch):
    names = load_solver("strict_line").names
    monkeypatch.setitem(names, "friction_law", replace(names["friction_law"], words=("zero", "constant")))
    (here / "asked.yaml").write_text(pulled(**BOTH))
    assert_refused(ask("check", "asked.yaml"), "asked.yaml:4", "methods", "different words for friction_law")


# ---- the command for one scenario ----


@pytest.mark.parametrize(
    "given",
    [
        ("force_A=0,3000,4000",),
        ("force_A=0, 3 kN, 4000 N",),
        ("force_A_x=0", "force_A_y=3 kN", "force_A_z=4000"),
    ],
)
def test_solve_takes_vectors_and_words(given, ask: Ask):
    answer = ask("solve", "pulled_line", *given, "line_length=10", "friction_law=zero", "--json")
    found = json.loads(answer.text)
    assert answer.code == 0
    assert found["force_B"] == [0.0, 9000.0, 12000.0]
    assert found["position_B"] == pytest.approx([0.0, 6.0, 8.0])
    assert "profile" not in found
    assert found["units"]["force_B"] == "N"


def test_solve_prints_the_three_components(ask: Ask):
    answer = ask("solve", "pulled_line", "force_A=0,3,4", "line_length=10")
    assert "force_B                     0, 3, 4 N" in answer.text


def test_describe_says_words_bounds_vectors_and_problems(ask: Ask):
    text = ask("describe", "pulled_line").text
    assert "one of constant, cosine_squared, zero, default constant" in text
    assert "(>= 0 and < 1.5, default 0)" in text
    assert "(vector x, y, z)" in text
    assert "Given: force_A and line_length, or force_A and depth, or position_B and line_length." in text
    assert "(over component)" in text


SOLVE = {
    "two components": (("force_A=0,3",), "force_A must have three components (x, y, z): it has 2"),
    "four components": (("force_A=0,3,4,5",), "force_A must have three components"),
    "a component that is no number": (("force_A=0,3,nan",), "force_A: 'nan' is not a number"),
    "a component in metres": (("force_A=0,3,4 m",), "force_A: the unit 'm' is of another dimension"),
    "a component missing": (("force_A_x=1", "force_A_y=2"), "force_A has three components: force_A_z must be given"),
    "whole and in part": (("force_A=1,2,3", "force_A_y=2"), "force_A is given twice"),
    "an unknown component": (("force_A_w=1",), "has no parameter 'force_A_w': did you mean force_A"),
    "an unknown word": (("force_A=0,3,4", "friction_law=constnt"), "unknown value 'constnt': did you mean constant?"),
    "a number for a word": (("force_A=0,3,4", "friction_law=2"), "unknown value '2'"),
    "a closed bound": (("force_A=0,3,4", "lay_angle=-1"), "lay_angle must be finite, >= 0 and < 1.5 rad: it is -1 rad"),
    "an open bound": (("force_A=0,3,4", "lay_angle=1.5"), "lay_angle must be finite, >= 0 and < 1.5 rad"),
    "two problems": (("force_A=0,3,4", "depth=1"), "or position_B and line_length; given: line_length, force_A, depth"),
    "no problem": (
        (),
        "give force_A and line_length, or force_A and depth, or position_B and line_length; given: line_",
    ),
}


@pytest.mark.parametrize(("given", "phrase"), SOLVE.values(), ids=SOLVE)
def test_a_wrong_word_vector_or_problem_is_refused(given, phrase, ask: Ask):
    assert_refused(ask("solve", "pulled_line", "line_length=10", *given), phrase)


SCENES = {
    "an unknown word": ({"design": "{grid: {friction_law: [constnt]}}"}, "friction_law[0]", "did you mean constant?"),
    "a number for a word": ({"design": "{grid: {friction_law: [2]}}"}, "friction_law[0]", "unknown value 2"),
    "a range of words": ({"design": "{grid: {friction_law: {start: 0, stop: 1, num: 2}}}"}, "a list of words"),
    "a range of vectors": ({"design": "{grid: {force_A: {start: 0, stop: 1, num: 2}}}"}, "a list of vectors"),
    "a word twice": ({"design": "{grid: {friction_law: [zero, zero]}}"}, "the value zero appears 2 times"),
    "a vector twice": ({"design": "{grid: {force_A: [[0, 0, 1], [0, 0, 1]]}}"}, "the value 0, 0, 1 appears 2 times"),
    "two components": ({"fixed": "{force_A: [1, 2]}"}, "asked.yaml:3", "fixed.force_A", "three components", "not 2"),
    "a vector that is a number": ({"fixed": "{force_A: 3 N}"}, "fixed.force_A", "a list is expected"),
    "a component in metres": ({"fixed": "{force_A: [1, 2, 3 m]}"}, "fixed.force_A[2]", "m"),
    "an infinite component": ({"fixed": "{force_A: [1, 2, .inf]}"}, "fixed.force_A[2]", "inf"),
    "a component missing": ({"fixed": "{force_A_x: 1, force_A_z: 1}"}, "methods.one", "force_A_y must be given"),
    "whole and in part": ({"fixed": "{force_A: [0, 0, 1], force_A_z: 1}"}, "'force_A_z' is given twice"),
    "fixed and varied": (
        {"design": "{grid: {force_A_z: [1]}}", "fixed": "{force_A: [0, 0, 1], line_length: 1}"},
        "fixed.force_A",
        "'force_A_z' varies",
    ),
    "varied twice": (
        {"design": "{grid: {force_A_z: [1], force_A: [[0, 0, 1]]}}", "fixed": "{line_length: 1}"},
        "'force_A_z' is given twice",
    ),
    "a case given twice": ({"design": "{cases: [{force_A: [0, 0, 1], force_A_z: 1}]}"}, "'force_A_z' is given twice"),
    "a sampled word": (
        {"design": "{sample: {method: sobol, num: 2, seed: 1, ranges: {friction_law: {start: 0, stop: 1}}}}"},
        "friction_law",
        "a word has no range",
    ),
    "a sampled vector": (
        {"design": "{sample: {method: sobol, num: 2, seed: 1, ranges: {force_A: {start: 0, stop: 1}}}}"},
        "give force_A_x, force_A_y, force_A_z",
    ),
    "two problems": (
        {"fixed": "{force_A: [0, 0, 1], depth: 3}"},
        "methods.one",
        "or force_A and depth",
        "given: line_",
    ),
    "a wanted output that is given": ({"outputs": "[line_length]"}, "outputs[0]", "'line_length' is a given parameter"),
    "a wanted vector that is given": ({"outputs": "[force_A]"}, "outputs[0]", "'force_A' is a given parameter"),
    "a vector to ignore that nobody gives": (
        {
            "methods": "{one: {solver: pulled_line}, flat: {solver: catenary_exact, ignores: [position_B]}}",
            "outputs": "[tension_A]",
        },
        "methods.flat.ignores",
        "no scenario has a parameter 'position_B'",
    ),
    "a parameter ignored in part": (
        {"methods": "{one: {solver: pulled_line}, flat: {solver: catenary_exact}}", "outputs": "[tension_A]"},
        "methods.flat",
        "ignores: [force_A_x, force_A_y, force_A_z, friction_law]",
    ),
    "a figure of a vector": (
        {"figures": "{look: {kind: curves, x: line_length, y: one.force_B, each: friction_law}}"},
        "figures.look",
        "take a component",
    ),
    "a figure of an unknown word": (
        {
            "figures": "{look: {kind: curves, x: line_length, y: one.force_B_z, each: friction_law,"
            " where: friction_law == zro}}"
        },
        "figures.look.where",
        "'zro': did you mean zero",
    ),
    "a figure of a word": (
        {"figures": "{look: {kind: curves, x: friction_law, y: one.force_B_z, each: line_length}}"},
        "a word cannot be used as a number",
    ),
}


@pytest.mark.parametrize(("parts", "phrases"), [(p, f) for p, *f in SCENES.values()], ids=SCENES)
def test_a_scene_with_a_wrong_word_vector_or_problem_is_refused(parts, phrases, ask: Ask, here: Path):
    (here / "asked.yaml").write_text(pulled(**parts))
    before = tree(here)
    assert_refused(ask("run", "asked.yaml"), "asked.yaml", *phrases)
    assert tree(here) == before
