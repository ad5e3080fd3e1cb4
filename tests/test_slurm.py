"""A study on a real Slurm with two virtual nodes, started here: the same bytes, failures, and jobs of a killed run."""

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from cablesim.cli import main
from cablesim.slurm import cancel_jobs, job_prefix
from tests.test_workflow import PROJECT, digests, make_project, replace, root_group

RECIPE = Path(__file__).with_name("slurm.sh")
PLUGIN = PROJECT / "requirements-slurm.lock"
# Long enough to be killed in the middle.
SLOW = """
title: Mooring lines
design:
  grid: {wave_period: {start: 4 s, stop: 9 s, num: 400}, length_ratio: [1.0, 1.0005, 1.001]}
fixed: {depth: 100 m, chord_angle: 45 deg, linear_stiffness: 10 MN, mass_per_length: 3, area: 3 cm^2,
        normal_drag: 15.6, tangential_drag: 0.78, added_mass_per_length: 0.4}
methods: {fine: {solver: wave_line, options: {segments: 40}}}
outputs: [max_top_tension]
"""


def installed() -> str:
    """Install Slurm where it is missing; why that cannot be, or nothing."""
    if os.getuid() != 0:
        return "only root can start Slurm"
    if shutil.which("slurmctld") is None:
        if shutil.which("apt-get") is None:
            return "Slurm is not installed, and there is no apt to install it"
        done = subprocess.run(["bash", RECIPE, "install"], capture_output=True, text=True, timeout=300, check=False)
        if done.returncode:
            return f"Slurm cannot be installed: {(done.stderr.strip().splitlines() or ['no reason given'])[-1]}"
    if subprocess.run(["pgrep", "-x", "slurmctld"], capture_output=True, check=False).returncode == 0:
        return "another Slurm is at work on this machine"
    return ""


@pytest.fixture(scope="module")
def slurm(tmp_path_factory) -> Iterator[dict[str, str]]:
    """Two nodes, and the environment of a study that finds Snakemake's plugin for them."""
    reason = installed()
    if reason:
        pytest.skip(reason)
    plugin = tmp_path_factory.mktemp("plugin")
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--require-hashes"]
    subprocess.run([*command, "--target", plugin, "-r", PLUGIN], check=True, capture_output=True, timeout=300)
    started = subprocess.run(["bash", RECIPE, "start"], capture_output=True, text=True, timeout=120, check=False)
    if started.returncode or started.stdout.count("idle") != 2:
        subprocess.run(["bash", RECIPE, "stop"], check=False)
        pytest.skip(f"Slurm does not start here: {started.stdout} {started.stderr}")
    yield {**os.environ, "PYTHONPATH": os.pathsep.join([str(plugin), os.environ.get("PYTHONPATH", "")])}
    subprocess.run(["bash", RECIPE, "stop"], check=False)


def project(folder: Path) -> Path:
    """A project whose profile for Slurm looks often whether jobs have ended."""
    folder.mkdir()
    made = make_project(folder)
    profile = made / "workflow" / "profiles" / "slurm" / "config.yaml"
    replace(profile, "checks: 5\nseconds-between-status-checks: 5", "checks: 1\nseconds-between-status-checks: 1")
    replace(profile, "mem_mb=2000", "mem_mb=500")
    return made


def study(folder: Path, environment: dict[str, str], profile: str = "slurm") -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "cablesim", "study", "--profile", profile]
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300, check=False
    )


def jobs(folder: Path) -> list[str]:
    """The jobs of a folder of results that are at work."""
    command = ["squeue", "--noheader", "--states=RUNNING", "--format=%i %j"]
    lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    return [line.split()[0] for line in lines if line.split()[1].startswith(job_prefix(folder / "results" / "small"))]


def same_results(one: Path, other: Path) -> bool:
    """Whether two studies have the same files with the same bytes, but for times."""
    mine, theirs = (digests(folder / "results" / "small") for folder in (one, other))
    timed = (".json", "_status.csv", "_status.md", ".log", "report.html")
    differ = {
        name
        for name in mine.keys() | theirs.keys()
        if mine.get(name) != theirs.get(name) and not name.endswith(timed) and not name.startswith((".", "stamps"))
    }
    datasets = {name for name in differ if name.endswith(".nc") and "/" not in name}
    return differ - {"catalogue.parquet"} == datasets and all(
        root_group(one / "results" / "small" / name) == root_group(other / "results" / "small" / name)
        for name in datasets
    )


def test_a_study_that_was_killed_on_slurm_ends_with_the_bytes_of_one_on_a_laptop(slurm, tmp_path):
    there, here = project(tmp_path / "there"), project(tmp_path / "here")
    for folder in (there, here):
        (folder / "config" / "scenes" / "limits.yaml").write_text(SLOW)
    command = [sys.executable, "-m", "cablesim", "study", "--profile", "slurm"]
    with (tmp_path / "log").open("w") as log:
        killed = subprocess.Popen(command, cwd=there, env=slurm, stdout=log, stderr=log, start_new_session=True)
        while killed.poll() is None and not jobs(there):
            time.sleep(0.1)
        os.killpg(killed.pid, signal.SIGKILL)
        killed.wait()
    left = jobs(there)
    assert left
    run = study(there, slurm)
    assert run.returncode == 1, run.stdout + run.stderr
    assert "has been submitted with SLURM jobid" in run.stderr
    # On this machine they can be ended as processes, too.
    assert " of a run that was killed are " in run.stderr
    assert not set(left) & set(jobs(there))
    assert study(here, slurm, profile="default").returncode == 1
    assert same_results(there, here)


def test_jobs_of_one_folder_are_cancelled_and_others_are_not(slurm, tmp_path):
    mine, others = (
        subprocess.run(
            [
                "sbatch",
                "--parsable",
                "--output=/dev/null",
                "--mem=100",
                f"--job-name={job_prefix(folder)}_1",
                "--wrap=sleep 300",
            ],
            check=True,
            capture_output=True,
            text=True,
        ).stdout.strip()
        for folder in (tmp_path / "mine", tmp_path / "others")
    )
    assert cancel_jobs(tmp_path / "mine") == 1
    left = subprocess.run(["squeue", "--noheader", "--format=%i"], capture_output=True, text=True, check=True).stdout
    assert others in left.split()
    assert mine not in left.split()
    assert cancel_jobs(tmp_path / "mine") == 0
    assert cancel_jobs(tmp_path / "others") == 1


def test_what_a_failing_job_says_is_the_end_of_the_study(slurm, tmp_path):
    made = project(tmp_path / "made")
    replace(made / "config" / "config.yaml", "[spans, limits]", "[spans]")
    (made / "results" / "small" / "shards").mkdir(parents=True)
    (made / "results" / "small" / "shards" / "spans").touch()
    run = study(made, slurm)
    assert run.returncode == 3
    assert "results/small/shards/spans" in run.stderr.strip().splitlines()[-1]


def test_without_slurm_or_its_plugin_the_study_says_so(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(project(tmp_path / "made"))
    assert main(["study", "--profile", "slurm"]) == 2
    assert "'make .venv/slurm' installs it" in capsys.readouterr().err
    monkeypatch.setattr("importlib.util.find_spec", lambda name: name)
    monkeypatch.setenv("PATH", "")
    assert main(["study", "--profile", "slurm"]) == 3
    assert "squeue: Slurm does not answer" in capsys.readouterr().err
