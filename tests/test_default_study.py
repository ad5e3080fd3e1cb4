"""The default study, computed once as `make study` does: what pages say of it, and what it is known for."""

import doctest
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from cablesim.config.scene import read_scene
from cablesim.database.reading import read_dataset
from cablesim.report.answer import NO_VALUE, written_answer
from cablesim.report.precision import work_and_precision
from cablesim.study import Layout, read_study
from tests.test_published import table
from tests.write_pages import PAGES, blocks, printed

PROJECT = Path(__file__).parent.parent


@pytest.fixture(scope="session")
def default_study(tmp_path_factory) -> Path:
    """A folder in which `make study` has run."""
    folder = tmp_path_factory.mktemp("default")
    shutil.copy(PROJECT / "Snakefile", folder)
    for part in ("workflow", "config"):
        shutil.copytree(PROJECT / part, folder / part)
    command = [sys.executable, "-m", "cablesim", "study"]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=1100, check=False)
    assert run.returncode == 1, run.stdout + run.stderr
    return folder


# ---- what the pages say ----


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


# ---- printed tables ----


def test_the_classical_layout_prints_the_values_of_the_literature(default_study):
    printed = table(Layout(default_study / "results" / "default"), "pode_table_classical").set_index(
        ["critical_angle [deg]", "friction_ratio", "angle [deg]"]
    )
    assert printed.loc[(30, 0.025, 90)].tolist() == [1.38698, 3.06571, -2.24439, 1.60605]
    assert printed.loc[(30, 0.025, 32), "xi"] == 2.33181
    assert printed.loc[(30, 0.025, 31), "xi"] == 4.05988
    # From the angle after the critical one to that before the end of the domain, and nothing at either.
    degrees = printed.loc[(30, 0.025)].index
    assert (degrees.min(), degrees.max(), len(degrees)) == (31, 209, 179)


# ---- answers ----

KNOWN = {
    "limit_ratio": "1.0743387 for the largest tension",
    "formula_error": "3.32 % too little sag and 4.53 % too little tension",
    "catenary_factors": "16 follow from no column and are misprints",
    "towline_alpha": "58 of 61 printed values",
    "tow_wave_height": "may be 6.7 m high",
    "weight_play_example": "By 2.612 m",
    "pode_example": "exact: 31.0646 deg and 208.5557 deg",
    "pode_table": "are 1.38698, 3.06571, -2.24439 and 1.60605",
    "extreme_towlines": "13034 of the 13034",
    "segment_error": "is of order 1.00, its midpoint variant of order 2.00",
    "paper_claims": "9 in setting 3",
    "stability_wave": "generalized alpha solves 83",
}
SCENE_FILES = read_study(PROJECT / "config" / "config.yaml").scene_paths


@pytest.mark.parametrize("name", [path.stem for path in SCENE_FILES])
def test_every_scene_answers_its_question_with_numbers_that_there_are(name, default_study):
    text = written_answer(Layout(default_study / "results" / "default").tables, name)
    assert KNOWN.get(name, "") in text
    assert re.search(r"[0-9]", text)
    assert not re.search(rf"(?<!\S){NO_VALUE}(?![\w.])|nan|inf\b", text), text


# ---- error against run time ----

SCENES = {
    "precision_hanging": ("elastic", 1e-9),
    "precision_towline": ("exact", 1e-9),
    "precision_pulled": ("exact", 1e-9),
    "precision_stream": ("pode", 1e-9),
    "segment_error": ("exact", 1e-9),
    "precision_wave": ("alpha_1e_5", 1e-4),
    "precision_mesh": ("n20_1e_3", 1e-2),
    "precision_snap": ("n20_1e_3", 1e-2),
}


@pytest.mark.parametrize("name", SCENES)
def test_the_reference_of_the_default_study_tells_what_it_is_there_for(name, default_study):
    read = read_scene(default_study / "config" / "scenes" / f"{name}.yaml")
    found = work_and_precision(read, read_dataset(default_study / "results" / "default" / f"{name}.nc"))
    method, accuracy = SCENES[name]
    assert found.least_told <= accuracy
    kept = next(one for one in found.methods if one.name == method)
    assert kept.solves_all and kept.largest <= accuracy
    assert found.fastest(accuracy) is not None
    assert found.front


def test_errors_in_the_default_study_are_those_of_the_methods(default_study):
    def largest(name):
        read = read_scene(default_study / "config" / "scenes" / f"{name}.yaml")
        dataset = read_dataset(default_study / "results" / "default" / f"{name}.nc")
        return {one.name: one.largest for one in work_and_precision(read, dataset).methods}

    hanging, towed = largest("precision_hanging"), largest("precision_towline")
    # 2 % longer than the span: the parabola's tension is off by 0.48 %, the series' by 1e-5, the handbook's by 41 %.
    assert [round(hanging[name], 4) for name in ("parabolic", "handbook")] == [0.0048, 0.4140]
    assert 5e-6 < hanging["series"] < 2e-5
    # MoorPy's own tolerance is absolute: lines that are nearly straight are off by any factor, and none says so.
    assert towed["moorpy"] > 1.0 and towed["moorpy_1e_6"] < 1e-3
