"""The default study, computed once as `make study` does: what pages say of it, and what it is known for."""

import doctest
import io
import json
import math
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pandas as pd
import pytest

from cablesim.cli import main
from cablesim.config.scene import read_scene
from cablesim.database.reading import read_dataset
from cablesim.report.answer import NO_VALUE, written_answer
from cablesim.report.precision import work_and_precision
from cablesim.report.tables import EFFORTS, LEFT_OVER
from cablesim.solver import load_solver, peer_names, solver_names
from cablesim.study import Layout, read_study
from tests.browser import Opened, chromium, opened
from tests.test_published import table
from tests.write_pages import STUDY_PAGES, blocks, plain, printed

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
    told = [body for page in STUDY_PAGES for body in blocks("console", page)]
    return [(body.partition("\n")[0].removeprefix("$ "), body.partition("\n")[2]) for body in told]


@pytest.mark.parametrize(("command", "output"), cases(), ids=[command[:60] for command, _ in cases()])
def test_a_command_of_a_page_prints_what_it_says(command, output, default_study, monkeypatch):
    monkeypatch.chdir(default_study)
    assert plain(printed(command)) == plain(output)


@pytest.mark.parametrize("page", [page for page in STUDY_PAGES if blocks("python", page)], ids=lambda page: page.name)
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
}
SCENE_FILES = read_study(PROJECT / "config" / "config.yaml").scene_paths


@pytest.mark.parametrize("name", [path.stem for path in SCENE_FILES])
def test_every_scene_answers_its_question_with_numbers_that_there_are(name, default_study):
    text = written_answer(Layout(default_study / "results" / "default").tables, name)
    assert KNOWN.get(name, "") in text
    assert re.search(r"[0-9]", text)
    assert not re.search(rf"(?<!\S){NO_VALUE}(?![\w.])|nan|inf\b", text), text


# ---- the page ----


@pytest.fixture(scope="module")
def report(default_study) -> Iterator[Opened]:
    """The page of the default study, opened where no host can be reached."""
    with chromium() as browser, opened(browser, default_study / "results" / "default" / "report.html") as found:
        yield found


def test_the_page_is_small_enough_to_mail(default_study):
    assert (default_study / "results" / "default" / "report.html").stat().st_size < 5e6


def test_every_figure_of_the_page_has_marks_and_nothing_is_asked_or_complained_of(report, default_study):
    study = read_study(default_study / "config" / "config.yaml")
    marks = report.draw_all()
    assert len(marks) == sum(len(scene.figures) for scene in study.scenes)
    assert {name: counts for name, counts in marks.items() if not all(counts)} == {}
    assert report.asked == [(default_study / "results" / "default" / "report.html").resolve().as_uri()]
    assert report.said == []


@pytest.mark.parametrize("name", [path.stem for path in SCENE_FILES])
def test_the_page_s_command_solves_the_scenario_that_it_is_shown_for(name, report, capsys):
    """By every solver of ours, in the middle of the scene's design: all outputs are numbers of the page again."""
    scenarios = report.page.evaluate("async name => (await cablesim.unpack(name)).scenarios", name)
    number = math.prod(axis["size"] for axis in scenarios["axes"]) // 2
    solvers = {method["solver"]: at for at, method in reversed(list(enumerate(scenarios["methods"])))}
    for solver, at in solvers.items():
        if solver in peer_names():
            continue
        shown = report.page.evaluate("([name, i, j]) => cablesim.scenarioOf(name, i, j)", [name, number, at])
        command = shlex.split(shown["command"])
        assert command[:3] == ["cablesim", "solve", solver]
        asked = [output for output in shown["outputs"] if output in load_solver(solver).outputs]
        capsys.readouterr()
        main([*command[1:], "--json", *(["--outputs", ",".join(asked)] if asked else [])])
        again = json.loads(capsys.readouterr().out)
        if shown["status"] is not None:
            assert again["status"] == shown["status"].replace(" ", "_")
        for output in asked:
            told = [math.nan if value is None else value for value in (shown["outputs"][output], again[output])]
            # The page has eight digits; what is left over of an equation may differ by rounding errors.
            small = 1e-9 if output in (*EFFORTS, *LEFT_OVER) else 0.0
            assert told[0] == pytest.approx(told[1], rel=5.1e-8, abs=small, nan_ok=True), f"{solver}: {output}"


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


# ---- the site ----

# What a browser fetches by itself, and what a reader may follow.
FETCHED = {"img": "src", "script": "src", "iframe": "src", "source": "src", "video": "src", "link": "href"}
ELSEWHERE = ("http:", "https:", "//", "data:")


class Links(HTMLParser):
    """The addresses in a page, and the names of its places."""

    def __init__(self, page: Path):
        super().__init__()
        self.fetched: list[str] = []
        self.followed: list[str] = []
        self.places: set[str] = set()
        self.feed(page.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        if given.get("id"):
            self.places.add(given["id"])
        if address := given.get(FETCHED.get(tag, "")):
            self.fetched.append(address)
        if tag == "a" and given.get("href"):
            self.followed.append(given["href"])


def build_site(results: Path, to: Path) -> subprocess.CompletedProcess[str]:
    quiet = {"NO_MKDOCS_2_WARNING": "1", "DISABLE_MKDOCS_2_WARNING": "true"}
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(to)]
    environment = {**os.environ, **quiet, "CABLESIM_SITE_RESULTS": str(results)}
    return subprocess.run(
        command, cwd=PROJECT, capture_output=True, text=True, env=environment, timeout=300, check=False
    )


@pytest.fixture(scope="module")
def site(default_study, tmp_path_factory) -> dict[Path, Links]:
    """The pages of the site, built of the default study without a warning, by their place."""
    folder = tmp_path_factory.mktemp("site")
    run = build_site(default_study / "results" / "default", folder)
    assert run.returncode == 0, run.stderr
    assert not re.search("WARNING|ERROR", run.stderr), run.stderr
    return {page: Links(page) for page in folder.rglob("*.html")}


def root(site: dict[Path, Links]) -> Path:
    return min(site, key=lambda page: len(page.parts)).parent


def test_a_page_of_the_site_fetches_nothing_from_elsewhere(site):
    fetched = {(page.name, address) for page, links in site.items() for address in links.fetched}
    assert {one for one in fetched if one[1].startswith(ELSEWHERE)} == set()
    styles = [path.read_text(encoding="utf-8") for path in root(site).rglob("*.css")]
    assert [
        found for style in styles for found in re.findall(r"(?:url\(|@import)\s*[\"']?(?:https?:|//)[^)]*", style)
    ] == []
    # The theme would fetch a program to draw these.
    assert [page.name for page in site if 'class="mermaid"' in page.read_text(encoding="utf-8")] == []


def test_every_link_of_the_site_leads_to_a_file_and_a_place_that_are_there(site):
    def broken() -> Iterator[tuple[str, str]]:
        for page, links in site.items():
            for address in (*links.fetched, *links.followed):
                parts = urlsplit(address)
                # The page for what is not found does not know from where it is asked.
                if parts.scheme or page.name == "404.html":
                    continue
                target = (page.parent / unquote(parts.path)).resolve() if parts.path else page
                known = target in site and parts.fragment not in ("", "__skip")
                if not target.is_file() or (known and unquote(parts.fragment) not in site[target].places):
                    yield page.name, address

    assert list(broken()) == []


def test_no_formula_is_left_as_it_was_written(site):
    assert [page.name for page in site if "arithmatex" in page.read_text(encoding="utf-8")] == []
    assert "<math" in (root(site) / "theory" / "waves.html").read_text(encoding="utf-8")


def test_every_solver_is_in_the_theory_and_in_the_reference(site):
    theory = {place for page, links in site.items() if page.parent.name == "theory" for place in links.places}
    assert set(solver_names()) <= theory
    reference = {page.stem for page in site if page.parent.name == "solvers"}
    assert {*solver_names(), *peer_names()} <= reference


def test_validation_has_every_cell_of_every_audited_table(site, default_study):
    audits = sorted((default_study / "results" / "default" / "tables").glob("*_audit.csv"))
    linked = site[root(site) / "validation" / "index.html"].followed
    assert len(audits) == sum(
        scene.published is not None for scene in read_study(PROJECT / "config/config.yaml").scenes
    )
    for path in audits:
        name = path.stem.removesuffix("_audit")
        assert f"tables/{name}.html" in linked
        page = (root(site) / "validation" / "tables" / f"{name}.html").read_text(encoding="utf-8")
        shown = [table for table in pd.read_html(io.StringIO(page)) if "verdict" in table]
        assert sum(map(len, shown)) == len(pd.read_csv(path)), name


def test_the_gallery_shows_every_figure(site, default_study):
    drawn = {path.name for path in (default_study / "results" / "default" / "figures").glob("*.png")}
    shown = {Path(address).name for address in site[root(site) / "gallery.html"].fetched}
    assert drawn <= shown and len(drawn) > 100


def test_without_a_study_the_site_says_in_one_line_what_is_missing(tmp_path):
    run = build_site(tmp_path / "nothing", tmp_path / "site")
    assert run.returncode == 1
    lines = (run.stdout + run.stderr).strip().splitlines()
    assert len(lines) == 1 and "no finished study" in lines[0] and lines[0].endswith("make study")
