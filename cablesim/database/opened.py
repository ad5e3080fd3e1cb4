"""A folder of results in a notebook: its catalogue, its scenes as lazy datasets, and queries.

>>> from cablesim import open_study
>>> study = open_study("results/default")
>>> study["formula_error"].sag.sel({"method": "exact"}).plot()  # doctest: +SKIP
"""

import html
import warnings
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd
import xarray as xr

from cablesim.database.catalogue import catalogue
from cablesim.database.query import Answer, Order, Request, ask
from cablesim.database.reading import chosen_paths, is_pattern, open_dataset, open_scenes, scene_path, scene_paths


class OpenedStudy(Mapping[str, xr.Dataset]):
    """The scenes of a results folder by name; nothing of them is read before it is asked for, and nothing written."""

    def __init__(self, results: Path):
        self.results = results
        self._paths = scene_paths(results)

    def __getitem__(self, scene: str) -> xr.Dataset:
        """The dataset of a scene, lazy (Dask), the measured run times beside the rest.

        Raises InputError, with the nearest names, for an unknown scene; EnvironmentFault for an unreadable file.
        """
        return open_dataset(scene_path(self.results, scene), chunks={})

    def __iter__(self) -> Iterator[str]:
        return iter(self._paths)

    def __len__(self) -> int:
        return len(self._paths)

    @cached_property
    def catalogue(self) -> pd.DataFrame:
        """All scenes, their methods, parameters with ranges and units, outputs, and counts by status."""
        return catalogue(self.results).drop(columns="digest")

    def query(
        self,
        scene: str,
        condition: str | None = None,
        columns: tuple[str, ...] | list[str] = (),
        nearest: Mapping[str, Any] | None = None,
        order_by: str | tuple[str, ...] | list[str] = (),
        limit: int | None = None,
    ) -> pd.DataFrame:
        """Scenarios of a scene, of several ("one,other") or of all that know the names ("precision_*"): a row for each.

        `nearest` maps parameters to values, numbers in SI or text with a unit; `order_by` holds formulas, perhaps with
        " desc" behind them. The units of the columns are in `.attrs["units"]`. Raises InputError for unknown names,
        wrong units, and an answer that does not fit into memory; warns, with the neighbours, of values nobody has.
        """
        orders = (order_by,) if isinstance(order_by, str) else tuple(order_by)
        near = tuple((name, str(value)) for name, value in (nearest or {}).items())
        request = Request(condition, tuple(columns), near, tuple(Order.read(text) for text in orders), limit)
        files = chosen_paths(self.results, scene)
        answer: Answer = ask(open_scenes(self.results, scene), request, is_pattern(scene), files)
        for note in answer.notes:
            warnings.warn(note, stacklevel=2)
        table = answer.table()
        table.attrs["units"] = answer.units
        return table

    @property
    def _overview(self) -> pd.DataFrame:
        rows = self.catalogue
        return rows[rows["kind"] == "scene"][["scene", "number", "meaning"]].rename(
            columns={"number": "scenarios", "meaning": "title"}
        )

    def __repr__(self) -> str:
        return f"{self.results}: {len(self)} scenes\n{self._overview.to_string(index=False, justify='left')}"

    def _repr_html_(self) -> str:
        return f"<p>{html.escape(str(self.results))}</p>{self._overview.to_html(index=False)}"


def open_study(results: Path | str) -> OpenedStudy:
    """Open a folder of results. Raises InputError where there is none."""
    return OpenedStudy(Path(results))
