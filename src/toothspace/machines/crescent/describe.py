"""From the parameters of an internal gear machine with crescent to its description."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, final

from toothspace.core.types import Array
from toothspace.gearing.meshing import FULL_TURN
from toothspace.gearing.numbering import Numbering, number
from toothspace.gearing.spaces import (
    Spaces,
    area_by_motion,
    section_area_rates,
    section_areas,
)
from toothspace.machines.crescent.assembly import CrescentAssembly, assemble
from toothspace.machines.crescent.contacts import displacement, flank_contacts, rigid_mesh
from toothspace.machines.crescent.flow_paths import flow_paths
from toothspace.machines.crescent.loads import (
    MOTIONS,
    bodies,
    journal_bearings,
    lateral_films,
    outlines,
)
from toothspace.machines.crescent.parameters import CrescentParameters
from toothspace.machines.crescent.summary import design_checks, geometry_summary
from toothspace.model.description import ChamberFamily, MachineDescription
from toothspace.numerics.periodic_table import smooth_table, table_from_exact_slopes

DEFAULT_NODES = 720
FAMILIES = ("pinion_space", "ring_space")


@final
@dataclass(frozen=True)
class CrescentMachine:
    """The machine type: a pinion in a ring gear, with a crescent between them."""

    name: str = "crescent"

    def describe(self, spec: CrescentParameters, nodes: int = DEFAULT_NODES) -> MachineDescription:
        """Tables and data of a machine.

        Parameters
        ----------
        spec : CrescentParameters
            Parameters.
        nodes : int
            About how many table nodes on one turn of the pinion.

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


def describe(spec: CrescentParameters, nodes: int = DEFAULT_NODES) -> MachineDescription:
    """Tables and data of a machine; see :meth:`CrescentMachine.describe`."""
    assembly = assemble(spec)
    checks = design_checks(assembly)
    numbering = number(assembly.counts)
    spaces = assembly.spaces(nodes)
    return MachineDescription(
        name="crescent",
        mode="pump" if spec.mode == "pump" else "motor",
        displacement=displacement(assembly),
        bodies=bodies(assembly),
        motions=MOTIONS,
        families=tuple(_family(assembly, numbering, spaces[gear], gear) for gear in (0, 1)),
        paths=flow_paths(assembly, numbering, spaces),
        journals=journal_bearings(assembly),
        laterals=lateral_films(assembly, numbering),
        contacts=flank_contacts(assembly, numbering, spaces[0]),
        mesh=rigid_mesh(assembly),
        seal_torque=0.0 if spec.seals is None else spec.seals.shaft_seal_torque,
        port_volumes=(spec.inlet.volume, spec.outlet.volume),
        drain=_drain(spec),
        drain_pressure=spec.drain_pressure or 1e5,
        outlines=outlines(assembly),
        geometry_summary=geometry_summary(assembly, spaces, checks),
        checks=checks,
    )


def _family(
    assembly: CrescentAssembly, numbering: Numbering, spaces: Spaces, gear: int
) -> ChamberFamily:
    width, ratio = assembly.face_width, numbering.ratios[gear]
    volume: Array = width * section_areas(spaces)
    slope = width * section_area_rates(spaces) / ratio
    return ChamberFamily(
        name=FAMILIES[gear],
        angle_ratio=ratio,
        phases=numbering.space_phases[gear],
        volume=table_from_exact_slopes(FULL_TURN, volume, slope),
        volume_by_motion=smooth_table(FULL_TURN, width * area_by_motion(spaces)),
    )


def _drain(spec: CrescentParameters) -> Literal["inlet", "outlet", "external"]:
    if spec.drain == "external":
        return "external"
    default = "inlet" if spec.mode == "pump" else "outlet"
    return "inlet" if (spec.drain or default) == "inlet" else "outlet"


MACHINE = CrescentMachine()
"""The machine type found through the entry point."""
