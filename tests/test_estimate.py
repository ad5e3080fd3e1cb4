"""What a study will cost: counts by hand, what is there already, and refusals with what would fit."""

import re
from pathlib import Path

import pytest

from cablesim import estimate as estimating
from cablesim.cli import main
from cablesim.config.scene import read_scene
from cablesim.errors import EnvironmentFault
from cablesim.estimate import Estimate, estimate_study, refuse_what_does_not_fit
from cablesim.plan import make_plan
from cablesim.study import Layout
from tests.test_workflow import make_project

SCENE = """
title: Spans
design:
  grid: {{span: {{start: 10 m, stop: 90 m, num: {num}}}, rise: [0 m, 10 m]}}
fixed: {{line_length: 120 m, weight_per_length: 5 N/m}}
methods:
  exact: {{solver: catenary_exact}}
outputs: [{outputs}]
"""


def scene(folder: Path, num: int = 100, outputs: str = "sag, max_tension") -> Path:
    path = folder / "spans.yaml"
    path.write_text(SCENE.format(num=num, outputs=outputs))
    return path


def estimated(path: Path, cores: int = 2) -> Estimate:
    read, layout = read_scene(path), Layout(path.parent / "results")
    return estimate_study([(read, make_plan(read, layout.plans))], layout, cores)


def test_a_small_scene_is_four_jobs_and_the_catalogue(tmp_path):
    found = estimated(scene(tmp_path))
    assert (found.scenarios, found.jobs, len(found.scenes[0].seconds)) == (200, 5, 1)
    assert found.seconds <= found.processor_seconds
    assert list(tmp_path.iterdir()) == [tmp_path / "spans.yaml"]


def test_more_scenarios_cost_more_of_everything(tmp_path):
    less, more = (estimated(scene(tmp_path, num)) for num in (100_000, 1_000_000))
    assert more.scenarios == 10 * less.scenarios
    for cost in ("jobs", "seconds", "processor_seconds", "memory", "disk"):
        assert getattr(more, cost) >= getattr(less, cost)
    # Outputs and status, compressed, in shards and in the dataset.
    assert more.disk - less.disk == pytest.approx(2 * 0.65 * 17 * 1_800_000, rel=0.01)


def test_a_profile_costs_disk_and_memory(tmp_path):
    without, with_profile = (estimated(scene(tmp_path, 50_000, outputs)) for outputs in ("sag", "sag, profile"))
    assert with_profile.disk > 50 * without.disk
    assert with_profile.memory > without.memory


def test_more_cores_take_less_time_but_no_less_work(tmp_path):
    few, many = (estimated(scene(tmp_path, 1_000_000, "sag, profile"), cores) for cores in (1, 8))
    assert many.seconds < few.seconds
    assert many.processor_seconds == few.processor_seconds


def test_what_is_there_is_not_counted_again(tmp_path):
    path = scene(tmp_path)
    assert main(["run", str(path), "--out", str(tmp_path / "results")]) == 0
    found = estimated(path)
    assert (found.scenes[0].new, found.jobs, found.disk) == (0, 1, 0)
    grown = estimated(scene(tmp_path, 199))
    assert (grown.scenarios, grown.scenes[0].new) == (398, 198)


def test_ledgers_tell_what_a_method_takes_here(tmp_path):
    from cablesim.files import ledger

    path = scene(tmp_path)
    main(["run", str(path), "--out", str(tmp_path / "results")])
    (shard,) = (tmp_path / "results" / "shards" / "spans").glob("*.nc")
    text = ledger(shard).read_text()
    ledger(shard).write_text(re.sub(r'"seconds": [^,]*', '"seconds": 100.0', text))
    # 200 scenarios took 100 s, and 198 are new.
    assert estimated(scene(tmp_path, 199)).scenes[0].bundles == [pytest.approx(99.0, abs=2.0)]


@pytest.mark.parametrize("what", ["disk", "memory"])
def test_what_does_not_fit_is_refused_with_what_would_and_that_does(tmp_path, monkeypatch, what):
    path, free = scene(tmp_path, 400_000, "sag, profile"), 2_000_000_000
    if what == "disk":
        monkeypatch.setattr(estimating, "free_bytes", lambda path: free)
    else:
        monkeypatch.setattr("psutil.virtual_memory", lambda: type("Memory", (), {"available": 400_000_000}))
    with pytest.raises(EnvironmentFault) as told:
        refuse_what_does_not_fit(estimated(path), Layout(tmp_path / "results"))
    fitting = re.search(
        r"spans\.yaml: .* needed, .* free; with (\d+) instead of 400000 points of span", str(told.value)
    )
    assert fitting
    refuse_what_does_not_fit(estimated(scene(tmp_path, int(fitting[1]), "sag, profile")), Layout(tmp_path / "results"))


def test_a_study_that_does_not_fit_is_not_started(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(make_project(tmp_path))
    monkeypatch.setattr(estimating, "free_bytes", lambda path: 1000)
    assert main(["study"]) == 3
    assert "on disk are needed" in capsys.readouterr().err
    assert not (tmp_path / "results" / "small" / "shards").exists()
    assert main(["check", "config/config.yaml"]) == 3


def test_a_study_is_checked_scene_by_scene(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(make_project(tmp_path))
    assert main(["check", "config/config.yaml"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == ["spans", "limits", "in"]
    assert "in all 20 of 20 scenarios to solve in 9 jobs" in lines[-1]
    assert not (tmp_path / "results").exists()


@pytest.mark.parametrize(("hours", "code"), [("0.0001", 3), ("10", 0), ("0", 2), ("nan", 2)])
def test_hours_are_a_limit(tmp_path, hours, code, capsys):
    assert main(["check", str(scene(tmp_path)), "--hours", hours]) == code
    if code == 3:
        assert "are needed, 0.0001 h are given; " in capsys.readouterr().err


def test_what_is_vast_is_refused_before_it_is_planned(tmp_path, capsys):
    path = scene(tmp_path, 50_000_000, "sag, profile")
    path.write_text(path.read_text().replace("rise: [0 m, 10 m]", "rise: {start: 0 m, stop: 10 m, num: 4}"))
    assert main(["check", str(path)]) == 3
    assert "B on disk are needed" in capsys.readouterr().err
