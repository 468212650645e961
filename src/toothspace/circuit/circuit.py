"""``[circuit]``: named elements and their connections, and the network that they make."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, final

from toothspace.circuit.electric_drive import ElectricDrive, LinkedDrive
from toothspace.circuit.elements import ELEMENTS
from toothspace.circuit.fmu import ForeignUnit, LinkedUnit
from toothspace.circuit.network import PORT_NODES, CircuitNetwork, CircuitNode, FluidPart
from toothspace.circuit.stores import Tank
from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.errors import CaseError
from toothspace.core.frozen import FrozenDict
from toothspace.core.keys import (
    KeyTable,
    Named,
    Row,
    Text,
    Variant,
    declare,
    items,
    quantity,
)
from toothspace.core.units import ATMOSPHERIC_PRESSURE

ELEMENT_KEY = Variant(tag="kind", variants=ELEMENTS, doc="Circuit element.")
MACHINE_PORTS = ("machine.inlet", "machine.outlet", "machine.drain")

Place = tuple[str, int]
"""Element and which of its ends; elements of one end have end 0."""


@final
@dataclass(frozen=True, kw_only=True)
class Circuit(KeyTable):
    """``[circuit]``: duration, start, elements by name and which are joined."""

    duration: float = quantity("s", "Simulated time.", above=0, high=1e5)
    initial_shaft_speed: float = quantity(
        "rpm", "Shaft speed at time zero.", low=-50000, high=50000, default=0.0
    )
    initial_pressure: float | None = quantity(
        "bar",
        "Absolute pressure of all volumes at time zero; default that of the first tank.",
        above=0,
        high=1000,
        default=None,
    )
    initial_shaft_angle: float = quantity(
        "deg", "Shaft angle at time zero.", low=-360, high=360, default=0.0
    )
    connections: tuple[tuple[str, str], ...] = items(
        Row(items=(Text(), Text())),
        "Pairs of element names or machine.inlet, machine.outlet, machine.drain.",
    )
    elements: Mapping[str, Any] = declare(
        Named(item=ELEMENT_KEY, beside=True, doc="Elements by name."), FrozenDict()
    )

    def __post_init__(self) -> None:
        # connections to unknown elements, and fluid elements that nothing joins
        fluid = list(self.parts)
        allowed = [*fluid, *MACHINE_PORTS]
        joined = [name for pair in self.connections for name in pair]
        for name in joined:
            if name not in allowed:
                raise CaseError("connections", repr(name), f"one of {', '.join(allowed)}")
        for name in fluid:
            if name not in joined:
                raise CaseError(name, "an element without connection", "an entry in connections")
        for name, unit in self.units.items():
            unit.check_links(name, self.elements, [p for p in MACHINE_PORTS if p in joined])

    @property
    def parts(self) -> Mapping[str, FluidPart]:
        """Elements that hold or pass fluid, by name."""
        return {n: e for n, e in self.elements.items() if isinstance(e, FluidPart)}

    @property
    def units(self) -> Mapping[str, ForeignUnit]:
        """Units of other programs, by name."""
        return {n: e for n, e in self.elements.items() if isinstance(e, ForeignUnit)}


def build_circuit(
    circuit: Circuit, port_volumes: tuple[float, float], fluid: FluidLaw
) -> CircuitNetwork:
    """Join the elements of a case to nodes of one pressure each.

    Raises CaseError if an end stays open, two tanks are joined, or nothing holds fluid between
    elements.

    Parameters
    ----------
    circuit : Circuit
        Keys of ``[circuit]``.
    port_volumes : tuple of float
        Fluid at inlet and outlet of the machine. [m3]
    fluid : FluidLaw
        Constants of the fluid; the wall of a hose takes the compliance that its fluid leaves.
    """
    parts = circuit.parts
    tanks = [part for part in parts.values() if isinstance(part, Tank)]
    supply = tanks[0].pressure if tanks else ATMOSPHERIC_PRESSURE
    start = circuit.initial_pressure or supply
    held = dict(zip(("inlet", "outlet"), port_volumes, strict=True))
    nodes: dict[Place, CircuitNode] = {}
    for joined in _joints(circuit):
        nodes |= _nodes_of(joined, parts, held, start, fluid)
    built = CircuitNetwork(tuple(dict.fromkeys(nodes.values())), supply_pressure=supply)
    rows: dict[str, int] = {}
    for name, part in parts.items():
        rows[name] = len(built.elements)
        ends = [nodes[name, end].name for end in range(2) if (name, end) in nodes]
        a, b = ("supply", *ends)[-2:] if part.draws_alone else (ends[0], ends[-1])
        added = part.build(name, (a, b), start, fluid)
        built = replace(
            built,
            nodes=(*built.nodes, *added.nodes),
            elements=(*built.elements, *added.elements),
            orifices=(*built.orifices, *added.orifices),
        )
    units = tuple(_linked(name, unit, nodes, rows) for name, unit in circuit.units.items())
    drives = tuple(
        LinkedDrive(name, drive)
        for name, drive in circuit.elements.items()
        if isinstance(drive, ElectricDrive)
    )
    return replace(built.with_tank_ends(), units=(*units, *drives)).with_led_histories()


def _linked(
    name: str, unit: ForeignUnit, nodes: Mapping[Place, CircuitNode], rows: Mapping[str, int]
) -> LinkedUnit:
    """Unit with the nodes whose pressures it is told and the rows that it sets."""
    told, sets = [], []
    for variable, source in unit.inputs:
        place, _, what = source.rpartition(".")
        if what == "pressure" and (place, 0) not in nodes:
            raise CaseError(f"circuit.{name}.inputs", repr(source), "a place that fluid reaches")
        told.append((variable, what, nodes[place, 0].name if what == "pressure" else ""))
    for variable, target in unit.outputs:
        element, _, what = target.rpartition(".")
        sets.append((variable, what, rows.get(element, -1)))
    return LinkedUnit(name, unit, tuple(told), tuple(sets))


def _joints(circuit: Circuit) -> list[list[Place]]:
    """Ends that are joined with each other; every port of the machine must be."""
    seen: dict[str, int] = {}
    group: dict[Place, list[Place]] = {}
    for pair in circuit.connections:
        ends: list[Place] = []
        for name in pair:
            part = circuit.parts.get(name)
            if part is None or part.ends == 1:
                ends.append((name, 0))
                continue
            # an element that is mentioned first means its upstream end
            seen[name] = seen.get(name, 0) + 1
            ends.append((name, min(seen[name], 2) - 1))
        first, second = ends
        joined = list(dict.fromkeys([*group.get(first, [first]), *group.get(second, [second])]))
        group |= dict.fromkeys(joined, joined)
    for name, part in circuit.parts.items():
        if part.ends == 2 and seen.get(name, 0) < 2 and not part.draws_alone:
            raise CaseError(
                "circuit.connections",
                f"one connection of {name!r}",
                "two: its upstream end, then its downstream end",
            )
    for port in ("machine.inlet", "machine.outlet"):
        if (port, 0) not in group:
            raise CaseError("circuit.connections", f"no {port}", "circuits that join it")
    return list({id(joined): joined for joined in group.values()}.values())


def _nodes_of(
    joined: Iterable[Place],
    parts: Mapping[str, FluidPart],
    port_volumes: Mapping[str, float],
    start: float,
    fluid: FluidLaw,
) -> dict[Place, CircuitNode]:
    """Node of all ends that are joined; ports that share a tank have one each."""
    ports = sorted(place for place in joined if place[0].startswith("machine."))
    here = {place: parts[place[0]] for place in joined if place[0] in parts}
    tanks = [part for part in here.values() if isinstance(part, Tank)]
    if len(tanks) > 1:
        raise CaseError("circuit.connections", "two tanks joined", "one tank per node")
    own = {place: place[0].removeprefix("machine.") for place in ports}
    if len(ports) > 1 and not tanks:
        found = [name for name, _ in ports]
        raise CaseError("circuit.connections", f"{found} joined", "one port per node")
    if len(ports) == 1:
        name = own[ports[0]]
    else:
        # of a part that holds fluid, else of an end; it must not become a node of the machine
        holding = [name for (name, _), part in here.items() if part.ends == 1]
        name = min(holding, default=min(f"{name}_{end}" for name, end in here))
        name = f"{name}:part" if name in PORT_NODES else name
    if tanks:
        pressure = tanks[0].pressure
        return {place: CircuitNode(own.get(place, name), pressure) for place in joined}
    node = CircuitNode(name, start, port_volumes.get(name, 0.0))
    for part in here.values():
        node = part.fill(node, fluid)
    if node.volume <= 0.0:
        raise CaseError(
            "circuit.connections",
            f"nothing that holds fluid at {name!r}",
            "a hose, volume, accumulator, tank or machine port at every joint",
        )
    return dict.fromkeys(joined, node)
