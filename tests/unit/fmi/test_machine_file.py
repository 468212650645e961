"""The file of a machine: where its variables are in memory, their signs and starts."""

from __future__ import annotations

import struct
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.toy_machine import AMPLITUDE, COUNT, toy_machine
from toothspace.circuit.shaft_loads import FreeShaft
from toothspace.core.types import Array
from toothspace.fmi import machine_file
from toothspace.fmi.machine_file import MachineVariable
from toothspace.model import arrays as col
from toothspace.model.assembly import System, assemble, node_places
from toothspace.model.description import Motion
from toothspace.model.fluid import GasModel, fluid_law
from toothspace.model.operating_point import OperatingCondition
from toothspace.solver.initial import start_state

LAW = fluid_law("iso_vg_46", 323.15, GasModel(law="none", dissolved_air_fraction=0.08))
CONDITION = OperatingCondition(
    shaft_speed=150.0, inlet_pressure=1e5, outlet_pressure=50e5, drain_pressure=1e5
)


def cylinders(condition: OperatingCondition = CONDITION, **changes: Any) -> System:
    return assemble(replace(toy_machine(), **changes), LAW, condition)


class Block:
    """Variables of a system, and their values in a block of memory that is laid out for them."""

    def __init__(self, system: System, reached: Array | None = None) -> None:
        self.system, self.memory = system, machine_file._Memory()
        self.given = start_state(system)
        self.reached = self.given.copy() if reached is None else reached
        # something stands before, so that no place is zero by chance
        self.memory.add((np.arange(9.0), system.arrays))
        found = machine_file._variables(system, self.memory, self.given, self.reached)
        self.variables: dict[str, MachineVariable] = {one.name: one for one in found}

    def at(self, place: int) -> float:
        (found,) = struct.unpack_from("<d", self.memory.content(), place)
        return float(found)

    def value(self, name: str) -> float:
        return self.at(self.variables[name].place)


def test_flows_count_into_the_inlet_and_out_of_all_other_ports() -> None:
    """What the integrator keeps is the mass that has left through a port."""
    block = Block(cylinders(drain="external"))
    signs = {
        name: one.factor for name, one in block.variables.items() if one.name.endswith("flow_rate")
    }
    assert signs == {"inlet_flow_rate": -1.0, "outlet_flow_rate": 1.0, "drain_flow_rate": 1.0}
    places = node_places(block.system.description, CONDITION)
    node = block.system.arrays.node
    for number, port in enumerate(("inlet", "outlet", "drain"), 1):
        flow, pressure = (block.variables[f"{port}_{what}"] for what in ("flow_rate", "pressure"))
        mass = int(block.system.arrays.balance[places[port], 0])
        block.reached[mass] = 0.25 * number
        assert block.at(flow.place) == 0.25 * number
        assert block.at(flow.density) == node[places[port], col.DENSITY] > 800.0
        assert block.at(pressure.place) == pressure.start
        assert pressure.other == places[port]
    starts = [block.variables[f"{port}_pressure"].start for port in ("inlet", "outlet", "drain")]
    assert starts == [1e5, 50e5, 1e5]


@pytest.mark.parametrize(("mode", "sign"), [("pump", 1.0), ("motor", -1.0)])
def test_a_torque_is_that_which_a_pump_takes_or_a_motor_gives(mode: str, sign: float) -> None:
    block = Block(cylinders(mode=mode))
    block.system.arrays.torque[-1] = 3.25
    assert block.value("shaft_torque") == 3.25
    assert block.variables["shaft_torque"].factor == sign


def test_speed_is_given_and_the_angle_reached() -> None:
    block = Block(cylinders())
    block.given[:2], block.reached[:2] = (0.1, 140.0), (0.2, 130.0)
    assert block.value("shaft_speed") == 140.0
    assert block.value("shaft_angle") == 0.2
    assert block.variables["shaft_speed"].start == 150.0


def test_the_inertia_that_is_given_adds_to_that_of_the_machine() -> None:
    """The rotor of the cylinders has 1e-5 kg m2."""
    free = replace(CONDITION, shaft_speed=0.0, free_shaft=FreeShaft(inertia=3e-4))
    block = Block(cylinders(free))
    inertia = block.variables["shaft_inertia"]
    assert inertia.start == 3e-4
    assert inertia.factor == pytest.approx(1e-5)
    assert block.at(inertia.place) == pytest.approx(3.1e-4)
    assert block.variables["shaft_speed"].start == 0.0
    assert block.variables["load_torque"].start == 0.0


def test_chambers_and_bodies_are_read_at_their_own_places() -> None:
    motions = (Motion("rotor", "x"), Motion("rotor", "y"), Motion("rotor", "rotation"))
    system = cylinders()
    described = replace(system.description, motions=motions)
    block = Block(replace(system, description=described, free_motions=(0, 2)))
    for k, label in enumerate(block.system.description.chamber_labels):
        block.system.arrays.node[k, col.PRESSURE] = 1e5 * (k + 2)
        assert block.value(f"chamber_pressure[{label}]") == 1e5 * (k + 2)
    first = block.system.arrays.size.position
    for k, (axis, unit) in enumerate((("x", "m"), ("rotation", "rad"))):
        block.reached[first + k] = 1e-6 * (k + 1)
        assert block.value(f"position[rotor {axis}]") == 1e-6 * (k + 1)
        assert block.variables[f"position[rotor {axis}]"].unit == unit


def test_pumps_of_given_flow_deliver_what_the_machine_displaces() -> None:
    """Six strokes of a turn, at the speed of the operating point; against any pressure."""
    machine = replace(toy_machine(), port_volumes=(20e-6, 30e-6))
    network = machine_file._flow_ports(machine, CONDITION, ("inlet", "outlet"))
    flow = 2.0 * AMPLITUDE * COUNT * 150.0 / (2.0 * np.pi)
    for element in network.elements:
        assert element.history[:, 1] == pytest.approx([flow, flow])
        law = element.law
        # flow is displacement * speed * efficiency less slip
        assert (law.displacement, law.slip, law.offset, law.slope) == (1.0, 0.0, 1.0, 0.0)
    assert [(n.name, n.pressure, n.volume) for n in network.nodes] == [
        ("inlet", 1e5, 20e-6),
        ("outlet", 50e5, 30e-6),
    ]
