"""Numbers and verdicts of the geometry report."""

from __future__ import annotations

import numpy as np

from toothspace.core.design_check import DesignCheck, warnings_of
from toothspace.gearing.meshing import contact_ratio, displacement, flow_ripple
from toothspace.gearing.spaces import Spaces
from toothspace.geometry.design_rules import contact_ratio_check, pair_checks
from toothspace.geometry.mesh_clearance import normal_play
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.profile_quality import (
    profile_checks,
    profile_quality,
    tooth_data,
    trapped_volumes,
    undercut_of,
)
from toothspace.machines.external_gear.strength import strength_checks
from toothspace.machines.external_gear.trapping import trapping_checks

DEEPEST_CUT = 0.127e-3
"""Deepest track of the gears in a casing that is still used (Parker, 0.005 inch). [m]"""


def geometry_summary(
    assembly: Assembly, spaces: tuple[Spaces, Spaces], checks: tuple[DesignCheck, ...]
) -> dict[str, object]:
    """Numbers of the geometry report.

    Parameters
    ----------
    checks : tuple of DesignCheck
        Design-rule report, whose failures are named.

    Returns
    -------
    dict
        Values by name; names carry their unit.
    """
    pair, distance = assembly.pair, assembly.mesh.center_distance
    if pair is None:
        backlash = normal_play(assembly.profiles, distance)
        undercut = any(undercut_of(gear) for gear in (assembly.spec.drive, assembly.spec.driven))
    else:
        backlash, undercut = pair.normal_backlash, any(form.undercut for form in pair.forms)
    first, second = (profile.base_radius for profile in assembly.profiles)
    angle = np.arccos((first + second) / distance) if first and second else None
    trapped, dead = trapped_volumes(assembly, spaces)
    return {
        **tooth_data(assembly),
        "displacement_cm3_per_rev": displacement(assembly) * 2e6 * np.pi,
        "contact_ratio": contact_ratio(assembly),
        "tip_land_mm": min(assembly.tip_lands) * 1e3,
        "undercut": undercut,
        "root_clearance_mm": min(assembly.root_clearances) * 1e3,
        "center_distance_mm": distance * 1e3,
        "normal_backlash_mm": backlash * 1e3,
        "base_diameter_mm": None if first is None else 2e3 * first,
        "operating_pressure_angle_deg": None if angle is None else float(np.rad2deg(angle)),
        "flow_ripple_percent": 100.0 * flow_ripple(assembly),
        "trapped_volume_mm3": trapped * 1e9,
        "dead_volume_mm3": dead * 1e9,
        **profile_quality(assembly),
        "warnings": warnings_of(checks),
    }


def design_checks(assembly: Assembly) -> tuple[DesignCheck, ...]:
    """Design-rule report: geometry, and at a running-in condition trapping and strength."""
    loaded = (casing_cut_check(assembly), *trapping_checks(assembly), *strength_checks(assembly))
    if assembly.pair is not None:
        vented = assembly.spec.grooves is not None
        return (*pair_checks(assembly.pair, assembly.face_width, vented=vented), *loaded)
    clearance = min(assembly.root_clearances)
    return (
        contact_ratio_check(contact_ratio(assembly)),
        DesignCheck(
            "root clearance", clearance * 1e3, "mm", "above 0 mm", clearance > 0.0,
            "Bearing play moves the gears together, so the mating tip needs room in the root.",
        ),
        *profile_checks(assembly),
        *loaded,
    )  # fmt: skip


def casing_cut_check(assembly: Assembly) -> DesignCheck:
    """Check of how deep the gears can cut into the casing as far as bearings and blocks let them.

    References
    ----------
    .. [1] Parker Hannifin, Gear Pump Division, service manual of series PGP030 and PGP031,
       guidelines for acceptable wear: replace housings with a cut-out above 0.005 inch.
    """
    keys = assembly.spec.keys
    blocks = 0.0 if keys.bearing_blocks is None else keys.bearing_blocks.radial_clearance
    reach = keys.journal_bearings.radial_clearance + blocks
    cut = max(reach - keys.casing.radial_clearance, 0.0)
    return DesignCheck(
        "cut into the casing", cut * 1e6, "um", f"up to {DEEPEST_CUT * 1e6:g} um",
        cut <= DEEPEST_CUT,
        "Pressure moves the gears through the clearance of bearings and blocks; a deep track "
        "weakens the casing, fills the oil with chips and opens the gap on the other side.",
    )  # fmt: skip
