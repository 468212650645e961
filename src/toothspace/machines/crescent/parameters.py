"""Keys of ``[machine]`` for internal gear pumps and motors with crescent, read to SI units."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

from toothspace.core.frozen import Points
from toothspace.core.keys import (
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

PROFILE_SUFFIXES = (".txt", ".csv", ".dxf", ".stl", ".step", ".stp")


@final
@dataclass(frozen=True, kw_only=True)
class PinionParameters(KeyTable):
    """``[machine.pinion]``: rack-generated involute teeth, or a profile from a file."""

    tooth_count: int | None = integer("Number of teeth.", low=5, high=100, default=None)
    module: float | None = quantity("mm", "Module of both gears.", low=0.1, high=50, default=None)
    pressure_angle: float | None = quantity(
        "deg", "Pressure angle of both gears.", low=10, high=35, default=None
    )
    profile_shift: float = number(
        "Shift of the rack away from the pinion, in modules.", low=-1.0, high=1.5, default=0.0
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
        "mm", "Radius of the edge between flank and tip.", low=0, high=5, default=0.05e-3
    )
    face_width: float = quantity("mm", "Axial width of both gears.", above=0, high=500)
    normal_backlash: float | None = quantity(
        "mm", "Play between the flanks along the line of action.", low=0, high=2, default=None
    )
    center_distance: float | None = quantity(
        "mm", "Distance of the gear centres.", above=0, high=500, default=None
    )
    material: str = text("Material from the library.", default="steel_16CrNi4")
    roughness: float = quantity(
        "um", "Root mean square roughness of flanks and faces.", low=0, high=10, default=0.25e-6
    )
    profile: Path | Points | None = file_path(
        "Closed profile; replaces the generator, together with that of the ring.",
        *PROFILE_SUFFIXES,
        points=True,
    )
    profile_unit: str = choice(
        "Length unit of the profile files.", "mm", "m", "um", "in", default="mm"
    )

    def __post_init__(self) -> None:
        if self.profile is None:
            reason = "unless a profile file is given"
            require(self, reason, "tooth_count", "module", "pressure_angle", "tip_diameter")
        else:
            require(self, "with a profile file", "center_distance")
        if self.normal_backlash is None:
            require(self, "unless normal_backlash is given", "center_distance")
        else:
            forbid(self, "because normal_backlash is given", "center_distance")


@final
@dataclass(frozen=True, kw_only=True)
class RingParameters(KeyTable):
    """``[machine.ring]``: teeth inside, a bearing surface outside."""

    tooth_count: int | None = integer("Number of teeth.", low=8, high=400, default=None)
    profile_shift: float = number(
        "Shift that widens the tooth spaces, in modules.", low=-1.0, high=2.5, default=0.0
    )
    tip_diameter: float | None = quantity(
        "mm", "Diameter of the circle inside the teeth.", above=0, high=1000, default=None
    )
    root_diameter: float | None = quantity(
        "mm", "Diameter of the circle at the bottom of the spaces.", above=0, high=1000,
        default=None,
    )  # fmt: skip
    root_fillet: float = quantity(
        "mm", "Radius between flank and root circle.", low=0, high=10, default=0.2e-3
    )
    outer_diameter: float = quantity("mm", "Outside diameter.", above=0, high=1000)
    radial_clearance: float = quantity(
        "um", "Housing bore radius minus outside radius.", low=1, high=1000
    )
    bore_roughness: float = quantity(
        "um", "Root mean square roughness of the housing bore.", low=0, high=10, default=0.4e-6
    )
    boundary_friction: float = number(
        "Friction coefficient of touching asperities in the bore.", low=0, high=1, default=0.08
    )
    material: str = text("Material from the library.", default="steel_16CrNi4")
    roughness: float = quantity(
        "um", "Root mean square roughness of flanks and faces.", low=0, high=10, default=0.25e-6
    )
    profile: Path | Points | None = file_path(
        "Closed curve of the teeth inside the ring.", *PROFILE_SUFFIXES, points=True
    )

    def __post_init__(self) -> None:
        if self.profile is None:
            reason = "unless a profile file is given"
            require(self, reason, "tooth_count", "tip_diameter", "root_diameter")


@final
@dataclass(frozen=True, kw_only=True)
class FillerParameters(KeyTable):
    """``[machine.filler]``: crescent between both tip circles."""

    inlet_angle: float = quantity(
        "deg",
        "From the mesh side of the centre line to the end of the filler at the inlet, about the "
        "centre of the pinion.",
        low=30,
        high=170,
    )
    outlet_angle: float = quantity("deg", "The same at the outlet.", low=30, high=170)
    pinion_clearance: float = quantity(
        "um", "Gap to the tip circle of the pinion.", low=0.5, high=1000
    )
    ring_clearance: float = quantity("um", "Gap to the tip circle of the ring.", low=0.5, high=1000)
    compensation: str = choice(
        "Whether the filler stands in the housing, or its halves are pressed radially against the "
        "teeth and follow the gears with these gaps.",
        "none",
        "radial",
        default="none",
    )


@final
@dataclass(frozen=True, kw_only=True)
class CrescentPortContourParameters(KeyTable):
    """``[machine.ports]``: recesses in both covers between mesh and filler."""

    inlet_start: float = quantity(
        "deg",
        "From the mesh side of the centre line to the begin of the inlet recess, about the centre "
        "of the pinion.",
        low=1,
        high=160,
    )
    outlet_start: float = quantity("deg", "The same at the outlet.", low=1, high=160)
    depth: float = quantity("mm", "Depth into the cover.", above=0, high=200, default=10e-3)


@final
@dataclass(frozen=True, kw_only=True)
class CrescentReliefGrooveParameters(KeyTable):
    """``[machine.relief_grooves]``: per cover."""

    closing_side_offset: float = quantity(
        "mm",
        "From the centre line to the edge of the groove on the side where trapped volume shrinks.",
        low=-50,
        high=100,
    )
    opening_side_offset: float = quantity(
        "mm",
        "From the centre line to the edge of the groove on the side where trapped volume grows.",
        low=-50,
        high=100,
    )
    width: float = quantity("mm", "Extent along x.", above=0, high=200, default=10e-3)
    radial_extent: float = quantity(
        "mm", "Extent along y, centred on the pitch point.", above=0, high=200, default=10e-3
    )
    depth: float = quantity("mm", "Depth into the cover.", above=0, high=100, default=1.5e-3)


@final
@dataclass(frozen=True, kw_only=True)
class CrescentJournalBearingParameters(KeyTable):
    """``[machine.journal_bearings]``: two equal bearings of the pinion."""

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


@final
@dataclass(frozen=True, kw_only=True)
class CrescentLateralParameters(KeyTable):
    """``[machine.lateral]``: films between the faces of the gears and the covers."""

    side_gap: float = quantity("um", "Film height of both faces.", low=0.1, high=500)


@final
@dataclass(frozen=True, kw_only=True)
class CrescentSealParameters(KeyTable):
    """``[machine.seals]``."""

    shaft_seal_torque: float = quantity("N m", "Friction of the shaft seal.", low=0, high=100)


@final
@dataclass(frozen=True, kw_only=True)
class CrescentPortParameters(KeyTable):
    """``[machine.inlet]`` and ``[machine.outlet]``."""

    volume: float = quantity(
        "cm^3", "Fluid volume between machine and line.", low=0.1, high=1e5, default=100e-6
    )


@final
@dataclass(frozen=True, kw_only=True)
class CrescentParameters(KeyTable):
    """``[machine]`` with ``type = "crescent"``."""

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
    pinion: PinionParameters = table(PinionParameters, "Gear on the shaft.")
    ring: RingParameters = table(RingParameters, "Ring gear round it.")
    filler: FillerParameters = table(FillerParameters, "Crescent between the gears.")
    ports: CrescentPortContourParameters = table(
        CrescentPortContourParameters, "Recesses of the covers."
    )
    relief_grooves: CrescentReliefGrooveParameters | None = table(
        CrescentReliefGrooveParameters, "Relief grooves; leave out for none.", default=None
    )
    journal_bearings: CrescentJournalBearingParameters = table(
        CrescentJournalBearingParameters, "Bearings of the pinion."
    )
    lateral: CrescentLateralParameters = table(CrescentLateralParameters, "Lateral films.")
    seals: CrescentSealParameters | None = table(
        CrescentSealParameters, "Shaft seal.", default=None
    )
    inlet: CrescentPortParameters = table(
        CrescentPortParameters, "Inlet volume.", default=CrescentPortParameters()
    )
    outlet: CrescentPortParameters = table(
        CrescentPortParameters, "Outlet volume.", default=CrescentPortParameters()
    )

    def __post_init__(self) -> None:
        if self.drain == "external":
            require(self, 'with drain = "external"', "drain_pressure")
        else:
            forbid(self, 'unless drain = "external"', "drain_pressure")

    def assemble(self) -> Any:
        """Return the definition of the machine: these parameters themselves."""
        return self


PARAMETERS = CrescentParameters
"""Found by the case reader under this name, in the module next to the machine's entry point."""
