"""Composite tow lines against MoorPy and SciPy.

Random lines of two sections, wire and chain, with the horizontal distance given or the horizontal tension, and lines of
twenty sections are solved in one process. Beside it stand, for some of the same lines and one at a time, MoorPy's
`Subsystem`, and SciPy's `fsolve` and `brentq` on the same closed equations. Their errors are against ours, and ours
against 30 digits.
"""

import argparse
import math
from collections.abc import Callable
from dataclasses import dataclass
from time import process_time

import numpy as np
from composite_peers import Line, by_brentq, by_fsolve, by_moorpy, in_digits
from exact_catenary import Lines, some
from measure import Costs, interleaved, markdown, measure, revision

from cablesim import batch
from cablesim.machine import machine
from cablesim.numerics import Array
from cablesim.peers._each import silenced
from cablesim.peers.fsolve_composite import in_arrays, in_floats
from cablesim.peers.moorpy_composite import subsystem

SEED = 22
MICRO, MILLI = 1e-6, 1e-3
END_TENSIONS = ("tension_A", "tension_B")
PERMITTED_ERROR = 1e-3
# MoorPy's tolerance in metres: its own, and one with which the lines that it solves are within the permitted error.
THEIR_OWN, TIGHT = 0.0, 1e-6
ALL, ENDS = "all outputs", "end tensions"


@dataclass(frozen=True)
class Peer:
    """Another way to the end tensions: its name, the lines that it takes, how it solves one of them."""

    name: str
    lines: list[Line]
    solve: Callable[[Line], Array]


@dataclass(frozen=True)
class Answer:
    """End tensions of a peer's lines, shape (line, 2), and the processor seconds that each took."""

    tensions: Array
    seconds: Array


@dataclass(frozen=True)
class Findings:
    """What was measured on lines of one kind: what each call cost, and ours and the peers' end tensions."""

    costs: dict[str, Costs]
    ours: Array
    reference: Array
    answers: dict[str, Answer]


def random_lines(number: int, sections: int = 2) -> Lines:
    """Wire and chain, or many sections with weights from the one's to the other's; from taut to slack."""
    random = np.random.default_rng(SEED + sections)
    if sections == 2:
        length = np.column_stack([random.uniform(100.0, 1000.0, number), random.uniform(20.0, 150.0, number)])
        weight = np.column_stack([random.uniform(60.0, 120.0, number), random.uniform(400.0, 900.0, number)])
    else:
        length = random.uniform(5.0, 50.0, (number, sections))
        weight = np.exp(random.uniform(math.log(60.0), math.log(900.0), (number, sections)))
    total = length.sum(axis=1)
    rise = random.uniform(-0.05, 0.05, number) * total
    chord = total * (1.0 - 10.0 ** random.uniform(-5.0, math.log10(0.2), number))
    distance = np.sqrt((chord - rise) * (chord + rise))
    return {"section_length": length, "section_weight": weight, "rise": rise, "horizontal_distance": distance}


def with_tension(lines: Lines) -> Lines:
    """The same lines, their horizontal tension given instead of the distance."""
    found = batch.solve("composite_line", lines, outputs=("horizontal_tension",)).outputs
    return {name: values for name, values in lines.items() if name != "horizontal_distance"} | found


def one_by_one(lines: Lines) -> list[Line]:
    """The same, one dictionary a line."""
    return [{name: values[row] for name, values in lines.items()} for row in range(len(lines["rise"]))]


def in_plain_floats(lines: list[Line]) -> list[Line]:
    """The same in lists and floats, with which Python is faster than with small arrays."""
    return [{name: value.tolist() for name, value in line.items()} for line in lines]


def end_tensions(lines: Lines) -> Array:
    """Ours, shape (line, 2)."""
    found = batch.solve("composite_line", lines, outputs=END_TENSIONS).outputs
    return np.column_stack([found[name] for name in END_TENSIONS])


def distance_peers(lines: Lines, compared: int, moorpy_lines: int = 0) -> list[Peer]:
    """All that solve lines whose distance is given."""
    arrays = one_by_one(some(lines, compared))
    floats = in_plain_floats(arrays)
    heavy = in_plain_floats(one_by_one(some(lines, moorpy_lines)))
    peers = [
        Peer("fsolve, floats", floats, lambda line: by_fsolve(line, in_floats)),
        Peer("fsolve, NumPy", arrays, lambda line: by_fsolve(line, in_arrays)),
        Peer("MoorPy, its tolerance", heavy, lambda line: by_moorpy(line, THEIR_OWN)),
        Peer(f"MoorPy, {TIGHT:g} m", heavy, lambda line: by_moorpy(line, TIGHT)),
    ]
    return [peer for peer in peers if peer.lines]


def tension_peers(lines: Lines, compared: int) -> list[Peer]:
    """All that solve lines whose horizontal tension is given."""
    return [Peer("brentq, floats", in_plain_floats(one_by_one(some(lines, compared))), by_brentq)]


def run(lines: Lines, peers: list[Peer], checked: int, repeats: int) -> Findings:
    """Ours and the peers, in turns."""
    answers: dict[str, Answer] = {}

    def ask(peer: Peer) -> None:
        answers[peer.name] = each(peer)

    ours = end_tensions(lines)
    costs = interleaved(
        {
            ALL: lambda: batch.solve("composite_line", lines),
            ENDS: lambda: end_tensions(lines),
            **{peer.name: lambda peer=peer: ask(peer) for peer in peers},
        },
        repeats,
    )
    singles = in_plain_floats(one_by_one(some(lines, checked)))
    reference = np.array([in_digits(line, near) for line, near in zip(singles, ours, strict=False)])
    return Findings(costs, ours, reference, answers)


def each(peer: Peer) -> Answer:
    """One call for each line."""
    found, seconds = [], []
    with silenced():
        for line in peer.lines:
            start = process_time()
            found.append(peer.solve(line))
            seconds.append(process_time() - start)
    return Answer(np.array(found), np.array(seconds))


def errors(found: Array, reference: Array) -> Array:
    """The larger relative error of the two end tensions of each line."""
    return np.abs(found / reference - 1.0).max(axis=1)


def rows(title: str, found: Findings) -> list[tuple[str, ...]]:
    """The rows of a table: ours, whose errors are those of the lines in the reference, and the peers."""
    number = len(found.ours)
    unit = found.costs[ENDS].cpu / number

    def row(name: str, tensions: Array, reference: Array) -> tuple[str, ...]:
        cost, count, failed = found.costs[name], len(tensions), np.isnan(tensions).any(axis=1)
        error = errors(tensions[: len(reference)], reference)
        error = error[~np.isnan(error)]
        return (
            f"{title}: {name}, {count} lines",
            cost.spread(MICRO * count),
            f"{cost.cpu / count / MICRO:.3g}",
            f"{cost.cpu / count / unit:.3g}",
            str(np.count_nonzero(failed)),
            str(np.count_nonzero(error > PERMITTED_ERROR)),
            *(f"{np.quantile(error, part):.1e}" for part in (0.5, 1.0)),
        )

    ours = [row(name, found.ours, found.reference) for name in (ALL, ENDS)]
    return ours + [
        row(name, theirs.tensions, found.ours[: len(theirs.tensions)]) for name, theirs in found.answers.items()
    ]


def moorpy_sentence(found: Findings, peers: list[Peer]) -> str:
    """What MoorPy's time is made of: lines that it solves, lines on which it fails, construction."""
    unit, sentences = found.costs[ALL].cpu / len(found.ours), []
    theirs = [peer for peer in peers if peer.name.startswith("MoorPy")]
    for peer in theirs:
        answer = found.answers[peer.name]
        solved = np.mean(answer.seconds[~np.isnan(answer.tensions).any(axis=1)])
        sentences.append(
            f"{peer.name}: the median line takes {np.median(answer.seconds) / MILLI:.3g} ms, those that it solves "
            f"{solved / MILLI:.3g} ms on average, {solved / unit:.3g} times ours with all outputs."
        )
    built = measure(lambda: [subsystem(line) for line in theirs[0].lines]).cpu / len(theirs[0].lines)
    return " ".join([*sentences, f"Construction is {built / MILLI:.2g} ms of it."])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--lines", type=int, default=100_000)
    parser.add_argument("--long-lines", type=int, default=10_000, help="lines of twenty sections")
    parser.add_argument("--compared", type=int, default=2000, help="lines that SciPy takes too")
    parser.add_argument("--moorpy-lines", type=int, default=150)
    parser.add_argument("--checked", type=int, default=50, help="lines that are also found in 30 digits")
    parser.add_argument("--repeats", type=int, default=3)
    given = parser.parse_args()
    wire_and_chain, long = random_lines(given.lines), random_lines(given.long_lines, sections=20)
    pulled = with_tension(wire_and_chain)
    peers = distance_peers(wire_and_chain, given.compared, given.moorpy_lines)
    found = run(wire_and_chain, peers, given.checked, given.repeats)
    table = rows("2 sections", found)
    kinds = {
        "2 sections, H given": (pulled, tension_peers(pulled, given.compared)),
        "20 sections": (long, distance_peers(long, given.compared)),
    }
    for title, (lines, others) in kinds.items():
        table += rows(title, run(lines, others, given.checked, given.repeats))
    head = ("", "µs per line: median (min .. max)", "processor µs", f"times ours, {ENDS}", "failed")
    off = f"off by > {100 * PERMITTED_ERROR:g} %"
    packages = machine("numpy", "numba", "scipy", "moorpy")
    print(packages, f"revision {revision()}, {given.repeats} repeats in turns", sep="; ", end="\n\n")
    print(markdown((*head, off, "median error", "worst error"), table))
    print("\n" + moorpy_sentence(found, peers))


if __name__ == "__main__":
    main()
