"""The pulled line with a narrower range of one parameter.

Reference: none; it belongs to the tests.
"""

from dataclasses import dataclass

from cablesim.numerics import Array
from cablesim.parameters import parameter
from cablesim.solvers import pulled_line

OUTPUTS = pulled_line.OUTPUTS
SECONDS_PER_SCENARIO = pulled_line.SECONDS_PER_SCENARIO
Options = pulled_line.Options
solve = pulled_line.solve


@dataclass(frozen=True)
class Parameters(pulled_line.Parameters):
    lay_angle: Array = parameter(at_least=0.0, at_most=0.5, typical=(0.0, 0.5), default=0.0)
