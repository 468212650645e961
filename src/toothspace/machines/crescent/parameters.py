"""Keys of ``[machine]`` for internal gear pumps and motors with crescent, read to SI units."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import final

from toothspace.core.frozen import Points
from toothspace.core.keys import (
    KeyTable,
    choice,
    file_path,
    integer,
    number,
    quantity,
    require,
    table,
    text,
)
from toothspace.gearing.gear_tables import (
    PROFILE_SUFFIXES,
    ReliefGrooveParameters,
)
from toothspace.gearing.helix import HelicalGearParameters
from toothspace.machines.shared_tables import (
    LinedBearingParameters,
    MachineTables,
    PortParameters,
    ShaftSealParameters,
)


@final
@dataclass(frozen=True, kw_only=True)
class PinionParameters(HelicalGearParameters):
    """``[machine.pinion]``: rack-generated involute teeth, or a profile from a file."""

    tip_rounding: float = quantity(
        "mm", "Radius of the edge between flank and tip.", low=0, high=5, default=0.05e-3
    )
    face_width: float = quantity("mm", "Axial width of the gears.", above=0, high=500)
    profile: Path | Points | None = file_path(
        "Closed profile; replaces the generator, together with that of the ring.",
        *PROFILE_SUFFIXES,
        points=True,
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.profile is not None:
            require(self, "with a profile file", "center_distance")


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
class NotchParameters(KeyTable):
    """``[machine.filler.notch]``: slot in each face of the filler, open at its outlet end."""

    length: float = quantity(
        "mm", "Along the face, from the outlet end against the rotation.", above=0, high=200
    )
    width: float = quantity("mm", "Extent along the axis.", above=0, high=100)
    depth: float = quantity(
        "mm", "Depth at the outlet end; it falls evenly to nothing.", above=0, high=20
    )


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
    roughness: float = quantity(
        "um", "Of the filler: keeps tips that touch it apart.", low=0.01, high=100, default=1e-6
    )
    compensation: str = choice(
        "Whether the filler stands in the housing, or its halves are pressed radially against the "
        "teeth and follow the gears with these gaps.",
        "none",
        "radial",
        default="none",
    )
    notch: NotchParameters | None = table(
        NotchParameters,
        "Precompression: lets pressure into the tooth spaces before they reach the outlet.",
        default=None,
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
class CrescentLateralParameters(KeyTable):
    """``[machine.lateral]``: films between the faces of the gears and the covers."""

    side_gap: float = quantity("um", "Film height of both faces.", low=0.1, high=500)


@final
@dataclass(frozen=True, kw_only=True)
class CrescentPortParameters(PortParameters):
    """``[machine.inlet]`` and ``[machine.outlet]``."""

    volume: float = quantity(
        "cm^3", "Fluid volume between machine and line.", low=0.1, high=1e5, default=100e-6
    )


@final
@dataclass(frozen=True, kw_only=True)
class CrescentParameters(MachineTables):
    """``[machine]`` with ``type = "crescent"``."""

    pinion: PinionParameters = table(PinionParameters, "Gear on the shaft.")
    ring: RingParameters = table(RingParameters, "Ring gear round it.")
    filler: FillerParameters = table(FillerParameters, "Crescent between the gears.")
    ports: CrescentPortContourParameters = table(
        CrescentPortContourParameters, "Recesses of the covers."
    )
    relief_grooves: ReliefGrooveParameters | None = table(
        ReliefGrooveParameters, "Relief grooves; leave out for none.", default=None
    )
    journal_bearings: LinedBearingParameters = table(
        LinedBearingParameters, "Bearings of the pinion."
    )
    lateral: CrescentLateralParameters = table(CrescentLateralParameters, "Lateral films.")
    seals: ShaftSealParameters | None = table(ShaftSealParameters, "Shaft seal.", default=None)
    inlet: CrescentPortParameters = table(
        CrescentPortParameters, "Inlet volume.", default=CrescentPortParameters()
    )
    outlet: CrescentPortParameters = table(
        CrescentPortParameters, "Outlet volume.", default=CrescentPortParameters()
    )


PARAMETERS = CrescentParameters
"""Found by the case reader under this name, in the module next to the machine's entry point."""
