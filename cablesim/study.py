"""A study: the scenes that one run of the workflow makes, and where its files are."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from cablesim.config.document import is_name, read_document
from cablesim.config.scene import Scene, read_scene
from cablesim.database import CATALOGUE_FILE
from cablesim.plan import ScenePlan, plan_path


@dataclass(frozen=True)
class Layout:
    """Where everything of a study's results lies."""

    root: Path

    @property
    def plans(self) -> Path:
        return self.root / "plans"

    def plan(self, plan: ScenePlan) -> Path:
        return plan_path(self.plans, plan.scene, plan.digest)

    def shards(self, scene: str) -> Path:
        return self.root / "shards" / scene

    def dataset(self, scene: str) -> Path:
        return self.root / f"{scene}.nc"

    def timings(self, scene: str, digest: str) -> Path:
        """The file of run times that were measured for this content of a scene."""
        return self.root / "timings" / f"{scene}.{digest}.json"

    @property
    def catalogue(self) -> Path:
        return self.root / CATALOGUE_FILE

    @property
    def tables(self) -> Path:
        return self.root / "tables"

    @property
    def figures(self) -> Path:
        return self.root / "figures"

    @property
    def page(self) -> Path:
        """The page of the study, for a browser."""
        return self.root / "report.html"

    def page_part(self, scene: str) -> Path:
        """What the page says of a scene."""
        return self.root / "report" / f"{scene}.json"

    def page_parts(self) -> list[Path]:
        """The parts of all scenes."""
        return sorted((self.root / "report").glob("*.json"))

    def stamp(self, scene: str, step: str, digest: str) -> Path:
        """The file that says a step was done for this content of the scene."""
        return self.root / "stamps" / f"{scene}.{step}.{digest}"

    def stamps(self, scene: str, step: str) -> list[Path]:
        """The stamps of a step for any content."""
        return sorted((self.root / "stamps").glob(f"{scene}.{step}.*"))


@dataclass(frozen=True)
class Study:
    """A configuration file, read: the study's name and the files of its scenes."""

    name: str
    path: Path
    scene_paths: tuple[Path, ...]

    @cached_property
    def scenes(self) -> tuple[Scene, ...]:
        return tuple(read_scene(path) for path in self.scene_paths)


def read_study(path: Path) -> Study:
    """Read `config/config.yaml` or another of its kind; scenes are found in `scenes/` beside it.

    Raises InputError naming file, line and key for anything unknown or missing.
    """
    keys = read_document(path).mapping(("study", "scenes"))
    paths = []
    for entry in keys["scenes"].sequence():
        name = entry.name()
        scene = path.parent / "scenes" / f"{name}.yaml"
        if not scene.is_file():
            known = sorted(p.stem for p in (path.parent / "scenes").glob("*.yaml") if is_name(p.stem))
            entry.choice(tuple(known))
        if scene in paths:
            entry.fail(f"the scene '{name}' is listed twice")
        paths.append(scene)
    return Study(keys["study"].name(), path, tuple(paths))


def read_any(path: Path) -> tuple[str, tuple[Scene, ...]]:
    """The name and the scenes of a study, or of a scene file by itself. Raises InputError as their readers do."""
    if "study" in read_document(path).mapping(optional=None):
        study = read_study(path)
        return study.name, study.scenes
    scene = read_scene(path)
    return scene.name, (scene,)
