"""A fault, and what came of injecting it."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Outcome:
    """What came of a fault that was injected many times.

    It is survived where all is as it should be: the damage is found, the answer refused in one line, or the study
    finished with the right numbers. `failures` tell of the others; `lost` are shards that had to be computed again.
    """

    injected: int
    failures: tuple[str, ...]
    lost: int | None = None
    figures: str = ""

    @property
    def survived(self) -> int:
        return self.injected - len(self.failures)


@dataclass(frozen=True)
class Fault:
    """A fault in words, what it takes to recover, and how often it is injected: by the tests, and by `make faults`.

    `inject` gets an empty folder, the number of times, and a seed.
    """

    name: str
    recovery: str
    inject: Callable[[Path, int, int], Outcome]
    quick: int
    full: int
