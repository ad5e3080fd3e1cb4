"""Flexible lines: solvers, a scenario database and a batch pipeline."""

from typing import Any

__all__ = ["open_study"]


def __getattr__(name: str) -> Any:
    """`open_study`, which needs heavy packages, is imported when it is asked for."""
    if name == "open_study":
        from cablesim.database.opened import open_study

        return open_study
    raise AttributeError(f"module 'cablesim' has no attribute '{name}'")
