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
from toothspace.geometry.curve import CurveSegment, arc_lengths, polar, sample_segments
from toothspace.geometry.gear_profile import GearProfile
from toothspace.numerics.roots import root_between

Family = Literal["arc_involute_arc", "circular_arc", "sinusoidal", "cycloidal"]
FAMILIES: tuple[Family, ...] = ("arc_involute_arc", "circular_arc", "sinusoidal", "cycloidal")
"""Outlines by the curve of their addendum."""
_CHECKED = 2001
_MOST_OF_A_PITCH = 0.52
"""Part of a pitch that one side of the teeth touches at most: half of it, but for the drawing."""
_LARGEST_GAP = 0.02
"""Gap or overlap of flanks that still count as touching, in transverse modules. [-]"""
_LARGEST_CLEARANCE = 0.1
"""Play of the tips in the roots that still seal in the middle of a space, in modules. [-]"""
LARGEST_DIFFERENCE = 0.01
"""Distance between the outlines of gears that count as equal, in transverse modules. [-]"""
_BESIDE_TIP = 0.05
"""Part of the addendum that is left out at the tip, where outlines from files have corners. [-]"""
_BENT = 0.05
"""Length of flank on which a drawn one is said to bend, in transverse modules. [-]"""


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


@final
@dataclass(frozen=True)
class RolledOutline:
    """How the outline of a gear rolls on an equal one."""

    pitch_radius: float
    """Circle on which both roll. [m]"""
    tooth_count: int
    contact_ratio: float
    """Part of a pitch for which one side of the teeth touches; NaN where normals of the flank miss
    the pitch circle. [-]
    """
    gaps: tuple[float, float]
    """Least and largest distance of the flanks where they should touch, negative where they
    overlap. [m]
    """
    root_clearance: float
    """Play of the tips in the roots. [m]"""
    smallest_radius: float
    """Smallest radius of curvature of a flank, corners at its ends left out. [m]"""

    @property
    def module(self) -> float:
        """Transverse module of the pitch circle. [m]."""
        return 2.0 * self.pitch_radius / self.tooth_count

    @property
    def backlash(self) -> float:
        """Play of both flanks together, at least 0. [m]."""
        return 2.0 * max(self.gaps[0], 0.0)

    @property
    def refusal(self) -> str:
        """Why the outline is none of continuous contact; empty if it is one."""
        least, largest = self.gaps
        if not math.isfinite(self.contact_ratio):
            return "flanks whose normals miss the pitch circle"
        if self.contact_ratio > _MOST_OF_A_PITCH:
            return (
                f"flanks of one side that touch for {self.contact_ratio:.2f} of a pitch, as those "
                "of ordinary gears that trap oil"
            )
        if self.root_clearance > _LARGEST_CLEARANCE * self.module:
            return f"roots {1e3 * self.root_clearance:.3g} mm deeper than the tips reach"
        if least < -_LARGEST_GAP * self.module:
            return f"flanks that overlap by {-1e3 * least:.3g} mm"
        if largest > _LARGEST_GAP * self.module:
            return f"flanks that stand {1e3 * largest:.3g} mm apart where they should touch"
        return ""


def rolled_outline(profile: GearProfile, distance: float | None = None) -> RolledOutline:
    """How an outline from a file rolls on an equal one.

    Raises GeometryError if the pitch circles of a distance do not pass through the teeth.

    Parameters
    ----------
    profile : GearProfile
        Transverse section, as drawn.
    distance : float, optional
        Distance of the centres; that without backlash if not given. [m]

    Notes
    -----
    Places of the addendum by the foot of their normal on the pitch circle give the dedendum that
    is their mate, which is held against the drawn one. Without a distance the pitch circle is the
    one on which teeth are as thick as spaces.
    """
    from scipy.interpolate import CubicSpline
    from scipy.spatial import KDTree

    quarter, flank = math.pi / (2.0 * profile.tooth_count), profile.left_flank
    along = arc_lengths(flank)
    spline = CubicSpline(along, flank)
    place = np.linspace(0.0, along[-1], _CHECKED)
    points, tangent = np.asarray(spline(place)), np.asarray(spline(place, 1))
    # tips come first, and the solid lies clockwise of a left flank
    direction = np.unwrap(np.arctan2(-tangent[:, 0], tangent[:, 1]))
    outward = np.column_stack([np.cos(direction), np.sin(direction)])
    radius, angle = np.hypot(*points.T), np.arctan2(points[:, 1], points[:, 0])
    pitch = 0.5 * distance if distance else float(np.interp(quarter, angle, radius))
    outside = radius > pitch
    if outside.all() or not outside.any():
        raise GeometryError(
            "center_distance", f"{2e3 * pitch:.5g} mm", "pitch circles between root and tip"
        )
    with np.errstate(invalid="ignore"):
        addendum = _from_normals(points[outside], direction[outside], pitch)
    places = RolledFlank(*(value[addendum.roll > 0.0] for value in vars(addendum).values()))
    roll = math.pi / profile.tooth_count - places.roll
    mates = polar(pitch, roll) + polar(-places.distance, roll + places.inclination)
    if not mates.size:
        mates = points[~outside][:1]
    nearest = KDTree(points[~outside]).query(mates)[1]
    gap = np.sum((mates - points[~outside][nearest]) * outward[~outside][nearest], axis=1)
    # a corner beside the tip belongs to none of both
    module, step = 2.0 * pitch / profile.tooth_count, along[-1] / (_CHECKED - 1)
    span = max(round(_BENT * module / step), 1)
    turn = np.abs(direction[span:] - direction[:-span])[span:-span]
    # the spline's normals beside the corner of the tip are those of none of its sides
    first = float(np.quantile(addendum.roll, _BESIDE_TIP))
    return RolledOutline(
        pitch_radius=pitch,
        tooth_count=profile.tooth_count,
        contact_ratio=(quarter - first) / (2.0 * quarter),
        gaps=(float(gap.min()), float(gap.max())),
        root_clearance=2.0 * pitch - profile.tip_radius - profile.root_radius,
        smallest_radius=float(span * step / turn.max()),
    )


def outlines_apart(first: GearProfile, second: GearProfile) -> float:
    """Largest distance between two outlines of one pitch; infinite for unlike tooth counts. [m]."""
    import shapely

    if first.tooth_count != second.tooth_count:
        return math.inf
    lines = [shapely.LineString(profile.points) for profile in (first, second)]
    return float(shapely.hausdorff_distance(*lines))
