"""Pode's functions: tension, length and distances along a plane line in a uniform stream, dimensionless.

    tau = T / T_0 = exp int (f_s + w sin a) / D da,   D = w cos a - sin a |sin a|                      (M11)
    sigma = K_n s / T_0 = int tau / D da,  xi = int tau cos a / D da,  eta = int tau sin a / D da

from the reference angle to `angle`; w = p / K_n = sin(a_c)^2 / cos(a_c) (M10), f = K_t / K_n. The angle is that of the
tangent above the direction of tow, so xi is counted against the stream. Drag normal to the line is sign-honest, as the
source's own example needs it; friction f_s is f sign(cos a), f cos a |cos a| or zero. The domain is a_c < a < a_c + 180
deg; at its ends the line is infinitely long. tau is in closed form, the other three are Gauss-Legendre integrals:
relative errors below 1e-12 in the domain, 1e-10 at 1e-6 rad from its ends.

Reference: L. Pode, Tables for computing the equilibrium configuration of a flexible cable in a uniform stream, David
Taylor Model Basin report 687, 1951.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cablesim.numerics import Array
from cablesim.parameters import Batch, NoOptions, parameter
from cablesim.physics.pode import PI_TAIL
from cablesim.physics.stream import FRICTION_LAWS, critical_angle
from cablesim.solver import Solution
from cablesim.solvers._pode_march import HORIZONTAL, LENGTH, TENSION, VERTICAL, logits, packed, pode_integrals
from cablesim.status import Status

OUTPUTS = ("tau", "sigma", "xi", "eta")
SECONDS_PER_SCENARIO = 3e-6
COMPILED = True


@dataclass(frozen=True)
class Parameters(Batch):
    """An angle of a line, and what decides its functions."""

    angle: Array = parameter(typical=(1.0, 3.5))
    critical_angle: Array = parameter(at_least=0.0, below=0.5 * np.pi, typical=(0.1, 1.4))
    weight_ratio: Array = parameter(at_least=0.0, typical=(1e-2, 1e2), instead_of="critical_angle")
    friction_ratio: Array = parameter(at_least=0.0, typical=(1e-3, 0.05))
    friction_law: np.ndarray = parameter(words=FRICTION_LAWS, default="constant")
    reference_angle: Array = parameter(typical=(1.5, 3.0), default=np.pi)


@dataclass(frozen=True)
class Functions:
    """The functions, from the integrals (scenario, 4) in units of T_0 / M; cosine is K_n / M."""

    integrals: Array
    cosine: Array

    @cached_property
    def tau(self) -> Array:
        return np.exp(self.integrals[:, TENSION])

    @property
    def sigma(self) -> Array:
        return -self.cosine * self.integrals[:, LENGTH]

    @property
    def xi(self) -> Array:
        return -self.cosine * self.integrals[:, HORIZONTAL]

    @property
    def eta(self) -> Array:
        return -self.cosine * self.integrals[:, VERTICAL]


def solve(p: Parameters, options: NoOptions) -> Solution:
    critical, tail, cosine = _critical(p)
    start, end = logits(p.reference_angle, critical, tail), logits(p.angle, critical, tail)
    inside = np.isfinite(start) & np.isfinite(end)
    start, end = np.where(inside, start, 0.0), np.where(inside, end, 0.0)
    integrals = pode_integrals(start, end, packed(critical, p.friction_ratio, p.friction_law, tail))
    status = np.where(inside, Status.ok, Status.out_of_domain).astype(np.int8)
    return Solution(status, Functions(integrals, cosine))


def _critical(p: Parameters) -> tuple[Array, Array, Array]:
    """The critical angle, what its float leaves out, and its cosine, exact for any given weight ratio."""
    if p.critical_angle is not None:
        return p.critical_angle, np.zeros(p.size), np.cos(p.critical_angle)
    half = 0.5 * p.weight_ratio
    cosine = 1.0 / (np.hypot(1.0, half) + half)
    angle = critical_angle(p.weight_ratio, np.ones(p.size))
    tail = (0.5 * np.pi - angle) + 0.5 * PI_TAIL - np.arcsin(cosine)
    return angle, np.where(cosine < np.sqrt(0.5), tail, 0.0), cosine
