"""Flat arrays of one system, as compiled code reads them, and the meaning of their columns.

State vector: shaft angle, shaft speed, fluid mass of each dynamic node, undissolved gas mass
of each dynamic node, free micro-motions, their velocities, flows of fluid columns with the
memory of their friction, load on tabulated lateral films and its moment, twist of an elastic
coupling and speed of the load beyond it, then the ledger states.

Few arrays with named columns instead of many arrays: compiled functions pass them by value,
and each costs reference counting.
"""

from __future__ import annotations

from typing import NamedTuple

from toothspace.closures.bearing_map import JournalMap
from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.compiled import passed_by_address
from toothspace.core.types import Array, IntArray
from toothspace.model.lateral_table import LateralLookup
from toothspace.model.packed_tables import Members, TableBank

# Columns of ``node``: state of chambers and ports.
(
    VOLUME, VOLUME_RATE, PRESSURE, PRESSURE_BY_MASS, PRESSURE_BY_GAS, PRESSURE_BY_VOLUME, GAS,
    DENSITY, LIQUID_ENTHALPY, GAS_ENTHALPY, MASS_RATE, GAS_RATE, EXCHANGE_RATE,
    EXCHANGE_BY_PRESSURE, EXCHANGE_BY_GAS, ROOT_VISCOSITY, REST_VOLUME, WALL_COMPLIANCE,
    GAS_VOLUME, PRECHARGE, GAS_EXPONENT, WALL_SLOPE, CARRIED_PRESSURE, LEAST_VOLUME, VOLUME_SHARE,
) = range(25)  # fmt: skip
NODE_COLUMNS = 25

# Columns of ``path``: what flows through a path. The line is its flow by the drop as linear
# equations have it, of one of its multiple gaps; the sense is that of the flow they led to.
(
    FLOW, VOLUME_FLOW, FLOW_BY_PRESSURE, FLOW_BY_HEIGHT, HEIGHT, DRAG, LOSS, SHEAR, DROP,
    INFLOW_DENSITY, MEAN_VISCOSITY, RUNNING_HEIGHT, HEIGHT_FACTOR, CONDUCTANCE, OPENING,
    BY_HEIGHT, DRAG_BY_HEIGHT, NOMINAL_HEIGHT, SENSE, LINE_FLOW, LINE_DROP, LINE_SLOPE, LAST_FLOW,
) = range(23)  # fmt: skip
PATH_COLUMNS = 23

# Kinds of paths, in the order of their rows; ``kinds`` holds the first of each.
CURVED_GAP, FITTED_GAP, PARALLEL_GAP, ORIFICE = range(4)

# Columns of ``path_index`` and ``path_data``: what a path is.
(
    KIND, CATEGORY, NODE_A, NODE_B, PRESENT_B, FAMILY_FIRST, FAMILY_COUNT, PARTNER_SHIFT,
) = range(8)  # fmt: skip
# of a path's height, LATERAL_SHARE follows that of tabulated lateral films
MULTIPLICITY, MINIMUM_HEIGHT, THROAT_SPEED, CARRIED_SHARE, GAP_VISCOSITY, LATERAL_SHARE = range(6)

# Columns of ``chamber_values``: volume, dV/d(mesh rotation), dV/d(each free motion), then axial
# force and moment by the pressure where lateral films are tabulated.
CHANNEL_VOLUME, CHANNEL_MESH, CHANNEL_MOTION = range(3)

# Columns of ``path_values``: geometry, drag and shear speed, d(height)/d(each free motion).
GEOMETRY, DRAG_SPEED, SHEAR_SPEED, HEIGHT_BY_MOTION = 0, 3, 4, 5

# Planes of ``contact_values``: at nominal place, their slopes by the angle, where the bodies are.
VALUE, SLOPE, DISPLACED = range(3)
# Their columns: in a rigid mesh, and where contacts are compliant instead; d(slip)/d(each free
# motion) follow those of the gap.
GAP, LOAD_SHARE, RADIUS_A, RADIUS_B, SLIDING, ROLLING = range(6)
CURVATURE, LAW_LEVEL, LAW_EXPONENT, POSSIBLE = 1, 2, 3, 6
BY_SHIFTS, BY_SHIFT_AND_TURN, BY_TURNS, GAP_BY_MOTION = 7, 8, 9, 10

# Columns of ``contact``: what acts in a contact, then constants of its pair.
(
    CONTACT_FORCE, CONTACT_ENERGY, CONTACT_DAMPING, CONTACT_FRICTION, CONTACT_SLIP,
    CONTACT_TORQUE, FORCE_BY_OVERLAP, FORCE_BY_RATE, FRICTION_BY_FORCE, FRICTION_BY_SLIP,
    PAIR_MODULUS, PAIR_ROUGHNESS, PAIR_BOUNDARY, PAIR_LIMIT, PAIR_WIDTH, PAIR_ONSET,
    PAIR_DAMPING, PAIR_POWER_LAW, PAIR_ACCOUNT, PAIR_SQUEEZE, PAIR_LOSS,
) = range(21)  # fmt: skip
CONTACT_STATE = 10
CONTACT_COLUMNS = 21
"""Then the relative rotation of the two bodies by each free motion."""

# Columns of ``motion``; ratio and drag are those of a rotation, zero otherwise; the port area is
# that on which inlet pressure pushes and outlet pressure pulls.
(
    MOTION_MASS, EXTERNAL_FORCE, CLEARANCE, MOTION_RATIO, LATERAL_DRAG, PRESSURE_FORCE,
    FILM_FORCE, CONTACT_LOAD, PORT_AREA,
) = range(9)  # fmt: skip
MOTION_COLUMNS = 9

# Columns of ``journal``; the number of loads with a friction curve and the sense of rotation of
# a driven body are zero of others, the viscosity is over that of the fluid, the carrier is what
# holds the bearing where that moves, -1 where it does not.
(
    MOTION_X, MOTION_Y, BEARINGS, RADIUS, LENGTH, JOURNAL_CLEARANCE, SPEED_RATIO, BUSH_X, BUSH_Y,
    BOUNDARY_FRICTION, ROTATION, FILM_MAP, FILM_X, FILM_Y, CURVES, DRIVEN_SENSE, JOURNAL_VISCOSITY,
    CARRIER_X, CARRIER_Y,
) = range(19)  # fmt: skip
JOURNAL_COLUMNS = 19

# Columns of ``friction_curves``, one row per bearing and load; the load is a logarithm.
(
    CURVE_LOAD, CURVE_BOUNDARY, CURVE_DECAY, CURVE_RISE, CURVE_TRANSITION, CURVE_OFFSET, CURVE_LINE,
) = range(7)  # fmt: skip
CURVE_COLUMNS = 7

# Columns of ``drive``: what turns the shaft. Direction is the sense in which friction lets it
# slide (+1, -1), or zero while it sticks or while its speed is prescribed at zero. Driven are
# the bodies that turn against the shaft, whose friction and inertia the mesh carries.
(
    FREE, DIRECTION, INERTIA, LOAD_LINEAR, LOAD_CUBIC, BREAKAWAY,
    RUNNING_FRICTION, BREAKAWAY_SPEED, ADDED_FRICTION, FADE, DRIVING_TORQUE, HOLDING_TORQUE,
    SPEED_KNOT, SPEED_KNOTS, LOAD_KNOT, LOAD_KNOTS, PRESENT_LOAD, LOAD_SQUARE, LOAD_INERTIA,
    COUPLING_STIFFNESS, COUPLING_DAMPING, DRIVEN_INERTIA, DRIVEN_LATERAL, DRIVEN_FRICTION,
    FROM_INTERFACES, SEAL_RATIO,
) = range(26)  # fmt: skip
DRIVE_COLUMNS = 26


@passed_by_address
class Sizes(NamedTuple):
    """Counts and positions in the state vector."""

    chambers: int
    nodes: int
    dynamic: int
    paths: int
    motions: int
    journals: int
    contacts: int
    compliant: int
    mass: int
    gas: int
    position: int
    velocity: int
    column: int
    film: int
    load: int
    core: int
    total: int


@passed_by_address
class ContactSurface(NamedTuple):
    """Flanks in contact; the first four fields are those of a flank surface."""

    effective_modulus: float
    roughness: float
    boundary_friction: float
    limiting_shear: float
    width: float
    lever: float


@passed_by_address
class Constants(NamedTuple):
    """Constants of one run."""

    lateral_torque: float
    asperity_share: float
    seal_torque: float
    relative_tolerance: float
    pressure_scale: float
    asperity_range: float


@passed_by_address
class SystemArrays(NamedTuple):
    """Everything that the compiled right-hand side reads and writes.

    ``node``, ``path``, ``chamber_values``, ``path_values``, ``contact_values``, ``contact``,
    ``motion``, ``film_slopes`` (by position, by velocity), ``torque`` and ``table_angle`` are
    written by each evaluation; ``origin`` says where flows come from, ``balance`` in which rows
    of the state mass and gas of each node stand: core states, or ledger states of held nodes.
    Rows of ``path`` and ``path_values`` are the open paths, one after the other: ``open_kinds``,
    ``open_index`` and ``open_data`` are ``kinds``, ``path_index`` and ``path_data`` of these.
    """

    size: Sizes
    constant: Constants
    fluid: FluidLaw
    surface: ContactSurface
    film: JournalMap
    bank: TableBank
    chambers: Members
    paths: Members
    contacts: Members
    dynamic_index: IntArray
    balance: IntArray
    kinds: IntArray
    path_index: IntArray
    path_data: Array
    open_kinds: IntArray
    open_index: IntArray
    open_data: Array
    journal: Array
    asperity: Array
    friction_curves: Array
    lateral: LateralLookup
    node: Array
    path: Array
    chamber_values: Array
    chamber_slopes: Array
    path_values: Array
    contact_values: Array
    contact: Array
    motion: Array
    film_slopes: Array
    torque: Array
    table_angle: Array
    origin: IntArray
    drive: Array
    elements: Array
    schedule: Array
    scratch: Array
