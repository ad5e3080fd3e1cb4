"""Composite lines against 20-digit references, equilibrium, the catenary, their symmetries and their limits."""

from functools import cache

import numpy as np
import pytest

from cablesim.batch import solve
from cablesim.hunt._composite_laws import Lines, joints, length, misfits, number, vertical, weight
from cablesim.numerics import Array
from cablesim.status import Status
from tests.composite_check import GIVEN, IN_WATER, OUTPUTS, SHAPE, random_lines, solved
from tests.helpers import PUBLISHED, REFERENCE, draw, read_table, relative_error, rows

SOLVER = "composite_line"
# A hundred times what is measured on the references, which are exact.
PROMISED = 1e-11
# What the residuals of a solved line may be: the solver's rounding and that of counting forces from a rounded vertex.
BALANCED = 1e-12
# Where the tension is given, B is met to this part of the length.
MET = 4e-16

given_either = pytest.mark.parametrize("given", GIVEN)


# ---- references ----


@cache
def reference(name: str, given: str) -> tuple[Lines, Lines, Lines]:
    """Reference lines in which this is given, what is expected of them, and what the solver says."""
    table = read_table(REFERENCE / f"{name}.csv")
    table = rows(table, table["given"] == given)
    lists = {key: padded(table[key]) for key in ("section_length", "section_weight", "joint_tension")}
    line = {key: lists[key] for key in ("section_length", "section_weight")} | {
        "rise": table["rise"],
        given: table[given],
    }
    expected = table | lists
    expected["lowest_point"] = np.column_stack(
        [table["lowest_point_x"], 0.0 * table["lowest_point_x"], table["lowest_point_z"]]
    )
    results = solve(SOLVER, line)
    return line, expected, results.outputs | {"status": results.status}


def padded(texts: Array) -> Array:
    """Lists written with spaces, NaN after the last number."""
    lists = [[float(word) for word in text.split()] for text in texts]
    width = max(len(values) for values in lists)
    return np.array([values + [np.nan] * (width - len(values)) for values in lists])


def misses(line: Lines, expected: Lines, found: Lines, name: str) -> Array:
    """Error of an output, relative to it; of places along the line, to its length where that is more."""
    scale = length(line) if name in ("vertex_s", "lowest_point") else np.zeros(len(line["rise"]))
    error = (
        relative_error(found[name].T, expected[name].T, scale)
        if name != "lowest_point"
        else (np.linalg.norm(found[name] - expected[name], axis=1) / scale)
    )
    return error if error.ndim == 1 else np.nanmax(error, axis=0)


@given_either
@pytest.mark.parametrize("output", sorted({*OUTPUTS} - {"closing_error", "vertex_section"}))
def test_every_output_keeps_the_promised_digits(output: str, given: str) -> None:
    line, expected, found = reference("composite_lines", given)
    assert (found["status"] == Status.ok).all()
    assert misses(line, expected, found, output).max() <= PROMISED


@given_either
@pytest.mark.parametrize("output", sorted({*OUTPUTS} - {"closing_error", "vertex_section"}))
def test_so_it_does_of_the_most_extreme_lines(output: str, given: str) -> None:
    """Inputs are taken as they are, so that even the slack of a line 1e-15 longer than its chord is known."""
    line, expected, found = reference("composite_extremes", given)
    exists = found["status"] == Status.ok
    line, expected, found = rows(line, exists), rows(expected, exists), rows(found, exists)
    tolerance = PROMISED
    if output in ("vertex_s", "lowest_point") and given == "horizontal_tension":
        tolerance = PROMISED + vertex_rounding(line)
    assert (misses(line, expected, found, output) <= tolerance).all()


@given_either
@pytest.mark.parametrize("name", ["composite_lines", "composite_extremes"])
def test_the_vertex_is_in_the_right_section(name: str, given: str) -> None:
    """Within rounding of a joint it may be on either side."""
    line, expected, found = reference(name, given)
    exists = found["status"] == Status.ok
    line, expected, found = rows(line, exists), rows(expected, exists), rows(found, exists)
    near = np.nanmin(np.abs(joints(line) - expected["vertex_s"][:, None]), axis=1) <= 1e-13 * length(line)
    apart = np.abs(found["vertex_section"] - expected["vertex_section"])
    assert (apart[~near] == 0.0).all() and (apart[near] <= 1.0).all()
    assert near.sum() < 0.2 * near.size


@given_either
def test_extreme_lines_are_refused_if_there_are_none_and_only_then(given: str) -> None:
    _, expected, found = reference("composite_extremes", given)
    none = expected["family"] == "no_line"
    assert none.sum() >= 4
    np.testing.assert_array_equal(found["status"], np.where(none, Status.infeasible, Status.ok))


@given_either
def test_the_references_are_slack_and_taut_light_and_heavy_of_one_section_and_of_many(given: str) -> None:
    """Guards the reference file: a promise is worth what it was measured on."""
    line, expected, _ = reference("composite_lines", given)
    sections, ratio = number(line), expected["horizontal_tension"] / weight(line)
    inside = (expected["vertex_section"] >= 1) & (expected["vertex_section"] <= sections)
    assert len(sections) == 500
    assert sections.min() == 1 and sections.max() == 20
    assert ratio.min() < 2e-3 and ratio.max() > 5e3
    assert inside.sum() >= 90 and (~inside).sum() >= 90
    assert (line["rise"] / length(line)).min() < -0.8 and (line["rise"] / length(line)).max() > 0.8
    if given == "horizontal_distance":
        over_chord = 1.0 - np.hypot(line[given], line["rise"]) / length(line)
        assert over_chord.min() < 1e-8 and over_chord.max() > 0.8


def vertex_rounding(line: Lines) -> Array:
    """What rounding of the height of B is worth in the place of the vertex, in lengths of a line of given tension.

    It moves the vertical tension by that part of H, and the vertex by this over the weight per length.
    """
    return MET * line["horizontal_tension"] / (np.nanmin(line["section_weight"], axis=1) * length(line))


# ---- equilibrium ----


@cache
def random_solved(given: str) -> tuple[Lines, Lines]:
    line = random_lines(5000, seed=1, given=given)
    return line, solved(line)


@given_either
@pytest.mark.parametrize("kind", ["tension", "rise", "arc", "end"])
def test_five_thousand_random_lines_are_in_equilibrium(kind: str, given: str) -> None:
    line, found = random_solved(given)
    assert misfits(line, found)[kind].max() <= BALANCED


def test_a_wrong_line_is_not() -> None:
    """Guards the residuals: they notice a change in the tenth digit of a tension or of a place."""
    line, found = random_solved("horizontal_distance")
    curved = found["horizontal_tension"] < weight(line)
    for name, kind in (("horizontal_tension", "arc"), ("tension_A", "tension"), ("vertex_s", "rise")):
        wrong = misfits(line, found | {name: found[name] * (1.0 + 1e-10)})[kind]
        assert (wrong[curved] > BALANCED).mean() > 0.5, name


@given_either
def test_the_solution_has_the_least_complementary_energy(given: str) -> None:
    """The integral of T less H x and V_A z is strictly convex in H and V_A, x and z being where B should be.

    Its gradient is how far B is off. Integrated numerically: of lines pulled with a tenth of their weight or more T is
    smooth enough for 100 points a section to leave 1e-16 of it.
    """
    line, found = random_solved(given)
    pulled = np.flatnonzero(found["horizontal_tension"] > 0.1 * weight(line))[:1000]
    assert pulled.size == 1000
    line, found = rows(line, pulled), rows(found, pulled)
    H, V_A = found["horizontal_tension"], vertical(line, found, np.zeros((1000, 1)))[:, 0]
    least, x, z = energy(line, found, H, V_A)
    assert (np.abs(x - found["horizontal_distance"]) <= BALANCED * length(line)).all()
    assert (np.abs(z - line["rise"]) <= BALANCED * length(line)).all()
    step = 1e-3 * found["max_tension"]
    for angle in np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False):
        more, *_ = energy(line, found, H + step * np.cos(angle), V_A + step * np.sin(angle))
        # T grows with neither along a straight line, and then hardly where it is nearly straight.
        assert (more >= least - 1e-14 * found["max_tension"] * length(line)).all()
        assert (more > least)[10.0 * weight(line) > H].all()


def energy(line: Lines, found: Lines, H: Array, V_A: Array) -> tuple[Array, Array, Array]:
    """Complementary energy, and the integrals of H / T and V / T, which are the place of B."""
    point, share = np.polynomial.legendre.leggauss(100)
    half = 0.5 * np.nan_to_num(line["section_length"])
    load = half * np.nan_to_num(line["section_weight"])
    middle = V_A[:, None] + 2.0 * np.cumsum(load, axis=1) - load
    V = middle[:, :, None] + load[:, :, None] * point
    T = np.hypot(H[:, None, None], V)
    total, x, z = ((half * (value * share).sum(axis=2)).sum(axis=1) for value in (T, H[:, None, None] / T, V / T))
    return total - H * found["horizontal_distance"] - V_A * line["rise"], x, z


# ---- the handbook ----


def in_water(lists: list[list[float]]) -> Array:
    return IN_WATER * np.array(lists)


def test_the_ten_tasks_of_the_handbook_are_in_equilibrium() -> None:
    """Tasks 121 to 130; their answers are not printed."""
    table = read_table(PUBLISHED / "towline_tasks.csv")
    line = {
        "section_length": np.column_stack([table["wire_length_m"], table["chain_length_m"]]),
        "section_weight": IN_WATER * np.column_stack([table["wire_weight_air_N_m"], table["chain_weight_air_N_m"]]),
        "rise": np.zeros(10),
        "horizontal_tension": 1e3 * table["horizontal_tension_kN"],
    }
    found = solved(line)
    for kind, left in misfits(line, found).items():
        assert left.max() <= BALANCED, kind
    del line["horizontal_tension"]
    again = solved(line | {"horizontal_distance": found["horizontal_distance"]})
    # Rounding of the distance, of which a taut line shows the tension by its slack only, some 1e-4 of it here.
    np.testing.assert_allclose(again["horizontal_tension"], 1e3 * table["horizontal_tension_kN"], rtol=1e-11)


@pytest.mark.parametrize("weights", [(80.04, 597.69), (80.0, 598.0)])
def test_the_first_example_of_the_handbook_is_met_to_its_digits(weights: tuple[float, float]) -> None:
    """Example III: 435.84 m, a sum of four numbers printed to a centimetre, from weights in whole newtons or not.

    Its vertex, 160.5 m from the joint, and its sags, 45.2 and 44.71 m, are approximate; the exact ones are 161.20 m and
    44.93 m, found with the catenary equations by hand.
    """
    line = {"section_length": [400.0, 50.0], "section_weight": list(weights), "horizontal_tension": 49e3}
    found = solved(line)
    assert found["horizontal_distance"] == pytest.approx(435.84, abs=0.02)
    assert 400.0 - found["vertex_s"] == pytest.approx(161.20, abs=0.03)
    assert found["lowest_point"][0, 2] == pytest.approx(-44.93, abs=0.02)
    assert found["vertex_section"] == 1.0


def test_the_play_of_the_second_example_is_met_to_its_digits() -> None:
    """Example V: 372.10 m (372.107 here) at 118 kN and 374.72 m at 388 kN, and so a play of 2.62 m (2.612 here)."""
    table = rows(read_table(PUBLISHED / "towline_play.csv"), 0)
    line = {"section_length": [300.0, 75.0], "section_weight": IN_WATER * np.array([76.0, 687.0])}
    low, high = solved(line | {"horizontal_tension": [118e3, 388e3]})["horizontal_distance"]
    # A printed distance is a sum of four numbers to a centimetre, some of them from catenary parameters to a metre.
    assert low == pytest.approx(table["distance_low_m"], abs=0.01)
    assert high == pytest.approx(table["distance_high_m"], abs=0.005)
    assert high - low == pytest.approx(table["play_m"], abs=0.01)
    assert (round(low, 3), round(high - low, 3)) == (372.107, 2.612)


# ---- the catenary ----


def test_one_section_is_the_exact_catenary() -> None:
    rng = np.random.default_rng(2)
    span, w = 10.0 ** rng.uniform(0.0, 3.0, 5000), 10.0 ** rng.uniform(-1.0, 4.0, 5000)
    rise = rng.uniform(-2.0, 2.0, 5000) * span
    total = np.hypot(span, rise) * (1.0 + 10.0 ** rng.uniform(-12.0, 3.0, 5000))
    exact = solve("catenary_exact", {"span": span, "rise": rise, "line_length": total, "weight_per_length": w}).outputs
    line = {"section_length": total[:, None], "section_weight": w[:, None], "rise": rise, "horizontal_distance": span}
    found = solved(line)
    for name in ("horizontal_tension", "tension_A", "tension_B", "max_tension"):
        np.testing.assert_allclose(found[name], exact[name], rtol=1e-12, err_msg=name)
    inside = (exact["vertex_x"] > 0.0) & (exact["vertex_x"] < span)
    assert 1000 < inside.sum() < 4000
    drop = np.maximum(rise, 0.0) - exact["drop"]
    lowest = np.where(inside, drop, np.minimum(rise, 0.0))
    assert (np.abs(found["lowest_point"][:, 2] - lowest) <= 1e-12 * total).all()
    assert (np.abs(found["lowest_point"][:, 0] - exact["vertex_x"])[inside] <= 1e-12 * total[inside]).all()


@given_either
def test_sections_cut_into_shorter_ones_hang_as_before(given: str) -> None:
    """By powers of two, so that the pieces have exactly the length of the whole."""
    line, found = random_solved(given)
    for parts in (
        [0.5, 0.5],
        [0.25] * 4,
        [0.5, 0.25, 0.125, 0.125],
        [0.5, 0.25, 2.0**-9, 2.0**-9] + [2.0**-n for n in range(3, 9)],
    ):
        cut = line | {
            "section_length": np.kron(line["section_length"], parts),
            "section_weight": np.repeat(line["section_weight"], len(parts), axis=1),
        }
        pieces = solved(cut)
        for name in ("horizontal_tension", "horizontal_distance", "tension_A", "tension_B", "max_tension"):
            np.testing.assert_allclose(pieces[name], found[name], rtol=1e-13, err_msg=name)
        joint = pieces["joint_position"][:, len(parts) - 1 :: len(parts)]
        off = np.nanmax(np.linalg.norm(joint - found["joint_position"], axis=2), axis=1)
        assert (off <= 1e-13 * length(line)).all()
        # A joint near the vertex of a steep line knows its tension as well as the forces a thousand times greater.
        tension = pieces["joint_tension"][:, len(parts) - 1 :: len(parts)]
        room = 1e-13 * found["joint_tension"] + 1e-15 * found["max_tension"][:, None]
        missing = np.isnan(found["joint_tension"])
        assert ((np.abs(tension - found["joint_tension"]) <= room) | missing).all()
        np.testing.assert_array_equal(np.isnan(tension), missing)


def test_lists_of_two_hundred_equal_sections_are_the_line_of_one() -> None:
    whole = {"section_length": [1024.0], "section_weight": [7.0], "rise": 100.0, "horizontal_distance": 900.0}
    many = whole | {"section_length": [4.0] * 256, "section_weight": [7.0] * 256}
    one, other = solved(whole), solved(many)
    for name in ("horizontal_tension", "tension_A", "tension_B", "vertex_s"):
        np.testing.assert_allclose(other[name], one[name], rtol=1e-12, err_msg=name)


# ---- symmetries ----


def reversed_lists(values: Array, sections: np.ndarray) -> Array:
    """Every list from its last number to its first, NaN after it as before."""
    place = np.arange(values.shape[1])
    order = np.where(place < sections[:, None], sections[:, None] - 1 - place, place)
    return np.take_along_axis(values, order, axis=1)


@given_either
def test_a_line_seen_from_behind_is_the_same(given: str) -> None:
    line, found = random_solved(given)
    sections = number(line)
    behind = {name: reversed_lists(line[name], sections) for name in ("section_length", "section_weight")}
    seen = solved(line | behind | {"rise": -line["rise"]})
    for name, other in (
        ("horizontal_tension", "horizontal_tension"),
        ("horizontal_distance", "horizontal_distance"),
        ("tension_A", "tension_B"),
        ("tension_B", "tension_A"),
        ("max_tension", "max_tension"),
    ):
        np.testing.assert_allclose(seen[name], found[other], rtol=BALANCED, err_msg=name)
    total, span = length(line), found["horizontal_distance"]
    tolerance = BALANCED + (vertex_rounding(line) if given == "horizontal_tension" else 0.0)
    assert (relative_error(total - seen["vertex_s"], found["vertex_s"], total) <= tolerance).all()
    mirrored = np.column_stack([span, 0.0 * span, line["rise"]]) + seen["lowest_point"] * [-1.0, 1.0, 1.0]
    assert (np.linalg.norm(mirrored - found["lowest_point"], axis=1) <= tolerance * total).all()


@given_either
def test_longer_and_heavier_lines_scale_exactly(given: str) -> None:
    """Powers of four, so that no input and no square root is rounded, and equality is exact."""
    longer, heavier = 16.0, 1.0 / 64.0
    line, found = random_solved(given)
    of = {"section_length": longer, "rise": longer, "section_weight": heavier}
    of |= {"horizontal_tension": longer * heavier, "horizontal_distance": longer}
    scaled = solved({name: of[name] * values for name, values in line.items()})
    for name, values in scaled.items():
        factor = 1.0 if name == "vertex_section" else longer * heavier if "tension" in name else longer
        np.testing.assert_array_equal(values, factor * found[name], err_msg=name)


def test_the_tension_is_found_again_from_the_distance() -> None:
    """As well as a distance of 53 bits tells it: a taut line shows its tension only in its slack."""
    line, found = random_solved("horizontal_tension")
    chord = np.hypot(found["horizontal_distance"], line["rise"])
    loose = 1.0 - chord / length(line) > 1e-12
    assert loose.sum() > 4500
    line, found, chord = rows(line, loose), rows(found, loose), chord[loose]
    tension = line.pop("horizontal_tension")
    again = solved(line | {"horizontal_distance": found["horizontal_distance"]})
    slack = 1.0 - chord / length(line)
    tolerance = 1e-13 + 1e-15 / slack
    for name, expected in (("horizontal_tension", tension), ("max_tension", found["max_tension"])):
        assert (relative_error(again[name], expected) <= tolerance).all(), name
    assert (again["closing_error"] <= 1e-14 * length(line)).all()


def test_the_distance_grows_with_the_tension() -> None:
    rng = np.random.default_rng(4)
    ratio = np.logspace(-9.0, 5.0, 500)
    for _ in range(20):
        sections = rng.integers(1, 8)
        lists = {
            "section_length": 10.0 ** rng.uniform(0.0, 3.0, sections),
            "section_weight": 10.0 ** rng.uniform(-1.0, 4.0, sections),
        }
        total, heavy = lists["section_length"].sum(), lists["section_length"] @ lists["section_weight"]
        pulled = lists | {"rise": rng.uniform(-0.95, 0.95) * total, "horizontal_tension": heavy * ratio}
        distance = solved(pulled)["horizontal_distance"]
        # What is left to give at the end, 1e-10 / 24 of the length at 1e5 of its weight, is still some 1e5 roundings.
        assert (np.diff(distance) > 0.0).all()
        assert distance[-1] < np.sqrt((total - pulled["rise"]) * (total + pulled["rise"]))


def test_it_matters_where_the_chain_is() -> None:
    tow = {"section_length": [400.0, 50.0], "section_weight": [80.0, 598.0], "horizontal_tension": 49e3}
    middle = {"section_length": [200.0, 50.0, 200.0], "section_weight": [80.0, 598.0, 80.0], "horizontal_tension": 49e3}
    at_the_end, between = (solved(line) for line in (tow, middle))
    # A weight in the middle sags more: here by two thirds, and takes 5 m of distance.
    assert between["lowest_point"][0, 2] < 1.5 * at_the_end["lowest_point"][0, 2]
    assert between["horizontal_distance"] < at_the_end["horizontal_distance"] - 5.0


# ---- limits ----


@given_either
@pytest.mark.parametrize("place", [0, 1, 2])
def test_a_section_a_billionth_of_a_millimetre_long_changes_nothing_beyond_its_size(place: int, given: str) -> None:
    """Of lines 1 to 1e3 m long that are not near their limits, so that a change of 1e-12 m leads to some 1e-11 m."""
    rng = np.random.default_rng(5)
    lists = [10.0 ** rng.uniform(low, high, (500, 2)) for low, high in ((0.0, 2.5), (1.0, 2.0))]
    line = dict(zip(("section_length", "section_weight"), lists, strict=True))
    line["rise"] = rng.uniform(-0.7, 0.7, 500) * length(line)
    reach = np.sqrt(length(line) ** 2 - line["rise"] ** 2)
    size = weight(line) if given == "horizontal_tension" else 0.5 * reach
    line[given] = size * rng.uniform(0.5, 1.8, 500)
    with_it = {
        name: np.insert(line[name], place, value, axis=1)
        for name, value in (("section_length", 1e-12), ("section_weight", 30.0))
    }
    one, other = solved(line), solved(line | with_it)
    for name in ("horizontal_tension", "horizontal_distance", "tension_A", "tension_B"):
        np.testing.assert_allclose(other[name], one[name], rtol=1e-10, err_msg=name)
    assert (np.linalg.norm(other["lowest_point"] - one["lowest_point"], axis=1) <= 1e-10 * length(line)).all()


@pytest.mark.parametrize("excess", [2.0**-50, 1e-12, 1e-9])
def test_a_level_line_a_hair_longer_than_its_distance_is_a_taut_string(excess: float) -> None:
    """Its slack is the integral of V^2 / 2 H^2, to the excess: H = sqrt(integral of V^2 / 2 (L - x))."""
    rng = np.random.default_rng(6)
    lengths, weights = 1.0 + rng.integers(0, 2**20, (500, 4)) / 2.0**20, 10.0 ** rng.uniform(-1.0, 2.0, (500, 4))
    total = lengths.sum(axis=1)  # exact, of numbers of 20 bits
    distance = total * (1.0 - excess)
    found = solved({"section_length": lengths, "section_weight": weights, "horizontal_distance": distance})
    load = lengths * weights
    middle = np.cumsum(load, axis=1) - 0.5 * load
    middle -= (lengths * middle).sum(axis=1)[:, None] / total[:, None]
    square = (lengths * (middle**2 + load**2 / 12.0)).sum(axis=1)
    expected = np.sqrt(square / (2.0 * (total - distance)))
    np.testing.assert_allclose(found["horizontal_tension"], expected, rtol=1e-13 + 10.0 * excess)


# ---- the vertex ----

# With H = 15 and these V, tensions are whole numbers: 15, 17, 25, 39.
WHOLE = {
    "in the wire": ((-20.0, 8.0, 36.0), 1),
    "in the chain": ((-36.0, -8.0, 20.0), 2),
    "at the joint": ((-20.0, 0.0, 8.0), 1),
    "at A": ((0.0, 8.0, 20.0), 1),
    "at B": ((-20.0, -8.0, 0.0), 2),
    "before A": ((8.0, 20.0, 36.0), 0),
    "past B": ((-36.0, -20.0, -8.0), 3),
}


@given_either
@pytest.mark.parametrize("where", WHOLE)
def test_the_vertex_is_found(where: str, given: str) -> None:
    forces, section = WHOLE[where]
    H, V, w = 15.0, np.array(forces), np.array([2.0, 4.0])
    T, turn = np.hypot(H, V), np.arcsinh(V / H)
    lengths, x, z = np.diff(V) / w, H * np.diff(turn) / w, np.diff(T) / w
    line = {"section_length": lengths, "section_weight": w, "rise": z.sum()}
    found = solved(line | {given: H if given == "horizontal_tension" else x.sum()})
    part = min(max(section, 1), 2) - 1
    level = [lengths[0] - V[1] / w[part]] if section else [-V[0] / w[0]]
    np.testing.assert_allclose(found["vertex_s"], level, rtol=0, atol=1e-13 * lengths.sum())
    lowest = {
        0: (0.0, 0.0),
        1: (-H * turn[0] / w[0], (H - T[0]) / w[0]),
        2: (x[0] - H * turn[1] / w[1], z[0] + (H - T[1]) / w[1]),
        3: (x.sum(), z.sum()),
    }[section]
    np.testing.assert_allclose(
        found["lowest_point"][0], [lowest[0], 0.0, lowest[1]], rtol=0, atol=1e-13 * lengths.sum()
    )
    # Just at a joint or an end, rounding may put it on either side.
    exactly = 0.0 not in forces
    assert abs(found["vertex_section"][0] - section) <= (0.0 if exactly else 1.0)
    np.testing.assert_allclose([found["tension_A"][0], *found["joint_tension"][0]], T, rtol=1e-13)
    np.testing.assert_allclose(found["max_tension"], T.max(), rtol=1e-13)


# ---- the profile ----


@given_either
def test_the_profile_runs_from_end_to_end_in_equal_steps_of_length(given: str) -> None:
    line, found = random_solved(given)
    nodes = 41
    shape = solved(line, SHAPE, nodes)
    profile, tension, section = (shape[name] for name in SHAPE)
    total, sections = length(line)[:, None], number(line)
    assert (profile[:, 0] == 0.0).all() and (profile[:, :, 1] == 0.0).all()
    end = np.column_stack([found["horizontal_distance"], 0.0 * total[:, 0], line["rise"]])
    assert (np.linalg.norm(profile[:, -1] - end, axis=1) <= 1e-13 * total[:, 0]).all()
    for node, end_tension in ((0, "tension_A"), (-1, "tension_B")):
        np.testing.assert_allclose(tension[:, node], found[end_tension], rtol=1e-15)
    # Every node is at its arc length: there the line has hung up as much weight, and is in that section.
    s = np.linspace(0.0, 1.0, nodes) * total
    T = np.hypot(found["horizontal_tension"][:, None], vertical(line, found, s))
    assert (np.abs(tension - T) <= BALANCED * found["max_tension"][:, None]).all()
    starts = np.nan_to_num(joints(line), nan=np.inf)[:, 1:-1]
    expected = 1 + np.minimum((s[:, :, None] > starts[:, None, :]).sum(axis=2), sections[:, None] - 1)
    clear = np.abs(s[:, :, None] - starts[:, None, :]).min(axis=2) > 1e-13 * total
    np.testing.assert_array_equal(section[clear], expected[clear])
    assert (np.diff(section, axis=1) >= 0.0).all()
    # No chord between two nodes is longer than the line between them.
    step = total / (nodes - 1)
    assert (np.linalg.norm(np.diff(profile, axis=1), axis=2) <= step + 1e-13 * total).all()


@given_either
def test_the_tension_less_the_weight_times_the_height_is_the_same_within_a_section(given: str) -> None:
    line, _ = random_solved(given)
    shape = solved(line, (*SHAPE, "joint_position", "joint_tension"), nodes=41)
    own = shape["profile_section"].astype(int) - 1
    w, T, z = (
        np.take_along_axis(values, own, axis=1)
        for values in (line["section_weight"], shape["joint_tension"], shape["joint_position"][:, :, 2])
    )
    energy = shape["profile_tension"] - T - w * (shape["profile"][:, :, 2] - z)
    rounding = BALANCED * shape["profile_tension"].max(axis=1)[:, None] + 1e-14 * w * length(line)[:, None]
    assert (np.abs(energy) <= rounding).all()


@given_either
def test_the_profile_passes_through_the_joints(given: str) -> None:
    """Of sections of one length, and nodes at every joint and halfway between two of them."""
    rng = np.random.default_rng(7)
    line = {"section_length": np.full((200, 5), 64.0), "section_weight": 10.0 ** rng.uniform(0.0, 3.0, (200, 5))}
    line["rise"] = rng.uniform(-200.0, 200.0, 200)
    line[given] = weight(line) * 10.0 ** rng.uniform(-2.0, 2.0, 200) if "tension" in given else rng.uniform(1, 240, 200)
    found = solved(line, (*SHAPE, "joint_position", "joint_tension"), nodes=11)
    assert (np.linalg.norm(found["profile"][:, 2::2] - found["joint_position"], axis=2) <= 1e-13 * 320.0).all()
    np.testing.assert_allclose(found["profile_tension"][:, 2::2], found["joint_tension"], rtol=1e-13)
    np.testing.assert_array_equal(found["profile_section"], np.tile([1, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5], (200, 1)))


def test_the_profile_ends_with_a_clump_at_b_however_short() -> None:
    """A load of 10 N on 1e-16 m, less than what a length of 3 m can show."""
    line = {"section_length": [3.0, 1e-16], "section_weight": [1.0, 1e17], "horizontal_tension": 10.0}
    found = solved(line, (*SHAPE, "tension_B"))
    np.testing.assert_allclose(found["profile_tension"][:, -1], found["tension_B"], rtol=1e-13)
    assert found["profile_section"][0, -1] == 2.0


# ---- what has no answer ----


def test_an_upright_line_of_a_heavy_foot_and_a_light_rest_is_solved() -> None:
    """Of 565 m of which all but half a metre lead straight up."""
    line = {"section_length": [0.04, 1.65, 563.5], "section_weight": [0.4, 50.0, 0.002], "rise": 565.189727}
    assert solve(SOLVER, line | {"horizontal_distance": 0.554069}).status == Status.ok


@pytest.mark.parametrize("lengths", [[2.0, 3.0], [3.0, 2.0], [1.0, 1.5, 2.5], [4.5, 2.0**-60, 0.5]])
@pytest.mark.parametrize(("distance", "rise"), [(3.0, 4.0), (4.0, -3.0), (5.0, 0.0)])
def test_a_line_no_longer_than_its_chord_is_infeasible(lengths: list[float], distance: float, rise: float) -> None:
    line = {"section_length": lengths, "section_weight": np.arange(1.0, len(lengths) + 1.0), "rise": rise}
    found = solve(SOLVER, line | {"horizontal_distance": np.nextafter([distance] * 2, [0.0, 10.0])})
    np.testing.assert_array_equal(found.status, [Status.ok, Status.infeasible])
    exactly_five = 2.0**-60 not in lengths
    exact = solve(SOLVER, line | {"horizontal_distance": distance})
    assert exact.status == (Status.infeasible if exactly_five else Status.ok)


def test_a_section_of_one_unit_in_the_last_place_makes_all_the_difference() -> None:
    line = {"section_weight": [1.0, 2.0], "rise": 4.0, "horizontal_distance": 3.0}
    lengths = [[2.0, np.nextafter(3.0, 4.0)], [2.0, np.nextafter(3.0, 0.0)], [2.0, 3.0], [5.0, 1e-30]]
    found = solve(SOLVER, line | {"section_length": lengths})
    np.testing.assert_array_equal(found.status, [Status.ok, Status.infeasible, Status.infeasible, Status.ok])


@pytest.mark.parametrize("rise", [5.0, -5.0, 7.0, np.nextafter(5.0, 6.0)])
def test_a_line_no_longer_than_its_rise_is_infeasible_under_any_tension(rise: float) -> None:
    line = {"section_length": [2.0, 3.0], "section_weight": [1.0, 2.0], "horizontal_tension": [1e-6, 1.0, 1e6]}
    assert (solve(SOLVER, line | {"rise": rise}).status == Status.infeasible).all()
    shorter = np.copysign(np.nextafter(5.0, 0.0), rise)
    assert (solve(SOLVER, line | {"rise": shorter}).status == Status.ok).all()


@pytest.mark.parametrize("problem", [0, 1])
def test_only_infeasible_lines_are_nan(problem: int) -> None:
    line = draw(SOLVER, 5000, seed=8, problem=problem)
    outputs = (*OUTPUTS, "joint_position", *SHAPE)
    found = solve(SOLVER, line, {"nodes": 5}, outputs)
    feasible = length(line) > np.hypot(line.get("horizontal_distance", 0.0), line["rise"])
    assert 500 < feasible.sum() < 4500
    np.testing.assert_array_equal(found.status, np.where(feasible, Status.ok, Status.infeasible))
    own = np.arange(line["section_length"].shape[1]) < number(line)[:, None]
    for name, values in found.outputs.items():
        finite = np.isfinite(values.reshape(5000, values.shape[1] if values.ndim > 1 else 1, -1))
        expected = (
            feasible[:, None] & own
            if name.startswith("joint")
            else np.broadcast_to(feasible[:, None], finite.shape[:2])
        )
        np.testing.assert_array_equal(finite.all(axis=2), expected, err_msg=name)
        np.testing.assert_array_equal(finite.any(axis=2), expected, err_msg=name)


@given_either
def test_a_line_among_longer_lists_is_solved_as_if_alone(given: str) -> None:
    """Bit by bit."""
    line = random_lines(200, seed=9, given=given)
    outputs = (*OUTPUTS, "joint_position", *SHAPE)
    together = solved(line, outputs, nodes=7)
    for i, sections in enumerate(number(line)):
        alone = rows(line, slice(i, i + 1))
        alone |= {name: alone[name][:, :sections] for name in ("section_length", "section_weight")}
        for name, values in solved(alone, outputs, nodes=7).items():
            own = together[name][i, :sections] if name.startswith("joint") else together[name][i]
            np.testing.assert_array_equal(values[0], own, err_msg=name)
