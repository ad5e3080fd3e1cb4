"""Wrong requests for error against run time: refused with one line, nothing is written."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.cli.helpers import Answer, assert_refused, scene, tree

Ask = Callable[..., Answer]
TWO = {
    "methods": {"exact": {"solver": "catenary_exact"}, "parabolic": {"solver": "catenary_parabolic"}},
    "reference": "exact",
}
WANTED = {"output": "sag", "check": "parabolic"}
CASES = {
    "an unknown key": (WANTED | {"repeat": 3}, ("work_precision.repeat", "repeats")),
    "an unknown output": (WANTED | {"output": "sagg"}, ("work_precision.output", "sag")),
    "no output": ({"check": "parabolic"}, ("work_precision", "output")),
    "a check that is no method": (WANTED | {"check": "series"}, ("work_precision.check", "parabolic")),
    "the reference as its own check": (WANTED | {"check": "exact"}, ("work_precision.check", "parabolic")),
    "no word on how well the reference is known": ({"output": "sag"}, ("work_precision", "check", "reference_error")),
    "two words on it": (WANTED | {"reference_error": 1e-9}, ("work_precision", "check", "reference_error")),
    "an error of nothing": ({"output": "sag", "reference_error": 0.0}, ("reference_error", "> 0")),
    "no repeats": (WANTED | {"repeats": 0}, ("work_precision.repeats", "1")),
    "half a repeat": (WANTED | {"repeats": 2.5}, ("work_precision.repeats",)),
    "seconds in metres": (WANTED | {"seconds": "2 m"}, ("work_precision.seconds", "s")),
    "no seconds": (WANTED | {"seconds": "0 s"}, ("work_precision.seconds", "> 0")),
}


@pytest.mark.parametrize(("wanted", "phrases"), CASES.values(), ids=CASES)
def test_a_wrong_request_is_refused(wanted: dict, phrases: tuple[str, ...], here: Path, ask: Ask) -> None:
    (here / "asked.yaml").write_text(scene(**TWO, work_precision=wanted))
    before = tree(here)
    assert_refused(ask("run", "asked.yaml"), "asked.yaml", *phrases)
    assert tree(here) == before


def test_an_error_needs_a_reference(here: Path, ask: Ask) -> None:
    (here / "asked.yaml").write_text(scene(work_precision={"output": "sag", "reference_error": 1e-9}))
    assert_refused(ask("check", "asked.yaml"), "work_precision", "reference")


def test_a_diagram_needs_the_request(here: Path, ask: Ask) -> None:
    (here / "asked.yaml").write_text(scene(**TWO, figures={"look": {"kind": "work_precision"}}))
    assert_refused(ask("check", "asked.yaml"), "figures.look", "work_precision")


def test_methods_are_joined_along_an_option_that_they_differ_in(here: Path, ask: Ask) -> None:
    figures = {"look": {"kind": "work_precision", "join": "segments"}}
    (here / "asked.yaml").write_text(scene(**TWO, work_precision=WANTED, figures=figures))
    assert_refused(ask("check", "asked.yaml"), "figures.look.join")
