"""Loops compiled by numba, kept on disk so that no job compiles what another one has compiled.

Numba notices a change in a compiled function's own file, but not in another file whose functions it calls. So its cache
lies in a folder named by a digest of all sources that hold numbers, and a changed source never meets an old kernel.
"""

import hashlib
import os
import stat
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
from platformdirs import user_cache_path

PACKAGE = Path(__file__).parent.parent
FOLDERS = ("numerics", "physics", "solvers")


def cache_folder() -> Path:
    """Where the kernels of these sources are kept: in NUMBA_CACHE_DIR, the user's cache or a temporary folder."""
    digest = hashlib.sha256()
    for path in sorted(path for folder in FOLDERS for path in (PACKAGE / folder).glob("*.py")):
        digest.update(path.relative_to(PACKAGE).as_posix().encode() + b"\0" + path.read_bytes())
    given = os.environ.get("NUMBA_CACHE_DIR")
    folder = (Path(given) if given else user_cache_path("cablesim")) / digest.hexdigest()[:16]
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return _private_folder() / folder.name
    return folder


def _private_folder() -> Path:
    """A temporary folder that nobody else can write to: kernels in it are run as they are found."""
    folder = Path(tempfile.gettempdir()) / f"cablesim-{os.getuid()}"
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    found = folder.lstat()
    is_ours = stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and not found.st_mode & 0o022
    return folder if is_ours else Path(tempfile.mkdtemp(prefix="cablesim-"))


numba.config.CACHE_DIR = str(cache_folder())  # type: ignore[attr-defined]


def compiled(function: Callable[..., Any]) -> Any:
    """The function as machine code. Division by zero gives inf or NaN, as in NumPy; nothing is reordered."""
    return numba.njit(cache=True, error_model="numpy", nogil=True)(function)
