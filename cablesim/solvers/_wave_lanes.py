"""Marching a batch side by side in lanes on all threads, each scenario within its bounds of steps and time."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from cablesim.numerics.lanes import LANES
from cablesim.numerics.threads import thread_count, ticking
from cablesim.solvers._wave_pack import Marched, Problem, Records


def march_all(
    march: Callable[..., None], problem: Problem, has_waves: bool, options: Any, records: Records, *more: Any
) -> Marched:
    """March all scenarios on the threads that there are; neither their number nor the batch changes any result.

    `march(problem, has_waves, limits, clock, records, fates, first, stride, width, *more)` marches every `stride`th
    scenario from `first` on, `width` at a time. `limits` are the tolerance, a fixed step (0: chosen by the method), the
    part of its longest steps that a method takes, the most steps and the most seconds; `clock` (1,) tells the time.
    Written: `records`, and `fates` (scenario, 4): fate, steps, rejected steps, evaluations.
    """
    size = len(problem.lines)
    fates = np.zeros((size, 4))
    threads = max(1, min(thread_count(), size))
    width = min(LANES, -(-size // threads))
    limits = np.array(
        [options.rtol, options.time_step, options.step_part, float(options.most_steps), options.most_seconds]
    )
    with ticking() as clock, ThreadPoolExecutor(threads) as pool:
        work = [
            pool.submit(march, problem, has_waves, limits, clock, records, fates, first, threads, width, *more)
            for first in range(threads)
        ]
        for part in work:
            part.result()
    fate, steps, rejected, evaluations = fates.T
    return Marched(fate, steps, rejected, evaluations, records)
