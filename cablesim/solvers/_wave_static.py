"""Equilibrium of a line of straight elastic elements between two fixed points, in still water or a uniform stream.

First under a uniform load (`_wave_uniform`), with that of an element across the stream for the drag; then with the drag
itself (`_wave_drag`). Never by marching through time.

In a stream there may be no equilibrium, or several; a line is INFEASIBLE if the one that is found needs more than the
greatest tension of its law. A slack line without load is in equilibrium in any shape; its answer is the limit of small
weight, without tension.
"""

from dataclasses import dataclass

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.compiled import compiled
from cablesim.solvers._wave_drag import ELEMENT_SIZE, LOAD_SIZE, NODE_SIZE, dragged_line, left_over, loads
from cablesim.solvers._wave_uniform import LINEAR, QUADRATIC, UX, UZ, norm, strain_of, uniform_line

SOLVED, INFEASIBLE, NOT_CONVERGED, NOT_FINITE = range(4)
# Stiffness that nothing stretches, in loads of an element.
RIGID = 1e100
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class StaticLines:
    """Lines in equilibrium, by scenario; NaN where `fate` is not SOLVED.

    `position` (scenario, node, 3) from A, `tension` (scenario, element), `residual` the largest force left over on a
    node over the largest tension, `mismatch` the largest difference, over its length, between the length of an element
    and what its tension stretches it to.
    """

    position: Array
    tension: Array
    residual: Array
    mismatch: Array
    fate: np.ndarray
    steps: np.ndarray


def static_lines(
    end: Array,
    line_length: Array,
    segments: int,
    weight_per_length: Array,
    linear_stiffness: Array,
    quadratic_stiffness: Array,
    normal_drag: Array,
    tangential_drag: Array,
    stream: Array,
) -> StaticLines:
    """Equilibrium of lines from the origin to `end` (scenario, 3) in streams (scenario, 3); all else (scenario,).

    The weight is less buoyancy, the drags are per speed squared and unstretched length. z is up.
    """
    element = line_length / segments
    packed, force = _packed(
        end / element[:, None],
        element,
        weight_per_length,
        linear_stiffness,
        quadratic_stiffness,
        np.column_stack([normal_drag, tangential_drag]),
        stream,
        segments,
    )
    size = element.size
    position, tension = np.empty((size, segments + 1, 3)), np.empty((size, segments))
    measures, fate, steps = np.empty((size, 2)), np.empty(size, dtype=np.int64), np.zeros(size, dtype=np.int64)
    _lines(packed, position, tension, measures, fate, steps)
    position *= element[:, None, None]
    position[fate == SOLVED, -1] = end[fate == SOLVED]
    tension *= force[:, None]
    return StaticLines(position, tension, measures[:, 0], measures[:, 1], fate, steps)


def _packed(
    end: Array,
    element: Array,
    weight: Array,
    linear: Array,
    quadratic: Array,
    drag: Array,
    stream: Array,
    segments: int,
) -> tuple[Array, Array]:
    """Rows in units of the element's length and a force; and that force, 0 for slack lines without load."""
    speed = np.sqrt((stream**2).sum(axis=1))
    load = (drag.max(axis=1) * speed)[:, None] * stream - weight[:, None] * UP
    size = np.sqrt((load**2).sum(axis=1))
    loaded, loose = size != 0.0, (end**2).sum(axis=1) < segments**2
    force = np.where(loaded, size * element, np.where(loose, 0.0, linear))
    # Without load the unit is the stiffness; slack lines get a weight that does not stretch them.
    unit = np.where(loaded, size, linear / element)
    shapeless = ~loaded & loose
    load = np.where(shapeless[:, None], -UP, load / unit[:, None])
    weight = np.where(shapeless, 1.0, weight / unit)
    linear, quadratic = linear / (unit * element), quadratic / (unit * element)
    linear, quadratic = np.where(shapeless, RIGID, linear), np.where(shapeless, 0.0, quadratic)
    return np.column_stack([end, stream, weight, load, drag / unit[:, None], linear, quadratic]), force


@compiled
def _lines(packed, position, tension, measures, fate, steps):
    n = tension.shape[1]
    vectors, forces, legs = np.empty((n, 3)), np.empty((n, LOAD_SIZE)), np.empty(n + 1)
    elements, nodes = np.empty((n, ELEMENT_SIZE)), np.empty((n, NODE_SIZE))
    for i in range(packed.shape[0]):
        line = packed[i]
        fate[i] = NOT_FINITE
        if np.isfinite(line.sum()) and line[LINEAR] > 0.0:
            good, steps[i] = uniform_line(line, vectors, tension[i], legs)
            if good and norm(line[UX : UZ + 1]) > 0.0:
                good, more = dragged_line(line, vectors, tension[i], forces, elements, nodes)
                steps[i] += more
            fate[i] = _finish(line, vectors, tension[i], forces, position[i], measures[i]) if good else NOT_CONVERGED
        if fate[i] != SOLVED:
            position[i], tension[i], measures[i] = np.nan, np.nan, np.nan


@compiled
def _finish(line, vectors, tension, forces, position, measures):
    """Nodes and what is left over; INFEASIBLE if an element pulls more than its law can."""
    n = tension.size
    loads(line, vectors, 1.0, forces)
    largest, left, mismatch = 0.0, 0.0, 0.0
    position[0] = 0.0
    for e in range(n):
        pull = max(tension[e], 0.0)
        length = norm(vectors[e])
        if 1.0 + 4.0 * line[QUADRATIC] * pull / line[LINEAR] ** 2 < 0.0:
            return INFEASIBLE
        largest = max(largest, pull)
        if pull > 0.0:
            strain, _ = strain_of(pull, line[LINEAR], line[QUADRATIC])
            mismatch = max(mismatch, abs(length - 1.0 - strain) / length)
        if e > 0:
            left = max(left, left_over(vectors, tension, forces, e))
        for k in range(3):
            position[e + 1, k] = position[e, k] + vectors[e, k]
        tension[e] = pull
    measures[0], measures[1] = left / largest if largest > 0.0 else 0.0, mismatch
    return SOLVED
