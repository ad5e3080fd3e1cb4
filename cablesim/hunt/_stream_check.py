"""Lines in a stream checked by another method: extrapolated midpoint steps of the equations as the book has them."""

from dataclasses import dataclass

import numpy as np

from cablesim.batch import solve
from cablesim.numerics import Array
from cablesim.physics.stream import FRICTION_LAWS
from cablesim.solver import load_solver
from cablesim.solvers._stream_march import trace
from cablesim.status import Status

Lines = dict[str, np.ndarray]

# Numbers of midpoint steps that are extrapolated to a step of order 14.
SUBSTEPS = (2, 4, 6, 8, 10, 12, 14)
TOLERANCE = 1e-12
MOST_ROUNDS = 3000
# A tension below this part of the largest in its line is compared to that: rounding leaves less of its digits.
FAINTEST = 1e-6
# A line in sea water without its shape, weight and stream.
ROPE = {
    "diameter": 0.02,
    "normal_drag_coefficient": 1.2,
    "tangential_drag_coefficient": 0.03,
    "fluid_density": 1025.0,
}
# The same with a weight, in a stream.
LOADED_ROPE = ROPE | {"weight_per_length": 5.0, "stream_speed": 1.0}


def rows(line: Lines, which: np.ndarray | slice) -> Lines:
    """Some of the lines."""
    return {name: values[which] for name, values in line.items()}


def norm(vectors: Array) -> Array:
    """Lengths of vectors along the last axis."""
    return np.linalg.norm(vectors, axis=-1)


def random_problems(size: int, seed: int) -> Lines:
    """Lines of any direction between two points, from nearly taut to twenty times as long as their chord."""
    rng = np.random.default_rng(seed)
    length = np.exp(rng.uniform(0.0, np.log(3000.0), size))
    ratio = np.where(rng.random(size) < 0.5, rng.uniform(0.05, 0.999, size), 1.0 - 10.0 ** rng.uniform(-3.0, 0.0, size))
    direction = rng.normal(size=(size, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    return {
        "position_B": direction * (np.clip(ratio, 0.05, 0.999) * length)[:, None],
        "line_length": length,
        "weight_per_length": rng.uniform(-20.0, 200.0, size),
        "diameter": np.exp(rng.uniform(np.log(5e-3), np.log(0.1), size)),
        "normal_drag_coefficient": rng.uniform(1.1, 1.4, size),
        "tangential_drag_coefficient": rng.uniform(0.02, 0.04, size),
        "friction_law": rng.choice(FRICTION_LAWS, size),
        "lay_angle": np.where(rng.random(size) < 0.3, 0.0, rng.uniform(-0.3, 0.3, size)),
        "fluid_density": np.full(size, 1025.0),
        "stream_speed": rng.uniform(0.1, 5.0, size),
        "heading": rng.uniform(-np.pi, np.pi, size),
    }


def loads_on(tangent: Array, line: Lines) -> Array:
    """Load per length on tangents (3, n): M13 with its angles, cosines and cross products as they are printed."""
    pressure = 0.5 * line["fluid_density"] * line["stream_speed"] ** 2 * line["diameter"]
    stream = np.stack([np.cos(line["heading"]), np.sin(line["heading"]), np.zeros(pressure.size)])
    cosine = (tangent * stream).sum(axis=0)
    across = stream - cosine * tangent
    normal = line["normal_drag_coefficient"] * pressure * np.sqrt((across**2).sum(axis=0)) * across
    law = line["friction_law"]
    shape = np.where(law == "constant", np.sign(cosine), np.where(law == "zero", 0.0, cosine * np.abs(cosine)))
    along = line["tangential_drag_coefficient"] * pressure * shape * tangent
    twist = 2.0 * np.pi * np.tan(line["lay_angle"]) * pressure * (0.4 - 0.3 * cosine**2) * cosine
    lateral = twist * np.cross(tangent, stream, axis=0)
    weight = np.zeros_like(tangent)
    weight[2] = -line["weight_per_length"]
    return normal + along + lateral + weight


def rate(state: Array, line: Lines) -> Array:
    """d/ds of force and position (6, n)."""
    tangent = state[:3] / np.sqrt((state[:3] ** 2).sum(axis=0))
    return np.concatenate([-loads_on(tangent, line), tangent])


def integrated(force: Array, length: Array, line: Lines) -> tuple[Array, Array]:
    """Forces and positions (n, 3) at the end of signed lengths (n,) from forces (n, 3); NaN where rounds run out."""
    state = np.concatenate([force.T, np.zeros((3, length.size))])
    done, step = np.zeros(length.size), length.copy()
    active = np.flatnonzero(length != 0.0)
    for _ in range(MOST_ROUNDS):
        if not active.size:
            break
        own, h = rows(line, active), step[active]
        left = length[active] - done[active]
        last = np.abs(h) >= np.abs(left)
        h = np.where(last, left, h)
        end, error = _extrapolated(state[:, active], h, own, np.abs(length[active]))
        good = (error <= 1.0) | (np.abs(h) <= 1e-15 * np.abs(length[active]))
        accepted = active[good]
        state[:, accepted] = end[:, good]
        done[accepted] = np.where(last, length[active], done[active] + h)[good]
        step[active] = np.where(good, np.where(error < 0.1, 2.0, 1.0) * h, 0.5 * h)
        active = active[~(good & last)]
    state[:, active] = np.nan
    return state[:3].T, state[3:].T


def _extrapolated(state: Array, h: Array, line: Lines, length: Array) -> tuple[Array, Array]:
    """One step of Gragg's, Bulirsch's and Stoer's method, and its error over what is allowed."""
    first = rate(state, line)
    row: list[Array] = []
    for k, n in enumerate(SUBSTEPS):
        before, here = state, state + h / n * first
        for _ in range(n - 1):
            before, here = here, before + 2.0 * h / n * rate(here, line)
        column = [0.5 * (before + here + h / n * rate(here, line))]
        for j, m in enumerate(reversed(SUBSTEPS[:k])):
            column.append(column[-1] + (column[-1] - row[j]) / ((n / m) ** 2 - 1.0))
        previous, row = row, column
    change = row[-1] - previous[-1]
    least = np.sqrt(np.minimum((state[:3] ** 2).sum(axis=0), (row[-1][:3] ** 2).sum(axis=0)))
    allowed = np.concatenate([np.tile(least, (3, 1)), np.tile(length, (3, 1))]) * TOLERANCE
    error = np.sqrt(((change / allowed) ** 2).sum(axis=0))
    return row[-1], np.where(np.isfinite(error), error, np.inf)


@dataclass(frozen=True)
class Check:
    """What became of lines between two ends: status, distance from B over the length, misfit of the integration."""

    status: np.ndarray
    closing: Array
    misfit: Array


def check(line: Lines, nodes: int = 41) -> Check:
    """Solve lines between two ends and follow each from node to node by `integrated`."""
    found = solve("stream_line", line)
    misfit = np.full(line["line_length"].size, np.nan)
    ok = np.flatnonzero(found.status == Status.ok)
    misfit[ok] = misfits(rows(line, ok), rows(found.outputs, ok), nodes)
    return Check(found.status, found.outputs["closing_error"] / line["line_length"], misfit)


def misfits(line: Lines, found: Lines, nodes: int, **options: float) -> Array:
    """By how much lines that are solved, whatever was given of them, miss the equations from node to node.

    The largest difference, between what another method makes of one node and the next node, of the force relative to
    the tension there (`FAINTEST`) or of the position relative to the length of the line; shape (scenario,).
    """
    chosen = load_solver("stream_line")
    answer = chosen.module.solve(chosen.make_parameters(line), chosen.make_options(options)).answer
    positions, forces = trace(answer.force, answer.at, answer.line_length, answer.loads, answer.rtol, nodes)
    length = found["line_length"]
    whole = line | {"line_length": length, "position_B": found["position_B"]}
    s = length[:, None] * np.linspace(0.0, 1.0, nodes)
    inner = np.argsort(np.column_stack([s, answer.at]), axis=1, kind="stable")
    s = np.take_along_axis(np.column_stack([s, answer.at]), inner, axis=1)
    joined = [
        np.take_along_axis(np.concatenate([values, extra[:, None]], axis=1), inner[:, :, None], axis=1)
        for values, extra in ((positions, -answer.back.position), (forces, answer.force))
    ]
    return np.maximum(_misfit(s, joined, whole), _misfit_at_ends(joined, found, whole))


def _misfit(s: Array, joined: list[Array], line: Lines) -> Array:
    """Every piece is followed from its slacker end, from where errors do not grow."""
    positions, forces = joined
    size, nodes = s.shape
    tension = np.linalg.norm(forces, axis=2)
    onward = tension[:, :-1] <= tension[:, 1:]
    start = np.where(onward[..., None], forces[:, :-1], forces[:, 1:]).reshape(-1, 3)
    goal = np.where(onward[..., None], forces[:, 1:], forces[:, :-1]).reshape(-1, 3)
    sign = np.where(onward, 1.0, -1.0).ravel()
    length = sign * np.diff(s, axis=1).ravel()
    move = sign[:, None] * np.diff(positions, axis=1).reshape(-1, 3)
    each = {name: np.repeat(values, nodes - 1, axis=0) for name, values in line.items()}
    force, moved = integrated(start, length, each)
    least = np.repeat(FAINTEST * tension.max(axis=1), nodes - 1)
    by_force = np.linalg.norm(force - goal, axis=1) / np.maximum(np.linalg.norm(goal, axis=1), least)
    by_place = np.linalg.norm(moved - move, axis=1) / each["line_length"]
    worst = np.maximum(by_force, by_place).reshape(size, nodes - 1)
    return np.where(np.isnan(worst), np.inf, worst).max(axis=1)


def _misfit_at_ends(joined: list[Array], found: Lines, line: Lines) -> Array:
    """What the ends of the followed line miss of the given position of B and of the answered forces."""
    positions, forces = joined
    miss = np.linalg.norm(positions[:, -1] - line["position_B"], axis=1) / line["line_length"]
    for node, end in ((0, "force_A"), (-1, "force_B")):
        force = found[end]
        error = np.linalg.norm(forces[:, node] - force, axis=1)
        miss = np.maximum(miss, error / np.linalg.norm(forces, axis=2).max(axis=1))
    return np.maximum(miss, np.linalg.norm(positions[:, 0], axis=1) / line["line_length"])
