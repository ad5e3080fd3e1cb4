"""What the readers of figures share: what they are checked against, scenarios and panels, methods and labels."""

from dataclasses import dataclass
from typing import NamedTuple

from cablesim.config.document import Node
from cablesim.config.method import Method
from cablesim.config.place_file import Wish, place, read_point, read_wishes
from cablesim.config.rehearsal import METHOD, Rehearsal
from cablesim.config.table import Table

VIEWS = ("xz", "xy", "yz")
MOST_ACROSS = 6


@dataclass(frozen=True)
class Shape:
    """One scenario whose line or history is drawn: how it is called, and its position on each axis."""

    label: str
    position: dict[str, int]


@dataclass(frozen=True)
class Stage:
    """What figures are checked against: names, methods, reference, points; is it audited; the output that is timed."""

    names: Rehearsal
    methods: tuple[Method, ...]
    reference: str | None
    points: Table | None
    audited: bool
    timed: str | None


class Panel(NamedTuple):
    """What stands above a panel, and the scenarios in it."""

    title: str
    shapes: list[Shape]


def read_panels(node: Node, keys: dict[str, Node], stage: Stage) -> list[Panel]:
    """A panel for each value of `at`, in it a scenario for each value of `each`."""
    wishes = read_wishes(keys["at"], stage.names) if "at" in keys else [None]
    titles = _read_titles(keys, [wish.words if wish else "" for wish in wishes])
    return [Panel(title, read_shapes(node, keys, wish, stage)) for title, wish in zip(titles, wishes, strict=True)]


def read_shapes(node: Node, keys: dict[str, Node], panel: Wish | None, stage: Stage) -> list[Shape]:
    """The scenarios that are drawn together."""
    common = [*read_point(keys, stage.names), *([panel] if panel else [])]
    if "each" not in keys:
        return [Shape("", place(node, common, stage.names))]
    wishes = read_wishes(keys["each"], stage.names)
    return [Shape(wish.words, place(node, [*common, wish], stage.names)) for wish in wishes]


def read_across(keys: dict[str, Node], otherwise: int) -> int:
    """How many panels stand side by side."""
    return keys["across"].whole(1, MOST_ACROSS) if "across" in keys else otherwise


def read_view(keys: dict[str, Node]) -> str:
    """The plane that the line is looked at in."""
    return keys["view"].choice(VIEWS) if "view" in keys else VIEWS[0]


def read_methods(keys: dict[str, Node], stage: Stage) -> tuple[str, ...]:
    """The methods that are drawn: all, unless the figure names some."""
    if "methods" not in keys:
        return stage.names.methods
    return tuple(entry.choice(stage.names.methods) for entry in keys["methods"].sequence())


def read_number(node: Node, stage: Stage) -> tuple[str, set[str]]:
    """A formula and the axes along which it varies; a scene's only method needs no choosing."""
    formula = node.formula()
    along = node.located(stage.names.number, formula)
    if along & {"time", "phase"}:
        node.fail("a history has many values a scenario: figures of kind history, orbit and snapshots show it")
    if "node" in along:
        node.fail("a profile has many values a scenario: only a figure of kind profiles shows it")
    if "component" in along:
        node.fail("a vector has three values a scenario: take a component, as in force_B_z")
    return formula, along - {METHOD} if len(stage.names.methods) == 1 else along


def check_sides(keys: dict[str, Node], along: dict[str, set[str]]) -> None:
    """Raises InputError unless each side of a map varies along one axis, and each along another one."""
    for name, axes in along.items():
        if len(axes) != 1:
            keys[name].fail("a side of a map varies along one axis")
    if len(along) == 2 and along["x"] == along["y"]:
        keys["y"].fail(f"both sides of the map vary along {min(along['x'])}")


def check_stored(node: Node, stage: Stage, kind: str, outputs: tuple[str, ...]) -> None:
    """Raises InputError unless the scene has all outputs that a figure is drawn from."""
    for output in outputs:
        if output not in stage.names.outputs:
            node.fail(f"a figure of {kind} needs the output '{output}'")


def _read_titles(keys: dict[str, Node], headings: list[str]) -> list[str]:
    """What stands above the panels: words of the scene's own, else the value of each."""
    if "titles" not in keys:
        return headings
    titles = [entry.text(60) for entry in keys["titles"].sequence()]
    if len(titles) != len(headings):
        keys["titles"].fail(f"a title for each panel is expected: {len(headings)}, not {len(titles)}")
    return titles
