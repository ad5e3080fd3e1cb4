"""The line of equal strength under another force: references, equilibrium, largest stress, limits and symmetries."""

from functools import cache

import numpy as np
import pytest

from cablesim.batch import Results, solve
from cablesim.numerics import Array
from cablesim.solver import load_solver
from cablesim.status import Status
from tests.helpers import REFERENCE, read_table, relative_error, rows

SOLVER = load_solver("equal_strength_loaded")
LINE = ("strength_length", "span", "rise")
# What the solver promises, for force ratios from 0.001 to 1000.
PROMISED = 1e-12
# A few hundred units in the last place: sums over some hundred points, and the error of their root.
ROUNDING = 1e-13
NODES = 41


@cache
def lines() -> dict[str, Array]:
    """Short to nearly widest lines, a third of them level, under a twentieth to five times their force."""
    rng = np.random.default_rng(1)
    strength = 10.0 ** rng.uniform(2.0, 4.0, 900)
    share = np.concatenate([10.0 ** rng.uniform(-3.0, -0.1, 450), 1.0 - 10.0 ** rng.uniform(-6.0, -0.5, 450)])
    span = share * np.pi * strength
    rise = span * 10.0 ** rng.uniform(-3.0, 1.0, 900) * rng.choice([-1.0, 0.0, 1.0], 900)
    force = 10.0 ** rng.uniform(np.log10(0.05), np.log10(5.0), 900)
    return {"strength_length": strength, "span": span, "rise": rise, "force_ratio": force}


@cache
def solved() -> Results:
    found = solve(SOLVER.name, lines(), {"nodes": NODES}, SOLVER.outputs)
    assert (found.status == Status.ok).all()
    return found


@cache
def design() -> dict[str, Array]:
    """The same lines as they were designed."""
    outputs = load_solver("equal_strength").outputs
    return solve("equal_strength", {name: lines()[name] for name in LINE}, {"nodes": NODES}, outputs).outputs


# ---- references ----


@cache
def reference() -> dict[str, Array]:
    return read_table(REFERENCE / "strength_lines.csv")


@pytest.mark.parametrize("place", range(5))
def test_the_stress_at_five_places_keeps_the_promised_digits(place: int) -> None:
    table = reference()
    expected = np.array([float(text.split()[place]) for text in table["stress_ratio"]])
    given = {name: table[name] for name in (*LINE, "force_ratio")}
    found = solve(SOLVER.name, given | {"arc_fraction": place / 4.0})
    assert (found.status == Status.ok).all()
    assert relative_error(found.outputs["stress_ratio"], expected).max() <= PROMISED


def test_distance_and_largest_stress_keep_the_promised_digits() -> None:
    table = reference()
    found = solve(SOLVER.name, {name: table[name] for name in (*LINE, "force_ratio")}).outputs
    assert relative_error(found["horizontal_distance"] / table["span"], table["distance_over_span"]).max() <= PROMISED
    assert relative_error(found["max_stress_ratio"], table["max_stress_ratio"]).max() <= PROMISED


def test_the_references_reach_from_short_to_widest_lines_and_from_small_to_large_forces() -> None:
    """Guards the reference file: a promise is worth what it was measured on."""
    table = reference()
    share, slope = table["span"] / (np.pi * table["strength_length"]), table["rise"] / table["span"]
    assert share.size >= 200
    assert share.min() <= 1e-9 and share.max() >= 1.0 - 1e-9
    assert slope.min() < -900.0 and slope.max() > 900.0
    assert table["force_ratio"].min() <= 1e-3 and table["force_ratio"].max() >= 1e3


# ---- under the force of the design ----


def test_under_the_force_of_its_design_it_is_the_design() -> None:
    found = solve(SOLVER.name, lines() | {"force_ratio": 1.0}, {"nodes": NODES}, SOLVER.outputs).outputs
    assert relative_error(found["horizontal_distance"], lines()["span"]).max() <= ROUNDING
    for name in ("max_stress_ratio", "stress_ratio", "stress_ratio_A", "stress_ratio_B", "profile_stress_ratio"):
        assert np.abs(found[name] - 1.0).max() <= ROUNDING, name
    miss = np.linalg.norm(found["profile"] - design()["profile"], axis=2)
    assert (miss / design()["line_length"][:, None]).max() <= ROUNDING


# ---- equilibrium ----


def vertical_at_A(tension_A: Array, tension_B: Array, weight: Array) -> Array:
    """From T_B^2 - T_A^2 = W (2 V_A + W)."""
    return 0.5 * ((tension_B - tension_A) / weight * (tension_B + tension_A) - weight)


def tensions() -> tuple[Array, Array, Array]:
    """Tension and its vertical part at the nodes, and how many times a relative rounding error of V_A is multiplied."""
    tension = solved().outputs["profile_stress_ratio"] * design()["profile_area_ratio"]
    weight = design()["profile_weight"]
    start = vertical_at_A(tension[:, 0], tension[:, -1], weight[:, -1])
    lost = np.maximum(tension[:, 0], tension[:, -1]) ** 2 / weight[:, -1]
    return tension, start[:, None] + weight, lost[:, None]


def test_the_tension_carries_force_and_weight() -> None:
    tension, vertical, lost = tensions()
    horizontal = lines()["force_ratio"][:, None]
    largest = np.maximum(tension.max(axis=1), design()["weight_over_force"])[:, None]
    # An error of V of that size changes T^2 by 2 V times it.
    assert (np.abs(tension**2 - horizontal**2 - vertical**2) <= ROUNDING * largest * (largest + lost)).all()


def test_every_piece_leans_as_the_tension_in_it() -> None:
    """The slope of a chord is between those at its ends, V / H."""
    _, vertical, lost = tensions()
    known = lost[:, 0] < 100.0
    assert known.sum() > 400
    dx, _, dz = np.moveaxis(np.diff(solved().outputs["profile"][known], axis=1), 2, 0)
    force, length = lines()["force_ratio"][known, None], design()["line_length"][known, None]
    slope = vertical[known] / force
    # Positions are summed from A: their rounding is that of the whole line.
    rounding = ROUNDING * (length + dx * lost[known] / force) * (1.0 + np.abs(slope).max(axis=1, keepdims=True))
    assert (dz >= dx * slope[:, :-1] - rounding).all()
    assert (dz <= dx * slope[:, 1:] + rounding).all()


def test_the_profile_is_as_long_as_the_design_and_meets_its_rise() -> None:
    profile, length = solved().outputs["profile"], design()["line_length"]
    ends = np.stack([solved().outputs["horizontal_distance"], np.zeros(900), lines()["rise"]], axis=1)
    assert (profile[:, 0] == 0.0).all()
    assert (np.linalg.norm(profile[:, -1] - ends, axis=1) / length).max() <= ROUNDING
    pieces = np.linalg.norm(np.diff(profile, axis=1), axis=2)
    step = length[:, None] / (NODES - 1)
    assert (pieces <= step + ROUNDING * length[:, None]).all()
    # An arc that turns by d has a chord of at least cos(d / 2) of its length.
    _, vertical, lost = tensions()
    known = lost[:, 0] < 100.0
    turn = np.diff(np.arctan(vertical / lines()["force_ratio"][:, None]), axis=1)
    shortest = step * np.cos(0.5 * turn)
    assert (pieces >= shortest - ROUNDING * length[:, None])[known].all()


# ---- stresses ----


def test_the_largest_stress_is_that_of_the_finest_nodes() -> None:
    """Near its maximum it is a parabola in u: a step away it is less by a square, elsewhere it is at an end."""
    some = rows(lines(), slice(0, 900, 6))
    found = solve(SOLVER.name, some, {"nodes": 4001}, ("max_stress_ratio", "profile_stress_ratio")).outputs
    nodes, largest = found["profile_stress_ratio"].max(axis=1), found["max_stress_ratio"]
    length = solve("equal_strength", {name: some[name] for name in LINE}).outputs["line_length"]
    step = length / some["strength_length"] / 4000.0
    assert (nodes <= largest * (1.0 + ROUNDING)).all()
    # d^2(T / cosh u) / du^2 is at most 4 T / cosh(u), at a maximum of T / cosh(u).
    assert (nodes >= largest * (1.0 - 0.5 * step**2)).all()
    inside = largest > np.maximum(found["profile_stress_ratio"][:, 0], found["profile_stress_ratio"][:, -1]) * 1.0001
    assert inside.sum() > 20


def test_the_stress_at_an_arc_fraction_is_that_of_the_node_there() -> None:
    for node in (0, 7, 20, NODES - 1):
        found = solve(SOLVER.name, lines() | {"arc_fraction": node / (NODES - 1)}).outputs["stress_ratio"]
        assert relative_error(found, solved().outputs["profile_stress_ratio"][:, node]).max() <= ROUNDING
    for node, name in ((0, "stress_ratio_A"), (-1, "stress_ratio_B")):
        np.testing.assert_array_equal(solved().outputs["profile_stress_ratio"][:, node], solved().outputs[name])


def test_a_level_line_is_stressed_most_at_its_ends_in_calm_and_in_its_middle_in_a_gale() -> None:
    """c = 0 by symmetry: sqrt((r^2 + sinh(u)^2) / (1 + sinh(u)^2)) grows or falls from the middle."""
    level = {"strength_length": 1.0, "span": 2.0}
    found = solve(SOLVER.name, level | {"force_ratio": [0.05, 0.5, 2.0, 5.0]}).outputs
    ends = np.sqrt(1.0 + (np.array([0.05, 0.5, 2.0, 5.0]) ** 2 - 1.0) * np.cos(1.0) ** 2)
    np.testing.assert_allclose(found["stress_ratio_A"], ends, rtol=ROUNDING)
    np.testing.assert_allclose(found["stress_ratio_B"], ends, rtol=ROUNDING)
    np.testing.assert_allclose(found["stress_ratio"], [0.05, 0.5, 2.0, 5.0], rtol=ROUNDING)
    np.testing.assert_allclose(found["max_stress_ratio"], [*ends[:2], 2.0, 5.0], rtol=ROUNDING)


# ---- limits ----


def test_a_great_force_pulls_it_straight() -> None:
    """What is missing to sqrt(L^2 - h^2) goes as 1 / r^2."""
    some = rows(lines(), lines()["span"] < 0.9 * np.pi * lines()["strength_length"])
    line = solve("equal_strength", {name: some[name] for name in LINE}).outputs
    length = line["line_length"]
    straight = np.sqrt(length - some["rise"]) * np.sqrt(length + some["rise"])
    missing = []
    for force in (1e3, 2e3):
        found = solve(SOLVER.name, some | {"force_ratio": force})
        assert (found.status == Status.ok).all()
        missing.append(1.0 - found.outputs["horizontal_distance"] / straight)
    assert (np.array(missing) >= -ROUNDING).all()
    # The next term is smaller by the square of weight over force, rounding by 1e-5.
    clear = (missing[1] > 1e-9) & (line["weight_over_force"] < 20.0)
    assert clear.sum() > 100
    np.testing.assert_allclose(missing[0][clear] / missing[1][clear], 4.0, rtol=1e-3)


def test_without_force_it_hangs_in_two_plumb_lines() -> None:
    """Distance goes to zero with the force, and the lowest point to where both parts make up the rise."""
    line = {"strength_length": 1.0, "span": 1.5, "rise": 0.4}
    length = solve("equal_strength", line).outputs["line_length"][0]
    found = solve(
        SOLVER.name, line | {"force_ratio": [1e-2, 1e-3]}, {"nodes": 2001}, ("horizontal_distance", "profile")
    )
    assert (found.status == Status.ok).all()
    assert found.outputs["horizontal_distance"][1] < 0.2 * found.outputs["horizontal_distance"][0]
    lowest = found.outputs["profile"][1, :, 2].min()
    # Around its lowest point the line is not upright over a length of the order of the force.
    assert lowest == pytest.approx(-0.5 * (length - 0.4), abs=5e-3)


def test_more_force_takes_its_ends_farther_apart() -> None:
    force = np.geomspace(1e-3, 1e3, 200)
    for rise in (0.0, 0.8, -3.0):
        found = solve(SOLVER.name, {"strength_length": 1.0, "span": 2.0, "rise": rise, "force_ratio": force})
        assert (found.status == Status.ok).all()
        assert (np.diff(found.outputs["horizontal_distance"]) > 0.0).all()


def test_a_design_that_does_not_exist_is_infeasible() -> None:
    found = solve(SOLVER.name, {"strength_length": 1.0, "span": [3.0, 3.2], "force_ratio": 0.5}, {}, SOLVER.outputs)
    np.testing.assert_array_equal(found.status, [Status.ok, Status.infeasible])
    for name, value in found.outputs.items():
        assert np.isnan(value[1]).all() and np.isfinite(value[0]).all(), name


# ---- symmetries ----


def test_a_line_seen_in_a_mirror_is_the_mirrored_line() -> None:
    line, out = lines(), solved().outputs
    mirrored = solve(SOLVER.name, line | {"rise": -line["rise"]}, {"nodes": NODES}, SOLVER.outputs).outputs
    for one, other in (("stress_ratio_A", "stress_ratio_B"), ("stress_ratio_B", "stress_ratio_A")):
        assert relative_error(mirrored[one], out[other]).max() <= ROUNDING
    for name in ("horizontal_distance", "max_stress_ratio", "stress_ratio"):
        assert relative_error(mirrored[name], out[name]).max() <= ROUNDING
    assert relative_error(mirrored["profile_stress_ratio"][:, ::-1], out["profile_stress_ratio"]).max() <= ROUNDING
    across = out["horizontal_distance"][:, None] - out["profile"][:, ::-1, 0]
    height = out["profile"][:, ::-1, 2] - line["rise"][:, None]
    length = design()["line_length"][:, None]
    assert (np.abs(mirrored["profile"][:, :, 0] - across) / length).max() <= ROUNDING
    assert (np.abs(mirrored["profile"][:, :, 2] - height) / length).max() <= ROUNDING


def test_longer_lines_scale_exactly() -> None:
    """By a power of two, so that no input is rounded and equality is exact."""
    line = lines() | {name: 8.0 * lines()[name] for name in LINE}
    for name, value in solve(SOLVER.name, line, {"nodes": NODES}, SOLVER.outputs).outputs.items():
        factor = 8.0 if name in ("horizontal_distance", "profile") else 1.0
        np.testing.assert_array_equal(value, factor * solved().outputs[name], err_msg=name)
