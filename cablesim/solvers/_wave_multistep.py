"""Marching lines through time by multistep formulas of variable order and step: VODE, from SciPy.

`gear` are backward differentiation formulas up to fifth order, `adams` those of Adams and Moulton up to twelfth. The
places and velocities of the inner nodes are the unknowns, node by node: the matrix of Newton's method is a band then,
narrow with lumped mass, wide with consistent mass. Everything is recorded after each of the library's own steps, and
where the recorded periods begin and end, between two of them.

Backward differentiation of an order above 2 is unstable close to the imaginary axis: with stiff vibrations along the
line that nothing damps it is forced to short steps, and these grow until the error sees them. Adams' formulas of an
order above 2 are unstable there with longer steps. `max_order` 2 avoids both. A run whose energy does not balance has
not converged.

Reference: P. Brown, G. Byrne, A. Hindmarsh, SIAM J. Sci. Stat. Comput. 10 (1989) 1038.
"""

import warnings
from collections.abc import Callable
from time import perf_counter
from typing import Any

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.compiled import compiled
from cablesim.numerics.lanes import LANES
from cablesim.physics.nodal_line import (
    ACCELERATION,
    ADDED_TANGENT,
    LINEAR,
    MASS,
    NODE_ROWS,
    OTHER_SHARE,
    PIECE,
    PLACE,
    QUADRATIC,
    VELOCITY,
)
from cablesim.solvers._wave_explicit import OWN_ROWS, advance, evaluate, find_supports, keep_old, load
from cablesim.solvers._wave_forces import FOUND_ROWS
from cablesim.solvers._wave_line import ORDERS
from cablesim.solvers._wave_pack import (
    ACCEPTED,
    BEYOND,
    BEYOND_LAW,
    EVALUATIONS,
    GAVE_UP,
    OLD_PLACE,
    OLD_VELOCITY,
    OUT_OF_STEPS,
    OUT_OF_TIME,
    SOLVED,
    STEP,
    TIME,
    Marched,
    Problem,
    Records,
    make_pack,
)
from cablesim.solvers._wave_record import (
    TALLY_ROWS,
    finish_tally,
    note_elements,
    note_ends,
    note_history,
)

NAMES = {"gear": "bdf", "adams": "adams"}
# Unknowns of a node, and how many neighbours to each side act on it, by whether the mass is lumped. A consistent one
# couples all nodes, with 0.27 times as much for each further one: less than rounding beyond these.
UNKNOWNS, NEIGHBOURS = 6, {True: 1, False: 18}
# Tolerance of a step, root mean square of all unknowns, in those of the result: measured, worst in the least tensions.
SHARE = 1.0
# The longest step in parts of a period: at rest, a line does not show what is to come.
LONGEST = 1.0 / 16.0
# Steps of one call, which the library counts in 32 bits; a call takes one, or a few to a time in between.
MOST_AT_ONCE = 2**31 - 1


def gear(problem: Problem, has_waves: bool, options: Any, records: Records) -> Marched:
    return march_all("gear", problem, has_waves, options, records)


def adams(problem: Problem, has_waves: bool, options: Any, records: Records) -> Marched:
    return march_all("adams", problem, has_waves, options, records)


def march_all(name: str, problem: Problem, has_waves: bool, options: Any, records: Records) -> Marched:
    """March the scenarios one after another; the library's steps are not rejected steps of ours (0)."""
    order = options.max_order or ORDERS[name]
    fates = [
        march(Line(problem, scenario, has_waves, records), NAMES[name], order, options)
        for scenario in range(len(problem.lines))
    ]
    fate, steps, evaluations = np.array(fates).reshape(-1, 3).T
    return Marched(fate, steps, np.zeros(len(fate)), evaluations, records)


def march(line: "Line", method: str, order: int, options: Any) -> tuple[float, float, float]:
    """Fate, steps and evaluations of one line."""
    from scipy.integrate import ode

    solver = ode(line.slope).set_integrator(
        "vode",
        method=method,
        order=order,
        rtol=0.0,
        atol=line.tolerances(options.rtol),
        nsteps=min(options.most_steps, MOST_AT_ONCE),
        max_step=options.step_part * LONGEST * line.problem.spans[line.scenario, 2],
        **line.matrix(),
    )
    solver.set_initial_value(line.state(), 0.0)
    begun = perf_counter()
    with warnings.catch_warnings():
        # What the library warns of is the fate of the scenario.
        warnings.simplefilter("ignore", UserWarning)
        for step in range(1, options.most_steps + 1):
            state = solver.integrate(line.end, step=True)
            if not solver.successful() or not np.isfinite(state).all():
                return line.finish(GAVE_UP, step)
            line.note(solver.t, state, solver.integrate)
            if line.is_beyond_law:
                return line.finish(BEYOND_LAW, step)
            if line.time >= line.end:
                return line.finish(SOLVED, step)
            if perf_counter() - begun > options.most_seconds:
                return line.finish(OUT_OF_TIME, step)
    return line.finish(OUT_OF_STEPS, options.most_steps)


class Line:
    """One line in the first lane of two packs: one for the library's evaluations, one for what is recorded."""

    def __init__(self, problem: Problem, scenario: int, has_waves: bool, records: Records):
        self.problem, self.scenario, self.has_waves, self.records = problem, scenario, has_waves, records
        self.count = problem.tensions.shape[1]
        self.is_lumped = bool(problem.lines[scenario, OTHER_SHARE] == 0.0)
        self.end, self.window = problem.spans[scenario, 0], problem.spans[scenario, 1]
        self.pack, self.noted = make_pack(self.count), make_pack(self.count)
        self.tally, self.own = np.zeros(TALLY_ROWS * LANES), np.ones(OWN_ROWS * LANES)
        self.found, self.slopes = np.zeros(FOUND_ROWS * LANES), np.zeros(UNKNOWNS * (self.count - 1))
        for pack in (self.pack, self.noted):
            load(pack, self.tally, self.own, 0, scenario, problem, self.count, 0.0)
        self.time = 0.0

    @property
    def is_beyond_law(self) -> bool:
        return bool(self.noted.lane[BEYOND * LANES] > 0.0)

    def state(self) -> Array:
        """Places and velocities of the inner nodes at rest."""
        inner = self.problem.starts[self.scenario, 1:-1]
        return np.concatenate([inner, np.zeros_like(inner)], axis=1).ravel()

    def slope(self, time: float, state: Array) -> Array:
        slopes = np.empty_like(state)
        find_slopes(time, state, slopes, self.pack, self.own, self.found, self.has_waves, self.is_lumped, self.count)
        return slopes

    def tolerances(self, rtol: float) -> Array:
        """Of places and velocities, such that either leads to the tolerated error of tension in a wave along a line."""
        row, (pull, move) = self.problem.lines[self.scenario], self.problem.scales[self.scenario]
        stiffness = row[LINEAR] + 2.0 * max(row[QUADRATIC], 0.0) * pull / row[LINEAR]
        place = min(pull * row[PIECE] / stiffness, move)
        speed = np.sqrt(stiffness / (row[MASS] - row[ADDED_TANGENT])) / row[PIECE]
        return SHARE * rtol * place * np.tile(np.repeat([1.0, speed], 3), self.count - 1)

    def matrix(self) -> dict[str, Any]:
        """What the library is told about the matrix of Newton's method."""
        width = min(UNKNOWNS * (NEIGHBOURS[self.is_lumped] + 1), UNKNOWNS * (self.count - 1)) - 1
        return {"with_jacobian": True, "lband": width, "uband": width}

    def note(self, time: float, state: Array, between: Callable[[float], Array]) -> None:
        """Record the end of a step, and the window's beginning and end if it has passed them."""
        passed = [when for when in (self.window, self.end) if self.time < when < time]
        for when, there in [(when, between(when)) for when in passed] + [(time, state)]:
            if self.time < when <= self.end:
                note_state(
                    when,
                    there,
                    self.noted,
                    self.tally,
                    self.own,
                    self.found,
                    self.records,
                    self.has_waves,
                    self.is_lumped,
                    self.count,
                )
                self.time = when

    def finish(self, fate: float, steps: int) -> tuple[float, float, float]:
        finish_tally(self.noted, self.tally, 0, self.records, self.count)
        return fate, float(steps), self.pack.lane[EVALUATIONS * LANES]


@compiled
def put_state(nodes, state, count):
    for j in range(1, count):
        node = nodes[NODE_ROWS * LANES * j : NODE_ROWS * LANES * (j + 1)]
        for k in range(3):
            node[(OLD_PLACE + k) * LANES] = node[(PLACE + k) * LANES]
            node[(OLD_VELOCITY + k) * LANES] = node[(VELOCITY + k) * LANES]
            node[(PLACE + k) * LANES] = state[UNKNOWNS * (j - 1) + k]
            node[(VELOCITY + k) * LANES] = state[UNKNOWNS * (j - 1) + 3 + k]


@compiled
def find_slopes(time, state, slopes, pack, own, found, has_waves, is_lumped, count):
    """Velocities and accelerations of the inner nodes."""
    put_state(pack.nodes, state, count)
    pack.method[STEP * LANES] = time
    evaluate(pack, own, found, 1.0, has_waves, is_lumped, count, 1)
    for j in range(1, count):
        node = pack.nodes[NODE_ROWS * LANES * j : NODE_ROWS * LANES * (j + 1)]
        for k in range(3):
            slopes[UNKNOWNS * (j - 1) + k] = node[(VELOCITY + k) * LANES]
            slopes[UNKNOWNS * (j - 1) + 3 + k] = node[(ACCELERATION + k) * LANES]


@compiled
def note_state(time, state, pack, tally, own, found, records, has_waves, is_lumped, count):
    """Record the line as it is at a time, after a step from the last one."""
    keep_old(pack.nodes, pack.elements, count, 1)
    put_state(pack.nodes, state, count)
    pack.method[STEP * LANES] = time - pack.lane[TIME * LANES]
    pack.lane[ACCEPTED * LANES] = 1.0
    evaluate(pack, own, found, 1.0, has_waves, is_lumped, count, 1)
    find_supports(pack.nodes, pack.elements, pack.lane, found, count, 1)
    note_elements(pack.elements, pack.method, pack.lane, tally, count, 1)
    if records.history.shape[1] > 0:
        note_history(pack, tally, 0, records, count)
    note_ends(pack, tally, 0)
    advance(pack, found, 0)
