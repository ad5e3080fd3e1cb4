"""What the paper on lines of nonlinear elasticity claims, as the default study finds it."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from cablesim.config.scene import read_scene
from cablesim.database.reading import read_dataset
from cablesim.report.printed import printed_table
from cablesim.solver import load_solver
from cablesim.steps import run_scene
from cablesim.study import Layout, read_study

CONFIG = Path(__file__).parent.parent / "config"
TAUT, NEAREST, WIDE = 1, 2, 3


@pytest.fixture(scope="module")
def layout(tmp_path_factory) -> Layout:
    return Layout(tmp_path_factory.mktemp("waves"))


def read(name: str):
    return read_scene(CONFIG / "scenes" / f"{name}.yaml")


def run(name: str, layout: Layout):
    scene = read(name)
    run_scene(scene, layout, lambda step, done, total: None)
    return scene, read_dataset(layout.dataset(name))


@pytest.fixture(scope="module")
def claims(layout) -> pd.DataFrame:
    """The printed table of claims by setting and claim, as numbers."""
    scene, dataset = run("paper_claims", layout)
    table = printed_table(next(table for table in scene.printed if table.name == "claims"), dataset)
    numbers = table.set_index("claim").astype(float)
    return numbers.set_index(numbers["setting"].astype(int), append=True).swaplevel()


@pytest.fixture(scope="module")
def along(layout):
    return run("tension_along_line", layout)[1]


def outside(claims: pd.DataFrame, setting: int, reading: str) -> set[str]:
    """The first words of the claims that are not met."""
    missed = claims.loc[setting, f"{reading} outside by"]
    return set(missed.index[missed > 0.0].str.split(",").str[0])


SLACK = {"slack at 45 deg and ratio 0.2", "snaps in five periods at 45 deg and ratio 0.2"}
FALLS = {
    "fall at 45 deg and ratio 0.2",
    "fall at the top at ratio 0.18 (Fig. 5)",
    "fall in the middle less fall at the top",
    "fall at the anchor less fall at the top",
}


def test_softening_meets_every_claim_with_twice_the_amplitude(claims):
    assert outside(claims, WIDE, "softening") == set()


def test_softening_with_the_printed_amplitude_meets_the_claims_on_45_deg_but_not_slack(claims):
    assert outside(claims, TAUT, "softening") == {"greatest tension at 60 deg", *SLACK}


def test_no_reading_meets_all_claims_with_the_printed_amplitude_and_slack(claims):
    assert outside(claims, NEAREST, "softening") >= {"greatest tension at 60 deg", "fall at 45 deg and ratio 0.2"}
    assert not outside(claims, NEAREST, "softening") & SLACK


@pytest.mark.parametrize("setting", [TAUT, NEAREST, WIDE])
def test_the_law_as_printed_makes_no_tension_fall(claims, setting):
    assert outside(claims, setting, "as printed") >= FALLS
    falls = claims.loc[setting, "as printed"].filter(like="fall")
    # With strains of one percent a ratio of 0.2 is an effect of 0.2 %.
    assert falls.between(-0.5, 0.1).all()


def test_the_fall_is_as_large_as_the_mesh_and_the_ratio_say(claims):
    fall = claims.loc[(TAUT, "fall at 45 deg and ratio 0.2, %")]
    # The change on halving the elements is 0.01 % and the accuracy in time 0.1 %: the fall of 19.3 % is known to 0.2.
    assert fall["softening"] == pytest.approx(19.3, abs=0.2)
    assert fall["change on halving the elements [%]"] < 0.1


def test_the_tension_falls_more_at_the_anchor_than_at_the_top(along):
    ratio = -along["stiffness_ratio"].values / 100
    taut = (ratio > 0.0) & (along["top_amplitude"].values < 2.0)
    softening, linear = (along.sel({"method": name}) for name in ("softening", "linear"))
    falls = [
        1 - (softening[f"max_{place}_tension"] / linear[f"max_{place}_tension"]).values[taut]
        for place in ("top", "middle", "anchor")
    ]
    assert (np.diff(falls, axis=0) > 0.0).all()
    # The strain at the greatest tension is nearly 1 %, so that the fall is nearly the ratio.
    np.testing.assert_allclose(falls[1], ratio[taut], rtol=0.03)


def test_methods_that_do_without_the_law_are_solved_once_for_all_ratios(along):
    linear = along["max_top_tension"].sel({"method": "linear"})
    for amplitude in np.unique(along["top_amplitude"]):
        same = linear.values[along["top_amplitude"].values == amplitude]
        np.testing.assert_array_equal(same, same[0])


@pytest.mark.parametrize("name", ["config", "full"])
def test_a_study_of_lines_in_waves_can_be_read(name):
    scenes = read_study(CONFIG / f"{name}.yaml").scenes
    waves = [scene for scene in scenes if load_solver("wave_line") in [m.solver for m in scene.methods]]
    assert len(waves) == 13
