"""Faults of files that are there: damaged, cut short, swapped, foreign, copied, with clocks that are wrong."""

import random
import shutil
import zipfile
from collections import Counter
from pathlib import Path

import numpy as np

from cablesim.config.scene import read_scene
from cablesim.database.reading import read_dataset
from cablesim.errors import EnvironmentFault, InputError
from cablesim.files import check, discard, holds_good, ledger
from cablesim.plan import read_plan
from cablesim.status import Status
from cablesim.steps import collect_partly
from tests.faults import ways
from tests.faults.copies import COPIES
from tests.faults.fault import Fault, Outcome
from tests.faults.studies import Study, finished, make_study, run_by_snakemake
from tests.faults.unreadable import UNREADABLE

# Names that a shell would obey.
FOLDERS = (
    "$(touch pwned)",
    "a; touch pwned",
    "'quoted\" `touch pwned`",
    "two  spaces & more",
    "{braces} {0.__class__}",
)
# A folder that is in the way of a file must be removed by whoever made it.
REPLACEABLE = tuple(way for way in ways.WAYS if way is not ways.folder)


def mended(study: Study) -> int:
    """Run a study until it is through, without the folders that are named as being in the way; shards computed."""
    before = inodes(study)
    while True:
        try:
            study.run()
            return len(inodes(study).items() - before.items())
        except EnvironmentFault as fault:
            in_the_way = Path(study.folder / str(fault).split(":", 1)[0])
            if not in_the_way.is_dir():
                raise
            in_the_way.rmdir()


def inodes(study: Study) -> dict[Path, tuple[int, int]]:
    """What is other for every file that is written anew."""
    found = {path: path.stat() for path in study.shards() if path.is_file()}
    return {path: (status.st_ino, status.st_mtime_ns) for path, status in found.items()}


def shards(folder: Path, times: int, seed: int) -> Outcome:
    """Damage shards or their ledgers; look at what is read of the others; run; count what was computed."""
    draw, failures, injected, lost = random.Random(seed), [], 0, 0
    whole = make_study(folder / "whole", "many", "limits", split=True)
    whole.run()
    same, before = whole.same(), read_dataset(whole.layout.dataset("many"))
    for number in range(-(-times // 60)):
        study = whole.copy(folder / f"damaged_{number}")
        paths = study.shards()
        hit = draw.sample(paths, min(60, times - injected))
        injected += len(hit)
        for path in hit:
            damage_shard(path, draw, paths)
        bad = {path for path in paths if not check(path).whole}
        failures += [f"{path.name}: other bytes were not found" for path in others(study, whole) - bad]
        failures += misread(study, bad, before)
        computed = mended(study)
        lost += computed
        if computed != len(bad):
            failures.append(f"round {number}: {computed} were computed, {len(bad)} were lost")
        if study.same() != same:
            failures.append(f"round {number}: other results")
        shutil.rmtree(study.folder)
    return Outcome(injected, tuple(failures), lost, "as many shards were computed as were lost, byte for byte the same")


def damage_shard(path: Path, draw: random.Random, paths: list[Path]) -> None:
    """Damage a shard or, every fifth time, its ledger; the seconds in a ledger are no result."""
    if draw.random() < 0.2:
        draw.choice((*ways.BYTES, ways.text))(ledger(path), draw, [ledger(other) for other in paths])
    elif path.is_file():
        draw.choice((*ways.WAYS, ways.swapped))(path, draw, [other for other in paths if other.is_file()])


def others(study: Study, whole: Study) -> set[Path]:
    """The shards of a study that are not, byte for byte, those of another."""
    pairs = ((path, study.folder / path.relative_to(whole.folder)) for path in whole.shards())
    return {copy for path, copy in pairs if not copy.is_file() or copy.read_bytes() != path.read_bytes()}


def misread(study: Study, bad: set[Path], before: object) -> list[str]:
    """What is wrong in a dataset of the shards that are left: those that are lost are not run, the others as before."""
    discard(study.layout.dataset("many"))
    left_out = collect_partly(read_scene(study.scene("many")), study.layout)
    if set(left_out) != {path for path in bad if path.parent.name == "many"}:
        return ["other shards are left out than those that are bad"]
    after = read_dataset(study.layout.dataset("many"))
    lost = after.status.values == Status.not_run
    for name in ("sag", "max_tension"):
        if not np.isnan(after[name].values[lost]).all() or not np.array_equal(
            after[name].values[~lost], before[name].values[~lost], equal_nan=True
        ):
            return [f"{name} is not what it was"]
    return []


def other_files(folder: Path, times: int, seed: int) -> Outcome:
    """Damage a dataset, plan, table, figure, stamp, ledger, the timings or the catalogue: the next run must know."""
    draw, failures, kinds = random.Random(seed), [], Counter[str]()
    whole = finished(folder / "whole")
    paths = products(whole)
    for number in range(times):
        study = whole.copy(folder / "damaged")
        place = draw.choice(paths)
        way = draw.choice(ways.WAYS)
        kinds[place.parts[0] if len(place.parts) > 1 else place.suffix] += 1
        before = (study.results / place).read_bytes()
        way(study.results / place, draw, [study.results / path for path in paths])
        if not is_known(study, place, before):
            failures.append(f"{number}: {way.__name__} of {place} was not found")
        shutil.rmtree(study.folder)
    return Outcome(times, tuple(failures), 0, ", ".join(f"{name} {count}" for name, count in sorted(kinds.items())))


def products(study: Study) -> list[Path]:
    """Its files but for shards, their ledgers and logs, by their places in the results."""
    found = (path.relative_to(study.results) for path in sorted(study.results.rglob("*")) if path.is_file())
    return [path for path in found if path.parts[0] not in ("shards", "logs") and ".solve." not in path.name]


def is_known(study: Study, place: Path, before: bytes) -> bool:
    """Whether the next run would make a damaged file again, has done so when it planned, or is not misled by it."""
    path = study.results / place
    vouching = {ledger(study.results / name): study.results / name for name in products(study)}
    try:
        undone = study.undone()
    except (OSError, EnvironmentFault) as fault:
        return path.name in str(fault)
    if undone or (path.is_file() and path.read_bytes() == before):
        return True
    if path.suffix == ".npz":
        return is_same_plan(path, before)
    # A ledger without which the catalogue is read from the datasets, or of which only the seconds are others.
    if place.parts[0] == "stamps":
        return holds_good(path)
    return path in vouching and (place.name == "catalogue.parquet.json" or check(vouching[path]).whole)


def by_snakemake(folder: Path, times: int, seed: int) -> Outcome:
    """Damage some files of any kind, run Snakemake once, and compare all with a study that nothing happened to."""
    draw, failures, lost = random.Random(seed), [], 0
    whole = finished(folder / "whole")
    same = whole.same()
    rounds = 0
    while (injected := rounds * 5) < times:
        study = whole.copy(folder / draw.choice(FOLDERS))
        paths = [*(study.results / path for path in products(study)), *study.shards()]
        done = {path: draw.choice(REPLACEABLE) for path in draw.sample(paths, 5)}
        for path, way in done.items():
            if path.exists():
                way(path, draw, [other for other in paths if other.is_file()])
        lost += len(study.lost())
        told = ", ".join(f"{way.__name__} of {path.name}" for path, way in done.items())
        try:
            run_by_snakemake(study)
            after = study.same()
            other = sorted(name for name in same.keys() | after.keys() if same.get(name) != after.get(name))
            failures += [f"round {rounds}, {told}: {other} are others"] if other else []
            failures += [f"round {rounds}, {told}: {study.undone()} are undone"] if study.undone() else []
        except RuntimeError as problem:
            failures.append(f"round {rounds}, {told}: {problem}")
        rounds += 1
        shutil.rmtree(study.folder)
    failures += [f"{path} was made" for path in folder.rglob("pwned")]
    return Outcome(injected, tuple(failures), lost, f"{rounds} runs of Snakemake, each after 5 files were damaged")


def content(path: Path) -> str:
    """All that is in a plan."""
    plan = read_plan(path)
    methods = [
        (m.method, m.positions, p.recipe.digest, p.axis, [a.tolist() for a in (*p.source, *p.target)])
        for m in plan.methods
        for p in m.placements
    ]
    return repr((plan.scene, plan.digest, methods))


def is_same_plan(path: Path, before: bytes) -> bool:
    """Whether damage to a plan has struck where nothing is."""
    found = content(path)
    path.write_bytes(before)
    return found == content(path)


def pickled(path: Path, draw: random.Random, others: list[Path]) -> None:
    """A plan that would touch a file if its pickle were loaded."""

    class Touching:
        def __reduce__(self):
            return Path.touch, (path.parent / "touched",)

    with path.open("wb") as file:
        np.savez(file, allow_pickle=True, head=np.array([Touching()], dtype=object))


def bomb(path: Path, draw: random.Random, others: list[Path]) -> None:
    """An archive of a few kilobytes that would be many megabytes."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("head.npy", bytes(2**25))


def huge(path: Path, draw: random.Random, others: list[Path]) -> None:
    """An array that says it has a million million numbers."""
    head = b"{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000,), }"
    content = b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head + bytes(80)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("head.npy", content)


def plans(folder: Path, times: int, seed: int) -> Outcome:
    """Damage plans in every way, with pickles and bombs among them: each is made again, and no shard is lost by it."""
    draw, failures = random.Random(seed), []
    whole = make_study(folder / "whole", "many", "limits", split=True)
    whole.run()
    kept = {path: path.read_bytes() for path in sorted((whole.results / "plans").glob("*.npz"))}
    contents = {path: content(path) for path in kept}
    refused = misread = 0
    for number in range(times):
        path = draw.choice(list(kept))
        way = draw.choice((*REPLACEABLE, pickled, bomb, huge))
        way(path, draw, list(kept))
        try:
            misread += content(path) != contents[path]
        except (EnvironmentFault, InputError):
            refused += 1
        if whole.lost() or content(path) != contents[path]:
            failures.append(f"{number}: {way.__name__} of {path.name}: another plan")
        path.unlink()
        path.write_bytes(kept[path])
    failures += [f"{misread} plans were read that were others"] if misread else []
    return Outcome(times, tuple(failures), 0, f"{refused} refused and made again, {times - refused} the same plan")


FAULTS: tuple[Fault, ...] = (
    Fault("a shard or its ledger is damaged, cut, swapped or foreign", "the next run", shards, 63, 2520),
    Fault("another file of a study is damaged, cut, swapped or foreign", "the next run", other_files, 40, 1000),
    Fault("any five files of a study, mended by Snakemake", "the next run", by_snakemake, 5, 40),
    Fault("a plan is damaged, a pickle or a bomb", "the next run", plans, 30, 1000),
    *COPIES,
    *UNREADABLE,
)
