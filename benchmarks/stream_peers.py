"""The other ways to the same answers: SciPy's integrators, a reference in 30 digits, MoorDyn and MoorPy.

Each takes one case at a time, as its users would, and is set up as well as we know how: scalar right-hand sides, a
split where the friction of Pode's functions changes its sign, the integrator that is fastest at the accuracy asked for
(DOP853 for the functions), MoorDyn's fastest stable scheme. Lines between two points are those of `cablesim.peers`.
"""

import math
import tempfile
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import mpmath as mp
import numpy as np
from scipy.integrate import solve_ivp

from cablesim import batch
from cablesim.numerics import Array
from cablesim.peers._each import muted
from cablesim.peers.moorpy_stream import DEPTH, GRAVITY, SEABED, axial_stiffness, mass_per_length

try:
    import moordyn
except ImportError:
    moordyn = None

Line = dict[str, Any]

# The ends of the reference's panels are this far apart, as a share of the distance to the nearer singular angle.
PANEL = 0.5
DIGITS = 30
NODES = 24
SEGMENTS = 50
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
    """Force vectors at A and B, shape (2, 3), by `solve_ivp` inside `fsolve`; NaN where it fails."""
    found = batch.solve("ivp_line", line, {"rtol": rtol}, ("force_A", "force_B")).outputs
    return np.array([found["force_A"][0], found["force_B"][0]])


def moorpy_line(line: Line) -> Array:
    """MoorPy's tensions at A and B: drag as a uniform load, corrected until it is that of the found shape."""
    found = batch.solve("moorpy_stream", line, outputs=("tension_A", "tension_B")).outputs
    return np.array([found["tension_A"][0], found["tension_B"][0]])


def moordyn_line(line: Line) -> Array:
    """MoorDyn's tensions at A and B when they no longer change, or NaN."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "line.txt"
        path.write_text(_moordyn_input(line), encoding="utf-8")
        speed = line["stream_speed"]
        profile = "\n".join(["---", "uniform", "z ux uy uz", f"{-SEABED} {speed} 0 0", f"0 {speed} 0 0", ""])
        path.with_name("current_profile.txt").write_text(profile, encoding="utf-8")
        with muted():
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
