"""A cluster of a hundred nodes on paper: what a study of a million scenarios asks of files, graph and scheduler.

Measured here: reading, planning and drawing the graph of studies of growing numbers of jobs, without solving anything.
From the law of that, and from what a job costs on Slurm, a simulation tells how long a hundred nodes take.
"""

import argparse
import heapq
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np
from measure import markdown, revision

from cablesim.config.scene import read_scene
from cablesim.machine import machine
from cablesim.plan import ScenePlan, make_plan
from workflow import NAME, SMALL, STUDY, make_study


@dataclass(frozen=True)
class Cluster:
    """Nodes, each with cores, and what a job costs on Slurm beside its work.

    `submit`: a call of sbatch, one after the other. `start`: from there to the first scenario (queue, Python, Snakemake
    on the node). `seen`: until its end is noticed. Measured with a study of 16 jobs on two virtual nodes of one core
    and the profile as it is: seven jobs were submitted within a second; those of next to no work took 6 s, those of
    18 s of work 20 to 26 s; and 2 to 14 s after their end those were submitted that had waited for them.
    """

    nodes: int = 100
    cores: int = 32
    submit: float = 0.1
    start: float = 6.0
    seen: float = 8.0


# What stays on disk: of each shard data and ledger, of each job stamp and log; of each Slurm job its own log.
FILES_PER_SHARD, FILES_PER_JOB = 2, 3
# Collecting: seconds for a shard and for a scenario (benchmarks/cluster.py).
COLLECT_SHARD, COLLECT_SCENARIO = 0.002, 1.8e-6
# Steps after solving: collect, then tables and figures beside each other, then the catalogue.
LAST_STEPS = 3

SCENES = {
    "static, 1e6": """\
title: Tow lines between two ends in a stream
design:
  grid:
    stream_speed: {{start: 0.1 m/s, stop: 3 m/s, num: 1000}}
    line_length: {{start: 101 m, stop: 200 m, num: {num}}}
fixed: {{position_B: [60 m, 0 m, 80 m], weight_per_length: 5, diameter: 10 mm, normal_drag_coefficient: 1.2,
        tangential_drag_coefficient: 0.03, fluid_density: 1025}}
methods: {{stream: {{solver: stream_line}}}}
outputs: [tension_A, tension_B, max_tension]
""",
    "dynamic, 1e5": """\
title: Mooring lines in waves
design:
  grid:
    wave_period: {{start: 4 s, stop: 12 s, num: {num}}}
    top_amplitude: {{start: 0.2 m, stop: 2.1 m, num: 100}}
    linear_stiffness: {{start: 1 MN, stop: 100 MN, num: 100}}
fixed: {{depth: 200 m, chord_angle: 45 deg, length_ratio: 1.0005, mass_per_length: 3 kg/m, area: 3 cm^2,
        normal_drag: 15.6, tangential_drag: 0.78, added_mass_per_length: 0.4, fluid_density: 1025}}
methods: {{moored: {{solver: wave_line}}}}
outputs: [max_top_tension, min_top_tension, slack_fraction]
""",
}
# What the design's `num` is for the studies of the question, and for those that show the growth of the graph.
ASKED = {"static, 1e6": 1000, "dynamic, 1e5": 10}
GROWTH = (2, 20, 200, 2000)


def scene_file(folder: Path, name: str, num: int) -> Path:
    """The scene in a new study of its own."""
    make_study(folder, SMALL)
    path = folder / "config" / "scenes" / f"{NAME}.yaml"
    path.write_text(SCENES[name].format(num=num))
    return path


def plan_of(path: Path) -> ScenePlan:
    """The plan of a scene in its study, from there if it is there."""
    return make_plan(read_scene(path), path.parents[2] / "results" / STUDY / "plans")


def dry_run(folder: Path) -> tuple[float, float]:
    """Seconds and MiB of a process that reads, plans and draws the graph of a study."""
    start = perf_counter()
    command = [sys.executable, "-m", "cablesim", "study", "--dry-run"]
    child = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        sys.exit(f"{folder}: the dry run ended with {child.returncode}")
    return perf_counter() - start, usage.ru_maxrss / 1024


def growth(folder: Path) -> list[tuple[int, int, float, float]]:
    """Scenarios, jobs, seconds and MiB of dynamic studies of growing size: the first dry run, which plans them, too."""
    found = []
    for num in GROWTH:
        path = scene_file(folder / str(num), "dynamic, 1e5", num)
        seconds, size = dry_run(folder / str(num))
        plan = plan_of(path)
        found.append((plan.scenarios, len(plan.bundles), seconds, size))
    return found


def makespan(seconds: Sequence[float], cluster: Cluster) -> float:
    """When the last job's end is seen: jobs are submitted one after the other and go to the core that is free first."""
    free = [0.0] * (cluster.nodes * cluster.cores)
    last = 0.0
    for number, work in enumerate(seconds):
        begin = max((number + 1) * cluster.submit, heapq.heappop(free))
        end = begin + cluster.start + work
        heapq.heappush(free, end)
        last = max(last, end + cluster.seen)
    return last


def forecast(plan: ScenePlan, graph: float, cluster: Cluster) -> tuple[str, ...]:
    """A row: what a study asks of a cluster, and how long it takes there; `graph` is the scheduler's time for it."""
    work = [sum(plan.recipes[shard].seconds for shard in shards) for shards in plan.bundles.values()]
    files = FILES_PER_SHARD * len(plan.recipes) + FILES_PER_JOB * len(work)
    solving = makespan(work, cluster)
    collecting = COLLECT_SHARD * len(plan.recipes) + COLLECT_SCENARIO * plan.scenarios
    after = LAST_STEPS * (cluster.submit + cluster.start + cluster.seen)
    cells = (plan.scenarios, len(plan.recipes), len(work), files, sum(work), graph, solving, collecting + after)
    total = graph + solving + collecting + after
    return (*(f"{cell:,.0f}" for cell in cells), f"{total:,.0f}", f"{sum(work) / 2 + 8:,.0f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.parse_args()
    cluster = Cluster()
    with tempfile.TemporaryDirectory() as name:
        grown = growth(Path(name))
        plans = {asked: plan_of(scene_file(Path(name) / asked[:3], asked, num)) for asked, num in ASKED.items()}
        plans["dynamic, 1e7"] = plan_of(scene_file(Path(name) / "large", "dynamic, 1e5", 1000))
    jobs, taken = (np.array([row[column] for row in grown], dtype=float) for column in (1, 2))
    each, fixed = np.polyfit(jobs, taken, 1)
    print(machine("snakemake"), f"revision {revision()}", sep="; ", end="\n\n")
    head = ("scenarios", "jobs", "s to read, plan and draw the graph", "MiB")
    print(markdown(head, [(f"{s:,}", f"{j:,}", f"{t:.1f}", f"{m:.0f}") for s, j, t, m in grown]), end="\n\n")
    print(f"Law: {fixed:.1f} s + {1e3 * each:.1f} ms for each job.", end="\n\n")
    print(f"{cluster.nodes} nodes of {cluster.cores} cores, simulated (seconds):", end="\n\n")
    head = (
        "study",
        "scenarios",
        "shards",
        "jobs",
        "files",
        "core s",
        "graph",
        "solve",
        "rest",
        "in all",
        "two cores here",
    )
    rows = [(name, *forecast(plan, fixed + each * len(plan.bundles), cluster)) for name, plan in plans.items()]
    print(markdown(head, rows))


if __name__ == "__main__":
    main()
