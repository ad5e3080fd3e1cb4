"""How many threads a job may use."""

import os


def thread_count() -> int:
    """OMP_NUM_THREADS, which Snakemake sets to the threads of the job; else the processors this process may use."""
    given = os.environ.get("OMP_NUM_THREADS", "")
    if given.isdigit() and int(given) > 0:
        return int(given)
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
