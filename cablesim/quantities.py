"""Every quantity once: name, symbol, SI unit and meaning.

Parameters, netCDF attributes, `cablesim describe` and figure axes all read this table; nobody writes a unit twice.
Units are spelled as CF (UDUNITS) wants them. A new solver adds a line for each quantity that is new.
"""

from dataclasses import dataclass

from cablesim.errors import InputError, nearest


@dataclass(frozen=True)
class Quantity:
    """`dims` are the dimensions a value has within one scenario: none for a scalar."""

    name: str
    symbol: str
    unit: str
    meaning: str
    dims: tuple[str, ...] = ()
    standard_name: str | None = None

    @property
    def label(self) -> str:
        """Name, symbol and unit, as a figure axis or a table head shows them."""
        words = self.name.replace("_", " ")
        return f"{words} ${self.symbol}$" + ("" if self.unit == "1" else f" [{self.unit.replace('-1', '⁻¹')}]")


COMPONENTS = ("x", "y", "z")

TABLE = (
    # parameters of a hanging line
    Quantity("span", "l", "m", "horizontal distance from support A to support B"),
    Quantity("rise", "h", "m", "height of support B above support A"),
    Quantity("line_length", "L", "m", "unstretched length of the line"),
    Quantity("length_ratio", "L/l", "1", "line length over span"),
    Quantity(
        "weight_per_length", "w", "N m-1", "weight of the line per unstretched length, less buoyancy if submerged"
    ),
    Quantity("axial_stiffness", "EA", "N", "tension per unit strain"),
    Quantity("permitted_error", r"\eta", "1", "largest permitted relative error of an approximate formula"),
    # what a hanging line answers
    Quantity("catenary_parameter", "a", "m", "horizontal tension over weight per length; radius at the vertex"),
    Quantity("horizontal_tension", "H", "N", "horizontal component of the tension, the same all along the line"),
    Quantity("tension_A", "T_A", "N", "tension at support A"),
    Quantity("tension_B", "T_B", "N", "tension at support B"),
    Quantity("max_tension", r"T_{\max}", "N", "largest tension in the line"),
    Quantity("sag", "d", "m", "largest vertical distance of the line below the chord between its supports"),
    Quantity("drop", "f", "m", "depth of the vertex of the curve below the upper support"),
    Quantity(
        "vertex_x", "x_v", "m", "horizontal position of the vertex from support A; outside 0..span if not on the line"
    ),
    Quantity("stretched_length", "L_s", "m", "length of the line under its tension"),
    Quantity("profile", "r", "m", "position along the line, from A to B", ("node", "component")),
    Quantity("profile_tension", "T", "N", "tension along the line, at the nodes of its profile", ("node",)),
    Quantity("sag_limit_ratio", "(L/l)_d", "1", "largest length ratio at which the sag is within the permitted error"),
    Quantity("tension_limit_ratio", "(L/l)_T", "1", "largest length ratio at which the largest tension is within it"),
    # what every solver can tell of its work
    Quantity("iterations", "n", "1", "iterations taken by the method; 0 for a closed formula"),
    Quantity("run_time", "t", "s", "measured wall time of the solver, per scenario of its shard"),
)

QUANTITIES = {quantity.name: quantity for quantity in TABLE}


def quantity(name: str) -> Quantity:
    """The row of the table. Raises InputError, with the nearest names, for an unknown one."""
    try:
        return QUANTITIES[name]
    except KeyError:
        raise InputError(f"unknown quantity '{name}': {nearest(name, QUANTITIES)}") from None
