"""Scenes of stability: every fate has a name, work is bounded, maps and tables of fates and effort tell it."""

import json
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
import xarray as xr
from matplotlib.colors import to_hex

from cablesim.config.scene import read_scene
from cablesim.database.reading import read_dataset, status_words
from cablesim.errors import InputError
from cablesim.report.colours import STATUS_COLOURS
from cablesim.report.drawing import cell_edges
from cablesim.report.figures import draw_figures
from cablesim.report.status_maps import draw_status_map
from cablesim.report.tables import effort_table
from cablesim.status import Status
from cablesim.steps import run_scene
from cablesim.study import Layout, read_study

CONFIG = Path(__file__).parent.parent / "config"
# Enough for what is not stiff; what is, explicit integrators give up.
MOST_STEPS = 1500


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


def run(folder: Path, scene: dict[str, Any]) -> tuple[Any, xr.Dataset]:
    """A scene that is written out, as it is read, and its dataset."""
    path, layout = folder / "small.yaml", Layout(folder / "results")
    path.write_text(json.dumps(scene))
    read = read_scene(path)
    run_scene(read, layout, lambda step, done, total: None)
    return read, read_dataset(layout.dataset("small"))


# ---- scenes of lines in waves ----

WAVES = {
    "title": "Integrators",
    "design": {"grid": {"linear_stiffness": [1e4, 1e7, 1e10], "wave_period": [1.0, 20.0]}},
    "fixed": {
        "depth": 200,
        "chord_angle": "45 deg",
        "length_ratio": 1.01,
        "mass_per_length": 3,
        "area": 3e-4,
        "normal_drag": 15.6,
        "tangential_drag": 0.78,
    },
    "methods": {
        name: {
            "solver": "wave_line",
            "options": {"segments": 4, "mass": "lumped", "most_steps": MOST_STEPS, "integrator": name},
        }
        for name in ("generalized_alpha", "leapfrog", "rk4")
    },
    "outputs": ["max_top_tension", "energy_error", "steps", "rejected_steps", "rhs_evaluations"],
    "figures": {"fates": {"kind": "status_map", "x": "linear_stiffness", "y": "wave_period", "log": "xy"}},
}


@pytest.fixture(scope="module")
def waves(tmp_path_factory) -> tuple[Any, xr.Dataset, Path]:
    folder = tmp_path_factory.mktemp("waves")
    return *run(folder, WAVES), folder / "results"


def test_every_cell_has_a_status_with_a_name_and_only_what_is_solved_has_numbers(waves):
    _, dataset, _ = waves
    assert status_words(dataset) == tuple(status.name for status in Status)
    assert np.isin(dataset.status, list(Status)).all()
    np.testing.assert_array_equal(np.isfinite(dataset.max_top_tension), dataset.status == Status.ok)


def test_stiff_lines_are_given_up_by_explicit_integrators_and_not_by_the_implicit_one(waves):
    _, dataset, _ = waves
    stiffest = dataset.status.sel(linear_stiffness=1e10, wave_period=20.0)
    assert stiffest.sel({"method": ["leapfrog", "rk4"]}).values.tolist() == [Status.not_converged] * 2
    assert (dataset.status.sel(linear_stiffness=1e4, wave_period=1.0) == Status.ok).all()


def test_no_line_takes_more_steps_than_it_may(waves):
    assert waves[1].steps.max() <= MOST_STEPS


def test_the_effort_table_names_the_scenario_that_took_most(waves):
    _, dataset, results = waves
    table = pd.read_csv(results / "tables" / "small_effort.csv").set_index(["method", "quantity"])
    steps = dataset.steps.sel({"method": "generalized_alpha"})
    row = table.loc[("generalized_alpha", "steps")]
    assert row["scenarios"] == np.isfinite(steps).sum()
    assert (row["median"], row["largest"]) == (float(steps.median()), float(steps.max()))
    worst = dict(part.split("=") for part in row["at"].split(", "))
    assert float(steps.sel({name: float(value) for name, value in worst.items()})) == row["largest"]
    # Explicit steps are never taken back.
    assert ("leapfrog", "rejected_steps") not in table.index


def test_a_method_that_solves_nothing_has_no_effort_to_tell(waves):
    dataset = waves[1]
    failed = dataset.assign(status=dataset.status.where(dataset.method != "rk4", Status.not_converged))
    assert "rk4" not in set(effort_table(failed)["method"])


def test_effort_is_no_output_with_an_error(tmp_path):
    run(tmp_path, {**WAVES, "reference": "generalized_alpha", "figures": {}})
    table = pd.read_csv(tmp_path / "results" / "tables" / "small_errors.csv")
    assert set(table["output"]) == {"max_top_tension"}


@pytest.mark.parametrize("name", ["config", "full"])
def test_every_scene_of_stability_bounds_its_work_by_steps_not_by_the_clock(name):
    scenes = [scene for scene in read_study(CONFIG / f"{name}.yaml").scenes if scene.name.startswith("stability")]
    assert len(scenes) == 7
    marched = [m.made_options for scene in scenes for m in scene.methods if m.solver.name == "wave_line"]
    assert len(marched) >= 6
    for options in marched:
        assert options.most_steps <= 20_000
        # A bound by the clock would make the fate of a scenario depend on the machine.
        assert options.most_seconds == 600.0


# ---- maps of fates ----

SPANS = {
    "title": "Spans",
    "design": {"grid": {"length_ratio": [1.2, 0.9, 1.1], "rise": ["0 m", "1 m", "5 m"]}},
    "fixed": {"span": "10 m", "weight_per_length": "2 N/m", "axial_stiffness": "1 kN"},
    "methods": {
        "rigid": {"solver": "catenary_exact", "ignores": ["axial_stiffness"]},
        "elastic": {"solver": "catenary_elastic"},
    },
    "outputs": ["sag"],
}
FATES = {"kind": "status_map", "x": "length_ratio", "y": "rise"}


def drawn(folder: Path, scene: dict[str, Any] = SPANS, **settings: Any) -> tuple[Any, xr.Dataset]:
    read, dataset = run(
        folder, {**scene, "figures": {"fates": {k: v for k, v in {**FATES, **settings}.items() if v is not None}}}
    )
    return draw_status_map(read, dataset, read.figures[0]), dataset


def cells(axes: Any) -> np.ndarray:
    """The statuses that a panel shows, (y, x)."""
    return axes.collections[0].get_array().reshape(axes.collections[0].get_coordinates().shape[0] - 1, -1)


def test_a_panel_for_each_method_shows_the_status_of_every_scenario_in_ascending_order(tmp_path):
    figure, dataset = drawn(tmp_path)
    assert [axes.get_title() for axes in figure.axes] == ["rigid", "elastic"]
    for axes, method in zip(figure.axes, ("rigid", "elastic"), strict=True):
        status = dataset.status.sel({"method": method}).sortby("length_ratio").transpose("rise", "length_ratio")
        np.testing.assert_array_equal(cells(axes), status)


def test_the_legend_names_the_statuses_that_occur_with_their_number_and_colour(tmp_path):
    figure, dataset = drawn(tmp_path)
    legend = figure.legends[0]
    counts = np.bincount(dataset.status.values.ravel(), minlength=2)
    assert [text.get_text() for text in legend.get_texts()] == [
        f"ok ({counts[0]} of 18): solved",
        f"infeasible ({counts[1]} of 18): no equilibrium exists for these parameters",
    ]
    colours = [to_hex(patch.get_facecolor()) for patch in legend.get_patches()]
    assert colours == [STATUS_COLOURS[Status.ok].lower(), STATUS_COLOURS[Status.infeasible].lower()]


def test_without_a_second_side_there_is_a_row_for_each_method(tmp_path):
    figure, dataset = drawn(tmp_path, {**SPANS, "design": {"grid": {"length_ratio": [0.9, 1.1, 1.2]}}}, y=None)
    (axes,) = figure.axes
    np.testing.assert_array_equal(cells(axes), dataset.status)
    assert [label.get_text() for label in axes.get_yticklabels()] == ["rigid", "elastic"]


def test_chosen_methods_at_a_chosen_point_are_shown(tmp_path):
    figure, dataset = drawn(tmp_path, y=None, point={"rise": "5 m"}, methods=["rigid"])
    np.testing.assert_array_equal(
        cells(figure.axes[0]), dataset.status.sel({"method": ["rigid"], "rise": 5.0}).sortby("length_ratio")
    )


def test_every_status_has_a_colour_of_its_own_lightness():
    assert set(STATUS_COLOURS) == set(Status)
    # Luminance by ITU-R BT.709, which is what is left of a colour on a grey printer.
    weights = (0.2126, 0.7152, 0.0722)
    grey = sorted(
        sum(w * int(colour[i : i + 2], 16) for w, i in zip(weights, (1, 3, 5), strict=True))
        for colour in STATUS_COLOURS.values()
    )
    assert np.diff(grey).min() > 40.0


def test_cells_meet_half_way_between_values_on_their_scale():
    np.testing.assert_allclose(cell_edges(np.array([1.0, 2.0, 4.0]), is_logarithmic=False), [0.5, 1.5, 3.0, 5.0])
    np.testing.assert_allclose(cell_edges(np.array([1.0, 100.0]), is_logarithmic=True), [0.1, 10.0, 1000.0])
    np.testing.assert_allclose(cell_edges(np.array([7.0]), is_logarithmic=False), [6.5, 7.5])


@pytest.mark.parametrize("kind", [{"kind": "status_map"}, {"kind": "map", "value": "exact.sag"}])
def test_a_logarithmic_side_with_a_zero_is_refused_in_one_line(tmp_path, kind):
    scene = {**SPANS, "methods": {"exact": SPANS["methods"]["elastic"]}}
    dataset = run(tmp_path, scene)[1]
    (tmp_path / "small.yaml").write_text(
        json.dumps({**scene, "figures": {"fates": {"x": "length_ratio", "y": "rise", "log": "y", **kind}}})
    )
    with pytest.raises(InputError, match=r"figures\.fates: a logarithmic side of a map needs values above 0, not 0$"):
        draw_figures(read_scene(tmp_path / "small.yaml"), dataset, tmp_path)
