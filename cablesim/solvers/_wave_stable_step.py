"""The longest fixed step of an explicit integrator with which a slightly disturbed line stays near its place at rest.

Found by trying: the step is marched, not computed. Every node of a line at rest is displaced a little at random and the
top end held; with a step that is too long the fastest vibration grows exponentially, far beyond the disturbance within
STEPS. As many steps as there are lanes are tried side by side, then as many between the longest that stays bounded and
the next one, until these are the same within WITHIN. Nothing but the length of the step is different from `wave_line`:
the same kernels march the line.
"""

import math

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.compiled import compiled
from cablesim.numerics.lanes import LANES
from cablesim.physics.nodal_line import NODE_ROWS, OTHER_SHARE, PIECE, PLACE
from cablesim.solvers._wave_explicit import evaluate, load, take_stages
from cablesim.solvers._wave_explicit_judge import OWN_ROWS
from cablesim.solvers._wave_explicit_step import leap
from cablesim.solvers._wave_forces import FOUND_ROWS
from cablesim.solvers._wave_pack import STEP, Problem, make_pack
from cablesim.solvers._wave_record import TALLY_ROWS

# One part in a hundred beyond the stable step the fastest vibration grows by e^70 (leapfrog) or e^18 (rk4) in so many
# steps; at it and below, it stays within the disturbance. Where it is strongly damped it grows by e^5 in two parts in a
# hundred: steps of such lines are found as much too long.
# What is light and hardly stretches drifts across by a dozen disturbances meanwhile, which is no growth.
STEPS, GROWTH = 250, 100.0
# The disturbance over what the least taut element is stretched by, so that none goes slack, and at least over the
# length of the line: places of nodes are rounded.
OF_STRETCH, OF_LENGTH = 1e-3, 1e-14
# Steps that are tried first, around the one that linear theory has, over it; how near the last two are; and how often
# a set of steps is tried.
AROUND, WITHIN, MOST_ROUNDS = 4.0, 1e-3, 8


def stable_steps(problem: Problem, guess: Array, is_leapfrog: bool) -> Array:
    """The longest stable step of each line, found from a guess (scenario,); NaN where none is found."""
    held = problem._replace(motions=np.zeros_like(problem.motions))
    pattern = np.random.default_rng(0).standard_normal(problem.starts.shape[1:])
    return np.array([_stable_step(held, i, guess[i], pattern, is_leapfrog) for i in range(guess.size)])


def _stable_step(problem: Problem, scenario: int, guess: float, pattern: Array, is_leapfrog: bool) -> float:
    disturbance = _size(problem, scenario) * pattern
    shortest, longest = guess / AROUND, guess * AROUND
    for _ in range(MOST_ROUNDS):
        steps = np.geomspace(shortest, longest, LANES)
        is_bounded = distances(problem, scenario, steps, disturbance, is_leapfrog) <= GROWTH * np.abs(disturbance).max()
        good = LANES if is_bounded.all() else int(np.argmin(is_bounded))
        if good == LANES:
            shortest, longest = longest, longest * AROUND**2
        elif good == 0:
            shortest, longest = shortest / AROUND**2, shortest
        else:
            shortest, longest = steps[good - 1], steps[good]
            if longest - shortest <= WITHIN * longest:
                return shortest
    return math.nan


def _size(problem: Problem, scenario: int) -> float:
    """How far nodes are moved."""
    piece = problem.lines[scenario, PIECE]
    lengths = np.linalg.norm(np.diff(problem.starts[scenario], axis=0), axis=1)
    stretch = lengths[lengths > piece] - piece
    return max(OF_STRETCH * stretch.min(initial=piece), OF_LENGTH * piece * lengths.size)


def distances(problem: Problem, scenario: int, steps: Array, disturbance: Array, is_leapfrog: bool) -> Array:
    """How far the farthest node is from its place at rest in the end, for each step; NaN where a place is none."""
    nodes = march(problem, scenario, steps, disturbance, is_leapfrog).reshape(-1, NODE_ROWS, LANES)
    moved = nodes[:, PLACE : PLACE + 3] - problem.starts[scenario][:, :, None]
    return np.linalg.norm(moved, axis=1).max(axis=0)


@compiled
def march(problem, scenario, steps, disturbance, is_leapfrog):
    """The nodes of a line after STEPS steps of a length of its own in each lane, moved by (node, 3) at first."""
    count = problem.tensions.shape[1]
    pack, tally = make_pack(count), np.zeros(TALLY_ROWS * LANES)
    found, own = np.zeros(FOUND_ROWS * LANES), np.ones(OWN_ROWS * LANES)
    is_lumped = problem.lines[scenario, OTHER_SHARE] == 0.0
    for w in range(LANES):
        load(pack, tally, own, w, scenario, problem, count, 0.0)
        for j in range(1, count):
            for k in range(3):
                pack.nodes[(NODE_ROWS * j + PLACE + k) * LANES + w] += disturbance[j, k]
    evaluate(pack, own, found, 1.0, False, is_lumped, count, LANES)
    last = np.zeros(LANES)
    pack.method[STEP * LANES : (STEP + 1) * LANES] = steps
    for _ in range(STEPS):
        if is_leapfrog:
            leap(pack.nodes, pack.method, last, count, LANES)
        else:
            take_stages(pack, own, found, False, is_lumped, count, LANES)
        evaluate(pack, own, found, 1.0, False, is_lumped, count, LANES)
        last[:] = steps
    return pack.nodes
