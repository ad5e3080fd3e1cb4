"""What can go wrong outside our own code, each with the exit code that the command line gives it.

A scenario without a solution is not an error: it is data (`cablesim.status`).
"""

import difflib
from collections.abc import Iterable


class CablesimError(Exception):
    """Something the user or the machine must mend; the message is one line and needs no traceback."""

    exit_code = 2


class InputError(CablesimError):
    """The caller's mistake: a file, key, parameter, unit or value that cannot be used."""

    exit_code = 2


class EnvironmentFault(CablesimError):
    """The machine's: disk, permission, lock or a damaged file."""

    exit_code = 3


def nearest(name: str, known: Iterable[str]) -> str:
    """A phrase that helps whoever mistyped `name`: the closest known names, or all of them where none is close."""
    names = sorted(known)
    close = difflib.get_close_matches(name, names, n=3, cutoff=0.6)
    if close:
        return "did you mean " + " or ".join(close) + "?"
    return "known: " + ", ".join(names) if names else "none is known here"
