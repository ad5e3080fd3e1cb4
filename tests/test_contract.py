"""Promises of every solver, checked over whatever is in the folder and over every problem that it solves."""

import numpy as np
import pytest

from cablesim import batch
from cablesim.errors import InputError
from cablesim.quantities import LIST, QUANTITIES, is_list, is_vector, quantity
from cablesim.solver import Solver, load_solver, solver_names
from cablesim.status import Status
from tests.helpers import draw, number_of_sections, problems

SOLVERS = [load_solver(name) for name in solver_names()]
PROBLEMS = [(solver, number) for solver in SOLVERS for number in range(len(problems(solver.name)))]
# Instead of the true size of a block: its end is what matters, and expensive methods get there sooner.
BLOCK = 200

every_solver = pytest.mark.parametrize("solver", SOLVERS, ids=lambda s: s.name)


def each_problem(cases: list[tuple[Solver, int]]) -> pytest.MarkDecorator:
    names = ["-".join((solver.name, *problems(solver.name)[number])) for solver, number in cases]
    return pytest.mark.parametrize(("solver", "problem"), cases, ids=names)


every_problem = each_problem(PROBLEMS)


def scenarios(solver: Solver, size: int, problem: int) -> dict[str, np.ndarray]:
    return draw(solver.name, size, seed=1, problem=problem)


@every_solver
def test_every_name_is_in_the_table_of_quantities(solver):
    assert set(solver.outputs) <= set(QUANTITIES)
    assert set(solver.parameters) <= set(QUANTITIES)
    for name, spec in solver.parameters.items():
        assert spec.vector == is_vector(name), name
        assert spec.listed == is_list(name), name


@every_solver
def test_the_docstring_starts_with_a_sentence_and_names_a_reference(solver):
    assert solver.summary.endswith(".")
    assert "Reference:" in solver.module.__doc__


@every_problem
def test_a_scenario_does_not_depend_on_its_neighbours(solver, problem, monkeypatch):
    monkeypatch.setattr(batch, "BLOCK", BLOCK)
    values = scenarios(solver, BLOCK + 100, problem)
    together = batch.solve(solver.name, values)
    for i in (0, 1, 77, BLOCK - 1, BLOCK, BLOCK + 99):
        alone = batch.solve(solver.name, {name: value[i] for name, value in values.items()})
        assert alone.status[0] == together.status[i]
        for name, value in alone.outputs.items():
            # Its own sections are all that a line has when it is alone.
            own = together.outputs[name][i][: len(value[0])] if value.ndim > 1 else together.outputs[name][i]
            # The same bits, not nearly the same: assert_array_equal takes NaN as equal to NaN.
            np.testing.assert_array_equal(value[0], own, err_msg=name)


@every_problem
def test_the_order_of_scenarios_does_not_matter(solver, problem):
    values = scenarios(solver, 500, problem)
    order = np.random.default_rng(2).permutation(500)
    straight = batch.solve(solver.name, values)
    shuffled = batch.solve(solver.name, {name: value[order] for name, value in values.items()})
    for name, value in straight.outputs.items():
        np.testing.assert_array_equal(value[order], shuffled.outputs[name], err_msg=name)


@every_problem
def test_failed_means_nan_in_every_output_and_only_failed_does(solver, problem):
    """Sections that a line does not have are NaN too."""
    values = scenarios(solver, 500, problem)
    found = batch.solve(solver.name, values, outputs=solver.answered(solver.make_options({})))
    failed = found.status != Status.ok
    assert failed.sum() < failed.size
    for name, value in found.outputs.items():
        expected = failed.reshape(-1, *(1,) * (value.ndim - 1))
        if quantity(name).dims[:1] == LIST:
            ended = np.arange(value.shape[1]) >= number_of_sections(values)[:, None]
            expected = expected | ended.reshape(*ended.shape, *(1,) * (value.ndim - 2))
        np.testing.assert_array_equal(np.isnan(value), np.broadcast_to(expected, value.shape), err_msg=name)


@every_problem
def test_only_the_wanted_outputs_come_back(solver, problem):
    wanted = solver.outputs[-1:]
    assert tuple(batch.solve(solver.name, scenarios(solver, 3, problem), outputs=wanted).outputs) == wanted


@each_problem([(solver, number) for solver, number in PROBLEMS if getattr(solver.module, "RECORDS", False)])
def test_what_is_recorded_does_not_depend_on_what_else_is_asked(solver, problem):
    values = scenarios(solver, 4, problem)
    outputs = solver.answered(solver.make_options({}))
    everything = batch.solve(solver.name, values, outputs=outputs)
    for name in outputs:
        alone = batch.solve(solver.name, values, outputs=(name,))
        np.testing.assert_array_equal(alone.outputs[name], everything.outputs[name], err_msg=name)


@each_problem([(solver, number) for solver, number in PROBLEMS if problems(solver.name)[number]])
def test_what_is_given_comes_back_as_it_was_given(solver, problem):
    """Within 1e-9 of the whole: an end that was to be met is met, a length or a force is not changed."""
    given = [name for name in problems(solver.name)[problem] if name in solver.outputs]
    values = scenarios(solver, 200, problem)
    found = batch.solve(solver.name, values, outputs=solver.answered(solver.make_options({})))
    solved = found.status == Status.ok
    for name in given:
        wanted, answer = (v[solved].reshape(solved.sum(), -1) for v in (values[name], found.outputs[name]))
        scale = np.linalg.norm(wanted, axis=1) if name != "position_B" else values["line_length"][solved]
        assert (np.linalg.norm(answer - wanted, axis=1) <= 1e-9 * scale).all(), name


@every_problem
def test_inputs_are_never_changed(solver, problem):
    values = scenarios(solver, 50, problem)
    before = {name: value.copy() for name, value in values.items()}
    batch.solve(solver.name, values)
    for name, value in values.items():
        np.testing.assert_array_equal(value, before[name])


@every_problem
def test_every_parameter_is_checked_at_the_door(solver, problem):
    for name, value in scenarios(solver, 3, problem).items():
        if solver.parameters[name].words:
            wrong = np.where(np.arange(3) == 1, "nonsense", value)
            complaint = f"^{name}: unknown value 'nonsense'"
        else:
            wrong = value.copy()
            wrong[1] = np.nan
            complaint = rf"^{name} must be finite.*1 of 3 are not \(first: scenario 1"
        with pytest.raises(InputError, match=complaint):
            batch.solve(solver.name, {**scenarios(solver, 3, problem), name: wrong})


@each_problem([(solver, number) for solver, number in PROBLEMS if any(map(is_list, draw(solver.name, 1, 1, number)))])
def test_lists_of_other_lengths_or_with_a_gap_are_refused(solver, problem):
    values = scenarios(solver, 20, problem)
    longest = int(number_of_sections(values).argmax())
    lists = [name for name, spec in solver.parameters.items() if spec.listed]
    for name in lists:
        shorter, broken = values[name].copy(), values[name].copy()
        shorter[longest, -1] = broken[longest, 1] = np.nan
        with pytest.raises(
            InputError, match=rf"^{name} must be finite.* \(first: scenario {longest}, nan .*section 2\)"
        ):
            batch.solve(solver.name, values | {name: broken})
        if len(lists) > 1:
            complaint = (
                rf"must have the same number of sections: 1 of 20 .*\(first: scenario {longest}, [56] and [56]\)"
            )
            with pytest.raises(InputError, match=complaint):
                batch.solve(solver.name, values | {name: shorter})


@every_problem
def test_the_solver_says_how_many_iterations_it_took_if_it_iterates(solver, problem):
    found = batch.solve(solver.name, scenarios(solver, 100, problem))
    assert (found.iterations > 0).any() == solver.iterates
