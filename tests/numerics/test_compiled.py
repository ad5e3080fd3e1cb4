"""Compiled kernels are kept in a folder that is named by the sources that they come from."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from cablesim.numerics import compiled as module
from cablesim.numerics.compiled import PACKAGE, cache_folder, compiled


@pytest.fixture
def sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the package that `cache_folder` reads, with the cache in another folder."""
    copy = tmp_path / "cablesim"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(module, "PACKAGE", copy)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    return copy


def test_the_same_sources_have_the_same_folder_and_it_exists(sources: Path, tmp_path: Path) -> None:
    folder = cache_folder()
    assert folder == cache_folder() and folder.is_dir()
    assert folder.parent == tmp_path / "cache"


@pytest.mark.parametrize("file", ["numerics/dop853.py", "physics/stream.py", "solvers/stream_line.py"])
def test_a_changed_source_of_numbers_has_another_folder(file: str, sources: Path) -> None:
    before = cache_folder()
    path = sources / file
    path.write_text(path.read_text() + "\n# changed\n")
    assert cache_folder() != before


def test_a_new_source_and_a_renamed_one_have_another_folder(sources: Path) -> None:
    folders = [cache_folder()]
    (sources / "physics" / "new.py").write_text("")
    folders.append(cache_folder())
    (sources / "physics" / "new.py").rename(sources / "physics" / "newer.py")
    folders.append(cache_folder())
    assert len(set(folders)) == 3


def test_a_source_without_numbers_does_not_count(sources: Path) -> None:
    before = cache_folder()
    for file in ("cli.py", "report/tables.py"):
        path = sources / file
        path.write_text(path.read_text() + "\n# changed\n")
    assert cache_folder() == before


def test_a_place_that_cannot_be_written_is_replaced_by_a_temporary_one(
    sources: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    named = cache_folder().name
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file" / "cache"))
    monkeypatch.setattr(module.tempfile, "gettempdir", lambda: str(tmp_path / "elsewhere"))
    assert cache_folder() == tmp_path / "elsewhere" / f"cablesim-{os.getuid()}" / named


def test_a_temporary_folder_that_others_may_write_to_is_not_used(
    sources: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file" / "cache"))
    monkeypatch.setattr(module.tempfile, "gettempdir", lambda: str(tmp_path))
    planted = tmp_path / f"cablesim-{os.getuid()}"
    planted.mkdir()
    planted.chmod(0o777)
    chosen = cache_folder().parent
    assert chosen != planted
    assert chosen.stat().st_mode & 0o077 == 0


def test_kernels_are_written_to_the_folder_of_their_sources(tmp_path: Path) -> None:
    """In a process of its own: the folder is chosen where the module is first imported."""
    program = "from cablesim.solvers import _pode_march as m; import numpy as n; m.logits(n.ones(1), n.zeros(1))"
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    subprocess.run([sys.executable, "-c", program], env=environment, cwd=PACKAGE.parent, check=True, timeout=120)
    (folder,) = tmp_path.iterdir()
    assert len(folder.name) == 16
    assert any("_logits" in path.name for path in folder.rglob("*.nbi"))


@compiled
def over(x, y):
    return x / y


def test_a_division_by_zero_gives_what_numpy_gives() -> None:
    assert over(1.0, 0.0) == np.inf and over(-1.0, 0.0) == -np.inf and np.isnan(over(0.0, 0.0))
