"""Conditions and formulas over the quantities of a scene: `sag / span > 3 % and max_tension < 12 kN`.

A grammar, not Python: names, numbers with units, arithmetic, comparisons, and / or / not, and the functions listed
below. Nothing else can be said in it, so nothing can be executed by it. Used for query conditions, for columns of
published tables, for what figures show and for the checks of a scene.

Bare numbers are SI. Numbers with a unit are converted, and dimensions are checked wherever a unit is written.
`==` holds to one part in 1e9, because an axis value and a typed value may differ in their last digit.
Words are compared with `==` and `!=`: `status == infeasible`, `method != exact`.
"""

import operator
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache, reduce
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from cablesim import units
from cablesim.errors import InputError, nearest

if TYPE_CHECKING:
    from lark import Lark, Token, Tree

GRAMMAR = r"""
?start: either
?either: both | either "or" both                  -> either
?both: negated | both "and" negated               -> both
?negated: comparison | "not" negated              -> negated
?comparison: sum | sum COMPARISON sum             -> comparison
?sum: product | sum SIGN product                  -> sum
?product: signed | product FACTOR signed          -> product
?signed: power | SIGN signed                      -> signed
?power: atom | atom ("**" | "^") signed           -> power
?atom: VALUE                                      -> value
     | FUNCTION "(" either ("," either)* ")"      -> call
     | NAME                                       -> name
     | STRING                                     -> word
     | "(" either ")"

COMPARISON: "<=" | ">=" | "==" | "!=" | "<" | ">"
SIGN: "+" | "-"
FACTOR.-1: "*" | "/"
FUNCTION.2: /(?!(?:and|or|not)\b)[A-Za-z_][A-Za-z0-9_]*(?=\s*\()/
NAME: /(?!(?:and|or|not)\b)[A-Za-z_][A-Za-z0-9_]*(?:\.[A-Za-z_][A-Za-z0-9_]*)?/
STRING: /"[^"]{0,80}"|'[^']{0,80}'/
VALUE: /@NUMBER@(?:\s?@UNIT@(?:(?:\/|\s)@UNIT@){0,4})?/
%ignore /\s+/
"""
_NUMBER = r"(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?(?![\w.]*\()"
_UNIT = r"(?!(?:and|or|not)\b)[A-Za-zµμ°%]{1,20}(?:\^?-?[0-9])?"
LONGEST = 1000
DEEPEST = 60

FUNCTIONS: dict[str, Callable[..., Any]] = {
    "sqrt": np.sqrt, "abs": np.abs, "exp": np.exp, "log": np.log, "log10": np.log10,
    "sin": np.sin, "cos": np.cos, "tan": np.tan, "asin": np.arcsin, "acos": np.arccos, "atan": np.arctan,
    "sinh": np.sinh, "cosh": np.cosh, "tanh": np.tanh, "asinh": np.arcsinh, "acosh": np.arccosh, "atanh": np.arctanh,
    "min": np.minimum, "max": np.maximum,
}  # fmt: skip
CONDITIONS = ("either", "both", "negated", "comparison")
_TWO_ARGUMENTS = ("min", "max")
_ANGLES = ("asin", "acos", "atan")
_COMPARISONS = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge}
EQUAL_WITHIN = 1e-9
BARE = units.BARE
PLAIN = "1"
WORDS = "words"


@dataclass(frozen=True)
class Term:
    """What a name stands for: an array (numpy or xarray) and its unit.

    The unit is BARE for a number that fits any dimension, and WORDS for labels; `words` are then the labels that may
    stand beside it, where they are known. Labels are text, or integers that are positions in `words`.
    """

    values: Any
    unit: str
    words: tuple[str, ...] = ()


Lookup = Callable[[str], Term | None]
# A function that is given its arguments unread, with what reads them.
Function = Callable[["Evaluation", tuple["Tree", ...]], Term]
NO_FUNCTIONS: Mapping[str, Function] = MappingProxyType({})


@dataclass(frozen=True)
class Expression:
    """A parsed formula or condition."""

    text: str
    tree: Any

    @property
    def names(self) -> list[str]:
        """The names it mentions, in order, each once."""
        return list(
            dict.fromkeys(str(tree.children[0]) for tree in self.tree.iter_subtrees_topdown() if tree.data == "name")
        )

    @property
    def conjuncts(self) -> tuple["Expression", ...]:
        """The conditions that must all hold."""
        if self.tree.data != "both":
            return (self,)
        return tuple(part for side in self.tree.children for part in Expression(self.text, side).conjuncts)

    @property
    def equality(self) -> "Equality | None":
        """What it says if it is `name == value`."""
        if not self.is_equality:
            return None
        left, _, right = self.tree.children
        name, value = (left, right) if left.data == "name" else (right, left)
        if name.data != "name" or Expression(self.text, value).names:
            return None
        unit = _split(value.children[0])[1] if value.data == "value" else ""
        return Equality(str(name.children[0]), float(Expression(self.text, value).evaluate(lambda _: None)), unit)

    @property
    def is_equality(self) -> bool:
        """Whether it compares with `==`."""
        return bool(self.tree.data == "comparison" and self.tree.children[1] == "==")

    def evaluate(self, lookup: Lookup) -> Any:
        """The value for every scenario. Raises InputError for an unknown name, a wrong unit or a misused word."""
        return self.term(lookup).values

    def term(self, lookup: Lookup, checking: bool = False) -> Term:
        """The value and its unit, which is known only if the formula writes one, or if `checking` is asked for."""
        with np.errstate(all="ignore"):
            return Evaluation(self, lookup, checking).number(self.tree)

    def answer(self, lookup: Lookup, functions: Mapping[str, Function], checking: bool = False) -> Term:
        """The same with further functions, and it may be a word. Raises InputError for a condition, too."""
        with np.errstate(all="ignore"):
            return Evaluation(self, lookup, checking, functions).told(self.tree)

    def unit(self, lookup: Lookup) -> str:
        """The unit of its value, "1" for a plain number. Raises InputError where units do not fit each other."""
        with np.errstate(all="ignore"):
            unit = _UnitEvaluation(self, lookup, checking=True).number(self.tree).unit
        return PLAIN if unit == BARE else unit

    def key(self, lookup: Lookup) -> Term:
        """What scenarios can be ordered by: a value, a label, or whether a condition holds."""
        with np.errstate(all="ignore"):
            term = Evaluation(self, lookup).visit(self.tree)
        if isinstance(term.values, str):
            raise UnknownName(term.values)
        return term

    def select(self, lookup: Lookup, checking: bool = False) -> Any:
        """True where the condition holds. Raises InputError where the expression is a number, not a condition.

        Units are checked if the condition writes one, or if `checking` is asked for.
        """
        if self.tree.data not in CONDITIONS:
            raise InputError(
                f"'{self.text}' is a value, not a condition: compare it with something (<, <=, ==, !=, >=, >)"
            )
        with np.errstate(all="ignore"):
            return Evaluation(self, lookup, checking).visit(self.tree).values

    def known(self, lookup: Lookup) -> Any:
        """True where all numbers that a condition compares are finite, whether or not they decide it."""
        with np.errstate(all="ignore"):
            sides = [Evaluation(self, lookup).visit(side) for side in _compared(self.tree)]
        return reduce(operator.and_, (np.isfinite(side.values) for side in sides if side.unit != WORDS), np.True_)


@dataclass(frozen=True)
class Equality:
    """A name, the value in SI that it should have, and the unit that this was written with ("" for none)."""

    name: str
    value: float
    unit: str


def parse(text: str) -> Expression:
    """Read a formula or condition. Raises InputError that says at which column it goes wrong."""
    from lark import UnexpectedInput

    if not isinstance(text, str) or not text.strip():
        raise InputError("an empty expression: write a condition such as 'sag > 2 m'")
    if len(text) > LONGEST:
        raise InputError(f"an expression of {len(text)} characters is too long: at most {LONGEST}")
    try:
        tree = _parser().parse(text)
    except UnexpectedInput as problem:
        column = problem.column if problem.column > 0 else len(text) + 1
        found = text[column - 1 : column + 11].strip() or "the end"
        raise InputError(
            f"cannot read '{_short(text)}' at column {column} (at {found!r}): not part of an expression"
        ) from None
    if not hasattr(tree, "data"):
        raise InputError(f"cannot read '{_short(text)}'")
    if _depth(tree) > DEEPEST:
        raise InputError(f"'{_short(text)}' is nested more than {DEEPEST} deep")
    return Expression(text, tree)


class Evaluation:
    """One walk over a tree. Units are tracked only when one is written: a bare number fits any dimension."""

    def __init__(
        self,
        expression: Expression,
        lookup: Lookup,
        checking: bool = False,
        functions: Mapping[str, Function] = NO_FUNCTIONS,
    ):
        self.text, self.lookup, self.functions = expression.text, lookup, functions
        self.checking = checking or any(_split(token)[1] for token in _values(expression.tree))

    def visit(self, tree: "Tree") -> Term:
        return getattr(self, f"_{tree.data}")(*tree.children)

    def number(self, tree: "Tree") -> Term:
        if tree.data in CONDITIONS:
            raise InputError(f"'{self.text}': a condition cannot be used as a number")
        term = self.visit(tree)
        if term.unit == WORDS:
            if tree.data == "name" and isinstance(term.values, str):
                raise UnknownName(term.values)
            raise InputError(f"'{self.text}': a word cannot be used as a number")
        return term

    def told(self, tree: "Tree") -> Term:
        """A number or a label."""
        if tree.data == "name":
            term = self.lookup(str(tree.children[0]))
            if term is None:
                raise UnknownName(str(tree.children[0]))
            return term
        return self.visit(tree) if tree.data == "call" else self.number(tree)

    def condition(self, tree: "Tree") -> Term:
        """Whether a condition holds."""
        if tree.data not in CONDITIONS:
            raise InputError(f"'{self.text}': a condition is expected here, such as sag > 2 m")
        return self.visit(tree)

    def word(self, tree: "Tree") -> str:
        """A word as it is written, whatever it may stand for elsewhere."""
        if tree.data not in ("name", "word"):
            raise InputError(f"'{self.text}': a word is expected here")
        written = str(tree.children[0])
        return written[1:-1] if tree.data == "word" else written

    def _value(self, token: "Token") -> Term:
        number, unit = _split(token)
        if not np.isfinite(float(number)):
            raise InputError(f"'{self.text}': {number} is too large for a number")
        if not unit:
            return Term(float(number), BARE)
        if unit in ("%", "percent"):
            return Term(float(number) * units.factor(unit, "1"), "1")
        base = units.base_unit(unit)
        return Term(float(number) * units.factor(unit, base), base)

    def _name(self, token: "Token") -> Term:
        term = self.lookup(str(token))
        return term if term is not None else Term(str(token), WORDS)

    def _word(self, token: "Token") -> Term:
        return Term(str(token)[1:-1], WORDS)

    def _call(self, function: "Token", *arguments: "Tree") -> Term:
        name = str(function)
        if name in self.functions:
            return self.functions[name](self, arguments)
        if name not in FUNCTIONS:
            known = [*FUNCTIONS, *self.functions]
            raise InputError(f"'{self.text}': unknown function '{name}': {nearest(name, known)}")
        wanted = 2 if name in _TWO_ARGUMENTS else 1
        if len(arguments) != wanted:
            raise InputError(f"'{self.text}': {name} takes {wanted} argument{'s' * (wanted > 1)}, not {len(arguments)}")
        terms = [self.number(argument) for argument in arguments]
        return Term(FUNCTIONS[name](*(term.values for term in terms)), self._unit_of_call(name, terms))

    def _unit_of_call(self, name: str, terms: list[Term]) -> str:
        unit = terms[0].unit if name in ("abs", "min", "max") else BARE
        if name == "sqrt" and self.checking:
            unit = units.power(terms[0].unit, 0.5)
        elif unit == BARE and self.checking:
            self._plain(name, terms[0].unit)
        return unit

    def _plain(self, function: str, unit: str) -> None:
        if unit != BARE and not units.compatible(unit, "1"):
            raise InputError(f"'{self.text}': {function} takes an angle or a plain number, not a value in {unit}")

    def _power(self, base: "Tree", exponent: "Tree") -> Term:
        a, n = self.number(base), self.number(exponent)
        plain = isinstance(n.values, float)
        unit = units.power(a.unit, n.values) if self.checking and plain else BARE
        return Term(np.power(a.values, n.values), unit)

    def _signed(self, sign: "Token", operand: "Tree") -> Term:
        term = self.number(operand)
        return Term(-term.values if sign == "-" else term.values, term.unit)

    def _product(self, left: "Tree", sign: "Token", right: "Tree") -> Term:
        a, b = self.number(left), self.number(right)
        unit = self._unit_of_product(a.unit, b.unit, -1 if sign == "/" else 1)
        return Term(np.divide(a.values, b.values) if sign == "/" else a.values * b.values, unit)

    def _unit_of_product(self, left: str, right: str, power: int) -> str:
        return units.product(left, right, power) if self.checking else BARE

    def _sum(self, left: "Tree", sign: "Token", right: "Tree") -> Term:
        a, b = self.number(left), self.number(right)
        return Term(a.values - b.values if sign == "-" else a.values + b.values, self._same_unit(a, b))

    def _comparison(self, left: "Tree", sign: "Token", right: "Tree") -> Term:
        for side in (left, right):
            if side.data in CONDITIONS:
                raise InputError(f"'{self.text}': conditions are joined with 'and' and 'or', not compared")
        a, b = self.visit(left), self.visit(right)
        if WORDS in (a.unit, b.unit):
            return self._compare_words(a, str(sign), b)
        self._same_unit(a, b)
        if sign in _COMPARISONS:
            return Term(_COMPARISONS[sign](a.values, b.values), BARE)
        scale = np.maximum(np.abs(a.values), np.abs(b.values))
        equal = np.abs(a.values - b.values) <= EQUAL_WITHIN * scale
        return Term(equal if sign == "==" else np.logical_not(equal), BARE)

    def _compare_words(self, a: Term, sign: str, b: Term) -> Term:
        labels, word = (a, b) if isinstance(b.values, str) else (b, a)
        if isinstance(word.values, str) and labels.unit != WORDS:
            raise UnknownName(word.values)
        if isinstance(labels.values, str):
            raise UnknownName(labels.values)
        if not isinstance(word.values, str):
            raise InputError(f"'{self.text}': words can only be compared with one word")
        if sign not in ("==", "!="):
            raise InputError(f"'{self.text}': words can only be compared with == or !=")
        if labels.words and word.values not in labels.words:
            raise InputError(f"'{self.text}': unknown word '{word.values}': {nearest(word.values, labels.words)}")
        wanted = labels.words.index(word.values) if labels.values.dtype.kind == "i" else word.values
        equal = labels.values == wanted
        return Term(equal if sign == "==" else np.logical_not(equal), BARE)

    def _either(self, left: "Tree", right: "Tree") -> Term:
        return Term(self._truth(left) | self._truth(right), BARE)

    def _both(self, left: "Tree", right: "Tree") -> Term:
        return Term(self._truth(left) & self._truth(right), BARE)

    def _negated(self, operand: "Tree") -> Term:
        return Term(np.logical_not(self._truth(operand)), BARE)

    def _truth(self, tree: "Tree") -> Any:
        if tree.data not in CONDITIONS:
            raise InputError(f"'{self.text}': 'and', 'or' and 'not' join conditions, not values")
        return self.visit(tree).values

    def _same_unit(self, left: Term, right: Term) -> str:
        if left.unit == BARE:
            return right.unit
        if self.checking and right.unit != BARE and not units.compatible(left.unit, right.unit):
            raise InputError(
                f"'{self.text}': a value in {left.unit} cannot be compared with or added to one in {right.unit}"
            )
        return left.unit


class _UnitEvaluation(Evaluation):
    """The same walk for the unit of a formula: a bare number fits what it is added to, and is plain as a factor."""

    def _unit_of_call(self, name: str, terms: list[Term]) -> str:
        if name in _TWO_ARGUMENTS:
            return self._same_unit(*terms)
        unit = super()._unit_of_call(name, terms)
        return "rad" if name in _ANGLES else unit

    def _unit_of_product(self, left: str, right: str, power: int) -> str:
        if left == right == BARE:
            return BARE
        first, second = (PLAIN if unit == BARE else unit for unit in (left, right))
        return super()._unit_of_product(first, second, power)


class UnknownName(InputError):
    """A name that stands for nothing here; whoever knows the names adds the nearest ones."""

    def __init__(self, name: str):
        super().__init__(f"unknown name '{name}'")
        self.name = name


@cache
def _parser() -> "Lark":
    from lark import Lark

    grammar = GRAMMAR.replace("@NUMBER@", _NUMBER).replace("@UNIT@", _UNIT)
    return Lark(grammar, parser="lalr", maybe_placeholders=False)


def _values(tree: "Tree") -> Iterator[Any]:
    return (subtree.children[0] for subtree in tree.iter_subtrees() if subtree.data == "value")


def _compared(tree: "Tree") -> Iterator["Tree"]:
    """The sides of all comparisons in a condition."""
    return (side for found in tree.iter_subtrees() if found.data == "comparison" for side in found.children[::2])


def _split(token: "Token") -> tuple[str, str]:
    """The number and the unit of a value token."""
    number = re.match(_NUMBER, str(token))
    end = number.end() if number else 0
    return str(token)[:end], str(token)[end:].strip()


def _depth(tree: "Tree") -> int:
    """Nesting depth, without recursion: hostile text must not overflow the stack."""
    deepest, todo = 0, [(tree, 1)]
    while todo:
        node, depth = todo.pop()
        deepest = max(deepest, depth)
        todo.extend((child, depth + 1) for child in node.children if hasattr(child, "children"))
    return deepest


def _short(text: str) -> str:
    return text if len(text) <= 60 else text[:57] + "..."
