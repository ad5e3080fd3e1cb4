"""What counts as an edit of a solver: its code and what it imports of physics and numerics, not comments or layout."""

from cablesim import solver, sources


def digest_with(monkeypatch, tmp_path, file: str, old: str, new: str) -> str:
    """The digest of the exact catenary in a copy of the package where one file was edited."""
    import shutil

    copy = tmp_path / "cablesim"
    shutil.copytree(solver.PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    text = (copy / file).read_text()
    assert old in text
    (copy / file).write_text(text.replace(old, new))
    monkeypatch.setattr(sources, "PACKAGE", copy)
    monkeypatch.setattr(sources, "FOLDER", copy / "solvers")
    return sources.source_digest.__wrapped__("catenary_exact")


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
