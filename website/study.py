"""The finished study that the site shows."""

from dataclasses import dataclass
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import Abort

from cablesim.config.scene import Scene
from cablesim.study import Layout, read_study


@dataclass(frozen=True)
class Finished:
    """A study, and where its results are."""

    layout: Layout
    scenes: tuple[Scene, ...]


def finished(config: MkDocsConfig) -> Finished:
    """The study that mkdocs.yml names. Ends the build with one line where it is not there as a whole."""
    results = Path(config.extra["results"])
    layout, study = Layout(results), read_study(Path(config.extra["study"]))
    missing = [scene.name for scene in study.scenes if not layout.dataset(scene.name).exists()]
    if missing or not layout.catalogue.exists():
        raise Abort(f"{results}: no finished study ({len(missing)} of {len(study.scenes)} scenes missing): make study")
    return Finished(layout, study.scenes)
