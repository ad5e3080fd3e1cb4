"""Lines in waves: random lines and corners of their parameters, judged by laws and by a second march through time.

Every scenario is asked with `time_check`, so that its result tells its own error.
"""

import numpy as np

from cablesim.hunt import _wave_moved, _wave_rest
from cablesim.hunt._case import Case, Judge
from cablesim.hunt._wave_lines import OPTIONAL, SEGMENTS, random_lines, with_corners
from cablesim.hunt._wave_momentum import momentum
from cablesim.numerics import Array
from cablesim.numerics.lanes import LANES
from cablesim.physics.waves import m18_amplitude

SOLVERS = ("wave_line",)
# A line takes about a second to be marched and judged.
WEIGHTS = {"wave_line": 0.002}
# Bounds of the work on a scenario, and of seconds where a slow machine does not get there.
MOST_STEPS = {"generalized_alpha": 20_000, "leapfrog": 100_000, "rk4": 50_000}
MOST_SECONDS = 10.0


def draw(solver: str, size: int, rng: np.random.Generator) -> list[Case]:
    """Lines that march side by side have the same options."""
    return [_draw_lanes(solver, min(LANES, size - first), rng) for first in range(0, size, LANES)]


def _draw_lanes(solver: str, size: int, rng: np.random.Generator) -> Case:
    line = with_corners(random_lines(size, rng), rng)
    integrator = str(rng.choice(list(MOST_STEPS), p=[0.8, 0.1, 0.1]))
    # Fine meshes cost as their square.
    shares = np.sqrt(1.0 / np.array(SEGMENTS if integrator == "generalized_alpha" else SEGMENTS[:4]))
    count = rng.choice(SEGMENTS[: shares.size], p=shares / shares.sum())
    options = {
        "segments": int(count),
        "integrator": integrator,
        "rtol": float(rng.choice([1e-2, 1e-3, 1e-4], p=[0.1, 0.8, 0.1])),
        "mass": str(rng.choice(["consistent", "lumped"])),
        "added_mass": str(rng.choice(["normal", "isotropic"])),
        "time_check": "yes",
        "most_steps": MOST_STEPS[integrator],
        "most_seconds": MOST_SECONDS,
    }
    return Case(solver, _with_motion(line, rng), options)


def _with_motion(line: dict[str, Array], rng: np.random.Generator) -> dict[str, Array]:
    """A motion of the top end that is given, or that of the surface, or (in still water) by M18."""
    by_period = m18_amplitude(line["wave_period"])
    if rng.random() < 0.7:
        amplitude = line["top_amplitude"]
        filled = {"top_amplitude": np.where(np.isnan(amplitude), by_period, amplitude)}
        return line | filled | {"wave_height": np.nan_to_num(line["wave_height"])}
    left_out = OPTIONAL if rng.random() < 0.3 else ("top_amplitude",)
    kept = {name: values for name, values in line.items() if name not in left_out}
    if "wave_height" in kept:
        kept["wave_height"] = np.where(np.isnan(kept["wave_height"]), by_period, kept["wave_height"])
    return kept


def judges(solver: str) -> dict[str, Judge]:
    """Laws first, the second march last."""
    return {
        "balance at rest": _wave_rest.balance,
        "closure at rest": _wave_rest.closure,
        "law at rest": _wave_rest.law,
        "supports at rest": _wave_rest.supports,
        "no compression at rest": _wave_rest.no_compression,
        "order of tensions": _wave_moved.order,
        "records agree": _wave_moved.records,
        "rest stays rest": _wave_moved.stillness,
        "mirror": _wave_moved.mirror,
        "units": _wave_moved.units,
        "neighbours": _wave_moved.neighbours,
        "rotation": _wave_moved.rotation,
        "momentum of a period": momentum,
        "second march": _wave_moved.second_march,
    }
