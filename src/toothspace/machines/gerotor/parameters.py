"""Keys of ``[machine]`` for gerotors, read to SI units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar, final

from toothspace.core.keys import (
    KeyTable,
    choice,
    file_path,
    forbid,
    number,
    quantity,
    require,
    table,
)
from toothspace.gearing.gear_tables import CONTOUR_SUFFIXES
from toothspace.machines.gerotor.rotor_files import RotorParameters
from toothspace.machines.shared_tables import (
    MachineTables,
    PortParameters,
    ShaftBearingParameters,
    ShaftSealParameters,
    SideGapParameters,
)


@final
@dataclass(frozen=True, kw_only=True)
class HousingParameters(KeyTable):
    """``[machine.housing]``: radial film round the outer rotor."""

    outer_rotor_diameter: float = quantity(
        "mm", "Outside diameter of the outer rotor.", above=0, high=1000
    )
    radial_clearance: float = quantity(
        "um", "Housing bore radius minus rotor radius.", low=1, high=1000
    )
    end_condition: str = choice(
        "Axial ends of the film: walls beside which the faces lead pressure into it, the drain, "
        "or walls through which nothing passes.",
        "no_flow",
        "pressure",
        "wall",
        default="no_flow",
    )
    roughness: float = quantity(
        "um", "Root mean square roughness of the bore.", low=0, high=10, default=0.4e-6
    )


@final
@dataclass(frozen=True, kw_only=True)
class PortContourParameters(KeyTable):
    """``[machine.ports]``: kidneys about the centre of the outer rotor."""

    timing: str | None = choice(
        "Ports change over exactly at the largest and smallest volume.", "kinematic", default=None
    )
    land_max_half_angle: float | None = quantity(
        "deg", "Half of the land at the largest volume.", above=0, high=90, default=None
    )
    land_min_half_angle: float | None = quantity(
        "deg", "Half of the land at the smallest volume.", above=0, high=90, default=None
    )
    inner_radius: float | None = quantity(
        "mm", "Inner radius of the kidneys.", above=0, high=500, default=None
    )
    outer_radius: float | None = quantity(
        "mm", "Outer radius of the kidneys.", above=0, high=500, default=None
    )
    depth: float = quantity(
        "mm",
        "Depth of the kidneys, for records: they count as deep.",
        above=0,
        high=200,
        default=10e-3,
    )
    covers: str = choice(
        "Covers with kidneys; in both, those opposite the ports are recesses at port pressure.",
        "one",
        "both",
        default="one",
    )
    contour: Path | None = file_path("Closed port polygons.", *CONTOUR_SUFFIXES)
    radial_slot_width: float | None = quantity(
        "mm",
        "Width, round the rim, of a slot from each cavity to windows in the bore, as long as the "
        "kidneys: radial porting.",
        above=0,
        high=200,
        default=None,
    )
    radial_slot_length: float | None = quantity(
        "mm", "Axial length of those slots.", above=0, high=500, default=None
    )

    def __post_init__(self) -> None:
        slot = ("radial_slot_width", "radial_slot_length")
        if any(getattr(self, name) is not None for name in slot):
            require(self, "with the other size of radial slots", *slot)
        names = ("land_max_half_angle", "land_min_half_angle")
        if self.timing is not None or self.contour is not None:
            forbid(self, "because timing or contour is given", *names)
        elif any(getattr(self, name) is not None for name in names):
            require(self, "with the other land angle", *names)


@final
@dataclass(frozen=True, kw_only=True)
class FaceGapParameters(SideGapParameters):
    """``[machine.lateral]``: films between rotor faces and covers."""

    each = "side_gap_a", "side_gap_b"

    side_gap_a: float | None = quantity(
        "um", "Film height at the face with the lower z.", low=0.1, high=500, default=None
    )
    side_gap_b: float | None = quantity(
        "um", "Film height at the face with the higher z.", low=0.1, high=500, default=None
    )
    position: str = choice(
        "Rotors stand as the gaps say, or free between the covers, which 'films' solves.",
        "given",
        "free",
        default="given",
    )
    motion: str | None = choice(
        "Free rotors lift along the axis alone, or lift and tilt (default).",
        "axial",
        "full",
        default=None,
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.position == "given":
            forbid(self, 'unless position = "free"', "motion")


@final
@dataclass(frozen=True, kw_only=True)
class ContactParameters(KeyTable):
    """``[machine.contact]``: mechanics of the lobe pairs."""

    law: str = choice("Force over penetration.", "hertz", "johnson", "pereira", default="hertz")
    theory: str = choice(
        "Every pair may carry, or one only.", "multiple", "single", default="multiple"
    )
    restitution: float = number(
        "Restitution of an impact (Lankarani and Nikravesh); 1: none is lost.",
        above=0,
        high=1,
        default=0.8,
    )
    impact: str = choice(
        "Damping by the speed of each impact, or of one impact speed for all.",
        "own",
        "given",
        default="given",
    )
    impact_speed: float = quantity(
        "m/s",
        "Speed of that impact with ``given``; lobes meet slowly.",
        above=0,
        high=10,
        default=0.01,
    )
    boundary_friction: float = number(
        "Friction coefficient of touching asperities.", low=0, high=1, default=0.10
    )
    squeeze_film: str = choice(
        "Film between lobes, which resists their approach.", "on", "off", default="on"
    )


@final
@dataclass(frozen=True, kw_only=True)
class GerotorParameters(MachineTables):
    """``[machine]`` with ``type = "gerotor"``."""

    part_tables: ClassVar[Mapping[str, str]] = {"free_bodies": "lateral.position"}
    """Keys of parts that not every preset uses."""

    rotors: RotorParameters = table(RotorParameters, "Inner and outer rotor.")
    housing: HousingParameters = table(HousingParameters, "Radial film of the outer rotor.")
    ports: PortContourParameters = table(
        PortContourParameters,
        "Kidney ports; default kinematic timing.",
        default=PortContourParameters(timing="kinematic"),
    )
    lateral: FaceGapParameters = table(FaceGapParameters, "Lateral films.")
    contact: ContactParameters = table(
        ContactParameters, "Contacts of the lobes.", default=ContactParameters()
    )
    journal_bearings: ShaftBearingParameters | None = table(
        ShaftBearingParameters, "Bearings of the inner rotor; leave out for a fixed shaft.",
        default=None,
    )  # fmt: skip
    seals: ShaftSealParameters | None = table(ShaftSealParameters, "Shaft seal.", default=None)
    inlet: PortParameters = table(PortParameters, "Inlet volume.", default=PortParameters())
    outlet: PortParameters = table(PortParameters, "Outlet volume.", default=PortParameters())

    def assemble(self) -> GerotorParameters:
        """Return these keys with what profiles from files tell of the rotors."""
        if self.rotors.kind is not None:
            return self
        # with what reads CAD files
        from toothspace.machines.gerotor.profiles import completed

        return replace(self, rotors=completed(self.rotors, self.housing.outer_rotor_diameter))


PARAMETERS = GerotorParameters
"""Found by the case reader under this name, in the module next to the machine's entry point."""
