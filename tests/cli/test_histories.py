"""Histories, all the way from a solver that records them to shards, datasets, queries and figures."""

from collections.abc import Callable
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr

from cablesim.config.scene import read_scene
from cablesim.database.query import query
from cablesim.database.reading import open_scene, read_dataset
from cablesim.plan import read_plan
from cablesim.quantities import PLACES
from cablesim.solver import load_solver
from cablesim.steps import run_scene
from cablesim.study import Layout
from tests.cli.helpers import Answer, assert_refused, scene

Ask = Callable[..., Answer]
HISTORIES = ("history", "history_time", "orbit", "snapshots", "snapshot_tension")
# The line of 2 m is too short for an amplitude of 3 m.
SWUNG = {
    "design": "{grid: {depth: [10 m, 2 m, 20 m], top_amplitude: [1 m, 3 m]}}",
    "fixed": "{wave_period: 4 s}",
    "methods": "{coarse: {solver: swinging_line}, fine: {solver: swinging_line, options: {rtol: 1e-6}}}",
    "outputs": "[max_top_tension, history, history_time, orbit, profile, snapshots, snapshot_tension]",
}

pytestmark = pytest.mark.usefixtures("pulled_line")


def swung(**parts: object) -> str:
    return scene(**{**SWUNG, **parts})


def run(folder: Path, **parts: object) -> xr.Dataset:
    path = folder / "swung.yaml"
    path.write_text(swung(**parts))
    run_scene(read_scene(path), Layout(folder / "results"), lambda step, done, total: None)
    return open_scene(folder / "results", "swung")


# ---- datasets ----


def test_histories_are_stored_with_their_own_dimensions_in_single_precision(tmp_path):
    found = run(tmp_path)
    axes = ("method", "depth", "top_amplitude")
    assert found.history.dims == (*axes, "time", "place")
    assert found.history_time.dims == (*axes, "time")
    assert found.orbit.dims == (*axes, "phase", "component")
    assert found.snapshots.dims == (*axes, "phase", "node", "component")
    assert found.snapshot_tension.dims == (*axes, "phase", "node")
    assert {found[name].dtype for name in HISTORIES} == {np.dtype(np.float32)}
    assert found.profile.dtype == found.max_top_tension.dtype == np.float64
    assert found.place.values.tolist() == list(PLACES)
    assert found.phase.values.tolist() == [0.0, 0.25, 0.5, 0.75]
    assert found.time.values.tolist() == list(range(13))
    assert found.history.attrs["units"] == "N"


def test_a_history_is_what_the_solver_answered(tmp_path):
    found = run(tmp_path).sel({"depth": 10.0, "top_amplitude": 1.0, "method": "fine"})
    np.testing.assert_allclose(found.history_time, np.linspace(0.0, 48.0, 13))
    # Single precision, against 1000 N (1 + A/Z sin).
    expected = 1e3 * (1.0 + 0.1 * np.sin(np.pi / 2.0 * found.history_time.values.astype(float)))
    np.testing.assert_allclose(found.history.sel(place="top"), expected, rtol=1e-6)
    np.testing.assert_allclose(found.history.sel(place="middle"), expected / 2.0, rtol=1e-6)
    np.testing.assert_allclose(found.orbit.sel(component="x"), [0.0, 0.5, 0.0, -0.5], atol=1e-7)
    np.testing.assert_allclose(found.snapshots.sel(phase=0.25, component="x"), [0, 0.25, 0.5, 0.75, 1.0])
    np.testing.assert_allclose(found.snapshot_tension.sel(phase=0.75).isel(node=-1), 900.0)


def test_a_failed_scenario_has_no_history(tmp_path):
    found = run(tmp_path)
    failed = found.status.values != 0
    assert failed.sum() == 2
    for name in HISTORIES:
        values = found[name].values.reshape(*failed.shape, -1)
        np.testing.assert_array_equal(np.isnan(values), np.broadcast_to(failed[..., None], values.shape))


def test_a_history_is_compressed_and_read_one_scenario_at_a_time(tmp_path):
    run(tmp_path)
    with netCDF4.Dataset(tmp_path / "results" / "swung.nc") as file:
        assert file["history"].chunking() == [1, 1, 1, 13, 3]
        assert file["snapshots"].chunking() == [1, 1, 1, 4, 5, 3]
        filters = file["history"].filters()
    assert (filters["zlib"], filters["shuffle"], filters["complevel"]) == (True, True, 1)
    shard = next((tmp_path / "results" / "shards").glob("**/*.nc"))
    with netCDF4.Dataset(shard) as file:
        assert file["history"].dtype == np.float32
        assert file["history"].shape == (3, 2, 13, 3)


def test_the_dataset_opens_without_us(tmp_path):
    run(tmp_path)
    with xr.open_dataset(tmp_path / "results" / "swung.nc") as plain:
        assert plain.history_time.dtype == np.float32
        assert plain.history.sel(place="anchor").max() == 0.0


def test_the_same_bytes_come_from_the_same_scene(tmp_path):
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        run(tmp_path / name)
    a, b = (read_dataset(tmp_path / name / "results" / "swung.nc").drop_vars("run_time") for name in "ab")
    xr.testing.assert_identical(a, b)


def test_only_what_is_asked_is_recorded(tmp_path):
    calls = load_solver("swinging_line").module.CALLS
    calls.clear()
    found = run(tmp_path, outputs="[max_top_tension]")
    assert {outputs for _, _, outputs in calls} == {("max_top_tension",)}
    assert "time" not in found.variables and "place" not in found.variables


def test_an_output_more_is_computed_anew_and_one_less_is_not(tmp_path):
    run(tmp_path)
    run(tmp_path, outputs="[history]")
    plans = (tmp_path / "results").glob("**/*.npz")
    assert {recipe.outputs for plan in plans for recipe in read_plan(plan).recipes.values()} == {
        tuple(sorted(SWUNG["outputs"].strip("[]").split(", ")))
    }


def test_a_parameter_that_is_left_out_is_not_in_the_dataset_and_a_shard_without_it_is_another(tmp_path):
    assert "duration" not in run(tmp_path).variables
    found = run(tmp_path, fixed="{wave_period: 4 s, duration: 48 s}")
    assert found.duration == 48.0
    shards = {
        recipe.digest for plan in (tmp_path / "results").glob("**/*.npz") for recipe in read_plan(plan).recipes.values()
    }
    assert len(shards) == 4


# ---- sizes and cost ----


def test_methods_of_histories_have_as_many_times(ask: Ask, tmp_path):
    path = tmp_path / "swung.yaml"
    methods = "{a: {solver: swinging_line}, b: {solver: swinging_line, options: {samples: 14, segments: 8}}}"
    for output, dim, sizes in (("history", "time", "a 13, b 14"), ("snapshots", "node", "a 5, b 9")):
        path.write_text(swung(methods=methods, outputs=f"[max_top_tension, {output}]"))
        expected = f"all methods must have the same number of {dim}s in {output}, not {sizes}"
        assert_refused(ask("check", path), "swung.yaml:4: methods", expected)
    path.write_text(swung(methods=methods, outputs="[max_top_tension, orbit]"))
    assert ask("check", path).code == 0


def test_check_counts_histories_and_the_time_that_options_cost(ask: Ask, tmp_path):
    path = tmp_path / "swung.yaml"
    methods = "{one: {solver: swinging_line, options: {segments: 1000, samples: 1001}}}"
    path.write_text(swung(methods=methods, outputs="[max_top_tension, history]"))
    text = ask("check", path).text
    # Once in a shard, once in the dataset: 6 scenarios of 8 bytes, and of 1001 x 3 times 4.
    assert f"at most {2 * 6 * (8 + 12012) / 1000:.3g} kB on disk" in text
    assert "one (swinging_line): 6 to solve in 1 shard(s), about 6 s" in text


def test_shards_are_cut_by_what_the_options_cost(tmp_path):
    path = tmp_path / "swung.yaml"
    many = "{grid: {depth: {start: 10, stop: 100, num: 100}}}"
    sizes = {}
    for segments in (100, 1000):
        path.write_text(
            swung(design=many, methods=f"{{one: {{solver: swinging_line, options: {{segments: {segments}}}}}}}")
        )
        plan = run_scene(read_scene(path), Layout(tmp_path / f"results {segments}"), lambda *_: None)
        sizes[segments] = [recipe.shape for recipe in plan.recipes.values()]
    # Ten seconds of work a shard, of 0.1 s and 1 s a scenario.
    assert sizes == {100: [(100,)], 1000: [(10,)] * 10}


# ---- queries and comparisons ----


def test_a_table_leaves_histories_out(tmp_path):
    table = query(run(tmp_path), "top_amplitude == 1 m and method == fine")
    assert table["max_top_tension"].tolist() == pytest.approx([1100.0, 1500.0, 1050.0])
    assert not {*HISTORIES, "time", "place", "phase", "profile"} & set(table.columns)


@pytest.mark.parametrize("form", ["table", "csv", "json", "parquet"])
def test_a_history_as_a_column_is_refused(form, ask: Ask, tmp_path):
    run(tmp_path)
    asked = (tmp_path / "results", "swung", "--columns", "history", "--format", form, "--output", tmp_path / "out")
    assert_refused(ask("query", *asked), "'history' has many values a scenario: only --format netcdf has room")
    assert not (tmp_path / "out").exists()


def test_netcdf_keeps_histories(ask: Ask, tmp_path):
    found, out = run(tmp_path), tmp_path / "out.nc"
    condition = "depth == 20 m and method == fine"
    assert ask("query", tmp_path / "results", "swung", condition, "--format", "netcdf", "--output", out).code == 0
    expected = found.sel({"depth": 20.0, "method": "fine"})
    with xr.open_dataset(out) as answer:
        assert answer.top_amplitude.values.tolist() == [1.0, 3.0]
        assert answer.history.dims == ("scenario", "time", "place")
        assert answer.history.attrs["units"] == "N"
        assert answer.place.values.astype(str).tolist() == list(PLACES)
        for name in (*HISTORIES, "profile"):
            np.testing.assert_array_equal(answer[name], expected[name])


def test_netcdf_of_some_columns_has_these_alone(ask: Ask, tmp_path):
    run(tmp_path)
    for columns in ("history,depth", "history", "depth"):
        out = tmp_path / f"{columns}.nc"
        asked = ("--columns", columns, "--format", "netcdf", "--output", out)
        assert ask("query", tmp_path / "results", "swung", "top_amplitude == 1 m", *asked).code == 0
        with xr.open_dataset(out) as answer:
            assert set(answer.data_vars) == set(columns.split(","))
            assert answer.sizes["scenario"] == 6


def test_runs_are_compared_by_histories_too(ask: Ask, tmp_path):
    options = {"a": "{samples: 13}", "b": "{samples: 13}", "c": "{samples: 14}"}
    for name, chosen in options.items():
        (tmp_path / name).mkdir()
        run(tmp_path / name, methods=f"{{one: {{solver: swinging_line, options: {chosen}}}}}")
    assert ask("compare", tmp_path / "a" / "results", tmp_path / "b" / "results").code == 0
    answer = ask("compare", tmp_path / "a" / "results", tmp_path / "c" / "results")
    assert answer.code == 1
    assert "history (other sizes)" in answer.text


# ---- one line on the command line ----


def test_solve_answers_with_a_history_if_it_is_asked(ask: Ask):
    given = ("swinging_line", "depth=10 m", "wave_period=4 s", "duration=4 s")
    assert "max_top_tension" in ask("solve", *given).text
    assert "history" not in ask("solve", *given).text
    assert "13 times" in ask("solve", *given, "--outputs", "history").text
    assert_refused(ask("solve", *given, "--outputs", "mesh_change"), "no output 'mesh_change' with these options")


def test_describe_says_what_happens_if_a_parameter_is_left_out(ask: Ask):
    text = ask("describe", "swinging_line").text
    assert "time that is computed (> 0, if left out: 12 wave periods)" in text
    assert "(instead of quadratic_stiffness)" in text
