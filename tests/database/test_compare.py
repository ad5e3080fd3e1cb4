"""What has changed between two folders of results, however the datasets are cut into blocks."""

from pathlib import Path

import netCDF4
import numpy as np
import pandas as pd
import pytest

from cablesim.cli import main
from cablesim.database import scan
from cablesim.database.compare import compare
from cablesim.status import Status
from tests.database.conftest import SCENES, run
from tests.helpers import rewritten


def rerun(folder: Path, name: str, *changes: tuple[str, str]) -> Path:
    """Results of a scene with some of its text replaced."""
    text = SCENES[name]
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    folder.mkdir(exist_ok=True)
    (folder / f"{name}.yaml").write_text(text)
    return run(folder / f"{name}.yaml", folder / "results").root


def only(results: Path, name: str, folder: Path) -> Path:
    """A folder with the dataset of one scene alone."""
    folder.mkdir()
    (folder / f"{name}.nc").write_bytes((results / f"{name}.nc").read_bytes())
    return folder


def row(table: pd.DataFrame, output: str, scene: str = "spans") -> pd.Series:
    (found,) = (one for _, one in table[(table.scene == scene) & (table.output == output)].iterrows())
    return found


@pytest.fixture(params=[1, 5, 2**19])
def block(request, monkeypatch):
    monkeypatch.setattr(scan, "BLOCK", request.param)


@pytest.mark.usefixtures("block")
def test_the_same_is_the_same(stored, copy):
    table = compare(stored, copy)
    assert not table.differs.any()
    assert set(table.scene) == set(SCENES)
    assert row(table, "sag")["in both"] == 24
    assert table.attrs["notes"] == []


@pytest.mark.usefixtures("block")
def test_points_in_another_order_are_the_same(stored, tmp_path):
    changes = (("[10, 20, 40]", "[40, 10, 20]"), ("[0.9, 1.1, 1.2, 1.3]", "[1.3, 0.9, 1.2, 1.1]"))
    other = rerun(tmp_path / "other", "spans", *changes)
    table = compare(only(stored, "spans", tmp_path / "a"), only(other, "spans", tmp_path / "b"))
    assert not table.differs.any()
    assert row(table, "profile")["in both"] == 24
    assert table.attrs["notes"] == ["spans: the scene file changed"]


@pytest.mark.usefixtures("block")
def test_scenarios_that_came_and_went_are_counted(stored, tmp_path):
    other = rerun(tmp_path / "other", "spans", ("[10, 20, 40]", "[5, 20, 40, 80]"), ("0.9, 1.1,", "1.1,"))
    found = row(compare(stored, other), "sag")
    # Of each method: two of three spans and three of four ratios are in both.
    assert (found["in both"], found["removed"], found["added"]) == (12, 12, 12)
    assert found.differs and found["beyond tolerance"] == 0


def test_what_was_fixed_and_varies_now_is_matched(stored, tmp_path):
    fixed = "fixed: {weight_per_length: 5 N/m}\n"
    other = rerun(tmp_path / "other", "spans", ("grid:", "grid:\n    weight_per_length: [4, 5]"), (fixed, ""))
    for folders, counts in (((stored, other), (24, 0, 24)), ((other, stored), (24, 24, 0))):
        found = row(compare(*folders), "sag")
        assert (found["in both"], found["removed"], found["added"]) == counts
        assert found["beyond tolerance"] == 0


def test_another_fixed_value_is_another_scenario(stored, tmp_path):
    other = rerun(tmp_path / "other", "spans", ("5 N/m", "6 N/m"))
    found = row(compare(stored, other), "sag")
    assert (found["in both"], found["removed"], found["added"]) == (0, 24, 24)


def test_a_grid_and_cases_are_other_designs(stored, tmp_path):
    cases = "cases: [{span: 10, length_ratio: 0.9}, {span: 40, length_ratio: 1.2}]"
    grid = "grid:\n    span: [10, 20, 40]\n    length_ratio: [0.9, 1.1, 1.2, 1.3]"
    table = compare(stored, rerun(tmp_path / "other", "spans", (grid, cases)))
    (found,) = table[table.scene == "spans"].output
    assert found.startswith("other design: ")
    assert table.differs.any()


@pytest.mark.usefixtures("block")
def test_a_change_is_told_with_its_size_and_place(stored, copy):
    with rewritten(copy / "spans.nc") as file:
        file["sag"][1, 2, 3] *= 1.25
        file["sag"][0, 1, 1] *= 1.01
    found = row(compare(stored, copy), "sag")
    assert found["beyond tolerance"] == 2
    assert found.relative == pytest.approx(0.2)
    assert found["where"] == "method=parabolic, span=40, length_ratio=1.3"
    with netCDF4.Dataset(stored / "spans.nc") as file:
        assert found["largest change"] == pytest.approx(0.25 * float(file["sag"][1, 2, 3]))
    assert row(compare(stored, copy, tolerance=0.05), "sag")["beyond tolerance"] == 1
    assert not row(compare(stored, copy), "max_tension").differs


@pytest.mark.usefixtures("block")
@pytest.mark.parametrize("index", [(0, 1, 1), (0, 0, 0)])
def test_a_number_for_none_and_none_for_a_number_are_changes(stored, copy, index):
    with rewritten(copy / "spans.nc") as file:
        file["sag"][index] = np.nan if index[2] else 3.0
    found = row(compare(stored, copy, tolerance=0.5), "sag")
    assert found["beyond tolerance"] == 1
    assert found.relative == np.inf
    assert found["where"].startswith("method=exact, span=")


@pytest.mark.usefixtures("block")
def test_statuses_are_told_from_what_to_what(stored, copy):
    with rewritten(copy / "spans.nc") as file:
        file["status"][0, :, 1:] = int(Status.not_converged)
        file["status"][1, 0, 0] = int(Status.out_of_domain)
    found = row(compare(stored, copy), "status")
    assert found["beyond tolerance"] == 10
    assert found["where"] == "ok -> not_converged: 9, infeasible -> out_of_domain: 1"


def test_vectors_and_profiles_are_compared_as_a_whole(stored, copy):
    with rewritten(copy / "spans.nc") as file:
        file["profile"][0, 1, 1, 2] *= 1.5
    table = compare(stored, copy)
    assert row(table, "profile")["beyond tolerance"] == 1
    assert not [output for output in table.output if output.startswith("profile_")]


def test_an_output_named_after_another_is_compared_too(tmp_path):
    checks = (
        "outputs: [sag, max_tension, profile]",
        "outputs: [sag, max_tension, profile]\nchecks: {sag_small: sag < 5 m}",
    )
    one, other = (rerun(tmp_path / name, "spans", checks) for name in "ab")
    with rewritten(other / "spans.nc") as file:
        file["sag_small"][0, 0, 1] = 1
    found = row(compare(one, other), "sag_small")
    assert (found["beyond tolerance"], found["where"]) == (1, "passed -> failed: 1")


def test_flags_are_compared_by_their_words(stored, copy):
    with rewritten(copy / "spans.nc") as file:
        file["status"].flag_meanings = "infeasible ok not_converged out_of_domain unavailable not_run"
        file["status"][...] = np.array([1, 0])[file["status"][...]]
    assert not row(compare(stored, copy), "status").differs


def test_a_case_that_is_listed_twice_is_two_scenarios(tmp_path):
    case = "    - {span: 40 m, rise: 3 m, length_ratio: 1.2}\n"
    twice, once = rerun(tmp_path / "a", "inclined", (case, case + case)), rerun(tmp_path / "b", "inclined")
    found = row(compare(twice, twice), "sag", "inclined")
    assert (found["in both"], found["removed"], found["added"], found["beyond tolerance"]) == (5, 0, 0, 0)
    found = row(compare(twice, once), "sag", "inclined")
    assert (found["in both"], found["removed"], found["added"], found["beyond tolerance"]) == (4, 1, 0, 0)


def test_what_may_explain_a_change_is_told(stored, copy, capsys):
    with rewritten(copy / "spans.nc") as file:
        file.methods = file.methods.replace('"sources": "', '"sources": "other', 1)
    assert main(["compare", str(stored), str(copy)]) == 0
    told = capsys.readouterr()
    assert told.out.endswith("the same\n")
    assert told.err == "note: spans: the code of catenary_exact changed\n"


def test_a_damaged_file_is_named(stored, copy, capsys):
    (copy / "spans.nc").write_bytes(b"nothing")
    assert main(["compare", str(stored), str(copy)]) == 3
    assert "spans.nc: damaged" in capsys.readouterr().err
