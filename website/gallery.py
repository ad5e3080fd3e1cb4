"""The gallery: every figure of the study, with the question that it answers and the scene file that draws it."""

from pathlib import Path

from cablesim.config.scene import Scene
from cablesim.report.answer import written_answer
from website.study import Finished
from website.text import scene_link, wide

FOLDER = "gallery"
MOVING = ".gif"
HEAD = """# Gallery

What `make study` draws, scene by scene. Each scene is one question in one file, which can be copied and changed; its
figures lie as SVG, PDF and PNG in `results/default/figures/`.
"""


def pages(study: Finished) -> dict[str, str]:
    """The page, scenes with animations first."""
    found = figures(study)
    shown = [scene for scene in study.scenes if found[scene.name]]
    shown.sort(key=lambda scene: not any(path.suffix == MOVING for path in found[scene.name]))
    text = HEAD + "\n" + "\n".join(_section(study, scene, found[scene.name]) for scene in shown)
    return {"gallery.md": wide(text, "navigation")}


def pictures(study: Finished) -> dict[str, Path]:
    """Where in the site each picture goes."""
    return {f"{FOLDER}/{path.name}": path for paths in figures(study).values() for path in paths}


def figures(study: Finished) -> dict[str, list[Path]]:
    """The pictures of each scene; one scene's name may be the beginning of another's."""
    names = [scene.name for scene in study.scenes]
    found: dict[str, list[Path]] = {name: [] for name in names}
    for path in sorted(study.layout.figures.glob("*")):
        owners = [name for name in names if path.stem.startswith(f"{name}_")]
        if path.suffix in (".png", MOVING) and owners:
            found[max(owners, key=len)].append(path)
    return found


def _section(study: Finished, scene: Scene, paths: list[Path]) -> str:
    shown = "\n\n".join(_picture(scene, path) for path in paths)
    pictures = f'<div class="pictures" markdown>\n\n{shown}\n\n</div>\n'
    answer = f"{written_answer(study.layout.tables, scene.name)}\n\n"
    return f"## {scene.title}\n\n*{scene.question}*\n\n{answer}{scene_link(scene)}\n\n{pictures}"


def _picture(scene: Scene, path: Path) -> str:
    what = path.stem.removeprefix(f"{scene.name}_").replace("_", " ")
    return f"[![{scene.title}: {what}]({FOLDER}/{path.name}){{ loading=lazy }}]({FOLDER}/{path.name})"
