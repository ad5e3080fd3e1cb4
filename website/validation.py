"""Validation: every printed value beside ours, scenes against tables and methods, and errors against run time."""

import pandas as pd

from cablesim.config.scene import AGREES, Scene
from cablesim.database.reading import open_scene
from cablesim.report.precision import advice
from website.places import AUDITS
from website.study import Finished
from website.text import folded, frame, scene_link, table, wide

INDEX = """# Validation

Each table that our sources print is audited: every cell is computed anew and set beside the printed one. A cell
*agrees* if it is within half a unit, or what the scene says, of its last printed digit. What is off has a verdict:

- **rounded key**: it is just what follows from another column of its row; the printed argument was rounded too hard.
- **misprint**: it follows from nothing in its row.
- What a scene calls its own: *approximated*, *interpolated by hand* and the like, where the source did not compute
  exactly.

No cell was judged by hand: verdicts follow from the numbers, and this page was made from the results of a study.
"""
MORE = """
## What else is checked

- [Independent references](references.md): numbers of 20 digits and more, computed by other means than ours.
- [Methods against each other](methods.md): scenes whose results are compared with a table or with another method, and
  with MoorPy, MoorDyn and SciPy, error against run time.
- [Where not to use a method](../stability.md), [the hunt for wrong answers](../hunt.md), and
  [what a study survives](../faults.md).
"""
METHODS = """# Methods against each other

Errors are relative to the reference, over the scenarios that both solved; the error of a vector is the length of the
difference, that of a list the largest of its sections.
"""


def pages(study: Finished) -> dict[str, str]:
    """Pages by their place."""
    audited = [(scene, audit(study, scene)) for scene in study.scenes if scene.published]
    return {
        "validation/index.md": f"{INDEX}\n{_summary(audited)}{MORE}",
        "validation/methods.md": _methods(study),
        **{f"{AUDITS}/{scene.name}.md": _audited(scene, cells) for scene, cells in audited},
    }


def audit(study: Finished, scene: Scene) -> pd.DataFrame:
    """The cells of a printed table, printed numbers as they are printed."""
    return pd.read_csv(study.layout.tables / f"{scene.name}_audit.csv", dtype={"printed": str})


def _summary(audited: list[tuple[Scene, pd.DataFrame]]) -> str:
    rows = []
    for scene, cells in audited:
        off = cells["flag"][cells["flag"] != AGREES].value_counts()
        verdicts = ", ".join(f"{count} {flag}" for flag, count in off.items())
        agree = int((cells["flag"] == AGREES).sum())
        rows.append((f"[{scene.title}](tables/{scene.name}.md)", len(cells), agree, len(cells) - agree, verdicts))
    total = [sum(row[i] for row in rows) for i in (1, 2, 3)]
    rows.append(("**all**", *total, ""))
    return table(("table", "printed cells", "agree", "off", "verdicts"), rows, "lrrrl")


def _audited(scene: Scene, cells: pd.DataFrame) -> str:
    assert scene.published is not None
    printed, agree = scene.published.table.path.name, cells["flag"] == AGREES
    keyed = cells["row_argument"].nunique() > 1
    parts = [f"## {_count(~agree)} off\n\n{_cells(cells[~agree], keyed)}"] if (~agree).any() else []
    parts += [f"## {_count(agree)} that agree\n\n{_cells(cells[agree], keyed=False)}"] if agree.any() else []
    told = (
        f"{scene.question}\n\n{scene_link(scene, AUDITS)} Table as printed: "
        f"[`{printed}`](../../../config/scenes/tables/{printed}), which says where it is from. A cell agrees if it is "
        f"off by no more than {scene.published.within:g} in its last printed digit. All tables: "
        "[validation](../index.md).\n\nHow each column follows from our outputs:"
    )
    page = f"# {scene.title}\n\n{told}\n\n{_formulas(scene)}\n" + "\n".join(parts)
    return wide(page, "navigation", "toc")


def _count(which: pd.Series) -> str:
    return f"{which.sum()} {'cell' if which.sum() == 1 else 'cells'}"


def _formulas(scene: Scene) -> str:
    assert scene.published is not None
    return table(("column", "formula"), ((f"`{name}`", f"`{text}`") for name, text in scene.published.columns.items()))


def _cells(cells: pd.DataFrame, keyed: bool) -> str:
    """Printed, ours, and what is between them; where rows have other arguments than they print, ours at those, too."""
    head = cells.columns[1]
    names = {"row": "row", head: head, "column": "column", "printed": "printed", "exact": "ours"}
    names |= {"difference": "difference", "units_off": "in last digits", "flag": "verdict"}
    names |= {"row_argument": "row's argument", "exact_at_argument": "ours at it"} if keyed else {}
    chosen = cells[list(names)].rename(columns=names)
    for name in ("ours", "ours at it"):
        if name in chosen:
            chosen[name] = [f"{value:.8g}" for value in chosen[name]]
    return frame(chosen, right=("printed", "ours", "ours at it"))


def _methods(study: Finished) -> str:
    told = [scene for scene in study.scenes if scene.reference]
    by_table = [scene for scene in told if scene.reference and scene.reference.table]
    timed = [scene for scene in study.scenes if scene.work_precision]
    parts = [METHODS, "## Against tables\n", *(_errors(study, scene) for scene in by_table)]
    parts += ["## Against run time, and other people's programs\n", *(_timed(study, scene) for scene in timed)]
    parts += ["## Against another method\n"]
    parts += [folded(scene.title, _errors(study, scene, heading=False)) for scene in told if scene not in by_table]
    return "\n".join(parts)


def _errors(study: Finished, scene: Scene, heading: bool = True) -> str:
    assert scene.reference is not None
    found = pd.read_csv(study.layout.tables / f"{scene.name}_errors.csv")
    chosen = found[["method", "output", "scenarios", "relative max", "relative 95 %", "relative median"]]
    reference = f"Reference: `{scene.reference.name}`. {scene_link(scene, 'validation')}"
    return (f"### {scene.title}\n\n" if heading else "") + f"{scene.question}\n\n{reference}\n\n{frame(chosen)}"


def _timed(study: Finished, scene: Scene) -> str:
    dataset = open_scene(study.layout.root, scene.name)
    columns = ["method", "solver", "options", "solved", "median error", "largest error", "run_time [s]", "alone [s]"]
    found = pd.read_csv(study.layout.tables / f"{scene.name}_work_precision.csv")[[*columns, "on the front"]]
    told = f"Measured on {dataset.attrs['machine']}. {scene_link(scene, 'validation')}"
    return f"### {scene.title}\n\n{scene.question}\n\n**{advice(scene, dataset)}**\n\n{told}\n\n{frame(found)}"
