"""A small study that every test of the database may read, and one that it may change."""

import shutil
from pathlib import Path

import pytest

from cablesim.config.scene import read_scene
from cablesim.steps import run_scene
from cablesim.study import Layout

SCENES = {
    "spans": """
title: Spans of three lengths
design:
  grid:
    span: [10, 20, 40]
    length_ratio: [0.9, 1.1, 1.2, 1.3]
fixed: {weight_per_length: 5 N/m}
methods:
  exact: {solver: catenary_exact, options: {nodes: 5}}
  parabolic: {solver: catenary_parabolic, options: {nodes: 5}}
outputs: [sag, max_tension, profile]
""",
    "inclined": """
title: Two spans between supports at different levels
design:
  cases:
    - {span: 10 m, rise: 0 m, length_ratio: 1.1}
    - {span: 10 m, rise: 3 m, length_ratio: 1.1}
    - {span: 40 m, rise: 3 m, length_ratio: 1.2}
    - {span: 40 m, rise: 9 m, length_ratio: 0.5}
fixed: {weight_per_length: 5 N/m}
methods:
  exact: {solver: catenary_exact}
outputs: [sag, max_tension]
""",
    "angles": """
title: Pode's functions at some angles
design:
  grid: {angle: [30 deg, 45 deg, 90 deg], friction_law: [constant, zero]}
fixed: {critical_angle: 20 deg, friction_ratio: 0.02}
methods:
  pode: {solver: pode_functions}
outputs: [tau, sigma]
""",
}


def run(path: Path, results: Path) -> Layout:
    """Run a scene file into a folder of results."""
    layout = Layout(results)
    run_scene(read_scene(path), layout, lambda step, done, total: None)
    return layout


@pytest.fixture(scope="session")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of results with three scenes, beside their files; not to be changed."""
    folder = tmp_path_factory.mktemp("database")
    for name, text in SCENES.items():
        (folder / f"{name}.yaml").write_text(text)
        run(folder / f"{name}.yaml", folder / "results")
    return folder / "results"


@pytest.fixture
def copy(stored: Path, tmp_path: Path) -> Path:
    """A copy of the same with its scene files, to be changed."""
    shutil.copytree(stored.parent, tmp_path / "copy")
    return tmp_path / "copy" / "results"
