"""Random lines in waves over the whole box of the scene `stiff_extremes`, and corners of it."""

from collections.abc import Callable
from typing import Any

import numpy as np

from cablesim.numerics import Array
from cablesim.physics.waves import m18_amplitude

Lines = dict[str, np.ndarray]

DENSITY = 1025.0
SEGMENTS = (4, 7, 12, 25, 50, 100, 200, 400)
# What a scenario may leave out: then its top end moves as M18 or the surface has it.
OPTIONAL = ("top_amplitude", "wave_height")
# How each parameter is measured: powers of length, time and mass.
UNITS = {
    "depth": (1, 0, 0),
    "mass_per_length": (-1, 0, 1),
    "area": (2, 0, 0),
    "linear_stiffness": (1, -2, 1),
    "internal_damping": (1, -1, 1),
    "normal_drag": (-2, 0, 1),
    "tangential_drag": (-2, 0, 1),
    "added_mass_per_length": (-1, 0, 1),
    "fluid_density": (-3, 0, 1),
    "wave_period": (0, 1, 0),
    "wave_height": (1, 0, 0),
    "top_amplitude": (1, 0, 0),
    "stream_speed": (1, -1, 0),
    "duration": (0, 1, 0),
    "ramp": (0, 1, 0),
}


# What is not given.
STANDARD = {
    "wave_height": 0.0,
    "heading": 0.0,
    "stream_speed": 0.0,
    "stiffness_ratio": 0.0,
    "added_mass_per_length": 0.0,
    "fluid_density": DENSITY,
}


def log_uniform(rng: np.random.Generator, low: float, high: float, size: int) -> Array:
    return np.exp(rng.uniform(np.log(low), np.log(high), size))


def sometimes(rng: np.random.Generator, share: float, values: Array, otherwise: Array | float = 0.0) -> Array:
    """The values in a share of the places."""
    return np.where(rng.random(values.size) < share, values, otherwise)


def random_scenarios(size: int, seed: int) -> tuple[Lines, dict[str, np.ndarray]]:
    """Parameters and options of lines of every kind, one number or word a scenario; NaN is what is not given."""
    rng = np.random.default_rng(seed)
    line = random_lines(size, rng)
    options = {
        "segments": rng.choice(SEGMENTS, size),
        "mass": rng.choice(["consistent", "lumped"], size),
        "added_mass": rng.choice(["normal", "isotropic"], size),
    }
    return line, options


def scenario(line: Lines, options: dict[str, np.ndarray], i: int) -> tuple[dict[str, Any], dict[str, Any]]:
    """One scenario, without what it leaves out."""
    left_out = [name for name in OPTIONAL if np.isnan(line[name][i])]
    given = {name: values[i : i + 1] for name, values in line.items() if name not in left_out}
    return given, {name: values[i].item() for name, values in options.items()}


def random_lines(size: int, rng: np.random.Generator) -> Lines:
    """Lines of every kind; NaN where no amplitude or no wave height is given."""
    period, depth = log_uniform(rng, 0.5, 60.0, size), log_uniform(rng, 10.0, 2000.0, size)
    mass, stiffness = log_uniform(rng, 0.5, 50.0, size), log_uniform(rng, 1e3, 1e12, size)
    near = 1.0 + rng.choice([-1.0, 1.0], size) * log_uniform(rng, 1e-5, 0.1, size)
    move = m18_amplitude(period)
    height = 2.0 * np.minimum(move * rng.uniform(0.1, 1.5, size), depth * rng.uniform(0.01, 0.4, size))
    return {
        "depth": depth,
        "chord_angle": np.radians(sometimes(rng, 0.9, rng.uniform(10.0, 90.0, size), 90.0)),
        "length_ratio": np.where(rng.random(size) < 0.6, np.clip(near, 0.9, 1.5), rng.uniform(0.9, 1.5, size)),
        "mass_per_length": mass,
        "area": mass / (DENSITY * log_uniform(rng, 0.7, 8.0, size)),
        "linear_stiffness": stiffness,
        "stiffness_ratio": sometimes(rng, 0.4, rng.choice([-1.0, 1.0], size) * log_uniform(rng, 0.05, 20.0, size)),
        "internal_damping": sometimes(rng, 0.4, stiffness * log_uniform(rng, 1e-5, 1e-1, size)),
        "normal_drag": sometimes(rng, 0.85, log_uniform(rng, 0.5, 100.0, size)),
        "tangential_drag": sometimes(rng, 0.85, log_uniform(rng, 0.01, 3.0, size)),
        "added_mass_per_length": sometimes(rng, 0.7, mass * rng.uniform(0.05, 1.0, size)),
        "wave_period": period,
        "wave_height": sometimes(rng, 0.4, height, np.nan),
        "top_amplitude": sometimes(rng, 0.7, sometimes(rng, 0.9, move * rng.uniform(0.02, 2.0, size)), np.nan),
        "heading": sometimes(rng, 0.7, rng.uniform(-np.pi, np.pi, size)),
        "motion_angle": sometimes(rng, 0.7, rng.uniform(-1.5, 1.5, size)),
        "axis_ratio": sometimes(rng, 0.6, rng.uniform(-1.0, 1.0, size)),
        "motion_phase": sometimes(rng, 0.5, rng.uniform(-3.0, 3.0, size)),
        "stream_speed": sometimes(rng, 0.5, rng.uniform(0.0, 3.0, size)),
    }


def with_corners(line: Lines, rng: np.random.Generator, share: float = 0.4) -> Lines:
    """Lines of which a share is moved into a corner; with the density of their water, a duration and a ramp."""
    size = line["depth"].size
    period = line["wave_period"]
    line = line | {
        "fluid_density": np.full(size, DENSITY),
        "duration": sometimes(rng, 0.2, period * rng.uniform(0.3, 15.0, size), 12.0 * period),
        "ramp": sometimes(rng, 0.2, period * rng.uniform(0.0, 4.0, size), 2.0 * period),
    }
    corners = np.where(rng.random(size) < share, rng.integers(len(CORNERS), size=size), -1)
    for number, corner in enumerate(CORNERS):
        for name, values in corner(line, rng).items():
            line[name] = np.where(corners == number, values, line[name])
    return line


def _weightless(line: Lines, rng: np.random.Generator) -> Lines:
    return {"area": line["mass_per_length"] / line["fluid_density"]}


def _nearly_weightless(line: Lines, rng: np.random.Generator) -> Lines:
    near = log_uniform(rng, 1e-12, 1e-2, line["depth"].size)
    return {"area": line["mass_per_length"] / line["fluid_density"] * (1.0 - near)}


def _floating(line: Lines, rng: np.random.Generator) -> Lines:
    return {"area": line["mass_per_length"] / line["fluid_density"] * rng.uniform(1.0, 20.0, line["depth"].size)}


def _without_fluid(line: Lines, rng: np.random.Generator) -> Lines:
    bare = ("fluid_density", "normal_drag", "tangential_drag", "added_mass_per_length", "stream_speed")
    return {name: 0.0 * line[name] for name in bare}


def _upright(line: Lines, rng: np.random.Generator) -> Lines:
    return {"chord_angle": np.full(line["depth"].size, 0.5 * np.pi)}


def _nearly_level(line: Lines, rng: np.random.Generator) -> Lines:
    return {"chord_angle": log_uniform(rng, 1e-3, 0.1, line["depth"].size)}


def _as_long_as_its_chord(line: Lines, rng: np.random.Generator) -> Lines:
    near = rng.choice([-1.0, 0.0, 1.0], line["depth"].size) * log_uniform(rng, 1e-14, 1e-5, line["depth"].size)
    return {"length_ratio": 1.0 + near}


def _very_slack(line: Lines, rng: np.random.Generator) -> Lines:
    return {"length_ratio": rng.uniform(1.5, 6.0, line["depth"].size)}


def _very_taut(line: Lines, rng: np.random.Generator) -> Lines:
    return {
        "length_ratio": rng.uniform(0.3, 0.9, line["depth"].size),
        "stiffness_ratio": np.abs(line["stiffness_ratio"]),
    }


def _near_its_greatest_tension(line: Lines, rng: np.random.Generator) -> Lines:
    """Softening, stretched at rest to about where the law has its greatest tension."""
    stretched = np.abs(1.0 / line["length_ratio"] - 1.0) + 1e-3
    return {
        "stiffness_ratio": -0.5 / stretched / rng.uniform(0.9, 1.5, stretched.size),
        "length_ratio": 1.0 / (1.0 + stretched),
    }


def _at_rest(line: Lines, rng: np.random.Generator) -> Lines:
    return {name: np.where(np.isnan(line[name]), np.nan, 0.0) for name in OPTIONAL}


def _no_ramp(line: Lines, rng: np.random.Generator) -> Lines:
    return {"ramp": 0.0 * line["ramp"]}


def _round_numbers(line: Lines, rng: np.random.Generator) -> Lines:
    """Directions that are right angles, and circles."""
    size = line["depth"].size
    return {
        "heading": rng.choice([0.0, 0.5 * np.pi, np.pi, -np.pi], size),
        "motion_angle": rng.choice([0.0, 0.5 * np.pi, np.pi], size),
        "axis_ratio": rng.choice([-1.0, 0.0, 1.0], size),
        "motion_phase": rng.choice([0.0, 0.5 * np.pi, np.pi], size),
    }


def _tossed(line: Lines, rng: np.random.Generator) -> Lines:
    return {name: line[name] * rng.uniform(2.0, 10.0, line["depth"].size) for name in OPTIONAL}


def _in_other_units(line: Lines, rng: np.random.Generator) -> Lines:
    """Models and giants: gravity keeps length over time squared."""
    half = 2.0 ** rng.integers(-6, 6, line["depth"].size)
    return scaled(line, half**2, half, 2.0 ** rng.integers(-40, 40, line["depth"].size))


CORNERS: tuple[Callable[[Lines, np.random.Generator], Lines], ...] = (
    _weightless,
    _nearly_weightless,
    _floating,
    _without_fluid,
    _upright,
    _nearly_level,
    _as_long_as_its_chord,
    _very_slack,
    _very_taut,
    _near_its_greatest_tension,
    _at_rest,
    _no_ramp,
    _round_numbers,
    _tossed,
    _in_other_units,
)


def given_or_standard(line: Lines) -> Lines:
    """Parameters by name, one number a scenario, with those that are not given."""
    period = line["wave_period"]
    times = {"duration": 12.0 * period, "ramp": 2.0 * period}
    return {name: np.broadcast_to(value, period.shape) for name, value in (STANDARD | times | line).items()}


def scaled(line: Lines, length: Any, time: Any, mass: Any) -> Lines:
    """The same lines in units of other sizes; gravity is the same if length goes as time squared."""
    powers = {name: UNITS[name] for name in line if name in UNITS}
    return {name: line[name] * (length**a * time**b * mass**c) for name, (a, b, c) in powers.items()}
