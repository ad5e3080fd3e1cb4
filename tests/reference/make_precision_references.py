"""Write the tables that scenes of error against run time are measured against, correct to 17 digits.

    python tests/reference/make_precision_references.py

The formulas are those of the other references, independent of cablesim; inputs are float64 numbers as printed. Hanging
lines are those of overhead spans, 1e-4 to 2e-2 longer than they span, of a stiffness that leaves next to no stretch;
tow lines are wire and chain between ships, 1e-4 to 0.2 of their length nearer than it.
Needs mpmath. The same seed gives the same bytes.
"""

import csv
from collections.abc import Iterable, Iterator
from pathlib import Path

import make_catenary_references as catenary
import make_composite_references as composite
import mpmath as mp
import numpy as np

TABLES = Path(__file__).parents[2] / "config" / "scenes" / "tables"
SEED = 20266
PRINTED_DIGITS = 17
# Lines of each table: few where another program takes a tenth of a second for one.
HANGING, TOWED, PULLED = 1000, 24, 300
# Of the length of a tow line, by which its ends are nearer.
LEAST_SLACK, MOST_SLACK = 1e-4, 0.2

HANGING_SOURCE = """\
# Largest tension of elastic lines between level supports 100 m apart, 10 N/m, EA = 1e15 N; SI. Lengths exactly as
# printed, tensions to 17 digits, made by tests/reference/make_precision_references.py with mpmath: the equations of
# Irvine (Cable Structures, 1981, section 2.2).
"""
TOWED_SOURCE = """\
# Tow lines of wire (section 1, from the ship at A) and chain; SI. Inputs exactly as printed, {answer} to 17
# digits, made by tests/reference/make_precision_references.py with mpmath: catenaries in series (M8).
"""


def main() -> None:
    write("precision_hanging.csv", HANGING_SOURCE, hanging_rows())
    write("precision_towline.csv", TOWED_SOURCE.format(answer="tension"), map(tension_row, towed_lines(TOWED)))
    write("precision_pulled.csv", TOWED_SOURCE.format(answer="distance"), map(distance_row, towed_lines(PULLED)))


def hanging_rows() -> Iterator[dict[str, str]]:
    mp.mp.dps = catenary.WORKING_DIGITS
    fixed = {"span": 100.0, "rise": 0.0, "weight_per_length": 10.0, "axial_stiffness": 1e15}
    for slack in np.geomspace(1e-4, 2e-2, HANGING):
        length = float(fixed["span"] * (1.0 + slack))
        answer = catenary.elastic_answer(fixed | {"line_length": length})
        yield {"line_length": repr(length), "max_tension": printed(answer["max_tension"])}


def towed_lines(number: int) -> Iterator[composite.Line]:
    rng = np.random.default_rng(SEED)
    for slack in np.geomspace(LEAST_SLACK, MOST_SLACK, number):
        lengths = (float(rng.uniform(200.0, 800.0)), float(rng.uniform(20.0, 100.0)))
        weights = (float(rng.uniform(60.0, 120.0)), float(rng.uniform(400.0, 900.0)))
        yield composite.Line("tow", lengths, weights, 0.0, distance=float(sum(lengths) * (1.0 - slack)))


def tension_row(line: composite.Line) -> dict[str, str]:
    """The distance is given."""
    return sections(line) | {
        "horizontal_distance": repr(line.distance),
        "max_tension": printed(max(solved(line).tensions)),
    }


def distance_row(line: composite.Line) -> dict[str, str]:
    """The horizontal tension is given, rounded to a float."""
    tension = float(solved(line).H)
    pulled = composite.Line("tow", line.lengths, line.weights, line.rise, tension=tension)
    return sections(line) | {"horizontal_tension": repr(tension), "horizontal_distance": printed(solved(pulled).x[-1])}


def solved(line: composite.Line) -> composite.Shape:
    mp.mp.dps = composite.WORKING_DIGITS
    shape = composite.solve(line)
    composite.check(line, shape)
    return shape


def sections(line: composite.Line) -> dict[str, str]:
    names = ("section_length_1", "section_length_2", "section_weight_1", "section_weight_2")
    return dict(zip(names, map(repr, (*line.lengths, *line.weights)), strict=True))


def printed(value: mp.mpf) -> str:
    return mp.nstr(value, PRINTED_DIGITS)


def write(name: str, source: str, rows: Iterable[dict[str, str]]) -> None:
    rows = list(rows)
    with (TABLES / name).open("w", encoding="utf-8", newline="") as file:
        file.write(source)
        table = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(rows)


if __name__ == "__main__":
    main()
