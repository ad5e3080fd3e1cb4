"""Printed tables and measured orders, on scenes small enough to say what must be in them."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from cablesim.config.scene import read_scene
from cablesim.database.reading import open_scene
from cablesim.report.orders import convergences
from cablesim.steps import run_scene
from cablesim.study import Layout

SPANS = {
    "title": "Spans",
    "design": {"grid": {"rise": ["0 m", "1 m"], "length_ratio": [0.9, 1.1, 1.2]}},
    "fixed": {"span": "10 m", "weight_per_length": "2 N/m"},
    "methods": {"exact": {"solver": "catenary_exact"}},
    "outputs": ["sag", "max_tension"],
}
TOWED = {
    "title": "A towed line",
    "design": {"grid": {"stream_speed": [0.5, 1.0]}},
    "fixed": {
        "force_A": [-50, 0, 250],
        "line_length": 50,
        "weight_per_length": 2,
        "diameter": 0.01,
        "normal_drag_coefficient": 1.2,
        "tangential_drag_coefficient": 0.03,
        "fluid_density": 1000,
    },
    "reference": "exact",
    "outputs": ["position_B"],
}


def run(folder: Path, scene: dict[str, Any]) -> Layout:
    path, layout = folder / "small.yaml", Layout(folder / "results")
    path.write_text(json.dumps(scene))
    run_scene(read_scene(path), layout, lambda step, done, total: None)
    return layout


def printed(folder: Path, scene: dict[str, Any] = SPANS, **settings: Any) -> pd.DataFrame:
    layout = run(folder, {**scene, "tables": {"page": settings}})
    return pd.read_csv(layout.tables / "small_page.csv", dtype=str)


def test_a_page_for_each_rise_and_no_line_without_an_answer(tmp_path):
    table = printed(tmp_path, pages=["rise"], rows="length_ratio", columns=["sag"], digits=3)
    assert table.columns.tolist() == ["rise [m]", "length_ratio", "sag [m]"]
    assert table["length_ratio"].tolist() == ["1.1", "1.2"] * 2
    text = (tmp_path / "results" / "tables" / "small_page.md").read_text()
    assert [line for line in text.splitlines() if line.startswith("#")] == ["# Spans", "## rise 0 m", "## rise 1 m"]


def test_digits_are_significant_and_units_are_those_of_print(tmp_path):
    table = printed(
        tmp_path,
        rows="length_ratio",
        columns={"pull": "max_tension", "double": "2 * max_tension"},
        point={"rise": "0 m"},
        units={"pull": "kN"},
        digits=4,
    )
    exact = open_scene(tmp_path / "results", "small").max_tension.values[0, 0, 1:]
    assert table["pull [kN]"].tolist() == [f"{value / 1000:#.4g}" for value in exact]
    assert table["double"].tolist() == [f"{2 * value:#.4g}" for value in exact]


def test_columns_run_across_a_parameter_and_what_has_no_answer_is_a_dash(tmp_path):
    table = printed(
        tmp_path, rows="rise", across="length_ratio", columns=["sag"], where="rise > 0 or length_ratio > 1.15"
    )
    assert table.columns.tolist() == ["rise [m]", "sag [m], length ratio 1.1", "sag [m], length ratio 1.2"]
    assert table.iloc[0, 1] == "-"
    assert float(table.iloc[1, 1]) > 0.0


def test_a_line_for_each_method_in_the_order_of_the_scene(tmp_path):
    methods = {"exact": {"solver": "catenary_exact"}, "a_parabola": {"solver": "catenary_parabolic"}}
    scene = {**SPANS, "design": {"grid": {"length_ratio": [1.1]}}, "methods": methods}
    table = printed(tmp_path, scene, rows="method", columns=["sag"])
    assert table["method"].tolist() == ["exact", "a_parabola"]


def test_printed_cases_are_named_by_their_parameters(tmp_path):
    cases = [{"rise": 1, "length_ratio": 1.2}, {"rise": 0, "length_ratio": 1.1}]
    table = printed(
        tmp_path, {**SPANS, "design": {"cases": cases}}, pages=["rise"], rows="length_ratio", columns=["sag"]
    )
    assert table["rise [m]"].tolist() == ["1", "0"]


def series(segments: tuple[int, ...], **options: Any) -> dict[str, Any]:
    """Methods of the segment method, by their number of segments."""
    return {f"n{n}": {"solver": "segment_line", "options": {"segments": n, **options}} for n in segments}


def test_the_order_is_positive_for_more_segments_and_for_smaller_tolerances(tmp_path):
    methods = {
        "exact": {"solver": "pode_line"},
        **series((32, 64, 128)),
        **{f"tolerance_{k}": {"solver": "stream_line", "options": {"rtol": 10.0**-k}} for k in (4, 6, 8)},
    }
    layout = run(tmp_path, {**TOWED, "methods": methods})
    scene, dataset = read_scene(tmp_path / "small.yaml"), open_scene(layout.root, "small")
    found = convergences(scene, dataset, "position_B")
    assert set(found) == {"segment_line", "stream_line"}
    assert found["segment_line"].order == pytest.approx(1.0, abs=0.05)
    assert found["stream_line"].series.values == (1e-8, 1e-6, 1e-4)
    # The error follows the tolerance, if not as a clean power.
    assert 0.0 < found["stream_line"].order < 2.0


def test_a_series_has_three_methods_that_differ_in_one_option_alone(tmp_path):
    coarse = {f"midpoint_{name}": method for name, method in series((8, 16), variant="midpoint").items()}
    methods = {"exact": {"solver": "pode_line"}, **series((8, 16, 32)), **coarse}
    layout = run(tmp_path, {**TOWED, "methods": methods})
    orders = pd.read_csv(layout.tables / "small_orders.csv")
    assert set(orders["series"]) == {"segment_line"}
    assert orders["value"].tolist() == [8, 16, 32]
    assert np.isnan(orders["order"].iloc[0])


def test_figures_in_space_and_of_convergence_are_drawn(tmp_path):
    methods = {"exact": {"solver": "stream_line"}, **series((8, 16, 32))}
    figures = {
        "space": {"kind": "spatial", "each": {"stream_speed": [0.5, 1.0]}, "methods": ["exact"]},
        "error": {"kind": "convergence", "output": "position_B", "against": "run_time"},
        "plan": {"kind": "profiles", "view": "xy", "at": {"stream_speed": [0.5, 1.0]}},
    }
    layout = run(tmp_path, {**TOWED, "methods": methods, "outputs": ["position_B", "profile"], "figures": figures})
    assert all((layout.figures / f"small_{name}.png").stat().st_size > 10_000 for name in figures)


def test_a_view_in_space_is_drawn_though_no_scenario_has_an_answer(tmp_path):
    figures = {"space": {"kind": "spatial", "point": {"rise": 0, "length_ratio": 0.9}}}
    layout = run(tmp_path, {**SPANS, "outputs": ["profile"], "figures": figures})
    assert (layout.figures / "small_space.png").stat().st_size > 1000


def test_a_convergence_is_drawn_though_no_scenario_has_an_answer(tmp_path):
    # A line without weight in still water has no shape at all.
    fixed = {**TOWED["fixed"], "weight_per_length": 0}
    del fixed["force_A"]
    scene = {
        **TOWED,
        "design": {"grid": {"stream_speed": [0.0]}},
        "fixed": {**fixed, "position_B": [10, 0, 5]},
        "methods": {"exact": {"solver": "pode_line"}, **series((8, 16, 32))},
        "outputs": ["force_B"],
        "figures": {"error": {"kind": "convergence", "output": "force_B", "against": "segments"}},
    }
    layout = run(tmp_path, scene)
    assert (open_scene(layout.root, "small").status.values != 0).all()
    assert (layout.figures / "small_error.png").stat().st_size > 1000
