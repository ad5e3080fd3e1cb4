"""Values with units, as people write them, turned into SI floats at the door.

A bare number is SI. "2.5 m", "12 kN", "30 deg", "5 mm", "3 %" are converted by pint, which is imported only when a unit
is met. Text is matched against a narrow pattern first, so nothing that is not a number and a plain product of units
reaches the unit library.
"""

import math
import re
from collections.abc import Iterable
from functools import cache
from typing import Any

from cablesim.errors import InputError

# The unit of a number written without one, which fits any dimension.
BARE = "any"
NUMBER = r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?"
_UNIT_NAME = r"[A-Za-zµμ°%]{1,20}"
_POWER = r"(?:\s?(?:\^|\*\*)?-?[0-9])?"
UNIT = rf"{_UNIT_NAME}{_POWER}(?:(?:\s?[*/·]\s?|\s){_UNIT_NAME}{_POWER}){{0,5}}"
DIGITS, POWERS = "-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"
RAISED, LOWERED = str.maketrans(DIGITS, POWERS), str.maketrans(POWERS, DIGITS)
# Units that have a sign.
SHOWN = {"deg": "°", "degree": "°", "percent": "%"}
_VALUE = re.compile(rf"\s*({NUMBER})\s*({UNIT})?\s*")


def to_si(value: Any, unit: str) -> float:
    """A number, or text such as "12 kN", as a finite float in the SI `unit` of its quantity.

    Raises InputError where the text is no value, the unit is unknown or of another dimension, or the value not finite.
    """
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise InputError(f"{value!r} is not a number or a number with a unit")
    if isinstance(value, str):
        match = _VALUE.fullmatch(value) if len(value) <= 80 else None
        if match is None:
            raise InputError(f"{value[:80]!r} is not a number or a number with a unit{_expected(unit)}")
        number = float(match[1]) * (factor(match[2], unit) if match[2] else 1.0)
    else:
        number = float(value) if abs(value) < 1e300 else math.inf
    if not math.isfinite(number):
        raise InputError(f"{value!r} is not a finite number{_expected(unit)}")
    return number


def unit_of(value: Any) -> str:
    """The unit that a value is written with."""
    match = _VALUE.fullmatch(value) if isinstance(value, str) and len(value) <= 80 else None
    return (match[2] or BARE) if match else BARE


@cache
def factor(given: str, unit: str) -> float:
    """What a value in the unit `given` is multiplied with to be in `unit`.

    Raises InputError for an unknown unit or one of another dimension.
    """
    if _powers(given) == _powers(unit):
        return 1.0
    import pint

    try:
        _unit(given)
    except InputError as problem:
        raise InputError(f"{problem}{_expected(unit)}") from None
    try:
        if _is_angle(given) != _is_angle(unit):
            raise InputError(f"the unit '{given}' is of another dimension{_expected(unit)}")
        return float(_unit(given).to(_unit(unit).units).magnitude)
    except pint.errors.DimensionalityError:
        raise InputError(f"the unit '{given}' is of another dimension{_expected(unit)}") from None


def _powers(unit: str) -> dict[str, int]:
    """Names and powers of a product of units: "N/m" and "N m-1" are the same, and need no unit library to say so."""
    powers: dict[str, int] = {}
    for sign, name, power in re.findall(rf"([*/·]?)\s?({_UNIT_NAME})\s?(?:\^|\*\*)?(-?[0-9])?", unit):
        powers[name] = powers.get(name, 0) + (-1 if sign == "/" else 1) * int(power or 1)
    return powers


def is_known(unit: str) -> bool:
    """Whether a unit can be used: it is a plain product, and all of it is known."""
    if unit != "1" and not re.fullmatch(UNIT, unit):
        return False
    try:
        _unit(unit)
    except InputError:
        return False
    return True


def base_unit(unit: str) -> str:
    """The SI base unit of a unit: "kN" -> "kg m s-2". Raises InputError for an unknown one."""
    return _cf(_unit(unit).to_base_units().units)


def compatible(first: str, second: str) -> bool:
    """Whether two units measure the same dimension."""
    return _unit(first).is_compatible_with(_unit(second))


def simplest(unit: str, known: Iterable[str]) -> str:
    """The first of the known units, all of them SI, that is equal to a product of SI units; else its base unit.

    "N/m*m" -> "N". An angle is not a plain number.
    """
    same = (one for one in known if compatible(unit, one) and _is_angle(unit) == _is_angle(one))
    return next(same, None) or base_unit(unit)


def shown(unit: str) -> str:
    """A unit with raised powers: "kN/m" and "kN m-1" are "kN m⁻¹"; nothing for a plain number."""
    if unit == "1":
        return ""
    powers = _powers(unit)
    named = (
        f"{SHOWN.get(name, name)}{'' if power == 1 else str(power).translate(RAISED)}" for name, power in powers.items()
    )
    return " ".join(named)


def dimensions(unit: str) -> dict[str, float]:
    """Powers of length, mass and time in a unit: "N" -> {"[length]": 1, "[mass]": 1, "[time]": -2}."""
    return dict(_unit(unit).dimensionality)


def product(first: str, second: str, power_of_second: float) -> str:
    """The unit of first * second**power; a bare number has no say."""
    if BARE in (first, second):
        return BARE
    return _cf((_unit(first) * _unit(second) ** power_of_second).units)


def power(unit: str, exponent: float) -> str:
    """The unit of a power; a bare number stays one."""
    return BARE if unit == BARE else _cf((_unit(unit) ** exponent).units)


def _cf(unit: Any) -> str:
    return f"{unit:~C}" or "1"


def _expected(unit: str) -> str:
    return ": a plain number is expected" if unit == "1" else f": a value in {unit} is expected"


@cache
def _unit(unit: str) -> Any:
    """One of the unit, as pint has it."""
    import pint

    try:
        one = _registry().Quantity(1.0, _registry().parse_units(_pint_spelling(unit)))
        one.to_base_units()
    except (pint.errors.PintError, AssertionError, AttributeError, ValueError, TypeError, KeyError):
        raise InputError(f"unknown unit '{unit}'") from None
    if not one._is_multiplicative:
        raise InputError(f"the unit '{unit}' is no multiple of another: decibels and degrees Celsius are not used here")
    return one


def _is_angle(unit: str) -> bool:
    return "radian" in str(_unit(unit).to_base_units().units)


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry()


def _pint_spelling(unit: str) -> str:
    """CF and everyday spellings ("N m-1", "kg/m^3", "%") as pint reads them."""
    if unit == "1":
        return "dimensionless"
    spaced = unit.replace("%", "percent").replace("°", "degree").replace("·", "*")
    spaced = re.sub(r"(?<=[A-Za-zµμ])\s?(?:\^|\*\*)?(-?\d(?:\.\d+)?)", r"**\1", spaced)
    return re.sub(r"(?<=[\w)])\s+(?=[A-Za-zµμ])", "*", spaced)
