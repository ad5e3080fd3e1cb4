"""Nonlinear-elastic line from an anchor to the surface, in waves: elements between nodes, marched through time.

    T = (C_eps eps + C_eps1 eps^2) H(eps)                                                             (M15)
    m a = d(T t)/ds + (m - rho F) g + C_n |u_n| u_n + C_t |u_t| u_t + C_a (a_f - a)_n + rho F a_f      (M16)
    r_B = r_B0 + R(t) A [sin(omega t + phase) e1 + (b/A) cos(omega t + phase) e2],  r_A fixed          (M17)
    A = 0.085 exp(0.75 ln(g T_w^2 / 2 pi)) metres, where neither amplitude nor wave height is given    (M18)

u is the velocity of the fluid relative to the line, a_f its acceleration, n and t are across and along the line, all
loads per unstretched length. The line carries no compression; where it is slack it is exactly without tension. The
fluid is still, a uniform stream, or moved by a plane progressive wave (see `physics.waves`), and the top end moves on
an ellipse or with the surface. The bottom is not felt between the ends: a slack line may hang below its anchor.

`segments` elements join nodes at which Lagrange's equations hold, with consistent or lumped mass (see
`physics.nodal_line`). The line starts from the equilibrium of the same discrete line and is marched by

    generalized_alpha   implicit, with steps by `rtol`: Newton's method with a block-tridiagonal matrix
    leapfrog, rk4       explicit, at a part of the longest stable step, or with shorter ones by `rtol`
    gear, adams         multistep formulas of variable order, steps by `rtol`; `max_order` limits the order

Energy that does not balance ends in `not_converged`, and so does a fixed `time_step` of the explicit two beyond the
stable one. Gear's formulas of an order above 2 are unstable in vibrations along the line that nothing damps, Adams'
with long steps: ask for `max_order: 2`, and for lumped mass, which makes a narrow band of their matrix.

End tensions are the forces on the end points. Tensions are recorded over the last five whole periods. A method takes
at most `step_part` of its longest step, which is a part of the period, and of what is stable.

Where not to rely on it. A line that is jerked taut rings in waves as short as the elements unless it has internal
damping: peaks then still depend on the mesh and on `rtol`. Ask for `mesh_check` and `time_check`, which tell how much
tensions change with half as long elements, and with a tenth of `rtol` and half of the longest steps; and look at
`period_spread`, which tells how different the last periods are: peaks of a line that snaps irregularly are known no
better than that. Waves that no march resolves are damped in each, and no change tells of them: tensions of a line that
goes slack are uncertain by some of the root of `energy_error` as well.

Elements carry no bending and no torsion. A softening law is left (`out_of_domain`) where the strain passes its greatest
tension, and lines that need more than that at rest have no solution (`infeasible`). A scenario that is given up after
`most_seconds` may be solved by a faster machine.

Reference: Investigation of the influence of nonlinear elastic properties of the material on the dynamics of submarine
cable systems (in Ukrainian), eqs. (1)-(8).
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cablesim.numerics import Array
from cablesim.solver import Solution
from cablesim.solvers import _wave_explicit, _wave_march, _wave_multistep, _wave_static
from cablesim.solvers._wave_cost import march_seconds
from cablesim.solvers._wave_line import MooredLine as Parameters
from cablesim.solvers._wave_line import Options, empty_records
from cablesim.solvers._wave_pack import BEYOND_LAW, SOLVED, UNBALANCED, Marched, Problem, Records
from cablesim.status import Status

__all__ = ["OUTPUTS", "Options", "Parameters", "solve"]

PLACES, KINDS = ("anchor", "middle", "top"), ("max", "min", "mean")
TENSIONS = tuple(f"{kind}_{place}_tension" for place in PLACES for kind in (*KINDS, "static"))
HISTORIES = ("history", "history_time")
SHAPES = ("orbit", "snapshots", "snapshot_tension")
MESH_CHECK, TIME_CHECK = ("mesh_change", "richardson_top_tension"), ("time_change",)
OUTPUTS = (
    *TENSIONS,
    "static_residual",
    "slack_fraction",
    "snap_count",
    "max_strain",
    "energy_error",
    "period_spread",
    "steps",
    "rejected_steps",
    "rhs_evaluations",
    *MESH_CHECK,
    *TIME_CHECK,
    "profile",
    "profile_tension",
    "profile_max_tension",
    "profile_min_tension",
    *HISTORIES,
    *SHAPES,
)
COMPILED = True
RECORDS = True
# The integrators; seconds that one needs per element of a scenario of twelve periods; and the error of energy beyond
# which, and beyond the tolerance, it is lost. The first one damps what rings after snaps, which is no error; sound
# marches of the others leave a tenth of theirs at most.
METHODS = {
    "generalized_alpha": (_wave_march.generalized_alpha, 1e-4, 0.1),
    "leapfrog": (_wave_explicit.leapfrog, 1e-3, 0.02),
    "rk4": (_wave_explicit.rk4, 2.5e-3, 0.02),
    "gear": (_wave_multistep.gear, 3e-3, 0.02),
    "adams": (_wave_multistep.adams, 4e-3, 0.02),
}
FATES = {
    _wave_static.SOLVED: Status.ok,
    _wave_static.INFEASIBLE: Status.infeasible,
    _wave_static.NOT_CONVERGED: Status.not_converged,
    _wave_static.NOT_FINITE: Status.out_of_domain,
}


def sizes(options: Options) -> dict[str, int]:
    return {"node": options.segments + 1, "time": options.samples, "phase": options.phases, "place": len(PLACES)}


def answered(options: Options) -> tuple[str, ...]:
    left_out = (() if options.mesh_check == "yes" else MESH_CHECK) + (() if options.time_check == "yes" else TIME_CHECK)
    return tuple(name for name in OUTPUTS if name not in left_out)


def seconds_per_scenario(options: Options) -> float:
    return METHODS[options.integrator][1] * options.segments * _marches(options)


def seconds_of(p: Parameters, options: Options) -> Array:
    marches = [options]
    if options.mesh_check == "yes":
        marches.append(replace(options, segments=2 * options.segments))
    if options.time_check == "yes":
        marches.append(options.closer)
    return np.sum([march_seconds(p, one, METHODS[options.integrator][1]) for one in marches], axis=0)


def _marches(options: Options) -> int:
    """The work in terms of a march: closer meshes and steps are some more."""
    return 1 + 4 * (options.mesh_check == "yes") + 4 * (options.time_check == "yes")


def warm(p: Parameters, options: Options, outputs: tuple[str, ...]) -> None:
    """Compile or load all that is needed: a short run of two scenarios, which march side by side."""
    short = object.__new__(Parameters)
    for name in p.__dataclass_fields__:
        value = getattr(p, name)
        object.__setattr__(short, name, None if value is None else np.repeat(value[:1], 2, axis=0))
    object.__setattr__(short, "duration", 0.01 * short.wave_period)
    solve(short, options, outputs)


@dataclass(frozen=True)
class MovedLine:
    """Lines marched through time, arrays of one entry per scenario."""

    p: Parameters
    options: Options
    still: _wave_static.StaticLines
    supports: Array
    marched: Marched
    finer: Array
    closer: Array

    def __getattr__(self, name: str) -> Array:
        kind, _, place = name.removesuffix("_tension").partition("_")
        if name not in TENSIONS:
            raise AttributeError(name)
        if kind == "static":
            return self.supports[:, PLACES.index(place)]
        return self.records.ends[:, PLACES.index(place), KINDS.index(kind)]

    @property
    def records(self) -> Records:
        return self.marched.records

    @property
    def static_residual(self) -> Array:
        return self.still.residual

    @property
    def slack_fraction(self) -> Array:
        return self.records.line[:, 0]

    @property
    def snap_count(self) -> Array:
        return self.records.line[:, 1]

    @property
    def max_strain(self) -> Array:
        return self.records.line[:, 2]

    @property
    def energy_error(self) -> Array:
        return self.records.line[:, 3]

    @property
    def period_spread(self) -> Array:
        return self.records.line[:, 4]

    @property
    def steps(self) -> Array:
        return self.marched.steps

    @property
    def rejected_steps(self) -> Array:
        return self.marched.rejected

    @property
    def rhs_evaluations(self) -> Array:
        return self.marched.evaluations

    @property
    def mesh_change(self) -> Array:
        return largest_change(self.records.ends, self.finer)

    @property
    def time_change(self) -> Array:
        return largest_change(self.records.ends, self.closer)

    @property
    def richardson_top_tension(self) -> Array:
        """Errors of a mesh go with the square of its elements' length."""
        finer = self.finer[:, PLACES.index("top"), 0]
        return finer + (finer - self.max_top_tension) / 3.0

    @property
    def profile(self) -> Array:
        return self.still.position

    @property
    def profile_tension(self) -> Array:
        return at_nodes(self.still.tension, self.supports[:, ::2])

    @property
    def profile_max_tension(self) -> Array:
        return at_nodes(self.records.extremes[:, :, 0], self.records.ends[:, ::2, 0])

    @property
    def profile_min_tension(self) -> Array:
        return at_nodes(self.records.extremes[:, :, 1], self.records.ends[:, ::2, 1])

    @property
    def history(self) -> Array:
        return self.records.history

    @property
    def history_time(self) -> Array:
        return np.linspace(0.0, self.p.end_time, self.options.samples, axis=1)

    @property
    def orbit(self) -> Array:
        segments = self.still.tension.shape[1]
        middle = 0.5 * (self.still.position[:, segments // 2] + self.still.position[:, (segments + 1) // 2])
        return self.records.orbit - (middle - self._anchor)[:, None]

    @property
    def snapshots(self) -> Array:
        return self.records.shapes + self._anchor[:, None, None]

    @cached_property
    def snapshot_tension(self) -> Array:
        pulls = self.records.pulls
        return at_nodes(pulls, pulls[..., [0, -1]])

    @property
    def _anchor(self) -> Array:
        """From the anchor up to the surface (scenario, 3)."""
        return self.p.depth[:, None] * [0.0, 0.0, 1.0]


def march(p: Parameters, problem: Problem, able: np.ndarray, options: Options, samples: int, phases: int) -> Marched:
    """March the scenarios that are able to; of the others nothing is known."""
    some = Problem(*(part[able] for part in problem))
    records = empty_records(able.size, problem.tensions.shape[1], samples, phases)
    method, _, unbalanced = METHODS[options.integrator]
    found = method(some, p.has_waves, options, records)
    is_balanced = found.records.line[:, 3] <= unbalanced + options.rtol
    return Marched(
        spread(np.where((found.fate == SOLVED) & ~is_balanced, UNBALANCED, found.fate), able, p.size),
        spread(found.steps, able, p.size),
        spread(found.rejected, able, p.size),
        spread(found.evaluations, able, p.size),
        Records(*(spread(values, able, p.size) for values in found.records)),
    )


def spread(values: Array, rows: np.ndarray, size: int) -> Array:
    """Values in some rows of a batch, NaN in the others."""
    whole = np.full((size, *values.shape[1:]), np.nan, dtype=values.dtype)
    whole[rows] = values
    return whole


def at_nodes(elements: Array, ends: Array) -> Array:
    """Values at nodes (..., node): means of the elements (..., element) that meet there, and given ones at the ends."""
    inner = 0.5 * (elements[..., 1:] + elements[..., :-1])
    return np.concatenate([ends[..., :1], inner, ends[..., 1:]], axis=-1)


def solve(p: Parameters, options: Options, outputs: tuple[str, ...]) -> Solution:
    still = p.equilibrium(options.segments)
    status = np.array([FATES[int(fate)] for fate in still.fate], dtype=np.int8)
    if p.has_waves:
        status[(status == Status.ok) & (p.wave_height >= 2.0 * p.depth)] = Status.out_of_domain
    able = np.flatnonzero(status == Status.ok)
    problem = p.problem(still, options)
    samples = options.samples if "history" in outputs else 0
    phases = options.phases if set(SHAPES) & set(outputs) else 0
    marched = march(p, problem, able, options, samples, phases)
    status[(status == Status.ok) & (marched.fate == BEYOND_LAW)] = Status.out_of_domain
    status[(status == Status.ok) & (marched.fate != SOLVED)] = Status.not_converged
    finer = closer = np.full((p.size, len(PLACES), len(KINDS)), np.nan)
    able = np.flatnonzero(status == Status.ok)
    if options.mesh_check == "yes":
        twice = p.equilibrium(2 * options.segments)
        both = able[twice.fate[able] == _wave_static.SOLVED]
        finer = checked(p, p.problem(twice, options), both, options, status)
    if options.time_check == "yes":
        closer = checked(p, problem, able, options.closer, status)
    line = MovedLine(p, options, still, problem.supports, marched, finer, closer)
    return Solution(status, line)


def checked(p: Parameters, problem: Problem, able: np.ndarray, options: Options, status: np.ndarray) -> Array:
    """Tensions (scenario, place, kind) of lines marched again; the answer of those that cannot be is taken back."""
    found = march(p, problem, able, options, 0, 0)
    is_known = found.fate == SOLVED
    status[(status == Status.ok) & ~is_known] = Status.not_converged
    return np.where(is_known[:, None, None], found.records.ends, np.nan)


def largest_change(tensions: Array, others: Array) -> Array:
    """Largest change of tensions (scenario, place, kind), over the largest of all; 0 of a line without tension."""
    change, largest = np.abs(others - tensions).max(axis=(1, 2)), tensions.max(axis=(1, 2))
    return np.divide(change, largest, out=np.zeros_like(change), where=change != 0.0)
