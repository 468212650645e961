"""Flat arrays of one system, as compiled code reads them.

=================== ==========================================================
tuple               content
=================== ==========================================================
Sizes               counts and positions in the state vector
ChamberArrays       table and phase of each chamber
PathArrays          nodes, table and law of each flow path
MotionArrays        mass and external force of each free micro-motion
JournalArrays       bearings of the bodies that move
ContactArrays       contacts and the rigid mesh
ConditionArrays     speeds, port states, tolerances, constant torques
WorkArrays          everything that one evaluation computes
SystemArrays        all of them
=================== ==========================================================

State vector: shaft angle, shaft speed, fluid mass of each dynamic node, undissolved gas mass
of each dynamic node, free micro-motions, their velocities, then the ledger states.
"""

from __future__ import annotations

from typing import NamedTuple

from toothspace.closures.bearing_map import JournalMap
from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.types import Array, IntArray
from toothspace.model.tables import TableBank


class Sizes(NamedTuple):
    """Counts and positions in the state vector."""

    chambers: int
    nodes: int
    dynamic: int
    motions: int
    mass: int
    gas: int
    position: int
    velocity: int
    core: int
    total: int


class ChamberArrays(NamedTuple):
    """Chambers: table channels are volume, dV/d(mesh rotation), dV/d(each free motion)."""

    table: IntArray
    phase: Array
    ratio: Array


class PathArrays(NamedTuple):
    """Flow paths: channels are three of geometry, drag speed, shear speed, dh/d(each motion)."""

    table: IntArray
    phase: Array
    ratio: Array
    kind: IntArray
    category: IntArray
    node_a: IntArray
    node_b: IntArray
    family_first: IntArray
    family_count: IntArray
    partner_shift: IntArray
    multiplicity: Array
    minimum_height: Array


class MotionArrays(NamedTuple):
    """Free micro-motions."""

    mass: Array
    external_force: Array
    clearance: Array


class JournalArrays(NamedTuple):
    """Journal bearings, one entry per body; the asperity table is over the eccentricity ratio."""

    motion_x: IntArray
    motion_y: IntArray
    bearings: Array
    radius: Array
    length: Array
    clearance: Array
    speed_ratio: Array
    bush_x: Array
    bush_y: Array
    boundary_friction: Array
    asperity_force: Array
    asperity_load: Array
    asperity_range: float
    film: JournalMap


class ContactArrays(NamedTuple):
    """Contacts: channels as in CONTACT_CHANNELS of the description."""

    table: IntArray
    phase: Array
    ratio: Array
    width: float
    effective_modulus: float
    roughness: float
    boundary_friction: float
    limiting_shear: float
    lever: float
    rotation_ratio: float


class ConditionArrays(NamedTuple):
    """Operating condition: states of fixed nodes and constants of friction."""

    fixed_pressure: Array
    fixed_gas: Array
    node_volume: Array
    dynamic_index: IntArray
    lateral_torque: float
    seal_torque: float
    relative_tolerance: float
    pressure_scale: float


class WorkArrays(NamedTuple):
    """Results of one evaluation, overwritten by the next."""

    chamber_values: Array
    chamber_slopes: Array
    path_values: Array
    path_b: IntArray
    contact_values: Array
    table_angle: Array
    volume: Array
    volume_rate: Array
    pressure: Array
    pressure_by_mass: Array
    pressure_by_gas: Array
    pressure_by_volume: Array
    gas: Array
    density: Array
    liquid_enthalpy: Array
    gas_enthalpy: Array
    path_flow: Array
    path_volume_flow: Array
    path_by_pressure: Array
    path_by_height: Array
    path_height: Array
    path_drag: Array
    path_loss: Array
    path_shear: Array
    mass_rate: Array
    gas_rate: Array
    gas_exchange: Array
    pressure_force: Array
    film_force: Array
    film_by_position: Array
    film_by_velocity: Array
    contact_force: Array
    torque: Array


class SystemArrays(NamedTuple):
    """Everything that the compiled right-hand side reads and writes."""

    size: Sizes
    bank: TableBank
    fluid: FluidLaw
    chambers: ChamberArrays
    paths: PathArrays
    motions: MotionArrays
    journals: JournalArrays
    contacts: ContactArrays
    condition: ConditionArrays
    work: WorkArrays
