"""Ways to damage a file that is there."""

import os
import random
import shutil
from collections.abc import Callable
from pathlib import Path

import netCDF4

from cablesim.files import ledger

Way = Callable[[Path, random.Random, list[Path]], None]


def bit(path: Path, draw: random.Random, others: list[Path]) -> None:
    data = bytearray(path.read_bytes())
    data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)
    path.write_bytes(data)


def byte(path: Path, draw: random.Random, others: list[Path]) -> None:
    data = bytearray(path.read_bytes())
    data[draw.randrange(len(data))] ^= draw.randrange(1, 256)
    path.write_bytes(data)


def some_bytes(path: Path, draw: random.Random, others: list[Path]) -> None:
    for _ in range(draw.randrange(2, 50)):
        byte(path, draw, others)


def block(path: Path, draw: random.Random, others: list[Path]) -> None:
    """A sector that was never written, or written by another."""
    data = bytearray(path.read_bytes())
    at, length = draw.randrange(len(data)), draw.choice([8, 64, 512, 4096])
    data[at : at + length] = draw.choice([bytes(length), b"\xff" * length, draw.randbytes(length)])
    path.write_bytes(data)


def cut(path: Path, draw: random.Random, others: list[Path]) -> None:
    size = path.stat().st_size
    os.truncate(path, draw.choice([0, 1, draw.randrange(size), size - 1]))


def grown(path: Path, draw: random.Random, others: list[Path]) -> None:
    with path.open("ab") as file:
        file.write(draw.randbytes(draw.randrange(1, 5000)))


def text(path: Path, draw: random.Random, others: list[Path]) -> None:
    path.write_text("span,sag\n10,3\n")


def gone(path: Path, draw: random.Random, others: list[Path]) -> None:
    path.unlink()


def dangling(path: Path, draw: random.Random, others: list[Path]) -> None:
    path.unlink()
    path.symlink_to("nowhere")


def folder(path: Path, draw: random.Random, others: list[Path]) -> None:
    path.unlink()
    path.mkdir()


def unreadable(path: Path, draw: random.Random, others: list[Path]) -> None:
    """Without permission; whoever is root reads it all the same, so it is damaged as well."""
    if os.geteuid() == 0:
        byte(path, draw, others)
    path.chmod(0)


def others_bytes(path: Path, draw: random.Random, others: list[Path]) -> None:
    """Another's content under this name."""
    shutil.copy(draw.choice([other for other in others if other != path]), path)


def others_file(path: Path, draw: random.Random, others: list[Path]) -> None:
    """Another's content under this name, with its ledger."""
    other = draw.choice([other for other in others if other != path])
    shutil.copy(other, path)
    if ledger(other).exists():
        shutil.copy(ledger(other), ledger(path))


def swapped(path: Path, draw: random.Random, others: list[Path]) -> None:
    """Two that have changed places, with their ledgers or without."""
    other = draw.choice([other for other in others if other != path])
    pairs = [(path, other), (ledger(path), ledger(other))]
    for one, two in pairs[: draw.choice([1, 2])]:
        if one.is_file() and two.is_file():
            content = one.read_bytes()
            one.write_bytes(two.read_bytes())
            two.write_bytes(content)


def netcdf(path: Path, draw: random.Random, others: list[Path]) -> None:
    """A valid netCDF file that is none of ours."""
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("span", 3)
        file.createVariable("sag", "f8", ("span",))[:] = draw.random()


def without_ledger(path: Path, draw: random.Random, others: list[Path]) -> None:
    """Never finished, or copied without."""
    byte(path, draw, others)
    ledger(path).unlink(missing_ok=True)


# What a disk, a copy or a person does to a file.
WAYS: tuple[Way, ...] = (
    bit, byte, some_bytes, block, cut, grown, text, gone, dangling, folder, unreadable, others_bytes, others_file,
    netcdf, without_ledger,
)  # fmt: skip
# Those that change bytes of it.
BYTES: tuple[Way, ...] = (bit, byte, some_bytes, block, cut)
