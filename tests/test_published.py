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
