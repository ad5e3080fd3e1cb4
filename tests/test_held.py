"""One run at a time in a folder, whoever it is; what a killed run has left is removed."""

import json
import os
import subprocess
import sys

import psutil
import pytest

from cablesim.errors import EnvironmentFault
from cablesim.held import HOLDER, MARK, held

HOLD = """
import sys, pathlib, cablesim.held
with cablesim.held.held(pathlib.Path(sys.argv[1])):
    print("held", flush=True)
    input()
"""


@pytest.fixture
def other(tmp_path):
    """Another process that works in the folder."""
    process = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(tmp_path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "held\n"
    yield process
    process.kill()
    process.communicate()


def test_who_comes_second_is_told_who_works_there_and_since_when(tmp_path, other):
    told = rf"process {other.pid} on {os.uname().nodename} has been at work here since \d{{4}}-\d\d-\d\d \d\d:\d\d:\d\d"
    with pytest.raises(EnvironmentFault, match=told), held(tmp_path):
        pass


def test_a_folder_is_free_again_when_its_holder_ends_or_is_killed(tmp_path, other):
    other.kill()
    other.communicate()
    assert (tmp_path / HOLDER).exists()
    with held(tmp_path):
        assert json.loads((tmp_path / HOLDER).read_text())["process"] == os.getpid()
    assert not (tmp_path / HOLDER).exists()
    with held(tmp_path):
        pass


@pytest.mark.parametrize("text", ["", "[]", "{", '{"process": "x"}'])
def test_a_spoilt_record_keeps_nobody_in_or_out(tmp_path, other, text):
    (tmp_path / HOLDER).write_text(text)
    with pytest.raises(EnvironmentFault, match="another process is at work here"), held(tmp_path):
        pass
    other.kill()
    other.communicate()
    (tmp_path / HOLDER).write_text(text)
    with held(tmp_path):
        pass


def test_jobs_and_halves_that_a_killed_run_has_left_are_removed_and_others_are_not(tmp_path):
    sleep = [sys.executable, "-c", "import time; time.sleep(60)"]
    mine, others = tmp_path / "mine", tmp_path / "others"
    orphan = subprocess.Popen(sleep, env={**os.environ, MARK: str(mine.resolve())})
    neighbour = subprocess.Popen(sleep, env={**os.environ, MARK: str(others.resolve())})
    mine.mkdir()
    # Marked as soon as it is another program than the one that started it.
    while MARK not in psutil.Process(orphan.pid).environ():
        pass
    left, at_work = mine / f".shard.nc.{2**22 + 1}.part", mine / f".shard.nc.{os.getpid()}.part"
    left.touch()
    at_work.touch()
    try:
        with held(mine):
            assert not psutil.pid_exists(orphan.pid)
            assert neighbour.poll() is None
            assert not left.exists()
            assert at_work.exists()
    finally:
        neighbour.kill()
        neighbour.wait()
        orphan.kill()
        orphan.wait()


def test_the_mark_is_in_the_environment_as_long_as_the_folder_is_held(tmp_path):
    with held(tmp_path):
        assert os.environ[MARK] == str(tmp_path.resolve())
    assert MARK not in os.environ
