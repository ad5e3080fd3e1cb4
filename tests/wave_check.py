"""Random lines in waves over the whole box of `stiff_extremes`, and small marches that tests set up themselves."""

from typing import Any

import numpy as np

from cablesim.physics.waves import m18_amplitude
from cablesim.solver import load_solver
from cablesim.solvers._wave_line import Options, empty_records
from cablesim.solvers._wave_pack import Marched, Problem, Records
from cablesim.solvers.wave_line import METHODS

Lines = dict[str, np.ndarray]

DENSITY = 1025.0
SEGMENTS = (4, 7, 12, 25, 50, 100, 200, 400)
# What a scenario may leave out: then its top end moves as M18 or the surface has it.
OPTIONAL = ("top_amplitude", "wave_height")


def log_uniform(rng: np.random.Generator, low: float, high: float, size: int) -> np.ndarray:
    return np.exp(rng.uniform(np.log(low), np.log(high), size))


def sometimes(rng: np.random.Generator, share: float, values: np.ndarray, otherwise: float = 0.0) -> np.ndarray:
    """The values in a share of the places."""
    return np.where(rng.random(values.size) < share, values, otherwise)


def random_scenarios(size: int, seed: int) -> tuple[Lines, dict[str, np.ndarray]]:
    """Parameters and options of lines of every kind, one number or word a scenario; NaN is what is not given."""
    rng = np.random.default_rng(seed)
    period, depth = log_uniform(rng, 0.5, 60.0, size), log_uniform(rng, 10.0, 2000.0, size)
    mass, stiffness = log_uniform(rng, 0.5, 50.0, size), log_uniform(rng, 1e3, 1e12, size)
    near = 1.0 + rng.choice([-1.0, 1.0], size) * log_uniform(rng, 1e-5, 0.1, size)
    move = m18_amplitude(period)
    height = 2.0 * np.minimum(move * rng.uniform(0.1, 1.5, size), depth * rng.uniform(0.01, 0.4, size))
    line = {
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


# The line of the paper, stretched by some 0.4 %, as MoorDyn has it in `reference/wave_moordyn.csv`.
CASE = {
    "depth": 200.0,
    "chord_angle": np.pi / 4.0,
    "length_ratio": 0.9971136116,
    "mass_per_length": 3.0,
    "area": 3e-4,
    "linear_stiffness": 1e7,
    "normal_drag": 15.6,
    "tangential_drag": 0.78,
    "added_mass_per_length": 0.4,
    "wave_period": 5.6,
    "top_amplitude": 1.57,
}
# A line that is pulled taut from slackness every period.
SNAPPING = CASE | {"linear_stiffness": 1e8, "length_ratio": 1.000466477}
# A vertical line without weight, drag or added mass, stretched by 1 %.
STRING = CASE | {
    "depth": 100.0,
    "chord_angle": np.pi / 2.0,
    "length_ratio": 1.0 / 1.01,
    "area": 3.0 / DENSITY,
    "linear_stiffness": 1e6,
    "normal_drag": 0.0,
    "tangential_drag": 0.0,
    "added_mass_per_length": 0.0,
    "top_amplitude": 0.0,
}


def without(line: dict[str, Any], *names: str) -> dict[str, Any]:
    return {name: value for name, value in line.items() if name not in names}


def packed(line: dict[str, Any], **options: Any) -> tuple[Problem, Options]:
    """The problem that integrators march, and the options."""
    solver = load_solver("wave_line")
    parameters, made = solver.make_parameters(line), solver.make_options(options)
    return parameters.problem(parameters.equilibrium(made.segments), made), made


def marched(
    problem: Problem, options: Options, samples: int = 0, phases: int = 0, has_waves: bool = False
) -> tuple[Marched, Records]:
    """March a problem that may have been changed."""
    records = empty_records(len(problem.lines), problem.tensions.shape[1], samples, phases)
    return METHODS[options.integrator][0](problem, has_waves, options, records), records
