"""Bodies that float between two covers: the stack of their films, with covers that rest."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.core.types import Array
from toothspace.model.description import MachineDescription
from toothspace.model.film_faces import NO_BODY, FaceCells, FilmFace, SharedFaces
from toothspace.model.lateral_balance import (
    AxialForce,
    FilmInterface,
    FloatingBearing,
    HousingContact,
    LateralBalance,
    Patch,
    Side,
)


@final
@dataclass(frozen=True)
class OwnFace:
    """Face map of one body alone; where another stands, the nearest chamber has its pressure."""

    cover: FilmFace
    """Cover that several bodies share."""
    body: int
    """Number of the body."""
    beyond: int
    """Node beyond the outer rim of the cover."""

    def __call__(self, shaft_angle: float, x: Array, y: Array) -> FaceCells:
        """Nodes and the body at points; angles in [rad], places in [m]."""
        cover, ring = self.cover, self.cover.chambers
        cells = cover.face_map(shaft_angle, x, y)
        x0, y0 = cover.center
        outside = np.hypot(x - x0, y - y0) > cover.outer_radius
        own = (cells.body == self.body) & ~outside
        nearest = ring.nodes[ring.nearest(shaft_angle, x, y)]
        node = np.where(own | (cells.body == NO_BODY), cells.node, nearest)
        return FaceCells(np.where(outside, self.beyond, node), np.where(own, 0, NO_BODY))


def resting_covers(description: MachineDescription, faces: SharedFaces) -> LateralBalance:
    """Balance of bodies between covers, from what the machine says of the covers.

    Parameters
    ----------
    description : MachineDescription
        Machine with masses, speeds and nodes of its bodies.
    faces : SharedFaces
        Its covers, with bodies that lift or lift and tilt.

    Notes
    -----
    Every film counts for its own body. The film at the outer rim has one pressure, that of its
    chamber in closed form, or of the inner node where its ends are open: the same at both covers.
    """
    face = faces.face
    own = {body.name: body for body in description.bodies}
    beyond = face.inner_node if faces.rim.open_ends else faces.rim.chamber
    sides: tuple[tuple[Side, str, FilmFace], ...] = (
        ("floating", "b", faces.covers[1]),
        ("solid", "a", faces.covers[0]),
    )
    area = np.pi * face.outer_radius**2
    whole, none = Patch(area, face.center), Patch(0.0, face.center)
    assert faces.motion != "none"
    return LateralBalance(
        arrangement="fixed",
        motion=faces.motion,
        interfaces=tuple(
            FilmInterface(
                name=f"{label}_{body.name}",
                body=body.name,
                side=side,
                face=replace(
                    cover,
                    bodies=(body,),
                    center=body.center,
                    inner_radius=body.inner_radius,
                    outer_radius=body.outer_radius,
                    face_map=OwnFace(cover, number, beyond),
                ),
                speed_ratio=own[body.name].speed_ratio,
            )
            for side, label, cover in sides
            for number, body in enumerate(face.bodies)
        ),
        floating=FloatingBearing(
            mass=0.0,
            face=whole,
            high_pressure=whole,
            nose=none,
            preload=AxialForce(0.0),
            housing=HousingContact(),
            gauge_point=face.center,
            axial_play=np.inf,
        ),
        high_node=description.outlet_node if description.mode == "pump" else description.inlet_node,
        low_node=face.inner_node,
        body_forces=tuple(AxialForce(0.0) for _ in face.bodies),
        body_masses=tuple(own[body.name].mass for body in face.bodies),
    )
