"""Tow lines in the default study: the handbook's numbers and what is off in them, answers to its tasks; and pictures of
lines of sections, and tables whose lines have names, on scenes small enough to say what must be in them.
"""

import json
import math
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex
from scipy.optimize import brentq

from cablesim.config.scene import read_scene
from cablesim.database.reading import read_dataset
from cablesim.errors import InputError
from cablesim.report.colours import PALETTE
from cablesim.report.figures import draw_figures
from cablesim.report.shapes import draw_profiles
from cablesim.steps import run_scene
from cablesim.study import Layout
from tests.helpers import PUBLISHED, read_table

SCENES = PUBLISHED.parent
AUDITED = (
    "towline_examples",
    "towline_handbook",
    "towline_alpha",
    "tow_wave_height",
    "tow_wave_distances",
    "weight_play_example",
)
ANSWERED = ("towline_tasks", "chain_places", "safe_waves", "weight_play")


@pytest.fixture(scope="module")
def tows(tmp_path_factory) -> Layout:
    """The scenes of tow lines, run."""
    layout = Layout(tmp_path_factory.mktemp("tows"))
    for name in (*AUDITED, *ANSWERED):
        run_scene(read_scene(SCENES / f"{name}.yaml"), layout, lambda step, done, total: None)
    return layout


def audit(layout: Layout, scene: str) -> pd.DataFrame:
    return pd.read_csv(layout.tables / f"{scene}_audit.csv", dtype={"printed": str})


def off(layout: Layout, scene: str) -> list[tuple[str, str]]:
    """The cells that are off: the name of the row, and the column."""
    table = audit(layout, scene)
    wrong = table[table["flag"] != "agrees"]
    return list(zip(wrong.iloc[:, 1].astype(str), wrong["column"], strict=True))


# ---- the handbook's numbers ----


def test_every_printed_distance_between_the_ships_is_exact_to_its_last_digit(tows):
    table = audit(tows, "towline_examples").set_index(["example", "column"])
    for example in ("III", "V-118kN", "V-388kN"):
        assert table.loc[(example, "distance_AB"), "flag"] == "agrees"


def test_the_handbook_s_vertex_is_off_and_with_it_all_that_follows_but_the_distance(tows):
    table = audit(tows, "towline_examples").set_index(["example", "column"])
    assert table.loc[("III", "vertex_distance"), "difference"] == pytest.approx(-0.70, abs=0.005)
    assert table.loc[("V-118kN", "vertex_distance"), "difference"] == pytest.approx(1.54, abs=0.005)
    agree = {column for _, column in table[table["flag"] == "agrees"].index}
    assert agree == {"wire_parameter", "chain_parameter", "distance_AB"}


def test_the_handbook_s_own_steps_give_its_numbers_to_the_rounding_of_its_intermediate_results(tows):
    table = audit(tows, "towline_handbook")
    lengths = table[~table["column"].str.endswith("parameter")]
    assert len(lengths) == 17
    # A unit of a parameter of three digits is 0.2 % of it: 0.04 m of the 21 m of fictive chain.
    assert (lengths["difference"].abs() < 0.04).all()
    assert set(table[table["flag"] != "agrees"]["flag"]) == {"rounded by hand"}


def test_three_printed_coefficients_were_cut_off_instead_of_rounded(tows):
    assert off(tows, "towline_alpha") == [("0.5", "alpha"), ("1.25", "alpha"), ("1.3", "alpha")]


def test_the_worked_example_of_the_wave_height_is_right(tows):
    table = audit(tows, "tow_wave_height").set_index("column")
    assert table["printed"].to_dict() == {
        "elastic_elongation_m": "2.1",
        "weight_elongation_m": "4.6",
        "wave_height_m": "6.7",
    }
    assert set(table["flag"]) == {"agrees"}


def test_three_tasks_print_a_distance_in_the_jerk_that_the_calm_one_contradicts(tows):
    assert off(tows, "tow_wave_distances") == [(task, "distance_jerk_m") for task in ("131", "135", "140")]
    # A taut line's shortfall goes with the inverse square of its tension, whatever its sections weigh: no chain helps.
    cells = read_table(PUBLISHED / "tow_wave_height.csv")
    short = [cells["line_length_m"] - cells[f"distance_{state}_m"] for state in ("calm", "jerk")]
    ratio = (2 * cells["hook_pull_kN"] / cells["breaking_strength_kN"]) ** 2
    contradicted = np.isin(cells["task"], ["131", "135", "140"])
    # All distances are printed to 0.1 m; cut off, each is wrong by up to that.
    far = np.abs(short[1] - short[0] * ratio) > 0.1
    np.testing.assert_array_equal(far, contradicted)


def test_the_weight_play_of_the_example_is_the_difference_of_its_rounded_distances(tows):
    assert off(tows, "weight_play_example") == [("V", "play_m")]
    assert audit(tows, "weight_play_example")["exact"].iloc[-1] == pytest.approx(374.719 - 372.107, abs=1e-3)


# ---- answers to the tasks ----


def answer(wire: float, chain: float, wire_weight: float, chain_weight: float, tension: float) -> tuple[float, float]:
    """Distance and sag of a line of wire and chain with its vertex in the wire, from the arcs of its catenaries."""
    a, c = tension / wire_weight, tension / chain_weight

    def arcs(vertex: float) -> tuple[float, float, float]:
        slope = (wire - vertex) / a
        ends = math.asinh(slope), math.asinh(slope + chain / c)
        below_A = a * (math.cosh(math.asinh(vertex / a)) - 1)
        below_B = a * (math.cosh(ends[0]) - 1) + c * (math.cosh(ends[1]) - math.cosh(ends[0]))
        return a * (math.asinh(vertex / a) + ends[0]) + c * (ends[1] - ends[0]), below_A, below_B

    vertex = brentq(lambda s: arcs(s)[1] - arcs(s)[2], 0.0, wire, xtol=1e-12)
    return arcs(vertex)[:2]


def test_the_answers_to_tasks_121_to_130_are_those_of_the_arcs_of_two_catenaries(tows):
    table = pd.read_csv(tows.tables / "towline_tasks_answers.csv", dtype=str).set_index("task")
    tasks = read_table(PUBLISHED / "towline_tasks.csv")
    assert table.index.tolist() == [str(number) for number in range(121, 131)]
    for i, task in enumerate(table.index):
        lengths = tasks["wire_length_m"][i], tasks["chain_length_m"][i]
        weights = 0.87 * tasks["wire_weight_air_N_m"][i], 0.87 * tasks["chain_weight_air_N_m"][i]
        distance, sag = answer(*lengths, *weights, 1000 * tasks["horizontal_tension_kN"][i])
        assert table.loc[task, "distance AB [m]"] == f"{distance:.2f}"
        assert table.loc[task, "sag [m]"] == f"{sag:.2f}"
        assert table.loc[task, "vertex in section"] == "1"


def test_chain_in_the_middle_gives_the_most_play(tows):
    table = pd.read_csv(tows.tables / "chain_places_places.csv").set_index("place")
    play = table["play left [m]"]
    assert play.idxmax() == "in the middle"
    assert play["at the towed ship"] < play["in the middle"] / 2


def test_more_wire_allows_higher_waves_and_more_pull_lower_ones(tows):
    table = pd.read_csv(tows.tables / "safe_waves_heights.csv").set_index("pull at the hook [kN]")
    assert table.columns[[0, -1]].tolist() == ["wave height [m], wire 200 m", "wave height [m], wire 1000 m"]
    assert (np.diff(table.to_numpy(), axis=1) > 0).all()
    assert (np.diff(table.to_numpy(), axis=0) < 0).all()


def test_the_figures_of_the_tow_lines_are_drawn(tows):
    names = [path.stem for path in tows.figures.glob("*.png") if path.stat().st_size > 10_000]
    assert {"towline_tasks_lines", "chain_places_lines", "safe_waves_height", "weight_play_play"} <= set(names)


# ---- pictures of sections ----

LINE = {
    "title": "Two lines",
    "design": {
        "cases": [
            {"section_length": ["40 m", "5 m"], "section_weight": [80, 600]},
            {"section_length": ["20 m", "5 m", "20 m"], "section_weight": [80, 600, 80]},
        ]
    },
    "fixed": {"horizontal_tension": "10 kN"},
    "methods": {"exact": {"solver": "composite_line", "options": {"nodes": 5}}},
    "outputs": ["lowest_point", "joint_position", "profile", "profile_section", "horizontal_distance"],
}
PANELS = {"kind": "profiles", "at": {"scenario": [0, 1]}, "across": 1, "colour": "section"}


def drawn(folder: Path, scene: dict[str, Any] = LINE, **settings: Any) -> tuple[Any, Any]:
    """The figure of a small scene, and its dataset."""
    path, layout = folder / "small.yaml", Layout(folder / "results")
    path.write_text(json.dumps({**scene, "figures": {"look": {**PANELS, **settings}}}))
    read = read_scene(path)
    run_scene(read, layout, lambda step, done, total: None)
    dataset = read_dataset(layout.dataset("small"))
    return draw_profiles(read, dataset, read.figures[0]), dataset


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


def strokes(axes: Any) -> list[Any]:
    """The lines of sections, without the marks."""
    return [line for line in axes.get_lines() if line.get_linestyle() != "None"]


def legend(figure: Any) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_each_section_has_its_colour_from_joint_to_joint(tmp_path):
    figure, dataset = drawn(tmp_path)
    first, second = figure.axes
    assert [to_hex(line.get_color()) for line in strokes(first)] == [c.lower() for c in PALETTE[:2]]
    assert [to_hex(line.get_color()) for line in strokes(second)] == [c.lower() for c in PALETTE[:3]]
    joints = dataset.joint_position.sel({"method": "exact"}).isel(scenario=1).sel(component=["x", "z"]).values
    for before, after, joint in zip(strokes(second), strokes(second)[1:], joints, strict=False):
        np.testing.assert_array_equal(before.get_xydata()[-1], joint)
        np.testing.assert_array_equal(after.get_xydata()[0], joint)


def test_the_joints_and_the_lowest_point_are_marked(tmp_path):
    figure, dataset = drawn(tmp_path)
    one = dataset.sel({"method": "exact"}).isel(scenario=1).sel(component=["x", "z"])
    marks = [line for line in figure.axes[1].get_lines() if line.get_linestyle() == "None"]
    joints, lowest = (line.get_xydata() for line in marks)
    np.testing.assert_array_equal(joints, one.joint_position.values[:2])
    np.testing.assert_array_equal(lowest, [one.lowest_point.values])
    words = [text.get_text() for text in figure.axes[1].texts]
    x, z = one.lowest_point.values
    assert words == ["A", "B", f"({x:.1f}, −{-z:.2f}) m"]


def test_the_legend_names_sections_and_their_weights(tmp_path):
    figure, _ = drawn(tmp_path)
    assert legend(figure) == [
        "section 1, 80 N m$^{-1}$",
        "section 2, 600 N m$^{-1}$",
        "section 3, 80 N m$^{-1}$",
        "joint",
        "lowest point",
    ]


def test_sections_of_one_weight_may_share_a_colour(tmp_path):
    figure, _ = drawn(tmp_path, colour="weight", names=["wire", "chain"])
    wire, chain = (colour.lower() for colour in PALETTE[:2])
    assert [to_hex(line.get_color()) for line in strokes(figure.axes[1])] == [wire, chain, wire]
    assert legend(figure)[:2] == ["wire, 80 N m$^{-1}$", "chain, 600 N m$^{-1}$"]


def test_curves_of_one_panel_are_told_apart_by_dashes(tmp_path):
    figure, _ = drawn(tmp_path, at={"scenario": [0]}, each={"scenario": [0]})
    assert legend(figure) == ["section 1, 80 N m$^{-1}$", "section 2, 600 N m$^{-1}$", "joint", "lowest point"]
    tensions = {**LINE, "design": {"grid": {"horizontal_tension": ["5 kN", "10 kN"]}}}
    tensions["fixed"] = {"section_length": ["40 m", "5 m"], "section_weight": [80, 600]}
    figure, _ = drawn(tmp_path, tensions, at={"horizontal_tension": ["5 kN"]}, titles=["one"])
    assert [axes.get_title() for axes in figure.axes] == ["one"]
    path = tmp_path / "small.yaml"
    look = {"kind": "profiles", "each": {"horizontal_tension": ["5 kN", "10 kN"]}, "colour": "section"}
    path.write_text(json.dumps({**tensions, "figures": {"look": look}}))
    read = read_scene(path)
    figure = draw_profiles(read, read_dataset(tmp_path / "results" / "small.nc"), read.figures[0])
    assert [line.get_linestyle() for line in strokes(figure.axes[0])] == ["-", "-", "--", "--"]
    assert legend(figure)[-2:] == ["horizontal tension 5 kN, exact", "horizontal tension 10 kN, exact"]


def test_a_stretched_axis_says_so(tmp_path):
    figure, _ = drawn(tmp_path, stretch=3)
    assert figure.get_supylabel() == "height $z$ [m], drawn × 3"
    assert [axes.get_aspect() for axes in figure.axes] == [3.0, 3.0]
    figure, _ = drawn(tmp_path)
    assert figure.get_supylabel() == "height $z$ [m]"
    assert [axes.get_aspect() for axes in figure.axes] == [1.0, 1.0]


def test_a_panel_may_be_stretched_by_a_factor_of_its_own_which_stands_above_it(tmp_path):
    figure, _ = drawn(tmp_path, stretch="auto")
    assert figure.get_supylabel() == "height $z$ [m]"
    for axes in figure.axes:
        stretch, box = axes.get_aspect(), axes.dataLim
        assert axes.get_title(loc="right") == ("" if stretch == 1.0 else f"heights × {stretch:g}")
        # The next factor of 1, 2, 5, 10 would make the panel higher than 0.3 of its width.
        assert stretch == 1.0 or stretch * box.height <= 0.3 * box.width < 2.5 * stretch * box.height
    assert max(axes.get_aspect() for axes in figure.axes) > 1.0


def test_a_line_that_has_no_solution_leaves_its_panel_empty(tmp_path):
    short = {**LINE, "fixed": {"horizontal_distance": "60 m"}, "outputs": LINE["outputs"][:-1]}
    for stretch in (2, "auto"):
        figure, _ = drawn(tmp_path, short, stretch=stretch)
        assert all(strokes(axes) == [] for axes in figure.axes)


def test_contours_are_drawn_on_a_map_and_whole_numbers_get_a_colour_each(tmp_path):
    scene = {
        **LINE,
        "design": {"grid": {"rise": [-30, 0, 30], "horizontal_tension": ["1 kN", "10 kN", "100 kN"]}},
        "fixed": {"section_length": [40, 5], "section_weight": [80, 600]},
        "outputs": ["vertex_section", "horizontal_distance"],
        "figures": {
            "vertex": {"kind": "map", "x": "horizontal_tension", "y": "rise", "value": "vertex_section", "log": "x"},
            "distance": {
                "kind": "map",
                "x": "horizontal_tension",
                "y": "rise",
                "value": "horizontal_distance",
                "contours": [20, 30],
                "x_label": "pull",
            },
        },
    }
    path, layout = tmp_path / "small.yaml", Layout(tmp_path / "results")
    path.write_text(json.dumps(scene))
    run_scene(read_scene(path), layout, lambda step, done, total: None)
    draw_figures(read_scene(path), read_dataset(layout.dataset("small")), layout.figures)
    assert (layout.figures / "small_vertex.png").stat().st_size > 10_000
    assert (layout.figures / "small_distance.png").stat().st_size > 10_000


# ---- tables whose lines have names ----

CASES = "place,wire,chain\nfar,40,5\nnear,30,4\nfar,20,3\n"
NAMED = {
    "title": "Named lines",
    "design": {"cases": {"table": "cases.csv", "columns": {"section_length_1": "wire", "section_length_2": "chain"}}},
    "fixed": {"section_weight": [80, 600], "horizontal_tension": "10 kN"},
    "methods": {"exact": {"solver": "composite_line"}, "even": {"solver": "composite_mean_weight"}},
    "outputs": ["horizontal_distance", "closing_error"],
}


def printed(folder: Path, **settings: Any) -> pd.DataFrame:
    (folder / "cases.csv").write_text(CASES)
    path, layout = folder / "small.yaml", Layout(folder / "results")
    path.write_text(json.dumps({**NAMED, "tables": {"page": settings}}))
    run_scene(read_scene(path), layout, lambda step, done, total: None)
    return pd.read_csv(layout.tables / "small_page.csv", dtype=str)


def test_lines_are_named_by_a_column_of_the_table_of_cases_whose_numbers_may_be_printed_too(tmp_path):
    columns = {"AB": "exact.horizontal_distance", "wire [m]": "table.wire"}
    table = printed(tmp_path, table="cases.csv", rows="place", columns=columns, decimals={"AB": 1, "wire [m]": 0})
    assert table.columns.tolist() == ["place", "AB [m]", "wire [m]"]
    assert table["place"].tolist() == ["far", "near", "far"]
    assert table["wire [m]"].tolist() == ["40", "30", "20"]
    assert all(len(cell.split(".")[1]) == 1 for cell in table["AB [m]"])


@pytest.mark.parametrize("where", ["section_length_1 > 35 m", "table.wire > 35"])
def test_a_condition_leaves_out_lines_of_which_the_table_knows_something(tmp_path, where):
    columns = {"AB": "exact.horizontal_distance", "wire [m]": "table.wire"}
    table = printed(tmp_path, table="cases.csv", rows="place", columns=columns, where=where)
    assert table["wire [m]"].tolist() == ["40.0000"]


def test_parameters_are_called_as_the_table_wants(tmp_path):
    table = printed(
        tmp_path,
        rows="section_length_1",
        across="method",
        columns=["horizontal_distance"],
        words={"section_length_1": "wire", "method": "by"},
    )
    assert table.columns.tolist() == [
        "wire [m]",
        "horizontal_distance [m], by exact",
        "horizontal_distance [m], by even",
    ]


def test_a_rounding_error_below_zero_is_printed_without_a_sign(tmp_path):
    table = printed(tmp_path, rows="scenario", columns={"z": "-exact.closing_error"}, decimals={"z": 2})
    assert set(table["z"]) == {"0.00"}


# ---- wrong input ----


def figure(*phrases: str, base: dict[str, Any] = LINE, **settings: Any) -> tuple[dict[str, Any], tuple[str, ...]]:
    look = {key: value for key, value in {**PANELS, **settings}.items() if value is not None}
    return {**base, "figures": {"look": look}}, phrases


def page(*phrases: str, **settings: Any) -> tuple[dict[str, Any], tuple[str, ...]]:
    look = {"table": "cases.csv", "rows": "place", "columns": ["exact.horizontal_distance"], **settings}
    return {**NAMED, "tables": {"look": {key: value for key, value in look.items() if value is not None}}}, phrases


def relief(*phrases: str, **settings: Any) -> tuple[dict[str, Any], tuple[str, ...]]:
    look = {"kind": "map", "x": "rise", "y": "horizontal_tension", "value": "horizontal_distance", **settings}
    design = {"grid": {"rise": [0, 1], "horizontal_tension": ["1 kN", "2 kN"]}}
    fixed = {"section_length": [40, 5], "section_weight": [80, 600]}
    return {**LINE, "design": design, "fixed": fixed, "figures": {"look": look}}, phrases


def without(output: str) -> dict[str, Any]:
    return {**LINE, "outputs": [name for name in LINE["outputs"] if name != output]}


MANY = {**LINE, "design": {"cases": [{"section_length": [1] * 9, "section_weight": list(range(1, 10))}]}}
FIVE = {**LINE, "methods": {f"m{i}": {"solver": "composite_line"} for i in range(5)}}

WRONG = {
    "an unknown colour": figure("figures.look.colour", "'depth'", "section", colour="depth"),
    "colours without the sections of nodes": figure("look.colour", "profile_section", base=without("profile_section")),
    "colours without joints": figure("look.colour", "joint_position", base=without("joint_position")),
    "colours without the lowest point": figure("look.colour", "lowest_point", base=without("lowest_point")),
    "names without colours": figure("look.names", "'colour'", colour=None, names=["wire", "chain", "wire"]),
    "too few names": figure("look.names", "3, not 2", names=["wire", "chain"]),
    "too many names of weights": figure("look.names", "2, not 3", colour="weight", names=["a", "b", "c"]),
    "a name that is a number": figure("look.names[0]", "text", names=[1, "chain", "wire"]),
    "more sections than colours": figure("look.colour", "9", base=MANY, at={"scenario": [0]}),
    "more weights than colours": figure("look.colour", "9", base=MANY, at={"scenario": [0]}, colour="weight"),
    "more curves than dashes": figure("look.colour", "not 5", base=FIVE),
    "a title too few": figure("look.titles", "2, not 1", titles=["one"]),
    "a title that is a number": figure("look.titles[0]", "text", titles=[121, 122]),
    "no panel across": figure("look.across", "from 1 to 6", across=0),
    "a stretch of nothing": figure("look.stretch", "> 0", "auto", stretch=0),
    "a negative stretch": figure("look.stretch", "> 0", "-2", stretch=-2),
    "a stretch in metres": figure("look.stretch", "'m'", stretch="2 m"),
    "an unknown stretch": figure("look.stretch", "'wide'", stretch="wide"),
    "contours that do not ascend": relief("look.contours", "ascending", contours=[2, 1]),
    "a contour that is a word": relief("look.contours[0]", "deep", contours=["deep"]),
    "no contours": relief("look.contours", "empty", contours=[]),
    "curves drawn in an unknown way": (
        {**NAMED, "figures": {"look": {"kind": "curves", "x": "section_length_1", "y": "1", "draw": "dots"}}},
        ("look.draw", "'dots'", "marks"),
    ),
    "lines named by what no table has": page("tables.look.rows", "'plaice'", "place", rows="plaice"),
    "lines named by a column of no table": page("tables.look.rows", "'place'", table=None),
    "lines of one name with columns across": page(
        "tables.look.rows", "same place", across="method", columns=["horizontal_distance"]
    ),
    "a table of other rows": page("tables.look.table", "same rows", table="longer.csv"),
    "a table that is not there": page("tables.look.table", "no such file", table="lost.csv"),
    "an unknown column of the table": page("tables.look.columns", "table.wirr", columns={"wire": "table.wirr"}),
    "a column of no table": page(
        "tables.look.columns", "table.wire", rows="scenario", table=None, columns=["table.wire"]
    ),
    "decimals of no column": page(
        "tables.look.decimals.AC", "AC", columns={"AB": "exact.closing_error"}, decimals={"AC": 1}
    ),
    "half a decimal": page("decimals.AB", "0.5", columns={"AB": "exact.closing_error"}, decimals={"AB": 0.5}),
    "minus one decimal": page("decimals.AB", "-1", columns={"AB": "exact.closing_error"}, decimals={"AB": -1}),
    "words for what is not shown": page("tables.look.words.rise", "rise", words={"rise": "height"}),
    "a number for a word": page("tables.look.words.scenario", "text", words={"scenario": 3}),
}


@pytest.mark.parametrize(("scene", "phrases"), WRONG.values(), ids=WRONG.keys())
def test_a_scene_is_refused_that_has(scene, phrases, tmp_path):
    (tmp_path / "cases.csv").write_text(CASES)
    (tmp_path / "longer.csv").write_text(CASES + "there,1,1\n")
    path = tmp_path / "asked.yaml"
    path.write_text(json.dumps(scene, indent=1))
    with pytest.raises(InputError) as refused:
        read_scene(path)
    for phrase in ("asked.yaml:", *phrases):
        assert phrase in str(refused.value)
