"""What the commands of the pages print beside a finished study; as a program, it writes that into the pages anew.

python -m tests.write_pages FOLDER          # the folder whose results/default `make study` has made
"""

import contextlib
import io
import os
import re
import shlex
import sys
from pathlib import Path

from cablesim.cli import main

PROJECT = Path(__file__).parents[1]
README = PROJECT / "README.md"
PAGES = (README, *sorted((PROJECT / "docs").glob("*.md")))
FENCE = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def blocks(language: str, page: Path = README) -> list[str]:
    return [body for found, body in FENCE.findall(page.read_text(encoding="utf-8")) if found == language]


def printed(command: str) -> str:
    """What a command prints: one of ours, or `head`."""
    program, *arguments = shlex.split(command)
    if program == "head":
        lines = Path(arguments[1]).read_text(encoding="utf-8").splitlines(keepends=True)
        return "".join(lines[: int(arguments[0].lstrip("-"))])
    assert program == "cablesim"
    with io.TextIOWrapper(io.BytesIO(), encoding="utf-8") as caught, contextlib.redirect_stdout(caught):
        main(arguments)
        caught.flush()
        return caught.buffer.getvalue().decode()


def written_anew(block: re.Match[str]) -> str:
    """A block of a page with the output of its command, without white space at line ends."""
    if block[1] != "console":
        return block[0]
    first = block[2].partition("\n")[0]
    output = re.sub(r"[ \t]+\n", "\n", printed(first.removeprefix("$ ")))
    return f"```console\n{first}\n{output}```"


if __name__ == "__main__":
    os.chdir(sys.argv[1])
    for page in PAGES:
        page.write_text(FENCE.sub(written_anew, page.read_text(encoding="utf-8")), encoding="utf-8")
