"""An audit hook: what the interpreter does that no command of ours should do."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

EXECUTING = ("exec", "compile", "ctypes.dlopen")
RUNNING = ("os.system", "subprocess.Popen", "os.exec", "os.posix_spawn", "os.fork", "pty.spawn", "socket.")
CHANGING = ("os.remove", "os.rename", "os.mkdir", "os.rmdir", "os.chmod", "os.link", "os.symlink", "os.truncate")
CACHE = Path.home() / ".cache"


@dataclass
class _Watch:
    """Who may write where, whether code may be executed, and what was seen."""

    within: tuple[Path, ...]
    executing: bool
    seen: list[str] = field(default_factory=list)

    def look(self, event: str, arguments: tuple[Any, ...]) -> None:
        changing = event.startswith(CHANGING) or (event == "open" and _is_writing(arguments))
        strange = changing and not self._is_allowed(arguments[0])
        running = event.startswith(RUNNING) and not _is_ours(event, arguments)
        if strange or running or (self.executing and event.startswith(EXECUTING)):
            self.seen.append(f"{event} {arguments!r:.200}")

    def _is_allowed(self, place: Any) -> bool:
        if isinstance(place, int):
            return bool(self.within)
        path = Path(place.decode(errors="replace") if isinstance(place, bytes) else place).absolute()
        return any(path.is_relative_to(folder) for folder in self.within)


_watches: list[_Watch] = []
_hooked: list[bool] = []


@contextmanager
def watching(*within: Path, executing: bool = False) -> Iterator[list[str]]:
    """What is done meanwhile: processes (but for our own), sockets, changes outside of some folders.

    `executing`: code that is compiled or executed, too. An import does that, so it must have been done before.
    """
    if not _hooked:
        sys.addaudithook(_hook)
        _hooked.append(True)
    watch = _Watch(within, executing)
    _watches.append(watch)
    try:
        yield watch.seen
    finally:
        _watches.remove(watch)


def _hook(event: str, arguments: tuple[Any, ...]) -> None:
    for watch in _watches:
        watch.look(event, arguments)


def _is_writing(arguments: tuple[Any, ...]) -> bool:
    """Whether a file is opened for writing, by the arguments of the event."""
    mode, flags = arguments[1:3]
    return bool(set(mode) & set("wax+")) if isinstance(mode, str) else bool((flags or 0) & 3)


def _is_ours(event: str, arguments: tuple[Any, ...]) -> bool:
    """A look at the revision, or into a file that may crash its reader."""
    started = [str(part) for part in arguments[1]][:3] if event == "subprocess.Popen" else []
    return started[:2] == ["git", "-C"] or started[1:] == ["-m", "cablesim.database.probe"]
