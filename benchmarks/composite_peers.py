"""The other ways to a composite line: adapters of `cablesim.peers`, one line a call, and a reference in 30 digits."""

from typing import Any

import mpmath as mp
import numpy as np

from cablesim.numerics import Array
from cablesim.peers import fsolve_composite, moorpy_composite
from cablesim.peers.fsolve_composite import Reach

Line = dict[str, Any]

XTOL = 1e-10
DIGITS = 30
FAILED = np.full(2, np.nan)


def by_moorpy(line: Line, tolerance: float) -> Array:
    """Tensions at A and B, joints in balance to a tolerance in metres (0: MoorPy's own); NaN where it gives up."""
    try:
        found = moorpy_composite.end_tensions(line, tolerance)
    except Exception:
        # Whatever it raises, from its own errors to a singular matrix, it has not solved the line.
        return FAILED
    return np.array([found["tension_A"], found["tension_B"]])


def by_fsolve(line: Line, reach: Reach) -> Array:
    """Tensions at A and B; NaN where it says it failed."""
    try:
        found = fsolve_composite.by_fsolve(line, reach, XTOL)
    except ArithmeticError:
        return FAILED
    return FAILED if found is None else found


def by_brentq(line: Line) -> Array:
    """Tensions at A and B where H is given."""
    return fsolve_composite.by_brentq(line, XTOL)


def in_digits(line: Line, near: Array) -> Array:
    """Tensions at A and B in 30 digits, from the tensions nearby."""
    with mp.workdps(DIGITS):
        lengths, weights = ([mp.mpf(value) for value in line[name]] for name in ("section_length", "section_weight"))
        rise, weight = mp.mpf(line["rise"]), mp.fdot(lengths, weights)
        # T_B^2 - T_A^2 = (2 V_A + W) W
        vertical = 0.5 * ((near[1] - near[0]) * (near[1] + near[0]) / weight - weight)

        def reach(horizontal: mp.mpf, upward: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
            x = z = mp.mpf(0)
            for length, each in zip(lengths, weights, strict=True):
                slope, upward = upward / horizontal, upward + each * length
                x += horizontal / each * (mp.asinh(upward / horizontal) - mp.asinh(slope))
                z += horizontal / each * (mp.hypot(1, upward / horizontal) - mp.hypot(1, slope))
            return x, z

        if "horizontal_tension" in line:
            horizontal = mp.mpf(line["horizontal_tension"])
            vertical = mp.findroot(lambda v: reach(horizontal, v)[1] - rise, (vertical, vertical + weight * 1e-6))
        else:
            distance, start = mp.mpf(line["horizontal_distance"]), mp.sqrt(mp.mpf(near[0]) ** 2 - vertical**2)
            horizontal, vertical = mp.findroot(
                lambda *state: [a - b for a, b in zip(reach(*state), (distance, rise), strict=True)], (start, vertical)
            )
        return np.array([float(mp.hypot(horizontal, v)) for v in (vertical, vertical + weight)])
