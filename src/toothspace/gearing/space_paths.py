"""Flow paths of chambers in a ring and of the tooth spaces of a gear pair."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np

from toothspace.closures.gap_flow import ring_sector_gap
from toothspace.closures.smooth import smooth_step
from toothspace.core.types import Array, IntArray
from toothspace.gearing import meshing
from toothspace.gearing.mesh_split import Throats
from toothspace.gearing.numbering import FULL_TURN, Numbering
from toothspace.gearing.openings import port_lengths
from toothspace.gearing.spaces import Spaces, area_by_motion, section_areas
from toothspace.model.description import ChamberFamily, FlowPath
from toothspace.model.machine_parts import PathKind
from toothspace.model.path_category import (
    DRAIN,
    INLET_GROOVE,
    INLET_PORT,
    LATERAL,
    OUTLET_GROOVE,
    OUTLET_PORT,
    PathCategory,
)
from toothspace.numerics.periodic_table import monotone_table, smooth_table


@final
@dataclass(frozen=True, kw_only=True)
class ChamberPaths:
    """Chambers round one axis, numbered round it, and the lands between neighbours."""

    nodes: IntArray
    """Nodes of the chambers."""
    behind: IntArray
    ahead: IntArray
    """Nodes behind and ahead of every land in the sense of rotation."""
    angle_ratio: float
    """Growth of the places per shaft angle. [-]"""
    phases: Array
    land_phases: Array
    """Places of chambers and lands at shaft angle zero. [rad]"""

    def over_lands(
        self, name: str, category: PathCategory, geometry: Array, kind: PathKind = "parallel_gap",
        **other: Any,
    ) -> FlowPath:  # fmt: skip
        """Path over the lands, with its channels [SI] over the place, or one row of them.

        ``other`` are further fields of the path.
        """
        return FlowPath(
            name=name,
            category=category,
            kind=kind,
            nodes_a=self.behind,
            nodes_b=self.ahead,
            angle_ratio=self.angle_ratio,
            phases=self.land_phases,
            geometry=monotone_table(FULL_TURN, _over_place(geometry)),
            **other,
        )

    def to_node(
        self, name: str, category: PathCategory, geometry: Array, node: int,
        kind: PathKind = "parallel_gap", multiplicity: float = 1.0,
    ) -> FlowPath:  # fmt: skip
        """Path from every chamber to one node, its channels [SI] over the place, or one row."""
        return FlowPath(
            name=name,
            category=category,
            kind=kind,
            nodes_a=self.nodes,
            nodes_b=np.full_like(self.nodes, node),
            angle_ratio=self.angle_ratio,
            phases=self.phases,
            geometry=monotone_table(FULL_TURN, _over_place(geometry)),
            multiplicity=multiplicity,
        )


def _over_place(geometry: Array) -> Array:
    return np.tile(geometry, (4, 1)) if geometry.ndim == 1 else geometry


FLANK = PathCategory("flank", "flanks", "#56B4E9", "mesh")
FACES = 2
"""Faces of a gear."""

_GROWN_THROAT = 0.05
"""Weight of a throat in the lens with which it is as wide as the face. [-]"""
_PEAKS = 2.0
"""Height of the peaks of a rough flank over their root mean square. [-]"""

_PORTS = {"inlet": INLET_PORT, "outlet": OUTLET_PORT}
_GROOVES = {"inlet": INLET_GROOVE, "outlet": OUTLET_GROOVE}
OPENINGS = {
    "port": (_PORTS, 1.0),
    "recess": (_PORTS, FACES),
    "notch": (_PORTS, 1.0),
    "groove": (_GROOVES, FACES),
}
"""Openings to ports at the tip circle, in both faces and in the wall, and to relief grooves in
both faces: categories by port, and how many of each there are.
"""


def flank_paths(
    gears: meshing.MeshedGears,
    numbering: Numbering,
    spaces: Spaces,
    tip_rounding: float,
    roughness: tuple[float, float],
) -> tuple[FlowPath, FlowPath]:
    """Throats of the drive spaces: ahead to the last driven space, behind to the next one.

    Parameters
    ----------
    spaces : Spaces
        Tooth spaces of the drive gear.
    tip_rounding : float
        Radius of an edge between flank and tip. [m]
    roughness : tuple of float
        Root mean square roughness of both flanks, whose peaks part them where they touch. [m]
    """

    def path(name: str, side: Throats, *, leading: bool) -> FlowPath:
        met = np.mod(numbering.met_spaces - (1 if leading else 0), gears.counts[1])
        radius = meshing.relative_radius(gears.mesh, side, tip_rounding)
        # the gap in a throat grows in width while the tips enter the lens
        width = gears.face_width * smooth_step(side.weight / _GROWN_THROAT)
        geometry = np.column_stack([side.gap, width, radius])
        return FlowPath(
            name=name,
            category=FLANK,
            kind="curved_gap",
            nodes_a=numbering.nodes[0],
            nodes_b=numbering.nodes[1][met],
            angle_ratio=1.0,
            phases=numbering.space_phases[0],
            geometry=monotone_table(FULL_TURN, geometry),
            height_by_motion=monotone_table(FULL_TURN, meshing.gap_by_motion(gears, side)),
            drag_speed=monotone_table(FULL_TURN, meshing.throat_drag(gears, side, leading=leading)),
            partner_shift=numbering.partner_shift,
            minimum_height=_PEAKS * sum(roughness),
        )

    return (
        path("flank_leading", spaces.right, leading=True),
        path("flank_trailing", spaces.left, leading=False),
    )


@final
@dataclass(frozen=True)
class ToothSpaces:
    """Tooth spaces of one gear as chambers with their paths; names end with that of the gear."""

    gears: meshing.MeshedGears
    """Gears in mesh."""
    numbering: Numbering
    """Phases and nodes."""
    spaces: Spaces
    """Tooth spaces of the gear at the table nodes."""
    label: str
    """End of the names of the paths."""
    width: float
    """Face width of the gear. [m]"""

    @property
    def gear(self) -> int:
        """0 for the drive gear, 1 for the driven gear."""
        return 0 if self.spaces.is_drive else 1

    @property
    def _paths(self) -> ChamberPaths:
        nodes = self.numbering.nodes[self.gear]
        return ChamberPaths(
            nodes=nodes,
            behind=np.roll(nodes, -1),
            ahead=nodes,
            angle_ratio=self.numbering.ratios[self.gear],
            phases=self.numbering.space_phases[self.gear],
            land_phases=self.numbering.tooth_phases[self.gear],
        )

    def chambers(self, name: str) -> ChamberFamily:
        """Volumes of the spaces; their jumps of slope, which would cost steps, are rounded."""
        return ChamberFamily(
            name=name,
            angle_ratio=self.numbering.ratios[self.gear],
            phases=self.numbering.space_phases[self.gear],
            volume=smooth_table(FULL_TURN, self.width * section_areas(self.spaces)),
            volume_by_motion=smooth_table(FULL_TURN, self.width * area_by_motion(self.spaces)),
        )

    def tips(
        self, name: str, category: PathCategory, clearance: Array | float, cover: Array,
        motion: Array, roughness: float, worn_by: str | None = None,
    ) -> FlowPath:  # fmt: skip
        """Gap between tooth tips and the wall round them, from the space behind to that ahead.

        Parameters
        ----------
        name : str
            Begin of its name.
        category : PathCategory
            What it is booked under.
        clearance : ndarray or float
            Height over the places. [m]
        cover : ndarray
            Part of a tip that seals. [-]
        motion : ndarray, shape (places, 5)
            Derivative of the height by the micro-motions. [-]
        roughness : float
            Of the wall, which parts it from tips that touch. [m]
        worn_by : str or None
            Body that cuts into the wall.
        """
        tooth, count = self.gears.teeth[self.gear], cover.size
        speed = abs(tooth.tip_radius) * self.numbering.ratios[self.gear]
        geometry = np.empty((count, 3))
        geometry[:, 0] = clearance
        geometry[:, 1] = self.width * cover
        geometry[:, 2] = tooth.land_angle * tooth.tip_radius
        return self._paths.over_lands(
            f"{name}_{self.label}",
            category,
            geometry,
            height_by_motion=smooth_table(FULL_TURN, motion),
            drag_speed=monotone_table(FULL_TURN, np.full(count, 0.5 * speed)),
            shear_speed=monotone_table(FULL_TURN, np.full(count, speed)),
            throat_speed=speed,
            worn_by=worn_by,
            minimum_height=roughness,
        )

    def port_openings(self, edges: tuple[float, float]) -> list[FlowPath]:
        """Openings at the tip circle between mesh and the edges of inlet and outlet [rad]."""
        tables = {}
        for port, length in zip(_PORTS, port_lengths(self.spaces, edges), strict=True):
            diameter = 2.0 * self.width * length / (self.width + length)
            tables[port] = np.column_stack([self.width * length, diameter])
        return self.openings("port", tables)

    def openings(self, kind: str, tables: Mapping[str, Array], end: float = 0.0) -> list[FlowPath]:
        """Openings of one kind of :data:`OPENINGS` by port: area [m2] and diameter [m].

        ``end`` is that of the flow path, for openings in one face.
        """
        (categories, multiplicity), found = OPENINGS[kind], []
        face = "" if end == 0.0 else "leading_" if end > 0.0 else "lagging_"
        for port, table in tables.items():
            label, node = f"{kind}_{port}_{face}{self.label}", getattr(self.numbering, port)
            equal = 1.0 if end else multiplicity
            path = self._paths.to_node(label, categories[port], table, node, "orifice", equal)
            found.append(replace(path, end=end))
        return found

    def lateral(self, height: float, space_area: float) -> FlowPath:
        """Gaps over the tooth faces, from the space behind to the space ahead.

        A land as wide as the teeth are high and as long as they are thick in the mean.

        Parameters
        ----------
        height : float
            Film height. [m]
        space_area : float
            Area of a space up to the tip circle, out of mesh. [m2]
        """
        tip, root = (abs(r) for r in (self.spaces.own.tip_radius, self.gears.root_radii[self.gear]))
        depth, middle = abs(tip - root), 0.5 * (tip + root)
        ring = np.pi * abs(tip**2 - root**2) / abs(self.spaces.own.tooth_count)
        row = np.array([height, depth, (ring - space_area) / depth])
        speed = middle * self.numbering.ratios[self.gear]
        return self._paths.over_lands(
            f"lateral_{self.label}",
            LATERAL,
            row,
            drag_speed=monotone_table(FULL_TURN, np.full(4, 0.5 * speed)),
            multiplicity=FACES,
        )

    def drain(self, height: float, radii: tuple[float, float]) -> FlowPath:
        """Gaps over the land behind the tooth roots, to the drain.

        The path, :func:`~toothspace.closures.gap_flow.ring_sector_gap`.

        Parameters
        ----------
        height : float
            Film height. [m]
        radii : tuple of float
            Inner and outer radius of the land, which leaks as a ring sector does. [m]
        """
        sector = ring_sector_gap(*radii, abs(self.spaces.own.pitch_angle))
        row, node = np.array([height, *sector]), self.numbering.drain
        return self._paths.to_node(f"drain_{self.label}", DRAIN, row, node, multiplicity=FACES)
