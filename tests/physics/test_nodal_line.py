"""Lines of elements: forces as the issue's model has them, derivatives, elimination, power, symmetries, frequencies."""

import numpy as np
import pytest
from scipy.linalg import eigh

from cablesim.numerics import Array
from cablesim.numerics.lanes import LANES
from cablesim.physics.nodal_line import (
    CHANGE,
    ELEMENT_ROWS,
    HELD,
    LEFT,
    LINE_ROWS,
    NODE_ROWS,
    OTHER,
    OWN,
    POWER,
    RIGHT,
    STRAIN,
    TANGENT,
    UNBOUND,
    assemble,
    solve_inner,
)
from cablesim.solvers._wave_static import static_lines
from tests.helpers import REFERENCE, read_table

EPS = np.finfo(float).eps
COUNT = 6
NAMES = (
    "piece",
    "mass",
    "added",
    "added_tangent",
    "displaced",
    "weight",
    "linear",
    "quadratic",
    "damping",
    "normal_drag",
    "tangent_drag",
    "own_share",
    "other_share",
)
SHARES = {"consistent": (1.0 / 3.0, 1.0 / 6.0), "lumped": (0.5, 0.0)}

Line = dict[str, Array]


def line(size: int = 1, kind: str = "consistent", **changes: float | Array) -> Line:
    """What lines are, an array of one number a lane for each row of the kernel."""
    own, other = SHARES[kind]
    given = {
        "piece": 2.0,
        "mass": 3.4,
        "added": 0.4,
        "added_tangent": 0.4,
        "displaced": 0.3,
        "weight": 26.0,
        "linear": 1e4,
        "quadratic": 3e3,
        "damping": 0.0,
        "normal_drag": 15.6,
        "tangent_drag": 0.78,
        "own_share": own,
        "other_share": other,
    }
    return {name: np.broadcast_to(changes.get(name, given[name]), size).astype(float) for name in NAMES}


def motion(size: int, seed: int = 1, count: int = COUNT) -> tuple[Array, Array]:
    """Random places, velocities and accelerations (lane, node, 9), and the fluid (lane, element, 6).

    Elements of 2 m are about as long as that, some taut and some slack.
    """
    rng = np.random.default_rng(seed)
    nodes = rng.normal(size=(size, count + 1, 9))
    pieces = rng.normal(size=(size, count + 1, 3))
    pieces *= (rng.uniform(1.6, 2.6, (size, count + 1)) / np.linalg.norm(pieces, axis=2))[..., None]
    nodes[:, :, :3] = pieces.cumsum(axis=1)
    return nodes, rng.normal(size=(size, count, 6))


def flat(values: Array, rows: int, width: int = LANES) -> Array:
    """Values (lane, item, row) as a flat array with the lane last; what is not given is NaN."""
    size, items, given = values.shape
    found = np.full((items, rows, LANES), np.nan)
    found[:, :given, :size] = values.transpose(1, 2, 0)
    return found.ravel()


def assembled(
    nodes: Array, fluid: Array, given: Line, by_v: float = 0.0, by_a: float = 0.0, held: Array | None = None
) -> Array:
    """What the kernel finds of the elements, (lane, element, row); held by the tension of their length if not told."""
    if held is None:
        held = np.fmax(assembled(nodes, fluid, given, by_v, by_a, np.ones(fluid.shape[:2]))[..., UNBOUND], 0.0)
    size, count = fluid.shape[:2]
    rows = flat(np.stack([given[name] for name in NAMES], axis=1)[:, None, :], LINE_ROWS)
    factors = np.repeat([by_v, by_a], LANES).astype(float)
    found = np.full((count, ELEMENT_ROWS, LANES), np.nan)
    found[:, HELD, :size] = held.T
    found = found.ravel()
    assemble(flat(nodes, NODE_ROWS), flat(fluid, 6), rows, factors, found, count, size)
    return found.reshape(count, ELEMENT_ROWS, LANES)[:, :, :size].transpose(2, 0, 1)


def matrices(found: Array, first: int) -> Array:
    """Symmetric blocks (..., 3, 3) from six rows on."""
    order = first + np.array([[0, 1, 2], [1, 3, 4], [2, 4, 5]])
    return found[..., order]


def forces(found: Array) -> Array:
    """Forces less inertia at the left and the right node, (lane, element, 2, 3)."""
    return np.stack([found[..., LEFT : LEFT + 3], found[..., RIGHT : RIGHT + 3]], axis=2)


def norm(vectors: Array) -> Array:
    return np.linalg.norm(vectors, axis=-1)


def wide(given: Line) -> Line:
    """The rows of lines, to be multiplied with (lane, element, component)."""
    return {name: values[:, None, None] for name, values in given.items()}


def expected_forces(nodes: Array, fluid: Array, given: Line) -> Array:
    """The same by the words of the model."""
    (x, v, a), p = (nodes[..., 3 * k : 3 * k + 3] for k in range(3)), wide(given)
    d = np.diff(x, axis=1)
    length = norm(d)[..., None]
    t, strain = d / length, length / p["piece"] - 1.0
    rate = (t * np.diff(v, axis=1)).sum(axis=2)[..., None] / p["piece"]
    elastic = p["linear"] * strain + p["quadratic"] * strain**2
    # Damping pulls no more than elasticity.
    pull = elastic + np.minimum(p["damping"] * rate, elastic)
    pull = np.where(strain > 0.0, np.maximum(pull, 0.0), 0.0) * t
    u = fluid[..., :3] - 0.5 * (v[:, 1:] + v[:, :-1])
    ut = (u * t).sum(axis=2)[..., None] * t
    un = u - ut
    load = p["normal_drag"] * norm(un)[..., None] * un + p["tangent_drag"] * norm(ut)[..., None] * ut
    accelerated = fluid[..., 3:]
    load = load + p["displaced"] * accelerated + p["added"] * accelerated
    load = load - p["added_tangent"] * (accelerated * t).sum(axis=2)[..., None] * t
    load[..., 2] -= p["weight"][..., 0]

    def inertia(near: Array, far: Array) -> Array:
        mixed = p["own_share"] * near + p["other_share"] * far
        return p["mass"] * mixed - p["added_tangent"] * (mixed * t).sum(axis=2)[..., None] * t

    left = pull + p["piece"] * (0.5 * load - inertia(a[:, :-1], a[:, 1:]))
    right = -pull + p["piece"] * (0.5 * load - inertia(a[:, 1:], a[:, :-1]))
    return np.stack([left, right], axis=2)


EACH_MASS = pytest.mark.parametrize("mass", SHARES)


# ---- forces ----


@EACH_MASS
@pytest.mark.parametrize("damping", [0.0, 900.0])
def test_forces_are_those_of_the_model(mass, damping):
    nodes, fluid = motion(8)
    added_tangent = np.where(np.arange(8) % 2, 0.4, 0.0)
    given = line(8, mass, damping=damping, added_tangent=added_tangent)
    found, expected = forces(assembled(nodes, fluid, given)), expected_forces(nodes, fluid, given)
    # Forces of a kilonewton, each a sum of few terms.
    assert np.allclose(found, expected, rtol=0.0, atol=100.0 * EPS * np.abs(expected).max())


@pytest.mark.parametrize("quadratic", [0.0, -3e5, 3e5])
def test_an_element_that_is_not_longer_than_unstretched_pulls_with_exactly_nothing_and_none_pushes(quadratic):
    nodes, fluid = motion(LANES)
    nodes[..., 6:] = 0.0
    # Some are much shorter, and of no length at all.
    nodes[::2, :, :3] *= np.linspace(0.0, 1.0, LANES // 2)[:, None, None]
    given = line(LANES, damping=9e3, weight=0.0, normal_drag=0.0, tangent_drag=0.0, quadratic=quadratic)
    found = assembled(nodes, 0.0 * fluid, given)
    pull = norm(forces(found)[:, :, 0])
    inwards = (forces(found)[:, :, 0] * np.diff(nodes[..., :3], axis=1)).sum(axis=2)
    slack = found[..., STRAIN] <= 0.0
    assert slack.any() and not slack.all()
    assert (pull[slack] == 0.0).all() and (found[slack][:, UNBOUND] <= 0.0).all()
    # Damping takes the tension of some elements to zero that are longer.
    assert (inwards >= 0.0).all() and (pull[~slack] == 0.0).any()
    assert np.array_equal(pull > 0.0, found[..., UNBOUND] > 0.0)


def test_elements_are_as_tight_as_they_are_held_whatever_their_length_says():
    """A held element pulls by its law, and pushes where it is shorter; one that is not held does nothing."""
    nodes, fluid = motion(LANES)
    nodes[..., 3:] = 0.0
    given = line(LANES, weight=0.0, normal_drag=0.0, tangent_drag=0.0)
    tight = assembled(nodes, 0.0 * fluid, given, held=np.full((LANES, COUNT), 70.0))
    along = np.einsum("lek,lek->le", forces(tight)[:, :, 0], tight[..., TANGENT : TANGENT + 3])
    assert np.allclose(along, tight[..., UNBOUND], rtol=1e-12, atol=0.0)
    assert (tight[..., UNBOUND] < 0.0).any() and (tight[..., UNBOUND] > 0.0).any()
    loose = assembled(nodes, 0.0 * fluid, given, held=np.zeros((LANES, COUNT)))
    assert (forces(loose) == 0.0).all() and (blocks(loose) == 0.0).all()
    # Across itself it resists by the tension that it is held with, over its length.
    lengths = 2.0 * (1.0 + tight[..., STRAIN])
    own, tangent = matrices(tight, OWN), tight[..., TANGENT : TANGENT + 3]
    across = np.trace(own, axis1=2, axis2=3) - np.einsum("lei,leij,lej->le", tangent, own, tangent)
    assert np.allclose(across, 2.0 * 70.0 / lengths, rtol=1e-9, atol=0.0)


# ---- derivatives ----


def differences(nodes: Array, fluid: Array, given: Line, rows: int, step: float) -> Array:
    """Derivatives of forces (lane, element, of 2 nodes, 3) by motion of the left and right node, last (2, 3).

    `rows` is 0 for places, 3 for velocities, 6 for accelerations. All left nodes are moved at once by moving those of
    even number, then the odd ones.
    """
    count = fluid.shape[1]
    found = np.empty((nodes.shape[0], count, 2, 3, 2, 3))
    for parity in (0, 1):
        even = np.arange(count + 1) % 2 == parity
        for k in range(3):
            shift = np.where(even[:, None], step * np.eye(9)[rows + k], 0.0)
            ahead = forces(assembled(nodes + shift, fluid, given))
            behind = forces(assembled(nodes - shift, fluid, given))
            slope = (ahead - behind) / (2.0 * step)
            for e in range(count):
                found[:, e, :, :, 0 if even[e] else 1, k] = slope[:, e]
    return found


def blocks(found: Array) -> Array:
    """The kernel's matrices in the shape of `differences`."""
    own, other = matrices(found, OWN), matrices(found, OTHER)
    return np.stack([np.stack([own, other], axis=3), np.stack([other, own], axis=3)], axis=2)


def test_blocks_have_the_derivative_of_tension_and_mass_by_place():
    nodes, fluid = motion(LANES)
    nodes[..., 3:] = 0.0
    given = line(LANES, normal_drag=0.0, tangent_drag=0.0, added_tangent=0.0)
    found = blocks(assembled(nodes, 0.0 * fluid, given))
    slope = -differences(nodes, 0.0 * fluid, given, rows=0, step=1e-5)
    # Stiffnesses of 5e3 N/m change by themselves over a metre: their third derivative times 1e-10.
    assert np.allclose(found, slope, rtol=0.0, atol=2e-6)


@EACH_MASS
def test_blocks_have_the_derivative_of_drag_and_damping_by_velocity(mass):
    nodes, fluid = motion(LANES)
    given = line(LANES, mass, damping=20.0)
    found = blocks(assembled(nodes, fluid, given, by_v=1.0)) - blocks(assembled(nodes, fluid, given))
    slope = -differences(nodes, fluid, given, rows=3, step=1e-4)
    # Quadratic drag of flows of 1 m/s; the third derivative of its normal part grows as the inverse flow across.
    assert np.allclose(found, slope, rtol=0.0, atol=1e-5)


@pytest.mark.parametrize("rate", [-0.3, 0.02, 0.5])
def test_blocks_have_the_derivative_of_damped_tension_along_a_straight_line(rate):
    """Where damping slackens the line a little, where it pulls as it wants, and as much as elasticity does."""
    nodes = np.zeros((1, COUNT + 1, 9))
    nodes[0, :, 0], nodes[0, :, 3] = 2.05 * np.arange(COUNT + 1), rate * np.arange(COUNT + 1)
    still, by_v = np.zeros((1, COUNT, 6)), 7.0
    given = line(1, damping=900.0, normal_drag=0.0, tangent_drag=0.0)
    found = blocks(assembled(nodes, still, given, by_v=by_v))[..., 0, :, 0]
    slope = differences(nodes, still, given, rows=0, step=1e-6) + by_v * differences(nodes, still, given, 3, step=1e-6)
    # Stiffnesses of 1e4 N/m; rounding of forces of 250 N over 1e-6 m.
    assert found == pytest.approx(-slope[..., 0, :, 0], abs=1e-4)
    unbound = assembled(nodes, still, given)[..., UNBOUND]
    elastic = (1e4 + 3e3 * 0.025) * 0.025
    assert unbound == pytest.approx(elastic + min(900.0 * rate / 2.0, elastic), rel=1e-12)


@EACH_MASS
def test_blocks_have_the_masses(mass):
    nodes, fluid = motion(LANES)
    given = line(LANES, mass)
    found = blocks(assembled(nodes, fluid, given, by_a=1.0)) - blocks(assembled(nodes, fluid, given))
    # Inertia is linear in the acceleration: only rounding of the stiffness beside it, 1e4 N/m.
    assert np.allclose(found, -differences(nodes, fluid, given, rows=6, step=1.0), rtol=0.0, atol=1e4 * 10.0 * EPS)


# ---- elimination ----


def test_elimination_solves_the_equations_of_the_inner_nodes():
    size, rng = LANES, np.random.default_rng(4)
    nodes, fluid = motion(size)
    found = assembled(nodes, fluid, line(size), by_v=30.0, by_a=900.0)
    kept, elements = flat(nodes, NODE_ROWS), flat(found, ELEMENT_ROWS)
    solve_inner(elements, kept, rng.normal(size=9 * LANES), COUNT, size)
    change = kept.reshape(COUNT + 1, NODE_ROWS, LANES)[:, CHANGE : CHANGE + 3].transpose(2, 0, 1)
    own, other, force = matrices(found, OWN), matrices(found, OTHER), forces(found)
    for w in range(size):
        matrix, left = np.zeros((3 * COUNT + 3, 3 * COUNT + 3)), np.zeros(3 * COUNT + 3)
        for e in range(COUNT):
            here, there = slice(3 * e, 3 * e + 3), slice(3 * e + 3, 3 * e + 6)
            matrix[here, here] += own[w, e]
            matrix[there, there] += own[w, e]
            matrix[here, there] += other[w, e]
            matrix[there, here] += other[w, e]
            left[here] += force[w, e, 0]
            left[there] += force[w, e, 1]
        inner = slice(3, -3)
        expected = np.linalg.solve(matrix[inner, inner], left[inner])
        condition = np.linalg.cond(matrix[inner, inner])
        assert np.abs(change[w, 1:-1].ravel() - expected).max() < 10.0 * condition * EPS * np.abs(expected).max()
    assert not change[:, [0, -1]].any()


# ---- power ----


def energies(nodes: Array, given: Line) -> Array:
    """Kinetic energy without added mass, elastic energy and weight times height (lane, element)."""
    (x, v), p = (nodes[..., 3 * k : 3 * k + 3] for k in range(2)), {n: values[:, None] for n, values in given.items()}
    strain = np.maximum(norm(np.diff(x, axis=1)) / p["piece"] - 1.0, 0.0)
    left, right = v[:, :-1], v[:, 1:]
    squares = p["own_share"] * (norm(left) ** 2 + norm(right) ** 2)
    squares += 2.0 * p["other_share"] * (left * right).sum(axis=2)
    kinetic = 0.5 * (p["mass"] - p["added"]) * squares
    elastic = 0.5 * p["linear"] * strain**2 + p["quadratic"] * strain**3 / 3.0
    return p["piece"] * (kinetic + elastic + p["weight"] * 0.5 * (x[:, 1:, 2] + x[:, :-1, 2]))


@EACH_MASS
@pytest.mark.parametrize("damping", [0.0, 900.0])
def test_work_at_the_nodes_is_the_gain_of_energy_less_the_power_of_what_has_no_potential(mass, damping):
    nodes, fluid = motion(8)
    given = line(8, mass, damping=damping)
    found = assembled(nodes, fluid, given)
    velocity = nodes[..., 3:6]
    at_nodes = (forces(found) * np.stack([velocity[:, :-1], velocity[:, 1:]], axis=2)).sum(axis=(2, 3))

    def after(time: float) -> Array:
        moved = nodes.copy()
        moved[..., :3] += time * velocity + 0.5 * time**2 * nodes[..., 6:]
        moved[..., 3:6] += time * nodes[..., 6:]
        return energies(moved, given)

    step = 1e-5
    gain = (after(step) - after(-step)) / (2.0 * step)
    strain, rate = found[..., STRAIN], (np.diff(velocity, axis=1) * found[..., TANGENT : TANGENT + 3]).sum(axis=2)
    elastic = np.where(strain > 0.0, (given["linear"] + given["quadratic"] * strain.T).T * strain, 0.0)
    damped = (np.maximum(found[..., UNBOUND], 0.0) - elastic) * rate
    # The forces have inertia taken off, so what is left over of them does the work that the energy has not gained.
    balance = at_nodes + gain + damped - found[..., POWER]
    # Energies of kilojoules over steps of 1e-5 s: rounding 1e-7 W, third derivatives times 1e-10.
    assert np.abs(balance).max() < 1e-5


# ---- symmetries ----


def turned(vectors: Array, matrix: Array) -> Array:
    """Every three components (..., 3 k) turned."""
    return (vectors.reshape(*vectors.shape[:-1], -1, 3) @ matrix.T).reshape(vectors.shape)


@pytest.mark.parametrize(
    "matrix",
    [
        np.diag([1.0, -1.0, 1.0]),
        np.array([[np.cos(2.0), -np.sin(2.0), 0.0], [np.sin(2.0), np.cos(2.0), 0.0], [0.0, 0.0, 1.0]]),
    ],
    ids=["mirrored", "turned"],
)
def test_lines_mirrored_or_turned_about_the_vertical_have_forces_mirrored_or_turned(matrix):
    nodes, fluid = motion(8)
    given = line(8, damping=50.0)
    one = assembled(nodes, fluid, given, by_v=3.0, by_a=9.0)
    other = assembled(turned(nodes, matrix), turned(fluid, matrix), given, by_v=3.0, by_a=9.0)
    assert np.allclose(forces(other), forces(one) @ matrix.T, rtol=0.0, atol=1e-10)
    for first in (OWN, OTHER):
        # Stiffnesses of 1e4 N/m, turned twice.
        assert np.allclose(matrices(other, first), matrix @ matrices(one, first) @ matrix.T, rtol=0.0, atol=1e-10)
    assert np.allclose(other[..., POWER], one[..., POWER], rtol=0.0, atol=1e-10)


def test_a_line_counted_from_its_other_end_has_the_same_forces():
    nodes, fluid = motion(8)
    given = line(8, damping=50.0)
    one = assembled(nodes, fluid, given)
    other = assembled(nodes[:, ::-1].copy(), fluid[:, ::-1].copy(), given)
    assert np.allclose(forces(other)[:, ::-1, ::-1], forces(one), rtol=0.0, atol=1e-10)


def test_units_of_length_mass_and_time_do_not_matter():
    nodes, fluid = motion(8)
    given = line(8, damping=50.0)
    # Powers of two: not a bit may differ.
    long, heavy, slow = 8.0, 0.25, 2.0
    force = heavy * long / slow**2
    units = {
        **dict.fromkeys(("mass", "added", "added_tangent", "displaced"), heavy / long),
        **dict.fromkeys(("linear", "quadratic"), force),
        **dict.fromkeys(("normal_drag", "tangent_drag"), heavy / long**2),
        "piece": long,
        "weight": force / long,
        "damping": force * slow,
        "own_share": 1.0,
        "other_share": 1.0,
    }
    rates = np.repeat([long, long / slow, long / slow**2], 3)
    scaled = {name: values * units[name] for name, values in given.items()}
    one = assembled(nodes, fluid, given, by_v=3.0, by_a=9.0)
    other = assembled(nodes * rates, fluid * rates[3:], scaled, by_v=3.0 / slow, by_a=9.0 / slow**2)
    assert np.array_equal(forces(other), force * forces(one))
    assert np.array_equal(other[..., : OTHER + 6], (force / long) * one[..., : OTHER + 6])
    assert np.array_equal(other[..., POWER], (force * long / slow) * one[..., POWER])


# ---- lanes ----


def test_a_line_has_the_same_bits_in_any_lane_beside_any_others():
    nodes, fluid = motion(LANES)
    given = line(LANES, damping=np.linspace(0.0, 50.0, LANES), linear=np.geomspace(1e3, 1e9, LANES))
    together = solved(nodes, fluid, given)
    for w in (0, 5, LANES - 1):
        alone = solved(nodes[[w]], fluid[[w]], {name: values[[w]] for name, values in given.items()})
        for one, other in zip(together, alone, strict=True):
            assert np.array_equal(one[w], other[0])
    spoiled = nodes.copy()
    spoiled[1:] = np.nan
    for one, other in zip(together, solved(spoiled, fluid, given), strict=True):
        assert np.array_equal(one[0], other[0])


def solved(nodes: Array, fluid: Array, given: Line) -> tuple[Array, Array]:
    """What the kernels find of elements and nodes, (lane, item, row)."""
    size = len(nodes)
    elements, kept = flat(assembled(nodes, fluid, given, by_v=3.0, by_a=9.0), ELEMENT_ROWS), flat(nodes, NODE_ROWS)
    solve_inner(elements, kept, np.empty(9 * LANES), COUNT, size)
    change = kept.reshape(COUNT + 1, NODE_ROWS, LANES)[:, CHANGE : CHANGE + 3, :size].transpose(2, 0, 1)
    found = elements.reshape(COUNT, ELEMENT_ROWS, LANES)[:, : POWER + 1, :size].transpose(2, 0, 1)
    return found, change


# ---- natural frequencies ----

X, Y, Z = range(3)
REFERENCES = read_table(REFERENCE / "wave_frequencies.csv")


def reference(kind: str, parameter: float | None = None) -> Array:
    """Frequencies of a kind by their number."""
    chosen = REFERENCES["kind"] == kind
    if parameter is not None:
        chosen &= REFERENCES["parameter"] == parameter
    return REFERENCES["frequency"][chosen]


def frequencies(position: Array, given: Line, kept: slice, components: list[int], number: int) -> Array:
    """The lowest angular frequencies of a line at rest about `position` (node, 3), by the kernel's matrices.

    `kept` are the nodes that move, `components` the directions in which they do.
    """
    count = len(position) - 1
    nodes, fluid = np.concatenate([position, np.zeros((count + 1, 6))], axis=1)[None], np.zeros((1, count, 6))
    still, moving = (_whole(assembled(nodes, fluid, given, by_a=by_a)) for by_a in (0.0, 1.0))
    stiffness, mass = (_chosen(matrix, kept, components) for matrix in (still, moving - still))
    return np.sqrt(eigh(stiffness, mass, eigvals_only=True, subset_by_index=[0, number - 1]))


def _chosen(matrix: Array, kept: slice, components: list[int]) -> Array:
    """Some nodes and components of (node, 3, node, 3), as a square matrix."""
    some = matrix[kept][:, components][:, :, kept][..., components]
    size = some.shape[0] * some.shape[1]
    return some.reshape(size, size)


def _whole(found: Array) -> Array:
    """Matrix (node, 3, node, 3) of the whole line in lane 0."""
    own, other = matrices(found, OWN)[0], matrices(found, OTHER)[0]
    whole = np.zeros((len(own) + 1, 3, len(own) + 1, 3))
    for e in range(len(own)):
        whole[e, :, e] += own[e]
        whole[e + 1, :, e + 1] += own[e]
        whole[e, :, e + 1] += other[e]
        whole[e + 1, :, e] += other[e]
    return whole


def bare(piece: float, kind: str = "consistent", **changes: float) -> Line:
    """A line of 3 kg/m without added mass."""
    return line(1, kind, piece=piece, mass=3.0, added=0.0, added_tangent=0.0, quadratic=0.0, **changes)


INNER = slice(1, -1)


@EACH_MASS
@pytest.mark.parametrize("count", [10, 20, 40, 80])
def test_a_taut_string_of_elements_has_the_frequencies_of_its_matrices_across_and_along(mass, count):
    length, stiffness, strain = 50.0, 1e5, 0.02
    position = np.linspace(0.0, 1.0, count + 1)[:, None] * [length * (1.0 + strain), 0.0, 0.0]
    given = bare(length / count, mass, linear=stiffness)
    expected = reference(f"string_{mass}", count)
    # The largest eigenvalue is 4 count^2 times the first one.
    rounding = 100.0 * EPS * 4.0 * count**2
    across = frequencies(position, given, INNER, [Y], 8) * length * np.sqrt(3.0 * (1.0 + strain) / (stiffness * strain))
    along = frequencies(position, given, INNER, [X], 8) * length * np.sqrt(3.0 / stiffness)
    assert across == pytest.approx(expected, rel=rounding)
    assert along == pytest.approx(expected, rel=rounding)


def test_waves_along_a_line_run_at_the_speed_of_sound_in_it():
    """Frequencies of a line between fixed ends, and of one whose lower end is free, with order two."""
    length, stiffness = 50.0, 1e6
    for kept, kind in ((INNER, "string"), (slice(0, -1), "bar_free")):
        errors = []
        for count in (40, 80):
            position = np.linspace(0.0, length, count + 1)[:, None] * [0.0, 0.0, 1.0 + 1e-9]
            found = frequencies(position, bare(length / count, linear=stiffness), kept, [Z], 4)
            errors.append(found * length * np.sqrt(3.0 / stiffness) / reference(kind)[:4] - 1.0)
        # The next order is (mode pi / 40)^2 / 10 of this one.
        assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.02)
        # (mode pi / 80)^2 / 24.
        assert errors[1] == pytest.approx(reference(kind)[:4] ** 2 / 80**2 / 24.0, rel=0.02)


def test_frequencies_of_a_hanging_chain_are_zeros_of_the_bessel_function_with_order_two():
    length, weight = 80.0, 25.0
    errors = []
    for count in (40, 80):
        h = length / count
        pull = weight * h * (np.arange(count) + 0.5)
        heights = np.concatenate([[0.0], (h * (1.0 + pull / 1e12)).cumsum()])
        position = heights[:, None] * [0.0, 0.0, 1.0]
        found = frequencies(position, bare(h, linear=1e12, weight=weight), slice(0, -1), [Y], 4)
        errors.append(found * np.sqrt(length * 3.0 / weight) / reference("hanging_chain")[:4] - 1.0)
    # The stretch of the least tension is known to 1e-4 of itself; the next order is (mode / 4)^2 times 4 % of this one.
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)
    assert np.log2(errors[0] / errors[1])[:2] == pytest.approx(2.0, abs=0.02)
    assert (errors[1] < 3e-3).all()


def level_line(lambda_squared: float, count: int) -> tuple[Array, Line, float]:
    """Nodes of a shallow level line with a parameter of Irvine and Caughey's, what it is, and its tension.

    Weight over tension is small enough that their theory's errors are, EA over tension large enough that stretch is.
    """
    span, force = 100.0, 5e4
    slope = min(np.sqrt(lambda_squared / 1e5), 0.05)
    stiffness, weight = force * lambda_squared / slope**2, force * slope / span
    # The unstretched length of a parabola with this tension, to the order of the sag that tension needs.
    length = span * (1.0 + slope**2 / 24.0 - slope**4 / 640.0) * (1.0 - force / stiffness)
    nothing = np.zeros(1)
    found = static_lines(
        np.array([[span, 0.0, 0.0]]),
        np.array([length]),
        count,
        np.array([weight]),
        np.array([stiffness]),
        nothing,
        nothing,
        nothing,
        np.zeros((1, 3)),
    )
    given = bare(length / count, linear=stiffness, weight=weight)
    middle = found.tension[0, count // 2]
    return found.position[0], given, middle


@pytest.mark.parametrize(
    "lambda_squared", np.unique(REFERENCES["parameter"][REFERENCES["kind"] == "shallow_symmetric"])
)
def test_the_first_symmetric_frequency_of_a_shallow_line_is_irvines_and_caugheys(lambda_squared):
    expected, found = reference("shallow_symmetric", lambda_squared)[0], []
    for count in (20, 40, 80):
        position, given, pull = level_line(lambda_squared, count)
        modes = frequencies(position, given, INNER, [X, Z], 3) * 100.0 * np.sqrt(3.0 / pull)
        found.append(modes[np.argmin(np.abs(modes - expected))])
    change, finer = np.diff(found)
    assert np.log2(change / finer) == pytest.approx(2.0, abs=0.02)
    # Measured 8.7e-5 at most: the theory leaves out the square of the slope at the ends, 6e-4, times about 1/8.
    assert found[-1] + finer / 3.0 == pytest.approx(expected, rel=2e-4)
