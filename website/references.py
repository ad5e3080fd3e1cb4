"""Independent references: the numbers of tests/reference/, computed anew by our solvers while the site is built."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from cablesim.batch import solve
from cablesim.numerics import Array
from cablesim.status import Status
from tests.helpers import REFERENCE, read_table, rows
from website.text import folded, table, wide

HEAD = """# Independent references

The files in `tests/reference/` hold numbers that were computed by other means than ours: with mpmath to 20 digits and
more, by other formulas, or by MoorDyn. Each is solved again here, when this page is made. *Largest difference* is
relative to the reference, or, where it may pass through zero, to what the last column names; the two numbers beside it
are those of the line that it belongs to. Floats of 64 bits differ by 1.1e-16 to 2.2e-16 from their neighbours.
"""
Table = dict[str, Array]


@dataclass(frozen=True)
class Compared:
    """An output of many lines beside its reference: numbers, vectors or lists, and what differences are relative to."""

    solver: str
    output: str
    found: Array
    expected: Array
    scale: Array | float = 0.0
    relative_to: str = ""

    @property
    def row(self) -> tuple[object, ...]:
        found, expected = (np.reshape(part, (len(part), -1)) for part in (self.found, self.expected))
        scale = np.maximum(_length(expected), self.scale)[:, None] if self.relative_to else np.abs(expected)
        differences = np.abs(found - expected) / np.where(scale > 0.0, scale, 1.0)
        line, part = np.unravel_index(np.nanargmax(differences), differences.shape)
        numbers = [f"{values[line, part]:.17g}" for values in (expected, found)]
        largest = f"{differences[line, part]:.1e}"
        return self.solver, f"`{self.output}`", len(found), largest, *numbers, self.relative_to or "itself"


HEADS = ("solver", "output", "lines", "largest difference", "reference", "ours", "relative to")


def pages() -> dict[str, str]:
    """The page."""
    text = "\n".join([HEAD, *(_section(file, found) for file, found in FILES.items())])
    return {"validation/references.md": wide(text, "toc")}


def _section(file: str, compared: Any) -> str:
    lines = (REFERENCE / file).read_text(encoding="utf-8").splitlines()
    told = " ".join(line.lstrip("# ") for line in lines if line.startswith("#"))
    body = table(HEADS, (one.row for one in compared()), "llrrrrl")
    link = f"[`{file}`](../../tests/reference/{file})"
    return f"## {file.removesuffix('.csv').replace('_', ' ')}\n\n{body}\n" + folded(
        "What the file says of itself", f"{link}: {told}"
    )


def _solved(solver: str, line: dict[str, Any], outputs: tuple[str, ...] = (), **options: Any) -> Table:
    """Outputs of lines, which a validation that leaves some out would not be worth its name without."""
    found = solve(solver, line, options, outputs)
    if (found.status != Status.ok).any():
        raise ValueError(f"{solver}: a reference is not solved")
    return found.outputs


def _length(vectors: Array) -> Array:
    return np.sqrt(np.nansum(vectors**2, axis=1))


def _vector(table: Table, name: str) -> Array:
    return np.column_stack([table[f"{name}_{component}"] for component in "xyz"])


def _padded(texts: Array) -> Array:
    """Lists that are written with spaces, NaN after their ends."""
    lists = [[float(word) for word in text.split()] for text in texts]
    width = max(map(len, lists))
    return np.array([values + [np.nan] * (width - len(values)) for values in lists])


def _catenary_exact() -> Iterator[Compared]:
    table = read_table(REFERENCE / "catenary_exact.csv")
    for given in ("line_length", "length_ratio"):
        lines = rows(table, np.isfinite(table[given]))
        yield from _hanging("catenary_exact", lines, ("span", "rise", "weight_per_length", given), f" (by {given})")


def _catenary_elastic() -> Iterator[Compared]:
    given = ("span", "rise", "line_length", "weight_per_length", "axial_stiffness")
    return _hanging("catenary_elastic", read_table(REFERENCE / "catenary_elastic.csv"), given)


def _hanging(solver: str, lines: Table, given: tuple[str, ...], how: str = "") -> Iterator[Compared]:
    found = _solved(solver, {name: lines[name] for name in given})
    for name, values in found.items():
        scale = (lines["span"], "the span") if name == "vertex_x" else (0.0, "")
        yield Compared(solver + how, name, values, lines[name], *scale)


def _composite(file: str) -> Iterator[Compared]:
    table = read_table(REFERENCE / file)
    for given in ("horizontal_tension", "horizontal_distance"):
        lines = rows(table, (table["given"] == given) & (table["family"] != "no_line"))
        lines |= {name: _padded(lines[name]) for name in ("section_length", "section_weight", "joint_tension")}
        found = _solved("composite_line", {n: lines[n] for n in ("section_length", "section_weight", "rise", given)})
        length = np.nansum(lines["section_length"], axis=1)
        lines["lowest_point"] = np.column_stack([lines["lowest_point_x"], 0.0 * length, lines["lowest_point_z"]])
        for name in sorted(set(found) & set(lines)):
            scale = (length, "the length of the line") if name in ("vertex_s", "lowest_point") else (0.0, "")
            # Rounding decides in which of two sections a vertex is that lies where they join.
            some = _off_joints(lines) if name == "vertex_section" else slice(None)
            yield Compared(f"composite_line (by {given})", name, found[name][some], lines[name][some], *scale)


def _off_joints(lines: Table) -> Array:
    """Lines whose vertex is at no end of any section."""
    joints = np.nancumsum(lines["section_length"], axis=1)
    away = np.abs(np.column_stack([0.0 * lines["rise"], joints]) - lines["vertex_s"][:, None]).min(axis=1)
    return np.flatnonzero(away > 1e-12 * joints[:, -1])


def _composite_lines() -> Iterator[Compared]:
    return _composite("composite_lines.csv")


def _composite_extremes() -> Iterator[Compared]:
    return _composite("composite_extremes.csv")


def _strength() -> Iterator[Compared]:
    table = read_table(REFERENCE / "strength_lines.csv")
    line = {name: table[name] for name in ("strength_length", "span", "rise")}
    for name, values in _solved("equal_strength", line).items():
        if name in table:
            yield Compared("equal_strength", name, values, table[name])
    loaded = line | {"force_ratio": table["force_ratio"]}
    found = _solved("equal_strength_loaded", loaded)
    distance = table["distance_over_span"] * table["span"]
    yield Compared("equal_strength_loaded", "horizontal_distance", found["horizontal_distance"], distance)
    yield Compared("equal_strength_loaded", "max_stress_ratio", found["max_stress_ratio"], table["max_stress_ratio"])
    stresses = _padded(table["stress_ratio"])
    places = [
        _solved("equal_strength_loaded", loaded | {"arc_fraction": place / 4.0}, ("stress_ratio",))["stress_ratio"]
        for place in range(5)
    ]
    yield Compared("equal_strength_loaded", "stress_ratio", np.column_stack(places), stresses)


def _pode_functions() -> Iterator[Compared]:
    table = read_table(REFERENCE / "pode_functions.csv")
    for given in ("critical_angle", "weight_ratio"):
        lines = rows(table, np.isfinite(table[given]))
        names = ("angle", given, "friction_ratio", "friction_law", "reference_angle")
        found = _solved("pode_functions", {name: lines[name] for name in names})
        for name, values in found.items():
            scale = (lines[f"{name}_scale"], "what it sums up") if name != "tau" else (0.0, "")
            yield Compared(f"pode_functions (by {given})", name, values, lines[name], *scale)


def _pode_example() -> Iterator[Compared]:
    expected = dict(zip(*read_table(REFERENCE / "pode_example4.csv").values(), strict=True))
    # With these coefficients a metre of the line has 1 N of normal drag, the unit of the reference.
    line = {
        "weight_per_length": np.sin(np.radians(30.0)) ** 2 / np.cos(np.radians(30.0)),
        "diameter": 0.02,
        "normal_drag_coefficient": 0.1,
        "tangential_drag_coefficient": 0.0025,
        "fluid_density": 1000.0,
        "stream_speed": 1.0,
        "line_length": 86.36,
        "position_B": [0.0, 0.0, 30.48],
    }
    for solver in ("pode_line", "stream_line"):
        found = _solved(solver, line)
        for end in "AB":
            angle = np.array([expected[f"angle_{end}"]])
            yield Compared(solver, f"angle_{end}", np.degrees(found[f"angle_{end}"]), angle)
            yield Compared(solver, f"tension_{end}", found[f"tension_{end}"], np.array([expected[f"tension_{end}"]]))
        for name, place in (("lowest_point", 180), ("farthest_point", 90)):
            point = np.array([[-expected[f"x_{place}"], 0.0, expected[f"y_{place}"]]])
            yield Compared(solver, name, found[name], point, 86.36, "the length of the line")


def _stream() -> Iterator[Compared]:
    table = read_table(REFERENCE / "stream_lines.csv")
    plane = (table["lay_angle"] == 0.0) & (table["heading"] == 0.0) & (table["force_A_y"] == 0.0)
    answers = ("position_B", "force_B", "tension_A", "tension_B", "max_tension")
    for solver, lines in (("stream_line", table), ("pode_line", rows(table, plane))):
        vectors = {name: _vector(lines, name) for name in ("force_A", "position_B", "force_B")}
        names = [name for name in lines if name[:-2] not in vectors and name not in answers]
        found = _solved(solver, {name: lines[name] for name in names} | {"force_A": vectors["force_A"]}, answers)
        scales = {
            "position_B": (lines["line_length"], "the length of the line"),
            "force_B": (lines["tension_B"], "tension_B"),
        }
        for name in answers:
            expected = vectors.get(name, lines.get(name))
            yield Compared(solver, name, found[name], expected, *scales.get(name, (0.0, "")))


def _frequencies() -> Iterator[Compared]:
    table = read_table(REFERENCE / "wave_frequencies.csv")
    # In a fluid as dense as itself, without drag and added mass, a taut line is a string.
    ratio, length, mass, stiffness = 0.98, 250.0, 3.0, 1e6
    line = {
        "depth": 200.0,
        "chord_angle": np.arcsin(0.8),
        "length_ratio": ratio,
        "mass_per_length": mass,
        "area": 3e-4,
        "fluid_density": 1e4,
        "linear_stiffness": stiffness,
        "normal_drag": 0.0,
        "tangential_drag": 0.0,
        "wave_period": 5.0,
    }
    speed = np.sqrt(stiffness * (1.0 / ratio - 1.0) * ratio / mass)
    for kind in ("lumped", "consistent"):
        first = rows(table, (table["kind"] == f"string_{kind}") & (table["mode"] == 1))
        found = [
            _solved("wave_modes", line, ("lowest_frequency",), segments=int(n), mass=kind)["lowest_frequency"]
            for n in first["parameter"]
        ]
        values = np.concatenate(found) * ratio * length / speed
        yield Compared(f"wave_modes ({kind} mass)", "lowest_frequency", values, first["frequency"])


def _moordyn() -> Iterator[Compared]:
    table = read_table(REFERENCE / "wave_moordyn.csv")
    # Its finest steps; what snaps without damping has no limit, and long marches are left to the benchmarks.
    converges = (table["linear_stiffness"] < 1e8) & (table["segments"] <= 50)
    lines = rows(table, converges)
    lines = rows(lines, np.flatnonzero(np.arange(len(lines["segments"])) % 2 == 1))
    given = {
        "depth": 200.0,
        "chord_angle": 0.25 * np.pi,
        "mass_per_length": 3.0,
        "area": 3e-4,
        "normal_drag": 15.6,
        "tangential_drag": 0.78,
        "added_mass_per_length": 0.4,
        "wave_period": 5.6,
        "top_amplitude": 1.57,
        "ramp": 11.2,
        "duration": 60.0,
    }
    outputs = ("max_top_tension", "min_top_tension", "max_anchor_tension", "min_anchor_tension")
    for segments in np.unique(lines["segments"]):
        some = rows(lines, lines["segments"] == segments)
        line = given | {name: some[name] for name in ("linear_stiffness", "length_ratio")}
        found = _solved("wave_line", line, outputs, segments=int(segments), mass="lumped", rtol=1e-5)
        for name in outputs:
            scale = (some["max_top_tension"], "the largest tension")
            yield Compared(f"wave_line ({segments:.0f} elements)", name, found[name], some[name], *scale)


FILES = {
    "catenary_exact.csv": _catenary_exact,
    "catenary_elastic.csv": _catenary_elastic,
    "composite_lines.csv": _composite_lines,
    "composite_extremes.csv": _composite_extremes,
    "strength_lines.csv": _strength,
    "pode_functions.csv": _pode_functions,
    "pode_example4.csv": _pode_example,
    "stream_lines.csv": _stream,
    "wave_frequencies.csv": _frequencies,
    "wave_moordyn.csv": _moordyn,
}
