"""Keys of the floating bearing and of elastic bodies in ``[machine]`` of external gears."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import final

from toothspace.core.keys import (
    KeyTable,
    QuantityKey,
    Table,
    choice,
    file_path,
    flag,
    forbid,
    instead_of,
    items,
    pair,
    quantity,
    require,
    table,
    text,
)
from toothspace.gearing.gear_tables import CONTOUR_SUFFIXES
from toothspace.model.floating_bearing import HousingContact

_STEP = (".step", ".stp")
_FORCE = QuantityKey(unit="N", low=-1e6, high=1e6)
_LENGTH = QuantityKey(unit="mm")


@final
@dataclass(frozen=True, kw_only=True)
class PressureAreaParameters(KeyTable):
    """``high_pressure_area``: a seal line, a contour, or area and centre."""

    seal_line_x: float | None = quantity(
        "mm",
        "Chord that divides the back face, from the centre line towards high pressure.",
        low=-500,
        high=500,
        default=None,
    )
    contour: Path | None = file_path("Closed polygon of the area.", *CONTOUR_SUFFIXES)
    area: float | None = quantity("mm^2", "Area.", low=0, high=1e6, default=None)
    center: tuple[float, float] | None = pair(_LENGTH, "Centroid of the area (x, y).", default=None)

    def __post_init__(self) -> None:
        if self.seal_line_x is None and self.contour is None:
            require(self, "unless seal_line_x or contour is given", "area", "center")
        elif self.seal_line_x is not None:
            forbid(self, "because seal_line_x is given", "contour", "area", "center")
        else:
            forbid(self, "because contour is given", "area", "center")


@final
@dataclass(frozen=True, kw_only=True)
class NoseParameters(KeyTable):
    """``nose``: patch of the back face with a pressure of its own."""

    contour: Path | None = file_path("Closed polygon of the patch.", *CONTOUR_SUFFIXES)
    area: float | None = quantity("mm^2", "Area of a square.", low=0, high=1e6, default=None)
    center: tuple[float, float] | None = pair(_LENGTH, "Its centroid (x, y).", default=None)

    def __post_init__(self) -> None:
        instead_of(self, "contour", "area", "center")


@final
@dataclass(frozen=True, kw_only=True)
class SpringParameters(KeyTable):
    """One of ``springs``."""

    force: float = quantity("N", "Preload towards the gears.", low=0, high=1e5)
    x: float = quantity("mm", "Position.", low=-500, high=500)
    y: float = quantity("mm", "Position.", low=-500, high=1000)


@final
@dataclass(frozen=True, kw_only=True)
class FloatingBearingParameters(KeyTable):
    """``[machine.floating_bearing]``: force balance of the floating bearing."""

    material: str = text("Material from the library.", default="AlSi")
    length: float | None = quantity("mm", "Axial length.", above=0, high=500, default=None)
    roughness: float = quantity(
        "um", "Root mean square roughness of the face.", low=0, high=10, default=0.4e-6
    )
    mass: float | None = quantity("kg", "Mass.", above=0, high=100, default=None)
    high_pressure_area: PressureAreaParameters | None = table(
        PressureAreaParameters, "Part of the back face that sees outlet pressure.", default=None
    )
    nose: NoseParameters | None = table(
        NoseParameters, "Patch of the back face with nose pressure.", default=None
    )
    seal_preload: float = quantity("N", "Preload of the seal.", low=0, high=1e5, default=0.0)
    springs: tuple[SpringParameters, ...] = items(
        Table(spec=SpringParameters), "Springs on the back face.", low=0, high=50, default=()
    )
    housing_contact: HousingContact | None = table(
        HousingContact, "Friction in the housing.", default=None
    )
    motion: str = choice("Free motions of bearing and gears.", "full", "axial", default="full")
    split: bool = flag(
        "Whether it is cut between the gears into halves that move on their own.", default=False
    )
    axial_play: float = quantity(
        "um", "Travel away from the gears up to the cover.", above=0, high=5000, default=100e-6
    )
    wall_stiffness: float | None = quantity(
        "N m/rad",
        "Moment about y over the tilt about it, by the wall that the bearing leans on; if not "
        "given, by its own compression there.",
        low=0,
        high=1e9,
        default=None,
    )
    shaft_stiffness: float | None = quantity(
        "N m/rad",
        "Moment over tilt by which its journal bearings hold a gear upright; if not given, by "
        "the films that carry its load.",
        low=0,
        high=1e9,
        default=None,
    )
    gear_axial_force: tuple[float, float] = pair(
        _FORCE,
        "Axial force on both gears that is given, along z, at the pitch point: of teeth without a "
        "helix_angle, or of pistons that balance it. That of a helix_angle is added.",
        default=(0.0, 0.0),
    )

    @property
    def housing(self) -> HousingContact:
        """Contact with the housing, without friction where it is not given."""
        return self.housing_contact or HousingContact()


@final
@dataclass(frozen=True, kw_only=True)
class ElasticBodiesParameters(KeyTable):
    """``[machine.elastic_bodies]``: shapes of bodies that deform in place of swept ones."""

    floating_bearing: Path | None = file_path(
        "Floating bearing in the frame of the machine, z = 0 on its film face, from there up (mm).",
        *_STEP,
    )
    solid_bearing: Path | None = file_path(
        "Bearing on the other side, z = 0 on its film face, from there down (mm).", *_STEP
    )
    drive_gear: Path | None = file_path(
        "Drive gear with its shaft, first tooth on x, z = 0 in the middle of its width (mm).",
        *_STEP,
    )
    driven_gear: Path | None = file_path("Driven gear, likewise.", *_STEP)
    edge_length: float | None = quantity(
        "mm",
        "Longest edge of the elements; default a tenth of the tip radius.",
        above=0,
        high=100,
        default=None,
    )
