"""The balance of momentum of the last period, of lines that stay taut in still water or in a stream.

What the first and the last element pull, and weight and drag of what is between them, is what that gains of momentum.
Shapes and tensions are those of snapshots, velocities are their differences.
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
PHASES = 64
# A line whose periods are alike to this part of its largest tension does not ring between snapshots; of what they
# leave, this part. (Differences of so many are good to 0.2 % of a velocity.)
ALIKE, LEFT_OVER = 1e-3, 3e-3
# Shares of the mass of its two elements that a node feels by its own acceleration and by its neighbours'.
SHARES = {"lumped": (1.0, 0.0), "consistent": (2.0 / 3.0, 1.0 / 6.0)}


def momentum(case: Case, found: Results) -> Array:
    """Mean force on the inner nodes less what they gain of momentum, over the largest tension."""
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
    """Still water, always taut, no ramp any more; added mass that turns with the line gives momentum away."""
    given = given_or_standard(case.parameters)
    is_still = given["wave_height"] == 0.0
    is_fixed = (given["added_mass_per_length"] == 0.0) | (case.options["added_mass"] == "isotropic")
    is_alike = (found.outputs["slack_fraction"] == 0.0) & (found.outputs["period_spread"] < ALIKE)
    is_late = given["duration"] - 5.0 * given["wave_period"] > given["ramp"]
    return is_still & is_fixed & is_alike & is_late


def _mean_force(case: Case, out: dict[str, Array]) -> Array:
    given = {name: values[:, None, None, None] for name, values in given_or_standard(case.parameters).items()}
    places = out["snapshots"].astype(float)
    step, count = given["wave_period"] / PHASES, places.shape[2] - 1
    velocity = np.gradient(places, axis=1, edge_order=2) / step
    pieces = np.diff(places, axis=2)
    tangents = pieces / np.linalg.norm(pieces, axis=3, keepdims=True)
    chord = given["depth"] / np.sin(given["chord_angle"])
    piece = given["length_ratio"] * chord / count
    load = piece * _load(given, tangents, 0.5 * (velocity[:, :, 1:] + velocity[:, :, :-1]))
    inner = load.sum(axis=2) - 0.5 * (load[:, :, 0] + load[:, :, -1])
    pulls = out["snapshot_tension"].astype(float)[:, :, [0, -1], None] * tangents[:, :, [0, -1]]
    force = np.trapezoid(pulls[:, :, 1] - pulls[:, :, 0] + inner, axis=1) / (PHASES - 1)
    own, other = SHARES[case.options["mass"]]
    moved = own * velocity[:, :, 1:-1] + other * (velocity[:, :, :-2] + velocity[:, :, 2:])
    gain = (piece * (given["mass_per_length"] + given["added_mass_per_length"]) * moved).sum(axis=2)
    return force - (gain[:, -1] - gain[:, 0]) / ((PHASES - 1) * step[:, 0, 0])


def _load(given: dict[str, Array], tangents: Array, velocity: Array) -> Array:
    """Drag and weight per length of elements of such directions and velocities."""
    heading = given["heading"]
    way = np.concatenate([np.cos(heading), np.sin(heading), 0.0 * heading], axis=3)
    flow = given["stream_speed"] * way - velocity
    along = (flow * tangents).sum(axis=3, keepdims=True) * tangents
    across = flow - along
    drag = given["normal_drag"] * np.linalg.norm(across, axis=3, keepdims=True) * across
    drag = drag + given["tangential_drag"] * np.linalg.norm(along, axis=3, keepdims=True) * along
    weight = (given["mass_per_length"] - given["fluid_density"] * given["area"]) * GRAVITY
    return drag - weight * [0.0, 0.0, 1.0]
