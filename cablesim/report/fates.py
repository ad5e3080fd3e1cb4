"""What became of the scenarios of a study, in a few lines."""

from pathlib import Path

import pandas as pd

from cablesim.database.catalogue import catalogue
from cablesim.status import Status

# Scenes that are named for each fate.
MOST_NAMES = 5


def fates(results: Path, scenes: list[str]) -> pd.DataFrame:
    """How many scenarios of these scenes met each fate, each counted once for every method, and in which scenes."""
    rows = catalogue(results)
    rows = rows[(rows["kind"] == "status") & rows["scene"].isin(scenes)]
    return pd.DataFrame([_fate(status, rows[rows["name"] == status.name]) for status in Status if _met(rows, status)])


def _met(rows: pd.DataFrame, status: Status) -> bool:
    return bool((rows["name"] == status.name).any())


def _fate(status: Status, rows: pd.DataFrame) -> dict[str, object]:
    scenes = rows.sort_values("number", ascending=False)["scene"].tolist()
    more = f" and {len(scenes) - MOST_NAMES} more scenes" if len(scenes) > MOST_NAMES else ""
    named = ", ".join(scenes[:MOST_NAMES]) + more
    return {"status": status.name, "scenarios": int(rows["number"].sum()), "most of them in": named}
