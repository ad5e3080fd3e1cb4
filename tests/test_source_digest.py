"""What counts as an edit of a solver: its code and what it imports of physics and numerics, not comments or layout."""

import shutil

import pytest

from cablesim import solver, sources
from cablesim.report.page import digest
from cablesim.workflow import STEP_MODULES, STEP_PARTS


def digest_with(monkeypatch, tmp_path, file: str, old: str, new: str, step: str | None = None) -> str:
    """The digest of the exact catenary, or of a step, in a copy of the package where one file was edited."""
    copy = tmp_path / "cablesim"
    shutil.copytree(solver.PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    text = (copy / file).read_text()
    assert old in text
    (copy / file).write_text(text.replace(old, new))
    monkeypatch.setattr(sources, "PACKAGE", copy)
    if step is not None:
        return sources.code_digest.__wrapped__(STEP_MODULES[step], STEP_PARTS)
    return sources.code_digest.__wrapped__(("solvers/catenary_exact",), sources.NUMBERS)


def test_code_of_the_solver_counts(monkeypatch, tmp_path):
    before = sources.source_digest("catenary_exact")
    assert digest_with(monkeypatch, tmp_path, "solvers/catenary_exact.py", "excess > 0.0", "excess >= 0.0") != before


def test_code_that_the_solver_imports_counts(monkeypatch, tmp_path):
    before = sources.source_digest("catenary_exact")
    assert (
        digest_with(monkeypatch, tmp_path, "numerics/hyperbolic.py", "HALLEY_STEPS = 2", "HALLEY_STEPS = 3") != before
    )


def test_comments_and_docstrings_do_not_count(monkeypatch, tmp_path):
    before = sources.source_digest("catenary_exact")
    assert (
        digest_with(monkeypatch, tmp_path, "solvers/catenary_exact.py", "Exact catenary:", "The exact catenary:")
        == before
    )


def test_other_solvers_do_not_count(monkeypatch, tmp_path):
    before = sources.source_digest("catenary_exact")
    assert (
        digest_with(monkeypatch, tmp_path, "solvers/catenary_elastic.py", "0.5 * p.weight", "0.25 * p.weight") == before
    )


@pytest.mark.parametrize(
    ("file", "old", "new", "steps"),
    [
        ("report/figures.py", "MOST_CELLS = 600", "MOST_CELLS = 500", {"figures"}),
        ("report/checks.py", "first failed at", "first failed", {"summarise"}),
        ("database/checks.py", "np.argsort(order)", "order", {"collect", "summarise", "figures"}),
        ("report/answer.py", 'NO_VALUE = "-"', 'NO_VALUE = "?"', {"summarise"}),
        ("reductions.py", "np.argmax", "np.argmin", {"summarise"}),
        ("report/tables.py", "MARKDOWN_ROWS = 40", "MARKDOWN_ROWS = 50", {"summarise"}),
        ("expressions.py", "EQUAL_WITHIN = 1e-9", "EQUAL_WITHIN = 1e-8", {"collect", "summarise", "figures"}),
        ("database/shard_file.py", "CHUNK = 2**17", "CHUNK = 2**16", {"collect", "summarise", "figures"}),
        ("physics/catenary.py", "np.sinh", "np.cosh", set()),
    ],
)
def test_an_edit_makes_the_files_of_the_steps_that_use_it_out_of_date(monkeypatch, tmp_path, file, old, new, steps):
    before = {step: sources.code_digest(modules, STEP_PARTS) for step, modules in STEP_MODULES.items()}
    after = {}
    for step in STEP_MODULES:
        with monkeypatch.context() as patched:
            after[step] = digest_with(patched, tmp_path / step, file, old, new, step)
    assert {step for step in before if after[step] != before[step]} == steps


@pytest.mark.parametrize("module", ["labels", "reductions", "config/axis_labels", "report/page/map_panels"])
def test_the_page_is_out_of_date_where_what_it_shows_is_made_otherwise(monkeypatch, module):
    """A part of it is named by the code of labels too, wherever that lies."""
    named = sources.PACKAGE / f"{module}.py"
    looked_at = []
    monkeypatch.setattr(sources, "_read", lambda path, read=sources._read: looked_at.append(path) or read(path))
    monkeypatch.setattr(digest, "code_digest", sources.code_digest.__wrapped__)
    digest.part_digest()
    assert named in looked_at
