"""What changed between two runs of a study: scenes and scenarios added or removed, values and statuses that differ.

Scenarios are matched by their parameters, to the last bit, not by their position. Measured times do not count.
"""

from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from cablesim.database.collect import RUN_TIME, TIMED
from cablesim.database.query import query
from cablesim.database.reading import read_dataset, running_numbers, scene_paths, with_components

MEASURED_NAMES = {RUN_TIME, *TIMED}


def compare(results_a: Path, results_b: Path, tolerance: float = 0.0) -> pd.DataFrame:
    """A row for each scene and output of either folder; `differs` says whether anything but times did.

    `tolerance` is the relative change up to which two values count as the same.
    """
    a, b = scene_paths(results_a), scene_paths(results_b)
    rows: list[dict[str, object]] = []
    for scene in sorted(a.keys() | b.keys()):
        if scene in a and scene in b:
            rows += _compare_scene(scene, read_dataset(a[scene]), read_dataset(b[scene]), tolerance)
        else:
            where = "only in A" if scene in a else "only in B"
            rows.append({"scene": scene, "output": where, "differs": True})
    columns = [
        "scene",
        "output",
        "in both",
        "removed",
        "added",
        "beyond tolerance",
        "largest change",
        "relative",
        "differs",
    ]
    return pd.DataFrame(rows, columns=columns)


def _compare_scene(scene: str, a: xr.Dataset, b: xr.Dataset, tolerance: float) -> list[dict[str, object]]:
    a, b = _equally_wide(a, b)
    keys = _keys(a)
    if keys != _keys(b):
        differing = ", ".join(sorted(keys ^ _keys(b)))
        return [{"scene": scene, "output": f"other parameters: {differing}", "differs": True}]
    both = _scenarios(a, keys).merge(_scenarios(b, keys), on=sorted(keys), how="outer", indicator="side")
    removed, added = int((both["side"] == "left_only").sum()), int((both["side"] == "right_only").sum())
    both = both[both["side"] == "both"]
    in_a, in_b = (both[f"place_{side}"].to_numpy(dtype=np.int64) for side in ("x", "y"))
    shared = {"scene": scene, "in both": len(both), "removed": removed, "added": added}
    rows: list[dict[str, object]] = []
    for output in sorted(_outputs(a) | _outputs(b)):
        if output not in _outputs(a) or output not in _outputs(b):
            where = "only in A" if output in _outputs(a) else "only in B"
            rows.append({**shared, "output": f"{output} ({where})", "differs": True})
            continue
        values_a, values_b = _by_scenario(a, output), _by_scenario(b, output)
        if values_a.shape[1] != values_b.shape[1]:
            rows.append({**shared, "output": f"{output} (other sizes)", "differs": True})
            continue
        change = _change(values_a[in_a], values_b[in_b], tolerance)
        rows.append(
            {**shared, "output": output, **change, "differs": bool(change["beyond tolerance"] or removed or added)}
        )
    return rows


def _equally_wide(a: xr.Dataset, b: xr.Dataset) -> tuple[xr.Dataset, xr.Dataset]:
    """Both with as many sections as the longest line of either has."""
    if "section" not in a.coords or "section" not in b.coords:
        return a, b
    sections = max(a.section.values, b.section.values, key=len)
    return a.reindex(section=sections), b.reindex(section=sections)


def _scenarios(dataset: xr.Dataset, keys: set[str]) -> pd.DataFrame:
    """The parameters of every scenario, and its place in the dataset."""
    table = query(dataset, None, tuple(sorted(keys)))
    return table.assign(place=np.arange(len(table)))


def _keys(dataset: xr.Dataset) -> set[str]:
    """What identifies a scenario: its method and parameters, not its running number."""
    dataset, scenario_dims = with_components(dataset), set(dataset.status.dims)
    return {str(name) for name in dataset.coords if set(dataset[name].dims) <= scenario_dims} - running_numbers(dataset)


def _outputs(dataset: xr.Dataset) -> set[str]:
    return {str(name) for name in dataset.data_vars} - MEASURED_NAMES


def _by_scenario(dataset: xr.Dataset, output: str) -> np.ndarray:
    """Values of shape (scenario, number of values in one scenario)."""
    values = dataset[output].transpose(*dataset.status.dims, ...).values
    return values.reshape(dataset.status.size, -1)


def _change(a: np.ndarray, b: np.ndarray, tolerance: float) -> dict[str, float | int]:
    """How many scenarios changed beyond the tolerance, and the largest change of any of their values."""
    if a.dtype.kind != "f":
        return {"beyond tolerance": int((a != b).any(axis=1).sum())}
    same = (a == b) | (np.isnan(a) & np.isnan(b))
    with np.errstate(divide="ignore", invalid="ignore"):
        absolute = np.where(same, 0.0, np.abs(b - a))
        relative = np.where(same, 0.0, absolute / np.maximum(np.abs(a), np.abs(b)))
    beyond = (~same & ~(relative <= tolerance)).any(axis=1)
    return {
        "beyond tolerance": int(beyond.sum()),
        "largest change": float(np.nanmax(absolute, initial=0.0)),
        "relative": float(np.nanmax(relative, initial=0.0)),
    }
