"""Two external gear machines with 12 and 14 teeth as parameters of the machine type."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from toothspace.gearing.gear_tables import ReliefGrooves
from toothspace.gearing.numbering import number
from toothspace.gearing.spaces import Spaces, drive_spaces, driven_spaces
from toothspace.geometry.involute import InvoluteGear
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.spec import (
    Casing,
    ExternalGearSpec,
    Gear,
    JournalBearings,
    LateralGaps,
)

TWELVE = InvoluteGear(
    tooth_count=12,
    module=2.75e-3,
    pressure_angle=np.deg2rad(20.0),
    profile_shift=0.3,
    tip_diameter=40.372e-3,
    tool_tip_radius=0.38,
    tip_rounding=0.1e-3,
)
FOURTEEN = InvoluteGear(
    tooth_count=14,
    module=4.5e-3,
    pressure_angle=np.deg2rad(25.0),
    tip_diameter=72.12e-3,
    tip_rounding=0.1e-3,
)


def egm12(mode: str = "motor", **changes: object) -> ExternalGearSpec:
    """Motor or pump of 4.95 cm3/rev."""
    gear = Gear(tooth=TWELVE, face_width=7.5e-3)
    inlet, outlet = (55.0, 70.0) if mode == "motor" else (70.0, 55.0)
    spec = ExternalGearSpec(
        drive=gear,
        driven=gear,
        casing=Casing(
            radial_clearance=20e-6,
            inlet_angle=np.deg2rad(inlet),
            outlet_angle=np.deg2rad(outlet),
        ),
        journals=JournalBearings(diameter=18e-3, length=19e-3, radial_clearance=8e-6),
        lateral=LateralGaps(side_gap_floating=8e-6, side_gap_solid=8e-6),
        grooves=ReliefGrooves(closing_side_offset=3.652e-3, opening_side_offset=3.652e-3),
        mode="motor" if mode == "motor" else "pump",
        normal_backlash=0.02e-3,
    )
    return replace(spec, **changes)  # type: ignore[arg-type]


def fuel14(**changes: object) -> ExternalGearSpec:
    """Fuel pump of 43 cm3/rev."""
    gear = Gear(tooth=FOURTEEN, face_width=23.4e-3)
    spec = ExternalGearSpec(
        drive=gear,
        driven=gear,
        casing=Casing(
            radial_clearance=40e-6,
            inlet_angle=np.deg2rad(70.0),
            outlet_angle=np.deg2rad(55.0),
        ),
        journals=JournalBearings(diameter=40e-3, length=38e-3, radial_clearance=25e-6),
        lateral=LateralGaps(side_gap_floating=3e-6, side_gap_solid=3e-6),
        grooves=ReliefGrooves(
            closing_side_offset=5.8e-3,
            opening_side_offset=5.8e-3,
            width=15e-3,
            radial_extent=15e-3,
            depth=4e-3,
        ),
        center_distance=63.06e-3,
    )
    return replace(spec, **changes)  # type: ignore[arg-type]


def unequal(drive_teeth: int = 11, driven_teeth: int = 13, **changes: object) -> ExternalGearSpec:
    """Pump with two different gears, module and tool of the 12-tooth design."""
    drive, driven = (
        Gear(
            tooth=replace(TWELVE, tooth_count=count, tip_diameter=None, profile_shift=0.35),
            face_width=7.5e-3,
        )
        for count in (drive_teeth, driven_teeth)
    )
    return egm12("pump", drive=drive, driven=driven, **changes)


ALL = {
    "egm12_motor": egm12("motor"),
    "egm12_pump": egm12("pump"),
    "fuel14": fuel14(),
    "unequal": unequal(),
}


def spaces_at(assembly: Assembly, shaft_angle: float) -> tuple[Spaces, Spaces]:
    """All tooth spaces of both gears at one shaft angle."""
    numbering = number(assembly.counts)
    places = [
        np.mod(phases + ratio * shaft_angle, 2.0 * np.pi) - np.pi
        for phases, ratio in zip(numbering.space_phases, numbering.ratios, strict=True)
    ]
    places[1] -= assembly.mesh.turn
    return (
        drive_spaces(*assembly.teeth, assembly.mesh, places[0]),
        driven_spaces(*assembly.teeth, assembly.mesh, places[1]),
    )
