"""Ask commands of processes that answer them, with a limit of time, and judge what they say."""

import atexit
import json
import os
import select
import subprocess
import sys
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

PROJECT = Path(__file__).parents[2]
SECONDS = 120.0
LONGEST_LINE = 1000
NO_ANSWER = 1000


@dataclass(frozen=True)
class Told:
    """What a command printed, its exit code (negative for a signal), and what it should not have done."""

    code: int
    out: str = ""
    err: str = ""
    seconds: float = 0.0
    seen: list[str] = field(default_factory=list)

    @property
    def wrong(self) -> str:
        """What no command may do, whatever it is asked; empty where it did none of that."""
        if self.code == NO_ANSWER:
            return f"no answer within {SECONDS:.0f} s"
        if self.code not in (0, 1, 2, 3):
            return f"exit code {self.code}: {self.err[-300:]}"
        if "Traceback" in self.err or "Warning" in self.err:
            return f"a traceback or a warning: {self.err[-300:]}"
        if self.seen:
            return f"it did {self.seen[:3]}"
        return self._ill_refused if self.code >= 2 else ""

    @property
    def _ill_refused(self) -> str:
        """Why a refusal is none: it is one line that can be printed."""
        last = self.err.splitlines()[-1] if self.err else ""
        told = (
            (self.code == 3 or not self.out)
            and last.startswith("cablesim: ")
            and len(last) <= LONGEST_LINE
            and last.isprintable()
        )
        return "" if told else f"an unclear refusal: {self.out[-100:]!r} {self.err[-300:]!r}"

    def refuses(self, code: int, *phrases: str) -> bool:
        """Whether it refuses with this exit code, and names all of that."""
        return self.code == code and all(phrase in self.err for phrase in phrases)


class Asked:
    """A process that answers, started anew where it had to be stopped."""

    def __init__(self) -> None:
        self.process: subprocess.Popen[str] | None = None

    def __call__(self, arguments: list[str], within: Path, forked: bool = True, seconds: float = SECONDS) -> Told:
        """What a command says, asked in a folder."""
        process = self._started()
        request = {"arguments": arguments, "within": str(within), "forked": forked}
        found = self._answer(process, json.dumps(request), seconds)
        if found is None:
            self.stop()
            return Told(NO_ANSWER, seconds=seconds)
        return Told(**found)

    def stop(self) -> None:
        """End the process and what it has forked."""
        if self.process is not None:
            os.killpg(self.process.pid, 9)
            self.process.communicate()
            self.process = None

    def _started(self) -> "subprocess.Popen[str]":
        if self.process is None:
            self.process = subprocess.Popen(
                [sys.executable, "-m", "tests.faults.answering"],
                cwd=PROJECT,
                env={**os.environ, "PYTHONPATH": str(PROJECT), "OMP_NUM_THREADS": "1"},
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
                start_new_session=True,
            )
            if self._line(self.process, 2 * SECONDS) != "ready":
                raise RuntimeError("the process that answers has not started")
        return self.process

    def _answer(self, process: "subprocess.Popen[str]", request: str, seconds: float) -> dict[str, Any] | None:
        assert process.stdin is not None
        process.stdin.write(request + "\n")
        process.stdin.flush()
        return self._line(process, seconds)

    def _line(self, process: "subprocess.Popen[str]", seconds: float) -> Any:
        """The next line, decoded; None where there is none in time. Lines are asked for one by one, so none waits."""
        assert process.stdout is not None
        ready, _, _ = select.select([process.stdout], [], [], seconds)
        line = process.stdout.readline() if ready else ""
        return json.loads(line) if line else None


@cache
def asking() -> Asked:
    """The process that answers, the same for all faults; it ends with this one."""
    asked = Asked()
    atexit.register(asked.stop)
    return asked
