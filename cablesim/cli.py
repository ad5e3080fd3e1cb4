"""The command line. Nothing heavy is imported before it is known to be needed: `--help` answers at once."""

import errno
import json
import math
import os
import sys
import traceback
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import click

from cablesim.errors import CablesimError, EnvironmentFault, InputError

if TYPE_CHECKING:
    from cablesim.config.scene import Scene
    from cablesim.database.query import Request
    from cablesim.solver import Solver

EXIT_FLAGGED = 1
EXIT_MISTAKE = 2
EXIT_ENVIRONMENT = 3
EXIT_BUG = 4
LONGEST_LINE = 800
MOST_FAULTS = 20

DASK_ADDRESS = "CABLESIM_DASK_ADDRESS"
_dask_address = click.option(
    "--dask-address",
    envvar=DASK_ADDRESS,
    metavar="ADDRESS",
    help="Work on the workers of this Dask scheduler, as in tcp://host:8786 (or $CABLESIM_DASK_ADDRESS).",
)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="cablesim", message="cablesim %(version)s")
def cli() -> None:
    """Flexible lines: solve one, run a scene of many, query what a study has found.

    Exit codes: 0 all solved, 1 some scenarios flagged, 2 your input, 3 the machine, 4 a bug of ours.
    """


@cli.command()
def solvers() -> None:
    """List the solvers."""
    from cablesim.solver import peer_names, solver_names, summary

    names, peers = solver_names(), peer_names()
    width = max(map(len, [*names, *peers]))
    for name in names:
        click.echo(f"{name:<{width}}  {summary(name)}")
    click.echo("\nOther people's programs, to compare with:")
    for name in peers:
        click.echo(f"{name:<{width}}  {summary(name)}")


@cli.command()
@click.argument("solver")
def describe(solver: str) -> None:
    """Theory, parameters, options and outputs of a SOLVER."""
    from cablesim.report.describe import description
    from cablesim.solver import load_solver

    click.echo(description(load_solver(solver)))


@cli.command()
@click.argument("solver")
@click.argument("parameters", nargs=-1, metavar="NAME=VALUE...")
@click.option("--option", "options", multiple=True, metavar="NAME=VALUE", help="A numerical option of the solver.")
@click.option("--outputs", metavar="NAME,...", help="Only these outputs (default: all but profiles and histories).")
@click.option("--json", "as_json", is_flag=True, help="One JSON object, in SI.")
def solve(
    solver: str, parameters: tuple[str, ...], options: tuple[str, ...], outputs: str | None, as_json: bool
) -> int:
    """Solve one scenario: cablesim solve catenary_exact span=2.5 line_length=3 weight_per_length="3 N/m"."""
    from cablesim import batch
    from cablesim.quantities import quantity
    from cablesim.solver import load_solver
    from cablesim.status import Status

    chosen = load_solver(solver)
    values = {name: chosen.parameter(name).read_text(text) for name, text in _pairs(parameters).items()}
    results = batch.solve(solver, values, _options(chosen, options), _names(outputs))
    status = Status(int(results.status[0]))
    answer = {name: _plain(value[0]) for name, value in results.outputs.items()}
    if as_json:
        given = {name: quantity(name).unit for name in answer}
        click.echo(json.dumps({**answer, "status": status.name, "units": given}))
    else:
        for name, value in answer.items():
            click.echo(f"{name:<20} {_shown(name, value):>14} {quantity(name).unit:<6} {quantity(name).meaning}")
        click.echo(f"{'status':<20} {status.name:>14} {'':<6} {status.sentence}")
    return 0 if status is Status.ok else EXIT_FLAGGED


@cli.command()
@click.argument("config", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), help="Folder of the results (default: results/<name>).")
@click.option("--cores", type=click.IntRange(min=1), metavar="N", help="Cores to use (default: all there are).")
@click.option("--hours", type=float, metavar="H", help="Refuse what would take longer than this.")
def check(config: Path, out: Path | None, cores: int | None, hours: float | None) -> None:
    """Validate CONFIG, a study or a scene, and estimate what is left to do; runs nothing.

    Exit code 3: it does not fit on the disk, into memory or into the time given; what would fit is told.
    """
    from cablesim.estimate import estimate_study
    from cablesim.fitting import refuse_vast, refuse_what_does_not_fit, room_at
    from cablesim.machine import available_cores
    from cablesim.report.estimate import study_lines
    from cablesim.study import Layout, read_any

    if hours is not None and not 0.0 < hours < math.inf:
        raise InputError(f"--hours must be a number > 0, not {hours}")
    name, scenes = read_any(config)
    layout = Layout(out if out is not None else Path("results") / name)
    for scene in scenes:
        refuse_vast(scene, layout.root)
    found = estimate_study(scenes, layout, cores or available_cores())
    click.echo(study_lines(name, found))
    refuse_what_does_not_fit(found, room_at(layout.root, hours), layout.root)


@cli.command()
@click.argument("scene", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), help="Folder of the results (default: results/<scene>).")
def run(scene: Path, out: Path | None) -> int:
    """Run a SCENE without Snakemake; the same files result."""
    from cablesim.config.scene import read_scene
    from cablesim.held import held
    from cablesim.report.answer import written_answer
    from cablesim.steps import run_scene
    from cablesim.study import Layout

    read = read_scene(scene)
    layout = Layout(out if out is not None else Path("results") / read.name)
    with held(layout.root):
        plan, computed = run_scene(read, layout, _progress)
    click.echo(f"{computed} scenarios computed, {plan.scenarios - computed} were there", err=True)
    code = _tell_fates(read, layout.dataset(read.name))
    click.echo(written_answer(layout.tables, read.name))
    return code


@cli.command()
@click.argument("config", type=click.Path(path_type=Path), default=Path("config/config.yaml"))
@click.option("--profile", default="default", show_default=True, help="How to run it: a folder in workflow/profiles.")
@click.option("--cores", metavar="N", help="Cores to use, or 'all' (default: what the profile says).")
@click.option("--dry-run", is_flag=True, help="Only tell what would be done.")
@click.option("--anyway", is_flag=True, help="Start even what is not expected to fit on the disk or into memory.")
@_dask_address
def study(config: Path, profile: str, cores: str | None, dry_run: bool, anyway: bool, dask_address: str | None) -> int:
    """Run a study, or finish it after whatever interruption: CONFIG is config/config.yaml if none is given.

    What is computed already is kept. Exit code 0: all is solved, 1: scenarios are flagged.
    """
    from cablesim.launch import run_study
    from cablesim.report.fates import fates
    from cablesim.status import Status

    if dask_address is not None:
        # The steps of the study read it.
        os.environ[DASK_ADDRESS] = dask_address
    planned = run_study(config, profile, cores, dry_run, anyway)
    if dry_run:
        return 0
    table = fates(Path(planned.results), [scene.name for scene in planned.scenes])
    click.echo(f"{planned.results}: {len(planned.scenes)} scenes, {table['scenarios'].sum()} scenarios")
    click.echo(table.to_markdown(index=False))
    return 0 if set(table["status"]) <= {Status.ok.name} else EXIT_FLAGGED


@cli.command()
@click.argument("config", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), help="Folder of the results (default: results/<name>).")
@_dask_address
def collect(config: Path, out: Path | None, dask_address: str | None) -> int:
    """Write datasets of what is computed so far of CONFIG, a study or a scene, while it runs; the rest is `not_run`.

    Exit code 0: all is solved, 1: scenarios are flagged, or not run yet.
    """
    from cablesim.database.cluster import connected
    from cablesim.steps import collect_partly
    from cablesim.study import Layout, read_any

    name, scenes = read_any(config)
    layout = Layout(out if out is not None else Path("results") / name)
    codes = []
    with connected(dask_address):
        for scene in scenes:
            missing = collect_partly(scene, layout)
            click.echo(f"{scene.name}: {len(missing)} shards are not there yet", err=True)
            codes.append(_tell_fates(scene, layout.dataset(scene.name)))
    return max(codes)


def _tell_fates(scene: "Scene", path: Path) -> int:
    """Print how many scenarios met which fate, and how the checks went; the exit code says whether any is flagged."""
    from cablesim.database.reading import read_dataset
    from cablesim.report.checks import check_lines
    from cablesim.report.tables import status_table

    dataset = read_dataset(path)
    click.echo(f"{path}: {dataset.status.size} scenarios")
    click.echo(status_table(dataset).to_markdown(index=False, floatfmt=".3g"))
    for line in check_lines(scene, dataset):
        click.echo(line)
    return EXIT_FLAGGED if int((dataset.status != 0).sum()) else 0


@cli.command()
@click.argument("results", type=click.Path(path_type=Path))
@click.argument("scene", required=False)
def scenes(results: Path, scene: str | None) -> None:
    """List the scenes in a folder of RESULTS, or what one SCENE holds: parameters, outputs, fates.

    A SCENE with `*` or `?` lists those that fit the pattern.
    """
    from cablesim.database.reading import chosen_paths, is_pattern, open_scene, read_dataset, scene_paths
    from cablesim.report.answer import written_answer
    from cablesim.report.describe import scene_line, scene_table
    from cablesim.study import Layout

    if scene is not None and not is_pattern(scene):
        click.echo(scene_table(scene, open_scene(results, scene), written_answer(Layout(results).tables, scene)))
        return
    faults = []
    for name, path in (scene_paths(results) if scene is None else chosen_paths(results, scene)).items():
        try:
            click.echo(scene_line(name, read_dataset(path)))
        except EnvironmentFault as fault:
            faults.append(str(fault))
    if faults:
        more = f" (and {len(faults) - 1} more files)" if len(faults) > 1 else ""
        raise EnvironmentFault(faults[0] + more)


@cli.command()
@click.argument("results", type=click.Path(path_type=Path))
@click.argument("scene")
@click.argument("condition", required=False)
@click.option("--columns", metavar="NAME,...", help="Only these columns.")
@click.option("--nearest", multiple=True, metavar="NAME=VALUE", help="Only the scenarios nearest to this value.")
@click.option("--order-by", "orders", multiple=True, metavar="FORMULA [desc]", help="Order by this; may be repeated.")
@click.option("--limit", type=int, metavar="N", help="At most so many scenarios.")
@click.option("--format", "form", default="table", help="table, csv, json, parquet, excel or netcdf.")
@click.option("--units/--no-units", default=True, help="With the units of the columns, or bare.")
@click.option("--output", type=click.Path(path_type=Path), help="Write to this file instead of standard output.")
@_dask_address
def query(
    results: Path,
    scene: str,
    condition: str | None,
    columns: str | None,
    nearest: tuple[str, ...],
    orders: tuple[str, ...],
    limit: int | None,
    form: str,
    units: bool,
    output: Path | None,
    dask_address: str | None,
) -> None:
    """Scenarios of a SCENE for which a CONDITION holds: cablesim query results/default inclined_spans 'sag > 20 m'.

    Several scenes are asked at once with 'one,other', or with a pattern: 'precision_*' asks those that know the names.
    """
    from cablesim.database.answers import BINARY
    from cablesim.database.cluster import connected
    from cablesim.database.query import Order, Request

    if form in BINARY and output is None and sys.stdout.isatty():
        raise InputError(f"{form} is not for a terminal: name a file with --output, or redirect standard output")
    near = tuple(_pairs(nearest).items())
    request = Request(condition, _names(columns), near, tuple(Order.read(text) for text in orders), limit)
    with connected(dask_address):
        _answer(results, scene, request, form, units, output)


def _answer(results: Path, scene: str, request: "Request", form: str, units: bool, output: Path | None) -> None:
    """Print or write the answer to a query, and what is to be told beside it."""
    from cablesim.database.answers import prepare
    from cablesim.database.reading import chosen_paths, is_pattern, open_scenes
    from cablesim.files import written_whole

    files = chosen_paths(results, scene)
    answer, write = prepare(open_scenes(results, scene), request, form, is_pattern(scene), files)
    for note in answer.notes:
        click.echo(f"note: {note}", err=True)
    if answer.left_out:
        click.echo(f"note: {len(answer.left_out)} scenes do not know all of these names", err=True)
    if output is None:
        rows = write(sys.stdout.buffer, units)
    else:
        with written_whole(output) as temporary, temporary.open("wb") as stream:
            rows = write(stream, units)
    if form == "table":
        click.echo(f"{rows} of {answer.scenarios} scenarios", err=True)


@cli.command()
@click.argument("results_a", type=click.Path(path_type=Path))
@click.argument("results_b", type=click.Path(path_type=Path))
@click.option("--tolerance", default=0.0, help="Relative change up to which values count as the same.")
def compare(results_a: Path, results_b: Path, tolerance: float) -> int:
    """What changed between two runs of a study. Measured times do not count. Exit code 0: the same, 1: they differ."""
    from cablesim.database import compare as comparison

    if not 0.0 <= tolerance < math.inf:
        raise InputError(f"--tolerance must be a number >= 0, not {tolerance}")
    table = comparison.compare(results_a, results_b, tolerance)
    differs = bool(table["differs"].any())
    shown = table.drop(columns="differs").astype(object)
    click.echo(shown.where(shown.notna(), "").to_markdown(index=False, floatfmt=".3g"))
    for note in table.attrs["notes"]:
        click.echo(f"note: {note}", err=True)
    click.echo("they differ" if differs else "the same")
    return EXIT_FLAGGED if differs else 0


@cli.command()
@click.argument("results", type=click.Path(path_type=Path))
@click.option("--sample", default=20, show_default=True, help="Scenarios of each scene to compute once more.")
@click.option("--seed", default=1, show_default=True)
@click.option("--tolerance", default=1e-9, show_default=True, help="Relative change up to which they agree.")
def verify(results: Path, sample: int, seed: int, tolerance: float) -> int:
    """Check the files of RESULTS against their ledgers, and a random sample of scenarios by computing them once more.

    Exit code 0: all is well, 1: scenarios differ, 3: files are damaged or missing.
    """
    from cablesim.report.verified import verified_table
    from cablesim.study import Layout
    from cablesim.verify import verify

    if sample < 0 or seed < 0 or not 0.0 <= tolerance < math.inf:
        raise InputError("--sample, --seed and --tolerance must be >= 0")
    found = list(verify(Layout(results), sample, seed, tolerance))
    click.echo(verified_table(found).to_markdown(index=False, disable_numparse=True))
    faults = [fault for one in found for fault in one.faults]
    for fault in faults[:MOST_FAULTS]:
        click.echo(fault, err=True)
    if faults:
        more = f" (and {len(faults) - MOST_FAULTS} more)" if len(faults) > MOST_FAULTS else ""
        raise EnvironmentFault(f"{len(faults)} files are not what was written{more}: run the study again")
    return EXIT_FLAGGED if any(one.differing for one in found) else 0


@cli.command()
@click.argument("config", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), help="Folder of the results (default: results/<name>).")
@click.option("--remove", is_flag=True, help="Remove what is listed.")
def clean(config: Path, out: Path | None, remove: bool) -> None:
    """List what the results of CONFIG, a study or a scene, hold of earlier scenes and earlier code, or remove it."""
    from cablesim import clean as cleaning
    from cablesim.report.verified import leftover_table
    from cablesim.study import Layout, read_any

    name, scenes = read_any(config)
    layout = Layout(out if out is not None else Path("results") / name)
    found = cleaning.leftovers(scenes, layout)
    if found:
        click.echo(leftover_table(found).to_markdown(index=False))
    others = cleaning.strangers(scenes, layout)
    if others:
        click.echo(f"not in {config}, and left alone: {', '.join(others)}", err=True)
    if remove:
        cleaning.remove(found, layout)
    told = "removed" if remove else "may be removed with --remove"
    click.echo(f"{len(found)} files {told}" if found else "nothing is left over")


@cli.command()
@click.argument("solvers", nargs=-1)
@click.option("--scenarios", default=10_000, show_default=True, help="In all; costly solvers get fewer of them.")
@click.option("--seed", default=1, show_default=True)
@click.option("--part", default="0/1", show_default=True, help="Only this part of the scenarios, as in 2/8.")
@click.option("--write", type=click.Path(path_type=Path), help="Write the table to this CSV file, too.")
def hunt(solvers: tuple[str, ...], scenarios: int, seed: int, part: str, write: Path | None) -> int:
    """Hunt for answers of SOLVERS (all of them) that are wrong without saying so; each is told with its command."""
    from cablesim.files import write_text
    from cablesim.hunt._hunt import hunt
    from cablesim.report.hunted import hunted_table

    if scenarios < 1 or seed < 0:
        raise InputError("--scenarios must be at least 1 and --seed at least 0")
    found = []
    for one in hunt(solvers, scenarios, seed, _part(part)):
        found.append(one)
        for wrong in one.told:
            click.echo(f"wrong: {wrong.judge} missed by {wrong.miss:.2g} times what is allowed\n  {wrong.command}")
        click.echo(f"{one.solver}: {one.scenarios} scenarios, {one.wrong} wrong", err=True)
    table = hunted_table(found)
    click.echo(table.to_markdown(index=False, disable_numparse=True))
    if write is not None:
        write_text(write, table.to_csv(index=False, lineterminator="\n"))
    return EXIT_FLAGGED if any(one.wrong for one in found) else 0


@cli.group()
def step() -> None:
    """The steps of the workflow, as the rules call them."""


@step.command("sample")
@click.argument("scene", type=click.Path(path_type=Path))
@click.argument("results", type=click.Path(path_type=Path))
def step_sample(scene: Path, results: Path) -> None:
    """Expand the design of a SCENE into shards."""
    from cablesim import steps
    from cablesim.config.scene import read_scene
    from cablesim.study import Layout

    layout = Layout(results)
    plan = steps.sample(read_scene(scene), layout)
    click.echo(f"{layout.plan(plan)}: {len(plan.recipes)} shards, {plan.scenarios} scenarios")


@step.command("solve")
@click.argument("plan", type=click.Path(path_type=Path))
@click.argument("folder", type=click.Path(path_type=Path))
@click.argument("shards", nargs=-1, required=True)
@click.option("--stamp", type=click.Path(path_type=Path), help="A file to write when all are there.")
def step_solve(plan: Path, folder: Path, shards: tuple[str, ...], stamp: Path | None) -> None:
    """Compute SHARDS of a PLAN into FOLDER; those that are there are kept."""
    from cablesim import steps

    steps.solve(plan, shards, folder, stamp)


@step.command("measure")
@click.argument("scene", type=click.Path(path_type=Path))
@click.argument("results", type=click.Path(path_type=Path))
def step_measure(scene: Path, results: Path) -> None:
    """Time the methods of a SCENE on one thread."""
    # Libraries look at it when they are imported.
    os.environ["OMP_NUM_THREADS"] = "1"
    start = perf_counter()
    from cablesim import steps
    from cablesim.config.scene import read_scene
    from cablesim.study import Layout

    read = read_scene(scene)
    steps.measure(read, Layout(results), perf_counter() - start)


@step.command("catalogue")
@click.argument("results", type=click.Path(path_type=Path))
@click.option("--stamp", type=click.Path(path_type=Path), help="A file to write when the step is done.")
def step_catalogue(results: Path, stamp: Path | None) -> None:
    """Write the catalogue of all scenes in RESULTS."""
    from cablesim import steps
    from cablesim.study import Layout

    steps.catalogue(Layout(results), stamp)


@step.command("report")
@click.argument("config", type=click.Path(path_type=Path))
@click.argument("results", type=click.Path(path_type=Path))
@click.option("--stamp", type=click.Path(path_type=Path), help="A file to write when the step is done.")
def step_report(config: Path, results: Path, stamp: Path | None) -> None:
    """Write the page of the scenes of CONFIG, a study or a scene, in RESULTS."""
    from cablesim import steps
    from cablesim.study import Layout, read_any

    steps.report(Layout(results), read_any(config)[1], stamp)


def _scene_step(name: str, help_text: str) -> None:
    """A step that takes a scene file and a results folder, and leaves a stamp when it is done."""

    @step.command(name, help=help_text)
    @click.argument("scene", type=click.Path(path_type=Path))
    @click.argument("results", type=click.Path(path_type=Path))
    @click.option("--stamp", type=click.Path(path_type=Path), help="A file to write when the step is done.")
    def command(scene: Path, results: Path, stamp: Path | None) -> None:
        from cablesim import steps
        from cablesim.config.scene import read_scene
        from cablesim.study import Layout

        steps.run_step(name, read_scene(scene), Layout(results), stamp)


@step.command("collect")
@click.argument("scene", type=click.Path(path_type=Path))
@click.argument("results", type=click.Path(path_type=Path))
@click.option("--stamp", type=click.Path(path_type=Path), help="A file to write when the step is done.")
@_dask_address
def step_collect(scene: Path, results: Path, stamp: Path | None, dask_address: str | None) -> None:
    """Join the shards of a SCENE into its dataset in RESULTS."""
    from cablesim import steps
    from cablesim.config.scene import read_scene
    from cablesim.database.cluster import connected
    from cablesim.study import Layout

    with connected(dask_address):
        steps.run_step("collect", read_scene(scene), Layout(results), stamp)


_scene_step("summarise", "Write the tables of a SCENE.")
_scene_step("figures", "Draw the figures of a SCENE.")


def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return its exit code; no error of the user's or the machine's shows a traceback."""
    given = sys.argv[1:] if arguments is None else arguments
    message, code = _end(given)
    if message:
        # What the study that this step belongs to looks for.
        told = f" (exit code {code})" if given[:1] == ["step"] else ""
        click.echo(f"cablesim: {_one_line(message)}{told}", err=True)
    return code


def _end(arguments: list[str]) -> tuple[str, int]:
    """What there is to complain of, and the exit code."""
    try:
        return "", cli.main(arguments, prog_name="cablesim", standalone_mode=False) or 0
    except click.exceptions.NoArgsIsHelpError as problem:
        return f"a command is missing: '{problem.ctx.command_path} --help' lists them", EXIT_MISTAKE
    except click.ClickException as problem:
        return problem.format_message(), EXIT_MISTAKE
    except CablesimError as problem:
        return str(problem), problem.exit_code
    except (click.Abort, KeyboardInterrupt):
        return "interrupted", 130
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return "", 0
    except OSError as problem:
        if problem.errno == errno.ENAMETOOLONG:
            return f"{str(problem.filename)[:60]}...: the name is too long", EXIT_MISTAKE
        return f"{problem.filename or 'the machine'}: {problem.strerror or problem}", EXIT_ENVIRONMENT
    except MemoryError as problem:
        return f"not enough memory for this ({problem or 'none is left'})", EXIT_ENVIRONMENT
    except Exception:
        traceback.print_exc()
        return "this is a bug of ours; please report it with the lines above", EXIT_BUG


def _one_line(message: str) -> str:
    """What was typed may hold what a terminal would obey, and what cannot be written at all."""
    line = "".join(letter if letter.isprintable() else ascii(letter)[1:-1] for letter in " ".join(message.split()))
    return line if len(line) <= LONGEST_LINE else f"{line[: LONGEST_LINE // 2]} ... {line[-LONGEST_LINE // 4 :]}"


def _options(solver: "Solver", texts: tuple[str, ...]) -> dict[str, Any]:
    """Options as the solver reads them; unknown ones are left for it to refuse."""
    known = solver.options
    return {name: known[name].read_text(text) if name in known else text for name, text in _pairs(texts).items()}


def _pairs(texts: tuple[str, ...]) -> dict[str, str]:
    pairs: dict[str, str] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name.strip():
            raise InputError(f"'{text[:60]}' is not name=value")
        if name.strip() in pairs:
            raise InputError(f"'{name.strip()}' is given twice")
        pairs[name.strip()] = value.strip()
    return pairs


def _part(text: str) -> tuple[int, int]:
    number, slash, parts = text.partition("/")
    if not (slash and number.isdigit() and parts.isdigit() and int(number) < int(parts)):
        raise InputError(f"--part must be like 0/4, the number of a part and how many there are, not '{text[:20]}'")
    return int(number), int(parts)


def _names(text: str | None) -> tuple[str, ...]:
    if text is None:
        return ()
    names = tuple(name.strip() for name in text.split(","))
    if not all(names) or len(set(names)) < len(names):
        raise InputError(f"'{text[:60]}' is not a list of different names separated by commas")
    return names


def _plain(value: Any) -> Any:
    """A number, or nested lists of them, with None for what is not finite (JSON has no NaN)."""
    if getattr(value, "ndim", 0):
        return [_plain(item) for item in value]
    return float(value) if math.isfinite(value) else None


def _shown(name: str, value: Any) -> str:
    from cablesim.quantities import SHORT, quantity

    if isinstance(value, list) and quantity(name).dims in SHORT:
        return ", ".join(_number(part) for part in value)
    if isinstance(value, list):
        return f"{len(value)} {quantity(name).dims[0]}s"
    return _number(value)


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.8g}"


def _progress(step: str, done: int, total: int) -> None:
    click.echo(f"{step} {done + 1}/{total}", err=True)
