"""Error against run time: what each method of a scene is worth, which are on the front, and which to use for what."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd
import xarray as xr

from cablesim.config.method import Method
from cablesim.config.precision_file import WorkPrecision
from cablesim.config.scene import Scene
from cablesim.database.reading import magnitude, of_method, reference_values
from cablesim.numerics import Array

# Accuracies that the fastest method is named for, and what they are called.
TARGETS = {1e-2: "1 %", 1e-4: "1e-4", 1e-6: "1e-6", 1e-9: "1e-9"}
# A reference tells an error that is so many times its own.
TOLD = 100.0
EFFORT = ("iterations", "steps", "rhs_evaluations")
NONE = "none"


@dataclass(frozen=True)
class Worth:
    """One timed method: relative errors in what the reference has solved (NaN where it has not), and run times."""

    method: Method
    errors: Array
    times: dict[str, float]
    effort: dict[str, float]

    @property
    def name(self) -> str:
        return self.method.name

    @property
    def solved(self) -> int:
        return int(np.isfinite(self.errors).sum())

    @property
    def solves_all(self) -> bool:
        return self.solved == self.errors.size

    @cached_property
    def largest(self) -> float:
        return float(np.nanmax(self.errors)) if self.solved else math.nan

    @cached_property
    def median(self) -> float:
        return float(np.nanmedian(self.errors)) if self.solved else math.nan

    @property
    def run_time(self) -> float:
        return self.times["run_time"]


@dataclass(frozen=True)
class WorkAndPrecision:
    """All timed methods of a scene, whose error counts, and the error of the reference that it is measured against."""

    output: str
    reference_error: float
    methods: tuple[Worth, ...]

    @property
    def least_told(self) -> float:
        """Errors below this are not told apart from the reference's own."""
        return TOLD * self.reference_error

    @cached_property
    def front(self) -> tuple[Worth, ...]:
        """Those that solve everything and that no other beats in both run time and largest error, fastest first."""
        best, front = math.inf, []
        for one in sorted((w for w in self.methods if w.solves_all), key=lambda w: (w.run_time, w.largest)):
            if max(one.largest, self.least_told) < best:
                best = max(one.largest, self.least_told)
                front.append(one)
        return tuple(front)

    def fastest(self, target: float) -> Worth | None:
        """The fastest method with no error above the target, the reference's included; None if there is none."""
        good = [w for w in self.methods if w.solves_all and w.largest + self.reference_error <= target]
        return min(good, key=lambda w: w.run_time, default=None)


def work_and_precision(scene: Scene, dataset: xr.Dataset) -> WorkAndPrecision:
    """What was measured in a scene that has `work_precision`."""
    wanted, reference = scene.work_precision, scene.reference
    if wanted is None or reference is None:
        raise ValueError(f"{scene.name} has no work_precision")
    exact = reference_values(reference, dataset, wanted.output)
    known = np.isfinite(_relative(exact, exact))
    timed = [method for method in scene.methods if np.isfinite(float(of_method(dataset.repeats, method.name)))]
    found = tuple(_worth(method, wanted, dataset, exact, known) for method in timed)
    return WorkAndPrecision(wanted.output, _reference_error(wanted, dataset, exact), found)


def precision_table(scene: Scene, dataset: xr.Dataset) -> pd.DataFrame:
    """A row for each method, in the order of the scene; nothing where nothing was timed."""
    if scene.work_precision is None:
        return pd.DataFrame()
    found = work_and_precision(scene, dataset)
    return pd.DataFrame([_row(one, found) for one in found.methods]).dropna(axis="columns", how="all")


def precision_caption(scene: Scene, dataset: xr.Dataset) -> str:
    """What the table of methods shows, how well the reference is known, and where times were taken."""
    if scene.work_precision is None:
        return ""
    found = work_and_precision(scene, dataset)
    about = dataset.attrs
    return (
        f"{scene.title}: relative errors of {found.output} against {about['reference']}, itself known to "
        f"{found.reference_error:.1e} (errors below {found.least_told:.1e} are not told from its own). Seconds a "
        f"scenario, warm, in one batch, median and range of the repeats, {about['threads']} thread; alone: one "
        f"scenario a call. First call: with loading of machine code, or compiling where none was on disk. Importing "
        f"all solvers took {about['import_seconds']:.2g} s. {about['machine']}."
    )


def fastest_table(scene: Scene, dataset: xr.Dataset) -> pd.DataFrame:
    """For each accuracy the fastest method that keeps it in every scenario; nothing where nothing was timed."""
    if scene.work_precision is None:
        return pd.DataFrame()
    found = work_and_precision(scene, dataset)
    rows = []
    for target in TARGETS:
        best = found.fastest(target)
        rows.append(
            {
                "accuracy": target,
                "fastest": best.name if best else NONE,
                "solver": best.method.solver.name if best else "",
                "options": changed_options(best.method) if best else "",
                "largest error": best.largest if best else math.nan,
                "run_time [s]": best.run_time if best else math.nan,
                "told by the reference": "yes" if target >= found.least_told else "no",
            }
        )
    return pd.DataFrame(rows)


def fastest_caption(scene: Scene, dataset: xr.Dataset) -> str:
    """The sentence that an engineer wants."""
    return f"{scene.title}: {advice(scene, dataset)}" if scene.work_precision else ""


def advice(scene: Scene, dataset: xr.Dataset) -> str:
    """For which accuracy to use which method, in a sentence computed from the data."""
    found, parts = work_and_precision(scene, dataset), []
    for target, words in TARGETS.items():
        best = found.fastest(target)
        choice = f"use {best.name} ({written_seconds(best.run_time)} a scenario)" if best else "there is no method here"
        parts.append(f"for {words} {choice if target >= found.least_told else 'the reference does not tell'}")
    missing = [one.name for one in found.methods if one.solved == 0]
    without = f" Without an answer: {', '.join(missing)}." if missing else ""
    sentence = ", ".join(parts)
    return f"{sentence[0].upper()}{sentence[1:]}.{without}"


def _worth(method: Method, wanted: WorkPrecision, dataset: xr.Dataset, exact: xr.DataArray, known: np.ndarray) -> Worth:
    errors = _relative(of_method(dataset[wanted.output], method.name), exact)[known]
    names = ("run_time", "run_time_lowest", "run_time_highest", "run_time_alone", "first_call_time", "repeats")
    times = {name: float(of_method(dataset[name], method.name).mean()) for name in names}
    effort = {
        name: float(of_method(dataset[name], method.name).median())
        for name in EFFORT
        if name in dataset and (of_method(dataset[name], method.name) >= 0).any()
    }
    return Worth(method, errors, times, effort)


def _relative(values: xr.DataArray, exact: xr.DataArray) -> Array:
    """Errors by scenario; of a list the largest of its sections."""
    relative = magnitude(values - exact) / magnitude(exact)
    return (relative.max("section") if "section" in relative.dims else relative).values.ravel()


def _reference_error(wanted: WorkPrecision, dataset: xr.Dataset, exact: xr.DataArray) -> float:
    if wanted.check is None:
        return wanted.reference_error
    return float(np.nanmax(_relative(of_method(dataset[wanted.output], wanted.check), exact)))


def _row(one: Worth, found: WorkAndPrecision) -> dict[str, object]:
    return {
        "method": one.name,
        "solver": one.method.solver.name,
        "options": changed_options(one.method),
        "solved": f"{one.solved} of {one.errors.size}",
        "median error": one.median,
        "largest error": one.largest,
        "told by the reference": "yes" if one.largest >= found.least_told else "no",
        "run_time [s]": one.run_time,
        "lowest [s]": one.times["run_time_lowest"],
        "highest [s]": one.times["run_time_highest"],
        "repeats": int(one.times["repeats"]),
        "alone [s]": one.times["run_time_alone"],
        "first call [s]": one.times["first_call_time"],
        **{name: one.effort.get(name, math.nan) for name in EFFORT},
        "on the front": "yes" if one in found.front else "no",
    }


def changed_options(method: Method) -> str:
    """The options in which a method differs from its solver's defaults, in words."""
    return ", ".join(f"{name}={value}" for name, value in method.changed_options.items())


def written_seconds(seconds: float) -> str:
    """Three digits in the unit that suits."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"
