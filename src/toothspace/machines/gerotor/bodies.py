"""Rotors as bodies: inertia, the film round the outer rotor, faces before the covers, outlines."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, cast, final

import numpy as np
import shapely

from toothspace.core.types import Array, BoolArray
from toothspace.gearing.gear_face import under_recesses
from toothspace.gearing.materials import library_material, reduced_modulus
from toothspace.geometry.curve import (
    closed_length,
    outline_with_hole,
    polar,
    polar_moment,
    signed_area,
)
from toothspace.machines.gerotor.flow_paths import (
    lobe_phases,
    pocket_phases,
    shaft_radius,
    side_gap,
)
from toothspace.machines.gerotor.parameters import GerotorParameters
from toothspace.machines.gerotor.pockets import FULL_TURN, Pockets
from toothspace.machines.gerotor.ports import Ports, throat_place
from toothspace.machines.shared_bearings import (
    CORRELATION_LENGTH,
    HOUSING_MATERIAL,
    ring_bearing,
    shaft_bearings,
)
from toothspace.model.description import (
    Body,
    ChamberFamily,
    LumpedJournalBearing,
    LumpedLateralFilm,
    Motion,
)
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

BODIES = ("inner_rotor", "outer_rotor")
_CIRCLE_POINTS = 361
_SECTORS = 24
"""About how many parts the solved film round the outer rotor has."""
_LEAST_RADIUS = 0.1
"""Inner rim of the grid over the shaft's radius, if the shaft stands round the origin. [-]"""


def motions(parameters: GerotorParameters) -> tuple[Motion, ...]:
    """Micro-motions: planar motion of the outer rotor, x and y of an inner one in bearings."""
    outer = tuple(Motion("outer_rotor", axis) for axis in ("x", "y", "rotation"))
    if parameters.journal_bearings is None:
        return outer
    return (Motion("inner_rotor", "x"), Motion("inner_rotor", "y"), *outer)


def motion_columns(parameters: GerotorParameters) -> tuple[int, ...]:
    """Columns that these motions have in ``area_by_motion`` and ``gap_by_motion``."""
    return (2, 3, 4) if parameters.journal_bearings is None else (0, 1, 2, 3, 4)


def bodies(parameters: GerotorParameters, pocket: Pockets) -> tuple[Body, Body]:
    """Both rotors: sections times face width; the shaft fills the inner rotor's bore."""
    rotors, width = pocket.rotors, parameters.rotors.face_width
    density = library_material(parameters.rotors.material, "machine.rotors.material").density
    radius = 0.5 * parameters.housing.outer_rotor_diameter
    mass = density * width * signed_area(rotors.inner)
    rim = density * width * (np.pi * radius**2 - signed_area(rotors.outer))
    inertia = density * width * polar_moment(rotors.inner)
    rim_inertia = density * width * (0.5 * np.pi * radius**4 - polar_moment(rotors.outer))
    center, ratio = (0.0, -rotors.eccentricity), pocket.angle_ratio
    wetted, rim_wetted = (width * closed_length(c) for c in (rotors.inner, rotors.outer))
    return (
        Body(BODIES[0], center, 1.0, float(mass), inertia, "shaft", wetted),
        Body(BODIES[1], (0.0, 0.0), ratio, float(rim), rim_inertia, "driven", rim_wetted),
    )


def journal_bearings(parameters: GerotorParameters) -> tuple[LumpedJournalBearing, ...]:
    """Film round the outer rotor, and the bearings of an inner rotor's shaft."""
    rotors, housing = parameters.rotors, parameters.housing
    own = library_material(rotors.material, "machine.rotors.material")
    film = ring_bearing(
        "outer_rotor",
        (housing.outer_rotor_diameter, rotors.face_width, housing.radial_clearance),
        (rotors.roughness, housing.roughness),
        own,
        parameters.contact.boundary_friction,
        "pressure" if housing.end_condition == "pressure" else "no_flow",
    )
    shaft = parameters.journal_bearings
    if shaft is None:
        return (film,)
    bush = library_material(HOUSING_MATERIAL, "")
    return film, shaft_bearings("inner_rotor", shaft, own, bush)


def film_by_motion(parameters: GerotorParameters, pocket: Pockets) -> Array:
    r"""Derivative of the film volume that each pocket feeds, by the motions of both rotors.

    In the order of ``area_by_motion``, over the place of the pocket, shape (n, 5). [m2], [m3/rad]

    Notes
    -----
    Walls close the ends of the film (``no_flow``), so the faces of the outer rotor lead the
    pressure of the pockets :math:`p_k` into it. In the film of the centred rotor

    .. math:: \frac{\partial^2 p}{\partial\theta^2} = \alpha^2 (p - p_k), \qquad
        \alpha^2 = \frac{2 h^3 R}{c^3 L \ln(R/r)},

    with the gap h beside the faces and the radius r of the cavity floors. The force on the
    rotor comes from the first harmonic, of which :math:`\alpha^2/(1 + \alpha^2)` is left:

    .. math:: \mathbf F = -\frac{2\alpha^2}{1 + \alpha^2}\,R L \sin\frac{\pi}{z_2}
        \sum_k p_k \mathbf n_k .

    Written as :math:`p\,\partial V/\partial\mathbf q` it is part of the pockets' work.
    """
    columns = np.zeros((pocket.place.size, 5))
    housing, width = parameters.housing, parameters.rotors.face_width
    if housing.end_condition != "no_flow":
        return columns
    radius = 0.5 * housing.outer_rotor_diameter
    floor = float(np.hypot(*pocket.rotors.outer.T).max())
    alpha = 2.0 * (side_gap(parameters) / housing.radial_clearance) ** 3
    alpha *= radius / (width * np.log(radius / floor))
    chord = 2.0 * radius * width * np.sin(np.pi / pocket.rotors.outer_tooth_count)
    size = chord * alpha / (1.0 + alpha)
    columns[:, 2] = -size * np.sin(pocket.place)
    columns[:, 3] = size * np.cos(pocket.place)
    return columns


def lateral_films(parameters: GerotorParameters, pocket: Pockets) -> tuple[LumpedLateralFilm, ...]:
    """Films on the faces of both rotors."""
    rotors, lateral = pocket.rotors, parameters.lateral
    height = lateral.side_gap or lateral.shear_height
    inner, outer = np.hypot(*rotors.inner.T), np.hypot(*rotors.outer.T)
    rim = 0.5 * parameters.housing.outer_rotor_diameter
    root, tip, lobe = float(inner.min()), float(inner.max()), float(outer.min())
    tooth = polar_moment(rotors.inner) - 0.5 * np.pi * root**4
    # the outer rotor has no full annulus inside its lobes: all of it counts as tooth
    face = 0.5 * np.pi * rim**4 - polar_moment(rotors.outer)
    return (
        LumpedLateralFilm(
            "inner_rotor", 2, height, shaft_radius(parameters, pocket), root, tip,
            tooth / (0.5 * np.pi * (tip**4 - root**4)),
        ),
        LumpedLateralFilm(
            "outer_rotor", 2, height, lobe, lobe, rim,
            face / (0.5 * np.pi * (rim**4 - lobe**4)),
        ),
    )  # fmt: skip


def outlines(parameters: GerotorParameters, pocket: Pockets, ports: Ports) -> dict[str, Array]:
    """Polygons for drawing: rotors in their own frame at shaft angle zero, casing, ports."""
    radius = 0.5 * parameters.housing.outer_rotor_diameter
    angle = np.linspace(0.0, 2.0 * np.pi, _CIRCLE_POINTS)[:-1]
    circle = polar(1.0, angle)
    return {
        "inner_rotor": pocket.rotors.inner,
        "outer_rotor": outline_with_hole(radius * circle, pocket.rotors.outer),
        "casing": (radius + parameters.housing.radial_clearance) * circle,
        "port_inlet": ports.contours["inlet"],
        "port_outlet": ports.contours["outlet"],
    }


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
        # pocket whose throats a point lies between
        count = self.pocket.rotors.outer_tooth_count
        lobes = np.mod(lobe_phases(self.pocket) + turn, FULL_TURN)
        throat = np.mod(np.interp(lobes, *self._throats), FULL_TURN)
        order = np.argsort(throat)
        place = np.mod(np.arctan2(y, x) + 0.5 * np.pi, FULL_TURN)
        # lobe k stands ahead of pocket k
        ahead = np.searchsorted(throat[order], place) % count
        node = np.where(inner | outer, FILM, np.asarray(order[ahead], dtype=np.int64)).astype(
            np.int64
        )
        node = under_recesses(node, body != NO_BODY, self.recesses, x, y)
        node[shaft] = rotors.outer_tooth_count + 3
        return FaceCells(node, body)


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
