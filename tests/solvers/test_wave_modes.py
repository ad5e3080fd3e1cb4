"""Vibrations of moored lines: strings, axial waves and meshes against theory, and stable steps that are tried out."""

from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigvalsh

from cablesim.batch import default_outputs, solve
from cablesim.errors import InputError
from cablesim.numerics import Array
from cablesim.solver import load_solver
from cablesim.solvers._wave_line import Options as MarchOptions
from cablesim.solvers.wave_modes import mass_matrix, stiffness_matrix
from cablesim.status import Status

SOLVER = "wave_modes"
# In fluid as dense as itself a line has no weight: taut, it is a straight string.
MASS, LENGTH, PERIOD = 3.0, 250.0, 5.0
STRING = {
    "depth": 200.0,
    "chord_angle": np.arcsin(0.8),
    "length_ratio": 0.98,
    "mass_per_length": MASS,
    "area": 3e-4,
    "fluid_density": 1e4,
    "linear_stiffness": 1e6,
    "normal_drag": 0.0,
    "tangential_drag": 0.0,
    "wave_period": PERIOD,
}
HANGING = STRING | {"length_ratio": 1.05, "fluid_density": 1025.0, "normal_drag": 15.6, "added_mass_per_length": 0.4}
EACH_MASS = pytest.mark.parametrize("mass", ["consistent", "lumped"])
EACH_INTEGRATOR = pytest.mark.parametrize("integrator", ["leapfrog", "rk4"])
LIMITS = {"leapfrog": 2.0, "rk4": np.sqrt(8.0)}


def vibrations(line: dict[str, Any], outputs: tuple[str, ...] = (), **options: Any) -> dict[str, Array]:
    """The answers for lines that are all solved."""
    found = solve(SOLVER, line, options, outputs)
    assert (found.status == Status.ok).all()
    return found.outputs


def string_frequency(ratio: float) -> float:
    """The lowest of a weightless string, which has its mass from before it was stretched."""
    tension = STRING["linear_stiffness"] * (1.0 / ratio - 1.0)
    return np.pi * np.sqrt(tension / (MASS * ratio)) / LENGTH


@EACH_MASS
def test_the_lowest_frequency_of_a_taut_string_is_met_with_order_two(mass):
    found = [vibrations(STRING, ("lowest_frequency",), segments=n, mass=mass)["lowest_frequency"][0] for n in (10, 20)]
    errors = np.array(found) / string_frequency(0.98) - 1.0
    # (pi / n)^2 / 24, less than it for lumped and more for consistent mass.
    np.testing.assert_allclose(np.abs(errors) * 24.0 * (np.array([10, 20]) / np.pi) ** 2, 1.0, rtol=0.02)
    assert (np.sign(errors) == {"lumped": -1.0, "consistent": 1.0}[mass]).all()


def test_a_taut_string_has_all_the_frequencies_of_a_chain_of_masses_across_and_along():
    p = load_solver(SOLVER).make_parameters(STRING)
    problem = p.problem(p.equilibrium(12), MarchOptions(segments=12, mass="lumped"))
    found = np.sqrt(eigvalsh(stiffness_matrix(problem, 0), mass_matrix(problem, 0)))
    chain = 2.0 * 12 * np.sin(np.arange(1, 12) * np.pi / 24)
    across = chain * string_frequency(0.98) / np.pi
    along = chain * np.sqrt(1e6 / MASS) / (0.98 * LENGTH)
    np.testing.assert_allclose(found, np.sort([*across, *across, *along]), rtol=1e-9)


@EACH_MASS
@pytest.mark.parametrize("segments", [4, 25])
def test_the_highest_frequency_is_that_of_neighbours_moving_against_each_other_along_the_line(mass, segments):
    stiffness = np.array([1e3, 1e6, 1e12])
    found = vibrations(STRING | {"linear_stiffness": stiffness}, ("highest_frequency",), segments=segments, mass=mass)
    cosine = np.cos(np.pi / segments)
    shape = {"lumped": 2.0 * (1.0 + cosine), "consistent": 6.0 * (1.0 + cosine) / (2.0 - cosine)}[mass]
    expected = segments / (0.98 * LENGTH) * np.sqrt(shape * stiffness / MASS)
    np.testing.assert_allclose(found["highest_frequency"], expected, rtol=1e-9)


def test_added_mass_across_the_line_slows_what_swings_but_not_what_runs_along_it():
    bare = vibrations(STRING)
    normal = vibrations(STRING | {"added_mass_per_length": MASS})
    isotropic = vibrations(STRING | {"added_mass_per_length": MASS}, added_mass="isotropic")
    for name in ("lowest_frequency", "highest_frequency"):
        np.testing.assert_allclose(isotropic[name], bare[name] / np.sqrt(2.0), rtol=1e-9)
    np.testing.assert_allclose(normal["lowest_frequency"], bare["lowest_frequency"] / np.sqrt(2.0), rtol=1e-9)
    np.testing.assert_allclose(normal["highest_frequency"], bare["highest_frequency"], rtol=1e-9)


def test_a_quadratic_law_is_as_stiff_as_its_slope_at_rest():
    strain = 1.0 / 0.98 - 1.0
    linear, curved = vibrations(STRING), vibrations(STRING | {"stiffness_ratio": 5.0})
    expected = linear["highest_frequency"] * np.sqrt(1.0 + 10.0 * strain)
    np.testing.assert_allclose(curved["highest_frequency"], expected, rtol=1e-9)


def test_a_slack_line_without_load_has_no_stiffness_to_swing_about():
    found = solve(SOLVER, STRING | {"length_ratio": 1.2}, {}, ("lowest_frequency",))
    assert found.outputs["lowest_frequency"] == 0.0


def test_the_ratio_is_to_the_wave_and_the_limit_goes_with_the_integrator():
    for integrator, limit in LIMITS.items():
        found = vibrations(HANGING, integrator=integrator)
        np.testing.assert_allclose(found["frequency_ratio"] * 2.0 * np.pi / PERIOD, found["highest_frequency"])
        np.testing.assert_allclose(found["stable_step_limit"] * found["highest_frequency"], limit)


@EACH_INTEGRATOR
@EACH_MASS
@pytest.mark.parametrize("line", [STRING, HANGING], ids=["taut", "hanging"])
def test_the_stable_step_that_is_tried_out_is_that_of_the_highest_frequency(integrator, mass, line):
    # From an element twice as long as its rest length to one that nothing stretches.
    stiffness = np.array([1e5, 1e7, 1e9, 1e12])
    found = vibrations(line | {"linear_stiffness": stiffness}, integrator=integrator, mass=mass, segments=10)
    # The search ends within 1e-3, and rk4 lets a step 0.25 % too long pass in as many steps as are tried.
    np.testing.assert_allclose(found["stable_step"], found["stable_step_limit"], rtol=5e-3)


def test_internal_damping_shortens_leapfrog_s_step_as_its_late_velocities_have_it():
    damping = np.array([1e2, 1e3, 3e3])
    found = vibrations(STRING | {"internal_damping": damping, "linear_stiffness": 1e6})
    omega = found["highest_frequency"]
    ratio = 0.5 * damping * omega / 1e6
    # Stable for (omega h)^2 + 8 ratio omega h < 4; what is damped grows slowly beyond, so that 0.4 % too long may pass.
    expected = 2.0 * (np.sqrt(1.0 + 4.0 * ratio**2) - 2.0 * ratio) / omega
    np.testing.assert_allclose(found["stable_step"], expected, rtol=1e-2)


def test_the_march_of_wave_line_takes_every_step_that_is_stable_for_an_endless_line():
    line = HANGING | {"linear_stiffness": 1e6, "top_amplitude": 0.0, "duration": 20.0}
    limit = vibrations(line, segments=10, mass="lumped")["stable_step"][0]
    outcomes = {
        share: solve(
            "wave_line",
            line,
            {"segments": 10, "integrator": "leapfrog", "mass": "lumped", "time_step": share * limit},
            ("max_top_tension",),
        ).status[0]
        for share in (0.98, 1.02)
    }
    # cos(pi / 20) = 0.9877 is what ten elements between fixed ends are slower by than endlessly many.
    assert outcomes == {0.98: Status.ok, 1.02: Status.not_converged}


def test_lines_that_have_no_rest_have_no_vibrations():
    found = solve(SOLVER, STRING | {"stiffness_ratio": [-40.0, 0.0]}, {}, default_outputs(load_solver(SOLVER)))
    assert found.status.tolist() == [Status.infeasible, Status.ok]
    assert all(np.isnan(values[0]) and np.isfinite(values[1]) for values in found.outputs.values())


def test_only_explicit_methods_have_a_stable_step():
    with pytest.raises(InputError, match="integrator"):
        vibrations(STRING, integrator="generalized_alpha")


def test_a_line_that_drifts_across_while_it_is_marched_is_not_taken_for_unstable():
    """Found by the hunt: buoyant, hardly pulled and hardly stretching, it was given 0.7 of its stable step."""
    light = {
        "depth": 192.35302302317407,
        "chord_angle": 1.5566197229592604,
        "length_ratio": 1.0001083223052911,
        "mass_per_length": 0.5780529261962216,
        "area": 0.0006716281272440016,
        "linear_stiffness": 413424637532.8284,
        "normal_drag": 0.0,
        "tangential_drag": 0.0,
        "wave_period": 6.8,
    }
    found = solve("wave_modes", light, {"segments": 4, "added_mass": "isotropic"}).outputs
    assert abs(found["stable_step"][0] / found["stable_step_limit"][0] - 1.0) < 0.01
