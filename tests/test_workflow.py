"""The whole line by Snakemake, as a user starts it: growth, resuming, damage, and the same bytes anywhere."""

import hashlib
import shutil
import subprocess
import sys
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from cablesim.workflow import plan_study

PROJECT = Path(__file__).parent.parent
SCENES = {
    "spans": """
title: A small grid
design:
  grid:
    span: [10 m, 20 m, 40 m]
    length_ratio: [0.9, 1.1, 1.2]
fixed: {weight_per_length: 5 N/m}
methods:
  exact: {solver: catenary_exact}
  parabolic: {solver: catenary_parabolic}
reference: exact
outputs: [sag, max_tension]
figures:
  sag: {kind: curves, x: length_ratio, y: exact.sag, each: span}
""",
    "limits": """
title: Limits
design:
  grid: {permitted_error: [1 %, 3 %]}
methods:
  parabolic: {solver: catenary_limit_ratio}
outputs: [sag_limit_ratio, tension_limit_ratio]
""",
}


def make_project(folder: Path) -> Path:
    """A folder with the workflow and a study of two small scenes."""
    shutil.copy(PROJECT / "Snakefile", folder)
    shutil.copytree(PROJECT / "workflow", folder / "workflow")
    (folder / "config" / "scenes").mkdir(parents=True)
    (folder / "config" / "config.yaml").write_text("study: small\nscenes: [spans, limits]\n")
    for name, text in SCENES.items():
        (folder / "config" / "scenes" / f"{name}.yaml").write_text(text)
    return folder


def snakemake(folder: Path, *arguments: str) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "snakemake", "--workflow-profile", "workflow/profiles/default", *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300, check=False)


def jobs(folder: Path) -> dict[str, int]:
    """How many jobs of each rule a run would start, but for catalogue and page, made anew whenever a scene is."""
    output = snakemake(folder, "--dry-run").stdout
    if "Job stats:" not in output:
        return {}
    lines = output.rpartition("Job stats:")[2].strip().splitlines()[2:]
    counts = dict(line.split() for line in lines[: lines.index("")])
    return {rule: int(count) for rule, count in counts.items() if rule not in ("all", "total", "catalogue", "report")}


def digests(folder: Path) -> dict[str, str]:
    """Every file of a folder by name and digest."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def replace(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


@pytest.fixture(scope="module")
def finished(tmp_path_factory) -> Path:
    """A study that ran to its end."""
    folder = make_project(tmp_path_factory.mktemp("study"))
    run = snakemake(folder)
    assert run.returncode == 0, run.stdout + run.stderr
    return folder


@pytest.fixture
def study(finished, tmp_path) -> Path:
    """A copy of the finished study, for a test to change."""
    return Path(shutil.copytree(finished, tmp_path / "study"))


def test_a_study_ends_with_datasets_tables_and_figures(finished):
    results = finished / "results" / "small"
    assert {"spans.nc", "limits.nc"} <= {path.name for path in results.iterdir()}
    tables = {path.name for path in (results / "tables").iterdir()}
    assert {"spans_errors.csv", "spans_errors.md", "spans_tensions.csv", "spans_status.csv"} <= tables
    assert {path.name for path in (results / "figures").iterdir()} == {
        "spans_sag.svg",
        "spans_sag.pdf",
        "spans_sag.png",
    }


def test_the_dataset_is_labelled_and_failed_means_nan(finished):
    import xarray as xr

    with xr.open_dataset(finished / "results" / "small" / "spans.nc") as dataset:
        assert dataset.sizes == {"method": 2, "span": 3, "length_ratio": 3}
        assert dataset.method.values.tolist() == ["exact", "parabolic"]
        assert dataset.sag.attrs["units"] == "m"
        assert dataset.status.attrs["flag_meanings"].split()[1] == "infeasible"
        failed = dataset.status != 0
        np.testing.assert_array_equal(failed.sel(length_ratio=0.9), True)
        for output in ("sag", "max_tension"):
            np.testing.assert_array_equal(np.isnan(dataset[output]), failed)
    with xr.open_dataset(finished / "results" / "small" / "spans.nc", group="measured") as measured:
        assert (measured.run_time > 0).all()


def test_what_takes_longest_is_solved_first_and_what_is_of_the_whole_study_last(tmp_path, monkeypatch):
    folder = make_project(tmp_path)
    assert snakemake(folder, "--cores", "1").returncode == 0
    monkeypatch.chdir(folder)
    planned = plan_study(Path("config") / "config.yaml", checking=False)
    expected = {one.name: one.bundle_seconds(bundle) for one in planned.scenes for bundle in one.bundles}
    assert expected["spans"] != expected["limits"]
    logs = sorted((folder / "results" / "small" / "logs").rglob("*.log"), key=lambda path: path.stat().st_mtime_ns)
    solved = [path.name.partition("-")[0] for path in logs if path.parent.name == "solve"]
    assert solved == sorted(expected, key=lambda name: -expected[name])
    # What is solved is collected and drawn before more is solved.
    assert [path.parent.name for path in logs[:2]] == ["solve", "collect"]
    assert {path.parent.name for path in logs[2:4]} == {"summarise", "figures"}
    assert {path.name for path in logs[-2:]} == {"catalogue.log", "report.log"}


def test_a_finished_study_has_nothing_to_do(study):
    assert jobs(study) == {}


@pytest.mark.parametrize(
    ("old", "new"), [("40 m]", "40 m, 80 m]"), ("[10 m,", "[5 m, 10 m,"), ("20 m,", "20 m, 30 m,")]
)
def test_an_added_value_runs_one_job_and_leaves_the_other_shards_alone(study, old, new):
    shards = study / "results" / "small" / "shards"
    before = digests(shards)
    replace(study / "config" / "scenes" / "spans.yaml", old, new)
    assert jobs(study) == {"solve": 1, "collect_spans": 1, "summarise_spans": 1, "figures_spans": 1}
    assert snakemake(study).returncode == 0
    after = digests(shards)
    assert len(after) == len(before) + 4
    assert after.items() >= before.items()


def test_going_back_to_an_earlier_scene_brings_back_its_results(study):
    results, scene = study / "results" / "small", study / "config" / "scenes" / "spans.yaml"
    before = digests(results)
    replace(scene, "40 m]", "40 m, 80 m]")
    assert snakemake(study).returncode == 0
    replace(scene, "40 m, 80 m]", "40 m]")
    assert jobs(study) == {"collect_spans": 1, "summarise_spans": 1, "figures_spans": 1}
    assert snakemake(study).returncode == 0
    after = digests(results)
    kept = [name for name in before if "shards" not in name and "logs" not in name]
    assert {name: after[name] for name in kept} == {name: before[name] for name in kept}


def test_an_added_scene_or_method_runs_only_itself(study):
    config = study / "config"
    (config / "scenes" / "more.yaml").write_text(SCENES["limits"].replace("Limits", "More"))
    replace(config / "config.yaml", "limits]", "limits, more]")
    replace(config / "scenes" / "spans.yaml", "reference:", "  series: {solver: catenary_series}\nreference:")
    solve = jobs(study)
    assert solve.pop("solve") == 2
    assert set(solve) == {
        f"{step}_{scene}" for step in ("collect", "summarise", "figures") for scene in ("spans", "more")
    }


def test_content_decides_what_is_up_to_date_not_the_clock(study):
    for path in sorted(study.rglob("*")):
        if path.is_file():
            path.touch()
    (study / "config" / "scenes" / "spans.yaml").touch()
    shutil.rmtree(study / ".snakemake")
    assert jobs(study) == {}


def test_a_lost_file_is_made_again(study):
    (study / "results" / "small" / "spans.nc").unlink()
    assert jobs(study).keys() == {"collect_spans", "summarise_spans", "figures_spans"}
    assert snakemake(study).returncode == 0
    assert (study / "results" / "small" / "spans.nc").exists()


def damage(path: Path) -> None:
    """Flip a bit in the middle of a file."""
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)


def test_damaged_missing_and_foreign_shards_are_computed_again_by_the_next_run(study):
    shards = study / "results" / "small" / "shards"
    before = digests(shards)
    spans, limits = sorted((shards / "spans").glob("*.nc")), sorted((shards / "limits").glob("*.nc"))
    damage(spans[0])
    for suffix in (".nc", ".json"):
        shutil.copy(spans[0].with_suffix(suffix), limits[0].with_suffix(suffix))
    assert jobs(study) == {"solve": 2, "collect_spans": 1, "collect_limits": 1}
    assert snakemake(study).returncode == 0
    after = digests(shards)
    assert {name: after[name] for name in before if name.endswith(".nc")} == {
        name: before[name] for name in before if name.endswith(".nc")
    }
    assert all(after[name] == before[name] for name in before if Path(name).stem not in (spans[0].stem, limits[0].stem))
    limits[0].unlink()
    assert jobs(study) == {"solve": 1, "collect_limits": 1}


def test_a_shard_that_is_damaged_while_the_study_runs_leaves_its_scenarios_not_run_and_is_named(study):
    scene, results = study / "config" / "scenes" / "spans.yaml", study / "results" / "small"
    shards = sorted((results / "shards" / "spans").glob("*.nc"))
    for shard in shards:
        damage(shard)
    command = [sys.executable, "-m", "cablesim", "step", "collect", str(scene), str(results)]
    failed = subprocess.run(command, capture_output=True, text=True, check=False)
    assert failed.returncode == 3
    said = "damaged (its digest does not match) (and 1 more shards)"
    assert any(f"{shard}: {said}" in failed.stderr for shard in shards)
    with netCDF4.Dataset(results / "spans.nc") as file:
        words = file["status"].flag_meanings.split()
        assert (file["status"][...] == words.index("not_run")).all()
        assert np.isnan(file["sag"][...].filled(np.nan)).all()
    mended = snakemake(study)
    assert mended.returncode == 0, mended.stdout + mended.stderr


def test_a_dataset_of_what_was_there_so_far_is_replaced_although_a_stamp_says_it_is_done(study):
    scene, results = study / "config" / "scenes" / "spans.yaml", study / "results" / "small"
    before, stamps = root_group(results / "spans.nc"), digests(results / "stamps")
    (results / "spans.nc").unlink()
    shard = min((results / "shards" / "spans").glob("*.nc"))
    shard.rename(shard.with_suffix(".away"))
    command = [sys.executable, "-m", "cablesim", "collect", str(scene), "--out", str(results)]
    assert subprocess.run(command, capture_output=True, check=False).returncode == 1
    shard.with_suffix(".away").rename(shard)
    # As if the step that collects had ended at the same moment.
    for name in stamps:
        (results / "stamps" / name).touch()
    assert "collect_spans" in jobs(study)
    assert snakemake(study).returncode == 0
    assert root_group(results / "spans.nc") == before


def test_a_damaged_dataset_is_collected_again(study):
    dataset = study / "results" / "small" / "spans.nc"
    before = root_group(dataset)
    damage(dataset)
    assert jobs(study) == {"collect_spans": 1, "summarise_spans": 1, "figures_spans": 1}
    assert snakemake(study).returncode == 0
    assert root_group(dataset) == before


def test_a_wrong_scene_stops_the_study_with_the_place_of_the_mistake(study):
    replace(study / "config" / "scenes" / "spans.yaml", "5 N/m", "5 N")
    run = snakemake(study)
    assert run.returncode != 0
    assert "spans.yaml:7: fixed.weight_per_length: the unit 'N' is of another dimension" in run.stdout + run.stderr


def test_another_folder_gives_the_same_bytes_but_for_measured_times(finished, tmp_path):
    other = make_project(tmp_path)
    assert snakemake(other).returncode == 0
    mine, theirs = (digests(folder / "results" / "small") for folder in (finished, other))
    measured = {name for name in mine if mine[name] != theirs.get(name)}
    # Times are in the ledgers of shards, in the group `measured` of datasets and in the tables of statuses; stamps have
    # the digests of these.
    assert mine.keys() == theirs.keys()
    assert all(
        name.endswith((".json", "_status.csv", "_status.md")) or Path(name).parent in (Path(), Path("stamps"))
        for name in measured
    )
    for scene in ("spans", "limits"):
        one, two = (root_group(folder / "results" / "small" / f"{scene}.nc") for folder in (finished, other))
        assert one == two


def root_group(path: Path) -> dict[str, object]:
    """A dataset's root group: its attributes, and of each variable the type, storage, attributes and bytes."""
    with netCDF4.Dataset(path) as file:
        file.set_auto_maskandscale(False)
        found: dict[str, object] = {"attributes": repr(file.__dict__), "dimensions": repr(file.dimensions)}
        for name, variable in file.variables.items():
            storage = (
                variable.dtype,
                variable.dimensions,
                variable.filters(),
                variable.chunking(),
                repr(variable.__dict__),
            )
            found[name] = (storage, np.asarray(variable[...]).tobytes())
        return found
