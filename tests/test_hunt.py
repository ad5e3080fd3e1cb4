"""The hunt's frame: what it draws, whom it asks, what it tells, and that it tells of what is wrong."""

import json
import shlex

import numpy as np
import pytest

from cablesim import batch
from cablesim.batch import Results
from cablesim.cli import main
from cablesim.hunt import _anything, _hunt
from cablesim.hunt._case import Case
from cablesim.hunt._hunt import families, hunt, judges_of
from cablesim.solver import solver_names
from cablesim.status import Status

QUICK = "tow_wave_height"


def found(solver: str, scenarios: int, seed: int = 1, part: tuple[int, int] = (0, 1)):
    (one,) = hunt((solver,), scenarios, seed, part)
    return one


def test_every_solver_is_drawn_for_and_judged():
    assert families().keys() <= set(solver_names())
    for solver in solver_names():
        assert judges_of(solver), solver


def test_the_same_seed_meets_the_same_scenarios_whole_or_in_parts(monkeypatch):
    monkeypatch.setattr(_hunt, "BLOCK", 50)
    whole = found(QUICK, 200)
    parts = [found(QUICK, 200, part=(k, 3)) for k in range(3)]
    assert whole.scenarios == sum(one.scenarios for one in parts) == 200
    assert whole.status == sum((one.status for one in parts), start=parts[0].status - parts[0].status)
    other = found(QUICK, 200, seed=2)
    assert other.status != whole.status or other.worst != whole.worst


def spoiled(results: Results, factor: float) -> Results:
    outputs = {
        name: np.where(np.arange(len(value)) == 7, factor * value, value) for name, value in results.outputs.items()
    }
    return Results(outputs, results.status, results.iterations, results.seconds)


def test_a_wrong_answer_is_told_with_the_command_that_gives_it(monkeypatch, capsys):
    """An answer that is off in one unit system, by a part in a million, is found by the judge of units."""
    real = batch.solve

    def solve(solver, parameters, options=None, outputs=()):
        results = real(solver, parameters, options, outputs)
        usual = np.max(parameters["line_length"]) < 1e3
        return spoiled(results, 1.0 + 1e-6) if usual and results.status.size > 7 else results

    lengths = np.linspace(101.0, 200.0, 9)
    hundred, ten = np.full(9, 100.0), np.full(9, 10.0)
    case = Case("catenary_exact", {"span": hundred, "line_length": lengths, "weight_per_length": ten}, {})
    monkeypatch.setattr(batch, "solve", solve)
    miss = _anything.other_answer_in_other_units(case, case.solve())
    assert np.flatnonzero(miss > 1.0).tolist() == [7]
    monkeypatch.setattr(batch, "solve", real)
    words = shlex.split(case.command(7))
    assert words[:2] == ["cablesim", "solve"]
    assert main([*words[1:], "--json"]) == 0
    answer = capsys.readouterr().out
    assert json.loads(answer)["max_tension"] == case.solve().outputs["max_tension"][7]


def test_commands_hold_vectors_lists_words_and_options(capsys):
    vectors = Case(
        "segment_line",
        {
            "force_A": np.array([[-50.0, 0.0, 250.0]]),
            "line_length": np.array([50.0]),
            "weight_per_length": np.array([1.7]),
            "diameter": np.array([0.01]),
            "normal_drag_coefficient": np.array([1.2]),
            "tangential_drag_coefficient": np.array([0.03]),
            "friction_law": np.array(["cosine_squared"]),
            "fluid_density": np.array([1000.0]),
            "stream_speed": np.array([1.0]),
        },
        {"segments": 7, "variant": "midpoint"},
    )
    lists = Case(
        "composite_line",
        {
            "section_length": np.array([[400.0, 50.0, np.nan]]),
            "section_weight": np.array([[80.0, 600.0, np.nan]]),
            "horizontal_tension": np.array([5e4]),
        },
        {},
    )
    for case in (vectors, lists):
        assert main([*shlex.split(case.command(0))[1:], "--outputs", "tension_B"]) == 0
        assert f"{case.solve().outputs['tension_B'][0]:.8g}" in capsys.readouterr().out


def test_a_scenario_that_neighbours_disturb_is_found(monkeypatch):
    case = Case(QUICK, _anything.draw(QUICK, 40, np.random.default_rng(1))[0].parameters, {})
    results = case.solve()
    ok = np.flatnonzero(results.status == Status.ok)[:5]
    solved = case.rows(ok)
    answers = solved.solve()
    assert (_anything.other_bits_alone(solved, answers)[:3] == 0.0).all()
    first = {name: value.copy() for name, value in answers.outputs.items()}
    first["wave_height"][1] = np.nextafter(first["wave_height"][1], np.inf)
    changed = Results(first, answers.status, answers.iterations, answers.seconds)
    assert _anything.other_bits_alone(solved, changed)[:3].tolist() == [0.0, np.inf, 0.0]


def test_what_is_found_is_counted_told_and_ends_in_exit_code_1(monkeypatch, capsys, tmp_path):
    assert main(["hunt", QUICK, "--scenarios", "50", "--write", str(tmp_path / "hunt.csv")]) == 0
    assert "wrong:" not in capsys.readouterr().out
    assert (tmp_path / "hunt.csv").read_text().startswith("solver,scenarios,ok,")

    suspects = 0

    def suspicious(case, results):
        nonlocal suspects
        found = np.arange(case.size) < 3
        suspects += np.count_nonzero(found)
        return np.where(found, 2.5, np.nan)

    monkeypatch.setattr(_hunt, "judges_of", lambda solver: {"suspicion": suspicious})
    assert main(["hunt", QUICK, "--scenarios", "50"]) == 1
    out = capsys.readouterr().out
    assert (
        out.count("wrong: suspicion missed by 2.5 times what is allowed\n  cablesim solve tow_wave_height ")
        == suspects
        > 0
    )
    assert f"suspicion 2.5 ({suspects})" in out


@pytest.mark.parametrize(
    ("arguments", "phrase"),
    [
        (("catenary_exakt",), "catenary_exact"),
        (("--scenarios", "0"), "--scenarios"),
        (("--part", "3"), "0/4"),
        (("--part", "4/4"), "0/4"),
        (("--seed", "-1"), "--seed"),
    ],
)
def test_a_wrong_request_is_refused_in_one_line(arguments, phrase, capsys):
    assert main(["hunt", *arguments]) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.count("\n") == 1
    assert phrase in said.err
