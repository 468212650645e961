"""Numbers and verdicts of the geometry report."""

from __future__ import annotations

import numpy as np

from toothspace.gearing.meshing import flow_over_pitch
from toothspace.gearing.spaces import Spaces
from toothspace.geometry.design_rules import design_findings
from toothspace.geometry.gear_pair import flow_ripple
from toothspace.geometry.involute import tooth_form
from toothspace.geometry.mesh_clearance import normal_play
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.contacts import contact_ratio, displacement
from toothspace.machines.external_gear.profile_quality import (
    profile_checks,
    profile_quality,
    tooth_data,
    undercut_of,
)
from toothspace.machines.external_gear.strength import strength_checks
from toothspace.machines.external_gear.trapped_volumes import trapped_volumes
from toothspace.machines.external_gear.trapping import trapping_checks
from toothspace.model.description import DesignCheck


def geometry_summary(
    assembly: Assembly, spaces: tuple[Spaces, Spaces], checks: tuple[DesignCheck, ...]
) -> dict[str, object]:
    """Numbers of the geometry report.

    Parameters
    ----------
    assembly : Assembly
        Gears in mesh.
    spaces : tuple of Spaces
        Tooth spaces of both gears at the table nodes.
    checks : tuple of DesignCheck
        Design-rule report, whose failures are named.

    Returns
    -------
    dict
        Values by name; names carry their unit.
    """
    per_turn = displacement(assembly) * 2.0 * np.pi
    trapped, dead = trapped_volumes(assembly, spaces)
    return {
        **tooth_data(assembly),
        "displacement_cm3_per_rev": per_turn * 1e6,
        "contact_ratio": contact_ratio(assembly),
        "tip_land_mm": min(t.land_angle * t.tip_radius for t in assembly.teeth) * 1e3,
        "undercut": _undercut(assembly),
        "root_clearance_mm": min(root_clearances(assembly)) * 1e3,
        "center_distance_mm": assembly.mesh.center_distance * 1e3,
        "normal_backlash_mm": _backlash(assembly) * 1e3,
        "base_diameter_mm": _base_diameter(assembly),
        "operating_pressure_angle_deg": _pressure_angle(assembly),
        "flow_ripple_percent": 100.0 * _ripple(assembly),
        "trapped_volume_mm3": trapped * 1e9,
        "dead_volume_mm3": dead * 1e9,
        **profile_quality(assembly, trapped),
        "warnings": [
            f"{check.name}: {check.value:.4g} {check.unit}, allowed {check.allowed}"
            for check in checks
            if not check.passed
        ],
    }


def _backlash(assembly: Assembly) -> float:
    if assembly.pair is not None:
        return assembly.pair.normal_backlash
    return normal_play(assembly.profiles, assembly.mesh.center_distance)


def root_clearances(assembly: Assembly) -> tuple[float, float]:
    """Radial play of the mating tip in the roots of drive and driven gear. [m]."""
    (drive, driven), distance = assembly.profiles, assembly.mesh.center_distance
    return (
        distance - drive.root_radius - driven.tip_radius,
        distance - driven.root_radius - drive.tip_radius,
    )


def design_checks(assembly: Assembly) -> tuple[DesignCheck, ...]:
    """Design-rule report: geometry, and at a running-in condition trapping and strength."""
    return (
        *_geometry_checks(assembly),
        *trapping_checks(assembly),
        *strength_checks(assembly),
    )


def _geometry_checks(assembly: Assembly) -> tuple[DesignCheck, ...]:
    if assembly.pair is not None:
        vented = assembly.spec.grooves is not None
        findings = design_findings(assembly.pair, assembly.face_width, vented=vented)
        return tuple(
            DesignCheck(f.name, f.value, f.unit, f.allowed, f.passed, f.reason) for f in findings
        )
    ratio = contact_ratio(assembly)
    clearance = min(root_clearances(assembly))
    return (
        DesignCheck(
            "contact ratio", ratio, "1", "1.05 to 2", 1.05 <= ratio <= 2.0,
            "Below 1 the drive is handed over with a shock and the outlet opens to the inlet "
            "through the mesh.",
        ),
        DesignCheck(
            "root clearance", clearance * 1e3, "mm", "above 0 mm", clearance > 0.0,
            "Bearing play moves the gears together, so the mating tip needs room in the root.",
        ),
        *profile_checks(assembly),
    )  # fmt: skip


def _ripple(assembly: Assembly) -> float:
    if assembly.pair is not None:
        return flow_ripple(assembly.pair)
    flow = flow_over_pitch(assembly)
    return float((flow.max() - flow.min()) / flow.mean())


def _undercut(assembly: Assembly) -> bool:
    if assembly.pair is None:
        return any(undercut_of(gear) for gear in (assembly.spec.drive, assembly.spec.driven))
    return any(tooth_form(gear).undercut for gear in (assembly.pair.drive, assembly.pair.driven))


def _base_diameter(assembly: Assembly) -> float | None:
    base = assembly.profiles[0].base_radius
    return None if base is None else 2e3 * base


def _pressure_angle(assembly: Assembly) -> float | None:
    bases = [profile.base_radius for profile in assembly.profiles]
    if bases[0] is None or bases[1] is None:
        return None
    return float(np.rad2deg(np.arccos((bases[0] + bases[1]) / assembly.mesh.center_distance)))
