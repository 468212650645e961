"""Keys of meshing gears and of relief grooves, and the involute tooth and outlines they mean."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import numpy as np

from toothspace.core.errors import CaseError, GeometryError
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
    text,
)
from toothspace.core.types import Array
from toothspace.core.units import to_si
from toothspace.geometry.cad_import import is_solid, load_polygons
from toothspace.geometry.involute import InvoluteGear, tooth_form

PROFILE_SUFFIXES = (".txt", ".csv", ".dxf", ".stl", ".step", ".stp")
"""Files that may hold a profile."""
CONTOUR_SUFFIXES = (".txt", ".csv", ".dxf")
"""Files that may hold a plane contour."""

GROOVE_DEPTH = 1.5e-3
"""Depth of a groove where none is given. [m]"""
TOOTH_KEYS = (
    "tooth_count", "module", "pressure_angle", "profile_shift", "dedendum", "tool_tip_radius",
    "tip_diameter", "tip_rounding",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class MeshingGearParameters(KeyTable):
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
    face_width: float | None = quantity(
        "mm",
        "Axial width of the gear; default that of the teeth in a solid file.",
        above=0,
        high=500,
        default=None,
    )
    normal_backlash: float | None = quantity(
        "mm", "Play between the flanks along the line of action.", low=0, high=2, default=None
    )
    center_distance: float | None = quantity(
        "mm",
        "Distance of the gear centres; default that of both gears in one solid file.",
        above=0,
        high=1000,
        default=None,
    )
    material: str = text("Material from the library.", default="steel_16CrNi4")
    roughness: float = quantity(
        "um", "Root mean square roughness of flanks and faces.", low=0, high=10, default=0.25e-6
    )
    profile: Path | Points | None = file_path(
        "Closed tooth or gear profile; replaces the generator.", *PROFILE_SUFFIXES, points=True
    )
    profile_unit: str = choice("Length unit of the profile.", "mm", "m", "um", "in", default="mm")

    def __post_init__(self) -> None:
        if self.profile is None:
            require(self, "unless a profile file is given", *self.generator_keys)
        solid = is_solid(self.profile)
        if not solid:
            require(self, "unless the gear comes from a solid file", "face_width")
        if self.normal_backlash is None and not solid:
            require(self, "unless normal_backlash is given", "center_distance")
        elif self.normal_backlash is not None:
            forbid(self, "because normal_backlash is given", "center_distance")

    @property
    def generator_keys(self) -> tuple[str, ...]:
        """Keys that generated teeth need."""
        return "tooth_count", "module", "pressure_angle", "tip_diameter"

    def involute_gear(self, table: str) -> InvoluteGear:
        """Return the generated gear.

        Raises GeometryError if the tooth is impossible, with the key in the given table.
        """
        values: dict[str, Any] = {name: getattr(self, name) for name in TOOTH_KEYS}
        try:
            tooth = InvoluteGear(**values)
            tooth_form(tooth)
        except GeometryError as error:
            raise error.under(table) from error
        return tooth


@dataclass(frozen=True, kw_only=True)
class ReliefGrooveParameters(KeyTable):
    """``[machine.relief_grooves]``: in each face beside the gears."""

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
    closing_side_angle: float = quantity(
        "deg",
        "Of the closing edge to the centre line, positive where it is farther off beyond the pitch "
        "point, seen from the drive gear.",
        low=-60,
        high=60,
        default=0.0,
    )
    opening_side_angle: float = quantity(
        "deg", "The same of the opening edge.", low=-60, high=60, default=0.0
    )
    closing_side_bow: float = quantity(
        "mm",
        "How much farther off the ends of the closing edge are than where it passes the height of "
        "the pitch point; between these it is straight.",
        low=-20,
        high=20,
        default=0.0,
    )
    opening_side_bow: float = quantity(
        "mm", "The same of the opening edge.", low=-20, high=20, default=0.0
    )
    width: float = quantity("mm", "Extent along x.", above=0, high=200, default=10e-3)
    radial_extent: float = quantity(
        "mm", "Extent along y, centred on the pitch point.", above=0, high=200, default=10e-3
    )
    depth: float | None = quantity(
        "mm",
        "Depth into the face; default 1.5 mm, or that of a solid.",
        above=0,
        high=100,
        default=None,
    )
    contour: Path | None = file_path(
        "Closed groove polygons in the machine frame, right of the centre line the closing side.",
        *CONTOUR_SUFFIXES,
    )

    def __post_init__(self) -> None:
        if self.contour is None:
            reason = "unless a contour file is given"
            require(self, reason, "closing_side_offset", "opening_side_offset")
        for side in ("closing_side", "opening_side"):
            angle, bow = getattr(self, f"{side}_angle"), getattr(self, f"{side}_bow")
            lean = 0.5 * self.radial_extent * abs(math.tan(angle))
            if lean + bow < self.width:
                continue
            name = f"{side}_angle" if bow == 0.0 else f"{side}_bow"
            if bow == 0.0:
                steepest = math.degrees(math.atan2(self.width, 0.5 * self.radial_extent))
                found = f"{math.degrees(angle):.6g} deg, with which the edge leaves the groove"
                allowed = f"less than {steepest:.3g} deg either way with this width and extent"
            else:
                found = f"{1e3 * bow:.6g} mm, with which the edge leaves the groove"
                allowed = f"less than {1e3 * (self.width - lean):.3g} mm with this width and angle"
            raise CaseError(name, found, allowed)

    def grooves(self, table: str = "", unit: str = "mm") -> ReliefGrooves:
        """Return the grooves, their contours read from the file; messages name the table above.

        ``unit`` is the length unit of the file.

        Raises CaseError if the file is damaged, or holds two polygons on one side.
        """
        key = f"{table}relief_grooves.contour"
        polygons = read_contours(self.contour, key, unit) if self.contour else []
        return self.outlined(polygons, self.depth or GROOVE_DEPTH, key)

    def outlined(self, polygons: list[Array], depth: float, key: str) -> ReliefGrooves:
        """Return the grooves with outlines in place of the rectangles and a depth. [m].

        Raises CaseError if two polygons lie on one side, with the key.
        """
        found: dict[bool, Array] = {}
        for polygon in polygons:
            right = bool(polygon[:, 0].mean() > 0.0)
            if right in found:
                side, file = "right" if right else "left", self.contour.name if self.contour else ""
                two = f"two polygons {side} of the centre line in {file}"
                raise CaseError(key, two, "one polygon on each side")
            found[right] = polygon
        sides = found.get(True), found.get(False)
        return ReliefGrooves(
            closing_side_offset=_offset(self.closing_side_offset, sides[0], 1.0),
            opening_side_offset=_offset(self.opening_side_offset, sides[1], -1.0),
            closing_side_angle=self.closing_side_angle,
            opening_side_angle=self.opening_side_angle,
            closing_side_bow=self.closing_side_bow,
            opening_side_bow=self.opening_side_bow,
            width=self.width,
            radial_extent=self.radial_extent,
            depth=depth,
            closing_contour=sides[0],
            opening_contour=sides[1],
        )


@final
@dataclass(frozen=True, kw_only=True)
class ReliefGrooves:
    """Relief grooves in both faces: closing side (+x) to the outlet, opening side to the inlet."""

    closing_side_offset: float
    opening_side_offset: float
    """Distance of the groove edge from the centre line at the pitch point. [m]"""
    closing_side_angle: float = 0.0
    opening_side_angle: float = 0.0
    """Of the groove edge to the centre line, positive if it is farther off along +y. [rad]"""
    closing_side_bow: float = 0.0
    opening_side_bow: float = 0.0
    """How much farther off both ends of the groove edge are than its middle. [m]"""
    width: float = 10e-3
    """Extent along x beyond the edge. [m]"""
    radial_extent: float = 10e-3
    """Extent along y, centred on the pitch point. [m]"""
    depth: float = 1.5e-3
    """Depth into the face. [m]"""
    closing_contour: Array | None = None
    opening_contour: Array | None = None
    """Closed polygons in the machine frame that replace the rectangles. Shape (points, 2). [m]"""

    def outlines(self, pitch_point: float) -> dict[str, Array]:
        """Outlines named by the port that they join, about a height of the pitch point [m]. [m]."""
        low, high = (pitch_point + s * 0.5 * self.radial_extent for s in (-1.0, 1.0))
        sides = (
            ("outlet", 1.0, self.closing_side_offset, self.closing_side_angle),
            ("inlet", -1.0, self.opening_side_offset, self.opening_side_angle),
        )
        contours = {"outlet": self.closing_contour, "inlet": self.opening_contour}
        bows = {"outlet": self.closing_side_bow, "inlet": self.opening_side_bow}
        found = {}
        for port, sign, offset, angle in sides:
            lean = sign * 0.5 * self.radial_extent * math.tan(angle)
            near, far, contour = sign * offset, sign * (offset + self.width), contours[port]
            ends = near + sign * bows[port]
            middle = [[near, pitch_point]] if bows[port] else []
            box = [[ends - lean, low], [far, low], [far, high], [ends + lean, high], *middle]
            found[port] = np.array(box) if contour is None else contour
        return found


def _offset(given: float | None, contour: Array | None, side: float) -> float:
    if given is not None:
        return given
    return 0.0 if contour is None else float((side * contour[:, 0]).min())


def read_contours(file: Path | Points, key: str, unit: str = "mm") -> list[Array]:
    """Closed polygons of a file in a unit of length. [m].

    Raises GeometryError if it cannot be read, with the key.
    """
    try:
        return load_polygons(file, to_si(1.0, unit))
    except GeometryError as error:
        raise error.read_for(key) from error
