"""What changed between two runs of a study: scenes and scenarios added or removed, values and statuses that differ.

Scenarios are matched by their parameters, not by their position, and compared block by block. Measured times do not
count; that the code of a method or a scene file has changed is told, but is no difference.
"""

import json
import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from cablesim.database.collect import MEASURED_NAMES
from cablesim.database.matching import Match, OtherDesignError, match
from cablesim.database.reading import flag_words, read_dataset, running_numbers, scene_paths, with_components, written
from cablesim.database.scan import Points, Selection, blocks, read

COLUMNS = (
    "scene",
    "output",
    "in both",
    "removed",
    "added",
    "beyond tolerance",
    "largest change",
    "relative",
    "where",
    "differs",
)
# Changes of a flag that are told, the most frequent first.
MOST_TOLD = 5


def compare(results_a: Path, results_b: Path, tolerance: float = 0.0) -> pd.DataFrame:
    """A row for each scene and output of either folder; `differs` says whether anything but times did.

    `tolerance` is the relative change up to which two values count as the same. `where` says where the largest relative
    change lies, or from what to what flags have changed. What explains differences is in `.attrs["notes"]`.
    Raises InputError where there is no such folder, EnvironmentFault for a file that cannot be read.
    """
    a, b = scene_paths(results_a), scene_paths(results_b)
    rows: list[dict[str, object]] = []
    notes: list[str] = []
    for scene in sorted(a.keys() | b.keys()):
        if scene in a and scene in b:
            both = read_dataset(a[scene]), read_dataset(b[scene])
            rows += [{"scene": scene, **row} for row in _compare_scene(*both, tolerance)]
            notes += [f"{scene}: {note}" for note in _notes(*both)]
        else:
            where = "only in A" if scene in a else "only in B"
            rows.append({"scene": scene, "output": where, "differs": True})
    table = pd.DataFrame(rows, columns=list(COLUMNS))
    table.attrs["notes"] = notes
    return table


def relative_change(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The change of each number relative to the larger of both; infinite where only one of them is a number."""
    same = (a == b) | (np.isnan(a) & np.isnan(b))
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = np.abs(b - a) / np.maximum(np.abs(a), np.abs(b))
    return np.where(same, 0.0, np.where(np.isnan(relative), math.inf, relative))


@dataclass
class _Change:
    """How an output has changed so far: how often, and the largest change and its place in A."""

    beyond: int = 0
    largest: float = 0.0
    relative: float = 0.0
    place: dict[str, int] = field(default_factory=dict)
    flags: Counter[tuple[str, str]] = field(default_factory=Counter)


def _compare_scene(a: xr.Dataset, b: xr.Dataset, tolerance: float) -> Iterator[dict[str, object]]:
    a, b = _equally_wide(a, b)
    try:
        matched = match(with_components(a), with_components(b))
    except OtherDesignError as reason:
        yield {"output": str(reason), "differs": True}
        return
    shared = {"in both": matched.both, "removed": matched.removed, "added": matched.added}
    for output in sorted({str(name) for name in (*a.data_vars, *b.data_vars)} - {*MEASURED_NAMES}):
        lacking = _lacking(a, b, output)
        if lacking:
            yield {**shared, "output": f"{output} ({lacking})", "differs": True}
            continue
        change = _Change()
        if matched.both:
            _look(a[output], b[output], matched, tolerance, change)
        differs = bool(change.beyond or matched.removed or matched.added)
        yield {**shared, "output": output, **_told(a, output, change), "differs": differs}


def _equally_wide(a: xr.Dataset, b: xr.Dataset) -> tuple[xr.Dataset, xr.Dataset]:
    """Both with as many sections as the longest line of either has."""
    if "section" not in a.coords or "section" not in b.coords or a.section.size == b.section.size:
        return a, b
    sections = max(a.section.values, b.section.values, key=len)
    return a.reindex(section=sections), b.reindex(section=sections)


def _lacking(a: xr.Dataset, b: xr.Dataset, output: str) -> str:
    """Why an output cannot be compared; empty where it can be."""
    if output not in a or output not in b:
        return "only in A" if output in a else "only in B"
    own_a, own_b = (
        {dim: size for dim, size in dataset[output].sizes.items() if dim not in dataset.status.dims}
        for dataset in (a, b)
    )
    return "" if own_a == own_b else "other sizes"


def _look(a: xr.DataArray, b: xr.DataArray, matched: Match, tolerance: float, change: _Change) -> None:
    """Compare an output of the scenarios that both have, block by block."""
    own = [dim for dim in a.dims if dim not in matched.in_a]
    sizes = {dim: points.size for dim, points in matched.in_a.items()}
    everything = Selection({dim: np.arange(size) for dim, size in sizes.items()})
    for block in blocks(everything, sizes, math.prod(a.sizes[dim] for dim in own)):
        in_a, in_b = (
            {dim: points[block[dim]] for dim, points in side.items()} for side in (matched.in_a, matched.in_b)
        )
        lengths = {dim: points.size for dim, points in block.items()} | {str(dim): a.sizes[dim] for dim in own}
        values_a, values_b = _values(a, in_a, lengths), _values(b, in_b, lengths)
        if flag_words(a):
            _count(values_a, values_b, (flag_words(a), flag_words(b)), change)
        else:
            _measure(values_a, values_b, tolerance if a.dtype.kind == "f" else 0.0, in_a, change)


def _values(values: xr.DataArray, points: Points, lengths: dict[str, int]) -> np.ndarray:
    """Values at points in any order, over all dimensions."""
    order = {dim: np.argsort(own) for dim, own in points.items() if dim in values.dims}
    block = read(values, {dim: points[dim][order[dim]] for dim in order})
    block = block.isel({dim: np.argsort(own) for dim, own in order.items() if np.any(np.diff(own) < 0)})
    return block.set_dims(lengths).values


def _count(a: np.ndarray, b: np.ndarray, words: tuple[tuple[str, ...], tuple[str, ...]], change: _Change) -> None:
    """From what to what flags have changed, by their words, whatever numbers these have."""
    pairs, counts = np.unique(np.stack([a.ravel(), b.ravel()]), axis=1, return_counts=True)
    for (old, new), count in zip(pairs.T.tolist(), counts.tolist(), strict=True):
        told = _word(words[0], old), _word(words[1], new)
        if told[0] != told[1]:
            change.flags[told] += count
            change.beyond += count


def _measure(a: np.ndarray, b: np.ndarray, tolerance: float, points: Points, change: _Change) -> None:
    """How much numbers have changed, and where most; a number that became none, or none a number, is a change."""
    a, b = a.astype(float), b.astype(float)
    relative = relative_change(a, b)
    if not relative.any():
        return
    scenario = tuple(range(len(points), a.ndim))
    change.beyond += int((relative > tolerance).any(axis=scenario).sum())
    with np.errstate(invalid="ignore"):
        absolute = np.where(relative == 0.0, 0.0, np.abs(b - a))
    change.largest = max(change.largest, float(np.nanmax(absolute, initial=0.0)))
    if not change.place or float(relative.max()) > change.relative:
        at = np.unravel_index(int(relative.argmax()), relative.shape)
        change.place = {dim: int(own[i]) for (dim, own), i in zip(points.items(), at, strict=False)}
        change.relative = float(relative.max())


def _told(a: xr.Dataset, output: str, change: _Change) -> dict[str, Any]:
    """The part of a row that tells of a change."""
    if flag_words(a[output]):
        told = [f"{old} -> {new}: {count}" for (old, new), count in change.flags.most_common(MOST_TOLD)]
        return {"beyond tolerance": change.beyond, "where": ", ".join(told)}
    where = _where(a, change.place) if change.beyond else ""
    sizes = {"largest change": change.largest, "relative": change.relative}
    return {"beyond tolerance": change.beyond, **sizes, "where": where}


def _word(words: tuple[str, ...], number: int) -> str:
    return words[number] if 0 <= number < len(words) else str(number)


def _where(a: xr.Dataset, place: dict[str, int]) -> str:
    """The coordinates of a scenario of A as text."""
    point = a.status.isel({dim: i for dim, i in place.items() if dim in a.status.dims})
    counting = running_numbers(a)
    names = [str(name) for name, values in a.status.coords.items() if values.ndim == 1 and name not in counting]
    return ", ".join(f"{name}={written(point[name], digits=12)}" for name in names)


def _notes(a: xr.Dataset, b: xr.Dataset) -> Iterator[str]:
    """What may explain that two datasets differ."""
    if a.attrs.get("scene_digest") != b.attrs.get("scene_digest"):
        yield "the scene file changed"
    methods_a, methods_b = (json.loads(dataset.attrs.get("methods", "{}")) for dataset in (a, b))
    for method in sorted(methods_a.keys() & methods_b.keys()):
        old, new = methods_a[method], methods_b[method]
        if (old["solver"], old["options"]) != (new["solver"], new["options"]):
            yield f"{method} is another solver, or has other options"
        elif old["sources"] != new["sources"]:
            yield f"the code of {old['solver']} changed"
