"""The files keep to the CF conventions, and programs that know nothing of us can read them."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr
from compliance_checker.runner import CheckSuite

from cablesim.database.shard_file import STORAGE
from cablesim.database.timing import MEASURED
from tests.database.conftest import run

IN_A_STREAM = """fixed:
  line_length: 50 m
  weight_per_length: 2 N/m
  diameter: 10 mm
  normal_drag_coefficient: 1.2
  tangential_drag_coefficient: 0.02
  fluid_density: 1025
  stream_speed: 1 m/s
"""
SCENES = {
    "words": """
title: Words, angles and flags
question: Does the friction law matter?
design: {grid: {angle: [30 deg, 45 deg, 90 deg], friction_law: [constant, zero]}}
fixed: {critical_angle: 20 deg, friction_ratio: 0.02}
methods: {pode: {solver: pode_functions}}
outputs: [tau, sigma]
checks: {tense: tau > 1}
""",
    "profiles": """
title: Profiles, a length that is too short, and errors
design: {grid: {span: [10, 20], length_ratio: [0.9, 1.1, 1.2]}}
fixed: {weight_per_length: 5 N/m}
methods: {exact: {solver: catenary_exact}, parabolic: {solver: catenary_parabolic}}
reference: exact
outputs: [sag, max_tension, profile]
""",
    "vectors": """
title: Vectors, given and answered
design: {cases: [{force_A: [0, 0, 100]}, {force_A: [5, 1, 80]}]}
"""
    + IN_A_STREAM
    + """methods: {stepped: {solver: stream_line}}
outputs: [position_B, tension_B, steps]
""",
    "lists": """
title: Lists of one and of two sections
design: {cases: [{section_length: [400], section_weight: [80]}, {section_length: [400, 50], section_weight: [80, 600]}]}
fixed: {horizontal_tension: 50 kN}
methods: {exact: {solver: composite_line}}
outputs: [tension_B, joint_tension, joint_position]
""",
    "laws": """
title: Words in no order along an axis, and vectors along another
design:
  grid:
    friction_law: [cosine_squared, zero, constant]
    force_A: [[0, 0, 100], [5, 0, 80]]
"""
    + IN_A_STREAM
    + """methods: {pode: {solver: pode_line, options: {nodes: 5}}}
outputs: [position_B, tension_B, profile_tension]
""",
    "sample": """
title: A sample of scenarios
design: {sample: {method: sobol, num: 8, seed: 3, ranges: {span: {start: 10 m, stop: 20 m}}}}
fixed: {length_ratio: 1.1, weight_per_length: 5 N/m}
methods: {exact: {solver: catenary_exact}}
outputs: [sag]
""",
    "printed": """
title: A printed table, read in several ways
design:
  cases:
    table: printed.csv
    keys:
      span: {span: span, length_ratio: ratio}
      ratio: {span: span, length_ratio: ratio}
fixed: {weight_per_length: 5 N/m}
methods: {exact: {solver: catenary_exact}}
outputs: [sag]
published: {table: printed.csv, columns: {sag: sag}}
""",
    "histories": """
title: Histories of a moored line
design: {grid: {top_amplitude: [0.5 m, 1 m], depth: [80 m, 100 m]}}
fixed:
  chord_angle: 45 deg
  length_ratio: 1.001
  linear_stiffness: 1 MN
  mass_per_length: 3
  area: 3 cm^2
  normal_drag: 15
  tangential_drag: 0.8
  added_mass_per_length: 0.4
  wave_period: 6 s
methods: {moored: {solver: wave_line, options: {segments: 5, rtol: 1e-2}}}
outputs: [max_top_tension, history, history_time, orbit]
""",
}
TABLE = "# source: made up\nspan,ratio,sag\n10.0,1.10,2.0\n20.0,1.20,5.8\n"
# Each scenario has times of its own, `history_time`, so that the dimension has no coordinate. CF allows that; the
# checker goes by the name of the dimension.
NO_TIME_FOR_ALL = re.compile(r"Dimension 'time' in variable 'history(_time)?' is expected to be a coordinate axis .*")
# Weight of an error; less are recommendations, such as the order of a dimension called depth among others.
ERROR = 3


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """A dataset of each scene, and their shards."""
    folder = tmp_path_factory.mktemp("standards")
    (folder / "printed.csv").write_text(TABLE)
    for name, text in SCENES.items():
        (folder / f"{name}.yaml").write_text(text)
        run(folder / f"{name}.yaml", folder / "results")
    found = sorted((folder / "results").rglob("*.nc"))
    assert len(found) > 2 * len(SCENES)
    return found


def datasets(files: list[Path]) -> list[Path]:
    """Those that are no shards."""
    return [path for path in files if path.stem in SCENES]


def errors_in(path: Path) -> list[str]:
    """What the CF checker says of a file."""
    CheckSuite.load_all_available_checkers()
    suite = CheckSuite()
    with suite.load_dataset(str(path)) as dataset:
        results, crashes = suite.run_all(dataset, ["cf:1.11"], None)["cf:1.11"]
    assert not crashes
    flawed = [one for one in results if one.weight >= ERROR and one.msgs and not _kept(one.value)]
    return [message for one in flawed for message in one.msgs]


def _kept(value: object) -> bool:
    return value[0] >= value[1] if isinstance(value, tuple) else bool(value)


@pytest.mark.filterwarnings("ignore")
def test_the_cf_checker_finds_nothing(files):
    found = {path.name: [one for one in errors_in(path) if not NO_TIME_FOR_ALL.fullmatch(one)] for path in files}
    assert {name: messages for name, messages in found.items() if messages} == {}


@pytest.mark.filterwarnings("ignore")
def test_the_cf_checker_finds_what_is_wrong(files, tmp_path):
    broken = tmp_path / "broken.nc"
    shutil.copy(next(path for path in files if path.stem == "profiles"), broken)
    with netCDF4.Dataset(broken, "a") as file:
        file["sag"].units = "furlongs per blink"
        file["status"].flag_meanings = "ok bad"
    found = errors_in(broken)
    assert any("furlongs" in message for message in found)
    assert any("flag_meanings" in message for message in found)


def test_every_array_is_compressed_and_has_a_checksum(files):
    for path in files:
        with netCDF4.Dataset(path) as file:
            groups = [file, *file.groups.values()]
            arrays = [array for group in groups for array in group.variables.values() if array.dimensions]
            assert arrays
            for array in arrays:
                assert array.filters() | STORAGE == array.filters(), (path.name, array.name)


def test_every_numeric_axis_has_a_unit_a_meaning_and_values_that_a_reader_can_draw_along(files):
    for path in datasets(files):
        with netCDF4.Dataset(path) as file:
            assert file.title and file.Conventions == "CF-1.11"
            for name in file.variables.keys() & {*file.dimensions, "row"}:
                assert file[name].long_name
                if file[name].dtype.kind in "if":
                    assert file[name].units
                if file[name].dtype.kind in "if" and name in file.dimensions:
                    change = np.diff(file[name][:])
                    assert (change > 0).all() or (change < 0).all()


def test_every_variable_names_the_coordinates_that_cf_does_not_know_by_their_name(files):
    for path in datasets(files):
        with netCDF4.Dataset(path) as file, xr.open_dataset(path) as plain:
            for name, variable in plain.data_vars.items():
                along = {str(own) for own, values in plain.coords.items() if set(values.dims) <= set(variable.dims)}
                numbers = {dim for dim in variable.dims if dim in file.variables and file[dim].dtype.kind in "if"}
                assert set(file[name].coordinates.split()) == along - numbers, (path.name, name)
            assert "coordinates" not in file.ncattrs()


def test_every_answer_in_a_shard_names_what_it_was_asked(files):
    for path in (path for path in files if path not in datasets(files)):
        with netCDF4.Dataset(path) as file:
            named = getattr(file["status"], "coordinates", "").split()
            axes = [name for name in file["status"].dimensions if name in file.variables]
            assert set(file.variables) - {*named, *axes} >= {"status", "iterations"}
            assert all(file[name].dimensions[0] in file["status"].dimensions for name in (*named, *axes))
            assert len(file["status"].dimensions) <= len(axes) + len(named)


@pytest.mark.filterwarnings("ignore")
def test_what_is_measured_is_along_the_dimensions_of_the_file_and_keeps_to_cf(files, tmp_path):
    for path in datasets(files):
        with netCDF4.Dataset(path) as file:
            assert not file[MEASURED].dimensions
            assert file[MEASURED]["run_time"].dimensions == file["status"].dimensions
        # The checker reads no variables of groups.
        alone = tmp_path / path.name
        with xr.open_dataset(path) as plain, xr.open_dataset(path, group=MEASURED) as measured:
            numbers = [dim for dim in measured.dims if plain[dim].dtype.kind in "if"]
            copied = measured.assign_coords({dim: plain[dim] for dim in numbers})
            copied = copied.assign_attrs(Conventions="CF-1.11", title="Times", history="copied")
            copied.to_netcdf(alone, encoding={dim: {"_FillValue": None} for dim in numbers})
        assert errors_in(alone) == []


READERS = {
    "xarray": "import xarray as xr; print(xr.open_dataset(path).status.dims)",
    "xarray with Dask": "import xarray as xr; print(xr.open_dataset(path, chunks={}).status.compute().dims)",
    "netCDF4": "import netCDF4; print(netCDF4.Dataset(path)['status'].dimensions)",
}


@pytest.mark.parametrize("reader", READERS)
def test_readers_that_do_not_know_us_open_the_datasets(reader, files):
    path = next(path for path in files if path.stem == "profiles")
    script = f"path = {str(path)!r}; {READERS[reader]}; import sys; assert 'cablesim' not in sys.modules"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "('method', 'span', 'length_ratio')"


@pytest.mark.skipif(shutil.which("ncdump") is None, reason="ncdump is not installed (Debian: netcdf-bin)")
def test_ncdump_prints_the_files(files):
    for path in files:
        done = subprocess.run(["ncdump", str(path)], capture_output=True, text=True, check=True)
        assert "status" in done.stdout and not done.stderr
