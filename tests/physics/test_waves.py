"""Waves and the motion of the top end: dispersion, derivatives, orbits, continuity, limits, and lanes alone."""

import numpy as np
import pytest

from cablesim.numerics import Array
from cablesim.numerics.lanes import LANES
from cablesim.physics.waves import (
    ACCELERATION,
    FLUID_SIZE,
    GRAVITY,
    OFFSET,
    RATE,
    START,
    TOP_SIZE,
    VELOCITY,
    Waves,
    ellipse_vectors,
    fluid_at,
    in_lanes,
    m18_amplitude,
    packed_motion,
    ramp_at,
    ramp_line,
    surface_vectors,
    top_motion,
    wave_number,
)

EPS = np.finfo(float).eps
RNG = np.random.default_rng(5)
# Central differences with steps of 1e-4 of a period: error 1e-8 of the second derivative's scale, rounding 1e-11.
STEP, DIFFERENCE = 1e-4, 2e-7


def waves(size: int, steepness: float = 0.05, seed: int = 1) -> Waves:
    """Random waves from shallow to deep water."""
    rng = np.random.default_rng(seed)
    period, depth = rng.uniform(2.0, 25.0, size), 10.0 ** rng.uniform(0.5, 3.0, size)
    k = wave_number(2.0 * np.pi / period, depth)
    return Waves(np.minimum(steepness / k, 0.3 * depth), period, depth, rng.uniform(-np.pi, np.pi, size))


def fluid(waves: Waves, points: Array, time: Array, ramp: float = 0.0, speed: float = 0.0) -> tuple[Array, Array]:
    """Velocity and acceleration (scenario, 3) at one point (scenario, 3) of each of up to LANES scenarios."""
    size = time.size
    packed = waves.packed(np.full(size, ramp), np.zeros((size, 3)), np.full(size, speed))
    found = np.empty(FLUID_SIZE * LANES)
    fluid_at(in_lanes(time[:, None])[0], in_lanes(points)[0], 1, in_lanes(packed)[0], found)
    found = found.reshape(FLUID_SIZE, LANES)[:, :size].T
    return found[:, :3], found[:, 3:]


def motion(omega: Array, ramp: Array, c: Array, s: Array, time: Array) -> Array:
    """What `top_motion` gives for up to LANES scenarios, shape (scenario, TOP_SIZE)."""
    packed, found = in_lanes(packed_motion(omega, ramp, c, s))[0], np.empty(TOP_SIZE * LANES)
    for lane, moment in enumerate(time):
        top_motion(moment, packed, lane, found)
    return found.reshape(TOP_SIZE, LANES)[:, : time.size].T


def depths_below(waves: Waves, fraction: Array) -> Array:
    points = RNG.uniform(-200.0, 200.0, (waves.depth.size, 3))
    points[:, 2] = -fraction * waves.depth
    return points


# ---- dispersion ----


def test_wave_numbers_meet_the_dispersion_relation_at_all_depths():
    y = np.geomspace(1e-12, 1e6, 4001)
    depth = np.geomspace(1.0, 1e4, y.size)
    omega = np.sqrt(y * GRAVITY / depth)
    k = wave_number(omega, depth)
    residual = GRAVITY * k * np.tanh(k * depth) / omega**2 - 1.0
    # Half a dozen roundings; where the water is shallow the relation is quadratic in k.
    assert np.abs(residual).max() < 1e-14


def test_wave_numbers_tend_to_those_of_deep_and_shallow_water():
    omega, depth = np.array([1.0, 1.0]), np.array([1e4, 1e-5])
    deep, shallow = wave_number(omega, depth)
    assert deep == pytest.approx(1.0 / GRAVITY, rel=4.0 * EPS)
    # (k d)^2 / 6 is what shallow water leaves out, 1.7e-7 here.
    assert shallow == pytest.approx(1.0 / np.sqrt(GRAVITY * 1e-5), rel=2e-7)


def test_the_amplitude_is_that_of_the_source_at_its_period():
    assert m18_amplitude(np.array([5.6]))[0] == pytest.approx(1.573, abs=5e-4)


# ---- ramp and top end ----


def test_the_ramp_starts_and_ends_without_slope_or_curvature():
    (start,), (rate,) = ramp_line(np.array([7.0]))
    assert ramp_at(0.0, start, rate) == (0.0, 0.0, 0.0)
    assert ramp_at(7.0, start, rate) == pytest.approx((1.0, 0.0, 0.0), abs=1e-14)
    assert ramp_at(1e3, start, rate) == (1.0, 0.0, 0.0)
    assert ramp_at(3.5, start, rate)[0] == pytest.approx(0.5, rel=4.0 * EPS)


def test_without_a_ramp_the_motion_is_there_at_once():
    (start,), (rate,) = ramp_line(np.array([0.0]))
    assert ramp_at(0.0, start, rate) == (1.0, 0.0, 0.0)


def test_velocity_and_acceleration_of_the_top_are_derivatives_of_its_place():
    size = LANES
    omega, ramp = RNG.uniform(0.2, 3.0, size), np.where(np.arange(size) == 0, 0.0, RNG.uniform(2.0, 40.0, size))
    c, s = RNG.normal(size=(2, size, 3))
    time, step = RNG.uniform(1.0, 30.0, size), STEP / omega
    before, here, after = (motion(omega, ramp, c, s, time + shift) for shift in (-step, 0.0 * step, step))
    slopes = (after - before) / (2.0 * step[:, None])
    scale = (omega + 1.0 / np.maximum(ramp, 1.0))[:, None] * 4.0
    for value, rate in ((OFFSET, VELOCITY), (VELOCITY, ACCELERATION)):
        error = slopes[:, value : value + 3] - here[:, rate : rate + 3]
        assert (np.abs(error) < DIFFERENCE * scale ** (2 if value == VELOCITY else 1)).all()


def test_the_ellipse_is_that_of_its_formula():
    amplitude, heading, angle, ratio, phase = RNG.uniform(0.1, 1.4, (5, LANES))
    omega, time = np.full(LANES, 1.3), np.full(LANES, 2.1)
    c, s = ellipse_vectors(amplitude, heading, angle, ratio, phase)
    found = motion(omega, np.zeros(LANES), c, s, time)[:, :3]
    e1 = np.stack([np.cos(heading) * np.cos(angle), np.sin(heading) * np.cos(angle), np.sin(angle)], axis=1)
    e2 = np.stack([-np.cos(heading) * np.sin(angle), -np.sin(heading) * np.sin(angle), np.cos(angle)], axis=1)
    turned = (omega * time + phase)[:, None]
    expected = amplitude[:, None] * (np.sin(turned) * e1 + ratio[:, None] * np.cos(turned) * e2)
    assert np.allclose(found, expected, rtol=0.0, atol=20.0 * EPS)


def test_amplitude_zero_is_rest():
    zero, one = np.zeros(1), np.ones(1)
    c, s = ellipse_vectors(zero, one, one, one, one)
    assert not motion(one, one, c, s, np.array([3.0])).any()


# ---- fluid ----


def test_acceleration_of_the_fluid_is_the_derivative_of_its_velocity():
    # Still levels: stretching, which moves with time, would add to the difference.
    w = waves(LANES, steepness=1e-6)
    points, time, ramp = depths_below(w, np.linspace(0.1, 0.9, LANES)), RNG.uniform(1.0, 20.0, LANES), 12.0
    step = STEP / w.omega
    ahead, behind = (fluid(w, points, time + shift, ramp)[0] for shift in (step, -step))
    _, acceleration = fluid(w, points, time, ramp)
    scale = (w.amplitude * w.omega * (w.omega + 1.0 / ramp) / np.tanh(w.number * w.depth))[:, None]
    error = (ahead - behind) / (2.0 * step[:, None]) - acceleration
    # The stretched height, of which steepness is a part, is held fixed by the one and not by the other.
    assert (np.abs(error) < (DIFFERENCE + 1e-5) * 4.0 * scale).all()


def test_no_water_is_made_or_lost():
    w = waves(LANES, steepness=1e-6)
    points, time = depths_below(w, np.linspace(0.1, 0.9, LANES)), RNG.uniform(1.0, 20.0, LANES)
    # In depth of some cm the wave is long: a step in parts of the wave length.
    step, divergence = 1e-3 / w.number, np.zeros(LANES)
    for k in range(3):
        there, here = points.copy(), points.copy()
        there[:, k] += step
        here[:, k] -= step
        divergence += ((fluid(w, there, time)[0] - fluid(w, here, time)[0])[:, k]) / (2.0 * step)
    scale = w.amplitude * w.omega * w.number / np.tanh(w.number * w.depth)
    # Differences leave (k step)^2 / 6 and stretching leaves a few times the steepness.
    assert (np.abs(divergence) < 1e-5 * scale).all()


def test_a_particle_of_the_surface_moves_as_the_top_end_that_follows_it():
    w = waves(LANES, steepness=1e-5)
    c, s = surface_vectors(w)
    time = RNG.uniform(0.0, 30.0, LANES)
    top = motion(w.omega, np.full(LANES, 9.0), c, s, time)
    velocity, acceleration = fluid(w, top[:, :3], time, ramp=9.0)
    # The top end has the velocity of the particles where R is constant; on the ramp R' times the offset is added.
    started = time > 9.0
    assert started.any()
    scale = w.amplitude * w.omega / np.tanh(w.number * w.depth)
    # Along its orbit the particle is away from its rest by the steepness, over tanh(k d) in shallow water.
    apart = 1e-4 / np.tanh(w.number * w.depth) ** 2
    assert (np.abs(velocity - top[:, 3:6])[started] < (apart * scale)[started, None]).all()
    assert (np.abs(acceleration - top[:, 6:9])[started] < (apart * scale * w.omega)[started, None]).all()


def test_velocity_at_bottom_and_surface_is_that_of_the_formulas():
    w = waves(LANES)
    time = 0.3 * w.period
    theta = w.omega * time
    surface = w.amplitude * np.sin(theta)
    top, bottom = np.zeros((2, LANES, 3))
    top[:, 2], bottom[:, 2] = surface, -w.depth
    up, down = fluid(w, top, time)[0], fluid(w, bottom, time)[0]
    kd, speed = w.number * w.depth, w.amplitude * w.omega
    along = np.stack([np.cos(w.heading), np.sin(w.heading)], axis=1)
    # The vertical speed at the surface is d(eta)/dt; all is within some roundings of the horizontal speed.
    scale = speed / np.tanh(kd)
    assert (np.abs(up[:, 2] - speed * np.cos(theta)) < 1e-13 * scale).all()
    assert (np.abs((up[:, :2] * along).sum(axis=1) - scale * np.sin(theta)) < 1e-13 * scale).all()
    assert (np.abs(down[:, 2]) < 1e-13 * scale).all()
    assert (np.abs((down[:, :2] * along).sum(axis=1) - speed * np.sin(theta) / np.sinh(kd)) < 1e-13 * scale).all()


def test_velocity_between_them_is_that_of_the_stretched_height():
    w, time = waves(LANES), RNG.uniform(0.0, 20.0, LANES)
    points = depths_below(w, np.linspace(0.2, 0.8, LANES))
    k, d, amplitude = w.number, w.depth, w.amplitude
    theta = w.omega * time - k * (np.cos(w.heading) * points[:, 0] + np.sin(w.heading) * points[:, 1])
    eta = amplitude * np.sin(theta)
    height = (points[:, 2] - eta) * d / (d + eta) + d
    upward = amplitude * w.omega * np.sinh(k * height) / np.sinh(k * d) * np.cos(theta)
    # Phases of some hundred radians and exponents of as much lose as many roundings.
    scale = amplitude * w.omega
    assert (np.abs(fluid(w, points, time)[0][:, 2] - upward) < 1e-12 * scale).all()


def test_points_above_the_surface_and_below_the_bottom_move_as_those_on_them():
    w = waves(LANES)
    time, outside, on = 0.1 * w.period, np.zeros((LANES, 3)), np.zeros((LANES, 3))
    outside[:, 2], on[:, 2] = 2.0 * w.amplitude, w.amplitude * np.sin(w.omega * time)
    outside[::2, 2], on[::2, 2] = -1.1 * w.depth[::2], -w.depth[::2]
    found, expected = fluid(w, outside, time)[0], fluid(w, on, time)[0]
    scale = (w.amplitude * w.omega / np.tanh(w.number * w.depth))[:, None]
    assert (np.abs(found - expected) < 1e-13 * scale).all()


def test_deep_water_neither_overflows_nor_stirs():
    w = Waves(np.array([1.0]), np.array([1.0]), np.array([2000.0]), np.array([0.7]))
    assert w.number[0] * 2000.0 > 8000.0
    for depth, share in ((0.0, 1.0), (1000.0, 0.0), (2000.0, 0.0)):
        velocity, acceleration = fluid(w, np.array([[0.0, 0.0, -depth]]), np.array([0.0]))
        assert np.isfinite(velocity).all() and np.isfinite(acceleration).all()
        assert np.abs(velocity).max() == pytest.approx(share * w.omega[0], abs=1e-100)


def test_the_stream_is_added_to_the_velocity_from_the_start():
    w = Waves(np.zeros(1), np.array([6.0]), np.array([40.0]), np.array([0.7]))
    velocity, acceleration = fluid(w, np.array([[3.0, 2.0, -7.0]]), np.array([0.0]), ramp=5.0, speed=1.5)
    assert np.allclose(velocity, [[1.5 * np.cos(0.7), 1.5 * np.sin(0.7), 0.0]], rtol=4.0 * EPS)
    assert not acceleration.any()


def test_waves_start_from_rest_on_the_ramp():
    w = waves(LANES)
    velocity, acceleration = fluid(w, depths_below(w, np.linspace(0.1, 0.9, LANES)), np.zeros(LANES), ramp=5.0)
    assert not velocity.any() and not acceleration.any()


def test_the_phase_is_counted_from_the_top_end():
    w, top, time = waves(LANES), RNG.uniform(-50.0, 50.0, (LANES, 3)), RNG.uniform(0.0, 9.0, LANES)
    points = depths_below(w, np.linspace(0.1, 0.9, LANES))
    packed = w.packed(np.zeros(LANES), top, np.zeros(LANES))
    found = np.empty(FLUID_SIZE * LANES)
    fluid_at(time, in_lanes(points)[0], 1, in_lanes(packed)[0], found)
    expected, _ = fluid(w, points - top * [1.0, 1.0, 0.0], time)
    scale = w.amplitude * w.omega / np.tanh(w.number * w.depth)
    # Phases of some hundred radians lose as many roundings.
    assert (np.abs(found.reshape(FLUID_SIZE, LANES)[:3] - expected.T) < 1e-12 * scale).all()


def test_lanes_have_the_same_bits_together_and_alone():
    w, count = waves(LANES), 13
    points, time = RNG.uniform(-60.0, 3.0, (LANES, 3 * count)), RNG.uniform(0.0, 20.0, LANES)
    packed = w.packed(np.full(LANES, 8.0), np.zeros((LANES, 3)), np.ones(LANES))
    together = np.empty(count * FLUID_SIZE * LANES)
    fluid_at(time, in_lanes(points)[0], count, in_lanes(packed)[0], together)
    for lane in range(LANES):
        alone = np.empty_like(together)
        one = slice(lane, lane + 1)
        fluid_at(time[one], in_lanes(points[one])[0], count, in_lanes(packed[one])[0], alone)
        assert np.array_equal(alone[::LANES], together[lane::LANES])


def test_groups_of_lanes_are_filled_with_the_last_row():
    rows = np.arange(2.0 * (LANES + 3)).reshape(LANES + 3, 2)
    groups = in_lanes(rows)
    assert groups.shape == (2, 2 * LANES)
    assert np.array_equal(groups[0, LANES:], rows[:LANES, 1])
    assert np.array_equal(groups[1, :LANES], [*rows[LANES:, 0], *[rows[-1, 0]] * (LANES - 3)])


def test_packed_rows_have_the_ramp_in_the_same_columns():
    w = waves(3)
    ramp = np.array([0.0, 2.0, 5.0])
    rows = packed_motion(w.omega, ramp, *surface_vectors(w)), w.packed(ramp, np.zeros((3, 3)), np.zeros(3))
    for packed in rows:
        assert np.array_equal(packed[:, [START, RATE]], np.stack(ramp_line(ramp), axis=1))
