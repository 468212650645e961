"""Find the gears in a file: bodies or curves with teeth, their axes, teeth and helix angles.

A ring gear or outer rotor is a body whose bore has the teeth. Its outline is that of an external
gear of the same base circle whose teeth fill the spaces of the ring.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.files import reading
from toothspace.core.frozen import Points
from toothspace.core.types import Array
from toothspace.geometry.body_section import BodySection, SectionRequest, axis_frame
from toothspace.geometry.cad_import import is_solid, load_body_sections, load_closed_curves
from toothspace.geometry.curve import chord_heights, counter_clockwise, signed_area
from toothspace.geometry.profile_detection import DetectedGear, gear_profile_from_curve
from toothspace.geometry.tooth_count import area_phase, repeating_teeth

_LEAST_HELIX = np.deg2rad(0.1)
_LEAST_SHIFT = 2e-6
_CHORDS = 3.0
_PARALLEL = 1e-4


@final
@dataclass(frozen=True)
class FoundGear:
    """A gear in a file."""

    file: Path | Points
    """Where it was found."""
    name: str
    """Name of the body, empty without."""
    detected: DetectedGear
    """Teeth of its section."""
    body: int | None
    """Number of the body, the largest is 0; None in files of plane curves."""
    axis: Array
    """Unit vector along the gear axis. Shape (3,)."""
    center: Array
    """Point on the axis in the plane of the section. Shape (3,). [m]"""
    face_width: float | None
    """Length of the teeth; None in files of plane curves. [m]"""
    length: float
    """Length of the body along the axis with its shaft; 0 in files of plane curves. [m]"""
    helix_angle: float
    """Helix angle on the circle halfway up the teeth, positive for a right-hand helix, 0 for spur
    teeth. [rad]
    """
    taper: float = 0.0
    """Angle by which the teeth narrow along the axis, as drafted, conical or bevel ones. [rad]"""
    internal: bool = False
    """Whether the outline is the bore of a ring gear or outer rotor: its teeth are the spaces."""


@final
@dataclass(frozen=True)
class PlainBody:
    """A body without teeth."""

    file: Path
    """Where it was found."""
    name: str
    """Its name in the file, empty without."""
    body: int
    """Its number, the largest is 0."""


@final
@dataclass(frozen=True)
class FileContents:
    """Gears and other bodies of one file, or of several that were drawn in one frame."""

    gears: tuple[FoundGear, ...]
    """Gears, largest tip circle first."""
    others: tuple[PlainBody, ...]
    """Bodies without teeth, largest first."""
    rings: tuple[FoundGear, ...] = ()
    """Ring gears and outer rotors among solids, largest bore first."""


def find_gears(
    path: Path | Points,
    unit: float,
    request: SectionRequest | None = None,
    layer: str | None = None,
    tooth_count: int | None = None,
) -> FileContents:
    """Find the gears in a CAD file or a file of points.

    Raises GeometryError for a file that cannot be read or holds no gear; the message names the
    section.

    Parameters
    ----------
    path : Path or Points
        File or points, as in ``cad_import.load_closed_curves``.
    unit : float
        Length of one unit of the file; STEP files carry their own. [m]
    request : SectionRequest or None
        Axis, plane and body of a solid file; None to find them.
    layer : str or None
        DXF layer; None for all.
    tooth_count : int or None
        Needed for the outline of a single pitch.
    """
    with reading(path, "the closed outline of a gear with equal teeth"):
        if is_solid(path):
            return _gears_of_solids(path, unit, request or SectionRequest())
        curves = load_closed_curves(path, unit, layer=layer)
        toothed = _outermost([curve for curve in curves if repeating_teeth(curve) is not None])
        if tooth_count is not None or not toothed:
            toothed = curves[:1]
        gears = []
        for curve in toothed:
            detected = gear_profile_from_curve(curve, key=str(path), tooth_count=tooth_count)
            center = np.array([*detected.center, 0.0])
            axis = np.array([0.0, 0.0, 1.0])
            gears.append(FoundGear(path, "", detected, None, axis, center, None, 0.0, 0.0))
        return FileContents(_by_size(gears), ())


def find_in_files(
    paths: Iterable[Path], unit: float, request: SectionRequest | None = None
) -> FileContents:
    """Gears and other bodies of files that were drawn in one frame; see ``find_gears``.

    Raises GeometryError if no file holds a gear, or one cannot be read.

    Parameters
    ----------
    paths : iterable of Path
        Files, as a CAD program writes them part by part; solids may be without gears.
    unit : float
        Length of one unit of the files; STEP files carry their own. [m]
    request : SectionRequest or None
        Axis and plane of gears in solid files, layer of plane ones, bodies that do not count; None
        to find them.
    """
    gears: list[FoundGear] = []
    others: list[PlainBody] = []
    rings: list[FoundGear] = []
    refused = []
    for path in paths:
        try:
            found = find_gears(path, unit, request, request.layer if request else None)
        except GeometryError as error:
            if not is_solid(path):
                raise
            refused.append(error)
            others += _plain(path, load_body_sections(path, unit, SectionRequest()))
            continue
        gears += found.gears
        others += found.others
        rings += found.rings
    if not gears and not rings:
        raise refused[0]
    out = set(request.left_out) if request else set()

    def counts(body: FoundGear | PlainBody) -> bool:
        return not isinstance(body.file, Path) or (body.file.name, body.body) not in out

    gears, rings = (list(filter(counts, bodies)) for bodies in (gears, rings))
    return FileContents(_by_size(gears), tuple(filter(counts, others)), _by_size(rings))


def _plain(path: Path, sections: Iterable[BodySection]) -> list[PlainBody]:
    return [PlainBody(path, cut.name, cut.body) for cut in sections]


def axis_distance(first: FoundGear, second: FoundGear) -> float | None:
    """Distance of the axes of two gears of one file, None unless they are parallel. [m]."""
    if np.linalg.norm(np.cross(first.axis, second.axis)) > _PARALLEL:
        return None
    between = second.center - first.center
    return float(np.linalg.norm(between - first.axis * (between @ first.axis)))


def _gears_of_solids(path: Path, unit: float, request: SectionRequest) -> FileContents:
    wanted = SectionRequest(request.axis, request.plane, request.body, request.part, teeth=True)
    sections = load_body_sections(path, unit, wanted)
    toothed = [cut for cut in sections if _teeth(cut.curves) is not None]
    found, refused = [], []
    for cut in toothed or sections[:1]:
        try:
            found.append(_gear(path, cut))
        except GeometryError as error:
            refused.append(error)
    if not found:
        raise refused[0]
    numbers = {gear.body for gear in found}
    return FileContents(
        _by_size([gear for gear in found if not gear.internal]),
        tuple(_plain(path, (cut for cut in sections if cut.body not in numbers))),
        _by_size([gear for gear in found if gear.internal]),
    )


def _teeth(curves: list[Array]) -> int | None:
    """Number of the outermost curve with teeth, 0 being the outline of a body."""
    toothed = (k for k, curve in enumerate(curves) if repeating_teeth(curve) is not None)
    return next(toothed, None)


def _gear(path: Path, cut: BodySection) -> FoundGear:
    frame, place = axis_frame(cut.axis), _teeth(cut.curves) or 0
    outline = cut.curves[place]
    second = cut.second[place] if place < len(cut.second) else None
    try:
        detected = gear_profile_from_curve(outline, key=str(path))
    except GeometryError as error:
        low, high = (1e3 * value for value in cut.extent)
        along = ", ".join(f"{value:.4g}" for value in cut.axis)
        said = (
            f" (section of body {cut.body} at {cut.height * 1e3:.5g} mm of its extent {low:.5g} to "
            f"{high:.5g} mm along ({along}); profile_axis and profile_plane choose another)"
        )
        raise error.changed(lambda one: one._replace(allowed=one.allowed + said)) from error
    low, high = cut.teeth_extent or (0.0, 0.0)
    gear = FoundGear(
        file=path,
        name=cut.name,
        detected=detected,
        body=cut.body,
        axis=cut.axis,
        center=frame.T @ np.array([*detected.center, cut.height]),
        face_width=high - low if high > low else None,
        length=cut.extent[1] - cut.extent[0],
        helix_angle=0.0,
        internal=place > 0,
    )
    distance = cut.height - cut.second_height
    if second is None or distance == 0.0:
        return gear
    # change of tip circle or size between two sections over their distance
    curves = [curve - np.array(detected.center) for curve in (outline, second)]
    tips = [float(np.hypot(*curve.T).max()) for curve in curves]
    sizes = [float(np.sqrt(abs(signed_area(curve)) / np.pi)) for curve in curves]
    change = max(abs(tips[0] - tips[1]), abs(sizes[0] - sizes[1]))
    angle = float(np.arctan(change / abs(distance)))
    return replace(
        gear,
        helix_angle=_helix_angle(detected, outline, second, distance),
        taper=_certain(angle, change, detected, second),
    )


def _helix_angle(detected: DetectedGear, outline: Array, second: Array, distance: float) -> float:
    # turn of the teeth between two sections
    pitch = 2.0 * np.pi / detected.tooth_count
    center = np.array(detected.center)
    first, last = (
        area_phase(counter_clockwise(curve) - center, detected.tooth_count)
        for curve in (outline, second)
    )
    turn = (first - last + 0.5 * pitch) % pitch - 0.5 * pitch
    radius = 0.5 * (detected.profile.root_radius + detected.profile.tip_radius)
    return _certain(float(np.arctan(radius * turn / distance)), radius * turn, detected, second)


def _certain(angle: float, shift: float, detected: DetectedGear, second: Array) -> float:
    # what the chords of the outlines can make appear is none
    chords = max(detected.chord_height, float(chord_heights(second).max(initial=0.0)))
    seen = abs(shift) >= max(_CHORDS * chords, _LEAST_SHIFT) and abs(angle) >= _LEAST_HELIX
    return angle if seen else 0.0


def _outermost(curves: list[Array]) -> list[Array]:
    # a toothed bore lies inside its gear
    import shapely

    kept: list[Array] = []
    for curve in sorted(curves, key=lambda c: -abs(signed_area(c))):
        inside = shapely.Point(curve[0])
        if not any(shapely.Polygon(other).contains(inside) for other in kept):
            kept.append(curve)
    return kept


def _by_size(gears: list[FoundGear]) -> tuple[FoundGear, ...]:
    return tuple(sorted(gears, key=lambda gear: -gear.detected.profile.tip_radius))
