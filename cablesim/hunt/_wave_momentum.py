"""The balance of momentum over a period, of lines that move periodically in still water or in a stream.

Over a whole period nothing is gained: the mean pull of the first and last element is what weight and mean drag of all
that is between them want. Shapes and tensions are those of snapshots, velocities are their derivatives.
"""

from dataclasses import replace

import numpy as np

from cablesim.batch import Results
from cablesim.hunt._case import Case
from cablesim.hunt._wave_lines import given_or_standard
from cablesim.hunt._wave_rest import over
from cablesim.numerics import Array
from cablesim.physics.waves import GRAVITY

OUTPUTS = ("snapshots", "snapshot_tension", "max_top_tension")
PHASES, HARMONICS = 64, 16
# Periods are alike to this part of the largest tension; they gain some of it, and snapshots are rounded.
ALIKE, LEFT_OVER = 1e-3, 5e-3


def momentum(case: Case, found: Results) -> Array:
    """Mean force on the inner nodes over a period, over the largest tension."""
    miss = np.full(case.size, np.nan)
    rows = np.flatnonzero(_is_judged(case, found))
    if rows.size:
        some = replace(case, options=case.options | {"time_check": "no", "phases": PHASES}).rows(rows)
        out = some.solve(OUTPUTS).outputs
        left = np.linalg.norm(_mean_force(some, out), axis=1)
        told = found.outputs["time_change"][rows] + LEFT_OVER
        miss[rows] = over(left, told * out["max_top_tension"])
    return miss


def _is_judged(case: Case, found: Results) -> Array:
    """Still water, always taut, periodic after the ramp; added mass that turns with the line gives momentum away."""
    given = given_or_standard(case.parameters)
    is_still = given["wave_height"] == 0.0
    is_fixed = (given["added_mass_per_length"] == 0.0) | (case.options["added_mass"] == "isotropic")
    is_alike = (found.outputs["slack_fraction"] == 0.0) & (found.outputs["period_spread"] < ALIKE)
    is_late = given["duration"] - 5.0 * given["wave_period"] > given["ramp"]
    return is_still & is_fixed & is_alike & is_late


def _mean_force(case: Case, out: dict[str, Array]) -> Array:
    given = {name: values[:, None, None, None] for name, values in given_or_standard(case.parameters).items()}
    places = out["snapshots"].astype(float)
    pieces = np.diff(places, axis=2)
    tangents = pieces / np.linalg.norm(pieces, axis=3, keepdims=True)
    velocity = _rate(0.5 * (places[:, :, 1:] + places[:, :, :-1]), given["wave_period"])
    heading = given["heading"]
    way = np.concatenate([np.cos(heading), np.sin(heading), 0.0 * heading], axis=3)
    flow = given["stream_speed"] * way - velocity
    along = (flow * tangents).sum(axis=3, keepdims=True) * tangents
    load = given["normal_drag"] * np.linalg.norm(flow - along, axis=3, keepdims=True) * (flow - along)
    load = load + given["tangential_drag"] * np.linalg.norm(along, axis=3, keepdims=True) * along
    weight = (given["mass_per_length"] - given["fluid_density"] * given["area"]) * GRAVITY
    chord = given["depth"] / np.sin(given["chord_angle"])
    load = (load - weight * [0.0, 0.0, 1.0]) * given["length_ratio"] * chord / pieces.shape[2]
    inner = load.sum(axis=2) - 0.5 * (load[:, :, 0] + load[:, :, -1])
    pulls = out["snapshot_tension"].astype(float)[:, :, [0, -1], None] * tangents[:, :, [0, -1]]
    return (pulls[:, :, 1] - pulls[:, :, 0] + inner).mean(axis=1)


def _rate(values: Array, period: Array) -> Array:
    """Derivative by time of periodic values (scenario, phase, ...), of as many harmonics as are not noise."""
    waves = np.fft.rfft(values, axis=1)
    orders = np.arange(waves.shape[1])
    factors = np.where(orders <= HARMONICS, 2.0j * np.pi * orders, 0.0)[None, :, None, None] / period
    return np.fft.irfft(factors * waves, n=values.shape[1], axis=1)
