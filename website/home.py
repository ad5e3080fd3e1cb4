"""The first page and the five minutes, both of README.md, and the page of the benchmarks."""

import re
from pathlib import Path

from website.text import wide

PROJECT = Path(__file__).parents[1]
TOUR = "## Five minutes"
HOME = """
| | |
|---|---|
| [Five minutes](tour.md) | one command after another, with what it prints |
| [Tutorial](tutorial.md) | from an empty folder to an answer and a plot, for a student |
| [How to](howto/own_scene.md) | a scene of your own, a solver of your own, a cluster, how to cite |
| [Theory](theory/index.md) | the equations of every solver, where they come from, and where they end |
| [Gallery](gallery.md) | the figures of the default study, each with its question and its scene file |
| [Validation](validation/index.md) | every printed value beside ours, and what independent programs say |
| [Reference](reference/solvers/index.md) | solvers, quantities, commands, Python, scene files |

"""


def pages() -> dict[str, str]:
    """Pages by their place."""
    above, tour = (PROJECT / "README.md").read_text(encoding="utf-8").split(f"\n{TOUR}\n")
    return {
        "index.md": wide(in_docs(above) + HOME, "navigation"),
        "tour.md": f"# {TOUR.removeprefix('## ')}\n" + in_docs(tour),
        "benchmarks.md": (PROJECT / "benchmarks" / "README.md").read_text(encoding="utf-8"),
    }


def in_docs(text: str) -> str:
    """Text of a file beside docs/, with links as from a page in it."""
    return re.sub(r"\]\((?!\w+:)([^)]+)\)", lambda link: f"]({_from_docs(link[1])})", text)


def _from_docs(target: str) -> str:
    return target.removeprefix("docs/") if target.startswith("docs/") else f"../{target}"
