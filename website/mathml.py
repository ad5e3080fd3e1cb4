"""Formulas of pages as MathML, which browsers show without a script."""

import html
import re

from latex2mathml.converter import convert

# What the extension arithmatex makes of $...$ and $$...$$.
FORMULA = re.compile(
    r'<span class="arithmatex">\\\((?P<inline>.*?)\\\)</span>|<div class="arithmatex">\\\[(?P<block>.*?)\\\]</div>',
    re.S,
)
TAG = re.compile(r"\\tag\{(.*?)\}")
# Names of functions are operators to the converter or not, as it knows them: too wide apart or too near in browsers.
NAME = re.compile(r"<m[io]>([a-z]{2,})</m[io]>")
FUNCTION = r"(?<!<msup>)<mi>[a-z]{2,}</mi>|<msup><mi>[a-z]{2,}</mi><m[in]>[^<]*</m[in]></msup>"
BEFORE_ITS_ARGUMENT = re.compile(rf"({FUNCTION})(?=<m(?:i|n|sub|sup|frac|sqrt)>)")
AFTER_A_FACTOR = re.compile(rf"(</m(?:i|n|sub|sup|frac|sqrt|row)>)(?={FUNCTION})")
THIN_SPACE = '<mspace width="0.167em"/>'


def with_mathml(page: str) -> str:
    """The HTML of a page with all of its formulas converted."""
    return FORMULA.sub(_converted, page)


def _converted(found: re.Match[str]) -> str:
    if found["inline"] is not None:
        return mathml(html.unescape(found["inline"]), "inline")
    tex = html.unescape(found["block"])
    tags = "".join(f'<span class="equation-number">({tag})</span>' for tag in TAG.findall(tex))
    return f'<div class="equation">{mathml(TAG.sub("", tex), "block")}{tags}</div>'


def mathml(tex: str, display: str) -> str:
    """A formula. Raises ValueError for what the converter does not know, which it would show as it stands."""
    found = convert(tex.strip(), display=display)
    if "\\" in found or "<mi>&</mi>" in found:
        raise ValueError(f"not understood: {tex}")
    found = NAME.sub(r"<mi>\1</mi>", found).replace("<mi>&#x000B1;</mi>", "<mo>&#x000B1;</mo>")
    return AFTER_A_FACTOR.sub(rf"\1{THIN_SPACE}", BEFORE_ITS_ARGUMENT.sub(rf"\1{THIN_SPACE}", found))
