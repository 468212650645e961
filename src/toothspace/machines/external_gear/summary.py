"""Numbers of the geometry report."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from toothspace.core.design_check import DesignCheck, warnings_of
from toothspace.gearing.meshing import contact_ratio, displacement, flow_ripple
from toothspace.gearing.spaces import Spaces
from toothspace.geometry.gear_pair import normal_play
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.profile_quality import (
    profile_quality,
    tooth_data,
    trapped_volumes,
    undercut_of,
)


def geometry_summary(
    assembly: Assembly, spaces: tuple[Spaces, Spaces], checks: Sequence[DesignCheck]
) -> dict[str, object]:
    """Numbers of the geometry report.

    Parameters
    ----------
    checks : sequence of DesignCheck
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
