"""Queries: what is found is what a look at every scenario finds, however the dataset is cut into blocks."""

import io
import json
from pathlib import Path

import numpy as np
import openpyxl
import pandas as pd
import pyarrow.parquet as pq
import pytest
import xarray as xr

from cablesim.database import answers, query, scan
from cablesim.database.query import Order, Request, ask
from cablesim.database.reading import open_scenes, read_dataset
from cablesim.errors import InputError
from tests.database.conftest import run

CONDITIONS = [
    None,
    "sag > 3 m",
    "span == 20 m",
    "span > 10 and length_ratio < 1.25 and method == exact",
    "status == infeasible",
    "not status == ok and span != 40",
    "sag > 2 or span == 10",
    "exact.sag > 1.01 * parabolic.sag",
    "exact.sag > parabolic.sag and method == parabolic",
    "1 < 2",
    "weight_per_length == 5 N/m and length_ratio >= 1.2",
    "2 < 1",
    "method == exact or length_ratio > 1.2",
]


def found(results: Path, scene: str, **request) -> pd.DataFrame:
    return ask(open_scenes(results, scene), Request(**request), skipping="*" in scene).table()


def by_hand(dataset: xr.Dataset, condition: str | None) -> list[tuple]:
    """The scenarios for which a condition holds, by a look at each."""
    rows = []
    for index in np.ndindex(dataset.status.shape):
        point = dataset.isel(dict(zip(dataset.status.dims, index, strict=True)))
        beside = {m: float(dataset.sag.sel({"method": m})[index[1:]]) for m in dataset.method.values.tolist()}
        status = dataset.status.attrs["flag_meanings"].split()[int(point.status)]
        names = {"sag": float(point.sag), "span": float(point.span), "ratio": float(point.length_ratio)}
        if holds(condition, {**names, "method": str(point.method.values), "status": status, "beside": beside}):
            rows.append((names["span"], names["ratio"], str(point.method.values)))
    return rows


def holds(condition: str | None, at: dict) -> bool:
    """The conditions above once more, in Python."""
    exact, parabolic = at["beside"]["exact"], at["beside"]["parabolic"]
    return {
        None: True,
        "sag > 3 m": at["sag"] > 3,
        "span == 20 m": at["span"] == 20,
        CONDITIONS[3]: at["span"] > 10 and at["ratio"] < 1.25 and at["method"] == "exact",
        "status == infeasible": at["status"] == "infeasible",
        CONDITIONS[5]: at["status"] != "ok" and at["span"] != 40,
        CONDITIONS[6]: at["sag"] > 2 or at["span"] == 10,
        CONDITIONS[7]: exact > 1.01 * parabolic,
        CONDITIONS[8]: exact > parabolic and at["method"] == "parabolic",
        "1 < 2": True,
        CONDITIONS[10]: at["ratio"] >= 1.2,
        "2 < 1": False,
        CONDITIONS[12]: at["method"] == "exact" or at["ratio"] > 1.2,
    }[condition]


@pytest.mark.parametrize("block", [1, 3, 7, 2**20])
@pytest.mark.parametrize("condition", CONDITIONS)
def test_a_query_finds_what_a_look_at_every_scenario_finds(stored, monkeypatch, condition, block):
    monkeypatch.setattr(scan, "BLOCK", block)
    dataset = read_dataset(stored / "spans.nc")
    table = found(stored, "spans", condition=condition)
    rows = list(zip(table.span, table.length_ratio, table.method, strict=True))
    assert sorted(rows) == sorted(by_hand(dataset, condition))
    for row in table.itertuples():
        own = dataset.sag.sel({"method": row.method, "span": row.span, "length_ratio": row.length_ratio})
        np.testing.assert_equal(row.sag, float(own))


@pytest.mark.parametrize("block", [1, 2**20])
def test_only_where_a_condition_may_hold_is_anything_read(stored, monkeypatch, block):
    monkeypatch.setattr(scan, "BLOCK", block)
    pieces = []
    read = scan.read

    def spied(values, points):
        if values.name == "sag":
            pieces.append({dim: own.tolist() for dim, own in points.items() if own.size})
        return read(values, points)

    monkeypatch.setattr(scan, "read", spied)
    monkeypatch.setattr(query, "read", spied)
    found(stored, "spans", condition="span == 20 m and method == exact and sag > 1")
    assert [piece for piece in pieces if piece]
    assert all(piece["span"] == [1] and piece["method"] == [0] for piece in pieces if piece)


def test_the_nearest_is_taken_on_each_axis_of_a_grid(stored):
    table = found(stored, "spans", near=(("span", "2.3e3 cm"), ("length_ratio", "1.16")))
    assert table[["method", "span", "length_ratio"]].values.tolist() == [["exact", 20, 1.2], ["parabolic", 20, 1.2]]


def test_the_nearest_of_cases_is_taken_by_all_values_together(stored):
    # In parts of their ranges, the third case is 0.033 and 0.67 from these values, the second 0.97 and 0.
    table = found(stored, "inclined", near=(("span", "39"), ("rise", "3")))
    assert table[["span", "rise"]].values.tolist() == [[40, 3]]


def test_points_that_are_equally_near_are_all_kept(stored):
    assert found(stored, "spans", near=(("span", "15 m"),)).span.unique().tolist() == [10, 20]
    assert found(stored, "inclined", near=(("span", "11 m"),)).rise.tolist() == [0, 3]


def test_conditions_on_parameters_go_before_the_nearest(stored):
    table = found(stored, "spans", condition="span < 15 m", near=(("span", "30 m"),))
    assert table.span.unique().tolist() == [10]


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("spam", "3", "nearest spam: no such parameter: did you mean span?"),
        ("sag", "3", "nearest sag: no such parameter"),
        ("method", "exact", "nearest method: no such parameter"),
        ("span", "3 kg", "nearest span: the unit 'kg' is of another dimension"),
        ("span", "wide", "nearest span: 'wide' is not a number"),
    ],
)
def test_the_nearest_of_what_is_no_parameter_is_refused(stored, name, value, message):
    with pytest.raises(InputError, match=message):
        found(stored, "spans", near=((name, value),))


@pytest.mark.parametrize("limit", [None, 1, 4, 1000])
@pytest.mark.parametrize("block", [1, 5, 2**20])
def test_an_order_is_that_of_a_stable_sort(stored, monkeypatch, limit, block):
    whole = found(stored, "spans")
    monkeypatch.setattr(scan, "BLOCK", block)
    ours = found(stored, "spans", order=(Order("sag / span", True), Order("method")), limit=limit)
    keys = whole.assign(key=whole.sag / whole.span)
    expected = keys.sort_values(["key", "method"], ascending=[False, True], kind="stable").drop(columns="key")
    pd.testing.assert_frame_equal(ours, expected.head(limit or len(expected)).reset_index(drop=True))


def test_an_order_is_read_with_its_sense():
    assert Order.read("sag desc") == Order("sag", True)
    assert Order.read(" sag / span asc ") == Order("sag / span")
    assert Order.read("desc") == Order("desc")


def test_a_limit_without_an_order_takes_the_first(stored):
    whole = found(stored, "spans", condition="sag > 1")
    pd.testing.assert_frame_equal(found(stored, "spans", condition="sag > 1", limit=3), whole.head(3))
    with pytest.raises(InputError, match="at least 1, not 0"):
        found(stored, "spans", limit=0)


def test_several_scenes_are_asked_at_once_for_what_they_share(stored):
    table = found(stored, "spans,inclined", condition="span == 40 m and status == ok and method == exact")
    assert table.scene.tolist() == ["spans"] * 3 + ["inclined"]
    assert list(table) == ["scene", "method", "span", "length_ratio", "sag", "max_tension", "status", "run_time"]
    best = found(stored, "spans,inclined", order=(Order("max_tension", True),), limit=2, columns=("max_tension",))
    alone = pd.concat([found(stored, scene) for scene in ("spans", "inclined")])
    assert best.max_tension.tolist() == alone.max_tension.nlargest(2).tolist()


def test_what_varies_in_one_scene_and_is_fixed_in_another_is_a_column(stored, tmp_path):
    for name in "ab":
        (tmp_path / f"{name}.yaml").write_text(
            f"title: {name}\ndesign: {{grid: {{{'span' if name == 'a' else 'line_length'}: [20, 25]}}}}\n"
            f"fixed: {{{'line_length: 30' if name == 'a' else 'span: 20'}, weight_per_length: {name == 'a' or 2:d}}}\n"
            "methods: {exact: {solver: catenary_exact}}\noutputs: [sag]\n"
        )
        run(tmp_path / f"{name}.yaml", tmp_path / "results")
    table = found(tmp_path / "results", "a,b")
    parameters = ["scene", "span", "line_length", "weight_per_length"]
    assert set(parameters) < set(table)
    assert table[parameters].values.tolist() == [["a", 20, 30, 1], ["a", 25, 30, 1], ["b", 20, 20, 2], ["b", 20, 25, 2]]


def test_a_pattern_asks_the_scenes_that_know_the_names(stored):
    answer = ask(open_scenes(stored, "*"), Request("rise == 3 m"), skipping=True)
    assert answer.table().scene.unique().tolist() == ["inclined"]
    assert sorted(answer.left_out) == ["angles", "spans"]
    with pytest.raises(InputError, match="unknown name 'ris': did you mean rise"):
        ask(open_scenes(stored, "incl*"), Request("ris == 3 m"), skipping=True)
    with pytest.raises(InputError, match="scene spans: unknown name 'rise'"):
        ask(open_scenes(stored, "spans,inclined"), Request("rise == 3 m"))
    with pytest.raises(InputError, match=r"no scene 'incline': did you mean inclined\?"):
        open_scenes(stored, "spans,incline")


@pytest.mark.parametrize(
    ("scene", "condition", "note"),
    [
        ("spans", "span == 23 m", "no scenario has span = 23 m: the neighbours are 20 m and 40 m"),
        (
            "spans",
            "span == 0.023 km and sag > 1",
            "no scenario has span = 0.023 km: the neighbours are 0.02 km and 0.04 km",
        ),
        ("spans", "5 == span", "no scenario has span = 5 m: nearest is 10 m"),
        ("spans", "length_ratio == 1.15", "no scenario has length_ratio = 1.15: the neighbours are 1.1 and 1.2"),
        ("spans", "weight_per_length == 6 N/m", "no scenario has weight_per_length = 6 N/m: nearest is 5 N/m"),
        ("angles", "angle == 40 deg", "no scenario has angle = 40 deg: the neighbours are 30 deg and 45 deg"),
        ("inclined", "rise == 4", "no scenario has rise = 4 m: the neighbours are 3 m and 9 m"),
    ],
)
def test_a_value_that_no_scenario_has_is_told_with_its_neighbours(stored, scene, condition, note):
    answer = ask(open_scenes(stored, scene), Request(condition))
    assert len(answer.table()) == 0
    assert answer.notes == (note,)


@pytest.mark.parametrize("condition", ["span == 20 m", "span > 100 m", "sag == 23", "method == exact and span == 10"])
def test_nothing_is_told_of_what_is_there_or_was_not_asked_by_value(stored, condition):
    assert ask(open_scenes(stored, "spans"), Request(condition)).notes == ()


def written(results: Path, form: str, units: bool = True, **request) -> bytes:
    stream = io.BytesIO()
    answers.prepare(open_scenes(results, "spans"), Request(**request), form, False)[1](stream, units)
    return stream.getvalue()


@pytest.mark.parametrize("block", [3, 2**20])
@pytest.mark.parametrize("condition", ["sag > 1 or status == infeasible", "sag > 1000 m"])
def test_every_format_holds_the_same_rows(stored, monkeypatch, block, condition):
    whole = found(stored, "spans", condition=condition)
    monkeypatch.setattr(scan, "BLOCK", block)
    csv = pd.read_csv(io.BytesIO(written(stored, "csv", condition=condition)), skiprows=[1], dtype=str)
    bare = pd.read_csv(io.BytesIO(written(stored, "csv", units=False, condition=condition)), dtype=str)
    parquet = pd.read_parquet(io.BytesIO(written(stored, "parquet", condition=condition)))
    told = json.loads(written(stored, "json", condition=condition))
    sheet = openpyxl.load_workbook(io.BytesIO(written(stored, "excel", condition=condition))).active
    excel = [[np.nan if cell is None else cell for cell in row] for row in sheet.iter_rows(min_row=3, values_only=True)]
    tables = [
        csv,
        bare,
        parquet,
        pd.DataFrame(told["rows"], columns=list(whole)),
        pd.DataFrame(excel, columns=list(whole)),
    ]
    for table in tables:
        assert table.columns.tolist() == whole.columns.tolist()
        assert len(table) == len(whole)
        for name in ("method", "status"):
            assert table[name].tolist() == whole[name].tolist()
        for name in ("span", "sag", "max_tension"):
            # Sheets have sixteen digits.
            within = 1e-15 if table is tables[-1] else 0.0
            np.testing.assert_allclose(table[name].astype(float), whole[name], rtol=within)


def test_units_go_along(stored):
    assert written(stored, "csv", columns=("method", "span", "sag")).splitlines()[:2] == [b"method,span,sag", b",m,m"]
    schema = pq.read_schema(io.BytesIO(written(stored, "parquet", columns=("sag", "method"))))
    assert schema.field("sag").metadata == {b"units": b"m"}
    assert json.loads(written(stored, "json", columns=("max_tension",)))["units"] == {"max_tension": "N"}
    sheet = openpyxl.load_workbook(io.BytesIO(written(stored, "excel", columns=("method", "span")))).active
    assert [[cell.value for cell in row] for row in sheet["A1:B2"]] == [["method", "span"], [None, "m"]]


@pytest.mark.parametrize("form", ["netcdf", "table", "csv"])
def test_an_answer_of_no_scenario_is_an_answer(stored, form):
    assert written(stored, form, condition="sag > 1000 m")


@pytest.mark.parametrize("block", [1, 20, 2**20])
def test_profiles_are_those_of_the_scenarios_in_their_order(stored, monkeypatch, block, tmp_path):
    monkeypatch.setattr(scan, "BLOCK", block)
    request = {"condition": "status == ok", "order": (Order("sag", True),), "limit": 7}
    (tmp_path / "answer.nc").write_bytes(written(stored, "netcdf", **request))
    dataset, whole = xr.load_dataset(tmp_path / "answer.nc"), read_dataset(stored / "spans.nc")
    assert dataset.sizes["scenario"] == 7
    for row in range(7):
        one = dataset.isel(scenario=row)
        key = {"method": str(one.method.values), "span": one.span, "length_ratio": one.length_ratio}
        np.testing.assert_array_equal(one.profile, whole.profile.sel(key))


def test_what_does_not_fit_into_memory_is_refused_before_it_is_there(stored, monkeypatch):
    monkeypatch.setattr(query, "MOST_BYTES", 2**10)
    monkeypatch.setattr(scan, "BLOCK", 4)
    with pytest.raises(InputError, match="narrow it, choose columns or give a limit"):
        found(stored, "spans")
    with pytest.raises(InputError, match="narrow it"):
        written(stored, "csv", order=(Order("sag"),))
    assert len(written(stored, "csv").splitlines()) == 26
    assert len(found(stored, "spans", order=(Order("sag"),), limit=2)) == 2


def test_a_sheet_has_only_so_many_rows(stored, monkeypatch):
    monkeypatch.setattr(answers, "EXCEL_ROWS", 10)
    with pytest.raises(InputError, match="a sheet has 10 rows"):
        written(stored, "excel")


def test_without_its_package_excel_is_refused_with_the_remedy(stored, monkeypatch):
    monkeypatch.setattr(answers, "find_spec", lambda name: None)
    with pytest.raises(answers.EnvironmentFault, match=r"pip install cablesim\[excel\]"):
        written(stored, "excel")
