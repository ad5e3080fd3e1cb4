"""The page of a study in a browser that reaches no host: figures, clicks, tables, names that would like to be code."""

import base64
import csv
import gzip
import io
import itertools
import json
import re
import shlex
from pathlib import Path

import numpy as np
import pytest

from cablesim.cli import main
from cablesim.config.scene import read_scene
from cablesim.database.reading import read_dataset
from cablesim.report.page import map_panels, part, scenarios, write
from cablesim.report.page.figures import page_figures
from cablesim.steps import run_step
from cablesim.study import Layout
from tests.browser import chromium, opened

# What a title, a label or a message must never become.
HOSTILE = (
    "<script>window.hacked = 1</script>",
    "</script><script>window.hacked = 2</script>",
    '"><img src=x onerror="window.hacked = 3">',
    "</style><style>body { display: none }</style>",
    "<b onclick=alert(1)>bold</b> & more",
)
SCENE = """
title: {0}
question: {1}
answer: {2}
design:
  grid: {{rise: [0 m, 10 m, 20 m], span: {{start: 40 m, stop: 120 m, num: 17}}}}
fixed: {{line_length: 100 m, weight_per_length: 10 N/m, axial_stiffness: 1 MN}}
methods:
  exact: {{solver: catenary_exact, ignores: [axial_stiffness]}}
  near: {{solver: catenary_elastic}}
reference: exact
outputs: [sag, max_tension, profile]
figures:
  curves:
    kind: curves
    x: span
    y: {{{3}: exact.sag, {4}: near.sag}}
    point: {{rise: 10 m}}
    y_label: {2}
  sag: {{kind: map, x: span, y: rise, value: exact.sag, label: {1}}}
  fates: {{kind: status_map, x: span, y: rise}}
  shapes: {{kind: profiles, at: {{rise: [0 m, 20 m]}}, point: {{span: 60 m}}, titles: [{0}, {4}]}}
tables:
  printed: {{rows: span, columns: {{{2}: exact.sag}}, point: {{rise: 0 m}}, words: {{span: {4}}}}}
"""


@pytest.fixture(scope="module")
def results(tmp_path_factory) -> Path:
    """The results of a scene full of hostile names; some of its lines are too short."""
    folder = tmp_path_factory.mktemp("page")
    path = folder / "spans.yaml"
    path.write_text(SCENE.format(*(json.dumps(hostile) for hostile in HOSTILE)), encoding="utf-8")
    assert main(["run", str(path), "--out", str(folder / "results")]) == 1
    return folder / "results"


@pytest.fixture(scope="module")
def browser():
    with chromium() as found:
        yield found


@pytest.fixture
def page(browser, results):
    with opened(browser, results / "report.html") as found:
        yield found
        assert found.asked == [(results / "report.html").resolve().as_uri()]
        assert found.said == []


def test_every_figure_has_marks_and_nothing_is_asked_of_any_host(page):
    marks = page.draw_all()
    assert len(marks) == 4
    assert all(count > 0 for panels in marks.values() for count in panels)
    # A cell for each scenario of the map, and of each method of the map of statuses.
    assert marks["spans 1"] == [51] and marks["spans 2"] == [51, 51]


def test_hostile_names_are_text(page):
    page.draw_all()
    for details in page.page.locator("details").all():
        details.evaluate("d => { d.open = true; }")
    page.page.wait_for_function("document.querySelectorAll('details[data-table] table').length >= 4")
    shown = page.page.evaluate(
        "document.body.innerText + [...document.querySelectorAll('svg text')].map(t => t.textContent)"
    )
    for hostile in HOSTILE:
        assert hostile in shown
    assert page.page.evaluate("window.hacked") is None
    assert page.page.locator("img").count() == 0 and page.page.locator("b").count() == 0
    assert page.page.title() == "results · cablesim"


def test_a_script_that_is_not_the_page_s_own_does_not_run(browser, results):
    with opened(browser, results / "report.html") as found:
        found.page.evaluate(
            "document.body.append(Object.assign(document.createElement('script'), {text: 'injected = 1'}))"
        )
        assert found.page.evaluate("typeof injected") == "undefined"
        assert len(found.said) == 1 and "Content Security Policy" in found.said[0]


CELL = """([figure, scenario]) => {
  const view = figure.views[0];
  const find = (node) => node.items.flatMap((item) =>
    item.datum && item.datum.scenario === scenario ? [item] : (item.items || []).flatMap(find));
  const { x1, x2, y1, y2 } = find(view.scenegraph().root)[0].bounds;
  const [left, top] = view.origin();
  const box = view.container().getBoundingClientRect();
  return [box.left + left + (x1 + x2) / 2, box.top + top + (y1 + y2) / 2];
}"""


def test_a_click_in_a_map_shows_its_scenario_and_the_command_that_solves_it_again(page, results, capsys):
    figure = page.page.locator("#spans figure").nth(1)
    figure.scroll_into_view_if_needed()
    page.page.wait_for_function("f => f.dataset.drawn", arg=figure.element_handle())
    page.page.mouse.click(*page.page.evaluate(CELL, [figure.element_handle(), 23]))
    card = page.page.locator("#spans details.scenario[data-number='23']")
    card.locator(".profile svg").wait_for()
    assert "Scenario 24 of 51" in card.inner_text()
    command = shlex.split(card.locator(".command").inner_text())
    assert command[:2] == ["cablesim", "solve"]
    capsys.readouterr()
    main([*command[1:], "--outputs", "sag,max_tension", "--json"])
    again = json.loads(capsys.readouterr().out)
    rows = card.locator("tbody tr").all_inner_texts()
    told = {row.split("\t")[0]: row.split("\t")[1] for row in rows}
    # Rise 10 m and span 70 m: the second of 3, the seventh of 17.
    assert (told["rise"], told["span"], told["status"]) == ("10 m", "70 m", "ok")
    assert told["sag [m]"] == f"{again['sag']:.8g}"
    assert told["max tension [N]"] == f"{again['max_tension']:.8g}"


def test_a_scenario_without_a_solution_says_so(page):
    page.page.locator("details.scenario > summary").click()
    page.page.locator("details.scenario input[type=range]").fill("16")
    assert "infeasible" in page.page.locator("details.scenario .result").inner_text()


def test_the_page_is_used_by_keyboard_alone(page):
    summary = page.page.locator("details.scenario > summary")
    summary.focus()
    page.page.keyboard.press("Enter")
    page.page.locator("details.scenario select").first.wait_for()
    page.page.keyboard.press("Tab")
    page.page.keyboard.press("ArrowDown")
    page.page.keyboard.press("Tab")
    page.page.keyboard.press("ArrowRight")
    assert page.page.locator("details.scenario").get_attribute("data-number") == str(1 * 17 + 1)


def test_tables_are_sorted_and_saved_as_they_are(page, results):
    table = page.page.locator("details[data-table]").filter(has_text="Tensions in N")
    table.locator("summary").click()
    head = table.locator("th", has_text="max_tension")
    for direction in ("ascending", "descending"):
        head.locator("button").click()
        assert head.get_attribute("aria-sort") == direction
        column = head.evaluate("h => [...h.parentNode.children].indexOf(h)")
        texts = [row.split("\t")[column] for row in table.locator("tbody tr").all_inner_texts()]
        values = [float(text.replace(",", "")) for text in texts if text]
        assert len(values) > 20 and values == sorted(values, reverse=direction == "descending")
    with page.page.expect_download() as saved:
        table.get_by_role("button", name="CSV").click()
    assert saved.value.suggested_filename == "spans_tensions.csv"
    files = (Path(saved.value.path()), results / "tables" / "spans_tensions.csv")
    written, table = (list(csv.reader(io.StringIO(path.read_text(encoding="utf-8")))) for path in files)
    assert written == table


def test_figures_are_saved_as_pictures_and_numbers(page):
    figure = page.page.locator("#spans figure").first
    page.draw_all()
    for name, start in (("SVG", b"<svg"), ("PNG", b"\x89PNG"), ("Data (CSV)", b"x,y,series")):
        with page.page.expect_download() as saved:
            figure.get_by_role("button", name=name).click()
        assert Path(saved.value.path()).read_bytes().startswith(start)


@pytest.mark.parametrize(("locale", "number"), [("en-GB", "10.5"), ("de-DE", "10,5"), ("fr-FR", "10,5")])
def test_numbers_are_written_as_the_browser_s_language_has_them(browser, results, locale, number):
    with opened(browser, results / "report.html", locale=locale) as found:
        found.page.locator("details[data-table]").filter(has_text="Tensions in N").locator("summary").click()
        cells = found.page.locator("details[data-table] td.number").all_inner_texts()
        decimal = number[2]
        assert any(re.fullmatch(rf"\d+\{decimal}\d+", text) for text in cells)
        assert not any(re.search(rf"\d[{'.' if decimal == ',' else ','}]\d\d?$", text) for text in cells)


def test_it_is_read_on_a_phone(browser, results):
    with opened(browser, results / "report.html", viewport={"width": 390, "height": 844}) as found:
        assert all(count > 0 for panels in found.draw_all().values() for count in panels)
        assert found.page.evaluate("document.documentElement.scrollWidth") <= 390
        assert found.said == []


def test_print_has_every_question_and_no_buttons(browser, results):
    with opened(browser, results / "report.html") as found:
        found.draw_all()
        found.page.emulate_media(media="print")
        assert not any(button.is_visible() for button in found.page.locator("button").all())
        assert found.page.locator(".question").is_visible() and found.page.locator(".answer").is_visible()
        assert found.page.pdf().startswith(b"%PDF")


# ---- parts ----

SMALL = """
title: {0}
design: {{grid: {{span: {{start: 1 m, stop: 2 m, num: {1}}}}}}}
fixed: {{line_length: 3 m, weight_per_length: 1 N/m}}
methods: {{exact: {{solver: catenary_exact}}}}
outputs: [sag, profile]
"""


def run(folder: Path, name: str, points: int = 3, title: str = "A scene") -> Path:
    path = folder / f"{name}.yaml"
    path.write_text(SMALL.format(title, points), encoding="utf-8")
    assert main(["run", str(path), "--out", str(folder / "results")]) == 0
    return path


def scenarios_in(page_part: Path) -> dict:
    return unpacked(json.loads(page_part.read_text(encoding="utf-8"))["packed"])["scenarios"]


def unpacked(text: str) -> dict:
    return json.loads(gzip.decompress(base64.b64decode(text)))


def test_scenes_of_a_folder_share_its_page(tmp_path):
    for name in ("second", "first"):
        run(tmp_path, name, title=f"The {name}")
    text = (tmp_path / "results" / "report.html").read_text(encoding="utf-8")
    assert text.index("The first") < text.index("The second")
    assert (tmp_path / "results" / "report.html").stat().st_size < 2e6


def test_a_part_is_made_anew_only_where_its_scene_has_changed(tmp_path, monkeypatch):
    paths = [run(tmp_path, name) for name in ("one", "two")]
    made = []
    monkeypatch.setattr(write, "scene_part", lambda scene, *_: made.append(scene.name) or part.scene_part(scene, *_))
    layout = Layout(tmp_path / "results")
    write.write_page(layout, [read_scene(path) for path in paths])
    assert made == []
    paths[1].write_text(paths[1].read_text() + "answer: Another answer.\n")
    run_step("summarise", read_scene(paths[1]), layout)
    write.write_page(layout, [read_scene(path) for path in paths])
    assert made == ["two"]
    assert "Another answer." in layout.page.read_text(encoding="utf-8")
    # A damaged part is made anew; that of a scene that is not among these is left out.
    layout.page_part("one").write_text("{")
    write.write_page(layout, [read_scene(paths[1])])
    assert 'id="one"' not in layout.page.read_text(encoding="utf-8")
    write.write_page(layout, [read_scene(path) for path in paths])
    assert made == ["two", "one"]


def test_what_is_too_much_for_a_page_is_left_out_and_said(tmp_path, monkeypatch):
    run(tmp_path, "whole")
    whole = scenarios_in(tmp_path / "results" / "report" / "whole.json")
    assert whole["left_out"] == [] and "profiles" in whole
    monkeypatch.setattr(scenarios, "MOST_CURVE_NUMBERS", 3 * 33 * 2 - 1)
    run(tmp_path, "lines")
    lines = scenarios_in(tmp_path / "results" / "report" / "lines.json")
    assert lines["left_out"] == ["the shapes of 3 lines are too many for this page"] and "profiles" not in lines
    assert [output["name"] for output in lines["outputs"]] == ["sag", "run_time"]
    monkeypatch.setattr(scenarios, "MOST_NUMBERS", 5)
    run(tmp_path, "numbers")
    numbers = scenarios_in(tmp_path / "results" / "report" / "numbers.json")
    assert numbers["left_out"] == ["outputs of 3 scenarios are too many for this page"] and numbers["outputs"] == []
    # A command needs the parameters only.
    assert numbers["axes"][0]["parameters"]["span"] == [1.0, 1.5, 2.0]
    monkeypatch.setattr(scenarios, "MOST_POINTS", 2)
    run(tmp_path, "points")
    assert scenarios_in(tmp_path / "results" / "report" / "points.json") == {
        "left_out": ["3 scenarios are too many for this page"]
    }


def test_a_map_of_too_many_cells_is_thinned_and_says_so(results, monkeypatch):
    monkeypatch.setattr(map_panels, "MOST_CELLS", 20)
    scene = read_scene(results.parent / "spans.yaml")
    of_value, of_status = page_figures(scene, read_dataset(results / "spans.nc"))[1:3]
    (panel,) = of_value["panels"]
    rows = panel["data"]["rows"]
    assert panel["title"] == "one in 2 points of each side"
    assert (len(rows["along"]["x"]), len(rows["up"]["y"]), len(rows["cells"]["value"])) == (9, 2, 18)
    # Rise 20 m and span 60 m.
    assert (rows["along"]["x"][2], rows["up"]["y"][1]) == (60, 20)
    assert rows["along"]["scenario"][2] + rows["up"]["scenario"][1] == 2 * 17 + 4
    assert [one["title"] for one in of_status["panels"]] == [
        f"{method}, one in 2 points of each side" for method in ("exact", "near")
    ]


def test_lines_are_held_to_a_part_in_four_thousand(tmp_path):
    run(tmp_path, "line")
    held = scenarios_in(tmp_path / "results" / "report" / "line.json")["profiles"]
    profile = read_dataset(tmp_path / "results" / "line.nc").profile.isel(method=0)
    assert held["components"] == ["x", "z"] and held["length"] == 33
    for curve, (scenario, component) in enumerate(itertools.product(range(3), "xz")):
        steps = np.array(held["values"]).reshape(-1, held["length"])[curve]
        low, high = held["lowest"][curve], held["highest"][curve]
        nodes = np.linspace(0, profile.sizes["node"] - 1, held["length"]).round().astype(int)
        exact = profile.isel(span=scenario, node=nodes).sel(component=component).values
        np.testing.assert_allclose(low + (high - low) * steps / held["steps"], exact, atol=0.51 * (high - low) / 4000)


def test_the_documentation_tells_the_limits_of_the_page():
    text = (Path(__file__).parents[1] / "docs" / "report.md").read_text(encoding="utf-8")
    limits = (scenarios.MOST_NUMBERS, scenarios.MOST_CURVE_NUMBERS, part.MOST_CELLS, map_panels.MOST_CELLS)
    assert [f"{limit:,}" in text for limit in limits] == [True] * 4
