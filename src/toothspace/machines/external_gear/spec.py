"""What an external gear pump or motor is built from: its keys, and what files and library hold.

Frame: origin at the drive gear, y towards the driven gear, x towards the outlet.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, cast, final

import shapely

from toothspace.core.errors import CaseError
from toothspace.core.frozen import Points
from toothspace.core.keys import (
    KeyTable,
    choice,
    file_path,
    forbid,
    integer,
    keys_of,
    number,
    optional,
    quantity,
    require,
    table,
    text,
)
from toothspace.core.types import Array
from toothspace.gearing.gear_tables import (
    CONTOUR_SUFFIXES,
    ReliefGrooveParameters,
    ReliefGrooves,
)
from toothspace.gearing.helix import ALIKE, HelicalGearParameters, Helix
from toothspace.gearing.materials import Material
from toothspace.geometry.cad_import import SOLID_SUFFIXES, is_solid
from toothspace.geometry.continuous_contact import FAMILIES, ContinuousGear, Family
from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.involute import InvoluteGear
from toothspace.geometry.tooth_deviations import ToothDeviations
from toothspace.machines.external_gear.floating.floating_parameters import (
    ElasticBodiesParameters,
    FloatingBearingParameters,
)
from toothspace.machines.shared_tables import (
    LinedBearingParameters,
    MachineTables,
    PortParameters,
    SideGapParameters,
)
from toothspace.model.description import BreakawayLaw, RunningIn, StartupFriction
from toothspace.model.floating_bearing import Patch

if TYPE_CHECKING:
    from toothspace.geometry.gear_finder import FoundGear


_PORTS_AND_GROOVES = 330.0
"""Largest sum of both angles along a bore. [deg]"""
DEVIATION_SUFFIXES = (".csv", ".mka")
OUTLETS = ("+x", "-x", "+y", "-y", "+z", "-z")

_STEP, _STL, _DXF = (".step", ".stp"), (".stl",), (".dxf",)
_READ_FROM = {
    "profile_layer": _DXF,
    "profile_axis": _STL + _STEP,
    "profile_plane": _STL + _STEP,
    "profile_body": _STL + _STEP,
    "profile_part": _STEP,
}
PROFILE_KEYS = ("profile_unit", *_READ_FROM)
"""Keys that say how one file is read."""


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
        raise CaseError(
            "profile_unit", repr(gear.profile_unit), "leave this key out: STEP files have their own"
        )


def forbid_solid_keys(table: CasingParameters | BlockGrooveParameters, *names: str) -> None:
    """Refuse keys of solids beside a contour of another kind."""
    suffix = "" if table.contour is None else table.contour.suffix.lower()
    if not is_solid(table.contour):
        forbid(table, f"unless the contour is a solid ({', '.join(SOLID_SUFFIXES)})", *names)
    elif suffix in _STEP and table.contour_unit != "mm":
        raise CaseError(
            "contour_unit",
            repr(table.contour_unit),
            "leave this key out: STEP files have their own",
        )


SHAPE_KEYS: Mapping[str, tuple[str, ...]] = {
    "arc_involute_arc": ("pressure_angle", "root_clearance"),
    "circular_arc": ("tip_diameter",),
    "sinusoidal": ("tip_diameter",),
}
"""Keys that shape teeth of continuous contact, by their families."""


@final
@dataclass(frozen=True, kw_only=True)
class GearParameters(HelicalGearParameters):
    """``[machine.gears]``: rack-generated involute teeth, or a profile from a file."""

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
    profile_teeth: str = choice(
        "All teeth as the one that fits them, or each as in the outline.",
        "equal",
        "own",
        default="equal",
    )
    tooth_deviations: Path | None = file_path(
        "Deviations of every tooth from a gear tester.", *DEVIATION_SUFFIXES
    )
    family: str = choice(
        "Outline of generated teeth: involutes, or those of continuous contact whose tips roll "
        "through the roots of an equal gear at a centre distance of one pitch diameter; "
        "'continuous_contact' says that of a profile file.",
        "involute",
        "continuous_contact",
        *FAMILIES,
        default="involute",
    )
    tip_land: float | None = quantity(
        "mm",
        "Width to which the round tips of continuous contact are ground; default 0.08 modules.",
        low=0,
        high=20,
        default=None,
    )
    root_clearance: float | None = quantity(
        "mm",
        "Play of tips in roots of family arc_involute_arc, where arcs do not touch; default 0.005 "
        "modules.",
        low=0,
        high=5,
        default=None,
    )

    def __post_init__(self) -> None:
        if self.is_continuous:
            reason = f'with family = "{self.family}"'
            forbid(self, reason, "tooth_deviations", "tool_tip_radius")
            forbid(self, f"{reason}: mating teeth cut its tooth spaces in two", "axial_slices")
            if self.is_drawn:
                require(self, reason, "profile")
                forbid(self, f"{reason}: tips are those of the file", "tip_land", "root_clearance")
                if self.profile_teeth == "own":
                    raise CaseError("profile_teeth", "'own'", f"'equal' {reason}")
            else:
                forbid(self, reason, "profile")
                forbid(self, f"{reason}: pitch circles touch", "center_distance")
                others = {"tip_diameter", "pressure_angle", "root_clearance"}
                forbid(self, reason, *sorted(others - set(self._shape_keys)))
            for name in ("profile_shift", "dedendum"):
                if getattr(self, name) != keys_of(type(self))[name][1].default:
                    raise CaseError(name, f"{getattr(self, name):g}", f"leave it out {reason}")
        else:
            forbid(self, "with involute teeth", "tip_land", "root_clearance")
        if self.helix_angle > 0.0:
            forbid(self, ALIKE, "tooth_deviations")
            if self.profile_teeth == "own":
                raise CaseError("profile_teeth", "'own'", f"'equal' {ALIKE}")
        if self.profile_teeth == "own":
            require(self, 'with profile_teeth = "own"', "profile")
            forbid(self, 'with profile_teeth = "own"', "tooth_deviations")
        super().__post_init__()
        forbid_unread(self)

    @property
    def is_continuous(self) -> bool:
        """Whether tips roll through roots."""
        return self.family != "involute"

    @property
    def is_drawn(self) -> bool:
        """Whether tips roll through roots as drawn in a file."""
        return self.family == "continuous_contact"

    @property
    def _shape_keys(self) -> tuple[str, ...]:
        return SHAPE_KEYS.get(self.family, ())

    @property
    def generator_keys(self) -> tuple[str, ...]:
        """Keys that generated teeth need."""
        if not self.is_continuous:
            return super().generator_keys
        shape = (name for name in self._shape_keys if name != "root_clearance")
        return "tooth_count", "module", *shape, "normal_backlash"

    def continuous_gear(self) -> ContinuousGear:
        """Return the generated gear of continuous contact in the transverse section."""
        assert self.tooth_count is not None
        assert self.module is not None
        module, arcs = self.module / self.slope, self.family == "arc_involute_arc"
        clearance = 0.005 * module if self.root_clearance is None else self.root_clearance
        return ContinuousGear(
            family=cast(Family, self.family),
            tooth_count=self.tooth_count,
            module=module,
            pressure_angle=self.transverse_pressure_angle if arcs else None,
            tip_diameter=self.tip_diameter,
            tip_land=0.08 * module if self.tip_land is None else self.tip_land,
            root_clearance=clearance if arcs else 0.0,
            backlash=self.transverse_backlash,
        )


@final
@dataclass(frozen=True, kw_only=True)
class DrivenGearParameters(KeyTable):
    """``[machine.driven_gear]``: the keys in which the driven gear differs."""

    tooth_count: int | None = optional(GearParameters, "tooth_count")
    profile_shift: float | None = optional(GearParameters, "profile_shift")
    dedendum: float | None = optional(GearParameters, "dedendum")
    tool_tip_radius: float | None = optional(GearParameters, "tool_tip_radius")
    tip_diameter: float | None = optional(GearParameters, "tip_diameter")
    tip_rounding: float | None = optional(GearParameters, "tip_rounding")
    material: str | None = optional(GearParameters, "material")
    roughness: float | None = optional(GearParameters, "roughness")
    profile: Path | Points | None = optional(GearParameters, "profile")
    profile_unit: str | None = optional(GearParameters, "profile_unit")
    profile_layer: str | None = optional(GearParameters, "profile_layer")
    profile_axis: str | None = optional(GearParameters, "profile_axis")
    profile_plane: float | None = optional(GearParameters, "profile_plane")
    profile_body: int | None = optional(GearParameters, "profile_body")
    profile_part: str | None = optional(GearParameters, "profile_part")
    profile_flank: str | None = optional(GearParameters, "profile_flank")
    profile_teeth: str | None = optional(GearParameters, "profile_teeth")
    tooth_deviations: Path | None = optional(GearParameters, "tooth_deviations")

    def __post_init__(self) -> None:
        if self.profile is not None:
            forbid_unread(self)


@final
@dataclass(frozen=True, kw_only=True)
class CasingParameters(KeyTable):
    """``[machine.casing]``: bores round the gears and their port edges."""

    radial_clearance: float = quantity(
        "um", "Bore radius minus tip radius, before wear.", low=1, high=1000
    )
    roughness: float = quantity(
        "um", "Of the bores: keeps tips that touch it apart.", low=0.01, high=100, default=1e-6
    )
    inlet_angle: float | None = quantity(
        "deg",
        "From the mesh side of the centre line to the inlet port edge along the bore, or to the "
        "end of a groove that leads its pressure round the gear; default of a contour.",
        low=5,
        high=300,
        default=None,
    )
    outlet_angle: float | None = quantity(
        "deg",
        "From the mesh side of the centre line to the outlet port edge along the bore, or to the "
        "end of a groove that leads its pressure round the gear; default of a contour.",
        low=5,
        high=300,
        default=None,
    )
    contour: Path | None = file_path(
        "Section of the casing as a closed polygon, or the casing as a solid.",
        *CONTOUR_SUFFIXES,
        *SOLID_SUFFIXES,
    )
    contour_unit: str = choice("Length unit of the contour.", "mm", "m", "um", "in", default="mm")
    contour_body: int | None = integer(
        "Casing in a solid file, the largest body is 0.", low=0, high=1000, default=None
    )
    contour_part: str | None = text("Name of the casing in a STEP file.", default=None)
    contour_plane: float | None = quantity(
        "mm",
        "Height of the section through a solid along the axis; default the middle of the teeth.",
        default=None,
    )
    wear_in: RunningIn | None = table(
        RunningIn, "Running-in condition; leave out for an unworn casing.", default=None
    )

    def __post_init__(self) -> None:
        if self.contour is None:
            require(self, "unless a contour file is given", "inlet_angle", "outlet_angle")
            both = math.degrees((self.inlet_angle or 0.0) + (self.outlet_angle or 0.0))
            if both > _PORTS_AND_GROOVES:
                allowed = f"at most {_PORTS_AND_GROOVES:g} deg, so that teeth seal between them"
                found = f"{both:.6g} deg together with outlet_angle"
                raise CaseError("inlet_angle", found, allowed)
        forbid_solid_keys(self, "contour_body", "contour_part", "contour_plane")


@final
@dataclass(frozen=True, kw_only=True)
class BearingBlockParameters(KeyTable):
    """``[machine.bearing_blocks]``."""

    radial_clearance: float = quantity(
        "um", "Radial clearance of the blocks in the housing.", low=0, high=500
    )
    motion: str = choice(
        "Rest where the mean load at rest presses them, or follow the load in time.",
        "seated",
        "free",
        default="seated",
    )
    port_area: float | None = quantity(
        "mm^2",
        "Of free blocks: projected area on which port pressures press them towards the other port; "
        "default 0.",
        low=0,
        high=1e5,
        default=None,
    )
    roughness: float = quantity(
        "um",
        "Of free blocks: combined roughness with the housing.",
        low=0.01,
        high=10,
        default=1e-6,
    )
    material: str = text("Of free blocks: material from the library.", default="AlSi")

    def __post_init__(self) -> None:
        if self.motion == "seated":
            forbid(self, "with seated blocks", "port_area")
        elif self.radial_clearance == 0.0:
            raise CaseError("radial_clearance", "0 um", "above 0 um of free blocks")


@final
@dataclass(frozen=True, kw_only=True)
class LaggingGrooveParameters(KeyTable):
    """``[machine.relief_grooves.lagging_face]``: the keys in which that face differs."""

    closing_side_offset: float | None = optional(ReliefGrooveParameters, "closing_side_offset")
    opening_side_offset: float | None = optional(ReliefGrooveParameters, "opening_side_offset")
    closing_side_angle: float | None = optional(ReliefGrooveParameters, "closing_side_angle")
    opening_side_angle: float | None = optional(ReliefGrooveParameters, "opening_side_angle")
    closing_side_bow: float | None = optional(ReliefGrooveParameters, "closing_side_bow")
    opening_side_bow: float | None = optional(ReliefGrooveParameters, "opening_side_bow")
    width: float | None = optional(ReliefGrooveParameters, "width")
    radial_extent: float | None = optional(ReliefGrooveParameters, "radial_extent")
    depth: float | None = optional(ReliefGrooveParameters, "depth")
    contour: Path | None = optional(ReliefGrooveParameters, "contour")

    @property
    def given(self) -> dict[str, Any]:
        """Keys that stand in the table."""
        found = {f.name: getattr(self, f.name) for f in fields(self)}
        return {name: value for name, value in found.items() if value is not None}


@final
@dataclass(frozen=True, kw_only=True)
class BlockGrooveParameters(ReliefGrooveParameters):
    """``[machine.relief_grooves]``: in each face beside the gears, or those of a bearing block."""

    contour: Path | None = file_path(
        "Closed groove polygons in the machine frame, right of the centre line the closing side; "
        "or the bearing block as a solid.",
        *CONTOUR_SUFFIXES,
        *SOLID_SUFFIXES,
    )
    contour_unit: str = choice("Length unit of the contour.", "mm", "m", "um", "in", default="mm")
    contour_body: int | None = integer(
        "Bearing block in a solid file, the largest body is 0.", low=0, high=1000, default=None
    )
    contour_part: str | None = text("Name of the bearing block in a STEP file.", default=None)
    lagging_face: LaggingGrooveParameters | None = table(
        LaggingGrooveParameters,
        "Of helical gears: where the grooves at the end of the teeth that lags differ from those "
        "at the end that leads.",
        default=None,
    )

    def __post_init__(self) -> None:
        forbid_solid_keys(self, "contour_body", "contour_part")
        super().__post_init__()
        if self.lagging_face is not None:
            self.lagging()

    def lagging(self) -> BlockGrooveParameters:
        """Return the grooves of the face at the lagging end.

        Raises CaseError if they are impossible, or the contour hides what differs.
        """
        assert self.lagging_face is not None
        given = self.lagging_face.given
        if self.contour is not None and "contour" not in given:
            found = f"{next(iter(given), 'nothing')} beside the contour of the other face"
            raise CaseError("lagging_face.contour", found, "a contour of this face, too")
        own: dict[str, Any] = dict.fromkeys(("lagging_face", "contour_body", "contour_part"))
        try:
            return replace(self, **own | given)
        except CaseError as error:
            raise error.under("lagging_face") from error


@final
@dataclass(frozen=True, kw_only=True)
class JournalBearingParameters(LinedBearingParameters):
    """``[machine.journal_bearings]``: two equal bearings on each gear."""

    friction: str = choice(
        "Friction from film and asperities, or the published curve over the Sommerfeld number of "
        "a gear motor's bushes (18 mm by 19 mm, clearance ratio 8.9e-4).",
        "film",
        "published_curve",
        default="film",
    )


@final
@dataclass(frozen=True, kw_only=True)
class LateralParameters(SideGapParameters):
    """``[machine.lateral]``: films between gear faces and bushings."""

    each = "side_gap_floating", "side_gap_solid"

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
        "Floating bushings on both sides, on one side, plates, or bushings that rest with the "
        "gears free between them.",
        "symmetric",
        "asymmetric",
        "plates",
        "fixed",
        default="symmetric",
    )


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
        "Whether the breakaway torque is the whole resistance at rest, is added to the films, or "
        "follows from the boundary friction of journals, faces, mesh and seal at their loads.",
        "total",
        "additive",
        "interfaces",
        default="total",
    )
    breakaway_torque: float | None = quantity(
        "N m",
        "Torque that starts the shaft; left out where it follows from the interfaces.",
        low=0,
        high=1000,
        default=None,
    )
    breakaway_speed: float = quantity("rad/s", "Speed of the friction peak.", above=0, high=1000)

    seal_rest_ratio: float | None = number(
        "Friction of the shaft seal at rest over that in running; default 1.",
        low=1,
        high=20,
        default=None,
    )

    def __post_init__(self) -> None:
        if self.breakaway == "interfaces":
            forbid(self, 'with breakaway = "interfaces"', "breakaway_torque")
        else:
            require(self, 'unless breakaway = "interfaces"', "breakaway_torque")
            forbid(self, 'without breakaway = "interfaces"', "seal_rest_ratio")

    @property
    def friction(self) -> StartupFriction | None:
        """Friction that holds the shaft at rest, None without a breakaway torque."""
        if self.breakaway_torque == 0.0:
            return None
        return StartupFriction(
            law=cast(BreakawayLaw, self.breakaway),
            torque=self.breakaway_torque or 0.0,
            speed=self.breakaway_speed,
            seal_ratio=self.seal_rest_ratio or 1.0,
        )


@dataclass(frozen=True, kw_only=True)
class ExternalGearTables(MachineTables):
    """Tables and keys of ``[machine]`` for external gears."""

    part_tables: ClassVar[Mapping[str, str]] = {
        "running_in": "casing.wear_in",
        "floating_part": "floating_bearing",
        "elastic_bodies": "elastic_bodies",
        "startup": "startup",
    }
    """Tables of parts that not every preset uses."""
    clearance_keys: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "conforming": ("bearing_blocks.radial_clearance",),
        "round": ("journal_bearings.radial_clearance",),
        "faces": (
            "lateral.side_gap",
            *(f"lateral.{name}" for name in LateralParameters.each),
        ),
    }
    """Keys of the clearances that wear opens: of bushes that take the shape of the shaft, of bushes
    that stay round, and of faces.
    """

    outlet_toward: str | None = choice(
        "Direction in the file of the gears from their centre line towards the outlet, where "
        "casing or bearing block come from that file or from others that share its frame.",
        *OUTLETS,
        default=None,
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
    relief_grooves: BlockGrooveParameters | None = table(
        BlockGrooveParameters, "Relief grooves; leave out for none.", default=None
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

    @property
    def covers_rest(self) -> bool:
        """Whether nothing beside the gears floats."""
        return self.floating_bearing is None

    @property
    def missing_floating_part(self) -> str:
        """Message about what the balance of the floating bearing would need; empty if given."""
        bearing = self.floating_bearing
        fixed = self.lateral.arrangement == "fixed"
        if bearing is not None and (fixed or bearing.high_pressure_area is not None):
            return ""
        return (
            "machine.floating_bearing: found no high_pressure_area, allowed a floating bearing "
            "with the area that balances it"
        )


@final
@dataclass(frozen=True, kw_only=True)
class Gear:
    """One gear: its tooth, its size out of the plane and its surface."""

    tooth: InvoluteGear | GearProfile
    """Generated by rack tooling, or a profile from CAD, a measurement or of continuous contact."""
    face_width: float
    """Axial width. [m]"""
    material: Material
    """Material of the gear."""
    roughness: float = 0.25e-6
    """Root mean square roughness of flanks and faces. [m]"""
    tip_rounding: float = 0.1e-3
    """Radius of the edge between flank and tip, for throats that end at a sharp corner. [m]"""
    found: FoundGear | None = None
    """What the profile file held; None for generated teeth."""
    deviations: ToothDeviations | None = None
    """Deviations of every tooth from the tooth; None where all are equal."""


@final
@dataclass(frozen=True, kw_only=True)
class FloatingBlock:
    """Bearing block or plate that pressure presses against the gears."""

    keys: FloatingBearingParameters
    """``[machine.floating_bearing]``."""
    material: Material
    """Material of the bearing."""
    length: float
    """Axial length. [m]"""
    arrangement: str = "asymmetric"
    """``symmetric``, ``asymmetric``, ``plates`` or ``fixed``."""
    high_pressure_contour: Array | None = None
    nose_contour: Array | None = None
    """Outlines on the back face from files. Shape (points, 2). [m]"""

    @property
    def high_pressure(self) -> Patch:
        """Part of the back face at high pressure, where it is given as a number."""
        given = self.keys.high_pressure_area
        return _patch(None if given is None else given.area, given and given.center)

    @property
    def nose(self) -> Patch:
        """Part of the back face with a pressure of its own."""
        if self.nose_contour is not None:
            shape = shapely.Polygon(self.nose_contour)
            return Patch(float(shape.area), (float(shape.centroid.x), float(shape.centroid.y)))
        given = self.keys.nose
        return _patch(given and given.area, given and given.center)

    def is_floating(self, side: str) -> bool:
        """Whether the bearing on a side is pressed on its back and held by nothing else."""
        if self.arrangement == "fixed":
            return False
        return side == "floating" or self.arrangement != "asymmetric"


def _patch(area: float | None, center: tuple[float, float] | None) -> Patch:
    return Patch(area or 0.0, center or (0.0, 0.0))


@final
@dataclass(frozen=True, kw_only=True)
class ExternalGearSpec:
    """Everything that defines an external gear machine."""

    keys: ExternalGearTables
    """``[machine]``."""
    drive: Gear
    driven: Gear
    """Shaft gear and idle gear."""
    center_distance: float | None
    """Distance of the gear centres, given or as drawn; None: that of the backlash. [m]"""
    bush: Material
    """Running layer of the journal bearings."""
    seal_torque: float = 0.0
    """Torque of the shaft seal. [N m]"""
    casing_contour: Array | None = None
    """Section of the casing as a closed polygon; replaces clearance and angles where it departs
    from the bores: beyond three clearances the space counts as port. Shape (points, 2). [m]
    """
    grooves: ReliefGrooves | None = None
    """Relief grooves of the faces, None without."""
    lagging_grooves: ReliefGrooves | None = None
    """Those of the face at the end of the teeth that lags, None where both faces are equal."""
    floating_block: FloatingBlock | None = None
    """Force balance of the floating bearing, None without."""

    @property
    def helix(self) -> Helix | None:
        """How the teeth wind about the axes; None for spur gears."""
        gears, tooth = self.keys.gears, self.drive.tooth
        profile = tooth if gears.profile and isinstance(tooth, GearProfile) else None
        width = self.drive.face_width
        return gears.helix(width, profile, flanks_in_turn=gears.is_continuous)

    @property
    def continuous(self) -> ContinuousGear | None:
        """Generated gears of continuous contact; None for other teeth."""
        gears = self.keys.gears
        return gears.continuous_gear() if gears.is_continuous and not gears.is_drawn else None

    @property
    def shaft_radius(self) -> float:
        """Radius of the journals. [m]."""
        return 0.5 * self.keys.journal_bearings.diameter
