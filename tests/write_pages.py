"""What the commands of the pages print; as a program, it writes that into the pages anew.

python -m tests.write_pages FOLDER          # the folder whose results/default `make study` has made

Most pages ask what a finished study holds. A page that writes files of its own, which are blocks with a title, is run
at a desk: a folder with these files, where its scenes have been run, with a copy of the package if a file belongs into
that.
"""

import contextlib
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from cablesim.cli import main

PROJECT = Path(__file__).parents[1]
README = PROJECT / "README.md"
IMAGES = PROJECT / "docs" / "images"
PAGES = (README, *sorted((PROJECT / "docs").rglob("*.md")))
FENCE = re.compile(r"^```(\w*)(?: title=\"([^\"\n]+)\")?\n(.*?)^```", re.MULTILINE | re.DOTALL)
Run = Callable[[str], str]
PACKAGE = ("cablesim", "tests")


def blocks(language: str, page: Path = README) -> list[str]:
    """The blocks of a language that are no files."""
    found = FENCE.findall(page.read_text(encoding="utf-8"))
    return [body for written_in, title, body in found if written_in == language and not title]


def files(page: Path) -> dict[str, str]:
    """The files that a page writes, by their place."""
    return {title: body for _, title, body in FENCE.findall(page.read_text(encoding="utf-8")) if title}


# Pages that are run at a desk, and those that are run beside the default study.
OWN_PAGES = tuple(page for page in PAGES if files(page))
STUDY_PAGES = tuple(page for page in PAGES if not files(page))


def plain(text: str) -> str:
    """Without the white space at line ends, which editors remove."""
    return "\n".join(line.rstrip() for line in text.strip().splitlines())


def printed(command: str) -> str:
    """What a command prints: one of ours, or `head`; its complaint where it cannot be done."""
    program, *arguments = shlex.split(command)
    if program == "head":
        lines = Path(arguments[1]).read_text(encoding="utf-8").splitlines(keepends=True)
        return "".join(lines[: int(arguments[0].lstrip("-"))])
    assert program == "cablesim"
    complaint = io.StringIO()
    with (
        io.TextIOWrapper(io.BytesIO(), encoding="utf-8") as caught,
        contextlib.redirect_stdout(caught),
        contextlib.redirect_stderr(complaint),
    ):
        code = main(arguments)
        caught.flush()
        return complaint.getvalue() if code > 1 else caught.buffer.getvalue().decode()


def printed_by_copy(command: str) -> str:
    """The same of the copy of the package that lies here."""
    _, *arguments = shlex.split(command)
    run = python_here("-m", "cablesim", *arguments)
    return run.stderr if run.returncode > 1 else run.stdout


def python_here(*arguments: str) -> subprocess.CompletedProcess[str]:
    """Run Python, to which what lies here comes before what is installed."""
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, timeout=300, check=False)


@contextlib.contextmanager
def at_desk(page: Path, desk: Path) -> Iterator[Run]:
    """Be in a folder with the files of a page, its scenes run; what comes back runs its commands there."""
    written = files(page)
    has_copy = any(Path(name).parts[0] in PACKAGE for name in written)
    run = printed_by_copy if has_copy else printed
    if has_copy:
        shutil.copy(PROJECT / "pyproject.toml", desk)
        for part in PACKAGE:
            shutil.copytree(PROJECT / part, desk / part, ignore=shutil.ignore_patterns("__pycache__"))
    for name, text in written.items():
        path = desk / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    with contextlib.chdir(desk):
        for name in written:
            if name.endswith(".yaml"):
                told = run(f"cablesim run {name}")
                assert told.startswith("results"), told
        yield run


def written_anew(run: Run, block: re.Match[str]) -> str:
    """A block of a page with the output of its command, without white space at line ends."""
    if block[1] != "console":
        return block[0]
    first = block[3].partition("\n")[0]
    output = re.sub(r"[ \t]+\n", "\n", run(first.removeprefix("$ ")))
    return f"```console\n{first}\n{output}```"


def write(page: Path, run: Run) -> None:
    """Write a page anew, with what its commands print."""
    page.write_text(FENCE.sub(partial(written_anew, run), page.read_text(encoding="utf-8")), encoding="utf-8")


def write_at_desk(page: Path) -> None:
    """The same of a page that writes files, with the figures of its scenes that it shows."""
    with tempfile.TemporaryDirectory() as folder, at_desk(page, Path(folder)) as run:
        write(page, run)
        for figure in Path().glob("results/*/figures/*.png"):
            if f"images/{figure.name}" in page.read_text(encoding="utf-8"):
                shutil.copy(figure, IMAGES)


if __name__ == "__main__":
    for own_page in OWN_PAGES:
        write_at_desk(own_page)
    os.chdir(sys.argv[1])
    for study_page in STUDY_PAGES:
        write(study_page, printed)
