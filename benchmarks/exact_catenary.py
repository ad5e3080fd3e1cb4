"""The exact catenary against MoorPy, and against the least that NumPy could need.

A million random lines are solved in one process, every output that is one number. Beside it stand

- MoorPy, one call for each line, on some of the same lines. Its lines are elastic, so it is given a stiff one, and it
  is judged twice: against our elastic line of the same stiffness and against our inextensible line.
- The floor: the hyperbolic functions and logarithms without which no direct evaluation of these outputs can do, and
  nothing else, on the same lines: no divisions, no series for taut lines, no checks.
"""

import argparse

import numpy as np
from measure import Costs, interleaved, markdown, revision

from cablesim import batch
from cablesim.machine import machine
from cablesim.numerics import Array

Lines = dict[str, Array]
Calls = list[tuple[np.ufunc, Array]]

SEED = 20
AXIAL_STIFFNESS = 1e12
PERMITTED_ERROR = 1e-3
BLOCK = 4096
END_TENSIONS = ("horizontal_tension", "tension_A", "tension_B")
NANOSECONDS = 1e-9


def random_lines(number: int) -> Lines:
    """Feasible lines from taut (one part in a million longer than the chord) to slack (twice the chord)."""
    random = np.random.default_rng(SEED)
    span = random.uniform(10.0, 1000.0, number)
    rise = random.uniform(-0.3, 0.3, number) * span
    slack = 10.0 ** random.uniform(-6.0, 0.0, number)
    line_length = np.hypot(span, rise) * (1.0 + slack)
    weight = random.uniform(1.0, 100.0, number)
    return {"span": span, "rise": rise, "line_length": line_length, "weight_per_length": weight}


def some(lines: Lines, number: int) -> Lines:
    """Some of the lines: they are random already, so the first will do."""
    return {name: values[:number] for name, values in lines.items()}


def least_calls(lines: Lines) -> Calls:
    """The functions that a direct evaluation cannot do without, each with the arguments that it would get here."""
    found = batch.solve("catenary_exact", lines, outputs=("catenary_parameter", "vertex_x")).outputs
    half_angle = 0.5 * lines["span"] / found["catenary_parameter"]
    angle_A = -found["vertex_x"] / found["catenary_parameter"]
    angle_B = angle_A + 2.0 * half_angle
    slope = lines["rise"] / lines["span"]
    parallel = np.arcsinh(slope) - angle_A
    excess = np.sinh(half_angle) / half_angle - 1.0
    return [
        (np.log1p, excess),  # the start: half the angle between the supports from log(sinh(x) / x)
        (np.sinh, half_angle),  # one correction of it: the value,
        (np.cosh, half_angle),  # the slope,
        (np.log1p, 1e-3 * excess),  # and the difference of the logarithms
        (np.arcsinh, slope),  # how far the line leans
        (np.cosh, angle_A),  # tension at A
        (np.cosh, angle_B),  # tension at B; the larger is the largest
        (np.arcsinh, 0.1 * slope),  # where the line is parallel to its chord
        (np.sinh, 0.5 * parallel),  # the sag there
    ]


def call_whole(calls: Calls, room: Array) -> None:
    """All calls, one array after the other."""
    for function, argument in calls:
        function(argument, out=room)


def call_in_blocks(calls: Calls, room: Array) -> None:
    """All calls on a block that fits the cache, then on the next block."""
    for first in range(0, room.size, BLOCK):
        rows = slice(first, first + BLOCK)
        for function, argument in calls:
            function(argument[rows], out=room[rows])


def moorpy_tensions(lines: Lines) -> Array:
    """MoorPy's tensions at both ends, shape (2, line); NaN where it gives up."""
    given = {**lines, "axial_stiffness": AXIAL_STIFFNESS}
    found = batch.solve("moorpy_catenary", given, outputs=("tension_A", "tension_B")).outputs
    return np.array(list(found.values()))


def verdict(lines: Lines) -> str:
    """How often MoorPy fails or is wrong, in a sentence."""
    theirs = moorpy_tensions(lines)
    stiff = {**lines, "axial_stiffness": np.full_like(lines["span"], AXIAL_STIFFNESS)}
    failed = ~np.isfinite(theirs).all(axis=0)
    off = [wrong(theirs, "catenary_elastic", stiff) & ~failed, wrong(theirs, "catenary_exact", lines) & ~failed]
    return (
        f"Of {failed.size} lines MoorPy, with its default tolerance, fails on {failed.sum()}. Of the others, it is off "
        f"by more than {100 * PERMITTED_ERROR:g} % in an end tension on {off[0].sum()} against our elastic line of the "
        f"same stiffness (EA = {AXIAL_STIFFNESS:g} N), on {off[1].sum()} against our inextensible line."
    )


def wrong(tensions: Array, solver: str, lines: Lines) -> np.ndarray:
    """Where a tension differs from ours by more than is permitted."""
    ours = batch.solve(solver, lines, outputs=("tension_A", "tension_B")).outputs
    return (np.abs(tensions / np.array(list(ours.values())) - 1.0) > PERMITTED_ERROR).any(axis=0)


def run(number: int, compared: int, repeats: int) -> dict[str, Costs]:
    """All measurements, in turns."""
    lines, calls = random_lines(number), least_calls(random_lines(number))
    few, room = some(lines, compared), np.empty(number)
    return interleaved(
        {
            "all": lambda: batch.solve("catenary_exact", lines),
            "whole": lambda: call_whole(calls, room),
            "blocks": lambda: call_in_blocks(calls, room),
            "few": lambda: batch.solve("catenary_exact", few, outputs=END_TENSIONS),
            "moorpy": lambda: moorpy_tensions(few),
        },
        repeats,
    )


def report(costs: dict[str, Costs], number: int, compared: int) -> str:
    """The table of what was measured. Ratios are of processor time, because others may be using the machine."""
    labels = {
        "all": (f"catenary_exact, {number} lines, all scalar outputs", number),
        "whole": (f"floor, whole arrays of {number}", number),
        "blocks": (f"floor, blocks of {BLOCK}", number),
        "few": (f"catenary_exact, {compared} lines, end tensions", compared),
        "moorpy": (f"MoorPy, {compared} lines, end tensions", compared),
    }
    each = {name: costs[name].cpu / lines for name, (_, lines) in labels.items()}
    floor = min(each["whole"], each["blocks"])
    rows = [
        (
            label,
            costs[name].spread(NANOSECONDS * lines),
            f"{each[name] / NANOSECONDS:.3g}",
            f"{each[name] / floor:.3g}",
            f"{each['moorpy'] / each[name]:.3g}",
        )
        for name, (label, lines) in labels.items()
    ]
    head = ("", "ns per line: median (min .. max)", "processor ns", "times the floor", "times faster than MoorPy")
    return markdown(head, rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--lines", type=int, default=1_000_000)
    parser.add_argument("--compared", type=int, default=2000, help="lines that MoorPy solves too")
    parser.add_argument("--repeats", type=int, default=7)
    given = parser.parse_args()
    costs = run(given.lines, given.compared, given.repeats)
    print(machine("numpy", "moorpy"), f"revision {revision()}, {given.repeats} repeats in turns", sep="; ", end="\n\n")
    print(report(costs, given.lines, given.compared))
    print("\n" + verdict(some(random_lines(given.lines), given.compared)))


if __name__ == "__main__":
    main()
