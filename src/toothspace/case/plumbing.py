"""From the circuit of a case to nodes and elements of the model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from toothspace.case import circuit as keys
from toothspace.case.lines import (
    LineCell,
    check_wall,
    end_cell,
    line_parts,
    relaxed_wall,
    wall_flexibility,
)
from toothspace.closures.fluid_law import FluidLaw
from toothspace.closures.viscosity import dynamic_viscosity
from toothspace.core.constants import ATMOSPHERIC_PRESSURE
from toothspace.core.errors import CaseError
from toothspace.core.signals import read_grid, read_signal
from toothspace.core.types import Array
from toothspace.model.circuit_description import (
    CircuitElement,
    CircuitNetwork,
    CircuitNode,
    CircuitOrifice,
    FreeShaft,
    ShaftCoupling,
)
from toothspace.model.description import MachineDescription
from toothspace.model.ledger import PORT_NODES

_ONE_PORT = (keys.Hose, keys.Volume, keys.Accumulator, keys.Tank)
_TWO_PORT = (
    keys.Orifice,
    keys.ReliefValve,
    keys.CheckValve,
    keys.ProportionalValve,
    keys.Cooler,
    keys.PumpMap,
)
_REFERENCE_DISCHARGE = 0.7
_ROUNDING = 5e3

Place = tuple[str, int]
"""Element and which of its ends; elements of one end have end 0."""


def plumb(
    circuit: keys.Circuit, description: MachineDescription, fluid: FluidLaw
) -> CircuitNetwork:
    """Join the elements of a case to nodes of one pressure each.

    Parameters
    ----------
    circuit : CircuitNetwork
        Keys of ``[circuit]``.
    description : MachineDescription
        The machine, with the volumes at its ports.
    fluid : FluidLaw
        Constants of the fluid; the wall of a hose takes the compliance that its fluid leaves.

    Raises
    ------
    CaseError
        If an end stays open, two tanks are joined, or nothing holds fluid between elements.
    """
    names = _node_names(circuit)
    tanks = [e for e in circuit.elements.values() if isinstance(e, keys.Tank)]
    supply = tanks[0].pressure if tanks else ATMOSPHERIC_PRESSURE
    start = circuit.initial_pressure or supply
    members: dict[str, list[Any]] = {name: [] for name in names.values()}
    hoses = {n: e for n, e in circuit.elements.items() if isinstance(e, keys.Hose)}
    for name, hose in hoses.items():
        check_wall(hose, fluid, f"circuit.{name}")
    waves = {name: hose for name, hose in hoses.items() if hose.carries_waves}
    for (name, _), node in names.items():
        element = circuit.elements.get(name)
        if name in waves:
            members[node].append(end_cell(waves[name], fluid))
        elif isinstance(element, _ONE_PORT):
            members[node].append(element)
    lines = [
        line_parts(name, hose, (names[name, 0], names[name, 1]), start, fluid)
        for name, hose in waves.items()
    ]
    ports = dict(zip(("inlet", "outlet"), description.port_volumes, strict=True))
    nodes = [
        _node(name, parts, ports.get(name, 0.0), start, fluid) for name, parts in members.items()
    ]
    for name, hose in hoses.items():
        if hose.wall_stiffening > 1.0 and wall_flexibility(hose, fluid) > 0.0:
            own = next(node for node in nodes if node.name == names[name, 0])
            lines.append(relaxed_wall(name, own, hose, fluid))
    return CircuitNetwork(
        nodes=(*nodes, *(node for line in lines for node in line.nodes)),
        elements=(
            *_elements(circuit, names, fluid),
            *(column for line in lines for column in line.columns),
        ),
        orifices=tuple(
            CircuitOrifice(
                names[name, 0],
                names[name, 1],
                (element.area or 0.25 * np.pi * (element.diameter or 0.0) ** 2)
                * element.discharge_coefficient
                / _REFERENCE_DISCHARGE,
            )
            for name, element in circuit.elements.items()
            if isinstance(element, keys.Orifice)
        ),
        supply_pressure=supply,
    ).with_tank_ends()


def _node_names(circuit: keys.Circuit) -> dict[Place, str]:
    """Node of every end; joined ends share one, named after a machine port if there is one."""
    seen: dict[str, int] = {}
    group: dict[Place, set[Place]] = {}
    for pair in circuit.connections:
        ends = [_end(circuit, name, seen) for name in pair]
        joined = group.get(ends[0], {ends[0]}) | group.get(ends[1], {ends[1]})
        group.update(dict.fromkeys(joined, joined))
    _check_ends(circuit, seen)
    return {place: _node_name(circuit, joined) for place, joined in group.items()}


def _end(circuit: keys.Circuit, name: str, seen: dict[str, int]) -> Place:
    """End that a mention of an element means: the first of a valve is its upstream end."""
    element = circuit.elements.get(name)
    if not _has_two_ends(element):
        return name, 0
    seen[name] = seen.get(name, 0) + 1
    return name, min(seen[name], 2) - 1


def _has_two_ends(element: Any) -> bool:
    return isinstance(element, _TWO_PORT) or (
        isinstance(element, keys.Hose) and element.carries_waves
    )


def _check_ends(circuit: keys.Circuit, seen: Mapping[str, int]) -> None:
    for name, element in circuit.elements.items():
        if not _has_two_ends(element) or isinstance(element, keys.PumpMap):
            continue
        if seen.get(name, 0) < 2:
            raise CaseError(
                "circuit.connections",
                f"one connection of {name!r}",
                "two: its upstream end, then its downstream end",
            )
    mentioned = {name for pair in circuit.connections for name in pair}
    for port in ("machine.inlet", "machine.outlet"):
        if port not in mentioned:
            raise CaseError("circuit.connections", f"no {port}", "circuits that join it")


def _node_name(circuit: keys.Circuit, joined: set[Place]) -> str:
    """Name of a machine port, else of a part that holds fluid, else of an end.

    A part that is called like a node of the machine must not become that node.
    """
    ports = sorted(name for name, _ in joined if name.startswith("machine."))
    if len(ports) > 1:
        raise CaseError("circuit.connections", f"{ports} joined", "one port per node")
    if ports:
        return ports[0].removeprefix("machine.")
    parts = {name: circuit.elements.get(name) for name, _ in joined}
    holding = [n for n, e in parts.items() if isinstance(e, _ONE_PORT) and not _has_two_ends(e)]
    name = min(holding, default=min(f"{name}_{end}" for name, end in joined))
    return f"{name}:part" if name in PORT_NODES else name


def _node(
    name: str, parts: list[Any], port_volume: float, start: float, fluid: FluidLaw
) -> CircuitNode:
    tanks = [part for part in parts if isinstance(part, keys.Tank)]
    if len(tanks) > 1:
        raise CaseError("circuit.connections", "two tanks joined", "one tank per node")
    if tanks:
        return CircuitNode(name, tanks[0].pressure)
    node = CircuitNode(name, start, port_volume)
    for part in parts:
        node = _enlarge(node, part, fluid)
    if node.volume <= 0.0:
        raise CaseError(
            "circuit.connections",
            f"nothing that holds fluid at {name!r}",
            "a hose, volume, accumulator, tank or machine port at every joint",
        )
    return node


def _enlarge(node: CircuitNode, part: Any, fluid: FluidLaw) -> CircuitNode:
    """Add the fluid volume and the compliance of a part to a node."""
    if isinstance(part, keys.Volume):
        return replace(node, volume=node.volume + part.volume)
    if isinstance(part, LineCell):
        compliance = node.wall_compliance + part.wall_compliance
        return replace(node, volume=node.volume + part.volume, wall_compliance=compliance)
    if isinstance(part, keys.Accumulator):
        if node.gas_volume > 0.0:
            raise CaseError("circuit.connections", "two accumulators joined", "one")
        return replace(
            node,
            volume=node.volume + part.fluid_volume,
            gas_volume=part.gas_volume,
            precharge=part.precharge,
            gas_exponent=part.gas_exponent,
        )
    volume = 0.25 * np.pi * part.bore**2 * part.length
    compliance = volume * wall_flexibility(part, fluid) / part.wall_stiffening
    return replace(
        node, volume=node.volume + volume, wall_compliance=node.wall_compliance + compliance
    )


def _elements(
    circuit: keys.Circuit, names: Mapping[Place, str], fluid: FluidLaw
) -> list[CircuitElement]:
    found = []
    for name, element in circuit.elements.items():
        ends = names.get((name, 0), ""), names.get((name, 1), "")
        if isinstance(element, keys.PumpMap):
            found.append(_pump(element, ends, fluid))
        elif isinstance(element, (keys.ReliefValve, keys.CheckValve)):
            law = (element.opening_pressure, element.gradient, _ROUNDING)
            found.append(CircuitElement("pressure_valve", *ends, law))
        elif isinstance(element, keys.ProportionalValve):
            area = element.discharge_coefficient * element.area
            opening = history(element, "opening", "1")
            found.append(CircuitElement("proportional_valve", *ends, (area,), opening))
        elif isinstance(element, keys.Cooler):
            linear = element.laminar_share * element.pressure_drop / element.flow_rate
            square = (1.0 - element.laminar_share) * element.pressure_drop / element.flow_rate**2
            found.append(CircuitElement("resistance", *ends, (linear, square)))
    return found


def _pump(pump: keys.PumpMap, ends: tuple[str, str], fluid: FluidLaw) -> CircuitElement:
    """A pump that is joined once draws from the tank, else from its first connection."""
    suction, pressure = ends if ends[1] else ("supply", ends[0])
    line = pump.volumetric_efficiency
    slip = pump.slip * pump.displacement
    slip /= float(dynamic_viscosity(ATMOSPHERIC_PRESSURE, fluid))
    return CircuitElement(
        "supply_pump",
        suction,
        pressure,
        (pump.displacement, line.offset, line.per_100_bar / 1e7, slip),
        history(pump, "speed", "rpm"),
        _efficiency_map(pump.table) if pump.table else None,
    )


def _efficiency_map(path: Path) -> Array:
    units = {"speed": "rpm", "pressure_difference": "bar", "volumetric_efficiency": "1"}
    speeds, rises, efficiency = read_grid(path, units)
    column = np.concatenate([speeds, rises, efficiency.ravel()])
    rows = np.column_stack([column, np.zeros_like(column)])
    return np.vstack([[speeds.size, rises.size], rows])


def history(element: Any, name: str, unit: str) -> Array:
    """Time [s] and value of a signal that stands in the case or in a file. [SI]."""
    file = getattr(element, f"{name}_file")
    if file is not None:
        return read_signal(file, name, unit)
    return np.asarray(getattr(element, name), dtype=float)


def shaft_of(circuit: keys.Circuit, description: MachineDescription) -> FreeShaft | None:
    """The free shaft with its loads; None where a source prescribes its speed.

    Raises
    ------
    CaseError
        If more than one load torque is given, or nothing that can turn or resist.
    """
    if speed_of(circuit) is not None:
        return None
    parts = circuit.elements.values()
    fans = [part for part in parts if isinstance(part, keys.Fan)]
    sources = [part for part in parts if isinstance(part, keys.TorqueSource)]
    if len(sources) > 1:
        raise CaseError("circuit", "two torque sources", "one")
    turning = sum(part.inertia for part in parts if isinstance(part, (keys.Fan, keys.Inertia)))
    startup = description.startup
    return FreeShaft(
        inertia=turning,
        coupling=_coupling(circuit, turning),
        square=sum(fan.quadratic for fan in fans),
        linear=sum(fan.linear for fan in fans),
        cubic=sum(fan.cubic for fan in fans),
        breakaway_torque=startup.torque if startup else 0.0,
        breakaway_speed=startup.speed if startup else 1.0,
        breakaway_law=startup.law if startup else "total",
        seal_ratio=startup.seal_ratio if startup else 1.0,
        load_schedule=history(sources[0], "torque", "N m") if sources else np.zeros((0, 2)),
    )


def _coupling(circuit: keys.Circuit, load_inertia: float) -> ShaftCoupling | None:
    parts = [part for part in circuit.elements.values() if isinstance(part, keys.Coupling)]
    if len(parts) > 1:
        raise CaseError("circuit", "two couplings", "one")
    if parts and load_inertia <= 0.0:
        raise CaseError(
            "circuit",
            "a coupling without inertia beyond it",
            "one with a fan or an inertia above 0 kg m^2",
        )
    return ShaftCoupling(parts[0].stiffness, parts[0].damping) if parts else None


def speed_of(circuit: keys.Circuit) -> Array | None:
    """Prescribed shaft speed over time, None where the shaft is free. [s], [rad/s]."""
    sources = [part for part in circuit.elements.values() if isinstance(part, keys.SpeedSource)]
    if len(sources) > 1:
        raise CaseError("circuit", "two speed sources", "one")
    couplings = [part for part in circuit.elements.values() if isinstance(part, keys.Coupling)]
    if sources and couplings:
        raise CaseError("circuit", "a coupling and a speed source", "one of them")
    return history(sources[0], "speed", "rpm") if sources else None
