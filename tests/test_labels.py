"""Words, symbols and units beside axes: those of the table of quantities, wherever they stand."""

import re
from pathlib import Path

import numpy as np
import pytest

from cablesim import units
from cablesim.config.figure_file import Figure
from cablesim.config.scene import read_scene
from cablesim.errors import InputError
from cablesim.expressions import BARE, Term, parse
from cablesim.labels import Label, quantity_label
from cablesim.quantities import QUANTITIES, TABLE
from cablesim.report.colours import DASHES
from tests.cli.helpers import scene

SCENES = sorted((Path(__file__).parent.parent / "config" / "scenes").glob("*.yaml"))
# The axes of each kind of figure; what shows a thing that is no formula shows this quantity.
AXES = {
    "curves": {"x": "", "y": ""},
    "map": {"x": "", "y": "", "value": ""},
    "status_map": {"x": ""},
    "profiles": {"x": "profile", "y": "profile"},
    "spatial": {"x": "profile", "y": "profile", "z": "profile"},
    "history": {"x": "history_time", "y": "history"},
    "orbit": {"x": "orbit", "y": "orbit"},
    "snapshots": {"x": "snapshots", "y": "snapshots", "value": "snapshot_tension"},
    "animation": {"x": "snapshots", "y": "snapshots", "value": "snapshot_tension"},
    "convergence": {"x": "", "y": ""},
    "work_precision": {"x": "run_time", "y": ""},
    "audit": {},
}
SIDES = ("x", "y", "z")


def known(name: str) -> Term:
    """What a name of a formula is in: of a method or not."""
    row = QUANTITIES.get(name.rpartition(".")[2])
    return Term(np.ones(1), row.unit if row else BARE)


def shown_by(figure: Figure, axis: str) -> list[str]:
    """The formulas that an axis shows; none where it shows something else."""
    if figure.kind not in ("curves", "map", "status_map"):
        return []
    found = figure.settings[axis]
    return list(found.values()) if isinstance(found, dict) else [found]


def unit_of(figure: Figure, axis: str) -> str:
    """The SI unit of what an axis shows, from the table alone."""
    formulas = shown_by(figure, axis)
    if formulas:
        return parse(formulas[0]).unit(known)
    name = AXES[figure.kind][axis] or (figure.settings.get("against", "") if axis == "x" else "")
    return QUANTITIES[name].unit if name in QUANTITIES else "1"


def quantity_of(figure: Figure, axis: str) -> str:
    """The quantity that an axis shows as it stands, by any method; none where that is more than one, or a formula."""
    names = {re.sub(r"^\w+\.(?=\w+$)", "", formula) for formula in shown_by(figure, axis)}
    return names.pop() if len(names) == 1 and names <= QUANTITIES.keys() else ""


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_every_axis_of_every_figure_has_the_units_and_symbols_of_the_table(path):
    for figure in read_scene(path).figures:
        axes = AXES[figure.kind] | ({"y": ""} if "y" in figure.settings else {})
        assert axes.keys() == figure.settings.get("labels", {}).keys() - {"each"}
        for axis in axes:
            label, unit = figure.label(axis), unit_of(figure, axis)
            assert units.compatible(label.unit, unit), (figure.name, axis)
            assert label.factor == pytest.approx(1.0 / units.factor(label.unit, unit)), (figure.name, axis)
            assert label.text.endswith(f"[{label.tex_unit}]") or units.shown(label.unit) == "", (figure.name, axis)
            assert label.words or figure.kind == "spatial", (figure.name, axis)
            name = quantity_of(figure, axis)
            if name:
                assert f"${QUANTITIES[name].symbol}$" in label.text, (figure.name, axis)
            if figure.kind not in ("curves", "map", "status_map") and AXES[figure.kind][axis]:
                assert label.symbol in (QUANTITIES[AXES[figure.kind][axis]].symbol, *SIDES), (figure.name, axis)


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_no_label_in_a_scene_file_has_a_unit_or_a_conversion_of_one(path):
    part = re.search(r"^figures:\n((?:[ ].*\n?|\n)*)", path.read_text(), re.MULTILINE)
    for line in part[1].splitlines() if part else ():
        if re.search(r"\blabel|_label", line):
            assert not re.search(r"label: [^,}]*\[", line), line
        assert not re.search(r"57\.29|/ 1000\b|/ 1e6\b|100 \* ", line), line


def test_all_symbols_can_be_read_as_plain_text_and_each_quantity_has_one_row():
    for row in QUANTITIES.values():
        plain = quantity_label(row.name).plain_symbol
        assert plain and plain.isprintable() and not set(plain) & set("\\{}$"), row.symbol
    names = [row.name for row in TABLE]
    assert len(names) == len(set(names))


@pytest.mark.parametrize(
    ("label", "text", "plain"),
    [
        (quantity_label("max_top_tension"), r"max top tension $T_{B,\max}$ [N]", "max top tension T_B,max [N]"),
        (quantity_label("critical_angle"), r"critical angle $\phi_c$ [°]", "critical angle φ_c [°]"),
        (quantity_label("length_ratio"), "length ratio $L/l$", "length ratio L/l"),
        (quantity_label("force_A_x"), "force A x $F_{A,x}$ [N]", "force A x F_A,x [N]"),
        (quantity_label("weight_per_length"), "weight per length $w$ [N m$^{-1}$]", "weight per length w [N m⁻¹]"),
        (quantity_label("internal_damping").in_unit("kN s"), None, "internal damping C_ε̇ [kN s]"),
        (quantity_label("richardson_top_tension"), None, "richardson top tension T_B,h →0 [N]"),
        (Label(r"slack $L/l$ - 1 for 5 \$"), r"slack $L/l$ - 1 for 5 \$", "slack L/l - 1 for 5 $"),
        (Label("", "", "%"), "[%]", "[%]"),
    ],
)
def test_a_label_is_the_same_for_matplotlib_and_as_plain_text(label, text, plain):
    assert label.plain == plain
    assert text is None or label.text == text


def test_a_label_in_another_unit_has_the_factor_to_it():
    label = quantity_label("max_tension").in_unit("kN")
    assert (label.unit, label.factor) == ("kN", pytest.approx(1e-3))
    assert label.in_unit("N").factor == pytest.approx(1.0)
    assert quantity_label("angle").factor == pytest.approx(180.0 / np.pi)
    with pytest.raises(InputError, match="'m' is of another dimension: a value in N is expected"):
        quantity_label("max_tension").in_unit("m")


# ---- scene files ----

DRAWN = {
    "design": "{grid: {length_ratio: [1.1, 1.2], rise: [0 m, 0.1 m]}}",
    "methods": "{exact: {solver: catenary_exact}, parabolic: {solver: catenary_parabolic, ignores: [rise]}}",
    "outputs": "[sag, max_tension]",
}


def read_figure(folder: Path, **look: object) -> Figure:
    path = folder / "asked.yaml"
    path.write_text(scene(**DRAWN, figures={"look": look}))
    return read_scene(path).figures[0]


CURVES = {"kind": "curves", "x": "length_ratio", "point": {"rise": "0 m"}}


@pytest.mark.parametrize(
    ("look", "x", "y"),
    [
        ({"y": "exact.sag"}, "length ratio L/l", "sag d [m]"),
        ({"y": "exact.sag", "y_unit": "mm", "y_label": "how deep"}, "length ratio L/l", "how deep d [mm]"),
        (
            {"x": "length_ratio - 1", "y": "100 * exact.max_tension", "x_unit": "%"},
            "(L/l) - 1 [%]",
            "100 * T_max [N]",
        ),
        (
            {"y": {"a": "exact.sag", "b": "parabolic.sag"}, "x_label": "slack {length_ratio} - 1"},
            "slack L/l - 1",
            "sag d [m]",
        ),
        (
            {"y": {"a": "exact.max_tension", "b": "span * weight_per_length"}, "y_unit": "kN"},
            "length ratio L/l",
            "[kN]",
        ),
        ({"y": "exact.max_tension / span + 3 N / 1 m"}, "length ratio L/l", "T_max / l + 3 N / 1 m [N m⁻¹]"),
        ({"y": "atan(exact.sag / span)"}, "length ratio L/l", "atan(d / l) [°]"),
        ({"y": "sqrt(exact.sag^2 + (2 m)^2)", "y_label": "{sag} and $5"}, "length ratio L/l", "d and $5 [m]"),
        ({"y": "exact.sag", "y_label": "$\\frac{$"}, "length ratio L/l", "$\\frac{$ d [m]"),
    ],
)
def test_labels_are_made_from_the_table(tmp_path, look, x, y):
    figure = read_figure(tmp_path, **{**CURVES, **look})
    assert (figure.label("x").plain, figure.label("y").plain) == (x, y)


@pytest.mark.parametrize(
    ("look", "complaint"),
    [
        (
            {"y": "exact.max_tension", "y_label": "tension [kN]"},
            r"asked.yaml:6: figures.look.y_label: .* \(\[N\]\): no brackets here; ask for another with y_unit",
        ),
        ({"y": "exact.max_tension", "y_unit": "m"}, "look.y_unit: .*another dimension: a value in N is expected"),
        ({"y": "exact.max_tension", "y_unit": "kNn"}, "look.y_unit: unknown unit 'kNn': a value in N is expected"),
        ({"y": "exact.sag / span", "y_unit": "mm"}, "look.y_unit: .*another dimension: a plain number is expected"),
        ({"y": "exact.sag", "y_unit": 5}, "figures.look.y_unit: text is expected"),
        ({"y": "exact.sag", "x_label": "slack {lenght_ratio}"}, "look.x_label: unknown quantity 'lenght_ratio'"),
        (
            {"y": {"a": "exact.sag", "b": "exact.max_tension"}},
            "look.y.b: its unit is N, that of 'exact.sag' is m: an axis has one unit",
        ),
        ({"y": "exact.sag + exact.max_tension"}, "look.y: .*a value in m cannot be .*added to one in N"),
        ({"y": "exact.sag", "unit": "m"}, "look.unit: unknown key 'unit'"),
    ],
)
def test_a_wrong_label_is_refused_with_the_unit_that_would_be_right(tmp_path, look, complaint):
    with pytest.raises(InputError, match=complaint):
        read_figure(tmp_path, **{**CURVES, **look})


def test_contours_are_in_si_and_may_have_units(tmp_path):
    look = {"kind": "map", "x": "length_ratio", "y": "rise", "value": "exact.sag", "unit": "mm"}
    figure = read_figure(tmp_path, **look, contours=["50 cm", 1])
    assert figure.settings["contours"] == (0.5, 1.0)
    assert figure.label("value").plain == "sag d [mm]"
    with pytest.raises(InputError, match=r"look.contours\[0\]: .*a value in m is expected"):
        read_figure(tmp_path, **look, contours=["5 kN"])


# ---- units ----


@pytest.mark.parametrize(
    ("formula", "unit"),
    [
        ("sag", "m"),
        ("2 * sag", "m"),
        ("sag - 3", "m"),
        ("3 - sag", "m"),
        ("max(1e-9, sag)", "m"),
        ("sag / span", "1"),
        ("1 / wave_period", "1/s"),
        ("max_tension * sag / span", "N"),
        ("sqrt(sag^2 + span^2)", "m"),
        ("angle - acos(sag / span)", "rad"),
        ("sinh(sag / span)", "1"),
        ("span * sinh(sag / span)", "m"),
        ("2 * 3", "1"),
        ("abs(-scenario)", "1"),
        ("5 kN / max_tension", "1"),
    ],
)
def test_the_unit_of_a_formula_is_computed(formula, unit):
    found = parse(formula).unit(known)
    assert units.simplest(found, dict.fromkeys(row.unit for row in TABLE)) == unit


@pytest.mark.parametrize(
    ("unit", "shown"), [("1", ""), ("kN/m", "kN m⁻¹"), ("kg m-3", "kg m⁻³"), ("deg", "°"), ("%", "%"), ("m^2", "m²")]
)
def test_units_are_shown_with_raised_powers(unit, shown):
    assert units.shown(unit) == shown


def test_methods_and_scenarios_are_told_apart_without_colour():
    assert len(set(DASHES)) == 4
