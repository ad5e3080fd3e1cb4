"""Queries and collecting on a Dask cluster of two worker processes on this machine, beside the same without.

The study of `database.py`, ten million scenarios, is asked by `cablesim query`; a million scenarios in a hundred and in
a thousand shards are joined by `cablesim step collect`. Each is a process of its own, and both ways must give the same
bytes. Scheduler, workers and caller share the cores of the machine: on a real cluster workers have their own.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median

from database import NAME, SCENE, STUDY, make_study, mebibytes
from distributed import LocalCluster
from measure import markdown, revision

from cablesim import shards
from cablesim.config.scene import read_scene
from cablesim.files import digest_of
from cablesim.machine import machine
from cablesim.steps import run_scene
from cablesim.study import Layout
from workflow import run_workflow

QUESTIONS = {
    "all with a largest tension of 50 to 51 kN": ("max_tension > 50 kN and max_tension < 51 kN",),
    "the ten slackest that hang no lower than 20 m": (
        "drop < 20 m",
        "--order-by",
        "length_ratio desc",
        "--limit",
        "10",
    ),
    "the ten that are first by a formula, of all": (
        "status == ok",
        "--order-by",
        "sqrt(abs(sag / span)) * log(max_tension / 1 N) desc",
        "--limit",
        "10",
    ),
    "all lines too short for their span, three columns, as CSV": (
        "status == infeasible",
        "--columns",
        "span,rise,length_ratio",
    ),
    "all that sag more than 40 m over four spans, as CSV": ("sag > 40 m and span > 150 m and span < 230 m",),
    "the same as JSON": ("sag > 40 m and span > 150 m and span < 230 m", "--format", "json"),
    "the same as Parquet": ("sag > 40 m and span > 150 m and span < 230 m", "--format", "parquet"),
}
TOLD = """
import json, re, sys, time
from pathlib import Path
start = time.perf_counter()
from cablesim.cli import main
code = main(sys.argv[1:])
# Not that of getrusage, which a process begins with that of whoever started it.
peak = 1024 * int(re.search(r"VmHWM:\\s+(\\d+)", Path("/proc/self/status").read_text())[1])
print(json.dumps({"code": code, "seconds": time.perf_counter() - start, "peak": peak}), file=sys.stderr)
"""


def told(arguments: tuple[str, ...]) -> dict[str, float]:
    """What a command took, as it tells itself."""
    command = [sys.executable, "-c", TOLD, *arguments]
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=True)
    return json.loads(done.stderr.splitlines()[-1])


def both(arguments: tuple[str, ...], address: str, made: Path, repeats: int) -> list[str]:
    """Seconds here and on the cluster in turns, their ratio, peak memory of the caller; the bytes must be the same."""
    runs: dict[tuple[str, ...], list[dict[str, float]]] = {(): [], ("--dask-address", address): []}
    digests = set()
    for _ in range(repeats):
        for where, costs in runs.items():
            made.unlink(missing_ok=True)
            costs.append(told((*arguments, *where)))
            digests.add(digest_of(made))
    assert len(digests) == 1, arguments
    here, there = ({key: median(cost[key] for cost in costs) for key in costs[0]} for costs in runs.values())
    return [
        f"{here['seconds']:.2f}",
        f"{there['seconds']:.2f}",
        f"{here['seconds'] / there['seconds']:.2f}",
        mebibytes(here["peak"]),
        mebibytes(there["peak"]),
    ]


def in_shards(folder: Path, number: int) -> Layout:
    """A million scenarios in so many shards."""
    (folder / f"{NAME}.yaml").write_text(SCENE.format(spans=20, rises=50, ratios=1000))
    shards.MOST_SCENARIOS = 1_000_000 // number
    layout = Layout(folder / f"in_{number}")
    run_scene(read_scene(folder / f"{NAME}.yaml"), layout, lambda step, done, total: None)
    return layout


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scale", type=float, default=1.0, help="part of ten million scenarios")
    parser.add_argument("--repeats", type=int, default=3)
    arguments = parser.parse_args()
    print(f"{machine('numpy', 'pandas', 'xarray', 'distributed')}; sources at revision {revision()}\n")
    local = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    with tempfile.TemporaryDirectory() as temporary, local:
        folder = Path(temporary)
        make_study(folder, arguments.scale)
        run_workflow(folder)
        rows = []
        for words, asked in QUESTIONS.items():
            made = folder / "answer"
            form = () if "--format" in asked else ("--format", "csv")
            query = ("query", str(folder / "results" / STUDY), NAME, *asked, *form, "--output", str(made))
            rows.append([words, *both(query, local.scheduler_address, made, arguments.repeats)])
        for number in (100, 1000):
            layout = in_shards(folder, number)
            collect = ("step", "collect", str(folder / f"{NAME}.yaml"), str(layout.root))
            found = len(list(layout.shards(NAME).glob("*.nc")))
            words = f"collecting {found} shards of a million scenarios"
            rows.append([words, *both(collect, local.scheduler_address, layout.dataset(NAME), arguments.repeats)])
        heads = ["", "s here", "s on the cluster", "times faster", "peak MiB here", "peak MiB of the caller"]
        print(markdown(heads, rows))


if __name__ == "__main__":
    main()
