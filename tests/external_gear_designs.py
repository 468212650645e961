"""Two external gear machines with 12 and 14 teeth as parameters of the machine type."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from toothspace.gearing.materials import Material
from toothspace.gearing.numbering import number
from toothspace.gearing.spaces import Spaces, drive_spaces, driven_spaces
from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.involute import InvoluteGear
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.parameters import ExternalGearParameters
from toothspace.machines.external_gear.spec import (
    BlockGrooveParameters,
    CasingParameters,
    ExternalGearSpec,
    FloatingBlock,
    Gear,
    GearParameters,
    JournalBearingParameters,
    LateralParameters,
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


CARBURISED_STEEL = Material(elastic_modulus=206e9, poisson_ratio=0.3, hardness=7e9)
"""Case-hardened gear steel 16CrNi4."""

LINED_STEEL_BUSH = Material(elastic_modulus=100e9, poisson_ratio=0.34, hardness=1e9)
"""Leaded bronze running layer of a bush."""

_KEYS = {"casing", "lateral", "journal_bearings", "elastic_bodies"}
_MESH = {"normal_backlash", "center_distance"}


def gear_of(tooth: InvoluteGear | GearProfile, face_width: float, **surface: float) -> Gear:
    """Gear of case-hardened steel."""
    return Gear(tooth=tooth, face_width=face_width, material=CARBURISED_STEEL, **surface)


def changed(spec: ExternalGearSpec, **changes: Any) -> ExternalGearSpec:
    """The machine with other keys, gears or grooves."""
    keys = replace(spec.keys, **{n: v for n, v in changes.items() if n in _KEYS})
    mesh = {name: value for name, value in changes.items() if name in _MESH}
    keys = replace(keys, gears=replace(keys.gears, **mesh))
    parts = {n: v for n, v in changes.items() if n not in _KEYS | _MESH}
    return replace(spec, keys=keys, center_distance=keys.gears.center_distance, **parts)


def machine_of(tooth: InvoluteGear, face_width: float, **tables: Any) -> ExternalGearSpec:
    """Machine of two equal gears from tables of ``[machine]``."""
    mesh = {name: tables.pop(name) for name in _MESH & tables.keys()}
    gears = GearParameters(
        tooth_count=tooth.tooth_count,
        module=tooth.module,
        pressure_angle=tooth.pressure_angle,
        profile_shift=tooth.profile_shift,
        tip_diameter=tooth.tip_diameter,
        face_width=face_width,
        **mesh,
    )
    keys = ExternalGearParameters(gears=gears, **tables)
    gear = gear_of(tooth, face_width)
    return replace(keys.assemble(), drive=gear, driven=gear, bush=LINED_STEEL_BUSH)


def egm12(mode: str = "motor", **changes: object) -> ExternalGearSpec:
    """Motor or pump of 4.95 cm3/rev."""
    inlet, outlet = (55.0, 70.0) if mode == "motor" else (70.0, 55.0)
    spec = machine_of(
        TWELVE,
        7.5e-3,
        mode=mode,
        casing=CasingParameters(
            radial_clearance=20e-6,
            inlet_angle=np.deg2rad(inlet),
            outlet_angle=np.deg2rad(outlet),
        ),
        journal_bearings=JournalBearingParameters(
            diameter=18e-3, length=19e-3, radial_clearance=8e-6
        ),
        lateral=LateralParameters(side_gap=8e-6),
        relief_grooves=BlockGrooveParameters(
            closing_side_offset=3.652e-3, opening_side_offset=3.652e-3
        ),
        normal_backlash=0.02e-3,
    )
    return changed(spec, **changes)


def fuel14(**changes: object) -> ExternalGearSpec:
    """Fuel pump of 43 cm3/rev."""
    spec = machine_of(
        FOURTEEN,
        23.4e-3,
        mode="pump",
        casing=CasingParameters(
            radial_clearance=40e-6,
            inlet_angle=np.deg2rad(70.0),
            outlet_angle=np.deg2rad(55.0),
        ),
        journal_bearings=JournalBearingParameters(
            diameter=40e-3, length=38e-3, radial_clearance=25e-6
        ),
        lateral=LateralParameters(side_gap=3e-6),
        relief_grooves=BlockGrooveParameters(
            closing_side_offset=5.8e-3,
            opening_side_offset=5.8e-3,
            width=15e-3,
            radial_extent=15e-3,
            depth=4e-3,
        ),
        center_distance=63.06e-3,
    )
    return changed(spec, **changes)


def unequal(drive_teeth: int = 11, driven_teeth: int = 13, **changes: object) -> ExternalGearSpec:
    """Pump with two different gears, module and tool of the 12-tooth design."""
    drive, driven = (
        gear_of(replace(TWELVE, tooth_count=n, tip_diameter=None, profile_shift=0.35), 7.5e-3)
        for n in (drive_teeth, driven_teeth)
    )
    return egm12("pump", drive=drive, driven=driven, **changes)


def floating_block(block: FloatingBlock, **changes: Any) -> FloatingBlock:
    """A floating bearing with other data or keys."""
    own = {n: changes.pop(n) for n in ("length", "arrangement") if n in changes}
    return replace(block, keys=replace(block.keys, **changes), **own)


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
