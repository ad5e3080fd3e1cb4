"""The steps of the workflow, each a command that can be run by hand: sample, solve, collect, summarise, figures.

`run_scene` does them all in one process, without Snakemake, and leaves the same files.
"""

import subprocess
from collections.abc import Callable
from pathlib import Path

from cablesim.config.scene import Scene
from cablesim.files import ledger, written_whole
from cablesim.plan import ScenePlan, plan_scene, read_plan
from cablesim.study import Layout

Progress = Callable[[str, int, int], None]


def sample(scene: Scene, layout: Layout) -> ScenePlan:
    """Expand the design of a scene into shards; what earlier plans have named is taken over."""
    return plan_scene(scene, layout.plans)


def solve(plan_path: Path, shard: str, out: Path) -> None:
    """Compute one shard of a plan."""
    from cablesim.database.shard_file import solve_recipe, write_shard
    from cablesim.errors import InputError

    recipes = read_plan(plan_path).recipes
    if shard not in recipes:
        raise InputError(f"{plan_path}: no shard '{shard}' in this plan")
    write_shard(out, recipes[shard], solve_recipe(recipes[shard]))


def collect(scene: Scene, plan: ScenePlan, layout: Layout) -> None:
    """Join the shards of a scene into its dataset."""
    from cablesim.database.collect import collect, write_dataset

    dataset, measured = collect(scene, plan, layout.shards(scene.name), revision())
    write_dataset(layout.dataset(scene.name), dataset, measured)


def summarise(scene: Scene, layout: Layout) -> list[Path]:
    """Write the tables of a scene."""
    from cablesim.database.reading import read_dataset
    from cablesim.report import tables
    from cablesim.report.audit import audit_table

    dataset = read_dataset(layout.dataset(scene.name))
    made = {
        "errors": (tables.error_table(scene, dataset), f"{scene.title}: errors against {dataset.attrs['reference']}"),
        "tensions": (tables.tension_table(dataset), f"{scene.title}: tensions in N"),
        "status": (
            tables.status_table(dataset),
            f"{scene.title}: scenarios by their fate, and measured seconds for each",
        ),
        "audit": (audit_table(scene, dataset), f"{scene.title}: printed values beside ours"),
    }
    written = (tables.write_table(layout.tables, f"{scene.name}_{name}", *table) for name, table in made.items())
    return [path for paths in written for path in paths]


def figures(scene: Scene, layout: Layout) -> list[Path]:
    """Draw the figures of a scene, as SVG and PNG."""
    from cablesim.database.reading import read_dataset
    from cablesim.report.figures import draw_figures

    return draw_figures(scene, read_dataset(layout.dataset(scene.name)), layout.figures)


def run_scene(scene: Scene, layout: Layout, progress: Progress) -> ScenePlan:
    """All steps of one scene; shards that are there already are kept."""
    plan = sample(scene, layout)
    folder = layout.shards(scene.name)
    for done, shard in enumerate(plan.recipes):
        progress("solve", done, len(plan.recipes))
        out = folder / f"{shard}.nc"
        if not (out.exists() and ledger(out).exists()):
            solve(layout.plan(plan), shard, out)
    for done, step in enumerate((collect_step, summarise, figures)):
        progress(step.__name__.removesuffix("_step"), done, 3)
        step(scene, layout)
    return plan


def collect_step(scene: Scene, layout: Layout) -> None:
    """Collect with the plan that is on disk."""
    collect(scene, sample(scene, layout), layout)


def stamp(path: Path) -> None:
    """Say that a step is done: an empty file named by the content it was done for."""
    with written_whole(path) as temporary:
        temporary.touch()


def revision() -> str:
    """The revision of the sources, where they are a git checkout."""
    folder = Path(__file__).parent
    command = ["git", "-C", str(folder), "describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True, timeout=10).stdout.strip()
    except (OSError, subprocess.SubprocessError):
        return "unknown"
