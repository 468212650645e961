"""Loads of bearings and teeth at one condition, against guide values."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from toothspace.advice.trapping import DesignCondition
from toothspace.closures.contact_cylindrical import hertz_pressure
from toothspace.core.finding import DesignCheck
from toothspace.gearing.flank_contacts import rigid_mesh
from toothspace.gearing.materials import Material, reduced_modulus
from toothspace.gearing.meshing import MeshedGears, displacement
from toothspace.geometry.gear_profile import GearProfile

RADIAL_LOAD_COEFFICIENT = 0.85
"""Radial load of the driven gear over pressure x width x tip diameter (Ivantysyn). [-]"""

MAX_BEARING_PRESSURE = 20e6
MAX_BEARING_PRESSURE_VELOCITY = 100e6
MAX_FLANK_PRESSURE = 1500e6
MAX_ROOT_STRESS = 430e6


def strength_checks(
    gears: MeshedGears,
    profiles: Sequence[GearProfile],
    materials: tuple[Material, Material],
    bearing: tuple[float, float],
    condition: DesignCondition,
) -> tuple[DesignCheck, ...]:
    r"""Bearing load, p v, flank and root stress at a pressure and speed.

    Parameters
    ----------
    gears : MeshedGears
        Gears in mesh.
    profiles : sequence of GearProfile
        Sections of drive and driven gear.
    materials : tuple of Material
        Materials of drive and driven gear.
    bearing : tuple of float
        Diameter and length of each bearing. [m]
    condition : DesignCondition
        Pressure and shaft speed.

    Notes
    -----
    Radial load :math:`0.85\,\Delta p\,b\,d_a`; contact force from half of the mean torque over
    the base radius; :func:`~toothspace.closures.contact_cylindrical.hertz_pressure` at the pitch
    point; root stress of a cantilever loaded at its tip. Limits of flank and root: endurance of
    case-hardened steel, quality MQ. Limits of the bearings: guide values for lubricated
    steel-backed bushes.

    References
    ----------
    .. [1] J. Ivantysyn, M. Ivantysynova, Hydrostatic Pumps and Motors, 2001.
    .. [2] ISO 6336-5:2016, figures for case-hardened wrought steels.
    """
    difference = condition.pressure_difference
    load = bearing_pressure(gears, bearing, difference)
    heat = load * 0.5 * bearing[0] * condition.shaft_speed
    force = contact_force(gears, difference)
    pitch, root = flank_pressure(gears, materials, force), root_stress(gears, profiles, force)
    rows = (
        ("bearing specific load", load, MAX_BEARING_PRESSURE, "MPa", _WHY_LOAD),
        ("bearing p v, lubricated", heat, MAX_BEARING_PRESSURE_VELOCITY, "MPa m/s", _WHY_HEAT),
        ("flank pressure at the pitch point", pitch, MAX_FLANK_PRESSURE, "MPa", _WHY_PITS),
        ("root stress", root, MAX_ROOT_STRESS, "MPa", _WHY_ROOT),
    )
    return tuple(
        DesignCheck(
            name=name,
            value=value * 1e-6,
            unit=unit,
            allowed=f"up to {limit * 1e-6:.4g} {unit} {condition}",
            passed=value <= limit,
            reason=reason,
        )
        for name, value, limit, unit, reason in rows
    )


def bearing_pressure(
    gears: MeshedGears, bearing: tuple[float, float], pressure_difference: float
) -> float:
    """Radial load over projected area of both bearings of a gear. [Pa]."""
    (diameter, length), radius = bearing, max(tooth.tip_radius for tooth in gears.teeth)
    load = RADIAL_LOAD_COEFFICIENT * pressure_difference * gears.face_width * 2.0 * radius
    return float(load / (2.0 * diameter * length))


def contact_force(gears: MeshedGears, pressure_difference: float) -> float:
    """Mean force of the loaded flanks: the driven gear's half of the torque. [N]."""
    torque = pressure_difference * displacement(gears)
    return 0.5 * torque / (gears.mesh.ratio * abs(rigid_mesh(gears).lever))


def flank_pressure(gears: MeshedGears, materials: tuple[Material, Material], force: float) -> float:
    """Hertzian pressure of one contact at the pitch point. [Pa]."""
    drive_pitch, driven_pitch = gears.mesh.pitch_radii
    lever = abs(rigid_mesh(gears).lever)
    sine = np.sqrt(max(1.0 - (lever / driven_pitch) ** 2, 1e-4))
    radius = sine / (1.0 / drive_pitch + 1.0 / driven_pitch)
    modulus = reduced_modulus(*materials)
    return float(hertz_pressure(force / gears.face_width, radius, 0.5 * modulus))


def root_stress(gears: MeshedGears, profiles: Sequence[GearProfile], force: float) -> float:
    """Largest bending stress of a tooth that carries the force at its tip. [Pa]."""
    line_load, stresses = force / gears.face_width, []
    for profile in profiles:
        radii = np.linspace(profile.root_radius, profile.tip_radius, 80)[8:60]
        thickness = np.zeros(radii.size)
        for flank in (profile.right_flank, profile.left_flank):
            radius = np.hypot(*flank.T)
            order = np.argsort(radius)
            thickness += np.interp(radii, radius[order], np.abs(flank[order, 1]))
        arm = profile.tip_radius - radii
        stresses.append(float(np.max(6.0 * line_load * arm / thickness**2)))
    return max(stresses)


_WHY_LOAD = "The bearings carry the whole pressure force; too high a load wipes their lining."
_WHY_HEAT = "Load times sliding speed is the heat that the bearing film must carry away."
_WHY_PITS = "Repeated contact pressure above the endurance of the flanks breaks out pits."
_WHY_ROOT = "Every passage bends the tooth once; above the endurance limit it breaks at the root."
