"""What a solver is: a module in `cablesim/solvers/` with `Parameters`, `solve` and `OUTPUTS`.

    Parameters   a frozen dataclass on `Batch`: one array per parameter, one entry per scenario (a list: one row)
    Options      (optional) a frozen dataclass of numerical options; the default is none
    OUTPUTS      the names of what it can answer, all rows of the table of quantities
    SECONDS_PER_SCENARIO   a measured cost, from which shards are sized; where that depends on the options, a function
                 seconds_per_scenario(options) instead
    seconds_of(parameters, options)   (optional) a closer estimate: the seconds of each scenario by its parameters
    solve(parameters, options) -> Solution; its answer has an attribute for every output, and one that is a cached
                 property costs nothing unless it is asked for
    sizes(options)   (optional) lengths of the dimensions of its outputs by name, as {"node": 51, "time": 600}; without
                 it, "node" is the option `nodes`
    answered(options)   (optional) those of OUTPUTS that it has with these options; without it, all
    ITERATES     (optional) True where it reports its iterations
    COMPILED     (optional) True where its first call compiles or loads machine code
    warm(parameters, options, outputs)   (optional) makes that first call, where solving a scenario would take too long
    RECORDS      (optional) True where it must know beforehand which histories to keep: then it is called
                 solve(parameters, options, outputs), with the names of what is asked

Nothing registers itself: solvers are found by looking into the folder, and only the one asked for is imported. Modules
whose name starts with an underscore are shared parts, not solvers.

Peers, in `cablesim/peers/`, are solvers too as far as scenes are concerned: thin adapters to other people's programs,
to compare with. They say which distribution they call (`REQUIRES`), and answer `unavailable` where it is missing.
"""

import ast
import dataclasses
import importlib
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from cablesim.errors import InputError, nearest
from cablesim.numerics import Array
from cablesim.parameters import (
    NoOptions,
    OptionSpec,
    ParameterSpec,
    check_given,
    check_sections,
    gather,
    given_by_columns,
    nearest_parameter,
    problem_words,
    specs,
)

PACKAGE = Path(__file__).parent
FOLDER, PEERS = PACKAGE / "solvers", PACKAGE / "peers"


@dataclass(frozen=True)
class Solution:
    """What `solve` returns: the fate of every scenario, and an object with one attribute for each output.

    `status` and `iterations` have shape (scenario,), an output (scenario, ...). One over `section` is as wide as the
    listed parameters, and NaN after the last section of a line.
    """

    status: np.ndarray
    answer: Any
    iterations: np.ndarray | None = None


@dataclass(frozen=True)
class Solver:
    """A solver module, seen from outside."""

    name: str
    module: ModuleType

    @property
    def summary(self) -> str:
        return summary(self.name)

    @property
    def requires(self) -> str:
        """The distribution that a peer calls; nothing for a solver of ours."""
        return getattr(self.module, "REQUIRES", "")

    @property
    def outputs(self) -> tuple[str, ...]:
        return self.module.OUTPUTS

    def answered(self, options: Any) -> tuple[str, ...]:
        """The outputs that it has with these options."""
        declared = getattr(self.module, "answered", None)
        return declared(options) if declared else self.outputs

    @property
    def iterates(self) -> bool:
        """Whether it reports how many iterations each scenario took."""
        return getattr(self.module, "ITERATES", False)

    @property
    def compiled(self) -> bool:
        """Whether its first call takes longer, because it compiles or loads machine code."""
        return getattr(self.module, "COMPILED", False)

    def seconds_per_scenario(self, options: Any) -> float:
        """The measured cost, with these options."""
        measured = getattr(self.module, "seconds_per_scenario", None)
        return measured(options) if measured else self.module.SECONDS_PER_SCENARIO

    def seconds_of(self, parameters: Any, options: Any) -> Array:
        """What each of these scenarios is expected to take, as far as the solver can tell them apart."""
        declared = getattr(self.module, "seconds_of", None)
        if declared is not None:
            return declared(parameters, options)
        return np.full(parameters.size, self.seconds_per_scenario(options))

    @property
    def tells_scenarios_apart(self) -> bool:
        """Whether their parameters decide what it says they take."""
        return hasattr(self.module, "seconds_of")

    def sizes(self, options: Any) -> dict[str, int]:
        """The lengths of its outputs' own dimensions, with these options; those that always have one are left out."""
        declared = getattr(self.module, "sizes", None)
        if declared is not None:
            return declared(options)
        return {"node": options.nodes} if hasattr(options, "nodes") else {}

    def solve(self, parameters: Any, options: Any, outputs: tuple[str, ...]) -> Solution:
        """The answer to a batch of scenarios; `outputs` are those that will be looked at."""
        if getattr(self.module, "RECORDS", False):
            return self.module.solve(parameters, options, outputs)
        return self.module.solve(parameters, options)

    @cached_property
    def parameters(self) -> dict[str, ParameterSpec]:
        return {spec.name: spec for spec in specs(self.module.Parameters)}

    @cached_property
    def columns(self) -> dict[str, ParameterSpec]:
        """The parameters as designs hold them: scalars, a vector by its components, a list by its sections."""
        return {column.name: column for spec in self.parameters.values() for column in spec.columns}

    @cached_property
    def names(self) -> dict[str, ParameterSpec]:
        """Every name by which a parameter, or a component or section of one, may be given."""
        return {**self.parameters, **self.columns}

    @property
    def problems(self) -> str:
        """The groups of parameters of which exactly one is given, in words."""
        return problem_words(self.module.Parameters)

    @cached_property
    def options(self) -> dict[str, OptionSpec]:
        fields = dataclasses.fields(getattr(self.module, "Options", NoOptions))
        return {f.name: OptionSpec(f.name, f.default, **f.metadata) for f in fields}

    def parameter(self, name: str) -> ParameterSpec:
        """A parameter, or a part of one, as declared. Raises InputError, with the nearest names, if unknown."""
        if name not in self.names:
            raise InputError(f"{self.name} has no parameter '{name}': {nearest_parameter(name, self.names)}")
        return self.names[name]

    def make_parameters(self, values: dict[str, Any]) -> Any:
        """A batch of scenarios. Raises InputError for an unknown, missing or impossible parameter."""
        for name in values:
            self.parameter(name)
        gathered = gather(self.module.Parameters, values)
        check_given(self.module.Parameters, set(gathered))
        return self.module.Parameters(**gathered)

    def check_columns(self, names: set[str]) -> None:
        """Raises InputError unless these columns of a design, and the defaults, are all that it needs."""
        whole = given_by_columns(self.module.Parameters, names)
        check_given(self.module.Parameters, whole | {name for name in names if name in self.parameters})

    def check_lists(self, columns: dict[str, Array]) -> None:
        """Raises InputError unless the lists in these columns of a design are whole, and as long as each other."""
        parts = {name: values for name, values in columns.items() if self.columns[name].section}
        lists = {name: self.parameters[name].read(v) for name, v in gather(self.module.Parameters, parts).items()}
        for name, values in lists.items():
            self.parameters[name].check(values)
        check_sections(lists)

    def from_columns(self, columns: dict[str, Any]) -> Any:
        """A batch from the columns of a design, in which a word is a number."""
        return self.make_parameters(
            {name: self.columns[name].restored(np.asarray(values)) for name, values in columns.items()}
        )

    def make_options(self, values: dict[str, Any]) -> Any:
        """The numerical options. Raises InputError for an unknown one or a value that is not allowed."""
        for name in values:
            if name not in self.options:
                raise InputError(f"{self.name} has no option '{name}': {nearest(name, self.options)}")
        read = {name: self.options[name].read(value) for name, value in values.items()}
        return getattr(self.module, "Options", NoOptions)(**read)

    def check_outputs(self, names: tuple[str, ...], options: Any) -> None:
        """Raises InputError for an output it does not have, or not with these options."""
        for name in names:
            if name not in self.outputs:
                raise InputError(f"{self.name} has no output '{name}': {nearest(name, self.outputs)}")
            if name not in self.answered(options):
                raise InputError(f"{self.name} has no output '{name}' with these options")


def solver_names() -> list[str]:
    """The solvers in the folder, by name."""
    return _modules(FOLDER)


def peer_names() -> list[str]:
    """The adapters to other people's programs, by name."""
    return _modules(PEERS)


@cache
def load_solver(name: str) -> Solver:
    """Import one solver or peer. Raises InputError, with the nearest names, if there is none of that name."""
    known = [*solver_names(), *peer_names()]
    if name not in known:
        raise InputError(f"unknown solver '{name}': {nearest(name, known)}")
    return Solver(name, importlib.import_module(f"cablesim.{source(name).parent.name}.{name}"))


def summary(name: str) -> str:
    """The first sentence of a solver's docstring, read without importing it."""
    docstring = ast.get_docstring(ast.parse(source(name).read_text(encoding="utf-8"))) or ""
    return docstring.split("\n", 1)[0].strip()


def source(name: str) -> Path:
    """The module of a solver or peer."""
    folder = PEERS if name in peer_names() else FOLDER
    return folder / f"{name}.py"


def installed(distribution: str) -> str:
    """The version of a distribution; empty where it is not installed."""
    try:
        return version(distribution)
    except PackageNotFoundError:
        return ""


def _modules(folder: Path) -> list[str]:
    return sorted(path.stem for path in folder.glob("*.py") if not path.stem.startswith("_"))
