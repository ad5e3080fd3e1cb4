"""Equilibrium of a line of elements: forces recomputed, elastic catenary, continuous line in a stream, limits."""

from functools import cache
from typing import Any

import numpy as np
import pytest

from cablesim.batch import solve
from cablesim.numerics import Array
from cablesim.solvers._wave_drag import loads
from cablesim.solvers._wave_static import INFEASIBLE, NOT_FINITE, SOLVED, StaticLines, static_lines

EPS = np.finfo(float).eps
DENSITY = 1025.0
# What is left over on a node, over the largest tension: promised for all lines.
BALANCED = 1e-10

ORDINARY = {
    "end": [200.0, 0.0, 200.0],
    "line_length": 310.0,
    "segments": 50,
    "weight_per_length": 26.0,
    "linear_stiffness": 1e7,
    "quadratic_stiffness": 0.0,
    "normal_drag": 15.6,
    "tangential_drag": 0.78,
    "stream": [0.0, 0.0, 0.0],
}


def lines(**changes: Any) -> dict[str, Any]:
    """Arguments of ordinary lines with some changes; scalars are given to all scenarios."""
    given = {**ORDINARY, **changes}
    segments = given.pop("segments")
    values = {name: np.asarray(value, dtype=float) for name, value in given.items()}
    size = max(v.shape[0] if v.ndim > (name in ("end", "stream")) else 1 for name, v in values.items())
    shapes = {name: (size, 3) if name in ("end", "stream") else (size,) for name in values}
    return {name: np.broadcast_to(v, shapes[name]).copy() for name, v in values.items()} | {"segments": segments}


def solved(**changes: Any) -> StaticLines:
    found = static_lines(**lines(**changes))
    assert (found.fate == SOLVED).all()
    assert (found.residual <= BALANCED).all()
    return found


def random_lines(size: int, segments: int, seed: int) -> dict[str, Any]:
    """Lines of all kinds: nearly and very taut and slack, heavy, weightless and buoyant, soft, stiff and softening."""
    rng = np.random.default_rng(seed)
    depth, angle = 10.0 ** rng.uniform(0.5, 3.3, size), np.radians(rng.uniform(5.0, 90.0, size))
    end = np.stack([depth / np.tan(angle), np.zeros(size), depth], axis=1)
    end[rng.random(size) < 0.05, 0] = 0.0
    near = 1.0 + rng.choice([-1.0, 1.0], size) * 10.0 ** rng.uniform(-6.0, -1.0, size)
    ratio = np.where(rng.random(size) < 0.4, near, rng.uniform(0.9, 3.0, size))
    weight = 10.0 ** rng.uniform(-1.0, 3.5, size) * rng.choice([1.0, 1.0, 1.0, -1.0], size)
    weight[rng.random(size) < 0.1] = 0.0
    stiffness = 10.0 ** rng.uniform(3.0, 12.0, size)
    bend = rng.choice([0.0, 0.0, 1.0, -1.0], size) * 10.0 ** rng.uniform(-1.0, 1.3, size)
    drag = 10.0 ** rng.uniform(0.0, 2.3, size)
    speed, heading = (
        np.where(rng.random(size) < 0.25, 0.0, rng.uniform(0.0, 3.0, size)),
        rng.uniform(-np.pi, np.pi, size),
    )
    return {
        "end": end,
        "line_length": ratio * np.sqrt((end**2).sum(axis=1)),
        "segments": segments,
        "weight_per_length": weight,
        "linear_stiffness": stiffness,
        "quadratic_stiffness": stiffness * bend,
        "normal_drag": drag,
        "tangential_drag": drag * rng.uniform(0.0, 0.1, size),
        "stream": np.stack([speed * np.cos(heading), speed * np.sin(heading), np.zeros(size)], axis=1),
    }


@cache
def solved_random_lines(segments: int) -> tuple[dict[str, Any], StaticLines]:
    given = random_lines(400, segments, seed=segments)
    return given, static_lines(**given)


def element_loads(given: dict[str, Any], position: Array) -> Array:
    """Weight and drag of each element (scenario, element, 3), as the issue's model states them."""
    vector = np.diff(position, axis=1)
    t = vector / np.sqrt((vector**2).sum(axis=2))[..., None]
    u = given["stream"][:, None, :]
    tangential = (u * t).sum(axis=2)[..., None] * t
    normal = u - tangential
    drag = given["normal_drag"][:, None, None] * np.sqrt((normal**2).sum(axis=2))[..., None] * normal
    drag += given["tangential_drag"][:, None, None] * np.sqrt((tangential**2).sum(axis=2))[..., None] * tangential
    drag[..., 2] -= given["weight_per_length"][:, None]
    return drag * (given["line_length"] / given["segments"])[:, None, None]


def end_forces(given: dict[str, Any], found: StaticLines) -> tuple[Array, Array]:
    """Forces (scenario, 3) that the supports at A and B give to the line."""
    loads, vector = element_loads(given, found.position), np.diff(found.position, axis=1)
    pull = found.tension[..., None] * vector / np.sqrt((vector**2).sum(axis=2))[..., None]
    return -pull[:, 0] - 0.5 * loads[:, 0], pull[:, -1] - 0.5 * loads[:, -1]


def norm(vectors: Array) -> Array:
    return np.sqrt((vectors**2).sum(axis=-1))


# ---- balance ----


@pytest.mark.parametrize("segments", [4, 7, 50, 400])
def test_random_lines_are_solved_unless_their_law_is_too_soft(segments):
    given, found = solved_random_lines(segments)
    assert np.isin(found.fate, [SOLVED, INFEASIBLE]).all()
    softening = given["quadratic_stiffness"] < 0.0
    assert softening[found.fate == INFEASIBLE].all()
    assert (found.fate[softening] == SOLVED).sum() > 20


@pytest.mark.parametrize("segments", [4, 7, 50, 400])
def test_forces_on_all_nodes_balance_and_elements_obey_their_law(segments):
    given, found = solved_random_lines(segments)
    good = np.flatnonzero((found.fate == SOLVED) & (found.tension.max(axis=1) > 0.0))
    given = {name: value if name == "segments" else value[good] for name, value in given.items()}
    position, tension = found.position[good], found.tension[good]
    loads, vector = element_loads(given, position), np.diff(position, axis=1)
    length = norm(vector)
    pull = tension[..., None] * vector / length[..., None]
    left = pull[:, 1:] - pull[:, :-1] + 0.5 * (loads[:, 1:] + loads[:, :-1])
    # Directions from rounded positions are uncertain by EPS times the line over its element.
    rounding = 100.0 * EPS * segments
    assert (norm(left).max(axis=1) <= (BALANCED + rounding) * tension.max(axis=1)).all()
    strain = length / (given["line_length"] / segments)[:, None] - 1.0
    law = (given["linear_stiffness"][:, None] + given["quadratic_stiffness"][:, None] * strain) * strain
    taut, slope = (
        tension > 0.0,
        given["linear_stiffness"][:, None] + 2.0 * given["quadratic_stiffness"][:, None] * strain,
    )
    # The position errors of an element, as strains; beyond a strain of 1 as parts of its length.
    uncertain = (BALANCED + 4.0 * rounding) * np.maximum(np.abs(slope) * (1.0 + strain), 1e-300)
    assert (np.abs(law - tension)[taut] <= (uncertain + 1e-9 * np.abs(tension))[taut]).all()
    assert (strain[~taut] <= 4.0 * rounding).all()


def test_the_ends_are_where_they_were_asked_for():
    given, found = solved_random_lines(50)
    good = found.fate == SOLVED
    assert np.array_equal(found.position[good, -1], given["end"][good])
    assert not found.position[good, 0].any()


@pytest.mark.parametrize("stiffness", [1e3, 1e6, 1e9, 1e12])
def test_tensions_of_lines_of_any_stiffness_balance_to_rounding(stiffness):
    found = solved(linear_stiffness=stiffness, line_length=[260.0, 282.0, 282.9, 283.0, 400.0], stream=[0.6, 0.8, 0.0])
    assert (found.residual < 1e-13).all()
    assert (found.mismatch < 1e-13).all()


def test_newton_takes_few_steps():
    _, found = solved_random_lines(50)
    # Measured 7 and 11.
    assert np.percentile(found.steps, [50, 90]) == pytest.approx([7, 11], abs=2)


def test_the_matrix_has_the_derivative_of_the_drag():
    rng = np.random.default_rng(2)
    line = rng.uniform(0.5, 1.5, 14)
    vectors, step = rng.normal(size=(200, 3)), 1e-5
    here, ahead, behind = np.empty((3, 200, 12))
    loads(line, vectors, 0.7, here)
    for k in range(3):
        shift = step * np.eye(3)[k]
        loads(line, vectors + shift, 0.7, ahead)
        loads(line, vectors - shift, 0.7, behind)
        slope = (ahead[:, :3] - behind[:, :3]) / (2.0 * step)
        # A third derivative grows with the inverse cube of the length of an element.
        bound = 1e3 * step**2 * (1.0 + 1.0 / norm(vectors) ** 3)[:, None]
        assert (np.abs(slope - here[:, [3 + k, 6 + k, 9 + k]]) < bound).all()


# ---- other methods ----


def orders(coarse: Array, fine: Array, true: Array) -> Array:
    return np.log2(np.abs(coarse - true) / np.abs(fine - true))


@pytest.mark.parametrize("stiffness", [1e5, 1e8])
def test_it_tends_to_the_elastic_catenary_with_order_two(stiffness):
    lengths = np.array([280.0, 284.0, 310.0, 500.0])
    names = ("tension_A", "tension_B")
    catenary = solve(
        "catenary_elastic",
        {"span": 200.0, "rise": 200.0, "line_length": lengths, "weight_per_length": 26.0, "axial_stiffness": stiffness},
        outputs=names,
    ).outputs
    given = lines(line_length=lengths, linear_stiffness=stiffness)
    ends = {n: end_forces(given | {"segments": n}, static_lines(**given | {"segments": n})) for n in (100, 200)}
    for side, name in enumerate(names):
        coarse, fine = (norm(ends[n][side]) for n in (100, 200))
        # The next order is (1 / 100)^2 of this one, times a few.
        assert orders(coarse, fine, catenary[name]) == pytest.approx(2.0, abs=0.02)
        assert fine == pytest.approx(catenary[name], rel=1e-4)


def test_it_tends_to_the_continuous_line_in_a_stream_with_order_two():
    headings, speed, diameter, lengths = np.array([0.3, 2.0, -1.2]), 0.7, 0.02, np.array([285.0, 320.0, 450.0])
    pressure = 0.5 * DENSITY * diameter
    continuous = solve(
        "stream_line",
        {
            "position_B": [200.0, 0.0, 200.0],
            "line_length": lengths,
            "weight_per_length": 26.0,
            "diameter": diameter,
            "normal_drag_coefficient": 15.6 / pressure,
            "tangential_drag_coefficient": 0.78 / pressure,
            "friction_law": "cosine_squared",
            "fluid_density": DENSITY,
            "stream_speed": speed,
            "heading": headings,
        },
        outputs=("force_A", "force_B"),
    ).outputs
    stream = speed * np.stack([np.cos(headings), np.sin(headings), np.zeros(3)], axis=1)
    # The mesh of 400 leaves errors of 1e-6, as a stretch of 1e-8 would, that of a stiffness of 1e12 N.
    given = lines(line_length=lengths, linear_stiffness=1e16, stream=stream)
    true, errors = norm(np.stack([continuous["force_A"], continuous["force_B"]])), []
    for n in (200, 400):
        ends = end_forces(given | {"segments": n}, static_lines(**given | {"segments": n}))
        errors.append(norm(np.stack(ends)) - true)
    assert np.log2(np.divide(*errors)) == pytest.approx(2.0, abs=0.02)
    assert (np.abs(errors[1]) < 1e-3 * norm(continuous["force_B"])).all()


# ---- symmetries ----


STREAMED = {"line_length": [281.0, 300.0, 500.0], "stream": [0.6, 0.5, 0.0]}


def test_a_line_turned_about_the_vertical_is_the_same_line():
    cosine, sine = np.cos(2.0), np.sin(2.0)
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    one = solved(**STREAMED)
    end, stream = turn @ ORDINARY["end"], turn @ STREAMED["stream"]
    other = solved(**STREAMED | {"end": end, "stream": stream})
    # Lengths are given with an error of EPS, which a taut line's tension feels 1e4 times.
    assert np.allclose(other.position, one.position @ turn.T, rtol=0.0, atol=1e-9)
    assert np.allclose(other.tension, one.tension, rtol=1e-9)


def test_the_mirrored_stream_bends_a_line_into_its_mirror_image():
    one, other = solved(**STREAMED), solved(**STREAMED | {"stream": [0.6, -0.5, 0.0]})
    assert np.allclose(other.position, one.position * [1.0, -1.0, 1.0], rtol=0.0, atol=1e-9)
    assert np.allclose(other.tension, one.tension, rtol=1e-9)


def test_a_line_seen_from_its_other_end_is_the_same_line():
    one = solved(**STREAMED)
    other = solved(**STREAMED | {"end": -np.array(ORDINARY["end"])})
    assert np.allclose(other.position, one.position[:, ::-1] - one.position[:, -1:], rtol=0.0, atol=1e-9)
    assert np.allclose(other.tension, one.tension[:, ::-1], rtol=1e-9)


def test_units_of_length_and_force_do_not_matter():
    long, strong = 8.0, 1.0 / 32.0
    given, found = solved_random_lines(7)
    scaled = {name: given[name] * strong for name in ("linear_stiffness", "quadratic_stiffness")}
    scaled |= {name: given[name] * (strong / long) for name in ("weight_per_length", "normal_drag", "tangential_drag")}
    other = static_lines(**given | scaled | {"end": long * given["end"], "line_length": long * given["line_length"]})
    assert np.array_equal(other.fate, found.fate)
    # Powers of two: not a bit may differ.
    assert np.array_equal(other.position, long * found.position, equal_nan=True)
    assert np.array_equal(other.tension, strong * found.tension, equal_nan=True)


def test_a_line_does_not_depend_on_its_neighbours():
    given, found = solved_random_lines(7)
    for i in range(0, 400, 37):
        one = {name: value if name == "segments" else value[i : i + 1] for name, value in given.items()}
        assert np.array_equal(static_lines(**one).position[0], found.position[i], equal_nan=True)


# ---- limits ----


def test_a_taut_line_without_load_is_straight():
    found = solved(line_length=[280.0, 250.0], weight_per_length=0.0)
    strain = 200.0 * np.sqrt(2.0) / np.array([280.0, 250.0]) - 1.0
    assert np.allclose(found.tension, 1e7 * strain[:, None], rtol=1e-12)
    assert np.allclose(found.position[:, :, 0], np.linspace(0.0, 200.0, 51), rtol=0.0, atol=1e-10)


def test_a_slack_line_without_load_hangs_as_a_very_light_one_and_pulls_on_nothing():
    nothing, light = solved(weight_per_length=0.0), solved(weight_per_length=1e-3, linear_stiffness=1e12)
    assert not nothing.tension.any() and nothing.residual[0] < 1e-15
    # The stretch of the light one is 1e-13 of it.
    assert np.allclose(nothing.position, light.position, rtol=0.0, atol=1e-8)
    assert nothing.position[0, :, 2].min() < 0.0


def test_a_buoyant_line_is_a_heavy_one_upside_down():
    heavy, buoyant = solved(), solved(end=[200.0, 0.0, -200.0], weight_per_length=-26.0)
    assert np.allclose(buoyant.position, heavy.position * [1.0, 1.0, -1.0], rtol=0.0, atol=1e-10)


@pytest.mark.parametrize("segments", [50, 51])
def test_a_slack_vertical_line_hangs_in_two_legs_with_no_tension_between(segments):
    found = solved(end=[0.0, 0.0, 200.0], line_length=300.0, linear_stiffness=1e12, segments=segments)
    h, tension = 300.0 / segments, found.tension[0]
    bottom = int(np.argmin(tension))
    assert tension[bottom] == 0.0
    steps = np.abs(np.arange(segments) - bottom)
    assert np.allclose(tension, 26.0 * h * steps, rtol=1e-12)
    assert norm(np.diff(found.position[0], axis=0))[bottom] < h
    # The legs differ by the rise, within the element between them.
    assert abs((segments - 1 - 2 * bottom) * h - 200.0) <= h


def test_legs_less_than_an_element_apart_hang_upright():
    found = solved(end=[5.0, 0.0, 200.0], line_length=300.0)
    bottom = int(np.argmin(found.tension[0]))
    assert found.tension[0, bottom] == 0.0
    assert np.array_equal(np.unique(found.position[0, :, 0]), [0.0, 5.0])


def test_legs_a_little_more_than_an_element_apart_are_solved_too():
    h = 300.0 / 50
    found = solved(
        end=np.stack([h * (1.0 + np.geomspace(1e-12, 1.0, 200)), np.zeros(200), np.full(200, 200.0)], axis=1)
    )
    # The tension across the load starts from zero at this distance and grows with it.
    assert (np.diff(found.tension.min(axis=1)) > -1e-9).all()


def test_a_stream_along_the_chord_of_a_weightless_line_bends_it_to_a_side_or_not_at_all():
    found = solved(end=[200.0, 0.0, 200.0], weight_per_length=0.0, line_length=280.0, stream=[1.0, 0.0, 0.0])
    assert np.abs(found.position[..., 1]).max() < 1e-9
    # Downstream of the chord everywhere inside.
    assert (found.position[0, 1:-1, 0] > found.position[0, 1:-1, 2]).all()


def test_a_current_moves_the_line_downstream():
    still, moved = solved(), solved(stream=[0.0, 1.0, 0.0])
    assert np.abs(still.position[..., 1]).max() == 0.0
    assert (moved.position[0, 1:-1, 1] > 0.0).all()


# ---- fates ----


def test_a_softening_law_carries_its_greatest_tension_and_no_more():
    stiffness, peak = 1e7, 0.02
    length = 200.0 * np.sqrt(2.0) / (1.0 + peak * np.array([0.5, 0.999, 1.001, 3.0]))
    law = {"linear_stiffness": stiffness, "quadratic_stiffness": -0.5 * stiffness / peak}
    found = static_lines(**lines(line_length=length, weight_per_length=0.0, **law))
    assert found.fate.tolist() == [SOLVED, SOLVED, INFEASIBLE, INFEASIBLE]
    assert found.tension[1, 0] == pytest.approx(0.5 * stiffness * peak, rel=1e-5)
    assert np.isnan(found.position[2:]).all() and np.isnan(found.residual[2:]).all()


def test_a_hanging_line_too_heavy_for_its_law_is_infeasible():
    # Its top carries more than half of the weight, 4 kN.
    law = {"linear_stiffness": 1e6, "quadratic_stiffness": -0.25 * 1e12 / np.array([1e5, 3.9e3])}
    assert static_lines(**lines(**law)).fate.tolist() == [SOLVED, INFEASIBLE]


@pytest.mark.parametrize("name", ["line_length", "weight_per_length", "quadratic_stiffness", "normal_drag", "stream"])
def test_what_is_not_a_number_spoils_its_own_line_only(name):
    given = lines(line_length=[300.0, 310.0, 320.0], stream=[0.5, 0.0, 0.0])
    expected = static_lines(**given)
    given[name][1] = np.nan
    found = static_lines(**given)
    assert found.fate.tolist() == [SOLVED, NOT_FINITE, SOLVED]
    assert np.array_equal(found.position[::2], expected.position[::2])
    assert np.isnan(found.tension[1]).all()
