"""Involute teeth of a ring gear, and the pair that it makes with a pinion.

The tooth spaces of a ring gear are the teeth of an external gear of equal data: its tip circle is
the ring's root circle, and the rounding of its tip is the ring's root fillet.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array, FloatOrArray
from toothspace.gearing.tooth import LEFT, RIGHT, Tooth, flank_spline
from toothspace.geometry.curve import CurveSegment, polar, sample_segments, turned, turned_copies
from toothspace.geometry.gear_pair import InvolutePair
from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.involute import InvoluteGear, ToothForm, involute_function, tooth_form
from toothspace.numerics.roots import root_between

_LEAST_TIP = 1.0 + 1e-6


@final
@dataclass(frozen=True)
class RingGear:
    """Ring gear with involute teeth inside.

    Raises
    ------
    GeometryError
        If the tip circle lies below the base circle, or no involute is left.
    """

    space: InvoluteGear
    """External gear whose teeth are the ring's tooth spaces, up to the ring's root circle."""
    tip_radius: float
    """Radius of the circle inside the teeth. [m]"""

    def __post_init__(self) -> None:
        base = _LEAST_TIP * self.space.base_radius
        top = self.form.tip_form_radius
        if not base <= self.tip_radius < top:
            raise GeometryError(
                "tip_diameter",
                f"{self.tip_radius * 2000.0:.5g} mm",
                f"from the base diameter of {base * 2000.0:.5g} mm to the end of the involute at "
                f"{top * 2000.0:.5g} mm",
            )

    @cached_property
    def form(self) -> ToothForm:
        """Junctions of involute and root fillet, seen as those of the space."""
        return tooth_form(self.space)

    @property
    def tooth_count(self) -> int:
        """Number of teeth."""
        return self.space.tooth_count

    @property
    def root_radius(self) -> float:
        """Radius of the root circle, outside the teeth. [m]."""
        return self.space.tip_radius

    @property
    def base_radius(self) -> float:
        """Radius of the base circle. [m]."""
        return self.space.base_radius

    def half_angle(self, radius: FloatOrArray) -> FloatOrArray:
        """Half of the angular thickness of a tooth at a radius [m]. [rad]."""
        return np.pi / self.tooth_count - self.space.half_angle(radius)

    def half_pitch(self, points: int) -> tuple[Array, tuple[int, ...]]:
        """Half a tooth and half a space, from the middle of the tip land to that of the root.

        Parameters
        ----------
        points : int
            Number of intervals.

        Returns
        -------
        points : ndarray, shape (points + 1, 2)
            Tooth on the +x axis of the ring's centre, counter-clockwise side. [m]
        breaks : tuple of int
            Indices at which curvature or tangent jumps.
        """
        form, pitch = self.form, np.pi / self.tooth_count
        corner = float(self.half_angle(self.tip_radius))
        rounding, land = self.space.tip_rounding, pitch - form.tip_half_angle
        rounded = float(rounding > 0.0)

        def flank(u: Array) -> Array:
            base = self.base_radius
            lower, upper = (
                np.sqrt(r**2 - base**2) for r in (self.tip_radius, form.tip_form_radius)
            )
            radius = np.hypot(base, lower + (upper - lower) * u)
            return polar(radius, np.asarray(self.half_angle(radius)))

        def fillet(u: Array) -> Array:
            end = np.array([form.tip_form_radius])
            start = polar(end, np.asarray(self.half_angle(end)))[0]
            center = polar(self.root_radius - rounding, np.array([land]))[0]
            first = float(np.arctan2(*(start - center)[::-1]))
            return np.asarray(center + polar(rounding, first + (land - first) * u), dtype=float)

        segments = [
            CurveSegment(lambda u: polar(self.tip_radius, corner * u), (0.0, 0.0)),
            CurveSegment(flank, (0.0, rounded)),
        ]
        if rounded:
            segments.append(CurveSegment(fillet, (1.0, 0.7)))
        segments.append(
            CurveSegment(
                lambda u: polar(self.root_radius, land + (pitch - land) * u), (0.7 * rounded, 0.0)
            )
        )
        return sample_segments(segments, points)


def ring_outline(ring: RingGear, points: int, rotation: float) -> Array:
    """Teeth of a ring as one closed curve about its centre.

    Counter-clockwise, shape (n, 2). [m]

    Parameters
    ----------
    points : int
        Intervals on one pitch.
    rotation : float
        Angle of a tooth from the x axis. [rad]
    """
    half, _ = ring.half_pitch(points // 2)
    pitch: Array = np.vstack([half[:0:-1] * (1.0, -1.0), half])[:-1]
    turns = rotation + 2.0 * np.pi / ring.tooth_count * np.arange(ring.tooth_count, dtype=float)
    return turned_copies(pitch, turns)


def ring_tooth(ring: RingGear, points: int = 200) -> Tooth:
    """Splines through both flanks of a ring gear, whose count and radii are negative.

    The tooth points to +x: it stands on the -x side of the ring's centre.
    """
    half, breaks = ring.half_pitch(points // 2)
    corner = breaks[0]
    # seen along the tooth, its left side lies clockwise round the centre of the ring
    clockwise = half[: corner - 1 : -1] * (-1.0, 1.0) if corner else half[::-1] * (-1.0, 1.0)
    last = len(half) - 1
    cuts = np.array([last - k for k in breaks], dtype=int)
    left = flank_spline(clockwise, cuts, LEFT, -ring.tip_radius)
    right = flank_spline(clockwise * (1.0, -1.0), cuts, RIGHT, -ring.tip_radius)
    return Tooth(left, right, -ring.tooth_count, -ring.tip_radius)


@final
@dataclass(frozen=True)
class InternalPair(InvolutePair[float]):
    """Pinion in a ring gear."""

    pinion: InvoluteGear
    """Gear on the shaft."""
    ring: RingGear
    """Ring gear."""
    center_distance: float
    """Distance of the centres. [m]"""

    @property
    def speed_ratio(self) -> float:
        """Speed of the ring over that of the pinion. [-]."""
        return self.pinion.tooth_count / self.ring.tooth_count

    @property
    def tip_radii(self) -> tuple[float, float]:
        """Tip circles of pinion and ring. [m]."""
        return self.pinion.tip_radius, self.ring.tip_radius

    @property
    def base_pitch(self) -> float:
        """Distance of consecutive contacts along the line of action. [m]."""
        return self.pinion.base_pitch

    @property
    def base_difference(self) -> float:
        """Radius of the ring's base circle less that of the pinion. [m]."""
        return self.ring.base_radius - self.pinion.base_radius

    @property
    def operating_pressure_angle(self) -> float:
        """Angle of the line of action to the pitch line. [rad]."""
        return float(np.arccos(self.base_difference / self.center_distance))

    @property
    def pitch_radii(self) -> tuple[float, float]:
        """Radii of the operating pitch circles. [m]."""
        pinion = self.center_distance * self.speed_ratio / (1.0 - self.speed_ratio)
        return pinion, pinion + self.center_distance

    @property
    def normal_backlash(self) -> float:
        """Play between the flanks out of contact, along their normal. [m]."""
        tight = _tight_involute(self.pinion, self.ring)
        operating = involute_function(self.operating_pressure_angle)
        return float(2.0 * self.base_difference * (tight - operating))

    @property
    def roll_offset(self) -> float:
        """Distance of the tangent points on both base circles along the line of action. [m]."""
        return float(self.center_distance * np.sin(self.operating_pressure_angle))

    @property
    def contact_rolls(self) -> tuple[float, float]:
        """Roll lengths of the pinion's flank at which contact ends, at ring tip and own tip. [m].

        A fillet that reaches into the involute shortens the path.
        """
        ring_tip, fillet, own_tip, ring_fillet = self._rolls
        return max(ring_tip, fillet), min(own_tip, ring_fillet)

    @cached_property
    def pinion_form(self) -> ToothForm:
        """Junctions of the pinion's tooth."""
        return tooth_form(self.pinion)

    @property
    def _rolls(self) -> tuple[float, float, float, float]:
        """Roll lengths of the pinion's flank at ring tip, own fillet, own tip, ring's fillet."""
        pinion, space = self.pinion, self.ring.space
        return (
            space.roll_length(self.ring.tip_radius) - self.roll_offset,
            pinion.roll_length(self.pinion_form.form_radius),
            pinion.roll_length(self.pinion_form.tip_form_radius),
            space.roll_length(self.ring.form.tip_form_radius) - self.roll_offset,
        )

    @property
    def path_of_contact(self) -> tuple[float, float]:
        """Both ends of contact from the pitch point, positive towards the pinion's tip. [m]."""
        start, end = self.contact_rolls
        pitch = self.pitch_radii[0] * float(np.sin(self.operating_pressure_angle))
        return start - pitch, end - pitch

    @property
    def involute_margins(self) -> tuple[float, float]:
        """Roll length between fillet and deepest contact, on pinion and ring. [m].

        Negative where the mating tip would run on the fillet.
        """
        ring_tip, fillet, own_tip, ring_fillet = self._rolls
        return ring_tip - fillet, ring_fillet - own_tip


def _tight_involute(pinion: InvoluteGear, ring: RingGear) -> float:
    """Involute function of the pressure angle without backlash. [-]."""
    shifts = ring.space.profile_shift - pinion.profile_shift
    counts = ring.tooth_count - pinion.tooth_count
    tangent = np.tan(pinion.pressure_angle)
    return float(involute_function(pinion.pressure_angle) + 2.0 * tangent * shifts / counts)


def pair_from_backlash(
    pinion: InvoluteGear, ring: RingGear, normal_backlash: float
) -> InternalPair:
    r"""Pinion in a ring at the centre distance that leaves a given normal backlash.

    Raises GeometryError if no operating pressure angle exists.

    Parameters
    ----------
    pinion : InvoluteGear
        Gear on the shaft.
    ring : RingGear
        Ring gear of equal module and pressure angle, with more teeth.
    normal_backlash : float
        Play between the flanks out of contact, along their normal, not negative. [m]

    Notes
    -----
    .. math:: j_n = 2 (r_{b2} - r_{b1}) \left(\mathrm{inv}\,\alpha
              + 2 \tan\alpha \frac{x_2 - x_1}{z_2 - z_1} - \mathrm{inv}\,\alpha_w\right)

    References
    ----------
    .. [1] ISO 21771:2007, Gears: cylindrical involute gears and gear pairs, section 5, with
       negative tooth count and profile shift of the ring.
    """
    difference = ring.base_radius - pinion.base_radius
    if difference <= 0.0:
        raise GeometryError(
            "ring.tooth_count",
            ring.tooth_count,
            f"more than the {pinion.tooth_count} teeth of the pinion",
        )
    target = _tight_involute(pinion, ring) - 0.5 * normal_backlash / difference
    if target <= 0.0:
        raise GeometryError(
            "ring.profile_shift",
            f"{ring.space.profile_shift:g} with a pinion shift of {pinion.profile_shift:g} and a "
            f"normal backlash of {normal_backlash * 1e3:.4g} mm",
            "a larger one (no operating pressure angle exists)",
        )
    angle = root_between(lambda a: float(involute_function(a)) - target, 1e-9, 1.4, 1e-15)
    return InternalPair(pinion, ring, float(difference / np.cos(angle)))


_LAND = 2e-4
"""Height above the tip circle, over its radius, up to which points count to the tip land. [-]"""


@final
@dataclass(frozen=True)
class RingProfile:
    """Teeth of a ring gear from a curve."""

    spaces: GearProfile
    """The curve as a gear whose teeth are the ring's spaces."""

    @property
    def tip_radius(self) -> float:
        """Circle inside the teeth. [m]."""
        return self.spaces.root_radius

    @property
    def root_radius(self) -> float:
        """Circle at the bottom of the spaces. [m]."""
        return self.spaces.tip_radius

    @property
    def flank(self) -> Array:
        """Counter-clockwise flank of a tooth on the +x axis, from root middle to tip corner. [m].

        The curve is that of the clockwise half of the space ahead.
        """
        middle = (self.spaces.tip_start + self.spaces.tip_end) // 2
        half = self.spaces.points[: middle + 1][::-1]
        radius = np.hypot(*half.T)
        last = int(np.argmax(radius < self.tip_radius * (1.0 + _LAND)))
        turn = np.pi / self.spaces.tooth_count - np.arctan2(half[0, 1], half[0, 0])
        corner = turned(half[: last + 1], turn)
        corner[-1] *= self.tip_radius / np.hypot(*corner[-1])
        return np.asarray(corner, dtype=float)


def profile_tooth(ring: RingProfile) -> Tooth:
    """Splines through both flanks of a ring gear, whose count and radii are negative."""
    breaks = np.zeros(0, dtype=int)
    left = flank_spline(ring.flank * (-1.0, 1.0), breaks, LEFT, -ring.tip_radius)
    right = flank_spline(ring.flank * (-1.0, -1.0), breaks, RIGHT, -ring.tip_radius)
    return Tooth(left, right, -ring.spaces.tooth_count, -ring.tip_radius)


def profile_outline(ring: RingProfile, rotation: float) -> Array:
    """Teeth as one closed curve about the ring's centre, a tooth at an angle from x [rad]. [m]."""
    return ring.spaces.closed_polygon(rotation + np.pi / ring.spaces.tooth_count)
