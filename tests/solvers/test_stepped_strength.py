"""The line of uniform pieces against the smooth one, its order, and as the composite line that it is."""

from functools import cache

import mpmath as mp
import numpy as np
import pytest

from cablesim.batch import Results, solve
from cablesim.numerics import Array
from cablesim.solver import load_solver
from cablesim.status import Status
from tests.helpers import draw, relative_error, rows

SOLVER, SMOOTH = load_solver("stepped_strength"), load_solver("equal_strength_loaded")
LINE = ("strength_length", "span", "rise")
# A few hundred units in the last place: sums over some hundred pieces, and the error of their root.
ROUNDING = 1e-13


@cache
def lines() -> dict[str, Array]:
    """Lines of a twentieth to nineteen twentieths of the widest span, under a twentieth to five times their force."""
    rng = np.random.default_rng(1)
    strength, share = 10.0 ** rng.uniform(2.0, 4.0, 200), rng.uniform(0.05, 0.95, 200)
    rise = strength * rng.uniform(-1.5, 1.5, 200) * rng.choice([0.0, 1.0], 200, p=[0.2, 0.8])
    force = np.concatenate([10.0 ** rng.uniform(np.log10(0.05), np.log10(5.0), 195), np.ones(5)])
    return {"strength_length": strength, "span": share * np.pi * strength, "rise": rise, "force_ratio": force}


@cache
def hung(solver: str, sections: int = 0) -> Results:
    """The lines with eleven nodes, which are joints too where the number of sections is a multiple of ten."""
    options = {"nodes": 11} | ({"sections": sections} if sections else {})
    found = solve(solver, lines(), options, SOLVER.outputs)
    assert (found.status == Status.ok).all()
    return found


def errors(sections: int) -> dict[str, Array]:
    """Of the stress at ten joints and both ends, the distance in units of k, and the shape in units of k."""
    found, exact = hung(SOLVER.name, sections).outputs, hung(SMOOTH.name).outputs
    k = lines()["strength_length"]
    return {
        "stress": np.abs(found["profile_stress_ratio"] - exact["profile_stress_ratio"]).max(axis=1),
        "distance": np.abs(found["horizontal_distance"] - exact["horizontal_distance"]) / k,
        "profile": np.abs(found["profile"] - exact["profile"]).max(axis=(1, 2)) / k,
    }


# ---- convergence ----


@pytest.mark.parametrize("quantity", ["stress", "distance", "profile"])
def test_it_converges_to_the_smooth_line_with_order_two(quantity: str) -> None:
    """Between 10, 100, 1000 and 10000 sections; with ten, a kink may be shorter than a piece: only of the median."""
    found = [errors(sections)[quantity] for sections in (10, 100, 1000, 10_000)]
    order = np.diff([np.log10(np.median(error)) for error in found])
    np.testing.assert_allclose(order, -2.0, atol=0.1)
    largest = np.diff([np.log10(error.max()) for error in found[1:]])
    np.testing.assert_allclose(largest, -2.0, atol=0.1)
    # Line by line, where the errors are well above the rounding of the smooth line.
    clear = found[3] > 1e-11
    assert clear.sum() > 150
    np.testing.assert_allclose(np.log10(found[2][clear] / found[3][clear]), 2.0, atol=0.1)


def test_the_largest_stress_converges_at_least_so_fast() -> None:
    """Within a piece it exceeds that at the joints by up to an eighth of the square of the piece; an end does not."""
    exact = hung(SMOOTH.name).outputs["max_stress_ratio"]
    found = [np.abs(hung(SOLVER.name, n).outputs["max_stress_ratio"] - exact).max() for n in (10, 100, 1000)]
    assert found[1] < 1.3e-2 * found[0] and found[2] < 1.3e-2 * found[1]


# ---- the composite line that it is ----


@pytest.mark.parametrize("sections", [1, 2, 7, 40])
def test_it_is_the_composite_line_of_its_pieces(sections: int) -> None:
    """Solved by another solver, for the horizontal tension alone."""
    some = rows(lines(), slice(60))
    found = solve(SOLVER.name, some, {"sections": sections, "nodes": 21}, SOLVER.outputs).outputs
    designs = solve(
        "equal_strength",
        {name: some[name] for name in LINE},
        {"nodes": sections + 1},
        ("line_length", "profile_weight", "area_ratio_A", "area_ratio_B"),
    ).outputs
    length = np.repeat(designs["line_length"][:, None] / sections, sections, axis=1)
    composite = solve(
        "composite_line",
        {
            "section_length": length,
            "section_weight": np.diff(designs["profile_weight"], axis=1) / length,
            "rise": some["rise"],
            "horizontal_tension": some["force_ratio"],
        },
        {"nodes": 21},
        ("horizontal_distance", "tension_A", "tension_B", "profile"),
    )
    assert (composite.status == Status.ok).all()
    out = composite.outputs
    # Section weights are differences of sums up to a thousand times as large: a few hundred units in the last place.
    assert relative_error(found["horizontal_distance"], out["horizontal_distance"]).max() <= 1e-11
    for end in ("A", "B"):
        assert (
            relative_error(found[f"stress_ratio_{end}"] * designs[f"area_ratio_{end}"], out[f"tension_{end}"]).max()
            <= 1e-11
        )
    miss = np.abs(found["profile"] - out["profile"]).max(axis=(1, 2))
    assert (miss / designs["line_length"]).max() <= 1e-11


def test_one_section_is_a_catenary() -> None:
    line = {"strength_length": 2000.0, "span": 1500.0, "rise": 300.0}
    found = solve(SOLVER.name, line | {"force_ratio": 0.7}, {"sections": 1}, ("horizontal_distance", "profile")).outputs
    design = solve("equal_strength", line).outputs
    weight = design["weight_over_force"] / design["line_length"]
    catenary = solve(
        "catenary_exact",
        {
            "span": found["horizontal_distance"],
            "rise": 300.0,
            "line_length": design["line_length"],
            "weight_per_length": weight,
        },
        {},
        ("horizontal_tension", "profile"),
    ).outputs
    # The chord leaves two digits less of a line a tenth longer than it.
    assert catenary["horizontal_tension"][0] == pytest.approx(0.7, rel=1e-12)
    np.testing.assert_allclose(found["profile"], catenary["profile"], rtol=0.0, atol=1e-9)


def test_an_upright_line_of_one_section_is_a_catenary_to_all_digits() -> None:
    """Spans down to 1e-9 of the rise; the distance of a catenary follows from its length and rise in closed form."""
    rng = np.random.default_rng(1)
    rise, share, force = (10.0 ** rng.uniform(*decades, 200) for decades in ((-2.0, 0.5), (-9.0, -3.0), (-2.0, 2.0)))
    line = {"strength_length": 1.0, "span": share * rise, "rise": rise, "force_ratio": force}
    found = solve(SOLVER.name, line, {"sections": 1})
    assert (found.status == Status.ok).all()
    expected = [_distance_of_one_section(*given) for given in zip(rise, share * rise, force, strict=True)]
    np.testing.assert_allclose(found.outputs["horizontal_distance"], expected, rtol=1e-12)


def _distance_of_one_section(rise: float, span: float, force: float) -> float:
    """2 a asinh(sqrt(L^2 - h^2) / 2a), with length and weight of the design from M7; all over k."""
    with mp.workdps(60):
        b, e = mp.mpf(span) / 2, mp.mpf(rise) / 2
        middle = mp.atan(mp.tanh(e) / mp.tan(b))
        slopes = [mp.tan(middle - b), mp.tan(middle + b)]
        length = mp.asinh(slopes[1]) - mp.asinh(slopes[0])
        a = force * length / (slopes[1] - slopes[0])
        return float(2 * a * mp.asinh(mp.sqrt(length**2 - mp.mpf(rise) ** 2) / (2 * a)))


# ---- stresses ----


@pytest.mark.parametrize("sections", [1, 3, 10])
def test_the_largest_stress_is_that_of_the_finest_nodes(sections: int) -> None:
    nodes = 60 * sections + 1
    wanted = ("max_stress_ratio", "profile_stress_ratio")
    found = solve(SOLVER.name, lines(), {"sections": sections, "nodes": nodes}, wanted).outputs
    finest, largest = found["profile_stress_ratio"].max(axis=1), found["max_stress_ratio"]
    length = solve("equal_strength", {name: lines()[name] for name in LINE}).outputs["line_length"]
    assert (finest <= largest * (1.0 + ROUNDING)).all()
    # A node is at most half a step from the top, where the second derivative of log(T / cosh(u)) is above -2:
    # (V' / T)^2 - 2 tanh(u)^2 - 1 / cosh(u)^2, as the first one, V V' / T^2 - tanh(u), is zero.
    step = length / lines()["strength_length"] / (nodes - 1)
    assert (finest >= largest * (1.0 - 0.25 * step**2)).all()
    assert (largest > finest).any()


def test_two_maxima_that_lie_close_together_are_told_apart() -> None:
    """Under nearly the force of the design the stress of a piece is all but the same everywhere, with two tops."""
    rng = np.random.default_rng(1)
    line = {"strength_length": 1.0, "span": rng.uniform(0.2, 1.0, 2000), "rise": rng.uniform(-0.05, 0.05, 2000)}
    line |= {"force_ratio": 1.0 + rng.uniform(-0.01, 0.01, 2000)}
    wanted = ("max_stress_ratio", "profile_stress_ratio")
    found = solve(SOLVER.name, line, {"sections": 1, "nodes": 401}, wanted).outputs
    finest = found["profile_stress_ratio"].max(axis=1)
    assert (finest <= found["max_stress_ratio"] * (1.0 + ROUNDING)).all()
    # Steps of 1 / 300 of k at most, and a second derivative above -2.
    assert (finest >= found["max_stress_ratio"] * (1.0 - 0.25 / 300.0**2)).all()


def test_the_stress_at_an_arc_fraction_is_that_of_the_node_there() -> None:
    nodes = hung(SOLVER.name, 10).outputs["profile_stress_ratio"]
    for node in (0, 3, 10):
        found = solve(SOLVER.name, lines() | {"arc_fraction": node / 10}).outputs["stress_ratio"]
        assert relative_error(found, nodes[:, node]).max() <= ROUNDING


# ---- symmetries and fates ----


def test_a_line_seen_in_a_mirror_is_the_mirrored_line() -> None:
    out = hung(SOLVER.name, 10).outputs
    mirrored = solve(SOLVER.name, lines() | {"rise": -lines()["rise"]}, {"nodes": 11}, SOLVER.outputs).outputs
    for one, other in (("stress_ratio_A", "stress_ratio_B"), ("stress_ratio_B", "stress_ratio_A")):
        assert relative_error(mirrored[one], out[other]).max() <= ROUNDING
    for name in ("horizontal_distance", "max_stress_ratio", "stress_ratio"):
        assert relative_error(mirrored[name], out[name]).max() <= ROUNDING
    across = out["horizontal_distance"][:, None] - out["profile"][:, ::-1, 0]
    height = out["profile"][:, ::-1, 2] - lines()["rise"][:, None]
    k = lines()["strength_length"][:, None]
    assert (np.abs(mirrored["profile"][:, :, 0] - across) / k).max() <= 100.0 * ROUNDING
    assert (np.abs(mirrored["profile"][:, :, 2] - height) / k).max() <= 100.0 * ROUNDING


def test_the_profile_ends_at_the_distance_and_the_rise() -> None:
    profile = hung(SOLVER.name, 10).outputs["profile"]
    ends = np.stack([hung(SOLVER.name, 10).outputs["horizontal_distance"], np.zeros(200), lines()["rise"]], axis=1)
    assert (profile[:, 0] == 0.0).all()
    assert (np.linalg.norm(profile[:, -1] - ends, axis=1) / lines()["strength_length"]).max() <= 100.0 * ROUNDING


def test_every_line_of_the_declared_ranges_is_solved_where_its_design_exists() -> None:
    line = draw(SOLVER.name, 3000, seed=1)
    for sections in (1, 10, 300):
        found = solve(SOLVER.name, line, {"sections": sections})
        exists = solve("equal_strength", {name: line[name] for name in LINE}).status
        assert 1000 < (exists == Status.ok).sum() < 3000
        np.testing.assert_array_equal(found.status, exists)
