"""How the scenarios of a scene fared in its checks: a table by method, and a line for each check."""

import numpy as np
import pandas as pd
import xarray as xr

from cablesim.config.scene import Scene
from cablesim.database.reading import of_method
from cablesim.report.tables import place
from cablesim.status import Verdict


def check_table(scene: Scene, dataset: xr.Dataset) -> pd.DataFrame:
    """How many scenarios of each method passed and failed each check, and the coordinates of the first that failed."""
    rows = []
    for check in scene.checks:
        for method in scene.methods:
            flags = of_method(dataset[check.name], method.name)
            about = {"check": check.name, "condition": check.words, "method": method.name}
            rows.append({**about, **_counts(flags), "first failed at": _first_failed(flags)})
    return pd.DataFrame(rows)


def check_lines(scene: Scene, dataset: xr.Dataset) -> list[str]:
    """A line for each check, over all methods: its name, and how many scenarios passed and failed it."""
    counted = {check.name: _counts(dataset[check.name]) for check in scene.checks}
    return [f"{name}: {', '.join(f'{n} {word}' for word, n in counts.items())}" for name, counts in counted.items()]


def _counts(flags: xr.DataArray) -> dict[str, int]:
    counts = np.bincount(flags.values.ravel(), minlength=len(Verdict))
    return {verdict.name: int(counts[verdict]) for verdict in Verdict}


def _first_failed(flags: xr.DataArray) -> str:
    failed = flags.values.ravel() == Verdict.failed
    return place(flags, int(failed.argmax())) if failed.any() else ""
