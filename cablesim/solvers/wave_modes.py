"""Vibrations of a line moored in waves about its rest, and the longest stable step of explicit integrators.

    M x'' + K x = 0,    K v = omega^2 M v                                                             (V1)
    K = K_elastic + K_geometric,  element by element  E/h t t' + T/l (1 - t t'),  nothing where it is slack

x are the displacements of the inner nodes of the same discrete line that `wave_line` marches, from the equilibrium
where its run starts; M is its mass matrix (consistent or lumped) with added mass across the elements, E the slope of
the law (M15), h the unstretched and l the stretched length of an element. Both ends are held. K and M are those of
`physics.nodal_line`, not a second statement of them. Drag, internal damping and how the load of a stream turns with the
line are left out.

    lowest_frequency, highest_frequency      the extreme omega
    frequency_ratio                          highest omega over 2 pi / wave period
    stable_step_limit                        2 / omega (leapfrog), 2 sqrt(2) / omega (rk4), of the highest omega
    stable_step                              the same found by marching (see `_wave_stable_step`), drag and all

The frequency ratio is the stiffness of the problem: its fastest scale over that of the motion which is asked for.
Leapfrog needs pi times as many steps a period. The lowest frequency of the line would be no measure of that: it is zero
where elements are slack, and a long wave may be slower than any vibration.

All eigenvalues are computed densely, at a cost that grows with segments^3. Squares of frequencies are right within
rounding of the highest: the lowest frequency loses digits where it is less than 1e-6 of it.

Reference: Hughes, T. J. R. (2000), The Finite Element Method, Dover, sections 7.3 and 9.1.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import eigvalsh

from cablesim.numerics import Array
from cablesim.numerics.lanes import LANES
from cablesim.parameters import option
from cablesim.physics.nodal_line import ELEMENT_ROWS, HELD, NODE_ROWS, OTHER, OWN, PLACE, assemble
from cablesim.solver import Solution
from cablesim.solvers._wave_line import SHARES
from cablesim.solvers._wave_line import MooredLine as Parameters
from cablesim.solvers._wave_line import Options as MarchOptions
from cablesim.solvers._wave_pack import Problem
from cablesim.solvers._wave_stable_step import stable_steps
from cablesim.solvers.wave_line import FATES
from cablesim.status import Status

__all__ = ["OUTPUTS", "Options", "Parameters", "solve"]

OUTPUTS = ("lowest_frequency", "highest_frequency", "frequency_ratio", "stable_step_limit", "stable_step")
COMPILED = True
# Longest stable step times the frequency of a vibration that nothing damps.
LIMITS = {"leapfrog": 2.0, "rk4": 2.0 * np.sqrt(2.0)}
# Symmetric blocks are kept as xx, xy, xz, yy, yz, zz.
ROWS = np.array([[0, 1, 2], [1, 3, 4], [2, 4, 5]])


@dataclass(frozen=True)
class Options:
    """Numerical options."""

    segments: int = option(20, at_least=2, at_most=1000, meaning="straight elements of the line")
    integrator: str = option("leapfrog", one_of=tuple(LIMITS), meaning="explicit method whose stable step is found")
    mass: str = option("consistent", one_of=tuple(SHARES), meaning="mass matrix of an element")
    added_mass: str = option("normal", one_of=("normal", "isotropic"), meaning="acceleration that added mass resists")


def seconds_per_scenario(options: Options) -> float:
    stages = {"leapfrog": 1, "rk4": 4}[options.integrator]
    return 5e-4 + 1e-4 * options.segments * stages + 2e-9 * options.segments**3


@dataclass(frozen=True)
class Vibrations:
    """Frequencies of lines about their rest, arrays of one entry per scenario; NaN where there is no rest."""

    p: Parameters
    problem: Problem
    squares: Array
    is_still: np.ndarray
    integrator: str

    @property
    def lowest_frequency(self) -> Array:
        return np.sqrt(np.maximum(self.squares[:, 0], 0.0))

    @property
    def highest_frequency(self) -> Array:
        return np.sqrt(self.squares[:, 1])

    @property
    def frequency_ratio(self) -> Array:
        return self.highest_frequency * self.p.wave_period / (2.0 * np.pi)

    @property
    def stable_step_limit(self) -> Array:
        return LIMITS[self.integrator] / self.highest_frequency

    @cached_property
    def stable_step(self) -> Array:
        found = np.full(self.p.size, np.nan)
        some = Problem(*(part[self.is_still] for part in self.problem))
        found[self.is_still] = stable_steps(some, self.stable_step_limit[self.is_still], self.integrator == "leapfrog")
        return found


def solve(p: Parameters, options: Options) -> Solution:
    still = p.equilibrium(options.segments)
    status = np.array([FATES[int(fate)] for fate in still.fate], dtype=np.int8)
    march = MarchOptions(segments=options.segments, mass=options.mass, added_mass=options.added_mass)
    problem = p.problem(still, march)
    squares = np.full((p.size, 2), np.nan)
    for i in np.flatnonzero(status == Status.ok).tolist():
        squares[i] = eigvalsh(stiffness_matrix(problem, i), mass_matrix(problem, i))[[0, -1]]
    return Solution(status, Vibrations(p, problem, squares, status == Status.ok, options.integrator))


def stiffness_matrix(problem: Problem, scenario: int) -> Array:
    """K of the inner nodes' coordinates, node by node."""
    return _matrix(problem, scenario, problem.tensions[scenario], 0.0)


def mass_matrix(problem: Problem, scenario: int) -> Array:
    """M of the same; of elements that are taken as slack, the forces change with accelerations alone."""
    return _matrix(problem, scenario, np.zeros_like(problem.tensions[scenario]), 1.0)


def _matrix(problem: Problem, scenario: int, held: Array, by_acceleration: float) -> Array:
    """How the forces on the inner nodes change with places and, by a factor, with accelerations."""
    count = held.size
    nodes, elements = np.zeros((count + 1, NODE_ROWS, LANES)), np.zeros((count, ELEMENT_ROWS, LANES))
    nodes[:, PLACE : PLACE + 3, 0] = problem.starts[scenario]
    elements[:, HELD, 0] = held
    line, factors = np.zeros((problem.lines.shape[1], LANES)), np.zeros((2, LANES))
    line[:, 0], factors[1, 0] = problem.lines[scenario], by_acceleration
    found = elements.ravel()
    assemble(nodes.ravel(), np.zeros(count * 6 * LANES), line.ravel(), factors.ravel(), found, count, 1)
    rows = found.reshape(elements.shape)[:, :, 0]
    return _joined(rows[:, OWN + ROWS], rows[:, OTHER + ROWS])


def _joined(own: Array, other: Array) -> Array:
    """The matrix of the inner nodes from the blocks (element, 3, 3) of elements: of a node by itself, by the other."""
    count = len(own)
    whole = np.zeros((count + 1, 3, count + 1, 3))
    left, right = np.arange(count), np.arange(1, count + 1)
    whole[left, :, left, :] += own
    whole[right, :, right, :] += own
    whole[left, :, right, :] += other
    whole[right, :, left, :] += other
    return whole[1:-1, :, 1:-1].reshape(3 * (count - 1), 3 * (count - 1))
