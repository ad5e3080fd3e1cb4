"""A study of ten million scenarios: its size, its making, and five questions, asked of the database and of a CSV file.

Every question is asked in a process of its own, which tells the time of the question and its peak memory. The other
route is what people do without a database: all scenarios in one CSV file, read by pandas and filtered there.
"""

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from statistics import median

from measure import markdown, measure, revision

from cablesim.machine import machine
from workflow import run_workflow

PROJECT = Path(__file__).resolve().parents[1]
STUDY, NAME = "benchmark", "spans"
SCENE = """\
title: Ten million spans
design:
  grid:
    span: {{start: 20 m, stop: 400 m, num: {spans}}}
    rise: {{start: 0 m, stop: 19 m, num: {rises}}}
    length_ratio: {{start: 1.001, stop: 1.4, num: {ratios}}}
fixed: {{weight_per_length: 12 N/m}}
methods:
  exact: {{solver: catenary_exact}}
outputs: [sag, drop, horizontal_tension, max_tension, vertex_x]
"""
# What is asked, of an open study and of a table in memory.
QUESTIONS = {
    "one scenario: span 200 m, rise 9.5 m, length ratio nearest to 1.2": (
        'found = study.query("spans", "span == 200 m", nearest={"rise": "9.5 m", "length_ratio": 1.2})',
        "near = table[table.span == 200]\n"
        "near = near[(near.rise - 9.5).abs() == (near.rise - 9.5).abs().min()]\n"
        "found = near[(near.length_ratio - 1.2).abs() == (near.length_ratio - 1.2).abs().min()]",
    ),
    "all scenarios with a largest tension of 50 to 51 kN": (
        'found = study.query("spans", "max_tension > 50 kN and max_tension < 51 kN")',
        "found = table[(table.max_tension > 50e3) & (table.max_tension < 51e3)]",
    ),
    "the ten slackest lines that hang no lower than 20 m": (
        'found = study.query("spans", "drop < 20 m", order_by="length_ratio desc", limit=10)',
        'found = table[table["drop"] < 20].sort_values("length_ratio", ascending=False, kind="stable").head(10)',
    ),
    "mean sag by span": (
        'found = study["spans"].sag.groupby("span").mean(...).compute()',
        'found = table.groupby("span").sag.mean()',
    ),
    "all lines too short for their span, into a CSV file": (
        'found = study.query("spans", "status == infeasible", columns=["span", "rise", "length_ratio"])\n'
        'found.to_csv("short.csv", index=False)',
        'found = table.loc[table.status == "infeasible", ["span", "rise", "length_ratio"]]\n'
        'found.to_csv("short.csv", index=False)',
    ),
}
OPEN = """
from cablesim import open_study
study = open_study({results!r})
study.catalogue
"""
READ = """
import pandas as pd
table = pd.read_csv({csv!r})
"""
ASKED = """
import json, resource, time
start = time.perf_counter()
{opening}
opened = time.perf_counter()
{question}
done = time.perf_counter()
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
print(json.dumps({{"opening": opened - start, "asking": done - opened, "peak": peak, "rows": len(found)}}))
"""


def make_study(folder: Path, scale: float) -> None:
    """A folder with the rules of the workflow and a study of one scene."""
    shutil.copy(PROJECT / "Snakefile", folder)
    shutil.copytree(PROJECT / "workflow", folder / "workflow")
    (folder / "config" / "scenes").mkdir(parents=True)
    sizes = {"spans": max(2, round(20 * scale)), "rises": 501, "ratios": 1000}
    (folder / "config" / "scenes" / f"{NAME}.yaml").write_text(SCENE.format(**sizes))
    (folder / "config" / "config.yaml").write_text(f"study: {STUDY}\nscenes: [{NAME}]\n")


def ask(opening: str, question: str, folder: Path, repeats: int) -> dict[str, float]:
    """Medians of what processes of their own tell of a question."""
    script = ASKED.format(opening=opening, question=question)
    told = []
    for _ in range(repeats):
        done = subprocess.run([sys.executable, "-c", script], cwd=folder, capture_output=True, text=True, check=True)
        told.append(json.loads(done.stdout))
    return {key: median(one[key] for one in told) for key in told[0]}


def size_of(*paths: Path) -> float:
    """Megabytes of files and folders."""
    files = [file for path in paths for file in ([path] if path.is_file() else path.rglob("*")) if file.is_file()]
    return sum(file.stat().st_size for file in files) / 1e6


def mebibytes(size: float) -> str:
    return f"{size / 2**20:.0f}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scale", type=float, default=1.0, help="part of ten million scenarios")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--folder", type=Path, help="where to work; some gigabytes (default: a temporary folder)")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=arguments.folder) as temporary:
        folder = Path(temporary)
        make_study(folder, arguments.scale)
        print(f"{machine('numpy', 'pandas', 'xarray', 'netCDF4')}; sources at revision {revision()}\n")
        seconds = measure(lambda: run_workflow(folder)).wall
        peak = getrusage(RUSAGE_CHILDREN).ru_maxrss * 1024
        results, csv = folder / "results" / STUDY, folder / "all.csv"
        export = ["-m", "cablesim", "query", str(results), NAME, "--format", "csv", "--no-units", "--output", str(csv)]
        exported = measure(lambda: subprocess.run([sys.executable, *export], check=True)).wall
        print(f"- the study, from nothing: {seconds:.0f} s, {mebibytes(peak)} MiB in its largest process")
        print(f"- dataset {size_of(results / f'{NAME}.nc'):.0f} MB, shards {size_of(results / 'shards'):.0f} MB")
        print(f"- CSV of all scenarios: {size_of(csv):.0f} MB, written by `cablesim query` in {exported:.0f} s")
        opening, reading = OPEN.format(results=str(results)), READ.format(csv=str(csv))
        bare = ask(opening, "found = study", folder, arguments.repeats)
        print(f"- opening the study with its catalogue, imports included: {bare['opening']:.2f} s\n")
        rows = []
        for words, (ours, theirs) in QUESTIONS.items():
            a = ask(opening, ours, folder, arguments.repeats)
            b = ask(reading, theirs, folder, 1)
            assert a["rows"] == b["rows"], (words, a, b)
            rows.append(
                [
                    words,
                    f"{a['rows']:.0f}",
                    f"{a['asking']:.2f}",
                    mebibytes(a["peak"]),
                    f"{b['opening']:.1f} + {b['asking']:.2f}",
                    mebibytes(b["peak"]),
                    f"{(b['opening'] + b['asking']) / (a['opening'] + a['asking']):.0f}",
                ]
            )
        heads = [
            "question",
            "rows",
            "s",
            "peak MiB",
            "CSV: read + ask, s",
            "CSV: peak MiB",
            "times faster, from nothing",
        ]
        print(markdown(heads, rows))


if __name__ == "__main__":
    main()
