"""What it takes to march a moored line through time, by laws that were fitted to measured times on one core.

Lines that stay taut are marched side by side in steps that their tolerance decides; the steps of lines that go slack
and snap are shorter and of another length for each, and grow faster with the tolerance and the number of elements.
Explicit methods take the longest step that is stable.
"""

import numpy as np

from cablesim.numerics import Array
from cablesim.solvers._wave_line import DURATION, MooredLine, Options

# Steps of a taut line in a period at the default tolerance, and microseconds of one: of a step, and of an element.
TAUT_STEPS, TAUT_STEP, TAUT_ELEMENT = 27.0, 0.9e-6, 0.037e-6
# Seconds of a period of a snapping line of so many elements at the default tolerance.
SNAPPING_PERIOD, SNAPPING_SEGMENTS = 4e-4, 20.0
# Its steps are as much slower where every line has its own.
SNAPPING_SLOWER = 1.5
DEFAULT_RTOL = 1e-3
# Steps over time and the frequency 2 N / L sqrt(EA / m), and seconds for an element.
EXPLICIT = {"leapfrog": (1.0, 0.065e-6), "rk4": (0.75, 0.24e-6)}
# A line goes slack if the motion alone, given way to by its sag, changes its tension by this part.
SLACK_SHARE = 0.5
ITERATIONS = 40
TINY = 1e-30


def march_seconds(p: MooredLine, options: Options, per_element: float) -> Array:
    """Seconds of each scenario for one march; `per_element` for integrators without a law."""
    periods = p.end_time / p.wave_period
    if options.integrator in EXPLICIT:
        return _explicit(p, options)
    if options.integrator != "generalized_alpha":
        return per_element * options.segments * periods / DURATION
    closer = DEFAULT_RTOL / options.rtol
    taut = TAUT_STEPS * closer**0.32 * (TAUT_STEP + TAUT_ELEMENT * options.segments)
    snapping = SNAPPING_PERIOD * closer**0.8 * (options.segments / SNAPPING_SEGMENTS) ** 1.5
    most = options.most_steps * (TAUT_STEP + TAUT_ELEMENT * options.segments)
    return np.minimum(periods * np.where(_goes_slack(p), max(taut, snapping), taut), SNAPPING_SLOWER * most)


def _explicit(p: MooredLine, options: Options) -> Array:
    steps_per_frequency, per_element = EXPLICIT[options.integrator]
    frequency = 2.0 * options.segments / p.length * np.sqrt(p.linear_stiffness / p.mass_per_length)
    steps = p.end_time * steps_per_frequency * frequency / options.step_part
    if options.time_step > 0.0:
        steps = p.end_time / options.time_step
    return np.minimum(steps, options.most_steps) * per_element * options.segments


def _goes_slack(p: MooredLine) -> Array:
    """Whether a line is likely to: its sag at rest is that of a parabola, and gives way to slow motion."""
    across = np.maximum(np.abs(p.weight) * p.length * p.top[:, 0] / p.chord, TINY)
    tension = _tension_at_rest(p, across)
    compliance = p.length / p.linear_stiffness + across**2 * p.length / (12.0 * tension**3)
    chord = (p.top + p.depth[:, None] * [0.0, 0.0, 1.0]) / p.chord[:, None]
    move = np.hypot(*((vector * chord).sum(axis=1) for vector in p.motion))
    return move / compliance > SLACK_SHARE * tension


def _tension_at_rest(p: MooredLine, across: Array) -> Array:
    """The root of T^3 / EA + (L / chord - 1) T^2 = across^2 / 24, by Newton's method from above."""
    excess, stiffness = p.length / p.chord - 1.0, p.linear_stiffness
    load = across**2 / 24.0
    tension = stiffness * np.maximum(-excess, 0.0) + np.cbrt(stiffness * load)
    for _ in range(ITERATIONS):
        value = tension**3 / stiffness + excess * tension**2 - load
        tension = tension - value / (tension * (3.0 * tension / stiffness + 2.0 * excess))
    return tension
