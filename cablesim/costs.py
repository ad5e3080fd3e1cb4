"""What the steps of a study take beside solving: seconds of a processor, memory of their process, bytes on the disk.

Measured step by step, each a process of its own (processor seconds and largest resident size by wait4), on scenes of
10 to 8 million answers; times of two cores of 2026 at 2 to 3 GHz. `benchmarks/estimates.py` sets them against studies.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import prod

from cablesim.config.method import Method
from cablesim.config.scene import Scene
from cablesim.database import gather
from cablesim.quantities import SHORT, quantity

MB = 1_000_000
# Snakemake reads its rules; then each job is started, logged and noted.
START_SECONDS, JOB_SECONDS = 2.5, 0.2
# Imports and reading the scene, by step; importing what draws samples, and what compiles, for each process that reads
# the scene; loading kernels.
SOLVE, COLLECT, SUMMARISE, FIGURES, CATALOGUE, REPORT = 0.25, 1.3, 1.2, 1.25, 0.9, 2.5
SAMPLE_SECONDS, COMPILER_SECONDS, LOAD_SECONDS = 0.5, 0.45, 1.4
# Compressing and writing a shard; reading it and writing it again; a row of a table; a number in statistics; a figure.
WRITE_PER_BYTE, COLLECT_PER_BYTE, SECONDS_PER_ROW, SECONDS_PER_VALUE, SECONDS_PER_FIGURE = (
    1.5e-8,
    1.7e-8,
    3.5e-5,
    5e-8,
    0.5,
)
# A figure, and what else a scene has, in the page.
SECONDS_PER_PAGE_FIGURE, SECONDS_PER_PAGE_SCENE = 0.06, 0.08
# Memory of a process that has done nothing yet, and what the same three add.
MAIN_BYTES, SOLVE_BYTES, READ_BYTES = 205 * MB, 60 * MB, 200 * MB
SAMPLE_BYTES, COMPILER_BYTES, LOAD_BYTES = 50 * MB, 100 * MB, 130 * MB
# What is held of each byte of answers while a shard is solved, datasets are collected, and read; of each scenario of a
# shard, of each of a dataset that is read variable by variable, and of each byte of a plan.
SOLVED_SHARE, COLLECTED_SHARE, READ_SHARE = 2.6, 2.3, 1.5
SHARD_SCENARIO, READ_SCENARIO, PLAN_SHARE = 100, 50, 1.5
# Bytes on the disk for each in memory, compressed: smooth along a grid, single precision, not smooth at all.
GRID_RATIO, HISTORY_RATIO, OTHER_RATIO = 0.68, 0.7, 0.8
# Of a number in a table, of a figure in its three forms, of what is in every shard and scene.
CELL_BYTES, FIGURE_BYTES, SHARD_BYTES, SCENE_BYTES = 19, 185_000, 15_000, 80_000
# Of the page without a scene, and of a scene in it and in its part.
PAGE_BYTES, PAGE_SCENE_BYTES = 940_000, 90_000
# Beyond this a table is statistics, and needs no room (report.tables).
MOST_ROWS = 10_000
# Of the status, the iterations and the time of a scenario, in memory, and compressed.
BESIDE, BESIDE_STORED = 9, 1


@dataclass(frozen=True)
class Job:
    """A process: seconds of a processor, and the most memory that it holds."""

    seconds: float
    memory: float


@dataclass(frozen=True)
class Sizes:
    """What the answers of a scene take: bytes in memory of all methods, scenarios times methods, and the plan."""

    scene: Scene
    plan_bytes: float

    @property
    def answers(self) -> int:
        return self.scene.size * len(self.scene.methods)

    @property
    def payload(self) -> float:
        """Bytes of the dataset in memory."""
        return sum(self._payloads)

    @property
    def part(self) -> float:
        """Bytes that are collected at a time: a method at most."""
        return min(max(self._payloads), gather.MOST_BYTES)

    @property
    def _payloads(self) -> list[float]:
        return [float(self.scene.size * (_answer_bytes(self.scene, m)[0] + BESIDE)) for m in self.scene.methods]

    @property
    def imports(self) -> Job:
        """What importing adds to a process that reads the scene."""
        sample = self.scene.design.kind == "sample"
        compiles = any(method.solver.compiled for method in self.scene.methods)
        seconds = sample * SAMPLE_SECONDS + compiles * COMPILER_SECONDS
        return Job(seconds, sample * SAMPLE_BYTES + compiles * COMPILER_BYTES)

    @property
    def read(self) -> float:
        """Bytes that reading the scene, and its plan, adds to a process."""
        return self.imports.memory + PLAN_SHARE * self.plan_bytes


def solve_job(scene: Scene, work: Iterable[tuple[Method, int, float]], plan_bytes: float) -> Job:
    """A job of shards: for each its method, scenarios and seconds of solving."""
    seconds, memory, loads = SOLVE, 0.0, False
    for method, scenarios, solving in work:
        size = _answer_bytes(scene, method)[0] * scenarios
        seconds += solving + WRITE_PER_BYTE * size
        memory = max(memory, SOLVED_SHARE * size + SHARD_SCENARIO * scenarios)
        loads |= method.solver.compiled
    base = SOLVE_BYTES + loads * LOAD_BYTES + PLAN_SHARE * plan_bytes
    return Job(seconds + loads * LOAD_SECONDS, base + memory)


def collect_job(sizes: Sizes) -> Job:
    """Joining the shards."""
    seconds = COLLECT + sizes.imports.seconds + COLLECT_PER_BYTE * sizes.payload
    return Job(seconds, READ_BYTES + sizes.read + COLLECTED_SHARE * sizes.part)


def summarise_job(sizes: Sizes) -> Job:
    """Writing the tables."""
    values = sizes.answers * len(sizes.scene.outputs)
    seconds = SUMMARISE + sizes.imports.seconds + SECONDS_PER_VALUE * values
    return Job(seconds + SECONDS_PER_ROW * _rows(sizes), READ_BYTES + sizes.read + _held(sizes))


def figures_job(sizes: Sizes) -> Job:
    """Drawing the figures."""
    seconds = FIGURES + sizes.imports.seconds + SECONDS_PER_FIGURE * len(sizes.scene.figures)
    return Job(seconds, READ_BYTES + sizes.read + _held(sizes))


def catalogue_job() -> Job:
    """Listing what all scenes hold."""
    return Job(CATALOGUE, READ_BYTES)


def report_job(made: Iterable[Sizes]) -> Job:
    """Writing the page, with the parts of these scenes made anew."""
    sizes = list(made)
    figures = sum(len(one.scene.figures) for one in sizes)
    seconds = REPORT + SECONDS_PER_PAGE_FIGURE * figures + SECONDS_PER_PAGE_SCENE * len(sizes)
    return Job(seconds, READ_BYTES + max((one.read + _held(one) for one in sizes), default=0.0))


def shard_bytes(scene: Scene, method: Method, scenarios: int) -> float:
    """Of a shard on the disk."""
    columns = sum(len(axis.columns) for axis in scene.design.axes) if scene.design.kind != "grid" else 0
    stored = _answer_bytes(scene, method)[1] + 8 * OTHER_RATIO * columns + BESIDE_STORED
    return SHARD_BYTES + scenarios * stored


def dataset_bytes(sizes: Sizes) -> float:
    """Of the dataset, the tables and the figures of a scene on the disk, and of its part of the page."""
    scene = sizes.scene
    stored = sum(scene.size * (_answer_bytes(scene, m)[1] + BESIDE_STORED) for m in scene.methods)
    columns = sum(len(axis.columns) for axis in scene.design.axes)
    given = 8 * OTHER_RATIO * columns * scene.size if scene.design.kind != "grid" else 0
    return (
        SCENE_BYTES
        + PAGE_SCENE_BYTES
        + stored
        + given
        + _table_bytes(sizes, columns)
        + FIGURE_BYTES * len(scene.figures)
    )


def plan_bytes(scene: Scene, scenarios: int) -> float:
    """Of the file of a plan: the points of each axis, twice their places; for cases and samples by method."""
    if scene.design.kind == "grid":
        return float(24 * sum(scene.design.shape))
    columns = len(scene.design.axes[0].columns)
    return float(scenarios * (8 * columns + 16))


def _answer_bytes(scene: Scene, method: Method) -> tuple[int, float]:
    """Of the answers to one scenario by one method, in memory and on the disk."""
    ratio = GRID_RATIO if scene.design.kind == "grid" else OTHER_RATIO
    whole, stored = 0, 0.0
    for name in scene.outputs:
        size = gather.stored_type(name).itemsize * prod(gather.own_shape(scene, name))
        whole += size
        stored += size * (HISTORY_RATIO if quantity(name).is_history else ratio)
    return whole, stored


def _rows(sizes: Sizes) -> int:
    return sizes.answers if sizes.answers <= MOST_ROWS else 0


def _table_bytes(sizes: Sizes, columns: int) -> float:
    """Of the tables of values and of tensions, which have the parameters too."""
    numbers = [name for name in sizes.scene.outputs if quantity(name).dims in SHORT]
    each = sum(prod(gather.own_shape(sizes.scene, name)) for name in numbers)
    tensions = sum("tension" in name for name in numbers)
    return float(CELL_BYTES * _rows(sizes) * (each + tensions + (1 + (tensions > 0)) * (columns + 1)))


def _held(sizes: Sizes) -> float:
    """Of a dataset that is read: whole if it is small, else a variable at a time."""
    small = sizes.payload <= gather.MOST_BYTES
    return READ_SHARE * sizes.payload if small else READ_SCENARIO * sizes.scene.size
