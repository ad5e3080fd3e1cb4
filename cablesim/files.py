"""Files appear whole or not at all: written beside, synced, renamed; damage is found by digest, not by luck."""

import hashlib
import json
import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from cablesim.errors import EnvironmentFault

LEDGER_SUFFIX = ".json"
# Lists that take down which files are written.
_records: list[list[Path]] = []


@contextmanager
def written_whole(path: Path) -> Iterator[Path]:
    """A temporary path in the same folder that becomes `path` if the block ends well, and vanishes if it does not.

    Raises EnvironmentFault, naming the path and what had been written, where the disk or a permission is in the way.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield temporary
        _sync(temporary)
        temporary.replace(path)
        _sync(path.parent)
        for record in _records:
            record.append(path)
    except (OSError, RuntimeError) as problem:
        size = temporary.stat().st_size if temporary.exists() else 0
        reason = getattr(problem, "strerror", None) or problem
        raise EnvironmentFault(
            f"{path}: cannot be written ({reason}; {size} bytes were), free {free_bytes(path)} bytes"
        ) from problem
    finally:
        temporary.unlink(missing_ok=True)


def parts(folder: Path) -> list[Path]:
    """Temporary files in a folder whose processes are no more."""
    return [path for path in sorted(folder.rglob(".*.part")) if not is_alive(path.name.split(".")[-2])]


def is_alive(process: int | str) -> bool:
    """Whether there is a process with this number on this machine."""
    import psutil

    return str(process).isdigit() and psutil.pid_exists(int(process))


@contextmanager
def recording() -> Iterator[list[Path]]:
    """The files that are written meanwhile."""
    written: list[Path] = []
    _records.append(written)
    try:
        yield written
    finally:
        _records.remove(written)


def write_stamp(path: Path, files: list[Path]) -> None:
    """Write the digests of files that were written in a step, by their paths from the folder of the results."""
    root = path.parent.parent
    digests = {os.path.relpath(file, root): digest_of(file) for file in files}
    write_text(path, json.dumps({"stamp": path.name, "files": digests}, indent=1, sort_keys=True) + "\n")


def holds_good(stamp: Path) -> bool:
    """Whether every file that a stamp vouches for is still what was written."""
    try:
        entry = json.loads(stamp.read_text(encoding="utf-8"))
        same = (digest_of(stamp.parent.parent / name) == digest for name, digest in entry["files"].items())
        return entry["stamp"] == stamp.name and all(same)
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return False


def write_text(path: Path, text: str) -> None:
    """Write a text file, whole or not at all."""
    with written_whole(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def ledger(path: Path) -> Path:
    """The file beside `path` that vouches for it: `spans.json` for `spans.nc`, `x.parquet.json` for `x.parquet`."""
    return path.with_suffix(LEDGER_SUFFIX) if path.suffix == ".nc" else path.with_name(path.name + LEDGER_SUFFIX)


def enter_in_ledger(path: Path, seconds: float = 0.0, complete: bool = True) -> None:
    """Record the name and digest of a finished file, and what it took: measured times stay out of the file itself.

    A file that is to be made again when more is known is not `complete`.
    """
    entry = {"file": path.name, "sha256": digest_of(path), "seconds": seconds, "complete": complete}
    write_text(ledger(path), json.dumps(entry) + "\n")


class Condition(StrEnum):
    """What a file is worth, by its ledger; only a `whole` one is read."""

    whole = "what was written"
    missing = "missing"
    unfinished = "never finished (it has no ledger)"
    damaged = "damaged (its digest does not match)"
    foreign = "foreign (its ledger is that of another file)"
    partial = "made before all of it was computed"


@dataclass(frozen=True)
class Checked:
    """The condition of a file, and the seconds that it took to make where it is whole."""

    condition: Condition
    seconds: float = math.nan

    @property
    def whole(self) -> bool:
        return self.condition is Condition.whole


def check(path: Path) -> Checked:
    """Compare a file with its ledger, to the last bit."""
    if not path.is_file():
        return Checked(Condition.missing)
    if not ledger(path).is_file():
        return Checked(Condition.unfinished)
    try:
        entry = json.loads(ledger(path).read_text(encoding="utf-8"))
        if entry["sha256"] != digest_of(path):
            return Checked(Condition.damaged)
        if entry["file"] != path.name:
            return Checked(Condition.foreign)
        if not entry["complete"]:
            return Checked(Condition.partial)
        return Checked(Condition.whole, float(entry["seconds"]))
    except (OSError, ValueError, KeyError, TypeError):
        return Checked(Condition.damaged)


def is_vouched_for(path: Path) -> bool:
    """Whether there is a ledger, and the file is as it says. Raises EnvironmentFault where it is not."""
    condition = check(path).condition
    if condition in (Condition.damaged, Condition.foreign):
        raise EnvironmentFault(f"{path}: {condition.value}; run the study again")
    return condition in (Condition.whole, Condition.partial)


def recorded_digest(path: Path) -> str:
    """The digest in a file's ledger, which is not compared with the file; empty where there is none."""
    try:
        return str(json.loads(ledger(path).read_text(encoding="utf-8"))["sha256"])
    except (OSError, ValueError, KeyError, TypeError):
        return ""


def discard(path: Path) -> None:
    """Remove a file and what vouches for it; without the ledger first, nobody takes the rest for whole."""
    ledger(path).unlink(missing_ok=True)
    path.unlink(missing_ok=True)


def digest_of(path: Path) -> str:
    """SHA-256 of a file's bytes."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _sync(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def free_bytes(path: Path) -> int:
    """What is left for a user on the disk of a path, which need not be there yet."""
    folder = next(one for one in (path, *path.absolute().parents) if one.exists())
    status = os.statvfs(folder)
    return status.f_bavail * status.f_frsize
