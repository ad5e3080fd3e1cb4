"""How a solver declares its parameters and options, and the batch of scenarios that it is given.

`Parameters` is a frozen dataclass on `Batch`, its fields made by `parameter`; `Options` one whose fields are made by
`option`. Everything is checked when it is made, so a solver meets only values that it declared possible.
"""

import dataclasses
import math
import re
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, ClassVar, Self

import numpy as np

from cablesim import units
from cablesim.errors import InputError, nearest
from cablesim.numerics import Array
from cablesim.quantities import COMPONENTS, component_names, is_list, is_vector, quantity

# Beyond this no length, force or stiffness is physical, and squares of squares stay clear of overflow.
LARGEST = 1e60


def parameter(
    *,
    typical: tuple[float, float] | None = None,
    above: float | None = None,
    at_least: float | None = None,
    below: float | None = None,
    at_most: float | None = None,
    default: float | str | None = None,
    otherwise: str | None = None,
    instead_of: str | None = None,
    words: tuple[str, ...] = (),
    vector: bool = False,
    listed: bool = False,
) -> Any:
    """A field of `Parameters`: a number, a word (one of `words`), a `vector` of three components, or a list.

    A `listed` parameter has one number for each section of the line, from A to B; all of a line have the same sections.

    `typical` is the range that property tests and sampling start from; `above` and `below` are open bounds, `at_least`
    and `at_most` closed ones; `instead_of` names the parameter that this one replaces: exactly one of the two is given.
    One that may be left out, and is then None, says in words what happens `otherwise`; so may one that replaces it.
    """
    bounds = {"above": above, "at_least": at_least, "below": below, "at_most": at_most}
    kind = {"words": words, "vector": vector, "listed": listed, "otherwise": otherwise}
    return field(
        default=default, metadata={"typical": typical, "default": default, "instead_of": instead_of, **kind, **bounds}
    )


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
    """Parameters of many scenarios, checked when they are made.

    A number is a float array of shape (scenario,), a vector one of shape (scenario, 3), a list one of shape (scenario,
    section), NaN after the last section of a line, a word its position among the declared words. Scalars and arrays of
    one length go together. `PROBLEMS` (optional) lists the groups of parameters of which exactly one is given; the
    others are None, as are those that may be left out and are. Raises InputError naming the parameter, its value and
    unit, how many are wrong and which is the first.
    """

    PROBLEMS: ClassVar[tuple[tuple[str, ...], ...]] = ()

    def __post_init__(self) -> None:
        given = {spec: value for spec in specs(type(self)) if (value := getattr(self, spec.name)) is not None}
        check_given(type(self), {spec.name for spec in given})
        arrays = {spec.name: spec.read(value) for spec, value in given.items()}
        size = common_length(arrays)
        for spec in given:
            spec.check(arrays[spec.name])
        check_sections({spec.name: arrays[spec.name] for spec in given if spec.listed})
        for name, array in arrays.items():
            whole = np.broadcast_to(array, (size, *array.shape[1:]))
            object.__setattr__(self, name, np.ascontiguousarray(whole))

    @property
    def size(self) -> int:
        """The number of scenarios."""
        return next(len(v) for f in dataclasses.fields(self) if (v := getattr(self, f.name)) is not None)

    @cached_property
    def sections(self) -> np.ndarray:
        """The number of sections of each line, of shape (scenario,), where there are listed parameters."""
        lists = (getattr(self, spec.name) for spec in specs(type(self)) if spec.listed)
        return count_sections(next(values for values in lists if values is not None))

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
    """One parameter as declared: name, unit, bounds, words, default and what it may stand in for.

    A column of a listed parameter has the number of its `section`; it is NaN where a line has fewer.
    """

    name: str
    typical: tuple[float, float] | None
    default: float | str | None
    instead_of: str | None
    words: tuple[str, ...]
    vector: bool
    above: float | None
    at_least: float | None
    below: float | None
    at_most: float | None
    listed: bool = False
    otherwise: str | None = None
    section: int = 0

    @property
    def unit(self) -> str:
        return quantity(self.name).unit

    @property
    def may_be_missing(self) -> bool:
        """Whether a scenario is complete without it."""
        return self.default is not None or self.otherwise is not None

    @cached_property
    def columns(self) -> tuple["ParameterSpec", ...]:
        """The scalars that a design holds for it: itself, the components of a vector or the sections of a list."""
        names = component_names(self.name)
        if self.listed:
            return tuple(replace(self, name=name, listed=False, section=i) for i, name in enumerate(names, start=1))
        return tuple(replace(self, name=name, vector=False) for name in names) if self.vector else (self,)

    def stored(self, value: float | str) -> float:
        """A value as a design holds it: a word by its position."""
        return float(self.words.index(value)) if isinstance(value, str) else value

    def restored(self, values: Array) -> np.ndarray:
        """Values that a design holds, with words as words again."""
        return np.array(self.words)[values.astype(int)] if self.words else values

    def read_text(self, text: str) -> Any:
        """The value of a parameter given as text, as on the command line; vectors and lists have commas."""
        if self.words:
            return text
        several = self.vector or self.listed
        try:
            values = [units.to_si(part, self.unit) for part in (text.split(",") if several else [text])]
        except InputError as problem:
            raise InputError(f"{self.name}: {problem}") from None
        return values if several else values[0]

    def read(self, value: Any) -> np.ndarray:
        """The value as an array with one entry per scenario; bounds are left to `check`.

        Raises InputError for what is no number, for an unknown word, for a vector without its three components and for
        what is neither a list nor one list a scenario.
        """
        if self.words:
            return self._positions(value)
        if self.listed:
            return self._lists(value)
        try:
            array = np.asarray(value, dtype=float)
        except (TypeError, ValueError):
            raise InputError(f"{self.name} must be numbers, not {value!r:.60}") from None
        if not self.vector:
            return np.atleast_1d(array)
        if array.ndim not in (1, 2) or array.shape[-1] != len(COMPONENTS):
            found = array.shape[-1] if array.ndim else 1
            raise InputError(f"{self.name} must have three components ({', '.join(COMPONENTS)}): it has {found}")
        return np.atleast_2d(array)

    def _lists(self, value: Any) -> Array:
        """One list a row, NaN after the end of those that are shorter than the longest."""
        try:
            array = np.asarray(value, dtype=float)
        except (TypeError, ValueError):
            array = self._padded(value)
        if array.ndim not in (1, 2):
            found = f"an array of shape {array.shape}" if array.ndim else f"{array:g}"
            raise InputError(f"{self.name} must be a list of numbers, or one list for each scenario, not {found}")
        lists = np.atleast_2d(array)
        longest = int(np.flatnonzero(~np.isnan(lists).all(axis=0)).max(initial=0)) + 1
        return lists[:, :longest]

    def _padded(self, value: Any) -> Array:
        try:
            rows = [np.asarray(row, dtype=float) for row in value]
        except (TypeError, ValueError):
            rows = []
        if not rows or any(row.ndim != 1 for row in rows):
            raise InputError(f"{self.name} must be numbers, not {value!r:.60}")
        lengths = np.array([row.size for row in rows])
        lists = np.full((len(rows), lengths.max()), np.nan)
        lists[np.arange(lengths.max()) < lengths[:, None]] = np.concatenate(rows)
        return lists

    def _positions(self, value: Any) -> np.ndarray:
        given = np.atleast_1d(np.asarray(value))
        # Columns of other libraries hold their texts as objects.
        texts = np.array(given.tolist()) if given.dtype.kind in "OT" else given
        if not texts.size:
            raise InputError(f"{self.name} has no values")
        if texts.dtype.kind != "U":
            raise InputError(f"{self.name} must be one of {', '.join(self.words)}: it is {texts.flat[0]!s:.60}")
        positions = np.full(texts.shape, -1, dtype=np.int64)
        for position, word in enumerate(self.words):
            positions[texts == word] = position
        if (positions < 0).any():
            unknown = str(texts.flat[int(np.argmax(positions < 0))])
            raise InputError(f"{self.name}: unknown value {unknown!r:.60}: {nearest(unknown, self.words)}")
        return positions

    def check(self, values: np.ndarray) -> None:
        """Raises InputError unless every value is finite, inside the declared bounds and of a physical magnitude.

        After the end of a list there is no value.
        """
        if not values.size or (self.section and np.isnan(values).all()):
            raise InputError(f"{self.name} has no values")
        least, most = self._least, self._most
        # A NaN is the minimum of whatever it stands among, and no comparison with it holds.
        if values.min() >= least and values.max() <= most:
            return
        each_good = ((values >= least) & (values <= most) | self._missing(values)).reshape(len(values), -1)
        good = each_good.all(axis=1)
        if good.all():
            return
        first = int(np.argmin(good))
        count = f"{int((~good).sum())} of {good.size} are not (first: scenario {first}, " if good.size > 1 else "it is "
        closing = ")" if good.size > 1 else ""
        shown = self._shown(values[first], int(np.argmin(each_good[first])))
        raise InputError(f"{self.name} must be {self.bounds}: {count}{shown}{closing}")

    def _missing(self, values: np.ndarray) -> np.ndarray:
        """Where there need not be a value, because the line has ended before."""
        missing = np.isnan(values) & (self.listed or self.section > 1)
        if self.listed:
            missing = np.logical_and.accumulate(missing[:, ::-1], axis=1)[:, ::-1]
            missing[:, 0] = False
        return missing

    def _shown(self, value: np.ndarray, position: int) -> str:
        if self.listed:
            return f"{value[position]:g}{self._shown_unit} in section {position + 1}"
        return ", ".join(f"{part:g}" for part in np.atleast_1d(value)) + self._shown_unit

    @property
    def limits(self) -> tuple[str, ...]:
        """The declared bounds in signs, without the unit."""
        signs = {">": self.above, ">=": self.at_least, "<": self.below, "<=": self.at_most}
        return tuple(f"{sign} {bound:g}" for sign, bound in signs.items() if bound is not None)

    @property
    def bounds(self) -> str:
        if not self.limits:
            return "finite"
        return ", ".join(("finite", *self.limits[:-1])) + f" and {self.limits[-1]}{self._shown_unit}"

    @property
    def _shown_unit(self) -> str:
        return "" if self.unit == "1" else f" {self.unit}"

    @property
    def _least(self) -> float:
        if self.above is not None:
            return float(np.nextafter(self.above, np.inf)) if self.above else 1.0 / LARGEST
        return -LARGEST if self.at_least is None else self.at_least

    @property
    def _most(self) -> float:
        if self.below is not None:
            return float(np.nextafter(self.below, -np.inf)) if self.below else -1.0 / LARGEST
        return LARGEST if self.at_most is None else self.at_most


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
        if wanted is str or not re.fullmatch(units.NUMBER, text):
            return self.read(text)
        return self.read(int(text) if wanted is int and text.lstrip("+-").isdigit() else float(text))

    def read(self, value: Any) -> Any:
        """The value in the type of the default. Raises InputError for another type, or outside what is allowed."""
        wanted = type(self.default)
        if wanted is float and isinstance(value, int) and not isinstance(value, bool):
            value = float(value) if abs(value) < LARGEST else math.inf
        if not isinstance(value, wanted) or isinstance(value, bool) or not self._inside(value):
            raise InputError(f"option {self.name} must be {self.allowed}, not {value!r:.60}")
        value = wanted(value)
        if self.one_of and value not in self.one_of:
            raise InputError(f"option {self.name} must be {self.allowed}, not {value!r}: {nearest(value, self.one_of)}")
        return value

    def _inside(self, value: Any) -> bool:
        finite = not isinstance(value, float) or math.isfinite(value)
        low = self.at_least is None or value >= self.at_least
        return finite and low and (self.at_most is None or value <= self.at_most)

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


def common_length(arrays: dict[str, np.ndarray]) -> int:
    """The number of scenarios in arrays by name. Raises InputError unless all have that length, or one."""
    sizes = {len(array) for array in arrays.values() if len(array) != 1}
    if len(sizes) > 1 or any(_is_too_deep(name, array) for name, array in arrays.items()):
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
        raise InputError(f"parameters must be scalars or arrays of one length, not {shapes}")
    return max(sizes, default=1)


def _is_too_deep(name: str, array: np.ndarray) -> bool:
    return array.ndim > 1 + (is_vector(name) or is_list(name))


def count_sections(lists: Array) -> np.ndarray:
    """The number of sections of each line, from a listed parameter of shape (scenario, section)."""
    return np.count_nonzero(~np.isnan(lists), axis=1)


def check_sections(lists: dict[str, Array]) -> None:
    """Raises InputError unless all lists of a line, by name, have the same number of sections."""
    for first, second in pairwise(lists):
        counts = np.broadcast_arrays(count_sections(lists[first]), count_sections(lists[second]))
        differs = np.flatnonzero(counts[0] != counts[1])
        if differs.size:
            found = f"{counts[0][differs[0]]} and {counts[1][differs[0]]}"
            of_many = f"{differs.size} of {counts[0].size} lines have not (first: scenario {differs[0]}, {found})"
            detail = of_many if counts[0].size > 1 else f"they have {found}"
            raise InputError(f"{first} and {second} must have the same number of sections: {detail}")


def gather(parameters: type, values: dict[str, Any]) -> dict[str, Any]:
    """Values by parameter, where some may be given by column: vectors and lists are put together.

    Raises InputError for one that lacks a column, or that is given twice.
    """
    gathered = dict(values)
    by_columns = given_by_columns(parameters, set(values))
    for spec in specs(parameters):
        if spec.name in by_columns:
            given = [column for column in spec.columns if column.name in values]
            parts = {column.name: column.read(gathered.pop(column.name)) for column in given}
            size = common_length(parts)
            gathered[spec.name] = np.stack([np.broadcast_to(part, (size,)) for part in parts.values()], axis=-1)
    return gathered


def given_by_columns(parameters: type, given: set[str]) -> set[str]:
    """The vectors and lists whose columns are given: all components, or the sections from the first to some last one.

    Raises InputError for one that lacks any of them, or that is given twice.
    """
    found = set()
    for spec in specs(parameters):
        present = [i for i, column in enumerate(spec.columns) if column.name in given]
        if not (spec.vector or spec.listed) or not present:
            continue
        if spec.name in given:
            parts = "sections" if spec.listed else "components"
            raise InputError(f"{spec.name} is given twice: as a whole and by its {parts}")
        wanted = spec.columns[: present[-1] + 1] if spec.listed else spec.columns
        missing = " and ".join(column.name for column in wanted if column.name not in given)
        if missing:
            known = f"has {len(wanted)} sections" if spec.listed else "has three components"
            raise InputError(f"{spec.name} {known}: {missing} must be given as well")
        found.add(spec.name)
    return found


def nearest_parameter(name: str, parameters: dict[str, ParameterSpec]) -> str:
    """A phrase that helps whoever mistyped `name`; the many columns of lists are not among the names it tells."""
    return nearest(name, [known for known, spec in parameters.items() if not spec.section])


def problem_words(parameters: type[Batch]) -> str:
    """The groups of parameters of which exactly one is given, in words; empty where there is no choice."""
    return ", or ".join(" and ".join(problem) for problem in parameters.PROBLEMS)


def check_given(parameters: type[Batch], given: set[str]) -> None:
    """Raises InputError unless all that is required is given: one of each pair of alternatives, and one problem.

    What may be left out need not be given, nor what would replace it; but not both are.
    """
    replaced = {spec.instead_of: spec.name for spec in specs(parameters) if spec.instead_of}
    alternatives = {name for problem in parameters.PROBLEMS for name in problem}
    for spec in specs(parameters):
        other = replaced.get(spec.name)
        if other and spec.name in given and other in given:
            raise InputError(f"{spec.name} and {other} are both given: one of them says it all")
        if spec.name in given or (other and other in given) or spec.instead_of or spec.may_be_missing:
            continue
        if spec.name not in alternatives:
            raise InputError(_missing(spec, f"{spec.name} (or {other})" if other else spec.name))
    stated = [name for spec in specs(parameters) if spec.name in given and (name := spec.instead_of or spec.name)]
    chosen = [name for name in stated if name in alternatives]
    if alternatives and set(chosen) not in [set(problem) for problem in parameters.PROBLEMS]:
        raise InputError(f"give {problem_words(parameters)}; given: {', '.join(chosen) or 'none of them'}")


def _missing(spec: ParameterSpec, wanted: str) -> str:
    kind = f"(one of {', '.join(spec.words)})" if spec.words else f"[{spec.unit}]"
    return f"missing parameter {wanted} {kind}, {quantity(spec.name).meaning}"
