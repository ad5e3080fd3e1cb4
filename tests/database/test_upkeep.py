"""Checking a folder of results, growing it, taking stock of what is left over, and looking at it half done."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from cablesim import verify as verifying
from cablesim.cli import main
from cablesim.config.scene import read_scene
from cablesim.database.reading import read_dataset
from cablesim.files import discard, enter_in_ledger
from cablesim.held import held
from cablesim.plan import read_plan
from cablesim.status import Status
from cablesim.steps import run_scene, sample, solve
from cablesim.study import Layout
from cablesim.verify import verify
from tests.cli.helpers import tree

QUIET = {"progress": lambda step, done, total: None}


def shards(results: Path, scene: str) -> list[Path]:
    return sorted((results / "shards" / scene).glob("*.nc"))


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


# ---- verify ----


def test_what_was_written_is_found_as_it_was_written(stored, capsys):
    before = tree(stored)
    verdicts = {one.scene: one for one in verify(Layout(stored), sample=100, seed=3, tolerance=0.0)}
    assert {scene: one.recomputed for scene, one in verdicts.items()} == {"angles": 6, "inclined": 4, "spans": 24}
    assert all(not one.differing and not one.faults and one.largest == 0.0 for one in verdicts.values())
    assert main(["verify", str(stored), "--sample", "2"]) == 0
    assert "spans" in capsys.readouterr().out
    assert tree(stored) == before


def test_a_wrong_number_under_a_right_digest_is_found_by_computing_it_again(copy, capsys):
    with netCDF4.Dataset(copy / "spans.nc", "a") as file:
        file["sag"][0, 1, 2] *= 1.001
    enter_in_ledger(copy / "spans.nc")
    (one,) = (one for one in verify(Layout(copy), 24, 1, 1e-9) if one.scene == "spans")
    assert one.differing == 1
    assert one.largest == pytest.approx(0.001 / 1.001, rel=1e-6)
    assert main(["verify", str(copy), "--sample", "24"]) == 1


def test_a_wrong_status_is_found(copy):
    with netCDF4.Dataset(copy / "inclined.nc", "a") as file:
        file["status"][0, 3] = int(Status.not_converged)
    enter_in_ledger(copy / "inclined.nc")
    (one,) = (one for one in verify(Layout(copy), 4, 1, 1e-9) if one.scene == "inclined")
    assert one.differing == 1


def test_damaged_files_are_named_and_it_is_the_machines_fault(copy, capsys):
    damaged, missing = shards(copy, "spans")
    damaged.write_bytes(damaged.read_bytes()[:-1])
    discard(missing)
    assert main(["verify", str(copy)]) == 3
    told = capsys.readouterr()
    assert f"{damaged}: damaged" in told.err
    assert f"{missing}: missing" in told.err
    assert "2 files are not what was written: run the study again" in told.err


def test_what_has_changed_since_is_told(copy, monkeypatch):
    monkeypatch.setattr(verifying, "source_digest", lambda solver: "changed")
    next((copy / "plans").glob("inclined.*")).unlink()
    notes = {one.scene: one.notes for one in verify(Layout(copy), 5, 1, 0.0)}
    assert "the code of catenary_parabolic has changed since" in notes["spans"]
    assert "nothing computed again" in notes["inclined"][0]


# ---- growing ----

GROWTH = [
    ("[10, 20, 40]", "[10, 20, 30, 40]", 8),
    ("[0.9, 1.1, 1.2, 1.3]", "[0.9, 1.1, 1.15, 1.2, 1.3]", 6),
    ("methods:", "methods:\n  series: {solver: catenary_series, options: {nodes: 5}}", 12),
    ("grid:", "grid:\n    weight_per_length: [5 N/m, 6 N/m]", 24),
    ("outputs: [sag, max_tension, profile]", "outputs: [sag]", 0),
    ("title: Spans of three lengths", "title: Another title", 0),
]


@pytest.mark.parametrize(("old", "new", "added"), GROWTH)
def test_a_study_that_grows_computes_what_is_added_and_leaves_the_rest_as_it_is(copy, old, new, added, capsys):
    scene = copy.parent / "spans.yaml"
    before = tree(copy / "shards")
    edit(scene, old, new)
    if "weight_per_length:" in new:
        edit(scene, "fixed: {weight_per_length: 5 N/m}\n", "")
    main(["run", str(scene), "--out", str(copy)])
    assert f"{added} scenarios computed" in capsys.readouterr().err
    assert tree(copy / "shards").items() >= before.items()


def test_a_new_axis_that_holds_the_default_takes_over_what_was_solved(copy, tmp_path, capsys):
    scene = tmp_path / "level.yaml"
    scene.write_text(
        "title: Level\ndesign: {grid: {span: [10, 20]}}\nfixed: {weight_per_length: 5, line_length: 30}\n"
        "methods: {exact: {solver: catenary_exact}}\noutputs: [sag]\n"
    )
    main(["run", str(scene), "--out", str(tmp_path / "results")])
    edit(scene, "{span: [10, 20]}", "{span: [10, 20], rise: [0, 2, 4]}")
    main(["run", str(scene), "--out", str(tmp_path / "results")])
    assert "4 scenarios computed, 2 were there" in capsys.readouterr().err


# ---- half done ----


def test_what_is_computed_so_far_can_be_used(tmp_path, stored, monkeypatch, capsys):
    scene = tmp_path / "spans.yaml"
    shutil.copy(stored.parent / "spans.yaml", scene)
    layout = Layout(tmp_path / "results")
    plan = sample(read_scene(scene), layout)
    exact = next(digest for digest, recipe in plan.recipes.items() if recipe.solver == "catenary_exact")
    solve(layout.plan(plan), (exact,), layout.shards("spans"))
    assert main(["collect", str(scene), "--out", str(layout.root)]) == 1
    assert "1 shards are not there yet" in capsys.readouterr().err
    half, whole = read_dataset(layout.dataset("spans")), read_dataset(stored / "spans.nc")
    np.testing.assert_array_equal(half.sag.sel({"method": "exact"}), whole.sag.sel({"method": "exact"}))
    assert (half.status.sel({"method": "parabolic"}) == Status.not_run).all()
    assert half.sag.sel({"method": "parabolic"}).isnull().all()
    run_scene(read_scene(scene), layout, **QUIET)
    np.testing.assert_array_equal(read_dataset(layout.dataset("spans")).status, whole.status)


# ---- clean ----


def grown_and_shrunk(copy: Path) -> Path:
    """A scene that had a span more for a while."""
    scene = copy.parent / "spans.yaml"
    edit(scene, "[10, 20, 40]", "[10, 20, 40, 80]")
    main(["run", str(scene), "--out", str(copy)])
    edit(scene, "[10, 20, 40, 80]", "[10, 20, 40]")
    main(["run", str(scene), "--out", str(copy)])
    return scene


def test_what_earlier_scenes_have_left_is_listed_and_removed_when_asked(copy, capsys):
    needed = tree(copy / "shards")
    scene = grown_and_shrunk(copy)
    before = tree(copy)
    capsys.readouterr()
    assert main(["clean", str(scene), "--out", str(copy)]) == 0
    told = capsys.readouterr()
    assert "superseded shard" in told.out
    assert "3 files may be removed with --remove" in told.out
    assert "left alone: angles, inclined" in told.err
    assert tree(copy) == before
    assert main(["clean", str(scene), "--out", str(copy), "--remove"]) == 0
    assert tree(copy / "shards") == needed
    _, computed = run_scene(read_scene(scene), Layout(copy), **QUIET)
    assert computed == 0
    assert main(["clean", str(scene), "--out", str(copy)]) == 0
    assert "nothing is left over" in capsys.readouterr().out


def test_code_that_has_changed_supersedes_its_shards(copy, monkeypatch, capsys):
    from cablesim import plan, shards

    for module in (plan, shards):
        monkeypatch.setattr(module, "source_digest", lambda solver: "changed")
    main(["clean", str(copy.parent / "spans.yaml"), "--out", str(copy)])
    assert "3 files may be removed" in capsys.readouterr().out


def test_a_whole_study_is_cleaned_by_its_configuration(copy, monkeypatch, capsys):
    scenes = copy.parent / "scenes"
    scenes.mkdir()
    for name in ("spans", "angles"):
        shutil.copy(copy.parent / f"{name}.yaml", scenes)
    (copy.parent / "config.yaml").write_text("study: small\nscenes: [spans, angles]\n")
    assert main(["clean", str(copy.parent / "config.yaml"), "--out", str(copy)]) == 0
    told = capsys.readouterr()
    assert "nothing is left over" in told.out
    assert "left alone: inclined" in told.err


def test_nothing_is_removed_while_a_study_runs(copy):
    scene = grown_and_shrunk(copy)
    (copy / ".lock").touch()
    before = tree(copy)
    clean = [sys.executable, "-m", "cablesim", "clean", str(scene), "--out", str(copy), "--remove"]
    with held(copy):
        found = subprocess.run(clean, capture_output=True, text=True, check=False)
    assert found.returncode == 3
    assert f"process {os.getpid()} on " in found.stderr
    assert tree(copy) == before


def test_parts_of_killed_processes_go_and_those_of_living_ones_stay(copy):
    dead, living = (copy / f".spans.nc.{process}.part" for process in (2**22 + 1, os.getpid()))
    for path in (dead, living):
        path.write_text("half")
    assert main(["clean", str(copy.parent / "spans.yaml"), "--out", str(copy), "--remove"]) == 0
    assert not dead.exists()
    assert living.exists()


def test_all_plans_that_are_kept_can_be_read(copy):
    grown_and_shrunk(copy)
    for path in (copy / "plans").glob("*.npz"):
        assert read_plan(path).recipes
