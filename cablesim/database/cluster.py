"""Work on the workers of a Dask cluster, where this process is connected to one, and here where it is not.

Workers read files and evaluate blocks, nothing more: what is written is written by one process, so that its bytes are
the same with a cluster and without.
"""

import asyncio
import concurrent.futures
import pickle
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError, wait
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from functools import cache
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, TypeVar

from cablesim.errors import CablesimError, EnvironmentFault, InputError
from cablesim.sources import code_digest

if TYPE_CHECKING:
    from distributed import Client, Future

# Seconds to wait for a scheduler, for a worker where there is none (it may be starting), and between looks.
CONNECTING, WORKERLESS, LOOK = 10.0, 30.0, 1.0
# Pieces of work for each worker, one at work and one waiting; more would only fill its memory.
IN_FLIGHT = 2
# What decides an answer: this code, and what computes for it.
MODULES = ("database/gather", "database/query")
PARTS = ("config", "database", "design", "expressions", "files", "plan", "quantities", "shards", "status", "units")
PACKAGES = ("numpy", "pandas", "xarray")

T = TypeVar("T")
R = TypeVar("R")

_client: ContextVar["Client | None"] = ContextVar("client", default=None)
# A worker may have several threads; neither netCDF nor Python's reading of its own code is made for that.
_working, _reading_code = threading.Lock(), threading.Lock()


def is_connected() -> bool:
    """Whether there are workers to work for this process."""
    return _client.get() is not None


def map_in_order(function: Callable[[T], R], items: Iterable[T]) -> Iterator[R]:
    """The function of each item, in their order: on the workers if this process is connected to some, here if not.

    Both must be picklable. No more is under way than a small multiple of the workers. Raises EnvironmentFault where the
    cluster fails; a worker that dies is replaced by the others.
    """
    client = _client.get()
    return map(function, items) if client is None else _on_workers(client, function, items)


@contextmanager
def connected(address: str | None) -> Iterator[None]:
    """Inside the block, the workers of the scheduler at an address do the work; without an address nothing changes.

    Raises InputError for what is no address, EnvironmentFault where nobody answers, where there is no worker, or where
    one runs other code than this process.
    """
    if address is None:
        yield
        return
    import dask
    from distributed.utils import silence_logging_cmgr

    _check_address(address)
    limits = {"distributed.comm.timeouts.connect": CONNECTING}
    with silence_logging_cmgr("CRITICAL"), dask.config.set(limits):
        client = _connect(address)
        token = _client.set(client)
        try:
            _check_workers(client)
            yield
        finally:
            _client.reset(token)
            # Where the scheduler is gone, there is nobody to take leave of.
            with suppress(OSError):
                client.close(timeout=LOOK)


def _check_address(address: str) -> None:
    from distributed.comm.addressing import get_address_host_port

    try:
        host, port = get_address_host_port(address, strict=True)
    except ValueError as problem:
        raise InputError(
            f"'{address[:100]}' is no address of a Dask scheduler like tcp://host:8786 ({problem})"
        ) from None
    if not host or not 0 < port < 2**16 or any(letter.isspace() for letter in host):
        raise InputError(f"'{address[:100]}' is no address of a Dask scheduler like tcp://host:8786")


def _connect(address: str) -> "Client":
    from distributed import Client
    from distributed.utils import LoopRunner

    try:
        LoopRunner(asynchronous=False).run_sync(_meet, address)
        return Client(address, timeout=CONNECTING, name="cablesim")
    except Exception as problem:  # Whatever another kind of server may answer.
        told = " ".join(str(problem).split()) or "it is silent"
        raise EnvironmentFault(f"{address}: no Dask scheduler answers within {CONNECTING:.0f} s ({told})") from None


async def _meet(address: str) -> None:
    """Connect once for trial: a client has no time limit for a server that takes its call and does not answer."""
    from distributed import Client

    client = Client(address, timeout=CONNECTING, asynchronous=True, set_as_default=False)
    try:
        await asyncio.wait_for(client, CONNECTING + LOOK)
    finally:
        await asyncio.wait_for(client.close(), LOOK)


def _check_workers(client: "Client") -> None:
    """Wait for the first worker, and see that all are of this code. Raises EnvironmentFault if not."""
    try:
        client.wait_for_workers(1, timeout=WORKERLESS)
        codes = client.run(_code, on_error="return")
    except TimeoutError:
        raise _no_worker(client) from None
    except OSError as problem:
        raise _lost(client, problem) from None
    for worker, theirs in codes.items():
        _check_code(worker, theirs, _code())


def _check_code(worker: str, theirs: Any, ours: str) -> None:
    if isinstance(theirs, Exception):
        raise EnvironmentFault(f"{worker}: this Dask worker cannot run cablesim ({theirs})")
    if theirs != ours:
        raise EnvironmentFault(f"{worker}: this Dask worker runs another version: {theirs} there, {ours} here")


@cache
def _code() -> str:
    """What answers depend on beside files: the code that makes them, and the packages that compute."""
    packages = ", ".join(f"{package} {version(package)}" for package in PACKAGES)
    with _reading_code:
        return f"cablesim {version('cablesim')} with code {code_digest(MODULES, PARTS)}, {packages}"


def _on_workers(client: "Client", function: Callable[[T], R], items: Iterable[T]) -> Iterator[R]:
    waiting: deque[Future] = deque()
    for item in items:
        # Pickled here, so that a worker looks first whether it is of the same code.
        waiting.append(client.submit(_work, _code(), pickle.dumps((function, item)), pure=False))
        while len(waiting) >= IN_FLIGHT * max(1, _workers(client)):
            yield _result(client, waiting.popleft())
    while waiting:
        yield _result(client, waiting.popleft())


def _work(ours: str, pickled: bytes) -> Any:
    """On a worker: the function of an item."""
    from distributed import get_worker

    worker = get_worker().address
    _check_code(worker, _code(), ours)
    with _working:
        function, item = pickle.loads(pickled)
        try:
            return function(item)
        except EnvironmentFault as problem:
            raise EnvironmentFault(f"{problem} (on the Dask worker {worker})") from None


def _workers(client: "Client") -> int:
    """How many workers there are now."""
    try:
        return int(client.scheduler_info(n_workers=0)["n_workers"])
    except Exception as problem:  # However a connection may break.
        raise _lost(client, problem) from None


def _result(client: "Client", future: "Future") -> Any:
    """What a worker has found; waits as long as there is any."""
    # Not waited for with a time limit of Dask's own: that would stop a long transfer, and start it again.
    loop: Any = client.loop
    fetched = asyncio.run_coroutine_threadsafe(client.gather(future, asynchronous=True), loop.asyncio_loop)
    seen = time.monotonic()
    while not wait([fetched], timeout=LOOK).done:
        if _workers(client):
            seen = time.monotonic()
        elif time.monotonic() - seen > WORKERLESS:
            fetched.cancel()
            raise _no_worker(client)
    return _found(client, fetched)


def _found(client: "Client", fetched: concurrent.futures.Future) -> Any:
    from distributed import KilledWorker

    try:
        return fetched.result()
    except CablesimError:
        raise
    except ImportError as problem:
        raise EnvironmentFault(f"{_address(client)}: a Dask worker cannot run cablesim ({problem})") from None
    except (KilledWorker, CancelledError, OSError) as problem:
        raise _lost(client, problem) from None


def _address(client: "Client") -> str:
    return client.scheduler.address if client.scheduler else "the Dask cluster"


def _no_worker(client: "Client") -> EnvironmentFault:
    return EnvironmentFault(f"{_address(client)}: this Dask cluster has had no worker for {WORKERLESS:.0f} s")


def _lost(client: "Client", problem: Exception) -> EnvironmentFault:
    return EnvironmentFault(f"{_address(client)}: the Dask cluster is lost ({problem})")
