"""The table of a hunt: scenarios of each solver by their fate, how many are wrong, the worst miss of each judge."""

from collections.abc import Sequence

import pandas as pd

from cablesim.hunt._hunt import Findings
from cablesim.status import Status


def hunted_table(found: Sequence[Findings]) -> pd.DataFrame:
    """A row for each solver; a miss is given in what is allowed, with how many scenarios were judged."""
    return pd.DataFrame([_row(one) for one in found])


def _row(one: Findings) -> dict[str, object]:
    fates = {status.name: one.status[status.name] for status in Status}
    misses = (f"{name} {one.worst[name]:.2g} ({one.judged[name]})" for name in one.worst)
    judges = {"worst miss (judged)": ", ".join(misses)}
    return {"solver": one.solver, "scenarios": one.scenarios, **fates, "wrong": one.wrong, **judges}
