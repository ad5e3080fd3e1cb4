"""A process that answers commands: `python -m tests.faults.answering`, one request a line, one answer a line.

Everything is imported once. A request is answered in a process that is forked for it, under a limit of memory, or in
this one where compiled methods are to stay loaded. An audit hook tells of processes, sockets and files written outside.
"""

import json
import os
import resource
import sys
import tempfile
import traceback
from pathlib import Path
from time import perf_counter
from typing import Any

from tests.faults.watch import CACHE, watching

# What a request may take in memory beyond what has been imported.
MOST_BYTES = 2**30
BUG = 70


def stored_values(results: str) -> int:
    """Print a digest of all that a notebook sees in a folder of results."""
    import hashlib

    from cablesim import open_study
    from cablesim.errors import EnvironmentFault

    study = open_study(results)
    print(study.catalogue.to_csv())
    for scene in study:
        try:
            dataset = study[scene].load(scheduler="synchronous")
        except (OSError, RuntimeError, MemoryError) as problem:
            raise EnvironmentFault(f"{scene}.nc: {problem}") from None
        for name, values in sorted(dataset.variables.items()):
            content = values.values.astype(str) if values.dtype.kind in "UOT" else values.values
            print(scene, name, values.dims, values.attrs, hashlib.sha256(content.tobytes()).hexdigest())
    return 0


def shown(results: str) -> int:
    """Print a folder of results as a notebook shows it."""
    from cablesim import open_study

    print(open_study(results)._repr_html_())
    return 0


def obey(request: list[str]) -> int:
    """The exit code of a command; `opened` and `page` are notebooks, whose errors are told as the command does."""
    from cablesim.cli import main
    from cablesim.errors import CablesimError

    notebooks = {"opened": stored_values, "page": shown}
    if request[0] not in notebooks:
        return main(request)
    try:
        return notebooks[request[0]](request[1])
    except CablesimError as problem:
        print(f"cablesim: {problem}", file=sys.stderr)
        return problem.exit_code


def _spoken(request: dict[str, Any], streams: tuple[int, int]) -> tuple[int, list[str]]:
    """Obey with both standard streams led into files; what was seen by the watch comes with the exit code."""
    kept = [os.dup(number) for number in (1, 2)]
    for number, stream in enumerate(streams, start=1):
        os.dup2(stream, number)
    try:
        with watching(Path(request["within"]), Path(tempfile.gettempdir()), CACHE, Path(os.devnull)) as seen:
            code = obey(request["arguments"])
    except BaseException:
        traceback.print_exc()
        code, seen = BUG, []
    sys.stdout.flush()
    sys.stderr.flush()
    for number, old in enumerate(kept, start=1):
        os.dup2(old, number)
        os.close(old)
    return code, seen


def _forked(request: dict[str, Any], streams: tuple[int, int]) -> tuple[int, list[str]]:
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        _limit()
        code, seen = _spoken(request, streams)
        os.write(writer, json.dumps(seen[:20]).encode())
        os._exit(code)
    os.close(writer)
    with os.fdopen(reader, "rb") as pipe:
        told = pipe.read()
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    return code, json.loads(told) if told else []


def _limit() -> None:
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    most = pages * os.sysconf("SC_PAGE_SIZE") + MOST_BYTES
    resource.setrlimit(resource.RLIMIT_AS, (most, most))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def answer(request: dict[str, Any]) -> dict[str, Any]:
    """What a command printed, its exit code (negative for a signal), its seconds, and what it should not have done."""
    start = perf_counter()
    os.chdir(request["within"])
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        one = _forked if request["forked"] else _spoken
        code, seen = one(request, (out.fileno(), err.fileno()))
        texts = [os.pread(stream.fileno(), 2**20, 0).decode(errors="replace") for stream in (out, err)]
    return {"code": code, "out": texts[0], "err": texts[1], "seen": seen, "seconds": perf_counter() - start}


def warm_up() -> None:
    """Import what commands import, so that no request pays for it."""
    import openpyxl  # noqa: F401
    import xarray  # noqa: F401

    from cablesim import open_study, steps, verify, workflow  # noqa: F401
    from cablesim.config import scene  # noqa: F401
    from cablesim.database import answers, collect, compare, query, timing  # noqa: F401
    from cablesim.report import describe, estimate, figures, tables, verified  # noqa: F401
    from cablesim.units import factor

    factor("kN", "N")


def serve() -> None:
    """Answer until standard input ends."""
    channel = os.fdopen(os.dup(1), "w")
    warm_up()
    print(json.dumps("ready"), file=channel, flush=True)
    for line in sys.stdin:
        print(json.dumps(answer(json.loads(line))), file=channel, flush=True)


if __name__ == "__main__":
    serve()
