"""Moored line in still water whose top is moved, by MoorDyn, from the same equilibrium and on the same elements.

MoorDyn's model is that of lumped mass but for two things: added mass and drag refer to the direction through both
neighbours of a node and not to an element's, and drag acts at nodes with their velocity, not at the middle of
elements. So its lines are put into water far from surface and bottom, start from the equilibrium that `wave_line` finds
(which its own relaxation comes to, but slowly), and its end forces get the inertia of the half element that they lack.
Its top end moves from place to place at constant velocity during each of its steps. Waves, streams and nonlinear
elasticity are not handed over: `not_converged`.

Reference: M. Hall, A. Goupee, Validation of a lumped-mass mooring line model, Ocean Engineering 104 (2015) 590.
"""

import contextlib
import math
import struct
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cablesim.numerics import Array
from cablesim.parameters import option
from cablesim.peers._each import Answer, muted, singles, solve_each
from cablesim.physics.waves import GRAVITY
from cablesim.solver import Solution
from cablesim.solvers._wave_line import MooredLine as Parameters

__all__ = ["OUTPUTS", "REQUIRES", "Options", "Parameters", "solve"]

REQUIRES = "moordyn"
KINDS, PLACES = ("max", "min", "mean"), ("top", "anchor")
OUTPUTS = (*(f"{kind}_{place}_tension" for place in PLACES for kind in KINDS), "steps")
SCHEMES = ("RK4", "RK2", "ABM2", "ABM4", "BEuler5", "Midpoint5")
# MoorDyn's line hangs this far below its surface, clear of its bottom.
SUNK, BOTTOM = 1000.0, 5000.0
# Largest step of the classical Runge-Kutta method times the largest frequency.
LIMIT = 2.8284
# A part of a period, and a time, that are as good as none.
SAME_TIME, TINY = 1e-9, 1e-300
# Of MoorDyn's own files of a state.
MAGIC, VERSION = b"MoorDyn", (2, 7)


@dataclass(frozen=True)
class Options:
    """Numerical options."""

    segments: int = option(50, at_least=2, at_most=10_000, meaning="straight elements of the line")
    scheme: str = option("RK4", one_of=SCHEMES, meaning="its time scheme")
    step_share: float = option(0.95, at_least=1e-3, meaning="time step over the longest one at which RK4 is stable")


def seconds_per_scenario(options: Options) -> float:
    return 1e-4 * options.segments**2 / options.step_share


@dataclass(frozen=True)
class Motion:
    """Times (step + 1,), displacement and acceleration of the top (step + 1, 3), and the nodes at rest (node, 3)."""

    time: Array
    place: Array
    acceleration: Array
    nodes: Array


@dataclass(frozen=True)
class Forces:
    """Times (step,) and forces on both ends (step, 3) after each step."""

    time: Array
    top: Array
    anchor: Array


def solve(p: Parameters, options: Options) -> Solution:
    return solve_each(p, OUTPUTS, lambda line: _extremes(line, options), REQUIRES, singles)


def _extremes(line: Parameters, options: Options) -> Answer:
    if line.has_waves or line.stream_speed.any() or line.quadratic.any():
        return None
    forces = run(line, options)
    recorded = forces.time >= line.window[0] - SAME_TIME * line.wave_period[0]
    found: dict[str, float] = {}
    for place, force in zip(PLACES, (forces.top, forces.anchor), strict=True):
        tension = np.linalg.norm(force[recorded], axis=1)
        found |= {f"{kind}_{place}_tension": getattr(tension, kind)() for kind in KINDS}
    return {**found, "steps": float(forces.time.size)}


def run(line: Parameters, options: Options) -> Forces:
    """MoorDyn's forces on both ends, those on the top with the inertia of half an element."""
    import moordyn

    motion = _motion(line, options)
    step = float(motion.time[1])
    places = motion.nodes[-1] + motion.place - [0.0, 0.0, SUNK]
    velocities = np.diff(places, axis=0) / step
    top, anchor = [], []
    with _system(line, options, motion, step) as (system, its_line):
        for k, (place, velocity) in enumerate(zip(places[:-1].tolist(), velocities.tolist(), strict=True)):
            top.append(moordyn.Step(system, place, velocity, k * step, step))
            anchor.append(moordyn.GetLineNodeForce(its_line, 0))
    inertia = motion.acceleration[1:] @ _half_element(line, motion.nodes)
    return Forces(motion.time[1:], np.array(top) - inertia, np.array(anchor))


def stable_step(line: Parameters, segments: int) -> float:
    """At which the classical Runge-Kutta method is just stable on a line of lumped mass without damping."""
    element = line.length[0] / segments
    return LIMIT * 0.5 * element * math.sqrt(line.mass_per_length[0] / line.linear_stiffness[0])


def _motion(line: Parameters, options: Options) -> Motion:
    end, ramp, omega = line.end_time[0], line.ramp_time[0], 2.0 * math.pi / line.wave_period[0]
    steps = math.ceil(end / (options.step_share * stable_step(line, options.segments)))
    time = np.linspace(0.0, end, steps + 1)
    s = np.minimum(time / ramp, 1.0) if ramp > 0.0 else np.ones_like(time)
    rise = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    slope = 30.0 * (s * (1.0 - s)) ** 2 / max(ramp, TINY)
    bend = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / max(ramp, TINY) ** 2
    c, s = (vector[0] for vector in line.motion)
    here = np.outer(np.cos(omega * time), c) + np.outer(np.sin(omega * time), s)
    turned = omega * (np.outer(np.cos(omega * time), s) - np.outer(np.sin(omega * time), c))
    acceleration = (bend - omega**2 * rise)[:, None] * here + 2.0 * slope[:, None] * turned
    nodes = line.equilibrium(options.segments).position[0] - [0.0, 0.0, line.depth[0]]
    return Motion(time, rise[:, None] * here, acceleration, nodes)


def _half_element(line: Parameters, nodes: Array) -> Array:
    """Matrix of the inertia of half the last element, as it lies at rest."""
    piece = nodes[-1] - nodes[-2]
    tangent = piece / np.linalg.norm(piece)
    mass, added = line.mass_per_length[0], line.added_mass_per_length[0]
    half = 0.5 * line.length[0] / (len(nodes) - 1)
    return half * ((mass + added) * np.eye(3) - added * np.outer(tangent, tangent))


@contextlib.contextmanager
def _system(line: Parameters, options: Options, motion: Motion, step: float) -> Iterator[tuple[object, object]]:
    """A system that is at rest, and its line."""
    import moordyn

    with tempfile.TemporaryDirectory() as folder, muted():
        path = Path(folder) / "line.txt"
        path.write_text(_input(line, options, step), encoding="utf-8")
        path.with_name("state").write_bytes(_state(motion.nodes))
        system = moordyn.Create(str(path))
        try:
            moordyn.Init_NoIC(system, [*(motion.nodes[-1] + motion.place[0] - [0.0, 0.0, SUNK])], [0.0, 0.0, 0.0])
            moordyn.LoadState(system, str(path.with_name("state")))
            yield system, moordyn.GetLine(system, 1)
        finally:
            moordyn.Close(system)


def _state(nodes: Array) -> bytes:
    """MoorDyn's file of a state: two points, which are not free, and the places and velocities of the inner nodes."""
    point = struct.pack("<QQ6d", 1, 6, *[0.0] * 6)
    inner = np.zeros((len(nodes) - 2, 6))
    inner[:, :3] = nodes[1:-1] - [0.0, 0.0, SUNK]
    data = 2 * point + struct.pack("<QQ", len(inner), 6) + inner.astype("<f8").tobytes()
    return MAGIC + struct.pack("<BBQQ", *VERSION, len(data) // 8 + 1, 3) + data


def _input(line: Parameters, options: Options, step: float) -> str:
    """The input file; tangential drag refers to pi times the diameter."""
    density, area = line.fluid_density[0], line.area[0]
    diameter = math.sqrt(4.0 * area / math.pi)
    normal = line.normal_drag[0] / (0.5 * density * diameter)
    along = line.tangential_drag[0] / (0.5 * density * diameter * math.pi)
    added = line.added_mass_per_length[0] / (density * area)
    stiffness, damping = line.linear_stiffness[0], line.internal_damping[0]
    rule = "-" * 80
    return f"""MoorDyn input: a line whose top is moved
{rule}
---------------------- LINE TYPES
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(-) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
line {diameter} {line.mass_per_length[0]} {stiffness} {damping} 0.0 {normal} {added} {along} 0.0
---------------------- POINTS
Node Type X Y Z M V CdA CA
(-) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Fixed 0 0 {-SUNK - line.depth[0]} 0 0 0 0
2 Coupled {line.top[0, 0]} 0 {-SUNK} 0 0 0 0
---------------------- LINES
Line LineType NodeA NodeB UnstrLen NumSegs Flags/Outputs
(-) (-) (-) (-) (m) (-) (-)
1 line 1 2 {line.length[0]} {options.segments} -
---------------------- OPTIONS
0 writeLog
1 disableOutTime
{GRAVITY} g
{density} WtrDnsty
{BOTTOM} WtrDpth
{options.scheme} tScheme
{step} dtM
---------------------- need this line
"""
