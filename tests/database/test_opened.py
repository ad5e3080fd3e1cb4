"""A study in a notebook: lazy datasets, the catalogue, queries; and nothing is written by looking."""

import subprocess
import sys
import warnings

import dask.array
import numpy as np
import pandas as pd
import pytest
import xarray as xr

from cablesim import open_study
from cablesim.database import CATALOGUE_FILE
from cablesim.database.catalogue import catalogue, write_catalogue
from cablesim.database.reading import read_dataset
from cablesim.errors import EnvironmentFault, InputError
from cablesim.files import discard, enter_in_ledger
from tests.cli.helpers import tree


def test_a_study_is_a_mapping_of_lazy_datasets(stored):
    study = open_study(stored)
    assert sorted(study) == ["angles", "inclined", "spans"]
    dataset = study["spans"]
    assert isinstance(dataset.sag.data, dask.array.Array)
    assert isinstance(dataset.run_time.data, dask.array.Array)
    np.testing.assert_array_equal(dataset.sag.compute(), read_dataset(stored / "spans.nc").sag)


def test_what_is_not_there_is_told_with_the_nearest_name(stored, tmp_path):
    with pytest.raises(InputError, match=r"no scene 'span': did you mean spans\?"):
        open_study(stored)["span"]
    with pytest.raises(InputError, match="no such folder of results"):
        open_study(tmp_path / "nowhere")


def test_a_damaged_dataset_is_the_machines_fault(copy):
    (copy / "spans.nc").write_bytes(b"nothing")
    with pytest.raises(EnvironmentFault, match=r"spans\.nc: damaged"):
        open_study(copy)["spans"]


def test_a_dataset_that_was_copied_without_its_ledger_is_opened(copy):
    (copy / "spans.json").unlink()
    assert open_study(copy)["spans"].sizes["span"] == 3
    (copy / "spans.nc").write_bytes(b"nothing")
    with pytest.raises(EnvironmentFault, match=r"spans\.nc: cannot be read"):
        open_study(copy)["spans"]


def test_a_file_that_is_no_dataset_of_ours_is_told_from_one(copy):
    xr.Dataset({"sag": 1.0}).to_netcdf(copy / "strange.nc")
    xr.Dataset({"run_time": 1.0}).to_netcdf(copy / "strange.nc", group="measured", mode="a")
    with pytest.raises(EnvironmentFault, match=r"strange\.nc: not a dataset of a scene"):
        open_study(copy)["strange"]


def test_the_catalogue_tells_what_the_datasets_hold(stored):
    rows = open_study(stored).catalogue.set_index(["scene", "kind", "name"])
    assert rows.loc[("spans", "scene", "spans"), "number"] == 24
    span = rows.loc[("spans", "axis", "span")]
    assert (span.unit, span.lowest, span.highest, span.number) == ("m", 10, 40, 3)
    weight = rows.loc[("spans", "fixed", "weight_per_length")]
    assert (weight.unit, weight.lowest, weight.highest) == ("N m-1", 5, 5)
    assert rows.loc[("inclined", "parameter", "rise"), "highest"] == 9
    assert rows.loc[("angles", "axis", "friction_law"), "meaning"].endswith(": constant, zero")
    sag = read_dataset(stored / "spans.nc").sag
    stored_sag = rows.loc[("spans", "output", "sag")]
    assert (stored_sag.lowest, stored_sag.highest) == (float(sag.min()), float(sag.max()))
    assert rows.loc[("spans", "output", "profile"), "meaning"].endswith("(over node, component)")
    assert rows.loc[("spans", "measured", "run_time"), "unit"] == "s"
    assert rows.loc[("spans", "status", "infeasible"), "number"] == 6
    assert ("spans", "status", "not_run") not in rows.index
    assert rows.loc[("spans", "method", "exact"), "number"] == 9
    assert rows.loc[("spans", "method", "exact"), "meaning"].startswith("catenary_exact(nodes=5)")


def test_the_catalogue_is_kept_in_one_file_and_can_be_rebuilt(copy):
    written = catalogue(copy)
    pd.testing.assert_frame_equal(pd.read_parquet(copy / CATALOGUE_FILE), written)
    (copy / CATALOGUE_FILE).unlink()
    pd.testing.assert_frame_equal(catalogue(copy), written)
    assert not (copy / CATALOGUE_FILE).exists()
    (copy / CATALOGUE_FILE).write_bytes(b"damaged")
    pd.testing.assert_frame_equal(catalogue(copy), written)
    write_catalogue(copy)
    pd.testing.assert_frame_equal(pd.read_parquet(copy / CATALOGUE_FILE), written)


def test_a_catalogue_that_is_out_of_date_is_not_believed(copy):
    known = catalogue(copy)
    stale = known.assign(number=known.number + 1)
    stale.to_parquet(copy / CATALOGUE_FILE)
    enter_in_ledger(copy / CATALOGUE_FILE)
    assert (catalogue(copy).number == stale.number).all()
    stale.assign(digest=np.where(stale.scene == "spans", "of another file", stale.digest)).to_parquet(
        copy / CATALOGUE_FILE
    )
    enter_in_ledger(copy / CATALOGUE_FILE)
    found = catalogue(copy)
    pd.testing.assert_frame_equal(found[found.scene == "spans"], known[known.scene == "spans"])
    discard(copy / "spans.nc")
    assert "spans" not in catalogue(copy).scene.unique()


def test_a_query_is_a_table_with_units(stored):
    study = open_study(stored)
    table = study.query("spans", "span == 20 m", ["method", "sag"], nearest={"length_ratio": 1.22}, order_by="sag desc")
    assert table.method.tolist() == ["exact", "parabolic"]
    assert table.attrs["units"] == {"sag": "m"}
    assert len(study.query("*", "method == exact", limit=5)) == 5


def test_a_miss_is_a_warning(stored):
    with pytest.warns(UserWarning, match="the neighbours are 20 m and 40 m"):
        assert open_study(stored).query("spans", "span == 23 m").empty
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        open_study(stored).query("spans", "span == 20 m")


def test_a_study_shows_itself(stored):
    study = open_study(stored)
    assert "3 scenes" in repr(study)
    assert "Two spans between supports" in repr(study)
    assert "<table" in study._repr_html_()


def test_looking_writes_nothing(copy):
    before = tree(copy)
    study = open_study(copy)
    study.catalogue, repr(study)
    study["spans"].sag.max().compute()
    study.query("*", "method == exact")
    assert tree(copy) == before


def test_importing_the_package_imports_nothing_heavy():
    script = "import cablesim, sys; print(sorted({'xarray', 'numpy', 'pandas', 'dask'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_an_unknown_name_of_the_package_is_an_attribute_error():
    import cablesim

    with pytest.raises(AttributeError, match="no attribute 'open_studies'"):
        cablesim.open_studies  # noqa: B018
