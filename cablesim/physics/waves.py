"""Plane progressive waves in water of finite depth, and the motion that they give to the top end of a line (M16-M18).

Frame: z up, still water level z = 0; the waves travel along (cos heading, sin heading), s is the horizontal distance
along it from the top end at rest. With the amplitude a, theta = omega t - k s and the ramp R(t),

    omega^2 = g k tanh(k d),    eta = a R sin(theta),    z' = (z - eta) d / (d + eta),                             (W1)
    u = a R omega cosh(k (z' + d)) / sinh(k d) sin(theta),    w = a R omega sinh(k (z' + d)) / sinh(k d) cos(theta),

z' being the height in still water that Wheeler's stretching gives to a point; it is held between bottom and surface.
The acceleration is the local one, d/dt at a fixed place and fixed z'. A uniform stream is added to the velocity.

The top end moves by R(t) (c cos(omega t) + s sin(omega t)) with vectors c and s: an ellipse, the orbit of a particle of
the surface, or rest. R is 10 x^3 - 15 x^4 + 6 x^5 with x = t / ramp up to 1: smooth in position, velocity and
acceleration.

The kernels take scenarios in lanes: entry k of lane w of a flat array is at k * LANES + w.
"""

from dataclasses import dataclass

import numpy as np

from cablesim.numerics import Array
from cablesim.numerics.compiled import compiled
from cablesim.numerics.elementary import exponential, sine_cosine
from cablesim.numerics.lanes import LANES

GRAVITY = 9.80665
NEWTON_STEPS = 4
# Power in the approximation of k d that Newton starts from, within 0.8 % everywhere (Guo 2002, Coastal Eng. 45, 71).
GUO = 2.4908

# Packed motion of the top end: angular frequency, the ramp x = START + RATE t, the vectors c and s.
OMEGA, START, RATE, C, S = 0, 1, 2, 3, 6
MOTION_SIZE = 9
# What `top_motion` writes: three components each.
OFFSET, VELOCITY, ACCELERATION = 0, 3, 6
TOP_SIZE = 9

# Packed waves, the first three as above: k times the direction, k times the way from the origin to s = 0, k, d, a,
# a omega / (1 - exp(-2 k d)), exp(-2 k d), direction, stream.
KX, KY, ORIGIN, NUMBER, DEPTH, AMPLITUDE, SPEED, BOTTOM, COSINE, SINE, STREAM_X, STREAM_Y = range(3, 15)
# Where `fluid_at` keeps omega t, R and R' of its lanes.
PHASE, RAMP, RAMP_RATE = 15, 16, 17
WAVE_SIZE = 18
# What `fluid_at` writes for a point: velocity and local acceleration.
FLUID_SIZE = 6
# exp(-|x|) beyond this is nothing beside 1, and exp(-2 k d) over it still a number.
DEEPEST = 350.0
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Waves:
    """Waves of many scenarios, arrays of shape (scenario,); amplitude 0 is still water."""

    amplitude: Array
    period: Array
    depth: Array
    heading: Array

    @property
    def omega(self) -> Array:
        return 2.0 * np.pi / self.period

    @property
    def number(self) -> Array:
        """k."""
        return wave_number(self.omega, self.depth)

    def packed(self, ramp: Array, top: Array, stream_speed: Array) -> Array:
        """One row a scenario, of WAVE_SIZE columns; `top` (scenario, 3) is the top end at rest, where s = 0."""
        k, cosine, sine = self.number, np.cos(self.heading), np.sin(self.heading)
        speed = -self.amplitude * self.omega / np.expm1(-2.0 * k * self.depth)
        wave = (self.depth, self.amplitude, speed, np.exp(-2.0 * k * self.depth))
        origin = k * (cosine * top[:, 0] + sine * top[:, 1])
        place = (k * cosine, k * sine, origin, k)
        stream = (cosine, sine, stream_speed * cosine, stream_speed * sine)
        now = np.zeros((3, k.size))
        return np.column_stack([self.omega, *ramp_line(ramp), *place, *wave, *stream, *now])


def wave_number(omega: Array, depth: Array) -> Array:
    """k of omega^2 = g k tanh(k d), relative error 1e-15 in shallow and deep water."""
    y = omega * omega * depth / GRAVITY
    x = y * (-np.expm1(-(np.sqrt(y) ** GUO))) ** (-1.0 / GUO)
    for _ in range(NEWTON_STEPS):
        slope = np.tanh(x)
        x = x - (x * slope - y) / (slope + x * (1.0 - slope * slope))
    return x / depth


def m18_amplitude(period: Array) -> Array:
    """Amplitude of the top end by the wave period, A = 0.085 exp(0.75 ln(g T^2 / 2 pi)) in metres (M18)."""
    return 0.085 * (GRAVITY * period**2 / (2.0 * np.pi)) ** 0.75


def ellipse_vectors(
    amplitude: Array, heading: Array, motion_angle: Array, axis_ratio: Array, motion_phase: Array
) -> tuple[Array, Array]:
    """c and s (scenario, 3) of A [sin(omega t + phase) e1 + axis_ratio cos(omega t + phase) e2]; amplitude 0 is rest.

    e1 is the heading turned upwards by the motion angle, e2 the vertical turned backwards by it.
    """
    along, cosine, sine = _along(heading), np.cos(motion_angle)[:, None], np.sin(motion_angle)[:, None]
    major = amplitude[:, None] * (cosine * along + sine * UP)
    minor = (amplitude * axis_ratio)[:, None] * (cosine * UP - sine * along)
    cosine, sine = np.cos(motion_phase)[:, None], np.sin(motion_phase)[:, None]
    return sine * major + cosine * minor, cosine * major - sine * minor


def surface_vectors(waves: Waves) -> tuple[Array, Array]:
    """c and s (scenario, 3) of a particle of the surface: a [-coth(k d) cos(omega t) along, sin(omega t) up]."""
    width = waves.amplitude / np.tanh(waves.number * waves.depth)
    return -width[:, None] * _along(waves.heading), waves.amplitude[:, None] * UP


def packed_motion(omega: Array, ramp: Array, c: Array, s: Array) -> Array:
    """One row a scenario, of MOTION_SIZE columns."""
    return np.column_stack([omega, *ramp_line(ramp), c, s])


def _along(heading: Array) -> Array:
    return np.column_stack([np.cos(heading), np.sin(heading), np.zeros_like(heading)])


def ramp_line(ramp: Array) -> tuple[Array, Array]:
    """START and RATE of a ramp of so many seconds; of none, R = 1 at once."""
    with np.errstate(divide="ignore"):
        return np.where(ramp > 0.0, 0.0, 1.0), np.where(ramp > 0.0, 1.0 / ramp, 0.0)


def in_lanes(packed: Array) -> Array:
    """Rows (scenario, column) as flat arrays (group, column * LANES); the last group is filled with its last row."""
    groups = -(-packed.shape[0] // LANES)
    rows = np.minimum(np.arange(groups * LANES), packed.shape[0] - 1)
    lanes = packed[rows].reshape(groups, LANES, packed.shape[1]).transpose(0, 2, 1)
    return np.ascontiguousarray(lanes).reshape(groups, LANES * packed.shape[1])


@compiled
def ramp_at(time, start, rate):
    """R, R' and R'' at a time."""
    x = start + rate * time
    x = 0.0 if x < 0.0 else x
    x = 1.0 if x > 1.0 else x
    rest = 1.0 - x
    value = x * x * x * (10.0 + x * (6.0 * x - 15.0))
    return value, 30.0 * rate * x * x * rest * rest, 60.0 * rate * rate * x * rest * (rest - x)


@compiled
def top_motion(time, motion, lane, top):
    """Offset from rest, velocity and acceleration of the top end of one lane into the lanes `top`."""
    omega = motion[OMEGA * LANES + lane]
    ramp, rate, bend = ramp_at(time, motion[START * LANES + lane], motion[RATE * LANES + lane])
    sine, cosine = sine_cosine(omega * time)
    for k in range(3):
        c, s = motion[(C + k) * LANES + lane], motion[(S + k) * LANES + lane]
        here, turned = c * cosine + s * sine, omega * (s * cosine - c * sine)
        top[(OFFSET + k) * LANES + lane] = ramp * here
        top[(VELOCITY + k) * LANES + lane] = ramp * turned + rate * here
        top[(ACCELERATION + k) * LANES + lane] = bend * here + 2.0 * rate * turned - ramp * omega * omega * here


@compiled
def fluid_at(times, points, count, wave, fluid):
    """Velocity and local acceleration of the fluid at `count` points, each lane at its own time.

    There are as many lanes as `times`, up to LANES; `points` has three entries a point, `fluid` FLUID_SIZE. `wave` is
    the packed waves in lanes; the last rows are written.
    """
    # The compiler makes vector code of a loop over several arrays only if it does not know that it is short.
    lanes = times.size
    _set_time(times, wave)
    for j in range(count):
        p = points[3 * LANES * j : 3 * LANES * (j + 1)]
        f = fluid[FLUID_SIZE * LANES * j : FLUID_SIZE * LANES * (j + 1)]
        for w in range(lanes):
            ahead, aside, ramp = wave[COSINE * LANES + w], wave[SINE * LANES + w], wave[RAMP * LANES + w]
            phase = wave[PHASE * LANES + w] - (wave[KX * LANES + w] * p[w] + wave[KY * LANES + w] * p[LANES + w])
            sine, cosine = sine_cosine(phase)
            depth, surface = wave[DEPTH * LANES + w], wave[AMPLITUDE * LANES + w] * ramp * sine
            upper = _upper(p[2 * LANES + w], surface, depth, wave[NUMBER * LANES + w])
            lower = wave[BOTTOM * LANES + w] / upper
            across, along = wave[SPEED * LANES + w] * (upper + lower), wave[SPEED * LANES + w] * (upper - lower)
            omega, rate = wave[OMEGA * LANES + w], wave[RAMP_RATE * LANES + w]
            flow, gain = across * ramp * sine, across * (rate * sine + omega * ramp * cosine)
            f[w] = ahead * flow + wave[STREAM_X * LANES + w]
            f[LANES + w] = aside * flow + wave[STREAM_Y * LANES + w]
            f[2 * LANES + w] = along * ramp * cosine
            f[3 * LANES + w] = ahead * gain
            f[4 * LANES + w] = aside * gain
            f[5 * LANES + w] = along * (rate * cosine - omega * ramp * sine)


@compiled
def _set_time(times, wave):
    for w in range(times.size):
        ramp, rate, _ = ramp_at(times[w], wave[START * LANES + w], wave[RATE * LANES + w])
        wave[PHASE * LANES + w] = wave[OMEGA * LANES + w] * times[w] + wave[ORIGIN * LANES + w]
        wave[RAMP * LANES + w], wave[RAMP_RATE * LANES + w] = ramp, rate


@compiled
def _upper(z, surface, depth, k):
    """exp(k z')."""
    below = (z - surface) * depth / (depth + surface)
    below = 0.0 if below > 0.0 else below
    below = -depth if below < -depth else below
    height = k * below
    return exponential(-DEEPEST if height < -DEEPEST else height)
