"""The page of a study in a browser, beside a page that Altair saves itself with a single chart.

python -m benchmarks.page RESULTS --repeats 10
"""

import argparse
import statistics
import tempfile
from pathlib import Path
from time import perf_counter
from typing import Any

import altair as alt

from benchmarks.measure import markdown, revision
from tests.browser import chromium, opened

PAINT = "(performance.getEntriesByName('first-contentful-paint')[0] || { startTime: 0 }).startTime"
POINTS = 200
WINDOWS = {"1280 pixels wide": {"width": 1280, "height": 900}, "390 pixels wide": {"width": 390, "height": 844}}


def single_chart(path: Path) -> None:
    """A page of one curve, its runtime inlined, as Altair makes it."""
    rows = [{"x": i, "y": i * i} for i in range(POINTS)]
    alt.Chart(alt.InlineData(rows)).mark_line().encode(x="x:Q", y="y:Q").save(str(path), inline=True)


def times(browser: Any, path: Path, window: dict[str, int]) -> tuple[float, float]:
    """Seconds until something is to be seen, and until the page is loaded."""
    start = perf_counter()
    with opened(browser, path, viewport=window) as found:
        loaded = perf_counter() - start
        found.page.wait_for_function(f"{PAINT} > 0")
        return found.page.evaluate(PAINT) / 1e3, loaded


def drawing(browser: Any, path: Path, window: dict[str, int]) -> float:
    """Seconds to draw every figure, one after the other."""
    with opened(browser, path, viewport=window) as found:
        start = perf_counter()
        found.page.evaluate("cablesim.drawAll()")
        return perf_counter() - start


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("results", type=Path)
    parser.add_argument("--repeats", type=int, default=10)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, chromium() as browser:
        alone = Path(folder) / "chart.html"
        single_chart(alone)
        pages = {"page of the study": options.results / "report.html", "one chart, by Altair": alone}
        rows = []
        for words, window in WINDOWS.items():
            found: dict[str, list[tuple[float, float]]] = {name: [] for name in pages}
            for _ in range(options.repeats):
                for name, path in pages.items():
                    found[name].append(times(browser, path, window))
            for name, path in pages.items():
                paint, loaded = ([one[i] for one in found[name]] for i in (0, 1))
                spread = f"{statistics.median(paint):.2f} ({min(paint):.2f} .. {max(paint):.2f})"
                whole = drawing(browser, path, window) if path.name == "report.html" else None
                size = f"{path.stat().st_size / 1e6:.2f}"
                drawn = f"{whole:.1f}" if whole else ""
                rows.append((f"{name}, {words}", size, spread, f"{statistics.median(loaded):.2f}", drawn))
    heads = ("", "MB", "first paint s: median (min .. max)", "loaded s", "every figure drawn s")
    print(f"{markdown(heads, rows)}\n\nRevision {revision()}.")


if __name__ == "__main__":
    main()
