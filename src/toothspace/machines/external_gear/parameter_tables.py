"""Tables of ``[machine]`` for external gear pumps and motors, read to SI units.

The classes mirror the case file; :mod:`toothspace.machines.external_gear.from_parameters` turns
them into the geometry that the machine is built from.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import final

from toothspace.core.frozen import Points
from toothspace.core.keys import (
    KeyRuleError,
    KeyTable,
    choice,
    file_path,
    forbid,
    integer,
    number,
    quantity,
    require,
    table,
    text,
)
from toothspace.machines.external_gear.floating_parameters import (
    CONTOUR_SUFFIXES,
    ElasticBodiesParameters,
    FloatingBearingParameters,
)

PROFILE_SUFFIXES = (".txt", ".csv", ".dxf", ".stl", ".step", ".stp")
PROFILE_KEYS = (
    "profile_unit",
    "profile_layer",
    "profile_axis",
    "profile_plane",
    "profile_body",
    "profile_part",
)
"""Keys that say how one file is read."""

_STEP, _STL, _DXF = (".step", ".stp"), (".stl",), (".dxf",)
_READ_FROM = {
    "profile_layer": _DXF,
    "profile_axis": _STL + _STEP,
    "profile_plane": _STL + _STEP,
    "profile_body": _STL + _STEP,
    "profile_part": _STEP,
}


def forbid_unread(gear: GearParameters | DrivenGearParameters) -> None:
    """Refuse a key that the format of the profile file does not have."""
    if gear.profile is None:
        forbid(gear, "without profile", *_READ_FROM)
        return
    suffix = gear.profile.suffix.lower() if isinstance(gear.profile, Path) else "points"
    for name, suffixes in _READ_FROM.items():
        if suffix not in suffixes:
            forbid(gear, f"with {suffix} (it is read from {', '.join(suffixes)})", name)
    if suffix in _STEP and gear.profile_unit not in (None, "mm"):
        raise KeyRuleError(
            "profile_unit", repr(gear.profile_unit), "leave this key out: STEP files have their own"
        )


@final
@dataclass(frozen=True, kw_only=True)
class GearParameters(KeyTable):
    """``[machine.gears]``: rack-generated involute teeth, or a profile from a file."""

    tooth_count: int | None = integer("Number of teeth.", low=5, high=200, default=None)
    module: float | None = quantity(
        "mm", "Module of the generating rack.", low=0.1, high=50, default=None
    )
    pressure_angle: float | None = quantity(
        "deg", "Pressure angle of the generating rack.", low=10, high=35, default=None
    )
    profile_shift: float = number(
        "Shift of the rack away from the gear, in modules.", low=-1.0, high=1.5, default=0.0
    )
    dedendum: float = number(
        "Depth of the tooth below the reference line, in modules.", low=0.5, high=2.0, default=1.25
    )
    tool_tip_radius: float | None = number(
        "Radius of the rack tip, in modules; default 0.38, or the full radius if that is less.",
        low=0.0,
        high=0.6,
        default=None,
    )
    tip_diameter: float | None = quantity(
        "mm", "Diameter of the tip circle.", above=0, high=1000, default=None
    )
    tip_rounding: float = quantity(
        "mm", "Radius of the edge between flank and tip.", low=0, high=5, default=0.1e-3
    )
    face_width: float = quantity("mm", "Axial width of the gear.", above=0, high=500)
    normal_backlash: float | None = quantity(
        "mm", "Play between the flanks along the line of action.", low=0, high=2, default=None
    )
    center_distance: float | None = quantity(
        "mm", "Distance of the gear centres.", above=0, high=1000, default=None
    )
    material: str = text("Material from the library.", default="steel_16CrNi4")
    roughness: float = quantity(
        "um", "Root mean square roughness of flanks and faces.", low=0, high=10, default=0.25e-6
    )
    profile: Path | Points | None = file_path(
        "Closed tooth or gear profile; replaces the generator.", *PROFILE_SUFFIXES, points=True
    )
    profile_unit: str = choice("Length unit of the profile.", "mm", "m", "um", "in", default="mm")
    profile_layer: str | None = text("Layer of a DXF file; default all.", default=None)
    profile_axis: str | None = choice(
        "Gear axis in a solid file; default found by symmetry.", "x", "y", "z", default=None
    )
    profile_plane: float | None = quantity(
        "mm",
        "Height of the section through a solid along the axis; default the middle of the teeth.",
        default=None,
    )
    profile_body: int | None = integer(
        "Body of a solid file, the largest is 0; default the largest with teeth.",
        low=0,
        high=1000,
        default=None,
    )
    profile_part: str | None = text("Name of the body in a STEP file.", default=None)
    profile_flank: str = choice(
        "Smooth involute that fits the flanks, or the outline as drawn.",
        "fitted",
        "drawn",
        default="fitted",
    )

    def __post_init__(self) -> None:
        if self.profile is None:
            reason = "unless a profile file is given"
            require(self, reason, "tooth_count", "module", "pressure_angle", "tip_diameter")
        if self.normal_backlash is None:
            require(self, "unless normal_backlash is given", "center_distance")
        else:
            forbid(self, "because normal_backlash is given", "center_distance")
        forbid_unread(self)


@final
@dataclass(frozen=True, kw_only=True)
class DrivenGearParameters(KeyTable):
    """``[machine.driven_gear]``: the keys in which the driven gear differs."""

    tooth_count: int | None = integer("Number of teeth.", low=5, high=200, default=None)
    profile_shift: float | None = number(
        "Shift of the rack away from the gear, in modules.", low=-1.0, high=1.5, default=None
    )
    dedendum: float | None = number(
        "Depth of the tooth below the reference line, in modules.", low=0.5, high=2.0, default=None
    )
    tool_tip_radius: float | None = number(
        "Radius of the rack tip, in modules.", low=0.0, high=0.6, default=None
    )
    tip_diameter: float | None = quantity(
        "mm", "Diameter of the tip circle.", above=0, high=1000, default=None
    )
    tip_rounding: float | None = quantity(
        "mm", "Radius of the edge between flank and tip.", low=0, high=5, default=None
    )
    material: str | None = text("Material from the library.", default=None)
    roughness: float | None = quantity(
        "um", "Root mean square roughness of flanks and faces.", low=0, high=10, default=None
    )
    profile: Path | Points | None = file_path(
        "Closed tooth or gear profile.", *PROFILE_SUFFIXES, points=True
    )
    profile_unit: str | None = choice(
        "Length unit of the profile.", "mm", "m", "um", "in", default=None
    )
    profile_layer: str | None = text("Layer of a DXF file.", default=None)
    profile_axis: str | None = choice("Gear axis in a solid file.", "x", "y", "z", default=None)
    profile_plane: float | None = quantity(
        "mm", "Height of the section through a solid along the axis.", default=None
    )
    profile_body: int | None = integer("Body of a solid file.", low=0, high=1000, default=None)
    profile_part: str | None = text("Name of the body in a STEP file.", default=None)
    profile_flank: str | None = choice(
        "Smooth involute that fits the flanks, or the outline as drawn.",
        "fitted",
        "drawn",
        default=None,
    )

    def __post_init__(self) -> None:
        if self.profile is not None:
            forbid_unread(self)


@final
@dataclass(frozen=True, kw_only=True)
class WearInParameters(KeyTable):
    """``[machine.casing.wear_in]``: condition at which the gears cut into the casing."""

    pressure: float = quantity("bar", "Pressure on the high-pressure side.", above=0, high=1000)
    shaft_speed: float = quantity("rpm", "Shaft speed.", above=0, high=50000)
    temperature: float = quantity("degC", "Fluid temperature.", low=-60, high=250)


@final
@dataclass(frozen=True, kw_only=True)
class CasingParameters(KeyTable):
    """``[machine.casing]``: bores round the gears and their port edges."""

    radial_clearance: float = quantity(
        "um", "Bore radius minus tip radius, before wear.", low=1, high=1000
    )
    inlet_angle: float = quantity(
        "deg",
        "From the mesh side of the centre line to the inlet port edge along the bore.",
        low=5,
        high=170,
    )
    outlet_angle: float = quantity(
        "deg",
        "From the mesh side of the centre line to the outlet port edge along the bore.",
        low=5,
        high=170,
    )
    contour: Path | None = file_path(
        "Section of the casing as a closed polygon.", *CONTOUR_SUFFIXES
    )
    wear_in: WearInParameters | None = table(
        WearInParameters, "Running-in condition; leave out for an unworn casing.", default=None
    )


@final
@dataclass(frozen=True, kw_only=True)
class BearingBlockParameters(KeyTable):
    """``[machine.bearing_blocks]``."""

    radial_clearance: float = quantity(
        "um", "Radial clearance of the blocks in the housing.", low=0, high=500
    )


@final
@dataclass(frozen=True, kw_only=True)
class JournalBearingParameters(KeyTable):
    """``[machine.journal_bearings]``: two equal bearings on each gear."""

    diameter: float = quantity("mm", "Journal diameter.", above=0, high=500)
    length: float = quantity("mm", "Length of each bearing.", above=0, high=500)
    radial_clearance: float = quantity("um", "Bush radius minus journal radius.", low=1, high=500)
    roughness_shaft: float = quantity(
        "um", "Root mean square roughness of the journal.", low=0, high=10, default=0.15e-6
    )
    roughness_bush: float = quantity(
        "um", "Root mean square roughness of the bush.", low=0, high=10, default=0.30e-6
    )
    boundary_friction: float = number(
        "Friction coefficient of touching asperities.", low=0, high=1, default=0.05
    )
    material: str = text("Running layer of the bush.", default="ptfe_lined_bush")
    friction: str = choice(
        "Friction from film and asperities, or the published curve over the Sommerfeld number of "
        "a gear motor's bushes (18 mm by 19 mm, clearance ratio 8.9e-4).",
        "film",
        "published_curve",
        default="film",
    )


@final
@dataclass(frozen=True, kw_only=True)
class ReliefGrooveParameters(KeyTable):
    """``[machine.relief_grooves]``: per bushing face."""

    closing_side_offset: float | None = quantity(
        "mm",
        "From the centre line to the edge of the groove on the side where trapped volume shrinks.",
        low=-50,
        high=100,
        default=None,
    )
    opening_side_offset: float | None = quantity(
        "mm",
        "From the centre line to the edge of the groove on the side where trapped volume grows.",
        low=-50,
        high=100,
        default=None,
    )
    width: float = quantity("mm", "Extent along x.", above=0, high=200, default=10e-3)
    radial_extent: float = quantity(
        "mm", "Extent along y, centred on the pitch point.", above=0, high=200, default=10e-3
    )
    depth: float = quantity("mm", "Depth into the face.", above=0, high=100, default=1.5e-3)
    contour: Path | None = file_path(
        "Closed groove polygons in the machine frame, right of the centre line the closing side.",
        *CONTOUR_SUFFIXES,
    )

    def __post_init__(self) -> None:
        if self.contour is None:
            reason = "unless a contour file is given"
            require(self, reason, "closing_side_offset", "opening_side_offset")


@final
@dataclass(frozen=True, kw_only=True)
class LateralParameters(KeyTable):
    """``[machine.lateral]``: films between gear faces and bushings."""

    side_gap: float | None = quantity(
        "um", "Film height of both faces.", low=0.1, high=500, default=None
    )
    side_gap_floating: float | None = quantity(
        "um", "Film height at the floating side.", low=0.1, high=500, default=None
    )
    side_gap_solid: float | None = quantity(
        "um", "Film height at the solid side.", low=0.1, high=500, default=None
    )
    tilt: float = number(
        "Change of height at the tip radius over the mean height.", low=0, high=0.99, default=0.0
    )
    arrangement: str = choice(
        "Floating bushings on both sides, on one side, or plates.",
        "symmetric",
        "asymmetric",
        "plates",
        default="symmetric",
    )

    def __post_init__(self) -> None:
        if self.side_gap is None:
            reason = "unless side_gap is given"
            require(self, reason, "side_gap_floating", "side_gap_solid")
        else:
            forbid(self, "because side_gap is given", "side_gap_floating", "side_gap_solid")


@final
@dataclass(frozen=True, kw_only=True)
class SealParameters(KeyTable):
    """``[machine.seals]``."""

    shaft_seal_torque: float | None = quantity(
        "N m", "Friction of the shaft seal.", low=0, high=100, default=None
    )
    table: Path | None = file_path(
        "Or its friction force at the lip: columns temperature [degC], penetration [mm] and "
        "friction_force [N] of a full grid.",
        ".csv",
    )
    temperature: float | None = quantity(
        "degC", "Temperature of the lip, with a table.", low=-60, high=250, default=None
    )
    penetration: float | None = quantity(
        "mm", "Penetration of the lip, with a table.", low=0, high=10, default=None
    )

    def __post_init__(self) -> None:
        if self.table is None:
            require(self, "unless a table is given", "shaft_seal_torque")
            forbid(self, "without a table", "temperature", "penetration")
        else:
            forbid(self, "because a table is given", "shaft_seal_torque")
            require(self, "with a table", "temperature", "penetration")


@final
@dataclass(frozen=True, kw_only=True)
class StartupParameters(KeyTable):
    """``[machine.startup]``: friction at rest."""

    breakaway: str = choice(
        "Whether the breakaway torque is the whole resistance at rest or is added to the films.",
        "total",
        "additive",
        default="total",
    )
    breakaway_torque: float = quantity("N m", "Torque that starts the shaft.", low=0, high=1000)
    breakaway_speed: float = quantity("rad/s", "Speed of the friction peak.", above=0, high=1000)


@final
@dataclass(frozen=True, kw_only=True)
class PortParameters(KeyTable):
    """``[machine.inlet]`` and ``[machine.outlet]``."""

    volume: float = quantity(
        "cm^3", "Fluid volume between machine and line.", low=0.1, high=1e5, default=50e-6
    )


@dataclass(frozen=True, kw_only=True)
class ExternalGearTables(KeyTable):
    """Tables and keys of ``[machine]`` for external gears."""

    mode: str = choice("What the machine is used as.", "pump", "motor")
    drain: str | None = choice(
        "Node that collects the drain; default the low-pressure port.",
        "inlet",
        "outlet",
        "external",
        default=None,
    )
    drain_pressure: float | None = quantity(
        "bar", "Absolute pressure of an external drain.", above=0, high=100, default=None
    )
    gears: GearParameters = table(GearParameters, "Both gears.")
    driven_gear: DrivenGearParameters | None = table(
        DrivenGearParameters, "Where the driven gear differs.", default=None
    )
    casing: CasingParameters = table(CasingParameters, "Bores and port edges.")
    bearing_blocks: BearingBlockParameters | None = table(
        BearingBlockParameters, "Seat of the bearing blocks in the housing.", default=None
    )
    journal_bearings: JournalBearingParameters = table(
        JournalBearingParameters, "Journal bearings of both gears."
    )
    relief_grooves: ReliefGrooveParameters | None = table(
        ReliefGrooveParameters, "Relief grooves; leave out for none.", default=None
    )
    lateral: LateralParameters = table(LateralParameters, "Lateral films.")
    floating_bearing: FloatingBearingParameters | None = table(
        FloatingBearingParameters, "Balance of the floating bearing.", default=None
    )
    elastic_bodies: ElasticBodiesParameters | None = table(
        ElasticBodiesParameters, "STEP files of bearings and gears.", default=None
    )
    seals: SealParameters | None = table(SealParameters, "Shaft seal.", default=None)
    startup: StartupParameters | None = table(StartupParameters, "Friction at rest.", default=None)
    inlet: PortParameters = table(PortParameters, "Inlet volume.", default=PortParameters())
    outlet: PortParameters = table(PortParameters, "Outlet volume.", default=PortParameters())

    def __post_init__(self) -> None:
        if self.drain == "external":
            require(self, 'with drain = "external"', "drain_pressure")
        else:
            forbid(self, 'unless drain = "external"', "drain_pressure")
