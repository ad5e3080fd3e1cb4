"""Histories, all the way from a solver that records them to shards, datasets, queries and figures."""

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import matplotlib.pyplot as plt
import netCDF4
import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from PIL import Image

from cablesim.config.scene import read_scene
from cablesim.costs import BESIDE, Sizes
from cablesim.database.query import query
from cablesim.database.reading import open_scene, read_dataset
from cablesim.plan import read_plan
from cablesim.quantities import PLACES
from cablesim.report import animations, figures, snapshots
from cablesim.report.snapshots import Motion
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
    # Each scenario has its own times: `history_time`. CF wants a coordinate `time` to be one for all.
    assert found.sizes["time"] == 13 and "time" not in found.variables
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


def test_a_method_may_do_without_what_may_be_left_out(tmp_path, ask: Ask):
    methods = "{given: {solver: swinging_line}, free: {solver: swinging_line, ignores: [top_amplitude]}}"
    found = run(tmp_path, methods=methods, outputs="[max_top_tension]").max_top_tension
    # 1000 N (1 + A/Z), with 1 m where the amplitude is left out.
    np.testing.assert_allclose(found.sel({"method": "given", "depth": 20.0}), [1050.0, 1150.0])
    np.testing.assert_allclose(found.sel({"method": "free", "depth": 20.0}), [1050.0, 1050.0])
    (tmp_path / "swung.yaml").write_text(swung(methods=methods.replace("[top_amplitude]", "[depth]")))
    assert_refused(ask("check", tmp_path / "swung.yaml"), "has the parameter 'depth': it cannot ignore it")


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
    # 6 scenarios of 8 bytes, of 1001 x 3 times 4, and of what is beside every answer.
    assert Sizes(read_scene(path), 0.0).payload == 6 * (8 + 12012 + BESIDE)
    assert "one (swinging_line): 6 to solve in 1 shard(s), about 6 s" in text


def test_shards_are_cut_by_what_the_options_cost(tmp_path):
    path = tmp_path / "swung.yaml"
    many = "{grid: {depth: {start: 10, stop: 100, num: 100}}}"
    sizes = {}
    for segments in (100, 1000):
        path.write_text(
            swung(design=many, methods=f"{{one: {{solver: swinging_line, options: {{segments: {segments}}}}}}}")
        )
        plan, _ = run_scene(read_scene(path), Layout(tmp_path / f"results {segments}"), lambda *_: None)
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


# ---- figures ----

PANELS = {"at": {"depth": ["10 m", "20 m"]}}
POINT = {"point": {"depth": "10 m", "top_amplitude": "1 m"}}
AMPLITUDE = {"point": {"top_amplitude": "1 m"}}


def drawn(folder: Path, monkeypatch: pytest.MonkeyPatch, **look: object) -> Figure:
    """The picture of a scene's only figure, before it is saved."""
    pictures: list[Figure] = []
    monkeypatch.setattr(figures, "_save", lambda picture, stem: pictures.append(picture))
    run(folder, figures={"look": look})
    plt.close("all")
    return pictures[0]


def test_a_history_has_a_panel_for_each_at_and_a_curve_for_each_scenario_and_method(tmp_path, monkeypatch):
    each = {"each": {"top_amplitude": ["1 m", "3 m"]}}
    picture = drawn(tmp_path, monkeypatch, kind="history", **PANELS, **each, place="middle")
    assert [axes.get_title() for axes in picture.axes] == ["depth 10 m", "depth 20 m"]
    assert [len(axes.lines) for axes in picture.axes] == [4, 4]
    line = picture.axes[1].lines[2]
    assert line.get_label() == "top amplitude 3 m, coarse"
    np.testing.assert_allclose(line.get_xdata(), np.linspace(0.0, 48.0, 13))
    # Of 1000 N at the top, half in the middle; times of the stub are whole periods of 4 s.
    np.testing.assert_allclose(line.get_ydata(), 0.5, rtol=1e-6)
    assert picture.axes[0].get_shared_y_axes().joined(*picture.axes)
    assert picture.get_supylabel() == "tension at the middle $T$ [kN]"


def test_a_history_is_cut_to_the_times_that_are_asked(tmp_path, monkeypatch):
    window = {"from": "8 s", "to": "0.5 min"}
    picture = drawn(tmp_path, monkeypatch, kind="history", **POINT, **window, methods=["fine"], x_label="t")
    axes = picture.axes[0]
    assert axes.lines[0].get_xdata().tolist() == [8.0, 12.0, 16.0, 20.0, 24.0, 28.0]
    assert axes.get_xlim() == (8.0, 30.0)
    assert (axes.get_xlabel(), picture.get_supylabel()) == ("t $t$ [s]", "tension at the top $T$ [kN]")


def test_a_history_that_starts_after_all_have_ended_is_refused(ask: Ask, tmp_path):
    path = tmp_path / "swung.yaml"
    path.write_text(swung(figures={"look": {"kind": "history", **POINT, "from": "1 min"}}))
    answer = ask("run", path, "--out", tmp_path / "results")
    assert answer.code == 2
    assert "figures.look: no history reaches 60 s: the longest ends at 48 s" in answer.err


def test_an_orbit_is_closed_and_starts_at_the_larger_dot(tmp_path, monkeypatch):
    each = {"each": {"depth": ["10 m", "20 m"]}}
    picture = drawn(tmp_path, monkeypatch, kind="orbit", **each, **AMPLITUDE, methods=["fine"], view="xy")
    path, start = picture.axes[0].lines[:2]
    np.testing.assert_allclose(path.get_xdata(), [0.0, 0.5, 0.0, -0.5, 0.0], atol=1e-7)
    np.testing.assert_allclose(path.get_ydata(), 0.0)
    assert (start.get_xdata()[0], start.get_ydata()[0]) == (path.get_xdata()[0], 0.0)
    assert picture.axes[0].get_xlabel() == "horizontal distance from rest $x$ [m]"
    assert [text.get_text() for text in picture.axes[0].get_legend().get_texts()] == ["depth 10 m", "depth 20 m"]


def test_snapshots_are_coloured_by_tension_on_one_scale_for_all_panels(tmp_path, monkeypatch):
    picture = drawn(tmp_path, monkeypatch, kind="snapshots", **PANELS, **AMPLITUDE, method="fine", magnify=2)
    *panels, bar = picture.axes
    assert [axes.get_title() for axes in panels] == ["depth 10 m", "depth 20 m"]
    lines = [axes.collections[0] for axes in panels]
    assert lines[0].norm is lines[1].norm
    # 1000 N (1 + 1 m / 10 m), at the top of the shallower line.
    assert (lines[0].norm.vmin, lines[0].norm.vmax) == (0.0, pytest.approx(1.1))
    # Four phases of four elements; the first element carries the mean of its ends.
    elements = np.array(lines[0].get_segments()).reshape(4, 4, 2, 2)
    np.testing.assert_allclose(elements[1, -1, 1], [2.0, 10.0])
    assert lines[0].get_array()[0] == pytest.approx(0.125)
    rest = panels[0].lines[0]
    assert rest.get_linestyle() == "--"
    np.testing.assert_allclose(rest.get_ydata(), [0.0, 2.5, 5.0, 7.5, 10.0])
    assert bar.get_ylabel() == "tension $T$ [kN]; motion × 2"


def test_elements_with_hardly_any_tension_have_a_colour_of_their_own(tmp_path, monkeypatch):
    picture = drawn(tmp_path, monkeypatch, kind="snapshots", **PANELS, **AMPLITUDE, method="fine")
    assert "orange" not in picture.axes[-1].get_ylabel()
    norm = picture.axes[0].collections[0].norm
    tension = np.array([[0.0, 0.01, 1.1]])
    np.testing.assert_allclose(snapshots.colour_values(tension, norm), [-1.0, 0.555])


def test_an_animation_runs_through_the_period_and_begins_again(tmp_path):
    look = {"kind": "animation", **PANELS, **AMPLITUDE, "method": "fine", "magnify": 2}
    run(tmp_path, figures={"look": look})
    folder = tmp_path / "results" / "figures"
    assert {path.suffix for path in folder.glob("swung_look.*")} == {".gif", ".svg", ".pdf", ".png"}
    assert (folder / "swung_look.gif").stat().st_size < 1_000_000
    with Image.open(folder / "swung_look.gif") as picture:
        assert (picture.n_frames, picture.info["loop"]) == (animations.FRAMES, 0)
        frames = [np.asarray(picture.convert("RGB"), dtype=float)]
        for number in range(1, animations.FRAMES):
            picture.seek(number)
            frames.append(np.asarray(picture.convert("RGB"), dtype=float))
    changes = [np.abs(after - before).mean() for before, after in pairwise([*frames, frames[0]])]
    # No jump where it begins again, and something moves all the time.
    assert min(changes) > 0.0 and changes[-1] < 2.0 * np.median(changes)


def test_between_the_phases_a_line_moves_smoothly_and_passes_through_them():
    phase = 2.0 * np.pi * np.arange(16) / 16
    places = np.stack([np.cos(phase), np.sin(phase)], axis=1)[:, None, :]
    tension = np.arange(16.0)[:, None]
    moved = animations.between(Motion(places[0], places, tension), 48)
    np.testing.assert_allclose(moved.places[::3], places, atol=1e-14)
    np.testing.assert_allclose(moved.tension[::3], tension)
    # A circle by splines of a sixteenth each: off by h^4/384, h = pi/8.
    np.testing.assert_allclose(np.linalg.norm(moved.places, axis=-1), 1.0, atol=1e-4)
    assert moved.tension[:4, 0].tolist() == pytest.approx([0.0, 1 / 3, 2 / 3, 1.0])
    assert moved.tension[-1, 0] == pytest.approx(5.0)


@pytest.mark.parametrize("kind", ["history", "orbit", "snapshots", "animation"])
def test_a_line_without_a_solution_leaves_an_empty_picture(kind, tmp_path):
    method = {"method": "fine"} if kind in ("snapshots", "animation") else {}
    point = {"depth": "2 m", "top_amplitude": "3 m"}
    assert run(tmp_path, figures={"look": {"kind": kind, "point": point, **method}}).status.max() == 1
    for suffix in ("svg", "pdf", "png", *(["gif"] if kind == "animation" else [])):
        assert (tmp_path / "results" / "figures" / f"swung_look.{suffix}").stat().st_size > 0


def test_the_same_picture_is_the_same_bytes(tmp_path):
    looks = {
        "a": {"kind": "history", **PANELS, **AMPLITUDE},
        "b": {"kind": "orbit", **POINT},
        "c": {"kind": "snapshots", **POINT, "method": "fine"},
        "d": {"kind": "animation", **POINT, "method": "fine"},
    }
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        run(tmp_path / name, figures=looks)
    first = sorted((tmp_path / "one" / "results" / "figures").glob("swung_*.*"))
    assert [path.suffix for path in first].count(".gif") == 1 and len(first) == 3 * len(looks) + 1
    for one in first:
        assert one.read_bytes() == (tmp_path / "two" / "results" / "figures" / one.name).read_bytes()


def test_a_pdf_has_letters_that_can_be_searched_and_no_clock(tmp_path):
    run(tmp_path, figures={"look": {"kind": "orbit", **POINT}})
    page = (tmp_path / "results" / "figures" / "swung_look.pdf").read_bytes()
    assert b"/FontFile2" in page and b"/Type3" not in page and b"CreationDate" not in page


def test_tensions_are_shown_in_the_unit_that_is_asked_for(tmp_path, monkeypatch):
    picture = drawn(tmp_path, monkeypatch, kind="history", **POINT, methods=["fine"], y_unit="N", x_unit="min")
    assert picture.get_supylabel() == "tension at the top $T$ [N]"
    assert picture.axes[0].get_xlabel() == "time $t$ [min]"
    x, y = picture.axes[0].lines[0].get_xdata(), picture.axes[0].lines[0].get_ydata()
    np.testing.assert_allclose(x, np.linspace(0.0, 0.8, 13), rtol=1e-6)
    np.testing.assert_allclose(y, 1e3, rtol=1e-6)


def test_a_shape_in_space_has_arrows_for_the_waves(tmp_path, monkeypatch):
    picture = drawn(tmp_path, monkeypatch, kind="spatial", **POINT)
    assert picture.legends[0].get_texts()[-1].get_text() == "arrow: waves and stream"


WRONG_FIGURES = {
    "an unknown key": ({"kind": "history", **POINT, "placed": "top"}, "figures.look.placed: unknown key 'placed'"),
    "an unknown place": ({"kind": "history", **POINT, "place": "bottom"}, "figures.look.place: unknown value 'bottom'"),
    "a time in metres": ({"kind": "history", **POINT, "from": "3 m"}, "figures.look.from: "),
    "a time before the start": ({"kind": "history", **POINT, "from": -1}, "look.from: a time >= 0 s is expected"),
    "a last time before the start": ({"kind": "history", **POINT, "to": -1}, "look.to: a time >= 0 s is expected"),
    "times in the wrong order": (
        {"kind": "history", **POINT, "from": "9 s", "to": "9 s"},
        "look.to: a time after 9 s is expected, not 9 s",
    ),
    "no time at all": ({"kind": "history", **POINT, "to": 0}, "look.to: a time after 0 s is expected, not 0 s"),
    "a title too few": ({"kind": "history", **PANELS, **AMPLITUDE, "titles": ["a"]}, "look.titles: a title for each"),
    "panels of a fraction": ({"kind": "history", **POINT, "across": 1.5}, "look.across: a whole number from 1 to 6"),
    "a scenario left open": ({"kind": "history", "point": {"depth": "10 m"}}, "2 scenarios are left along top_ampl"),
    "a value that is not on the axis": ({"kind": "orbit", "point": {"depth": "11 m"}}, "look.point.depth: no scenario"),
    "an unknown method": ({"kind": "orbit", **POINT, "methods": ["find"]}, "look.methods[0]: unknown value 'find'"),
    "an unknown view": ({"kind": "orbit", **POINT, "view": "zx"}, "figures.look.view: unknown value 'zx'"),
    "an orbit with panels": ({"kind": "orbit", **PANELS, **AMPLITUDE}, "figures.look.at: unknown key 'at'"),
    "snapshots of two methods": ({"kind": "snapshots", **POINT}, "look: snapshots are those of one method: choose"),
    "snapshots of an unknown method": ({"kind": "snapshots", **POINT, "method": "find"}, "look.method: unknown value"),
    "snapshots for each": (
        {"kind": "snapshots", **PANELS, "each": {"top_amplitude": ["1 m"]}, "method": "fine"},
        "look.each: unknown key 'each'",
    ),
    "a motion that is not magnified": (
        {"kind": "snapshots", **POINT, "method": "fine", "magnify": 0},
        "look.magnify: a number > 0 is expected, not 0",
    ),
    "a curve of a history": ({"kind": "curves", "x": "depth", "y": "history"}, "look.y: a history has many values"),
    "a curve of an orbit": ({"kind": "curves", "x": "depth", "y": "orbit"}, "look.y: a history has many values"),
}


@pytest.mark.parametrize(("look", "complaint"), WRONG_FIGURES.values(), ids=WRONG_FIGURES)
def test_a_figure_is_refused_that_has(look, complaint, ask: Ask, tmp_path):
    path = tmp_path / "swung.yaml"
    path.write_text(swung(figures={"look": look}))
    assert_refused(ask("check", path), "swung.yaml:6: ", complaint)


@pytest.mark.parametrize(
    ("look", "outputs"),
    [
        ({"kind": "history", **POINT}, ["history", "history_time"]),
        ({"kind": "orbit", **POINT}, ["orbit"]),
        ({"kind": "snapshots", **POINT, "method": "fine"}, ["snapshots", "snapshot_tension", "profile"]),
    ],
)
def test_a_figure_needs_its_outputs(look, outputs, ask: Ask, tmp_path):
    path = tmp_path / "swung.yaml"
    for missing in outputs:
        stored = [name for name in ("max_top_tension", *outputs) if name != missing]
        path.write_text(swung(outputs=stored, figures={"look": look}))
        assert_refused(ask("check", path), "swung.yaml:6: figures.look: ", f"needs the output '{missing}'")


def test_a_printed_table_has_no_room_for_a_history(ask: Ask, tmp_path):
    path = tmp_path / "swung.yaml"
    tables = {"look": {"rows": "depth", "across": "top_amplitude", "columns": ["fine.history_time"]}}
    path.write_text(swung(tables=tables))
    assert_refused(ask("check", path), "tables.look.columns", "a cell has one value, this has many along time")
