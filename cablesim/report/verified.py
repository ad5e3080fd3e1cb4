"""What was found in a folder of results: damage, differences and leftovers, as tables."""

import pandas as pd

from cablesim.clean import Leftover
from cablesim.files import Condition
from cablesim.verify import Verdict


def verified_table(verdicts: list[Verdict]) -> pd.DataFrame:
    """A row for each scene; every cell is text."""
    rows = [
        {
            "scene": one.scene,
            "shards": str(sum(one.shards.values())),
            **{c.name: str(one.shards[c]) for c in Condition if c is not Condition.whole},
            "computed again": str(one.recomputed),
            "differing": str(one.differing),
            "largest change": f"{one.largest:.2g}",
            "notes": "; ".join(dict.fromkeys(one.notes)),
        }
        for one in verdicts
    ]
    return pd.DataFrame(rows)


def leftover_table(found: list[Leftover]) -> pd.DataFrame:
    """A row for each scene and kind of file: how many there are, and their size."""
    table = pd.DataFrame([{"scene": one.scene, "what": one.what, "MB": one.bytes / 1e6} for one in found])
    table = table.groupby(["scene", "what"], as_index=False).agg(files=("MB", "size"), MB=("MB", "sum"))
    return table.round({"MB": 3})
