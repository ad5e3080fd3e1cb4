"""A page in headless Chromium, with every host out of reach: what it asks for, what it complains of, what it shows."""

import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome")
ARGUMENTS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--host-resolver-rules=MAP * ~NOTFOUND",
]
# What stands on a chart beside its axes, titles and legends.
COUNT_MARKS = """figure => figure.views.map(view => {
  const count = (node, inside) => {
    if (!node) return 0;
    const own = inside && node.marktype && node.marktype !== "group" ? node.items.length : 0;
    return own + (node.items || []).reduce((sum, item) =>
      sum + (item.items || []).reduce((more, child) => more + count(child, child.role === "mark" || inside), 0), 0);
  };
  return count(view.scenegraph().root, false);
})"""


@dataclass
class Opened:
    """A page, and what it has asked of the network and said in the console so far."""

    page: Any
    asked: list[str] = field(default_factory=list)
    said: list[str] = field(default_factory=list)

    def draw_all(self) -> dict[str, list[int]]:
        """Draw every figure; how many marks each panel has, by scene and number of the figure."""
        self.page.evaluate("cablesim.drawAll()")
        figures = self.page.locator("figure")
        found = {}
        for figure in figures.element_handles():
            name = figure.evaluate("f => `${f.closest('article').id} ${f.dataset.figure}`")
            found[name] = figure.evaluate(COUNT_MARKS)
        return found


def executable() -> str:
    """Chromium, installed where that can be done; else the test is skipped."""
    for name in NAMES:
        if path := shutil.which(name):
            return path
    if os.getuid() != 0 or shutil.which("apt-get") is None:
        pytest.skip("there is no Chromium, and nobody here who could install it")
    install = ["apt-get", "install", "-y", "-q", "--no-install-recommends", "chromium"]
    quiet = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    for command in (["apt-get", "update", "-q"], install):
        done = subprocess.run(command, env=quiet, capture_output=True, text=True, timeout=600, check=False)
    path = shutil.which("chromium")
    if path is None:
        pytest.skip(f"Chromium cannot be installed: {(done.stderr.strip().splitlines() or ['no reason given'])[-1]}")
    return path


@contextmanager
def chromium() -> Iterator[Any]:
    """The browser."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=executable(), args=ARGUMENTS)
        try:
            yield browser
        finally:
            browser.close()


@contextmanager
def opened(browser: Any, path: Path, **options: Any) -> Iterator[Opened]:
    """A file in a window of its own; `options` are those of the window (viewport, locale, ...)."""
    context = browser.new_context(**{"viewport": {"width": 1280, "height": 900}, **options})
    found = Opened(context.new_page())
    found.page.on("request", lambda request: found.asked.append(request.url))
    found.page.on("console", lambda message: found.said.append(f"{message.type}: {message.text}"))
    found.page.on("pageerror", lambda problem: found.said.append(f"error: {problem}"))
    try:
        found.page.goto(path.resolve().as_uri())
        yield found
    finally:
        context.close()
