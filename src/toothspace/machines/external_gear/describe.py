"""From the parameters of an external gear machine to its description."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from toothspace.core.lazy import Lazy, LazyMapping, LazySequence
from toothspace.gearing.flank_contacts import flank_contacts, rigid_mesh
from toothspace.gearing.helix_slices import Slices
from toothspace.gearing.mesh_cut import AlongTeeth, CutSpaces
from toothspace.gearing.meshing import displacement
from toothspace.gearing.numbering import Numbering, number
from toothspace.gearing.openings import SpaceOutlines
from toothspace.machines.external_gear import gear_bodies
from toothspace.machines.external_gear.assembly import Assembly, assemble
from toothspace.machines.external_gear.flow_paths import flow_paths, tooth_spaces
from toothspace.machines.external_gear.gear_bodies import lateral_films
from toothspace.machines.external_gear.own_teeth import own_teeth
from toothspace.machines.external_gear.spec import ExternalGearSpec
from toothspace.machines.external_gear.summary import (
    as_drawn,
    design_checks,
    enclosed_area,
    geometry_summary,
)
from toothspace.machines.shared_tables import DEFAULT_NODES, MachineType
from toothspace.model.description import ChamberFamily, MachineDescription
from toothspace.model.floating_bearing import LateralBalance
from toothspace.model.path_category import INLET_PORT


def describe(spec: ExternalGearSpec, nodes: int = DEFAULT_NODES) -> MachineDescription:
    """Tables and data of a machine.

    Parameters
    ----------
    nodes : int
        About how many table nodes on one turn of the drive gear.

    Raises
    ------
    GeometryError
        If the gears cannot be built or put into mesh.
    """
    assembly, keys = assemble(spec), spec.keys
    numbering = number(assembly.counts)
    spaces = assembly.spaces(nodes)
    drive, driven = tooth_spaces(assembly, numbering, spaces)
    journals, displaced = gear_bodies.journal_bearings(assembly), displacement(assembly)
    families: tuple[ChamberFamily, ...]
    families = drive.chambers(gear_bodies.BODIES[0]), driven.chambers(gear_bodies.BODIES[1])
    paths = flow_paths(assembly, numbering, spaces)
    contacts = flank_contacts(assembly, gear_bodies.flank_pair(assembly), numbering, spaces[0])
    helix, cut, slices = spec.helix, None, keys.gears.axial_slices
    across, paths_across = families, paths
    section = {"families": across, "paths": paths_across, "contacts": contacts}
    if helix is not None:
        if assembly.flanks_in_turn:
            # the mating tooth fills a space: what lies ahead of it and behind are two chambers
            cut = CutSpaces(numbering.nodes[0].size, helix.twist)
            families = cut.family(families[0]), cut.family(families[1])
        along = AlongTeeth(helix, cut)
        families = helix.family(families[0]), helix.family(families[1])
        paths = tuple(part for path in paths for part in along(path))
        contacts = helix.contact(contacts[0]), helix.contact(contacts[1])
    if cut is not None:
        paths = tuple(
            cut.breather(path, assembly.face_width) if path.category is INLET_PORT else path
            for path in paths
        )
        left_open = enclosed_area(assembly)
        for gear in (0, 1):
            room = max(assembly.root_clearances[gear], spec.drive.roughness)
            paths += (cut.roots(families[gear], gear, left_open, room),)
        families = cut.rest(families[0]), cut.rest(families[1])
    # rules judge a tooth space as one chamber
    checks = LazySequence(partial(design_checks, assembly, spaces, families, paths, journals))
    equal = spec.drive.deviations is None and spec.driven.deviations is None
    own = None if equal else own_teeth(assembly, numbering, spaces)
    if own is not None:
        widths = spec.drive.face_width, spec.driven.face_width
        families = own.family(families[0], 0, widths[0]), own.family(families[1], 1, widths[1])
        paths = tuple(own.path(path) for path in paths)
        loaded, coast = contacts
        left = assembly.loaded_is_left
        contacts = own.contact(loaded, is_left=left), own.contact(coast, is_left=not left)
    sliced = None if slices is None or helix is None else Slices(helix, slices, assembly.counts)
    if sliced is not None:
        families, paths = sliced.families(*across), sliced.paths(paths_across, across)
    # a face sees one chamber of a space that is parted, another one later or at the other end: only
    # the section has a map
    is_parted = cut is not None or sliced is not None
    laterals = faces = lateral_films(assembly, numbering)
    if is_parted:
        laterals = tuple(replace(film, face=None) for film in laterals)
    has_floating_part = spec.floating_block is not None
    machine = MachineDescription(
        name="external_gear",
        mode=keys.use,
        displacement=displaced,
        bodies=gear_bodies.bodies(assembly),
        motions=gear_bodies.MOTIONS,
        families=families,
        paths=paths,
        journals=journals,
        laterals=laterals,
        contacts=contacts,
        mesh=rigid_mesh(assembly),
        seal_torque=spec.seal_torque,
        free_blocks=gear_bodies.free_blocks(assembly),
        startup=None if keys.startup is None else keys.startup.friction,
        port_volumes=(keys.inlet.volume, keys.outlet.volume),
        drain=keys.drain_node,
        drain_pressure=keys.drain_pressure or 1e5,
        running_in=keys.casing.wear_in,
        floating=Lazy(partial(_balance, assembly, numbering, is_parted))
        if has_floating_part
        else None,
        outlines=gear_bodies.outlines(assembly),
        chamber_outlines=None if is_parted else SpaceOutlines(assembly, numbering),
        geometry_summary=LazyMapping(partial(geometry_summary, assembly, spaces, checks)),
        checks=checks,
        as_drawn={} if spec.drive.found is spec.driven.found is None else as_drawn(assembly),
    )
    if helix is None:
        return machine
    outlines = SpaceOutlines(assembly, numbering)
    return helix.wound(
        machine,
        sliced or along,
        slices or 1,
        **section,
        laterals=faces,
        chamber_outlines=outlines,
    )


def _balance(assembly: Assembly, numbering: Numbering, is_parted: bool) -> LateralBalance:
    # with the bodies that bend, most of the machine's modules
    from toothspace.machines.external_gear.floating.balance import lateral_balance

    return lateral_balance(assembly, numbering, parted=is_parted)


MACHINE = MachineType("external_gear", describe)
"""The machine type found through the entry point."""
