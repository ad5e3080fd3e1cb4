"""The other ways to the same answers: SciPy's integrators, a reference in 30 digits, MoorDyn and MoorPy.

Each takes one case at a time, as its users would, and is set up as well as we know how: scalar right-hand sides, a
split where the friction of Pode's functions changes its sign, first guesses from a catenary, the integrator that is
fastest at the accuracy asked for (DOP853 for the functions, LSODA for shooting), MoorDyn's fastest stable scheme.
"""

import math
import tempfile
import warnings
from collections.abc import Callable
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import moorpy
import mpmath as mp
import numpy as np
from measure import silence
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve

from cablesim.numerics import Array

try:
    import moordyn
except ImportError:
    moordyn = None

Line = dict[str, Any]
Slope = Callable[[float, Array], tuple[float, ...]]

GRAVITY = 9.81
# The ends of the reference's panels are this far apart, as a share of the distance to the nearer singular angle.
PANEL = 0.5
DIGITS = 30
NODES = 24
# Lines for MoorDyn and MoorPy lie this deep, clear of the surface, and the seabed is out of reach.
DEPTH = 3000.0
SEABED = 10_000.0
# A stiff line stretches by this at its largest tension; shorter time steps for MoorDyn are the price of less.
STRAIN = 5e-4
SEGMENTS = 50
# Length that MoorPy is given.
SHORT = 90.0
STEADY = 2e-5
LOOK_EVERY = 10.0
LONGEST = 600.0


# Pode's functions


def pode_functions(angle: float, critical_angle: float, friction_ratio: float, rtol: float) -> Array:
    """tau, sigma, xi, eta from the reference angle 180 deg, by `solve_ivp`."""
    weight_ratio = math.sin(critical_angle) ** 2 / math.cos(critical_angle)
    state = np.array([1.0, 0.0, 0.0, 0.0])
    for first, last in _pieces(angle):
        friction = friction_ratio * math.copysign(1.0, math.cos(0.5 * (first + last)))
        found = solve_ivp(
            _pode_slope, (first, last), state, "DOP853", args=(weight_ratio, friction), rtol=rtol, atol=1e-2 * rtol
        )
        state = found.y[:, -1]
    return state


def _pieces(angle: float) -> list[tuple[float, float]]:
    """From 180 deg to the angle, in two pieces where friction changes its direction in between."""
    turn = 0.5 * math.pi
    return [(math.pi, turn), (turn, angle)] if angle < turn else [(math.pi, angle)]


def _pode_slope(angle: float, state: Array, weight_ratio: float, friction: float) -> tuple[float, ...]:
    cos, sin, tau = math.cos(angle), math.sin(angle), state[0]
    change = tau / (weight_ratio * cos - sin * abs(sin))
    return (friction + weight_ratio * sin) * change, change, cos * change, sin * change


def pode_reference(angle: float, critical_angle: float, friction_ratio: float) -> Array:
    """The same four in 30 digits: Gauss panels that shrink towards the singular angles, integrated as polynomials."""
    with mp.workdps(DIGITS):
        nodes, integrals, weights = _panel_rule()
        critical = mp.mpf(critical_angle)
        weight_ratio = mp.sin(critical) ** 2 / mp.cos(critical)
        log_tau, sums = mp.mpf(0), [mp.mpf(0)] * 3
        for first, last in _panels(mp.mpf(angle), critical):
            half = (last - first) / 2
            at = [first + half * (1 + node) for node in nodes]
            friction = friction_ratio * mp.sign(mp.cos(at[0]))
            angles = [(mp.cos(a), mp.sin(a)) for a in at]
            inverse = [1 / (weight_ratio * cos - sin * abs(sin)) for cos, sin in angles]
            slope = [(friction + weight_ratio * sin) * d for (_, sin), d in zip(angles, inverse, strict=True)]
            tau = [mp.exp(log_tau + half * mp.fdot(row, slope)) for row in integrals]
            arc = [t * d for t, d in zip(tau, inverse, strict=True)]
            parts = [[half * w * s for w, s in zip(weights, arc, strict=True)]]
            parts += [[p * pair[axis] for p, pair in zip(parts[0], angles, strict=True)] for axis in (0, 1)]
            sums = [total + mp.fsum(part) for total, part in zip(sums, parts, strict=True)]
            log_tau += half * mp.fdot(weights, slope)
        return np.array([float(mp.exp(log_tau)), *map(float, sums)])


def _panels(angle: mp.mpf, critical: mp.mpf) -> list[tuple[mp.mpf, mp.mpf]]:
    """From 180 deg to the angle, in panels not longer than a share of the distance to the nearer singular angle."""
    turn = mp.pi / 2
    way = [mp.pi, turn, angle] if angle < turn else [mp.pi, angle]
    panels = []
    for here, end in pairwise(way):
        while here != end:
            distance = min(here - critical, mp.pi + critical - here)
            step = min(PANEL * distance, mp.mpf(1) / 4, abs(end - here))
            there = end if step == abs(end - here) else here + mp.sign(end - here) * step
            panels.append((here, there))
            here = there
    return panels


@cache
def _panel_rule() -> tuple[list[mp.mpf], list[list[mp.mpf]], list[mp.mpf]]:
    """Gauss's nodes and weights on -1 .. 1, and the weights of the integrals from -1 to each node."""
    start = np.polynomial.legendre.leggauss(NODES)[0]
    nodes = [mp.findroot(lambda x: mp.legendre(NODES, x), x) for x in start]
    values = [[mp.legendre(k, x) for k in range(NODES + 1)] for x in nodes]
    weights = [2 * (1 - x**2) / (NODES * p[NODES - 1]) ** 2 for x, p in zip(nodes, values, strict=True)]

    def until(upper: list[mp.mpf], x: mp.mpf, column: int) -> mp.mpf:
        terms = (values[column][k] * (upper[k + 1] - upper[k - 1]) for k in range(1, NODES))
        return weights[column] * (1 + x + mp.fsum(terms)) / 2

    integrals = [[until(p, x, column) for column in range(NODES)] for x, p in zip(nodes, values, strict=True)]
    return nodes, integrals, weights


# Lines between two points in a stream


def shooting(line: Line, rtol: float) -> Array:
    """Force vectors at A and B, shape (2, 3): `solve_ivp` inside `fsolve`, from a catenary under a uniform load.

    NaN where it fails: where it says so, where an integration breaks down, or where the line ends elsewhere.
    """
    length, end = line["line_length"], line["position_B"]
    scale, slope = _typical_load(line) * length, line_slope(line)

    def ends(force: Array) -> Array:
        start = np.concatenate([np.zeros(3), scale * force])
        found = solve_ivp(slope, (0.0, length), start, "LSODA", rtol=0.1 * rtol, atol=_small(0.1 * rtol, line))
        if not found.success:
            raise ArithmeticError(found.message)
        return found.y[:, -1]

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            force, _, flag, _ = fsolve(
                lambda force: (ends(force)[:3] - end) / length,
                first_guess(line) / scale,
                full_output=True,
                xtol=0.1 * rtol,
                epsfcn=1e-8,
            )
            last = ends(force)
        except (ArithmeticError, ValueError):
            return np.full((2, 3), np.nan)
    if flag != 1 or np.linalg.norm(last[:3] - end) > 10 * rtol * length:
        return np.full((2, 3), np.nan)
    return np.array([scale * force, last[3:]])


def line_slope(line: Line) -> Slope:
    """The right-hand side: position grows along the force, the force falls by the load."""
    weight, normal, along = line["weight_per_length"], *drag(line)
    squared = line["friction_law"] == "cosine_squared"

    def slope(_: float, state: Array) -> tuple[float, ...]:
        *_, fx, fy, fz = state.tolist()
        tension = math.sqrt(fx * fx + fy * fy + fz * fz)
        x, y, z = fx / tension, fy / tension, fz / tension
        across = normal * math.sqrt(max(1.0 - x * x, 0.0))
        friction = along * (x * abs(x) if squared else math.copysign(1.0, x))
        pull = friction - across * x
        return x, y, z, -(across + pull * x), -pull * y, weight - pull * z

    return slope


def drag(line: Line) -> tuple[float, float]:
    """Normal and tangential drag per length."""
    half = 0.5 * line["fluid_density"] * line["stream_speed"] ** 2 * line["diameter"]
    return line["normal_drag_coefficient"] * half, line["tangential_drag_coefficient"] * half


def first_guess(line: Line) -> Array:
    """Force at A of the catenary under the load that the straight chord would feel."""
    length, chord = line["line_length"], line["position_B"]
    load = -np.array(line_slope(line)(0.0, np.concatenate([np.zeros(3), chord]))[3:])
    magnitude = np.linalg.norm(load)
    up = -load / magnitude
    rise = chord @ up
    across = chord - rise * up
    # A chord along the load has no span; a small one stands for it.
    span = max(np.linalg.norm(across), 1e-2 * length)
    ratio = math.sqrt(length**2 - rise**2) / span
    half = brentq(lambda x: math.log(math.sinh(x) / x / max(ratio, 1.0 + 1e-9)), 1e-6, 50.0)
    sideways = across / max(np.linalg.norm(across), 1e-9 * length)
    return 0.5 * magnitude * (span / half * sideways + (rise / math.tanh(half) - length) * up)


def _typical_load(line: Line) -> float:
    return abs(line["weight_per_length"]) + sum(drag(line))


def _small(rtol: float, line: Line) -> Array:
    length = line["line_length"]
    return rtol * np.repeat([length, _typical_load(line) * length], 3) * 0.1


def moorpy_line(line: Line) -> Array:
    """MoorPy's tensions at A and B: drag as a uniform load, corrected until it is that of the found shape.

    The line is made short, and the tensions long again: in a current MoorPy puts its seabed 100 m below the lower end.
    """
    shorter = SHORT / line["line_length"]
    end = shorter * line["position_B"]
    system = moorpy.System(depth=SEABED, rho=line["fluid_density"], g=GRAVITY)
    system.currentMod, system.current = 1, np.array([line["stream_speed"], 0.0, 0.0])
    system.lineTypes["line"] = {
        "name": "line",
        "d_vol": line["diameter"],
        "m": mass_per_length(line),
        "EA": shorter * axial_stiffness(line),
        "w": line["weight_per_length"],
        "Cd": line["normal_drag_coefficient"],
        "CdAx": line["tangential_drag_coefficient"] / math.pi,
    }
    start = np.array([0.0, 0.0, -DEPTH])
    system.addPoint(1, start)
    system.addPoint(1, start + end)
    system.addLine(SHORT, "line", nSegs=SEGMENTS, pointA=1, pointB=2)
    between = system.lineList[0]
    between.setEndPosition(start, 0)
    between.setEndPosition(start + end, 1)
    before = np.zeros(2)
    for _ in range(100):
        between.staticSolve(tol=1e-8)
        found = np.array([between.TA, between.TB])
        if np.all(np.abs(found - before) < 1e-6 * found):
            return found / shorter
        before = found
    return np.full(2, np.nan)


def moordyn_line(line: Line) -> Array:
    """MoorDyn's tensions at A and B when they no longer change, or NaN."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "line.txt"
        path.write_text(_moordyn_input(line), encoding="utf-8")
        speed = line["stream_speed"]
        profile = "\n".join(["---", "uniform", "z ux uy uz", f"{-SEABED} {speed} 0 0", f"0 {speed} 0 0", ""])
        path.with_name("current_profile.txt").write_text(profile, encoding="utf-8")
        with silence():
            system = moordyn.Create(str(path))
            try:
                if moordyn.Init(system, [], []) != 0:
                    return np.full(2, np.nan)
                return _until_steady(system)
            finally:
                moordyn.Close(system)


def _until_steady(system: object) -> Array:
    """Steps until both tensions stay within a small part over a while."""
    line, before = moordyn.GetLine(system, 1), np.zeros(2)
    for look in range(round(LONGEST / LOOK_EVERY)):
        moordyn.Step(system, [], [], LOOK_EVERY * look, LOOK_EVERY)
        ends = [moordyn.GetLineNodeForce(line, node) for node in (0, SEGMENTS)]
        found = np.linalg.norm(ends, axis=1)
        if np.all(np.abs(found - before) < STEADY * found):
            return found
        before = found
    return np.full(2, np.nan)


def mass_per_length(line: Line) -> float:
    """Mass whose weight in water is the line's."""
    displaced = line["fluid_density"] * 0.25 * math.pi * line["diameter"] ** 2
    return line["weight_per_length"] / GRAVITY + displaced


def axial_stiffness(line: Line) -> float:
    """A stiffness that leaves little stretch."""
    return _typical_load(line) * line["line_length"] / STRAIN


def _moordyn_input(line: Line) -> str:
    """The input file: one line between two fixed points; its tangential coefficient refers to pi times the diameter."""
    end = line["position_B"]
    normal, along = line["normal_drag_coefficient"], line["tangential_drag_coefficient"] / math.pi
    kind = f"{line['diameter']} {mass_per_length(line)} {axial_stiffness(line)} -0.3 0.0 {normal} 1.0 {along} 0.0"
    rule = "-" * 80
    return f"""MoorDyn input: a line in a uniform stream
{rule}
---------------------- LINE TYPES
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(-) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
line {kind}
---------------------- POINTS
Node Type X Y Z M V CdA CA
(-) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Fixed 0 0 {-DEPTH} 0 0 0 0
2 Fixed {end[0]} {end[1]} {end[2] - DEPTH} 0 0 0 0
---------------------- LINES
Line LineType NodeA NodeB UnstrLen NumSegs Flags/Outputs
(-) (-) (-) (-) (m) (-) (-)
1 line 1 2 {line["line_length"]} {SEGMENTS} -
---------------------- OPTIONS
0 writeLog
{GRAVITY} g
{line["fluid_density"]} WtrDnsty
{SEABED} WtrDpth
1 Currents
RK4 tScheme
0.15 cfl
0.0 TmaxIC
---------------------- need this line
"""
