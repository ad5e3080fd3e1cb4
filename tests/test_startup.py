"""Heavy libraries are imported where they are used, so that a small question gets its answer at once."""

import json
import subprocess
import sys

import pytest

HEAVY = {"numpy", "scipy", "pandas", "xarray", "dask", "netCDF4", "matplotlib", "pint", "snakemake", "pyarrow"}
PROBE = """
import json, sys
from cablesim.cli import main
code = main(sys.argv[1:])
print(json.dumps({"code": code, "modules": [name for name in sys.modules if "." not in name]}))
"""


def imported(*arguments: str) -> set[str]:
    """Which heavy libraries a command imports."""
    run = subprocess.run([sys.executable, "-c", PROBE, *arguments], capture_output=True, text=True, check=True)
    said = json.loads(run.stdout.splitlines()[-1])
    assert said["code"] in (0, 2)
    return HEAVY & set(said["modules"])


def test_help_imports_nothing_heavy():
    assert imported("--help") == set()


def test_a_single_line_in_si_needs_numpy_alone():
    assert imported("solve", "catenary_exact", "span=2.5", "line_length=3", "weight_per_length=3") == {"numpy"}


def test_a_shard_needs_neither_labels_nor_units(tmp_path):
    from cablesim.config.scene import read_scene
    from cablesim.steps import sample
    from cablesim.study import Layout

    scene = tmp_path / "lines.yaml"
    scene.write_text(
        "title: One line\ndesign: {cases: [{span: 10, line_length: 11}]}\nfixed: {weight_per_length: 1}\n"
        "methods: {exact: {solver: catenary_exact}}\noutputs: [sag]\n"
    )
    layout = Layout(tmp_path / "results")
    plan = sample(read_scene(scene), layout)
    shard = next(iter(plan.recipes))
    found = imported("step", "solve", str(layout.plan(plan)), str(tmp_path), shard)
    assert (tmp_path / f"{shard}.nc").exists()
    assert found <= {"numpy", "netCDF4"}


@pytest.mark.parametrize("command", ["solvers", "describe"])
def test_lists_and_descriptions_import_no_database(command):
    arguments = ("describe", "catenary_exact") if command == "describe" else (command,)
    assert not imported(*arguments) & {"xarray", "dask", "pandas", "matplotlib", "snakemake"}
