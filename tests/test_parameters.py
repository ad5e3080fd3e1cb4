"""Batches: numbers, words and vectors are checked when they are made, and each problem kind has its own parameters."""

import numpy as np
import pytest

from cablesim import batch
from cablesim.errors import InputError
from cablesim.parameters import ParameterSpec
from cablesim.quantities import component_names, quantity

LAW = "friction_law"


def made(solver, **values):
    return solver.make_parameters(values)


def test_a_word_becomes_its_position_and_a_vector_three_columns(pulled_line):
    p = made(pulled_line, force_A=[[0, 0, 1], [0, 0, 2]], line_length=3.0, friction_law=["zero", "constant"])
    assert p.friction_law.dtype == np.int64
    assert p.friction_law.tolist() == [2, 0]
    assert p.force_A.shape == (2, 3)
    assert p.line_length.tolist() == [3.0, 3.0]
    assert p.size == 2
    assert p.part(slice(1, 2)).force_A.tolist() == [[0.0, 0.0, 2.0]]


def test_one_vector_serves_all_scenarios(pulled_line):
    assert made(pulled_line, force_A=[0, 0, 1], line_length=[1.0, 2.0]).force_A.shape == (2, 3)


def test_words_of_other_libraries_are_words(pulled_line):
    laws = np.array(["zero", "constant"], dtype=object)
    assert made(pulled_line, force_A=[0, 0, 1], line_length=1.0, friction_law=laws).friction_law.tolist() == [2, 0]


def test_components_make_a_vector(pulled_line):
    p = made(pulled_line, force_A_x=0.0, force_A_y=[1.0, 2.0], force_A_z=3.0, line_length=1.0)
    assert p.force_A.tolist() == [[0.0, 1.0, 3.0], [0.0, 2.0, 3.0]]


def test_parameters_of_other_problems_are_none(pulled_line):
    p = made(pulled_line, force_A=[0, 0, 1], depth=3.0)
    assert p.line_length is None
    assert p.position_B is None


WRONG = {
    "three problems": (
        {"depth": 1.0, "position_B": [0, 0, 1]},
        "give force_A and line_length, or force_A and depth, or ",
    ),
    "what was given": ({"depth": 1.0}, "given: line_length, force_A, depth$"),
    "an unknown word": ({LAW: "constnt"}, "^friction_law: unknown value 'constnt': did you mean constant?"),
    "one unknown word of two": ({LAW: ["zero", "none"]}, "^friction_law: unknown value 'none'"),
    "no words": ({LAW: []}, "^friction_law has no values$"),
    "a number for a word": ({LAW: 2}, "^friction_law must be one of constant, cosine_squared, zero: it is 2$"),
    "a word for a number": ({"lay_angle": "wide"}, "^lay_angle must be numbers, not 'wide'$"),
    "a vector of two": ({"force_A": [1, 2]}, r"^force_A must have three components \(x, y, z\): it has 2$"),
    "a vector that is a number": ({"force_A": 1.0}, "three components .*: it has 1$"),
    "not finite": ({"force_A": [[0, 0, 1], [0, np.nan, 1]]}, r"1 of 2 are not \(first: scenario 1, 0, nan, 1 N\)$"),
    "other lengths": ({"force_A": np.ones((2, 3)), "lay_angle": [0, 0, 0]}, "arrays of one length"),
    "below a closed bound": ({"lay_angle": -0.1}, "^lay_angle must be finite, >= 0 and < 1.5 rad: it is -0.1 rad$"),
    "at an open bound": ({"lay_angle": 1.5}, "^lay_angle must be finite, >= 0 and < 1.5 rad: it is 1.5 rad$"),
}


@pytest.mark.parametrize(("values", "complaint"), WRONG.values(), ids=WRONG)
def test_what_cannot_be_is_refused(values, complaint, pulled_line):
    with pytest.raises(InputError, match=complaint):
        made(pulled_line, **{"force_A": [0, 0, 1], "line_length": 1.0, **values})


@pytest.mark.parametrize(
    ("values", "complaint"),
    [
        ({"force_A_x": 1.0, "force_A_z": 1.0}, "force_A has three components: force_A_y must be given as well"),
        ({"force_A": [0, 0, 1], "force_A_z": 1.0}, "force_A is given twice"),
        ({"force_A_x": [1.0, 2.0], "force_A_y": 0.0, "force_A_z": [1, 2, 3]}, "arrays of one length"),
    ],
)
def test_a_vector_in_part_or_twice_is_refused(values, complaint, pulled_line):
    with pytest.raises(InputError, match=complaint):
        made(pulled_line, line_length=1.0, **values)


@pytest.mark.parametrize(
    ("bounds", "good", "bad"),
    [
        ({"above": 0.0}, [1e-59, 1e60], [0.0, -1.0, 1e-61, np.inf]),
        ({"above": -2.0}, [-1.99, 0.0], [-2.0, -3.0]),
        ({"at_least": 0.0}, [0.0, 5.0], [-1e-9]),
        ({"below": 1.0}, [0.999, -5.0], [1.0, -1e61]),
        ({"at_most": 1.0}, [1.0], [1.0 + 1e-15]),
    ],
)
def test_bounds_are_open_or_closed(bounds, good, bad):
    every = {"above": None, "at_least": None, "below": None, "at_most": None, **bounds}
    spec = ParameterSpec("depth", typical=None, default=None, instead_of=None, words=(), vector=False, **every)
    spec.check(np.array(good))
    for value in bad:
        with pytest.raises(InputError, match=r"^depth must be finite"):
            spec.check(np.array([value]))


def test_a_component_is_a_quantity():
    row = quantity("force_A_z")
    assert (row.unit, row.dims) == ("N", ())
    assert row.meaning.startswith("z component of force_A")
    assert component_names("profile") == ("profile",)


def test_vectors_are_among_the_outputs_that_come_back_unasked(pulled_line):
    found = batch.solve("pulled_line", {"force_A": [[0, 3, 4], [0, 0, 0]], "line_length": 10.0})
    assert "profile" not in found.outputs
    np.testing.assert_allclose(found.outputs["position_B"][0], [0.0, 6.0, 8.0])
    assert np.isnan(found.outputs["position_B"][1]).all()


def test_a_compiled_solver_is_called_once_before_the_clock_starts(pulled_line):
    calls = pulled_line.module.CALLS
    calls.clear()
    batch.solve("pulled_line", {"force_A": np.ones((5, 3)), "line_length": 10.0})
    assert calls == [1, 5]
