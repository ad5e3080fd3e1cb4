"""Studies that are copied, moved and mixed, with clocks that are wrong: content decides, not times."""

import os
import random
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

from tests.faults.fault import Fault, Outcome
from tests.faults.studies import SCENES, Study, finished, make_study, run_by_snakemake
from tests.test_workflow import digests

LATEST = 4_102_444_800.0  # the year 2100


def files(study: Study) -> list[Path]:
    """Everything in a study's folder, in the order of a copy."""
    return sorted(path for path in study.folder.rglob("*") if path.is_file())


def clocked(whole: Study, folder: Path, draw: random.Random) -> Study:
    """A copy whose files have the times of 1970, 2100, of chance, or the other way round."""
    study = whole.copy(folder)
    of: Callable[[float], float] = draw.choice(
        [lambda _: 0.0, lambda _: LATEST, lambda _: draw.uniform(0.0, LATEST), lambda time: LATEST - time]
    )
    for path in [*files(study), *(path for path in study.folder.rglob("*") if path.is_dir())]:
        time = of(path.stat().st_mtime)
        os.utime(path, (time, time))
    return study


def copied(whole: Study, folder: Path, draw: random.Random) -> Study:
    """A copy by `cp -r`, whose files are all new."""
    subprocess.run(["cp", "-r", str(whole.folder), str(folder)], check=True)
    return Study(folder, whole.names)


def moved(whole: Study, folder: Path, draw: random.Random) -> Study:
    """A copy that was moved."""
    study = whole.copy(folder.with_name("elsewhere"))
    study.folder.rename(folder)
    return Study(folder, whole.names)


def packed(whole: Study, folder: Path, draw: random.Random) -> Study:
    """A copy through an archive."""
    archive = folder.with_suffix(".tar")
    subprocess.run(["tar", "-C", str(whole.folder), "-cf", str(archive), "."], check=True)
    folder.mkdir()
    subprocess.run(["tar", "-C", str(folder), "-xf", str(archive)], check=True)
    archive.unlink()
    return Study(folder, whole.names)


def interrupted(whole: Study, folder: Path, draw: random.Random) -> Study:
    """A copy that was broken off, in the order of names or in none, in the midst of a file."""
    study = whole.copy(folder)
    there = sorted(path for path in study.results.rglob("*") if path.is_file())
    if draw.random() < 0.5:
        draw.shuffle(there)
    first = draw.randrange(len(there))
    os.truncate(there[first], draw.randrange(there[first].stat().st_size + 1))
    for path in there[first + 1 :]:
        path.unlink()
    return study


def overlaid(older: Study) -> Callable[[Study, Path, random.Random], Study]:
    """A copy over which the results of an older study were copied, all of them or until that was broken off."""

    def way(whole: Study, folder: Path, draw: random.Random) -> Study:
        study = whole.copy(folder)
        there = sorted(path for path in older.results.rglob("*") if path.is_file())
        for path in there[: draw.choice([len(there), draw.randrange(1, len(there))])]:
            target = study.results / path.relative_to(older.results)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, target)
        return study

    return way


def injected(
    whole: Study, way: Callable[[Study, Path, random.Random], Study], times: int, seed: int, each: int
) -> Outcome:
    """Copy in some way, many times; run, every so often by Snakemake, and count what was computed."""
    draw, failures, lost, runs = random.Random(seed), [], 0, 0
    same, content = whole.same(), digests(whole.results)
    for number in range(times):
        study = way(whole, whole.folder.with_name("copy"), draw)
        missing = study.lost()
        lost += len(missing)
        changed = {name for name, digest in digests(study.results).items() if content.get(name, digest) != digest}
        changed |= content.keys() - digests(study.results).keys()
        undone = study.undone()
        if bool(undone) != any(not name.startswith("logs") for name in changed):
            failures.append(f"{number}: {len(changed)} files differ, {len(undone)} are to be made")
        if number % each == each - 1:
            runs += 1
            run_by_snakemake(study)
            failures += [f"{number}: something is left to be made"] if study.undone() else []
        elif (computed := study.run()) != (expected := sum(missing.values())):
            failures.append(f"{number}: {computed} scenarios were computed, {expected} were lost")
        after = study.same()
        if {name: after.get(name) for name in same} != same:
            failures.append(f"{number}: other results")
        shutil.rmtree(study.folder)
    return Outcome(times, tuple(failures), lost, f"{runs} of the runs by Snakemake")


def times_and_places(folder: Path, times: int, seed: int) -> Outcome:
    """Whole copies: nothing is computed."""
    whole = finished(folder / "whole", "many", "limits")
    ways = (clocked, copied, moved, packed)
    return injected(whole, lambda *given: ways[given[2].randrange(4)](*given), times, seed, 25)


def parts(folder: Path, times: int, seed: int) -> Outcome:
    return injected(finished(folder / "whole", "many", "limits"), interrupted, times, seed, 25)


def mixtures(folder: Path, times: int, seed: int) -> Outcome:
    whole = finished(folder / "whole", "many", "limits")
    older = make_study(folder / "older", "many", "limits")
    older.scene("many").write_text(SCENES["many"].replace("1.2, 1.3]", "1.2]").replace("title: Many", "title: Few"))
    older.scene("limits").write_text(SCENES["limits"].replace("3 %, ", "4 %, "))
    older.finish()
    return injected(whole, overlaid(older), times, seed, 25)


COPIES: tuple[Fault, ...] = (
    Fault("clocks are wrong, or the study was copied or moved", "none is needed", times_and_places, 6, 100),
    Fault("a copy was interrupted", "the next run", parts, 6, 50),
    Fault("an older study was copied over", "the next run", mixtures, 6, 50),
)
