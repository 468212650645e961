"""From a machine description, a fluid and a condition to the arrays of one system."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np

from toothspace.circuit import network as net
from toothspace.circuit.elements import LAWS
from toothspace.circuit.history import Tables
from toothspace.circuit.network import PORT_NODES, CircuitNetwork
from toothspace.closures.aeration import gas_exchange_rate
from toothspace.closures.density import mixture_density
from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.model import arrays as col
from toothspace.model.arrays import Constants, ContactSurface, Sizes, SystemArrays
from toothspace.model.chambers import wall_volume
from toothspace.model.contact_data import (
    contact_parts,
    held_by_contacts,
    loaded_contacts,
    rigid_mesh,
)
from toothspace.model.description import (
    ChamberFamily,
    FlowPath,
    FreeBlocks,
    MachineDescription,
    categories_of,
)
from toothspace.model.lateral_load import (
    SampledLoads,
    lateral_lookup,
    load_table,
    sampled_loads,
    with_lateral_leakage,
)
from toothspace.model.lateral_table import LOAD_STATES, no_lookup
from toothspace.model.ledger import FRICTION_MECHANISMS, THROTTLING
from toothspace.model.lumped_films import (
    journal_data,
    lateral_asperity_share,
    lateral_drag,
    lateral_torque_coefficient,
)
from toothspace.model.operating_point import OperatingCondition
from toothspace.model.packed_tables import OPEN, make_members, pack_tables
from toothspace.model.path_category import PathCategory
from toothspace.model.paths import by_kind, circuit_orifices, load_orifice, path_arrays, path_tables
from toothspace.model.quasi_static import bush_positions
from toothspace.numerics.ndf_types import FROM_STATE
from toothspace.numerics.periodic_table import PeriodicTable, stack_tables
from toothspace.numerics.roots import root_between

_CLEARANCE = 1e-3
"""Scale of motions without a bearing, over the cube root of the displacement. [-]"""


def free_motions(description: MachineDescription, condition: OperatingCondition) -> list[int]:
    """Positions of the free motions of bodies among those of the description."""
    carried = {journal.body for journal in description.journals}
    held = held_by_contacts(description, condition)
    mesh = rigid_mesh(description, condition)
    tied = mesh.motion if mesh else -1
    free = []
    for k, motion in enumerate(description.motions):
        held_radially = motion.axis in ("x", "y") and (motion.body in carried or held[k])
        turning = motion.axis == "rotation" and held[k]
        if k != tied and (turning or (held_radially and condition.radial_motion)):
            free.append(k)
    return free


def free_blocks(
    description: MachineDescription, condition: OperatingCondition
) -> FreeBlocks | None:
    """Bearing blocks that move in x and y, the last two free motions; None if they rest."""
    return description.free_blocks if condition.radial_motion else None


def motion_rows(
    description: MachineDescription, condition: OperatingCondition, free: list[int]
) -> Array:
    """Mass, load and scale of every free motion."""
    bodies = {body.name: body for body in description.bodies}
    clearance = {journal.body: journal.radial_clearance for journal in description.journals}
    drag = lateral_drag(description)
    blocks = free_blocks(description, condition)
    rows = np.zeros((len(free) + (2 if blocks else 0), col.MOTION_COLUMNS))
    without_bearing = _CLEARANCE * float(np.cbrt(description.displacement))
    for row, k in zip(rows, free, strict=False):
        motion = description.motions[k]
        body = bodies[motion.body]
        row[col.CLEARANCE] = clearance.get(motion.body, without_bearing)
        row[col.MOTION_MASS] = body.mass
        if motion.axis == "rotation":
            row[col.MOTION_MASS], row[col.MOTION_RATIO] = body.inertia, body.speed_ratio
            row[col.LATERAL_DRAG] = drag[motion.body]
            levers = [np.abs(c.gap_by_motion.values[:, k]).max() for c in description.contacts]
            row[col.CLEARANCE] /= float(max(levers))
        elif body.role == "shaft" and motion.axis in ("x", "y"):
            row[col.EXTERNAL_FORCE] = condition.radial_load["xy".index(motion.axis)]
    if blocks:
        rows[-2:, col.MOTION_MASS] = blocks.mass
        rows[-2:, col.CLEARANCE] = blocks.film.radial_clearance
        rows[-2, col.PORT_AREA] = blocks.port_area
    return rows


_SLOWEST_SPEED = 1.0
_LEAST_VOLUME = 1e-4
"""Volume that stays in a chamber whose walls meet, over the largest of its family. [-]"""


@final
@dataclass(frozen=True)
class System:
    """One machine at one condition, ready to be marched in time."""

    description: MachineDescription
    """The machine, with its load orifice among the paths if there is one."""
    condition: OperatingCondition
    """Speed, ports, tolerance."""
    arrays: SystemArrays
    """What compiled code reads and writes."""
    pattern: BoolArray
    """Where the derivatives by the unknowns of the iteration may be nonzero. Shape (total, core).
    """
    basis: BoolArray
    """Where the core states may depend on the unknowns. Shape (core, core)."""
    free_motions: tuple[int, ...]
    """Positions of the free micro-motions in ``description.motions``."""
    motion_map: Array
    """All micro-motions from the free ones (the rigid mesh ties one rotation); bearing blocks that
    move have two more columns, of zeros. Shape (motions, free).
    """
    categories: tuple[PathCategory, ...]
    """What the flow paths are booked under, in the order of the ledger."""

    def at(self, **changes: Any) -> System:
        """System of the same machine and fluid at a condition in which some values differ."""
        return self.under(replace(self.condition, **changes))

    def under(self, condition: OperatingCondition) -> System:
        """System of the same machine and fluid at another condition."""
        return assemble(self.description, self.arrays.fluid, condition)

    @property
    def contact_labels(self) -> list[str]:
        """Names of the contacts that carry load: pair and number."""
        contacts = loaded_contacts(self.description, self.condition)
        return [f"{contact.name}_{k}" for contact in contacts for k in range(contact.count)]


def assemble(
    description: MachineDescription, fluid: FluidLaw, condition: OperatingCondition
) -> System:
    """Build the arrays of a machine at a condition."""
    free = free_motions(description, condition)
    blocks = free_blocks(description, condition)
    # all motions of the description from the free ones, with a column for each of these
    motion_map = np.zeros((len(description.motions), len(free) + (2 if blocks else 0)))
    motion_map[free, np.arange(len(free))] = 1.0
    if mesh := rigid_mesh(description, condition):
        motion_map[mesh.motion, : len(free)] = np.asarray(mesh.coefficients)[free]
    paths = description.paths
    places = node_places(description, condition)
    if condition.load_area > 0.0:
        ends = places[condition.load_node], places["load"]
        paths = (*paths, load_orifice(*ends, condition.load_area))
    if condition.circuit:
        paths = (*paths, *circuit_orifices(condition.circuit, places))
    categories = categories_of(paths)
    paths = by_kind(paths)
    families = description.families
    loads = sampled_loads(description) if description.lateral_table else None
    tables = [
        table
        for family in families
        for table in _chamber_tables(description, family, motion_map, loads)
    ]
    first_of_contacts = len(tables)
    contacts = contact_parts(description, condition, motion_map)
    tables += contacts.tables
    first_of_paths = len(tables)
    tables += [table for path in paths for table in path_tables(path, motion_map)]
    bank = pack_tables(tables)
    table = description.lateral_table
    seated = with_lateral_leakage(description, table.seat_factor) if table else description
    bush = bush_positions(seated, condition, motion_map, free)
    journals = journal_data(description, free, bush, blocks)
    counts = {"motions": motion_map.shape[1], "journals": len(journals.rows), **contacts.counts}
    chambers = description.chamber_count
    node_place = node_places(description, condition)
    dynamic = np.full(chambers + len(node_place), -1, dtype=np.int64)
    dynamic[:chambers] = np.arange(chambers)
    nodes = condition.circuit.nodes if condition.circuit else ()
    filled = [node.name for node in nodes if node.volume > 0.0]
    if condition.load_area > 0.0:
        filled.append(condition.load_node)
    for k, place in enumerate(sorted({node_place[name] for name in filled})):
        dynamic[place] = chambers + k
    sizes = _sizes(description, condition, paths, dynamic, counts)
    tables_over_time = Tables()
    elements = (condition.circuit or CircuitNetwork()).rows(places, LAWS, tables_over_time)
    drive = _drive(description, condition, free, tables_over_time)
    mesh = rigid_mesh(description, condition)
    if mesh is None:
        surface = ContactSurface(1.0, 1.0, 0.0, 0.05, 1.0, 1.0)
    else:
        contact = next(c for c in description.contacts if c.name == mesh.contact)
        surface = ContactSurface(
            contact.effective_modulus,
            contact.roughness,
            contact.boundary_friction,
            contact.limiting_shear,
            contact.width,
            mesh.lever,
        )
    held = int(np.count_nonzero(dynamic < 0))
    # rows of the state in which mass and gas of each node stand
    balance = np.column_stack([sizes.mass + dynamic, sizes.gas + dynamic])
    first = sizes.total - 2 * held
    balance[dynamic < 0] = np.arange(first, sizes.total).reshape(2, held).T
    arrays = SystemArrays(
        size=sizes,
        constant=Constants(
            lateral_torque=float(lateral_torque_coefficient(description)),
            asperity_share=lateral_asperity_share(description),
            seal_torque=float(description.seal_torque),
            relative_tolerance=float(condition.relative_tolerance),
            pressure_scale=5.0 * max(condition.inlet_pressure, condition.outlet_pressure),
            asperity_range=journals.asperity_range,
        ),
        fluid=fluid,
        surface=surface,
        film=journals.film,
        bank=bank,
        chambers=make_members(bank, families, 0, [OPEN] * len(families)),
        contacts=make_members(
            bank, contacts.pairs, first_of_contacts, [contacts.gate] * len(contacts.pairs)
        ),
        paths=make_members(
            bank,
            paths,
            first_of_paths,
            [int(path.kind != "orifice") for path in paths],
            packed=True,
        ),
        dynamic_index=dynamic,
        balance=balance,
        **path_arrays(description, paths, categories),
        journal=journals.rows,
        asperity=journals.asperity,
        friction_curves=journals.curves,
        lateral=lateral_lookup(description, sizes.nodes, loads) if loads else no_lookup(),
        node=np.asfortranarray(_nodes(description, fluid, condition, sizes)),
        contact=contacts.data,
        motion=motion_rows(description, condition, free),
        drive=drive,
        elements=elements,
        schedule=tables_over_time.rows,
        **_work(sizes),
    )
    pattern = _pattern(arrays)
    size = arrays.size
    # where states depend on the unknowns: masses on gas and on motions that change a volume
    basis = np.eye(size.core, dtype=bool)
    for d in range(size.dynamic):
        basis[size.mass + d, size.gas + d] = True
    for i in range(size.chambers):
        moved = _moved(arrays, int(arrays.chambers.table[i]), col.CHANNEL_MOTION)
        basis[size.mass + arrays.dynamic_index[i], moved] = True
    return System(
        description, condition, arrays, pattern, basis, tuple(free), motion_map, categories
    )


def _sizes(
    description: MachineDescription,
    condition: OperatingCondition,
    paths: tuple[FlowPath, ...],
    dynamic_index: IntArray,
    counts: dict[str, int],
) -> Sizes:
    chambers, motions = description.chamber_count, counts["motions"]
    dynamic = int(np.max(dynamic_index)) + 1
    column = 2 + 2 * dynamic + 2 * motions
    film = column + (condition.circuit.states if condition.circuit else 0)
    load = film + LOAD_STATES * (description.lateral_table is not None)
    shaft = condition.free_shaft
    # twist of an elastic coupling, and speed of the load beyond it
    core = load + 2 * (shaft is not None and shaft.coupling is not None)
    return Sizes(
        chambers=chambers,
        nodes=len(dynamic_index),
        dynamic=dynamic,
        paths=sum(path.count for path in paths),
        **counts,
        mass=2,
        gas=2 + dynamic,
        position=2 + 2 * dynamic,
        velocity=2 + 2 * dynamic + motions,
        column=column,
        film=film,
        load=load,
        core=core,
        total=core
        + THROTTLING
        + len(categories_of(paths))
        + 2 * int(np.count_nonzero(dynamic_index < 0)),
    )


def _chamber_tables(
    description: MachineDescription,
    family: ChamberFamily,
    motion_map: Array,
    loads: SampledLoads | None,
) -> list[PeriodicTable]:
    raw = family.volume_by_motion
    tied = description.mesh.motion if description.mesh else None
    select = np.zeros((raw.values.shape[1], 1))
    if tied is not None:
        select[tied, 0] = 1.0
    mix = np.hstack([select, motion_map])
    by_motion = PeriodicTable(raw.period, raw.values @ mix, raw.slopes @ mix)
    tables = [stack_tables(volume, by_motion) for volume in family.own or (family.volume,)]
    if loads is None:
        return tables
    load = load_table(description, family, loads)
    return [stack_tables(table, load) for table in tables]


def node_places(description: MachineDescription, condition: OperatingCondition) -> dict[str, int]:
    """Numbers of the nodes beyond the chambers by name: ports, then those of the circuit."""
    circuit = condition.circuit.all_nodes if condition.circuit else ()
    names = dict.fromkeys([*PORT_NODES, *(node.name for node in circuit)])
    return {name: description.chamber_count + k for k, name in enumerate(names)}


def _drive(
    description: MachineDescription,
    condition: OperatingCondition,
    free: list[int],
    tables: Tables,
) -> Array:
    """Row of the shaft; the tables of its speed and its load join the others."""
    shaft, startup = condition.free_shaft, description.startup
    turning = {m.body for m in (description.motions[k] for k in free) if m.axis == "rotation"}
    inertia = sum(b.inertia * b.speed_ratio**2 for b in description.bodies if b.name not in turning)
    row = np.zeros(col.DRIVE_COLUMNS)
    row[col.FADE] = row[col.BREAKAWAY_SPEED] = 1.0
    row[col.RUNNING_FRICTION] = description.seal_torque
    row[col.DIRECTION] = np.sign(condition.shaft_speed)
    if shaft is not None:
        row[col.FREE] = 1.0
        row[col.INERTIA] = shaft.inertia + inertia
        row[[col.LOAD_LINEAR, col.LOAD_SQUARE, col.LOAD_CUBIC]] = (
            shaft.linear,
            shaft.square,
            shaft.cubic,
        )
        if shaft.coupling is not None:
            row[[col.INERTIA, col.LOAD_INERTIA]] = inertia, shaft.inertia
            row[col.COUPLING_STIFFNESS] = shaft.coupling.stiffness
            row[col.COUPLING_DAMPING] = shaft.coupling.damping
        if startup is not None:
            row[[col.BREAKAWAY, col.BREAKAWAY_SPEED]] = startup.torque, startup.speed
            row[col.ADDED_FRICTION] = startup.law == "additive"
            row[col.FROM_INTERFACES] = startup.law == "interfaces"
            row[col.SEAL_RATIO] = startup.seal_ratio
    load = np.zeros((0, 2)) if shaft is None else shaft.load_history
    row[[col.SPEED_KNOT, col.SPEED_KNOTS]] = tables.add(condition.speed_schedule)
    row[[col.LOAD_KNOT, col.LOAD_KNOTS]] = tables.add(load)
    drag = lateral_drag(description)
    driven = [body for body in description.bodies if body.role == "driven"]
    row[col.DRIVEN_INERTIA] = -sum(b.inertia * b.speed_ratio for b in driven)
    row[col.DRIVEN_LATERAL] = -sum(drag[b.name] * b.speed_ratio for b in driven)
    return row


def _nodes(
    description: MachineDescription, fluid: FluidLaw, condition: OperatingCondition, sizes: Sizes
) -> Array:
    node = np.zeros((sizes.nodes, col.NODE_COLUMNS))
    largest = [np.full(f.count, f.volume.values[:, 0].max()) for f in description.families]
    node[: sizes.chambers, col.LEAST_VOLUME] = _LEAST_VOLUME * np.concatenate(largest)
    ports = node[sizes.chambers : sizes.chambers + len(PORT_NODES)]
    ports[:, col.PRESSURE] = (
        condition.inlet_pressure,
        condition.outlet_pressure,
        condition.drain_pressure,
        condition.load_pressure,
        condition.circuit.supply_pressure if condition.circuit else condition.inlet_pressure,
    )
    ports[:, col.GAS] = fluid.feed_gas_mass_fraction
    flow_rate = description.displacement * max(abs(condition.shaft_speed), _SLOWEST_SPEED)
    residence_time = description.port_volumes[0] / flow_rate
    node[description.inlet_node, col.GAS] = inlet_gas_fraction(
        condition.inlet_pressure, residence_time, fluid
    )
    ports[:, col.DENSITY] = mixture_density(ports[:, col.PRESSURE], ports[:, col.GAS], fluid)
    node[description.outlet_node, col.VOLUME] = description.port_volumes[1]
    places = node_places(description, condition)
    for place in condition.circuit.all_nodes if condition.circuit else ():
        row = node[places[place.name]]
        row[col.PRESSURE], row[col.GAS] = place.pressure, fluid.feed_gas_mass_fraction
        row[col.DENSITY] = mixture_density(place.pressure, row[col.GAS], fluid)
        row[col.REST_VOLUME], row[col.WALL_COMPLIANCE] = place.volume, place.wall_compliance
        row[col.GAS_VOLUME], row[col.PRECHARGE] = place.gas_volume, place.precharge
        row[col.GAS_EXPONENT] = place.gas_exponent
        row[col.VOLUME], row[col.WALL_SLOPE] = wall_volume(row, place.pressure)
    return node


def _work(sizes: Sizes) -> dict[str, Any]:
    """Work arrays; tables are evaluated channel by channel, so their values stand in columns."""
    channels = col.CHANNEL_MOTION + sizes.motions + sizes.load - sizes.film
    gap_channels = col.GAP_BY_MOTION + 2 * sizes.motions
    return {
        "path": np.zeros((col.PATH_COLUMNS, sizes.paths)).T,
        "chamber_values": np.zeros((channels, sizes.chambers)).T,
        "chamber_slopes": np.zeros((channels, sizes.chambers)).T,
        "path_values": np.zeros((col.HEIGHT_BY_MOTION + sizes.motions, sizes.paths)).T,
        # room for two at least: fewer would be another layout, to be compiled once more
        "contact_values": np.zeros((3, gap_channels, max(sizes.contacts, 2))).transpose(0, 2, 1),
        "film_slopes": np.zeros((2, sizes.motions, sizes.motions)),
        "torque": np.zeros(len(FRICTION_MECHANISMS) + 1),
        "table_angle": np.array([np.nan]),
        "origin": np.array([FROM_STATE]),
        "scratch": np.zeros(sizes.total - sizes.core),
    }


def _pattern(arrays: SystemArrays) -> BoolArray:
    """Where derivatives by the unknowns may be: each path joins its nodes, a gap the motions.

    What flows between two nodes of held pressure depends on none, but rows without a column are
    those of losses, which are not integrated with the masses: they get the first.
    """
    size = arrays.size
    pattern = np.zeros((size.total, size.core), dtype=bool)
    np.fill_diagonal(pattern, True)
    pattern[0, 1] = True
    columns = [[size.mass + int(d)] if d >= 0 else [] for d in arrays.dynamic_index]
    rows = [[int(row) for row in balance] for balance in arrays.balance]
    # paths of a family share their table
    tables = {int(table) for table in arrays.paths.table}
    heights = {table: _moved(arrays, table, col.HEIGHT_BY_MOTION) for table in tables}
    for j, index in enumerate(arrays.path_index):
        a = int(index[col.NODE_A])
        moved = heights[int(arrays.paths.table[j])]
        first, count = int(index[col.NODE_B]), 1
        if index[col.PARTNER_SHIFT] != 0:
            first, count = int(index[col.FAMILY_FIRST]), int(index[col.FAMILY_COUNT])
        for b in range(first, first + count):
            joined = [*columns[a], *columns[b], *moved] or [0]
            pattern[np.ix_([*rows[a], *rows[b]], joined)] = True
    for d in range(size.dynamic):
        pattern[size.gas + d, size.mass + d] = True
    for k in range(size.motions):
        pattern[size.position + k, size.velocity + k] = True
        pattern[size.velocity + k, size.position : size.column] = True
    for i in range(size.chambers):
        moved = _moved(arrays, int(arrays.chambers.table[i]), col.CHANNEL_MOTION)
        velocities = [column + size.velocity - size.position for column in moved]
        pattern[np.ix_(velocities, columns[i])] = True
    pressed = [size.velocity + int(k) for k in np.flatnonzero(arrays.motion[:, col.PORT_AREA])]
    pattern[np.ix_(pressed, [*columns[size.chambers], *columns[size.chambers + 1]])] = True
    # what circuit elements and an elastic coupling join
    coupled = [1, *range(size.load, size.core)]
    pattern[np.ix_(coupled, coupled)] = True
    for element in arrays.elements:
        a, b = int(element[net.END_A]), int(element[net.END_B])
        ends = [*columns[a], *columns[b]]
        if element[net.STATES] > 0.0:
            place = size.column + int(element[net.FIRST_STATE])
            own = list(range(place, place + int(element[net.STATES])))
            pattern[np.ix_(own, [*own, *ends])] = True
            ends.append(place)
        pattern[np.ix_([*rows[a], *rows[b]], ends or [0])] = True
    return pattern


def _moved(arrays: SystemArrays, table: int, first: int) -> list[int]:
    """Positions that a table's channels from the first one on depend on."""
    offset, nodes, channels = arrays.bank.layout[table]
    block = arrays.bank.coefficients[offset : offset + 4 * nodes * channels]
    used = np.any(block.reshape(-1, channels) != 0.0, axis=0)
    motions = range(min(arrays.size.motions, channels - first))
    return [arrays.size.position + k for k in motions if used[first + k]]


def inlet_gas_fraction(pressure: float, residence_time: float, law: FluidLaw) -> float:
    """Mass fraction of free gas of the fluid that enters the machine.

    Mass of free gas per mass of mixture, between zero and the total gas content. [-]

    Parameters
    ----------
    pressure : float
        Absolute pressure of the inlet volume, above the vapour pressure. [Pa]
    residence_time : float
        Inlet volume over volume flow rate, positive. [s]
    law : FluidLaw
        Constants of the fluid. [SI]
    """
    feed = law.feed_gas_mass_fraction

    def excess(gas: float) -> float:
        return feed - gas + residence_time * float(gas_exchange_rate(pressure, gas, law)[0])

    highest = 1.1 * law.total_gas_mass_fraction + law.nuclei_mass_fraction
    if excess(0.0) <= 0.0 or excess(highest) >= 0.0:
        return feed
    return root_between(excess, 0.0, highest, 1e-14 * highest)
