"""Journal bearings of shafts and of rings in a bore, and a gear with its shaft, from their data."""

from __future__ import annotations

from typing import Literal

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.gearing.materials import Material, library_material, reduced_modulus
from toothspace.geometry.curve import closed_length, polar_moment
from toothspace.geometry.gear_profile import GearProfile
from toothspace.machines.shared_tables import ShaftBearingParameters
from toothspace.model.description import Body, LumpedJournalBearing

HOUSING_MATERIAL = "cast_iron"
"""Material of the bore round a ring."""

BEARINGS = 2
"""Bearings of a shaft."""

CORRELATION_LENGTH = 10e-6
"""Half-height correlation length of machined surfaces. [m]"""


def shaft_bearings(
    body: str,
    bearing: ShaftBearingParameters,
    shaft: Material,
    bush: Material,
    seat_clearance: float = 0.0,
) -> LumpedJournalBearing:
    """Two equal bearings of a shaft.

    Parameters
    ----------
    body : str
        Body on the shaft.
    bearing : ShaftBearingParameters
        Size and surfaces.
    seat_clearance : float
        Radial clearance of what holds the bearings, in the housing. [m]
    """
    return LumpedJournalBearing(
        body=body,
        count=BEARINGS,
        diameter=bearing.diameter,
        length=bearing.length,
        radial_clearance=bearing.radial_clearance,
        roughness=float(np.hypot(bearing.roughness_shaft, bearing.roughness_bush)),
        correlation_length=CORRELATION_LENGTH,
        effective_modulus=reduced_modulus(shaft, bush),
        hardness=min(shaft.hardness, bush.hardness),
        boundary_friction=bearing.boundary_friction,
        seat_clearance=seat_clearance,
    )


def ring_bearing(
    body: str,
    size: tuple[float, float, float],
    roughness: tuple[float, float],
    ring: Material,
    boundary_friction: float,
    end_condition: Literal["pressure", "no_flow"] = "pressure",
) -> LumpedJournalBearing:
    """Film round a body that turns in the bore of the housing.

    Parameters
    ----------
    body : str
        The ring.
    size : tuple of float
        Outside diameter, width and radial clearance. [m]
    roughness : tuple of float
        Root mean square roughness of ring and bore. [m]
    boundary_friction : float
        Friction coefficient of touching asperities. [-]
    end_condition : str
        Both ends of the film: ``pressure`` or ``no_flow``.
    """
    diameter, width, clearance = size
    bore = library_material(HOUSING_MATERIAL, "")
    return LumpedJournalBearing(
        body=body,
        count=1,
        diameter=diameter,
        length=width,
        radial_clearance=clearance,
        roughness=float(np.hypot(*roughness)),
        correlation_length=CORRELATION_LENGTH,
        effective_modulus=reduced_modulus(ring, bore),
        hardness=min(ring.hardness, bore.hardness),
        boundary_friction=boundary_friction,
        end_condition=end_condition,
    )


def require_shaft_below(key: str, diameter: float, root_radius: float) -> None:
    """Refuse a shaft that is not thinner than the root of what it carries. [m].

    Raises GeometryError if a diameter under a key reaches the root circle.
    """
    if diameter >= 2.0 * root_radius:
        allowed = f"below the root diameter, {root_radius * 2e3:.5g} mm"
        raise GeometryError(key, f"{diameter * 1e3:.5g} mm", allowed)


def require_rim(key: str, diameter: float, root_radius: float) -> None:
    """Refuse a ring whose teeth reach its outside diameter. [m].

    Raises GeometryError if a diameter under a key does not reach beyond the roots of the teeth.
    """
    if diameter <= 2.0 * root_radius:
        allowed = f"above {root_radius * 2e3:.5g} mm, the root diameter of its teeth"
        raise GeometryError(key, f"{diameter * 1e3:.5g} mm", allowed)


def gear_on_shaft(
    name: str,
    profile: GearProfile,
    width: float,
    material: Material,
    bearing: ShaftBearingParameters,
) -> Body:
    """Gear of a profile with the journals of its shaft, at the origin, driven by the shaft.

    Section times face width, plus the journals.

    Parameters
    ----------
    name : str
        Name of the body.
    profile : GearProfile
        Section of the gear.
    width : float
        Face width. [m]
    material : Material
        Material of gear and shaft.
    bearing : ShaftBearingParameters
        Bearings of the shaft.
    """
    radius, density = 0.5 * bearing.diameter, material.density
    shaft = density * np.pi * radius**2 * BEARINGS * bearing.length
    polar = density * width * polar_moment(profile.closed_polygon())
    return Body(
        name=name,
        center=(0.0, 0.0),
        speed_ratio=1.0,
        mass=float(density * profile.area * width + shaft),
        inertia=float(polar + 0.5 * shaft * radius**2),
        role="shaft",
        wetted_area=width * closed_length(profile.closed_polygon()),
    )
