"""Estimates of what a study takes: figures by hand, what is there already, and refusals that tell what would fit."""

import re
from pathlib import Path

import numpy as np
import pytest

from cablesim import cli, costs, fitting, launch
from cablesim.config.scene import read_scene
from cablesim.errors import EnvironmentFault
from cablesim.estimate import StudyEstimate, estimate_study
from cablesim.files import ledger
from cablesim.fitting import Room, refuse_what_does_not_fit
from cablesim.plan import make_plan
from cablesim.solver import load_solver
from cablesim.steps import run_scene, sample
from cablesim.study import Layout, read_any

GB = 10**9
PLENTY = Room(10**18, 10**15)
LINES = """\
title: Lines
design:
  {design}
fixed: {{line_length: 500 m, weight_per_length: 10 N/m}}
methods:
  exact: {{solver: catenary_exact{options}}}
outputs: [{outputs}]
"""


def scene_file(folder: Path, design: str = "", outputs: str = "sag, max_tension", options: str = "", name="lines"):
    path = folder / f"{name}.yaml"
    design = design or "grid: {span: {start: 50 m, stop: 400 m, num: 100}}"
    path.write_text(LINES.format(design=design, outputs=outputs, options=options))
    return path


def spans(num: int) -> str:
    return f"grid: {{span: {{start: 50 m, stop: 400 m, num: {num}}}, rise: [0 m, 10 m]}}"


def found_for(path: Path, folder: Path, cores: int = 2) -> StudyEstimate:
    _, scenes = read_any(path)
    return estimate_study(scenes, Layout(folder), cores)


def refusal(path: Path, room: Room, folder: Path, cores: int = 2) -> str:
    with pytest.raises(EnvironmentFault) as refused:
        refuse_what_does_not_fit(found_for(path, folder, cores), room, folder)
    assert "\n" not in str(refused.value)
    return str(refused.value)


def test_a_small_scene_is_a_shard_and_five_steps(tmp_path):
    found = found_for(scene_file(tmp_path), tmp_path / "results")
    total = found.total
    assert (total.scenarios, total.jobs) == (100, 6)
    starts = costs.SOLVE + costs.COLLECT + costs.SUMMARISE + costs.FIGURES + costs.CATALOGUE + costs.REPORT
    fixed = costs.START_SECONDS + 6 * costs.JOB_SECONDS + starts + costs.SECONDS_PER_PAGE_SCENE
    assert total.processor_seconds == pytest.approx(fixed, rel=1e-3)
    table = costs.CELL_BYTES * 100 * (3 + 2 * 2)
    answers = 2 * 100 * (16 * costs.GRID_RATIO + costs.BESIDE_STORED)
    page = costs.PAGE_BYTES + costs.PAGE_SCENE_BYTES
    by_hand = costs.SHARD_BYTES + costs.SCENE_BYTES + page + answers + table + 24 * 100
    assert total.disk_bytes == round(by_hand)
    assert total.seconds <= total.processor_seconds
    assert not (tmp_path / "results").exists()


def test_everything_grows_with_the_scenarios(tmp_path):
    totals = [found_for(scene_file(tmp_path, spans(n)), tmp_path).total for n in (10_000, 100_000, 1_000_000)]
    for name in ("scenarios", "seconds", "processor_seconds", "together_bytes", "disk_bytes"):
        values = [getattr(total, name) for total in totals]
        assert values == sorted(set(values)), name


def test_profiles_take_their_room(tmp_path):
    bare, long = (
        found_for(scene_file(tmp_path, spans(10_000), outputs), tmp_path).total for outputs in ("sag", "sag, profile")
    )
    profile = 101 * 3 * 8 * 20_000
    # Once in the shards, once in the dataset.
    assert 1.2 * profile < long.disk_bytes - bare.disk_bytes < 2.0 * profile
    assert long.memory_bytes > bare.memory_bytes


def test_a_study_is_its_scenes_and_shares_the_cores(tmp_path):
    for name in ("one", "two", "three"):
        scene_file(tmp_path, name=name)
    scenes = [read_scene(tmp_path / f"{name}.yaml") for name in ("one", "two", "three")]
    single, several = (estimate_study(scenes, Layout(tmp_path / "results"), cores) for cores in (1, 2))
    assert single.total.jobs == 3 * 4 + 2
    assert several.total.processor_seconds == single.total.processor_seconds
    assert several.total.seconds < single.total.seconds == pytest.approx(single.total.processor_seconds)
    assert several.total.together_bytes > single.total.together_bytes
    # They share a page.
    alone = [several.of(scene).disk_bytes - costs.PAGE_BYTES for scene in several.scenes]
    assert several.total.disk_bytes == costs.PAGE_BYTES + sum(alone)


def test_what_is_there_is_no_work(tmp_path):
    scene, layout = read_scene(scene_file(tmp_path)), Layout(tmp_path / "results")
    run_scene(scene, layout, lambda *_: None)
    total = estimate_study([scene], layout, 2).total
    assert total.scenarios == 0
    more = read_scene(scene_file(tmp_path, "grid: {span: {start: 50 m, stop: 400 m, num: 100, also: [401 m, 402 m]}}"))
    assert estimate_study([more], layout, 2).total.scenarios == 2


def test_a_finished_scene_takes_nothing(tmp_path):
    scene, layout = read_scene(scene_file(tmp_path)), Layout(tmp_path / "results")
    plan, _ = run_scene(scene, layout, lambda *_: None)
    stamps = [layout.stamp(scene.name, step, "0" * 16) for step in ("collect", "summarise", "figures")]
    stamps += [layout.stamp(scene.name, "solve", bundle) for bundle in plan.bundles]
    for stamp in stamps:
        stamp.parent.mkdir(exist_ok=True)
        stamp.touch()
    total = estimate_study([scene], layout, 2).total
    assert (total.scenarios, total.jobs, total.disk_bytes) == (0, 0, 0)


def test_what_shards_took_is_believed_and_changes_no_shard(tmp_path):
    layout = Layout(tmp_path / "results")
    first = read_scene(scene_file(tmp_path))
    plan = sample(first, layout)
    (digest, recipe), *_ = plan.recipes.items()
    shard = layout.shards(first.name) / f"{digest}.nc"
    shard.parent.mkdir(parents=True)
    shard.touch()
    ledger(shard).write_text('{"seconds": 5.0}')
    other = read_scene(scene_file(tmp_path, "grid: {span: {start: 60 m, stop: 410 m, num: 200}}"))
    method = estimate_study([other], layout, 2).scenes[0].methods[0]
    assert method.seconds == pytest.approx(10.0)
    assert make_plan(other, layout.plans).recipes.keys() == make_plan(other, tmp_path / "elsewhere").recipes.keys()
    assert recipe.expected_seconds == recipe.seconds


@pytest.mark.parametrize("share", [0.9, 0.3, 0.05])
def test_the_number_of_points_that_is_told_fits(tmp_path, share):
    # So many that a page, which is as large for any number, does not count.
    path, results = scene_file(tmp_path, spans(4_000_000)), tmp_path / "results"
    room = Room(round(share * found_for(path, results).total.disk_bytes), 10**15)
    said = refusal(path, room, results)
    points = int(re.search(r"span: \{num: (\d+)\} instead of 4000000", said)[1])
    assert points > 0.75 * share * 4_000_000
    smaller = found_for(scene_file(tmp_path, spans(points)), results)
    refuse_what_does_not_fit(smaller, room, results)


def test_profiles_that_do_not_fit_may_be_left_out(tmp_path):
    path = scene_file(tmp_path, spans(10_000), "sag, profile")
    room = Room(20 * 10**6, 10**15)
    said = refusal(path, room, tmp_path)
    assert "outputs without `profile`" in said
    refuse_what_does_not_fit(found_for(scene_file(tmp_path, spans(10_000), "sag"), tmp_path), room, tmp_path)


def test_less_memory_is_enough_for_fewer_cores(tmp_path):
    path = scene_file(tmp_path, spans(400_000))
    needs = [found_for(path, tmp_path, cores).total.together_bytes for cores in (1, 4)]
    room = Room(10**18, sum(needs) // 2)
    cores = int(re.search(r"--cores (\d)", refusal(path, room, tmp_path, 4))[1])
    refuse_what_does_not_fit(found_for(path, tmp_path, cores), room, tmp_path)


def test_time_is_a_limit_where_it_is_given(tmp_path):
    path = scene_file(tmp_path, spans(4_000_000))
    total = found_for(path, tmp_path).total
    room = Room(10**18, 10**15, 0.7 * total.seconds)
    points = int(re.search(r"span: \{num: (\d+)\}", refusal(path, room, tmp_path))[1])
    refuse_what_does_not_fit(found_for(scene_file(tmp_path, spans(points)), tmp_path), room, tmp_path)
    refuse_what_does_not_fit(found_for(path, tmp_path), PLENTY, tmp_path)


def test_where_nothing_fits_it_is_said(tmp_path):
    assert "no smaller number" in refusal(scene_file(tmp_path), Room(10, 10**15), tmp_path)


def test_what_is_vast_is_refused_before_it_is_planned_and_what_is_told_fits(tmp_path, monkeypatch):
    free = 50_000_000
    monkeypatch.setattr(fitting, "free_bytes", lambda folder: free)
    vast = read_scene(scene_file(tmp_path, spans(50_000_000), "sag, profile"))
    with pytest.raises(EnvironmentFault, match=r"GB on the disk, 50 MB are free") as refused:
        fitting.refuse_vast(vast, tmp_path)
    points = int(re.search(r"span: \{num: (\d+)\}", str(refused.value))[1])
    smaller = scene_file(tmp_path, spans(points), "sag, profile")
    fitting.refuse_vast(read_scene(smaller), tmp_path)
    refuse_what_does_not_fit(found_for(smaller, tmp_path), Room(free), tmp_path)


def test_the_largest_scene_of_a_study_is_named(tmp_path):
    folder = tmp_path / "config" / "scenes"
    folder.mkdir(parents=True)
    scene_file(folder, name="small")
    scene_file(folder, spans(300_000), name="large")
    config = tmp_path / "config" / "config.yaml"
    config.write_text("study: some\nscenes: [small, large]\n")
    said = refusal(config, Room(10**7, 10**15), tmp_path)
    assert said.startswith("2 scenes, most of all ")
    assert "large.yaml: needs" in said
    assert "span: {num:" in said


def test_of_many_equal_scenes_as_many_fit_as_are_told(tmp_path):
    scenes = [read_scene(scene_file(tmp_path, name=f"scene_{number}")) for number in range(6)]
    found = estimate_study(scenes, Layout(tmp_path / "results"), 2)
    half = estimate_study(scenes[:3], Layout(tmp_path / "results"), 2)
    room = Room(half.total.disk_bytes, 10**15)
    with pytest.raises(EnvironmentFault, match="it fits with the first 3 of 6 scenes"):
        refuse_what_does_not_fit(found, room, tmp_path)
    refuse_what_does_not_fit(half, room, tmp_path)


@pytest.mark.parametrize(
    ("design", "words"),
    [
        (
            "sample: {method: sobol, num: 50000, seed: 1, ranges: {span: {start: 50 m, stop: 400 m}}}",
            r"num: \d+ instead of 50000",
        ),
        (f"cases: [{', '.join(f'{{span: {50 + i} m}}' for i in range(300))}]", r"\d+ cases instead of 300"),
        (f"grid: {{span: [{', '.join(f'{50 + i} m' for i in range(300))}]}}", r"\d+ values of span instead of 300"),
    ],
)
def test_it_is_told_in_the_words_of_the_scene(tmp_path, design, words):
    path = scene_file(tmp_path, design)
    least = found_for(scene_file(tmp_path), tmp_path).total.disk_bytes
    whole = found_for(scene_file(tmp_path, design), tmp_path).total.disk_bytes
    assert re.search(words, refusal(path, Room((least + whole) // 2, 10**15), tmp_path))


def test_check_answers_with_its_exit_codes_and_writes_nothing(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    path = str(scene_file(tmp_path))
    assert cli.main(["check", path]) == 0
    assert "100 to solve in 1 shard(s)" in capsys.readouterr().out
    monkeypatch.setattr(fitting, "free_bytes", lambda _: 1000)
    assert cli.main(["check", path]) == 3
    assert "1 kB are free at results/lines" in capsys.readouterr().err
    assert cli.main(["check", path, "--hours", "-1"]) == 2
    assert sorted(path.name for path in tmp_path.iterdir()) == ["lines.yaml"]


def test_check_of_a_study_has_a_line_for_each_scene(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scenes").mkdir()
    for name in ("one", "two"):
        scene_file(tmp_path / "scenes", name=name)
    (tmp_path / "config.yaml").write_text("study: some\nscenes: [one, two]\n")
    assert cli.main(["check", "config.yaml", "--cores", "3"]) == 0
    first, second, valid, total = capsys.readouterr().out.splitlines()
    assert first.startswith("one") and second.startswith("two")
    assert valid == "some: 2 scenes, all valid"
    assert "10 jobs" in total and "3 cores" in total


def test_a_study_that_does_not_fit_is_not_started(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for path in (launch.SNAKEFILE, launch.PROFILES / "default" / "config.yaml"):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    (tmp_path / "scenes").mkdir()
    scene_file(tmp_path / "scenes", name="one")
    config = tmp_path / "refused.yaml"
    config.write_text("study: some\nscenes: [one]\n")
    planned = launch.plan_study(config)
    monkeypatch.setattr(launch, "plan_study", lambda *_, **__: planned)
    for room in (Room(1000, 10**15), Room(10**15, 1000)):
        monkeypatch.setattr(launch, "room_at", lambda _, room=room: room)
        with pytest.raises(EnvironmentFault, match=r"one.yaml: needs .*, 1 kB are free"):
            launch.run_study(config, "default", "2")


def test_snapping_lines_are_expected_to_take_longer():
    solver = load_solver("wave_line")
    line = {"depth": 200.0, "chord_angle": 0.785, "mass_per_length": 3.0, "area": 3e-4, "normal_drag": 15.6}
    line |= {"tangential_drag": 0.78, "added_mass_per_length": 0.4, "wave_period": 5.6, "linear_stiffness": 1e7}
    lengths = np.array([0.995, 1.0005, 1.0005])
    parameters = solver.make_parameters(
        {name: np.full(3, value) for name, value in line.items()}
        | {"length_ratio": lengths, "top_amplitude": np.array([0.2, 0.2, 3.0])}
    )
    for options in ({"segments": 20}, {"segments": 40, "rtol": 1e-4}):
        taut, still, snapping = solver.seconds_of(parameters, solver.make_options(options))
        assert taut == still < snapping
        # A second march with a tenth of the tolerance, which costs more where a line snaps.
        twice = solver.seconds_of(parameters, solver.make_options(options | {"time_check": "yes"}))
        assert twice[2] / snapping > twice[0] / taut > 2.0


def test_the_words_for_sizes_and_times():
    assert [fitting.size_words(size) for size in (5, 1234, 76e9)] == ["5 bytes", "1.23 kB", "76 GB"]
    assert [fitting.duration_words(s) for s in (0.2, 61, 600, 9000)] == ["1 s", "61 s", "10 min", "2.5 h"]
