"""What the tests of the command line share: a small scene, one call of the command, and a picture of a folder."""

import io
import json
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

from cablesim.cli import main
from cablesim.database.answers import WRITERS
from cablesim.database.query import Request
from cablesim.database.query import ask as query_of

GOOD = {
    "title": "Sag of two lines",
    "design": "{grid: {length_ratio: [1.1, 1.2]}}",
    "fixed": "{span: 2.5 m, weight_per_length: 3 N/m}",
    "methods": "{exact: {solver: catenary_exact}}",
    "outputs": "[sag, max_tension]",
}
# Generous: an ordinary refusal takes a hundredth of a second, but a first answer may wait a minute for compilation.
SECONDS = 180
LONGEST_LINE = 1000


@dataclass(frozen=True)
class Answer:
    """What the command said, and its exit code."""

    code: int
    out: bytes
    err: str

    @property
    def text(self) -> str:
        return self.out.decode()


class TookTooLongError(BaseException):
    """Not an Exception: nothing that handles errors may take it for one of its own."""


def scene(**parts: Any) -> str:
    """A scene file: the good one with some parts replaced (YAML text, or data), added, or left out (None)."""
    chosen = {key: part for key, part in {**GOOD, **parts}.items() if part is not None}
    return "".join(f"{key}: {part if isinstance(part, str) else json.dumps(part)}\n" for key, part in chosen.items())


def call(arguments: tuple[str, ...]) -> int:
    """The exit code of the command, within bounded time."""
    try:
        with _time_limit():
            return main(list(arguments))
    except TookTooLongError:
        pass
    # Out here, because wherever the alarm struck is no place to show.
    pytest.fail(f"no answer within {SECONDS} s")


def rendered(dataset: xr.Dataset, form: str, *columns: str) -> bytes:
    """All scenarios of a dataset in one of the formats of a query."""
    stream = io.BytesIO()
    WRITERS[form](query_of({"": dataset}, Request(columns=columns)), stream, True)
    return stream.getvalue()


def tree(folder: Path) -> dict[str, bytes | str]:
    """Everything below a folder: files by their bytes, links by where they lead."""
    return {str(path.relative_to(folder)): _content(path) for path in sorted(folder.rglob("*"))}


def assert_refused(answer: Answer, *phrases: str) -> None:
    """Exit code 2, nothing on standard output, and one line on standard error that says all the phrases."""
    assert answer.code == 2, f"{answer.code}: {answer.err[-400:]}"
    assert answer.out == b""
    assert answer.err.endswith("\n") and answer.err.count("\n") == 1, answer.err[-400:]
    assert answer.err.startswith("cablesim: ")
    assert "Traceback" not in answer.err
    for phrase in phrases:
        assert phrase in answer.err, f"{phrase!r} is not in {answer.err!r}"
    assert len(answer.err) <= LONGEST_LINE, len(answer.err)


def _content(path: Path) -> bytes | str:
    if path.is_symlink():
        return f"-> {path.readlink()}"
    return "folder" if path.is_dir() else path.read_bytes()


@contextmanager
def _time_limit() -> Iterator[None]:
    def stop(*_: object) -> None:
        raise TookTooLongError

    earlier = signal.signal(signal.SIGALRM, stop)
    signal.alarm(SECONDS)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, earlier)
