"""The README says what a user will see: its commands are run, its output compared, its scene checked."""

import doctest
import re
from pathlib import Path

import pytest

from cablesim.config.scene import read_scene
from cablesim.steps import run_scene
from cablesim.study import Layout
from tests.write_readme import FENCE, README, printed

PROJECT = Path(__file__).parent.parent
PAGES = (README, *sorted((PROJECT / "docs").glob("*.md")))


def blocks(language: str, page: Path = README) -> list[str]:
    return [body for found, body in FENCE.findall(page.read_text(encoding="utf-8")) if found == language]


def cases() -> list[tuple[str, str]]:
    """Each command of the README with the output that follows it."""
    return [(body.partition("\n")[0].removeprefix("$ "), body.partition("\n")[2]) for body in blocks("console")]


@pytest.mark.parametrize(("command", "output"), cases(), ids=[command[:60] for command, _ in cases()])
def test_a_command_of_the_readme_prints_what_it_says(command, output, default_study, monkeypatch):
    monkeypatch.chdir(default_study)
    assert plain(printed(command)) == plain(output)


def plain(text: str) -> str:
    """Without the white space at line ends, which editors remove."""
    return "\n".join(line.rstrip() for line in text.strip().splitlines())


def test_the_python_lines_of_the_readme_print_what_they_say(default_study, monkeypatch):
    monkeypatch.chdir(default_study)
    examples = doctest.DocTestParser().get_doctest("\n".join(blocks("python")), {}, "README", str(README), 0)
    assert doctest.DocTestRunner().run(examples).failed == 0


SCENES = [(page.name, text) for page in PAGES for text in blocks("yaml", page)]


@pytest.mark.parametrize(("page", "text"), SCENES, ids=[f"{page} {i}" for i, (page, _) in enumerate(SCENES)])
def test_every_scene_of_the_documentation_runs(page, text, tmp_path):
    path = tmp_path / "own.yaml"
    path.write_text(text)
    run_scene(read_scene(path), Layout(tmp_path / "results"), lambda step, done, total: None)
    assert (tmp_path / "results" / "own.nc").exists()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_file_that_a_page_links_to_exists(page):
    links = re.findall(r"\]\(([^)#]+)\)", page.read_text(encoding="utf-8"))
    assert [link for link in links if not (page.parent / link).exists()] == []
