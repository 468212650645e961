r"""Gears of continuous contact: outlines without trapped oil, whose tips roll through the roots.

The normal at every place of a conjugate flank meets the pitch circle, and touches when its foot
there is the pitch point. With the polar angle :math:`\beta` of the foot from the middle of the
tooth, the distance s of the flank from it, positive outside the pitch circle, and the inclination
A of the normal against the radius of the foot, the flank is

.. math:: \mathbf p(\beta) = r\,\mathbf e(\beta) + s\,\mathbf e(\beta + A) .

The mate of an addendum :math:`(\beta, s, A)` on an equal gear is the dedendum
:math:`(\pi/z - \beta, -s, A)`, so that an addendum over the roll angles 0 to :math:`\pi/(2z)` is a
whole gear: both flanks of a tooth touch in turn, each for half a pitch, and at every angle one of
them does.

References
----------
.. [1] Litvin, Fuentes, Gear Geometry and Applied Theory, 2nd ed., 2004, chapters 6 and 13.
.. [2] EP 1921319, positive-displacement rotary pump with gears that mesh without encapsulation and
    whose helical teeth overlap by about one.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array
from toothspace.geometry.curve import CurveSegment, polar, sample_segments
from toothspace.geometry.gear_profile import GearProfile
from toothspace.numerics.roots import root_between

Family = Literal["arc_involute_arc", "circular_arc", "sinusoidal", "cycloidal"]
FAMILIES: tuple[Family, ...] = ("arc_involute_arc", "circular_arc", "sinusoidal", "cycloidal")
"""Outlines by the curve of their addendum."""
_CHECKED = 2001


@final
@dataclass(frozen=True)
class RolledFlank:
    """Places on a left flank by the foot of their normal on the pitch circle. Shape (n,)."""

    roll: Array
    """Polar angle of the foot from the middle of the tooth. [rad]"""
    distance: Array
    """Distance from the foot, positive outside the pitch circle. [m]"""
    inclination: Array
    """Angle of the outward normal from the radius of the foot. [rad]"""


@final
@dataclass(frozen=True, kw_only=True)
class ContinuousGear:
    """One of two equal gears of continuous contact in the transverse section."""

    family: Family
    """Curve of the addendum."""
    tooth_count: int
    """Number of teeth."""
    module: float
    """Diameter of the pitch circle over the number of teeth. [m]"""
    pressure_angle: float | None = None
    """Of the involute between both arcs; None with other families. [rad]"""
    tip_diameter: float | None = None
    """Of the whole tooth, before the tip is ground; None where the family has one only. [m]"""
    tip_land: float = 0.0
    """Width to which the tip is ground flat. [m]"""
    root_clearance: float = 0.0
    """Play of the tip in the root between two involutes, where arcs do not touch. [m]"""
    backlash: float = 0.0
    """Play of both flanks together along the common normal. [m]"""

    @property
    def reference_radius(self) -> float:
        """Radius of the pitch circle. [m]."""
        return 0.5 * self.module * self.tooth_count

    @property
    def quarter_pitch(self) -> float:
        """Roll angle of the addendum: half of the tooth on the pitch circle. [rad]."""
        return math.pi / (2.0 * self.tooth_count)

    @property
    def addendum(self) -> float:
        """Height of the whole tooth above the pitch circle. [m]."""
        r = self.reference_radius
        if self.family == "arc_involute_arc":
            assert self.pressure_angle is not None
            return r * math.cos(self.pressure_angle) * self.quarter_pitch
        if self.family == "cycloidal":
            return 0.5 * self.module
        assert self.tip_diameter is not None
        return 0.5 * self.tip_diameter - r

    def pieces(self) -> list[Callable[[Array], RolledFlank]]:
        """Smooth pieces of the addendum from the tip to the pitch circle, over 0 to 1."""
        r, z, height, quarter = (
            self.reference_radius, self.tooth_count, self.addendum, self.quarter_pitch
        )  # fmt: skip
        if self.family == "arc_involute_arc":
            assert self.pressure_angle is not None
            side, base = 0.5 * math.pi - self.pressure_angle, r * math.cos(self.pressure_angle)

            def arc(u: Array) -> RolledFlank:
                return RolledFlank(np.zeros_like(u), np.full_like(u, height), side * u)

            def involute(u: Array) -> RolledFlank:
                roll = quarter * u
                return RolledFlank(roll, height - base * roll, np.full_like(u, side))

            return [arc, involute]
        if self.family == "circular_arc":
            # centre on the axis of the tooth, through tip and pitch circle
            tip, end = r + height, polar(r, np.array([quarter]))[0]
            center = (tip**2 - r**2) / (2.0 * (tip - end[0]))
            last = float(np.arctan2(end[1], end[0] - center))

            def circle(u: Array) -> RolledFlank:
                points = polar(tip - center, last * u) + np.array([center, 0.0])
                return _from_normals(points, last * u, r)

            return [circle]
        if self.family == "sinusoidal":

            def wave(u: Array) -> RolledFlank:
                angle = quarter * u
                radius, slope = r + height * np.cos(z * angle), -height * z * np.sin(z * angle)
                normal = angle - np.arctan2(slope, radius)
                return _from_normals(polar(radius, angle), normal, r)

            return [wave]

        # cycloidal: a circle that rolls half a turn from the tip to the pitch circle
        def arch(u: Array) -> RolledFlank:
            # even along the curve, whose curvature has no bound at the pitch circle
            turn = 2.0 * np.arccos(np.clip(u, 0.0, 1.0))
            roll = quarter * (1.0 - turn / math.pi)
            return RolledFlank(roll, r / z * np.sin(0.5 * turn), 0.5 * (math.pi - turn))

        return [arch]

    def points(self, flank: RolledFlank, *, mate: bool = False) -> Array:
        """Points of the flank, or of the dedendum that is its mate. Shape (n, 2). [m]."""
        roll = math.pi / self.tooth_count - flank.roll if mate else flank.roll
        distance = (-flank.distance if mate else flank.distance) - 0.25 * self.backlash
        if mate and self.root_clearance > 0.0:
            # deepest in the middle of the root, with the tangent of the involute where it begins
            side = 0.5 * math.pi - (self.pressure_angle or 0.0)
            inner = np.where(flank.roll > 0.0, 0.0, 1.0 - flank.inclination / side)
            distance = distance - self.root_clearance * inner**2 * (3.0 - 2.0 * inner)
        return polar(self.reference_radius, roll) + polar(distance, roll + flank.inclination)

    def mean_square_distance(self) -> float:
        """Mean of the square of the contact's distance from the pitch point over a turn. [m2]."""
        total = 0.0
        for piece in self.pieces():
            found = piece(np.linspace(0.0, 1.0, _CHECKED))
            total += float(np.trapezoid(found.distance**2, found.roll))
        return total / self.quarter_pitch

    def displacement_per_radian(self, face_width: float) -> float:
        r"""Volume delivered per radian with a seal at each contact.

        Parameters
        ----------
        face_width : float
            Width of the gears. [m]

        Notes
        -----
        .. math:: \frac{V}{2\pi} = b\,(r_a^2 - r^2 - \overline{s^2})
        """
        r, tip = self.reference_radius, self.tip_radius
        return face_width * (tip**2 - r**2 - self.mean_square_distance())

    def flow_ripple(self, overlap_ratio: float = 0.0) -> float:
        r"""Largest less smallest ideal flow over its mean, over all sections of the width. [-].

        Parameters
        ----------
        overlap_ratio : float
            Twist of the face width over the pitch; 0 of spur gears. [-]

        Notes
        -----
        The flow of a section is :math:`b\,\omega\,(r_a^2 - r^2 - s^2)`, with the distance s of the
        contact from the pitch point. Both flanks of a tooth touch in turn, so that :math:`s^2` has
        half a pitch as its period.
        """
        found = [piece(np.linspace(0.0, 1.0, _CHECKED)) for piece in self.pieces()]
        roll = np.concatenate([one.roll for one in found])
        square = np.concatenate([one.distance for one in found]) ** 2
        places = np.linspace(0.0, self.quarter_pitch, _CHECKED)
        half = np.interp(places, roll, square)
        period = np.concatenate([half, half[-2::-1]])
        swing = float(np.ptp(period))
        turns = 2.0 * overlap_ratio
        if turns > 1e-6:
            steps = len(period) - 1
            swept = np.concatenate([[0.0], np.cumsum(0.5 * (period[1:] + period[:-1])) / steps])
            begin = np.arange(steps) / steps
            end = begin + turns % 1.0
            grid = np.linspace(0.0, 1.0, steps + 1)
            past = np.interp(end % 1.0, grid, swept) + np.floor(end) * swept[-1]
            swing = float(np.ptp(past - swept[:-1])) / turns
        return swing / self.displacement_per_radian(1.0)

    @property
    def tip_radius(self) -> float:
        """Tip circle of the ground tooth. [m]."""
        return float(np.hypot(*self._at_land()[1]))

    @property
    def smallest_radius(self) -> float:
        """Smallest radius of curvature of the flanks, both ends of a cycloid left out. [m]."""
        found = []
        for piece in self.pieces():
            flank = piece(np.linspace(0.01, 0.99, _CHECKED))
            for mate in (False, True):
                points = self.points(flank, mate=mate)
                step = np.hypot(*np.diff(points, axis=0).T)
                roll = math.pi / self.tooth_count - flank.roll if mate else flank.roll
                turn = np.abs(np.diff(roll + flank.inclination))
                found.append(np.min(step / np.maximum(turn, 1e-12)))
        return float(min(found))

    def check(self) -> None:
        """Refuse a tooth that its mate undercuts.

        Raises GeometryError if the roll angle does not grow along the addendum, or the dedendum
        has a cusp.
        """
        r, z = self.reference_radius, self.tooth_count
        for piece in self.pieces():
            flank = piece(np.linspace(0.0, 1.0, _CHECKED))
            if not np.all(np.isfinite(flank.roll)) or np.any(np.diff(flank.roll) < -1e-9):
                raise self._refusal("the normals of the tip cross before the pitch circle")
            root = np.diff(self.points(flank, mate=True), axis=0)
            roll = math.pi / z - flank.roll + flank.inclination
            along = np.column_stack([-np.sin(roll), np.cos(roll)])
            if np.any(np.sum(root * along[1:], axis=1) > 1e-9 * r):
                raise self._refusal("the tip of the mate undercuts the root")
        if self._at_land()[1][0] - r < 0.2 * self.addendum:
            raise GeometryError(
                "tip_land", f"{self.tip_land * 1e3:.4g} mm", "less: most of the addendum is ground"
            )

    def _refusal(self, why: str) -> GeometryError:
        if self.tip_diameter is None:
            return GeometryError("tooth_count", f"{self.tooth_count}: {why}", "more teeth")
        high = 2.0 * self.reference_radius + 0.9 * self.module
        return GeometryError(
            "tip_diameter",
            f"{self.tip_diameter * 1e3:.5g} mm: {why}",
            f"a smaller one, about {high * 1e3:.4g} mm at most",
        )

    def _at_land(self) -> tuple[float, Array]:
        """Where the first piece meets the ground tip: its parameter, and the place. [-], [m]."""
        first = self.pieces()[0]

        def wide(u: float) -> float:
            x, y = self.points(first(np.array([u])))[0]
            return float(math.hypot(x, y) * math.atan2(y, x)) - 0.5 * self.tip_land

        if self.tip_land == 0.0:
            return 0.0, np.array([self.reference_radius + self.addendum - 0.25 * self.backlash, 0])
        if wide(1.0) <= 0.0:
            raise GeometryError(
                "tip_land", f"{self.tip_land * 1e3:.4g} mm", "less than the tip is wide"
            )
        u = root_between(wide, 0.0, 1.0, 1e-15)
        return u, self.points(first(np.array([u])))[0]


def _from_normals(points: Array, normal: Array, radius: float) -> RolledFlank:
    """Places of points [m] with directions of normals [rad], about a pitch circle [m]."""
    out = np.column_stack([np.cos(normal), np.sin(normal)])
    along = np.sum(points * out, axis=1)
    room = along**2 - (np.sum(points**2, axis=1) - radius**2)
    distance = along - np.sqrt(np.where(room >= 0.0, room, np.nan))
    foot = points - distance[:, None] * out
    roll = np.arctan2(foot[:, 1], foot[:, 0])
    return RolledFlank(roll, distance, normal - roll)


def generate_continuous(gear: ContinuousGear, points_per_tooth: int = 400) -> GearProfile:
    """One pitch of the outline, every point on the exact curve, closer together at junctions.

    Raises GeometryError if tip or root are undercut, or the land is wider than the tip.

    Parameters
    ----------
    points_per_tooth : int
        Number of intervals on one pitch, even, at least 80.
    """
    gear.check()
    start, corner = gear._at_land()
    pieces, pitch = gear.pieces(), math.pi / gear.tooth_count
    segments, land = [], float(np.arctan2(corner[1], corner[0]))
    if gear.tip_land > 0.0:
        tip = float(np.hypot(*corner))
        segments.append(CurveSegment(lambda u: polar(tip, land * u), (0.0, 2.0)))

    def above(piece: Callable[[Array], RolledFlank], first: float) -> Callable[[Array], Array]:
        return lambda u: gear.points(piece(first + (1.0 - first) * u))

    def below(piece: Callable[[Array], RolledFlank]) -> Callable[[Array], Array]:
        return lambda u: gear.points(piece(1.0 - u), mate=True)

    for k, piece in enumerate(pieces):
        first = start if k == 0 else 0.0
        near = 1.0 if k else 2.0 * (start > 0.0)
        segments.append(CurveSegment(above(piece, first), (near, 1.0)))
    for k, piece in enumerate(reversed(pieces)):
        last = k == len(pieces) - 1
        segments.append(CurveSegment(below(piece), (1.0, 0.0 if last else 1.0)))
    half, breaks = sample_segments(segments, points_per_tooth // 2)
    half[-1] = polar(float(np.hypot(*half[-1])), np.array([pitch]))[0]
    points = np.vstack([half[:0:-1] * (1.0, -1.0), half])
    middle = len(half) - 1
    ground = breaks[0] if gear.tip_land > 0.0 else 0
    return GearProfile(
        tooth_count=gear.tooth_count,
        points=points,
        tip_start=middle - ground,
        tip_end=middle + ground,
        tip_radius=float(np.hypot(*half[0])),
        root_radius=float(np.hypot(*half[-1])),
        breaks=tuple(middle - k for k in reversed(breaks)) + tuple(middle + k for k in breaks),
    )
