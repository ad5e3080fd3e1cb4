"""Vibrations of moored lines: bounds that hold for any of them, and the stable step that linear theory promises."""

import numpy as np

from cablesim.batch import Results
from cablesim.hunt import _anything
from cablesim.hunt._case import Case, Judge
from cablesim.hunt._wave_lines import DENSITY, random_lines, scaled
from cablesim.numerics import Array
from cablesim.status import Status

SOLVERS = ("wave_modes",)
# A line takes some milliseconds, nearly all of it the search for the stable step.
WEIGHTS = {"wave_modes": 0.002}
SEGMENTS = (2, 4, 7, 12, 25)
# Eigenvalues are right within rounding of the largest, and there are up to 75 of them.
ROUNDING = 1e-12
# Squared frequency of a free element in (stiffness / mass per length) / length^2, by its mass matrix.
ELEMENT = {"lumped": 4.0, "consistent": 12.0}
# The stable step of a line that nothing damps is found by trial, to a few thousandths.
STEP_FOUND = 0.01
# What is not handed to the solver, because it has no say: the motion of the top.
MOTION = ("wave_height", "top_amplitude")


def draw(solver: str, size: int, rng: np.random.Generator) -> list[Case]:
    """Lines of any stiffness that obey Hooke's law, half of them without any damping."""
    line = {name: values for name, values in random_lines(size, rng).items() if name not in MOTION}
    line["stiffness_ratio"] = np.zeros(size)
    undamped = rng.random(size) < 0.5
    for name in ("internal_damping", "normal_drag", "tangential_drag", "stream_speed"):
        line[name] = np.where(undamped, 0.0, line[name])
    options = {
        "segments": int(rng.choice(SEGMENTS)),
        "mass": str(rng.choice(list(ELEMENT))),
        "integrator": str(rng.choice(["leapfrog", "rk4"])),
        "added_mass": str(rng.choice(["normal", "isotropic"])),
    }
    return [Case(solver, line, options)]


def judges(solver: str) -> dict[str, Judge]:
    """Laws alone: what marches is judged as `wave_line`."""
    return {"neighbours": _anything.other_bits_alone, "units": units, "bounds": bounds, "stable step": stable_step}


def units(case: Case, found: Results) -> Array:
    """Powers of two that leave gravity what it is change frequencies by what they change times."""
    time = 2.0
    line = {"fluid_density": np.full(case.size, DENSITY)} | case.parameters
    other = case.solve(("lowest_frequency", "highest_frequency"), **scaled(line, 4.0, time, 8.0))
    highest = found.outputs["highest_frequency"]
    miss = [np.abs(other.outputs["highest_frequency"] * time / highest - 1.0)]
    # The least eigenvalue is known within rounding of the largest.
    squares = (other.outputs["lowest_frequency"] * time) ** 2 - found.outputs["lowest_frequency"] ** 2
    miss.append(np.abs(squares) / highest**2)
    return np.where(other.status == Status.ok, np.max(miss, axis=0) / ROUNDING, np.inf)


def bounds(case: Case, found: Results) -> Array:
    """No vibration of a line is faster than that of its stiffest element alone (Irons and Treharne)."""
    line, out = case.parameters, found.outputs
    element = line["length_ratio"] * line["depth"] / np.sin(line["chord_angle"]) / case.options["segments"]
    fastest = np.sqrt(ELEMENT[case.options["mass"]] * line["linear_stiffness"] / line["mass_per_length"]) / element
    excess = np.maximum(out["highest_frequency"] / fastest - 1.0, 0.0) / ROUNDING
    in_order = (out["lowest_frequency"] >= 0.0) & (out["lowest_frequency"] <= out["highest_frequency"])
    return np.where(in_order, excess, np.inf)


def stable_step(case: Case, found: Results) -> Array:
    """Undamped, the longest stable step is that of linear theory."""
    line, out = case.parameters, found.outputs
    undamped = (line["normal_drag"] == 0.0) & (line["internal_damping"] == 0.0) & (line["tangential_drag"] == 0.0)
    return np.where(undamped, np.abs(out["stable_step"] / out["stable_step_limit"] - 1.0) / STEP_FOUND, np.nan)
