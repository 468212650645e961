"""Where the mesh splits chambers: the throat between two facing flanks over the angle.

Along the lens of both tip circles, drive and driven tooth spaces follow one another, separated
by throats. The *leading* throat of a drive space lies between the trailing flank of the drive
tooth ahead and the driven tooth in the space (right flanks); the *trailing* throat between that
driven tooth and the leading flank of the drive tooth behind (left flanks).

The angle of a throat is that of the middle of its drive tooth space, measured from the centre
line in the sense of rotation. Polar places on a tip circle are measured likewise for both gears.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, final

import numpy as np

from toothspace.closures.smooth import smooth_step
from toothspace.core.compiled import inlined, njit
from toothspace.core.types import Array
from toothspace.gearing.closest_points import (
    FIRST_AT_CORNER,
    FREE,
    Closest,
    Placement,
    closest_points,
    nearest_knot,
    placed_point,
    placed_tangent,
    project,
    refined,
)
from toothspace.gearing.tooth import Flank, flank_curvature, flank_length, flank_swept_area

_STEP = 2e-5
_COLUMNS = 23


class Mesh(NamedTuple):
    """Two gears in mesh, drive gear at the origin, the mesh above it.

    A ring gear has negative radii: its centre lies below, its places are against the rotation.
    """

    center_distance: float
    """Height of the driven gear's centre, negative for a ring gear. [m]"""
    ratio: float
    """Speed of the driven over the speed of the drive gear, positive where they turn opposite ways,
    negative for a ring gear. [-]
    """
    half_pitch: float
    """Half of the drive gear's pitch angle. [rad]"""
    turn: float
    """Right-handed rotation of the driven gear from centred backlash to contact. [rad]"""
    lens_drive: float
    lens_driven: float
    """Half angle of the lens of the tip circles seen from each centre, negative from that of a ring
    gear. [rad]
    """

    @property
    def pitch_radii(self) -> tuple[float, float]:
        """Operating pitch radii of drive and driven gear. [m]."""
        drive = self.center_distance / (1.0 + 1.0 / self.ratio)
        return drive, self.center_distance / (1.0 + self.ratio)


class Window(NamedTuple):
    """Angles at which a throat appears, is complete, begins to leave and is gone. [rad]."""

    appears: float
    complete: float
    leaves: float
    gone: float


class _Ends(NamedTuple):
    x1: float
    y1: float
    x2: float
    y2: float
    inward1: float
    inward2: float
    along1: float
    along2: float
    weight: float


@final
@dataclass(frozen=True)
class ThroatEnd:
    """End of throats of one kind on one gear at many angles."""

    point: Array
    """Place; the cusp of the tip circles where there is no throat. Shape (angles, 2). [m]"""
    velocity: Array
    """Its derivative with respect to the shaft angle. Shape (angles, 2). [m/rad]"""
    swept: Array
    """Area swept from the root middle along flank and tip circle to the end. [m2]"""
    along: Array
    """Place of the end on its tip circle, or of the tip corner where it is on the flank. [rad]"""
    corner: Array
    """Place of the tip corner. [rad]"""
    curvature: Array
    """Curvature of the flank at the end, positive where convex. [1/m]"""
    inward: Array
    """Curve length from the tip corner to the end, negative where it is on the tip circle. [m]"""


@final
@dataclass(frozen=True)
class Throats:
    """Throats of one kind at many angles; arrays of shape (angles,) or (angles, 2)."""

    weight: Array
    """1 where the throat is complete, 0 where the teeth are not in the lens. [-]"""
    gap: Array
    """Distance along the normal, negative where the flanks overlap. [m]"""
    normal: Array
    """Unit vector from the drive to the driven flank. [-]"""
    at_corner: Array
    """True where an end lies at a tip corner. [-]"""
    drive: ThroatEnd
    driven: ThroatEnd
    """Ends on both gears."""

    @property
    def middle(self) -> Array:
        """Middle of the throat. [m]."""
        return 0.5 * (self.drive.point + self.driven.point)


def throats(drive: Flank, driven: Flank, mesh: Mesh, angles: Array) -> Throats:
    """Throats between facing flanks.

    Parameters
    ----------
    drive, driven : Flank
        Both right flanks (leading throat) or both left flanks (trailing throat).
    mesh : Mesh
        Gears in mesh.
    angles : ndarray
        Throat angles. [rad]

    Returns
    -------
    Throats
        Geometry at the angles.
    """
    data = _throat_rows(drive, driven, mesh, np.ascontiguousarray(angles, dtype=float))
    ends = (
        ThroatEnd(
            point=data[:, 1 + 2 * k : 3 + 2 * k],
            velocity=data[:, 5 + 2 * k : 7 + 2 * k],
            swept=data[:, 9 + k],
            along=data[:, 11 + k],
            corner=data[:, 13 + k],
            curvature=data[:, 18 + k],
            inward=data[:, 21 + k],
        )
        for k in (0, 1)
    )
    return Throats(data[:, 0], data[:, 15], data[:, 16:18], data[:, 20] != FREE, *ends)


@inlined
def throat_window(drive: Flank, driven: Flank, mesh: Mesh) -> Window:
    """Angles at which the two tip corners pass the cusps of the lens."""
    offset = drive.corner_angle - drive.side * mesh.half_pitch
    lag = mesh.turn + driven.corner_angle
    enter1, exit1 = -mesh.lens_drive - offset, mesh.lens_drive - offset
    enter2 = (lag - mesh.lens_driven) / mesh.ratio
    exit2 = (lag + mesh.lens_driven) / mesh.ratio
    complete, leaves = max(enter1, enter2), min(exit1, exit2)
    if complete > leaves:
        complete = leaves = 0.5 * (complete + leaves)
    return Window(min(enter1, enter2), complete, leaves, max(exit1, exit2))


@inlined
def _ramp(position: float, start: float, end: float) -> float:
    if end - start < 1e-12:
        return 1.0 if position >= end else 0.0
    return min(max((position - start) / (end - start), 0.0), 1.0)


@inlined
def _placements(drive: Flank, mesh: Mesh, angle: float) -> tuple[Placement, Placement]:
    first = Placement(0.5 * np.pi + angle - drive.side * mesh.half_pitch, 0.0)
    second = Placement(-0.5 * np.pi - mesh.ratio * angle + mesh.turn, mesh.center_distance)
    return first, second


@inlined
def _inward(
    flank: Flank, at: Placement, cusp: tuple[float, float], excess: float, closest: float, t: float
) -> float:
    # distance of the throat's end inwards from the tip corner; negative on the tip circle.
    # t runs from 0, throat at the cusp of the lens, to 1, throat at the closest points
    length = flank_length(flank)
    if t >= 1.0:
        return length - closest
    if excess > 0.0:
        # pause at the corner: a moving end would turn there
        if t < 0.5:
            return -excess * (1.0 - smooth_step(2.0 * t))
        return smooth_step(2.0 * t - 1.0) * (length - closest)
    guess = nearest_knot(flank, at, cusp[0], cusp[1])
    outer = project(flank, at, cusp[0], cusp[1], guess)
    w = smooth_step(t)
    return length - (1.0 - w) * outer - w * closest


@inlined
def _ends(
    drive: Flank, driven: Flank, mesh: Mesh, window: Window, angle: float, near: Closest
) -> _Ends:
    sign = -1.0 if 2.0 * angle < window.complete + window.leaves else 1.0
    first, second = _placements(drive, mesh, angle)
    lens1, lens2 = sign * mesh.lens_drive, sign * mesh.lens_driven
    cusp_x = -drive.tip_radius * np.sin(lens1)
    cusp_y = drive.tip_radius * np.cos(lens1)
    if angle <= window.appears or angle >= window.gone:
        return _Ends(cusp_x, cusp_y, cusp_x, cusp_y, -1.0, -1.0, lens1, lens2, 0.0)
    progress = min(
        _ramp(angle, window.appears, window.complete),
        1.0 - _ramp(angle, window.leaves, window.gone),
    )
    weight = smooth_step(progress)
    corner1 = first.angle - 0.5 * np.pi + drive.corner_angle
    corner2 = -(second.angle + 0.5 * np.pi) - driven.corner_angle
    cusp = (cusp_x, cusp_y)
    excess1 = drive.tip_radius * (sign * corner1 - mesh.lens_drive)
    excess2 = driven.tip_radius * (sign * corner2 - mesh.lens_driven)
    in1 = _inward(drive, first, cusp, excess1, near.first, progress)
    in2 = _inward(driven, second, cusp, excess2, near.second, progress)
    along1, along2 = corner1, corner2
    if in1 >= 0.0:
        x1, y1 = placed_point(drive, first, flank_length(drive) - in1)
    else:
        along1 = corner1 + sign * in1 / drive.tip_radius
        x1, y1 = -drive.tip_radius * np.sin(along1), drive.tip_radius * np.cos(along1)
    if in2 >= 0.0:
        x2, y2 = placed_point(driven, second, flank_length(driven) - in2)
    else:
        along2 = corner2 + sign * in2 / driven.tip_radius
        x2 = -driven.tip_radius * np.sin(along2)
        y2 = mesh.center_distance - driven.tip_radius * np.cos(along2)
    return _Ends(x1, y1, x2, y2, in1, in2, along1, along2, weight)


@inlined
def _swept(flank: Flank, inward: float, turned: float) -> float:
    # turned: polar angle from the tip corner to the end on the tip circle, right-handed
    if inward >= 0.0:
        return flank_swept_area(flank, flank_length(flank) - inward)
    return flank.area[-1] + 0.5 * flank.tip_radius**2 * turned


@inlined
def _outward(flank: Flank, at: Placement, place: float) -> tuple[float, float]:
    dx, dy, _, _ = placed_tangent(flank, at, place)
    speed = np.sqrt(dx * dx + dy * dy)
    return -flank.side * dy / speed, flank.side * dx / speed


@inlined
def _signed_gap(
    drive: Flank, driven: Flank, mesh: Mesh, angle: float, near: Closest, ends: _Ends
) -> tuple[float, float, float]:
    first, second = _placements(drive, mesh, angle)
    gx, gy = ends.x2 - ends.x1, ends.y2 - ends.y1
    reach = np.sqrt(gx * gx + gy * gy)
    if near.mode != FIRST_AT_CORNER:
        nx, ny = _outward(drive, first, near.first)
    else:
        mx, my = _outward(driven, second, near.second)
        nx, ny = -mx, -my
    if ends.weight >= 1.0 and near.mode == FREE:
        return gx * nx + gy * ny, nx, ny
    if reach < 1e-12:
        return 0.0, nx, ny
    sign = -1.0 if ends.weight >= 1.0 and gx * nx + gy * ny < 0.0 else 1.0
    return sign * reach, sign * gx / reach, sign * gy / reach


@njit
def _throat_rows(drive: Flank, driven: Flank, mesh: Mesh, angles: Array) -> Array:
    window = throat_window(drive, driven, mesh)
    rows = np.zeros((angles.size, _COLUMNS))
    idle = Closest(0.0, 0.0, FIRST_AT_CORNER)
    for k in range(angles.size):
        angle, row = angles[k], rows[k]
        first, second = _placements(drive, mesh, angle)
        inside = window.appears < angle < window.gone
        near = closest_points(drive, first, driven, second) if inside else idle
        ends = _ends(drive, driven, mesh, window, angle, near)
        row[0], row[1], row[2], row[3], row[4] = ends.weight, ends.x1, ends.y1, ends.x2, ends.y2
        corner1 = first.angle - 0.5 * np.pi + drive.corner_angle
        corner2 = -(second.angle + 0.5 * np.pi) - driven.corner_angle
        row[9] = _swept(drive, ends.inward1, ends.along1 - corner1)
        row[10] = _swept(driven, ends.inward2, corner2 - ends.along2)
        row[11], row[12], row[13], row[14] = ends.along1, ends.along2, corner1, corner2
        row[21], row[22] = ends.inward1, ends.inward2
        row[16] = -1.0
        if not inside:
            continue
        after1, after2 = _placements(drive, mesh, angle + _STEP)
        before1, before2 = _placements(drive, mesh, angle - _STEP)
        near_after = refined(drive, after1, driven, after2, near)
        near_before = refined(drive, before1, driven, before2, near)
        b = _ends(drive, driven, mesh, window, angle + _STEP, near_after)
        a = _ends(drive, driven, mesh, window, angle - _STEP, near_before)
        row[5], row[6] = (b.x1 - a.x1) / (2.0 * _STEP), (b.y1 - a.y1) / (2.0 * _STEP)
        row[7], row[8] = (b.x2 - a.x2) / (2.0 * _STEP), (b.y2 - a.y2) / (2.0 * _STEP)
        row[15], row[16], row[17] = _signed_gap(drive, driven, mesh, angle, near, ends)
        row[18] = flank_curvature(drive, near.first)
        row[19] = flank_curvature(driven, near.second)
        row[20] = near.mode
    return rows
