"""Lines of sections to hunt among: ordinary ones, and those at the corners of what there is."""

import numpy as np

from cablesim.hunt._case import Case
from cablesim.hunt._composite_laws import Lines, length, weight
from cablesim.numerics import Array

FEW, MANY = 6, 20
# Decimal exponents: of ordinary lengths and weights per length, and of units that nobody uses.
LENGTHS, WEIGHTS, UNITS = (0.0, 3.0), (-1.0, 4.0), (-9.0, 9.0)
# How much shorter or longer, lighter or heavier one section may be than the others.
ODD = (-8.0, 6.0)
# H over the weight of the line; and the part of its length by which a chord is shorter: ordinary, and extreme.
PULLS, EXTREME_PULLS = (-2.0, 3.0), (-9.0, 9.0)
SLACKS, EXTREME_SLACKS = (-6.0, -0.05), (-17.0, -1e-9)


def composite(size: int, rng: np.random.Generator) -> Lines:
    """Lengths, weights and rises over length."""
    most = MANY if rng.random() < 0.1 else FEW
    shape = (size, most)
    missing = np.arange(most) >= rng.integers(1, most + 1, size)[:, None]
    lengths, weights = 10.0 ** rng.uniform(*LENGTHS, shape), 10.0 ** rng.uniform(*WEIGHTS, shape)
    equal = rng.random(size) < 0.1
    lengths[equal], weights[equal & (rng.random(size) < 0.5)] = lengths[equal, :1], 1.0
    odd = (rng.random(size) < 0.2)[:, None] & (np.arange(most) == rng.integers(0, most, size)[:, None])
    lengths[odd] *= 10.0 ** rng.uniform(*ODD, odd.sum())
    weights[odd] *= 10.0 ** rng.uniform(*ODD, odd.sum())
    for values in (lengths, weights):
        values *= np.where(rng.random(size) < 0.2, 10.0 ** rng.uniform(*UNITS, size), 1.0)[:, None]
    lists = {"section_length": np.where(missing, np.nan, lengths)}
    return lists | {"section_weight": np.where(missing, np.nan, weights)}


def slope(size: int, rng: np.random.Generator) -> Array:
    """Rise over chord: level, ordinary, nearly level or nearly upright."""
    ordinary, tiny = rng.uniform(-0.95, 0.95, size), 10.0 ** rng.uniform(-12.0, -1.0, size)
    sign = rng.choice([-1.0, 1.0], size)
    return np.choose(
        rng.choice(4, size, p=[0.2, 0.5, 0.1, 0.2]), [0.0 * sign, ordinary, sign * tiny, sign - sign * 1e-4 * tiny]
    )


def pulled(size: int, rng: np.random.Generator) -> Lines:
    """Lines of given horizontal tension."""
    line = composite(size, rng)
    pull = _mixed(rng, size, PULLS, EXTREME_PULLS) * weight(line)
    return line | {"rise": slope(size, rng) * length(line), "horizontal_tension": pull}


def spanned(size: int, rng: np.random.Generator) -> Lines:
    """Lines of given horizontal distance; some of them a rounding longer than their chord, or a rounding shorter."""
    line = composite(size, rng)
    chord, sine = length(line) * (1.0 - _mixed(rng, size, SLACKS, EXTREME_SLACKS)), slope(size, rng)
    distance = chord * np.sqrt((1.0 - sine) * (1.0 + sine))
    upright = rng.random(size) < 0.05
    distance = np.where(upright, chord * 10.0 ** rng.uniform(-12.0, -2.0, size), distance)
    return line | {"rise": sine * chord * np.where(upright, 0.9, 1.0), "horizontal_distance": distance}


def of_two(line: Lines) -> Lines:
    """The same lines cut down to wire and chain where there are more sections."""
    return line | {name: line[name][:, :2] for name in ("section_length", "section_weight")}


def towed(size: int, rng: np.random.Generator) -> list[Case]:
    """Tow lines in calm water and in the jerk, four in five by their sections, the others by their distances."""
    line = composite(size, rng)
    pull = _mixed(rng, size, PULLS, EXTREME_PULLS) * weight(line)
    strength = 2.0 * pull * (1.0 + _mixed(rng, size, (-1.0, 1.0), (-14.0, 6.0)))
    wire = {
        "hook_pull": pull,
        "breaking_strength": np.where(rng.random(size) < 0.05, 2.0 * pull, strength),
        "diameter": 10.0 ** rng.uniform(-4.0, 1.0, size),
        "wire_modulus": 10.0 ** rng.uniform(6.0, 13.0, size),
    }
    calm = 10.0 ** rng.uniform(-3.0, 6.0, size)
    jerk = calm * (1.0 + rng.choice([-1e-3, 0.0, 1e-15, 1e-3, 1.0], size))
    distances = {"distance_calm": calm, "distance_jerk": jerk, "line_length": length(line)}
    given = rng.random(size) < 0.2
    by_sections, by_distances = Case("tow_wave_height", wire | line, {}), Case("tow_wave_height", wire | distances, {})
    return [case for case in (by_sections.rows(~given), by_distances.rows(given)) if case.size]


def _mixed(rng: np.random.Generator, size: int, ordinary: tuple[float, float], extreme: tuple[float, float]) -> Array:
    """Powers of ten, every third one extreme."""
    exponents = np.where(rng.random(size) < 0.67, rng.uniform(*ordinary, size), rng.uniform(*extreme, size))
    return 10.0**exponents
