"""Laws that hold for every line hanging between two supports, rigid or elastic."""

from functools import cache

import numpy as np
import pytest

from cablesim.batch import Results, default_outputs, solve
from cablesim.numerics import Array
from cablesim.solver import load_solver
from cablesim.status import Status
from tests.helpers import draw, relative_error, rows

SOLVERS = ("catenary_exact", "catenary_elastic")
# A hundred units in the last place: what a dozen rounded operations leave on a line of up to 3000 spans.
ROUNDING = 2e-14
EPS = np.finfo(float).eps

pytestmark = pytest.mark.parametrize("solver", SOLVERS)


@cache
def feasible(solver: str) -> dict[str, Array]:
    """Random lines of the declared ranges that have an equilibrium."""
    parameters = draw(solver, 6000, seed=1)
    balanced = solve(solver, parameters).status == Status.ok
    assert balanced.sum() > 1000
    return rows(parameters, balanced)


@cache
def solved(solver: str) -> Results:
    return solve(solver, feasible(solver))


@cache
def curves(solver: str, nodes: int) -> tuple[dict[str, Array], Array, Array]:
    """Parameters of some of the lines with their scalar outputs, their profiles and the tension along them."""
    some = rows(feasible(solver), slice(1500))
    found = solve(solver, some, {"nodes": nodes}, load_solver(solver).outputs).outputs
    profile, tension = found.pop("profile"), found.pop("profile_tension")
    return some | found, profile, tension


def stiffness(line: dict[str, Array]) -> Array | float:
    return line.get("axial_stiffness", np.inf)


def longest_step(line: dict[str, Array], nodes: int) -> Array:
    """The longest stretched piece of line between two nodes."""
    return line["line_length"] / (nodes - 1) * (1.0 + line["max_tension"] / stiffness(line))


def pieces(profile: Array) -> Array:
    """Distances from node to node."""
    return np.linalg.norm(np.diff(profile, axis=1), axis=2)


def test_the_supports_carry_the_weight(solver: str) -> None:
    line, found = feasible(solver), solved(solver).outputs
    H, weight = found["horizontal_tension"], line["weight_per_length"] * line["line_length"]
    vertical, lost = {}, 0.0
    for end, upward in (("A", found["vertex_x"]), ("B", line["span"] - found["vertex_x"])):
        tension = found[f"tension_{end}"]
        size = np.sqrt(np.maximum(tension - H, 0.0) * (tension + H))
        vertical[end] = np.sign(upward) * size
        # The root of a difference: T^2 / V rounding errors, and half of all digits where the line is level.
        lost = lost + 4.0 * EPS * tension**2 / np.maximum(size, np.sqrt(EPS) * tension)
    assert (np.abs(vertical["A"] + vertical["B"] - weight) <= lost + ROUNDING * weight).all()


def test_the_largest_tension_is_at_the_upper_support(solver: str) -> None:
    line, found = feasible(solver), solved(solver).outputs
    upper = np.where(line["rise"] > 0.0, found["tension_B"], found["tension_A"])
    assert (found["max_tension"] >= np.maximum(found["tension_A"], found["tension_B"])).all()
    np.testing.assert_allclose(found["max_tension"], upper, rtol=ROUNDING)


def test_a_line_seen_in_a_mirror_is_the_mirrored_line(solver: str) -> None:
    line, found = feasible(solver), solved(solver).outputs
    mirrored = solve(solver, line | {"rise": -line["rise"]}).outputs
    for one, other in (("tension_A", "tension_B"), ("tension_B", "tension_A"), ("sag", "sag"), ("drop", "drop")):
        np.testing.assert_allclose(mirrored[one], found[other], rtol=ROUNDING)
    vertex_error = relative_error(mirrored["vertex_x"], line["span"] - found["vertex_x"], line["span"])
    assert vertex_error.max() <= ROUNDING


def test_longer_and_heavier_lines_scale_exactly(solver: str) -> None:
    """Powers of two, so that no input is rounded and equality is exact."""
    longer, heavier = 8.0, 1.0 / 32.0
    line, found = feasible(solver), solved(solver).outputs
    scaled = {name: values * longer for name, values in line.items()}
    scaled["weight_per_length"] = line["weight_per_length"] * heavier
    if "axial_stiffness" in line:
        scaled["axial_stiffness"] = line["axial_stiffness"] * longer * heavier
    for name, values in solve(solver, scaled).outputs.items():
        factor = longer * heavier if "tension" in name else longer
        np.testing.assert_array_equal(values, factor * found[name], err_msg=name)


def test_the_profile_runs_from_support_to_support(solver: str) -> None:
    line, profile, tension = curves(solver, 11)
    assert (profile[:, 0] == 0.0).all() and (profile[:, :, 1] == 0.0).all()
    supports = np.stack([line["span"], np.zeros_like(line["span"]), line["rise"]], axis=1)
    miss = np.linalg.norm(profile[:, -1] - supports, axis=1)
    assert (miss / line["stretched_length"]).max() <= ROUNDING
    for node, end in ((0, "A"), (-1, "B")):
        assert relative_error(tension[:, node], line[f"tension_{end}"], line["max_tension"]).max() <= ROUNDING


def test_tension_grows_with_height(solver: str) -> None:
    """T + T^2 / 2 EA - w z is the same all along: the work of gravity on a line drawn through its own shape."""
    line, profile, tension = curves(solver, 11)
    w, EA = line["weight_per_length"][:, None], np.broadcast_to(stiffness(line), line["span"].shape)[:, None]
    energy = tension + tension**2 / (2.0 * EA)
    change = energy - energy[:, :1] - w * profile[:, :, 2]
    assert (np.abs(change) / energy.max(axis=1, keepdims=True)).max() <= ROUNDING


def test_the_profile_is_as_long_as_the_stretched_line(solver: str) -> None:
    """A chord of an arc s of curvature at most 1/a is no shorter than s (1 - (s / a)^2 / 24), and no longer than s."""
    nodes = 201
    line, profile, _ = curves(solver, nodes)
    short = 1.0 - pieces(profile).sum(axis=1) / line["stretched_length"]
    longest = longest_step(line, nodes) / line["catenary_parameter"]
    assert (short >= -ROUNDING).all()
    assert (short <= longest**2 / 24.0 + ROUNDING).all()


def test_the_nodes_divide_the_unstretched_line_equally(solver: str) -> None:
    """On one piece the tension is between its larger end value and that less the weight of the piece."""
    nodes = 201
    line, profile, tension = curves(solver, nodes)
    step = line["line_length"] / (nodes - 1)
    bend = (longest_step(line, nodes) / line["catenary_parameter"]) ** 2 / 24.0
    largest = np.maximum(tension[:, 1:], tension[:, :-1]).T
    smallest = largest - line["weight_per_length"] * step
    found, rounding = pieces(profile).T, ROUNDING * line["stretched_length"]
    assert (found <= step * (1.0 + largest / stiffness(line)) + rounding).all()
    assert (found >= step * (1.0 + smallest / stiffness(line)) * (1.0 - bend) - rounding).all()


def test_the_length_of_the_profile_converges_in_second_order(solver: str) -> None:
    missing = []
    for nodes in (201, 401):
        line, profile, _ = curves(solver, nodes)
        missing.append(line["stretched_length"] - pieces(profile).sum(axis=1))
    resolved = longest_step(line, nodes) < 0.05 * line["catenary_parameter"]
    resolved &= missing[1] > 1e-8 * line["stretched_length"]
    assert resolved.sum() > 50
    # Next to the leading term stands one of relative size (s / a)^2, and rounding of 1e-14 in 1e-8.
    np.testing.assert_allclose(missing[0][resolved] / missing[1][resolved], 4.0, rtol=0.05**2)


def test_the_sag_is_the_largest_distance_below_the_chord(solver: str) -> None:
    """At its maximum the distance is flat: half a step away it is less by at most step^2 / 8 times its curvature."""
    nodes = 401
    line, profile, _ = curves(solver, nodes)
    slope = line["rise"] / line["span"]
    below = (slope[:, None] * profile[:, :, 0] - profile[:, :, 2]).max(axis=1)
    curvature = np.hypot(1.0, slope) / line["catenary_parameter"] + line["weight_per_length"] / stiffness(line)
    step = line["line_length"] / (nodes - 1)
    rounding = ROUNDING * line["stretched_length"]
    assert (below <= line["sag"] + rounding).all()
    assert (below >= line["sag"] - step**2 / 8.0 * curvature - rounding).all()


def test_a_scenario_does_not_depend_on_its_neighbours(solver: str) -> None:
    parameters = draw(solver, 10_000, seed=2)
    together = solve(solver, parameters)
    for i in np.random.default_rng(3).choice(10_000, 50, replace=False):
        assert_same(solve(solver, rows(parameters, i)), together, slice(i, i + 1))
    order = np.random.default_rng(4).permutation(10_000)
    assert_same(solve(solver, rows(parameters, order)), together, order)


def assert_same(one: Results, other: Results, which: slice | np.ndarray) -> None:
    """Bit for bit."""
    np.testing.assert_array_equal(one.status, other.status[which])
    np.testing.assert_array_equal(one.iterations, other.iterations[which])
    for name, values in one.outputs.items():
        np.testing.assert_array_equal(values, other.outputs[name][which], err_msg=name)


def test_the_number_of_nodes_does_not_change_the_line(solver: str) -> None:
    some = rows(feasible(solver), slice(100))
    names = default_outputs(load_solver(solver))
    coarse, fine = (solve(solver, some, {"nodes": nodes}, (*names, "profile")).outputs for nodes in (2, 51))
    assert coarse.pop("profile").shape == (100, 2, 3) and fine.pop("profile").shape == (100, 51, 3)
    for name in names:
        np.testing.assert_array_equal(coarse[name], fine[name], err_msg=name)
