"""Temperatures outside the range of the fluid are named in every result."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from tests.fake_solution import fake_solution
from toothspace.api import simulate
from toothspace.results.credibility import temperatures_beyond, temperatures_of
from toothspace.results.performance import outlet_temperature
from toothspace.results.solution import Solution

PUMP = Path(__file__).resolve().parents[3] / "cases" / "egm12_pump.toml"
RANGE = 233.15, 393.15


def with_nodes(**temperatures: float) -> Solution:
    solution = fake_solution()
    nodes = {"outlet": 330.0, "drain": 340.0, **temperatures}
    network = xr.Dataset(
        {"temperature": ("heat_node", list(nodes.values()))}, {"heat_node": [*nodes]}
    )
    return replace(solution, data=solution.data.merge(network))


def test_temperatures_inside_the_range_are_not_told() -> None:
    assert not list(temperatures_beyond(with_nodes(casing=330.0), *RANGE))
    assert temperatures_of(fake_solution()).keys() >= {"outlet", "drain"}


@pytest.mark.parametrize(("kelvin", "shown"), [(500.0, "226.9 °C"), (200.0, "-73.15 °C")])
def test_the_farthest_place_is_named_with_the_others(kelvin: float, shown: float) -> None:
    [found] = temperatures_beyond(with_nodes(casing=kelvin, drain=395.0), *RANGE)
    assert f"{shown} (casing)" in found.text
    assert "and beyond it in: drain" in found.text
    assert found.allowed == "-40 to 120 °C"
    assert found.severity == "serious"


def test_a_rise_of_lateral_films_counts() -> None:
    hot = fake_solution().with_note(lateral_temperature_rise=200.0)
    assert "lateral film" in next(temperatures_beyond(hot, *RANGE)).text


def test_a_stream_that_runs_backwards_has_no_temperature() -> None:
    solution = fake_solution()
    mass = {**solution.ledger.mass, "outlet": -solution.ledger.mass["outlet"]}
    ledger = replace(solution.ledger, mass=mass)
    assert np.isnan(outlet_temperature(solution.data, ledger))


@pytest.mark.slow
def test_a_run_with_bearings_too_tight_says_so() -> None:
    bearings = {"machine__journal_bearings__radial_clearance": "1 um"}
    found = simulate(PUMP, operating_point__shaft_speed="8000 rpm", **bearings)
    told = [finding.text for finding in found.findings]
    assert any(text.startswith("Temperatures reach") for text in told)
