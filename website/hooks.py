"""What MkDocs is told beside mkdocs.yml: formulas become MathML, and links may leave docs/.

A page may link to any file of the project, so that the link holds where the page is read beside the sources. In the
site that file is a copy in files/, or the page that was made of it.
"""

import re
from pathlib import Path, PurePosixPath
from posixpath import normpath, relpath

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

from cablesim.solver import peer_names, solver_names
from website.mathml import with_mathml
from website.places import MADE_OF, SOLVERS
from website.study import finished

PROJECT = Path(__file__).parents[1]
OUTSIDE = re.compile(r"(\]\()((?:\.\./)+[^)#\s]+)")
SOLVER_HEADING = re.compile(r"^## `(\w+)`$", re.M)


def on_config(config: MkDocsConfig) -> None:
    """Look for the study before anything is done, and list the pages of the solvers."""
    finished(config)
    listed = next(part["Solvers"] for top in config.nav for part in _parts(top) if "Solvers" in part)
    listed += [{name: f"{SOLVERS}/{name}.md"} for name in (*solver_names(), *peer_names())]


def _parts(top: dict) -> list[dict]:
    below = next(iter(top.values()))
    return [part for part in below if isinstance(part, dict)] if isinstance(below, list) else []


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Send links that leave docs/ to copies, and join each solver's theory with its reference."""
    folder = PurePosixPath("docs") / PurePosixPath(page.file.src_uri).parent

    def inside(link: re.Match[str]) -> str:
        path = normpath(f"{folder}/{link[2]}")
        if path.startswith("docs/"):
            return link[0]
        target = MADE_OF.get(path, f"files/{path}")
        if path not in MADE_OF and (PROJECT / path).is_file() and files.get_file_from_path(target) is None:
            files.append(File.generated(config, target, abs_src_path=str(PROJECT / path)))
        return link[1] + relpath(f"docs/{target}", str(folder))

    if page.file.src_uri.startswith("theory/"):
        told = rf"\g<0>\n\n[Parameters, options and outputs](../{SOLVERS}/\1.md){{ .to-reference }}"
        markdown = SOLVER_HEADING.sub(told, markdown)
    return OUTSIDE.sub(inside, markdown)


def on_page_content(html: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Convert the formulas."""
    return with_mathml(html)
