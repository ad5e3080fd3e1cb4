"""Promises of every solver, checked over whatever is in the folder."""

import numpy as np
import pytest

from cablesim import batch
from cablesim.quantities import QUANTITIES, is_vector
from cablesim.solver import Solver, load_solver, solver_names
from cablesim.status import Status
from tests.helpers import draw

pytestmark = pytest.mark.parametrize("solver", [load_solver(name) for name in solver_names()], ids=lambda s: s.name)


def scenarios(solver: Solver, size: int) -> dict[str, np.ndarray]:
    return draw(solver.name, size, seed=1)


def test_every_name_is_in_the_table_of_quantities(solver):
    assert set(solver.outputs) <= set(QUANTITIES)
    assert set(solver.parameters) <= set(QUANTITIES)
    for name, spec in solver.parameters.items():
        assert spec.vector == is_vector(name), name


def test_the_docstring_starts_with_a_sentence_and_names_a_reference(solver):
    assert solver.summary.endswith(".")
    assert "Reference:" in solver.module.__doc__


def test_a_scenario_does_not_depend_on_its_neighbours(solver):
    values = scenarios(solver, batch.BLOCK + 300)
    together = batch.solve(solver.name, values)
    chosen = [0, 1, 77, batch.BLOCK - 1, batch.BLOCK, batch.BLOCK + 299]
    for i in chosen:
        alone = batch.solve(solver.name, {name: value[i] for name, value in values.items()})
        assert alone.status[0] == together.status[i]
        for name, value in alone.outputs.items():
            # The same bits, not nearly the same: assert_array_equal takes NaN as equal to NaN.
            np.testing.assert_array_equal(value[0], together.outputs[name][i], err_msg=name)


def test_the_order_of_scenarios_does_not_matter(solver):
    values = scenarios(solver, 1000)
    order = np.random.default_rng(2).permutation(1000)
    straight = batch.solve(solver.name, values)
    shuffled = batch.solve(solver.name, {name: value[order] for name, value in values.items()})
    for name, value in straight.outputs.items():
        np.testing.assert_array_equal(value[order], shuffled.outputs[name], err_msg=name)


def test_failed_means_nan_in_every_output_and_only_failed_does(solver):
    found = batch.solve(solver.name, scenarios(solver, 2000), outputs=solver.outputs)
    failed = found.status != Status.ok
    assert failed.sum() < failed.size
    for name, value in found.outputs.items():
        missing = np.isnan(value).reshape(value.shape[0], -1)
        np.testing.assert_array_equal(missing.all(axis=1), failed, err_msg=name)
        np.testing.assert_array_equal(missing.any(axis=1), failed, err_msg=name)


def test_only_the_wanted_outputs_come_back(solver):
    wanted = solver.outputs[-1:]
    assert tuple(batch.solve(solver.name, scenarios(solver, 3), outputs=wanted).outputs) == wanted


def test_inputs_are_never_changed(solver):
    values = scenarios(solver, 50)
    before = {name: value.copy() for name, value in values.items()}
    batch.solve(solver.name, values)
    for name, value in values.items():
        np.testing.assert_array_equal(value, before[name])


def test_every_parameter_is_checked_at_the_door(solver):
    from cablesim.errors import InputError

    for name, value in scenarios(solver, 3).items():
        if solver.parameters[name].words:
            wrong = np.where(np.arange(3) == 1, "nonsense", value)
            complaint = f"^{name}: unknown value 'nonsense'"
        else:
            wrong = value.copy()
            wrong[1] = np.nan
            complaint = rf"^{name} must be finite.*1 of 3 are not \(first: scenario 1"
        with pytest.raises(InputError, match=complaint):
            batch.solve(solver.name, {**scenarios(solver, 3), name: wrong})


def test_the_solver_says_how_many_iterations_it_took_if_it_iterates(solver):
    found = batch.solve(solver.name, scenarios(solver, 100))
    assert (found.iterations > 0).any() == solver.iterates
