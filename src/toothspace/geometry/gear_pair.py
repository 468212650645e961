"""Two involute gears in mesh: backlash, path of contact, ideal displacement and ripple.

Frame: origin at the drive gear's centre, y towards the driven gear, x towards the outlet. The
drive gear turns counter-clockwise. In a pump its leading flank pushes the driven gear; in a motor
the driven gear's leading flank pushes the drive gear.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Generic, Literal, cast, final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.types import FloatOrArray
from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.involute import InvoluteGear, ToothForm, tooth_form
from toothspace.geometry.involute_gear import (
    InvoluteGears,
    RackCutTeeth,
    Real,
    involute_function,
    plain,
)
from toothspace.numerics.roots import root_between

Sealing = Literal["single", "dual"]
LARGEST_OVERLAP = 1e-6


class InvolutePair(ABC, Generic[Real]):
    """What external and internal pairs of involute gears have in common.

    Lengths along the line of action count from the pitch point. Numbers are those of one pair,
    or arrays over many.
    """

    @property
    @abstractmethod
    def speed_ratio(self) -> Real:
        """Speed of the driven gear over that of the drive gear, negative of external pairs. [-]."""

    @property
    @abstractmethod
    def tip_radii(self) -> tuple[Real, Real]:
        """Tip circles of drive and driven gear. [m]."""

    @property
    @abstractmethod
    def pitch_radii(self) -> tuple[Real, Real]:
        """Operating pitch radii of drive and driven gear. [m]."""

    @property
    @abstractmethod
    def operating_pressure_angle(self) -> Real:
        """Angle of the line of action to the common tangent of the pitch circles. [rad]."""

    @property
    @abstractmethod
    def base_pitch(self) -> Real:
        """Distance of consecutive contacts along the line of action. [m]."""

    @property
    @abstractmethod
    def path_of_contact(self) -> tuple[Real, Real]:
        """Positions at which a tooth pair begins and ends contact. [m]."""

    @property
    def contact_ratio(self) -> Real:
        """Mean number of tooth pairs in contact. [-]."""
        start, end = self.path_of_contact
        return (end - start) / self.base_pitch

    def sealing_window(self, flank_sealing: Sealing = "single") -> tuple[Real, Real]:
        """Positions of the sealing contact over one pitch, as near the pitch point as can be.

        Window: with two pairs in contact the one nearer to the pitch point gives more flow. About
        the middle of a path that is shorter than the window. [m]

        Parameters
        ----------
        flank_sealing : str
            ``single``: one flank seals and the contact that seals moves over one base pitch;
            ``dual``: both flanks seal, it moves over half a base pitch.
        """
        start, end = self.path_of_contact
        span = self.base_pitch * (1.0 if flank_sealing == "single" else 0.5)
        room = 0.5 * np.maximum(end - start - span, 0.0)
        middle = 0.5 * (start + end - span)
        first: Real = np.clip(-0.5 * span, middle - room, middle + room)
        return first, first + span

    def flow_per_radian(self, face_width: FloatOrArray, position: FloatOrArray) -> FloatOrArray:
        r"""Volume delivered per radian of the shaft while the sealing contact is at a position.

        Flow rate over shaft speed. [m3/rad]

        Parameters
        ----------
        face_width : float
            Tooth length. [m]
        position : float or ndarray
            Distance of the sealing contact from the pitch point. [m]

        Notes
        -----
        .. math:: \frac{Q}{\omega} = \frac{b}{2}\left[r_{a1}^2 - r_{w1}^2
                  - i (r_{a2}^2 - r_{w2}^2) - (1 - i) u^2\right]

        with the speed ratio :math:`i = \mp z_1/z_2` of an external or internal pair. Validity:
        rigid fluid, no leakage.

        References
        ----------
        .. [1] Manring, Kasaragadda, The theoretical flow ripple of an external gear pump, J. Dyn.
           Sys. Meas. Control 125 (2003) 396-404, doi:10.1115/1.1592193.
        .. [2] J. R. Colbourne, Gear shape and theoretical flow rate in internal gear pumps,
           Trans. Can. Soc. Mech. Eng. 3 (1975) 215-223.
        """
        (tip_1, tip_2), (pitch_1, pitch_2) = self.tip_radii, self.pitch_radii
        swept = tip_1**2 - pitch_1**2 - self.speed_ratio * (tip_2**2 - pitch_2**2)
        return 0.5 * face_width * (swept - (1.0 - self.speed_ratio) * np.asarray(position) ** 2)

    def displacement_per_radian(
        self, face_width: FloatOrArray, flank_sealing: Sealing = "single"
    ) -> Real:
        """Geometric displacement per radian of the shaft.

        Mean of :meth:`flow_per_radian` over the window. [m3/rad]

        Parameters
        ----------
        face_width : float
            Tooth length. [m]
        flank_sealing : str
            ``single`` or ``dual``, as in :meth:`sealing_window`.
        """
        first, last = self.sealing_window(flank_sealing)
        mean_square = (first**2 + first * last + last**2) / 3.0
        return cast("Real", self.flow_per_radian(face_width, np.sqrt(mean_square)))

    def flow_ripple(self, flank_sealing: Sealing = "single") -> Real:
        """Largest less smallest ideal flow over its mean, ``single`` or ``dual`` sealing. [-]."""
        first, last = self.sealing_window(flank_sealing)
        largest = np.maximum(np.abs(first), np.abs(last))
        least = np.maximum(np.maximum(first, -last), 0.0)
        swing = 0.5 * (1.0 - self.speed_ratio) * (largest**2 - least**2)
        ripple: Real = (swing / self.displacement_per_radian(1.0, flank_sealing))[()]
        return ripple


class ExternalPair(InvolutePair[Real]):
    """Two external gears at their operating centre distance, or many such pairs."""

    drive: RackCutTeeth[Real]
    driven: RackCutTeeth[Real]
    center_distance: Real

    @property
    @abstractmethod
    def forms(self) -> tuple[Any, Any]:
        """Ends of the involutes of drive and driven gear, as of :class:`ToothForm`."""

    @property
    def speed_ratio(self) -> Real:
        """Speed of the driven gear over that of the drive gear, negative. [-]."""
        return -self.drive.tooth_count / self.driven.tooth_count

    @cached_property
    def pitch_radii(self) -> tuple[Real, Real]:
        """Operating pitch radii of drive and driven gear. [m]."""
        share = self.drive.tooth_count / (self.drive.tooth_count + self.driven.tooth_count)
        return self.center_distance * share, self.center_distance * (1.0 - share)

    @cached_property
    def operating_pressure_angle(self) -> Real:
        """Angle of the line of action to the common tangent of the pitch circles. [rad]."""
        bases = self.drive.base_radius + self.driven.base_radius
        return plain(np.arccos(bases / self.center_distance))

    @property
    def base_pitch(self) -> Real:
        """Distance of consecutive contacts along the line of action. [m]."""
        return self.drive.base_pitch

    @cached_property
    def normal_backlash(self) -> Real:
        """Play between the flanks out of contact, along their normal. [m]."""
        total = self.drive.base_radius + self.driven.base_radius
        excess = involute_function(self.operating_pressure_angle)
        return 2.0 * total * (excess - tight_involute(self.drive, self.driven))

    @cached_property
    def pitch_roll_lengths(self) -> tuple[Real, Real]:
        """Distance of the pitch point from the tangent point on each base circle. [m]."""
        sine = plain(np.sin(self.operating_pressure_angle))
        return self.pitch_radii[0] * sine, self.pitch_radii[1] * sine

    @cached_property
    def path_of_contact(self) -> tuple[Real, Real]:
        """Positions at which a tooth pair of a pump begins and ends contact. [m].

        Measured from the pitch point along the motion of the contact: negative on the closing
        side, where the driven tip limits, positive on the opening side, where the drive tip does.
        Fillets that end the involute early (undercut) shorten the path.
        """
        (form_1, form_2), (roll_1, roll_2) = self.forms, self.pitch_roll_lengths
        start = roll_2 - self.driven.roll_length(form_2.tip_form_radius)
        end = self.drive.roll_length(form_1.tip_form_radius) - roll_1
        low = self.drive.roll_length(form_1.form_radius) - roll_1
        high = roll_2 - self.driven.roll_length(form_2.form_radius)
        first: Any = np.where(form_1.undercut, low, -np.inf)
        last: Any = np.where(form_2.undercut, high, np.inf)
        return plain(np.maximum(start, first)), plain(np.minimum(end, last))

    @property
    def root_clearances(self) -> tuple[Real, Real]:
        """Radial play of the mating tip in the roots of drive and driven gear. [m]."""
        tip_1, tip_2 = self.tip_radii
        return (
            self.center_distance - self.drive.root_radius - tip_2,
            self.center_distance - self.driven.root_radius - tip_1,
        )

    @cached_property
    def involute_margins(self) -> tuple[Real, Real]:
        """Roll length between fillet and the deepest contact on drive and driven gear. [m].

        Negative where the mating tip reaches below the involute: fillet interference, or for an
        undercut gear merely a shorter path.
        """
        (form_1, form_2), (roll_1, roll_2) = self.forms, self.pitch_roll_lengths
        deepest_1 = roll_1 + roll_2 - self.driven.roll_length(form_2.tip_form_radius)
        deepest_2 = roll_1 + roll_2 - self.drive.roll_length(form_1.tip_form_radius)
        return (
            deepest_1 - self.drive.roll_length(form_1.form_radius),
            deepest_2 - self.driven.roll_length(form_2.form_radius),
        )


def tight_involute(drive: RackCutTeeth[Real], driven: RackCutTeeth[Real]) -> Real:
    """Involute function of the operating pressure angle of a pair without backlash. [-]."""
    mean = drive.tooth_count * drive.base_half_angle + driven.tooth_count * driven.base_half_angle
    return (mean - np.pi) / (drive.tooth_count + driven.tooth_count)


@final
@dataclass(frozen=True)
class GearPair(ExternalPair[float]):
    """Two gears at their operating centre distance; build it with one of the functions below."""

    drive: InvoluteGear
    driven: InvoluteGear
    """Gears of equal base pitch."""
    center_distance: float
    """Distance of the gear centres. [m]"""

    @cached_property
    def forms(self) -> tuple[ToothForm, ToothForm]:
        """Tooth forms of drive and driven gear."""
        return tooth_form(self.drive), tooth_form(self.driven)

    @property
    def tip_radii(self) -> tuple[float, float]:
        """Tip circles of drive and driven gear. [m]."""
        return self.drive.tip_radius, self.driven.tip_radius

    @property
    def relief_groove_spacing(self) -> float:
        """Distance of the two groove edges at which a single-flank trap is never closed [m]."""
        return float(self.base_pitch * np.cos(self.operating_pressure_angle))


def pair_from_backlash(
    drive: InvoluteGear, driven: InvoluteGear, normal_backlash: float
) -> GearPair:
    r"""Gears at the centre distance that leaves a given normal backlash.

    Raises GeometryError for unequal base pitches, backlash outside 0 to half a module, or no
    solution.

    Parameters
    ----------
    drive, driven : InvoluteGear
        Gears of equal base pitch.
    normal_backlash : float
        Play between the flanks out of contact, along their normal, not negative. [m]

    Notes
    -----
    .. math:: j_n = 2 (r_{b1} + r_{b2}) \left(\mathrm{inv}\,\alpha_w - \mathrm{inv}\,\alpha
              - 2 \tan\alpha \frac{x_1 + x_2}{z_1 + z_2}\right)

    References
    ----------
    .. [1] ISO 21771:2007, Gears: cylindrical involute gears and gear pairs, section 5.
    """
    _check_base_pitch(drive, driven)
    if not 0.0 <= normal_backlash <= 0.5 * drive.module:
        raise GeometryError(
            "normal_backlash",
            f"{normal_backlash * 1e3:.4g} mm",
            f"0 to {0.5 * drive.module * 1e3:.4g} mm",
        )
    total = drive.base_radius + driven.base_radius
    target = tight_involute(drive, driven) + 0.5 * normal_backlash / total
    if target <= 0.0:
        raise GeometryError(
            "profile_shift",
            f"a sum of {drive.profile_shift + driven.profile_shift:g}",
            "larger (no operating pressure angle exists)",
        )
    angle = root_between(lambda a: float(involute_function(a)) - target, 1e-9, 1.4, 1e-15)
    return _checked(GearPair(drive, driven, float(total / np.cos(angle))))


def pair_from_center_distance(
    drive: InvoluteGear, driven: InvoluteGear, center_distance: float
) -> GearPair:
    """Gears at a given centre distance; the backlash follows.

    Raises GeometryError for unequal base pitches, or a distance at which flanks or roots interfere
    or the teeth do not mesh.

    Parameters
    ----------
    drive, driven : InvoluteGear
        Gears of equal base pitch.
    center_distance : float
        Distance of the gear centres. [m]
    """
    _check_base_pitch(drive, driven)
    tight = pair_from_backlash(drive, driven, 0.0).center_distance
    longest = drive.tip_radius + driven.tip_radius
    if not tight - LARGEST_OVERLAP <= center_distance < longest:
        raise GeometryError(
            "center_distance",
            f"{center_distance * 1e3:.5g} mm",
            f"{tight * 1e3:.6g} mm (no backlash) to {longest * 1e3:.6g} mm (tips no longer meet)",
        )
    return _checked(GearPair(drive, driven, max(center_distance, tight)))


def trapped_volume_change(pair: GearPair, face_width: float) -> float:
    r"""Volume by which the sealed mesh chamber shrinks from the second contact to its minimum.

    Volume that relief grooves must pass, 0 for a contact ratio of at most 1. [m3]

    Parameters
    ----------
    face_width : float
        Tooth length. [m]

    Notes
    -----
    With two contacts one base pitch apart, the rate is
    :math:`b (1 + r_{w1}/r_{w2}) p_b s / r_{b1}` per radian, :math:`s` being the distance of their
    midpoint from the pitch point; it is integrated from the first double contact to :math:`s = 0`,
    or to the last one before. Backlash is taken as open (single flank).
    """
    start, end = pair.path_of_contact
    half = 0.5 * pair.base_pitch
    first, last = min(start + half, 0.0), min(end - half, 0.0)
    shrinking = max(first**2 - last**2, 0.0) if end - start > 2.0 * half else 0.0
    ratio = 1.0 - pair.speed_ratio
    return float(0.5 * face_width * ratio * pair.base_pitch * shrinking / pair.drive.base_radius)


def _check_base_pitch(drive: InvoluteGear, driven: InvoluteGear) -> None:
    if abs(drive.base_pitch - driven.base_pitch) > 1e-9 * drive.base_pitch:
        raise GeometryError(
            "driven_gear.module, driven_gear.pressure_angle",
            f"a base pitch of {driven.base_pitch * 1e3:.5g} mm",
            f"{drive.base_pitch * 1e3:.5g} mm (the drive gear's)",
        )


def _checked(pair: GearPair) -> GearPair:
    for owner, clearance in zip(("drive", "driven"), pair.root_clearances, strict=True):
        if clearance <= 0.0:
            raise GeometryError(
                "center_distance",
                f"{pair.center_distance * 1e3:.5g} mm: the mating tip reaches "
                f"{-clearance * 1e3:.4g} mm into the {owner} gear's root",
                "a positive root clearance",
            )
    if pair.contact_ratio <= 0.0:
        raise GeometryError(
            "tip_diameter", f"a contact ratio of {pair.contact_ratio:.3f}", "above 0"
        )
    if min(pair.involute_margins) < 0.0:
        # a tip below the involute may still clear the fillet
        drive, driven = InvoluteGears.of(pair.drive), InvoluteGears.of(pair.driven)
        distance = np.array([pair.center_distance])
        play = np.minimum(
            drive.fillet_play(driven, distance), driven.fillet_play(drive, distance)
        ).item()
        if play < -LARGEST_OVERLAP:
            tips = f"{pair.drive.tip_radius * 2e3:.5g} and {pair.driven.tip_radius * 2e3:.5g} mm"
            raise GeometryError(
                "tip_diameter",
                f"{tips}: the teeth interfere by {-play * 1e3:.4g} mm at a root fillet",
                "smaller tips or a larger profile_shift",
            )
    return pair


def flank_clearance(
    drive: GearProfile, driven: GearProfile, center_distance: float, phases: int = 161
) -> float:
    """Smallest circumferential play between two profiles that roll with centred backlash.

    Arc length between a tooth and the flanks of the mating space, about half the circumferential
    backlash; negative where the gears overlap. [m]

    Parameters
    ----------
    drive, driven : GearProfile
        Profiles of any origin whose radius rises from root to tip.
    center_distance : float
        Distance of the gear centres. [m]
    phases : int
        Number of positions over the passage of a tooth.
    """
    return min(
        _clearance_in_space(drive, driven, center_distance, phases),
        _clearance_in_space(driven, drive, center_distance, phases),
    )


def normal_play(profiles: tuple[GearProfile, GearProfile], distance: float) -> float:
    r"""Normal backlash of two profiles, negative where they overlap.

    Play along the common normal. [m]

    Parameters
    ----------
    profiles : tuple of GearProfile
        Drive and driven gear.
    distance : float
        Distance of the centres. [m]

    Notes
    -----
    Of involutes with half angles :math:`\vartheta_b` on the base circles,
    :math:`j_n = 2 (r_{b1} + r_{b2}) (\mathrm{inv}\,\alpha_w - (z_1 \vartheta_{b1} +
    z_2 \vartheta_{b2} - \pi)/(z_1 + z_2))`; below the sum of the base radii and for other flanks
    twice the arc between a tooth and the space around it.
    """
    flanks = [profile.involute for profile in profiles]
    if flanks[0] is None or flanks[1] is None:
        return 2.0 * flank_clearance(*profiles, distance)
    bases = flanks[0].base_radius + flanks[1].base_radius
    if distance <= bases:
        return 2.0 * flank_clearance(*profiles, distance)
    counts = [profile.tooth_count for profile in profiles]
    tight = counts[0] * flanks[0].base_half_angle + counts[1] * flanks[1].base_half_angle - np.pi
    working = involute_function(np.arccos(bases / distance))
    return float(2.0 * bases * (working - tight / sum(counts)))


def _clearance_in_space(
    space: GearProfile, tooth: GearProfile, center_distance: float, phases: int
) -> float:
    reach = 2.5 * max(space.pitch_angle, tooth.pitch_angle * tooth.tooth_count / space.tooth_count)
    turn = np.linspace(-reach, reach, phases)[:, None]
    # the mating tooth points from its centre (0, a) towards the space on the y axis
    local = (tooth.points @ np.array([1.0, 1j]))[None, :]
    mating = local * np.exp(-1j * turn * space.tooth_count / tooth.tooth_count)
    placed = (center_distance - mating) * np.exp(-1j * turn)
    radius, angle = np.abs(placed), np.abs(np.angle(placed))
    flank = space.left_flank[::-1]
    flank_radius = np.maximum.accumulate(np.hypot(flank[:, 0], flank[:, 1]))
    half_space = 0.5 * space.pitch_angle - np.arctan2(flank[:, 1], flank[:, 0])
    limit = np.interp(radius, flank_radius, half_space)
    inside = radius < space.tip_radius
    play = np.where(inside, radius * (limit - angle), np.inf)
    return float(np.min(np.where(angle < 1.5 * space.pitch_angle, play, np.inf)))
