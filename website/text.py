"""Markdown that several pages are made of."""

from collections.abc import Iterable
from pathlib import PurePosixPath

import pandas as pd

from cablesim.config.scene import Scene


def table(heads: Iterable[str], rows: Iterable[Iterable[object]], numbers: str = "") -> str:
    """A table; columns whose letter in `numbers` is r are set to the right."""
    heads = list(heads)
    marks = ["---:" if numbers[i : i + 1] == "r" else "---" for i in range(len(heads))]
    lines = [_line(heads), f"|{'|'.join(marks)}|", *map(_line, rows)]
    return "\n".join(lines) + "\n"


def frame(found: pd.DataFrame, right: tuple[str, ...] = ()) -> str:
    """A table of results as it is, numbers to the right and to four digits; `right` are columns of written numbers."""
    is_number = [name in right or pd.api.types.is_numeric_dtype(found[name]) for name in found]
    numbers = "".join("r" if each else "l" for each in is_number)
    return table(found.columns, ([short(cell) for cell in row] for row in found.itertuples(index=False)), numbers)


def short(cell: object) -> str:
    """A number to four digits, nothing for what is not there."""
    if cell is None or (isinstance(cell, float) and cell != cell):
        return ""
    return f"{cell:.4g}" if isinstance(cell, float) else str(cell)


def scene_link(scene: Scene, folder: str = "") -> str:
    """Where the file of a scene is, for a page in a folder of the site."""
    up = "../" * (1 + len(PurePosixPath(folder).parts))
    return f"Scene file: [`{scene.path.name}`]({up}config/scenes/{scene.path.name})."


def wide(page: str, *hidden: str) -> str:
    """A page without some of what stands beside it: `navigation`, `toc`."""
    return "\n".join(["---", "hide:", *(f"  - {part}" for part in hidden), "---", page])


def folded(title: str, body: str) -> str:
    """A part of a page that is opened when it is wanted."""
    indented = "\n".join(f"    {line}" if line else "" for line in body.splitlines())
    return f'??? note "{title}"\n\n{indented}\n'


def _line(cells: Iterable[object]) -> str:
    return "| " + " | ".join(str(cell).replace("|", "\\|").replace("\n", " ") for cell in cells) + " |"
