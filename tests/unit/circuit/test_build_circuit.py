"""From the elements of a case to nodes: ports that share a tank, and circuits that cannot be."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.unit.circuit.test_circuit_ledger import check, motor
from toothspace import api
from toothspace.circuit import network as net
from toothspace.circuit.circuit import build_circuit
from toothspace.circuit.elements import LAWS, element_flow
from toothspace.circuit.history import Tables
from toothspace.circuit.network import CircuitElement, CircuitNetwork
from toothspace.circuit.restrictions import Cooler
from toothspace.core.errors import CaseError


def network(connections: list[list[str]], **elements: dict[str, Any]) -> CircuitNetwork:
    case = motor(connections, elements)
    assert case.circuit is not None
    return build_circuit(case.circuit, (5e-5, 5e-5), api.fluid_of(case))


def test_two_ports_joined_without_a_tank_are_refused() -> None:
    with pytest.raises(CaseError, match="joined, allowed one port per node"):
        network([["machine.inlet", "machine.outlet"], ["machine.inlet", "store"]])


def test_ports_that_share_a_tank_have_a_node_each() -> None:
    """Inlet, drain and what a valve returns, all joined to one tank: all are accounted."""
    joints = [["low", "machine.inlet"], ["machine.drain", "low"]]
    joints += [["machine.outlet", "x"], ["x", "low"]]
    orifice = {"kind": "orifice", "diameter": "3 mm"}
    found = network(joints, x=orifice)
    held = {node.name: node.pressure for node in found.nodes if node.volume == 0.0}
    assert held == {"inlet": 1e5, "drain": 1e5, "low": 1e5}
    joints[0] = ["high", "machine.inlet"]
    check(api.simulate(motor(joints, {"x": orifice})))


def test_a_pump_joined_once_draws_from_the_tank() -> None:
    pump = {"kind": "pump_map", "displacement": "5 cm^3", "speed": [["0 s", "300 rpm"]]}
    joints = [["x", "store"], ["store", "machine.inlet"], ["machine.outlet", "low"]]
    (element,) = network(joints, x=pump).elements
    assert (element.node_a, element.node_b) == ("supply", "inlet")
    (element,) = network([["low", "x"], *joints], x=pump).elements
    assert element.node_a.startswith("outlet")  # the tank that the outlet stands in
    assert element.supplies


def test_a_row_has_ends_tables_and_law() -> None:
    history = np.array([[0.0, 1.0], [2.0, 3.0]])
    law = Cooler(pressure_drop=1e5, flow_rate=1e-4).law
    element = CircuitElement(law, "a", "b", history=history, states=0)
    tables = Tables()
    tables.add(np.zeros((3, 2)))
    (row,) = CircuitNetwork(elements=(element,)).rows({"a": 7, "b": 4}, LAWS, tables)
    assert [row[net.END_A], row[net.END_B]] == [7, 4]
    assert [row[net.FIRST_KNOT], row[net.KNOTS]] == [3, 2]
    assert tables.rows.shape == (5, 2)
    flow, slope = element_flow(row, tables.rows, 1e5, 850.0, 0.0)
    assert flow == pytest.approx(1e-4, rel=1e-6)
    step = element_flow(row, tables.rows, 1e5 + 10.0, 850.0, 0.0)[0] - flow
    assert slope == pytest.approx(step / 10.0, rel=1e-3)


def test_every_law_fits_its_row() -> None:
    assert max(len(law._fields) for law in LAWS) <= net.LAW_FIELDS
