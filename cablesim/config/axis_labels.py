"""Labels of axes: words from the scene file, symbols and units from the table of quantities.

A label in a scene file holds words alone. Names of quantities in braces become symbols; the unit is that of what is
shown, or the one that is asked for beside the label, and is written behind it by whoever draws.
"""

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

from cablesim.config.document import Node
from cablesim.config.rehearsal import Rehearsal
from cablesim.expressions import PLAIN, parse
from cablesim.labels import Label, as_shown, quantity_label
from cablesim.quantities import COMPONENTS, QUANTITIES, quantity

_NAMED = re.compile(r"\{([A-Za-z_]\w*)\}")
# What the sides of a view are called.
SIDES = dict(zip(COMPONENTS, ("horizontal distance", "sideways distance", "height"), strict=True))


class Keys(NamedTuple):
    """How a scene file calls the label of an axis, and its unit."""

    label: str
    unit: str


def keys_of(axis: str) -> Keys:
    """Those of an axis: `x_label` and `x_unit`; of the colours of a map `label` and `unit`."""
    head = "" if axis == "value" else f"{axis}_"
    return Keys(f"{head}label", f"{head}unit")


def label_keys(*axes: str) -> tuple[str, ...]:
    """The keys of some axes."""
    return tuple(key for axis in axes for key in keys_of(axis))


def read_labels(keys: dict[str, Node], given: Mapping[str, Label]) -> dict[str, Label]:
    """The label of each axis: as it is given in SI, with the words and the unit that the scene file asks for.

    Raises InputError naming file, line and key for an unknown quantity, a unit among the words, or a wrong unit.
    """
    return {axis: _read_label(keys, keys_of(axis), label) for axis, label in given.items()}


def formula_label(formulas: list[Node], names: Rehearsal) -> Label:
    """What formulas say of the axis that they share, in SI. Raises InputError where their units differ."""
    texts = [node.formula() for node in formulas]
    found = [node.located(names.unit, text) for node, text in zip(formulas, texts, strict=True)]
    unit = found[0]
    for node, other in zip(formulas, found, strict=True):
        if other != unit:
            node.fail(f"its unit is {other}, that of '{texts[0]}' is {unit}: an axis has one unit")
    shown = {_quantity_of(text) for text in texts}
    if len(shown) == 1 and "" not in shown:
        return replace(quantity_label(shown.pop()), unit=unit, factor=1.0)
    return Label(_symbolic(texts[0]) if len(texts) == 1 else "", "", unit)


def parameter_label(name: str) -> Label:
    """A parameter, or a numerical option, as a plain word and in SI."""
    return Label(name.replace("_", " "), "", QUANTITIES[name].unit if name in QUANTITIES else PLAIN)


def side_label(output: str, component: str, more: str = "") -> Label:
    """One side of a view of positions: its name, its letter, and the unit of the output."""
    return Label(f"{SIDES[component]} {more}".strip(), component, quantity(output).unit)


def error_label(output: str) -> Label:
    """The relative error of an output."""
    return Label(f"largest relative error of {output.replace('_', ' ')}", quantity(output).symbol)


def output_label(words: str, output: str, unit: str | None = None) -> Label:
    """An output in words of the figure's own, shown in another unit than SI where that is usual."""
    label = Label(words, quantity(output).symbol, quantity(output).unit)
    return label.in_unit(unit) if unit else label


def _read_label(keys: dict[str, Node], called: Keys, label: Label) -> Label:
    if called.label in keys:
        label = _with_words(keys[called.label], label, called)
    if called.unit not in keys:
        return as_shown(label)
    node = keys[called.unit]
    return node.located(label.in_unit, node.text(40))


def _with_words(node: Node, label: Label, called: Keys) -> Label:
    """Words instead of those that were given. Where they name quantities, the symbols stand among them."""
    text = node.text()
    if "[" in text or "]" in text:
        unit = as_shown(label).bracket or "none: a plain number"
        node.fail(f"the unit is added to the words ({unit}): no brackets here; ask for another with {called.unit}")
    for name in _NAMED.findall(text):
        node.located(quantity, name)
    words = _NAMED.sub(lambda found: f"${QUANTITIES[found[1]].symbol}$", text.replace("$", r"\$"))
    return replace(label, words=words, symbol="" if _NAMED.search(text) else label.symbol)


def _quantity_of(formula: str) -> str:
    """The quantity that a formula is the name of, by any method; nothing if it is more than a name."""
    name = formula.strip().rpartition(".")[2]
    return name if name in QUANTITIES and parse(formula).tree.data == "name" else ""


def _symbolic(formula: str) -> str:
    """A formula with symbols instead of names."""
    names = sorted(parse(formula).names, key=len, reverse=True)
    known = {name: name.rpartition(".")[2] for name in names if name.rpartition(".")[2] in QUANTITIES}
    if not known:
        return formula.replace("$", r"\$").replace("_", " ")
    pattern = re.compile(r"(?<![\w.])(" + "|".join(map(re.escape, known)) + r")(?![\w.])")
    pieces = pattern.split(formula.replace("$", r"\$"))
    return "".join(_factor(known[piece]) if i % 2 else piece.replace("_", " ") for i, piece in enumerate(pieces))


def _factor(name: str) -> str:
    """The symbol of a quantity in a formula: a quotient in parentheses."""
    symbol = QUANTITIES[name].symbol
    return f"$({symbol})$" if "/" in symbol else f"${symbol}$"
