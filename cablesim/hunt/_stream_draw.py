"""Lines in a stream to be hunted: comfortable ones, and the corners where methods fail.

Weightless and heavy, in still water and in a torrent, upright, along the stream and across it, pulled at the singular
angle, straight but for a hair or slack, with hardly any pull or none.
"""

import numpy as np

from cablesim.hunt._case import Case
from cablesim.numerics import Array
from cablesim.physics.stream import FRICTION_LAWS, critical_angle

# The plane that Pode's methods know is that of the stream and the vertical.
PLANE = ("pode_line", "pode_table_line")
PROBLEMS = ("length", "depth", "ends")
# Segments of the polygons that are hunted, few and many; and variants of the segment method.
SEGMENTS = (1, 7, 100)
RUNGE_KUTTA = (50, 400)


def draw(solver: str, size: int, rng: np.random.Generator) -> list[Case]:
    """Cases of all problems, each with its options."""
    problems = PROBLEMS[2:] if solver == "pode_table_line" else PROBLEMS
    sizes = [size // len(problems) + (i < size % len(problems)) for i in range(len(problems))]
    return [
        Case(solver, _lines(solver, problem, n, rng), _options(solver, rng))
        for problem, n in zip(problems, sizes, strict=True)
        if n
    ]


def _options(solver: str, rng: np.random.Generator) -> dict[str, float | int | str]:
    if solver == "segment_line":
        return {"segments": int(rng.choice(SEGMENTS)), "variant": str(rng.choice(["euler", "midpoint"]))}
    if solver == "angle_line":
        return {"segments": int(rng.choice(RUNGE_KUTTA))}
    return {"table_step": float(rng.choice([0.5, 1.0, 5.0]))} if solver == "pode_table_line" else {}


def _lines(solver: str, problem: str, size: int, rng: np.random.Generator) -> dict[str, np.ndarray]:
    line = _ropes(solver, size, rng)
    length = mixed(rng, spread(rng, size, 1.0, 3e3), spread(rng, size, 1.0, 3e3), spread(rng, size, 1e-6, 1e6))
    load, critical = loads(line)
    if problem == "ends":
        chord = _chords(solver, line["heading"], size, rng) * (length * _reach(size, rng))[:, None]
        return line | {"position_B": chord, "line_length": length}
    pull = load * length * mixed(rng, spread(rng, size, 0.1, 10.0), spread(rng, size, 1e-6, 1e6))
    pull = np.where(rng.random(size) < 0.03, 0.0, pull)
    force = _directions(solver, line["heading"], critical, size, rng) * pull[:, None]
    if problem == "length":
        return line | {"force_A": force, "line_length": length}
    return line | {"force_A": force, "depth": length * spread(rng, size, 1e-3, 1.0)}


def _ropes(solver: str, size: int, rng: np.random.Generator) -> dict[str, np.ndarray]:
    """What line and stream are, without the shape."""
    zero, ones = np.zeros(size), np.ones(size)
    weight = mixed(
        rng,
        rng.uniform(-20.0, 200.0, size),
        rng.uniform(-20.0, 200.0, size),
        signed(rng, spread(rng, size, 1e-9, 1e6)),
        zero,
    )
    heading = mixed(rng, rng.uniform(-np.pi, np.pi, size), 0.5 * np.pi * rng.integers(-2, 3, size), zero)
    lay = mixed(rng, zero, rng.uniform(-0.3, 0.3, size), rng.uniform(-1.5, 1.5, size))
    return {
        "weight_per_length": np.abs(weight) + 1e-9 * ones if solver == "pode_table_line" else weight,
        "diameter": spread(rng, size, 5e-3, 0.1),
        "normal_drag_coefficient": mixed(rng, *[rng.uniform(1.1, 1.4, size)] * 5, zero),
        "tangential_drag_coefficient": mixed(
            rng, *[rng.uniform(0.02, 0.04, size)] * 3, zero, rng.uniform(0.0, 1.0, size)
        ),
        "friction_law": rng.choice(FRICTION_LAWS, size),
        "lay_angle": zero if solver in PLANE else lay,
        "fluid_density": mixed(rng, 1025.0 * ones, 1025.0 * ones, 1.2 * ones),
        "stream_speed": mixed(
            rng, *[rng.uniform(0.1, 5.0, size)] * 4, spread(rng, size, 1e-4, 0.1), spread(rng, size, 5.0, 50.0), zero
        ),
        "heading": heading,
    }


def loads(line: dict[str, np.ndarray]) -> tuple[Array, Array]:
    """A load per length, and the critical angle."""
    pressure = 0.5 * line["fluid_density"] * line["stream_speed"] ** 2 * line["diameter"]
    weight, drag = np.abs(line["weight_per_length"]), line["normal_drag_coefficient"] * pressure
    load = weight + drag + line["tangential_drag_coefficient"] * pressure
    return np.where(load > 0.0, load, 1.0), critical_angle(weight, drag)


def _reach(size: int, rng: np.random.Generator) -> Array:
    """Chord over length: any, nearly one, hardly anything, and sometimes too far."""
    some = rng.uniform(0.05, 0.999, size)
    taut = 1.0 - spread(rng, size, 1e-9, 1e-1)
    return mixed(rng, some, some, taut, spread(rng, size, 1e-3, 0.1), 1.0 + spread(rng, size, 1e-9, 1.0))


def _chords(solver: str, heading: Array, size: int, rng: np.random.Generator) -> Array:
    if solver == "pode_table_line":
        return np.tile([0.0, 0.0, 1.0], (size, 1))
    return _directions(solver, heading, np.full(size, 0.5 * np.pi), size, rng)


def _directions(solver: str, heading: Array, critical: Array, size: int, rng: np.random.Generator) -> Array:
    """Unit vectors: any, upright, along the stream, near the singular angle; in the stream's plane where they must."""
    zero, side = np.zeros(size), rng.normal(size=size)
    angle = mixed(
        rng,
        *[rng.uniform(-np.pi, np.pi, size)] * 4,
        0.5 * np.pi * rng.integers(-1, 3, size),
        critical + signed(rng, spread(rng, size, 1e-9, 0.1)),
        np.pi + critical + signed(rng, spread(rng, size, 1e-9, 0.1)),
    )
    across = zero if solver in PLANE else mixed(rng, zero, side, side)
    along, up = -np.cos(angle), np.sin(angle)
    vectors = np.column_stack(
        [along * np.cos(heading) - across * np.sin(heading), along * np.sin(heading) + across * np.cos(heading), up]
    )
    return vectors / np.linalg.norm(vectors, axis=1)[:, None]


def spread(rng: np.random.Generator, size: int, low: float, high: float) -> Array:
    """Numbers spread evenly by their logarithm."""
    return np.exp(rng.uniform(np.log(low), np.log(high), size))


def mixed(rng: np.random.Generator, *choices: np.ndarray) -> Array:
    """For every scenario the value of one of the choices."""
    return np.stack(choices)[rng.integers(len(choices), size=choices[0].size), np.arange(choices[0].size)]


def signed(rng: np.random.Generator, values: Array) -> Array:
    """The values with a sign by chance."""
    return values * rng.choice([-1.0, 1.0], values.shape)
