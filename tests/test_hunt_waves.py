"""The hunt for wrong answers of lines in waves: a small one finds nothing, and judges catch spoiled results."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest

from cablesim.batch import Results
from cablesim.hunt import _wave_moved, waves
from cablesim.hunt._case import Case, rows_of
from cablesim.hunt._wave_lines import CORNERS, random_lines, with_corners
from cablesim.status import Status
from tests.wave_check import CASE

SOLVER = "wave_line"
JUDGES = waves.judges(SOLVER)
Spoil = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Spoiled(Case):
    """A case of which the solver says something else for some outputs, whenever it is asked."""

    spoils: dict[str, Spoil] = field(default_factory=dict)

    def solve(self, outputs: tuple[str, ...] = (), **changed: Any) -> Results:
        return spoiled(super().solve(outputs, **changed), self.spoils)


def spoiled(found: Results, spoils: dict[str, Spoil]) -> Results:
    changed = {name: spoil(found.outputs[name]) for name, spoil in spoils.items() if name in found.outputs}
    return replace(found, outputs=found.outputs | changed)


def times(factor: float) -> Spoil:
    return lambda values: factor * values


def bent(profile: np.ndarray) -> np.ndarray:
    """A node in the middle, a hundredth of a millimetre aside."""
    out = profile.copy()
    out[:, 3, 1] += 1e-5
    return out


def moved_top(profile: np.ndarray) -> np.ndarray:
    out = profile.copy()
    out[:, -1, 0] += 1e-9
    return out


def pulled_up(tension: np.ndarray) -> np.ndarray:
    out = tension.copy()
    out[..., -1] *= 1.03
    return out


def sound_case() -> Case:
    """Taut lines in a stream that move periodically, one of them upright."""
    names = dict(CASE) | {"added_mass_per_length": 0.0, "internal_damping": 1e5, "stream_speed": 0.5}
    parameters = {name: np.full(2, value) for name, value in names.items()}
    parameters |= {"chord_angle": np.array([0.8, 0.5 * np.pi]), "heading": np.array([0.4, 0.0])}
    options = {"segments": 6, "integrator": "generalized_alpha", "rtol": 1e-3, "mass": "consistent"}
    return Case(SOLVER, parameters, options | {"added_mass": "normal", "time_check": "yes"})


@pytest.fixture(scope="module")
def sound() -> tuple[Case, Results]:
    case = sound_case()
    found = case.solve()
    assert (found.status == Status.ok).all()
    return case, found


@pytest.mark.parametrize("name", JUDGES)
def test_every_judge_looks_at_a_sound_answer_and_lets_it_pass(name, sound):
    miss = JUDGES[name](*sound)
    assert miss.shape == (2,)
    assert not np.isnan(miss[1])
    assert np.nanmax(miss) <= 1.0


# What the solver says whenever it is asked, by the judge that is to catch it.
WHENEVER = [
    ("balance at rest", {"profile": bent}),
    ("closure at rest", {"profile": moved_top}),
    ("law at rest", {"profile": times(1.0 + 1e-8)}),
    ("supports at rest", {"static_top_tension": times(1.0 + 1e-6)}),
    ("supports at rest", {"static_middle_tension": times(1.0 + 1e-6)}),
    ("no compression at rest", {"profile_tension": times(-1.0)}),
    ("records agree", {"history": times(1.05)}),
    ("records agree", {"history": times(0.8)}),
    ("records agree", {"profile_max_tension": times(1.0 + 1e-9)}),
    ("rest stays rest", {"max_top_tension": times(1.0 + 1e-5)}),
    ("momentum of a period", {"snapshot_tension": pulled_up}),
]


@pytest.mark.parametrize(("name", "spoils"), WHENEVER)
def test_a_judge_catches_what_is_always_said_wrong(name, spoils, sound):
    case, found = sound
    liar = Spoiled(case.solver, case.parameters, case.options, spoils)
    assert JUDGES[name](liar, spoiled(found, spoils))[1] > 1.0


# What is said of the lines as they are, and not of their mirror images, say.
ONCE = [
    ("order of tensions", {"mean_middle_tension": times(3.0)}),
    ("order of tensions", {"min_anchor_tension": times(-1e-9)}),
    ("records agree", {"max_strain": times(1.0 + 1e-15)}),
    ("mirror", {"min_top_tension": times(1.0 + 1e-15)}),
    ("units", {"mean_top_tension": times(1.0 + 1e-15)}),
    ("neighbours", {"max_anchor_tension": times(1.0 + 1e-15)}),
    ("rotation", {"max_top_tension": times(1.1)}),
    ("second march", {"max_top_tension": times(1.05)}),
    ("second march", {"mean_anchor_tension": times(0.95)}),
]


@pytest.mark.parametrize(("name", "spoils"), ONCE)
def test_a_judge_catches_what_is_said_wrong_once(name, spoils, sound):
    case, found = sound
    assert JUDGES[name](case, spoiled(found, spoils))[1] > 1.0


def test_an_answer_that_tells_of_its_error_may_be_wrong_by_that(sound):
    case, found = sound
    wrong = spoiled(found, {"max_top_tension": times(1.05), "time_change": lambda values: values + 0.02})
    assert (JUDGES["second march"](case, wrong) <= 1.0).all()
    lost = spoiled(wrong, {"time_change": lambda values: values + 0.1})
    assert np.isnan(JUDGES["second march"](case, lost)).all()


def test_a_small_hunt_finds_nothing(monkeypatch):
    """Of few elements, with fewer steps: those that need more are not judged by a second march."""
    monkeypatch.setattr(waves, "MOST_STEPS", dict.fromkeys(waves.MOST_STEPS, 4000))
    monkeypatch.setattr(_wave_moved, "EXPLICIT_STEPS", 10_000)
    monkeypatch.setattr(_wave_moved, "FINER_STEPS", 5000)
    cases = [case for case in waves.draw(SOLVER, 400, np.random.default_rng(4)) if case.options["segments"] <= 7]
    solved = 0
    for case in cases[:4]:
        case = case.rows(slice(0, 12))
        found = case.solve()
        ok = found.status == Status.ok
        solved += ok.sum()
        for name, judge in JUDGES.items():
            miss = judge(case.rows(ok), rows_of(found, ok))
            assert not (miss > 1.0).any(), (name, miss)
    assert solved > 24


def test_lines_are_drawn_into_every_corner():
    line = random_lines(400, np.random.default_rng(1))
    cornered = with_corners(line, np.random.default_rng(2), share=1.0)
    changed = {name for name in line if not np.array_equal(cornered[name], line[name], equal_nan=True)}
    assert {"area", "chord_angle", "length_ratio", "stiffness_ratio", "normal_drag", "heading", "depth"} <= changed
    assert len(CORNERS) == 15 and (cornered["length_ratio"] == 1.0).any()


def test_a_block_is_drawn_the_same_again():
    one, two = (waves.draw(SOLVER, 40, np.random.default_rng(7)) for _ in range(2))
    assert [case.size for case in one] == [16, 16, 8]
    for case, other in zip(one, two, strict=True):
        assert case.options == other.options
        assert all(np.array_equal(case.parameters[name], other.parameters[name]) for name in case.parameters)
