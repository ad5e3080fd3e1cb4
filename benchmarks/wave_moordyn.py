"""Lines whose top is moved in still water, by MoorDyn: a peer, and a table of its results for the tests.

    python benchmarks/wave_moordyn.py tests/reference/wave_moordyn.csv

The line is 283 m long from an anchor 200 m deep, its chord at 45 deg, the static tension at its top 40 kN; the top
moves by 1.57 m to either side, horizontally, with a period of 5.6 s and a smooth start of two periods, through 60 s.

MoorDyn's model is that of lumped mass but for two things: added mass and drag refer to the direction through both
neighbours of a node and not to an element's, and drag acts at nodes with their velocity, not at the middle of elements.
So its lines are put into water far from surface and bottom, start from the same equilibrium (which its own relaxation
comes to, but slowly), and its end forces get the inertia of the half element that they lack. Its top end moves from
place to place at constant velocity during each of its steps.

With EA = 1e8 N the line is jerked taut, and what rings then is as short as the elements and undamped. Its share of a
peak is a matter of the step, not of the physics, so that peaks of the force's mean over 0.1 s are given as well, and
those of the line with internal damping, a two-thousandth of a second of EA.
"""

import argparse
import contextlib
import csv
import math
import struct
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from measure import measure, silence
from scipy.optimize import brentq

from cablesim import batch
from cablesim.numerics import Array

try:
    import moordyn
except ImportError:
    moordyn = None

Line = dict[str, Any]

GRAVITY = 9.80665
DEPTH, TOP_TENSION = 200.0, 40e3
LINE: Line = {
    "depth": DEPTH,
    "chord_angle": 0.25 * math.pi,
    "mass_per_length": 3.0,
    "area": 3e-4,
    "normal_drag": 15.6,
    "tangential_drag": 0.78,
    "added_mass_per_length": 0.4,
    "fluid_density": 1025.0,
    "wave_period": 5.6,
    "top_amplitude": 1.57,
    "ramp": 11.2,
    "duration": 60.0,
}
RECORDED_PERIODS = 5
AVERAGED = 0.1
# MoorDyn's line hangs this far below its surface, clear of its bottom.
SUNK, BOTTOM = 1000.0, 5000.0
SCHEME = "RK4"
SNAPPING = 1e8
# Largest step of the classical Runge-Kutta method times the largest frequency, and the parts of it that are run: the
# largest is stable and damps the shortest waves, the smallest is converged where the line does not snap.
LIMIT, PRACTICAL, CONVERGED = 2.8284, 0.95, 0.2

SOURCE = """\
# A line whose top is moved in still water, by MoorDyn {version} (RK4), written by benchmarks/wave_moordyn.py, where the
# line and its motion are described. SI. Tensions are forces on the ends over the last five periods of 60 s, that of the
# top with the inertia of half an element of lumped mass; averaged: of the mean over 0.1 s. Time steps are
# {practical} and {converged} of the largest stable one. At 1e8 N it snaps; undamped, only its averaged peak converges.
"""


@dataclass(frozen=True)
class Case:
    """A line of some stiffness and internal damping, in elements."""

    stiffness: float
    segments: int
    damping: float = 0.0

    @property
    def line(self) -> Line:
        """Parameters of `wave_line`."""
        ratio = length_ratio(self.stiffness)
        return {
            **LINE,
            "linear_stiffness": self.stiffness,
            "internal_damping": self.damping,
            "length_ratio": ratio,
        }

    @property
    def element(self) -> float:
        """Unstretched length of an element."""
        return length_ratio(self.stiffness) * chord() / self.segments

    @property
    def snaps(self) -> bool:
        return self.stiffness == SNAPPING

    @property
    def converges(self) -> bool:
        """Whether peaks themselves have a limit for short steps."""
        return not self.snaps or self.damping > 0.0

    def __str__(self) -> str:
        damped = ", damped" if self.damping else ""
        return f"EA {self.stiffness:.0e} N{damped}, {self.segments} elements".replace("e+0", "e")


MESHES = (20, 50, 100)
CASES = (
    *(Case(stiffness, segments) for stiffness in (1e6, 1e7, SNAPPING) for segments in MESHES),
    *(Case(SNAPPING, segments, 5e-4 * SNAPPING) for segments in MESHES),
)


@dataclass(frozen=True)
class Extremes:
    """Of the force on the top end over the last periods: of itself, and the peak of its mean over 0.1 s."""

    highest: float
    lowest: float
    averaged: float


@dataclass(frozen=True)
class MoorDynRun:
    """Times (step,) and forces on both ends (step, 3) after each step, and what the steps cost."""

    time: Array
    top: Array
    anchor: Array
    seconds: float


@cache
def length_ratio(stiffness: float) -> float:
    """Unstretched length over chord with which the elastic catenary has its tension at the top."""
    catenary = {"span": DEPTH, "rise": DEPTH, "axial_stiffness": stiffness, "weight_per_length": weight_per_length()}

    def missing(ratio: float) -> float:
        given = {**catenary, "line_length": ratio * chord()}
        return batch.solve("catenary_elastic", given, outputs=("tension_B",)).outputs["tension_B"][0] - TOP_TENSION

    return brentq(missing, 0.9, 1.003, xtol=1e-14)


def chord() -> float:
    return math.sqrt(2.0) * DEPTH


def weight_per_length() -> float:
    return (LINE["mass_per_length"] - LINE["fluid_density"] * LINE["area"]) * GRAVITY


def largest_step(case: Case) -> float:
    """At which the classical Runge-Kutta method is just stable on a line of lumped mass without damping."""
    return LIMIT * 0.5 * case.element * math.sqrt(LINE["mass_per_length"] / case.stiffness)


# MoorDyn


def moordyn_run(case: Case, part: float, scheme: str = SCHEME) -> MoorDynRun:
    """MoorDyn's forces, with steps that are a part of the largest."""
    steps = math.ceil(LINE["duration"] / (part * largest_step(case)))
    time = np.linspace(0.0, LINE["duration"], steps + 1)
    step = float(time[1])
    place = DEPTH + top_motion(time)[0]
    velocity = np.diff(place) / step
    with _moordyn_system(case, scheme, step) as (system, its_line):
        top, anchor = [], []

        def march() -> None:
            for k, (x, v) in enumerate(zip(place[:-1].tolist(), velocity.tolist(), strict=True)):
                top.append(moordyn.Step(system, [x, 0.0, -SUNK], [v, 0.0, 0.0], k * step, step))
                anchor.append(moordyn.GetLineNodeForce(its_line, 0))

        cost = measure(march)
    inertia = 0.5 * case.element * top_motion(time[1:])[1]
    return MoorDynRun(time[1:], np.array(top) - inertia[:, None] * _across(), np.array(anchor), cost.cpu)


def top_motion(time: Array) -> tuple[Array, Array]:
    """Displacement and acceleration of the top end, horizontal."""
    omega, ramp = 2.0 * math.pi / LINE["wave_period"], LINE["ramp"]
    s = np.minimum(time / ramp, 1.0)
    rise = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    slope = 30.0 * (s * (1.0 - s)) ** 2 / ramp
    bend = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / ramp**2
    sine, cosine = np.sin(omega * time), np.cos(omega * time)
    acceleration = (bend - omega**2 * rise) * sine + 2.0 * omega * slope * cosine
    return LINE["top_amplitude"] * rise * sine, LINE["top_amplitude"] * acceleration


def _across() -> Array:
    """Inertia per length of a horizontal acceleration of the last element, which is taken to lie along the chord."""
    mass, added = LINE["mass_per_length"], LINE["added_mass_per_length"]
    return np.array([mass + 0.5 * added, 0.0, -0.5 * added])


@contextlib.contextmanager
def _moordyn_system(case: Case, scheme: str, step: float) -> Iterator[tuple[object, object]]:
    """A system that is at rest, and its line."""
    with tempfile.TemporaryDirectory() as folder, silence():
        path = Path(folder) / "line.txt"
        path.write_text(_moordyn_input(case, scheme, step), encoding="utf-8")
        path.with_name("state").write_bytes(_moordyn_state(still_line(case)))
        system = moordyn.Create(str(path))
        try:
            moordyn.Init_NoIC(system, [DEPTH, 0.0, -SUNK], [0.0, 0.0, 0.0])
            moordyn.LoadState(system, str(path.with_name("state")))
            yield system, moordyn.GetLine(system, 1)
        finally:
            moordyn.Close(system)


@cache
def still_line(case: Case) -> Array:
    """Places of the nodes at rest, from the anchor, shape (node, 3); MoorDyn's equilibrium is the same."""
    options = {"segments": case.segments, "mass": "lumped"}
    given = case.line | {"duration": 0.01}
    return batch.solve("wave_line", given, options, ("profile",)).outputs["profile"][0]


def _moordyn_state(places: Array) -> bytes:
    """MoorDyn's file of a state: two points, which are not free, and the places and velocities of the inner nodes."""
    point = struct.pack("<QQ6d", 1, 6, *[0.0] * 6)
    nodes = np.zeros((len(places) - 2, 6))
    nodes[:, :3] = places[1:-1] - [0.0, 0.0, SUNK + DEPTH]
    data = 2 * point + struct.pack("<QQ", len(nodes), 6) + nodes.astype("<f8").tobytes()
    return b"MoorDyn" + struct.pack("<BBQQ", 2, 7, len(data) // 8 + 1, 3) + data


def _moordyn_input(case: Case, scheme: str, step: float) -> str:
    """The input file; tangential drag refers to pi times the diameter."""
    density, area = LINE["fluid_density"], LINE["area"]
    diameter = math.sqrt(4.0 * area / math.pi)
    normal = LINE["normal_drag"] / (0.5 * density * diameter)
    along = LINE["tangential_drag"] / (0.5 * density * diameter * math.pi)
    added = LINE["added_mass_per_length"] / (density * area)
    rule = "-" * 80
    return f"""MoorDyn input: a line whose top is moved
{rule}
---------------------- LINE TYPES
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(-) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
line {diameter} {LINE["mass_per_length"]} {case.stiffness} {case.damping} 0.0 {normal} {added} {along} 0.0
---------------------- POINTS
Node Type X Y Z M V CdA CA
(-) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Fixed 0 0 {-SUNK - DEPTH} 0 0 0 0
2 Coupled {DEPTH} 0 {-SUNK} 0 0 0 0
---------------------- LINES
Line LineType NodeA NodeB UnstrLen NumSegs Flags/Outputs
(-) (-) (-) (-) (m) (-) (-)
1 line 1 2 {case.segments * case.element} {case.segments} -
---------------------- OPTIONS
0 writeLog
1 disableOutTime
{GRAVITY} g
{density} WtrDnsty
{BOTTOM} WtrDpth
{scheme} tScheme
{step} dtM
---------------------- need this line
"""


def extremes(time: Array, tension: Array) -> Extremes:
    """Of a tension at equal steps of time."""
    recorded = time >= LINE["duration"] - RECORDED_PERIODS * LINE["wave_period"] - 1e-9
    kept = tension[recorded]
    length = max(1, round(AVERAGED / (time[1] - time[0])))
    sums = np.concatenate([[0.0], np.cumsum(kept)])
    return Extremes(kept.max(), kept.min(), np.max(sums[length:] - sums[:-length]) / length)


def moordyn_extremes(case: Case, part: float) -> Extremes:
    run = moordyn_run(case, part)
    return extremes(run.time, np.linalg.norm(run.top, axis=1))


def write_moordyn(path: Path) -> None:
    """MoorDyn's extremes on all meshes, with two steps where both are stable."""
    columns = (
        "linear_stiffness",
        "internal_damping",
        "segments",
        "length_ratio",
        "time_step",
        "max_top_tension",
        "averaged_max_top_tension",
        "min_top_tension",
        "max_anchor_tension",
        "min_anchor_tension",
        "processor_seconds",
    )
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write(SOURCE.format(version=version("moordyn"), practical=PRACTICAL, converged=CONVERGED))
        table = csv.writer(file, lineterminator="\n")
        table.writerow(columns)
        for case in CASES:
            for part in (CONVERGED,) if case.damping else (PRACTICAL, CONVERGED):
                table.writerow(_written(case, moordyn_run(case, part)))
                file.flush()


def _written(case: Case, run: MoorDynRun) -> list[str]:
    top = extremes(run.time, np.linalg.norm(run.top, axis=1))
    anchor = extremes(run.time, np.linalg.norm(run.anchor, axis=1))
    values = (top.highest, top.averaged, top.lowest, anchor.highest, anchor.lowest)
    line = (f"{case.stiffness:g}", f"{case.damping:g}", str(case.segments), f"{length_ratio(case.stiffness):.12g}")
    return [*line, f"{run.time[0]:.6g}", *(f"{value:.8g}" for value in values), f"{run.seconds:.3g}"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("file", type=Path)
    write_moordyn(parser.parse_args().file)


if __name__ == "__main__":
    main()
