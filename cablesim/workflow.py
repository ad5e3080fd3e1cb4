"""What the Snakefile needs to know of a study: for each scene its shards, its files and the names of its stamps."""

import hashlib
import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from cablesim.config.scene import Scene
from cablesim.files import check, discard, holds_good
from cablesim.fitting import refuse_vast
from cablesim.held import hold_for_good
from cablesim.plan import ScenePlan
from cablesim.report.page.digest import page_digest
from cablesim.sources import LABELS, STEP_PARTS, code_digest
from cablesim.steps import CATALOGUE, REPORT, STUDY, sample, timings_path
from cablesim.study import Layout, read_study

# The modules that write the files of a step: editing them, or what they import, makes these files out of date.
STEP_MODULES = {
    "collect": ("database/collect",),
    "summarise": (
        "database/collect",
        "report/answer",
        "report/tables",
        "report/audit",
        "report/checks",
        "report/orders",
        "report/printed",
        "report/precision",
    ),
    "figures": ("database/collect", "report/figures", *LABELS),
}


@dataclass(frozen=True)
class PlannedScene:
    """A scene, its plan, and the paths that the rules write out."""

    scene: Scene
    layout: Layout
    shard_plan: ScenePlan

    @property
    def name(self) -> str:
        return self.scene.name

    @property
    def path(self) -> str:
        return str(self.scene.path)

    @property
    def plan(self) -> str:
        return str(self.layout.plan(self.shard_plan))

    @property
    def dataset(self) -> str:
        return str(self.layout.dataset(self.name))

    @property
    def shards(self) -> str:
        """The folder of its shards."""
        return str(self.layout.shards(self.name))

    @cached_property
    def bundles(self) -> dict[str, tuple[str, ...]]:
        """The shards that one job computes, by the name of the bundle."""
        return self.shard_plan.bundles

    def bundle_seconds(self, bundle: str) -> float:
        """What the shards of a bundle are expected to take."""
        return sum(self.shard_plan.recipes[digest].expected_seconds for digest in self.bundles[bundle])

    @property
    def solved(self) -> list[str]:
        """The stamps that say that all shards are there."""
        return [str(self.bundle_stamp(bundle)) for bundle in self.bundles]

    def bundle_stamp(self, bundle: str) -> Path:
        """The stamp of a bundle of shards."""
        return self.layout.stamp(self.name, "solve", bundle)

    @property
    def timings(self) -> list[str]:
        """The file of measured run times, where the scene asks for them."""
        path = timings_path(self.scene, self.layout)
        return [str(path)] if path else []

    def stamp(self, step: str) -> str:
        """The stamp of a step, named by the plan and by the code that leads to its files."""
        told = self.scene.answer.text if self.scene.answer and step == "summarise" else ""
        content = (
            f"{self.shard_plan.digest} {' '.join(self.timings)} {code_digest(STEP_MODULES[step], STEP_PARTS)}{told}"
        )
        return str(self.layout.stamp(self.name, step, hashlib.sha256(content.encode()).hexdigest()[:16]))


@dataclass(frozen=True)
class PlannedStudy:
    """A study with all its scenes planned."""

    config: str
    results: str
    scenes: tuple[PlannedScene, ...]
    python: str = sys.executable

    def scene(self, name: str) -> PlannedScene:
        return next(scene for scene in self.scenes if scene.name == name)

    @property
    def catalogue_stamp(self) -> str:
        """The stamp of the catalogue, named by what was collected."""
        return self._stamp(CATALOGUE, code_digest(("database/catalogue",), STEP_PARTS), "collect")

    @property
    def report_stamp(self) -> str:
        """The stamp of the page, named by the tables, and so the datasets, that it shows."""
        return self._stamp(REPORT, page_digest(), "summarise")

    def _stamp(self, step: str, code: str, made_from: str) -> str:
        content = " ".join([code, *(scene.stamp(made_from) for scene in self.scenes)])
        digest = hashlib.sha256(content.encode()).hexdigest()[:16]
        return str(Layout(Path(self.results)).stamp(STUDY, step, digest))

    def forget_lost_files(self) -> None:
        """Stamps of the whole study go where the files of a scene are to be made again, or theirs are lost."""
        for stamp, made_from in ((self.catalogue_stamp, "collect"), (self.report_stamp, "summarise")):
            made = all(Path(scene.stamp(made_from)).exists() for scene in self.scenes)
            if not made or not holds_good(Path(stamp)):
                Path(stamp).unlink(missing_ok=True)


# The studies whose results this process holds, by their configuration: they are planned once.
_held: dict[Path, PlannedStudy] = {}


def plan_study(config: Path | str, checking: bool = True, holding: bool = False) -> PlannedStudy:
    """Read a study and sample its designs.

    `checking` looks whether every file is still what was written; `holding` keeps others out of the results until this
    process ends. Raises InputError for anything wrong in the files of the study, EnvironmentFault where a study is
    running already.
    """
    path = Path(config)
    if not holding:
        return _plan_study(path, checking, holding)
    if path.resolve() not in _held:
        # Snakemake names files by their whole paths.
        near = path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path
        _held[path.resolve()] = _plan_study(near, checking, holding)
    return _held[path.resolve()]


def _plan_study(config: Path, checking: bool, holding: bool) -> PlannedStudy:
    study = read_study(config)
    layout = Layout(Path("results") / study.name)
    read = study.scenes
    for one in read:
        refuse_vast(one, layout.root)
    if holding:
        hold_for_good(layout.root)
    scenes = tuple(PlannedScene(scene, layout, sample(scene, layout)) for scene in read)
    planned = PlannedStudy(str(config), str(layout.root), scenes)
    if checking:
        for scene in scenes:
            _forget_lost_files(scene)
        planned.forget_lost_files()
    return planned


def _forget_lost_files(scene: PlannedScene) -> None:
    """A stamp vouches for files; where they are gone or damaged, it goes too, so that they are made again."""
    layout, name = scene.layout, scene.name
    for bundle, shards in scene.bundles.items():
        paths = [layout.shards(name) / f"{shard}.nc" for shard in shards]
        if not all(check(path).whole for path in paths):
            scene.bundle_stamp(bundle).unlink(missing_ok=True)
    lost = {step for step in STEP_MODULES if not holds_good(Path(scene.stamp(step)))}
    measured = [Path(path) for path in scene.timings if not check(Path(path)).whole]
    for path in measured:
        discard(path)
    if measured or not check(layout.dataset(name)).whole:
        lost.add("collect")
    for step in STEP_MODULES if "collect" in lost else lost:
        Path(scene.stamp(step)).unlink(missing_ok=True)
