"""What a study costs as it grows: the whole workflow at three sizes, and its parts at the largest.

The study has one scene: a grid of rises and spans, the exact catenary, eight outputs and a map. Its cost is taken as

    fixed + scenarios * cost of one

and both are told in units that every machine has: the fixed cost in imports of xarray, the cost of a scenario in single
writings of the same outputs with xarray, encoded as the database encodes them.
"""

import argparse
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr
from measure import Cost, Costs, interleaved, markdown, measure, revision

from cablesim import steps
from cablesim.config.scene import read_scene
from cablesim.database.reading import read_dataset
from cablesim.database.shard_file import chunk_sizes, solve_recipe, write_shard
from cablesim.machine import machine
from cablesim.shards import Recipe
from cablesim.study import Layout

PROJECT = Path(__file__).resolve().parents[1]
# Scenarios by size of the grid: rises times spans.
SIZES = {100_000: (250, 400), 1_000_000: (1000, 1000), 10_000_000: (2500, 4000)}
SMALL, MIDDLE, LARGE = SIZES
STUDY, NAME = "benchmark", "lines"
UNITS = IMPORT, WRITING = "import", "writing"
MICROSECOND = 1e-6
# The exit code of a study in which scenarios have no solution.
FLAGGED = 1
OUTPUTS = (
    "catenary_parameter",
    "horizontal_tension",
    "tension_A",
    "tension_B",
    "max_tension",
    "sag",
    "drop",
    "vertex_x",
)
ENCODING = {"zlib": True, "complevel": 1, "shuffle": True, "fletcher32": True}

SCENE = """\
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
  max_tension:
    kind: map
    x: span
    y: rise
    value: max_tension / (weight_per_length * line_length)
    log: value
    label: largest tension over weight of the line
"""

BARE, WHOLE = "shards solved in as many processes as cores", "the study"
# Mooring lines in waves: gentle ones; snap loads of the default study on a finer grid, and those of the full one.
GENTLE = """\
title: Ten thousand mooring lines in waves
design:
  grid:
    wave_period: {start: 4 s, stop: 12 s, num: 25}
    top_amplitude: {start: 0.2 m, stop: 2.1 m, num: 20}
    length_ratio: {start: 0.998, stop: 1.002, num: 20}
fixed: {depth: 200 m, chord_angle: 45 deg, linear_stiffness: 10 MN, mass_per_length: 3 kg/m, area: 3 cm^2,
        normal_drag: 15.6, tangential_drag: 0.78, added_mass_per_length: 0.4, fluid_density: 1025}
methods:
  moored: {solver: wave_line}
outputs: [max_top_tension, min_top_tension, mean_top_tension, slack_fraction, snap_count, max_strain, energy_error]
"""
SCENES = PROJECT / "config" / "scenes"
FINER = {"num: 21": "num: 100", "num: 15": "num: 50"}


def make_study(folder: Path, size: int) -> Path:
    """A folder with the rules of the workflow and a study of one scene."""
    folder.mkdir(parents=True)
    shutil.copy(PROJECT / "Snakefile", folder)
    shutil.copytree(PROJECT / "workflow", folder / "workflow")
    scenes = folder / "config" / "scenes"
    scenes.mkdir(parents=True)
    rises, spans = SIZES[size]
    (scenes / f"{NAME}.yaml").write_text(SCENE.format(rises=rises, spans=spans, outputs=", ".join(OUTPUTS)))
    (folder / "config" / "config.yaml").write_text(f"study: {STUDY}\nscenes: [{NAME}]\n")
    return folder


def run_workflow(folder: Path) -> None:
    """Run the study in a folder as a user would, with this Python first on the path."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    command = [sys.executable, "-m", "cablesim", "study"]
    done = subprocess.run(command, cwd=folder, env={**os.environ, "PATH": path}, capture_output=True, text=True)
    if done.returncode not in (0, FLAGGED):
        sys.exit(f"{done.stdout}{done.stderr}")


def run_new_study(folder: Path, size: int) -> None:
    """A study from nothing. What an earlier repeat has left is removed first, which takes no time to speak of."""
    shutil.rmtree(folder, ignore_errors=True)
    run_workflow(make_study(folder, size))


def import_xarray() -> None:
    subprocess.run([sys.executable, "-c", "import xarray"], check=True)


def write_once(outputs: xr.Dataset, path: Path) -> None:
    """The outputs of a scene in one file, as the database encodes them, and nothing else."""
    encoding = {name: {**ENCODING, "chunksizes": chunk_sizes(outputs[name].shape)} for name in OUTPUTS}
    outputs.to_netcdf(path, engine="netcdf4", encoding=encoding)


def whole_workflow(folder: Path, repeats: int) -> dict[str, Costs]:
    """The workflow at all sizes and both units, in turns."""
    # Once before anything counts: compiled modules, and the outputs that are written for the unit.
    run_new_study(folder / str(LARGE), LARGE)
    outputs = read_dataset(Layout(folder / str(LARGE) / "results" / STUDY).dataset(NAME))[list(OUTPUTS)].load()
    actions: dict[str, Callable[[], object]] = {}
    # Both units beside every size: they are short, and so measured three times as often.
    for size in SIZES:
        actions[f"{IMPORT} {size}"] = import_xarray
        actions[str(size)] = partial(run_new_study, folder / str(size), size)
        actions[f"{WRITING} {size}"] = partial(write_once, outputs, folder / "once.nc")
    costs = interleaved(actions, repeats)
    units = {unit: Costs(tuple(run for size in SIZES for run in costs.pop(f"{unit} {size}").runs)) for unit in UNITS}
    return costs | units


def parts(folder: Path) -> dict[str, Cost]:
    """The steps of the largest study in this process, one after the other."""
    scene, layout = read_scene(folder / "config" / "scenes" / f"{NAME}.yaml"), Layout(folder / "by_hand")
    costs = {"sample": measure(lambda: steps.sample(scene, layout))}
    plan = steps.sample(scene, layout)
    solving, writing, solved = [], [], {}
    for digest, recipe in plan.recipes.items():
        path = layout.shards(NAME) / f"{digest}.nc"
        solving.append(measure(lambda r=recipe: solved.update(results=solve_recipe(r))))
        writing.append(measure(lambda p=path, r=recipe: write_shard(p, r, solved["results"])))
    costs[f"solve {len(plan.recipes)} shards"], costs[f"write {len(plan.recipes)} shards"] = (
        _sum(solving),
        _sum(writing),
    )
    costs["collect"] = measure(lambda: steps.collect(scene, layout))
    costs["summarise"] = measure(lambda: steps.summarise(scene, layout))
    costs["figures"] = measure(lambda: steps.figures(scene, layout))
    return costs


def _sum(costs: list[Cost]) -> Cost:
    return Cost(sum(cost.wall for cost in costs), sum(cost.cpu for cost in costs))


def parts_in_turns(folder: Path, repeats: int) -> dict[str, Costs]:
    """The parts several times over, each time from nothing."""
    rounds = []
    for number in range(repeats):
        rounds.append(parts(make_study(folder / f"parts{number}", LARGE)))
        shutil.rmtree(folder / f"parts{number}")
    return {name: Costs(tuple(costs[name] for costs in rounds)) for name in rounds[0]}


# ---- dynamic scenarios ----


def dynamic_scenes() -> dict[str, str]:
    """Scene files of about ten thousand mooring lines."""
    snap_loads = (SCENES / "snap_loads.yaml").read_text(encoding="utf-8")
    for old, new in FINER.items():
        assert old in snap_loads, old
        snap_loads = snap_loads.replace(old, new)
    return {
        "10,000 gentle lines": GENTLE,
        "10,000 lines of `snap_loads`": snap_loads,
        "9,720 lines of `snap_loads_full`": (SCENES / "snap_loads_full.yaml").read_text(encoding="utf-8"),
    }


def dynamic_overhead(folder: Path, scene: str, repeats: int) -> dict[str, Costs]:
    """A study of mooring lines in waves, and the same shards solved by as many processes, nothing else."""
    shutil.rmtree(folder, ignore_errors=True)
    path = make_study(folder, SMALL) / "config" / "scenes" / f"{NAME}.yaml"
    path.write_text(scene)
    plan = steps.sample(read_scene(path), Layout(folder / "planned"))
    recipes = sorted(plan.recipes.values(), key=lambda recipe: -recipe.expected_seconds)

    def workflow() -> None:
        shutil.rmtree(folder / "results", ignore_errors=True)
        run_workflow(folder)

    with ProcessPoolExecutor(os.cpu_count(), initializer=solve_recipe, initargs=(_first_scenario(recipes[0]),)) as pool:
        # Every process has loaded its kernels before anything counts.
        list(pool.map(solve_recipe, [_first_scenario(recipes[0])] * 8))
        return interleaved({BARE: lambda: list(pool.map(_solve, recipes)), WHOLE: workflow}, repeats)


def _solve(recipe: Recipe) -> float:
    return solve_recipe(recipe).seconds


def _first_scenario(recipe: Recipe) -> Recipe:
    return replace(recipe, axes=tuple(axis.take(np.array([0])) for axis in recipe.axes))


def dynamic_summary(found: dict[str, dict[str, Costs]]) -> str:
    """The part of a study's time that is not solving."""
    rows = []
    for name, costs in found.items():
        shares = [1.0 - bare.wall / whole.wall for bare, whole in zip(costs[BARE].runs, costs[WHOLE].runs, strict=True)]
        overhead = f"{statistics.median(shares):.1%} ({min(shares):.1%} .. {max(shares):.1%})"
        rows.append((name, costs[BARE].spread(1.0), costs[WHOLE].spread(1.0), overhead))
    return markdown(("", f"{BARE}, wall s", f"{WHOLE}, wall s", "(study - bare) / study; aim: under 15 %"), rows)


# ---- tables ----


def slope(costs: dict[str, Costs], kind: str) -> float:
    """Seconds for one scenario more, between the two larger sizes."""
    more = getattr(costs[str(LARGE)], kind) - getattr(costs[str(MIDDLE)], kind)
    return more / (LARGE - MIDDLE)


def summary(costs: dict[str, Costs]) -> str:
    """Fixed cost and cost of a scenario, in seconds and in their units."""
    rows = []
    for kind, label in (("wall", "wall time"), ("cpu", "processor time")):
        each, once = slope(costs, kind), getattr(costs[WRITING], kind) / LARGE
        fixed, unit = getattr(costs[str(SMALL)], kind) - SMALL * each, getattr(costs[IMPORT], kind)
        rows += [
            (f"fixed, {label}", f"{fixed:.2f} s", f"{fixed / unit:.1f} imports of xarray ({unit:.3f} s)", "20"),
            (
                f"for each scenario, {label}",
                f"{each / MICROSECOND:.2f} µs",
                f"{each / once:.1f} writings of its outputs ({once / MICROSECOND:.2f} µs)",
                "3",
            ),
        ]
    return markdown(("", "measured", "in units", "aim: at most"), rows)


def table(costs: dict[str, Costs], of: float | None = None) -> str:
    """Wall and processor time of each, with the share of the total where one is given."""
    rows = [
        (name, costs[name].spread(1.0), f"{costs[name].cpu:.3g}", *([f"{costs[name].cpu / of:.0%}"] if of else []))
        for name in costs
    ]
    return markdown(("", "wall s: median (min .. max)", "processor s", *(["share"] if of else [])), rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--repeats", type=int, default=3)
    repeats = parser.parse_args().repeats
    with tempfile.TemporaryDirectory() as name:
        dynamic = {
            told: dynamic_overhead(Path(name) / "dynamic", scene, repeats) for told, scene in dynamic_scenes().items()
        }
        costs = whole_workflow(Path(name), repeats)
        by_hand = parts_in_turns(Path(name), repeats)
    packages = ("numpy", "xarray", "netCDF4", "snakemake")
    print(machine(*packages), f"revision {revision()}, {repeats} repeats in turns", sep="; ", end="\n\n")
    labels = {str(size): f"workflow, {size} scenarios" for size in SIZES}
    labels |= {IMPORT: "python -c 'import xarray'", WRITING: f"writing the outputs of {LARGE} scenarios once"}
    print(table({label: costs[name] for name, label in labels.items()}), end="\n\n")
    print(summary(costs), f"The parts, by hand, {LARGE} scenarios:", sep="\n\n", end="\n\n")
    print(table(by_hand, sum(cost.cpu for cost in by_hand.values())), end="\n\n")
    print(dynamic_summary(dynamic))


if __name__ == "__main__":
    main()
