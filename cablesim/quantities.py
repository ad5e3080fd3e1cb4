"""Every quantity once: name, symbol, SI unit and meaning.

Parameters, netCDF attributes, `cablesim describe` and figure axes all read this table; nobody writes a unit twice.
Units are spelled as CF (UDUNITS) wants them. A new solver adds a line for each quantity that is new.
"""

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace

from cablesim.errors import InputError, nearest


@dataclass(frozen=True)
class Quantity:
    """`dims` are the dimensions that a value has within one scenario.

    None for a number, `component` for a vector, `section` for a list with a number for each section of the line, `node`
    for a profile, `time` or `phase` (of a period) for a history.
    """

    name: str
    symbol: str
    unit: str
    meaning: str
    dims: tuple[str, ...] = ()
    standard_name: str | None = None

    @property
    def is_history(self) -> bool:
        """Whether it has a value for each of many times."""
        return not HISTORY.isdisjoint(self.dims)

    @property
    def dtype(self) -> str:
        """How an output is stored: histories are long, and nobody needs more than six digits of them."""
        return "float32" if self.is_history else "float64"

    @property
    def attributes(self) -> dict[str, str]:
        """How CF tells of it in a file. A vertical coordinate must say which way it counts."""
        named = {"standard_name": self.standard_name} if self.standard_name else {}
        counted = {"positive": "down"} if self.standard_name == "depth" else {}
        return {"units": self.unit, "long_name": self.meaning, **named, **counted}


COMPONENTS = ("x", "y", "z")
# What is measured of every scenario.
RUN_TIME = "run_time"
# Where along the line the tension is recorded.
PLACES = ("anchor", "middle", "top")
VECTOR = ("component",)
LIST = ("section",)
HISTORY = frozenset(("time", "phase"))
# Dimensions whose length is a choice of the method.
LONG = HISTORY | {"node"}
# Dimensions of what is answered unasked and has an error; profiles and histories are too long for that.
SHORT = ((), VECTOR, LIST)
# As many sections can a line in a design have; through Python there is no limit.
MOST_SECTIONS = 100

TABLE = (
    # parameters of a hanging line
    Quantity("span", "l", "m", "horizontal distance from support A to support B"),
    Quantity("rise", "h", "m", "height of support B above support A"),
    Quantity("line_length", "L", "m", "unstretched length of the line"),
    Quantity("length_ratio", "L/l", "1", "line length over span; of a line moored in waves, over its chord"),
    Quantity(
        "weight_per_length", "w", "N m-1", "weight of the line per unstretched length, less buoyancy if submerged"
    ),
    Quantity("axial_stiffness", "EA", "N", "tension per unit strain"),
    Quantity("permitted_error", r"\eta", "1", "largest permitted relative error of an approximate formula"),
    # parameters of a line in a stream
    Quantity("angle", r"\phi", "rad", "angle of the tangent above the direction of tow, that is against the stream"),
    Quantity("critical_angle", r"\phi_c", "rad", "angle at which weight and normal drag of a straight line balance"),
    Quantity("weight_ratio", "w", "1", "weight over normal drag of a line across the stream, per length"),
    Quantity("friction_ratio", "f", "1", "tangential over normal drag, per length"),
    Quantity("friction_law", r"f(\phi)", "1", "how the tangential drag depends on the angle to the stream"),
    Quantity("reference_angle", r"\phi_0", "rad", "angle of the tangent at which the dimensionless functions start"),
    Quantity("diameter", "D", "m", "diameter of the line"),
    Quantity("normal_drag_coefficient", "C_n", "1", "drag coefficient of the line across the stream"),
    Quantity("tangential_drag_coefficient", "C_t", "1", "drag coefficient of the line along the stream"),
    Quantity("lay_angle", r"\beta", "rad", "angle of the strands of the line to its axis"),
    Quantity("fluid_density", r"\rho", "kg m-3", "density of the fluid"),
    Quantity("stream_speed", "U", "m s-1", "speed of the stream past the line"),
    Quantity("heading", r"\psi", "rad", "direction in which stream and waves run, from x towards y"),
    Quantity(
        "depth",
        "Z",
        "m",
        "height of end B above end A; of a line moored in waves, depth of the still water",
        standard_name="depth",
    ),
    Quantity("force_A", r"\mathbf{F}_A", "N", "tension times tangent at end A, tangent from A to B", ("component",)),
    Quantity("position_B", r"\mathbf{r}_B", "m", "position of end B from end A", ("component",)),
    # parameters of a line of sections
    Quantity("section_length", r"\ell", "m", "length of each section, from A to B", LIST),
    Quantity(
        "section_weight",
        "w",
        "N m-1",
        "weight per length of each section, less buoyancy if submerged, from A to B",
        LIST,
    ),
    # parameters of a line of equal strength
    Quantity("strength_length", "k", "m", "permitted stress over weight per volume, less buoyancy if submerged"),
    Quantity("force_ratio", "r", "1", "horizontal force on the line over the force that it was designed for"),
    Quantity("arc_fraction", "s/L", "1", "position along the line: arc length from end A over the length of the line"),
    # parameters of a tow line in waves
    Quantity("hook_pull", "F_r", "N", "pull at the towing hook in calm water"),
    Quantity("breaking_strength", r"P", "N", "tension at which the tow line breaks; half of it is allowed in a jerk"),
    Quantity("distance_calm", r"AB", "m", "horizontal distance between the ships in calm water"),
    Quantity("distance_jerk", r"A'B'", "m", "horizontal distance between the ships at half the breaking strength"),
    Quantity("wire_modulus", r"\varepsilon", "Pa", "tension per unit strain of the wire over its diameter squared"),
    # parameters of a line moored in waves
    Quantity("chord_angle", r"\alpha", "rad", "angle of the chord from end A to end B above the horizontal, at rest"),
    Quantity("mass_per_length", "m", "kg m-1", "mass of the line per unstretched length"),
    Quantity("area", "F", "m2", "cross-section of the line"),
    Quantity("linear_stiffness", r"C_\varepsilon", "N", "tension per unit strain, where the strain is small"),
    Quantity(
        "quadratic_stiffness",
        r"C_{\varepsilon 1}",
        "N",
        "tension per unit strain squared, beside the linear part; negative where the line softens",
    ),
    Quantity(
        "stiffness_ratio",
        r"C_{\varepsilon 1}/C_\varepsilon",
        "1",
        "quadratic over linear stiffness, the strain taken as a fraction; negative where the line softens",
    ),
    Quantity("internal_damping", r"C_{\dot\varepsilon}", "N s", "tension per unit rate of strain, of a taut line"),
    Quantity(
        "normal_drag", "C_n", "kg m-2", "drag per length over the square of the speed of the fluid across the line"
    ),
    Quantity(
        "tangential_drag",
        r"C_\tau",
        "kg m-2",
        "drag per length over the square of the speed of the fluid along the line",
    ),
    Quantity("added_mass_per_length", "C_a", "kg m-1", "mass of fluid per length that is accelerated with the line"),
    Quantity("wave_period", "T_w", "s", "period of the waves, and of the motion of the top end"),
    Quantity("top_amplitude", "A", "m", "longer half axis of the ellipse on which the top end moves"),
    Quantity("motion_angle", r"\vartheta", "rad", "angle of the longer axis of that ellipse above the heading"),
    Quantity(
        "axis_ratio",
        "b/A",
        "1",
        "shorter over longer axis of that ellipse; negative if it is run through the other way",
    ),
    Quantity("motion_phase", r"\varphi", "rad", "phase of the motion of the top end at the start"),
    Quantity("duration", r"t_{\max}", "s", "time that is computed"),
    Quantity("ramp", "t_r", "s", "time in which waves and motion grow from nothing to their full size"),
    # what a hanging line answers
    Quantity("catenary_parameter", "a", "m", "horizontal tension over weight per length; radius at the vertex"),
    Quantity("horizontal_tension", "H", "N", "horizontal component of the tension, the same all along the line"),
    Quantity("tension_A", "T_A", "N", "tension at end A"),
    Quantity("tension_B", "T_B", "N", "tension at end B"),
    Quantity("max_tension", r"T_{\max}", "N", "largest tension in the line"),
    Quantity("sag", "d", "m", "largest vertical distance of the line below the chord between its supports"),
    Quantity("drop", "f", "m", "depth of the vertex of the curve below the upper support"),
    Quantity("horizontal_distance", "X", "m", "horizontal distance from end A to end B"),
    Quantity(
        "vertex_x", "x_v", "m", "horizontal position of the vertex from support A; outside 0..span if not on the line"
    ),
    Quantity("stretched_length", "L_s", "m", "length of the line under its tension"),
    Quantity("profile", "r", "m", "position along the line, from A to B", ("node", "component")),
    Quantity("profile_tension", "T", "N", "tension along the line, at the nodes of its profile", ("node",)),
    Quantity(
        "joint_tension",
        "T_j",
        "N",
        "tension at the end of each section that is nearer to B; that of the last is tension_B",
        LIST,
    ),
    Quantity(
        "joint_position",
        r"\mathbf{r}_j",
        "m",
        "position from end A of the end of each section that is nearer to B; that of the last is end B",
        ("section", "component"),
    ),
    Quantity("profile_section", "i", "1", "number of the section that a node is in, 1 at end A", ("node",)),
    Quantity("vertex_s", "s_v", "m", "length of line from end A to where it is level, or would be if it went on"),
    Quantity(
        "vertex_section", "i_v", "1", "section in which the line is level; 0 before A, their number plus 1 past B"
    ),
    # what a tow line in waves answers
    Quantity("elastic_elongation", r"\Delta_e", "m", "elongation of the wire from calm to jerk"),
    Quantity("weight_elongation", r"\Delta_w", "m", "by how much the ships part, the line being pulled straighter"),
    Quantity("wave_height", "h", "m", "height of the waves, from trough to crest"),
    Quantity("sag_limit_ratio", "(L/l)_d", "1", "largest length ratio at which the sag is within the permitted error"),
    Quantity("tension_limit_ratio", "(L/l)_T", "1", "largest length ratio at which the largest tension is within it"),
    # what a line of equal strength answers
    Quantity(
        "area_ratio_A", "A_A/A_0", "1", "cross-section at end A over the one that carries the horizontal force alone"
    ),
    Quantity(
        "area_ratio_B", "A_B/A_0", "1", "cross-section at end B over the one that carries the horizontal force alone"
    ),
    Quantity(
        "saved_weight_fraction",
        r"\eta_w",
        "1",
        "weight saved against an equally long line as thick as the thicker end everywhere, over the weight of that",
    ),
    Quantity("weight_over_force", "W/H", "1", "weight of the line over its horizontal force"),
    Quantity(
        "profile_area_ratio",
        "A/A_0",
        "1",
        "cross-section at the nodes of the profile over the one that carries the horizontal force alone",
        ("node",),
    ),
    Quantity(
        "profile_weight",
        "W_s/H",
        "1",
        "weight of the line from end A to a node of its profile over its horizontal force",
        ("node",),
    ),
    Quantity("stress_ratio", r"\sigma_s/\sigma", "1", "stress at the arc fraction over the permitted stress"),
    Quantity("stress_ratio_A", r"\sigma_A/\sigma", "1", "stress at end A over the permitted stress"),
    Quantity("stress_ratio_B", r"\sigma_B/\sigma", "1", "stress at end B over the permitted stress"),
    Quantity("max_stress_ratio", r"\sigma_{\max}/\sigma", "1", "largest stress in the line over the permitted stress"),
    Quantity(
        "profile_stress_ratio",
        r"\sigma_s/\sigma",
        "1",
        "stress at the nodes of the profile over the permitted stress",
        ("node",),
    ),
    # what a line in a stream answers
    Quantity("tau", r"\tau", "1", "tension over the tension at the reference angle"),
    Quantity("sigma", r"\sigma", "1", "dimensionless length of the line from the reference angle"),
    Quantity("xi", r"\xi", "1", "dimensionless horizontal distance from the reference angle"),
    Quantity("eta", r"\eta", "1", "dimensionless vertical distance from the reference angle"),
    Quantity("force_B", r"\mathbf{F}_B", "N", "tension times tangent at end B, tangent from A to B", ("component",)),
    Quantity("angle_A", r"\alpha_A", "rad", "angle of the tangent at end A above the direction of tow, 0 to 2 pi"),
    Quantity("angle_B", r"\alpha_B", "rad", "angle of the tangent at end B above the direction of tow, 0 to 2 pi"),
    Quantity(
        "lowest_point", r"\mathbf{r}_l", "m", "position of the lowest point of the line from end A", ("component",)
    ),
    Quantity(
        "farthest_point",
        r"\mathbf{r}_f",
        "m",
        "position from end A of the point of the line that is farthest downstream",
        ("component",),
    ),
    Quantity("closing_error", "e", "m", "distance by which the computed line misses its given end"),
    Quantity("steps", "n", "1", "integration steps, or segments, in all"),
    # what a line moored in waves answers
    Quantity("max_top_tension", r"T_{B,\max}", "N", "largest force on the top end over the last periods"),
    Quantity("min_top_tension", r"T_{B,\min}", "N", "smallest force on the top end over the last periods"),
    Quantity("mean_top_tension", r"T_{B,\mathrm{mean}}", "N", "mean force on the top end over the last periods"),
    Quantity("static_top_tension", r"T_{B,0}", "N", "force on the top end at rest, before waves and motion"),
    Quantity(
        "max_middle_tension", r"T_{m,\max}", "N", "largest tension in the middle of the line over the last periods"
    ),
    Quantity(
        "min_middle_tension", r"T_{m,\min}", "N", "smallest tension in the middle of the line over the last periods"
    ),
    Quantity(
        "mean_middle_tension",
        r"T_{m,\mathrm{mean}}",
        "N",
        "mean tension in the middle of the line over the last periods",
    ),
    Quantity(
        "static_middle_tension", r"T_{m,0}", "N", "tension in the middle of the line at rest, before waves and motion"
    ),
    Quantity("max_anchor_tension", r"T_{A,\max}", "N", "largest force on the anchor over the last periods"),
    Quantity("min_anchor_tension", r"T_{A,\min}", "N", "smallest force on the anchor over the last periods"),
    Quantity("mean_anchor_tension", r"T_{A,\mathrm{mean}}", "N", "mean force on the anchor over the last periods"),
    Quantity("static_anchor_tension", r"T_{A,0}", "N", "force on the anchor at rest, before waves and motion"),
    Quantity("static_residual", "e_0", "1", "largest force left over on a node at rest over the largest tension"),
    Quantity("slack_fraction", r"\sigma_0", "1", "part of the line and of the last periods without tension"),
    Quantity(
        "snap_count",
        "n_s",
        "1",
        "how often the element that snaps most is jerked from slack to taut in the last periods",
    ),
    Quantity("max_strain", r"\varepsilon_{\max}", "1", "largest strain of any element in the whole run"),
    Quantity(
        "energy_error",
        "e_E",
        "1",
        "error of the balance of energy over the whole run, relative to what was turned over",
    ),
    Quantity(
        "period_spread",
        r"\delta_T",
        "1",
        "largest difference between the largest tensions of the last periods at one place, over the largest of all",
    ),
    Quantity("rejected_steps", "n_r", "1", "integration steps that were tried and repeated with a smaller one"),
    Quantity("rhs_evaluations", "n_f", "1", "how often the forces on the line were computed"),
    Quantity(
        "mesh_change",
        "e_h",
        "1",
        "largest change of the largest, least and mean tensions if all elements are halved, over the largest of all",
    ),
    Quantity(
        "time_change",
        "e_t",
        "1",
        "largest change of the largest, least and mean tensions if time is marched ten times as accurately, "
        "over the largest of all",
    ),
    Quantity(
        "richardson_top_tension", r"T_{B,h \to 0}", "N", "largest top tension, extrapolated to elements of no length"
    ),
    Quantity(
        "profile_max_tension",
        r"T_{\max}",
        "N",
        "largest tension along the line in the last periods, at nodes",
        ("node",),
    ),
    Quantity(
        "profile_min_tension",
        r"T_{\min}",
        "N",
        "smallest tension along the line in the last periods, at nodes",
        ("node",),
    ),
    Quantity("history", "T", "N", "tension at anchor, middle and top through the whole run", ("time", "place")),
    Quantity("history_time", "t", "s", "times of the history, of each scenario its own", ("time",)),
    Quantity(
        "orbit",
        r"\mathbf{r}_m",
        "m",
        "position of the middle of the line from its place at rest, through the last period",
        ("phase", "component"),
    ),
    Quantity(
        "snapshots",
        r"\mathbf{r}",
        "m",
        "position along the line from A, through the last period",
        ("phase", "node", "component"),
    ),
    Quantity("snapshot_tension", "T", "N", "tension along the line through the last period", ("phase", "node")),
    # what vibrations of a moored line answer
    Quantity(
        "lowest_frequency", r"\omega_1", "rad s-1", "lowest angular frequency of the discrete line about its rest"
    ),
    Quantity(
        "highest_frequency",
        r"\omega_{\max}",
        "rad s-1",
        "highest angular frequency of the discrete line about its rest",
    ),
    Quantity(
        "frequency_ratio",
        r"\omega_{\max}/\omega",
        "1",
        "highest angular frequency of the discrete line over that of the waves: how stiff the problem is in time",
    ),
    Quantity(
        "stable_step_limit",
        r"h_{\max}",
        "s",
        "longest time step of an explicit method that is stable in the fastest vibration, by linear theory",
    ),
    Quantity("stable_step", "h_s", "s", "longest time step with which a slightly disturbed line stayed near its rest"),
    # what every solver can tell of its work
    Quantity("iterations", "n", "1", "iterations taken by the method; 0 for a closed formula"),
    Quantity("run_time", "t", "s", "measured wall time of the solver, per scenario of its shard or of its timed runs"),
    Quantity("run_time_lowest", r"t_{\min}", "s", "shortest of the timed runs, per scenario"),
    Quantity("run_time_highest", r"t_{\max}", "s", "longest of the timed runs, per scenario"),
    Quantity("run_time_alone", "t_1", "s", "wall time of one scenario solved alone, median of some"),
    Quantity("first_call_time", "t_0", "s", "wall time of the first call, which loads or compiles its machine code"),
    Quantity("repeats", "n", "1", "timed runs"),
)


def is_vector(name: str) -> bool:
    """Whether a quantity is a vector for each scenario."""
    return name in QUANTITIES and QUANTITIES[name].dims == VECTOR


def is_list(name: str) -> bool:
    """Whether a quantity is a list for each scenario, with one number a section."""
    return name in QUANTITIES and QUANTITIES[name].dims == LIST


def component_names(name: str, sections: int = MOST_SECTIONS) -> tuple[str, ...]:
    """The scalars that a name stands for; itself where it is one.

    "force_A_x", "force_A_y" and "force_A_z" for a vector, "section_length_1", "section_length_2", ... for a list.
    """
    if is_list(name):
        return tuple(f"{name}_{section}" for section in range(1, sections + 1))
    return tuple(f"{name}_{component}" for component in COMPONENTS) if is_vector(name) else (name,)


def list_name(name: str) -> str:
    """The list that a name is a part of: "section_length" for "section_length_2"; empty for any other name."""
    head = name.rpartition("_")[0]
    return head if is_list(head) and name in QUANTITIES else ""


def section_number(name: str) -> int:
    """The section of a list that a name stands for: 2 for "section_length_2"; 0 for any other name."""
    return int(name.rpartition("_")[2]) if list_name(name) else 0


def most_sections(names: Iterable[str]) -> int:
    """The largest number of a section among names; 0 where none stands for a section of a list."""
    return max(map(section_number, names), default=0)


def quantity(name: str) -> Quantity:
    """The row of the table. Raises InputError, with the nearest names, for an unknown one."""
    try:
        return QUANTITIES[name]
    except KeyError:
        raise InputError(f"unknown quantity '{name}': {nearest(name, QUANTITIES)}") from None


def numbers_per_scenario(outputs: Iterable[str], sizes: dict[str, int]) -> int:
    """How many numbers the outputs of one scenario are, `sizes` being the lengths of dimensions."""
    return sum(_numbers(name, sizes) for name in outputs)


def bytes_per_scenario(outputs: Iterable[str], sizes: dict[str, int]) -> int:
    """How many bytes the outputs of one scenario are when they are stored."""
    return sum(_numbers(name, sizes) * (4 if quantity(name).is_history else 8) for name in outputs)


def _numbers(name: str, sizes: dict[str, int]) -> int:
    known = {"component": len(COMPONENTS), "place": len(PLACES), **sizes}
    return math.prod(known.get(dim, 1) for dim in quantity(name).dims)


def _with_components(row: Quantity) -> tuple[Quantity, ...]:
    """A row and, for a vector or a list, those of its components or sections."""
    if row.dims == VECTOR:
        return (row, *(_part(row, component, f"{component} component of {row.name}") for component in COMPONENTS))
    if row.dims == LIST:
        numbers = map(str, range(1, MOST_SECTIONS + 1))
        return (row, *(_part(row, number, f"section {number} of {row.name}") for number in numbers))
    return (row,)


def _part(row: Quantity, part: str, meaning: str) -> Quantity:
    return replace(
        row,
        name=f"{row.name}_{part}",
        symbol=_part_symbol(row.symbol, part),
        meaning=f"{meaning}, {row.meaning}",
        dims=(),
    )


def _part_symbol(symbol: str, part: str) -> str:
    """The symbol of a part: "F_{A,x}" of a vector F_A, which is bold."""
    letter, _, index = re.sub(r"\\mathbf\{(\w)\}", r"\1", symbol).partition("_")
    return f"{letter}_{{{index},{part}}}" if index else f"{letter}_{{{part}}}"


QUANTITIES = {row.name: row for entry in TABLE for row in _with_components(entry)}
# Every dimension that a value may have within one scenario.
OWN_DIMS = tuple(dict.fromkeys(dim for row in TABLE for dim in row.dims))
