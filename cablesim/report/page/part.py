"""A scene's part of the page: what is read at once, and what is unpacked when somebody looks at it."""

import csv
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from cablesim.config.scene import Scene
from cablesim.database.reading import status_words
from cablesim.report.answer import answer_path, written_answer
from cablesim.report.audit import audit_table
from cablesim.report.page.columns import pack
from cablesim.report.page.scenarios import scenario_data
from cablesim.status import SENTENCES, Status
from cablesim.study import Layout

PROVENANCE = ("source", "revision", "scene_digest", "plan", "seed", "machine")
# The tables of a scene that are in the page, in this order, printed ones after the first.
FIRST, LAST = ("fastest", "audit", "errors", "checks"), ("work_precision", "orders", "status", "effort", "tensions")
# Of one table in the page: what is beyond stays in its file.
MOST_CELLS = 6000


def scene_part(scene: Scene, dataset: xr.Dataset, layout: Layout) -> dict[str, Any]:
    """Everything the page says of a scene, as JSON can hold it."""
    about = dataset.attrs
    tables = [read for path in _table_files(scene, layout) if (read := _table(scene, path)) is not None]
    details: dict[str, Any] = {
        "figures": _figures(scene, dataset),
        "tables": tables,
        "scenarios": scenario_data(scene, dataset),
    }
    return {
        "scene": scene.name,
        "title": scene.title,
        "question": scene.question,
        "answer": written_answer(layout.tables, scene.name),
        "kind": scene.design.kind,
        "axes": [{"name": axis.name, "size": axis.size} for axis in scene.design.axes],
        "methods": [{"name": method.name, "solver": method.solver.name} for method in scene.methods],
        "fates": _fates(dataset),
        "seconds": float(dataset.run_time.sum()),
        "provenance": {name: str(about[name]) for name in PROVENANCE if name in about},
        "source": _source(scene, dataset),
        "figures": [{"title": one["title"], "whole": one["whole"]} for one in details["figures"]],
        "tables": [{"caption": one["caption"], "rows": one["count"]} for one in tables],
        "packed": pack(details),
    }


def _figures(scene: Scene, dataset: xr.Dataset) -> list[dict[str, Any]]:
    """The interactive figures; what draws them is imported only where there are any."""
    if not scene.figures:
        return []
    from cablesim.report.page.figures import page_figures

    return page_figures(scene, dataset)


def _fates(dataset: xr.Dataset) -> list[dict[str, Any]]:
    """How many scenarios met each fate, methods counted by themselves."""
    words = status_words(dataset)
    counts = np.bincount(dataset.status.values.ravel(), minlength=len(words))
    return [
        {"status": word, "count": int(count), "sentence": SENTENCES[Status[word]]}
        for word, count in zip(words, counts, strict=True)
        if count
    ]


def _source(scene: Scene, dataset: xr.Dataset) -> dict[str, Any] | None:
    """The printed table that a scene reproduces, and how many of its cells met which verdict."""
    table = audit_table(scene, dataset)
    if scene.published is None or table.empty:
        return None
    counts = {str(flag): int(count) for flag, count in table["flag"].value_counts().items()}
    return {"table": scene.published.table.path.name, "cells": len(table), "verdicts": counts}


def made_from(scene: Scene, layout: Layout) -> list[Path]:
    """The files that a part is made from beside the dataset."""
    return [scene.path, answer_path(layout.tables, scene.name), *_table_files(scene, layout)]


def _table_files(scene: Scene, layout: Layout) -> list[Path]:
    """The tables of a scene that are in the page, as far as they are there."""
    names = [*FIRST, *(printed.name for printed in scene.printed), *LAST]
    return [path for name in names if (path := layout.tables / f"{scene.name}_{name}.csv").exists()]


def _table(scene: Scene, path: Path) -> dict[str, Any] | None:
    """A table as text, its caption from the page for print beside it; cut where it is long."""
    with path.open(newline="", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    shown = rows[: max(1, MOST_CELLS // max(1, len(head)))]
    caption = path.with_suffix(".md").read_text(encoding="utf-8").partition("\n")[0].lstrip("# ")
    words = path.stem.removeprefix(f"{scene.name}_").replace("_", " ") if caption == scene.title else caption
    words = words.removeprefix(f"{scene.title}: ")
    if not rows:
        return None
    return {
        "name": path.stem,
        "caption": words[0].upper() + words[1:],
        "head": head,
        "rows": shown,
        "count": len(rows),
        "file": path.name,
    }
