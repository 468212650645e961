"""Gaps and bearings whose flow is not laminar are named with their place."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from tests.tank_circuit import pump_between_tanks
from tests.toy_machine import COUNT, GAP, OIL, toy_machine, toy_system
from toothspace import api
from toothspace.closures.line_friction import CRITICAL_REYNOLDS
from toothspace.closures.viscosity import dynamic_viscosity
from toothspace.model.assembly import System
from toothspace.model.description import FlowPath, LumpedJournalBearing, MachineDescription
from toothspace.model.path_category import INLET_PORT, PathCategory
from toothspace.numerics.periodic_table import monotone_table
from toothspace.solver.compiled_model import Observation, observe
from toothspace.solver.flow_regime import (
    _bearings,
    _gaps,
    _lines,
    gap_reynolds_number,
    taylor_number,
)
from toothspace.solver.initial import start_state


def test_numbers_by_hand() -> None:
    """10 g/s through 20 mm of 1 mPa s; 100 um round 18 mm at 7.5 m/s in jet fuel."""
    found = gap_reynolds_number(np.array(0.01), np.array(0.02), np.array(1e-3))
    assert float(found) == pytest.approx(1000.0)
    expected = 780.0 * 7.5 * 1e-4 / 1e-3 * (1.0 / 90.0) ** 0.5
    assert taylor_number(780.0, -7.5, 1e-4, 9e-3, 1e-3) == pytest.approx(expected)


def test_every_line_is_read_at_its_own_flow() -> None:
    """Lines have as many states as their cells ask for; their flow stands first among them."""

    def element(states: int, name: str) -> Any:
        law = SimpleNamespace(critical_flow=0.5)
        return SimpleNamespace(states=states, law=law, node_a=f"{name}:1", node_b="outlet")

    elements = [element(0, "orifice"), element(5, "long"), element(0, "valve"), element(1, "short")]
    circuit = SimpleNamespace(
        nodes=[SimpleNamespace(name="long:1"), SimpleNamespace(name="short:1")], elements=elements
    )
    system = SimpleNamespace(
        condition=SimpleNamespace(circuit=circuit),
        arrays=SimpleNamespace(size=SimpleNamespace(column=2)),
    )
    states = np.array([[9.0, 9.0, -1.0, 9.0, 9.0, 9.0, 9.0, 2.0]])
    found = dict(_lines(cast(Any, system), states))
    assert found == {"long": 2.0 * CRITICAL_REYNOLDS, "short": 4.0 * CRITICAL_REYNOLDS}


def looked_at(machine: MachineDescription) -> tuple[System, np.ndarray, Observation]:
    """A machine between 1 and 50 bar, its chambers as the start leaves them."""
    system = toy_system(machine)
    states = np.repeat(start_state(system)[None], 3, axis=0)
    states[:, 0] += [0.0, 0.2, 0.4]
    return system, states, observe(system.arrays, states)


@pytest.mark.parametrize("beside", [1.0, 2.0])
def test_reynolds_number_of_a_gap_is_that_of_the_pressures_at_its_ends(beside: float) -> None:
    """Re = rho h3 dp / (6 mu2 l), however many such gaps lie side by side."""
    machine = toy_machine()
    ports, leak = machine.paths[:2], machine.paths[2]
    thin = 0.5
    leak = replace(leak, multiplicity=beside, viscosity_ratio=thin)
    system, states, seen = looked_at(replace(machine, paths=(*ports, leak)))
    pressure, fluid = seen.pressure[:, :COUNT], system.arrays.fluid
    drop = np.abs(pressure - np.roll(pressure, -1, axis=1))
    ends = (dynamic_viscosity(p, fluid) for p in (pressure, np.roll(pressure, -1, axis=1)))
    viscosity = thin * np.sqrt(np.prod([*ends], axis=0))
    length = 2e-3
    expected = seen.density[:, :COUNT] * GAP**3 * drop / (6.0 * viscosity**2 * length)
    found = dict(_gaps(system, states, seen, slice(None)))
    assert found.keys() == {leak.category.label}
    assert found[leak.category.label] == pytest.approx(expected.max(), rel=0.03)


def test_taylor_number_of_every_journal_by_hand() -> None:
    machine = toy_machine()
    rotor = machine.bodies[0]
    machine = replace(
        machine,
        bodies=(rotor, replace(rotor, name="idle_gear", speed_ratio=-0.5)),
        journals=(
            LumpedJournalBearing("rotor", 1, 0.02, 0.01, 5e-5, 1e-7, 1e-5, 1e11, 1e9, 0.1),
            LumpedJournalBearing(
                "idle_gear", 1, 0.04, 0.01, 8e-5, 1e-7, 1e-5, 1e11, 1e9, 0.1, viscosity_ratio=2.0
            ),
        ),
    )
    system, _, _ = looked_at(toy_machine())
    system = replace(system, description=machine)
    fluid = system.arrays.fluid
    per_speed = fluid.reference_density / float(dynamic_viscosity(1e5, fluid))
    found = dict(_bearings(system, 100.0))
    assert found["rotor"] == pytest.approx(per_speed * 1.0 * 5e-5 * (5e-5 / 0.01) ** 0.5)
    assert found["idle gear"] == pytest.approx(0.5 * per_speed * 1.0 * 8e-5 * (8e-5 / 0.02) ** 0.5)


def test_a_gap_is_read_where_it_stands_and_with_the_oil_in_it() -> None:
    """Its own flow over the width at its angle, of all paths in parallel; what is shut is still."""
    nodes = 2.0 * np.pi * np.arange(720) / 720
    channels = np.zeros((720, 3))
    channels[:, 1] = 10e-3 * np.maximum(1.0 + 2.0 * np.cos(nodes), 0.0)
    table = monotone_table(2.0 * np.pi, channels)
    port = FlowPath(
        "port", INLET_PORT, "orifice", np.zeros(2, int), np.ones(2, int), 1.0, np.zeros(2), table
    )
    tip = PathCategory("tip", "tooth tips", "#000000", "gap")
    gap = FlowPath(
        "tips",
        tip,
        "parallel_gap",
        np.array([0, 1, 1]),
        np.array([2, 2, 2]),
        2.0,
        np.array([0.3, 1.1, np.pi - 0.8]),
        table,
        multiplicity=2.0,
        viscosity_ratio=3.0,
    )
    description = SimpleNamespace(laterals=(), paths=(gap, port))
    system = SimpleNamespace(description=description, arrays=SimpleNamespace(fluid=OIL))
    pressure = np.array([[1e5, 400e5, 100e5]])
    states = np.array([[0.4, 150.0]])
    # paths in the order of compiled code, orifices last; the last gap is shut
    flow, partner = np.zeros((1, 5)), np.full((1, 5), 2)
    flow[0] = (1e-4, -3e-3, 9.0, 9.0, 9.0)
    seen = SimpleNamespace(pressure=pressure, path_flow=flow, path_partner=partner)
    (found,) = _gaps(cast(Any, system), states, cast(Any, seen), slice(None))
    width = 2.0 * 10e-3 * (1.0 + 2.0 * np.cos(1.1 + 2.0 * 0.4))
    thick, thin = (float(dynamic_viscosity(p, OIL)) for p in (400e5, 100e5))
    expected = 2.0 * 3e-3 / (width * 3.0 * np.sqrt(thick * thin))
    assert found == ("tooth tips", pytest.approx(expected, rel=1e-3))


@pytest.mark.slow
def test_a_thin_fuel_in_wide_bearings_is_told() -> None:
    quick = {"run__samples_per_revolution": 180, "heat__model": "network"}
    wide = {
        "fluid__name": "jet_a1",
        "machine__journal_bearings__radial_clearance": "100 um",
        "operating_point__shaft_speed": "8000 rpm",
        **quick,
    }
    told = {finding.quantity: finding for finding in api.simulate("egm12_pump", **wide).warnings}
    assert "drive gear" in told["Taylor number of the journal bearings"].found
    assert "tooth tips" in told["Reynolds number of the gaps"].found
    slow = api.simulate("egm12_pump", **quick)
    assert not [finding for finding in slow.warnings if "number of the" in finding.quantity]


def test_lines_and_bearings_over_time_are_judged() -> None:
    """Jet fuel through a bore of 4 mm: beyond smooth walls; the bearings as at a constant speed."""
    tables = pump_between_tanks("8000 rpm", "4 ms", high="outlet")
    tables["fluid"]["name"] = "jet_a1"
    tables["machine"]["journal_bearings"]["radial_clearance"] = "100 um"
    tables["run"] = {"time_samples": 100}
    circuit = tables["circuit"]
    circuit["high"]["pressure"] = "5 bar"
    circuit["hose"] = {
        "kind": "hose",
        "model": "transmission_line",
        "length": "0.2 m",
        "bore": "4 mm",
        "cells": 3,
    }
    circuit["connections"][0] = ["machine.outlet", "hose"]
    circuit["connections"].append(["hose", "high"])
    told = {finding.quantity: finding for finding in api.simulate(tables).warnings}
    assert "hose" in told["Reynolds number of lines and hoses"].found
    assert "drive gear" in told["Taylor number of the journal bearings"].found
    assert "tooth tips" in told["Reynolds number of the gaps"].found
