"""Batches: numbers, words, vectors and lists are checked when they are made; each problem has its own parameters."""

import numpy as np
import pytest

from cablesim import batch
from cablesim.errors import InputError
from cablesim.parameters import ParameterSpec
from cablesim.quantities import MOST_SECTIONS, QUANTITIES, component_names, list_name, quantity, section_number
from cablesim.solver import load_solver
from cablesim.status import Status

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


# ---- lists ----


@pytest.fixture
def joined_line(pulled_line):
    """A solver with lists."""
    yield load_solver("joined_line")
    load_solver.cache_clear()


SAME_LISTS = {
    "lists of other lengths": {"section_length": [[400, 50], [300]], "section_weight": [[80, 600], [70]]},
    "arrays": {
        "section_length": [np.array([400.0, 50.0]), np.array([300.0])],
        "section_weight": np.array([[80, 600], [70, np.nan]]),
    },
    "padded more than it need be": {
        "section_length": [[400, 50, np.nan], [300, np.nan, np.nan]],
        "section_weight": [(80, 600), (70,)],
    },
    "columns": {
        "section_length_1": [400, 300],
        "section_length_2": [50, np.nan],
        "section_weight_1": [80, 70],
        "section_weight_2": [600, np.nan],
        "section_weight_3": np.nan,
    },
}


@pytest.mark.parametrize("lists", SAME_LISTS.values(), ids=SAME_LISTS)
def test_lists_are_padded_to_the_longest(lists, joined_line):
    p = made(joined_line, **lists, tension_A=1.0)
    np.testing.assert_array_equal(p.section_length, [[400.0, 50.0], [300.0, np.nan]])
    np.testing.assert_array_equal(p.section_weight, [[80.0, 600.0], [70.0, np.nan]])
    assert p.section_length.dtype == np.float64
    assert p.section_length.flags.c_contiguous
    assert p.sections.tolist() == [2, 1]
    assert p.sections.dtype == np.int64
    assert p.part(slice(1, 2)).sections.tolist() == [1]
    assert p.size == 2


def test_one_list_serves_all_scenarios(joined_line):
    p = made(joined_line, section_length=[400, 50], section_weight=[[80, 600], [70, 500], [60, 1]], tension_A=1.0)
    assert p.section_length.tolist() == [[400.0, 50.0]] * 3
    assert made(joined_line, section_length=[4, 5], section_weight=[8, 6], tension_A=[1.0, 2.0]).sections.tolist() == [
        2,
        2,
    ]


def test_a_line_has_as_many_sections_as_it_likes(joined_line):
    many = np.ones(100 * MOST_SECTIONS)
    found = batch.solve("joined_line", {"section_length": many, "section_weight": many, "tension_A": 1.0})
    assert found.outputs["joint_tension"].shape == (1, many.size)
    assert found.outputs["tension_B"].tolist() == [1.0 + many.size]


def test_sections_that_a_line_does_not_have_are_no_failure(joined_line, monkeypatch):
    monkeypatch.setattr(batch, "BLOCK", 2)
    lists = {"section_length": [[1, 2, 3], [4], [5, 6]], "section_weight": [[1, 1, 1], [1], [1, 1]]}
    found = batch.solve("joined_line", {**lists, "tension_A": 1.0, "depth": [0, 5, 0]})
    assert found.status.tolist() == [Status.ok, Status.infeasible, Status.ok]
    nan = np.nan
    np.testing.assert_array_equal(found.outputs["joint_tension"], [[2, 4, 7], [nan, nan, nan], [6, 12, nan]])


@pytest.mark.parametrize("section", [0, 1])
def test_an_answer_that_is_missing_for_a_section_is_a_failure(section, joined_line, monkeypatch):
    def solve(p, options):
        solution = joined(p, options)
        solution.answer.joint_tension[1, section] = np.nan
        return solution

    joined = joined_line.module.solve
    monkeypatch.setattr(joined_line.module, "solve", solve)
    lists = {"section_length": [[1, 2, 3], [4, 5]], "section_weight": [[1, 1, 1], [1, 1]]}
    found = batch.solve("joined_line", {**lists, "tension_A": 1.0}, outputs=("joint_tension", "line_length"))
    assert found.status.tolist() == [Status.ok, Status.out_of_domain]
    assert np.isnan(found.outputs["line_length"]).tolist() == [False, True]


def test_answers_with_components_for_each_section_are_as_long_as_their_lines(joined_line, monkeypatch):
    class Answer:
        joint_position = np.array([[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], [[7.0, 8.0, 9.0], [np.nan] * 3]])

    ok = np.zeros(2, dtype=np.int8)
    monkeypatch.setattr(joined_line.module, "OUTPUTS", ("joint_position",))
    monkeypatch.setattr(joined_line.module, "solve", lambda p, options: batch.Solution(ok, Answer))
    lists = {"section_length": [[1, 2], [4]], "section_weight": [[1, 1], [1]]}
    asked = {"outputs": ("joint_position",)}
    assert batch.solve("joined_line", {**lists, "tension_A": 1.0}, **asked).status.tolist() == [0, 0]
    Answer.joint_position[0, 1, 2] = np.nan
    assert batch.solve("joined_line", {**lists, "tension_A": 1.0}, **asked).status.tolist() == [Status.out_of_domain, 0]


WRONG_LISTS = {
    "a number": ({"section_length": 400.0}, "^section_length must be a list of numbers, or one list .*, not 400$"),
    "too deep": ({"section_length": np.ones((1, 1, 2))}, r"not an array of shape \(1, 1, 2\)$"),
    "numbers and lists": ({"section_length": [1, [2]]}, r"^section_length must be numbers, not \[1, \[2\]\]$"),
    "a word": ({"section_length": ["long", 2]}, "^section_length must be numbers"),
    "no sections": ({"section_length": []}, "^section_length has no values$"),
    "a line without sections": (
        {"section_length": [[1, 2], []]},
        r"^section_length must be finite and > 0 m: 1 of 2 are not \(first: scenario 1, nan m in section 1\)$",
    ),
    "nothing but NaN": ({"section_length": [np.nan, np.nan]}, "it is nan m in section 1$"),
    "a gap": (
        {"section_length": [1, np.nan, 2]},
        "^section_length must be finite and > 0 m: it is nan m in section 2$",
    ),
    "a gap in one of three": (
        {"section_length": [[1, 2], [1, 2, 3], [1, np.nan, 3]]},
        r"1 of 3 are not \(first: scenario 2, nan m in section 2\)$",
    ),
    "out of bounds": (
        {"section_weight": [[1, 2], [3, -4]]},
        r"^section_weight must be finite and >= 0 N m-1: 1 of 2 are not \(first: scenario 1, -4 N m-1 in section 2\)$",
    ),
    "infinite": ({"section_length": [1, np.inf]}, "it is inf m in section 2$"),
    "other lengths": (
        {"section_length": [1, 2, 3]},
        "^section_length and section_weight must have the same number of sections: they have 3 and 2$",
    ),
    "other lengths of one line": (
        {"section_length": [[1, 2], [1, 2], [1]]},
        r"same number of sections: 1 of 3 lines have not \(first: scenario 2, 1 and 2\)$",
    ),
    "other numbers of scenarios": ({"section_length": [[1, 2]] * 3, "tension_A": [1, 2]}, "arrays of one length"),
    "whole and in part": ({"section_length_1": 1.0}, "^section_length is given twice: as a whole and by its sections$"),
}


@pytest.mark.parametrize(("values", "complaint"), WRONG_LISTS.values(), ids=WRONG_LISTS)
def test_what_cannot_be_a_list_is_refused(values, complaint, joined_line):
    with pytest.raises(InputError, match=complaint):
        made(joined_line, **{"section_length": [1, 2], "section_weight": [1, 2], "tension_A": 1.0, **values})


def test_a_list_without_a_section_is_refused(joined_line):
    with pytest.raises(
        InputError, match=r"^section_length has 4 sections: section_length_2 and section_length_3 must be"
    ):
        made(joined_line, section_length_1=1.0, section_length_4=1.0, section_weight=[1.0], tension_A=1.0)


def test_a_mistyped_name_is_not_answered_with_every_section(joined_line):
    with pytest.raises(InputError) as refused:
        made(joined_line, xyz=1.0)
    assert str(refused.value).endswith("known: depth, section_length, section_weight, tension_A")


def test_a_section_of_a_list_is_a_quantity():
    row = quantity("section_length_12")
    assert (row.unit, row.dims, row.symbol) == ("m", (), r"\ell_{12}")
    assert row.meaning == "section 12 of section_length, length of each section, from A to B"
    assert component_names("joint_tension", 2) == ("joint_tension_1", "joint_tension_2")
    assert component_names("section_length")[-1] == f"section_length_{MOST_SECTIONS}"
    assert (list_name("section_length_12"), section_number("section_length_12")) == ("section_length", 12)
    for other in ("section_length", "section_length_0", "section_length_01", "force_A_x", "tension_A", "depth_1"):
        assert (list_name(other), section_number(other)) == ("", 0)
    assert f"section_length_{MOST_SECTIONS + 1}" not in QUANTITIES


# ---- parameters that may be left out, and histories ----

SWUNG = {"depth": 10.0, "wave_period": [4.0, 8.0]}


@pytest.fixture
def swinging_line(pulled_line):
    """A solver with parameters that may be left out, and with histories."""
    solver = load_solver("swinging_line")
    solver.module.CALLS.clear()
    yield solver
    load_solver.cache_clear()


def test_what_may_be_left_out_is_none_and_otherwise_an_array(swinging_line):
    p = made(swinging_line, **SWUNG, duration=5.0)
    assert p.duration.tolist() == [5.0, 5.0]
    assert p.wave_height is p.top_amplitude is p.quadratic_stiffness is p.stiffness_ratio is None
    assert p.linear_stiffness.tolist() == [1e3, 1e3]
    assert p.part(slice(1, 2)).wave_height is None
    assert p.part(slice(1, 2)).duration.tolist() == [5.0]


@pytest.mark.parametrize("given", [{}, {"wave_height": 1.0}, {"top_amplitude": 2.0}])
@pytest.mark.parametrize("ratio", [{}, {"quadratic_stiffness": 1.0}, {"stiffness_ratio": -0.1}])
def test_any_of_what_may_be_left_out_is_taken(given, ratio, swinging_line):
    p = made(swinging_line, **SWUNG, **given, **ratio)
    found = {name for name in swinging_line.parameters if getattr(p, name) is not None}
    assert found == {"depth", "wave_period", "linear_stiffness", *given, *ratio}


def test_two_that_may_be_left_out_may_both_be_given(swinging_line):
    assert made(swinging_line, **SWUNG, wave_height=1.0, top_amplitude=2.0).size == 2


@pytest.mark.parametrize(
    ("values", "complaint"),
    [
        (
            {"quadratic_stiffness": 1.0, "stiffness_ratio": 1.0},
            "quadratic_stiffness and stiffness_ratio are both given",
        ),
        ({"duration": -1.0}, "^duration must be finite and > 0 s: it is -1 s$"),
        ({"wave_height": [1.0, np.nan]}, r"1 of 2 are not \(first: scenario 1, nan m\)$"),
    ],
)
def test_what_may_be_left_out_is_checked_if_it_is_given(values, complaint, swinging_line):
    with pytest.raises(InputError, match=complaint):
        made(swinging_line, **SWUNG, **values)


def test_what_must_be_given_is_still_asked_for(swinging_line):
    with pytest.raises(InputError, match=r"^missing parameter wave_period \[s\]"):
        made(swinging_line, depth=1.0, duration=2.0)


def test_the_solver_is_told_which_outputs_are_asked(swinging_line):
    found = batch.solve("swinging_line", SWUNG, outputs=("max_top_tension", "history"))
    asked = ("max_top_tension", "history")
    calls = swinging_line.module.CALLS
    assert calls == [("warm", 1, asked), ("solve", 2, asked)]
    assert found.outputs["history"].dtype == np.float32
    assert found.outputs["history"].shape == (2, 13, 3)


def test_histories_do_not_come_unasked(swinging_line):
    assert tuple(batch.solve("swinging_line", SWUNG).outputs) == ("max_top_tension",)
    checked = batch.solve("swinging_line", SWUNG, {"mesh_check": "yes"})
    assert tuple(checked.outputs) == ("max_top_tension", "mesh_change")
    with pytest.raises(InputError, match=r"^swinging_line has no output 'mesh_change' with these options$"):
        batch.solve("swinging_line", SWUNG, outputs=("mesh_change",))


def test_a_failed_scenario_has_no_history_and_one_too_large_for_its_numbers_fails(swinging_line):
    values = {
        "depth": 10.0,
        "wave_period": 4.0,
        "top_amplitude": [1.0, 11.0, 1.0],
        "linear_stiffness": [1e3, 1e3, 1e40],
    }
    found = batch.solve("swinging_line", values, outputs=("history", "snapshots"))
    assert found.status.tolist() == [Status.ok, Status.infeasible, Status.out_of_domain]
    for values in found.outputs.values():
        assert np.isnan(values.reshape(3, -1)).all(axis=1).tolist() == [False, True, True]


def test_long_histories_make_small_blocks(swinging_line, monkeypatch):
    values = {"depth": np.arange(1.0, 6.0), "wave_period": 4.0}
    whole = batch.solve("swinging_line", values, outputs=("history",))
    swinging_line.module.CALLS.clear()
    monkeypatch.setattr(batch, "MOST_NUMBERS", 100)
    cut = batch.solve("swinging_line", values, outputs=("history",))
    # 13 times at 3 places: two scenarios a block.
    assert [size for call, size, _ in swinging_line.module.CALLS if call == "solve"] == [2, 2, 1]
    np.testing.assert_array_equal(cut.outputs["history"], whole.outputs["history"])


@pytest.mark.parametrize("value", [np.inf, -np.inf, np.nan, 10**400, True, "1", None])
def test_an_option_without_bounds_is_still_a_number(value, pulled_line):
    with pytest.raises(InputError, match=r"^option factor must be a number, not"):
        pulled_line.make_options({"factor": value})
    assert pulled_line.make_options({"factor": 2}).factor == 2.0
