"""What hostile input is made of: words, numbers, pieces of YAML and of tables."""

import random

WORDS = (
    "../x", "/etc/passwd", "~/x", ".", "..", "", " ", "-", "--help", "con", "nul", "a" * 300, "a" * 5000, "sag\n",
    "s\tag",
    "sа\u0433", "ｓａｇ", "ſag", "sag\u200b", "\u202egas", "\ufeffsag", "é", "e\u0301", "💥", "sag\x00", "sag\x1b[31m",
    "$(touch pwned)", "`touch pwned`", "; touch pwned", "| touch pwned", "&& touch pwned", "'; touch pwned; '",
    '"; touch pwned; "', "x; rm -rf .", "{0.__class__}", "{study.python}", "{{x}}", "%s%n", "%(x)s", "${HOME}",
    "<script>alert(1)</script>", "[x](javascript:alert(1))", "![x](http://127.0.0.1/)", "| a | b |", "# x", "***",
    r"$\frac$", r"$\undefined{x}$", "$x", "$$", r"$\frac{1}{2", "_{", "^", r"\input{/etc/passwd}", "a_b^c", "&amp;",
    "__import__('os').system('touch pwned')", "os.system", "lambda: 0", "=1+1", "=cmd|' /C calc'!A0", "@x", "!x", "*x",
    "&x", "nan", "null", "~", "true", "yes", "1e9", "0o17", "12:30", "2001-01-01", "{a: 1}", "[1, 2]", "sag, sag",
)  # fmt: skip
NUMBERS = (
    "nan", "-nan", "inf", "-inf", "infinity", "∞", "1e400", "-1e400", "1e-400", "1e308", "-1e308",
    "1.7976931348623157e308",
    "1e60", "-1e60", "9.99e59", "1e61", "1e-60", "1e-61", "5e-324", "2.2e-308", "1e-310", "-5e-324", "0", "-0", "0.0",
    "-0.0", "1", "-1", "1e9", "1e18", "-1e18", "1e-9", "1e-18", "1e30", "1e-30", "0x10", "1_000", "１２", "1e", "--1",
    "+-1",
    "1,5", "1.5.5", "1/3", "1 m m", "1 m/0", "1e5 ly", "1 parsec", "3 %", "-3 %", "1e300 km", "1e-300 mm", "1 degC",
    "1 dB",
    "9" * 70, "9" * 400, "." * 10, "1e999999999", "-", "", "true", "none", "[]", "{}", "1 N**9", "1 m^-9",
)  # fmt: skip
# Lines and pieces that a document is spoilt with.
PIECES = (
    "a: &a [x, x]\nb: &b [*a, *a]\nc: [*b, *b]\n", "<<: {span: 1}\n",
    "x: !!python/object/apply:os.system ['touch pwned']\n",
    "x: !!python/name:os.system\n", "x: !!binary aGFjaw==\n", "%YAML 1.1\n---\n", "---\n", "...\n", "\t", "\0",
    "\x1b[31m", "\x85",
    "\u2028", "{", "}", "[", "]", ":", "- ", "? ", "| ", "> ", "'", '"', "#", "*x", "&x ", "!x ", "@", "`", "[" * 2000,
    "{a: " * 500, "- " * 3000, "x: " * 40, "title: Twice\n", "fixed: {}\n", "span: 1\n", "num: 1e18\n", "num: -5\n",
    "num: 10000000000\n", "include: /etc/passwd\n", "x: ${HOME}\n", "\r", "\r\n", "\n\n\n", "é", "💥", "0" * 5000,
    "a" * 50_000,
)  # fmt: skip
ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-32", "latin-1", "cp037", "utf-7", "shift_jis")


def number(draw: random.Random) -> str:
    """A number that is none, is huge or tiny, or is just any."""
    if draw.random() < 0.7:
        return draw.choice(NUMBERS)
    return repr(draw.choice([-1.0, 1.0]) * 10.0 ** draw.uniform(-320, 308))


def extreme(draw: random.Random) -> str:
    """A number that is one, of any magnitude that is taken and beyond."""
    return repr(draw.choice([1.0, 1.0, 1.0, -1.0]) * 10.0 ** draw.choice([draw.uniform(-62, 62), draw.uniform(-3, 3)]))


def word(draw: random.Random) -> str:
    """A word, or two of them in one."""
    return draw.choice(WORDS) if draw.random() < 0.7 else draw.choice(WORDS) + draw.choice(WORDS)


def printed(draw: random.Random) -> str:
    """A word that can be printed, mostly."""
    return (
        draw.choice([one for one in WORDS if one.strip() and one.isprintable()]) if draw.random() < 0.95 else word(draw)
    )


def spoilt(text: str, draw: random.Random) -> bytes:
    """A text with something put in, left out, doubled, replaced, or written in another way."""
    for _ in range(draw.randrange(1, 4)):
        text = _changed(text, draw)
    return encoded(text, draw)


def _changed(text: str, draw: random.Random) -> str:
    at = draw.randrange(len(text) + 1)
    end = min(len(text), at + draw.randrange(40))
    lines = text.splitlines(keepends=True)
    line = draw.randrange(len(lines) + 1)
    ways = (
        text[:at] + draw.choice(PIECES) + text[at:],
        "".join([*lines[:line], draw.choice(PIECES), *lines[line:]]),
        text[:at] + text[end:],
        text[:end] + text[at:],
        text[:at] + word(draw) + text[end:],
        text[:at] + number(draw) + text[end:],
    )
    return draw.choice(ways)


def encoded(text: str, draw: random.Random) -> bytes:
    """A text as bytes: mostly UTF-8, sometimes of another kind, with surrogates or with any bytes."""
    if draw.random() < 0.8:
        return text.encode("utf-8", "surrogatepass")
    if draw.random() < 0.5:
        return text.encode(draw.choice(ENCODINGS), "replace")
    content = bytearray(text.encode())
    at = draw.randrange(len(content) + 1)
    return bytes(content[:at] + draw.choice([b"\xed\xa0\x80", b"\xff", b"\xc0\xaf", draw.randbytes(9)]) + content[at:])
