"""Design rules of involute gears and of bearings, each with the reason it matters."""

from __future__ import annotations

from collections.abc import Sequence

from toothspace.core.finding import DesignCheck
from toothspace.geometry.gear_pair import GearPair, trapped_volume_change
from toothspace.geometry.involute import InvoluteGear, ToothForm
from toothspace.geometry.involute_gear import Real
from toothspace.model.description import LumpedJournalBearing

MIN_CONTACT_RATIO = 1.05
MAX_SPUR_CONTACT_RATIO = 2.0
MIN_TIP_LAND = 0.2
MIN_ROOT_CLEARANCE = 0.1
MAX_BACKLASH = 0.1
VENTED_SHARE = 0.5
_ENCLOSED_SHARE = 0.002
"""Largest change of the enclosed volume over face width and square of the module. [-]

The volume itself is some two: a thousandth of it compressed raises the pressure of oil by 16 bar.
"""


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
    module, backlash = pair.drive.module, pair.normal_backlash
    least, most = least_normal_backlash(module, pair.center_distance), MAX_BACKLASH * module
    return (
        *checks,
        DesignCheck(
            name="normal backlash",
            value=backlash * 1e3,
            unit="mm",
            allowed=f"{least * 1e3:.3g} mm (ISO/TR 10064-2) to {most * 1e3:.3g} mm "
            f"({MAX_BACKLASH:g} modules)",
            passed=least <= backlash <= most,
            reason="Less lets thermal growth and bearing play jam the flanks and throttles trapped "
            "fluid between them; a wide one rattles and lets both sides of the mesh leak into each "
            "other.",
        ),
        _trapped_volume(pair, face_width, vented=vented),
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


def _trapped_volume(pair: GearPair, face_width: float, *, vented: bool) -> DesignCheck:
    change = trapped_volume_change(pair, face_width)
    share = VENTED_SHARE if vented else _ENCLOSED_SHARE
    spacing = f"vented by relief grooves at most {pair.relief_groove_spacing * 1e3:.4g} mm apart"
    return DesignCheck(
        name="trapped volume change",
        value=change * 1e9,
        unit="mm3",
        allowed=f"below {share:g} face_width module^2, "
        + (spacing if vented else f"without relief grooves; below {VENTED_SHARE:g} {spacing}"),
        passed=change <= share * face_width * pair.drive.module**2,
        reason="Fluid enclosed between two contacts is squeezed and stretched; unless grooves vent "
        "it, pressure peaks load the bearings and then cavitation erodes the flanks.",
    )


RELATIVE_CLEARANCE = 0.3e-3, 5e-3
"""Least and largest radial clearance of a bearing over its radius. [-]"""


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
