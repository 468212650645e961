"""What stands before the covers: rotors, pockets, kidneys and shaft at a shaft angle."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, cast, final

import numpy as np
import shapely

from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.gearing.gear_face import under_recesses
from toothspace.gearing.materials import library_material, reduced_modulus
from toothspace.machines.gerotor.bodies import BODIES
from toothspace.machines.gerotor.flow_paths import lobe_phases, pocket_phases, shaft_radius
from toothspace.machines.gerotor.parameters import GerotorParameters
from toothspace.machines.gerotor.pockets import FULL_TURN, Pockets
from toothspace.machines.gerotor.ports import Ports, throat_place
from toothspace.machines.shared_bearings import CORRELATION_LENGTH, HOUSING_MATERIAL
from toothspace.model.description import ChamberFamily
from toothspace.model.film_faces import (
    FILM,
    NO_BODY,
    ChamberRing,
    FaceBody,
    FaceCells,
    FaceSurfaces,
    FilmFace,
    RimFilm,
    SharedFaces,
)

_SECTORS = 24
"""About how many parts the solved film round the outer rotor has."""
_LEAST_RADIUS = 0.1
"""Inner rim of the grid over the shaft's radius, if the shaft stands round the origin. [-]"""


@final
@dataclass(frozen=True, eq=False)
class CoverMap:
    """Nodes and rotors before one cover."""

    pocket: Pockets
    """Pockets over their place."""
    shaft_radius: float
    """Radius at which the land of the inner rotor ends. [m]"""
    recesses: tuple[tuple[int, Array], ...]
    """Kidneys of this cover: node and outline. [m]"""
    _throats: tuple[Array, Array] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        place = self.pocket.place
        throat = np.append(throat_place(self.pocket), 0.0)
        throat[-1] = throat[0] + FULL_TURN
        object.__setattr__(self, "_throats", (np.append(place, FULL_TURN), throat))

    def __call__(self, shaft_angle: float, x: Array, y: Array) -> FaceCells:
        """Nodes and numbers of rotors at points; angles in [rad], places in [m]."""
        rotors, turn = self.pocket.rotors, self.pocket.angle_ratio * shaft_angle
        inner = _inside(rotors.inner, shaft_angle, x, y + rotors.eccentricity)
        outer = ~_inside(rotors.outer, turn, x, y) & ~inner
        shaft = np.hypot(x, y + rotors.eccentricity) < self.shaft_radius
        body = np.where(inner & ~shaft, 0, np.where(outer, 1, NO_BODY)).astype(np.int64)
        node = np.where(inner | outer, FILM, self._pocket(turn, x, y)).astype(np.int64)
        node = under_recesses(node, body != NO_BODY, self.recesses, x, y)
        node[shaft] = rotors.outer_tooth_count + 3
        return FaceCells(node, body)

    def _pocket(self, turn: float, x: Array, y: Array) -> IntArray:
        """Pocket whose throats a point lies between."""
        count = self.pocket.rotors.outer_tooth_count
        lobes = np.mod(lobe_phases(self.pocket) + turn, FULL_TURN)
        throat = np.mod(np.interp(lobes, *self._throats), FULL_TURN)
        order = np.argsort(throat)
        place = np.mod(np.arctan2(y, x) + 0.5 * np.pi, FULL_TURN)
        # lobe k stands ahead of pocket k
        ahead = np.searchsorted(throat[order], place) % count
        return np.asarray(order[ahead], dtype=np.int64)


def _inside(outline: Array, turn: float, x: Array, y: Array) -> BoolArray:
    cosine, sine = np.cos(turn), np.sin(turn)
    shape = shapely.Polygon(outline)
    shapely.prepare(shape)
    back = cosine * x + sine * y, cosine * y - sine * x
    return np.asarray(shapely.contains_xy(shape, *back))


def shared_faces(
    parameters: GerotorParameters, pocket: Pockets, ports: Ports, family: ChamberFamily
) -> SharedFaces:
    """Films of both rotors before both covers.

    Parameters
    ----------
    ports : Ports
        Kidneys, in the cover with the lower z.
    family : ChamberFamily
        The pockets, without the film that they feed.
    """
    count, shaft = pocket.rotors.outer_tooth_count, shaft_radius(parameters, pocket)
    kidneys = ((count + 1, ports.contours["inlet"]), (count + 2, ports.contours["outlet"]))
    opposite = kidneys if parameters.ports.covers == "both" else ()
    housing, rotors, lateral = parameters.housing, parameters.rotors, parameters.lateral
    rim = RimFilm(
        body="outer_rotor",
        radius=0.5 * housing.outer_rotor_diameter,
        length=rotors.face_width,
        clearance=housing.radial_clearance,
        roughness=float(np.hypot(rotors.roughness, housing.roughness)),
        open_ends=housing.end_condition == "pressure",
        chamber=count,
    )
    outer_radii = (float(np.hypot(*pocket.rotors.inner.T).max()), rim.radius)
    inner_radii = (shaft, float(np.hypot(*pocket.rotors.outer.T).min()))
    centers = ((0.0, -pocket.rotors.eccentricity), (0.0, 0.0))
    own = library_material(rotors.material, "machine.rotors.material")
    cover = library_material(HOUSING_MATERIAL, "")
    surfaces = FaceSurfaces(
        moving_roughness=rotors.roughness,
        resting_roughness=housing.roughness,
        effective_modulus=reduced_modulus(own, cover),
        hardness=min(own.hardness, cover.hardness),
        correlation_length=CORRELATION_LENGTH,
    )
    covers = tuple(
        FilmFace(
            bodies=tuple(map(FaceBody, BODIES, centers, outer_radii, inner_radii)),
            center=(0.0, 0.0),
            inner_radius=max(shaft - pocket.rotors.eccentricity, _LEAST_RADIUS * shaft),
            outer_radius=rim.radius,
            gap=gap,
            face_map=CoverMap(pocket, shaft, recesses),
            chambers=ChamberRing(
                nodes=np.arange(count),
                phases=pocket_phases(pocket),
                angle_ratio=pocket.angle_ratio,
                zero_angle=-0.5 * np.pi,
            ),
            recesses=np.array([node for node, _ in kidneys]),
            inner_node=count + 3,
            sectors=-(-_SECTORS // count),
            surfaces=surfaces,
        )
        for gap, recesses in zip(lateral.side_gaps, (kidneys, opposite), strict=True)
    )
    return SharedFaces(
        covers=covers,
        rim=rim,
        families=(family,),
        replaced=("lateral", "drain", "rim", "film_end"),
        motion=cast(Any, "none" if lateral.position == "given" else lateral.motion or "full"),
    )
