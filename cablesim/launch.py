"""Run a study by Snakemake, in this process, and say what became of it with an exit code of ours.

A step that fails tells why in its last line, which ends with its exit code; Snakemake's records lead to it.
"""

import importlib.util
import logging
import re
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from cablesim.errors import CablesimError, EnvironmentFault, InputError
from cablesim.estimate import estimate_study
from cablesim.files import free_bytes
from cablesim.fitting import refuse_what_does_not_fit, room_at
from cablesim.machine import available_cores
from cablesim.slurm import cancel_jobs, is_slurm, job_prefix
from cablesim.workflow import PlannedStudy, plan_study

SLURM_PLUGIN = "snakemake_executor_plugin_slurm"
SNAKEFILE, PROFILES, DEFAULT = Path("Snakefile"), Path("workflow") / "profiles", "default"
# What a failed step says last, and what is left of it where even its log could not be written.
LAST_LINE = re.compile(r"^cablesim: (?P<message>.*) \(exit code (?P<code>\d+)\)$", re.MULTILINE)
STATUS = re.compile(r"returned non-zero exit status (\d+)")
DIED = re.compile(r"died with <Signals\.(\w+): \d+>")
MACHINE = re.compile(
    r"(?:No space left on device|Permission denied|Read-only file system|Disk quota exceeded)(?:: '([^'\n]*)')?"
)
STOPPED = re.compile(r"on user request|Will exit after finishing currently running jobs")
# No step of ours ends with 1: its log could not be written.
UNSAID, KILLED, INTERRUPTED = 1, 128, 130


class StepFailed(CablesimError):
    """A step of the workflow could not be done; others may have been."""

    def __init__(self, message: str, code: int) -> None:
        super().__init__(message)
        self.exit_code = code


def run_study(
    config: Path, profile: str, cores: str | None, dry_run: bool = False, anyway: bool = False
) -> PlannedStudy:
    """Do all that a study still asks for, after whatever interruption; a dry run only tells what that is.

    Raises InputError for anything wrong in the files of the study, EnvironmentFault where the machine is in the way or
    another run is in the same folder, or where the study does not fit on the disk or into memory (unless it is to start
    `anyway`), and StepFailed, with the gravest message and its exit code, where steps failed.
    """
    folder = PROFILES / profile
    for path in (SNAKEFILE, folder / "config.yaml"):
        if not path.is_file():
            raise InputError(f"{path}: no such file; a study is run in the folder that holds it")
    if cores is not None and cores != "all" and not (cores.isdigit() and int(cores)):
        raise InputError(f"--cores must be a number of cores or 'all', not '{cores[:20]}'")
    planned = plan_study(config, holding=not dry_run)
    if not (dry_run or anyway):
        _refuse_what_does_not_fit(planned, profile, cores)
    from snakemake.cli import main

    command = ["--snakefile", str(SNAKEFILE), "--workflow-profile", str(folder), "--configfile", str(config)]
    command += [*(("--cores", cores) if cores else ()), *(("--dry-run",) if dry_run else ())]
    if is_slurm(folder / "config.yaml") and not dry_run:
        command += _on_slurm(Path(planned.results))
    with _listening(Path(planned.results)) as heard:
        try:
            main(command)
        except SystemExit as end:
            if end.code:
                raise heard.gravest() from None
        finally:
            _cancel_timers()
    return planned


def _cancel_timers() -> None:
    """Snakemake's scheduler wakes itself a second after its last job, and this process would wait for it."""
    for thread in threading.enumerate():
        if isinstance(thread, threading.Timer):
            thread.cancel()


def _on_slurm(results: Path) -> list[str]:
    """Cancel the jobs of a killed run, as far as there are any, and name the new ones so that they can be found."""
    if not importlib.util.find_spec(SLURM_PLUGIN):
        raise InputError(f"the Python package {SLURM_PLUGIN} is missing: 'make .venv/slurm' installs it")
    cancelled = cancel_jobs(results)
    if cancelled:
        print(f"{results}: {cancelled} Slurm jobs of a run that was killed are cancelled", file=sys.stderr)
    return ["--slurm-jobname-prefix", job_prefix(results)]


def _refuse_what_does_not_fit(planned: PlannedStudy, profile: str, cores: str | None) -> None:
    """Raises EnvironmentFault where disk or memory do not suffice; memory counts where jobs run on this machine."""
    own = int(cores) if cores is not None and cores != "all" else available_cores()
    scenes, plans = zip(*((one.scene, one.shard_plan) for one in planned.scenes), strict=True)
    layout = planned.scenes[0].layout
    room = room_at(layout.root)
    found = estimate_study(scenes, layout, own, plans)
    refuse_what_does_not_fit(found, room if profile == DEFAULT else replace(room, memory=None), layout.root)


class _Failures(logging.Filter):
    """What Snakemake says of steps that failed."""

    def __init__(self, results: Path = Path()) -> None:
        super().__init__()
        self.results = results
        self.told: dict[str, int] = {}
        self.codes: list[int] = []
        self.logs = [results]
        self.machine = ""
        self.stopped = False

    def filter(self, record: logging.LogRecord) -> bool:
        """Look at a record; it is shown unless it is a traceback of Snakemake's about the machine."""
        message = record.getMessage()
        for log in getattr(record, "log", None) or ():
            self.logs.append(Path(log))
            self._read(Path(log))
        self.codes += [int(code) for code in STATUS.findall(message)] + [KILLED for _ in DIED.findall(message)]
        self.stopped |= STOPPED.search(message) is not None
        found = MACHINE.search(message) if record.levelno >= logging.ERROR else None
        if found is None:
            return True
        path = Path(found[1]) if found[1] else self.results
        self.machine = f"{path}: {found[0].partition(':')[0]}, free {free_bytes(path)} bytes"
        return False

    def gravest(self) -> CablesimError:
        """The error to end with: a bug of ours before the machine, the machine before the user."""
        if self.stopped:
            return StepFailed("interrupted; the same command goes on with it", INTERRUPTED)
        if self.told:
            message, code = max(self.told.items(), key=lambda item: item[1])
            others = f" (and {len(self.told) - 1} more)" if len(self.told) > 1 else ""
            return StepFailed(f"{message}{others}", code)
        if self.machine:
            return EnvironmentFault(self.machine)
        if any(code >= KILLED for code in self.codes):
            return EnvironmentFault("a step was killed: memory may have run out, or somebody ended it; run it again")
        if UNSAID in self.codes:
            free = free_bytes(self.logs[-1])
            return EnvironmentFault(f"{self.logs[-1]}: the log of a step that failed, on a disk with {free} bytes free")
        return StepFailed("Snakemake has not finished the study: see above", max(self.codes, default=4))

    def _read(self, log: Path) -> None:
        try:
            text = log.read_text(encoding="utf-8", errors="replace")
        except OSError:
            return
        self.told.update({found["message"]: int(found["code"]) for found in LAST_LINE.finditer(text)})


@contextmanager
def _listening(results: Path) -> Iterator[_Failures]:
    from snakemake.logging import logger

    failures = _Failures(results)
    logger.addFilter(failures)
    # A log that cannot be written because the disk is full is no reason for tracebacks.
    logging.raiseExceptions = False
    try:
        yield failures
    finally:
        logger.removeFilter(failures)
