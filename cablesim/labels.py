"""What stands beside an axis: words, symbol and unit, as matplotlib wants them and as plain text.

Symbols are those of the table of quantities, in TeX. Plain text is for whoever shows no TeX: web pages, terminals.
"""

import re
import unicodedata
from dataclasses import dataclass, replace

from cablesim import units
from cablesim.quantities import QUANTITIES

# What TeX calls otherwise than Unicode does; other Greek letters have one name.
SPECIAL = {"varepsilon": "ε", "vartheta": "θ", "varphi": "φ", "ell": "ℓ", "max": "max", "min": "min", "to": "→"}
_POWER = re.compile(f"[{units.POWERS}]+")
DOT_ABOVE = "\u0307"
_MATHEMATICS = re.compile(r"(?<!\\)\$(.*?)(?<!\\)\$")


@dataclass(frozen=True)
class Label:
    """Words, which may hold symbols between dollar signs; a symbol in TeX ("" for none); a unit ("1" for none).

    What is shown is the value in SI times `factor`.
    """

    words: str
    symbol: str = ""
    unit: str = "1"
    factor: float = 1.0

    @property
    def text(self) -> str:
        """All of it, as matplotlib reads it."""
        return _joined(self.words, self.symbol and f"${self.symbol}$", self.tex_unit and f"[{self.tex_unit}]")

    @property
    def plain(self) -> str:
        """All of it as plain text."""
        return _joined(self.plain_words, self.plain_symbol, self.bracket)

    @property
    def plain_words(self) -> str:
        """The words as plain text."""
        return _MATHEMATICS.sub(lambda found: unicode(found[1]), self.words).replace(r"\$", "$")

    @property
    def plain_symbol(self) -> str:
        """The symbol as plain text."""
        return unicode(self.symbol)

    @property
    def shown_unit(self) -> str:
        """The unit with raised powers; nothing for a plain number."""
        return units.shown(self.unit)

    @property
    def tex_unit(self) -> str:
        """The same as matplotlib reads it."""
        return lowered(self.shown_unit)

    @property
    def bracket(self) -> str:
        """The unit in brackets; nothing for a plain number."""
        return f"[{self.shown_unit}]" if self.shown_unit else ""

    def in_unit(self, unit: str) -> "Label":
        """The same in another unit. Raises InputError for an unknown unit or one of another dimension."""
        return replace(self, unit=unit, factor=self.factor / units.factor(unit, self.unit))


def quantity_label(name: str) -> Label:
    """Name, symbol and unit of a quantity of the table; angles in degrees."""
    row = QUANTITIES[name]
    return as_shown(Label(row.name.replace("_", " "), row.symbol, row.unit))


def as_shown(label: Label) -> Label:
    """A label in SI in the unit that is shown where nobody asks for another: angles are in degrees."""
    return label.in_unit("deg") if label.unit == "rad" else label


def lowered(text: str) -> str:
    """A text whose raised digits are powers in TeX: few fonts have them all."""
    return _POWER.sub(lambda found: f"$^{{{found[0].translate(units.LOWERED)}}}$", text)


def unicode(tex: str) -> str:
    r"""A symbol as plain text: `T_{B,\max}` is "T_B,max", `\phi_c` is "φ_c"."""
    text = re.sub(r"\\(?:mathbf|mathrm)\s*", "", tex)
    text = re.sub(r"\\dot\s*\\([A-Za-z]+)\s*", lambda found: _letter(found[1]) + DOT_ABOVE, text)
    text = re.sub(r"\\([A-Za-z]+)\s*", lambda found: _letter(found[1]), text)
    return re.sub(r"[{}]", "", text)


def _letter(name: str) -> str:
    """The letter that TeX calls so; the name where there is none."""
    if name in SPECIAL:
        return SPECIAL[name]
    size = "CAPITAL" if name[0].isupper() else "SMALL"
    try:
        return unicodedata.lookup(f"GREEK {size} LETTER {name.upper().replace('LAMBDA', 'LAMDA')}")
    except KeyError:
        return name


def _joined(*parts: str) -> str:
    return " ".join(part for part in parts if part)
