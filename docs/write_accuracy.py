"""Write the sections of docs/accuracy.md, and its figures, from what a study measured.

    python docs/write_accuracy.py results/default

What stands above the first section is kept, but for the machine.
"""

import re
import shutil
import sys
from pathlib import Path

from cablesim.config.scene import read_scene
from cablesim.database.reading import open_scene
from cablesim.report.precision import Worth, advice, changed_options, work_and_precision, written_seconds

PAGE = Path(__file__).with_name("accuracy.md")
SCENES = PAGE.parents[1] / "config" / "scenes"
# Of each scene its heading, and what its error is of.
SECTIONS = {
    "precision_hanging": (
        "Hanging line",
        "largest tension of overhead spans, 1e-4 to 2e-2 longer than their span, so stiff that they hardly stretch",
    ),
    "precision_towline": (
        "Tow line between two ships",
        "largest tension of wire and chain, ends 1e-4 to 0.2 of the length nearer than it",
    ),
    "precision_pulled": ("Tow line under a given pull", "distance between the ships"),
    "precision_stream": ("Line between two ends in a stream", "largest tension of heavy lines, taut to slack"),
    "segment_error": ("Line from a known force in a stream", "position of the free end"),
    "precision_wave": (
        "Moored line in still water, on the same elements",
        "greatest top tension of lines that stay taut, 20 elements of lumped mass: errors of marching alone",
    ),
    "precision_mesh": (
        "Moored line in still water, mesh and steps",
        "greatest top tension of lines that stay taut, against 400 elements",
    ),
    "precision_snap": (
        "Moored line that goes slack and snaps",
        "greatest top tension, with internal damping, against 200 elements",
    ),
}
DRAWN = ("precision_hanging", "segment_error", "precision_wave", "precision_snap")
HEAD = """| method | solver | solved | median error | largest error | a scenario, in a batch | alone | front |
|---|---|---:|---:|---:|---:|---:|---|"""


def section(results: Path, name: str) -> str:
    """Heading, sentence, table and figure of one scene."""
    scene, dataset = read_scene(SCENES / f"{name}.yaml"), open_scene(results, name)
    found = work_and_precision(scene, dataset)
    heading, what = SECTIONS[name]
    rows = "\n".join(row(one, one in found.front) for one in found.methods)
    text = (
        f"## {heading}\n\n`{name}`: {what}; {found.methods[0].errors.size} scenarios. The reference is known to "
        f"{found.reference_error:.1e}.\n\n**{advice(scene, dataset)}**\n\n{HEAD}\n{rows}\n"
    )
    if name in DRAWN:
        shutil.copyfile(results / "figures" / f"{name}_diagram.png", PAGE.parent / "images" / f"{name}.png")
        text += f"\n![Largest error against run time](images/{name}.png)\n"
    return text


def row(one: Worth, on_the_front: bool) -> str:
    """One method."""
    options, times = changed_options(one.method), one.times
    spread = f"{written_seconds(times['run_time_lowest'])} .. {written_seconds(times['run_time_highest'])}"
    cells = [
        f"`{one.name}`",
        f"{one.method.solver.name}{', ' if options else ''}{options}",
        f"{one.solved} of {one.errors.size}",
        f"{one.median:.1e}",
        f"{one.largest:.1e}",
        f"{written_seconds(one.run_time)} ({spread})",
        written_seconds(times["run_time_alone"]),
        "*" if on_the_front else "",
    ]
    return f"| {' | '.join(cells)} |"


def main(results: Path) -> None:
    """Write the page anew."""
    machines = [open_scene(results, name).attrs["machine"].split(", ") for name in SECTIONS]
    machine = ", ".join(dict.fromkeys(part for parts in machines for part in parts))
    above = PAGE.read_text(encoding="utf-8").split("\n## ")[0]
    above = re.sub(
        r"of a machine with .*?\. Errors are", lambda _: f"of a machine with {machine}. Errors are", above, flags=re.S
    )
    PAGE.write_text("\n".join([above + "\n", *(section(results, name) for name in SECTIONS)]), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
