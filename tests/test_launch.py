"""`cablesim study`: what it refuses, and what it says of steps that failed."""

import logging
import signal
import subprocess
import sys

import pytest

from cablesim.cli import main
from cablesim.errors import EnvironmentFault
from cablesim.launch import StepFailed, _Failures
from tests.test_workflow import make_project, replace


def record(message: str, level: int = logging.ERROR, **more: object) -> logging.LogRecord:
    return logging.makeLogRecord({"msg": message, "levelno": level, **more})


@pytest.fixture
def heard() -> _Failures:
    return _Failures()


@pytest.fixture
def project(tmp_path, monkeypatch):
    monkeypatch.chdir(make_project(tmp_path))
    return tmp_path


def test_the_last_line_of_a_failed_step_is_repeated_with_its_exit_code(heard, tmp_path):
    log = tmp_path / "solve.log"
    log.write_text("something\ncablesim: results/x.nc: cannot be written (100 bytes were) (exit code 3)\n")
    assert heard.filter(record("Error in rule solve", log=[str(log)]))
    told = heard.gravest()
    assert isinstance(told, StepFailed)
    assert (told.exit_code, str(told)) == (3, "results/x.nc: cannot be written (100 bytes were)")


def test_the_gravest_of_several_is_told(heard, tmp_path):
    for code in (2, 4, 3):
        (tmp_path / f"{code}.log").write_text(f"cablesim: {code} (exit code {code})\n")
        heard.filter(record("Error in rule", log=[str(tmp_path / f"{code}.log")]))
    assert (heard.gravest().exit_code, str(heard.gravest())) == (4, "4 (and 2 more)")


def test_without_a_log_the_exit_status_is_what_is_known(heard):
    heard.filter(record("CalledProcessError in file x: Command 'y' returned non-zero exit status 3."))
    assert heard.gravest().exit_code == 3


@pytest.mark.parametrize("how", ["returned non-zero exit status 137.", "died with <Signals.SIGKILL: 9>."])
def test_a_step_that_was_killed_is_the_machines_fault(heard, how):
    heard.filter(record(f"CalledProcessError in file x: Command 'y' {how}"))
    assert isinstance(heard.gravest(), EnvironmentFault)
    assert "was killed" in str(heard.gravest())


def test_a_study_that_is_interrupted_says_so(project):
    command = [sys.executable, "-m", "cablesim", "study"]
    run = subprocess.Popen(
        command, cwd=project, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    while "Execute" not in run.stderr.readline():
        pass
    run.send_signal(signal.SIGTERM)
    last = run.communicate(timeout=120)[1].strip().splitlines()[-1]
    assert (run.returncode, last) == (130, "cablesim: interrupted; the same command goes on with it")


def test_tracebacks_of_snakemake_about_the_machine_become_a_line(heard):
    assert not heard.filter(record("Traceback ...\nOSError: [Errno 28] No space left on device: '/nowhere/x'"))
    told = heard.gravest()
    assert isinstance(told, EnvironmentFault)
    assert str(told).startswith("/nowhere/x: No space left on device, free ")


def test_what_is_no_error_is_let_through(heard):
    assert heard.filter(record("Permission denied is a good title", level=logging.INFO))
    assert not heard.machine


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["nowhere.yaml"], "nowhere.yaml"),
        (["--profile", "cloud"], "workflow/profiles/cloud/config.yaml: no such file"),
        (["--profile", "../../.."], "config.yaml: no such file"),
        (["--cores", "0"], "--cores must be a number of cores or 'all', not '0'"),
        (["--cores", "many"], "not 'many'"),
    ],
)
def test_a_wrong_request_is_refused_and_nothing_is_written(project, arguments, told, capsys):
    before = sorted(project.rglob("*"))
    assert main(["study", *arguments]) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1
    assert sorted(project.rglob("*")) == before


def test_a_wrong_scene_is_told_before_anything_is_started(project, capsys):
    replace(project / "config" / "scenes" / "spans.yaml", "5 N/m", "5 N")
    assert main(["study"]) == 2
    told = "cablesim: config/scenes/spans.yaml:7: fixed.weight_per_length: the unit 'N' is of another dimension"
    assert capsys.readouterr().err.startswith(told)
    assert not (project / "results").exists()


def test_outside_of_a_project_the_missing_file_is_named(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["study"]) == 2
    assert "Snakefile: no such file" in capsys.readouterr().err


def test_the_scheduler_leaves_no_timer_that_the_process_would_wait_for(project):
    program = """
import sys, threading
from cablesim.cli import main
main(["study"])
sys.exit(7 if any(timer.is_alive() and not timer.finished.is_set() for timer in threading.enumerate()
                  if isinstance(timer, threading.Timer)) else 0)
"""
    run = subprocess.run([sys.executable, "-c", program], cwd=project, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr


def test_a_study_tells_how_many_scenarios_met_which_fate(project):
    def study(*arguments: str) -> subprocess.CompletedProcess:
        command = [sys.executable, "-m", "cablesim", "study", *arguments]
        return subprocess.run(command, cwd=project, capture_output=True, text=True, check=False)

    dry = study("--dry-run")
    assert dry.returncode == 0
    assert "solve" in dry.stderr + dry.stdout
    assert not (project / "results" / "small" / "shards").exists()
    run = study("--cores", "2")
    assert run.returncode == 1, run.stderr
    lines = run.stdout.strip().splitlines()
    assert lines[0] == "results/small: 2 scenes, 20 scenarios"
    assert [line.split("|")[1:4] for line in lines[3:]] == [
        [" ok         ", "          14 ", " spans, limits     "],
        [" infeasible ", "           6 ", " spans             "],
    ]
    again = study()
    assert again.returncode == 1
    assert "Nothing to be done" in again.stderr
