"""Numbers and verdicts of the geometry report."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from toothspace.advice import gear_rules as rules
from toothspace.advice.gear_rules import bearing_checks
from toothspace.advice.trapping import opening_checks
from toothspace.core.finding import DesignCheck, warnings_of
from toothspace.gearing.meshing import contact_ratio, displacement, flow_over_pitch, flow_ripple
from toothspace.gearing.ring_gear import InternalPair
from toothspace.gearing.spaces import Spaces, section_areas
from toothspace.geometry.curve import turned
from toothspace.geometry.involute import involute_function
from toothspace.machines.crescent.assembly import CrescentAssembly, filler_edges, filler_thickness
from toothspace.model.description import ChamberFamily, FlowPath, LumpedJournalBearing

_LEAST_ROOT_CLEARANCE = 0.05
_LARGEST_CONTACT_RATIO = 2.5
_LEAST_FILLER = 0.2e-3
_TRIMMING_STEPS = 24
_OVERLAP = 1e-10
_ANGLES = 6


def geometry_summary(
    assembly: CrescentAssembly, spaces: tuple[Spaces, Spaces], checks: Sequence[DesignCheck]
) -> dict[str, object]:
    """Numbers of the geometry report, names with their unit."""
    pair = assembly.pair
    sealed = [sealed_teeth(assembly, gear) for gear in (0, 1)]
    dead = assembly.face_width * sum(float(section_areas(s).min()) for s in spaces)
    angle = None if pair is None else float(np.rad2deg(pair.operating_pressure_angle))
    helix = assembly.helix
    ripple = flow_ripple(assembly) if helix is None else helix.ripple(flow_over_pitch(assembly))
    return {
        "displacement_cm3_per_rev": displacement(assembly) * 2.0 * np.pi * 1e6,
        "face_width_mm": assembly.face_width * 1e3,
        "contact_ratio": contact_ratio(assembly),
        "center_distance_mm": -assembly.mesh.center_distance * 1e3,
        "operating_pressure_angle_deg": angle,
        "flow_ripple_percent": 100.0 * ripple,
        "tip_land_mm": min(assembly.tip_lands) * 1e3,
        "root_clearance_mm": min(assembly.root_clearances) * 1e3,
        "filler_thickness_mm": filler_thickness(assembly) * 1e3,
        "sealed_pinion_teeth": sealed[0],
        "sealed_ring_teeth": sealed[1],
        "smallest_chamber_volumes_mm3": dead * 1e9,
        **({} if helix is None else helix.numbers(contact_ratio(assembly))),
        "warnings": warnings_of(checks),
    }


def sealed_teeth(assembly: CrescentAssembly, gear: int) -> float:
    """Mean number of teeth of a gear that seal at the filler beside its notch. [-].

    Along a helix those that seal over the whole width.
    """
    helix = assembly.helix
    lost = 0.0 if helix is None else helix.overlap_ratio
    notch, tooth = assembly.spec.filler.notch, assembly.teeth[gear]
    open_end = 0.0 if notch is None else notch.length / abs(tooth.tip_radius)
    span = filler_edges(assembly, gear).span - open_end - abs(tooth.land_angle)
    return max(span * assembly.counts[gear] / (2.0 * np.pi) - lost, 0.0)


def tip_clearance(pair: InternalPair) -> float:
    r"""Arc by which the tips of pinion and ring miss each other where their circles cross. [m].

    Negative where the teeth foul outside the path of contact (tip interference).

    Notes
    -----
    .. math:: r_{a1}\left[\theta_1 + \mathrm{inv}\,\alpha_{a1} - \mathrm{inv}\,\alpha_w
        - \frac{z_2}{z_1}(\theta_2 + \mathrm{inv}\,\alpha_{a2} - \mathrm{inv}\,\alpha_w)\right]

    with the polar angles :math:`\theta` of the crossing from both centres.

    References
    ----------
    .. [1] J. R. Colbourne, The Geometry of Involute Gears, Springer 1987, chapter 8.
    """
    first, second = pair.pinion.tip_radius, pair.ring.tip_radius
    distance, squares = pair.center_distance, second**2 - first**2
    theta_1 = np.arccos((squares - pair.center_distance**2) / (2.0 * distance * first))
    theta_2 = np.arccos((squares + pair.center_distance**2) / (2.0 * distance * second))
    operating = involute_function(pair.operating_pressure_angle)
    tip_1 = involute_function(np.arccos(pair.pinion.base_radius / first))
    tip_2 = involute_function(np.arccos(pair.ring.base_radius / second))
    lead = theta_1 + tip_1 - operating - (theta_2 + tip_2 - operating) / pair.speed_ratio
    return float(first * lead)


def trimming_distance(assembly: CrescentAssembly) -> float:
    """Part of the way along the centre line on which the pinion fouls the ring. [m].

    Where it is not zero, the pinion cannot be slid radially into the ring.
    """
    pinion = _pinion(assembly, 0.0)
    ring = assembly.ring_curve
    steps = np.linspace(0.0, 1.0, _TRIMMING_STEPS, endpoint=False) * assembly.mesh.center_distance
    fouls = 0
    for rise in steps:
        bore = shapely.Polygon(ring + np.array([0.0, rise]))
        fouls += int(pinion.difference(bore).area > _OVERLAP)
    return fouls / _TRIMMING_STEPS * -assembly.mesh.center_distance


def overlap(assembly: CrescentAssembly) -> float:
    """Largest area in which the teeth overlap while they turn through a pitch. [m2]."""
    found = []
    for angle in 2.0 * assembly.mesh.half_pitch * np.arange(_ANGLES) / _ANGLES:
        turn = assembly.ratio * angle + assembly.mesh.turn
        bore = shapely.Polygon(turned(assembly.ring_curve, turn) + assembly.ring_center)
        found.append(float(_pinion(assembly, angle).difference(bore).area))
    return max(found)


def _pinion(assembly: CrescentAssembly, angle: float) -> shapely.Polygon:
    start = 0.5 * np.pi + assembly.mesh.half_pitch
    return shapely.Polygon(assembly.pinion.closed_polygon(start + angle))


def closing_play(assembly: CrescentAssembly) -> float:
    """Part of the backlash that the play of both bearings closes. [m].

    The pressure lifts the ring of a pump off the pinion and presses that of a motor onto it, along
    the centre line; twice the sine of a working angle near 30 degrees is 1.
    """
    spec = assembly.spec
    play = spec.journal_bearings.radial_clearance + spec.ring.radial_clearance
    return play if spec.mode == "motor" else 0.0


def design_checks(
    assembly: CrescentAssembly,
    families: Sequence[ChamberFamily],
    paths: Sequence[FlowPath],
    journals: Sequence[LumpedJournalBearing],
) -> tuple[DesignCheck, ...]:
    """Design-rule report of gears, filler, cross-port leakage and bearings."""
    fouled, owners = overlap(assembly), ("pinion", "ring")
    module = 2.0 * assembly.mesh.half_pitch * assembly.mesh.pitch_radii[0] / np.pi
    checks = [
        rules.contact_ratio_check(contact_ratio(assembly), _LARGEST_CONTACT_RATIO),
        DesignCheck(
            "overlap of the teeth", fouled * 1e6, "mm2", "0 mm2", fouled <= _OVERLAP,
            "Teeth that overlap anywhere in a pitch cannot turn.",
        ),
    ]  # fmt: skip
    for owner, clearance in zip(owners, assembly.root_clearances, strict=True):
        checks.append(rules.root_clearance_check(owner, clearance, module, _LEAST_ROOT_CLEARANCE))
    for owner, land in zip(owners, assembly.tip_lands, strict=True):
        checks.append(rules.tip_land_check(owner, land, module))
    return (
        *checks,
        *_involute_checks(assembly),
        *_filler_checks(assembly),
        *opening_checks(families, paths, displacement(assembly), closing_play(assembly)),
        *bearing_checks(journals, min(assembly.root_clearances)),
    )


def _involute_checks(assembly: CrescentAssembly) -> list[DesignCheck]:
    pair = assembly.pair
    if pair is None:
        return []
    tip, trimmed, backlash = tip_clearance(pair), trimming_distance(assembly), pair.normal_backlash
    if assembly.helix is not None:
        backlash *= float(np.cos(assembly.helix.base_angle))
    first, second = pair.involute_margins
    # where both contacts stand alike about the pitch point, neither side may be reached
    sealed = 0.5 * pair.base_pitch * np.cos(pair.operating_pressure_angle)
    least = float(np.arcsin(sealed / assembly.pinion.root_radius))
    latest, ports = least + assembly.mesh.half_pitch, assembly.spec.ports
    return [
        *[
        DesignCheck(
            f"begin of the recess, {side}", float(np.rad2deg(start)), "deg",
            f"{np.rad2deg(least):.3g} to {np.rad2deg(latest):.3g} deg, half a pitch later",
            least <= start <= latest,
            "Nearer to the mesh the recess joins outlet and inlet; later the spaces that leave the "
            "mesh fill through the relief grooves alone, and cavitate.",
        )
        for side, start in (("inlet", ports.inlet_start), ("outlet", ports.outlet_start))
    ],
        rules.interference_check("pinion", first),
        rules.interference_check("ring", second),
        rules.undercut_check("pinion", pair.pinion, pair.pinion_form),
        DesignCheck(
            "tip clearance in passing", tip * 1e3, "mm", "above 0 mm", tip > 0.0,
            "Where the tip circles cross, the tips of both gears pass each other; with few teeth "
            "between them they foul.",
        ),
        DesignCheck(
            "trimming", trimmed * 1e3, "mm", "0 mm of fouling on the way in", trimmed == 0.0,
            "A pinion that fouls on the way cannot be slid radially into the ring; it must be "
            "pushed in along the axis.",
        ),
        DesignCheck(
            "normal backlash", backlash * 1e3, "mm", "above 0 mm", backlash > 0.0,
            "Without backlash thermal growth jams the flanks.",
        ),
    ]  # fmt: skip


def _filler_checks(assembly: CrescentAssembly) -> list[DesignCheck]:
    spec = assembly.spec
    thickness = filler_thickness(assembly)
    checks = [
        DesignCheck(
            "filler thickness", thickness * 1e3, "mm", f"at least {_LEAST_FILLER * 1e3:g} mm",
            thickness >= _LEAST_FILLER,
            "The ends of the crescent taper; a thin one bends into the gears.",
        )
    ]  # fmt: skip
    plays = spec.journal_bearings.radial_clearance, spec.ring.radial_clearance
    gaps = spec.filler.pinion_clearance, spec.filler.ring_clearance
    for gear, name in enumerate(("pinion", "ring")):
        sealed = sealed_teeth(assembly, gear)
        checks.append(
            DesignCheck(
                f"teeth at the filler, {name}", sealed, "1", "at least 1", sealed >= 1.0,
                "One tooth at least must seal at any time, or inlet and outlet are joined.",
            )
        )  # fmt: skip
        if spec.filler.compensation == "none":
            checks.append(
                DesignCheck(
                    f"tip clearance to the filler, {name}", gaps[gear] * 1e6, "um",
                    f"above the bearing play of {plays[gear] * 1e6:.4g} um",
                    gaps[gear] > plays[gear],
                    "A gear that moves through its bearing play must not cut the filler.",
                )
            )  # fmt: skip
    return checks
