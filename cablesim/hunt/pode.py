"""Pode's functions: judged by the laws of their integrals, then by integration over the angle."""

from itertools import pairwise
from typing import Any

import numpy as np

from cablesim.batch import Results
from cablesim.hunt import _anything
from cablesim.hunt._case import Case, Judge
from cablesim.hunt._stream_draw import mixed, spread
from cablesim.numerics import Array
from cablesim.physics.stream import FRICTION_LAWS
from cablesim.status import Status

SOLVERS = ("pode_functions",)
WEIGHTS = {"pode_functions": 0.5}
FUNCTIONS = ("tau", "sigma", "xi", "eta")
# What the solver claims within its domain, and nearer than `NEAR` to its ends.
CLAIMED, CLAIMED_NEAR, NEAR = 1e-12, 1e-10, 1e-2
# Three evaluations are compared, each as good as claimed, at angles that are rounded.
ROOM = 10.0
# The second method takes so many of a case, that keep away from the ends of the domain, where its steps are short; its
# steps are held to `TOLERANCE`, and a thousand of them to `AGREE`.
INTEGRATED, INNER = 10, 0.1
TOLERANCE, AGREE = 1e-12, 1e-9


def draw(solver: str, size: int, rng: np.random.Generator) -> list[Case]:
    """Angles anywhere in the domain and near its ends, lines from neutral to still water."""
    critical = mixed(rng, *[rng.uniform(0.02, 1.55, size)] * 4, 0.5 * np.pi - spread(rng, size, 1e-6, 0.1))
    return [
        Case(
            solver,
            {
                "angle": critical + _inside(size, rng),
                "critical_angle": critical,
                "friction_ratio": mixed(rng, rng.uniform(0.0, 0.1, size), np.zeros(size)),
                "friction_law": rng.choice(FRICTION_LAWS, size),
                "reference_angle": critical + _inside(size, rng),
            },
            {},
        )
    ]


def _inside(size: int, rng: np.random.Generator) -> Array:
    """Distances from the critical angle."""
    some = np.pi * rng.uniform(0.02, 0.98, size)
    near = spread(rng, size, 1e-6, 0.1)
    return mixed(rng, some, some, some, near, np.pi - near)


def judges(solver: str) -> dict[str, Judge]:
    """Laws, and an integration over the angle."""
    return {**_anything.judges(solver), "chord": chord, "by parts": by_parts, "second": integrated}


def chord(case: Case, found: Results) -> Array:
    """A chord is no longer than its line."""
    out = found.outputs
    return np.maximum(np.hypot(out["xi"], out["eta"]) - np.abs(out["sigma"]), 0.0) / _allowed(case, out["sigma"])


def by_parts(case: Case, found: Results) -> Array:
    """From one angle to another by way of a third: tensions multiply, lengths and distances add up."""
    p = case.parameters
    middle = 0.5 * (p["angle"] + p["reference_angle"])
    first, second = case.solve(FUNCTIONS, angle=middle), case.solve(FUNCTIONS, reference_angle=middle)
    tau = first.outputs["tau"]
    miss = np.abs(tau * second.outputs["tau"] - found.outputs["tau"]) / _allowed(case, found.outputs["tau"])
    for name in FUNCTIONS[1:]:
        whole = first.outputs[name] + tau * second.outputs[name]
        largest = np.abs(first.outputs["sigma"]) + np.abs(tau * second.outputs["sigma"])
        miss = np.maximum(miss, np.abs(whole - found.outputs[name]) / _allowed(case, largest))
    both = (first.status == Status.ok) & (second.status == Status.ok)
    return np.where(both, miss, np.inf)


def integrated(case: Case, found: Results) -> Array:
    """The first few by a Runge-Kutta method of order 8 over the angle itself, with the equations as M11 has them."""
    p = case.parameters
    miss = np.full(case.size, np.nan)
    inner = (_from_ends(case, p["reference_angle"]) > INNER) & (_from_ends(case, p["angle"]) > INNER)
    for row in np.flatnonzero(inner)[:INTEGRATED]:
        seen = _march({name: values[row] for name, values in p.items()})
        own = np.array([found.outputs[name][row] for name in FUNCTIONS])
        scale = np.array([own[0], own[1], own[1], own[1]])
        miss[row] = np.max(np.abs(own - seen) / np.maximum(np.abs(scale), TOLERANCE)) / AGREE
    return miss


def _march(line: dict[str, Any]) -> Array:
    """tau, sigma, xi and eta, piece by piece between the angles at which the loads have a corner."""
    from scipy.integrate import solve_ivp

    start, end = line["reference_angle"], line["angle"]
    corners = sorted(np.clip([0.5 * np.pi, np.pi], min(start, end), max(start, end)), reverse=bool(end < start))
    state = np.array([1.0, 0.0, 0.0, 0.0])
    for low, high in pairwise([start, *corners, end]):
        if low != high:
            side = np.sign(np.cos(0.5 * (low + high)))
            args = (line, side)
            steps = solve_ivp(_rate, (low, high), state, "DOP853", rtol=TOLERANCE, atol=TOLERANCE, args=args)
            state = steps.y[:, -1]
    return state


def _rate(angle: float, state: Array, line: dict[str, Any], side: float) -> Array:
    """d/da of the four functions; `side` is the sign of the cosine in this piece."""
    sine, cosine = np.sin(angle), np.cos(angle)
    weight = np.sin(line["critical_angle"]) ** 2 / np.cos(line["critical_angle"])
    shape = {"constant": 1.0, "cosine_squared": cosine**2, "zero": 0.0}[str(line["friction_law"])]
    turn = state[0] / (weight * cosine - sine * abs(sine))
    friction = line["friction_ratio"] * side * shape
    return turn * np.array([friction + weight * sine, 1.0, cosine, sine])


def _from_ends(case: Case, angle: Array) -> Array:
    """How far an angle is from the nearer end of the domain."""
    low = angle - case.parameters["critical_angle"]
    return np.minimum(low, np.pi - low)


def _allowed(case: Case, values: Array) -> Array:
    """What is claimed, and what the rounding of the angles is worth near the ends of the domain."""
    nearest = np.minimum(*(_from_ends(case, case.parameters[name]) for name in ("angle", "reference_angle")))
    return np.where(nearest > NEAR, CLAIMED, CLAIMED_NEAR) * ROOM * np.abs(values)
