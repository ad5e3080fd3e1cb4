"""Answers: text with formulas over all scenarios, checked when a scene is read and computed from its dataset."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from cablesim.config.scene import read_scene
from cablesim.database.reading import read_dataset
from cablesim.report.answer import answer
from cablesim.steps import run_scene
from cablesim.study import Layout

# Lines of the second length are too short, those of the third where there is a rise.
SPANS: dict[str, Any] = {
    "title": "Spans",
    "question": "How deep do they hang?",
    "design": {"grid": {"rise": ["0 m", "4 m"], "length_ratio": [1.3, 0.9, 1.05, 1.2]}},
    "fixed": {"span": "10 m", "weight_per_length": "2 N/m"},
    "methods": {"exact": {"solver": "catenary_exact"}, "level": {"solver": "catenary_parabolic", "ignores": ["rise"]}},
    "reference": "exact",
    "outputs": ["sag", "max_tension", "profile"],
    "checks": {"shallow": "sag < 4 m"},
}


def scene(folder: Path, told: str | None, **parts: Any) -> Path:
    path = folder / "spans.yaml"
    path.write_text(json.dumps(SPANS | ({} if told is None else {"answer": told}) | parts, indent=1))
    return path


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> xr.Dataset:
    folder = tmp_path_factory.mktemp("answers")
    layout = Layout(folder / "results")
    run_scene(read_scene(scene(folder, None)), layout, lambda step, done, total: None)
    return read_dataset(layout.dataset("spans"))


def told(folder: Path, dataset: xr.Dataset, text: str, **parts: Any) -> str:
    return answer(read_scene(scene(folder, text, **parts)), dataset)


# ---- values ----


def exact(dataset: xr.Dataset, name: str = "sag") -> xr.DataArray:
    return dataset[name].sel({"method": "exact"})


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("largest(exact.sag)", lambda d: np.nanmax(exact(d))),
        ("smallest(exact.sag)", lambda d: np.nanmin(exact(d))),
        ("median(exact.sag)", lambda d: np.nanmedian(exact(d))),
        ("mean(exact.sag)", lambda d: np.nanmean(exact(d))),
        ("largest(sag)", lambda d: np.nanmax(d.sag)),
        ("largest(exact.sag, rise == 4 m)", lambda d: np.nanmax(exact(d).sel(rise=4))),
        ("largest(exact.sag) / span", lambda d: np.nanmax(exact(d)) / 10),
        ("largest(abs(1 - level.sag / exact.sag))", lambda d: np.nanmax(abs(1 - d.sag[1] / d.sag[0]))),
        ("value(exact.sag, rise == 400 cm and length_ratio == 1.2)", lambda d: exact(d).sel(rise=4, length_ratio=1.2)),
        ("at_largest(exact.max_tension, length_ratio)", lambda d: 1.05),
        ("at_smallest(exact.max_tension, length_ratio, length_ratio < 1.25)", lambda d: 1.2),
        ("share(exact.sag > 0 m)", lambda d: np.isfinite(exact(d)).mean()),
        ("share(sag > 0, method == level)", lambda d: 0.75),
        ("scenarios", lambda d: 8),
        ("largest(rise, exact.sag > 0)", lambda d: 4),
        ("largest(exact.sag - median(exact.sag))", lambda d: np.nanmax(exact(d)) - np.nanmedian(exact(d))),
    ],
)
def test_a_formula_over_all_scenarios_has_one_value(formula, expected, dataset, tmp_path):
    assert told(tmp_path, dataset, f"{{{formula}:.12g}}") == f"{float(expected(dataset)):.12g}"


@pytest.mark.parametrize(
    ("condition", "number"),
    [
        ("status == ok", 11),
        ("status == infeasible", 5),
        ("rise == 4 m", 4),
        ("rise == 4 m and length_ratio > 1.1", 2),
        ("method == exact", 8),
        ("exact.shallow == passed", 5),
    ],
)
def test_count_is_of_scenarios(condition, number, dataset, tmp_path):
    assert told(tmp_path, dataset, f"{{count({condition}):d}}") == str(number)
