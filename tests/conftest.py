"""The default study, computed once by Snakemake for all tests that look at it."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import cablesim.solvers
from cablesim import solver, sources

PROJECT = Path(__file__).parent.parent
DEFAULT_STUDY = "default_study"
EXAMPLES = Path(__file__).parent / "example_solvers"


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Where several processes share the tests, a file stays in one, and so does all that needs the default study.

    That comes first, because it takes longest.
    """
    for item in items:
        group = DEFAULT_STUDY if DEFAULT_STUDY in item.fixturenames else str(item.path)
        item.add_marker(pytest.mark.xdist_group(group))
    items.sort(key=lambda item: DEFAULT_STUDY not in item.fixturenames)


@pytest.fixture(scope="session")
def default_study(tmp_path_factory) -> Path:
    """A folder in which `make study` has run."""
    folder = tmp_path_factory.mktemp("default")
    shutil.copy(PROJECT / "Snakefile", folder)
    for part in ("workflow", "config"):
        shutil.copytree(PROJECT / part, folder / part)
    command = [sys.executable, "-m", "snakemake", "--workflow-profile", "workflow/profiles/default"]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=1100, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    return folder


@pytest.fixture
def pulled_line(monkeypatch):
    """A solver with words, vectors and problem kinds, found as if it lay in the folder of the solvers."""
    names = sorted([*(path.stem for path in EXAMPLES.glob("*_line.py")), *solver.solver_names()])
    monkeypatch.setattr(cablesim.solvers, "__path__", [*cablesim.solvers.__path__, str(EXAMPLES)])
    monkeypatch.setattr(solver, "solver_names", lambda: names)
    monkeypatch.setattr(sources, "code_digest", lambda modules, parts: modules[0])
    yield solver.load_solver("pulled_line")
    solver.load_solver.cache_clear()
