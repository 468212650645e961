"""From the parameters of a gerotor machine to its description."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from toothspace.core.lazy import LazyMapping, LazySequence
from toothspace.geometry.curve import outline_with_hole
from toothspace.machines.gerotor.bodies import (
    bodies,
    film_by_motion,
    journal_bearings,
    lateral_films,
    motion_columns,
    motions,
    outlines,
    shared_faces,
)
from toothspace.machines.gerotor.flow_paths import flow_paths, pocket_phases
from toothspace.machines.gerotor.lobe_pairs import rotor_contacts
from toothspace.machines.gerotor.parameters import GerotorParameters
from toothspace.machines.gerotor.pockets import FULL_TURN, Pockets, area_by_motion, pockets
from toothspace.machines.gerotor.ports import PocketOutlines, ports_of, timing_of
from toothspace.machines.gerotor.profiles import rotors_from
from toothspace.machines.gerotor.summary import design_checks, geometry_summary
from toothspace.machines.shared_bearings import require_rim, require_shaft_below
from toothspace.machines.shared_tables import DEFAULT_NODES, MachineType
from toothspace.model.description import ChamberFamily, MachineDescription
from toothspace.numerics.periodic_table import (
    monotone_table,
    smooth_table,
    sum_of_tables,
    table_from_exact_slopes,
)


def describe(spec: GerotorParameters, nodes: int = DEFAULT_NODES) -> MachineDescription:
    """Tables and data of a machine.

    Parameters
    ----------
    nodes : int
        About how many table nodes on one turn of the outer rotor.

    Raises
    ------
    GeometryError
        If the rotors cannot be built.
    """
    pocket = pockets(spec.rotors, rotors_from(spec.rotors), nodes)
    far, near = (np.hypot(*curve.T) for curve in (pocket.rotors.outer, pocket.rotors.inner))
    rim, shaft = spec.housing.outer_rotor_diameter, spec.rotors.shaft_diameter or 0.0
    require_rim("machine.housing.outer_rotor_diameter", rim, float(far.max()))
    require_shaft_below("machine.rotors.shaft_diameter", shaft, float(near.min()))
    ports = ports_of(spec.ports, pocket, 0.5 * spec.housing.outer_rotor_diameter)
    timing = timing_of(ports, pocket)
    journals = journal_bearings(spec)
    checks = LazySequence(partial(design_checks, spec, pocket, timing, ports, journals))
    columns = motion_columns(spec)
    clearance = float(np.median(pocket.path.gap))
    contacts = rotor_contacts(spec, pocket.rotors, clearance)
    family, film = _families(spec, pocket, columns)
    # the pockets feed the film through the faces of the outer rotor
    share = smooth_table(FULL_TURN, film_by_motion(spec, pocket)[:, columns])
    fed = replace(family, volume_by_motion=sum_of_tables(family.volume_by_motion, share))
    shapes = outlines(spec, pocket, ports)
    bore = shapes["casing"]
    rim_circle = bore * rim / (rim + 2.0 * spec.housing.radial_clearance)
    walls = spec.housing.end_condition == "wall"  # the solved film of the faces feeds the rim
    return MachineDescription(
        name="gerotor",
        mode=spec.use,
        displacement=spec.rotors.face_width * pocket.area_per_radian,
        bodies=bodies(spec, pocket),
        motions=motions(spec),
        families=(fed, film),
        paths=flow_paths(spec, pocket, timing, columns),
        journals=journals,
        laterals=lateral_films(spec, pocket),
        shared_faces=None if walls else shared_faces(spec, pocket, ports, family),
        contacts=contacts,
        seal_torque=0.0 if spec.seals is None else spec.seals.shaft_seal_torque,
        port_volumes=(spec.inlet.volume, spec.outlet.volume),
        drain=spec.drain_node,
        drain_pressure=spec.drain_pressure or 1e5,
        outlines=shapes,
        chamber_outlines=PocketOutlines(pocket, outline_with_hole(bore, rim_circle)),
        geometry_summary=LazyMapping(
            partial(geometry_summary, spec, pocket, timing, contacts, checks)
        ),
        checks=checks,
    )


def _families(
    spec: GerotorParameters, pocket: Pockets, columns: tuple[int, ...]
) -> tuple[ChamberFamily, ChamberFamily]:
    """Pockets, and the film round the outer rotor as one chamber of constant volume."""
    width, housing = spec.rotors.face_width, spec.housing
    radius = 0.5 * housing.outer_rotor_diameter
    ring = np.pi * ((radius + housing.radial_clearance) ** 2 - radius**2)
    of_pockets = ChamberFamily(
        name="pocket",
        angle_ratio=pocket.angle_ratio,
        phases=pocket_phases(pocket),
        volume=table_from_exact_slopes(
            FULL_TURN, width * pocket.area, width * pocket.area_rate / pocket.angle_ratio
        ),
        volume_by_motion=smooth_table(FULL_TURN, width * area_by_motion(pocket)[:, columns]),
    )
    film = ChamberFamily(
        name="outer_film",
        angle_ratio=1.0,
        phases=np.zeros(1),
        volume=monotone_table(FULL_TURN, np.full(4, ring * width)),
        volume_by_motion=monotone_table(FULL_TURN, np.zeros((4, len(columns)))),
    )
    return of_pockets, film


MACHINE = MachineType("gerotor", describe)
"""The machine type found through the entry point."""
