"""The pages say what a user will see: their commands are run, output is compared, scenes are computed."""

import doctest
import re
from pathlib import Path

import pytest

from cablesim.config.scene import read_scene
from cablesim.steps import run_scene
from cablesim.study import Layout
from tests.write_pages import FENCE, PAGES, README, printed


def blocks(language: str, page: Path = README) -> list[str]:
    return [body for found, body in FENCE.findall(page.read_text(encoding="utf-8")) if found == language]


def cases() -> list[tuple[str, str]]:
    """Each command of a page with the output that follows it."""
    told = [body for page in PAGES for body in blocks("console", page)]
    return [(body.partition("\n")[0].removeprefix("$ "), body.partition("\n")[2]) for body in told]


@pytest.mark.parametrize(("command", "output"), cases(), ids=[command[:60] for command, _ in cases()])
def test_a_command_of_a_page_prints_what_it_says(command, output, default_study, monkeypatch):
    monkeypatch.chdir(default_study)
    assert plain(printed(command)) == plain(output)


def plain(text: str) -> str:
    """Without the white space at line ends, which editors remove."""
    return "\n".join(line.rstrip() for line in text.strip().splitlines())


@pytest.mark.parametrize("page", [page for page in PAGES if blocks("python", page)], ids=lambda page: page.name)
def test_the_python_lines_of_a_page_print_what_they_say(page, default_study, monkeypatch):
    monkeypatch.chdir(default_study)
    examples = doctest.DocTestParser().get_doctest("\n".join(blocks("python", page)), {}, page.name, str(page), 0)
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
