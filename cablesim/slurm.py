"""Jobs on a Slurm cluster: those of one folder of results are known by the first part of their names."""

import hashlib
import re
import subprocess
import time
from pathlib import Path

from cablesim.errors import EnvironmentFault

EXECUTOR = re.compile(r"^executor:\s*slurm\s*$", re.MULTILINE)
# How long cancelled jobs may take to end, and how long Slurm to answer.
END, ANSWER = 60.0, 30.0


def is_slurm(profile: Path) -> bool:
    """Whether a profile of the workflow is for Slurm."""
    return EXECUTOR.search(profile.read_text(encoding="utf-8")) is not None


def job_prefix(folder: Path) -> str:
    """What the names of all jobs for a folder of results begin with."""
    return f"cablesim_{hashlib.sha256(str(folder.resolve()).encode()).hexdigest()[:16]}"


def cancel_jobs(folder: Path) -> int:
    """Cancel the jobs that a killed run of this folder has left with Slurm; returns how many, when they have ended.

    Raises EnvironmentFault where Slurm does not answer, or the jobs do not end.
    """
    cancelled: set[str] = set()
    until = time.monotonic() + END
    while left := _jobs(job_prefix(folder)):
        if time.monotonic() > until:
            raise EnvironmentFault(f"{folder}: jobs of an earlier run do not end: {', '.join(sorted(left))}")
        _call("scancel", *sorted(left))
        cancelled |= left
        time.sleep(0.5)
    return len(cancelled)


def _jobs(prefix: str) -> set[str]:
    """The jobs that are waiting, at work or ending."""
    states = "--states=PENDING,CONFIGURING,RUNNING,SUSPENDED,COMPLETING"
    lines = _call("squeue", "--me", "--noheader", states, "--format=%i %j").splitlines()
    return {number for number, _, name in (line.partition(" ") for line in lines) if name.startswith(prefix)}


def _call(*command: str) -> str:
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=ANSWER, check=False)
    except (OSError, subprocess.TimeoutExpired) as problem:
        raise EnvironmentFault(f"{command[0]}: Slurm does not answer ({problem})") from None
    if done.returncode:
        raise EnvironmentFault(f"{command[0]}: Slurm does not answer ({done.stderr.strip()})")
    return done.stdout
