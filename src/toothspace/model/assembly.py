"""From a machine description, a fluid and a condition to the arrays of one system."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.closures.density import mixture_density
from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.types import Array, BoolArray
from toothspace.model.arrays import (
    ChamberArrays,
    ConditionArrays,
    ContactArrays,
    MotionArrays,
    Sizes,
    SystemArrays,
    WorkArrays,
)
from toothspace.model.chambers import CHANNEL_MOTION
from toothspace.model.description import FlowPath, MachineDescription
from toothspace.model.films import journal_arrays, lateral_torque_coefficient
from toothspace.model.ledger import LEDGER_SIZE, PORT_NODES
from toothspace.model.network import HEIGHT_BY_MOTION
from toothspace.model.operating_point import OperatingCondition
from toothspace.model.paths import load_orifice, pack_paths, path_table
from toothspace.model.quasi_static import bush_positions
from toothspace.model.tables import pack_tables
from toothspace.numerics.periodic_table import PeriodicTable, stack_tables

_NODE_ARRAYS = (
    "volume pressure pressure_by_mass pressure_by_gas pressure_by_volume gas density "
    "liquid_enthalpy gas_enthalpy mass_rate gas_rate"
)
_PATH_ARRAYS = "flow volume_flow by_pressure by_height height drag loss shear"


@final
@dataclass(frozen=True)
class System:
    """One machine at one condition, ready to be marched in time.

    Parameters
    ----------
    description : MachineDescription
        The machine, with its load orifice among the paths if there is one.
    condition : OperatingCondition
        Speed, ports, tolerance.
    arrays : SystemArrays
        What compiled code reads and writes.
    pattern : ndarray of bool, shape (total, core)
        Where the Jacobian may be nonzero.
    free_motions : tuple of int
        Positions of the free micro-motions in ``description.motions``.
    motion_map : ndarray, shape (motions, free)
        All micro-motions from the free ones (the rigid mesh ties one rotation).
    """

    description: MachineDescription
    condition: OperatingCondition
    arrays: SystemArrays
    pattern: BoolArray
    free_motions: tuple[int, ...]
    motion_map: Array


def assemble(
    description: MachineDescription, fluid: FluidLaw, condition: OperatingCondition
) -> System:
    """Build the arrays of a machine at a condition."""
    free = _free_motions(description, condition)
    motion_map = _motion_map(description, free)
    paths = description.paths
    if condition.load_area > 0.0:
        paths = (*paths, load_orifice(description, condition.load_area))
    sizes = _sizes(description, condition, len(free))
    tables = [_chamber_table(description, k, motion_map) for k in range(len(description.families))]
    first_path = len(tables)
    tables += [path_table(path, motion_map) for path in paths]
    first_contact = len(tables)
    tables += [contact.geometry for contact in _loaded_contacts(description)]
    bush = bush_positions(description, condition, motion_map, free)
    arrays = SystemArrays(
        size=sizes,
        bank=pack_tables(tables),
        fluid=fluid,
        chambers=_chambers(description),
        paths=pack_paths(description, paths, first_path, condition),
        motions=_motions(description, condition, free),
        journals=journal_arrays(description, free, bush),
        contacts=_contacts(description, first_contact),
        condition=_conditions(description, fluid, condition, sizes),
        work=_work(sizes, sum(path.count for path in paths), description),
    )
    _set_fixed_densities(arrays)
    pattern = _pattern(arrays)
    return System(description, condition, arrays, pattern, tuple(free), motion_map)


def _free_motions(description: MachineDescription, condition: OperatingCondition) -> list[int]:
    carried = {journal.body for journal in description.journals}
    tied = description.mesh.motion if description.mesh else -1
    if not condition.radial_motion:
        return []
    return [
        k
        for k, motion in enumerate(description.motions)
        if motion.body in carried and motion.axis in ("x", "y") and k != tied
    ]


def _motion_map(description: MachineDescription, free: list[int]) -> Array:
    matrix = np.zeros((len(description.motions), len(free)))
    for column, k in enumerate(free):
        matrix[k, column] = 1.0
        if description.mesh:
            matrix[description.mesh.motion, column] = description.mesh.coefficients[k]
    return matrix


def _sizes(description: MachineDescription, condition: OperatingCondition, motions: int) -> Sizes:
    chambers = description.chamber_count
    dynamic = chambers + (1 if condition.load_area > 0.0 else 0)
    core = 2 + 2 * dynamic + 2 * motions
    return Sizes(
        chambers=chambers,
        nodes=chambers + len(PORT_NODES),
        dynamic=dynamic,
        motions=motions,
        mass=2,
        gas=2 + dynamic,
        position=2 + 2 * dynamic,
        velocity=2 + 2 * dynamic + motions,
        core=core,
        total=core + LEDGER_SIZE,
    )


def _chamber_table(description: MachineDescription, k: int, motion_map: Array) -> PeriodicTable:
    family = description.families[k]
    raw = family.volume_by_motion
    tied = description.mesh.motion if description.mesh else None
    select = np.zeros((raw.values.shape[1], 1))
    if tied is not None:
        select[tied, 0] = 1.0
    mix = np.hstack([select, motion_map])
    return stack_tables(
        family.volume, PeriodicTable(raw.period, raw.values @ mix, raw.slopes @ mix)
    )


def _chambers(description: MachineDescription) -> ChamberArrays:
    counts = [family.count for family in description.families]
    return ChamberArrays(
        table=np.repeat(np.arange(len(counts)), counts).astype(np.int64),
        phase=np.concatenate([family.phases for family in description.families]),
        ratio=np.repeat([family.angle_ratio for family in description.families], counts),
    )


def _motions(
    description: MachineDescription, condition: OperatingCondition, free: list[int]
) -> MotionArrays:
    bodies = {body.name: body for body in description.bodies}
    clearances = {journal.body: journal.radial_clearance for journal in description.journals}
    names = [description.motions[k].body for k in free]
    force = np.zeros(len(free))
    for column, k in enumerate(free):
        if description.motions[k].body == description.bodies[0].name:
            force[column] = condition.radial_load[0 if description.motions[k].axis == "x" else 1]
    return MotionArrays(
        mass=np.array([bodies[name].mass for name in names]),
        external_force=force,
        clearance=np.array([clearances[name] for name in names]),
    )


def _loaded_contacts(description: MachineDescription) -> list[object]:
    if description.mesh is None:
        return []
    return [c for c in description.contacts if c.name == description.mesh.contact]


def _contacts(description: MachineDescription, first_table: int) -> ContactArrays:
    contacts = _loaded_contacts(description)
    if not contacts or description.mesh is None:
        empty = np.zeros(0)
        return ContactArrays(empty.astype(np.int64), empty, empty, 1, 1, 1, 0, 0, 1, 1)
    contact = contacts[0]
    return ContactArrays(
        table=np.full(contact.count, first_table, dtype=np.int64),
        phase=contact.phases,
        ratio=np.full(contact.count, contact.angle_ratio),
        width=contact.width,
        effective_modulus=contact.effective_modulus,
        roughness=contact.roughness,
        boundary_friction=contact.boundary_friction,
        limiting_shear=contact.limiting_shear,
        lever=description.mesh.lever,
        rotation_ratio=1.0,
    )


def _conditions(
    description: MachineDescription,
    fluid: FluidLaw,
    condition: OperatingCondition,
    sizes: Sizes,
) -> ConditionArrays:
    chambers = sizes.chambers
    pressure = np.zeros(sizes.nodes)
    pressure[chambers:] = (
        condition.inlet_pressure,
        condition.outlet_pressure,
        condition.drain_pressure,
        condition.load_pressure,
    )
    dynamic = np.full(sizes.nodes, -1, dtype=np.int64)
    dynamic[:chambers] = np.arange(chambers)
    volume = np.ones(sizes.nodes)
    if condition.load_area > 0.0:
        dynamic[description.outlet_node] = chambers
        volume[description.outlet_node] = description.port_volumes[1]
    return ConditionArrays(
        fixed_pressure=pressure,
        fixed_gas=np.full(sizes.nodes, fluid.feed_gas_mass_fraction),
        node_volume=volume,
        dynamic_index=dynamic,
        lateral_torque=lateral_torque_coefficient(description),
        seal_torque=description.seal_torque,
        relative_tolerance=condition.relative_tolerance,
        pressure_scale=5.0 * max(condition.inlet_pressure, condition.outlet_pressure),
    )


def _work(sizes: Sizes, paths: int, description: MachineDescription) -> WorkArrays:
    nodes, motions = sizes.nodes, max(sizes.motions, 1)
    contacts = sum(c.count for c in _loaded_contacts(description))
    per_node = {name: np.zeros(nodes) for name in _NODE_ARRAYS.split()}
    per_path = {f"path_{name}": np.zeros(paths) for name in _PATH_ARRAYS.split()}
    return WorkArrays(
        chamber_values=np.zeros((sizes.chambers, CHANNEL_MOTION + sizes.motions)),
        chamber_slopes=np.zeros((sizes.chambers, CHANNEL_MOTION + sizes.motions)),
        path_values=np.zeros((paths, HEIGHT_BY_MOTION + sizes.motions)),
        path_b=np.zeros(paths, dtype=np.int64),
        contact_values=np.zeros((contacts, 6)),
        table_angle=np.array([np.nan]),
        volume_rate=np.zeros(sizes.chambers),
        gas_exchange=np.zeros((nodes, 3)),
        pressure_force=np.zeros(motions),
        film_force=np.zeros(motions),
        film_by_position=np.zeros((motions, motions)),
        film_by_velocity=np.zeros((motions, motions)),
        contact_force=np.zeros(contacts),
        torque=np.zeros(7),
        **per_node,
        **per_path,
    )


def _set_fixed_densities(arrays: SystemArrays) -> None:
    fixed = arrays.condition.dynamic_index < 0
    pressure, gas = arrays.condition.fixed_pressure[fixed], arrays.condition.fixed_gas[fixed]
    arrays.work.density[fixed] = mixture_density(pressure, gas, arrays.fluid)


def _pattern(arrays: SystemArrays) -> BoolArray:
    """Where the Jacobian may fill: each path joins its nodes, motions join all."""
    size = arrays.size
    pattern = np.zeros((size.total, size.core), dtype=bool)
    np.fill_diagonal(pattern, True)
    pattern[0, 1] = True
    columns = [_columns(arrays, node) for node in range(size.nodes)]
    rows = [_rows(arrays, node) for node in range(size.nodes)]
    motions = list(range(size.position, size.core))
    for j in range(arrays.paths.table.size):
        a = int(arrays.paths.node_a[j])
        for b in _partners(arrays, j):
            joined_columns = [*columns[a], *columns[b], *motions[: size.motions]]
            pattern[np.ix_([*rows[a], *rows[b]], joined_columns)] = True
    chamber_columns = [c for node in range(size.chambers) for c in columns[node]]
    for k in range(size.motions):
        pattern[size.position + k, size.velocity + k] = True
        pattern[size.velocity + k, [*chamber_columns, *motions]] = True
    return pattern


def _columns(arrays: SystemArrays, node: int) -> list[int]:
    d = int(arrays.condition.dynamic_index[node])
    return [arrays.size.mass + d, arrays.size.gas + d] if d >= 0 else []


def _rows(arrays: SystemArrays, node: int) -> list[int]:
    d = int(arrays.condition.dynamic_index[node])
    if d >= 0:
        return [arrays.size.mass + d, arrays.size.gas + d]
    return [arrays.size.core + node - arrays.size.chambers]


def _partners(arrays: SystemArrays, j: int) -> list[int]:
    if arrays.paths.partner_shift[j] == 0:
        return [int(arrays.paths.node_b[j])]
    first, count = int(arrays.paths.family_first[j]), int(arrays.paths.family_count[j])
    return list(range(first, first + count))


__all__ = ["FlowPath", "System", "assemble"]
