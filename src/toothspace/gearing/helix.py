r"""Helical gears: what a transverse section does, over all sections along the face width.

Along the axis a section leads or lags by the shaft angle :math:`\kappa z`, with the turn of the
drive gear's teeth per length :math:`\kappa = \tan\beta / r`. A tooth space that follows the
helix is one chamber with one pressure, so that its volume, its openings and its gaps are means of
those of the sections over the twist :math:`\varphi = b\,|\kappa|` of the whole width.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np

from toothspace.core.keys import choice, forbid, integer, quantity
from toothspace.core.types import Array
from toothspace.gearing.gear_tables import MeshingGearParameters
from toothspace.gearing.numbering import FULL_TURN
from toothspace.gearing.space_paths import FACES
from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.involute import InvoluteGear
from toothspace.model.description import (
    ChamberFamily,
    ContactPair,
    FlowPath,
    MachineDescription,
    Winding,
)
from toothspace.numerics.periodic_table import PeriodicTable, monotone_table

_SECTIONS = 33
"""Transverse sections of a gap, whose flow grows faster than its height."""
_SLICES_PER_PITCH = 8
"""Slices of a contact line on one pitch of overlap: the load moves in steps of an eighth of it."""
_CURVED_GAP = 2.5
"""Power of the height that the flow through a gap between curved walls grows with. [-]"""


ALIKE = "with a helix_angle (teeth are then all alike)"
"""Reason why deviations of single teeth are refused."""


def halfway_up(profile: GearProfile) -> float:
    """Radius halfway between root and tip of a profile, on which files tell the helix. [m]."""
    return 0.5 * (profile.root_radius + profile.tip_radius)


def base_helix_angle(angle: Any, pressure_angle: Any) -> Any:
    """Helix angle at the base circle, tan(beta_b) = tan(beta) cos(alpha_t). [rad].

    Parameters
    ----------
    angle, pressure_angle : float or ndarray
        Helix angle at the reference circle, and transverse pressure angle. [rad]
    """
    return np.arctan(np.tan(angle) * np.cos(pressure_angle))


@final
@dataclass(frozen=True)
class Helix:
    """Teeth that wind about the axes of a pair of gears."""

    angle: float
    """Helix angle at the reference circle, positive where the drive gear is right-handed. [rad]"""
    tooth_count: int
    reference_radius: float
    pressure_angle: float
    """Of the drive gear in the transverse section: circle of the helix angle, and the pressure
    angle there, 0 where flanks have none. [m], [rad]
    """
    face_width: float
    """Width of both gears. [m]"""
    flanks_in_turn: bool = False
    """Whether the loaded flanks of a section touch for a part of a pitch only, so that slices share
    the load among those that do.
    """

    @property
    def turn_per_length(self) -> float:
        """Turn of the drive gear's teeth along its axis, positive right-handed. [rad/m]."""
        return math.tan(self.angle) / self.reference_radius

    @property
    def twist(self) -> float:
        """Shaft angle between both ends of a tooth. [rad]."""
        return abs(self.turn_per_length) * self.face_width

    @property
    def leads(self) -> tuple[float, float]:
        """Shaft angles by which the ends of the gears lead their middle, far side first. [rad]."""
        half = 0.5 * self.turn_per_length * self.face_width
        return half, -half

    @property
    def overlap_ratio(self) -> float:
        """Twist over the pitch angle: contact ratio along the face width. [-]."""
        return self.twist * self.tooth_count / FULL_TURN

    @property
    def base_angle(self) -> float:
        """Helix angle at the base circle. [rad]."""
        return float(base_helix_angle(abs(self.angle), self.pressure_angle))

    def numbers(self, contact_ratio: float) -> dict[str, object]:
        """Numbers of the geometry report, from the contact ratio of the transverse section [-]."""
        return {
            "helix_angle_deg": float(np.rad2deg(self.angle)),
            "face_twist_deg": float(np.rad2deg(self.twist)),
            "overlap_ratio": self.overlap_ratio,
            "total_contact_ratio": contact_ratio + self.overlap_ratio,
        }

    def wound(
        self,
        machine: MachineDescription,
        along: Callable[[FlowPath], tuple[FlowPath, ...]],
        slices: int = 1,
        **section: Any,
    ) -> MachineDescription:
        """Machine along the teeth that knows the one whose parts are those of its middle section.

        Parameters
        ----------
        along : callable
            What a path of the section becomes along the teeth.
        slices : int
            Parts of the width in each of which a tooth space is a chamber of its own.
        **section : object
            Fields of the description in which the machine of the section differs.
        """
        spur = replace(machine, **section)
        winding = Winding(self.turn_per_length, self.twist, spur, along, slices)
        return replace(machine, winding=winding)

    def family(self, family: ChamberFamily) -> ChamberFamily:
        """Chambers along the helix: means of volumes and of what micro-motions displace."""
        width = self.twist * family.angle_ratio
        return replace(
            family,
            volume=family.volume.moving_mean(width),
            volume_by_motion=family.volume_by_motion.moving_mean(width),
        )

    def path(self, path: FlowPath) -> FlowPath:
        """Flow path along the helix: in both end faces, or over the whole width.

        Openings in a face see the section of that face; openings at the tip circle are sums over
        the width. A gap is as high as one that leaks as much.
        """
        table = path.geometry
        if path.end:
            lead = 0.5 * path.end * self.twist * path.angle_ratio
            return replace(path, phases=path.phases + lead)
        if path.kind == "orifice":
            in_faces = path.multiplicity == FACES
            found = self._over(table, self._leads(path, FACES if in_faces else _SECTIONS))
            open_area = np.maximum(found[..., 0], 0.0)
            if in_faces:
                area = open_area.mean(axis=0)
            else:
                area = table.moving_mean(self.twist * path.angle_ratio).values[:, 0]
            total = open_area.sum(axis=0)
            weighted = (open_area * found[..., 1]).sum(axis=0)
            diameter = np.where(total > 0.0, weighted / np.where(total > 0.0, total, 1.0), 0.0)
            return replace(
                path,
                geometry=monotone_table(
                    table.period, np.column_stack([np.maximum(area, 0.0), diameter])
                ),
            )
        if path.height_by_motion is None and np.all(table.values == table.values[0]):
            return path  # lands that are alike at every place
        sections = FACES if path.multiplicity == FACES else _SECTIONS
        return self._gap(path, 3.0 if path.kind == "parallel_gap" else _CURVED_GAP, sections)

    def contact(self, contact: ContactPair) -> ContactPair:
        r"""Contacts of slices along the width, each at the place of its section.

        Notes
        -----
        The force F of a contact is that in the transverse section. The flanks part along their
        normal by :math:`\cos\beta_b` of the gap there, over a line that is longer by
        :math:`1/\cos\beta_b`, and their radii grow by that, too.
        """
        count = max(math.ceil(_SLICES_PER_PITCH * self.overlap_ratio), 2)
        middles = (np.arange(count) + 0.5) / count - 0.5
        leads = self.twist * contact.angle_ratio * middles
        slope = math.cos(self.base_angle)
        scale = np.array([1.0, 1.0 / count, 1.0 / slope, 1.0 / slope, 1.0, 1.0])
        table = contact.geometry
        own = self._shared(table, leads, contact.phases) if self.flanks_in_turn else ()
        return replace(
            contact,
            phases=(contact.phases[None, :] + leads[:, None]).ravel(),
            geometry=PeriodicTable(table.period, table.values * scale, table.slopes * scale),
            own=tuple(PeriodicTable(t.period, t.values * scale, t.slopes * scale) for t in own),
            width=contact.width * slope / count,
            part=1.0 / count,
            structure_stiffness=contact.structure_stiffness * slope / count,
        )

    def ripple(self, flow: Array) -> float:
        """Largest less smallest ideal flow over its mean, from that of a section over a pitch. [-].

        Parameters
        ----------
        flow : ndarray
            Ideal flow of spur gears at even angles of one pitch. [m3/rad]
        """
        pitch = FULL_TURN / self.tooth_count
        mean = monotone_table(pitch, flow).moving_mean(self.twist).values
        return float((mean.max() - mean.min()) / mean.mean())

    def _leads(self, path: FlowPath, sections: int) -> Array:
        """Table angles of sections relative to that of the middle. [rad]."""
        half = 0.5 * self.twist * path.angle_ratio
        return np.linspace(-half, half, sections)

    def _gap(self, path: FlowPath, power: float, sections: int) -> FlowPath:
        leads, table = self._leads(path, sections), path.geometry
        found = self._over(table, leads)
        height, wide = np.maximum(found[..., 0], 0.0), np.maximum(found[..., 1], 0.0)
        # trapezoidal rule over the width
        share = np.full((sections, 1), 1.0 / (sections - 1))
        share[[0, -1]] *= 0.5
        width = (share * wide).sum(axis=0)
        safe = np.where(width > 0.0, width, 1.0)

        def mean(weight: Array, value: Array) -> Array:
            total = (share * weight).sum(axis=0)
            extra = (1,) * (value.ndim - 2)
            part = (share * weight).reshape(*weight.shape, *extra) * value
            some = np.where(total > 0.0, total, 1.0).reshape(-1, *extra)
            middle = value[sections // 2]
            return np.where(total.reshape(-1, *extra) > 0.0, part.sum(axis=0) / some, middle)

        length = mean(wide, found[..., 2])
        if path.kind == "parallel_gap":
            # as long as a gap of that height and width that leaks as much
            leaks = share * wide * height**power
            long = np.where(found[..., 2] > 0.0, found[..., 2], 1.0)
            conducts, whole = (leaks / long).sum(axis=0), leaks.sum(axis=0)
            safe_conducts = np.where(conducts > 0.0, conducts, 1.0)
            length = np.where(conducts > 0.0, whole / safe_conducts, length)
        leaking = (share * wide * height**power).sum(axis=0) / safe
        high = np.where(width > 0.0, leaking ** (1.0 / power), height[sections // 2])
        geometry = np.column_stack([high, width, length])
        drag = path.drag_speed
        if drag is not None:
            speeds = self._over(drag, leads)[..., 0]
            carried = (share * wide * height * speeds).sum(axis=0)
            swept = width * high
            even = np.where(swept > 0.0, carried / np.where(swept > 0.0, swept, 1.0), 0.0)
            drag = monotone_table(table.period, even)
        motion = path.height_by_motion
        if motion is not None:
            motion = monotone_table(motion.period, mean(wide, self._over(motion, leads)))
        return replace(
            path,
            geometry=monotone_table(table.period, geometry),
            height_by_motion=motion,
            drag_speed=drag,
        )

    @staticmethod
    def _shared(table: PeriodicTable, leads: Array, phases: Array) -> tuple[PeriodicTable, ...]:
        """Geometry of every contact, with the load of all slices on those that touch.

        Parameters
        ----------
        leads : ndarray
            Places of the slices relative to the middle. [rad]
        phases : ndarray
            Places of the tooth spaces at shaft angle zero. [rad]
        """
        nodes = table.period * np.arange(table.values.shape[0]) / table.values.shape[0]
        places = (leads[:, None] + phases[None, :]).ravel()
        touching = table(nodes[:, None] + places[None, :])[..., 1].sum(axis=1)
        total = monotone_table(table.period, touching)
        found = []
        for lead in leads:
            all_slices = total(nodes - lead - phases[0])[:, 0]
            touch = all_slices > 0.0
            part = leads.size * table.values[:, 1] / np.where(touch, all_slices, 1.0)
            shares = monotone_table(table.period, np.where(touch, part, 0.0))
            values, slopes = table.values.copy(), table.slopes.copy()
            values[:, 1], slopes[:, 1] = shares.values[:, 0], shares.slopes[:, 0]
            found += [PeriodicTable(table.period, values, slopes)] * phases.size
        return tuple(found)

    @staticmethod
    def _over(table: PeriodicTable, leads: Array) -> Array:
        """Values at the nodes of a table in sections. Shape (sections, nodes, channels)."""
        nodes = table.period * np.arange(table.values.shape[0]) / table.values.shape[0]
        return table(nodes[None, :] + leads[:, None])


@dataclass(frozen=True, kw_only=True)
class HelicalGearParameters(MeshingGearParameters):
    """Keys of meshing gears whose teeth may wind about their axes."""

    helix_angle: float = quantity(
        "deg",
        "Helix angle at the reference circle, 0 for spur gears; module, pressure angle, shifts, "
        "dedendum, tool tip and backlash are then those of the normal section. Of a profile from a "
        "file, which is the transverse section, on the circle halfway up the teeth.",
        low=0,
        high=45,
        default=0.0,
    )
    helix_hand: str | None = choice(
        "Hand of the drive gear's teeth, default right; a gear beside it has the other one, a ring "
        "gear round it the same.",
        "right",
        "left",
        default=None,
    )
    axial_slices: int | None = integer(
        "Slices of the face width, in each of which a tooth space has a pressure of its own; "
        "default one for the whole width.",
        low=2,
        high=16,
        default=None,
    )

    def __post_init__(self) -> None:
        if self.helix_angle == 0.0:
            forbid(self, "with spur gears", "helix_hand", "axial_slices")
        super().__post_init__()

    @property
    def slope(self) -> float:
        """Cosine of the helix angle. [-]."""
        return math.cos(self.helix_angle)

    @property
    def transverse_pressure_angle(self) -> float:
        """Pressure angle in the section across the axis, of generated teeth. [rad]."""
        return math.atan(math.tan(self.pressure_angle or 0.0) / self.slope)

    @property
    def transverse_backlash(self) -> float:
        """Play of the flanks along the line of action of the transverse section. [m]."""
        base = base_helix_angle(self.helix_angle, self.transverse_pressure_angle)
        return (self.normal_backlash or 0.0) / math.cos(base)

    def involute_gear(self, table: str) -> InvoluteGear:
        r"""Return the generated gear in the transverse section.

        Raises GeometryError if the tooth is impossible, with the key in the given table.

        Notes
        -----
        .. math:: m_t = \frac{m_n}{\cos\beta}, \quad
            \tan\alpha_t = \frac{\tan\alpha_n}{\cos\beta}, \quad x_t = x_n \cos\beta

        Lengths in modules change alike, so that they stay the same in mm.

        References
        ----------
        .. [1] ISO 21771:2007, Gears: cylindrical involute gears and gear pairs, section 4.
        """
        if self.helix_angle == 0.0:
            return super().involute_gear(table)
        assert self.module is not None
        radius = self.tool_tip_radius
        return replace(
            self,
            helix_angle=0.0,
            helix_hand=None,
            axial_slices=None,
            module=self.module / self.slope,
            pressure_angle=self.transverse_pressure_angle,
            profile_shift=self.profile_shift * self.slope,
            dedendum=self.dedendum * self.slope,
            tool_tip_radius=None if radius is None else radius * self.slope,
        ).involute_gear(table)

    def helix(
        self, face_width: float, profile: GearProfile | None = None, *, flanks_in_turn: bool = False
    ) -> Helix | None:
        """How the teeth wind about the axes over a width [m]; None for spur gears.

        Parameters
        ----------
        profile : GearProfile, optional
            Transverse section from a file, None of generated teeth.
        """
        if self.helix_angle == 0.0:
            return None
        if profile is None:
            assert self.tooth_count is not None
            assert self.module is not None
            count, pressure_angle = self.tooth_count, self.transverse_pressure_angle
            radius = 0.5 * count * self.module / self.slope
        else:
            count, base = profile.tooth_count, profile.base_radius or 0.0
            radius = halfway_up(profile)
            pressure_angle = math.acos(base / radius) if 0.0 < base < radius else 0.0
        return Helix(
            angle=-self.helix_angle if self.helix_hand == "left" else self.helix_angle,
            tooth_count=count,
            reference_radius=radius,
            pressure_angle=pressure_angle,
            face_width=face_width,
            flanks_in_turn=flanks_in_turn,
        )
