"""The hunt for wrong answers of tow lines: a small one finds nothing, and every judge catches spoiled results."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from cablesim.batch import Results
from cablesim.hunt import towing
from cablesim.hunt._case import Case
from cablesim.hunt._composite_precise import longer
from cablesim.hunt._composite_taut import slack, taut_tension
from cablesim.hunt._hunt import hunt
from cablesim.status import Status

LINE = {
    "section_length": np.array([[400.0, 50.0, np.nan], [300.0, 75.0, 20.0]]),
    "section_weight": np.array([[80.0, 598.0, np.nan], [66.0, 600.0, 60.0]]),
}
CASES = {
    "composite_line": LINE | {"rise": np.array([5.0, -40.0]), "horizontal_distance": np.array([420.0, 300.0])},
    "composite_mean_weight": LINE | {"rise": np.array([5.0, -40.0]), "horizontal_tension": np.array([4e4, 2e4])},
    "composite_parabolic": LINE | {"rise": np.array([5.0, -40.0]), "horizontal_tension": np.array([4e4, 2e4])},
    "composite_handbook": {name: values[:, :2] for name, values in LINE.items()}
    | {"horizontal_tension": np.array([4e4, 2e5])},
    "tow_wave_height": LINE
    | {"wire_modulus": np.full(2, 3.6e10)}
    | {
        "hook_pull": np.array([1e5, 5e4]),
        "breaking_strength": np.array([8e5, 4e5]),
        "diameter": np.array([0.05, 0.04]),
    },
}
Spoil = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Spoiled(Case):
    """A case of which the solver says something else for one output, whenever it is asked."""

    name: str = ""
    spoil: Spoil = np.copy

    def solve(self, outputs: tuple[str, ...] = (), **changed: Any) -> Results:
        return spoiled(super().solve(outputs, **changed), self.name, self.spoil)


def spoiled(found: Results, name: str, spoil: Spoil) -> Results:
    changed = {name: spoil(found.outputs[name])} if name in found.outputs else {}
    return replace(found, outputs=found.outputs | changed)


def case_of(solver: str) -> Case:
    return Case(solver, CASES[solver], {} if solver == "tow_wave_height" else {"nodes": 7})


def times(factor: float) -> Spoil:
    return lambda values: factor * values


def plus(change: float) -> Spoil:
    return lambda values: values + change


@pytest.mark.parametrize("solver", towing.SOLVERS)
def test_a_small_hunt_finds_nothing(solver: str) -> None:
    [found] = hunt((solver,), 200, seed=3)
    assert found.wrong == 0 and found.scenarios == 200
    assert found.status["ok"] > 100 and found.status["not_converged"] == 0
    assert set(found.judged) == set(towing.judges(solver))
    assert min(found.judged.values()) > 0


@pytest.mark.parametrize("solver", towing.SOLVERS)
def test_sound_answers_pass_every_judge(solver: str) -> None:
    case = case_of(solver)
    found = case.solve()
    assert (found.status == Status.ok).all()
    for name, judge in towing.judges(solver).items():
        miss = judge(case, found)
        assert miss.shape == (2,) and (miss <= 1.0).all(), name


# Ten times what is allowed or more; whatever is asked again is answered rightly.
ONCE = [
    ("composite_line", "units", "horizontal_tension", times(1.0 + 1e-8)),
    ("composite_line", "equilibrium", "tension_A", times(1.0 + 1e-10)),
    ("composite_line", "equilibrium", "vertex_s", times(1.0 + 1e-9)),
    ("composite_line", "other end", "tension_B", times(1.0 + 1e-9)),
    ("composite_line", "other end", "horizontal_tension", times(1.0 + 1e-9)),
    ("composite_line", "halves", "joint_tension", times(1.0 + 1e-9)),
    ("composite_line", "harder pull", "horizontal_tension", times(0.9)),
    ("composite_line", "second method", "horizontal_tension", times(1.0 + 1e-9)),
    ("composite_line", "second method", "max_tension", times(1.0 + 1e-9)),
    ("composite_line", "second method", "vertex_section", plus(1.0)),
    ("composite_line", "second method", "closing_error", plus(1e-6)),
    ("composite_line", "second method", "lowest_point", times(1.0 + 1e-8)),
    ("composite_mean_weight", "harder pull", "horizontal_distance", times(1.1)),
    ("composite_mean_weight", "second method", "horizontal_distance", times(1.0 + 1e-9)),
    ("composite_parabolic", "halves", "tension_A", times(1.0 + 1e-9)),
    ("composite_parabolic", "second method", "vertex_s", times(1.0 + 1e-9)),
    ("composite_handbook", "second method", "vertex_s", times(1.0 + 1e-9)),
    ("composite_handbook", "equilibrium", "joint_tension", times(1.0 + 1e-10)),
    ("tow_wave_height", "formula", "elastic_elongation", times(1.0 + 1e-13)),
    ("tow_wave_height", "formula", "weight_elongation", plus(1e-10)),
    ("tow_wave_height", "formula", "wave_height", plus(1e-10)),
    ("tow_wave_height", "other end", "distance_calm", times(1.0 + 1e-9)),
    ("tow_wave_height", "second method", "distance_jerk", times(1.0 + 1e-9)),
]


@pytest.mark.parametrize(("solver", "judge", "name", "spoil"), ONCE)
def test_a_judge_catches_a_spoiled_answer(solver: str, judge: str, name: str, spoil: Spoil) -> None:
    case = case_of(solver)
    assert (towing.judges(solver)[judge](case, spoiled(case.solve(), name, spoil)) > 1.0).all()


# What is asked for by the judge itself.
ASKED = [
    ("equilibrium", "joint_position", times(1.0 + 1e-9)),
    ("second method", "joint_position", times(1.0 + 1e-9)),
    ("profile", "profile", times(1.0 + 1e-9)),
    ("profile", "profile_tension", times(1.0 + 1e-9)),
    ("profile", "profile_section", lambda sections: np.ones_like(sections)),
]


@pytest.mark.parametrize("solver", ["composite_line", "composite_handbook"])
@pytest.mark.parametrize(("judge", "name", "spoil"), ASKED)
def test_a_judge_catches_spoiled_places(solver: str, judge: str, name: str, spoil: Spoil) -> None:
    case = case_of(solver)
    liar = Spoiled(solver, case.parameters, case.options, name, spoil)
    assert (towing.judges(solver)[judge](liar, liar.solve()) > 1.0).all()


def test_a_line_that_cannot_be_is_caught_however_it_is_answered() -> None:
    case, judges = case_of("composite_line"), towing.judges("composite_line")
    chord = case.parameters | {"rise": np.zeros(2), "horizontal_distance": np.array([450.0, np.nextafter(395.0, 0.0)])}
    np.testing.assert_array_equal(judges["existence"](replace(case, parameters=chord), case.solve()), [np.inf, 0.0])
    tow = case_of("tow_wave_height")
    weak = replace(tow, parameters=tow.parameters | {"breaking_strength": np.array([2e5, 4e5])})
    np.testing.assert_array_equal(towing.judges(tow.solver)["feasibility"](weak, tow.solve()), [np.inf, 0.0])


def test_given_distances_of_a_tow_line_are_answered_as_they_are() -> None:
    names = ("hook_pull", "breaking_strength", "diameter", "wire_modulus")
    given = {name: CASES["tow_wave_height"][name] for name in names}
    given |= {name: np.array([300.0, 400.0]) for name in ("line_length", "distance_calm", "distance_jerk")}
    case, judge = Case("tow_wave_height", given, {}), towing.judges("tow_wave_height")["second method"]
    assert (judge(case, case.solve()) == 0.0).all()
    assert (judge(case, spoiled(case.solve(), "distance_calm", times(1.0 + 1e-15))) == np.inf).all()


def test_the_tension_of_a_taut_line_follows_from_its_slack_but_for_what_is_told() -> None:
    """A uniform line, steep: sinh(l)/l = sqrt(L^2 - z^2) / x with l = w x / 2 H."""
    for pull in (1e2, 1e3, 1e4):
        turn = 0.5 / pull
        x, z = 0.8, 0.6
        L = np.hypot(z, x * np.sinh(turn) / turn)
        line = {"section_length": [[L]], "section_weight": [[1.0]], "rise": [z], "horizontal_distance": [x]}
        line = longer({name: np.array(values) for name, values in line.items()})
        H, off = taut_tension(line, slack(line))
        # The length is rounded, and with it the slack.
        assert abs(H[0] / (pull * x) - 1.0) <= off[0] + 1e-15 / slack(line)[0]
        assert off[0] < 1.0 / pull**2
