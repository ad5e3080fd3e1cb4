"""Files appear whole or not at all, and damage is found."""

import os
import subprocess
import sys
import textwrap

import pytest

from cablesim.errors import EnvironmentFault
from cablesim.files import Condition, check, discard, enter_in_ledger, ledger, written_whole


def test_a_file_appears_when_its_writing_ends(tmp_path):
    path = tmp_path / "deep" / "file.txt"
    with written_whole(path) as temporary:
        temporary.write_text("whole")
        assert not path.exists()
    assert path.read_text() == "whole"
    assert list(path.parent.iterdir()) == [path]


def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path):
    path = tmp_path / "file.txt"
    path.write_text("old")
    with pytest.raises(ZeroDivisionError), written_whole(path) as temporary:
        temporary.write_text("half")
        raise ZeroDivisionError
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_writer_killed_in_the_middle_leaves_no_file(tmp_path):
    script = """
        import os, sys
        from pathlib import Path
        from cablesim.files import written_whole
        with written_whole(Path("file.txt")) as temporary:
            temporary.write_text("half")
            os.kill(os.getpid(), 9)
    """
    killed = subprocess.run([sys.executable, "-c", textwrap.dedent(script)], cwd=tmp_path, check=False)
    assert killed.returncode == -9
    assert not (tmp_path / "file.txt").exists()


def test_a_full_disk_is_the_machines_fault_and_names_the_path(tmp_path):
    path = tmp_path / "file.txt"
    with pytest.raises(EnvironmentFault, match=r"file\.txt: cannot be written \(No space left"), written_whole(path):
        raise OSError(28, os.strerror(28))


@pytest.fixture
def shard(tmp_path):
    """A file that is whole."""
    path = tmp_path / "shard.nc"
    path.write_bytes(b"results")
    enter_in_ledger(path, seconds=1.5)
    assert check(path).whole
    assert check(path).seconds == 1.5
    return path


@pytest.mark.parametrize("where", [0, 3, -1])
def test_a_flipped_bit_is_found(shard, where):
    data = bytearray(shard.read_bytes())
    data[where] ^= 4
    shard.write_bytes(data)
    assert check(shard).condition is Condition.damaged


def test_a_file_without_a_ledger_was_never_finished(shard):
    ledger(shard).unlink()
    assert check(shard).condition is Condition.unfinished


def test_a_file_that_is_gone_is_missing(shard):
    shard.unlink()
    assert check(shard).condition is Condition.missing


def test_a_file_in_the_place_of_another_is_foreign_although_its_ledger_came_along(shard):
    other = shard.with_name("other.nc")
    shard.rename(other)
    ledger(shard).rename(ledger(other))
    assert check(other).condition is Condition.foreign


def test_a_file_that_waits_for_more_is_partial(shard):
    enter_in_ledger(shard, complete=False)
    assert check(shard).condition is Condition.partial


@pytest.mark.parametrize("text", ["[]", "", "{}", '{"sha256": 1}', "\x00"])
def test_a_spoilt_ledger_vouches_for_nothing(shard, text):
    ledger(shard).write_text(text)
    assert check(shard).condition is Condition.damaged


def test_a_discarded_file_takes_its_ledger_along(shard):
    discard(shard)
    assert list(shard.parent.iterdir()) == []
