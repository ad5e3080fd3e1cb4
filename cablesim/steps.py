"""The steps of the workflow, each a command of its own: sample, solve, measure, collect, summarise, figures.

`run_scene` does them all in one process, without Snakemake, and leaves the same files; only measuring has a process of
its own, which is to have one thread from its start.
"""

import hashlib
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from cablesim.config.scene import Scene
from cablesim.errors import EnvironmentFault, InputError
from cablesim.files import LEDGER_SUFFIX, Checked, check, recording, write_stamp, write_text
from cablesim.plan import ScenePlan, plan_digest, plan_scene, read_plan
from cablesim.shards import Recipe
from cablesim.sources import code_digest
from cablesim.study import Layout

Progress = Callable[[str, int, int], None]


def sample(scene: Scene, layout: Layout) -> ScenePlan:
    """Expand the design of a scene into shards; what earlier plans have named is taken over."""
    return plan_scene(scene, layout.plans)


def solve(plan_path: Path, shards: tuple[str, ...], folder: Path, stamp: Path | None = None) -> None:
    """Compute shards of a plan; those that are in the folder, whole, are kept. The stamp says that all are there."""
    recipes = read_plan(plan_path).recipes
    for shard in shards:
        if shard not in recipes:
            raise InputError(f"{plan_path}: no shard '{shard}' in this plan")
    for shard in shards:
        _solve(recipes[shard], folder)
    if stamp is not None:
        write_text(stamp, "")


def _solve(recipe: Recipe, folder: Path) -> int:
    """Compute a shard, unless it is there, whole; returns how many scenarios were computed."""
    from cablesim.database.shard_file import solve_recipe, write_shard

    out = folder / f"{recipe.digest}.nc"
    if check(out).whole:
        return 0
    write_shard(out, recipe, solve_recipe(recipe))
    return recipe.scenarios


def measure(scene: Scene, layout: Layout, import_seconds: float) -> None:
    """Time the methods of a scene that asks for it."""
    from cablesim.database.timing import measure, write_timings

    path = timings_path(scene, layout)
    if scene.work_precision is None or path is None:
        raise InputError(f"{scene.path}: no work_precision in it: nothing is to be timed")
    write_timings(path, measure(scene, scene.work_precision, import_seconds))


def timings_path(scene: Scene, layout: Layout) -> Path | None:
    """Where the run times of this content of a scene are; None where none are asked for."""
    if scene.work_precision is None:
        return None
    content = f"{plan_digest(scene)} {code_digest(('database/timing',), ('database',))}"
    return layout.timings(scene.name, hashlib.sha256(content.encode()).hexdigest()[:16])


def collect(scene: Scene, layout: Layout) -> None:
    """Join the shards of a scene into its dataset.

    Raises EnvironmentFault, when the dataset is written, where shards are missing or damaged: one more run mends them.
    """
    faults = _collect(scene, layout, whole=True)
    if faults:
        path, checked = next(iter(faults.items()))
        more = f" (and {len(faults) - 1} more shards)" if len(faults) > 1 else ""
        raise EnvironmentFault(f"{path}: {checked.condition.value}{more}; run the study again to compute what is lost")


def collect_partly(scene: Scene, layout: Layout) -> dict[Path, Checked]:
    """Join the shards that are there into the dataset of a scene, unless it is there as a whole.

    Returns the other shards, whose scenarios are `not_run`. The next run of the study replaces the dataset.
    """
    from cablesim.database.reading import read_dataset

    path = layout.dataset(scene.name)
    if check(path).whole and read_dataset(path).attrs.get("plan") == plan_digest(scene):
        return {}
    for stamp in layout.stamps(scene.name, "collect"):
        stamp.unlink(missing_ok=True)
    return _collect(scene, layout, whole=False)


def _collect(scene: Scene, layout: Layout, whole: bool) -> dict[Path, Checked]:
    from cablesim.database.collect import collect
    from cablesim.database.timing import read_timings

    measured_at = timings_path(scene, layout)
    timings = read_timings(measured_at) if measured_at and (whole or check(measured_at).whole) else None
    plan = sample(scene, layout)
    return collect(layout.dataset(scene.name), scene, plan, layout.shards(scene.name), revision(), timings)


def summarise(scene: Scene, layout: Layout) -> None:
    """Write the tables of a scene."""
    from cablesim.database.reading import read_dataset
    from cablesim.report import tables
    from cablesim.report.answer import write_answer
    from cablesim.report.audit import audit_table
    from cablesim.report.checks import check_table
    from cablesim.report.orders import order_table
    from cablesim.report.precision import fastest_caption, fastest_table, precision_caption, precision_table
    from cablesim.report.printed import write_printed_tables

    dataset = read_dataset(layout.dataset(scene.name))
    made = {
        "errors": (tables.error_table(scene, dataset), f"{scene.title}: errors against {dataset.attrs['reference']}"),
        "tensions": (tables.tension_table(dataset), f"{scene.title}: tensions in N"),
        "values": (tables.value_table(dataset), f"{scene.title}: all outputs, in SI"),
        "status": (
            tables.status_table(dataset),
            f"{scene.title}: scenarios by their fate, and measured seconds for each",
        ),
        "effort": (
            tables.effort_table(dataset),
            f"{scene.title}: effort, and what is left over, of the scenarios that were solved",
        ),
        "checks": (check_table(scene, dataset), f"{scene.title}: scenarios by what the checks say of them"),
        "orders": (order_table(scene, dataset), f"{scene.title}: measured orders of the methods"),
        "audit": (audit_table(scene, dataset), f"{scene.title}: printed values beside ours"),
        "work_precision": (precision_table(scene, dataset), precision_caption(scene, dataset)),
        "fastest": (fastest_table(scene, dataset), fastest_caption(scene, dataset)),
    }
    for name, (table, caption) in made.items():
        tables.write_table(layout.tables, f"{scene.name}_{name}", table, caption)
    write_printed_tables(layout.tables, scene, dataset)
    write_answer(layout.tables, scene, dataset)


def figures(scene: Scene, layout: Layout) -> None:
    """Draw the figures of a scene, as SVG, PDF and PNG; of what moves a GIF, too."""
    from cablesim.database.reading import read_dataset
    from cablesim.report.figures import draw_figures

    draw_figures(scene, read_dataset(layout.dataset(scene.name)), layout.figures)


# The steps that are of the whole study, and what stands for a scene in the names of their stamps.
STUDY, CATALOGUE, REPORT = "study", "catalogue", "report"


def catalogue(layout: Layout, stamp: Path | None = None) -> None:
    """Write the catalogue of all scenes in a folder of results."""
    from cablesim.database.catalogue import write_catalogue

    _leave(stamp, layout.stamps(STUDY, CATALOGUE), lambda: write_catalogue(layout.root))


def report(layout: Layout, scenes: Sequence[Scene], stamp: Path | None = None) -> None:
    """Write the page of a folder of results: these scenes first, then all others that are there."""
    from cablesim.report.page.write import write_page

    _leave(stamp, layout.stamps(STUDY, REPORT), lambda: write_page(layout, scenes))


SCENE_STEPS: dict[str, Callable[[Scene, Layout], None]] = {
    "collect": collect,
    "summarise": summarise,
    "figures": figures,
}


def run_scene(scene: Scene, layout: Layout, progress: Progress) -> tuple[ScenePlan, int]:
    """All steps of one scene; returns its plan and how many scenarios were computed, not taken from earlier shards."""
    plan = sample(scene, layout)
    folder = layout.shards(scene.name)
    computed = 0
    for done, recipe in enumerate(plan.recipes.values()):
        progress("solve", done, len(plan.recipes))
        computed += _solve(recipe, folder)
    timings = timings_path(scene, layout)
    if timings and not check(timings).whole:
        progress("measure", 0, 1)
        command = [sys.executable, "-m", "cablesim", "step", "measure", str(scene.path), str(layout.root)]
        subprocess.run(command, check=True)
    for done, name in enumerate(SCENE_STEPS):
        progress(name, done, len(SCENE_STEPS))
        run_step(name, scene, layout)
    catalogue(layout)
    report(layout, [scene])
    return plan, computed


def run_step(name: str, scene: Scene, layout: Layout, stamp: Path | None = None) -> None:
    """Run a step of a scene and leave its stamp: the digests of its files, named by the content it was done for.

    Stamps of other content go first, because the files that they vouched for are about to be replaced.
    """
    _leave(stamp, layout.stamps(scene.name, name), lambda: SCENE_STEPS[name](scene, layout))


def _leave(stamp: Path | None, earlier: list[Path], work: Callable[[], None]) -> None:
    for old in earlier:
        old.unlink(missing_ok=True)
    with recording() as written:
        work()
    if stamp is not None:
        write_stamp(stamp, [path for path in written if path.suffix != LEDGER_SUFFIX])


def revision() -> str:
    """The revision of the sources, where they are a git checkout."""
    folder = Path(__file__).parent
    command = ["git", "-C", str(folder), "describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True, timeout=10).stdout.strip()
    except (OSError, subprocess.SubprocessError):
        return "unknown"
