"""Faults of runs: killed, started twice, without disk, without permission, without memory."""

import contextlib
import hashlib
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path

from tests.faults.fault import Fault, Outcome

PROJECT = Path(__file__).parents[2]
STUDY = [sys.executable, "-m", "cablesim", "study"]
NAME = "small"
LIMIT = 300
PATIENCE = 5
# Bytes of a disk with room enough.
ROOM = 2**28
# A study of shards that take a moment, so that a run can be killed in the middle of one, and a scene of one large shard
# in which some scenarios have no solution.
SCENES = {
    "moored": """
title: Mooring lines
design:
  grid:
    length_ratio: [1.0, 1.0005, 1.001]
    wave_period: {start: 4 s, stop: 9 s, num: 12}
fixed: {depth: 100 m, chord_angle: 45 deg, linear_stiffness: 10 MN, mass_per_length: 3, area: 3 cm^2,
        normal_drag: 15.6, tangential_drag: 0.78, added_mass_per_length: 0.4}
methods:
  coarse: {solver: wave_line, options: {segments: 20}}
  fine: {solver: wave_line, options: {segments: 40}}
outputs: [max_top_tension, min_top_tension]
""",
    "spans": """
title: Spans
design:
  grid: {span: {start: 10 m, stop: 90 m, num: 200}, rise: {start: -40 m, stop: 40 m, num: 100}}
fixed: {line_length: 80 m, weight_per_length: 5 N/m}
methods:
  exact: {solver: catenary_exact}
outputs: [sag, max_tension]
""",
}


def make_study(folder: Path) -> Path:
    """A folder with the workflow and a small study."""
    shutil.copy(PROJECT / "Snakefile", folder)
    shutil.copytree(PROJECT / "workflow", folder / "workflow")
    (folder / "config" / "scenes").mkdir(parents=True)
    (folder / "config" / "config.yaml").write_text(f"study: {NAME}\nscenes: [moored]\n")
    for name, text in SCENES.items():
        (folder / "config" / "scenes" / f"{name}.yaml").write_text(text)
    return folder


def start(folder: Path, **settings: object) -> subprocess.Popen:
    """A study under way, in a process group of its own."""
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    return subprocess.Popen(STUDY, cwd=folder, start_new_session=True, **{**quiet, **settings})


def finish(folder: Path, before: Sequence[str] = ()) -> subprocess.CompletedProcess:
    """The one command that recovers; another may be put before it."""
    return subprocess.run([*before, *STUDY], cwd=folder, capture_output=True, text=True, timeout=LIMIT)


def last_line(run: subprocess.CompletedProcess) -> str:
    return (run.stderr.strip().splitlines() or [""])[-1]


def content(folder: Path) -> dict[str, str]:
    """What a study has found: shards, plans and tables by name and digest, but for what is measured."""
    results = folder / "results" / NAME
    kept = [*results.glob("shards/*/*.nc"), *results.glob("tables/*_values.csv"), *results.glob("figures/*")]
    return {
        str(path.relative_to(results)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in kept
        if not path.name.startswith(".")
    }


def ledgers(folder: Path) -> dict[Path, str]:
    """What is finished: a ledger tells the time that its shard took, so one that is computed again has another."""
    return {path: path.read_text() for path in (folder / "results" / NAME).glob("shards/*/*.json")}


class Reference:
    """A study that nothing happened to, and what it takes."""

    def __init__(self) -> None:
        self._temporary = tempfile.TemporaryDirectory()
        self.folder = make_study(Path(self._temporary.name))
        finish(self.folder)  # Kernels are compiled.
        shutil.rmtree(self.folder / "results")
        begin = time.monotonic()
        run = finish(self.folder)
        self.seconds = time.monotonic() - begin
        assert run.returncode == 0, run.stdout + run.stderr
        self.content = content(self.folder)
        assert self.content

    def difference(self, folder: Path) -> str:
        """In what a study differs from this one; nothing where it does not."""
        found = content(folder)
        differing = [name for name in {*self.content, *found} if self.content.get(name) != found.get(name)]
        return f"differs: {sorted(differing)[:5]}" if differing else ""


@cache
def undisturbed() -> Reference:
    """It is made once in a process."""
    return Reference()


# ---- kills ----


def _recovered(folder: Path, reference: Reference, before: dict[Path, str]) -> tuple[str, int]:
    """Run the one command; what is wrong afterwards, and how many finished shards were computed again."""
    run = finish(folder)
    if run.returncode != 0:
        return f"exit code {run.returncode}: {last_line(run)}", 0
    after = ledgers(folder)
    again = sum(after.get(path) != text for path, text in before.items())
    left = [str(path) for path in (folder / "results").rglob(".*.part")]
    trouble = [
        reference.difference(folder),
        f"left over: {left[:3]}" if left else "",
        f"{again} finished shards were computed again" if again else "",
    ]
    return "; ".join(filter(None, trouble)), again


def _killed_again_and_again(folder: Path, times: int, seed: int, whole_tree: bool) -> Outcome:
    draw, failures, lost = random.Random(seed), [], 0
    reference = undisturbed()
    for number in range(times):
        (folder / str(number)).mkdir()
        study = make_study(folder / str(number))
        _kill(start(study), draw.uniform(0.1, 1.0) * reference.seconds, whole_tree)
        trouble, again = _recovered(study, reference, ledgers(study))
        failures += [f"{number}: {trouble}"] if trouble else []
        lost += again
        shutil.rmtree(study)
    return Outcome(times, tuple(failures), lost, f"a study of {reference.seconds:.0f} s, killed at any moment of it")


def _kill(run: subprocess.Popen, seconds: float, whole_tree: bool) -> None:
    """Kill a study after some seconds, with all its jobs or without."""
    with contextlib.suppress(subprocess.TimeoutExpired):
        run.wait(seconds)
    with contextlib.suppress(ProcessLookupError):
        (os.killpg if whole_tree else os.kill)(run.pid, signal.SIGKILL)
    run.wait()
    until = time.monotonic() + PATIENCE
    while whole_tree and _group_is_alive(run.pid) and time.monotonic() < until:
        time.sleep(0.01)


def _group_is_alive(group: int) -> bool:
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def kill_tree(folder: Path, times: int, seed: int) -> Outcome:
    return _killed_again_and_again(folder, times, seed, whole_tree=True)


def kill_scheduler(folder: Path, times: int, seed: int) -> Outcome:
    return _killed_again_and_again(folder, times, seed, whole_tree=False)


def kill_writers(folder: Path, times: int, seed: int) -> Outcome:
    """Processes that write shards over and over, each killed at any moment; nothing partial is ever accepted."""
    from cablesim.config.scene import read_scene
    from cablesim.database.shard_file import solve_recipe, write_shard
    from cablesim.files import check, digest_of, discard, ledger, parts
    from cablesim.plan import plan_scene

    draw, failures, mid_write = random.Random(seed), [], 0
    make_study(folder)
    scene = read_scene(folder / "config" / "scenes" / "spans.yaml")
    recipe = next(iter(plan_scene(scene, folder / "plans").recipes.values()))
    solved, path = solve_recipe(recipe), folder / "shards" / f"{recipe.digest}.nc"
    begin = time.monotonic()
    write_shard(path, recipe, solved)
    seconds, right, size = time.monotonic() - begin, digest_of(path), path.stat().st_size
    for number in range(times):
        discard(path)
        child = os.fork()
        if child == 0:
            try:
                write_shard(path, recipe, solved)
            finally:
                os._exit(0)
        time.sleep(draw.uniform(0.0, 1.2) * seconds)
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        left = parts(path.parent)
        mid_write += bool(left)
        if path.exists() and digest_of(path) != right:
            failures.append(f"{number}: there under its name, and not what was written")
        if ledger(path).exists() and not check(path).whole:
            failures.append(f"{number}: a ledger for {check(path).condition.value}")
        for part in left:
            part.unlink()
    figures = f"a shard of {size} bytes, {mid_write} killed in mid-write, 0 partial files accepted"
    return Outcome(times, tuple(failures), None, figures if not failures else f"{mid_write} killed in mid-write")


def kill_jobs(folder: Path, times: int, seed: int) -> Outcome:
    """One job of a study killed at any moment, as by a machine that runs out of memory: the others go on."""
    draw, failures, lost, killed = random.Random(seed), [], 0, 0
    reference = undisturbed()
    while killed < times:
        (folder / "study").mkdir()
        study = make_study(folder / "study")
        run = start(study, stderr=subprocess.PIPE, text=True)
        time.sleep(draw.uniform(0.1, 0.7) * reference.seconds)
        job = _one_job(run.pid, draw)
        if job:
            os.kill(job, signal.SIGKILL)
        error = run.communicate(timeout=LIMIT)[1].strip().splitlines()[-1:]
        if job and run.returncode != 0:
            killed += 1
            told = run.returncode == 3 and "was killed" in error[0]
            trouble, again = _recovered(study, reference, ledgers(study))
            failures += [f"{killed}: {trouble or error}"] if trouble or not told else []
            lost += again
        shutil.rmtree(study)
    return Outcome(times, tuple(failures), lost, "the study says so with exit code 3, and the next run ends well")


def _one_job(study: int, draw: random.Random) -> int:
    """The process of a step that a study has at work; 0 where there is none."""
    import psutil

    until = time.monotonic() + PATIENCE
    while time.monotonic() < until and psutil.Process(study).status() != psutil.STATUS_ZOMBIE:
        with contextlib.suppress(psutil.Error):
            found = [one.pid for one in psutil.Process(study).children(recursive=True) if "step" in one.cmdline()[:4]]
            if found:
                return draw.choice(found)
        time.sleep(0.02)
    return 0


# ---- two at once ----


def concurrent_starts(folder: Path, times: int, seed: int) -> Outcome:
    """Three commands in one folder at once: one works, the others say who does, and end with exit code 3."""
    failures = []
    reference = undisturbed()
    for number in range(times):
        (folder / str(number)).mkdir()
        study = make_study(folder / str(number))
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
        runs = [start(study, **pipes) for _ in range(3)]
        told = [run.communicate(timeout=LIMIT)[1].strip().splitlines()[-1] for run in runs]
        codes = [run.returncode for run in runs]
        worker = next((run.pid for run in runs if run.returncode == 0), 0)
        named = sum(f"process {worker} on " in line and "since 20" in line for line in told)
        if sorted(codes) != [0, 3, 3] or named != 2:
            failures.append(f"{number}: exit codes {codes}: {told}")
        elif trouble := reference.difference(study):
            failures.append(f"{number}: {trouble}")
        shutil.rmtree(study)
    return Outcome(times, tuple(failures), 0, "three commands at once: one works, two are told")


# ---- disk, permissions, memory ----


@contextlib.contextmanager
def small_disk(folder: Path, size: int) -> Iterator[Path]:
    """A disk of so many bytes, in memory. Raises CalledProcessError or OSError where that is not permitted."""
    folder.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", folder], check=True, capture_output=True)
    try:
        yield folder
    finally:
        subprocess.run(["umount", "--lazy", folder], check=True)


NO_DISK = Outcome(0, (), 0, "not injected: no permission to mount a small disk here")


def remount(folder: Path, how: str) -> None:
    subprocess.run(["mount", "-o", f"remount,{how}", folder], check=True, capture_output=True)


def can_mount(folder: Path) -> bool:
    try:
        with small_disk(folder, 2**20):
            return True
    except (OSError, subprocess.CalledProcessError):
        return False


def used(folder: Path) -> int:
    status = os.statvfs(folder)
    return (status.f_blocks - status.f_bfree) * status.f_frsize


def disk_full(folder: Path, times: int, seed: int) -> Outcome:
    """A disk that fills up during a study: exit code 3, path and bytes are named; with room it goes on."""
    draw, failures, lost, full, number = random.Random(seed), [], 0, 0, 0
    if not can_mount(folder / "trial"):
        return NO_DISK
    reference = undisturbed()
    while full < times:
        number += 1
        with small_disk(folder / str(number), ROOM) as disk:
            run = start(make_study(disk), stderr=subprocess.PIPE, text=True)
            time.sleep(draw.uniform(0.1, 0.8) * reference.seconds)
            remount(disk, f"size={used(disk) + 4096 * draw.randrange(3)}")
            told = run.communicate(timeout=LIMIT)[1]
            if run.returncode == 0:
                continue  # There was room enough.
            full += 1
            line = told.strip().splitlines()[-1]
            if run.returncode != 3 or not (str(NAME) in line and "bytes" in line) or "Traceback" in told:
                failures.append(f"{number}: exit code {run.returncode}: {line}")
            before = ledgers(disk)
            remount(disk, f"size={ROOM}")
            trouble, again = _recovered(disk, reference, before)
            failures += [f"{number}: {trouble}"] if trouble else []
            lost += again
    return Outcome(times, tuple(failures), lost, "full at any moment of the study")


def kth_write_fails(folder: Path, times: int, seed: int) -> Outcome:
    """`cablesim run` on a disk that is full at the k-th block: nothing partial is accepted, the next run is right."""
    failures, k = [], 0
    if not can_mount(folder / "trial"):
        return NO_DISK
    make_study(folder)
    scene = folder / "config" / "scenes" / "spans.yaml"
    right = _run_scene(scene, folder / "right")
    size = sum(path.stat().st_size for path in (folder / "right").rglob("*") if path.is_file())
    with small_disk(folder / "disk", ROOM) as disk:
        for number in range(times):
            k = 1 + number * (size // 4096) // times
            _run_scene(scene, disk / "results", full_after=(disk, 4096 * k, ROOM))
            found = _run_scene(scene, disk / "results")
            if found != right:
                failures.append(f"full at block {k}: {found or 'the next run fails'}")
            shutil.rmtree(disk / "results")
    return Outcome(times, tuple(failures), 0, f"blocks 1 to {k} of 4 KiB")


def _run_scene(scene: Path, results: Path, full_after: tuple[Path, int, int] | None = None) -> dict[str, str]:
    """The shards, by digest, after `cablesim run` in this process; nothing where it ends with exit code 3."""
    from cablesim.cli import main

    if full_after is not None:
        disk, room, whole = full_after
        remount(disk, f"size={used(disk) + room}")
    try:
        with (
            Path(os.devnull).open("w") as nowhere,
            contextlib.redirect_stderr(nowhere),
            contextlib.redirect_stdout(nowhere),
        ):
            code = main(["run", str(scene), "--out", str(results)])
    finally:
        if full_after is not None:
            remount(disk, f"size={whole}")
    if code not in (1, 3):
        return {"exit code": str(code)}
    shards = results.glob("shards/*/*.nc") if code == 1 else ()
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in shards}


PLACES = (".", "shards/moored", "stamps", "tables", "plans")
OVERRIDE = "-dac_override,-dac_read_search"
# The superuser may write everywhere, unless this is taken away.
UNPRIVILEGED = ["setpriv", "--bounding-set", OVERRIDE, "--inh-caps", OVERRIDE] if os.getuid() == 0 else []


def read_only(folder: Path, times: int, seed: int) -> Outcome:
    """A disk that may only be read, before the study or in the middle of it."""
    draw, failures, lost = random.Random(seed), [], 0
    if not can_mount(folder / "trial"):
        return NO_DISK
    reference = undisturbed()
    for number in range(times):
        with small_disk(folder / str(number), ROOM) as disk:
            make_study(disk)
            if number % 2:
                _kill(start(disk), draw.uniform(0.2, 0.8) * reference.seconds, whole_tree=True)
            remount(disk, "ro")
            run = finish(disk)
            line = last_line(run)
            if run.returncode != 3 or "Read-only file system" not in line or "Traceback" in run.stderr:
                failures.append(f"{number}: exit code {run.returncode}: {line}")
            before = ledgers(disk)
            remount(disk, "rw")
            trouble, again = _recovered(disk, reference, before)
            failures += [f"{number}: {trouble}"] if trouble else []
            lost += again
    return Outcome(times, tuple(failures), lost, "")


def no_permission(folder: Path, times: int, seed: int) -> Outcome:
    """A folder in the results that may not be written, once more each time."""
    if UNPRIVILEGED and not shutil.which(UNPRIVILEGED[0]):
        return Outcome(0, (), 0, "not injected: the superuser may write everywhere, and there is no setpriv here")
    failures = []
    reference = undisturbed()
    for number in range(times):
        study = Path(shutil.copytree(reference.folder, folder / str(number)))
        results = study / "results" / NAME
        place = results / PLACES[number % len(PLACES)]
        for path in (file for kind in ("stamps/*", "plans/*", "shards/moored/*") for file in results.glob(kind)):
            path.unlink()
        place.chmod(0o555)
        run = finish(study, before=UNPRIVILEGED)
        line = last_line(run)
        named = "Permission denied" in line and str(place.relative_to(study)) in line
        if run.returncode != 3 or not named or "Traceback" in run.stderr:
            failures.append(f"{number}: {place.name}: exit code {run.returncode}: {line}")
        # Snakemake removes an empty folder that should have got an output.
        place.mkdir(exist_ok=True)
        place.chmod(0o755)
        trouble, _ = _recovered(study, reference, {})
        failures += [f"{number}: {trouble}"] if trouble else []
        shutil.rmtree(study)
    return Outcome(times, tuple(failures), 0, f"of results: {', '.join(PLACES)}")


def no_memory(folder: Path, times: int, seed: int) -> Outcome:
    """`cablesim run` with less memory than it needs: solved, or exit code 3 in one line; nothing partial is kept."""
    draw, failures, short = random.Random(seed), [], 0
    make_study(folder)
    small = folder / "config" / "scenes" / "spans.yaml"
    large = small.with_name("large.yaml")
    large.write_text(small.read_text().replace("num: 200", "num: 2000").replace("num: 100", "num: 500"))
    right = _run_scene(large, folder / "right")
    for number in range(times):
        results = folder / str(number)
        code, line = _run_in_little_memory(small, large, results, int(draw.uniform(0, MOST_MEMORY)))
        short += code == 3
        # HDF5 does not say that it is memory that it lacks.
        if code not in (1, 3) or (code == 3 and not re.search("memory|cannot be read|cannot be written", line)):
            failures.append(f"{number}: exit code {code}: {line}")
        found = _run_scene(large, results)
        failures += [] if found == right else [f"{number}: differs after the next run"]
        shutil.rmtree(results)
    most = MOST_MEMORY // 2**20
    return Outcome(
        times, tuple(failures), None, f"{short} ran out of memory, with up to {most} MiB more than at the start"
    )


# Runs a small scene, so that all is imported, then a large one with so many bytes more than it has then.
LITTLE_MEMORY = """
import os, resource, sys
from cablesim.cli import main
small, large, results, more = sys.argv[1:]
main(["run", small, "--out", results + ".small"])
has = int(open("/proc/self/statm").read().split()[0]) * os.sysconf("SC_PAGE_SIZE")
resource.setrlimit(resource.RLIMIT_AS, (has + int(more), has + int(more)))
sys.exit(main(["run", large, "--out", results]))
"""
MOST_MEMORY = 120 * 2**20


def _run_in_little_memory(small: Path, large: Path, results: Path, more: int) -> tuple[int, str]:
    """Exit code and last line of a run in a process that may take some bytes more than it has after a small run."""
    command = [sys.executable, "-c", LITTLE_MEMORY, str(small), str(large), str(results), str(more)]
    run = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT)
    return run.returncode, last_line(run)


NEXT_RUN = "cablesim study"
FAULTS = (
    Fault("process killed while it writes a shard", "the next run", kill_writers, 50, 1000),
    Fault("job killed", NEXT_RUN, kill_jobs, 1, 6),
    Fault("scheduler killed, its jobs go on", NEXT_RUN, kill_scheduler, 1, 50),
    Fault("all processes killed", NEXT_RUN, kill_tree, 1, 50),
    Fault("three starts at once", "none: one of them works", concurrent_starts, 1, 6),
    Fault("disk full at the k-th block", "the next run", kth_write_fails, 5, 100),
    Fault("disk full during a study", NEXT_RUN, disk_full, 1, 8),
    Fault("disk becomes read-only", NEXT_RUN, read_only, 1, 4),
    Fault("no permission to write", NEXT_RUN, no_permission, 1, 5),
    Fault("not enough memory", "the next run", no_memory, 3, 50),
)
