"""What interactive pictures of lines share: places as columns, frames of equal scales, what the pointer is told."""

from collections.abc import Iterable, Mapping
from typing import Any

import altair as alt
import numpy as np
import xarray as xr

from cablesim.config.figure_file import Figure
from cablesim.report.page.columns import Columns, column

# Of what the pointer is on.
PLACE = [alt.Tooltip("series:N", title=" "), alt.Tooltip("x:Q", format=".4~g"), alt.Tooltip("y:Q", format=".4~g")]
SIDES = {"x": ("x", "x2"), "y": ("y", "y2")}


def titles(figure: Figure, sides: str) -> list[str]:
    """What stands at sides of a figure."""
    return [figure.label(side).plain for side in sides]


def factors(figure: Figure, sides: str) -> list[float]:
    """What values in SI are multiplied by to be shown."""
    return [figure.label(side).factor for side in sides]


def in_view(places: xr.DataArray, view: str, scaled: list[float]) -> np.ndarray:
    """Places along a line or a path as they are shown: of shape (2, node)."""
    along = next(dim for dim in places.dims if dim != "component")
    return places.sel(component=list(view)).transpose("component", along).values * np.array(scaled)[:, None]


def place_columns(places: np.ndarray, series: str, scenario: int) -> Columns:
    """Places of shape (2, node), in their order."""
    count = places.shape[1]
    return {
        "x": column(places[0]),
        "y": column(places[1]),
        "node": list(range(count)),
        "series": [series] * count,
        "scenario": [scenario] * count,
    }


def extent(found: Iterable[Mapping[str, list[Any]]]) -> list[np.ndarray]:
    """All numbers along x and along y."""
    known = list(found)
    return [
        np.array([value for one in known for key in keys for value in one.get(key, []) if value is not None])
        for keys in SIDES.values()
    ]


def framed(layers: list[Any], ranges: list[list[float]], titles: list[str]) -> Any:
    """Layers with the same two scales."""
    channels = {
        name: channel(f"{name}:Q", title=title, scale=alt.Scale(domain=given, nice=False, zero=False))
        for name, channel, title, given in zip("xy", (alt.X, alt.Y), titles, ranges, strict=True)
    }
    first, *others = layers
    return alt.layer(first.encode(**channels), *others)
