"""From the parameters of an external gear machine to its description."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from toothspace.core.types import Array
from toothspace.gearing.numbering import FULL_TURN, Numbering, number
from toothspace.gearing.spaces import (
    Spaces,
    area_by_motion,
    section_area_rates,
    section_areas,
)
from toothspace.machines.external_gear.assembly import Assembly, assemble
from toothspace.machines.external_gear.balance import lateral_balance
from toothspace.machines.external_gear.contacts import displacement, rigid_mesh
from toothspace.machines.external_gear.films import lateral_films
from toothspace.machines.external_gear.flank_contacts import flank_contacts
from toothspace.machines.external_gear.flow_paths import flow_paths
from toothspace.machines.external_gear.loads import (
    BODIES,
    MOTIONS,
    bodies,
    journal_bearings,
    outlines,
)
from toothspace.machines.external_gear.own_teeth import own_teeth
from toothspace.machines.external_gear.profile_quality import as_drawn
from toothspace.machines.external_gear.spec import ExternalGearSpec
from toothspace.machines.external_gear.summary import design_checks, geometry_summary
from toothspace.model.description import ChamberFamily, MachineDescription, RunningIn
from toothspace.numerics.periodic_table import smooth_table, table_from_exact_slopes

DEFAULT_NODES = 720


@final
@dataclass(frozen=True)
class ExternalGearMachine:
    """The machine type: two external gears in a casing."""

    name: str = "external_gear"

    def describe(self, spec: ExternalGearSpec, nodes: int = DEFAULT_NODES) -> MachineDescription:
        """Tables and data of a machine.

        Parameters
        ----------
        spec : ExternalGearSpec
            Parameters.
        nodes : int
            Table nodes on one turn of each gear.

        Returns
        -------
        MachineDescription
            What the solver needs.

        Raises
        ------
        GeometryError
            If the gears cannot be built or put into mesh.
        """
        return describe(spec, nodes)


def describe(spec: ExternalGearSpec, nodes: int = DEFAULT_NODES) -> MachineDescription:
    """Tables and data of a machine; see :meth:`ExternalGearMachine.describe`."""
    assembly = assemble(spec)
    numbering = number(assembly.counts)
    spaces = assembly.spaces(nodes)
    families = tuple(_family(assembly, numbering, spaces[gear], gear) for gear in (0, 1))
    paths = flow_paths(assembly, numbering, spaces)
    contacts = flank_contacts(assembly, numbering, spaces[0])
    own = own_teeth(assembly, numbering, spaces)
    if own is not None:
        widths = spec.drive.face_width, spec.driven.face_width
        families = tuple(own.family(families[gear], gear, widths[gear]) for gear in (0, 1))
        paths = tuple(own.path(path) for path in paths)
        loaded, coast = contacts
        left = assembly.loaded_is_left
        contacts = own.contact(loaded, is_left=left), own.contact(coast, is_left=not left)
    return MachineDescription(
        name="external_gear",
        mode=spec.mode,
        displacement=displacement(assembly),
        bodies=bodies(assembly),
        motions=MOTIONS,
        families=families,
        paths=paths,
        journals=journal_bearings(assembly),
        laterals=lateral_films(assembly, numbering),
        contacts=contacts,
        mesh=rigid_mesh(assembly),
        seal_torque=spec.seal_torque,
        startup=spec.startup,
        port_volumes=(spec.inlet_volume, spec.outlet_volume),
        drain=spec.drain or ("inlet" if spec.mode == "pump" else "outlet"),
        drain_pressure=spec.drain_pressure,
        running_in=_running_in(spec),
        lateral_balance=lateral_balance(assembly, numbering),
        outlines=outlines(assembly),
        geometry_summary=geometry_summary(assembly, spaces),
        checks=design_checks(assembly),
        as_drawn=as_drawn(assembly),
    )


def _family(assembly: Assembly, numbering: Numbering, spaces: Spaces, gear: int) -> ChamberFamily:
    width = (assembly.spec.drive, assembly.spec.driven)[gear].face_width
    volume: Array = width * section_areas(spaces)
    slope = width * section_area_rates(spaces) / spaces.angle_ratio
    return ChamberFamily(
        name=BODIES[gear],
        angle_ratio=spaces.angle_ratio,
        phases=numbering.space_phases[gear],
        volume=table_from_exact_slopes(FULL_TURN, volume, slope),
        volume_by_motion=smooth_table(FULL_TURN, width * area_by_motion(spaces)),
    )


def _running_in(spec: ExternalGearSpec) -> RunningIn | None:
    wear = spec.casing.wear_in
    if wear is None:
        return None
    return RunningIn(wear.pressure, wear.shaft_speed, wear.temperature)


MACHINE = ExternalGearMachine()
"""The machine type found through the entry point."""
