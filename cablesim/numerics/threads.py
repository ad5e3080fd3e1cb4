"""How many threads a job may use, and a clock that compiled loops can look at."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event, Thread
from time import perf_counter

import numpy as np

from cablesim.numerics import Array

TICK = 0.1


def thread_count() -> int:
    """OMP_NUM_THREADS, which Snakemake sets to the threads of the job; else the processors this process may use."""
    given = os.environ.get("OMP_NUM_THREADS", "")
    if given.isdigit() and int(given) > 0:
        return int(given)
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def ticking() -> Iterator[Array]:
    """Seconds since now (1,), kept up to date to a tenth of a second by a thread of its own."""
    clock, ended, start = np.zeros(1), Event(), perf_counter()

    def tick() -> None:
        while not ended.wait(TICK):
            clock[0] = perf_counter() - start

    thread = Thread(target=tick, daemon=True)
    thread.start()
    try:
        yield clock
    finally:
        ended.set()
        thread.join()
