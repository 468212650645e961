"""Where the mesh splits chambers: the throat between two facing flanks over the angle.

Along the lens of both tip circles, drive and driven tooth spaces follow one another, separated
by throats. The *leading* throat of a drive space lies between the trailing flank of the drive
tooth ahead and the driven tooth in the space (right flanks); the *trailing* throat between that
driven tooth and the leading flank of the drive tooth behind (left flanks).

The angle of a throat is that of the middle of its drive tooth space, measured from the centre
line in the sense of rotation. Polar places on a tip circle are measured likewise for both gears.
A place on a flank is its spline parameter, from 0 in the root middle to the tip corner; every
flank is turned by an angle, then shifted by its centre.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, final

import numpy as np

from toothspace.closures.smooth import smooth_step
from toothspace.core.compiled import inlined, kernel
from toothspace.core.recall import recalled
from toothspace.core.types import Array, IntArray
from toothspace.gearing.tooth import (
    Flank,
    flank_curvature,
    flank_length,
    flank_point,
    flank_swept_area,
    flank_tangent,
)

FREE, FIRST_AT_CORNER, SECOND_AT_CORNER = 0, 1, 2
"""How the closest points lie: common normal, or one of them at its flank's tip corner."""

_ITERATIONS = 30
_TOLERANCE = 1e-13
_OVERLAP = 2e-5
"""Largest overlap of flanks, which have a common normal longer than the way to a crossing. [m]"""
_ROUNDING = 1.0 + 1e-9
_STARTS, _PARTS = 3, 4


class Placement(NamedTuple):
    """Where a gear's tooth stands: polar angle of the tooth [rad] and height of the centre [m]."""

    angle: float
    center: float


class Closest(NamedTuple):
    """Closest points: their places on the flanks [m] and how they lie."""

    first: float
    second: float
    mode: int


@inlined
def placed_point(flank: Flank, at: Placement, place: float) -> tuple[float, float]:
    """Point of a flank in the machine frame. [m]."""
    x, y = flank_point(flank, place)
    c, s = np.cos(at.angle), np.sin(at.angle)
    return c * x - s * y, s * x + c * y + at.center


@inlined
def placed_tangent(flank: Flank, at: Placement, place: float) -> tuple[float, float, float, float]:
    """First and second derivative of a flank in the machine frame. [-], [1/m]."""
    dx, dy, ddx, ddy = flank_tangent(flank, place)
    c, s = np.cos(at.angle), np.sin(at.angle)
    return c * dx - s * dy, s * dx + c * dy, c * ddx - s * ddy, s * ddx + c * ddy


@inlined
def project(flank: Flank, at: Placement, x: float, y: float, guess: float) -> float:
    """Place of the point of a flank closest to a given point, near a guess. [m]."""
    length = flank_length(flank)
    place = guess
    for _ in range(_ITERATIONS):
        px, py = placed_point(flank, at, place)
        dx, dy, ddx, ddy = placed_tangent(flank, at, place)
        residual = (px - x) * dx + (py - y) * dy
        slope = dx * dx + dy * dy + (px - x) * ddx + (py - y) * ddy
        if slope <= 0.1:
            slope = dx * dx + dy * dy
        step = min(max(-residual / slope, -0.05 * length), 0.05 * length)
        following = min(max(place + step, 0.0), length)
        change = abs(following - place)
        place = following
        if change < _TOLERANCE:
            break
    return place


@inlined
def nearest_knot(flank: Flank, at: Placement, x: float, y: float) -> float:
    """Place of the spline knot closest to a point. [m]."""
    best, place = 1e300, 0.0
    for k in range(flank.knots.size):
        px, py = placed_point(flank, at, flank.knots[k])
        d = (px - x) ** 2 + (py - y) ** 2
        if d < best:
            best, place = d, flank.knots[k]
    return place


class Search(NamedTuple):
    """Memory for the search for the places where two flanks come closest."""

    points: Array  # (knots of the first flank, 2)
    apart: Array  # (knots of the second flank,)
    near: IntArray
    reach: Array  # (places between those knots,)
    place: Array
    across: Array
    starts: Array  # (starts, 2), what is found


def search_of(first: Flank, second: Flank) -> Search:
    """Memory for a search between two flanks."""
    n, m = first.knots.size, second.knots.size
    reach, place, across = np.empty((3, _PARTS * (m - 1) + 3))
    near, starts = np.empty(m, dtype=np.int64), np.empty((_STARTS, 2))
    return Search(np.empty((n, 2)), np.empty(m), near, reach, place, across, starts)


@inlined
def starting_places(
    first: Flank, at_first: Placement, second: Flank, at_second: Placement, search: Search
) -> int:
    """Find the places where the flanks come closest; return how many there are. [m].

    Facets and waves come close at several places. From one knot of the second flank to the next
    the distance changes by the way at most, so one looks between them only where it can fall
    below the least that was found.
    """
    n, m = first.knots.size, second.knots.size
    points, apart, near, reach = search.points, search.apart, search.near, search.reach
    place, across, starts = search.place, search.across, search.starts
    for i in range(n):
        points[i, 0], points[i, 1] = placed_point(first, at_first, first.knots[i])
    least = 1e300
    for j in range(m):
        x, y = placed_point(second, at_second, second.knots[j])
        apart[j] = 1e300
        for i in range(n):
            d = (x - points[i, 0]) ** 2 + (y - points[i, 1]) ** 2
            if d < apart[j]:
                apart[j], near[j] = d, i
        # a knot is held against the tangent at another one: between knots alone the distance
        # would prefer where they are dense
        i = near[j]
        dx, dy, _, _ = placed_tangent(first, at_first, first.knots[i])
        ahead = (x - points[i, 0]) * dx + (y - points[i, 1]) * dy
        after = first.knots[min(i + 1, n - 1)] - first.knots[i]
        before = first.knots[i] - first.knots[max(i - 1, 0)]
        along = min(max(ahead, -0.5 * before), 0.5 * after)
        beyond_x, beyond_y = x - points[i, 0] - along * dx, y - points[i, 1] - along * dy
        apart[j] = np.sqrt(beyond_x**2 + beyond_y**2)
        least = min(least, apart[j])
    reach[:] = 1e300
    for j in range(m - 1):
        step = second.knots[j + 1] - second.knots[j]
        if 0.5 * (apart[j] + apart[j + 1] - step) > least:
            continue
        for k in range(_PARTS + 1):
            row = _PARTS * j + k + 1
            if reach[row] < 1e300:
                continue
            across[row] = second.knots[j] + step * k / _PARTS
            x, y = placed_point(second, at_second, across[row])
            i = near[j] if 2 * k <= _PARTS else near[j + 1]
            place[row] = project(first, at_first, x, y, first.knots[i])
            px, py = placed_point(first, at_first, place[row])
            reach[row] = np.sqrt((x - px) ** 2 + (y - py) ** 2)
    count = 0
    while count < _STARTS:
        best, chosen = 1e300, -1
        for row in range(1, reach.size - 1):
            lowest = reach[row] <= reach[row - 1] and reach[row] < reach[row + 1]
            if lowest and place[row] >= 0.0 and reach[row] < best:
                best, chosen = reach[row], row
        if chosen < 0:
            break
        starts[count, 0], starts[count, 1] = place[chosen], across[chosen]
        place[chosen] = -1.0
        count += 1
    return count


@inlined
def common_normal(
    first: Flank, at_first: Placement, second: Flank, at_second: Placement, start: Closest
) -> tuple[float, float, bool]:
    """Newton for parallel tangents and a line at right angles to them: places [m], whether found.

    Well conditioned at zero distance, where minimising the distance is not.
    """
    s, t = start.first, start.second
    limit_s, limit_t = 0.03 * flank_length(first), 0.03 * flank_length(second)
    for _ in range(_ITERATIONS):
        px, py = placed_point(first, at_first, s)
        qx, qy = placed_point(second, at_second, t)
        ax, ay, axx, ayy = placed_tangent(first, at_first, s)
        bx, by, bxx, byy = placed_tangent(second, at_second, t)
        gx, gy = qx - px, qy - py
        parallel, across = ax * by - ay * bx, gx * ax + gy * ay
        j11, j12 = axx * by - ayy * bx, ax * byy - ay * bxx
        j21, j22 = gx * axx + gy * ayy - ax * ax - ay * ay, bx * ax + by * ay
        det = j11 * j22 - j12 * j21
        if abs(det) < 1e-9:
            return s, t, False
        step_s = (j12 * across - j22 * parallel) / det
        step_t = (j21 * parallel - j11 * across) / det
        scale = max(abs(step_s) / limit_s, abs(step_t) / limit_t, 1.0)
        s, t = s + step_s / scale, t + step_t / scale
        if s < 0.0 or t < 0.0 or s > flank_length(first) or t > flank_length(second):
            return s, t, False
        if abs(step_s) + abs(step_t) < _TOLERANCE:
            return s, t, True
    return s, t, abs(step_s) + abs(step_t) < 1e-10


@inlined
def distance(
    first: Flank, at_first: Placement, second: Flank, at_second: Placement, pair: Closest
) -> float:
    """Distance of two points on the flanks. [m]."""
    px, py = placed_point(first, at_first, pair.first)
    qx, qy = placed_point(second, at_second, pair.second)
    return np.sqrt((px - qx) ** 2 + (py - qy) ** 2)


@inlined
def alternated(
    first: Flank,
    at_first: Placement,
    second: Flank,
    at_second: Placement,
    start: Closest,
    rounds: int,
) -> Closest:
    """Project in turn from one flank onto the other: slow, but never lost, corners included."""
    s, t = start.first, start.second
    for _ in range(rounds):
        x, y = placed_point(first, at_first, s)
        following = project(second, at_second, x, y, t)
        x, y = placed_point(second, at_second, following)
        place = project(first, at_first, x, y, s)
        change = abs(place - s) + abs(following - t)
        s, t = place, following
        if change < _TOLERANCE:
            break
    mode = FREE
    if t >= flank_length(second):
        mode = SECOND_AT_CORNER
    elif s >= flank_length(first):
        mode = FIRST_AT_CORNER
    return Closest(s, t, mode)


@inlined
def _outward(flank: Flank, at: Placement, place: float) -> tuple[float, float]:
    dx, dy, _, _ = placed_tangent(flank, at, place)
    speed = np.sqrt(dx * dx + dy * dy)
    return -flank.side * dy / speed, flank.side * dx / speed


@inlined
def _closest_from(
    first: Flank, at_first: Placement, second: Flank, at_second: Placement, start: Closest
) -> Closest:
    reach = distance(first, at_first, second, at_second, start)
    for rounds in (4, 40, 300):
        start = alternated(first, at_first, second, at_second, start, rounds)
        reach = min(reach, distance(first, at_first, second, at_second, start))
        s, t, found = common_normal(first, at_first, second, at_second, start)
        free = Closest(s, t, FREE)
        within = max(reach * _ROUNDING, _OVERLAP)
        if found and distance(first, at_first, second, at_second, free) <= within:
            return free
        if start.mode != FREE:
            break
    return start


@inlined
def _normal(
    first: Flank, at_first: Placement, second: Flank, at_second: Placement, pair: Closest
) -> tuple[float, float]:
    # from the first flank to the second one, of that which does not end there in its corner
    if pair.mode != FIRST_AT_CORNER:
        return _outward(first, at_first, pair.first)
    x, y = _outward(second, at_second, pair.second)
    return -x, -y


@inlined
def _signed_distance(
    first: Flank, at_first: Placement, second: Flank, at_second: Placement, pair: Closest
) -> float:
    # negative where the flanks overlap; points on the far sides of two teeth are no overlap
    px, py = placed_point(first, at_first, pair.first)
    qx, qy = placed_point(second, at_second, pair.second)
    nx, ny = _normal(first, at_first, second, at_second, pair)
    along = (qx - px) * nx + (qy - py) * ny
    reach = np.sqrt((qx - px) ** 2 + (qy - py) ** 2)
    return -reach if along < 0.0 and reach <= _OVERLAP else reach


@inlined
def closest_points(
    first: Flank, at_first: Placement, second: Flank, at_second: Placement, search: Search
) -> Closest:
    """Closest points of two flanks: on a common normal, or with one at its tip corner."""
    count, places = starting_places(first, at_first, second, at_second, search), search.starts
    best, least = Closest(0.0, 0.0, FREE), 1e300
    for k in range(count):
        start = Closest(places[k, 0], places[k, 1], FREE)
        pair = _closest_from(first, at_first, second, at_second, start)
        apart = _signed_distance(first, at_first, second, at_second, pair)
        if apart < least:
            best, least = pair, apart
    return best


@inlined
def refined(
    first: Flank, at_first: Placement, second: Flank, at_second: Placement, near: Closest
) -> Closest:
    """Closest points at a slightly different placement, lying as before."""
    if near.mode == FIRST_AT_CORNER:
        x, y = placed_point(first, at_first, near.first)
        return Closest(near.first, project(second, at_second, x, y, near.second), near.mode)
    if near.mode == SECOND_AT_CORNER:
        x, y = placed_point(second, at_second, near.second)
        return Closest(project(first, at_first, x, y, near.first), near.second, near.mode)
    s, t, found = common_normal(first, at_first, second, at_second, near)
    if found:
        return Closest(s, t, FREE)
    return near


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


_KEPT = 48
"""Throats that are remembered: a design is looked at again and again, in part unchanged."""


@recalled(_KEPT)
def throats(drive: Flank, driven: Flank, mesh: Mesh, angles: Array) -> Throats:
    """Throats between facing flanks.

    Geometry at the angles.

    Parameters
    ----------
    drive, driven : Flank
        Both right flanks (leading throat) or both left flanks (trailing throat).
    mesh : Mesh
        Gears in mesh.
    angles : ndarray
        Throat angles. [rad]
    """
    data = np.zeros((angles.size, _COLUMNS))
    at = np.ascontiguousarray(angles, dtype=float)
    _throat_rows(drive, driven, mesh, at, search_of(drive, driven), data)
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
def _signed_gap(
    drive: Flank, driven: Flank, mesh: Mesh, angle: float, near: Closest, ends: _Ends
) -> tuple[float, float, float]:
    first, second = _placements(drive, mesh, angle)
    gx, gy = ends.x2 - ends.x1, ends.y2 - ends.y1
    reach = np.sqrt(gx * gx + gy * gy)
    nx, ny = _normal(drive, first, driven, second, near)
    if ends.weight >= 1.0 and near.mode == FREE:
        return gx * nx + gy * ny, nx, ny
    if reach < 1e-12:
        return 0.0, nx, ny
    sign = -1.0 if ends.weight >= 1.0 and gx * nx + gy * ny < 0.0 else 1.0
    return sign * reach, sign * gx / reach, sign * gy / reach


@kernel
def _throat_rows(
    drive: Flank, driven: Flank, mesh: Mesh, angles: Array, search: Search, rows: Array
) -> None:
    window = throat_window(drive, driven, mesh)
    idle = Closest(0.0, 0.0, FIRST_AT_CORNER)
    for k in range(angles.size):
        angle, row = angles[k], rows[k]
        first, second = _placements(drive, mesh, angle)
        inside = window.appears < angle < window.gone
        near = closest_points(drive, first, driven, second, search) if inside else idle
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
