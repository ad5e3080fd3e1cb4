"""Adapters to other programs: the same line gives the same answer, and what is missing or fails is said."""

import numpy as np
import pytest

from cablesim import sources
from cablesim.batch import solve
from cablesim.hunt._stream_check import LOADED_ROPE
from cablesim.peers import _each
from cablesim.solver import load_solver, peer_names
from cablesim.status import Status
from tests.wave_check import CASE, without

HANGING = {
    "span": 100.0,
    "line_length": np.array([100.5, 104.0, 130.0]),
    "weight_per_length": 10.0,
    "axial_stiffness": 1e8,
}
TOWED = {"section_length": [400.0, 50.0], "section_weight": [90.0, 600.0], "horizontal_distance": 440.0, "rise": 2.0}
BETWEEN = LOADED_ROPE | {
    "weight_per_length": 30.0,
    "position_B": [-40.0, 0.0, 30.0],
    "line_length": 60.0,
    "friction_law": "cosine_squared",
}
MOVED = CASE | {"length_ratio": 0.99, "duration": 30.0}

# A peer, ours, the line, the output, the peer's options, and how far they may be apart: a hundred times the tolerance
# that is asked for, or what the peer's model is said to leave out.
PAIRS = {
    "moorpy_catenary": ("catenary_elastic", HANGING, "max_tension", {"tolerance": 1e-9}, 1e-7),
    "fsolve_catenary": ("catenary_elastic", HANGING, "max_tension", {"xtol": 1e-10}, 1e-8),
    "fsolve_composite": ("composite_line", TOWED, "tension_B", {"xtol": 1e-10}, 1e-8),
    # Its line stretches by a thousandth of its slack, which changes the tension by half of that.
    "moorpy_composite": ("composite_line", TOWED, "tension_B", {"tolerance": 1e-6}, 1e-3),
    "ivp_line": ("stream_line", BETWEEN, "force_B", {"rtol": 1e-8}, 1e-6),
    # It replaces the drag by a uniform load.
    "moorpy_stream": ("stream_line", BETWEEN, "max_tension", {}, 0.05),
    # Added mass and drag refer to other directions than an element's, and 20 elements are coarse.
    "moordyn_line": ("wave_line", MOVED, "max_top_tension", {"segments": 20, "step_share": 0.5}, 5e-3),
}


def test_every_peer_is_compared():
    assert set(PAIRS) == set(peer_names())


@pytest.mark.parametrize("peer", PAIRS)
def test_a_peer_finds_what_we_find(peer):
    ours, line, output, options, within = PAIRS[peer]
    shared = {"segments": 20, "mass": "lumped"} if ours == "wave_line" else {}
    theirs, exact = solve(peer, line, options, (output,)), solve(ours, line, shared, (output,))
    assert (theirs.status == Status.ok).all() and (exact.status == Status.ok).all()
    found, expected = theirs.outputs[output], exact.outputs[output]
    assert np.linalg.norm(found - expected) <= within * np.linalg.norm(expected)
    assert (found != expected).any()  # not ours under another name


def test_a_line_from_a_known_force_is_integrated_to_its_end():
    line = without(BETWEEN, "position_B") | {"force_A": [-50.0, 0.0, 250.0]}
    theirs = solve("ivp_line", line, {"scheme": "DOP853", "rtol": 1e-9}, ("position_B",))
    ours = solve("stream_line", line, outputs=("position_B",))
    np.testing.assert_allclose(theirs.outputs["position_B"], ours.outputs["position_B"], rtol=0, atol=60.0 * 1e-7)


def test_a_tow_line_under_a_given_pull_is_solved_by_brentq():
    line = without(TOWED, "horizontal_distance") | {"horizontal_tension": 2e5}
    theirs = solve("fsolve_composite", line, {"xtol": 1e-12}, ("max_tension",))
    ours = solve("composite_line", line, outputs=("max_tension",))
    np.testing.assert_allclose(theirs.outputs["max_tension"], ours.outputs["max_tension"], rtol=1e-9)


@pytest.mark.parametrize("peer", [name for name in PAIRS if load_solver(name).requires])
def test_without_its_program_a_peer_is_unavailable(peer, monkeypatch):
    monkeypatch.setattr(_each, "is_there", lambda module: False)
    _, line, output, _, _ = PAIRS[peer]
    found = solve(peer, line, outputs=(output,))
    assert (found.status == Status.unavailable).all()
    assert np.isnan(found.outputs[output]).all()


def test_what_a_peer_cannot_do_is_not_converged():
    sidewards = solve("ivp_line", BETWEEN | {"heading": 0.5}, outputs=("force_A",))
    waves = solve("moordyn_line", MOVED | {"wave_height": 1.0}, outputs=("max_top_tension",))
    pulled = without(TOWED, "horizontal_distance") | {"horizontal_tension": 2e5}
    held = solve("moorpy_composite", pulled, outputs=("max_tension",))
    assert [one.status.tolist() for one in (sidewards, waves, held)] == [[Status.not_converged]] * 3


def test_a_line_that_makes_the_program_raise_does_not_end_the_batch(monkeypatch):
    from cablesim.peers import fsolve_catenary

    real = fsolve_catenary.end_tensions

    def broken(line, xtol):
        if line["line_length"] == HANGING["line_length"][1]:
            raise ZeroDivisionError
        return real(line, xtol)

    monkeypatch.setattr(fsolve_catenary, "end_tensions", broken)
    found = solve("fsolve_catenary", HANGING)
    assert found.status.tolist() == [Status.ok, Status.not_converged, Status.ok]


def test_results_of_a_peer_are_named_by_the_version_of_its_program(monkeypatch):
    digests = []
    for version in ("1.3.0", "1.4.0", ""):
        monkeypatch.setattr(sources, "installed", lambda distribution, version=version: version)
        digests.append(sources.source_digest("moorpy_catenary"))
    assert len(set(digests)) == 3
    assert sources.source_digest("catenary_exact") == sources.source_digest("catenary_exact")
