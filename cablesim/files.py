"""Files appear whole or not at all: written beside, synced, renamed; damage is found by digest, not by luck."""

import hashlib
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from cablesim.errors import EnvironmentFault

LEDGER_SUFFIX = ".json"


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
    except (OSError, RuntimeError) as problem:
        size = temporary.stat().st_size if temporary.exists() else 0
        reason = getattr(problem, "strerror", None) or problem
        raise EnvironmentFault(
            f"{path}: cannot be written ({reason}; {size} bytes were), free {_free(path)} bytes"
        ) from problem
    finally:
        temporary.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Write a text file, whole or not at all."""
    with written_whole(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def ledger(path: Path) -> Path:
    """The file beside `path` that vouches for it."""
    return path.with_suffix(LEDGER_SUFFIX)


def enter_in_ledger(path: Path, seconds: float) -> None:
    """Record the digest of a finished file, and what it took: measured times stay out of the file itself."""
    write_text(ledger(path), json.dumps({"sha256": digest_of(path), "seconds": seconds}) + "\n")


def check_against_ledger(path: Path) -> float:
    """The seconds a file took. Raises EnvironmentFault if it is missing, unfinished or not what was written."""
    if not path.is_file():
        raise EnvironmentFault(f"{path}: missing; run the study again to compute it")
    if not ledger(path).is_file():
        raise EnvironmentFault(f"{path}: never finished (no {ledger(path).name}); run the study again to compute it")
    try:
        entry = json.loads(ledger(path).read_text(encoding="utf-8"))
        if entry["sha256"] == digest_of(path):
            return float(entry["seconds"])
    except (ValueError, KeyError, TypeError):
        pass
    path.unlink()
    ledger(path).unlink()
    raise EnvironmentFault(f"{path}: was damaged (its digest does not match) and is removed; run the study again")


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


def _free(path: Path) -> int:
    folder = next((parent for parent in path.parents if parent.exists()), Path("/"))
    status = os.statvfs(folder)
    return status.f_bavail * status.f_frsize
