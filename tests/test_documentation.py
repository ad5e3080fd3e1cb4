"""The pages say what a user will see: their commands are run, output is compared, scenes are computed."""

import re

import pytest

from cablesim.config.scene import read_scene
from cablesim.steps import run_scene
from cablesim.study import Layout
from tests.write_pages import PAGES, blocks

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
