"""Write the output of the README's commands anew, as they print it beside a finished study.

    python docs/write_readme.py FOLDER          # the folder whose results/default `make study` has made

`tests/test_documentation.py` checks that the README says what they print.
"""

import contextlib
import io
import os
import re
import shlex
import sys
from pathlib import Path

from cablesim.cli import main

README = Path(__file__).parents[1] / "README.md"
CONSOLE = re.compile(r"(?<=^```console\n)(\$ [^\n]*\n)(.*?)(?=^```)", re.MULTILINE | re.DOTALL)


def printed(command: str) -> str:
    """What a command prints: one of ours, or `head`."""
    program, *arguments = shlex.split(command.removeprefix("$ "))
    if program == "head":
        lines = Path(arguments[1]).read_text(encoding="utf-8").splitlines(keepends=True)
        return "".join(lines[: int(arguments[0].lstrip("-"))])
    with io.TextIOWrapper(io.BytesIO(), encoding="utf-8") as caught, contextlib.redirect_stdout(caught):
        main(arguments)
        caught.flush()
        return caught.buffer.getvalue().decode()


if __name__ == "__main__":
    os.chdir(sys.argv[1])
    text = CONSOLE.sub(lambda block: block[1] + printed(block[1].strip()), README.read_text(encoding="utf-8"))
    README.write_text(re.sub(r"[ \t]+\n", "\n", text), encoding="utf-8")
