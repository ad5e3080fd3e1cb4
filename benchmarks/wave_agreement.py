"""Random lines in waves by every integrator: how far the largest tensions are from those of `rk4`.

    python -m benchmarks.wave_agreement [--each 200] [--seed 3] [--rtol 1e-3]

So many lines that stay taut and so many that go slack, of 4 to 12 elements and with lumped mass, from the box of
`stiff_extremes`. A method that needs more than its number of steps is counted and left out.
"""

import argparse
from collections import Counter, defaultdict

import numpy as np

from benchmarks.wave_check import PEAKS, Row, difference
from cablesim.batch import solve
from cablesim.hunt._wave_lines import random_scenarios, scenario
from cablesim.status import Status

TRUE = "rk4"
# Most steps of each method, and what limits its order.
METHODS = {
    "rk4": (400_000, {}),
    "leapfrog": (400_000, {}),
    "generalized_alpha": (200_000, {}),
    "gear": (8_000, {"max_order": 2}),
    "adams": (4_000, {"max_order": 2}),
}
MOST_SEGMENTS = 12


def main() -> None:
    words = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    words.add_argument("--each", type=int, default=200)
    words.add_argument("--seed", type=int, default=3)
    words.add_argument("--rtol", type=float, default=1e-3)
    given = words.parse_args()
    line, options = random_scenarios(20 * given.each, given.seed)
    rows: dict[bool, list[Row]] = {False: [], True: []}
    left_out = 0
    for i in np.flatnonzero(options["segments"] <= MOST_SEGMENTS):
        true = solve_by(TRUE, line, options, i, 0.1 * given.rtol)
        if true["status"] != "ok":
            left_out += 1
            continue
        kept = rows[true["slack_fraction"] > 0.0]
        if len(kept) < given.each:
            kept.append(
                {"i": i, TRUE: true} | {m: solve_by(m, line, options, i, given.rtol) for m in METHODS if m != TRUE}
            )
        if all(len(some) == given.each for some in rows.values()):
            break
    print(f"{left_out} lines left out: {TRUE} does not solve them in {METHODS[TRUE][0]} steps, or they have no answer")
    for is_slack, some in rows.items():
        report("slack at times" if is_slack else "always taut", some, given.rtol)


def solve_by(method: str, line: Row, options: Row, i: int, rtol: float) -> Row:
    given, chosen = scenario(line, options, i)
    steps, more = METHODS[method]
    asked = chosen | {"mass": "lumped", "integrator": method, "rtol": rtol, "most_steps": steps} | more
    found = solve("wave_line", given, asked, (*PEAKS, "slack_fraction"))
    return {"status": Status(found.status[0]).name} | {name: found.outputs[name].item() for name in found.outputs}


def report(title: str, rows: list[Row], rtol: float) -> None:
    print(f"\n{title}: {len(rows)} lines")
    differences = defaultdict(dict)
    for method in METHODS:
        if method == TRUE:
            continue
        print(f"  {method:18}", dict(Counter(row[method]["status"] for row in rows)), end="  ")
        for row in rows:
            if row[method]["status"] == "ok":
                differences[method][row["i"]] = difference(row[method], row[TRUE])
        found = np.array(list(differences[method].values()))
        if found.size:
            shares = " ".join(f"{share:.0%}: {np.quantile(found, share):.1e}" for share in (0.5, 0.9, 0.95, 1.0))
            print(f"{shares}; {(found > 10 * rtol).sum()} beyond {10 * rtol:g}:", end=" ")
            worst = sorted(differences[method].items(), key=lambda item: -item[1])[:12]
            print(", ".join(f"{i} {size:.3f}" for i, size in worst if size > 10 * rtol))


if __name__ == "__main__":
    main()
