"""From the parameters of an internal gear machine with crescent to its description."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from toothspace.core.lazy import LazyMapping, LazySequence
from toothspace.gearing.flank_contacts import flank_contacts, rigid_mesh
from toothspace.gearing.helix_slices import Slices
from toothspace.gearing.mesh_cut import AlongTeeth
from toothspace.gearing.meshing import displacement
from toothspace.gearing.numbering import number
from toothspace.gearing.openings import SpaceOutlines
from toothspace.machines.crescent import gear_bodies
from toothspace.machines.crescent.assembly import assemble
from toothspace.machines.crescent.flow_paths import flow_paths, tooth_spaces
from toothspace.machines.crescent.parameters import CrescentParameters
from toothspace.machines.crescent.summary import design_checks, geometry_summary
from toothspace.machines.shared_tables import DEFAULT_NODES, MachineType
from toothspace.model.description import MachineDescription

FAMILIES = ("pinion_space", "ring_space")


def describe(spec: CrescentParameters, nodes: int = DEFAULT_NODES) -> MachineDescription:
    """Tables and data of a machine.

    Parameters
    ----------
    nodes : int
        About how many table nodes on one turn of the pinion.

    Raises
    ------
    GeometryError
        If the gears cannot be built or put into mesh.
    """
    assembly = assemble(spec)
    numbering = number(assembly.counts)
    spaces = assembly.spaces(nodes)
    families = tuple(
        own.chambers(name)
        for own, name in zip(tooth_spaces(assembly, numbering, spaces), FAMILIES, strict=True)
    )
    paths = flow_paths(assembly, numbering, spaces)
    contacts = flank_contacts(assembly, gear_bodies.flank_pair(assembly), numbering, spaces[0])
    helix = assembly.helix
    across, paths_across = families, paths
    section = {"families": across, "paths": paths_across, "contacts": contacts}
    if helix is not None:
        families = tuple(helix.family(family) for family in families)
        paths = tuple(helix.path(path) for path in paths)
        contacts = helix.contact(contacts[0]), helix.contact(contacts[1])
    journals = gear_bodies.journal_bearings(assembly)
    # rules judge a tooth space as one chamber
    checks = LazySequence(partial(design_checks, assembly, families, paths, journals))
    slices, sliced = spec.pinion.axial_slices, None
    outlines = SpaceOutlines(assembly, numbering)
    laterals = gear_bodies.lateral_films(assembly, numbering)
    if helix is not None and slices is not None:
        sliced = Slices(helix, slices, assembly.counts)
        families, paths = sliced.families(*across), sliced.paths(paths_across, across)
    machine = MachineDescription(
        name="crescent",
        mode=spec.use,
        displacement=displacement(assembly),
        bodies=gear_bodies.bodies(assembly),
        motions=gear_bodies.MOTIONS,
        families=families,
        paths=paths,
        journals=journals,
        # each end of a sliced space is a chamber of its own: only the section has a map of them
        laterals=laterals if sliced is None else tuple(replace(f, face=None) for f in laterals),
        contacts=contacts,
        mesh=rigid_mesh(assembly),
        seal_torque=0.0 if spec.seals is None else spec.seals.shaft_seal_torque,
        port_volumes=(spec.inlet.volume, spec.outlet.volume),
        drain=spec.drain_node,
        drain_pressure=spec.drain_pressure or 1e5,
        outlines=gear_bodies.outlines(assembly),
        chamber_outlines=outlines if sliced is None else None,
        geometry_summary=LazyMapping(partial(geometry_summary, assembly, spaces, checks)),
        checks=checks,
    )
    if helix is None:
        return machine
    along = sliced or AlongTeeth(helix)
    return helix.wound(
        machine, along, slices or 1, **section, laterals=laterals, chamber_outlines=outlines
    )


MACHINE = MachineType("crescent", describe)
"""The machine type found through the entry point."""
