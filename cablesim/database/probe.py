"""Look into a netCDF file that nobody vouches for, in a process of its own: `python -m cablesim.database.probe FILE`.

On a damaged file HDF5 may run in a circle or crash, and takes its process with it.
"""

import math
import subprocess
import sys
from pathlib import Path

from cablesim.errors import EnvironmentFault

SECONDS = 20.0
# No file is compressed by more than that.
MOST_COMPRESSED = 10_000


def probe(path: Path) -> None:
    """Raise EnvironmentFault for a file whose heads cannot be read in time, or that says it holds more than it can."""
    command = [sys.executable, "-m", "cablesim.database.probe", str(path)]
    try:
        found = subprocess.run(command, capture_output=True, text=True, timeout=SECONDS, check=False)
    except subprocess.TimeoutExpired:
        raise EnvironmentFault(f"{path}: cannot be read (no answer within {SECONDS:.0f} s)") from None
    if found.returncode or not found.stdout.strip().isdigit():
        told = found.stderr.strip().splitlines()[-1:] or [f"the reader crashed, {found.returncode}"]
        raise EnvironmentFault(f"{path}: cannot be read ({told[0]})")
    if int(found.stdout) > MOST_COMPRESSED * path.stat().st_size:
        raise EnvironmentFault(f"{path}: cannot be read (it says it holds {int(found.stdout)} bytes: not possible)")


def declared_bytes(path: Path) -> int:
    """The size of all variables as the file tells it, after everything but values was read."""
    import netCDF4

    with netCDF4.Dataset(path) as file:
        groups = (file, *file.groups.values())
        for holder in (*groups, *(variable for group in groups for variable in group.variables.values())):
            holder.__dict__  # noqa: B018
        variables = [variable for group in groups for variable in group.variables.values()]
        return sum(math.prod(one.shape) * getattr(one.dtype, "itemsize", 1) for one in variables)


if __name__ == "__main__":
    print(declared_bytes(Path(sys.argv[1])))
