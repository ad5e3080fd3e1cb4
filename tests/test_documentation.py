"""The pages say what a user will see: their commands are run, output is compared, scenes are computed."""

import doctest
import re
from pathlib import Path

import pytest

from cablesim.config.scene import read_scene
from cablesim.quantities import TABLE
from cablesim.solver import solver_names
from cablesim.steps import run_scene
from cablesim.study import Layout
from tests.write_pages import FENCE, OWN_PAGES, PAGES, PROJECT, at_desk, blocks, files, plain, printed, python_here
from website.mathml import mathml
from website.solvers import chapter

SCENES = [(page.name, text) for page in PAGES for text in blocks("yaml", page)]


@pytest.mark.parametrize(("page", "text"), SCENES, ids=[f"{page} {i}" for i, (page, _) in enumerate(SCENES)])
def test_every_scene_of_the_documentation_runs(page, text, tmp_path):
    path = tmp_path / "own.yaml"
    path.write_text(text)
    run_scene(read_scene(path), Layout(tmp_path / "results"), lambda step, done, total: None)
    assert (tmp_path / "results" / "own.nc").exists()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_file_that_a_page_links_to_exists(page):
    links = re.findall(r"\]\((?!\w+:)([^)#]+)", page.read_text(encoding="utf-8"))
    assert [link for link in links if not (page.parent / link).exists()] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_block_of_a_page_is_run_or_says_nothing_of_its_language(page):
    for language, title, body in FENCE.findall(page.read_text(encoding="utf-8")):
        assert language in ("", "console", "python", "yaml")
        if language == "console":
            assert body.startswith(("$ cablesim ", "$ head ")) and body.count("\n$ ") == 0
        if language == "python" and not title:
            assert body.startswith(">>> ")


# ---- pages that write files of their own ----


@pytest.mark.parametrize("page", OWN_PAGES, ids=lambda page: page.name)
def test_a_page_that_writes_files_does_what_it_says(page, tmp_path):
    with at_desk(page, tmp_path) as run:
        for body in blocks("console", page):
            command, _, output = body.partition("\n")
            assert plain(run(command.removeprefix("$ "))) == plain(output), command
        if run is printed:
            examples = doctest.DocTestParser().get_doctest("\n".join(blocks("python", page)), {}, page.name, None, 0)
            assert doctest.DocTestRunner().run(examples).failed == 0
        else:
            Path("page.txt").write_text("\n".join(blocks("python", page)), encoding="utf-8")
            told = python_here("-m", "doctest", "page.txt")
            assert told.returncode == 0, told.stdout


def test_the_solver_that_a_page_writes_passes_its_test_and_keeps_the_promises_of_every_solver(tmp_path):
    page = next(page for page in OWN_PAGES if page.name == "own_solver.md")
    own_test = next(name for name in files(page) if name.startswith("tests/"))
    with at_desk(page, tmp_path):
        command = (
            "-m",
            "pytest",
            "-p",
            "no:cacheprovider",
            own_test,
            "tests/test_contract.py",
            "-k",
            "catenary_from_sag",
        )
        told = python_here(*command)
    assert told.returncode == 0, told.stdout
    assert re.search(r"^\d+ passed, \d+ deselected", told.stdout, re.M), told.stdout


# ---- formulas ----


@pytest.mark.parametrize("solver", solver_names())
def test_every_solver_has_its_section_in_the_theory_with_an_equation_and_a_source(solver):
    text = (PROJECT / "docs" / "theory" / f"{chapter(solver)}.md").read_text(encoding="utf-8")
    sections = [section for section in re.split(r"^## ", text, flags=re.M) if section.startswith(f"`{solver}`\n")]
    assert len(sections) == 1
    assert re.search(r"\$.+\$", sections[0], re.S) and "\nSource: " in sections[0]


def test_every_symbol_of_a_quantity_is_a_formula():
    assert all(mathml(quantity.symbol, "inline").startswith("<math ") for quantity in TABLE)


@pytest.mark.parametrize(
    ("tex", "expected"),
    [
        (r"2 a \sinh \lambda", "<mi>sinh</mi><mspace"),
        (r"a \sinh^2 (b)", "<msup><mi>sinh</mi><mn>2</mn></msup><mo"),
        (r"\operatorname{asinh} x", "<mi>asinh</mi><mspace"),
        (r"a \pm b", "<mo>&#x000B1;</mo>"),
    ],
)
def test_functions_and_signs_stand_as_in_print(tex, expected):
    assert expected in mathml(tex, "inline")


def test_a_formula_that_is_not_understood_is_refused():
    with pytest.raises(ValueError, match="not understood"):
        mathml(r"\begin{aligned} a &= b \end{aligned}", "block")
