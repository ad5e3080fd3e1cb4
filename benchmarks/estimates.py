"""Estimates beside what studies take: time, memory of the largest process, and disk, each study from nothing."""

import os
import shutil
import subprocess
import sys
import tempfile
import threading
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import psutil
from measure import markdown, revision

from cablesim.config.scene import read_scene
from cablesim.estimate import Estimate, estimate_study
from cablesim.machine import machine
from cablesim.plan import make_plan
from cablesim.study import Layout
from workflow import DYNAMIC_SCENE, NAME, STUDY, make_study

PROJECT = Path(__file__).resolve().parents[1]
MEGABYTE = 1e6
STATIC = """\
title: {title}
design: {{grid: {grid}}}
fixed: {fixed}
methods: {{one: {{solver: {solver}}}}}
outputs: [{outputs}]
"""
SCENES = {
    "1,000,000 spans, eight outputs, a map": "",
    "30,000 profiles of hanging lines": STATIC.format(
        title="Profiles",
        grid="{span: {start: 10 m, stop: 90 m, num: 300}, rise: {start: 0 m, stop: 30 m, num: 100}}",
        fixed="{line_length: 100 m, weight_per_length: 5 N/m}",
        solver="catenary_exact",
        outputs="sag, max_tension, profile",
    ),
    "20,000 lines between two ends in a stream": STATIC.format(
        title="Stream",
        grid="{stream_speed: {start: 0.2 m/s, stop: 3 m/s, num: 200}, "
        "line_length: {start: 101 m, stop: 150 m, num: 100}}",
        fixed="{position_B: [60 m, 0 m, 80 m], weight_per_length: 5, diameter: 10 mm, normal_drag_coefficient: 1.2, "
        "tangential_drag_coefficient: 0.03, fluid_density: 1025}",
        solver="stream_line",
        outputs="tension_A, tension_B, max_tension",
    ),
    "10,000 lines in waves": DYNAMIC_SCENE,
    "300 histories of lines in waves": DYNAMIC_SCENE.replace("num: 25", "num: 5")
    .replace("start: 0.2 m, stop: 2.1 m, num: 20", "start: 0.2 m, stop: 2.1 m, num: 6")
    .replace("start: 0.998, stop: 1.002, num: 20", "start: 0.998, stop: 1.002, num: 10")
    .replace("snap_count,", "snap_count, history,"),
}
# Scenes of the default study, together in one.
MANY = ("formula_error", "inclined_spans", "limit_ratio", "sag_experiment", "friction_laws", "stream_3d", "weight_play")
MANY_NAME = f"{len(MANY)} scenes of the default study"


@dataclass(frozen=True)
class Taken:
    """What a study took: seconds, bytes of memory of its largest process, bytes on disk."""

    seconds: float
    memory: int
    disk: int


def study_of(folder: Path, name: str) -> Path:
    """A folder with a study."""
    make_study(folder, 1_000_000)
    scenes = folder / "config" / "scenes"
    if name == MANY_NAME:
        shutil.copytree(PROJECT / "config" / "scenes", scenes, dirs_exist_ok=True)
        (folder / "config" / "config.yaml").write_text(f"study: {STUDY}\nscenes: [{', '.join(MANY)}]\n")
    elif SCENES[name]:
        (scenes / f"{NAME}.yaml").write_text(SCENES[name])
    return folder


def estimated(folder: Path, name: str) -> Estimate:
    names = MANY if name == MANY_NAME else (NAME,)
    scenes = [read_scene(folder / "config" / "scenes" / f"{one}.yaml") for one in names]
    layout = Layout(folder / "results" / STUDY)
    return estimate_study([(scene, make_plan(scene, layout.plans)) for scene in scenes], layout)


def taken(folder: Path) -> Taken:
    """Run the study, and look at its processes twenty times a second."""
    largest = 0
    start = perf_counter()
    run = subprocess.Popen(
        [sys.executable, "-m", "cablesim", "study"], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )

    def look() -> None:
        nonlocal largest
        while run.poll() is None:
            largest = max(largest, _largest(run.pid))
            threading.Event().wait(0.05)

    watcher = threading.Thread(target=look)
    watcher.start()
    code = run.wait()
    seconds = perf_counter() - start
    watcher.join()
    if code not in (0, 1):
        sys.exit(f"{folder}: the study ended with {code}")
    files = (path.stat().st_size for path in (folder / "results").rglob("*") if path.is_file())
    return Taken(seconds, largest, sum(files))


def _largest(process: int) -> int:
    try:
        whole = psutil.Process(process)
        return max(one.memory_info().rss for one in (whole, *whole.children(recursive=True)))
    except psutil.Error:
        return 0


def row(name: str, told: Estimate, found: Taken) -> tuple[str, ...]:
    """Estimate, actual and their ratio."""
    pairs = (
        (told.seconds, found.seconds),
        (told.memory / MEGABYTE, found.memory / MEGABYTE),
        (told.disk / MEGABYTE, found.disk / MEGABYTE),
    )
    return (
        name,
        *(cell for pair in pairs for cell in (f"{pair[0]:.3g}", f"{pair[1]:.3g}", f"{pair[0] / pair[1]:.2f}")),
    )


def main() -> None:
    rows = []
    for name in (*SCENES, MANY_NAME):
        with tempfile.TemporaryDirectory() as folder:
            study = study_of(Path(folder) / "study", name)
            rows.append(row(name, estimated(study, name), taken(study)))
    print(machine("snakemake"), f"revision {revision()}, {os.cpu_count()} cores", sep="; ", end="\n\n")
    head = ("study", "estimated s", "s", "ratio", "estimated MB", "MB", "ratio", "estimated MB on disk", "MB", "ratio")
    print(markdown(head, rows))


if __name__ == "__main__":
    main()
