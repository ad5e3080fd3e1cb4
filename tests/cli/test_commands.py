"""Every command does what it says: what it prints, what it leaves on disk, and its exit code."""

import io
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pandas as pd
import pytest
import xarray as xr

from cablesim.batch import default_outputs
from cablesim.plan import read_plan
from cablesim.solver import load_solver, peer_names, solver_names
from tests.cli.helpers import Answer, assert_refused, scene, tree
from tests.helpers import rewritten

Ask = Callable[..., Answer]
SCENES = sorted((Path(__file__).parents[2] / "config" / "scenes").glob("*.yaml"))
LINE = ("span=2.5", "line_length=3", "weight_per_length=3")


# ---- help ----


@pytest.mark.parametrize("flag", ["--help", "-h"])
def test_help_names_every_command_and_every_exit_code(flag: str, ask: Ask) -> None:
    answer = ask(flag)
    assert (answer.code, answer.err) == (0, "")
    for command in ("solvers", "describe", "solve", "check", "run", "scenes", "query", "compare"):
        assert f"\n  {command} " in answer.text
    for code in ("0 all solved", "1 some scenarios flagged", "2 ", "3 ", "4 "):
        assert code in answer.text


@pytest.mark.parametrize("command", ["solve", "check", "run", "scenes", "query", "compare", "describe", "step"])
def test_every_command_has_its_own_help(command: str, ask: Ask) -> None:
    answer = ask(command, "--help")
    assert (answer.code, answer.err) == (0, "")
    assert answer.text.startswith(f"Usage: cablesim {command}")


def test_the_version_is_one_line(ask: Ask) -> None:
    answer = ask("--version")
    assert (answer.code, answer.err) == (0, "")
    name, version = answer.text.split()
    assert name == "cablesim" and version[0].isdigit()


# ---- solvers and describe ----


def test_solvers_lists_each_with_a_sentence(ask: Ask) -> None:
    answer = ask("solvers")
    assert (answer.code, answer.err) == (0, "")
    ours, (_, *theirs) = (lines.splitlines() for lines in answer.text.strip().split("\n\n"))
    for lines, names in ((ours, solver_names()), (theirs, peer_names())):
        listed = dict(line.split(maxsplit=1) for line in lines)
        assert list(listed) == names
        assert all(sentence.strip() for sentence in listed.values())


@pytest.mark.parametrize("solver", [*solver_names(), *peer_names()])
def test_describe_gives_theory_parameters_options_and_outputs(solver: str, ask: Ask) -> None:
    answer = ask("describe", solver)
    assert (answer.code, answer.err) == (0, "")
    loaded = load_solver(solver)
    assert "Reference:" in answer.text
    for name in (*loaded.parameters, *loaded.options, *loaded.outputs):
        assert f"\n  {name} " in answer.text


def test_describe_gives_the_equations_and_units_of_the_exact_catenary(ask: Ask) -> None:
    text = ask("describe", "catenary_exact").text
    for part in ("sinh(lambda) = k lambda", "weight_per_length", "[N m-1]", "instead of line_length", "default 101"):
        assert part in text


# ---- solve ----


def solved(ask: Ask, *arguments: str, code: int = 0) -> dict[str, Any]:
    """The one JSON object that `solve` prints."""
    answer = ask("solve", "catenary_exact", *arguments, "--json")
    assert (answer.code, answer.err) == (code, "")
    assert answer.out.count(b"\n") == 1
    return json.loads(answer.out)


def test_solve_prints_one_object_with_outputs_status_and_units(ask: Ask) -> None:
    found = solved(ask, *LINE)
    outputs = default_outputs(load_solver("catenary_exact"))
    assert list(found) == [*outputs, "status", "units"]
    assert found["status"] == "ok"
    assert list(found["units"]) == list(outputs)
    assert found["units"]["sag"] == "m" and found["units"]["max_tension"] == "N"


def test_solve_answers_in_si_whatever_the_units_of_the_question(ask: Ask) -> None:
    found = solved(ask, "span=250 cm", "line_length=0.003 km", "weight_per_length=3 kN/km")
    assert found == solved(ask, *LINE)
    a = found["catenary_parameter"]
    # sinh(l / 2a) = L / 2a, H = w a and sag = a (cosh(l / 2a) - 1), to rounding.
    assert 2.0 * a * np.sinh(1.25 / a) == pytest.approx(3.0, rel=1e-13)
    assert found["horizontal_tension"] == pytest.approx(3.0 * a, rel=1e-13)
    assert found["sag"] == pytest.approx(a * (np.cosh(1.25 / a) - 1.0), rel=1e-13)


def test_solve_takes_a_ratio_in_per_cent(ask: Ask) -> None:
    ratio = solved(ask, "span=2.5", "length_ratio=120 %", "weight_per_length=3")
    assert ratio == solved(ask, "span=2.5", "length_ratio=1.2", "weight_per_length=3")


def test_solve_says_why_there_is_no_answer_with_nulls_and_exit_code_1(ask: Ask) -> None:
    found = solved(ask, "span=2.5", "line_length=2", "weight_per_length=3", code=1)
    assert found["status"] == "infeasible"
    assert {value for name, value in found.items() if name not in ("status", "units")} == {None}


def test_solve_gives_only_the_outputs_that_are_wanted(ask: Ask) -> None:
    found = solved(ask, *LINE, "--outputs", "drop,sag")
    assert list(found) == ["drop", "sag", "status", "units"]


def test_solve_gives_profiles_as_nested_lists(ask: Ask) -> None:
    found = solved(ask, *LINE, "rise=50 cm", "--option", "nodes=3", "--outputs", "profile,profile_tension")
    profile = np.array(found["profile"])
    assert profile.shape == (3, 3) and len(found["profile_tension"]) == 3
    np.testing.assert_allclose(profile[[0, -1]], [[0.0, 0.0, 0.0], [2.5, 0.0, 0.5]], atol=1e-14)


def test_a_profile_without_an_answer_is_nulls(ask: Ask) -> None:
    short = ("span=2.5", "line_length=2", "weight_per_length=3")
    found = solved(ask, *short, "--option", "nodes=2", "--outputs", "profile", code=1)
    assert found["profile"] == [[None, None, None], [None, None, None]]


def test_solve_prints_a_line_for_people_on_each_output(ask: Ask) -> None:
    answer = ask("solve", "catenary_exact", *LINE)
    assert (answer.code, answer.err) == (0, "")
    lines = {line.split()[0]: line for line in answer.text.splitlines()}
    assert list(lines) == [*default_outputs(load_solver("catenary_exact")), "status"]
    assert "0.73085949 m " in lines["sag"] and "largest vertical distance" in lines["sag"]
    assert "ok" in lines["status"] and "solved" in lines["status"]


def test_solve_tells_people_why_there_is_no_answer(ask: Ask) -> None:
    answer = ask("solve", "catenary_exact", "span=2.5", "line_length=2", "weight_per_length=3")
    assert (answer.code, answer.err) == (1, "")
    assert "no equilibrium exists" in answer.text
    assert "nan" not in answer.text


# ---- check and run ----


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_check_accepts_every_scene_of_ours_and_writes_nothing(path: Path, here: Path, ask: Ask) -> None:
    before = tree(here), tree(path.parent)
    answer = ask("check", path)
    assert (answer.code, answer.err) == (0, "")
    for word in ("valid", "scenarios", "shard", "about", "on disk"):
        assert word in answer.text
    assert (tree(here), tree(path.parent)) == before


def test_check_counts_scenarios_and_shards(in_study: Path, ask: Ask) -> None:
    text = ask("check", "tiny.yaml").text
    assert "rise 2 x length_ratio 4 = 8 scenarios" in text
    # The parabola ignores the rise: it is solved once for both.
    assert "exact (catenary_exact): 8 to solve in 1 shard" in text
    assert "parabolic (catenary_parabolic): 4 to solve in 1 shard" in text


def test_run_makes_dataset_tables_and_figures(here: Path, ask: Ask) -> None:
    (here / "good.yaml").write_text(scene(figures="{sag: {kind: curves, x: length_ratio, y: exact.sag}}"))
    answer = ask("run", "good.yaml")
    assert answer.code == 0
    assert "results/good/good.nc: 2 scenarios" in answer.text
    results = here / "results" / "good"
    assert (results / "good.nc").is_file()
    assert {path.name for path in (results / "figures").iterdir()} == {"good_sag.svg", "good_sag.pdf", "good_sag.png"}
    tables = {path.name for path in (results / "tables").iterdir()}
    assert tables >= {f"good_{kind}.{suffix}" for kind in ("status", "tensions") for suffix in ("csv", "md")}
    assert not [path for path in here.rglob("*") if path.name.endswith(".part")]


def test_run_says_which_scenarios_are_flagged_and_ends_with_1(in_study: Path, tmp_path: Path, ask: Ask) -> None:
    answer = ask("run", "tiny.yaml", "--out", tmp_path / "results")
    assert answer.code == 1
    head, _, exact, parabolic = (line.split("|") for line in answer.text.splitlines()[-5:-1])
    column = [cell.strip() for cell in head].index("infeasible")
    assert (exact[1].strip(), exact[column].strip()) == ("exact", "2")
    assert (parabolic[1].strip(), parabolic[column].strip()) == ("parabolic", "2")


FIGURES = {
    "curves": {
        "kind": "curves",
        "x": "length_ratio",
        "y": "exact.sag",
        "log": "xy",
        "each": "rise",
        "x_label": "$\\frac{$",
    },
    "below_zero": {"kind": "curves", "x": "length_ratio", "y": "-exact.sag", "log": "y", "each": "rise"},
    "map": {"kind": "map", "x": "length_ratio", "y": "rise", "value": "sag", "log": "value"},
    "nowhere": {"kind": "map", "x": "length_ratio", "y": "rise", "value": "sag", "where": "sag > 1 km"},
}
PROFILES = {"kind": "profiles", "at": {"length_ratio": [0.8]}}
TOO_SHORT = {"length_ratio": [0.8, 0.9], "rise": [0, 0.1]}
LONG_ENOUGH = {"length_ratio": [1.1, 1.2], "rise": [0, 0.1]}


def assert_drawn(here: Path, ask: Ask, grid: dict[str, list[float]], figure: dict[str, Any], code: int) -> None:
    """A run of a scene with one figure ends as it should, without a warning, and the picture is there."""
    text = scene(design={"grid": grid}, outputs="[sag, profile]", figures={"look": figure}, reference="exact")
    (here / "good.yaml").write_text(text)
    answer = ask("run", "good.yaml")
    assert answer.code == code, answer.err[-400:]
    assert "Warning" not in answer.err
    assert (here / "results" / "good" / "figures" / "good_look.png").stat().st_size > 1000


@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_of_several_axes_is_drawn(name: str, here: Path, ask: Ask) -> None:
    assert_drawn(here, ask, LONG_ENOUGH, FIGURES[name], code=0)


@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_is_drawn_though_no_scenario_has_an_answer(name: str, here: Path, ask: Ask) -> None:
    assert_drawn(here, ask, TOO_SHORT, FIGURES[name], code=1)


def test_profiles_are_drawn_though_no_scenario_has_an_answer(here: Path, ask: Ask) -> None:
    assert_drawn(here, ask, {"length_ratio": [0.8, 0.9]}, PROFILES, code=1)


def test_run_again_computes_nothing_again(in_study: Path, tmp_path: Path, ask: Ask) -> None:
    shutil.copytree("results", tmp_path / "results")
    before = tree(tmp_path / "results")
    answer = ask("run", "tiny.yaml", "--out", tmp_path / "results")
    assert answer.code == 1
    # Measured times come from the shards, so even the file of the dataset is the same.
    assert tree(tmp_path / "results") == before


def test_a_dataset_opens_without_us_and_says_what_it_is(in_study: Path) -> None:
    with xr.open_dataset("results/tiny.nc") as dataset:
        assert dataset.status.dims == ("method", "rise", "length_ratio")
        assert dataset.sizes == {"method": 2, "rise": 2, "length_ratio": 4, "node": 5, "component": 3}
        failed = dataset.status.values == 1
        words = dataset.status.attrs["flag_meanings"].split()
        np.testing.assert_array_equal(failed, np.broadcast_to(dataset.length_ratio.values < 1.0, failed.shape))
        assert words[1] == "infeasible" and len(words) == len(dataset.status.attrs["flag_values"])
        np.testing.assert_array_equal(np.isnan(dataset.sag.values), failed)
        np.testing.assert_array_equal(np.isnan(dataset.profile.values).any(axis=(-1, -2)), failed)
        assert dataset.sag.attrs["units"] == "m" and dataset.length_ratio.attrs["units"] == "1"
        assert {"source", "revision", "scene_digest", "title"} <= set(dataset.attrs)
    with xr.open_dataset("results/tiny.nc", group="measured") as measured:
        assert (measured.run_time.values > 0.0).all() and measured.run_time.attrs["units"] == "s"


def test_the_steps_by_hand_make_what_run_makes(in_study: Path, tmp_path: Path, ask: Ask) -> None:
    assert ask("step", "sample", "tiny.yaml", tmp_path).code == 0
    plan = next((tmp_path / "plans").iterdir())
    assert ask("step", "solve", plan, tmp_path / "shards" / "tiny", *read_plan(plan).recipes).code == 0
    for step in ("collect", "summarise", "figures"):
        assert ask("step", step, "tiny.yaml", tmp_path, "--stamp", tmp_path / "stamps" / step) == Answer(0, b"", "")
    assert ask("step", "catalogue", tmp_path, "--stamp", tmp_path / "stamps" / "catalogue").code == 0
    assert ask("step", "report", "tiny.yaml", tmp_path, "--stamp", tmp_path / "stamps" / "report").code == 0
    assert root_group(tmp_path / "tiny.nc") == root_group(in_study / "results" / "tiny.nc")
    by_hand, by_run = lasting(tree(tmp_path)), lasting(tree(in_study / "results"))
    assert {name for name in by_hand if name.startswith("stamps/")} == {
        "stamps/catalogue",
        "stamps/collect",
        "stamps/summarise",
        "stamps/figures",
        "stamps/report",
    }
    assert {name: content for name, content in by_hand.items() if not name.startswith("stamps")} == by_run


def root_group(path: Path) -> dict[str, Any]:
    """All that a dataset holds outside the group of measured values, to the last byte."""
    with netCDF4.Dataset(path) as file:
        file.set_auto_maskandscale(False)
        variables = {
            name: (v.dimensions, v.dtype, v.filters(), {a: repr(v.getncattr(a)) for a in v.ncattrs()}, v[...].tobytes())
            for name, v in file.variables.items()
        }
        return {
            "variables": variables,
            "dimensions": {name: dimension.size for name, dimension in file.dimensions.items()},
            "attributes": {name: repr(file.getncattr(name)) for name in file.ncattrs()},
        }


def lasting(files: dict[str, bytes | str]) -> dict[str, bytes | str]:
    """Without the lock, and the files that hold measured times."""
    measured = (".lock", ".nc", ".json", ".parquet", ".html", "_status.csv", "_status.md")
    return {name: content for name, content in files.items() if not name.endswith(measured)}


# ---- scenes and query ----


def test_scenes_lists_what_a_folder_holds(in_study: Path, ask: Ask) -> None:
    answer = ask("scenes", "results")
    assert (answer.code, answer.err) == (0, "")
    assert ask("scenes", "results", "t*y").text == answer.text
    assert_refused(ask("scenes", "results", "y*"), "results", "'y*'")
    (line,) = answer.text.splitlines()
    for part in ("tiny", "16 scenarios", "method 2 x rise 2 x length_ratio 4", "4 flagged", "Slack and taut lines"):
        assert part in line


CONDITION = "method == exact and rise == 10 cm and status == ok"
COLUMNS = ("length_ratio", "sag", "max_tension", "status")


@pytest.fixture
def expected(study: Path) -> dict[str, np.ndarray]:
    """The columns that CONDITION selects, straight from the dataset."""
    with xr.open_dataset(study / "results" / "tiny.nc") as dataset:
        part = dataset.sel({"method": "exact", "rise": 0.1}).sel(length_ratio=[1.1, 1.2, 1.3])
        return {name: part[name].values for name in ("length_ratio", "sag", "max_tension")}


def ask_for(ask: Ask, form: str, *more: object) -> Answer:
    return ask("query", "results", "tiny", CONDITION, "--columns", ",".join(COLUMNS), "--format", form, *more)


def assert_same(found: pd.DataFrame, expected: dict[str, np.ndarray]) -> None:
    """The columns in the order they were asked for, with every digit."""
    assert tuple(found.columns) == COLUMNS
    assert list(found["status"]) == ["ok"] * 3
    for name, values in expected.items():
        np.testing.assert_array_equal(found[name].to_numpy(dtype=float), values, err_msg=name)


def test_a_query_as_csv_has_every_digit(in_study: Path, ask: Ask, expected: dict[str, np.ndarray]) -> None:
    answer = ask_for(ask, "csv")
    assert (answer.code, answer.err) == (0, "")
    assert_same(pd.read_csv(io.BytesIO(answer.out), dtype=str, skiprows=[1]), expected)


def test_a_query_as_json_has_every_digit_and_the_units(
    in_study: Path, ask: Ask, expected: dict[str, np.ndarray]
) -> None:
    answer = ask_for(ask, "json")
    assert (answer.code, answer.err) == (0, "")
    found = json.loads(answer.out)
    assert found["units"] == {"length_ratio": "1", "sag": "m", "max_tension": "N"}
    assert_same(pd.DataFrame(found["rows"]), expected)


def test_a_query_as_parquet_has_every_digit(in_study: Path, ask: Ask, expected: dict[str, np.ndarray]) -> None:
    answer = ask_for(ask, "parquet")
    assert (answer.code, answer.err) == (0, "")
    assert_same(pd.read_parquet(io.BytesIO(answer.out)), expected)


def test_a_query_as_netcdf_has_every_digit_and_the_units(
    in_study: Path, tmp_path: Path, ask: Ask, expected: dict[str, np.ndarray]
) -> None:
    answer = ask_for(ask, "netcdf")
    assert (answer.code, answer.err) == (0, "")
    (tmp_path / "found.nc").write_bytes(answer.out)
    with xr.open_dataset(tmp_path / "found.nc") as dataset:
        assert dataset.sag.attrs["units"] == "m"
        found = dataset.to_dataframe()
        found["status"] = dataset.status.values.astype(str)
    assert_same(found, expected)


def test_a_query_as_a_table_is_for_people(in_study: Path, ask: Ask, expected: dict[str, np.ndarray]) -> None:
    answer = ask_for(ask, "table")
    assert (answer.code, answer.err) == (0, "3 of 16 scenarios\n")
    names, units, _, *rows = answer.text.splitlines()
    assert names.split() == list(COLUMNS)
    assert units.split() == ["[m]", "[N]"]
    assert [float(row.split()[1]) for row in rows] == pytest.approx(expected["sag"], rel=1e-5)


@pytest.mark.parametrize("form", ["table", "csv", "json", "parquet", "netcdf"])
def test_a_query_into_a_file_writes_what_it_would_have_printed(
    form: str, in_study: Path, tmp_path: Path, ask: Ask
) -> None:
    printed = ask_for(ask, form)
    before = tree(in_study)
    answer = ask_for(ask, form, "--output", tmp_path / "found")
    assert (answer.code, answer.out) == (0, b"")
    assert tree(tmp_path) == {"found": printed.out}
    assert tree(in_study) == before


@pytest.mark.parametrize("form", ["table", "csv", "json", "parquet", "netcdf"])
def test_a_query_that_finds_nothing_is_an_empty_answer(form: str, in_study: Path, ask: Ask) -> None:
    answer = ask("query", "results", "tiny", "sag > 1 km", "--columns", "sag,status", "--format", form)
    assert answer.code == 0
    assert answer.out


def test_a_query_without_a_condition_has_every_scenario(in_study: Path, ask: Ask) -> None:
    found = pd.read_csv(io.BytesIO(ask("query", "results", "tiny", "--format", "csv").out), skiprows=[1])
    assert len(found) == 16
    assert {"method", "rise", "length_ratio", "sag", "max_tension", "status", "run_time"} <= set(found.columns)
    assert found.loc[found["status"] == "infeasible", "sag"].isna().all()


def test_json_has_null_where_there_is_no_number(in_study: Path, ask: Ask) -> None:
    arguments = ("query", "results", "tiny", "status != ok", "--columns", "sag,status", "--format", "json")
    assert json.loads(ask(*arguments).out)["rows"] == [{"sag": None, "status": "infeasible"}] * 4


@pytest.mark.parametrize(
    ("condition", "same"),
    [
        ("sag > 50 cm", "sag > 0.5"),
        ("max_tension < 0.006 kN", "max_tension < 6"),
        ("sag / span > 25 %", "sag > 0.625"),
        ("weight_per_length * span > 7 N and rise == 100 mm", "rise == 0.1"),
        ("exact.sag > 0.6 m", "exact.sag > 60 cm"),
        ("length_ratio == 1.1 or length_ratio == 1.2", "1.05 < length_ratio and not length_ratio > 1.25"),
        ("status == infeasible", "not (status == ok)"),
        ("method != parabolic", 'method == "exact"'),
        ("sqrt(sag ^ 2) > 0.5 m", "abs(-sag) > 500 mm"),
    ],
)
def test_two_ways_to_say_a_condition_find_the_same(condition: str, same: str, in_study: Path, ask: Ask) -> None:
    first, second = (ask("query", "results", "tiny", text, "--format", "csv") for text in (condition, same))
    assert (first.code, second.code) == (0, 0)
    assert 1 < first.out.count(b"\n") < 17
    assert first.out == second.out


# ---- compare ----


@pytest.fixture
def copy(in_study: Path, tmp_path: Path) -> Path:
    """A second folder of the same results."""
    shutil.copytree("results", tmp_path / "copy")
    return tmp_path / "copy"


def change(results: Path, name: str, value: float | int) -> None:
    """Overwrite a value of the first solved line in the dataset."""
    with rewritten(results / "tiny.nc") as file:
        file.variables[name][0, 0, 1] = value


def test_a_folder_compared_with_itself_is_the_same(in_study: Path, ask: Ask) -> None:
    before = tree(in_study)
    answer = ask("compare", "results", "results")
    assert (answer.code, answer.err) == (0, "")
    assert answer.text.endswith("the same\n")
    assert tree(in_study) == before


def test_measured_times_are_not_compared(copy: Path, ask: Ask) -> None:
    with rewritten(copy / "tiny.nc") as file:
        file["measured"].variables["run_time"][:] = 1.0
    assert ask("compare", "results", copy).code == 0


@pytest.mark.parametrize(("name", "value"), [("sag", 0.7), ("sag", np.nan), ("status", 2), ("profile", 0.3)])
def test_a_changed_value_is_found(name: str, value: float, copy: Path, ask: Ask) -> None:
    change(copy, name, value)
    answer = ask("compare", "results", copy)
    assert (answer.code, answer.err) == (1, "")
    assert answer.text.endswith("they differ\n")
    assert f" {name} " in answer.text and " tiny " in answer.text


def test_a_change_within_the_tolerance_is_none(copy: Path, ask: Ask) -> None:
    with rewritten(copy / "tiny.nc") as file:
        file.variables["sag"][:] *= 1.0 + 1e-9
    assert ask("compare", "results", copy).code == 1
    assert ask("compare", "results", copy, "--tolerance", "1e-8").code == 0


def test_a_scene_in_one_folder_only_is_a_change(copy: Path, ask: Ask) -> None:
    shutil.copy(copy / "tiny.nc", copy / "more.nc")
    for folders, side in ((("results", copy), "only in B"), ((copy, "results"), "only in A")):
        answer = ask("compare", *folders)
        assert (answer.code, answer.err) == (1, "")
        assert side in answer.text and "more" in answer.text


def test_scenarios_added_and_removed_are_counted(copy: Path, tmp_path: Path, ask: Ask) -> None:
    text = Path("tiny.yaml").read_text().replace("[0.9, 1.1, 1.2, 1.3]", "[1.3, 1.2, 1.1, 1.4, 1.5]")
    (tmp_path / "tiny.yaml").write_text(text)
    assert ask("run", tmp_path / "tiny.yaml", "--out", tmp_path / "other").code == 0
    answer = ask("compare", "results", tmp_path / "other")
    assert answer.code == 1
    head, _, *rows = ([cell.strip() for cell in line.split("|")] for line in answer.text.splitlines()[:-1])
    sag = dict(zip(head, next(row for row in rows if row[2] == "sag"), strict=True))
    # Two methods, two rises: 3 ratios in both, 1 removed, 2 added; those in both have not changed.
    assert (sag["in both"], sag["removed"], sag["added"], sag["beyond tolerance"]) == ("12", "4", "8", "0")


# ---- the machine's faults ----


def assert_machine_at_fault(answer: Answer, path: str) -> None:
    assert (answer.code, answer.out) == (3, b"")
    assert answer.err.startswith("cablesim: ") and answer.err.count("\n") == 1
    assert path in answer.err


def test_a_damaged_dataset_is_the_machines_fault(copy: Path, ask: Ask) -> None:
    content = (copy / "tiny.nc").read_bytes()
    for damaged in (b"", content[:1000], content[: len(content) // 2], b"x" * len(content)):
        (copy / "tiny.nc").write_bytes(damaged)
        assert_machine_at_fault(ask("query", copy, "tiny", "sag > 1", "--format", "csv"), "tiny.nc")
        assert_machine_at_fault(ask("scenes", copy), "tiny.nc")
        assert_machine_at_fault(ask("compare", "results", copy), "tiny.nc")


def test_a_dataset_that_is_not_ours_is_the_machines_fault(copy: Path, ask: Ask) -> None:
    xr.Dataset({"sag": ("x", [1.0, 2.0])}).to_netcdf(copy / "tiny.nc")
    assert_machine_at_fault(ask("query", copy, "tiny", "sag > 1", "--format", "csv"), "tiny.nc")


def test_a_file_in_the_place_of_the_results_folder_is_named(here: Path, ask: Ask) -> None:
    (here / "results").write_text("in the way")
    before = tree(here)
    assert_machine_at_fault(ask("run", "good.yaml"), "results")
    assert tree(here) == before


def test_a_shard_that_is_missing_is_named_and_its_scenarios_are_not_run(here: Path, ask: Ask) -> None:
    assert ask("step", "sample", "good.yaml", "results").code == 0
    assert_machine_at_fault(ask("step", "collect", "good.yaml", "results"), "results/shards/good/")
    answer = ask("query", "results", "good", "status == not_run", "--format", "json")
    assert len(json.loads(answer.text)["rows"]) == 2
