"""A circuit as the model sees it: nodes of one pressure, what joins them, and its rows in arrays.

Volumes (hoses, lines, accumulators) are dynamic nodes of the network, tanks hold their pressure,
orifices are flow paths like those of the machine, and every other element has a row: its ends, its
tables and its law. Flow counts from a to b.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple, final

import numpy as np

from toothspace.circuit.electric_drive import LinkedDrive
from toothspace.circuit.fmu import LinkedUnit
from toothspace.circuit.history import Tables, no_history
from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.keys import KeyTable
from toothspace.core.types import Array

PORT_NODES = ("inlet", "outlet", "drain", "load", "supply")
"""Nodes after the chambers: three ports, the far side of a load, the tank of a supply pump."""

# Columns of a row: history over time and further table by first row and count, first state of its
# own and their number, whether its work comes from outside; present mass flow with its slopes by
# the pressures at both ends; then the fields of its law.
(
    KIND, END_A, END_B, FIRST_KNOT, KNOTS, FIRST_ROW, ROWS, FIRST_STATE, STATES, SUPPLIES,
    FLOW, FLOW_BY_A, FLOW_BY_B, LAW,
) = range(14)  # fmt: skip
LAW_FIELDS = 4
_LATER = 1e-3
COLUMNS = LAW + LAW_FIELDS


def law_columns(law: type[NamedTuple]) -> range:
    """Columns of the fields of a law in a row."""
    return range(LAW, LAW + len(law._fields))


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

    def grown(self, volume: float, wall_compliance: float = 0.0) -> CircuitNode:
        """With more fluid [m3] and wall [m3/Pa]."""
        compliance = self.wall_compliance + wall_compliance
        return replace(self, volume=self.volume + volume, wall_compliance=compliance)


@final
@dataclass(frozen=True)
class CircuitElement:
    """An element between two nodes whose flow follows from its law."""

    law: Any
    """Named fields of one of :data:`toothspace.circuit.elements.LAWS`. [SI]"""
    node_a: str
    node_b: str
    """Names of nodes; ``supply`` is the tank of a pump."""
    history: Array = field(default_factory=no_history)
    """Time [s] and value of what changes over time, joined by straight lines. Shape (knots, 2)."""
    table: Array = field(default_factory=no_history)
    """Further numbers that the law reads. Shape (rows, 2)."""
    states: int = 0
    """States of its own, the flow first; else the flow follows from the pressures at once."""
    supplies: bool = False
    """Whether its work on the fluid comes from outside; else its loss is one of the circuit."""
    turns: bool = False
    """Whether its history is the speed of a shaft. [rad/s]"""


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
    """Nodes, elements and orifices round a machine, or a part of them."""

    nodes: tuple[CircuitNode, ...] = ()
    """Places with volume, and tanks."""
    elements: tuple[CircuitElement, ...] = ()
    orifices: tuple[CircuitOrifice, ...] = ()
    """What joins them."""
    supply_pressure: float = 1e5
    """Absolute pressure of the tank that supply pumps draw from. [Pa]"""
    units: tuple[LinkedUnit | LinkedDrive, ...] = ()
    """Units of other programs, and a drive, that receive values of the run and set histories."""
    tank_ends: tuple[CircuitNode, ...] = ()
    """Ends of elements and orifices at tanks, each a tank that accounts for its own flow."""

    @property
    def all_nodes(self) -> tuple[CircuitNode, ...]:
        """Nodes and ends at tanks."""
        return (*self.nodes, *self.tank_ends)

    @property
    def states(self) -> int:
        """States of all elements."""
        return sum(element.states for element in self.elements)

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

    def with_led_histories(self) -> CircuitNetwork:
        """Give two knots to every history that a unit sets: where it begins and where it goes."""
        led = {row for unit in self.units for _, _, row in unit.sets if row >= 0}
        elements = tuple(
            replace(element, history=led_history(element.history)) if k in led else element
            for k, element in enumerate(self.elements)
        )
        return replace(self, elements=elements)

    def leads(self, key: str) -> bool:
        """Whether a unit sets the speed or the torque of the shaft."""
        return any(row < 0 and what == key for unit in self.units for _, what, row in unit.sets)

    def rows(self, places: Mapping[str, int], laws: tuple[type, ...], tables: Tables) -> Array:
        """Rows of the elements as compiled code reads them; their tables join the others.

        ``places`` are the numbers of the nodes, ``laws`` all laws in the order of their kinds.
        """
        rows, state = np.zeros((len(self.elements), COLUMNS)), 0
        for row, element in zip(rows, self.elements, strict=True):
            row[KIND] = laws.index(type(element.law))
            row[[END_A, END_B]] = places[element.node_a], places[element.node_b]
            row[[FIRST_KNOT, KNOTS]] = tables.add(element.history)
            row[[FIRST_ROW, ROWS]] = tables.add(element.table)
            row[[FIRST_STATE, STATES]] = state, element.states
            row[SUPPLIES] = element.supplies
            row[LAW : LAW + len(element.law)] = element.law
            state += element.states
        return rows


def led_history(history: Array) -> Array:
    """Two knots at the first value of a history."""
    return np.array([[0.0, history[0, 1]], [_LATER, history[0, 1]]])


@dataclass(frozen=True, kw_only=True)
class FluidPart(KeyTable):
    """Keys of an element that fluid flows into or through."""

    @property
    def ends(self) -> int:
        """Nodes that it joins: upstream and downstream, or one."""
        return 2

    @property
    def draws_alone(self) -> bool:
        """Whether it takes from the tank where its first end is not joined."""
        return False

    def fill(self, node: CircuitNode, fluid: FluidLaw) -> CircuitNode:
        """Node with what this part holds at each of its ends."""
        return node

    def build(
        self, name: str, ends: tuple[str, str], start: float, fluid: FluidLaw
    ) -> CircuitNetwork:
        """What stands between the nodes at its ends, the same where it has one.

        ``start`` is the absolute pressure at the start. [Pa]
        """
        return CircuitNetwork()
