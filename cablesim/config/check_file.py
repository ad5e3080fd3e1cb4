"""The `checks` part of a scene file: what every scenario should meet, and what should only grow or only fall."""

from dataclasses import dataclass, replace

from cablesim import units
from cablesim.config.document import Node, is_name
from cablesim.config.rehearsal import METHOD, Rehearsal
from cablesim.design import SCENARIO
from cablesim.errors import nearest
from cablesim.expressions import Term, parse
from cablesim.quantities import OWN_DIMS, QUANTITIES, RUN_TIME
from cablesim.status import Status, Verdict

SENSES = ("increasing", "decreasing")
LIMIT_KEYS, MONOTONE_KEYS = ("limit", "with"), ("monotone", "along", "sense")
# What a dataset has beside variables: dimensions, and a group of what was measured.
ELSEWHERE = (SCENARIO, *OWN_DIMS, "measured")


@dataclass(frozen=True)
class Value:
    """A number that a condition has a name for: in the SI unit `unit`, and as it is written."""

    number: float
    unit: str
    written: str


@dataclass(frozen=True)
class Limit:
    """A condition that every scenario should meet, over the names of the scene and of its own `values`."""

    name: str
    condition: str
    values: dict[str, Value]

    @property
    def words(self) -> str:
        """The check as a phrase."""
        given = ", ".join(f"{name} = {value.written}" for name, value in self.values.items())
        return f"{self.condition}, with {given}" if given else self.condition

    @property
    def terms(self) -> dict[str, Term]:
        """What the names of its own stand for."""
        return {name: Term(value.number, value.unit) for name, value in self.values.items()}


@dataclass(frozen=True)
class Monotone:
    """A formula whose value should be `increasing` or `decreasing` with the value of an axis; equal is both."""

    name: str
    formula: str
    along: str
    sense: str

    @property
    def words(self) -> str:
        """The check as a phrase."""
        return f"{self.formula} is {self.sense} along {self.along}"


Check = Limit | Monotone


def read_checks(node: Node, names: Rehearsal, taken: tuple[str, ...]) -> tuple[Check, ...]:
    """The checks of a scene; the words `taken` have a meaning of their own in formulas.

    Raises InputError naming file, line and key for a name that means something else, and for what cannot be judged.
    """
    known = _known(names) | set(taken)
    checks = []
    for name, entry in node.named_entries().items():
        # Words are stored as characters, along a dimension that is called after them.
        if name in known or name in QUANTITIES or name.removesuffix("_width") in known:
            entry.fail(f"'{name}' means something else already: choose another name")
        checks.append(_read_check(name, entry, names, known))
    return tuple(checks)


def _known(names: Rehearsal) -> set[str]:
    """The names that formulas and datasets of the scene have, and the words that these are compared with."""
    axes = names.design.axes
    labels = {label: values for axis in axes for label, values in axis.labels.items()}
    words = [values.tolist() for values in labels.values() if values.dtype.kind == "U"]
    words += [spec.words for spec in names.parameters.values()]
    words += [[member.name for member in flags] for flags in (Status, Verdict)]
    given = {*names.design.parameters, *names.fixed, *(axis.name for axis in axes), *labels}
    return given.union(names.answers, names.methods, ELSEWHERE, *words)


def _read_check(name: str, node: Node, names: Rehearsal, known: set[str]) -> Check:
    """A condition alone, one with values of its own, or a formula and the axis along which it grows or falls."""
    if not isinstance(node.value, dict):
        return _read_limit(name, node, None, names, known)
    keys = node.mapping(optional=(*LIMIT_KEYS, *MONOTONE_KEYS))
    if "limit" in keys:
        keys = node.mapping(("limit",), ("with",))
        return _read_limit(name, keys["limit"], keys.get("with"), names, known)
    if "monotone" not in keys:
        node.fail("a check has the key 'limit' or the key 'monotone'")
    return _read_monotone(name, node.mapping(MONOTONE_KEYS), names)


def _read_limit(name: str, node: Node, given: Node | None, names: Rehearsal, known: set[str]) -> Limit:
    entries = given.mapping(optional=None) if given else {}
    limit = Limit(name, node.formula(), {value: _read_value(value, entry, known) for value, entry in entries.items()})
    along = node.located(replace(names, values=limit.terms).condition, limit.condition)
    _check_judged(node, limit.condition, along, names)
    mentioned = parse(limit.condition).names
    for value, entry in entries.items():
        if value not in mentioned:
            entry.fail(f"the condition has no name '{value}': {nearest(value, mentioned)}")
    if set(mentioned) <= set(entries):
        node.fail("the condition has no name of the scene: it says nothing of a scenario")
    return limit


def _read_value(name: str, node: Node, known: set[str]) -> Value:
    """A quantity has its unit, any other number the one that it is written with."""
    if name in known:
        node.fail(f"'{name}' means something else already: choose another name")
    if name in QUANTITIES:
        if QUANTITIES[name].dims:
            node.fail(f"'{name}' is no single number: choose another name")
        return Value(node.number(QUANTITIES[name].unit), QUANTITIES[name].unit, node.formula())
    if not is_name(name):
        node.fail(f"{name!r:.60} is neither a quantity nor a name (letters, digits, underscores)")
    written = units.unit_of(node.value)
    if written == units.BARE:
        return Value(node.number("1"), units.BARE, node.formula())
    unit = node.located(units.base_unit, written)
    return Value(node.number(unit), unit, node.formula())


def _read_monotone(name: str, keys: dict[str, Node], names: Rehearsal) -> Monotone:
    node = keys["monotone"]
    formula = node.formula()
    along = node.located(names.number, formula)
    _check_judged(node, formula, along, names)
    axis = _read_axis(keys["along"], names)
    if axis not in along:
        node.fail(f"this does not vary along {axis}")
    return Monotone(name, formula, axis, keys["sense"].choice(SENSES))


def _read_axis(node: Node, names: Rehearsal) -> str:
    """An axis whose points are in an order of their own: that of its numbers."""
    if names.design.kind != "grid":
        node.fail(f"only a grid has axes to go along, not a design of kind {names.design.kind}")
    chosen = node.choice(tuple(axis.name for axis in names.design.axes))
    axis = next(axis for axis in names.design.axes if axis.name == chosen)
    if chosen not in axis.columns or names.parameters[chosen].words:
        node.fail(f"the points of {chosen} are not numbers: they neither increase nor decrease")
    return chosen


def _check_judged(node: Node, formula: str, along: set[str], names: Rehearsal) -> None:
    """One answer for each scenario, the same whenever the scene is run."""
    for dim in sorted(along - {METHOD} - {axis.name for axis in names.design.axes}):
        node.fail(f"a check has one answer a scenario, this has many along {dim}")
    if RUN_TIME in (name.rpartition(".")[2] for name in parse(formula).names):
        node.fail(f"'{RUN_TIME}' is measured and never the same twice: a check cannot judge it")
