"""What lines that march side by side keep: state, numbers of the step, and what each lane knows of its scenario."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.compiled import compiled
from cablesim.numerics.lanes import LANES
from cablesim.physics.nodal_line import ELEMENT_ROWS, FREE_ELEMENT, FREE_NODE, HELD, LINE_ROWS, NODE_ROWS
from cablesim.physics.waves import FLUID_SIZE, MOTION_SIZE, TOP_SIZE, WAVE_SIZE

# What a node needs beside its motion: q, q of the last step as this step needs it, motion and q after the last step.
# (The method says what q is.)
SHIFTED = FREE_NODE
START_SHIFTED = FREE_NODE + 3
OLD_PLACE = FREE_NODE + 6
OLD_VELOCITY = FREE_NODE + 9
OLD_ACCELERATION = FREE_NODE + 12
OLD_SHIFTED = FREE_NODE + 15

# Of an element: tension and strain at the end of the step, tension after the last three, and what is recorded.
NEW = HELD
(
    NEW_STRAIN,
    PAST1,
    PAST2,
    PAST3,
    LARGEST,
    LEAST,
    SLACK_TIME,
    WAS_SLACK,
    SNAPS,
    LARGEST_STRAIN,
    DISTANCE,  # of the new tension from the parabola through the last three
) = range(FREE_ELEMENT, FREE_ELEMENT + 11)

# Numbers of the method for one step; `assemble` reads the first two.
(
    VELOCITY_BY_PLACE,
    ACCELERATION_BY_PLACE,
    STEP,
    PLACE_NEW,  # factors of q' and q in the new place, velocity and acceleration
    PLACE_OLD,
    VELOCITY_NEW,
    VELOCITY_OLD,
    ACCELERATION_NEW,
    ACCELERATION_OLD,
    ACCELERATION_PAST,  # factor of the old acceleration in the new one
    RESCALED,  # theta h of this step over that of the last
    RELAGGED,  # factor in the old velocity of what the old q is more than the old acceleration
    PLACE_DEFECT,  # error of the place over the change of q
    EXTRAPOLATED1,  # factors of the last three tensions in what they lead to
    EXTRAPOLATED2,
    EXTRAPOLATED3,
    TENSION_DEFECT,  # error of a tension over its distance from that
    ACTIVE,  # 1 while Newton's method goes on
    METHOD_ROWS,
) = range(19)

# What a lane knows.
(
    SCENARIO,  # -1 where there is none left
    TIME,
    NEXT_STEP,
    LAST_STEP,
    STEP_BEFORE,
    SHIFT_TIME,  # theta h of the last step
    RHO,  # of the line while it is taut
    TENSION_SCALE,
    PLACE_SCALE,
    END,
    WINDOW,
    PERIOD,
    SLACK_UNTIL,
    CORRECTION,  # largest of the last iteration, in tolerances
    CONVERGED,
    LARGEST_SHIFT,  # of a tension, in the last iteration
    LARGEST_MISS,  # tension by which an element passed through zero in it
    LARGEST_MOVE,
    ALL_MOVES,
    POWER_IN,  # of all forces that have no potential, the top end's aside
    TENSION_ERROR,
    PLACE_ERROR,
    SLACK_NOW,
    ACCEPTED,
    BEGUN,  # by the clock
    BEYOND,  # 1 once a softening law has been stretched beyond its greatest tension
    STEPS,
    REJECTED,
    EVALUATIONS,
    ANCHOR_NOW,  # end forces, tension in the middle and all power at the end of the step
    MIDDLE_NOW,
    TOP_NOW,
    POWER_NOW,
    POWER_TURNED,  # of the top end and of the rest, each without its sign
    LANE_ROWS,
) = range(35)


# How a scenario ends.
SOLVED, GAVE_UP, OUT_OF_STEPS, BEYOND_LAW, UNBALANCED, OUT_OF_TIME = 0.0, 1.0, 2.0, 3.0, 4.0, 5.0


class Problem(NamedTuple):
    """Scenarios: packed rows of lines, motions of the top end and waves, and the equilibrium they start from.

    `starts` has shape (scenario, node, 3), `tensions` (scenario, element), `supports` (scenario, 3): tension at anchor,
    middle and top; `spans` (scenario, 3): duration, beginning of the window, period; `scales` (scenario, 2): tension
    and place that tolerances are relative to.
    """

    lines: np.ndarray
    motions: np.ndarray
    waves: np.ndarray
    starts: np.ndarray
    tensions: np.ndarray
    supports: np.ndarray
    spans: np.ndarray
    scales: np.ndarray


@dataclass(frozen=True)
class Marched:
    """Fate, steps, rejected steps and evaluations of each scenario (scenario,), and what was recorded."""

    fate: Array
    steps: Array
    rejected: Array
    evaluations: Array
    records: "Records"


class Records(NamedTuple):
    """Written by the march, one row a scenario; the last four are empty unless histories are asked for.

    `ends` (scenario, 3, 3): largest, least and mean tension of anchor, middle and top; `line` (scenario, 5): slack
    fraction, snaps, largest strain, energy error, spread of periods; `extremes` (scenario, element, 2): largest and
    least tension; `history` (scenario, time, 3); `orbit` (scenario, phase, 3); `shapes` (scenario, phase, node, 3);
    `pulls` (scenario, phase, element).
    """

    ends: np.ndarray
    line: np.ndarray
    extremes: np.ndarray
    history: np.ndarray
    orbit: np.ndarray
    shapes: np.ndarray
    pulls: np.ndarray


class Pack(NamedTuple):
    """Flat arrays, the lane last."""

    nodes: np.ndarray
    elements: np.ndarray
    method: np.ndarray
    lane: np.ndarray
    line: np.ndarray
    motion: np.ndarray
    wave: np.ndarray
    fluid: np.ndarray
    points: np.ndarray
    top: np.ndarray
    carry: np.ndarray
    times: np.ndarray


@compiled
def make_pack(count):
    """Room for lines of so many elements; no lane has a scenario."""
    lane = np.zeros(LANE_ROWS * LANES)
    lane[SCENARIO * LANES : (SCENARIO + 1) * LANES] = -1.0
    nodes = np.zeros((count + 1) * NODE_ROWS * LANES)
    # An empty lane computes as well: with a line of unit length and mass it does so without NaN.
    return Pack(
        nodes,
        np.zeros(count * ELEMENT_ROWS * LANES),
        np.ones(METHOD_ROWS * LANES),
        lane,
        np.ones(LINE_ROWS * LANES),
        np.zeros(MOTION_SIZE * LANES),
        np.ones(WAVE_SIZE * LANES),
        np.zeros(count * FLUID_SIZE * LANES),
        np.zeros(count * 3 * LANES),
        np.zeros(TOP_SIZE * LANES),
        np.zeros(9 * LANES),
        np.zeros(LANES),
    )


@compiled
def put(flat, w, row):
    """A row of numbers into a lane."""
    for k in range(row.size):
        flat[k * LANES + w] = row[k]


@compiled
def load_state(pack, w, scenario, problem):
    """A lane begins a scenario at rest in its equilibrium, where it has always been."""
    put(pack.line, w, problem.lines[scenario])
    put(pack.motion, w, problem.motions[scenario])
    put(pack.wave, w, problem.waves[scenario])
    for j in range(problem.starts.shape[1]):
        node = pack.nodes[NODE_ROWS * LANES * j : NODE_ROWS * LANES * (j + 1)]
        for row in range(NODE_ROWS):
            node[row * LANES + w] = 0.0
        for k in range(3):
            node[k * LANES + w] = problem.starts[scenario, j, k]
            node[(OLD_PLACE + k) * LANES + w] = problem.starts[scenario, j, k]
    for e in range(problem.tensions.shape[1]):
        element = pack.elements[ELEMENT_ROWS * LANES * e : ELEMENT_ROWS * LANES * (e + 1)]
        for row in range(ELEMENT_ROWS):
            element[row * LANES + w] = 0.0
        for row in (NEW, PAST1, PAST2, PAST3):
            element[row * LANES + w] = problem.tensions[scenario, e]
    for row in range(LANE_ROWS):
        pack.lane[row * LANES + w] = 0.0
    pack.lane[SCENARIO * LANES + w] = scenario
    pack.lane[END * LANES + w] = problem.spans[scenario, 0]
    pack.lane[WINDOW * LANES + w] = problem.spans[scenario, 1]
    pack.lane[PERIOD * LANES + w] = problem.spans[scenario, 2]
    pack.lane[TENSION_SCALE * LANES + w] = problem.scales[scenario, 0]
    pack.lane[PLACE_SCALE * LANES + w] = problem.scales[scenario, 1]
