"""Gaps and bearings whose flow is not laminar are named with their place."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from tests.tank_circuit import pump_between_tanks
from toothspace import api
from toothspace.closures.line_friction import CRITICAL_REYNOLDS
from toothspace.solver.flow_regime import _lines, gap_reynolds_number, taylor_number


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
