"""A machine as a file that the C library reads: the words and the memory of its model.

See ``native/c/toothspace.h`` for what reads it.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from toothspace import api
from toothspace.case import Case
from toothspace.circuit.shaft_loads import FreeShaft
from toothspace.core.compilation.library import chosen
from toothspace.core.errors import CaseError
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.assembly import System, assemble, node_places
from toothspace.model.operating_point import OperatingCondition
from toothspace.numerics.ndf_types import CONTROL, make_record
from toothspace.solver.compiled_model import Integration, empty_observation
from toothspace.solver.initial import start_state
from toothspace.solver.integrator import start_march

DRIVES = ("speed", "torque")
"""What moves the shaft: its speed is an input, or follows from torques and inertia."""

_MAGIC = b"TOOTHSP1"
_EVENTS = 64
_SHAFT_INERTIA = 1e-3
"""Inertia of shaft and load where torques move the shaft. [kg m2]"""
_FOREVER = 1e12
"""End of a prescribed speed until the first step. [s]"""
_ALIGNED = 64

PORT_PRESSURE, SHAFT_SPEED, LOAD_TORQUE, NUMBER, FLOW = range(5)
"""What a variable of the file is."""


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


def machine_file(case: Case, *, drive: str = "speed") -> bytes:
    """Return the file of a machine at its operating point.

    Parameters
    ----------
    case : Case
        Case with an operating point; its ports are held at pressures that are inputs.
    drive : str
        ``speed``: the shaft speed is an input; ``torque``: the shaft starts from rest under the
        load torque, an input.

    Raises
    ------
    CaseError
        If the case has no operating point, or there is no library that the file would fit.
    """
    if drive not in DRIVES:
        raise CaseError("--drive", repr(drive), " or ".join(map(repr, DRIVES)))
    if case.operating_point is None or not case.run.preset.has_losses:
        raise CaseError(case.label, "no [operating_point] with losses", "a steady case with losses")
    library = chosen()[2]
    if library is None:
        raise CaseError("compiled code", chosen()[1], "the library of the installed version")
    run = api.prepare(case).worn().with_films()
    given = replace(run.condition, load_area=0.0, circuit=None)
    steady = assemble(run.machine, run.fluid, given)
    if drive == "torque":
        moved = replace(given, shaft_speed=0.0, free_shaft=FreeShaft(inertia=_SHAFT_INERTIA))
        system = assemble(run.machine, run.fluid, moved)
        state = start_state(system)
    else:
        system = assemble(run.machine, run.fluid, _kept_speed(given))
        state = start_state(steady)
    return _file(system, state, library.digest)


def _kept_speed(condition: OperatingCondition) -> OperatingCondition:
    """Condition with a prescribed speed over time, which steps of the library change."""
    speed = condition.shaft_speed
    return replace(condition, speed_schedule=np.array([[0.0, speed], [_FOREVER, speed]]))


def _file(system: System, state: Array, digest: str) -> bytes:
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
    variables = list(_variables(system, block, given, memory.y))
    inputs = sum(role in {PORT_PRESSURE, SHAFT_SPEED, LOAD_TORQUE} for _, _, role, *_ in variables)
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
    return b"".join(
        (
            head,
            *(
                struct.pack("<40s16s4qd", name.encode(), unit.encode(), role, *places, factor)
                for name, unit, role, places, factor in variables
            ),
            struct.pack(f"<{len(block.words)}q", *block.words),
            *(struct.pack("<2q", *one) for one in block.addresses),
            block.content(),
        )
    )


def _variables(
    system: System, block: _Memory, given: Array, reached: Array
) -> Iterator[tuple[str, str, int, tuple[int, int, int], float]]:
    """Name, unit, role, places (of itself and of a density, number of the node) and factor."""
    arrays, description = system.arrays, system.description
    places = node_places(description, system.condition)
    ports = ["inlet", "outlet", *(["drain"] if description.drain == "external" else [])]
    for port in ports:
        pressure = block.place(arrays.node, places[port], col.PRESSURE)
        yield f"{port}_pressure", "Pa", PORT_PRESSURE, (pressure, 0, places[port]), 1.0
    if system.condition.free_shaft is None:
        yield "shaft_speed", "rad/s", SHAFT_SPEED, (block.place(given, 1), 0, 0), 1.0
    else:
        load = block.place(arrays.drive, col.PRESENT_LOAD)
        yield "load_torque", "N m", LOAD_TORQUE, (load, 0, 0), 1.0
        yield "shaft_speed", "rad/s", NUMBER, (block.place(reached, 1), 0, 0), 1.0
    for port, sign in zip(ports, (-1.0, 1.0, 1.0), strict=False):
        mass = block.place(reached, int(arrays.balance[places[port], 0]))
        density = block.place(arrays.node, places[port], col.DENSITY)
        yield f"{port}_flow_rate", "m3/s", FLOW, (mass, density, 0), sign
    turned = -1.0 if description.mode == "motor" else 1.0
    torque = block.place(arrays.torque, arrays.torque.size - 1)
    yield "shaft_torque", "N m", NUMBER, (torque, 0, 0), turned
    yield "shaft_angle", "rad", NUMBER, (block.place(reached, 0), 0, 0), 1.0
    for k, label in enumerate(description.chamber_labels):
        pressure = block.place(arrays.node, k, col.PRESSURE)
        yield f"chamber_pressure[{label}]", "Pa", NUMBER, (pressure, 0, 0), 1.0
    for k, motion in enumerate(system.free_motions):
        entry = description.motions[motion]
        where = block.place(reached, arrays.size.position + k)
        unit = "rad" if entry.axis == "rotation" else "m"
        yield f"position[{entry.body} {entry.axis}]", unit, NUMBER, (where, 0, 0), 1.0
