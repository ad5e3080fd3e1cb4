"""What a folder of results holds, as one table: scenes, methods, parameters with their ranges, outputs, fates.

It is kept in one Parquet file. That is a copy of what the datasets say, taken scene by scene from those whose ledger
still has the digest that was copied from, and from the datasets for all others: it may be deleted at any time.
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from cablesim.database import CATALOGUE_FILE
from cablesim.database.collect import MEASURED_NAMES
from cablesim.database.reading import flag_words, of_scenarios, open_dataset, readable, scene_paths, with_components
from cablesim.files import check, enter_in_ledger, recorded_digest, written_whole
from cablesim.status import SENTENCES, Status

COLUMNS = ("scene", "kind", "name", "unit", "lowest", "highest", "number", "meaning", "digest")


def catalogue(results: Path) -> pd.DataFrame:
    """A row for each scene, and for each method, parameter, output, flag and fate of it.

    `kind` says which it is; `lowest` and `highest` are in the `unit`. `number` counts scenarios (of a scene, method,
    status or flag), different values (of an axis or a parameter) or values in a scenario (of an output).
    Raises InputError where there is no such folder.
    """
    paths = scene_paths(results)
    known = _stored(results / CATALOGUE_FILE)
    tables = []
    for scene, path in paths.items():
        digest = recorded_digest(path)
        if digest and (scene, digest) in known:
            tables.append(known[scene, digest])
        else:
            with readable(path), open_dataset(path, cache=False) as dataset:
                tables.append(describe(scene, dataset, digest))
    return pd.concat(tables, ignore_index=True) if tables else pd.DataFrame(columns=list(COLUMNS))


def write_catalogue(results: Path) -> None:
    """Write the catalogue of a folder, whole."""
    path = results / CATALOGUE_FILE
    with written_whole(path) as temporary:
        catalogue(results).to_parquet(temporary, index=False)
    enter_in_ledger(path)


def describe(scene: str, dataset: xr.Dataset, digest: str = "") -> pd.DataFrame:
    """The rows of one scene."""
    rows = [
        (scene, "scene", scene, "", np.nan, np.nan, dataset.status.size, dataset.attrs["title"]),
        *(_method(dataset, scene, method) for method in dataset.method.values.tolist()),
        *(_parameter(dataset, scene, values) for values in _parameters(dataset)),
        *(_output(dataset, scene, str(name)) for name in dataset.data_vars if not flag_words(dataset[name])),
        *(row for name in dataset.data_vars if flag_words(dataset[name]) for row in _flags(dataset, scene, str(name))),
    ]
    return pd.DataFrame([(*row, digest) for row in rows], columns=list(COLUMNS))


def _stored(path: Path) -> dict[Any, pd.DataFrame]:
    """The stored rows by scene and digest; none where the file is not what was written."""
    if not check(path).whole:
        return {}
    try:
        return dict(iter(pd.read_parquet(path, columns=list(COLUMNS)).groupby(["scene", "digest"])))
    except (OSError, ValueError, KeyError):
        return {}


def _method(dataset: xr.Dataset, scene: str, method: str) -> tuple[Any, ...]:
    about = json.loads(dataset.attrs["methods"])[method]
    options = ", ".join(f"{name}={value}" for name, value in about["options"].items())
    solved = int((dataset.status.sel({"method": method}) == 0).sum())
    return scene, "method", method, "", np.nan, np.nan, solved, f"{about['solver']}({options}), solved scenarios"


def _parameters(dataset: xr.Dataset) -> Iterator[xr.DataArray]:
    """Coordinates that tell scenarios apart, or are the same in all; parts of vectors and lists by themselves."""
    for name, values in with_components(dataset.drop_vars(dataset.data_vars)).coords.items():
        if of_scenarios(values, dataset) and name != "method":
            yield values


def _parameter(dataset: xr.Dataset, scene: str, values: xr.DataArray) -> tuple[Any, ...]:
    name = str(values.name)
    kind = "fixed" if values.ndim == 0 else "axis" if name in dataset.dims else "parameter"
    meaning = values.attrs.get("long_name", "")
    known = np.unique(values.values[~pd.isna(values.values)])
    if values.dtype.kind in "fi":
        ends = (float(known[0]), float(known[-1])) if known.size else (np.nan, np.nan)
        return scene, kind, name, values.attrs.get("units", ""), *ends, known.size, meaning
    return scene, kind, name, "", np.nan, np.nan, known.size, f"{meaning}: {', '.join(map(str, known))}"


def _output(dataset: xr.Dataset, scene: str, name: str) -> tuple[Any, ...]:
    values = dataset[name]
    own = [dim for dim in values.dims if dim not in dataset.status.dims]
    lowest, highest = values.attrs.get("actual_range", (np.nan, np.nan))
    kind = "measured" if name in MEASURED_NAMES else "output"
    number = int(np.prod([values.sizes[dim] for dim in own]))
    meaning = values.attrs.get("long_name", "") + (f" (over {', '.join(map(str, own))})" if own else "")
    return scene, kind, name, values.attrs.get("units", ""), float(lowest), float(highest), number, meaning


def _flags(dataset: xr.Dataset, scene: str, name: str) -> Iterator[tuple[Any, ...]]:
    """A row for each word of a flag that any scenario has."""
    words = flag_words(dataset[name])
    counts = np.bincount(dataset[name].values.ravel(), minlength=len(words))
    for word, count in zip(words, counts.tolist(), strict=True):
        if count:
            known = name == "status" and word in Status.__members__
            meaning = SENTENCES[Status[word]] if known else dataset[name].attrs.get("long_name", "")
            yield scene, name, word, "", np.nan, np.nan, count, meaning
