"""Lines in waves: random lines and corners of their parameters, judged by laws and by a second march through time.

Every scenario is asked with `time_check`, so that its result tells its own error. What it may miss beside that is ten
tolerances, for `rtol` bounds the error of a step, and a run has hundreds.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from cablesim.batch import Results
from cablesim.hunt import _wave_rest
from cablesim.hunt._case import Case, Judge
from cablesim.hunt._wave_lines import DENSITY, OPTIONAL, SEGMENTS, random_lines, scaled, with_corners
from cablesim.hunt._wave_momentum import momentum
from cablesim.hunt._wave_rest import over
from cablesim.numerics import Array
from cablesim.numerics.lanes import LANES
from cablesim.physics.waves import m18_amplitude
from cablesim.status import Status

SOLVERS = ("wave_line",)
# A line takes about a second to be marched and judged.
WEIGHTS = {"wave_line": 0.002}
PLACES = ("anchor", "middle", "top")
PEAKS = tuple(f"max_{place}_tension" for place in PLACES)
TENSIONS = tuple(f"{kind}_{place}_tension" for kind in ("max", "min", "mean") for place in PLACES)
# What is the same, to the last bit, of lines that are the same but for a mirror or for units.
SAME = (*TENSIONS, "slack_fraction", "snap_count", "max_strain", "energy_error", "steps", "rhs_evaluations")
RESTS = tuple(f"static_{place}_tension" for place in PLACES)
RECORDS = ("profile_max_tension", "profile_min_tension", "history", "history_time")
SPREADS = ("period_spread", "slack_fraction")
RECORDED_PERIODS = 5.0
# Error of a step in tolerances that is let pass.
LET_PASS = 3.0
# Newton's method leaves 1e-10 of the largest tension in every step.
STILL = 1e-7
# Bounds of the work on a scenario, and of seconds where a slow machine does not get there.
MOST_STEPS = {"generalized_alpha": 20_000, "leapfrog": 100_000, "rk4": 50_000}
MOST_SECONDS = 10.0
EXPLICIT_STEPS, FINER_STEPS = 100_000, 50_000
# Elements up to which steps of an explicit method are many but cheap.
MOST_SEGMENTS = 25
# What a peak may miss: so many of the changes that its result tells of, and so many tolerances.
CHANGES, TOLERANCES = 5.0, 10.0
# ... and of a line that goes slack, of the root of its error of energy. What numerical damping takes after a snap
# would ring, and the energy of waves goes as the square of their tension.
RINGING = 2.0


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
        "order of tensions": order,
        "records agree": records,
        "rest stays rest": stillness,
        "mirror": mirror,
        "units": units,
        "neighbours": neighbours,
        "rotation": rotation,
        "momentum of a period": momentum,
        "second march": second_march,
    }


def once(case: Case) -> Case:
    """Without the second run, which judges need not repeat."""
    return replace(case, options=case.options | {"time_check": "no"})


def told(case: Case, found: Results) -> Array:
    """What tensions may miss by what their result says of itself, over the largest of all.

    The tensions of a line that snaps are as uncertain as its periods are different, and as what is damped would ring.
    """
    change = np.maximum(found.outputs["time_change"], irregularity(found))
    ringing = np.where(found.outputs["slack_fraction"] > 0.0, np.sqrt(found.outputs["energy_error"]), 0.0)
    return CHANGES * change + RINGING * ringing + TOLERANCES * case.options["rtol"]


def irregularity(found: Results) -> Array:
    """How different the periods of lines that go slack are, over the largest tension."""
    return np.where(found.outputs["slack_fraction"] > 0.0, found.outputs["period_spread"], 0.0)


def largest(found: Results) -> Array:
    """Largest tension of all places."""
    return np.max([found.outputs[name] for name in PEAKS], axis=0)


def distance(found: Results, other: Results, rows: Any = slice(None)) -> Array:
    """Largest difference of tensions, over the largest of all; `other` has these rows of what was found."""
    miss = np.max([np.abs(found.outputs[name][rows] - other.outputs[name]) for name in TENSIONS], axis=0)
    return over(miss, largest(found)[rows])


def unequal(found: Results, other: Results, units: dict[str, float] | None = None) -> Array:
    """Infinity where anything differs in any bit; NaN where the other was given up."""
    is_same = np.ones(found.status.size, dtype=bool)
    for name in SAME:
        is_same &= found.outputs[name] == other.outputs[name] / (units or {}).get(name, 1.0)
    return np.where(other.status == Status.not_converged, np.nan, np.where(is_same, 0.0, np.inf))


def order(case: Case, found: Results) -> Array:
    """No tension is below zero, none is out of the order of least, mean and largest, and shares are shares."""
    out = found.outputs
    wrong = [np.zeros(found.status.size)]
    for place in PLACES:
        least, mean, most = (out[f"{kind}_{place}_tension"] for kind in ("min", "mean", "max"))
        # A mean over many steps is rounded in each.
        rounding = 1e-12 * most
        wrong += [over(least - mean, rounding), over(mean - most, rounding), np.where(least < 0.0, np.inf, 0.0)]
    is_share = (out["slack_fraction"] >= 0.0) & (out["slack_fraction"] <= 1.0 + 1e-12)
    return np.max([*wrong, np.where(is_share, 0.0, np.inf)], axis=0)


def records(case: Case, found: Results) -> Array:
    """Whoever asks for histories gets the same numbers, and histories and extremes along the line that fit them."""
    asked = once(case).solve((*SAME, *RECORDS))
    out = asked.outputs
    was_slack = (out["profile_min_tension"][:, 1:-1] == 0.0).any(axis=1) | (out["snap_count"] > 0.0)
    is_wrong = was_slack & (out["slack_fraction"] == 0.0)
    is_wrong |= (out["profile_min_tension"] > out["profile_max_tension"]).any(axis=1)
    for kind, node, place in (("max", 0, "anchor"), ("max", -1, "top"), ("min", 0, "anchor"), ("min", -1, "top")):
        is_wrong |= out[f"profile_{kind}_tension"][:, node] != out[f"{kind}_{place}_tension"]
    miss = [unequal(found, asked), np.where(is_wrong, np.inf, 0.0)]
    # Histories and extremes are of parabolas that are not through the same points: as far apart as steps are wrong.
    allowed = found.outputs["time_change"] + LET_PASS * case.options["rtol"]
    return np.max([*miss, over(_beyond(case, out), allowed * largest(found))], axis=0)


def _beyond(case: Case, out: dict[str, Array]) -> Array:
    """By how much histories leave the extremes of their last periods, or fall below nothing."""
    time, history = out["history_time"], out["history"].astype(float)
    window = time[:, -1] - RECORDED_PERIODS * case.parameters["wave_period"]
    is_recorded = (time >= window[:, None])[:, :, None]
    most, least = (np.stack([out[f"{kind}_{place}_tension"] for place in PLACES], axis=-1) for kind in ("max", "min"))
    outside = np.maximum(history - most[:, None], least[:, None] - history)
    return np.maximum(np.where(is_recorded, outside, -history).max(axis=(1, 2)), 0.0)


def stillness(case: Case, found: Results) -> Array:
    """A line that nothing moves keeps the tensions that it has at rest, as Newton's method finds them."""
    period = case.parameters["wave_period"]
    moves = {name: 0.0 * period for name in OPTIONAL if name in case.parameters} or {"top_amplitude": 0.0 * period}
    still = once(case).solve((*TENSIONS, *RESTS), duration=2.0 * period, **moves)
    miss = [
        np.abs(still.outputs[f"{kind}_{place}_tension"] - still.outputs[f"static_{place}_tension"])
        for place in PLACES
        for kind in ("max", "min", "mean")
    ]
    rounding = _wave_rest.at_rest(case).rounding[:, 0] * case.parameters["linear_stiffness"]
    return over(np.max(miss, axis=0), STILL * largest(still) + rounding)


def mirror(case: Case, found: Results) -> Array:
    """Waves from the other side move the line's mirror image."""
    return unequal(found, once(case).solve(SAME, heading=-case.parameters["heading"]))


def units(case: Case, found: Results) -> Array:
    """Powers of two that leave gravity what it is change no bit; M18 has units of its own."""
    if not set(OPTIONAL) & set(case.parameters):
        return np.full(case.size, np.nan)
    length, time, mass = 4.0, 2.0, 8.0
    line = {"fluid_density": np.full(case.size, DENSITY)} | case.parameters
    other = once(case).solve(SAME, **scaled(line, length, time, mass))
    return unequal(found, other, dict.fromkeys(TENSIONS, mass * length / time**2))


def neighbours(case: Case, found: Results) -> Array:
    """A line does not depend on those beside it."""
    turned = once(case).rows(slice(None, None, -1)).solve(SAME)
    outputs = {name: values[::-1] for name, values in turned.outputs.items()}
    return unequal(found, replace(turned, outputs=outputs, status=turned.status[::-1]))


def rotation(case: Case, found: Results) -> Array:
    """An upright line has no other direction than that of the waves; steps may differ, for they see components."""
    miss = np.full(case.size, np.nan)
    upright = np.flatnonzero(case.parameters["chord_angle"] == 0.5 * np.pi)
    if upright.size:
        some = case.rows(upright)
        other = some.solve(heading=some.parameters["heading"] + 1.0)
        miss[upright] = distance(found, other, upright) / (told(case, found)[upright] + told(some, other))
    return miss


def second_march(case: Case, found: Results) -> Array:
    """The same line by an explicit method, or where that takes too many steps with a hundredth of the tolerance.

    The other march of a line that snaps is a sample as well, and no more certain than its own periods are alike.
    """
    miss = np.full(case.size, np.nan)
    for options in _finer(case):
        rest = np.flatnonzero(np.isnan(miss))
        if rest.size:
            other = replace(case, options=case.options | options).rows(rest).solve((*TENSIONS, *SPREADS))
            miss[rest] = distance(found, other, rest) / (told(case, found)[rest] + irregularity(other))
    return miss


def _finer(case: Case) -> list[dict[str, Any]]:
    rtol, integrator = case.options["rtol"], case.options["integrator"]
    explicit = {"integrator": "leapfrog" if integrator == "rk4" else "rk4", "rtol": 0.1 * rtol}
    finer = {"integrator": "generalized_alpha", "rtol": 0.01 * rtol, "most_steps": FINER_STEPS}
    first = [explicit | {"most_steps": EXPLICIT_STEPS}] if case.options["segments"] <= MOST_SEGMENTS else []
    return [options | {"time_check": "no"} for options in (*first, finer)]
