"""What the benchmarks share: timings in wall and processor time, the revision, a Markdown table."""

import resource
import statistics
import subprocess
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from time import perf_counter


@dataclass(frozen=True)
class Cost:
    """Seconds that something took: on the clock, and of processors, its child processes included."""

    wall: float
    cpu: float


@dataclass(frozen=True)
class Costs:
    """The same thing measured several times."""

    runs: tuple[Cost, ...]

    @cached_property
    def wall(self) -> float:
        """Median seconds on the clock."""
        return statistics.median(cost.wall for cost in self.runs)

    @cached_property
    def cpu(self) -> float:
        """Median seconds of processors."""
        return statistics.median(cost.cpu for cost in self.runs)

    @property
    def fastest(self) -> float:
        return min(cost.wall for cost in self.runs)

    @property
    def slowest(self) -> float:
        return max(cost.wall for cost in self.runs)

    def spread(self, scale: float, digits: int = 3) -> str:
        """Median wall time and its range, in units of `scale` seconds."""
        low, middle, high = (f"{seconds / scale:.{digits}g}" for seconds in (self.fastest, self.wall, self.slowest))
        return f"{middle} ({low} .. {high})"


def measure(action: Callable[[], object]) -> Cost:
    """What a call costs."""
    wall, cpu = perf_counter(), _processor_seconds()
    action()
    return Cost(perf_counter() - wall, _processor_seconds() - cpu)


def interleaved(actions: dict[str, Callable[[], object]], repeats: int) -> dict[str, Costs]:
    """What each call costs, taken in turns, so that a busy minute of the machine falls on all of them."""
    runs: dict[str, list[Cost]] = {name: [] for name in actions}
    for _ in range(repeats):
        for name, action in actions.items():
            runs[name].append(measure(action))
    return {name: Costs(tuple(costs)) for name, costs in runs.items()}


def revision() -> str:
    """The revision of the sources that were measured."""
    command = ["git", "-C", str(Path(__file__).parent), "describe", "--always", "--dirty"]
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip() or "unknown"


def markdown(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A Markdown table, numbers to the right."""
    head = tuple(head)
    rule = ("---", *("---:" for _ in head[1:]))
    return "\n".join("| " + " | ".join(row) + " |" for row in (head, rule, *rows))


def _processor_seconds() -> float:
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in used)
