"""What tests of several folders share: their order, and solvers that are there for tests alone."""

from pathlib import Path

import pytest

import cablesim.solvers
from cablesim import solver, sources

EXAMPLES = Path(__file__).parent / "example_solvers"


# Files that take longest, in this order.
LONGEST = ("test_default_study.py", "test_slurm.py", "test_faults.py", "test_workflow.py", "test_cluster.py")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The longest files first, where several processes share the tests by file."""
    items.sort(key=lambda item: LONGEST.index(item.path.name) if item.path.name in LONGEST else len(LONGEST))


@pytest.fixture
def pulled_line(monkeypatch):
    """A solver with words, vectors and problem kinds, found as if it lay in the folder of the solvers."""
    names = sorted([*(path.stem for path in EXAMPLES.glob("*_line.py")), *solver.solver_names()])
    monkeypatch.setattr(cablesim.solvers, "__path__", [*cablesim.solvers.__path__, str(EXAMPLES)])
    monkeypatch.setattr(solver, "solver_names", lambda: names)
    monkeypatch.setattr(sources, "code_digest", lambda modules, parts: modules[0])
    yield solver.load_solver("pulled_line")
    solver.load_solver.cache_clear()
