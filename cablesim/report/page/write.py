"""Write the page of a folder of results: from a part for each scene, kept beside it, and the runtime of the figures."""

import base64
import contextlib
import hashlib
import json
from collections import Counter
from collections.abc import Iterable
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from cablesim.config.scene import Scene
from cablesim.database.reading import read_dataset
from cablesim.errors import CablesimError
from cablesim.files import digest_of, recorded_digest, write_text
from cablesim.report.colours import PALETTE, PIXEL_DASHES, STATUS_COLOURS
from cablesim.report.page.digest import FILES, FOLDER, part_digest
from cablesim.report.page.part import made_from, scene_part
from cablesim.status import SENTENCES, Status
from cablesim.study import Layout

# What the figures need of the runtime.
SNIPPET = "window.vegaEmbed = vegaEmbed;"


def write_page(layout: Layout, scenes: Iterable[Scene]) -> None:
    """Write `report.html` with these scenes first, then all others that have a part in the folder.

    A part is made anew where its scene, the dataset, the tables or the code has changed; that of another scene is left
    out where the code has.
    """
    order = [_updated(layout, scene) for scene in scenes]
    names = {part["scene"] for part in order}
    others = [
        _read(path) for path in layout.page_parts() if path.stem not in names and layout.dataset(path.stem).exists()
    ]
    known = [part for part in others if part.get("code") == part_digest()]
    write_text(layout.page, page(layout.root.name, [*order, *known]))


def page(study: str, parts: list[dict[str, Any]]) -> str:
    """The page of a study as text. Whatever the parts say is shown as text, whatever it looks like."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(FOLDER),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["words"] = lambda name: str(name).replace("_", " ")
    style, script = ((FOLDER / name).read_text(encoding="utf-8") for name in FILES[1:])
    scripts = {"runtime": runtime(), "script": script}
    fates: Counter[str] = Counter()
    for part in parts:
        fates.update({fate["status"]: fate["count"] for fate in part["fates"]})
    return environment.get_template(FILES[0]).render(
        study=study,
        parts=parts,
        fates=[(status.name, fates[status.name], SENTENCES[status]) for status in Status if fates[status.name]],
        scenarios=sum(fates.values()),
        seconds=sum(part["seconds"] for part in parts),
        revisions=sorted({f"{p['provenance']['source']}, revision {p['provenance']['revision']}" for p in parts}),
        sources=[part for part in parts if part["source"]],
        colours={status.name: colour for status, colour in STATUS_COLOURS.items()},
        styles={"palette": PALETTE, "dashes": PIXEL_DASHES},
        style=style,
        style_digest=_policy_digest(style),
        script_digests=[_policy_digest(text) for text in scripts.values()],
        **scripts,
    )


def _updated(layout: Layout, scene: Scene) -> dict[str, Any]:
    """The part of a scene, made anew unless it is there for the same content."""
    path, dataset = layout.page_part(scene.name), layout.dataset(scene.name)
    content = " ".join([recorded_digest(dataset), *map(digest_of, made_from(scene, layout))])
    made = {"code": part_digest(), "digest": hashlib.sha256(content.encode()).hexdigest()[:16]}
    found = _read(path)
    if {name: found.get(name) for name in made} != made:
        found = {**made, **scene_part(scene, read_dataset(dataset), layout)}
        write_text(path, json.dumps(found, ensure_ascii=False))
    return found


def _read(path: Path) -> dict[str, Any]:
    """A part; nothing where it is not there, or damaged."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        return found if isinstance(found, dict) else {}
    except (OSError, ValueError):
        return {}


@cache
def runtime() -> str:
    """Vega, Vega-Lite and Vega-Embed as one script. Joining them takes seconds, so it is kept in the user's cache."""
    import vl_convert
    from platformdirs import user_cache_path

    path = user_cache_path("cablesim") / f"vega-{version('vl-convert-python')}.js"
    if path.is_file():
        return path.read_text(encoding="utf-8")
    script = str(vl_convert.javascript_bundle(SNIPPET)).replace("</script", "<\\/script")
    with contextlib.suppress(CablesimError):
        write_text(path, script)
    return script


def _policy_digest(text: str) -> str:
    """How a content policy names a script or a style that stands in the page."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
