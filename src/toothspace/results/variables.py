"""The one table of result variables, and of the names and units of summary numbers.

Everything that goes into a result file is looked up here; a name that is not in the
table is refused. The page ``docs/reference/results.md`` is generated from it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, final

import numpy as np
from numpy.typing import ArrayLike

from toothspace.core.errors import CaseError
from toothspace.core.keys import suggestion
from toothspace.core.netcdf import spare_array_packages
from toothspace.model.ledger import FRICTION_MECHANISMS
from toothspace.results.performance import LATERAL

if TYPE_CHECKING:
    import xarray as xr


SampleDimension = Literal["shaft_angle", "time"]

SAMPLE = "sample"
"""Stands for the dimension of the samples: ``shaft_angle`` (steady) or ``time`` (transient)."""
_ROWS: tuple[tuple[str, str, str, str], ...] = (
    ("shaft_angle", "sample", "rad", "Angle of the drive shaft, counted from the start of the run"),
    ("time", "sample", "s", "Time from the start of the run"),
    ("shaft_speed", "sample", "rad/s", "Speed of the drive shaft"),
    ("shaft_torque", "sample", "N m", "Shaft torque, absorbed by a pump, delivered by a motor"),
    ("inlet_flow_rate", "sample", "m3/s", "Flow into the machine at inlet pressure"),
    ("outlet_flow_rate", "sample", "m3/s", "Flow out of the machine at outlet pressure"),
    ("line_flow_rate", "sample", "m3/s",
     "Flow from the working port of a pump into its line or load, or from a line into a motor"),
    ("inlet_pressure", "sample", "Pa", "Absolute pressure at the inlet"),
    ("outlet_pressure", "sample", "Pa", "Absolute pressure at the outlet"),
    ("pressure_difference", "sample", "Pa",
     "Inlet minus outlet pressure of a motor, outlet minus inlet pressure of a pump"),
    ("node_pressure", "sample node", "Pa", "Absolute pressure at a node of the circuit"),
    ("supply_speed", "sample", "rad/s", "Shaft speed of the supply pump"),
    ("load_torque", "sample", "N m", "Torque that the load takes from the shaft"),
    ("load_speed", "sample", "rad/s", "Speed of the load beyond an elastic coupling"),
    ("coupling_torque", "sample", "N m", "Torque that an elastic coupling takes from the shaft"),
    ("drive_torque", "sample", "N m", "Torque of an electric drive on the shaft"),
    ("electric_power", "sample", "W", "Power that an electric drive draws from its supply"),
    ("drive_motor_loss", "sample", "W", "Losses in copper and iron of an electric drive"),
    ("drive_inverter_loss", "sample", "W", "Losses in the inverter of an electric drive"),
    ("chamber_pressure", "sample chamber", "Pa", "Absolute pressure in a chamber"),
    ("chamber_volume", "sample chamber", "m3", "Volume of a chamber"),
    ("chamber_gas_fraction", "sample chamber", "1", "Volume fraction of free gas in a chamber"),
    ("chamber_vapour_fraction", "sample chamber", "1", "Volume fraction of vapour in a chamber"),
    ("chamber_angle", "sample chamber", "rad", "Table angle of a chamber within its own period"),
    ("opening_area", "sample chamber port", "m2", "Open area between a chamber and a port"),
    ("body_position", "sample body axis", "m", "Displacement of a body from its nominal centre"),
    ("body_velocity", "sample body axis", "m/s", "Velocity of the displacement of a body"),
    ("body_rotation", "sample body", "rad", "Rotation of a body ahead of its kinematic angle"),
    ("body_tilt", "sample body axis", "rad", "Rotation of a body between its covers about x and y"),
    ("face_film_height", "sample body", "m", "Smallest film height between a body and its covers"),
    ("body_force", "sample body axis", "N", "Force of the fluid pressure on a body"),
    ("body_moment", "sample body", "N m", "Moment of the fluid pressure about the axis of a body"),
    ("axial_force", "sample body", "N",
     "Axial force of pressure and helical teeth on a body, positive along z"),
    ("journal_force", "sample body axis", "N", "Force of the journal bearings on a body"),
    ("journal_eccentricity_ratio", "sample body", "1", "Eccentricity over journal clearance"),
    ("journal_film_height", "sample journal", "m", "Smallest film height in a journal bearing"),
    ("block_position", "sample axis", "m", "Displacement of moving bearing blocks in the housing"),
    ("seat_position", "body axis", "m", "Displacement of the bearing blocks in the housing"),
    ("lateral_gap_height", "sample body", "m", "Film height on the faces of a body"),
    ("tip_gap_height", "sample chamber", "m", "Gap at the tooth tip ahead of a chamber"),
    ("contact_force", "sample contact", "N", "Normal force in a contact, positive pushing"),
    ("contact_gap", "sample contact", "m", "Gap of a contact, negative if the flanks overlap"),
    ("tooth_force", "sample tooth", "N",
     "Sum of the forces of contacts that touch on a tooth of the outer rotor"),
    ("tooth_place", "sample tooth", "rad",
     "Angle of that tooth from the largest pocket, in the sense of rotation"),
    ("leakage", "sample path", "m3/s",
     "Flow from the high to the low port, each by the share of the way that it falls"),
    ("equivalent_leakage", "sample path", "m3/s",
     "Flow from the high to the low port that would lose the same power, trapping included"),
    ("drain_flow_rate", "sample", "m3/s", "Flow from the chambers to the drain"),
    ("drag_torque", "sample path", "N m",
     "Torque at the shaft of walls that drag fluid against pressure, part of the path losses"),
    ("axial_load", "sample", "N",
     "Axial load that tabulated lateral films carry, positive away from the faces"),
    ("lateral_leakage_factor", "sample", "1", "Leakage of these films over their closed form"),
    ("lateral_load_beyond", "sample", "1",
     "Share of time in which the load lies beyond the table by a tenth of its range"),
    ("path_label", "path", "", "Readable name of a leakage path"),
    ("path_colour", "path", "", "Colour of a leakage path in figures"),
    ("torque_loss", "sample mechanism", "N m", "Friction torque, at the shaft, by mechanism"),
    ("power_loss", "sample mechanism", "W", "Friction power by mechanism"),
    ("film_pressure", "film film_row film_column", "Pa", "Absolute pressure in a film"),
    ("film_height", "film film_row film_column", "m", "Height of a film, deformation included"),
    ("film_contact_pressure", "film film_row film_column", "Pa", "Pressure carried by asperities"),
    ("film_wear_power", "film film_row film_column", "W/m2",
     "Asperity pressure times sliding speed at the bearing, mean over the shaft angles solved"),
    ("film_deformation", "film film_row film_column", "m", "Elastic deformation of the surfaces"),
    ("film_fraction", "film film_row film_column", "1", "Part of the gap filled with liquid"),
    ("film_temperature", "film", "K", "Mean temperature of a film"),
    ("temperature", "heat_node", "K", "Mean temperature of oil, bodies and films"),
    ("film_angle", "film_row", "rad", "Angle of cells about the axis of their film, from x to y"),
    ("film_radius", "film film_column", "m", "Radius of cells about the axis of their film"),
    ("film_center_x", "film", "m", "Axis of a film"),
    ("film_center_y", "film", "m", "Axis of a film"),
    ("bearing_position", "sample", "m", "Floating bearing at the drive gear, away from the gears"),
    ("casing_angle", "casing_angle", "rad",
     "Angle round a bore in the sense of rotation, zero opposite to the mesh"),
    ("running_in_depth", "body casing_angle", "m", "Depth cut into the casing by running-in"),
    ("tip_cut_depth", "body casing_angle", "m",
     "Depth by which tips would cut into the casing as it is, in this revolution"),
    ("dense_angle", "dense_angle", "rad",
     "Angle of the drive shaft at the states that spectra come from, whatever the samples are"),
    ("contact_loaded_share", "contact", "1",
     "Share of a revolution in which a contact carries, times its part of the face width"),
    ("tip_gap_minimum", "tip", "m",
     "Smallest gap of tips along a wall, negative where they would cut in and roughness is kept"),
    ("vapour_collapse_power", "", "W", "Mean power that collapsing vapour sets free"),
    ("lost_flow", "flow_part", "m3/s",
     "Flow that the volumetric efficiency lacks, in parts that sum to it"),
    ("event_shaft_angle", "event", "rad", "Shaft angle of an event"),
    ("event_time", "event", "s", "Time of an event"),
    ("event_kind", "event", "", "Kind of an event"),
    ("event_label", "event", "", "Where an event happened"),
    ("ledger_mass", "mass_entry", "kg", "Mass over the evaluation window"),
    ("ledger_energy", "energy_entry", "J", "Energy over the evaluation window"),
    ("ledger_label", "energy_entry", "", "Readable name of an energy account"),
    ("window_duration", "", "s", "Duration of the evaluation window"),
    ("window_shaft_angle", "", "rad", "Angle turned by the shaft in the evaluation window"),
    ("displacement", "", "m3/rad", "Geometric volume per shaft radian, single flank"),
    ("inlet_density", "", "kg/m3", "Density at mean inlet pressure"),
    ("outlet_density", "", "kg/m3", "Density at mean outlet pressure"),
    ("specific_heat_capacity", "", "J/(kg K)", "Specific heat capacity of the liquid"),
    ("fluid_temperature", "", "K", "Temperature of the fluid at the inlet"),
)  # fmt: skip
WITH_EXTREMES = (
    "shaft_speed", "shaft_torque", "pressure_difference", "inlet_pressure", "outlet_pressure",
    "node_pressure", "chamber_pressure", "contact_force", "coupling_torque",
)  # fmt: skip
"""Variables of which a run over time also keeps the lowest and the highest value of each row."""
OVER_A_REVOLUTION = (
    "shaft_torque", "inlet_flow_rate", "outlet_flow_rate", "inlet_pressure", "outlet_pressure",
    "chamber_pressure", "contact_force", "journal_film_height",
)  # fmt: skip
"""Variables of which a steady run keeps the smallest and the largest value of its revolution."""
WAVES = (
    "shaft_torque", "inlet_flow_rate", "outlet_flow_rate", "inlet_pressure", "outlet_pressure",
    "line_flow_rate",
)  # fmt: skip
"""Variables that a steady run keeps at ``dense_angle`` too."""
CHANNELS = (
    "node_pressure", "chamber_pressure", "chamber_gas_fraction", "chamber_vapour_fraction",
    "body_position", "body_velocity", "body_rotation", "body_force", "body_moment",
    "journal_force", "journal_eccentricity_ratio", "journal_film_height",
    "contact_force", "contact_gap", "torque_loss", "power_loss",
)  # fmt: skip
"""Variables with several values in each sample, of which a run over time may keep some."""
_COORDINATES = ("shaft_angle", "time", "casing_angle", "dense_angle")
LABELS: Mapping[str, tuple[str, ...]] = {
    "port": ("inlet", "outlet", "drain", "inlet_groove", "outlet_groove"),
    "axis": ("x", "y", "z"),
    "mechanism": FRICTION_MECHANISMS,
}
"""Labels allowed along these dimensions, of which each machine has some; others are its own."""
LABEL_DIMENSIONS: Mapping[str, str] = {
    "chamber": "chamber, named by family and number",
    "body": "body, named by the machine",
    "journal": "body in a journal bearing, named by the machine",
    "axis": "direction in the frame of the machine",
    "contact": "contact, named by pair and number",
    "tooth": "tooth of the outer rotor, by number",
    "path": "kind of leakage path, named by the machine",
    "mechanism": "cause of friction, those that the machine has",
    "port": "port or relief groove",
    "node": "node of the circuit",
    "film": "lubricating film",
    "heat_node": "oil, body or film of the heat network",
    "tip": "tips of a body along a wall, named by the machine",
    "flow_part": "part of the lost flow, leakage of a path by pressure or by drag, or its cause",
    "mass_entry": "mass account of the ledger",
    "energy_entry": "energy account of the ledger",
}
"""Dimensions whose coordinate is a list of labels, with their meaning."""
STEADY = (
    "displacement_cm3_per_rev", "mean_flow_L_per_min", "mean_torque_N_m", "volumetric_efficiency",
    "hydromechanical_efficiency", "overall_efficiency", "flow_ripple_percent",
    "pressure_ripple_bar", "torque_ripple_percent", "max_chamber_pressure_bar",
    "min_chamber_pressure_bar", "cavitation_index_W", "mean_loaded_contacts",
    "mass_balance_error", "energy_balance_error", "shaft_speed_rpm", "inlet_pressure_bar",
    "outlet_pressure_bar", "shaft_power_W", "hydraulic_power_W", "power_loss_W",
    "inlet_temperature_degC", "outlet_temperature_degC", "drain_temperature_degC",
    "highest_film_temperature_degC", "lost_flow_L_per_min", "mesh_exchange_flow_L_per_min",
    "compression_flow_L_per_min", "gas_flow_L_per_min", "port_volume_flow_L_per_min",
    "bearing_position_um", "loaded_contacts_two_or_more", "loaded_contacts_three_or_more",
    "contact_span", "axial_force_N", "pressure_along_spaces_bar", *LATERAL,
)  # fmt: skip
"""Of a run at an operating point; films add some."""
CURVES: Mapping[str, tuple[str, str, float]] = {
    "outlet_pressure": ("Outlet pressure", "bar", 1.0 / 1e5),
    "inlet_pressure": ("Inlet pressure", "bar", 1.0 / 1e5),
    "outlet_flow_rate": ("Outlet flow", "L/min", 6e4),
    "inlet_flow_rate": ("Inlet flow", "L/min", 6e4),
    "shaft_torque": ("Shaft torque", "N m", 1.0),
    "shaft_speed": ("Shaft speed", "rpm", 30.0 / math.pi),
    "pressure_difference": ("Pressure difference", "bar", 1.0 / 1e5),
}
"""What pages draw over the angle or time: label, unit, and the factor to it."""

OVER_TIME = (
    "startup_pressure_bar", "max_running_pressure_bar", "startup_pressure_ratio",
    "breakaway_time_s", "breakaway_pressure_bar", "settled_pressure_bar",
    "startup_to_settled_ratio", "displacement_cm3_per_rev", "duration_s", "revolutions",
    "max_shaft_speed_rpm", "mean_flow_L_per_min", "mean_torque_N_m",
    "max_pressure_difference_bar", "max_chamber_pressure_bar", "min_chamber_pressure_bar",
    "mass_balance_error", "energy_balance_error", "supply_energy_J", "shaft_energy_J",
    "loss_energy_J", "electric_energy_J", "drive_loss_energy_J", "real_time_factor",
)  # fmt: skip
"""Of a run with a circuit."""
BY_LABEL: Mapping[str, str] = {
    "leakage_": "leakage", "pressure_leakage_": "leakage by pressure",
    "drag_leakage_": "leakage by drag", "torque_loss_": "torque lost", "power_loss_": "power lost",
}  # fmt: skip
"""Beginnings of the names that end with a path or a mechanism of the machine, in words."""
WORDS: Mapping[str, str] = {
    "axial_force": "axial force on the gears",
    "breakaway_time": "time to breakaway",
    "cavitation_index": "power of collapsing vapour",
    "compression_flow": "flow lost to compression",
    "contact_span": "span of loaded contacts in pitches",
    "dead_volume": "volume carried back by the mesh",
    "encapsulated_volume": "volume enclosed in the roots",
    "face_twist": "twist over the face width",
    "gas_flow": "flow lost to free gas",
    "highest_film_temperature": "temperature of the warmest film",
    "kinematic_land_max_half_angle": "half land at the largest pocket, kinematic",
    "kinematic_land_min_half_angle": "half land at the smallest pocket, kinematic",
    "loaded_contacts_three_or_more": "share of a turn with three or more loaded contacts",
    "loaded_contacts_two_or_more": "share of a turn with two or more loaded contacts",
    "lost_flow": "lost flow, all causes",
    "max_running_pressure": "highest pressure while running",
    "mean_loaded_contacts": "loaded contacts on average",
    "mesh_exchange_flow": "flow exchanged in the mesh and by port timing",
    "no_undercut_limit": "largest lobe radius without undercut",
    "port_volume_flow": "flow taken up by ports and lines",
    "power_loss": "lost power",
    "pressure_along_spaces": "pressure difference along a tooth space",
    "sealed_shaft_angle": "shaft angle while a pocket is sealed",
    "smallest_relative_radius": "smallest relative radius of curvature",
    "startup_pressure": "start-up pressure",
    "startup_pressure_ratio": "start-up pressure over that of running",
    "startup_to_settled_ratio": "start-up pressure over the settled one",
}  # fmt: skip
"""Names without their unit for a reader, where the words of the key would not tell."""
UNITS: Mapping[str, str] = {
    "cm3_per_rev": "cm3/rev", "L_per_min": "L/min", "N_m": "N m", "percent": "%", "bar": "bar",
    "rpm": "rpm", "degC": "degC", "deg": "deg", "W": "W", "um": "um", "mm": "mm", "N": "N",
    "mm2": "mm2", "s": "s", "MPa": "MPa", "K": "K", "mrad": "mrad", "W_per_mm2": "W/mm2",
    "um_bar": "um bar", "mm3": "mm3", "kN": "kN", "J": "J", "h": "h", "dBA": "dB(A)", "dB": "dB",
}  # fmt: skip
"""Units by the suffix of a name."""


@final
@dataclass(frozen=True)
class Variable:
    """One result variable."""

    name: str
    """Name in the file."""
    dimensions: tuple[str, ...]
    """Dimensions; ``sample`` stands for ``shaft_angle`` or ``time``."""
    units: str
    """SI unit, ``1`` if dimensionless."""
    long_name: str
    """Meaning and sign."""


def _variables() -> dict[str, Variable]:
    table = {
        name: Variable(name, tuple(dimensions.split()), units, long_name)
        for name, dimensions, units, long_name in _ROWS
    }
    for name in WITH_EXTREMES:
        entry = table[name]
        for extreme in ("lowest", "highest"):
            text = f"{entry.long_name}, {extreme} value within a row"
            key = f"{name}_{extreme}"
            table[key] = Variable(key, entry.dimensions, entry.units, text)
    for name in OVER_A_REVOLUTION:
        entry = table[name]
        labels = tuple(dim for dim in entry.dimensions if dim != SAMPLE)
        for end, word in (("minimum", "smallest"), ("maximum", "largest")):
            text = f"{entry.long_name}, {word} value of the revolution between all samples"
            table[f"{name}_{end}"] = Variable(f"{name}_{end}", labels, entry.units, text)
    for name in WAVES:
        entry = table[name]
        key = f"dense_{name}"
        table[key] = Variable(key, ("dense_angle",), entry.units, entry.long_name)
    return table


VARIABLES: Mapping[str, Variable] = _variables()
"""All result variables by name."""


def variable(name: str) -> Variable:
    """Look up a result variable.

    Raises KeyError if the name is not in the table.
    """
    if name not in VARIABLES:
        raise KeyError(f"unknown result variable '{name}'; add it to results/variables.py")
    return VARIABLES[name]


def dataset_from(
    values: Mapping[str, ArrayLike | xr.Variable],
    labels: Mapping[str, Sequence[str]],
    *,
    sample: SampleDimension = "shaft_angle",
    attributes: Mapping[str, str] | None = None,
) -> xr.Dataset:
    """Build the dataset of a result, with units and long names from the table.

    Parameters
    ----------
    values : mapping of name to array or xarray.Variable
        Values in SI units, axes in the order of the table. With samples, both
        ``shaft_angle`` and ``time`` belong to them. Variables stay where they are, on disk for
        those of :class:`toothspace.results.stream.SampleStream`.
    labels : mapping of dimension to labels
        Labels of the dimensions ``chamber``, ``body``, ``journal``, ``axis``, ``contact``,
        ``path``, ``mechanism``, ``port``.
    sample : str
        Dimension of the samples, ``shaft_angle`` or ``time``.
    attributes : mapping, optional
        ``title``, ``machine`` and ``mode`` of the run.

    Raises
    ------
    KeyError
        If a name is not in the table.
    ValueError
        If an array does not fit its dimensions or labels.
    """
    import xarray as xr

    spare_array_packages()
    for dim, names in labels.items():
        if dim not in LABEL_DIMENSIONS:
            raise KeyError(f"unknown dimension '{dim}'; allowed: {', '.join(LABEL_DIMENSIONS)}")
        unknown = set(names) - set(LABELS.get(dim, names))
        if unknown:
            raise ValueError(f"unknown {dim} label {sorted(unknown)}; allowed: {LABELS[dim]}")
    arrays = {}
    for name, value in values.items():
        entry = variable(name)
        dimensions = tuple(sample if dim == SAMPLE else dim for dim in entry.dimensions)
        if np.ndim(value) != len(dimensions):
            raise ValueError(f"{name} has {np.ndim(value)} axes, the table says {dimensions}")
        if isinstance(value, xr.Variable):
            arrays[name] = value.copy(deep=False)
            arrays[name].encoding = {}
        else:
            arrays[name] = xr.Variable(dimensions, np.asarray(value))
        units = {"units": entry.units} if entry.units else {}
        arrays[name].attrs = {"long_name": entry.long_name} | units
    dataset = xr.Dataset(arrays, attrs=dict(attributes or {}))
    dataset = dataset.assign_coords(
        {
            dim: (dim, np.asarray(list(names), dtype=str), {"long_name": LABEL_DIMENSIONS[dim]})
            for dim, names in labels.items()
        }
    )
    coordinates = [name for name in _COORDINATES if name in dataset]
    return dataset.set_coords(coordinates)


def stem_and_unit(name: str) -> tuple[str, str]:
    """Split a name such as ``mean_flow_L_per_min`` from its unit, ``1`` if it has none."""
    suffix = max((s for s in UNITS if name.endswith(f"_{s}")), key=len, default="")
    return name.removesuffix(f"_{suffix}"), UNITS.get(suffix, "1")


def unit_of(name: str) -> str:
    """Return the unit that the suffix of a name says, ``1`` if it has none."""
    return stem_and_unit(name)[1]


def words_of(name: str) -> str:
    """Return a name for a reader without its unit, such as ``mean flow``."""
    stem, _ = stem_and_unit(name)
    beginning = max((b for b in BY_LABEL if stem.startswith(b)), key=len, default="")
    if stem in WORDS or not beginning:
        return WORDS.get(stem, stem.replace("_", " "))
    return f"{BY_LABEL[beginning]}, {stem.removeprefix(beginning).replace('_', ' ')}"


def label_of(name: str) -> str:
    """Return a name with its unit for a reader, such as ``mean flow (L/min)``."""
    words, unit = words_of(name), stem_and_unit(name)[1]
    return words if unit == "1" else f"{words} ({unit})"


def require_known(wanted: Mapping[str, str], label: str, *, over_time: bool) -> None:
    """Refuse a name that no run gives.

    Parameters
    ----------
    wanted : mapping of str to str
        Names of summary numbers by the key that asks for them.
    label : str
        Name of the case in messages.
    over_time : bool
        Whether the case has a circuit.

    Raises
    ------
    CaseError
        With the nearest known name.
    """
    known = OVER_TIME if over_time else STEADY
    for key, name in wanted.items():
        if name not in known and (over_time or not name.startswith(tuple(BY_LABEL))):
            allowed = suggestion(name, known)
            raise CaseError(f"{key}", f"{name!r}, which is no result", allowed).in_file(label)
