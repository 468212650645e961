"""Loads of bearings and teeth at the running-in condition, against guide values."""

from __future__ import annotations

import numpy as np

from toothspace.closures.contact_cylindrical import hertz_pressure
from toothspace.gearing.flank_contacts import rigid_mesh
from toothspace.gearing.materials import reduced_modulus
from toothspace.gearing.meshing import displacement
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.trapping import design_condition
from toothspace.model.description import DesignCheck

RADIAL_LOAD_COEFFICIENT = 0.85
"""Radial load of the driven gear over pressure x width x tip diameter (Ivantysyn). [-]"""

MAX_BEARING_PRESSURE = 20e6
MAX_BEARING_PRESSURE_VELOCITY = 100e6
MAX_FLANK_PRESSURE = 1500e6
MAX_ROOT_STRESS = 430e6


def strength_checks(assembly: Assembly) -> tuple[DesignCheck, ...]:
    r"""Bearing load, p v, flank and root stress at the pressure and speed of running-in.

    Returns
    -------
    tuple of DesignCheck
        Empty without a running-in condition.

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
    if assembly.spec.keys.casing.wear_in is None:
        return ()
    condition = design_condition(assembly)
    difference = condition.pressure_difference
    load = bearing_pressure(assembly, difference)
    sliding = assembly.spec.shaft_radius * condition.shaft_speed
    force = contact_force(assembly, difference)
    heat, pitch = load * sliding, flank_pressure(assembly, force)
    rows = (
        ("bearing specific load", load, MAX_BEARING_PRESSURE, "MPa", _WHY_LOAD),
        ("bearing p v, lubricated", heat, MAX_BEARING_PRESSURE_VELOCITY, "MPa m/s", _WHY_HEAT),
        ("flank pressure at the pitch point", pitch, MAX_FLANK_PRESSURE, "MPa", _WHY_PITS),
        ("root stress", root_stress(assembly, force), MAX_ROOT_STRESS, "MPa", _WHY_ROOT),
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


def bearing_pressure(assembly: Assembly, pressure_difference: float) -> float:
    """Radial load over projected area of both bearings of a gear. [Pa]."""
    bearing = assembly.spec.keys.journal_bearings
    radius = max(tooth.tip_radius for tooth in assembly.teeth)
    load = RADIAL_LOAD_COEFFICIENT * pressure_difference * assembly.face_width * 2.0 * radius
    return float(load / (2.0 * bearing.diameter * bearing.length))


def contact_force(assembly: Assembly, pressure_difference: float) -> float:
    """Mean force of the loaded flanks: the driven gear's half of the torque. [N]."""
    torque = pressure_difference * displacement(assembly)
    return 0.5 * torque / (assembly.mesh.ratio * abs(rigid_mesh(assembly).lever))


def flank_pressure(assembly: Assembly, force: float) -> float:
    """Hertzian pressure of one contact at the pitch point. [Pa]."""
    spec = assembly.spec
    drive_pitch, driven_pitch = assembly.mesh.pitch_radii
    lever = abs(rigid_mesh(assembly).lever)
    sine = np.sqrt(max(1.0 - (lever / driven_pitch) ** 2, 1e-4))
    radius = sine / (1.0 / drive_pitch + 1.0 / driven_pitch)
    modulus = reduced_modulus(spec.drive.material, spec.driven.material)
    return float(hertz_pressure(force / assembly.face_width, radius, 0.5 * modulus))


def root_stress(assembly: Assembly, force: float) -> float:
    """Largest bending stress of a tooth that carries the force at its tip. [Pa]."""
    line_load, stresses = force / assembly.face_width, []
    for profile in assembly.profiles:
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
