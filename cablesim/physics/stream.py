"""Loads on a line in a uniform stream and the equations of its equilibrium (docs/models.md, M10, M12, M13).

Frame: z up, the stream horizontal along the unit vector e; t is the tangent from A to B, F = T t the force vector, s
the arc length from A. With c = t.e and e_p = e - c t, of length sin(angle between line and stream),

    dr/ds = t,   dF/ds = -q,   q = K_n |e_p| e_p + K_t g(c) t + K_b (0.4 - 0.3 c^2) c (t x e) - p z          (M12, M13)

K_n = C_n rho V^2 d / 2, K_t = C_t rho V^2 d / 2, K_b = 2 pi tan(lay angle) rho V^2 d / 2; p is the submerged weight per
length, counted once. The friction law g is sign(c), c |c| or zero.
"""

from dataclasses import dataclass, replace

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.compiled import compiled

FRICTION_LAWS = ("constant", "cosine_squared", "zero")
CONSTANT, COSINE_SQUARED, ZERO = range(3)
# Columns of the packed loads, as the kernels read them.
KN, KT, KB, EX, EY, QX, QY, QZ = range(8)
# Parts of a state: force, position, d(force)/d(force at the start), d(position)/d(force at the start).
FORCE, POSITION, PLAIN, FULL = 0, 3, 6, 24


@dataclass(frozen=True)
class StreamLoads:
    """Loads per length of many lines; all arrays of shape (scenario,), `steady` (scenario, 3).

    `steady` is the part of the load that does not depend on the direction of the line: its weight, pointing down.
    """

    normal_drag: Array
    tangential_drag: Array
    lateral_drag: Array
    direction: Array
    steady: Array
    friction_law: np.ndarray

    @property
    def packed(self) -> Array:
        """One row a line, in the order of the columns above."""
        columns = (self.normal_drag, self.tangential_drag, self.lateral_drag, *self.direction.T, *self.steady.T)
        return np.ascontiguousarray(np.column_stack(columns))

    @property
    def magnitude(self) -> Array:
        """A load per length that none of the parts exceeds in sum."""
        steady = np.hypot.reduce(self.steady, axis=1)
        return steady + self.normal_drag + self.tangential_drag + np.abs(self.lateral_drag)

    def take(self, which: np.ndarray) -> "StreamLoads":
        """Some of the lines."""
        return StreamLoads(*(getattr(self, name)[which] for name in self.__dataclass_fields__))

    def on_straight_line(self, tangent: Array) -> Array:
        """The load per length on straight lines of unit tangents (scenario, 3), as vectors."""
        loads = np.empty_like(tangent)
        _loads(tangent, self.packed, self.friction_law, loads)
        return loads

    @property
    def trailing_direction(self) -> Array:
        """Tangent (scenario, 3) of a line that trails freely from B: the critical angle, up or down with its weight."""
        weight = -self.steady[:, 2]
        angle = critical_angle(np.abs(weight), self.normal_drag)
        along = -np.cos(angle)[:, None] * self.direction
        return np.column_stack([along, np.where(weight < 0.0, -1.0, 1.0) * np.sin(angle)])

    def blended(self, uniform: Array, share: Array) -> "StreamLoads":
        """`share` of these loads and the rest of the given uniform ones: share 1 is the line itself."""
        steady = share[:, None] * self.steady + (1.0 - share)[:, None] * uniform
        drags = (share * self.normal_drag, share * self.tangential_drag, share * self.lateral_drag)
        return replace(self, normal_drag=drags[0], tangential_drag=drags[1], lateral_drag=drags[2], steady=steady)


def stream_loads(
    weight_per_length: Array,
    diameter: Array,
    normal_drag_coefficient: Array,
    tangential_drag_coefficient: Array,
    friction_law: np.ndarray,
    lay_angle: Array,
    fluid_density: Array,
    stream_speed: Array,
    heading: Array,
) -> StreamLoads:
    """Loads from the properties of line and stream, all in SI and of shape (scenario,)."""
    pressure = 0.5 * fluid_density * stream_speed**2 * diameter
    steady = np.zeros((weight_per_length.size, 3))
    steady[:, 2] = -weight_per_length
    return StreamLoads(
        normal_drag_coefficient * pressure,
        np.where(friction_law == ZERO, 0.0, tangential_drag_coefficient * pressure),
        2.0 * np.pi * np.tan(lay_angle) * pressure,
        np.column_stack([np.cos(heading), np.sin(heading)]),
        steady,
        friction_law,
    )


def critical_angle(weight: Array, normal_drag: Array) -> Array:
    """Angle above the direction of tow at which the weight balances the normal drag; weight and drag per length >= 0.

    cos(a) = sqrt(1 + (w/2)^2) - w/2, w = weight / normal_drag (M10), written for the small of cos and 1 - cos.
    """
    half = 0.5 * weight
    root = np.hypot(half, normal_drag)
    with np.errstate(divide="ignore", invalid="ignore"):
        tangent = np.sqrt(weight * (root + half)) / normal_drag
    return np.where(weight > 0.0, np.arctan(np.where(normal_drag > 0.0, tangent, np.inf)), 0.0)


@compiled
def _loads(tangents, packed, laws, loads):
    for i in range(tangents.shape[0]):
        t = tangents[i]
        c = t[0] * packed[i, EX] + t[1] * packed[i, EY]
        load(t[0], t[1], t[2], packed[i], laws[i], 1.0 if c >= 0.0 else -1.0, loads[i])


@compiled
def load(tx, ty, tz, line, law, side, q):
    """q of a line of unit tangent t into `q`; `side` is the sign of c that the friction law is to take."""
    ex, ey = line[EX], line[EY]
    c = tx * ex + ty * ey
    px, py, pz = ex - c * tx, ey - c * ty, -c * tz
    normal = line[KN] * np.sqrt(px * px + py * py + pz * pz)
    along = line[KT] * friction(c, law, side)
    lateral = line[KB] * (0.4 - 0.3 * c * c) * c
    q[0] = normal * px + along * tx - lateral * tz * ey + line[QX]
    q[1] = normal * py + along * ty + lateral * tz * ex + line[QY]
    q[2] = normal * pz + along * tz + lateral * (tx * ey - ty * ex) + line[QZ]


@compiled
def friction(c, law, side):
    """g(c) with the sign of c held at `side`, so that it is smooth on either side of a right angle."""
    if law == CONSTANT:
        return side
    if law == COSINE_SQUARED:
        return side * c * c
    return 0.0


@compiled
def rates(y, dy, line, law, side, size):
    """d/ds of the state `y` into `dy`: force and position, and with size FULL their derivatives by the first force."""
    fx, fy, fz = y[0], y[1], y[2]
    tension = np.sqrt(fx * fx + fy * fy + fz * fz)
    tx, ty, tz = fx / tension, fy / tension, fz / tension
    load(tx, ty, tz, line, law, side, dy)
    dy[0], dy[1], dy[2] = -dy[0], -dy[1], -dy[2]
    dy[3], dy[4], dy[5] = tx, ty, tz
    if size == FULL:
        _rates_of_derivatives(y, dy, tx, ty, tz, tension, line, law, side)


@compiled
def _rates_of_derivatives(y, dy, tx, ty, tz, tension, line, law, side):
    """Columns Phi = dF/dF_0 and R = dr/dF_0: Phi' = -(dq/dt) u, R' = u, with u = (1 - t t^T) Phi / T the turn of t."""
    ex, ey, kn = line[EX], line[EY], line[KN]
    c = tx * ex + ty * ey
    px, py, pz = ex - c * tx, ey - c * ty, -c * tz
    sine = np.sqrt(px * px + py * py + pz * pz)
    along = line[KT] * friction(c, law, side)
    along_slope = 2.0 * line[KT] * side * c if law == COSINE_SQUARED else 0.0
    lateral = line[KB] * (0.4 - 0.3 * c * c) * c
    lateral_slope = line[KB] * (0.4 - 0.9 * c * c)
    # dq = b dc + by_t dt + lateral (dt x e), with dc = e.dt; c / sine is harmless because p is as small as sine.
    ratio = kn * c / sine if sine > 0.0 else 0.0
    by_t = along - kn * sine * c
    by_tangent = along_slope - kn * sine
    bx = -ratio * px + by_tangent * tx - lateral_slope * tz * ey
    by = -ratio * py + by_tangent * ty + lateral_slope * tz * ex
    bz = -ratio * pz + by_tangent * tz + lateral_slope * (tx * ey - ty * ex)
    for k in range(3):
        x, z, v = y[6 + k], y[12 + k], y[9 + k]
        stretch = tx * x + ty * v + tz * z
        ux, uy, uz = (x - stretch * tx) / tension, (v - stretch * ty) / tension, (z - stretch * tz) / tension
        turn = ux * ex + uy * ey
        dy[6 + k] = -(bx * turn + by_t * ux - lateral * uz * ey)
        dy[9 + k] = -(by * turn + by_t * uy + lateral * uz * ex)
        dy[12 + k] = -(bz * turn + by_t * uz + lateral * (ux * ey - uy * ex))
        dy[15 + k], dy[18 + k], dy[21 + k] = ux, uy, uz
