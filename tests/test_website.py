"""The pages that are made: which pictures belong to which scene, and what Markdown cannot have in a table."""

from pathlib import Path

import pytest

from cablesim.config.scene import read_scene
from cablesim.study import Layout
from website import gallery, home
from website.study import Finished
from website.text import scene_link, table

SCENES = Path(__file__).parents[1] / "config" / "scenes"


@pytest.fixture
def study(tmp_path) -> Finished:
    """Two scenes, the name of one of which begins the name of the other, with empty pictures."""
    layout = Layout(tmp_path)
    (tmp_path / "figures").mkdir()
    for name in ("pode_example_force.png", "pode_example_shape_moving.gif", "pode_example_force.svg"):
        (tmp_path / "figures" / name).touch()
    return Finished(
        layout, tuple(read_scene(SCENES / f"{name}.yaml") for name in ("pode_example", "pode_example_shape"))
    )


def test_a_picture_belongs_to_the_scene_with_the_longest_name_that_it_begins_with(study):
    found = {scene: [path.name for path in paths] for scene, paths in gallery.figures(study).items()}
    assert found == {
        "pode_example": ["pode_example_force.png"],
        "pode_example_shape": ["pode_example_shape_moving.gif"],
    }
    assert set(gallery.pictures(study)) == {"gallery/pode_example_force.png", "gallery/pode_example_shape_moving.gif"}


def test_what_moves_stands_first_in_the_gallery_with_its_scene_file(study):
    page = gallery.pages(study)["gallery.md"]
    assert page.index("pode_example_shape_moving.gif") < page.index("pode_example_force.png")
    assert "](../config/scenes/pode_example_shape.yaml)" in page
    assert all(scene.question in page for scene in study.scenes)


def test_a_link_to_a_scene_file_leaves_the_folders_of_the_site(study):
    assert "](../../../config/scenes/pode_example.yaml)" in scene_link(study.scenes[0], "validation/tables")


def test_cells_of_a_table_keep_it_whole():
    assert table(("a", "b"), [("x|y", "two\nlines")], "lr") == "| a | b |\n|---|---:|\n| x\\|y | two lines |\n"


def test_links_of_the_readme_are_turned_to_be_read_from_docs():
    text = "[a](docs/runs.md) [b](benchmarks/README.md) [c](https://example.org/)"
    assert home.in_docs(text) == "[a](runs.md) [b](../benchmarks/README.md) [c](https://example.org/)"
