"""Shards: every scenario once, and only what is new is computed when a study grows."""

import math
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from cablesim import shards
from cablesim.config.scene import read_scene
from cablesim.database.reading import read_dataset
from cablesim.design import Axis
from cablesim.plan import plan_scene, read_plan
from cablesim.shards import Recipe, plan_methods
from cablesim.steps import run_scene
from cablesim.study import Layout

SCENE = """
title: A grid that grows
design:
  grid:
    span: {spans}
    length_ratio: {ratios}
fixed: {{weight_per_length: {weight}}}
methods: {methods}
outputs: {outputs}
"""
EXACT = "{exact: {solver: catenary_exact}}"


def scene(
    folder: Path, spans="[10, 20, 30]", ratios="[1.1, 1.2]", weight=5, methods=EXACT, outputs="[sag, max_tension]"
):
    path = folder / "growing.yaml"
    path.write_text(SCENE.format(spans=spans, ratios=ratios, weight=weight, methods=methods, outputs=outputs))
    return read_scene(path)


def solved(plan) -> dict[str, int]:
    """Scenarios of each shard of a plan."""
    return {digest: math.prod(recipe.shape) for digest, recipe in plan.recipes.items()}


def new_scenarios(before, after) -> int:
    """Scenarios in shards that the earlier plan does not have."""
    return sum(size for digest, size in solved(after).items() if digest not in solved(before))


def covered(plan, method: int, shape: tuple[int, ...]) -> np.ndarray:
    """How often each scenario of a method is placed."""
    count = np.zeros(shape, dtype=int)
    for placement in plan.methods[method].placements:
        count[np.ix_(*placement.target)] += 1
    return count


@pytest.mark.parametrize(
    ("change", "new"),
    [
        ({"spans": "[10, 20, 30, 40]"}, 2),
        ({"spans": "[5, 10, 20, 30]"}, 2),
        ({"spans": "[10, 20, 25, 30]"}, 2),
        ({"spans": "[30, 25, 10, 20]"}, 2),
        ({"ratios": "[1.05, 1.1, 1.2]"}, 3),
        ({"spans": "[10, 20, 30, 40]", "ratios": "[1.1, 1.15, 1.2]"}, 6),
        ({"methods": "{exact: {solver: catenary_exact}, parabolic: {solver: catenary_parabolic}}"}, 6),
        ({"methods": "{renamed: {solver: catenary_exact}}"}, 0),
        ({"outputs": "[sag]"}, 0),
        ({"spans": "[10, 30]"}, 0),
        ({"weight": 6}, 6),
        ({"outputs": "[sag, drop, max_tension]"}, 6),
    ],
)
def test_a_grown_study_computes_only_what_is_new(tmp_path, change, new):
    before = plan_scene(scene(tmp_path), tmp_path / "plans")
    grown = scene(tmp_path, **change)
    after = plan_scene(grown, tmp_path / "plans")
    assert new_scenarios(before, after) == new
    for number in range(len(grown.methods)):
        assert (covered(after, number, grown.design.shape) >= 1).all()


def test_an_axis_made_of_a_fixed_value_takes_over_what_was_solved_for_it(tmp_path):
    before = plan_scene(scene(tmp_path), tmp_path / "plans")
    path = tmp_path / "growing.yaml"
    path.write_text(
        path.read_text().replace("  grid:", "  grid:\n    weight_per_length: [4, 5]").replace("fixed:", "# fixed:")
    )
    after = plan_scene(read_scene(path), tmp_path / "plans")
    assert new_scenarios(before, after) == 6
    assert solved(after).items() >= solved(before).items()


def test_going_back_to_an_earlier_scene_needs_nothing(tmp_path):
    first = plan_scene(scene(tmp_path), tmp_path / "plans")
    plan_scene(scene(tmp_path, spans="[10, 20, 30, 40]"), tmp_path / "plans")
    again = plan_scene(scene(tmp_path), tmp_path / "plans")
    assert solved(again) == solved(first)


def test_without_history_every_scenario_is_in_one_shard_only(tmp_path, monkeypatch):
    monkeypatch.setattr(shards, "MOST_SCENARIOS", 7)
    grid = scene(tmp_path, spans="{start: 1, stop: 9, num: 9}", ratios="{start: 1.1, stop: 1.5, num: 5}")
    plans = plan_methods(grid, ())
    count = np.zeros(grid.design.shape, dtype=int)
    for placement in plans[0].placements:
        assert math.prod(placement.recipe.shape) <= 7
        count[np.ix_(*placement.target)] += 1
    assert (count == 1).all()


@pytest.mark.parametrize("seed", range(20))
def test_any_set_of_scenarios_is_covered_exactly_by_blocks(seed):
    draw = np.random.default_rng(seed)
    shape = tuple(draw.integers(1, 7, size=draw.integers(1, 4)))
    mask = draw.random(shape) < draw.random()
    count = np.zeros(shape, dtype=int)
    limit = int(draw.integers(1, 20))
    for block in shards._blocks(mask, limit):
        assert math.prod(points.size for points in block) <= limit
        count[np.ix_(*block)] += 1
    np.testing.assert_array_equal(count, mask.astype(int))


def test_a_plan_reads_back_as_it_was_written(tmp_path):
    grown = scene(tmp_path)
    plan_scene(grown, tmp_path / "plans")
    plan = plan_scene(scene(tmp_path, spans="[10, 15, 20, 30]"), tmp_path / "plans")
    path = next((tmp_path / "plans").glob(f"*.{plan.digest}.npz"))
    again = read_plan(path)
    assert list(again.recipes) == list(plan.recipes)
    # A recipe's digest covers every value in it, so recipes that were read wrongly would name other shards.
    assert all(digest == recipe.digest for digest, recipe in again.recipes.items())
    for ours, theirs in zip(plan.methods[0].placements, again.methods[0].placements, strict=True):
        for one, other in zip(ours.target + ours.source, theirs.target + theirs.source, strict=True):
            np.testing.assert_array_equal(one, other)


def test_editing_a_solver_changes_its_shards_and_no_others(monkeypatch, tmp_path):
    both = "{exact: {solver: catenary_exact}, parabolic: {solver: catenary_parabolic}}"
    before = plan_scene(scene(tmp_path, methods=both), tmp_path / "plans")
    real = shards.source_digest
    edited = lambda name: "edited" if name == "catenary_parabolic" else real(name)  # noqa: E731
    monkeypatch.setattr("cablesim.shards.source_digest", edited)
    monkeypatch.setattr("cablesim.plan.source_digest", edited)
    after = plan_scene(scene(tmp_path, methods=both), tmp_path / "plans")
    assert new_scenarios(before, after) == 6
    assert {r.solver for d, r in after.recipes.items() if d not in solved(before)} == {"catenary_parabolic"}


def test_a_method_that_ignores_every_axis_is_solved_once_and_stands_all_along_them(tmp_path):
    path = tmp_path / "ignoring.yaml"
    path.write_text(
        "title: A rigid line beside elastic ones\n"
        "design: {grid: {axial_stiffness: [1e5, 1e6, 1e9]}}\n"
        "fixed: {span: 10, line_length: 11, weight_per_length: 5}\n"
        "methods:\n"
        "  elastic: {solver: catenary_elastic}\n"
        "  rigid: {solver: catenary_exact, ignores: [axial_stiffness]}\n"
        "outputs: [sag, profile]\n"
    )
    layout = Layout(tmp_path / "results")
    plan, _ = run_scene(read_scene(path), layout, lambda step, done, total: None)
    assert sorted(solved(plan).values()) == [1, 3]
    sag = read_dataset(layout.dataset("ignoring")).sag
    rigid, elastic = sag.sel({"method": "rigid"}).values, sag.sel({"method": "elastic"}).values
    assert len(set(rigid.tolist())) == 1
    # The stiffest line is as good as rigid: its strain is 3e-8.
    assert elastic[-1] == pytest.approx(rigid[-1], rel=1e-6)
    assert len(set(elastic.tolist())) == 3


GROWING = [
    {"span": [10, 20, 30], "length_ratio": [1.1, 1.2]},
    {"span": [10, 20, 25, 30], "length_ratio": [1.1, 1.2]},
    {"length_ratio": [1.3, 1.2, 1.05, 1.1], "span": [30, 10, 25]},
    {"rise": [0, 2], "length_ratio": [1.1, 1.2], "span": [20, 30, 40]},
    {"span": [40], "rise": [2, 0], "length_ratio": [0.9, 1.1, 1.2]},
    {"span": [10, 20, 30], "length_ratio": [1.1, 1.2]},
]


GROWN = """
title: A grid that grows
design:
  grid:
{axes}
fixed: {{weight_per_length: 5, axial_stiffness: 1e5}}
methods:
  exact: {{solver: catenary_exact, ignores: [axial_stiffness]}}
  elastic: {{solver: catenary_elastic}}
outputs: [sag, tension_A, profile]
"""


def test_a_dataset_that_grew_is_the_same_as_one_made_afresh(tmp_path):
    path = tmp_path / "grown.yaml"
    for number, grid in enumerate(GROWING):
        axes = "\n".join(f"    {name}: {values}" for name, values in grid.items())
        path.write_text(GROWN.format(axes=axes))
        datasets = [collected(path, tmp_path / folder) for folder in ("grown", f"afresh {number}")]
        xr.testing.assert_identical(*datasets)


WIRE = "{section_length: [400], section_weight: [80]}"
CHAIN = "{section_length: [400, 50], section_weight: [80, 600]}"
SAME_WIRE = "{section_length: [400, 50], section_weight: [80, 80]}"
THREE = "{section_length: [200, 50, 200], section_weight: [80, 600, 80]}"
GROWING_LISTS = [
    [CHAIN],
    [WIRE, CHAIN],
    [WIRE, THREE, CHAIN],
    [CHAIN, WIRE],
    [WIRE],
    [SAME_WIRE, WIRE, CHAIN, THREE],
]


def test_a_dataset_of_lists_that_grew_is_the_same_as_one_made_afresh(tmp_path):
    path = tmp_path / "grown.yaml"
    for number, cases in enumerate(GROWING_LISTS):
        path.write_text(
            f"title: Lines that grow\ndesign: {{cases: [{', '.join(cases)}]}}\nfixed: {{horizontal_tension: 1e5}}\n"
            "methods: {exact: {solver: composite_line}}\noutputs: [tension_B, joint_tension, joint_position, profile]\n"
        )
        datasets = [collected(path, tmp_path / folder) for folder in ("grown", f"afresh {number}")]
        xr.testing.assert_identical(*datasets)
    found = {recipe.digest: recipe.shape for plan in (tmp_path / "grown").glob("**/*.npz") for recipe in recipes(plan)}
    # The first chain, the wire, the line of three sections and the line of wire in two sections, each once.
    assert list(found.values()) == [(1,)] * 4


def recipes(path: Path) -> list[Recipe]:
    return list(read_plan(path).recipes.values())


def test_points_of_an_axis_are_told_apart_by_value_whatever_the_bits_of_zero_and_nan():
    other_nan = np.array([0xFFF8000000000001], dtype=np.uint64).view(float)[0]
    axis = Axis("scenario", {"rise": np.array([0.0, -0.0, 1.0, np.nan, -np.nan, other_nan])})
    assert np.unique(axis.key).size == 3
    with_nan = axis.padded(["section_length_2"])
    assert np.isnan(with_nan.columns["section_length_2"]).all()
    assert np.unique(with_nan.key).size == 3


def collected(path: Path, folder: Path) -> xr.Dataset:
    """The dataset of a scene, without what was measured."""
    layout = Layout(folder)
    run_scene(read_scene(path), layout, lambda step, done, total: None)
    with xr.open_dataset(layout.dataset(path.stem)) as dataset:
        return dataset.load()


TWO = "{exact: {solver: catenary_exact}, series: {solver: catenary_series}}"


def test_small_shards_share_a_job_and_what_is_worth_one_has_its_own(tmp_path, monkeypatch):
    made = plan_scene(scene(tmp_path, methods=TWO), tmp_path / "plans")
    (together,) = made.bundles.values()
    assert together == tuple(made.recipes)
    room = sum(recipe.seconds for recipe in made.recipes.values())
    monkeypatch.setattr("cablesim.plan.SECONDS_PER_SHARD", 0.9 * room)
    alone = made.bundles
    assert sorted(alone.values()) == sorted((shard,) for shard in made.recipes)
    assert made.bundles == alone
