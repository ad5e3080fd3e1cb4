"""Error against run time: what is measured, what is drawn from it, and that results do not depend on it."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from cablesim.cli import main
from cablesim.config.scene import read_scene
from cablesim.database.reading import read_dataset
from cablesim.database.timing import Timing, Timings, read_timings, write_timings
from cablesim.errors import EnvironmentFault
from cablesim.report.precision import (
    WorkAndPrecision,
    Worth,
    advice,
    fastest_table,
    precision_table,
    work_and_precision,
)
from tests.cli.helpers import scene

PRECISION = {"output": "max_tension", "reference_error": 1e-15, "seconds": 0.02, "repeats": 3}
PARTS = {
    "title": "Two formulas",
    "design": "{grid: {length_ratio: [1.01, 1.05, 1.1]}}",
    "methods": {
        "exact": {"solver": "catenary_exact"},
        "series": {"solver": "catenary_series"},
        "parabolic": {"solver": "catenary_parabolic"},
    },
    "reference": "exact",
    "outputs": "[sag, max_tension]",
    "work_precision": PRECISION,
    "figures": {"diagram": {"kind": "work_precision"}},
}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A folder with a scene and its results."""
    folder = tmp_path_factory.mktemp("precision")
    (folder / "formulas.yaml").write_text(scene(**PARTS))
    assert main(["run", str(folder / "formulas.yaml"), "--out", str(folder / "results")]) == 0
    return folder


def opened(folder):
    return read_scene(folder / "formulas.yaml"), read_dataset(folder / "results" / "formulas.nc")


def test_times_are_measured_of_every_method_but_the_reference(run):
    with xr.open_dataset(run / "results" / "formulas.nc", group="measured") as measured:
        assert np.isfinite(measured.repeats.values).tolist() == [False, True, True]
        timed = measured.isel(method=[1, 2])
        for name in ("run_time_lowest", "run_time_highest", "run_time_alone", "first_call_time"):
            assert (timed[name] > 0.0).all(), name
        median = timed.run_time.max("length_ratio")
        assert (timed.run_time_lowest <= median).all() and (median <= timed.run_time_highest).all()
        assert measured.attrs["threads"] == 1
        assert "cores" in measured.attrs["machine"] and "numpy" in measured.attrs["machine"]
        assert measured.attrs["import_seconds"] > 0.0


def test_errors_are_relative_and_against_the_reference(run):
    read, dataset = opened(run)
    table = precision_table(read, dataset).set_index("method")
    for method in ("series", "parabolic"):
        found, exact = (dataset.max_tension.sel({"method": name}).values for name in (method, "exact"))
        error = np.abs(found / exact - 1.0)
        # Both forms of a relative error round differently.
        np.testing.assert_allclose(table.loc[method, "largest error"], error.max(), rtol=1e-9)
        np.testing.assert_allclose(table.loc[method, "median error"], np.median(error), rtol=1e-9)
    assert (table["solved"] == "3 of 3").all()
    written = (run / "results" / "tables" / "formulas_work_precision.csv").read_text()
    assert written.count("\n") == 3
    assert (run / "results" / "figures" / "formulas_diagram.png").stat().st_size > 10_000


def test_the_sentence_names_the_fastest_for_each_accuracy(run):
    read, dataset = opened(run)
    words = advice(read, dataset)
    best = fastest_table(read, dataset).set_index("accuracy")["fastest"]
    # The parabola is off by 4 % at 1.1, the series by 2e-3.
    assert best[1e-2] == "series" and best[1e-9] == "none"
    assert words.startswith("For 1 % use series (") and words.endswith("for 1e-9 there is no method here.")
    assert words in (run / "results" / "tables" / "formulas_fastest.md").read_text()


def test_a_second_run_measures_nothing_again_and_the_results_are_the_same_bytes(run, tmp_path):
    timings, _ = sorted((run / "results" / "timings").iterdir())
    before = timings.read_bytes()
    assert main(["run", str(run / "formulas.yaml"), "--out", str(run / "results")]) == 0
    assert timings.read_bytes() == before
    assert main(["run", str(run / "formulas.yaml"), "--out", str(tmp_path / "other")]) == 0
    assert main(["compare", str(run / "results"), str(tmp_path / "other")]) == 0
    one, other = (xr.open_dataset(folder / "formulas.nc") for folder in (run / "results", tmp_path / "other"))
    with one, other:
        xr.testing.assert_identical(one.load(), other.load())


def test_a_scene_that_asks_for_no_times_has_none_to_measure(tmp_path, capsys):
    (tmp_path / "plain.yaml").write_text(scene())
    assert main(["step", "measure", str(tmp_path / "plain.yaml"), str(tmp_path / "results")]) == 2
    assert "work_precision" in capsys.readouterr().err
    assert not (tmp_path / "results").exists()


def test_timings_are_kept_whole_and_damage_is_named(tmp_path):
    path = tmp_path / "lines.0123.json"
    timings = Timings("a machine", 0.5, {"exact": Timing((1e-6, 3e-6, 2e-6), 1e-5, 0.2)})
    (tmp_path / "lines.4567.json").write_text("of an earlier content")
    write_timings(path, timings)
    assert read_timings(path) == timings
    assert timings.methods["exact"].median == 2e-6
    assert sorted(one.name for one in tmp_path.iterdir()) == ["lines.0123.json", "lines.0123.json.json"]
    path.write_text(path.read_text().replace("2e-06", "2e-05"))
    with pytest.raises(EnvironmentFault, match=r"lines\.0123\.json: damaged .*run the study again"):
        read_timings(path)
    assert "runs" in json.dumps({"runs": timings.methods["exact"].runs})


def worth(name, run_time, errors):
    return Worth(SimpleNamespace(name=name), np.array(errors), {"run_time": run_time}, {})


MADE_UP = WorkAndPrecision(
    "sag",
    1e-12,
    (
        worth("rough", 1.0, [1e-2, 5e-2]),
        worth("beaten", 3.0, [1e-2, 2e-2]),
        worth("good", 2.0, [1e-5, 1e-4]),
        worth("fine", 9.0, [1e-13, 3e-13]),
        worth("as fine", 8.0, [2e-12, 9e-11]),
        worth("fails", 0.5, [1e-9, np.nan]),
    ),
)


def test_the_front_is_what_nothing_beats_in_both_as_far_as_the_reference_tells():
    assert [one.name for one in MADE_UP.front] == ["rough", "good", "as fine"]


@pytest.mark.parametrize(
    ("target", "name"), [(0.1, "rough"), (1e-2, "good"), (1e-5, "as fine"), (1e-11, "fine"), (1e-12, None)]
)
def test_the_fastest_method_keeps_the_accuracy_in_every_scenario(target, name):
    best = MADE_UP.fastest(target)
    assert (best.name if best else None) == name


def test_the_error_of_the_reference_is_what_it_differs_by_from_its_check(tmp_path):
    parts = PARTS | {"work_precision": {**PRECISION, "check": "series"}}
    del parts["work_precision"]["reference_error"]
    (tmp_path / "checked.yaml").write_text(scene(**parts))
    assert main(["run", str(tmp_path / "checked.yaml"), "--out", str(tmp_path / "results")]) == 0
    read, dataset = read_scene(tmp_path / "checked.yaml"), read_dataset(tmp_path / "results" / "checked.nc")
    found = work_and_precision(read, dataset)
    series = next(one for one in found.methods if one.name == "series")
    assert found.reference_error == series.largest > 0.0
    assert "the reference does not tell" in advice(read, dataset)


# Of the scenes in the default study: what does not depend on the machine.
