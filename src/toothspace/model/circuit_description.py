"""A hydraulic circuit and a shaft as the model sees them, and their arrays."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Literal, final

import numpy as np

from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.circuit import PRESSURE_VALVE, PROPORTIONAL_VALVE, RESISTANCE, SUPPLY_PUMP
from toothspace.model.description import BreakawayLaw
from toothspace.model.fluid_column import FLUID_COLUMN

_KINDS = {
    "supply_pump": SUPPLY_PUMP,
    "pressure_valve": PRESSURE_VALVE,
    "proportional_valve": PROPORTIONAL_VALVE,
    "resistance": RESISTANCE,
    "fluid_column": FLUID_COLUMN,
}
ElementKind = Literal[
    "supply_pump", "pressure_valve", "proportional_valve", "resistance", "fluid_column"
]

_NO_KNOTS: Array = np.zeros((0, 2))


@final
@dataclass(frozen=True)
class CircuitNode:
    """A place of one pressure in a circuit."""

    name: str
    """``inlet`` and ``outlet`` are those of the machine."""
    pressure: float
    """Absolute pressure, held if the node is a tank, else at the start. [Pa]"""
    volume: float = 0.0
    """Fluid volume at zero pressure; zero makes the node a tank. [m3]"""
    wall_compliance: float = 0.0
    """Growth of the volume per pressure. [m3/Pa]"""
    gas_volume: float = 0.0
    """Volume of the gas charge of an accumulator. [m3]"""
    precharge: float = 1e5
    """Absolute pressure of that charge without fluid. [Pa]"""
    gas_exponent: float = 1.4
    """Polytropic exponent of the charge, not one. [-]"""


@final
@dataclass(frozen=True)
class CircuitElement:
    """An element that joins two nodes; flow counts from a to b."""

    kind: ElementKind
    """``supply_pump``: displacement [m3/rad], volumetric efficiency at zero pressure difference
    [-], its change per pressure rise [1/Pa] and leakage per pressure rise [m3/(s Pa)]; the schedule
    is its speed. ``pressure_valve`` (relief, check): opening pressure difference [Pa], pressure
    rise per flow [Pa s/m3] and rounding of the opening point [Pa]. ``proportional_valve``:
    effective area when fully open [m2]; the schedule is its opening from 0 to 1. ``resistance``:
    pressure drop per flow [Pa s/m3] and per flow squared [Pa s2/m6]. ``fluid_column``: inertance
    [kg/m4], laminar pressure drop per flow [Pa s/m3] and flow at a Reynolds number of 2300 [m3/s].
    """
    node_a: str
    node_b: str
    """Names of nodes; ``supply`` is the tank of a pump."""
    parameters: tuple[float, ...]
    """See ``kind``."""
    schedule: Array = field(default_factory=lambda: _NO_KNOTS)
    """Time [s] and value, joined by straight lines. Shape (knots, 2)."""
    efficiency_map: Array | None = None
    """Map of the volumetric efficiency of a supply pump instead of its line, as
    :func:`toothspace.model.circuit.map_efficiency` reads it. Shape (rows, 2).
    """
    memory: Array = field(default_factory=lambda: _NO_KNOTS)
    """Friction of a fluid column that remembers, shape (branches, 2): decay rate [1/s] and
    resistance [Pa s/m3].
    """

    @property
    def states(self) -> int:
        """States of its own: flow and memory of a fluid column."""
        return 1 + len(self.memory) if self.kind == "fluid_column" else 0


@final
@dataclass(frozen=True)
class CircuitOrifice:
    """Sharp-edged restriction between two nodes. ``area``: [m2]."""

    node_a: str
    node_b: str
    area: float


@final
@dataclass(frozen=True)
class CircuitNetwork:
    """Nodes, elements and orifices round a machine."""

    nodes: tuple[CircuitNode, ...]
    """Places with volume, and tanks."""
    elements: tuple[CircuitElement, ...] = ()
    orifices: tuple[CircuitOrifice, ...] = ()
    """What joins them."""
    supply_pressure: float = 1e5
    """Absolute pressure of the tank that supply pumps draw from. [Pa]"""
    tank_ends: tuple[CircuitNode, ...] = ()
    """Ends of elements and orifices at tanks, each a tank that accounts for its own flow."""

    @property
    def all_nodes(self) -> tuple[CircuitNode, ...]:
        """Nodes and ends at tanks."""
        return (*self.nodes, *self.tank_ends)

    def with_tank_ends(self) -> CircuitNetwork:
        """Give every end at a tank an account of its own.

        What flows out of a tank in one place and back in another would cancel in one account.
        """
        pressures = {node.name: node.pressure for node in self.nodes if node.volume <= 0.0}
        found: list[CircuitNode] = []

        def at_tank(name: str) -> str:
            if name not in pressures:
                return name
            found.append(CircuitNode(f"{name}:{len(found)}", pressures[name]))
            return found[-1].name

        def joined(parts: tuple[Any, ...]) -> tuple[Any, ...]:
            return tuple(
                replace(part, node_a=at_tank(part.node_a), node_b=at_tank(part.node_b))
                for part in parts
            )

        elements, orifices = joined(self.elements), joined(self.orifices)
        return replace(self, elements=elements, orifices=orifices, tank_ends=tuple(found))


@final
@dataclass(frozen=True)
class ShaftCoupling:
    """Elastic coupling: torque over twist [N m/rad] and over slip [N m s/rad]."""

    stiffness: float
    damping: float


@final
@dataclass(frozen=True, kw_only=True)
class FreeShaft:
    """A shaft that turns as the torques on it let it."""

    inertia: float
    """Moment of inertia of load and shaft without the machine's bodies. [kg m2]"""
    linear: float = 0.0
    cubic: float = 0.0
    constant: float = 0.0
    """Torque of the load: linear w + square w|w| + cubic w^3 + constant. [N m s], [N m s3], [N m]
    """
    breakaway_torque: float = 0.0
    """Largest friction at rest; zero leaves out start-up friction. [N m]"""
    breakaway_speed: float = 0.7
    """Speed up to which friction stays at the breakaway torque. [rad/s]"""
    breakaway_law: BreakawayLaw = "total"
    """Whether that torque stands for all interfaces, which fade in with speed, is added to their
    boundary friction, or is their boundary friction and follows their loads.
    """
    seal_ratio: float = 1.0
    """Friction of the shaft seal at rest over that in running, where the breakaway torque is the
    boundary friction of all interfaces. [-]
    """
    load_schedule: Array = field(default_factory=lambda: _NO_KNOTS)
    """Time [s] and further torque of the load [N m], joined by straight lines. Shape (knots, 2)."""
    square: float = 0.0
    """Torque of the load per speed squared. [N m s2]"""
    coupling: ShaftCoupling | None = None
    """Elastic coupling between the machine and its load; None joins them rigidly."""


def column_states(circuit: CircuitNetwork | None) -> int:
    """States of all fluid columns of a circuit."""
    return sum(element.states for element in circuit.elements) if circuit else 0


def coupling_states(shaft: FreeShaft | None) -> int:
    """Twist of an elastic coupling and speed of the load beyond it."""
    return 2 if shaft is not None and shaft.coupling is not None else 0


def drive_row(
    shaft: FreeShaft | None, shaft_speed: float, running_friction: float, body_inertia: float
) -> Array:
    """Row of the shaft; ``running_friction`` is that of the seal. [N m], [kg m2]."""
    row = np.zeros(col.DRIVE_COLUMNS)
    row[col.FADE] = row[col.BREAKAWAY_SPEED] = 1.0
    row[col.RUNNING_FRICTION] = running_friction
    row[col.DIRECTION] = np.sign(shaft_speed)
    if shaft is not None:
        row[col.FREE] = 1.0
        row[col.INERTIA] = shaft.inertia + body_inertia
        row[col.LOAD_SQUARE] = shaft.square
        if shaft.coupling is not None:
            row[[col.INERTIA, col.LOAD_INERTIA]] = body_inertia, shaft.inertia
            row[col.COUPLING_STIFFNESS] = shaft.coupling.stiffness
            row[col.COUPLING_DAMPING] = shaft.coupling.damping
        row[[col.LOAD_LINEAR, col.LOAD_CUBIC]] = shaft.linear, shaft.cubic
        row[col.LOAD_CONSTANT] = shaft.constant
        row[col.BREAKAWAY] = shaft.breakaway_torque
        row[col.BREAKAWAY_SPEED] = shaft.breakaway_speed
        row[col.ADDED_FRICTION] = shaft.breakaway_law == "additive"
        row[col.FROM_INTERFACES] = shaft.breakaway_law == "interfaces"
        row[col.SEAL_RATIO] = shaft.seal_ratio
    return row


def circuit_rows(
    circuit: CircuitNetwork | None,
    places: dict[str, int],
    drive: Array,
    schedules: tuple[Array, Array],
) -> tuple[Array, Array]:
    """Rows of the elements and all schedules; the drive row learns where its own ones are.

    ``schedules`` are the prescribed shaft speed and the torque of the load over time.
    """
    elements = circuit.elements if circuit else ()
    rows = np.zeros((len(elements), col.ELEMENT_COLUMNS))
    knots = _Knots()
    states = 0
    for row, element in zip(rows, elements, strict=True):
        row[col.ELEMENT_KIND] = _KINDS[element.kind]
        row[[col.ELEMENT_A, col.ELEMENT_B]] = places[element.node_a], places[element.node_b]
        row[col.PARAMETER_1 : col.PARAMETER_1 + len(element.parameters)] = element.parameters
        table = element.memory if element.states else element.schedule
        row[[col.FIRST_KNOT, col.KNOTS]] = knots.add(table), len(table)
        if element.states:
            row[col.PARAMETER_4] = states
            states += element.states
        if element.efficiency_map is not None:
            row[col.PARAMETER_2] = -1.0 - knots.add(element.efficiency_map)
    speed, load = schedules
    drive[[col.SPEED_KNOT, col.SPEED_KNOTS]] = knots.add(speed), len(speed)
    drive[[col.LOAD_KNOT, col.LOAD_KNOTS]] = knots.add(load), len(load)
    return rows, knots.table


class _Knots:
    """Tables of two columns, put on top of each other."""

    def __init__(self) -> None:
        self.table: Array = np.zeros((0, 2))

    def add(self, rows: Array) -> int:
        """Add rows and return where they begin."""
        first = len(self.table)
        self.table = np.vstack([self.table, np.reshape(rows, (-1, 2))])
        return first
