"""Datasets that HDF5 cannot read, or should not: asked for in processes of their own, with limits."""

import random
import shutil
import zlib
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import netCDF4
import numpy as np

from cablesim.files import ledger
from tests.database.conftest import SCENES, run
from tests.faults import ways
from tests.faults.asking import Asked, Told, asking
from tests.faults.fault import Fault, Outcome

COMMANDS = (
    ["query", "results", "spans", "--format", "csv"],
    ["query", "results", "spans", "sag > 1 m", "--order-by", "sag desc", "--limit", "3"],
    ["query", "results", "spans", "--format", "netcdf", "--output", "answer.nc"],
    ["scenes", "results"],
    ["scenes", "results", "spans"],
    ["compare", "results", "other"],
    ["opened", "results"],
)
HEAD = 4096


def head(path: Path, draw: random.Random, others: list[Path]) -> None:
    """Change bits where HDF5 keeps what is where."""
    data = bytearray(path.read_bytes())
    for _ in range(draw.randrange(1, 8)):
        data[draw.randrange(min(HEAD, len(data)))] ^= 1 << draw.randrange(8)
    path.write_bytes(data)


def lengths(path: Path, draw: random.Random, others: list[Path]) -> None:
    """Huge numbers where eight bytes may be a size or an address."""
    data = bytearray(path.read_bytes())
    for _ in range(draw.randrange(1, 4)):
        at = draw.randrange(0, len(data) - 8, 8)
        data[at : at + 8] = draw.choice([2**31, 2**40, 2**62, 2**64 - 1, len(data)]).to_bytes(8, "little")
    path.write_bytes(data)


def vast(path: Path, draw: random.Random, others: list[Path]) -> None:
    """A file of some kilobytes that says it has a million million scenarios, or lines of as many nodes."""
    dim = draw.choice(["span", "node"])
    with netCDF4.Dataset(path) as old, netCDF4.Dataset(path.with_suffix(".part"), "w") as new:
        old.set_auto_chartostring(False)
        _copy_dims(old, new, {dim: draw.choice([10**9, 10**12, 2**40])})
        for name, variable in old.variables.items():
            _copy_variable(new, name, variable, None if dim in variable.dimensions else variable[...])
        group = new.createGroup("measured")
        variable = old["measured"]["run_time"]
        _copy_variable(group, "run_time", variable, None if dim in variable.dimensions else variable[...])
        new.setncatts(old.__dict__)
    path.with_suffix(".part").replace(path)


def inflating(path: Path, draw: random.Random, others: list[Path]) -> None:
    """A chunk whose compressed bytes become gigabytes."""
    content = draw.randbytes(2**22)
    with netCDF4.Dataset(path, "a") as file:
        file.createDimension("much", 2**22)
        settings = {"zlib": True, "complevel": 1, "shuffle": False, "chunksizes": (2**22,)}
        file.createVariable("depth", "i1", ("much",), fill_value=False, **settings)[:] = np.frombuffer(content, "i1")
    data = bytearray(path.read_bytes())
    at = _stream(data, content)
    bomb = zlib.compress(bytes(2**31 + 2**30), 9)
    data[at : at + len(bomb)] = bomb
    path.write_bytes(data)


WAYS: tuple[ways.Way, ...] = (*ways.BYTES, ways.grown, ways.text, ways.netcdf, head, lengths)
RARE: tuple[ways.Way, ...] = (vast, inflating)


def _stream(data: bytearray, content: bytes) -> int:
    """Where the compressed bytes of a content begin."""
    at = -1
    while (at := data.find(b"\x78", at + 1)) >= 0:
        try:
            if zlib.decompressobj().decompress(data[at:], 64) == content[:64]:
                return at
        except zlib.error:
            pass
    raise ValueError("no such stream")


def _copy_dims(old: netCDF4.Dataset, new: netCDF4.Dataset, others: dict[str, int]) -> None:
    for name, dim in old.dimensions.items():
        new.createDimension(name, others.get(name, dim.size))


def _copy_variable(new: netCDF4.Dataset, name: str, variable: netCDF4.Variable, values: np.ndarray | None) -> None:
    chunks = [min(size, 4) for size in variable.shape]
    settings = {"zlib": True, "chunksizes": chunks} if variable.dimensions else {}
    made = new.createVariable(name, variable.dtype, variable.dimensions, fill_value=False, **settings)
    if values is not None:
        made[...] = values
    made.setncatts({key: value for key, value in variable.__dict__.items() if key != "_FillValue"})


def judged(told: Told, good: Told, path: Path) -> str:
    """What is wrong with an answer: it must be that of the whole dataset, or a refusal that names the file."""
    if told.wrong:
        return told.wrong
    if told.code == 3:
        return "" if path.name in told.err else f"the file is not named: {told.err[-300:]}"
    if told.code == good.code and told.out == good.out:
        return ""
    return f"another answer: {told.code} {told.out[-300:]} {told.err[-300:]}"


def stored(folder: Path) -> tuple[Path, Path]:
    """A folder with results and a copy of them; the dataset that is to be damaged."""
    for name in ("spans", "inclined"):
        (folder / f"{name}.yaml").write_text(SCENES[name])
        run(folder / f"{name}.yaml", folder / "results")
    shutil.copytree(folder / "results", folder / "other")
    return folder, folder / "results" / "spans.nc"


def damaged(with_ledger: bool) -> Callable[[Path, int, int], Outcome]:
    """Damage a dataset that has a ledger, or none, and ask for what is in it."""

    def inject(folder: Path, times: int, seed: int) -> Outcome:
        draw, failures, kinds, slowest = random.Random(seed), [], Counter[str](), 0.0
        here, path = stored(folder)
        content = path.read_bytes()
        # Without a ledger, another scene's dataset may have got this name on purpose.
        usual = (*WAYS, ways.others_bytes) if with_ledger else WAYS
        others = [here / "results" / "inclined.nc"]
        ask = asking()
        good = [expected(ask, command, here) for command in COMMANDS]
        if not with_ledger:
            ledger(path).unlink()
        for number in range(times):
            path.write_bytes(content)
            way = RARE[number // 25 % 2] if number % 25 == 0 else draw.choice(usual)
            way(path, draw, others)
            which = number % len(COMMANDS)
            told = ask(COMMANDS[which], here)
            problem = judged(told, good[which], path)
            kinds["refused" if told.code == 3 else "answered"] += 1
            slowest = max(slowest, told.seconds)
            failures += [f"{number}, {way.__name__}, {' '.join(COMMANDS[which])}: {problem}"] if problem else []
        figures = f"{kinds['refused']} refused, {kinds['answered']} answered rightly, the slowest in {slowest:.1f} s"
        return Outcome(times, tuple(failures), None, figures)

    return inject


def expected(ask: Asked, command: list[str], here: Path) -> Told:
    """The answer of a whole study."""
    told = ask(command, here)
    if told.wrong or told.code > 1:
        raise RuntimeError(f"{command}: {told}")
    return told


UNREADABLE: tuple[Fault, ...] = (
    Fault("a dataset that cannot be read, with its ledger", "refused", damaged(True), 10, 200),
    Fault("a dataset that cannot be read, without a ledger", "refused", damaged(False), 10, 600),
)
