"""The handbook's way: a line between two ends on one vertical, by linear interpolation in a table of Pode's functions.

Both ends lie at one x, so xi_B = xi_A. For angles at B on half steps of the table the angle at A follows from xi, and
from both the ratio (eta_B - eta_A) / (sigma_B - sigma_A), which must be that of the height to the length. The two
trials around it are interpolated linearly in this ratio, angles and functions alike (reference angle 180 deg). Kept to
show what the tables were worth: use `pode_line`.

The table itself is exact here. The method knows only a B above A, in a stream, without lay angle. Where its ends are
missed by more than a hundredth of the slack, the table is too coarse to tell the tension (`not_converged`).

Reference: Handbook on ropes and fishing gear (in Chinese), section 3-5, example 4.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from cablesim.numerics import Array
from cablesim.parameters import option
from cablesim.physics.stream import critical_angle
from cablesim.solver import Solution
from cablesim.solvers import _stream_line
from cablesim.solvers._pode_march import HORIZONTAL, LENGTH, TENSION, VERTICAL, logits, packed, pode_integrals
from cablesim.solvers._stream_line import LineBetweenEnds as Parameters
from cablesim.solvers._stream_line import Nodes, SolvedLine
from cablesim.status import Status

__all__ = ["OUTPUTS", "Options", "Parameters", "solve"]

OUTPUTS = tuple(name for name in _stream_line.OUTPUTS if name != "steps")
COMPILED = True
# A chord that leans by less than this part of itself does so by rounding alone.
UPRIGHT = 1e-12
# The tension follows from the slack: where the ends are missed by more than this part of it, the table is too coarse.
# What is left has errors of up to 6 % in the tension (1,000 random lines), half of them below 0.1 %.
TELLING = 0.01


@dataclass(frozen=True)
class Options(Nodes):
    """Numerical options."""

    table_step: float = option(1.0, at_least=0.01, at_most=10.0, meaning="step of the table in degrees")


class Page(NamedTuple):
    """Functions at angles in degrees, all of one shape: (row,) for a page of the table."""

    angle: Array
    tau: Array
    sigma: Array
    xi: Array
    eta: Array

    def at(self, angle: Array | float) -> "Page":
        """Linear interpolation."""
        return Page(np.asarray(angle), *[np.asarray(np.interp(angle, self.angle, column)) for column in self[1:]])


NOTHING = Page(*np.full((5, 1), np.nan))


@dataclass(frozen=True)
class TableLine(SolvedLine):
    """Both ends, lowest and farthest point as read off the table; lengths in units of T_0 / K_n = `unit`."""

    unit: Array
    normal_drag: Array
    ends: tuple[Page, Page]
    right_angle: Page
    height: Array
    pages: list[Page | None]

    @property
    def position_B(self) -> Array:
        return self._position(self.ends[1])

    @property
    def force_B(self) -> Array:
        return self.force_of(self.ends[1])

    @property
    def max_tension(self) -> Array:
        return np.maximum(self.tension_A, self.tension_B)

    @property
    def lowest_point(self) -> Array:
        zero = np.zeros_like(self.unit)
        below = (self.ends[0].angle > 180.0)[:, None]
        return np.where(below, self._position(Page(zero + 180.0, zero + 1.0, zero, zero, zero)), 0.0)

    @property
    def farthest_point(self) -> Array:
        return self._position(self.right_angle)

    @property
    def closing_error(self) -> Array:
        """The distance of B from where it should be, and what the length lacks."""
        target = np.column_stack([np.zeros((self.height.size, 2)), self.height])
        length = self.unit * (self.ends[1].sigma - self.ends[0].sigma)
        return np.hypot(np.linalg.norm(self.position_B - target, axis=1), length - self.line_length)

    @cached_property
    def shape(self) -> tuple[Array, Array]:
        """Nodes at equal steps of angle, as the table has them."""
        angles = np.linspace(self.ends[0].angle, self.ends[1].angle, self.nodes, axis=1)
        read = [NOTHING.at(row) if page is None else page.at(row) for page, row in zip(self.pages, angles, strict=True)]
        points = Page(*(np.array(column) for column in zip(*read, strict=True)))
        along = [self._position(Page(*(column[:, i] for column in points))) for i in range(self.nodes)]
        return np.stack(along, axis=1), (self.normal_drag * self.unit)[:, None] * points.tau

    def force_of(self, end: Page) -> Array:
        """Force vector at an end."""
        tension, angle = self.normal_drag * self.unit * end.tau, np.radians(end.angle)
        return np.column_stack([-(tension * np.cos(angle))[:, None] * self.loads.direction, tension * np.sin(angle)])

    def _position(self, point: Page) -> Array:
        against, up = self.unit * (point.xi - self.ends[0].xi), self.unit * (point.eta - self.ends[0].eta)
        return np.column_stack([-against[:, None] * self.loads.direction, up])


def seconds_per_scenario(options: Options) -> float:
    return 4e-4 / options.table_step


def solve(p: Parameters, options: Options) -> Solution:
    usable = _usable(p)
    pages = _pages(p, options.table_step, usable)
    ends = [
        _read_ends(page, z / length) for page, z, length in zip(pages, p.position_B[:, 2], p.line_length, strict=True)
    ]
    first, last, right = (Page(*np.array([np.ravel(found[k]) for found in ends]).T) for k in range(3))
    with np.errstate(all="ignore"):
        unit = p.position_B[:, 2] / (last.eta - first.eta)
    line = TableLine(
        np.zeros((p.size, 3)),
        p.line_length,
        p.loads,
        options.nodes,
        unit,
        p.loads.normal_drag,
        (first, last),
        right,
        p.position_B[:, 2],
        pages,
    )
    line = replace(line, force_A=line.force_of(first))
    slack = p.line_length - np.linalg.norm(p.position_B, axis=1)
    found = np.where(line.closing_error <= TELLING * slack, Status.ok, Status.not_converged)
    status = np.where(
        usable, found, np.where(p.fate_of_ends == Status.infeasible, Status.infeasible, Status.out_of_domain)
    )
    return Solution(status.astype(np.int8), line)


def _usable(p: Parameters) -> np.ndarray:
    """Which lines the method can be asked for at all."""
    upright = np.linalg.norm(p.position_B[:, :2], axis=1) <= UPRIGHT * np.abs(p.position_B[:, 2])
    in_stream = (p.loads.normal_drag > 0.0) & (p.loads.lateral_drag == 0.0) & (p.weight_per_length > 0.0)
    return upright & in_stream & (p.position_B[:, 2] > 0.0) & (p.fate_of_ends == Status.ok)


def _pages(p: Parameters, step: float, usable: np.ndarray) -> list[Page | None]:
    """The page of the table for each line; none where it is of no use."""
    drag = np.where(usable, p.loads.normal_drag, 1.0)
    critical = critical_angle(np.where(usable, p.weight_per_length, 1.0), drag)
    lines = packed(critical, p.loads.tangential_drag / drag, p.friction_law)
    return [_page(critical[i], lines[i], step) if usable[i] else None for i in range(p.size)]


def _page(critical: float, line: Array, step: float) -> Page:
    """The functions at all multiples of the step inside the domain, from the reference angle of 180 deg."""
    limits = np.degrees(critical), 180.0 + np.degrees(critical)
    angle = step * np.arange(np.floor(limits[0] / step) + 1.0, np.ceil(limits[1] / step))
    lines = np.repeat(line[None], angle.size, axis=0)
    width = np.full(angle.size, critical)
    integrals = pode_integrals(logits(np.full(angle.size, np.pi), width), logits(np.radians(angle), width), lines)
    lengths = -np.cos(critical) * integrals[:, :TENSION].T
    return Page(angle, np.exp(integrals[:, TENSION]), lengths[LENGTH], lengths[HORIZONTAL], lengths[VERTICAL])


def _read_ends(page: Page | None, ratio: float) -> tuple[Page, Page, Page]:
    """A, B and the point at 90 deg, as the handbook reads them off the page; NaN where it does not hold them."""
    if page is None:
        return NOTHING, NOTHING, NOTHING
    half_steps = np.linspace(page.angle[0], page.angle[-1], 2 * page.angle.size - 1)
    trials = page.at(half_steps[half_steps <= 90.0])
    lower = page.angle >= 90.0
    at_first = page.at(np.interp(trials.xi, page.xi[lower], page.angle[lower], right=np.nan))
    found = (trials.eta - at_first.eta) / (trials.sigma - at_first.sigma)
    beyond = np.flatnonzero(found >= ratio)
    if not beyond.size or beyond[0] == 0 or not np.isfinite(found[beyond[0] - 1]):
        return NOTHING, NOTHING, NOTHING
    around = slice(beyond[0] - 1, beyond[0] + 1)
    first, last = (
        Page(*[np.asarray(np.interp(ratio, found[around], column[around])) for column in side])
        for side in (at_first, trials)
    )
    return first, last, page.at(90.0)
