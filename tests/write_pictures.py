"""The picture of a study's page in the documentation: python -m tests.write_pictures RESULTS."""

import sys
from pathlib import Path

from tests.browser import chromium, opened
from tests.test_page import CELL

PICTURE = Path(__file__).parents[1] / "docs" / "images" / "report.png"
WINDOW = {"viewport": {"width": 1000, "height": 1180}, "reduced_motion": "reduce"}
# A scene, one of its maps, and the scenario that is clicked in it.
SCENE, FIGURE, SCENARIO = "snap_loads", 2, 400


def write_picture(results: Path) -> None:
    """A map, and below it the scenario whose cell was clicked."""
    with chromium() as browser, opened(browser, results / "report.html", **WINDOW) as found:
        figure = found.page.locator(f"#{SCENE} figure").nth(FIGURE)
        figure.scroll_into_view_if_needed()
        found.page.wait_for_function("f => f.dataset.drawn", arg=figure.element_handle())
        found.page.mouse.click(*found.page.evaluate(CELL, [figure.element_handle(), SCENARIO]))
        found.page.locator(f"#{SCENE} details.scenario[data-number='{SCENARIO}'] .command").wait_for()
        found.page.evaluate("f => f.scrollIntoView()", figure.element_handle())
        found.page.screenshot(path=PICTURE)


if __name__ == "__main__":
    write_picture(Path(sys.argv[1]))
