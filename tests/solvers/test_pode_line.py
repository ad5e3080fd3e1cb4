"""Plane lines by Pode's functions against the integrated line, 20-digit references and the handbook's example."""

from functools import cache

import numpy as np
import pytest

from cablesim.batch import default_outputs, solve
from cablesim.hunt._stream_check import LOADED_ROPE, ROPE, norm, random_problems
from cablesim.numerics import Array
from cablesim.physics.stream import FRICTION_LAWS, critical_angle
from cablesim.solver import load_solver
from cablesim.status import Status
from tests.helpers import REFERENCE, draw, in_plane, read_table, rows

# All but what tells of the work.
OUTPUTS = tuple(name for name in default_outputs(load_solver("pode_line")) if name not in ("steps", "closing_error"))
AGREE = 1e-9
PROMISED = 1e-11
EXAMPLE = {
    "weight_per_length": np.sin(np.radians(30.0)) ** 2 / np.cos(np.radians(30.0)),
    "diameter": 0.02,
    "normal_drag_coefficient": 2.0 / (1000.0 * 0.02),
    "tangential_drag_coefficient": 0.025 * 2.0 / (1000.0 * 0.02),
    "fluid_density": 1000.0,
    "stream_speed": 1.0,
    "line_length": 86.36,
}


def plane_problems(size: int, seed: int) -> dict[str, np.ndarray]:
    """Lines between two points of the plane of a stream along x or, in every other one, of any heading."""
    line = in_plane(random_problems(size, seed))
    line["heading"] = np.random.default_rng(seed).uniform(-3.0, 3.0, size) * (np.arange(size) % 2)
    x, _, z = line["position_B"].T
    line["position_B"] = np.column_stack([x * np.cos(line["heading"]), x * np.sin(line["heading"]), z])
    return line


def assert_agree(line: dict[str, np.ndarray], tolerance: Array | float = AGREE) -> None:
    """Both methods solve all lines, and agree relative to the largest tension and the length."""
    found, expected = solve("pode_line", line), solve("stream_line", line)
    assert (expected.status == Status.ok).all()
    np.testing.assert_array_equal(found.status, expected.status)
    length, tension = expected.outputs["line_length"], expected.outputs["max_tension"]
    for name in OUTPUTS:
        one, other = found.outputs[name], expected.outputs[name]
        error = norm(one - other) if one.ndim == 2 else np.abs(one - other)
        if name.startswith("angle"):
            # The direction of a nearly slack end is only as good as the force there.
            end = expected.outputs[f"tension_{name[-1]}"]
            error, scale = np.minimum(error, 2.0 * np.pi - error) * end, tension
        else:
            scale = tension if "tension" in name or "force" in name else length
        if name in ("lowest_point", "farthest_point"):
            # A flat peak: a height that is off by rounding moves its place by the root of that.
            across = 2 if name == "lowest_point" else 0
            level = heights(line, one, across) - heights(line, other, across)
            assert (np.abs(level) <= tolerance * scale).all(), name
            assert (error <= 1e-5 * scale).all(), name
            continue
        assert (error <= tolerance * scale).all(), (name, np.max(error / scale))


def heights(line: dict[str, np.ndarray], points: Array, across: int) -> Array:
    """Of points above A, or downstream of it."""
    if across == 2:
        return points[:, 2]
    heading = line.get("heading", np.zeros(len(points)))
    return points[:, 0] * np.cos(heading) + points[:, 1] * np.sin(heading)


# ---- against the integrated line ----


@pytest.mark.parametrize("law", FRICTION_LAWS)
def test_a_line_of_known_force_is_the_integrated_line(law: str) -> None:
    """Taut ones: through a slack part an error in the last digit of the force grows in either method."""
    line = draw("pode_line", 400, seed=1) | {"friction_law": np.full(400, law)}
    tension = solve("stream_line", line, outputs=("profile_tension",)).outputs["profile_tension"]
    taut = tension.min(axis=1) > 1e-2 * tension.max(axis=1)
    assert taut.sum() > 100
    assert_agree(rows(line, taut))


def test_a_line_to_a_depth_is_the_integrated_line() -> None:
    line = draw("pode_line", 600, seed=2, problem=1)
    found, expected = solve("pode_line", line), solve("stream_line", line)
    np.testing.assert_array_equal(found.status, expected.status)
    reached = expected.status == Status.ok
    assert (expected.status == Status.infeasible).sum() > 10 and reached.sum() > 300
    some = rows(line, reached)
    tension = solve("stream_line", some, outputs=("profile_tension",)).outputs["profile_tension"]
    taut = tension.min(axis=1) > 1e-2 * tension.max(axis=1)
    assert taut.sum() > 200
    assert_agree(rows(some, taut))


@cache
def between_ends() -> dict[str, np.ndarray]:
    return plane_problems(400, seed=3)


def test_a_line_between_two_points_is_the_integrated_line() -> None:
    line = between_ends()
    assert (line["weight_per_length"] < 0.0).sum() > 20
    # Both meet B to 1e-13 of the length; a taut line's tension is as sure as its slack.
    slack = 1.0 - norm(line["position_B"]) / line["line_length"]
    assert_agree(line, AGREE + 1e-12 / slack)


def test_its_ends_are_met() -> None:
    line = between_ends()
    found = solve("pode_line", line).outputs
    assert (found["closing_error"] <= 1e-12 * line["line_length"]).all()
    assert (norm(found["position_B"] - line["position_B"]) <= 1e-12 * line["line_length"]).all()


def test_lines_of_both_half_turns_are_met() -> None:
    """Walked with the angle falling from A, and as lines seen from their other end."""
    line = draw("pode_line", 300, seed=4)
    found = solve("pode_line", line).outputs
    back = solve("pode_line", line | {"force_A": -found["force_B"]})
    assert (back.status == Status.ok).all()
    tension = solve("pode_line", line, outputs=("profile_tension",)).outputs["profile_tension"]
    taut = tension.min(axis=1) > 1e-2 * tension.max(axis=1)
    scale = found["max_tension"]
    assert (norm(back.outputs["force_B"] + line["force_A"])[taut] <= AGREE * scale[taut]).all()
    assert (norm(back.outputs["position_B"] + found["position_B"])[taut] <= AGREE * line["line_length"][taut]).all()
    against = found["angle_A"] < np.pi
    assert against.sum() > 50 and (~against).sum() > 50


def test_a_floating_line_is_the_mirror_image_of_a_heavy_one() -> None:
    line = draw("pode_line", 300, seed=5)
    found = solve("pode_line", line)
    flip = np.array([1.0, 1.0, -1.0])
    mirrored = {"weight_per_length": -line["weight_per_length"], "force_A": line["force_A"] * flip}
    floating = solve("pode_line", line | mirrored)
    np.testing.assert_array_equal(floating.status, found.status)
    for name in ("position_B", "force_A", "force_B"):
        np.testing.assert_array_equal(floating.outputs[name], found.outputs[name] * flip, err_msg=name)
    np.testing.assert_array_equal(floating.outputs["max_tension"], found.outputs["max_tension"])


@pytest.mark.parametrize("problem", [0, 2])
def test_a_line_in_still_water_is_the_integrated_line(problem: int) -> None:
    line = draw("pode_line", 200, seed=6, problem=problem)
    line["stream_speed"] = np.zeros(200)
    tension = solve("stream_line", line, outputs=("profile_tension",)).outputs["profile_tension"]
    taut = (tension.min(axis=1) > 1e-2 * tension.max(axis=1)) | (problem == 2)
    assert taut.sum() > 50
    assert_agree(rows(line, taut))


def test_a_neutral_line_is_the_integrated_line() -> None:
    line = draw("pode_line", 200, seed=7) | {"weight_per_length": np.zeros(200)}
    tension = solve("stream_line", line, outputs=("profile_tension",)).outputs["profile_tension"]
    taut = tension.min(axis=1) > 1e-2 * tension.max(axis=1)
    assert taut.sum() > 50
    assert_agree(rows(line, taut))


def test_the_profile_is_that_of_the_integrated_line() -> None:
    line = rows(between_ends(), slice(60))
    one, other = (
        solve(name, line, {"nodes": 21}, ("profile", "profile_tension")).outputs
        for name in ("pode_line", "stream_line")
    )
    slack = 1.0 - norm(line["position_B"]) / line["line_length"]
    tolerance = (AGREE + 1e-12 / slack)[:, None]
    assert (norm(one["profile"] - other["profile"]) <= tolerance * line["line_length"][:, None]).all()
    largest = other["profile_tension"].max(axis=1, keepdims=True)
    assert (np.abs(one["profile_tension"] - other["profile_tension"]) <= tolerance * largest).all()


# ---- references ----


def test_the_plane_references_keep_the_promised_digits() -> None:
    table = read_table(REFERENCE / "stream_lines.csv")
    plane = (table["lay_angle"] == 0.0) & (table["heading"] == 0.0) & (table["force_A_y"] == 0.0)
    table = rows(table, plane)
    assert table["line_length"].size >= 30
    vectors = {
        name: np.column_stack([table.pop(f"{name}_{c}") for c in "xyz"])
        for name in ("force_A", "position_B", "force_B")
    }
    expected = {name: table.pop(name) for name in ("tension_A", "tension_B", "max_tension")}
    found = solve("pode_line", table | {"force_A": vectors["force_A"]})
    assert (found.status == Status.ok).all()
    out = found.outputs
    assert (norm(out["position_B"] - vectors["position_B"]) <= PROMISED * table["line_length"]).all()
    assert (norm(out["force_B"] - vectors["force_B"]) <= PROMISED * expected["tension_B"]).all()
    np.testing.assert_allclose(out["max_tension"], expected["max_tension"], rtol=PROMISED)


# ---- example 4 of the handbook ----


@cache
def example() -> tuple[dict[str, float], dict[str, Array]]:
    rows_ = [line.split(",") for line in (REFERENCE / "pode_example4.csv").read_text().splitlines() if line[0] != "#"]
    found = solve("pode_line", EXAMPLE | {"position_B": [0.0, 0.0, 30.48]})
    assert found.status == Status.ok
    return {name: float(value) for name, value in rows_[1:]}, found.outputs


def test_example_4_is_solved_to_the_last_digits_of_its_reference() -> None:
    """The book's x runs against the stream; a unit of force is the normal drag on one metre, here 1 N."""
    expected, found = example()
    for end in ("A", "B"):
        assert np.degrees(found[f"angle_{end}"][0]) == pytest.approx(expected[f"angle_{end}"], rel=PROMISED)
        assert found[f"tension_{end}"][0] == pytest.approx(expected[f"tension_{end}"], rel=PROMISED)
    scale = 1e-11 * 86.36
    lowest, farthest = found["lowest_point"][0], found["farthest_point"][0]
    np.testing.assert_allclose(lowest, [-expected["x_180"], 0.0, expected["y_180"]], atol=scale)
    np.testing.assert_allclose(farthest, [-expected["x_90"], 0.0, expected["y_90"]], atol=scale)


def test_the_book_is_off_by_what_its_coarse_table_costs() -> None:
    """Printed: 31.09 and 208.43 deg, lowest (-21.563, -8.034) m, farthest (-33.964, 0.84) m."""
    _, found = example()
    assert 0.02 < 31.09 - np.degrees(found["angle_B"][0]) < 0.03
    assert 0.12 < np.degrees(found["angle_A"][0]) - 208.43 < 0.13
    assert np.hypot(found["lowest_point"][0][0] - 21.563, found["lowest_point"][0][2] + 8.034) < 0.1
    assert np.hypot(found["farthest_point"][0][0] - 33.964, found["farthest_point"][0][2] - 0.84) < 0.1


# ---- what has no answer ----

LINE = LOADED_ROPE | {"line_length": 10.0}
OUT_OF_PLANE = {
    "a force across the stream": {"force_A": [10.0, 1e-6, 50.0]},
    "an end across the stream": {"position_B": [3.0, 1e-6, 4.0]},
    "another heading": {"force_A": [10.0, 0.0, 50.0], "heading": 0.1},
    "a lay angle": {"force_A": [10.0, 0.0, 50.0], "lay_angle": 0.1},
    "a left-hand lay angle": {"force_A": [10.0, 0.0, 50.0], "lay_angle": -1.4},
    "friction and no drag across": {"force_A": [10.0, 0.0, 50.0], "normal_drag_coefficient": 0.0},
    "no load at all": {"force_A": [0.0, 0.0, 0.0], "weight_per_length": 0.0, "stream_speed": 0.0},
}


@pytest.mark.parametrize("given", OUT_OF_PLANE.values(), ids=OUT_OF_PLANE)
def test_a_line_is_out_of_domain_that_has(given: dict[str, object]) -> None:
    found = solve("pode_line", LINE | given, outputs=load_solver("pode_line").outputs)
    assert found.status == Status.out_of_domain
    for name, values in found.outputs.items():
        assert np.isnan(values).all(), name


@pytest.mark.parametrize("length", [5.0, 4.9])
def test_a_line_no_longer_than_its_chord_is_infeasible(length: float) -> None:
    found = solve("pode_line", LINE | {"line_length": length, "position_B": [3.0, 0.0, 4.0]})
    assert found.status == Status.infeasible


def test_a_floating_line_never_reaches_a_depth_above_its_end() -> None:
    line = {name: value for name, value in LINE.items() if name != "line_length"} | {"weight_per_length": -5.0}
    found = solve("pode_line", line | {"depth": 10.0, "force_A": [10.0, 0.0, -20.0]})
    assert found.status == Status.infeasible


def test_a_nearly_straight_line_is_no_longer_than_it_is() -> None:
    """Found by the hunt: lightly loaded or near a singular angle, B was off by up to 6e-6 of the length."""
    line = {
        "weight_per_length": [0.0, 157.08702282446342],
        "diameter": [0.01496950346076259, 0.007686633112888072],
        "normal_drag_coefficient": [1.1841208165714228, 1.2792966675140094],
        "tangential_drag_coefficient": [0.0, 0.026946697788757166],
        "friction_law": ["zero", "cosine_squared"],
        "fluid_density": [1.2, 1025.0],
        "stream_speed": [0.018660018140571024, 0.0],
        "force_A": [
            [2.270961896363962e-07, 0.0, -1.1874261756910725e-14],
            [5122755.651476796, 0.0, -105524944082.44814],
        ],
    }
    length = np.array([0.0019153438553266761, 2775.02733688429])
    found, expected = (solve(name, line | {"line_length": length}) for name in ("pode_line", "stream_line"))
    assert (found.status == Status.ok).all()
    off = norm(found.outputs["position_B"] - expected.outputs["position_B"])
    assert (off <= PROMISED * length).all()


def test_a_tension_that_keeps_too_few_digits_is_out_of_domain() -> None:
    """Found by the hunt: weightless, 1e-8 rad off the stream, `force_B` was off by up to 1e-5; 1e-5 rad will do."""
    line = LOADED_ROPE | {"weight_per_length": 0.0, "line_length": 100.0, "heading": 0.0}
    found = solve("pode_line", line | {"force_A": [[-1e5, 0.0, 1e-3], [-1e5, 0.0, 1.0]]})
    assert found.status.tolist() == [Status.out_of_domain, Status.ok]


def test_a_force_near_the_unstable_angle_does_not_tell_where_a_long_line_ends() -> None:
    """Found by the hunt: both methods were ok and apart. Towards the slack end a turn grows beyond 1e6 times."""
    drag = 0.5 * LINE["fluid_density"] * LINE["diameter"] * LINE["normal_drag_coefficient"]
    angle = critical_angle(np.array([LINE["weight_per_length"]]), np.array([drag]))[0] + np.pi + 1e-9
    line = LINE | {"force_A": [-1e3 * np.cos(angle), 0.0, 1e3 * np.sin(angle)], "line_length": [200.0, 400.0]}
    for solver in ("stream_line", "pode_line"):
        assert solve(solver, line).status.tolist() == [Status.ok, Status.out_of_domain]


def test_behind_a_part_without_tension_only_the_closed_form_goes_on() -> None:
    """Towed by its upstream end, all but weightless, the tension of this line falls to next to nothing after 96 m."""
    line = ROPE | {"weight_per_length": 1e-6, "stream_speed": 1.3, "force_A": [50.0, 0.0, 0.0]}
    lengths = {"line_length": [90.0, 400.0]}
    assert solve("stream_line", line | lengths).status.tolist() == [Status.ok, Status.out_of_domain]
    assert (solve("pode_line", line | lengths).status == Status.ok).all()


def test_a_depth_is_out_of_domain_where_the_range_of_angles_ends_before() -> None:
    """Found by the hunt: these were infeasible, and `stream_line` solved them."""
    light = {"weight_per_length": 6.142308156371406e-06, "diameter": 0.031029982724101506, "depth": 1.0121380881536621}
    stream = {"normal_drag_coefficient": 1.2357157629170832, "tangential_drag_coefficient": 0.0, "heading": 0.0}
    line = light | stream | {"fluid_density": 1.2, "stream_speed": 2.301427582253079}
    found = solve("pode_line", line | {"force_A": [[-2.0116282640484844e-05, 0.0, 0.0], [0.0, 0.0, 0.0]]})
    assert (found.status == Status.out_of_domain).all()
