"""Small studies to be damaged, what of them is the same on every run, and what a run computes of them."""

import contextlib
import math
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

from cablesim import shards as blocks
from cablesim import steps
from cablesim.config.scene import read_scene
from cablesim.files import check
from cablesim.study import Layout
from cablesim.workflow import plan_study
from tests.test_workflow import PROJECT, digests, root_group, snakemake

SCENES = {
    "many": """
title: Many small shards
design:
  grid:
    span: [10, 20, 40, 50, 60]
    length_ratio: [0.9, 1.1, 1.2, 1.3]
fixed: {weight_per_length: 5 N/m}
methods:
  exact: {solver: catenary_exact}
  parabolic: {solver: catenary_parabolic}
  series: {solver: catenary_series}
outputs: [sag, max_tension]
""",
    "limits": """
title: Limits
design:
  grid: {permitted_error: [1 %, 3 %, 5 %]}
methods:
  parabolic: {solver: catenary_limit_ratio}
outputs: [sag_limit_ratio, tension_limit_ratio]
""",
    "timed": """
title: Times of two methods
design:
  grid: {length_ratio: [1.1, 1.2]}
fixed: {span: 10 m, weight_per_length: 5 N/m}
methods:
  exact: {solver: catenary_exact}
  parabolic: {solver: catenary_parabolic}
reference: exact
outputs: [sag]
work_precision: {output: sag, reference_error: 1e-15, repeats: 1}
figures:
  sag: {kind: curves, x: length_ratio, y: exact.sag}
""",
}
STUDY = "small"


@dataclass(frozen=True)
class Study:
    """A folder with a study of these scenes, as the workflow has it; perhaps every scenario has a shard of its own."""

    folder: Path
    names: tuple[str, ...] = tuple(SCENES)
    split: bool = False

    @property
    def results(self) -> Path:
        return self.folder / "results" / STUDY

    @property
    def layout(self) -> Layout:
        return Layout(self.results)

    def scene(self, name: str) -> Path:
        return self.folder / "config" / "scenes" / f"{name}.yaml"

    def shards(self) -> list[Path]:
        """All of its shards."""
        return sorted(self.results.glob("shards/*/*.nc"))

    def run(self) -> int:
        """Run its scenes without Snakemake; how many scenarios were computed."""
        with self._here():
            layout = Layout(Path("results") / STUDY)
            paths = [Path("config") / "scenes" / f"{name}.yaml" for name in self.names]
            return sum(steps.run_scene(read_scene(path), layout, lambda *_: None)[1] for path in paths)

    def finish(self) -> None:
        """Do all steps of the workflow, as its rules do, in this process."""
        with self._here():
            planned = plan_study("config/config.yaml")
            layout = Layout(Path(planned.results))
            for scene in planned.scenes:
                for bundle, shards in scene.bundles.items():
                    steps.solve(Path(scene.plan), shards, Path(scene.shards), scene.bundle_stamp(bundle))
                if scene.timings:
                    steps.measure(scene.scene, layout, 0.0)
                for step in steps.SCENE_STEPS:
                    steps.run_step(step, scene.scene, layout, Path(scene.stamp(step)))
            steps.catalogue(layout, Path(planned.catalogue_stamp))

    def undone(self) -> list[str]:
        """What Snakemake has still to make, after it has looked at all files."""
        with self._here():
            planned = plan_study("config/config.yaml")
            wanted = [path for scene in planned.scenes for path in (*scene.solved, *scene.timings)]
            wanted += [scene.stamp(step) for scene in planned.scenes for step in ("collect", "summarise", "figures")]
            return [path for path in (*wanted, planned.catalogue_stamp) if not Path(path).exists()]

    def lost(self) -> dict[Path, int]:
        """The shards that its plans ask for and that are not there, whole, and the scenarios in each."""
        with self._here():
            planned = {name: steps.sample(read_scene(self.scene(name)), self.layout) for name in self.names}
        wanted = {
            self.layout.shards(name) / f"{digest}.nc": math.prod(recipe.shape)
            for name, plan in planned.items()
            for digest, recipe in plan.recipes.items()
        }
        return {path: scenarios for path, scenarios in wanted.items() if not check(path).whole}

    @contextlib.contextmanager
    def _here(self) -> Iterator[None]:
        most = 1 if self.split else blocks.MOST_SCENARIOS
        with mock.patch.object(blocks, "MOST_SCENARIOS", most), contextlib.chdir(self.folder):
            yield

    def same(self) -> dict[str, object]:
        """What is the same on every run: shards, tables and figures by their bytes, datasets but for measured times."""
        found = {name: digest for name, digest in digests(self.results).items() if _is_unmeasured(name)}
        return {**found, **{path.stem: root_group(path) for path in self.results.glob("*.nc")}}

    def copy(self, folder: Path) -> "Study":
        return Study(Path(shutil.copytree(self.folder, folder, symlinks=True)), self.names, self.split)


def make_study(folder: Path, *names: str, split: bool = False) -> Study:
    """A folder with the workflow and some of the scenes, not run yet."""
    study = Study(folder, names or tuple(SCENES), split)
    study.scene("any").parent.mkdir(parents=True)
    for name in study.names:
        study.scene(name).write_text(SCENES[name])
    (folder / "config" / "config.yaml").write_text(f"study: {STUDY}\nscenes: [{', '.join(study.names)}]\n")
    shutil.copy(PROJECT / "Snakefile", folder)
    shutil.copytree(PROJECT / "workflow", folder / "workflow")
    return study


def finished(folder: Path, *names: str) -> Study:
    """A study that ran to its end by the steps of the workflow, with their stamps."""
    study = make_study(folder, *names)
    study.finish()
    return study


def run_by_snakemake(study: Study) -> None:
    """Run a study. Raises RuntimeError, with what Snakemake said, where that fails."""
    run = snakemake(study.folder)
    if run.returncode:
        raise RuntimeError((run.stdout + run.stderr)[-1000:])


def _is_unmeasured(name: str) -> bool:
    path = Path(name)
    return (
        path.suffix in (".nc", ".svg", ".csv")
        and len(path.parts) > 1
        and not path.stem.endswith(("_status", "_work_precision", "_fastest"))
    )
