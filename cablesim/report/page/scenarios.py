"""The scenarios of a scene as the page holds them: what was given, what came out, the command that solves one again.

Parameters have all their digits, because commands are made of them. Lines and histories are whole numbers from 0 to
`STEPS` between their own lowest and highest value: finer than a screen shows.
"""

import shlex
from typing import Any

import numpy as np
import xarray as xr

from cablesim import units
from cablesim.config.method import Method
from cablesim.config.scene import Scene
from cablesim.database.reading import flag_words, status_words, with_components
from cablesim.design import Axis
from cablesim.numerics import Array
from cablesim.parameters import ParameterSpec
from cablesim.quantities import COMPONENTS, PLACES, QUANTITIES, component_names, quantity
from cablesim.report.page.columns import OUTPUT_DIGITS, column, exact
from cablesim.report.tables import EFFORTS
from cablesim.status import SENTENCES, Status

# Of a scene whose outputs are in the page, and of lines or histories in it: numbers in all.
MOST_NUMBERS = 40_000
MOST_CURVE_NUMBERS = 60_000
# Without its design in the page, a scene has no commands.
MOST_POINTS = 20_000
STEPS = 4000
MOST_NODES = 33
# At the end of a history: two periods of most methods.
LAST_SAMPLES = 160


def scenario_data(scene: Scene, dataset: xr.Dataset) -> dict[str, Any]:
    """Everything the page needs to show one scenario, as far as there is room for it; `left_out` says what is not."""
    if sum(axis.size for axis in scene.design.axes) > MOST_POINTS:
        return {"left_out": [f"{scene.size} scenarios are too many for this page"]}
    found: dict[str, Any] = {
        "axes": [_axis(scene, axis) for axis in scene.design.axes],
        "fixed": {name: _shown(scene.parameters[name], np.array([value]))[0] for name, value in scene.fixed.items()},
        "units": {name: _unit(name) for name in [*scene.fixed, *sorted(scene.design.parameters)]},
        "methods": [_method(scene, method) for method in scene.methods],
        "outputs": [],
        "left_out": [],
    }
    whole = with_components(dataset)
    numbers = [str(name) for name in whole.data_vars if _is_number(whole[name], dataset)]
    if dataset.status.size * len(numbers) > MOST_NUMBERS:
        found["left_out"].append(f"outputs of {dataset.status.size} scenarios are too many for this page")
        return found
    found["fates"] = {
        "words": [word.replace("_", " ") for word in status_words(dataset)],
        "sentences": [SENTENCES[Status[word]] for word in status_words(dataset)],
        "values": _by_method(dataset.status, column),
    }
    found["outputs"] = [_output(name, whole[name]) for name in numbers]
    return {**found, **_curves(dataset, found["left_out"])}


def _is_number(values: xr.DataArray, dataset: xr.Dataset) -> bool:
    return values.dims == dataset.status.dims and not (flag_words(values) and values.name == "status")


def _output(name: str, values: xr.DataArray) -> dict[str, Any]:
    words = flag_words(values)
    about = {"name": name, "unit": _unit(name), "meaning": values.attrs.get("long_name", "")}
    if words:
        return {**about, "words": list(words), "values": _by_method(values, column)}
    # A method that does not count its work says so by -1.
    counted = values.where(values >= 0) if name in EFFORTS else values
    return {**about, "values": _by_method(counted, lambda part: column(part, OUTPUT_DIGITS))}


def _unit(name: str) -> str:
    """The unit as it is shown; none for a plain number or a check of the scene's own."""
    return units.shown(quantity(name).unit) if name in QUANTITIES else ""


def _by_method(values: xr.DataArray, write: Any) -> list[Any]:
    """A list for each method: its values by scenario."""
    return [write(part) for part in values.transpose("method", ...).values]


def _axis(scene: Scene, axis: Axis) -> dict[str, Any]:
    columns = {name: _shown(scene.parameters[name], values) for name, values in axis.columns.items()}
    return {"name": axis.name, "size": axis.size, "parameters": columns}


def _shown(spec: ParameterSpec, values: Array) -> list[Any]:
    """The values of a parameter: words as words, numbers with all digits, None where there is none."""
    if not spec.words:
        return exact(values)
    return [spec.words[int(value)] if np.isfinite(value) else None for value in values]


def _method(scene: Scene, method: Method) -> dict[str, Any]:
    """Its solver, and how its command is made: groups of columns for each parameter, and options as they are."""
    given = (scene.design.parameters | set(scene.fixed)) & method.columns
    groups = []
    for name in method.solver.parameters:
        columns = [column for column in component_names(name, max(scene.sections, 1)) if column in given]
        if columns:
            groups.append([name, columns])
    options = [f"--option {shlex.quote(f'{name}={value}')}" for name, value in method.changed_options.items()]
    return {"name": method.name, "solver": method.solver.name, "parameters": groups, "options": " ".join(options)}


def _curves(dataset: xr.Dataset, left_out: list[str]) -> dict[str, Any]:
    """The line and the end of the history of each scenario, where they are few enough."""
    found = {}
    if "profile" in dataset:
        profile = dataset.profile.transpose(*dataset.status.dims, "component", "node")
        nodes = np.unique(np.linspace(0, profile.sizes["node"] - 1, MOST_NODES).round().astype(int))
        moved = [i for i, c in enumerate(COMPONENTS) if bool((profile.sel(component=c).fillna(0.0) != 0.0).any())]
        if dataset.status.size * nodes.size * max(len(moved), 2) <= MOST_CURVE_NUMBERS:
            shown = sorted({*moved, 0, 2})
            lines = profile.isel(component=shown, node=nodes)
            found["profiles"] = {"components": [COMPONENTS[i] for i in shown], **_whole_numbers(lines.values, 2)}
        else:
            left_out.append(f"the shapes of {dataset.status.size} lines are too many for this page")
    if "history" in dataset and "history_time" in dataset:
        history = dataset.history.transpose(*dataset.status.dims, "place", "time")
        last = slice(-LAST_SAMPLES, None)
        if dataset.status.size * len(PLACES) * min(history.sizes["time"], LAST_SAMPLES) <= MOST_CURVE_NUMBERS:
            times = dataset.history_time.transpose(*dataset.status.dims, "time").isel(time=last).values
            found["histories"] = {
                "places": [str(place) for place in dataset.place.values],
                "first": column(times[..., 0].ravel()),
                "last": column(times[..., -1].ravel()),
                **_whole_numbers(history.isel(time=last).values, 2),
            }
        else:
            left_out.append(f"the histories of {dataset.status.size} lines are too many for this page")
    return found


def _whole_numbers(values: np.ndarray, own: int) -> dict[str, Any]:
    """Values whose last `own` dimensions are within a scenario as whole numbers, and what 0 and `STEPS` stand for."""
    flat = values.reshape(-1, *values.shape[-own:]).astype(float)
    known = np.isfinite(flat)
    low = np.min(flat, axis=-1, where=known, initial=np.inf)
    high = np.max(flat, axis=-1, where=known, initial=-np.inf)
    low, high = np.where(np.isfinite(low), low, 0.0), np.where(np.isfinite(high), high, 0.0)
    scale = np.where(high > low, high - low, 1.0)
    steps = np.where(known, np.round((flat - low[..., None]) / scale[..., None] * STEPS), -1).astype(int)
    return {
        "steps": STEPS,
        "lowest": column(low, 7),
        "highest": column(low + scale, 7),
        "length": int(values.shape[-1]),
        "values": steps.ravel().tolist(),
    }
