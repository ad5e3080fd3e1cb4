"""Values with units at the door."""

import math

import pytest

from cablesim import units
from cablesim.errors import InputError
from cablesim.labels import quantity_label


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        (2, "m", 2.0),
        ("2.5", "m", 2.5),
        ("2.5 m", "m", 2.5),
        ("5mm", "m", 0.005),
        ("12 kN", "N", 12e3),
        ("1 N/m", "N m-1", 1.0),
        ("3 N m-1", "N m-1", 3.0),
        ("30 deg", "rad", math.pi / 6),
        ("3 %", "1", 0.03),
        ("7850 kg/m^3", "kg m-3", 7850.0),
        ("36 kN/mm^2", "N m-2", 36e9),
        ("1 kgf/m", "N m-1", 9.80665),
        ("-1e-3 km", "m", -1.0),
        ("5 min", "s", 300.0),
    ],
)
def test_a_value_arrives_in_si(text, unit, value):
    # One rounding each in the factor and in the product.
    assert units.to_si(text, unit) == pytest.approx(value, rel=4e-16)


@pytest.mark.parametrize(
    ("value", "unit", "complaint"),
    [
        ("5 kg", "m", "the unit 'kg' is of another dimension"),
        ("5 blorps", "m", "unknown unit 'blorps'"),
        ("nan", "m", "not a number"),
        (math.nan, "m", "not a finite number"),
        (math.inf, "m", "not a finite number"),
        (10**400, "m", "not a finite number"),
        ("1e400", "m", "not a finite number"),
        ("1e308 km", "m", "not a finite number"),
        (True, "m", "not a number"),
        (None, "m", "not a number"),
        ([1], "m", "not a number"),
        ("", "m", "not a number"),
        ("two metres", "m", "not a number"),
        ("1 m; rm -rf", "m", "not a number"),
        ("2**9", "m", "not a number"),
        ("1 m" + " m" * 50, "m", "not a number"),
    ],
)
def test_anything_else_is_refused(value, unit, complaint):
    with pytest.raises(InputError, match=complaint):
        units.to_si(value, unit)


@pytest.mark.parametrize(
    ("name", "shown"), [("stream_speed", "m s⁻¹"), ("normal_drag", "kg m⁻²"), ("area", "m²"), ("depth", "m")]
)
def test_powers_are_raised_where_a_unit_is_shown(name, shown):
    assert quantity_label(name).plain.endswith(f" [{shown}]")
