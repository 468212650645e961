"""Design rules of involute gears, of their strength and of bearings, each with its reason."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from toothspace.advice.trapping import DesignCondition
from toothspace.closures.contact_cylindrical import hertz_pressure
from toothspace.core.finding import DesignCheck
from toothspace.gearing.flank_contacts import rigid_mesh
from toothspace.gearing.materials import Material, reduced_modulus
from toothspace.gearing.meshing import MeshedGears, displacement
from toothspace.geometry.gear_pair import GearPair, trapped_volume_change
from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.involute import InvoluteGear, ToothForm
from toothspace.geometry.involute_gear import Real
from toothspace.model.description import LumpedJournalBearing

MIN_CONTACT_RATIO = 1.05
MAX_SPUR_CONTACT_RATIO = 2.0
MIN_TIP_LAND = 0.2
MIN_ROOT_CLEARANCE = 0.1
MAX_BACKLASH = 0.1
VENTED_SHARE = 0.5
MAX_CONTINUOUS_BACKLASH = 0.005
"""Backlash of gears of continuous contact, whose flanks seal in turn. [modules]"""
MIN_CURVATURE = 0.3
"""Smallest radius of curvature of their flanks. [modules]"""
OVERLAP_TOLERANCE = 0.05
"""How far their overlap may be from a multiple of half a pitch. [-]"""
ENCLOSED_SHARE = 0.002
"""Largest change of the enclosed volume over face width and square of the module. [-]

The volume itself is some two: a thousandth of it compressed raises the pressure of oil by 16 bar.
"""
RELATIVE_CLEARANCE = 0.3e-3, 5e-3
"""Least and largest radial clearance of a bearing over its radius. [-]"""
RADIAL_LOAD_COEFFICIENT = 0.85
"""Radial load of the driven gear over pressure x width x tip diameter (Ivantysyn). [-]"""
MAX_BEARING_PRESSURE = 20e6
MAX_BEARING_PRESSURE_VELOCITY = 100e6
MAX_FLANK_PRESSURE = 1500e6
MAX_ROOT_STRESS = 430e6
STRENGTH_LIMITS = (
    MAX_BEARING_PRESSURE,
    MAX_BEARING_PRESSURE_VELOCITY,
    MAX_FLANK_PRESSURE,
    MAX_ROOT_STRESS,
)
"""Of bearing load, bearing p v, flank pressure and root stress. [Pa], [Pa m/s]"""
DEEPEST_CUT = 0.127e-3
"""Deepest track of the gears in a casing that is still used (Parker, 0.005 inch). [m]"""
_WHY_LOAD = "The bearings carry the whole pressure force; too high a load wipes their lining."
_WHY_HEAT = "Load times sliding speed is the heat that the bearing film must carry away."
_WHY_PITS = "Repeated contact pressure above the endurance of the flanks breaks out pits."
_WHY_ROOT = "Every passage bends the tooth once; above the endurance limit it breaks at the root."
TOOL_MODULES = (
    0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5, 2.75, 3.0, 3.25, 3.5, 3.75, 4.0,
    4.5, 5.0, 5.5, 6.0, 7.0, 8.0, 9.0, 10.0, 12.0, 14.0, 16.0, 20.0,
)  # fmt: skip
"""Modules of which there are tools. [mm]"""


def overlap_from_whole(overlap: float) -> float:
    """How far an overlap ratio is from the nearest multiple of a half, which is not zero. [-]."""
    return abs(overlap - max(round(2.0 * overlap), 1) / 2.0)


def pair_checks(
    pair: GearPair, face_width: float, *, vented: bool = True
) -> tuple[DesignCheck, ...]:
    """Geometric design rules of a gear pair.

    Contact ratio, tip land, undercut, interference, root clearance, backlash, trapped volume.

    Parameters
    ----------
    face_width : float
        Tooth length. [m]
    vented : bool
        Whether relief grooves join the volume between two contacts to the ports.
    """
    gears = (("drive gear", pair.drive), ("driven gear", pair.driven))
    checks = [contact_ratio_check(pair.contact_ratio)]
    for index, (owner, gear) in enumerate(gears):
        form, margin = pair.forms[index], pair.involute_margins[index]
        land = form.tip_land_angle * gear.tip_radius
        checks += [
            tip_land_check(owner, land, gear.module),
            undercut_check(owner, gear, form),
            interference_check(owner, margin, allowed=form.undercut),
            root_clearance_check(owner, pair.root_clearances[index], gear.module),
        ]
    change = trapped_volume_change(pair, face_width)
    share = VENTED_SHARE if vented else ENCLOSED_SHARE
    spacing = f"vented by relief grooves at most {pair.relief_groove_spacing * 1e3:.4g} mm apart"
    return (
        *checks,
        backlash_check(pair.normal_backlash, pair.drive.module, pair.center_distance),
        DesignCheck(
            name="trapped volume change",
            value=change * 1e9,
            unit="mm3",
            allowed=f"below {share:g} face_width module^2, "
            + (spacing if vented else f"without relief grooves; below {VENTED_SHARE:g} {spacing}"),
            passed=change <= share * face_width * pair.drive.module**2,
            reason="Fluid enclosed between two contacts is squeezed and stretched; unless grooves "
            "vent it, pressure peaks load the bearings and then cavitation erodes the flanks.",
        ),
    )


def backlash_check(backlash: float, module: float, center_distance: float) -> DesignCheck:
    """Check of the normal backlash at a module and a distance of the centres. [m]."""
    least, most = least_normal_backlash(module, center_distance), MAX_BACKLASH * module
    return DesignCheck(
        name="normal backlash",
        value=backlash * 1e3,
        unit="mm",
        allowed=f"{least * 1e3:.3g} mm (ISO/TR 10064-2) to {most * 1e3:.3g} mm "
        f"({MAX_BACKLASH:g} modules)",
        passed=least <= backlash <= most,
        reason="Less lets thermal growth and bearing play jam the flanks and throttles trapped "
        "fluid between them; a wide one rattles and lets both sides of the mesh leak into each "
        "other.",
    )


def contact_ratio_check(ratio: float, largest: float = MAX_SPUR_CONTACT_RATIO) -> DesignCheck:
    """Check of the mean number of tooth pairs in contact. [-]."""
    return DesignCheck(
        name="contact ratio",
        value=ratio,
        unit="1",
        allowed=f"{MIN_CONTACT_RATIO:g} to {largest:g}",
        passed=MIN_CONTACT_RATIO <= ratio <= largest,
        reason="Below 1 the drive is handed over with a shock and the outlet opens to the inlet "
        "through the mesh; a high ratio traps more fluid.",
    )


def tip_land_check(owner: str, land: float, module: float) -> DesignCheck:
    """Check of the width of a tip land. [m]."""
    return DesignCheck(
        name=f"tip land, {owner}",
        value=land * 1e3,
        unit="mm",
        allowed=f"at least {MIN_TIP_LAND * module * 1e3:.3g} mm ({MIN_TIP_LAND:g} modules)",
        passed=land >= MIN_TIP_LAND * module,
        reason="The land is the seal between neighbouring tooth spaces and meets the wall round "
        "them; a thin, hardened tip chips.",
    )


def undercut_check(owner: str, gear: InvoluteGear, form: ToothForm) -> DesignCheck:
    """Check that the tool leaves the involute whole."""
    return DesignCheck(
        name=f"undercut, {owner}",
        value=form.undercut_depth * 1e3,
        unit="mm",
        allowed=f"0 mm (profile shift at least {gear.smallest_shift_without_undercut:.3f})",
        passed=not form.undercut,
        reason="Undercut removes involute near the base circle, which shortens the contact and "
        "weakens the tooth root.",
    )


def interference_check(owner: str, margin: float, *, allowed: bool = False) -> DesignCheck:
    """Check of the roll length between fillet and deepest contact [m], if not allowed below 0."""
    return DesignCheck(
        name=f"fillet interference, {owner}",
        value=margin * 1e3,
        unit="mm",
        allowed="at least 0 mm of roll length between fillet and deepest contact",
        passed=margin >= 0.0 or allowed,
        reason="A mating tip that reaches below the involute runs on the root fillet, jams the "
        "gears and destroys tip and root.",
    )


def root_clearance_check(
    owner: str, clearance: float, module: float, least: float = MIN_ROOT_CLEARANCE
) -> DesignCheck:
    """Check of the play of the mating tip in a root [m], at least so many modules [-]."""
    return DesignCheck(
        name=f"root clearance, {owner}",
        value=clearance * 1e3,
        unit="mm",
        allowed=f"at least {least * module * 1e3:.3g} mm ({least:g} modules)",
        passed=clearance >= least * module,
        reason="Bearing play moves the gears into one another, so the mating tip needs room in the "
        "root; too much room is dead volume that carries compressed fluid back.",
    )


def least_normal_backlash(module: Real, center_distance: Real) -> Real:
    r"""Smallest normal backlash recommended for industrial drives of medium and large modules. [m].

    Parameters
    ----------
    module : float
        Normal module. [m]
    center_distance : float
        Distance of the gear centres. [m]

    Notes
    -----
    In millimetres :math:`j_{bn} = \frac23 (0.06 + 0.0005\,a + 0.03\,m_n)`. Validity: ferrous gears
    in ferrous housings, pitch line below 15 m/s; faster and hotter gears need more.

    References
    ----------
    .. [1] ISO/TR 10064-2:1996, Code of inspection practice, part 2, clause 9 and table A.1.

    Examples
    --------
    >>> round(least_normal_backlash(2.75e-3, 34.5e-3) * 1e3, 3)
    0.107
    """
    return (0.06e-3 + 0.0005 * center_distance + 0.03 * module) * 2.0 / 3.0


def bearing_checks(
    journals: Sequence[LumpedJournalBearing], root_clearance: float | None = None
) -> tuple[DesignCheck, ...]:
    """Clearances of bearings over their radius, and play over the room in the teeth.

    One for each bearing, and one for the play.

    Parameters
    ----------
    journals : sequence of LumpedJournalBearing
        Bearings, two of those at either side of a gear as one.
    root_clearance : float or None
        Smallest room of a mating tip in a root; None where teeth do not limit the play. [m]

    References
    ----------
    .. [1] DIN 31698:1979, Plain bearings, fits: mean relative clearances of 0.56 to 3.15 per mille.
    """
    least, most = RELATIVE_CLEARANCE
    checks = []
    for journal in journals:
        found = 2.0 * journal.radial_clearance / journal.diameter
        checks.append(
            DesignCheck(
                f"relative clearance of the bearing, {journal.body.replace('_', ' ')}",
                found, "1", f"{least:g} to {most:g}",
                least <= found <= most,
                "A bearing with less runs hot or seizes; with more its film does not carry.",
            )
        )  # fmt: skip
    if root_clearance is not None:
        # what holds both bearings in the housing carries the gears along together
        play = sum(journal.radial_clearance for journal in journals)
        checks.append(
            DesignCheck(
                "bearing play of both gears", play * 1e3, "mm",
                f"below the root clearance of {root_clearance * 1e3:.3g} mm",
                play < root_clearance,
                "Gears that move through the play of their bearings must not run into the roots.",
            )
        )  # fmt: skip
    return tuple(checks)


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
        ("bearing specific load", load, "MPa", _WHY_LOAD),
        ("bearing p v, lubricated", heat, "MPa m/s", _WHY_HEAT),
        ("flank pressure at the pitch point", pitch, "MPa", _WHY_PITS),
        ("root stress", root, "MPa", _WHY_ROOT),
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
        for (name, value, unit, reason), limit in zip(rows, STRENGTH_LIMITS, strict=True)
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
