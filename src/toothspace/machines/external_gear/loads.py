"""Bodies, their bearings and their faces."""

from __future__ import annotations

import numpy as np

from toothspace.core.types import Array
from toothspace.geometry.gear_profile import GearProfile
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.spec import Material
from toothspace.model.description import Body, LumpedJournalBearing, Motion

BODIES = ("drive_gear", "driven_gear")
MOTIONS = (
    Motion("drive_gear", "x"),
    Motion("drive_gear", "y"),
    Motion("driven_gear", "x"),
    Motion("driven_gear", "y"),
    Motion("driven_gear", "rotation"),
)
"""Micro-motions; the drive gear's rotation is the shaft angle."""

_BEARINGS_PER_GEAR = 2


def bodies(assembly: Assembly) -> tuple[Body, Body]:
    """Both gears with their shafts: section times face width, plus the journals."""
    return _body(assembly, 0), _body(assembly, 1)


def _body(assembly: Assembly, index: int) -> Body:
    spec = assembly.spec
    gear = (spec.drive, spec.driven)[index]
    profile, density = assembly.profiles[index], gear.material.density
    shaft_radius = 0.5 * spec.journals.diameter
    shaft_length = _BEARINGS_PER_GEAR * spec.journals.length
    shaft_mass = density * np.pi * shaft_radius**2 * shaft_length
    mass = density * profile.area * gear.face_width + shaft_mass
    polar = density * gear.face_width * polar_moment(profile)
    return Body(
        name=BODIES[index],
        center=(0.0, 0.0 if index == 0 else assembly.mesh.center_distance),
        speed_ratio=1.0 if index == 0 else -assembly.mesh.ratio,
        mass=float(mass),
        inertia=float(polar + 0.5 * shaft_mass * shaft_radius**2),
        role="shaft" if index == 0 else "driven",
    )


def polar_moment(profile: GearProfile) -> float:
    """Polar second moment of area of a gear section about its axis. [m4]."""
    p, q = profile.points[:-1], profile.points[1:]
    cross = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    squares = np.sum(p * p + p * q + q * q, axis=1)
    return float(profile.tooth_count * np.sum(cross * squares) / 12.0)


def reduced_modulus(first: Material, second: Material) -> float:
    """Effective modulus E' = 2 / [(1 - nu1^2)/E1 + (1 - nu2^2)/E2]. [Pa]."""
    compliance = sum((1.0 - m.poisson_ratio**2) / m.elastic_modulus for m in (first, second))
    return 2.0 / compliance


def journal_bearings(assembly: Assembly) -> tuple[LumpedJournalBearing, ...]:
    """Journal bearings of both gears."""
    bearing = assembly.spec.journals
    gears = (assembly.spec.drive, assembly.spec.driven)
    return tuple(
        LumpedJournalBearing(
            body=name,
            count=_BEARINGS_PER_GEAR,
            diameter=bearing.diameter,
            length=bearing.length,
            radial_clearance=bearing.radial_clearance,
            roughness=float(np.hypot(bearing.roughness_shaft, bearing.roughness_bush)),
            correlation_length=bearing.correlation_length,
            effective_modulus=reduced_modulus(gear.material, bearing.material),
            hardness=min(gear.material.hardness, bearing.material.hardness),
            boundary_friction=bearing.boundary_friction,
            seat_clearance=bearing.seat_clearance,
            friction=bearing.friction,
        )
        for name, gear in zip(BODIES, gears, strict=True)
    )


def tooth_fraction(profile: GearProfile) -> float:
    """Part of the ring between root and tip that is tooth, weighted with r^2. [-]."""
    ring = 0.5 * np.pi * (profile.tip_radius**4 - profile.root_radius**4)
    teeth = polar_moment(profile) - 0.5 * np.pi * profile.root_radius**4
    return float(teeth / ring)


def outlines(assembly: Assembly) -> dict[str, Array]:
    """Polygons for drawing: gears in their own frame at shaft angle zero, casing and grooves."""
    drive, driven = assembly.profiles
    mesh, casing = assembly.mesh, assembly.spec.casing
    found = {
        # the drive space 0 and the driven tooth 0 lie on the centre line
        "drive_gear": drive.closed_polygon(0.5 * np.pi + mesh.half_pitch),
        "driven_gear": driven.closed_polygon(-0.5 * np.pi + mesh.turn),
        "casing": casing.contour if casing.contour is not None else _figure_eight(assembly),
    }
    found.update(groove_polygons(assembly))
    return found


def groove_polygons(assembly: Assembly) -> dict[str, Array]:
    """Outlines of the relief grooves, named by the port that they join. [m]."""
    grooves = assembly.spec.grooves
    if grooves is None:
        return {}
    pitch_height = assembly.mesh.pitch_radii[0]
    low, high = (pitch_height + s * 0.5 * grooves.radial_extent for s in (-1.0, 1.0))
    found = {}
    sides = (
        ("outlet", 1.0, grooves.closing_side_offset, grooves.closing_contour),
        ("inlet", -1.0, grooves.opening_side_offset, grooves.opening_contour),
    )
    for port, sign, offset, contour in sides:
        near, far = sign * offset, sign * (offset + grooves.width)
        box = np.array([[near, low], [far, low], [far, high], [near, high]])
        found[f"groove_{port}"] = box if contour is None else contour
    return found


def _figure_eight(assembly: Assembly) -> Array:
    mesh, clearance = assembly.mesh, assembly.spec.casing.radial_clearance
    lower = assembly.teeth[0].tip_radius + clearance
    upper = assembly.teeth[1].tip_radius + clearance
    distance = mesh.center_distance
    low = np.arccos((distance**2 + lower**2 - upper**2) / (2.0 * distance * lower))
    high = np.arccos((distance**2 + upper**2 - lower**2) / (2.0 * distance * upper))
    below = np.linspace(low, 2.0 * np.pi - low, 180) + 0.5 * np.pi
    above = np.linspace(high, 2.0 * np.pi - high, 180) - 0.5 * np.pi
    first = lower * np.column_stack([np.cos(below), np.sin(below)])
    second = upper * np.column_stack([np.cos(above), np.sin(above)])
    return np.vstack([first[:-1], second[:-1] + np.array([0.0, distance])])
