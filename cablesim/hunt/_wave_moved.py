"""Judges of a line that moves: order and records, symmetries, and a second march through time.

What a result may miss is what it says of itself, and ten tolerances: `rtol` bounds the error of a step, and a run has
hundreds.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from cablesim.batch import Results
from cablesim.hunt import _wave_rest
from cablesim.hunt._case import Case
from cablesim.hunt._wave_lines import DENSITY, OPTIONAL, scaled, unmoved
from cablesim.hunt._wave_rest import over
from cablesim.numerics import Array
from cablesim.status import Status

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
# Part of the range of a sine by which two parabolas through three of sixteen points of it, the fewest steps of a period
# that are taken, may miss it in different directions.
BETWEEN = (2.0 * np.pi / 16.0) ** 3 / (9.0 * np.sqrt(3.0))
# Newton's method leaves 1e-10 of the largest tension in every step.
STILL = 1e-7
EXPLICIT_STEPS, FINER_STEPS = 100_000, 50_000
# Elements up to which steps of an explicit method are many but cheap.
MOST_SEGMENTS = 25
# What a peak may miss: so many of the changes that its result tells of, and so many tolerances.
CHANGES, TOLERANCES = 5.0, 10.0
# ... and of a line that goes slack, of the root of its error of energy. What numerical damping takes after a snap
# would ring, and the energy of waves goes as the square of their tension.
RINGING = 2.0
# A change that says only that nothing is known.
UNKNOWN = 0.1


def once(case: Case) -> Case:
    """Without the second run, which judges need not repeat."""
    return replace(case, options=case.options | {"time_check": "no"})


def told(case: Case, found: Results) -> Array:
    """What tensions may miss by what their result says of itself, over the largest of all.

    The tensions of a line that snaps are as uncertain as its periods are different, and as what is damped would ring. A
    change tells of the error while it is small: one of a tenth says that steps are far too long for what the line does,
    and no more; NaN then.
    """
    change = np.maximum(found.outputs["time_change"], irregularity(found))
    ringing = np.where(found.outputs["slack_fraction"] > 0.0, np.sqrt(found.outputs["energy_error"]), 0.0)
    allowed = CHANGES * change + RINGING * ringing + TOLERANCES * case.options["rtol"]
    return np.where(found.outputs["time_change"] > UNKNOWN, np.nan, allowed)


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
    # Histories and extremes are of parabolas that are not through the same points: as far apart as steps are wrong, and
    # as parabolas are between steps.
    largest_range = np.ptp(out["history"].astype(float), axis=1).max(axis=1)
    allowed = (found.outputs["time_change"] + LET_PASS * case.options["rtol"]) * largest(found)
    beyond = _beyond(case, out, largest(found)[:, None, None])
    return np.max([*miss, over(beyond, allowed + BETWEEN * largest_range)], axis=0)


def _beyond(case: Case, out: dict[str, Array], scale: Array) -> Array:
    """By how much histories leave the extremes of their last periods, or fall below nothing.

    Their squares are told between steps: half the difference of squares over the largest tension, `scale`, which for
    tensions near that is their difference.
    """
    time, history = out["history_time"], out["history"].astype(float)
    window = time[:, -1] - RECORDED_PERIODS * case.parameters["wave_period"]
    is_recorded = (time >= window[:, None])[:, :, None]
    most, least = (np.stack([out[f"{kind}_{place}_tension"] for place in PLACES], axis=-1) for kind in ("max", "min"))
    squares = history * history
    outside = np.maximum(squares - most[:, None] ** 2, least[:, None] ** 2 - squares) / (2.0 * scale)
    return np.maximum(np.where(is_recorded, outside, -history).max(axis=(1, 2)), 0.0)


def stillness(case: Case, found: Results) -> Array:
    """A line that nothing moves keeps the tensions that it has at rest, as Newton's method finds them."""
    period = case.parameters["wave_period"]
    still = once(case).solve((*TENSIONS, *RESTS), duration=2.0 * period, **unmoved(case.parameters))
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

    At its longest stable step `rk4` damps the shortest waves, and 12 % of a peak were lost by that: a third is taken.

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
    explicit = {"integrator": "leapfrog" if integrator == "rk4" else "rk4", "rtol": 0.1 * rtol, "step_part": 0.3}
    finer = {"integrator": "generalized_alpha", "rtol": 0.01 * rtol, "most_steps": FINER_STEPS}
    first = [explicit | {"most_steps": EXPLICIT_STEPS}] if case.options["segments"] <= MOST_SEGMENTS else []
    return [options | {"time_check": "no"} for options in (*first, finer)]
