"""What decides a page beside the scenes: code, files that are no code, libraries. Nothing heavy is imported."""

import hashlib
from importlib.metadata import version
from pathlib import Path

from cablesim.sources import LABELS, STEP_PARTS, code_digest

FOLDER = Path(__file__).parent
# What the page is made of, beside Python.
FILES = ("page.html", "page.css", "page.js")


def part_digest() -> str:
    """Digest of all that decides what a page says of a scene."""
    return f"{code_digest(('report/page/part', *LABELS), STEP_PARTS)} {version('altair')}"


def page_digest() -> str:
    """Digest of all that decides how a page looks."""
    digest = hashlib.sha256(f"{part_digest()} {code_digest(('report/page/write',), STEP_PARTS)}".encode())
    for name in FILES:
        digest.update((FOLDER / name).read_bytes())
    digest.update(version("vl-convert-python").encode())
    return digest.hexdigest()[:16]
