"""How a solver declares its parameters and options, and the batch of scenarios that it is given.

`Parameters` is a frozen dataclass on `Batch`, its fields made by `parameter`; `Options` one whose fields are made by
`option`. Everything is checked when it is made, so a solver meets only values that it declared possible.
"""

import dataclasses
import re
from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np

from cablesim.errors import InputError, nearest
from cablesim.numerics import Array
from cablesim.quantities import quantity
from cablesim.units import NUMBER

# Beyond this no length, force or stiffness is physical, and squares of squares stay clear of overflow.
LARGEST = 1e60


def parameter(
    *,
    typical: tuple[float, float],
    above: float | None = None,
    default: float | None = None,
    instead_of: str | None = None,
) -> Any:
    """A field of `Parameters`.

    `typical` is the range that property tests and sampling start from; `above` an open lower bound; `instead_of` names
    the parameter that this one replaces: exactly one of the two is given.
    """
    metadata = {"typical": typical, "above": above, "instead_of": instead_of, "default": default}
    return field(default=default, metadata=metadata)


def option(
    default: Any,
    *,
    meaning: str,
    at_least: float | None = None,
    at_most: float | None = None,
    one_of: tuple[str, ...] = (),
) -> Any:
    """A field of `Options`: a numerical setting of the method, not a property of the line."""
    return field(
        default=default, metadata={"meaning": meaning, "at_least": at_least, "at_most": at_most, "one_of": one_of}
    )


@dataclass(frozen=True)
class Batch:
    """Parameters of many scenarios: every field a float array of shape (scenario,), checked when it is made.

    Scalars and arrays of one length go together. Raises InputError naming the parameter, its value and unit, how many
    are wrong and which is the first.
    """

    def __post_init__(self) -> None:
        given = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        arrays = {
            name: np.atleast_1d(np.asarray(value, dtype=float)) for name, value in given.items() if value is not None
        }
        check_given(type(self), set(arrays))
        sizes = {array.size for array in arrays.values() if array.size != 1}
        if len(sizes) > 1 or any(array.ndim > 1 for array in arrays.values()):
            shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
            raise InputError(f"parameters must be scalars or arrays of one length, not {shapes}")
        for spec in specs(type(self)):
            if spec.name in arrays:
                spec.check(arrays[spec.name])
        for name, array in arrays.items():
            object.__setattr__(self, name, np.ascontiguousarray(np.broadcast_to(array, max(sizes, default=1))))

    @property
    def size(self) -> int:
        """The number of scenarios."""
        return next(v.size for f in dataclasses.fields(self) if (v := getattr(self, f.name)) is not None)

    def part(self, rows: slice) -> Self:
        """Some of the scenarios, already checked."""
        piece = object.__new__(type(self))
        for f in dataclasses.fields(self):
            value = getattr(self, f.name)
            object.__setattr__(piece, f.name, None if value is None else value[rows])
        return piece


@dataclass(frozen=True)
class NoOptions:
    """A method with nothing to set."""


@dataclass(frozen=True)
class ParameterSpec:
    """One parameter as declared: name, unit, bounds, default and what it may stand in for."""

    name: str
    typical: tuple[float, float]
    above: float | None
    default: float | None
    instead_of: str | None

    @property
    def unit(self) -> str:
        return quantity(self.name).unit

    def check(self, values: Array) -> None:
        """Raises InputError unless every value is finite, inside the declared bound and of a physical magnitude."""
        if not values.size:
            raise InputError(f"{self.name} has no values")
        least = -LARGEST if self.above is None else max(np.nextafter(self.above, np.inf), 1.0 / LARGEST)
        # A NaN is the minimum of whatever it stands among, and no comparison with it holds.
        if values.min() >= least and values.max() <= LARGEST:
            return
        bad = ~((values >= least) & (values <= LARGEST))
        first = int(np.argmax(bad))
        count = f"{int(bad.sum())} of {bad.size} are not (first: scenario {first}, " if bad.size > 1 else "it is "
        closing = ")" if bad.size > 1 else ""
        shown = "" if self.unit == "1" else f" {self.unit}"
        raise InputError(f"{self.name} must be {self.bounds}: {count}{values.flat[first]:g}{shown}{closing}")

    @property
    def bounds(self) -> str:
        shown = "" if self.unit == "1" else f" {self.unit}"
        return "finite" if self.above is None else f"finite and > {self.above:g}{shown}"


@dataclass(frozen=True)
class OptionSpec:
    """One numerical option as declared."""

    name: str
    default: Any
    meaning: str
    at_least: float | None
    at_most: float | None
    one_of: tuple[str, ...]

    def read_text(self, text: str) -> Any:
        """The value of an option given as text, as on the command line."""
        wanted = type(self.default)
        if wanted is str or not re.fullmatch(NUMBER, text):
            return self.read(text)
        return self.read(int(text) if wanted is int and text.lstrip("+-").isdigit() else float(text))

    def read(self, value: Any) -> Any:
        """The value in the type of the default. Raises InputError for another type, or outside what is allowed."""
        wanted = type(self.default)
        if wanted is float and isinstance(value, int) and not isinstance(value, bool):
            value = float(value)
        if not isinstance(value, wanted) or isinstance(value, bool) or not self._inside(value):
            raise InputError(f"option {self.name} must be {self.allowed}, not {value!r:.60}")
        value = wanted(value)
        if self.one_of and value not in self.one_of:
            raise InputError(f"option {self.name} must be {self.allowed}, not {value!r}: {nearest(value, self.one_of)}")
        return value

    def _inside(self, value: Any) -> bool:
        low = self.at_least is None or value >= self.at_least
        return low and (self.at_most is None or value <= self.at_most)

    @property
    def allowed(self) -> str:
        if self.one_of:
            return "one of " + ", ".join(self.one_of)
        kind = {int: "a whole number", float: "a number", str: "a word"}[type(self.default)]
        if self.at_least is not None and self.at_most is not None:
            return f"{kind} from {self.at_least:g} to {self.at_most:g}"
        return kind if self.at_least is None else f"{kind} >= {self.at_least:g}"


def specs(parameters: type) -> tuple[ParameterSpec, ...]:
    """The parameters that a class declares."""
    return tuple(ParameterSpec(name=f.name, **f.metadata) for f in dataclasses.fields(parameters))


def check_given(parameters: type, given: set[str]) -> None:
    """Raises InputError unless every required parameter is given, and exactly one of each pair of alternatives."""
    replaced = {spec.instead_of: spec.name for spec in specs(parameters) if spec.instead_of}
    for spec in specs(parameters):
        other = replaced.get(spec.name)
        if other and spec.name in given and other in given:
            raise InputError(f"{spec.name} and {other} are both given: one of them says it all")
        if spec.name in given or (other and other in given) or spec.default is not None or spec.instead_of:
            continue
        wanted = f"{spec.name} (or {other})" if other else spec.name
        raise InputError(f"missing parameter {wanted} [{spec.unit}], {quantity(spec.name).meaning}")
