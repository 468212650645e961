"""Design rules of journal bearings: their clearance, and the play that they leave to gears."""

from __future__ import annotations

from collections.abc import Sequence

from toothspace.core.design_check import DesignCheck
from toothspace.model.description import LumpedJournalBearing

RELATIVE_CLEARANCE = 0.3e-3, 5e-3
"""Least and largest radial clearance of a bearing over its radius. [-]"""


def bearing_checks(
    journals: Sequence[LumpedJournalBearing], root_clearance: float | None = None
) -> tuple[DesignCheck, ...]:
    """Clearances of bearings over their radius, and play over the room in the teeth.

    Parameters
    ----------
    journals : sequence of LumpedJournalBearing
        Bearings, two of those at either side of a gear as one.
    root_clearance : float or None
        Smallest room of a mating tip in a root; None where teeth do not limit the play. [m]

    Returns
    -------
    tuple of DesignCheck
        One for each bearing, and one for the play.

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
