"""Design rules of an external gear machine, computed on request."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from toothspace.advice.bearing_rules import bearing_checks
from toothspace.advice.gear_rules import contact_ratio_check, pair_checks
from toothspace.advice.short_circuit import TYPICAL, DesignCondition, opening_checks
from toothspace.advice.strength import strength_checks
from toothspace.advice.trapping import EnclosedMesh, sealing_edge, trapping_checks
from toothspace.core.design_check import DesignCheck
from toothspace.core.types import Array
from toothspace.gearing.gear_tables import ReliefGrooves
from toothspace.gearing.meshing import contact_ratio, displacement
from toothspace.gearing.spaces import Spaces
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.flow_paths import grooves_by_port, port_opening_lengths
from toothspace.machines.external_gear.profile_quality import profile_checks
from toothspace.model.description import ChamberFamily, FlowPath, LumpedJournalBearing

DEEPEST_CUT = 0.127e-3
"""Deepest track of the gears in a casing that is still used (Parker, 0.005 inch). [m]"""


def design_checks(
    assembly: Assembly,
    spaces: tuple[Spaces, Spaces],
    families: Sequence[ChamberFamily],
    paths: Sequence[FlowPath],
    journals: Sequence[LumpedJournalBearing],
) -> tuple[DesignCheck, ...]:
    """Design-rule report: geometry, trapping, strength, cross-port leakage and bearings.

    Parameters
    ----------
    spaces, families, paths : sequences
        Tooth spaces of both gears, as chambers, and all flow paths, of equal teeth.
    journals : sequence of LumpedJournalBearing
        Bearings of both gears.
    """
    mesh = enclosed_mesh(assembly, spaces)
    short, *opened = opening_checks(families, paths, displacement(assembly), 0.0, mesh.condition)
    if not short.passed:
        short = replace(short, reason=short.reason + sealing_edge(mesh))
    return (
        *_tooth_checks(assembly),
        casing_cut_check(assembly),
        *_running_in_checks(assembly, mesh),
        short,
        *opened,
        *bearing_checks(journals, min(assembly.root_clearances)),
    )


def enclosed_mesh(assembly: Assembly, spaces: tuple[Spaces, Spaces]) -> EnclosedMesh:
    """What the mesh encloses, at the pressure and speed of running-in or else typical ones."""
    spec, wear = assembly.spec, assembly.spec.keys.casing.wear_in
    return EnclosedMesh(
        gears=assembly,
        spaces=spaces,
        port_openings=(
            port_opening_lengths(assembly, spaces[0]),
            port_opening_lengths(assembly, spaces[1]),
        ),
        groove_openings=partial(_groove_openings, assembly),
        grooves=spec.grooves,
        tip_rounding=min(spec.drive.tip_rounding, spec.driven.tip_rounding),
        is_pump=spec.keys.mode == "pump",
        condition=TYPICAL if wear is None else DesignCondition(wear.pressure, wear.shaft_speed),
        groove_spacing=None if assembly.pair is None else assembly.pair.relief_groove_spacing,
    )


def _groove_openings(
    assembly: Assembly, grooves: ReliefGrooves, spaces: Spaces
) -> Mapping[str, Array]:
    moved = replace(assembly, spec=replace(assembly.spec, grooves=grooves))
    return grooves_by_port(moved, spaces)


def _running_in_checks(assembly: Assembly, mesh: EnclosedMesh) -> tuple[DesignCheck, ...]:
    """Trapping and strength, where the machine has a condition to judge them at."""
    spec = assembly.spec
    if spec.keys.casing.wear_in is None:
        return ()
    bearing = spec.keys.journal_bearings
    return (
        *trapping_checks(mesh),
        *strength_checks(
            assembly,
            assembly.profiles,
            (spec.drive.material, spec.driven.material),
            (bearing.diameter, bearing.length),
            mesh.condition,
        ),
    )


def _tooth_checks(assembly: Assembly) -> tuple[DesignCheck, ...]:
    """Geometry of the teeth, given by parameters or in files."""
    if assembly.pair is not None:
        vented = assembly.spec.grooves is not None
        return pair_checks(assembly.pair, assembly.face_width, vented=vented)
    clearance = min(assembly.root_clearances)
    return (
        contact_ratio_check(contact_ratio(assembly)),
        DesignCheck(
            "root clearance", clearance * 1e3, "mm", "above 0 mm", clearance > 0.0,
            "Bearing play moves the gears together, so the mating tip needs room in the root.",
        ),
        *profile_checks(assembly),
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
