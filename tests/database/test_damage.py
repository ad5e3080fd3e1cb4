"""Three hundred shards, each damaged by one byte: what is read of them is right, or it is not there."""

import random
import shutil
from pathlib import Path

import numpy as np
import pytest

from cablesim import shards as blocks
from cablesim.config.scene import read_scene
from cablesim.database.reading import read_dataset
from cablesim.files import check, discard, ledger
from cablesim.status import Status
from cablesim.steps import collect_partly, run_scene
from cablesim.study import Layout
from tests.database.conftest import run

SCENE = """
title: Many small shards
design:
  grid:
    span: {start: 10, stop: 70, num: 60}
    length_ratio: [0.9, 1.1, 1.2, 1.3, 1.4]
fixed: {weight_per_length: 5 N/m}
methods:
  exact: {solver: catenary_exact}
outputs: [sag, max_tension]
"""
DAMAGED = 300


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study whose every scenario has a shard of its own."""
    folder = tmp_path_factory.mktemp("many")
    (folder / "many.yaml").write_text(SCENE)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(blocks, "MOST_SCENARIOS", 1)
        run(folder / "many.yaml", folder / "results")
    return folder


@pytest.fixture
def many(made: Path, tmp_path: Path) -> Layout:
    """A copy of it, to be damaged."""
    shutil.copytree(made, tmp_path, dirs_exist_ok=True)
    return Layout(tmp_path / "results")


def flip(path: Path, where: float, mask: int) -> None:
    """Change one byte."""
    data = bytearray(path.read_bytes())
    data[int(where * len(data))] ^= mask
    path.write_bytes(data)


def test_a_byte_that_is_wrong_anywhere_is_found_or_does_no_harm(many, tmp_path):
    draw = random.Random(1)
    paths = sorted(many.shards("many").glob("*.nc"))
    assert len(paths) == DAMAGED
    before = read_dataset(many.dataset("many"))
    for number, path in enumerate(paths):
        # A ledger is a fortieth as long as its shard, but every tenth flip is there.
        flip(ledger(path) if number % 10 == 0 else path, draw.random(), 1 << draw.randrange(8))
    bad = {path for path in paths if not check(path).whole}
    assert {path for number, path in enumerate(paths) if number % 10} <= bad
    scene = read_scene(tmp_path / "many.yaml")
    discard(many.dataset("many"))
    assert set(collect_partly(scene, many)) == bad
    after = read_dataset(many.dataset("many"))
    lost = after.status.values == Status.not_run
    assert lost.sum() == len(bad)
    for name in ("sag", "max_tension"):
        assert np.isnan(after[name].values[lost]).all()
        np.testing.assert_array_equal(after[name].values[~lost], before[name].values[~lost])
    _, computed = run_scene(scene, many, lambda *_: None)
    assert computed == len(bad)
    mended = read_dataset(many.dataset("many"))
    for name in ("sag", "max_tension", "status"):
        np.testing.assert_array_equal(mended[name], before[name])


@pytest.mark.parametrize("length", [0, 1, 1000])
def test_a_shard_that_is_cut_short_is_found(many, length):
    path = next(many.shards("many").glob("*.nc"))
    path.write_bytes(path.read_bytes()[:length])
    assert not check(path).whole


def test_two_shards_that_changed_places_are_found(many):
    one, other = sorted(many.shards("many").glob("*.nc"))[:2]
    for a, b in ((one, other), (ledger(one), ledger(other))):
        content = a.read_bytes()
        a.write_bytes(b.read_bytes())
        b.write_bytes(content)
    assert [check(path).condition.name for path in (one, other)] == ["foreign", "foreign"]
