"""Checks of a scene: their flags follow from the condition or the order of values alone, whole or in blocks."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from cablesim.config.check_file import Limit, Monotone, Value
from cablesim.config.scene import read_scene
from cablesim.database.checks import check_flags
from cablesim.database.query import query
from cablesim.database.reading import open_scene
from cablesim.status import Status, Verdict
from cablesim.steps import run_scene
from cablesim.study import Layout

PASSED, FAILED, UNKNOWN = (int(verdict) for verdict in Verdict)
WORDS = np.array([verdict.name for verdict in Verdict])
# Lines of the second length are too short, those of the third where there is a rise.
SPANS = {
    "title": "Spans",
    "design": {"grid": {"rise": ["0 m", "4 m"], "length_ratio": [1.3, 0.9, 1.05, 1.2]}},
    "fixed": {"span": "10 m", "weight_per_length": "2 N/m"},
    "methods": {"exact": {"solver": "catenary_exact"}, "level": {"solver": "catenary_parabolic", "ignores": ["rise"]}},
    "outputs": ["sag", "max_tension", "profile"],
}
CHECKS = {
    "strong": {"limit": "max_tension < breaking_strength / safety", "with": {"breaking_strength": "60 N", "safety": 4}},
    "shallow": "sag < 40 % * span",
    "near": {"limit": "abs(sag / exact.sag - 1) < wrong_by", "with": {"wrong_by": "5 %"}},
    "sag_grows": {"monotone": "sag", "along": "length_ratio", "sense": "increasing"},
    "sag_falls": {"monotone": "sag", "along": "length_ratio", "sense": "decreasing"},
}


def run(folder: Path, **parts: Any) -> Layout:
    path, layout = folder / "small.yaml", Layout(folder / "results")
    path.write_text(json.dumps(SPANS | {"checks": CHECKS} | parts))
    run_scene(read_scene(path), layout, lambda step, done, total: None)
    return layout


@pytest.fixture(scope="module")
def layout(tmp_path_factory: pytest.TempPathFactory) -> Layout:
    return run(tmp_path_factory.mktemp("checks"))


@pytest.fixture
def dataset(layout: Layout) -> xr.Dataset:
    return open_scene(layout.root, "small")


def drawn(seed: int) -> xr.Dataset:
    """Values of two methods on a grid, whole numbers so that some are equal; a third of them unsolved."""
    draw = np.random.default_rng(seed)
    dims, shape = ("method", "span", "length_ratio", "rise"), (2, 3, 7, 2)
    status = draw.choice([Status.ok, Status.ok, Status.infeasible], shape).astype(np.int8)
    sag = np.where(status == Status.ok, draw.integers(0, 5, shape).astype(float), np.nan)
    flags = {"flag_meanings": " ".join(word.name for word in Status)}
    ratios = draw.permutation(np.linspace(1.1, 1.7, 7))
    coords = {"method": ["exact", "level"], "span": [1.0, 2.0, 3.0], "length_ratio": ratios, "rise": [0.0, 1.0]}
    return xr.Dataset({"status": (dims, status, flags), "sag": (dims, sag, {"units": "m"})}, coords)


def judged_one_by_one(values: np.ndarray, solved: np.ndarray, ratios: np.ndarray, sign: float) -> list[int]:
    """The flags of one row of scenarios."""
    flags, last = [UNKNOWN] * len(values), None
    for i in sorted(range(len(values)), key=lambda i: ratios[i]):
        if solved[i] and np.isfinite(values[i]):
            wrong = last is not None and sign * (values[i] - last) < -1e-9 * abs(values[i])
            flags[i], last = FAILED if wrong else PASSED, values[i]
    return flags


def test_a_limit_says_what_its_condition_says(dataset):
    solved = dataset.status.values == Status.ok
    strong = np.where(dataset.max_tension.values < 60.0 / 4.0, PASSED, FAILED)
    shallow = np.where(dataset.sag.values < 0.4 * 10.0, PASSED, FAILED)
    np.testing.assert_array_equal(dataset.strong, np.where(solved, strong, UNKNOWN))
    np.testing.assert_array_equal(dataset.shallow, np.where(solved, shallow, UNKNOWN))
    assert {PASSED, FAILED, UNKNOWN} == set(dataset.strong.values.ravel().tolist())


def test_a_number_of_another_method_that_is_missing_is_unknown(dataset):
    exact, level = (dataset.status.sel({"method": name}).values == Status.ok for name in ("exact", "level"))
    assert (level & ~exact).any()
    near = dataset.near.sel({"method": "level"}).values
    np.testing.assert_array_equal(near == UNKNOWN, ~(level & exact))


def test_an_unsolved_scenario_is_unknown_to_every_check(dataset):
    unsolved = dataset.status.values != Status.ok
    assert unsolved.any()
    for name in CHECKS:
        assert (dataset[name].values[unsolved] == UNKNOWN).all()


def test_a_number_that_is_not_finite_is_unknown_on_either_side_of_an_or():
    dataset = drawn(1)
    flags = check_flags(Limit("odd", "sag / 0 > 1 or sag >= 0", {}), dataset)
    assert (flags == UNKNOWN).all()
    flags = check_flags(Limit("even", "method == exact or sag >= 0", {}), dataset)
    np.testing.assert_array_equal(flags, np.where(dataset.status == Status.ok, PASSED, UNKNOWN))


def test_sag_grows_with_length_in_whatever_order_lengths_are_written(dataset):
    solved = dataset.status == Status.ok
    np.testing.assert_array_equal(dataset.sag_grows, np.where(solved, PASSED, UNKNOWN))
    shortest = dataset.sag_falls.where(solved).sortby("length_ratio")
    assert (shortest == PASSED).sum() == solved.any("length_ratio").sum()


@pytest.mark.parametrize("sense", ["increasing", "decreasing"])
@pytest.mark.parametrize("seed", range(10))
def test_each_value_is_compared_with_the_last_solved_one_before_it(seed, sense):
    dataset = drawn(seed)
    flags = check_flags(Monotone("look", "sag", "length_ratio", sense), dataset)
    assert flags.dtype == np.int8
    assert flags.dims == dataset.status.dims
    sign = 1.0 if sense == "increasing" else -1.0
    for place in np.ndindex(2, 3, 2):
        here = dict(zip(("method", "span", "rise"), place, strict=True))
        row, solved = dataset.sag.isel(here).values, dataset.status.isel(here).values == Status.ok
        expected = judged_one_by_one(row, solved, dataset.length_ratio.values, sign)
        assert flags.isel(here).values.tolist() == expected


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    "check",
    [
        Monotone("look", "sag", "length_ratio", "increasing"),
        Monotone("look", "sag - exact.sag", "length_ratio", "decreasing"),
        Limit("look", "sag < most * rise + length_ratio", {"most": Value(2.0, "1", "2")}),
        Limit("look", "sag >= exact.sag and method != exact", {}),
    ],
    ids=lambda check: check.words,
)
def test_blocks_have_the_flags_of_the_whole(seed, check):
    dataset = drawn(seed)
    whole = check_flags(check, dataset)
    for dim, parts in {"span": [[0], [1, 2]], "rise": [[0], [1]], "method": [[0], [1]]}.items():
        if dim == "method" and "exact." in check.words:
            continue
        blocks = [check_flags(check, dataset.isel({dim: part})) for part in parts]
        xr.testing.assert_identical(xr.concat(blocks, dim), whole)


@pytest.mark.parametrize(("step", "flag"), [(0.0, PASSED), (-1e-12, PASSED), (-1e-6, FAILED), (1e-6, PASSED)])
def test_equal_goes_the_right_way(step, flag):
    dataset = drawn(0).isel(method=[0], span=[0], rise=[0], length_ratio=[0, 1]).sortby("length_ratio")
    dataset.status[:] = Status.ok
    dataset.sag[:] = 3.0 + np.array([0.0, step]).reshape(dataset.sag.shape)
    flags = check_flags(Monotone("look", "sag", "length_ratio", "increasing"), dataset)
    assert flags.values.ravel().tolist() == [PASSED, flag]


def test_flags_say_what_they_mean(dataset):
    assert dataset.strong.dtype == np.int8
    assert dataset.strong.attrs["flag_meanings"] == "passed failed unknown"
    assert dataset.strong.attrs["flag_values"].tolist() == [0, 1, 2]
    assert dataset.strong.attrs["long_name"] == (
        "max_tension < breaking_strength / safety, with breaking_strength = 60 N, safety = 4"
    )
    assert dataset.sag_grows.attrs["long_name"] == "sag is increasing along length_ratio"


def test_the_table_counts_each_check_by_method_and_names_the_first_that_failed(layout, dataset):
    table = pd.read_csv(layout.tables / "small_checks.csv", keep_default_na=False)
    assert table["check"].tolist() == [name for name in CHECKS for _ in range(2)]
    for row in table.to_dict("records"):
        flags = dataset[row["check"]].sel({"method": row["method"]}).values
        assert [row[word] for word in WORDS] == np.bincount(flags.ravel(), minlength=3).tolist()
        assert (row["first failed at"] == "") == (row["failed"] == 0)
    assert dataset.strong.sel({"method": "exact", "rise": 0.0}).values.tolist()[:2] == [FAILED, UNKNOWN]
    assert table["first failed at"][0] == "rise=0, length_ratio=1.3"


def test_the_tables_by_scenario_have_flags_as_words_beside_the_status(layout, dataset):
    for name in ("values", "tensions"):
        table = pd.read_csv(layout.tables / f"small_{name}.csv", keep_default_na=False)
        assert table.columns.tolist()[-6:] == ["status", *CHECKS]
        for check in CHECKS:
            np.testing.assert_array_equal(table[check], WORDS[dataset[check].values.ravel()])


def test_a_check_is_asked_for_by_its_words(dataset):
    found = query(dataset, "strong == failed and exact.sag_falls == failed", ("strong", "sag"))
    assert len(found) > 0
    assert set(found["strong"]) == {"failed"}


def test_figures_and_printed_tables_choose_by_a_check(tmp_path):
    figure = {
        "kind": "curves",
        "x": "length_ratio",
        "y": "exact.sag",
        "each": "rise",
        "where": "exact.strong == passed",
    }
    page = {"pages": ["rise"], "rows": "length_ratio", "columns": ["exact.sag"], "where": "exact.strong == failed"}
    layout = run(tmp_path, figures={"look": figure}, tables={"look": page})
    assert (layout.figures / "small_look.svg").exists()
    dataset = open_scene(layout.root, "small")
    failed = int((dataset.strong.sel({"method": "exact"}) == FAILED).sum())
    assert len(pd.read_csv(layout.tables / "small_look.csv")) == failed > 0


def test_parts_of_vectors_and_lists_are_judged(tmp_path):
    scene = {
        "title": "Chain and wire",
        "design": {"grid": {"section_length_2": [5, 20, 50]}},
        "fixed": {"section_length_1": 400, "section_weight": [80, 600], "horizontal_tension": 1e5},
        "methods": {"exact": {"solver": "composite_line"}},
        "outputs": ["joint_tension", "horizontal_distance"],
        "checks": {
            "pulled": "joint_tension_1 > horizontal_tension",
            "longer": {"monotone": "horizontal_distance", "along": "section_length_2", "sense": "increasing"},
        },
    }
    dataset = open_scene(run(tmp_path, **scene).root, "small")
    assert (dataset.pulled == PASSED).all()
    assert (dataset.longer == PASSED).all()
