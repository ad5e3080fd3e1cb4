"""Estimates of `cablesim check` against what studies then take: time, memory and disk, each study from nothing."""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

from measure import markdown, revision

from cablesim.errors import EnvironmentFault
from cablesim.estimate import Estimate, estimate_study
from cablesim.machine import available_cores, machine
from cablesim.study import Layout, read_study

PROJECT = Path(__file__).parent.parent
MB = 1e6
HANGING = "catenary_parameter, horizontal_tension, tension_A, tension_B, max_tension, sag, drop, vertex_x"
SPANS = """\
title: Spans between supports at different levels
design:
  grid:
    rise: {{start: -30 m, stop: 30 m, num: {rises}}}
    span: {{start: 5 m, stop: 95 m, num: {spans}}}
fixed: {{line_length: 100 m, weight_per_length: 10 N/m}}
methods:
  exact: {{solver: catenary_exact}}
outputs: [{outputs}]
figures:
  tension: {{kind: map, x: span, y: rise, value: max_tension, label: largest tension}}
"""
STREAM = """\
title: Lines in a stream
design:
  sample:
    method: sobol
    num: {number}
    seed: 3
    ranges:
      line_length: {{start: 35 m, stop: 90 m}}
      stream_speed: {{start: 0.2 m/s, stop: 2 m/s}}
      weight_per_length: {{start: 1 N/m, stop: 10 N/m}}
fixed:
  {end}
  diameter: 10 mm
  normal_drag_coefficient: 1.2
  tangential_drag_coefficient: 0.03
  fluid_density: 1000
methods:
  vector: {{solver: stream_line}}
  segments: {{solver: segment_line}}
reference: vector
outputs: [tension_A, tension_B, lowest_point]
"""
WAVES = """\
title: Mooring lines in waves
design:
  grid:
    length_ratio: {ratios}
    linear_stiffness: {stiffness}
    top_amplitude: {amplitudes}
fixed:
  depth: 200 m
  chord_angle: 45 deg
  mass_per_length: 3 kg/m
  area: 3 cm^2
  normal_drag: 15.6 kg/m^2
  tangential_drag: 0.78 kg/m^2
  added_mass_per_length: 0.4 kg/m
  wave_period: 6 s
methods:
  moving: {{solver: wave_line, options: {{{options}}}}}
outputs: [max_top_tension, min_top_tension, slack_fraction, {outputs}]
"""
METHODS = """\
title: Formulas for spans
design:
  grid:
    span: {start: 50 m, stop: 400 m, num: 1500}
    length_ratio: {start: 1.0001, stop: 1.2, num: 1500}
fixed: {weight_per_length: 12 N/m}
methods:
  exact: {solver: catenary_exact}
  parabolic: {solver: catenary_parabolic}
  series: {solver: catenary_series}
reference: exact
outputs: [max_tension, sag]
"""
TOW = """\
title: Tow lines
design:
  sample:
    method: latin_hypercube
    num: 300000
    seed: 2
    ranges:
      horizontal_distance: {start: 200 m, stop: 470 m}
      section_weight_2: {start: 100 N/m, stop: 900 N/m}
      rise: {start: -10 m, stop: 10 m}
fixed: {section_length: [400 m, 100 m], section_weight_1: 80 N/m}
methods:
  exact: {solver: composite_line}
outputs: [horizontal_tension, tension_A, tension_B, lowest_point]
"""
ALL_WAVES = {
    "ratios": "{start: 0.995, stop: 1.01, num: 16}",
    "stiffness": "{start: 1 MN, stop: 30 MN, num: 16, spacing: log}",
    "amplitudes": "{start: 0.2 m, stop: 2 m, num: 8}",
}
SOME_WAVES = ALL_WAVES | {"stiffness": "[2 MN, 8 MN]", "amplitudes": "[0.5 m, 1 m, 1.5 m]"}
SNAPS = {"ratios": "[1, 1.0005, 1.001]", "stiffness": "[8 MN, 16 MN]", "amplitudes": "[2 m, 3 m, 4 m]"}
# The studies of which the estimates are to be right, then others of which they should be too.
STUDIES: dict[str, tuple[str, ...]] = {
    "1,000,000 hanging lines, a map": (SPANS.format(rises=1000, spans=1000, outputs=HANGING),),
    "profiles of 20,000 hanging lines": (SPANS.format(rises=100, spans=200, outputs="max_tension, profile"),),
    "5,000 lines in a stream, two methods": (STREAM.format(number=5000, end="position_B: [10 m, 5 m, 30 m]"),),
    "2,048 lines in waves, slack and taut": (WAVES.format(**ALL_WAVES, options="segments: 20", outputs="steps"),),
    "histories of 96 lines in waves": (WAVES.format(**SOME_WAVES, options="", outputs="history, history_time"),),
    "12 scenes of 400 to 620 hanging lines": tuple(
        SPANS.format(rises=20, spans=20 + number, outputs=HANGING) for number in range(12)
    ),
    "2,250,000 spans by three formulas": (METHODS,),
    "300,000 tow lines": (TOW,),
    "100,000 lines from a force in a stream": (STREAM.format(number=100_000, end="force_A: [20 N, 5 N, 60 N]"),),
    "18 lines that snap, close steps": (WAVES.format(**SNAPS, options="segments: 40, rtol: 1e-4", outputs="steps"),),
    "96 lines in waves, leapfrog": (WAVES.format(**SOME_WAVES, options="integrator: leapfrog", outputs="steps"),),
}


@dataclass(frozen=True)
class Actual:
    """What a study took: of the clock, of processors, memory of its largest process, bytes of its results."""

    seconds: float
    processor_seconds: float
    memory_bytes: float
    disk_bytes: float


KINDS = {"seconds": (1.0, "s"), "processor_seconds": (1.0, "s"), "memory_bytes": (MB, "MB"), "disk_bytes": (MB, "MB")}


def make_study(folder: Path, scenes: tuple[str, ...]) -> Path:
    """A folder with the rules of the workflow and a study of these scenes."""
    (folder / "config" / "scenes").mkdir(parents=True)
    shutil.copy(PROJECT / "Snakefile", folder)
    shutil.copytree(PROJECT / "workflow", folder / "workflow")
    names = [f"scene_{number}" for number in range(len(scenes))]
    for name, scene in zip(names, scenes, strict=True):
        (folder / "config" / "scenes" / f"{name}.yaml").write_text(scene)
    config = folder / "config" / "config.yaml"
    config.write_text(f"study: measured\nscenes: [{', '.join(names)}]\n")
    return config


def run_study(folder: Path) -> Actual:
    """Run the study in a folder; processes that it waits for count in what the system says of it."""
    start = perf_counter()
    with (folder / "output").open("w") as output:
        process = subprocess.Popen(
            [sys.executable, "-m", "cablesim", "study"], cwd=folder, stdout=output, stderr=output
        )
        _, status, used = os.wait4(process.pid, 0)
    seconds = perf_counter() - start
    if os.waitstatus_to_exitcode(status) not in (0, 1):
        raise EnvironmentFault((folder / "output").read_text())
    disk = sum(path.stat().st_size for path in (folder / "results").rglob("*") if path.is_file())
    return Actual(seconds, used.ru_utime + used.ru_stime, used.ru_maxrss * 1024.0, disk)


def compare(folder: Path, scenes: tuple[str, ...]) -> tuple[Estimate, Actual]:
    """Estimate a study, then run it."""
    study = read_study(make_study(folder, scenes))
    estimate = estimate_study(study.scenes, Layout(folder / "results" / study.name), available_cores()).total
    return estimate, run_study(folder)


def cells(estimate: Estimate, actual: Actual) -> Iterable[str]:
    """Estimate, actual and their ratio, of each kind."""
    for kind, (unit, _) in KINDS.items():
        expected, took = getattr(estimate, kind), getattr(actual, kind)
        yield f"{expected / unit:.3g} / {took / unit:.3g} = {expected / took:.2f}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="Only studies with this in their name.")
    only = parser.parse_args().only
    rows = []
    for name, scenes in STUDIES.items():
        if only in name:
            with tempfile.TemporaryDirectory() as folder:
                rows.append((name, *cells(*compare(Path(folder) / "study", scenes))))
            print(*rows[-1], f"load {os.getloadavg()[0]:.1f}", sep="; ", file=sys.stderr, flush=True)
    print(machine("numpy", "netCDF4", "snakemake"), f"revision {revision()}", sep="; ", end="\n\n")
    heads = ("wall, s", "processors, s", "memory of the largest process, MB", "disk, MB")
    print(markdown(("estimate / actual = ratio", *heads), rows))


if __name__ == "__main__":
    main()
