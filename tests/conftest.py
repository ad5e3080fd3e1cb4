"""The default study, computed once by Snakemake for all tests that look at it."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

PROJECT = Path(__file__).parent.parent


@pytest.fixture(scope="session")
def default_study(tmp_path_factory) -> Path:
    """A folder in which `make study` has run."""
    folder = tmp_path_factory.mktemp("default")
    shutil.copy(PROJECT / "Snakefile", folder)
    for part in ("workflow", "config"):
        shutil.copytree(PROJECT / part, folder / part)
    command = [sys.executable, "-m", "snakemake", "--workflow-profile", "workflow/profiles/default"]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=600, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    return folder
