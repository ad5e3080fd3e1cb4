"""Pode's functions and lines between two points in a stream, against SciPy, MoorPy and MoorDyn.

- Pode's functions at random angles, all four at once, against `solve_ivp`; errors of both against 30 digits.
- Random lines between two points, against `solve_ivp` inside `fsolve`, and, among heavy lines neither very slack nor
  very taut, against MoorPy and MoorDyn. Errors are against ours at a tight tolerance, itself checked by `solve_ivp`.
- The first call in a process, which compiles the kernels or loads the compiled ones.
"""

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable

import numpy as np
from measure import Costs, interleaved, markdown, revision
from scipy.integrate import solve_ivp
from stream_peers import Line, moordyn, moordyn_line, moorpy_line, pode_functions, pode_reference, shooting

from cablesim import batch
from cablesim.machine import machine
from cablesim.numerics import Array
from cablesim.peers._each import silenced
from cablesim.peers.ivp_line import line_slope
from cablesim.physics.stream import FRICTION_LAWS

Lines = dict[str, Array]

SEED = 21
MICRO, MILLI = 1e-6, 1e-3
# Pode's functions come no nearer to the singular angles than this.
MARGIN = 1e-3
LADDER = (1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 3e-14)
COMMON = 1e-10
FOUR = ("tau", "sigma", "xi", "eta")
LAW = {"friction_law": "constant"}
# What MoorPy and MoorDyn assume.
THEIR_LAW = {"friction_law": "cosine_squared"}
TOLERANCE, TIGHT = 1e-6, 1e-13
# Ours converges to its rtol in position and force, and a taut line's tension is more sensitive than that: with the
# second of these its worst error on the compared lines is below that of shooting to 1e-6.
OURS = {f"rtol {rtol:g}": {"rtol": rtol} for rtol in (TOLERANCE, 1e-8, 1e-10)} | {"default": {}}
LOOSE, AS_ACCURATE = list(OURS)[:2]
ENDS = ("force_A", "force_B")
# A peer's line that joins the ends, but with tensions this far from ours, is another solution or none.
ANOTHER = 1e-3

FIRST_CALL = """
from time import perf_counter
start = perf_counter()
from cablesim.batch import solve
imported = perf_counter()
arguments = {arguments}
solve(*arguments)
called = perf_counter()
solve(*arguments)
print(imported - start, called - imported, perf_counter() - called)
"""
ONE_ANGLE = {"angle": 1.0, "critical_angle": 0.5, "friction_ratio": 0.025, "reference_angle": np.pi, **LAW}
ONE_LINE = {
    "position_B": [[60.0, 20.0, 40.0]],
    "line_length": 100.0,
    "weight_per_length": 20.0,
    "diameter": 0.02,
    "normal_drag_coefficient": 1.2,
    "tangential_drag_coefficient": 0.03,
    "fluid_density": 1025.0,
    "stream_speed": 1.5,
    **LAW,
}


def random_angles(number: int) -> Lines:
    """Arguments of Pode's functions: all of the domain, but for a margin."""
    random = np.random.default_rng(SEED)
    critical = np.radians(random.uniform(5.0, 85.0, number))
    return {
        "angle": random.uniform(critical + MARGIN, np.pi + critical - MARGIN),
        "critical_angle": critical,
        "friction_ratio": random.uniform(0.0, 0.05, number),
    }


def random_lines(number: int, heavy: bool = False) -> Lines:
    """Feasible lines of any direction; the heavy ones are what MoorPy and MoorDyn are made for."""
    random = np.random.default_rng(SEED + heavy)
    direction = random.normal(size=(number, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    length = random.uniform(100.0, 1000.0, number)
    chord = length * random.uniform(*((0.5, 0.95) if heavy else (0.05, 0.999)), number)
    return {
        "position_B": chord[:, None] * direction,
        "line_length": length,
        "weight_per_length": random.uniform(*((50.0, 200.0) if heavy else (-20.0, 200.0)), number),
        "diameter": random.uniform(0.01, 0.05, number),
        "normal_drag_coefficient": np.full(number, 1.2),
        "tangential_drag_coefficient": np.full(number, 0.03),
        "fluid_density": np.full(number, 1025.0),
        "stream_speed": random.uniform(0.1, 2.0 if heavy else 5.0, number),
    }


def some(many: Lines, number: int) -> Lines:
    """Some of them: they are random already, so the first will do."""
    return {name: values[:number] for name, values in many.items()}


def one_by_one(lines: Lines, law: dict[str, str]) -> list[Line]:
    """The same, one dictionary a line, as the peers take them."""
    count = len(lines["line_length"])
    return [{name: values[row] for name, values in lines.items()} | law for row in range(count)]


# Pode's functions


def ours_of(angles: Lines) -> Array:
    """tau, sigma, xi, eta, shape (angle, 4)."""
    found = batch.solve("pode_functions", {**angles, **LAW, "reference_angle": np.pi}, outputs=FOUR)
    return np.column_stack([found.outputs[name] for name in FOUR])


def theirs_of(angles: Lines, rtol: float) -> Array:
    """The same by `solve_ivp`."""
    return np.array([pode_functions(*case, rtol) for case in _cases(angles)])


def _cases(angles: Lines) -> list[tuple[float, ...]]:
    return list(zip(*(values.tolist() for values in angles.values()), strict=True))


def pode_errors(found: Array, reference: Array) -> tuple[float, float]:
    """Median and worst error: tau and sigma relative to themselves, xi and eta to the length of line, sigma."""
    size = np.abs(np.column_stack([reference[:, 0], *[reference[:, 1]] * 3]))
    error = (np.abs(found - reference) / size).max(axis=1)
    return float(np.median(error)), float(error.max())


def pode_table(number: int, compared: int, checked: int, repeats: int) -> str:
    """Cost and error of ours and of `solve_ivp`, with about our median or worst error and with a common tolerance."""
    angles = random_angles(number)
    few, judged = some(angles, compared), some(angles, checked)
    reference = np.array([pode_reference(*case) for case in _cases(judged)])
    errors = {"ours": pode_errors(ours_of(judged), reference)}
    for rtol in LADDER:
        errors[f"{rtol:g}"] = pode_errors(theirs_of(judged, rtol), reference)
    notes = {COMMON: ""}
    for which, word in enumerate(("median", "worst")):
        rtol = _as_accurate(errors, which)
        notes[rtol] = f"{notes.get(rtol, '')}, our {word} error"
    costs = interleaved(
        {
            "ours": lambda: ours_of(angles),
            **{f"{rtol:g}": lambda rtol=rtol: theirs_of(few, rtol) for rtol in notes},
        },
        repeats,
    )
    labels = {"ours": (f"pode_functions, {number} angles", number)}
    for rtol in sorted(notes):
        labels[f"{rtol:g}"] = (f"solve_ivp, DOP853, rtol {rtol:g}{notes[rtol]}, {compared} angles", compared)
    rows = [
        (
            label,
            costs[name].spread(MICRO * count),
            f"{costs[name].cpu / count / MICRO:.3g}",
            f"{errors[name][0]:.1e}",
            f"{errors[name][1]:.1e}",
            f"{costs[name].cpu / count * number / costs['ours'].cpu:.3g}",
        )
        for name, (label, count) in labels.items()
    ]
    head = ("", "µs: median (min .. max)", "processor µs", "median error", "worst error", "times our processor time")
    return markdown(head, rows)


def _as_accurate(errors: dict[str, tuple[float, float]], which: int) -> float:
    """The loosest tolerance of `solve_ivp` with an error not above ours; if there is none, the tightest."""
    return next((rtol for rtol in LADDER if errors[f"{rtol:g}"][which] <= errors["ours"][which]), LADDER[-1])


# Lines between two points


def solved(lines: Lines, law: dict[str, str], options: dict[str, float]) -> tuple[Array, np.ndarray]:
    """Our forces at both ends, shape (line, 2, 3), and the status."""
    found = batch.solve("stream_line", {**lines, **law}, options, outputs=ENDS)
    return np.stack([found.outputs[name] for name in ENDS], axis=1), found.status


def tensions(forces: Array) -> Array:
    return np.linalg.norm(forces, axis=2)


def tension_errors(found: Array, reference: Array) -> Array:
    """The larger error of the two end tensions of each line, relative to the larger tension."""
    return np.abs(found - reference).max(axis=1) / reference.max(axis=1)


def end_gap(lines: Lines, forces: Array) -> float:
    """How far from B, in lengths, `solve_ivp` ends at the worst when it starts with our force at A."""
    gaps = []
    for line, force in zip(one_by_one(lines, LAW), forces[:, 0], strict=True):
        start = np.concatenate([np.zeros(3), force])
        size = np.repeat([line["line_length"], np.linalg.norm(force)], 3)
        slope = line_slope(line | {"friction_law": FRICTION_LAWS.index(line["friction_law"])})
        last = solve_ivp(slope, (0.0, line["line_length"]), start, "DOP853", rtol=1e-13, atol=1e-13 * size).y[:3, -1]
        gaps.append(np.linalg.norm(last - line["position_B"]) / line["line_length"])
    return max(gaps)


def each(action: Callable[[Line], Array], lines: list[Line]) -> Array:
    """One call for each line."""
    with silenced():
        return np.array([action(line) for line in lines])


def line_report(number: int, compared: int, repeats: int, moorpy_lines: int, moordyn_lines: int) -> str:
    """Cost, failures and error of all, and what was checked."""
    lines, heavy = random_lines(number), random_lines(moorpy_lines, heavy=True)
    few = some(lines, compared)
    singles, heavies = one_by_one(few, LAW), one_by_one(heavy, THEIR_LAW)
    answers: dict[str, Array] = {}

    def ours(name: str, options: dict[str, float]) -> None:
        answers[name] = tensions(solved(lines, LAW, options)[0])

    def theirs(name: str, action: Callable[[Line], Array], cases: list[Line]) -> None:
        answers[name] = each(action, cases)

    actions = {
        **{name: lambda name=name, options=options: ours(name, options) for name, options in OURS.items()},
        "shooting": lambda: theirs("shooting", lambda line: tensions(shooting(line, TOLERANCE)[None])[0], singles),
        "moorpy": lambda: theirs("moorpy", moorpy_line, heavies),
    }
    labels = {
        **{name: (f"stream_line, {name}, {number} lines", number) for name in OURS},
        "shooting": (f"solve_ivp in fsolve, {TOLERANCE:g}, {compared} lines", compared),
        "moorpy": (f"MoorPy, {moorpy_lines} heavy lines", moorpy_lines),
    }
    if moordyn:
        actions["moordyn"] = lambda: theirs("moordyn", moordyn_line, heavies[:moordyn_lines])
        labels["moordyn"] = (f"MoorDyn, {moordyn_lines} heavy lines", moordyn_lines)
    costs = interleaved(actions, repeats)

    tight, status = solved(lines, LAW, {"rtol": TIGHT})
    exact = {name: tensions(tight) for name in OURS} | {"shooting": tensions(tight[:compared])}
    exact["moorpy"] = tensions(solved(heavy, THEIR_LAW, {"rtol": TIGHT})[0])
    exact["moordyn"] = exact["moorpy"][:moordyn_lines]
    errors = {name: tension_errors(found, exact[name]) for name, found in answers.items()}
    ours_there = {name: np.max(errors[name][:compared]) for name in (LOOSE, AS_ACCURATE)}
    sentences = [
        _checked(few, tight[:compared], status, number),
        f"On the lines that fsolve takes too, the worst error of ours is {ours_there[LOOSE]:.1e} with {LOOSE}, "
        f"{ours_there[AS_ACCURATE]:.1e} with {AS_ACCURATE}. Of those that fsolve claims to have solved, "
        f"{np.count_nonzero(errors['shooting'] > ANOTHER)} differ from ours by more than {ANOTHER:g} in a tension.",
    ]
    if not moordyn:
        sentences.append("MoorDyn is not installed here, so it was left out (`pip install moordyn`).")
    failed = {name: int(np.isnan(found).any(axis=1).sum()) for name, found in answers.items()}
    return "\n\n".join([_line_table(costs, labels, failed, errors), *sentences])


def _checked(few: Lines, forces: Array, status: np.ndarray, number: int) -> str:
    """How the reference stands up to an independent integration, in a sentence."""
    ok = status[: len(forces)] == 0
    gap = end_gap({name: values[ok] for name, values in few.items()}, forces[ok])
    return (
        f"At rtol {TIGHT:g} ours flags {np.count_nonzero(status)} of {number} lines; from its force at A, `solve_ivp` "
        f"(DOP853, rtol 1e-13) ends within {gap:.1e} lengths of B on {ok.sum()} of the first {ok.size} lines."
    )


def _line_table(
    costs: dict[str, Costs], labels: dict[str, tuple[str, int]], failed: dict[str, int], errors: dict[str, Array]
) -> str:
    def row(name: str, label: str, count: int) -> tuple[str, ...]:
        good = errors[name][np.isfinite(errors[name])]
        ratio = costs[name].cpu / count / (costs[AS_ACCURATE].cpu / labels[AS_ACCURATE][1])
        cost = (costs[name].spread(MILLI * count), f"{costs[name].cpu / count / MILLI:.3g}")
        worst = tuple(f"{np.quantile(good, part):.1e}" for part in (0.5, 0.99, 1.0)) if good.size else ("",) * 3
        return (label, *cost, str(failed[name]), *worst, f"{ratio:.3g}")

    head = ("", "ms per line: median (min .. max)", "processor ms", "failed", "median error", "99 %", "worst")
    return markdown((*head, f"times {AS_ACCURATE}"), [row(name, *labels[name]) for name in labels])


# First calls


def first_call_table(repeats: int) -> str:
    """What the first call in a fresh process costs, with an empty cache of compiled kernels and with a filled one."""
    rows = []
    for solver, one, options in (("pode_functions", ONE_ANGLE, {}), ("stream_line", ONE_LINE, {"rtol": TOLERANCE})):
        with tempfile.TemporaryDirectory() as cache:
            cold = first_call(solver, one, options, cache)
            warm = [first_call(solver, one, options, cache) for _ in range(repeats)]
        imported, called, again = (statistics.median(times) for times in zip(*warm, strict=True))
        rows.append((solver, f"{imported:.3g}", f"{cold[1]:.3g}", f"{called:.3g}", f"{again / MILLI:.3g}"))
    head = ("", "import of cablesim.batch s", "first call, compiling s", "first call, loading s", "second call ms")
    return markdown(head, rows)


def first_call(solver: str, one: dict[str, object], options: dict[str, float], cache: str) -> list[float]:
    """Seconds of the import, of the first and of the second call of one scenario in a new process."""
    code = FIRST_CALL.format(arguments=repr((solver, one, options)))
    environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
    return [float(word) for word in done.stdout.split()]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--angles", type=int, default=100_000)
    parser.add_argument("--compared-angles", type=int, default=300, help="angles that solve_ivp takes too")
    parser.add_argument("--checked-angles", type=int, default=40, help="angles that are also found in 30 digits")
    parser.add_argument("--lines", type=int, default=10_000)
    parser.add_argument("--compared-lines", type=int, default=100, help="lines that fsolve takes too")
    parser.add_argument("--moorpy-lines", type=int, default=30)
    parser.add_argument("--moordyn-lines", type=int, default=5)
    parser.add_argument("--repeats", type=int, default=3)
    given = parser.parse_args()
    packages = ("numpy", "numba", "scipy", "moorpy", *(("moordyn",) if moordyn else ()))
    print(machine(*packages), f"revision {revision()}, {given.repeats} repeats in turns", sep="; ", end="\n\n")
    print(pode_table(given.angles, given.compared_angles, given.checked_angles, given.repeats), end="\n\n")
    print(line_report(given.lines, given.compared_lines, given.repeats, given.moorpy_lines, given.moordyn_lines))
    print("\n" + first_call_table(given.repeats))


if __name__ == "__main__":
    main()
