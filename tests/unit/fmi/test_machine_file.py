"""The file of a machine: where its variables are in memory, their signs and starts."""

from __future__ import annotations

import struct
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.toy_machine import AMPLITUDE, CONDITION, COUNT, OIL, toy_machine
from toothspace.circuit.shaft_loads import FreeShaft
from toothspace.core.types import Array
from toothspace.fmi import machine_file
from toothspace.fmi.machine_file import MachineVariable
from toothspace.model import arrays as col
from toothspace.model.assembly import System, assemble, node_places
from toothspace.model.description import Motion
from toothspace.model.operating_point import OperatingCondition
from toothspace.solver.initial import start_state
from toothspace.solver.integrator import start_march


def cylinders(condition: OperatingCondition = CONDITION, **changes: Any) -> System:
    return assemble(replace(toy_machine(), **changes), OIL, condition)


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


def test_arrays_that_share_memory_are_laid_out_once_and_on_even_places() -> None:
    memory = machine_file._Memory()
    whole, short = np.arange(40.0).reshape(10, 4), np.arange(5.0)
    part = whole[3:, 1:]
    assert memory.place(short) == 0
    assert memory.place(whole) == 64
    place = memory.place(part, 2, 1)
    assert place == 64 + 8 * (5 * 4 + 2)
    assert memory.place(np.zeros(0)) == 64 + 320
    assert memory.size == 64 + 320 + 64
    content = memory.content()
    assert len(content) == memory.size
    assert struct.unpack_from("<d", content, place) == (part[2, 1],)
    assert struct.unpack_from("<5d", content, 0) == (0.0, 1.0, 2.0, 3.0, 4.0)


def test_words_of_an_array_are_its_size_address_shape_and_strides() -> None:
    memory = machine_file._Memory()
    memory.add((7, np.zeros((10, 4)), 2.5, np.zeros(3)))
    assert memory.words[:7] == [7, 40, 0, 10, 4, 32, 8]
    assert struct.pack("<q", memory.words[7]) == struct.pack("<d", 2.5)
    assert memory.words[8:] == [3, 0, 3, 8]
    # where an address is written, and the place that it is of
    assert memory.addresses == [(2, 0), (9, 320)]


@pytest.mark.parametrize("scheduled", [False, True])
def test_a_file_begins_with_where_its_parts_are(scheduled: bool) -> None:
    knots = np.array([[0.0, 150.0], [1e12, 150.0]])
    condition = replace(CONDITION, speed_schedule=knots) if scheduled else CONDITION
    system = cylinders(condition)
    state = start_state(system)
    content, variables = machine_file._file(system, state, "0123456789abcdef")
    head, record = "<8s16s22q", "<40s16s4qd"
    magic, digest, words, addresses, size, count, inputs, total, *places = struct.unpack_from(
        head, content
    )
    assert (magic, digest) == (b"TOOTHSP1", b"0123456789abcdef")
    assert (count, total) == (len(variables), state.size)
    told = [one.is_input for one in variables]
    assert told == sorted(told, reverse=True)
    assert sum(told) == inputs == 3
    begin = struct.calcsize(head)
    for k, one in enumerate(variables):
        name, unit, role, place, *_, factor = struct.unpack_from(
            record, content, begin + k * struct.calcsize(record)
        )
        assert name.rstrip(b"\0").decode() == one.name
        assert unit.rstrip(b"\0").decode() == one.unit
        assert (role, place, factor) == (one.role, one.place, one.factor)
    begin += count * struct.calcsize(record)
    memory = begin + 8 * words + 16 * addresses
    assert len(content) == memory + size
    # every address stands behind the size of its array
    listed = struct.unpack_from(f"<{words}q", content, begin)
    for k in range(addresses):
        word, place = struct.unpack_from("<2q", content, begin + 8 * words + 16 * k)
        assert listed[word] == 0 <= listed[word - 1]
        assert 0 <= place < size
    given, schedule = places[2], places[-1]
    found = struct.unpack_from(f"<{state.size}d", content, memory + given)
    assert found == pytest.approx(state)
    if scheduled:
        assert struct.unpack_from("<4d", content, memory + schedule) == (0.0, 150.0, 1e12, 150.0)
    else:
        assert schedule == -1
    # time up to which steps were made, in the record of the integrator
    control = start_march(system, state).state.control
    offset = control.dtype.fields["valid_until"][1]
    (kept,) = np.frombuffer(content, control.dtype, 1, memory + places[8] - offset)
    assert kept == control[0]
