"""Numbers and verdicts of the geometry report of gerotors."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from toothspace.advice.gear_rules import bearing_checks
from toothspace.core.finding import DesignCheck, warnings_of
from toothspace.core.types import Array
from toothspace.machines.gerotor.flow_paths import shaft_radius
from toothspace.machines.gerotor.lobe_pairs import contact_ratio
from toothspace.machines.gerotor.parameters import GerotorParameters
from toothspace.machines.gerotor.pockets import Pockets
from toothspace.machines.gerotor.ports import Ports, Timing, kinematic_lands
from toothspace.machines.gerotor.profiles import trochoid_of
from toothspace.model.description import ContactPair, LumpedJournalBearing

_LEAST_EDGE = 0.5e-3
_LEAST_LAND = 0.5
_THICKEST_RIM = 6.0
_LARGEST_RIPPLE = 0.10
_LARGEST_JOINED_AREA = 0.2e-6
_LARGEST_TRAPPED_SHARE = 0.01


def ideal_flow(pocket: Pockets) -> Array:
    """Section area delivered per shaft radian over one turn of the outer rotor: rising pockets."""
    step, count = 2 * pocket.half_pitch_nodes, pocket.rotors.outer_tooth_count
    shifted = [np.roll(pocket.area_rate, k * step) for k in range(count)]
    return np.asarray(np.sum(np.maximum(shifted, 0.0), axis=0), dtype=float)


def flow_ripple(pocket: Pockets) -> float:
    """Highest less lowest kinematic flow over its mean. [-]."""
    flow = ideal_flow(pocket)
    return float(np.ptp(flow) / np.mean(flow))


def geometry_summary(
    parameters: GerotorParameters,
    pocket: Pockets,
    timing: Timing,
    contacts: tuple[ContactPair, ...],
    checks: Sequence[DesignCheck],
) -> dict[str, object]:
    """Numbers of the geometry report.

    Values by name; names carry their unit.

    Parameters
    ----------
    contacts : tuple of ContactPair
        Contacts of the lobes.
    checks : sequence of DesignCheck
        Design-rule report, whose failures are named.
    """
    width, rotors = parameters.rotors.face_width, pocket.rotors
    inner, outer = np.hypot(*rotors.inner.T) * 1e3, np.hypot(*rotors.outer.T) * 1e3
    lands = np.rad2deg(kinematic_lands(pocket))
    return {
        "displacement_cm3_per_rev": pocket.area_per_radian * width * 2e6 * np.pi,
        "face_width_mm": width * 1e3,
        "max_pocket_volume_mm3": float(pocket.area.max()) * width * 1e9,
        "min_pocket_volume_mm3": float(pocket.area.min()) * width * 1e9,
        "no_undercut_limit_mm": trochoid_of(parameters.rotors).no_undercut_limit * 1e3
        if parameters.rotors.kind == "trochoidal"
        else None,
        "flow_ripple_percent": 100.0 * flow_ripple(pocket),
        "eccentricity_mm": rotors.eccentricity * 1e3,
        "inner_tip_diameter_mm": 2.0 * float(inner.max()),
        "inner_root_diameter_mm": 2.0 * float(inner.min()),
        "outer_tip_diameter_mm": 2.0 * float(outer.min()),
        "outer_root_diameter_mm": 2.0 * float(outer.max()),
        "smallest_relative_radius_mm": float(pocket.path.relative_radius.min()) * 1e3,
        "kinematic_land_max_half_angle_deg": float(lands[0]),
        "kinematic_land_min_half_angle_deg": float(lands[1]),
        "smallest_tip_gap_um": float(pocket.path.gap.min()) * 1e6,
        "trapped_volume_mm3": timing.trapped_area(pocket) * width * 1e9,
        "sealed_shaft_angle_deg": float(np.rad2deg(timing.sealed_angle(pocket))),
        "contact_ratio": contact_ratio(contacts, float(np.median(pocket.path.gap))),
        "warnings": warnings_of(checks),
    }


def design_checks(
    parameters: GerotorParameters,
    pocket: Pockets,
    timing: Timing,
    ports: Ports,
    journals: Sequence[LumpedJournalBearing],
) -> tuple[DesignCheck, ...]:
    """Design-rule report of a gerotor set: profiles, rim, ports, timing, bearings."""
    return (
        *_undercut_check(parameters),
        *_common_checks(parameters, pocket),
        *_land_checks(parameters, pocket, ports),
        *_timing_checks(pocket, timing),
        *bearing_checks(journals),
    )


def _land_checks(
    parameters: GerotorParameters, pocket: Pockets, ports: Ports
) -> tuple[DesignCheck, ...]:
    """Lands that the kidneys leave on the faces, over those between pockets and rim or shaft."""
    radii = np.hypot(*np.vstack(list(ports.contours.values())).T)
    rim = 0.5 * parameters.housing.outer_rotor_diameter
    floor = float(np.hypot(*pocket.rotors.outer.T).max())
    root = float(np.hypot(*pocket.rotors.inner.T).min())
    shaft = shaft_radius(parameters, pocket)
    shares = {
        "rim": (rim - float(radii.max())) / (rim - floor),
        "shaft": (float(radii.min()) - shaft) / (root - shaft),
    }
    return tuple(
        DesignCheck(
            f"land beside the kidneys to the {name}", 100.0 * share, "%",
            f"above {100.0 * _LEAST_LAND:g} % of that beside the pockets", share > _LEAST_LAND,
            "The land seals the port; leakage is found with the land that the pockets leave.",
        )
        for name, share in shares.items()
    )  # fmt: skip


def _timing_checks(pocket: Pockets, timing: Timing) -> tuple[DesignCheck, ...]:
    joined = timing.joined_area
    trapped = timing.trapped_area(pocket) / float(pocket.area.max())
    return (
        DesignCheck(
            "area that joins both ports through a pocket", joined * 1e6, "mm2", "below 0.2 mm2",
            joined < _LARGEST_JOINED_AREA,
            "A pocket open to both ports is a cross-port leakage: widen the lands.",
        ),
        DesignCheck(
            "volume change of a sealed pocket over the largest pocket", 100.0 * trapped, "%",
            "below 1 %", trapped < _LARGEST_TRAPPED_SHARE,
            "Fluid squeezed or stretched in a sealed pocket makes pressure peaks or cavitation: "
            "let the ports reach all over the pockets.",
        ),
    )  # fmt: skip


def _undercut_check(parameters: GerotorParameters) -> tuple[DesignCheck, ...]:
    if parameters.rotors.kind != "trochoidal":
        return ()
    design = trochoid_of(parameters.rotors)
    limit = design.no_undercut_limit
    return (
        DesignCheck(
            "lobe radius over its no-undercut limit", design.lobe_radius / limit, "1",
            "below 0.95", design.lobe_radius < 0.95 * limit,
            "Near the limit the inner tips become edges that wear and cannot carry load.",
        ),
        DesignCheck(
            "lobe radius over half the lobe distance",
            design.lobe_radius / design.closure_limit, "1", "below 0.95",
            design.lobe_radius < 0.95 * design.closure_limit,
            "Neighbouring lobes that nearly touch leave no room for the inner teeth.",
        ),
    )  # fmt: skip


def _common_checks(parameters: GerotorParameters, pocket: Pockets) -> tuple[DesignCheck, ...]:
    rotors = pocket.rotors
    rim = 0.5 * parameters.housing.outer_rotor_diameter - np.hypot(*rotors.outer.T).max()
    height = float(np.ptp(np.hypot(*rotors.outer.T)))
    edge = float(1.0 / np.maximum(pocket.path.inner_curvature, 1e-3).max())
    ripple = flow_ripple(pocket)
    trapped = float(pocket.area.min() / pocket.area.max())
    gap_share = float(np.median(pocket.path.gap)) / rotors.eccentricity
    checks = [
        DesignCheck(
            "rim of the outer rotor over the lobe height", float(rim) / height, "1",
            f"0.6 to {_THICKEST_RIM:g}", bool(0.6 * height < rim < _THICKEST_RIM * height),
            "A thin rim breathes with the pressure and opens the tip gaps; a thick one adds "
            "friction with its radius cubed.",
        ),
        DesignCheck(
            "flow ripple", 100.0 * ripple, "%", "below 10 %", ripple < _LARGEST_RIPPLE,
            "Flow ripple excites pressure ripple in the line.",
        ),
        DesignCheck(
            "smallest pocket over the largest", 100.0 * trapped, "%", "below 5 %", trapped < 0.05,
            "Fluid left in the smallest pocket carries its compression back to the inlet.",
        ),
        DesignCheck(
            "tip gap over the eccentricity", 100.0 * gap_share, "%", "below 4 %",
            gap_share < 0.04,
            "Tip leakage grows with the power 2.5 of the gap.",
        ),
    ]  # fmt: skip
    if parameters.rotors.kind != "cycloidal":
        checks.append(
            DesignCheck(
                "smallest convex radius of the inner rotor", edge * 1e3, "mm", "above 0.5 mm",
                edge > _LEAST_EDGE,
                "Small radii raise the contact pressure and chip in sintered steel.",
            )
        )  # fmt: skip
    return tuple(checks)
