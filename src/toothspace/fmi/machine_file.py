"""A machine as a file that the C library reads: the words and the memory of its model.

See ``native/c/toothspace.h`` for what reads it.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from toothspace import api
from toothspace.case import Case
from toothspace.circuit.network import FIRST_KNOT, CircuitElement, CircuitNetwork, CircuitNode
from toothspace.circuit.pumps import SupplyPump
from toothspace.circuit.shaft_loads import FreeShaft
from toothspace.core.compilation.library import chosen
from toothspace.core.errors import CaseError
from toothspace.core.progress import Progress
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.assembly import System, assemble, node_places
from toothspace.model.description import MachineDescription
from toothspace.model.operating_point import OperatingCondition
from toothspace.numerics.ndf_types import CONTROL, make_record
from toothspace.run.run import warmed_through
from toothspace.solver.compiled_model import Integration, empty_observation
from toothspace.solver.initial import start_state
from toothspace.solver.integrator import start_march

DRIVES = ("speed", "torque")
"""What moves the shaft: its speed is an input, or follows from torques and inertia."""

FLOW_PORTS = ("inlet", "outlet")
"""Ports whose flow may be the input, with their pressure an output."""

_MAGIC = b"TOOTHSP1"
_EVENTS = 64
_SHAFT_INERTIA = 1e-3
"""Inertia of shaft and load where torques move the shaft. [kg m2]"""
_FOREVER = 1e12
"""End of a prescribed speed until the first step. [s]"""
_ALIGNED = 64

PORT_PRESSURE, SHAFT_SPEED, LOAD_TORQUE, NUMBER, FLOW, PORT_FLOW, INERTIA = range(7)
"""What a variable of the file is."""
INPUTS = (PORT_PRESSURE, SHAFT_SPEED, LOAD_TORQUE, PORT_FLOW, INERTIA)


@final
@dataclass(frozen=True)
class MachineVariable:
    """A variable of the file; what is given comes first."""

    name: str
    unit: str
    role: int
    """One of those above."""
    start: float
    """Value at the start. [unit]"""
    place: int
    """Place in memory. [byte]"""
    density: int = 0
    other: int = 0
    """Of a port the place of its density, and its node."""
    factor: float = 1.0
    """Factor on the value; of an inertia what the machine has itself."""

    @property
    def is_input(self) -> bool:
        """Whether the program sets it."""
        return self.role in INPUTS


@final
@dataclass(frozen=True)
class MachineFile:
    """A machine as bytes that the C library reads."""

    content: bytes
    variables: tuple[MachineVariable, ...]
    title: str


@final
@dataclass
class _Memory:
    """Arrays one after the other, those that share memory once, and words that describe them."""

    words: list[int] = field(default_factory=list)
    addresses: list[tuple[int, int]] = field(default_factory=list)
    parts: list[NDArray[Any]] = field(default_factory=list)
    size: int = 0
    _places: dict[int, int] = field(default_factory=dict)

    def place(self, array: NDArray[Any], *index: int) -> int:
        """Place of an item of an array in the memory. [byte]."""
        root = array
        while isinstance(root.base, np.ndarray):
            root = root.base
        if id(root) not in self._places:
            self._places[id(root)] = self.size
            self.parts.append(root)
            self.size += -(-max(root.nbytes, 1) // _ALIGNED) * _ALIGNED
        begin = _address(array) - _address(root)
        item = sum(k * step for k, step in zip(index, array.strides, strict=False))
        return self._places[id(root)] + begin + item

    def add(self, value: Any) -> None:
        """Append the words of a number, an array or a tuple of them."""
        if isinstance(value, np.ndarray):
            self.words += [value.size, 0, *value.shape, *value.strides]
            ahead = 1 + 2 * value.ndim
            self.addresses.append((len(self.words) - ahead, self.place(value)))
        elif isinstance(value, tuple):
            for item in value:
                self.add(item)
        elif isinstance(value, float):
            self.words += struct.unpack("<q", struct.pack("<d", value))
        else:
            self.words.append(int(value))

    def content(self) -> bytes:
        """Bytes of all arrays."""
        out = np.zeros(self.size, np.uint8)
        for part in self.parts:
            begin = self._places[id(part)]
            flat = part.ravel(order="K").view(np.uint8) if part.size else np.zeros(0, np.uint8)
            out[begin : begin + part.nbytes] = flat
        return out.tobytes()


def _address(array: NDArray[Any]) -> int:
    return int(array.__array_interface__["data"][0])


def machine_file(
    case: Case,
    *,
    drive: str = "speed",
    flows: Sequence[str] = (),
    progress: Progress | None = None,
) -> MachineFile:
    """Return the file of a machine at its operating point, its films as warm as there.

    Parameters
    ----------
    case : Case
        Case with an operating point.
    drive : str
        ``speed``: the shaft speed is an input; ``torque``: the shaft starts from rest under the
        load torque, an input.
    flows : sequence of str
        Ports whose flow is an input: their pressure follows from the fluid in the port. All other
        ports are held at pressures that are inputs.
    progress : callable, optional
        Called with the finished share and a short text.

    Raises
    ------
    CaseError
        If the case has no operating point, or there is no library that the file would fit.
    """
    if drive not in DRIVES:
        raise CaseError("--drive", repr(drive), " or ".join(map(repr, DRIVES)))
    for port in flows:
        if port not in FLOW_PORTS:
            raise CaseError("--flow", repr(port), " or ".join(map(repr, FLOW_PORTS)))
    if case.operating_point is None or not case.run.preset.has_losses:
        raise CaseError(case.label, "no [operating_point] with losses", "a steady case with losses")
    library = chosen()[2]
    if library is None:
        raise CaseError("compiled code", chosen()[1], "the library of the installed version")
    run = warmed_through(api.prepare(case).worn(progress).with_films(progress), progress)
    given = replace(run.condition, load_area=0.0, circuit=None)
    if flows:
        given = replace(given, circuit=_flow_ports(run.machine, given, tuple(dict.fromkeys(flows))))
    steady = assemble(run.machine, run.fluid, given)
    if drive == "torque":
        moved = replace(given, shaft_speed=0.0, free_shaft=FreeShaft(inertia=_SHAFT_INERTIA))
        system = assemble(run.machine, run.fluid, moved)
        state = start_state(system)
    else:
        # a prescribed speed over time, which steps of the library change
        kept = np.array([[0.0, given.shaft_speed], [_FOREVER, given.shaft_speed]])
        system = assemble(run.machine, run.fluid, replace(given, speed_schedule=kept))
        state = start_state(steady)
    content, variables = _file(system, state, library.digest)
    return MachineFile(content, variables, case.title or case.name)


def _flow_ports(
    machine: MachineDescription, condition: OperatingCondition, ports: tuple[str, ...]
) -> CircuitNetwork:
    """Fluid in these ports, each with an ideal pump whose flow steps of the library change."""
    flow = machine.displacement * condition.shaft_speed
    history = np.array([[0.0, flow], [_FOREVER, flow]])
    pressures = {"inlet": condition.inlet_pressure, "outlet": condition.outlet_pressure}
    ends = {"inlet": ("supply", "inlet"), "outlet": ("outlet", "supply")}
    return CircuitNetwork(
        nodes=tuple(
            CircuitNode(port, pressures[port], machine.port_volumes[FLOW_PORTS.index(port)])
            for port in ports
        ),
        elements=tuple(
            CircuitElement(SupplyPump(1.0, 0.0, 1.0, 0.0), *ends[port], history, supplies=True)
            for port in ports
        ),
        supply_pressure=pressures[ports[0]],
    )


def _file(system: System, state: Array, digest: str) -> tuple[bytes, tuple[MachineVariable, ...]]:
    march = start_march(system, state)
    arrays, memory = system.arrays, march.state
    total = arrays.size.total
    record = make_record(np.zeros(1), total, _EVENTS)
    integration = Integration(march.program, march.settings, memory, record)
    times, states, given = np.zeros(1), np.zeros((1, total)), state.copy()
    block = _Memory()
    block.add((0, arrays, integration, empty_observation(arrays, 1)))
    time = len(block.words)
    block.add((0.0, given, times, states))
    variables = tuple(
        sorted(
            _variables(system, block, given, memory.y), key=lambda variable: not variable.is_input
        )
    )
    inputs = sum(variable.is_input for variable in variables)
    drive = arrays.drive
    columns = (col.FREE, col.DIRECTION, col.DRIVING_TORQUE, col.HOLDING_TORQUE, col.BREAKAWAY)
    scheduled = drive[col.SPEED_KNOTS] > 0.0
    head = struct.pack(
        "<8s16s22q",
        _MAGIC,
        digest.encode(),
        *(len(block.words), len(block.addresses), block.size, len(variables), inputs, total),
        *(0, time),
        *(block.place(given), block.place(times), block.place(states)),
        *(block.place(record.sample_times), block.place(record.counts), block.place(memory.y)),
        block.place(memory.control) + CONTROL.fields["valid_until"][1],  # type: ignore[index]
        *(block.place(drive, column) for column in (*columns, col.PRESENT_LOAD)),
        block.place(arrays.schedule, int(drive[col.SPEED_KNOT])) if scheduled else -1,
    )
    content = b"".join(
        (
            head,
            *(
                struct.pack(
                    "<40s16s4qd",
                    *(one.name.encode(), one.unit.encode(), one.role),
                    *(one.place, one.density, one.other, one.factor),
                )
                for one in variables
            ),
            struct.pack(f"<{len(block.words)}q", *block.words),
            *(struct.pack("<2q", *one) for one in block.addresses),
            block.content(),
        )
    )
    return content, variables


def _variables(
    system: System, block: _Memory, given: Array, reached: Array
) -> Iterator[MachineVariable]:
    """All variables, in the order in which a program wants to see them."""
    arrays, description, condition = system.arrays, system.description, system.condition
    places = node_places(description, condition)
    node, drive = arrays.node, arrays.drive
    ports = ["inlet", "outlet", *(["drain"] if description.drain == "external" else [])]
    by_flow = [place.name for place in condition.circuit.nodes] if condition.circuit else []
    for port, sign in zip(ports, (-1.0, 1.0, 1.0), strict=False):
        k = places[port]
        pressure, density = (block.place(node, k, c) for c in (col.PRESSURE, col.DENSITY))
        start = float(node[k, col.PRESSURE])
        if port in by_flow:
            first = int(arrays.elements[by_flow.index(port), FIRST_KNOT])
            flow = float(arrays.schedule[first, 1])
            place = block.place(arrays.schedule, first, 1)
            yield MachineVariable(f"{port}_flow_rate", "m3/s", PORT_FLOW, flow, place)
            yield MachineVariable(f"{port}_pressure", "Pa", NUMBER, start, pressure)
            continue
        yield MachineVariable(f"{port}_pressure", "Pa", PORT_PRESSURE, start, pressure, 0, k)
        mass = block.place(reached, int(arrays.balance[k, 0]))
        yield MachineVariable(f"{port}_flow_rate", "m3/s", FLOW, 0.0, mass, density, factor=sign)
    speed = float(given[1])
    if condition.free_shaft is None:
        place = block.place(given, 1)
        yield MachineVariable("shaft_speed", "rad/s", SHAFT_SPEED, speed, place)
    else:
        load, inertia = (block.place(drive, c) for c in (col.PRESENT_LOAD, col.INERTIA))
        own = float(drive[col.INERTIA]) - condition.free_shaft.inertia
        yield MachineVariable("load_torque", "N m", LOAD_TORQUE, 0.0, load)
        yield MachineVariable(
            "shaft_inertia", "kg m2", INERTIA, condition.free_shaft.inertia, inertia, factor=own
        )
        yield MachineVariable("shaft_speed", "rad/s", NUMBER, speed, block.place(reached, 1))
    turned = -1.0 if description.mode == "motor" else 1.0
    torque = block.place(arrays.torque, arrays.torque.size - 1)
    yield MachineVariable("shaft_torque", "N m", NUMBER, 0.0, torque, factor=turned)
    yield MachineVariable("shaft_angle", "rad", NUMBER, float(given[0]), block.place(reached, 0))
    for k, label in enumerate(description.chamber_labels):
        pressure = block.place(node, k, col.PRESSURE)
        yield MachineVariable(f"chamber_pressure[{label}]", "Pa", NUMBER, 0.0, pressure)
    for k, motion in enumerate(system.free_motions):
        entry = description.motions[motion]
        where = block.place(reached, arrays.size.position + k)
        unit = "rad" if entry.axis == "rotation" else "m"
        yield MachineVariable(f"position[{entry.body} {entry.axis}]", unit, NUMBER, 0.0, where)
