"""Strict reading of YAML: every value knows its file, line and key, and nothing is guessed.

YAML 1.2 (so `1e9` is a number, `NO` is a word), no duplicate keys, no tags, anchors or aliases, bounded size and depth.
A `Node` is read by asking it for what is expected; anything else is an InputError that names file, line and key.
"""

import errno
import hashlib
import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from cablesim import units
from cablesim.errors import EnvironmentFault, InputError, nearest

# The reader takes a second for each 100 kB; tables of values belong into CSV files.
LARGEST_FILE = 200_000
DEEPEST = 12
T = TypeVar("T")


@dataclass(frozen=True)
class Node:
    """A value of a document: what it is, and where it stands."""

    file: str
    line: int
    key: str
    value: Any

    def fail(self, message: str) -> NoReturn:
        """Raise InputError with the place of this value."""
        where = f"{self.file}:{self.line}: " + (f"{self.key}: " if self.key else "")
        raise InputError(where + message)

    def mapping(self, required: tuple[str, ...] = (), optional: tuple[str, ...] | None = ()) -> dict[str, "Node"]:
        """Its entries by key. `optional=None` allows any key; otherwise unknown keys are errors."""
        if not isinstance(self.value, dict):
            self.fail(f"a mapping (key: value) is expected, not {_kind(self.value)}")
        entries = {}
        for key in self.value:
            if not isinstance(key, str) or not key.isprintable():
                self.fail(f"the key {key!r:.60} must be a word")
            known = None if optional is None else (*required, *optional)
            entry = Node(self.file, _line(self.value, key, self.line), f"{self.key}.{key}".lstrip("."), self.value[key])
            if known is not None and key not in known:
                entry.fail(f"unknown key '{key}': {nearest(key, known)}")
            entries[key] = entry
        for key in required:
            if key not in entries:
                self.fail(f"missing key '{key}'")
        return entries

    def digest(self, without: tuple[str, ...] = ()) -> str:
        """Digest of what a mapping says, but for some of its keys; comments and layout do not count."""
        said = {key: value for key, value in self.value.items() if key not in without}
        return hashlib.sha256(json.dumps(said, default=str).encode()).hexdigest()

    def sequence(self) -> list["Node"]:
        """Its entries; an empty list is an error."""
        if not isinstance(self.value, list):
            self.fail(f"a list is expected, not {_kind(self.value)}")
        if not self.value:
            self.fail("the list is empty")
        entries = enumerate(self.value)
        return [Node(self.file, _line(self.value, i, self.line), f"{self.key}[{i}]", value) for i, value in entries]

    def text(self, longest: int = 400) -> str:
        """A non-empty line of text."""
        if not isinstance(self.value, str) or not self.value.strip():
            self.fail(f"text is expected, not {_kind(self.value)}")
        text = " ".join(self.value.split())
        if len(text) > longest or not text.isprintable():
            self.fail(f"text of at most {longest} printable characters is expected")
        return text

    def name(self) -> str:
        """A name that is safe as a file name and in formulas: lower-case letters, digits and underscores."""
        text = self.value if isinstance(self.value, str) else None
        if text is None or not is_name(text):
            self.fail(
                f"a name (letters, digits, underscores; starting with a letter) is expected, not {self.value!r:.60}"
            )
        return text

    def named_entries(self) -> dict[str, "Node"]:
        """Its entries by names of the user's own, each safe as part of a file name."""
        entries = self.mapping(optional=None)
        for name, entry in entries.items():
            if not is_name(name):
                entry.fail(f"{name!r:.60} is not a name (letters, digits, underscores; starting with a letter)")
        return entries

    def choice(self, known: tuple[str, ...]) -> str:
        """One of the known words."""
        if not isinstance(self.value, str) or self.value not in known:
            self.fail(f"unknown value {self.value!r:.60}: {nearest(str(self.value), known)}")
        return self.value

    def number(self, unit: str) -> float:
        """A finite number in the SI unit, converted if it is written with another."""
        return self.located(units.to_si, self.value, unit)

    def formula(self) -> str:
        """The text of a formula; a bare number is one too."""
        is_number = isinstance(self.value, int | float) and not isinstance(self.value, bool)
        return str(self.value) if is_number else self.text(1000)

    def located(self, check: Callable[..., T], *arguments: Any) -> T:
        """Call something that knows nothing of files; its InputError gets the place of this value."""
        try:
            return check(*arguments)
        except InputError as problem:
            self.fail(str(problem))

    def whole(self, least: int, most: int) -> int:
        """A whole number within bounds."""
        if not isinstance(self.value, int) or isinstance(self.value, bool) or not least <= self.value <= most:
            self.fail(f"a whole number from {least} to {most} is expected, not {self.value!r:.60}")
        return int(self.value)


def is_name(text: str) -> bool:
    """Whether a text can name a scene, method, study or figure."""
    return text.isascii() and text.isidentifier() and text[0] != "_" and text == text.lower() and len(text) <= 64


def read_text(path: Path, largest: int = LARGEST_FILE) -> str:
    """A file's text. Raises InputError where there is no such file, EnvironmentFault where it cannot be read."""
    try:
        if not path.is_file():
            raise InputError(f"{path}: no such file")
        if path.stat().st_size > largest:
            raise InputError(
                f"{path}: {path.stat().st_size} bytes are too many for this kind of file (at most {largest})"
            )
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{path}: not a text file in UTF-8") from None
    except (OSError, ValueError) as problem:
        if getattr(problem, "errno", None) == errno.ENAMETOOLONG:
            raise InputError(f"{str(path)[:60]}...: the name is too long") from None
        raise EnvironmentFault(f"{path}: cannot be read ({getattr(problem, 'strerror', None) or problem})") from None


def read_document(path: Path) -> Node:
    """The root of a YAML file."""
    from ruamel.yaml import YAML
    from ruamel.yaml.error import MarkedYAMLError, YAMLError

    text = read_text(path)
    try:
        for problem, line in _forbidden(text):
            raise InputError(f"{path}:{line}: {problem}")
        root = YAML(typ="rt", pure=True).load(text)
    except MarkedYAMLError as problem:
        line = problem.problem_mark.line + 1 if problem.problem_mark else 1
        detail = " ".join(str(problem.problem or "cannot be read").split())
        raise InputError(f"{path}:{line}: {detail}") from None
    except (YAMLError, ValueError, RecursionError, AttributeError, TypeError) as problem:
        raise InputError(f"{path}: not YAML that can be read ({' '.join(str(problem).split())[:100]})") from None
    if root is None:
        raise InputError(f"{path}: the file is empty")
    return Node(str(path), 1, "", root)


def _forbidden(text: str) -> Iterator[tuple[str, int]]:
    """What this reader does not accept though YAML has it, found before anything is built from it."""
    from ruamel.yaml import YAML
    from ruamel.yaml import tokens as t

    words = {t.TagToken: "tags", t.AnchorToken: "anchors", t.AliasToken: "aliases", t.DirectiveToken: "directives"}
    opening = (t.BlockMappingStartToken, t.BlockSequenceStartToken, t.FlowMappingStartToken, t.FlowSequenceStartToken)
    depth, documents = 0, 0
    for token in YAML(typ="rt", pure=True).scan(text):
        line = token.start_mark.line + 1
        depth += isinstance(token, opening)
        depth -= isinstance(token, t.BlockEndToken | t.FlowMappingEndToken | t.FlowSequenceEndToken)
        documents += isinstance(token, t.DocumentStartToken)
        for kind, word in words.items():
            if isinstance(token, kind):
                yield f"YAML {word} are not used here", line
        if isinstance(token, t.ScalarToken) and token.plain and token.value == "<<":
            yield "YAML merge keys (<<) are not used here", line
        if depth > DEEPEST:
            yield f"nested more than {DEEPEST} deep", line
        if documents > 1:
            yield "one document a file", line


def _line(container: Any, key: Any, default: int) -> int:
    position = getattr(container, "lc", None)
    try:
        return int(position.data[key][0]) + 1 if position is not None else default
    except (KeyError, TypeError, IndexError):
        return default


def _kind(value: Any) -> str:
    if value is None:
        return "nothing"
    kinds = {dict: "a mapping", list: "a list", str: "text", bool: "true or false", int: "a number", float: "a number"}
    return next((word for kind, word in kinds.items() if isinstance(value, kind)), f"{type(value).__name__}")
