"""Rotors as bodies: inertia, the film round the outer rotor, faces, outlines."""

from __future__ import annotations

import numpy as np

from toothspace.core.types import Array
from toothspace.gearing.materials import library_material
from toothspace.geometry.curve import (
    closed_length,
    outline_with_hole,
    polar,
    polar_moment,
    signed_area,
)
from toothspace.machines.gerotor.flow_paths import shaft_radius, side_gap
from toothspace.machines.gerotor.parameters import GerotorParameters
from toothspace.machines.gerotor.pockets import Pockets
from toothspace.machines.gerotor.ports import Ports
from toothspace.machines.shared_bearings import HOUSING_MATERIAL, ring_bearing, shaft_bearings
from toothspace.model.description import Body, LumpedJournalBearing, LumpedLateralFilm, Motion

BODIES = ("inner_rotor", "outer_rotor")
_CIRCLE_POINTS = 361


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

    Returns
    -------
    ndarray, shape (n, 5)
        In the order of ``area_by_motion``, over the place of the pocket. [m2], [m3/rad]

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
