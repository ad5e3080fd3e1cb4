"""One run at a time in a folder of results: who works there is told, and what a killed run left behind is ended.

The lock is the system's, so it ends with its process, however that ends. Processes that outlive a run are known by a
mark in their environment, which every job inherits.
"""

import atexit
import json
import os
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from cablesim.errors import EnvironmentFault
from cablesim.files import is_alive, parts, write_text

if TYPE_CHECKING:
    import psutil

LOCK, HOLDER = ".lock", ".running.json"
MARK = "CABLESIM_RESULTS"
# How long one who comes second waits for the first to write down who it is.
MOMENT = 2.0
# How long a killed process may take to end.
END = 30.0
_for_good = ExitStack()


@contextmanager
def held(folder: Path) -> Iterator[None]:
    """Nobody else works in a folder of results meanwhile; jobs and half-written files of a killed run are removed.

    Raises EnvironmentFault, telling who does and since when, where somebody else works there.
    """
    from filelock import FileLock, Timeout

    folder.mkdir(parents=True, exist_ok=True)
    lock = FileLock(folder / LOCK, timeout=0)
    try:
        lock.acquire()
    except Timeout:
        raise EnvironmentFault(f"{folder}: {_who(folder)}; start again when it has ended") from None
    try:
        os.environ[MARK] = _mark(folder)
        _end_orphans(folder)
        _remove_parts(folder)
        _write_holder(folder)
        yield
    finally:
        (folder / HOLDER).unlink(missing_ok=True)
        os.environ.pop(MARK, None)
        lock.release()


def hold_for_good(folder: Path) -> None:
    """The same until this process ends."""
    _for_good.enter_context(held(folder))
    atexit.register(_for_good.close)


def _remove_parts(folder: Path) -> None:
    for part in parts(folder):
        part.unlink(missing_ok=True)


def _mark(folder: Path) -> str:
    return str(folder.resolve())


def _write_holder(folder: Path) -> None:
    since = datetime.now().astimezone().isoformat(sep=" ", timespec="seconds")
    holder = {
        "process": os.getpid(),
        "host": os.uname().nodename,
        "since": since,
        "command": " ".join([Path(sys.argv[0]).name, *sys.argv[1:]])[:200],
    }
    write_text(folder / HOLDER, json.dumps(holder) + "\n")


def _who(folder: Path) -> str:
    """Who works in a folder, in words; a holder that is no more has not been replaced yet."""
    until = time.monotonic() + MOMENT
    while time.monotonic() < until:
        try:
            holder = json.loads((folder / HOLDER).read_text(encoding="utf-8"))
            process, host = int(holder["process"]), str(holder["host"])
            if host != os.uname().nodename or is_alive(process):
                return (
                    f"process {process} on {host} has been at work here since {holder['since']} ({holder['command']})"
                )
        except (OSError, ValueError, KeyError, TypeError):
            pass
        time.sleep(0.05)
    return "another process is at work here"


def _end_orphans(folder: Path) -> None:
    """Kill the jobs that a killed run left behind on this machine: whoever holds the folder has no jobs yet."""
    import psutil

    until, ended = time.monotonic() + END, set()
    while orphans := _marked(_mark(folder)):
        if time.monotonic() > until:
            told = ", ".join(str(one.pid) for one in orphans)
            raise EnvironmentFault(f"{folder}: jobs of an earlier run are still at work and cannot be ended: {told}")
        for orphan in orphans:
            with suppress(psutil.NoSuchProcess):
                orphan.kill()
        ended |= {one.pid for one in orphans}
        psutil.wait_procs(orphans, timeout=1.0)
    if ended:
        print(f"{folder}: {len(ended)} processes of a run that was killed are ended", file=sys.stderr)


def _marked(mark: str) -> list["psutil.Process"]:
    """The other processes that were started in a run of this folder."""
    import psutil

    found = []
    for process in psutil.process_iter():
        with suppress(psutil.Error, OSError):
            if process.pid != os.getpid() and process.environ().get(MARK) == mark:
                found.append(process)
    return found
