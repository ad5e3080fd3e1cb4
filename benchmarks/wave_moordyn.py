"""Lines whose top is moved in still water, by MoorDyn: a peer, and a table of its results for the tests.

    python benchmarks/wave_moordyn.py tests/reference/wave_moordyn.csv

The line is 283 m long from an anchor 200 m deep, its chord at 45 deg, the static tension at its top 40 kN; the top
moves by 1.57 m to either side, horizontally, with a period of 5.6 s and a smooth start of two periods, through 60 s.

What MoorDyn does differently, and what its end forces lack, is said by its adapter, `cablesim/peers/moordyn_line.py`.

With EA = 1e8 N the line is jerked taut, and what rings then is as short as the elements and undamped. Its share of a
peak is a matter of the step, not of the physics, so that peaks of the force's mean over 0.1 s are given as well, and
those of the line with internal damping, a two-thousandth of a second of EA.
"""

import argparse
import csv
import math
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from measure import measure
from scipy.optimize import brentq

from cablesim import batch
from cablesim.numerics import Array
from cablesim.peers._each import is_there
from cablesim.peers.moordyn_line import Forces, run, stable_step
from cablesim.solver import load_solver

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
SCHEME = "RK4"
SNAPPING = 1e8
# Parts of the longest stable step that are run: the largest is stable and damps the shortest waves, the smallest is
# converged where the line does not snap.
PRACTICAL, CONVERGED = 0.95, 0.2
HAS_MOORDYN = is_there("moordyn")

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
    """Forces on both ends after each step, and what the run cost."""

    forces: Forces
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
    return stable_step(load_solver("moordyn_line").make_parameters(case.line), case.segments)


# MoorDyn


def moordyn_run(case: Case, part: float) -> MoorDynRun:
    """MoorDyn's forces, with steps that are a part of the largest."""
    solver = load_solver("moordyn_line")
    options = solver.make_options({"segments": case.segments, "step_share": part})
    runs: list[Forces] = []
    cost = measure(lambda: runs.append(run(solver.make_parameters(case.line), options)))
    return MoorDynRun(runs[0], cost.cpu)


def extremes(time: Array, tension: Array) -> Extremes:
    """Of a tension at equal steps of time."""
    recorded = time >= LINE["duration"] - RECORDED_PERIODS * LINE["wave_period"] - 1e-9
    kept = tension[recorded]
    length = max(1, round(AVERAGED / (time[1] - time[0])))
    sums = np.concatenate([[0.0], np.cumsum(kept)])
    return Extremes(kept.max(), kept.min(), np.max(sums[length:] - sums[:-length]) / length)


def moordyn_extremes(case: Case, part: float) -> Extremes:
    forces = moordyn_run(case, part).forces
    return extremes(forces.time, np.linalg.norm(forces.top, axis=1))


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


def _written(case: Case, found: MoorDynRun) -> list[str]:
    forces = found.forces
    top = extremes(forces.time, np.linalg.norm(forces.top, axis=1))
    anchor = extremes(forces.time, np.linalg.norm(forces.anchor, axis=1))
    values = (top.highest, top.averaged, top.lowest, anchor.highest, anchor.lowest)
    line = (f"{case.stiffness:g}", f"{case.damping:g}", str(case.segments), f"{length_ratio(case.stiffness):.12g}")
    return [*line, f"{forces.time[0]:.6g}", *(f"{value:.8g}" for value in values), f"{found.seconds:.3g}"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("file", type=Path)
    write_moordyn(parser.parse_args().file)


if __name__ == "__main__":
    main()
