"""Lines in waves that tests ask about, and small marches that they set up themselves."""

from typing import Any

import numpy as np

from cablesim.hunt._wave_lines import DENSITY
from cablesim.solver import load_solver
from cablesim.solvers._wave_line import Options, empty_records
from cablesim.solvers._wave_pack import Marched, Problem, Records
from cablesim.solvers.wave_line import METHODS

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
