"""The default study's published tables: reproduced cell by cell, and what is wrong in them found by the audit."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from cablesim.config.scene import read_scene
from cablesim.database.reading import read_dataset
from cablesim.report.audit import audit_table
from cablesim.report.tables import error_table
from cablesim.steps import run_scene
from cablesim.study import Layout

SCENES = Path(__file__).parent.parent / "config" / "scenes"


@pytest.fixture(scope="module")
def audits(tmp_path_factory) -> dict[str, pd.DataFrame]:
    layout = Layout(tmp_path_factory.mktemp("published"))
    found = {}
    for name in ("formula_error", "sag_experiment", "catenary_factors"):
        scene = read_scene(SCENES / f"{name}.yaml")
        run_scene(scene, layout, lambda step, done, total: None)
        dataset = read_dataset(layout.dataset(name))
        found[name] = audit_table(scene, dataset)
        found[f"{name} errors"] = error_table(scene, dataset)
    return found


def flagged(audit: pd.DataFrame, flag: str) -> set[tuple[str, str]]:
    """Cells with a flag, by the first column of their row and their own column."""
    chosen = audit[audit["flag"] == flag]
    return set(zip(chosen.iloc[:, 1], chosen["column"], strict=True))


def test_table_2_is_reproduced_but_for_the_sag_error_at_1_01(audits):
    audit = audits["formula_error"]
    assert len(audit) == 16
    assert flagged(audit, "misprint") == {("1.01", "sag_error_percent")}
    assert audit["exact"].iloc[0] == pytest.approx(0.348, abs=5e-4)


def test_table_1_is_reproduced_in_every_cell(audits):
    assert len(audits["sag_experiment"]) == 12
    assert set(audits["sag_experiment"]["flag"]) == {"agrees"}


def test_the_measured_sag_is_within_six_percent_of_the_exact_one(audits):
    errors = audits["sag_experiment errors"].set_index("method")
    assert errors.loc["exact", "relative max"] == pytest.approx(0.0605, abs=5e-5)
    assert errors.loc["exact", "worst at"] == "length_ratio=1.1"


def test_the_audit_finds_the_misprints_of_the_catenary_factors(audits):
    known = {
        ("0.900", "tan_alpha"),
        ("0.550", "sag_over_length"),
        ("0.500", "sag_over_length"),
        ("0.100", "sag_over_length"),
        ("0.230", "phi"),
        ("0.450", "span_over_sag"),
        ("0.030", "span_over_sag"),
        # Not in any list we were given:
        ("0.650", "tan_alpha"),
        ("0.400", "tan_alpha"),
        ("0.270", "tan_alpha"),
        ("0.200", "phi"),
        ("0.200", "cos_alpha"),
        ("0.150", "cos_alpha"),
        ("0.995", "phi"),
        ("0.995", "sag_over_length"),
        ("0.995", "span_over_sag"),
    }
    assert flagged(audits["catenary_factors"], "misprint") == known


def test_every_cell_off_by_more_than_a_unit_is_flagged(audits):
    audit = audits["catenary_factors"]
    off = audit["units_off"].abs() > 1.0 + 1e-9
    assert off.sum() > 100
    assert not (audit.loc[off, "flag"] == "agrees").any()


def test_a_rounded_key_explains_the_cells_that_are_blamed_on_it(audits):
    audit = audits["catenary_factors"]
    blamed = audit[(audit["flag"] == "rounded key") & (audit["column"] != "span_over_length")]
    printed = blamed["printed"].astype(float)
    # A key of three digits moves the other cells by 0.7 % at most (phi = 0.080 may be anything from 0.0795 to 0.0805).
    np.testing.assert_allclose(printed, blamed["exact_at_argument"], rtol=7e-3)
    assert set(audit.loc[audit["row"].isin([1, 2, 3, 4, 6, 7]), "row_argument"]) == {"phi"}


def test_the_printed_argument_is_named_where_it_contradicts_the_row(audits):
    rounded = flagged(audits["catenary_factors"], "rounded key")
    assert {("0.996", "span_over_length"), ("0.995", "span_over_length")} <= rounded


@pytest.fixture(scope="module")
def stream(tmp_path_factory) -> Layout:
    """The scenes of Pode's method and of the segment method, run."""
    layout = Layout(tmp_path_factory.mktemp("stream"))
    for name in ("pode_published", "pode_example", "pode_example_shape", "segment_error"):
        run_scene(read_scene(SCENES / f"{name}.yaml"), layout, lambda step, done, total: None)
    return layout


def table(layout: Layout, name: str) -> pd.DataFrame:
    return pd.read_csv(layout.tables / f"{name}.csv")


def test_the_printed_functions_of_pode_are_reproduced_in_every_digit(stream):
    audit = table(stream, "pode_published_audit")
    from_tables = audit[audit["row"] <= 4]
    assert len(from_tables) == 10
    assert set(from_tables["flag"]) == {"agrees"}
    assert (from_tables["units_off"].abs() < 0.5).all()


def test_functions_that_were_interpolated_by_hand_are_off_and_called_so(stream):
    audit = table(stream, "pode_published_audit")
    by_hand = audit[audit["row"] >= 6]
    assert set(by_hand["flag"]) == {"interpolated by hand"}
    assert (by_hand["units_off"].abs() > 50).all()


def test_example_4_of_pode_is_solved_and_the_errors_of_the_handbook_are_shown(stream):
    audit = table(stream, "pode_example_audit").set_index("column")
    exact = {
        "angle_B_deg": (31.0646, 5e-5),
        "angle_A_deg": (208.5557, 5e-5),
        "lowest_x_m": (-21.499, 5e-4),
        "lowest_y_m": (-7.981, 5e-4),
        "farthest_x_m": (-33.891, 5e-4),
        "farthest_y_m": (0.886, 5e-4),
    }
    for column, (value, half_digit) in exact.items():
        assert audit.loc[column, "exact"] == pytest.approx(value, abs=half_digit)
    np.testing.assert_allclose(audit["difference"], audit["printed"] - audit["exact"], rtol=1e-3)
    assert set(audit["flag"]) == {"off by interpolation"}


def test_interpolation_in_a_table_of_whole_degrees_gives_the_angles_of_the_handbook(stream):
    results = table(stream, "pode_example_results").set_index("method")
    assert results.loc["table_1_deg", "angle_B_deg"] == pytest.approx(31.09, abs=5e-3)
    assert results.loc["table_1_deg", "angle_A_deg"] == pytest.approx(208.43, abs=5e-3)
    # Its points are the handbook's to 1 cm, because the handbook rounds on the way.
    assert results.loc["table_1_deg", "lowest_x_m"] == pytest.approx(-21.563, abs=1e-2)
    assert results.loc["table_1_deg", "farthest_x_m"] == pytest.approx(-33.964, abs=1.1e-2)


@pytest.mark.parametrize(("variant", "order"), [("euler", 1.0), ("midpoint", 2.0)])
def test_the_measured_order_of_the_segment_method_is_that_of_its_variant(variant, order, stream):
    orders = table(stream, "segment_error_orders")
    fine = orders[orders["series"].str.endswith(f"variant={variant}") & (orders["value"] >= 64)]
    assert len(fine) == 4 * 3
    np.testing.assert_allclose(fine["order"], order, atol=0.05)


def test_the_figures_of_example_4_and_of_the_segment_errors_are_drawn(stream):
    figures = ("pode_example_shape_shape", "pode_example_force", "segment_error_segments", "segment_error_diagram")
    assert all((stream.figures / f"{name}.png").stat().st_size > 10_000 for name in figures)
