"""Faults of what a user writes: scenes, names, queries, parameters and tolerances that are hostile or not numbers."""

import json
import os
import random
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from cablesim.config.document import is_name
from cablesim.solver import Solver, load_solver, solver_names
from tests.cli.helpers import GOOD, scene
from tests.cli.test_wrong_inputs import as_scene, assignments, good_values
from tests.database.conftest import SCENES, run
from tests.database.test_hostile_queries import QUERIES
from tests.faults.asking import Asked, Told, asking
from tests.faults.fault import Fault, Outcome
from tests.faults.ingredients import encoded, extreme, number, printed, spoilt, word

TABLE = "# made up\nlength_ratio,rise [m],sag\n1.1,0.1,0.5\n1.2,0.2,0.7\n"
TABLED = "{cases: {table: lines.csv, columns: {length_ratio: length_ratio, rise: rise}}}"
FIGURES = {"sag": {"kind": "curves", "x": "length_ratio", "y": "exact.sag"}}
# A question asked of the command, and what is wrong with the answer.
Question = Callable[[Asked, Path, random.Random], tuple[Told, str]]


def asked(question: Question, prepare: Callable[[Path], None] = lambda _: None) -> Callable[[Path, int, int], Outcome]:
    """Ask again and again; refused, answered and flagged are counted, and nothing else may be in the folder after."""

    def inject(folder: Path, times: int, seed: int) -> Outcome:
        draw, failures, codes, slowest = random.Random(seed), [], Counter[int](), 0.0
        here = folder / "here"
        here.mkdir()
        prepare(here)
        ask = asking()
        for turn in range(times):
            told, problem = question(ask, here, draw)
            codes[told.code] += 1
            slowest = max(slowest, told.seconds)
            failures += [f"{turn}: {told.wrong or problem}"] if told.wrong or problem else []
        strange = [str(path) for path in folder.rglob("pwned*")]
        failures += [f"files were made: {strange}"] if strange else []
        told_codes = ", ".join(f"{count} with exit code {code}" for code, count in sorted(codes.items()))
        return Outcome(times, tuple(failures), None, f"{told_codes}; the slowest in {slowest:.1f} s")

    return inject


def named(told: Told, *names: str) -> str:
    """What is wrong with a refusal of a file: it must name that, and be the caller's mistake."""
    if told.code in (0, 1):
        return ""
    return "" if told.refuses(2, *names) else f"exit code {told.code} does not name {names}: {told.err[-300:]}"


def document(ask: Asked, here: Path, draw: random.Random) -> tuple[Told, str]:
    """A scene that was spoilt."""
    good = draw.choice([scene(), scene(figures=FIGURES), *SCENES.values()])
    content = spoilt(good, draw)
    if draw.random() < 0.005:
        content = draw.choice([bytes(10**8), b"# " + b"x" * 10**8, content + b"\n" * 10**7])
    (here / "asked.yaml").write_bytes(content)
    told = ask(["check", "asked.yaml"], here, forked=draw.random() < 0.02)
    return told, named(told, "asked.yaml")


def table(ask: Asked, here: Path, draw: random.Random) -> tuple[Told, str]:
    """A table beside a scene that was spoilt."""
    (here / "asked.yaml").write_text(scene(design=TABLED))
    rows = [[number(draw), number(draw), word(draw)] for _ in range(draw.randrange(4))]
    cells = "".join(",".join(row) + "\n" for row in rows)
    (here / "lines.csv").write_bytes(spoilt(TABLE, draw) if draw.random() < 0.5 else encoded(TABLE + cells, draw))
    told = ask(["check", "asked.yaml"], here, forked=draw.random() < 0.02)
    return told, named(told, "asked.yaml")


def name(ask: Asked, here: Path, draw: random.Random) -> tuple[Told, str]:
    """A hostile name in some place of a scene, or of a study."""
    hostile = word(draw)
    parts = {
        "axis": {"design": {"grid": {hostile: [1.1, 1.2]}}},
        "method": {"methods": {hostile: {"solver": "catenary_exact"}}},
        "solver": {"methods": {"exact": {"solver": hostile}}},
        "option": {"methods": {"exact": {"solver": "catenary_exact", "options": {hostile: 5}}}},
        "output": {"outputs": [hostile]},
        "fixed": {"fixed": {hostile: 1.0}},
        "figure": {"figures": {hostile: FIGURES["sag"]}},
        "formula": {"figures": {"sag": {**FIGURES["sag"], "y": hostile}}},
        "check": {"checks": {hostile: "sag > 1 m"}},
        "condition": {"checks": {"deep": hostile}},
        "table": {"design": {"cases": {"table": hostile}}},
        "reference": {"reference": hostile},
        "key": {hostile: 1},
    }
    place = draw.choice([*parts, "study", "scene", "file"])
    if place in parts:
        (here / "asked.yaml").write_text(json.dumps(json_scene(**parts[place])))
        told = ask(["run", "asked.yaml", "--out", "out"], here)
        return told, named(told, "asked.yaml")
    if place == "file":
        return file_name(ask, here, hostile)
    study = {"study": hostile, "scenes": ["spans"]} if place == "study" else {"study": "x", "scenes": [hostile]}
    (here / "config.yaml").write_text(json.dumps(study))
    told = ask([draw.choice(["clean", "collect"]), "config.yaml"], here)
    return told, named(told, "config.yaml")


def json_scene(**parts: object) -> dict[str, object]:
    """The good scene as data, with some parts replaced."""
    good = {
        "title": GOOD["title"],
        "design": {"grid": {"length_ratio": [1.1, 1.2]}},
        "fixed": {"span": 2.5, "weight_per_length": 3},
        "methods": {"exact": {"solver": "catenary_exact"}},
        "outputs": ["sag", "max_tension"],
    }
    return good | parts


def file_name(ask: Asked, here: Path, hostile: str) -> tuple[Told, str]:
    """A scene file of a hostile name, if there can be one."""
    place = f"{hostile}.yaml".replace("\0", "")
    try:
        if "/" not in hostile:
            (here / place).write_text(scene())
    except (OSError, ValueError):
        pass
    told = ask(["run", "--", place], here)
    expected = (0, 2) if is_name(hostile.replace("\0", "")) else (2,)
    return told, "" if told.code in expected else f"exit code {told.code} for {place[:40]!r}: {told.err[-200:]}"


def words(ask: Asked, here: Path, draw: random.Random) -> tuple[Told, str]:
    """A hostile title, question and labels: what can be printed is drawn as it stands, and is harmless on a page."""
    labels = {key: printed(draw) for key in ("x_label", "y_label", "each_label") if draw.random() < 0.5}
    look = {**FIGURES["sag"], "y": {printed(draw): "exact.sag", "b": "2 * exact.sag"}, **labels}
    parts = {"title": printed(draw), "question": printed(draw), "figures": {"sag": look}}
    (here / "asked.yaml").write_text(json.dumps(json_scene(**parts), ensure_ascii=draw.random() < 0.2))
    told = ask(["run", "asked.yaml", "--out", "shown"], here)
    if told.code == 0:
        for command in (["scenes", "shown"], ["scenes", "shown", "asked"], ["page", "shown"]):
            told = ask(command, here)
            if told.wrong or told.code or "\x1b" in told.out or (command[0] == "page" and "<script" in told.out):
                return told, f"{command}: {told.code} {told.out[-200:]}"
    return told, named(told, "asked.yaml")


def query(ask: Asked, here: Path, draw: random.Random) -> tuple[Told, str]:
    """A hostile query, in any place of it."""
    # No argument of a process has a zero byte.
    hostile = (draw.choice(QUERIES) if draw.random() < 0.7 else word(draw)).replace("\0", "")
    places = [
        ["query", "results", "--", "spans", hostile],
        ["query", "results", "--", hostile],
        ["query", "results", "spans", f"--columns={hostile}"],
        ["query", "results", "spans", f"--nearest={hostile}"],
        ["query", "results", "spans", f"--nearest=span={hostile}"],
        ["query", "results", "spans", f"--order-by={hostile}"],
        ["query", "results", "spans", f"--limit={hostile}"],
        ["query", "results", "spans", f"--format={hostile}"],
        ["scenes", "results", "--", hostile],
        ["scenes", "--", hostile],
        ["compare", "results", "--", hostile],
        ["verify", "--", hostile],
        ["describe", "--", hostile],
        ["solve", "--", "catenary_exact", hostile],
        ["solve", "--", "catenary_exact", f"span={hostile}", "line_length=3", "weight_per_length=3"],
        ["solve", "catenary_exact", "span=2", "line_length=3", "weight_per_length=3", f"--outputs={hostile}"],
    ]
    told = ask(draw.choice(places), here, forked=False)
    return told, "" if told.code < 3 else f"exit code {told.code}: {told.err[-300:]}"


def tolerance(ask: Asked, here: Path, draw: random.Random) -> tuple[Told, str]:
    """A poisoned tolerance, sample, seed or limit of a command."""
    poison = number(draw)
    commands = [
        ["compare", "results", "results", f"--tolerance={poison}"],
        ["verify", "results", "--sample=1", f"--tolerance={poison}"],
        ["verify", "results", "--sample=1", f"--seed={poison}"],
        ["verify", "results", f"--sample={poison}"],
        ["query", "results", "spans", f"--limit={poison}"],
        ["query", "results", "spans", f"--nearest=span={poison}"],
        ["query", "results", "spans", f"sag > {poison}"],
        ["hunt", "catenary_exact", f"--scenarios={poison}"] if poison in ("nan", "-1", "0", "inf", "1e400") else [],
    ]
    told = ask(draw.choice([command for command in commands if command]), here, forked=False)
    return told, "" if told.code < 3 else f"exit code {told.code}: {told.err[-300:]}"


def solved(ask: Asked, here: Path, draw: random.Random) -> tuple[Told, str]:
    """A poisoned parameter or option of any solver, on the command line or in a scene."""
    solver = load_solver(draw.choice(solver_names()))
    target = draw.choice([*solver.parameters, *solver.options])
    spec = solver.parameters.get(target)
    values = good_values(solver, target if spec else "")
    options: dict[str, str] = {}
    if spec is None:
        options[target] = number(draw)
    else:
        values[target] = poisoned(values.get(target, "1"), draw)
    for _ in range(draw.randrange(2)):
        other = draw.choice(list(values))
        values[other] = poisoned(values[other], draw)
    if draw.random() < 0.6:
        given = [f"--option={name}={value}" for name, value in options.items()]
        told = ask(["solve", solver.name, "--json", *given, "--", *assignments(values)], here, forked=False)
        return told, told.wrong or unclear(told, solver, values, options)
    (here / "asked.yaml").write_text(in_scene(solver, target, values, options, draw))
    (here / "lines.csv").write_text(f"{target}\n{values.get(target, 1)}\n")
    told = ask(["run", "asked.yaml", "--out", f"out_{draw.randrange(10**9)}"], here, forked=False)
    return told, told.wrong or (named(told, "asked.yaml") and f"{solver.name} {values} {options}: {told.err[-300:]}")


def poisoned(value: str, draw: random.Random) -> str:
    """A value with one of its components or sections poisoned."""
    parts = value.split(",")
    parts[draw.randrange(len(parts))] = draw.choice([number, extreme])(draw)
    return ",".join(parts)


def in_scene(solver: Solver, target: str, values: dict[str, str], options: dict[str, str], draw: random.Random) -> str:
    """A scene of one case, a range that is sampled, an axis, or a table, with a poison in it."""
    text = as_scene(solver, values, options)
    if target not in solver.parameters or draw.random() < 0.4:
        return text
    poison = values[target]
    others = {name: value for name, value in values.items() if name != target}
    ranged = {"start": poison, "stop": number(draw), "num": 3, **({"spacing": "log"} if draw.random() < 0.5 else {})}
    designs = [
        {"grid": {target: [poison, number(draw)]}},
        {"grid": {target: ranged}},
        {"sample": {"method": "sobol", "num": 2, "seed": 1, "ranges": {target: {"start": "0", "stop": poison}}}},
        {"cases": {"table": "lines.csv"}},
    ]
    lines = as_scene(solver, others, options).splitlines() if len(others) > 1 else text.splitlines()
    return "\n".join(
        f"design: {json.dumps(draw.choice(designs))}" if line.startswith("design:") else line for line in lines
    )


def unclear(told: Told, solver: Solver, values: dict[str, str], options: dict[str, str]) -> str:
    """What is wrong with an answer in JSON: numbers where it is ok, none where it is flagged, one line if refused."""
    asked_for = f"{solver.name} {values} {options}: "
    if told.code == 2:
        return ""
    if told.code not in (0, 1):
        return asked_for + f"exit code {told.code}: {told.err[-200:]}"
    found = json.loads(told.out)
    status, units = found.pop("status"), found.pop("units")
    if (status == "ok") != (told.code == 0):
        return asked_for + f"{status} with exit code {told.code}"
    numbers = [value for name, value in found.items() if name in units and not isinstance(value, list)]
    missing = [value is None for value in numbers]
    wrong = any(missing) if status == "ok" else not all(missing)
    return asked_for + f"{status} {found}" if wrong else ""


def results(here: Path) -> None:
    """A folder with a study in it."""
    for scene_name in ("spans", "inclined"):
        (here / f"{scene_name}.yaml").write_text(SCENES[scene_name])
        run(here / f"{scene_name}.yaml", here / "results")
    os.environ.setdefault("MPLBACKEND", "Agg")


FAULTS: tuple[Fault, ...] = (
    Fault("a scene is hostile YAML, or no YAML", "refused", asked(document), 80, 6000),
    Fault("a table beside a scene is hostile", "refused", asked(table), 60, 3000),
    Fault("a name is hostile", "refused", asked(name), 12, 300),
    Fault("a title or label is hostile", "drawn as it stands, or refused", asked(words), 2, 40),
    Fault("a query is hostile", "refused", asked(query, results), 60, 3000),
    Fault("a tolerance, sample or limit is poisoned", "refused", asked(tolerance, results), 15, 400),
    Fault("a parameter or option of a solver is poisoned", "refused, or a status", asked(solved), 30, 800),
)
