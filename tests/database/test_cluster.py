"""Collecting and querying on a Dask cluster: the same bytes as without, workers that die, faults in one line."""

import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest
from distributed import LocalCluster

from cablesim import shards as blocks
from cablesim.cli import main
from cablesim.config.scene import read_scene
from cablesim.database import cluster, gather, scan
from cablesim.database.cluster import connected, map_in_order
from cablesim.database.query import Order, Request, ask
from cablesim.database.reading import chosen_paths, open_scenes
from cablesim.errors import EnvironmentFault
from cablesim.solver import PACKAGE
from cablesim.steps import collect, run_scene
from cablesim.study import Layout
from tests.test_workflow import make_project, replace, root_group

SCENE = """
title: Many small shards
design:
  grid:
    span: {start: 10, stop: 40, num: 16}
    length_ratio: [0.9, 1.1, 1.2, 1.3, 1.4]
fixed: {weight_per_length: 5 N/m}
methods:
  exact: {solver: catenary_exact, options: {nodes: 5}}
  parabolic: {solver: catenary_parabolic, options: {nodes: 5}}
outputs: [sag, max_tension, profile]
"""
QUERIES = [
    ("spans", ()),
    ("spans", ("sag > 3 m and span < 40 m",)),
    ("spans", ("exact.sag > 1.01 * parabolic.sag", "--columns", "span,method,sag", "--no-units")),
    ("spans", ("status == ok", "--order-by", "sag desc")),
    ("spans", ("status == ok", "--order-by", "method", "--order-by", "sag / span desc", "--limit", "5")),
    ("spans", ("--limit", "7")),
    ("spans", ("sag > 1000 m",)),
    ("spans", ("span == 11 m",)),
    ("spans", ("--nearest", "span=19 m")),
    ("spans,inclined", ("sag > 2 m",)),
    ("*", ("sag > 2 m", "--order-by", "sag", "--limit", "6")),
]


@pytest.fixture(scope="module")
def local() -> Iterator[LocalCluster]:
    """Two worker processes of two threads each; who dies is started again."""
    with LocalCluster(n_workers=2, threads_per_worker=2, dashboard_address=None, silence_logs=50) as running:
        yield running


@pytest.fixture(scope="module")
def address(local) -> str:
    return local.scheduler_address


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study whose every scenario has a shard of its own."""
    folder = tmp_path_factory.mktemp("cluster")
    (folder / "many.yaml").write_text(SCENE)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(blocks, "MOST_SCENARIOS", 1)
        run_scene(read_scene(folder / "many.yaml"), Layout(folder / "results"), lambda step, done, total: None)
    return folder


@pytest.fixture
def many(made: Path, tmp_path: Path) -> Path:
    """A copy of it without its dataset."""
    shutil.copytree(made, tmp_path, dirs_exist_ok=True)
    for suffix in (".nc", ".json"):
        (tmp_path / "results" / f"many{suffix}").unlink()
    return tmp_path


def printed(capfdbinary, *arguments: str) -> bytes:
    """What a command writes to standard output, and that it says nothing of a fault."""
    assert main([*arguments]) in (0, 1, None)
    out, err = capfdbinary.readouterr()
    assert b"Traceback" not in err and b"cablesim:" not in err
    return out


def refused(capfd, *arguments: str) -> tuple[int, str]:
    """The exit code of a command, and its only line on standard error; nothing is on standard output."""
    code = main([*arguments])
    out, err = capfd.readouterr()
    assert out == ""
    assert err.count("\n") == 1, err
    return code, err


def kill_a_worker(local: LocalCluster) -> None:
    os.kill(next(iter(local.workers.values())).process.process.pid, signal.SIGKILL)


@pytest.mark.parametrize(
    ("scene", "asked", "form"),
    [*((*one, "csv") for one in QUERIES), *((*one, form) for one in QUERIES[1:10:4] for form in ("json", "parquet"))],
)
def test_a_query_has_the_same_bytes(stored, address, capfdbinary, monkeypatch, scene, asked, form):
    monkeypatch.setattr(scan, "BLOCK", 5)
    query = ("query", str(stored), scene, *asked, "--format", form)
    output = str(stored.parent / "found")
    if form == "parquet":
        found = []
        for where in ((), ("--dask-address", address)):
            printed(capfdbinary, *query, "--output", output, *where)
            found.append(Path(output).read_bytes())
    else:
        found = [printed(capfdbinary, *query), printed(capfdbinary, *query, "--dask-address", address)]
    assert found[0] == found[1] and found[0]


def test_profiles_are_found_on_the_cluster_too(stored, address, tmp_path, capfdbinary, monkeypatch):
    monkeypatch.setattr(scan, "BLOCK", 5)
    paths = tmp_path / "here.nc", tmp_path / "there.nc"
    query = ("query", str(stored), "spans", "sag > 3 m", "--columns", "sag,profile", "--format", "netcdf", "--output")
    printed(capfdbinary, *query, str(paths[0]))
    printed(capfdbinary, *query, str(paths[1]), "--dask-address", address)
    assert root_group(paths[0]) == root_group(paths[1])


def test_the_environment_may_name_the_cluster(stored, address, capfdbinary, monkeypatch):
    asked = []
    monkeypatch.setenv("CABLESIM_DASK_ADDRESS", address)
    monkeypatch.setattr(cluster, "_connect", lambda at, connect=cluster._connect: asked.append(at) or connect(at))
    printed(capfdbinary, "query", str(stored), "spans")
    assert asked == [address]


@pytest.mark.parametrize("together", [1, 7, 1000])
def test_collecting_gives_the_same_bytes(made, many, address, capfdbinary, monkeypatch, together):
    monkeypatch.setattr(gather, "MOST_TOGETHER", together)
    where = (str(many / "many.yaml"), str(many / "results"))
    printed(capfdbinary, "step", "collect", *where, "--dask-address", address)
    assert root_group(many / "results" / "many.nc") == root_group(made / "results" / "many.nc")
    (many / "results" / "many.nc").unlink()
    printed(capfdbinary, "collect", where[0], "--out", where[1], "--dask-address", address)
    assert root_group(many / "results" / "many.nc") == root_group(made / "results" / "many.nc")


def test_no_more_is_under_way_than_a_few_for_each_worker(address):
    taken = []

    def items() -> Iterator[int]:
        for item in range(100):
            taken.append(item)
            yield item

    with connected(address):
        for done, found in enumerate(map_in_order(abs, items())):
            assert found == done
            assert len(taken) <= done + 1 + cluster.IN_FLIGHT * 2
    assert len(taken) == 100


def test_a_query_survives_the_death_of_a_worker(stored, local, address, monkeypatch):
    monkeypatch.setattr(scan, "BLOCK", 1)
    request = Request("sag > 0 m", order=(Order("sag"),))
    expected = ask(open_scenes(stored, "spans"), request).table()
    with connected(address):
        answer = ask(open_scenes(stored, "spans"), Request("sag > 0 m"), files=chosen_paths(stored, "spans"))
        pieces = [next(answer.pieces), next(answer.pieces), next(answer.pieces)]
        kill_a_worker(local)
        pieces += list(answer.pieces)
    assert sorted(sag for piece in pieces for sag in piece.sag) == expected.sag.tolist()


def test_collecting_survives_the_death_of_a_worker(made, many, local, address, monkeypatch):
    def map_and_kill(function, items):
        for number, found in enumerate(map_in_order(function, items)):
            if number == 3:
                kill_a_worker(local)
            yield found

    monkeypatch.setattr(gather, "MOST_TOGETHER", 1)
    monkeypatch.setattr(gather, "map_in_order", map_and_kill)
    with connected(address):
        collect(read_scene(many / "many.yaml"), Layout(many / "results"))
    assert root_group(many / "results" / "many.nc") == root_group(made / "results" / "many.nc")


def test_what_fails_on_a_worker_is_told_as_here(address):
    with connected(address), pytest.raises(ZeroDivisionError):
        list(map_in_order(divmod_of, [(1, 1), (1, 0)]))


def divmod_of(pair: tuple[int, int]) -> tuple[int, int]:
    return divmod(*pair)


@pytest.mark.parametrize(
    "wrong",
    ["nonsense", "tcp://host", "http://host:1", "tcp://host:0", "tcp://host:99999", "tcp://a b:8786", "tcp://:1"],
)
def test_what_is_no_address_is_a_mistake(stored, capfd, wrong):
    code, line = refused(capfd, "query", str(stored), "spans", "--dask-address", wrong)
    assert code == 2 and f"'{wrong}' is no address of a Dask scheduler like tcp://host:8786" in line


@pytest.mark.parametrize("listening", [False, True])
def test_where_nobody_answers_one_line_says_so(stored, capfd, monkeypatch, unused, listening):
    monkeypatch.setattr(cluster, "CONNECTING", 1.0)
    if listening:
        unused.listen()
    address = f"tcp://127.0.0.1:{unused.getsockname()[1]}"
    output = stored.parent / "nothing.csv"
    asked = ("query", str(stored), "spans", "--format", "csv", "--output", str(output))
    code, line = refused(capfd, *asked, "--dask-address", address)
    assert code == 3 and f"{address}: no Dask scheduler answers within 1 s" in line
    assert not output.exists()


@pytest.fixture
def unused() -> Iterator[socket.socket]:
    """A port that nobody listens at."""
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        yield taken


def test_workers_of_another_version_are_refused(many, address, capfd, monkeypatch):
    cluster._code.cache_clear()
    monkeypatch.setattr(cluster, "version", lambda package: "0.0")
    arguments = ("step", "collect", str(many / "many.yaml"), str(many / "results"), "--dask-address", address)
    code, line = refused(capfd, *arguments)
    cluster._code.cache_clear()
    assert code == 3 and "this Dask worker runs another version: cablesim 0.1.0 with code" in line
    assert not (many / "results" / "many.nc").exists()


def test_a_worker_that_joins_later_is_looked_at_too(address, monkeypatch):
    with connected(address):
        monkeypatch.setattr(cluster, "_code", lambda: "another")
        with pytest.raises(EnvironmentFault, match="this Dask worker runs another version: "):
            list(map_in_order(abs, [1]))


def test_a_dataset_that_workers_do_not_see_is_named(copy, address):
    files = chosen_paths(copy, "spans")
    with connected(address):
        answer = ask(open_scenes(copy, "spans"), Request(), files=files)
        files["spans"].unlink()
        with pytest.raises(EnvironmentFault, match=r"spans\.nc: cannot be read .*on the Dask worker tcp://"):
            answer.table()


def test_another_dataset_at_the_same_path_is_refused(copy, address, monkeypatch):
    files = chosen_paths(copy, "spans")
    monkeypatch.setattr("cablesim.database.pieces.recorded_digest", lambda path: "that of this file here")
    with connected(address), pytest.raises(EnvironmentFault, match=r"spans\.nc: another file is here \(on the Dask"):
        ask(open_scenes(copy, "spans"), Request(), files=files).table()


def test_shards_that_workers_do_not_see_are_named_and_nothing_is_written(many, address, capfd, monkeypatch):
    monkeypatch.setattr(gather.Shards, "path", lambda self, digest: Path("/elsewhere") / f"{digest}.nc")
    arguments = ("step", "collect", str(many / "many.yaml"), str(many / "results"), "--dask-address", address)
    code, line = refused(capfd, *arguments)
    assert code == 3 and "/elsewhere/" in line and "on the Dask worker tcp://" in line
    assert not list((many / "results").glob("*many.nc*"))


class ByHand:
    """A scheduler, and workers that nobody starts again, as a user starts them."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.scheduler = self._start("dask_scheduler", "--port", "0", "--no-dashboard", "--scheduler-file", "scheduler")
        self.workers: list[subprocess.Popen] = []

    @property
    def address(self) -> str:
        """Where the scheduler listens, as soon as it has written that to the end."""
        deadline, path = time.monotonic() + 60, self.folder / "scheduler"
        while time.monotonic() < deadline:
            with suppress(FileNotFoundError, json.JSONDecodeError):
                return json.loads(path.read_text())["address"]
            time.sleep(0.05)
        pytest.fail(f"no Dask scheduler in {path} after 60 s")

    def add_worker(self, *arguments: str) -> None:
        self.workers.append(self._start("dask_worker", self.address, "--no-nanny", "--no-dashboard", *arguments))

    def _start(self, program: str, *arguments: str) -> subprocess.Popen:
        command = [sys.executable, "-m", f"distributed.cli.{program}", *arguments, "--host", "127.0.0.1"]
        here = {**os.environ, "PYTHONPATH": str(PACKAGE.parent)}
        quiet = subprocess.DEVNULL
        return subprocess.Popen(command, cwd=self.folder, env=here, stdout=quiet, stderr=quiet)

    def stop(self) -> None:
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()


@pytest.fixture
def by_hand(tmp_path) -> Iterator[ByHand]:
    (tmp_path / "dask").mkdir()
    running = ByHand(tmp_path / "dask")
    yield running
    running.stop()


def test_a_cluster_without_workers_is_told(stored, by_hand, capfd, monkeypatch):
    monkeypatch.setattr(cluster, "WORKERLESS", 1.0)
    code, line = refused(capfd, "query", str(stored), "spans", "--dask-address", by_hand.address)
    assert code == 3 and f"{by_hand.address}: this Dask cluster has had no worker for 1 s" in line


def test_a_worker_without_the_package_is_told(stored, by_hand, capfd):
    (by_hand.folder / "without.py").write_text("import sys\nsys.modules['cablesim'] = None\n")
    by_hand.add_worker("--preload", "without.py")
    code, line = refused(capfd, "query", str(stored), "spans", "--dask-address", by_hand.address)
    assert code == 3 and "this Dask worker cannot run cablesim" in line


@pytest.mark.parametrize("dying", ["workers", "scheduler"])
def test_the_end_of_a_cluster_is_one_line_and_nothing_is_written(many, by_hand, capfd, monkeypatch, dying):
    def map_and_kill(function, items):
        for number, found in enumerate(map_in_order(function, items)):
            if number == 3:
                for process in by_hand.workers if dying == "workers" else [by_hand.scheduler]:
                    process.kill()
            yield found

    monkeypatch.setattr(cluster, "WORKERLESS", 2.0)
    monkeypatch.setattr(cluster, "CONNECTING", 5.0)
    monkeypatch.setattr(gather, "MOST_TOGETHER", 1)
    monkeypatch.setattr(gather, "map_in_order", map_and_kill)
    by_hand.add_worker()
    by_hand.add_worker()
    arguments = ("step", "collect", str(many / "many.yaml"), str(many / "results"), "--dask-address", by_hand.address)
    code, line = refused(capfd, *arguments)
    assert code == 3 and "Dask cluster" in line and by_hand.address in line
    assert not list((many / "results").glob("*many.nc*"))


def test_a_study_passes_the_address_on_to_its_steps(tmp_path, address):
    """The scheduler that is named must be asked: another address fails in the step that collects."""
    folder = make_project(tmp_path)
    replace(folder / "config" / "config.yaml", "[spans, limits]", "[spans]")
    command = [sys.executable, "-m", "cablesim", "study", "--dask-address"]
    failed = subprocess.run([*command, "nonsense"], cwd=folder, capture_output=True, text=True, check=False)
    assert failed.returncode == 2
    assert "'nonsense' is no address of a Dask scheduler" in failed.stderr.strip().splitlines()[-1]
    mended = subprocess.run([*command, address], cwd=folder, capture_output=True, text=True, check=False)
    assert mended.returncode == 1, mended.stderr
    assert (folder / "results" / "small" / "spans.nc").exists()
