"""Numbers as the page holds them: columns, with as many digits as a figure can show, packed as text."""

import base64
import gzip
import json
from typing import Any

import numpy as np

# Of a number in a figure: finer than any screen.
DIGITS = 5
# Of an output in the table of a scenario.
OUTPUT_DIGITS = 8

Columns = dict[str, list[Any]]
# Columns along a side, up another, and of the cells row by row: the page makes a row for each cell of it.
Grid = dict[str, Columns]


def column(values: Any, digits: int = DIGITS) -> list[Any]:
    """Values as JSON has them: numbers with some significant digits, None where there is none, words as they are."""
    array = np.asarray(values).ravel()
    if array.dtype.kind != "f":
        return list(array.tolist())
    return [_rounded(value, digits) for value in array.tolist()]


def exact(values: Any) -> list[Any]:
    """Numbers with all their digits: what a command is made of."""
    return [value if np.isfinite(value) else None for value in np.asarray(values, dtype=float).ravel().tolist()]


def pack(content: Any) -> str:
    """Anything JSON can hold as text that stands in a page as it is: JSON, compressed, in base 64."""
    text = json.dumps(content, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return base64.b64encode(gzip.compress(text.encode(), compresslevel=9, mtime=0)).decode()


def _rounded(value: float, digits: int) -> float | int | None:
    if not np.isfinite(value):
        return None
    rounded = float(f"{value:.{digits}g}")
    return int(rounded) if rounded.is_integer() and abs(rounded) < 10.0**digits else rounded
