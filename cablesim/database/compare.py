"""What changed between two runs of a study: scenes and scenarios added or removed, values and statuses that differ.

Scenarios are matched by their parameters, to the last bit, not by their position. Measured times do not count.
"""

from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from cablesim.database.query import query
from cablesim.database.reading import read_dataset, scene_paths


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
    keys = sorted(_keys(a) | _keys(b))
    if _keys(a) != _keys(b):
        differing = ", ".join(sorted(_keys(a) ^ _keys(b)))
        return [{"scene": scene, "output": f"other parameters: {differing}", "differs": True}]
    outputs_a, outputs_b = _outputs(a), _outputs(b)
    table_a, table_b = query(a, None, (*keys, *outputs_a)), query(b, None, (*keys, *outputs_b))
    both = table_a.merge(table_b, on=keys, how="outer", suffixes=("|a", "|b"), indicator="side")
    removed, added = int((both["side"] == "left_only").sum()), int((both["side"] == "right_only").sum())
    both = both[both["side"] == "both"]
    shared = {"scene": scene, "in both": len(both), "removed": removed, "added": added}
    rows: list[dict[str, object]] = []
    for output in sorted(set(outputs_a) | set(outputs_b)):
        if output not in outputs_a or output not in outputs_b:
            where = "only in A" if output in outputs_a else "only in B"
            rows.append({**shared, "output": f"{output} ({where})", "differs": True})
            continue
        change = _change(both[f"{output}|a"].to_numpy(), both[f"{output}|b"].to_numpy(), tolerance)
        rows.append(
            {**shared, "output": output, **change, "differs": bool(change["beyond tolerance"] or removed or added)}
        )
    return rows


def _keys(dataset: xr.Dataset) -> set[str]:
    """What identifies a scenario: its method and parameters, not its running number."""
    names = {
        str(name)
        for name in dataset.coords
        if dataset[name].dims and set(dataset[name].dims) <= set(dataset.status.dims)
    }
    return names - {"scenario"} | {str(name) for name in dataset.coords if not dataset[name].dims}


def _outputs(dataset: xr.Dataset) -> tuple[str, ...]:
    dims = set(dataset.status.dims)
    return tuple(str(n) for n in dataset.data_vars if set(dataset[n].dims) == dims and n != "run_time")


def _change(a: np.ndarray, b: np.ndarray, tolerance: float) -> dict[str, float | int]:
    if a.dtype.kind != "f":
        return {"beyond tolerance": int((a != b).sum())}
    absolute = np.abs(b - a)
    scale = np.maximum(np.abs(a), np.abs(b))
    same = (a == b) | (np.isnan(a) & np.isnan(b))
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = np.where(same, 0.0, absolute / scale)
    beyond = ~same & ~(relative <= tolerance)
    finite = absolute[np.isfinite(absolute)]
    return {
        "beyond tolerance": int(beyond.sum()),
        "largest change": float(finite.max()) if finite.size else 0.0,
        "relative": float(np.nanmax(relative, initial=0.0)),
    }
