"""Reference pages that are made of the package: quantities, commands, statuses, and the Python interface."""

from importlib.metadata import version

import click

from cablesim import units
from cablesim.cli import EXIT_BUG, EXIT_ENVIRONMENT, EXIT_FLAGGED, EXIT_MISTAKE, cli
from cablesim.quantities import TABLE
from cablesim.solver import load_solver, solver_names
from cablesim.status import SENTENCES, Status, Verdict
from website.text import table, wide

QUANTITIES = """# Quantities

Every quantity has one name, one SI unit and one meaning, in scene files, on the command line, in Python, in datasets
and on the axes of figures. A quantity may be what one solver is given and what another answers. Where it has
dimensions, it is not one number for a scenario: `component` is a vector (x, y, z), `section` a list with a number for
each section of the line, `node` a profile along it, `time` and `phase` a history. Adapters to other people's programs
are not listed.
"""
COMMANDS = f"""# Command line

What `cablesim --help` and `cablesim COMMAND --help` print, version {version("cablesim")}. Exit codes are told under
[statuses and exit codes](statuses.md).
"""
EXIT_CODES = {
    0: "done, all scenarios are solved; nothing differs",
    EXIT_FLAGGED: "done, some scenarios are flagged; results differ; the hunt found something",
    EXIT_MISTAKE: "your input: a file, key, option, unit or value that cannot be used; nothing was started",
    EXIT_ENVIRONMENT: "the machine: disk, memory, permission, a lock, a damaged file; the path is named",
    EXIT_BUG: "a mistake of ours, with a traceback to report",
}
VERDICTS = {
    Verdict.passed: "the condition holds",
    Verdict.failed: "it does not",
    Verdict.unknown: "the scenario is not solved, or a number in the condition is not finite",
}
PYTHON = """# Python

Two doors: `cablesim.batch.solve` solves scenarios in memory, `cablesim.open_study` opens what a study has computed. All
is in SI; statuses are the small numbers of [`Status`](#cablesim.status.Status). What users
call most:

    from cablesim import open_study
    from cablesim.batch import solve

## Solving

::: cablesim.batch.solve

::: cablesim.batch.Results

::: cablesim.status.Status

## Results of a study

::: cablesim.database.opened.open_study

::: cablesim.database.opened.OpenedStudy

::: cablesim.database.cluster.connected

## Studies and scenes

::: cablesim.config.scene.read_scene

::: cablesim.steps.run_scene

::: cablesim.study.Layout

::: cablesim.study.read_study

## Solvers and quantities

::: cablesim.solver.solver_names

::: cablesim.solver.load_solver

::: cablesim.solver.Solver
    options:
      members: [summary, outputs, parameters, options, problems, solve]

::: cablesim.solver.Solution

::: cablesim.parameters.parameter

::: cablesim.parameters.option

::: cablesim.parameters.Batch

::: cablesim.quantities.quantity

::: cablesim.quantities.Quantity

## What is raised

::: cablesim.errors.CablesimError

::: cablesim.errors.InputError

::: cablesim.errors.EnvironmentFault
"""


def pages() -> dict[str, str]:
    """Pages by their place."""
    return {
        "reference/quantities.md": wide(f"{QUANTITIES}\n{quantities()}", "toc"),
        "reference/commands.md": COMMANDS + "".join(commands(cli, "cablesim")),
        "reference/statuses.md": statuses(),
        "reference/python.md": PYTHON,
    }


def quantities() -> str:
    """The table of quantities, with the solvers that take and answer each."""
    solvers = [load_solver(name) for name in solver_names()]
    taken = {row.name: [s.name for s in solvers if row.name in s.parameters] for row in TABLE}
    answered = {row.name: [s.name for s in solvers if row.name in s.outputs] for row in TABLE}
    # A quantity that is given to some and answered by others stands in the table once.
    rows = {row.name: row for row in TABLE}.values()
    heads = ("name", "symbol", "unit", "meaning", "given to", "answered by")
    return table(
        heads,
        (
            (
                f"`{row.name}`",
                f"${row.symbol}$",
                units.shown(row.unit),
                row.meaning + (f" (over {', '.join(row.dims)})" if row.dims else ""),
                links(taken[row.name]),
                links(answered[row.name]),
            )
            for row in rows
        ),
    )


def links(solvers: list[str]) -> str:
    """All solvers named, each a link to its page."""
    return ", ".join(f"[{name}](solvers/{name}.md)" for name in solvers)


def commands(command: click.Command, path: str, depth: int = 2) -> list[str]:
    """The help of a command and of those below it, a section each."""
    settings = {**cli.context_settings, "max_content_width": 84, "terminal_width": 84}
    context = click.Context(command, info_name=path, **settings)
    found = [f"\n{'#' * depth} `{path}`\n\n```\n{command.get_help(context).replace('%(prog)s', path)}\n```\n"]
    if isinstance(command, click.Group):
        for name in command.list_commands(context):
            below = command.get_command(context, name)
            assert below is not None
            found += commands(below, f"{path} {name}", min(depth + (depth > 2 or path != "cablesim"), 3))
    return found


def statuses() -> str:
    """Fates of scenarios, verdicts of checks, and exit codes."""
    fates = table(("number", "status", "meaning"), ((int(s), f"`{s.name}`", SENTENCES[s]) for s in Status), numbers="r")
    verdicts = table(("number", "verdict", "meaning"), ((int(v), f"`{v.name}`", VERDICTS[v]) for v in Verdict), "r")
    codes = table(("code", "meaning"), EXIT_CODES.items(), numbers="r")
    return (
        "# Statuses and exit codes\n\n## Fates of scenarios\n\nEvery scenario has a `status`. Only where it is `ok` "
        "are there numbers; every other status means NaN in every output of that scenario and method, and nothing for "
        f"its neighbours.\n\n{fates}\n## Verdicts of checks\n\nWhat a [check](../scenes.md#checks) of a scene says of "
        f"a scenario.\n\n{verdicts}\n## Exit codes\n\nOf every command.\n\n{codes}\nA step that a study runs ends its "
        "last line with its exit code; the study ends with that of its gravest step.\n"
    )
