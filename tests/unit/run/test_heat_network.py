"""Temperatures of a machine: closed forms, limits and the balance of heat."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.toy_machine import toy_machine
from toothspace.case.conditions import HeatSettings
from toothspace.closures.heat_transfer import film_wall_conductance, turning_body_coefficient
from toothspace.model.description import LumpedJournalBearing, LumpedLateralFilm
from toothspace.model.fluid import library_liquid
from toothspace.model.path_category import DRAIN, LATERAL
from toothspace.run.heating import (
    HeatFlows,
    HeatNetwork,
    heat_network,
    journal_node,
    lateral_node,
)

SUPPLY = 323.15
LIQUID = library_liquid("iso_vg_46", SUPPLY)
CAPACITY = LIQUID.specific_heat_capacity
SETTINGS = HeatSettings(casing_heat_capacity=500.0)
LOSSES = {
    "throttle_outlet_port": 20.0,
    "journal_viscous": 40.0,
    "lateral_viscous": 30.0,
    LATERAL.account: 4.0,
    DRAIN.account: 6.0,
    "mesh_friction": 10.0,
    "shaft_seal": 5.0,
}
FLOWS = HeatFlows(150.0, LOSSES, through_flow=0.1, drain_flow=1e-3)


def machine(wetted_area: float = 2e-3):
    toy = toy_machine()
    return replace(
        toy,
        bodies=(replace(toy.bodies[0], wetted_area=wetted_area),),
        laterals=(LumpedLateralFilm("rotor", 2, 10e-6, 0.009, 0.016, 0.02, 0.5),),
        journals=(
            LumpedJournalBearing("rotor", 2, 0.018, 0.018, 10e-6, 0.0, 1e-5, 2e11, 1e9, 0.1),
        ),
        drain="external",
    )


def network(flows: HeatFlows = FLOWS, settings: HeatSettings = SETTINGS, area: float = 2e-3):
    return heat_network(machine(area), LIQUID, SUPPLY, flows, settings)


def leaving(found: HeatNetwork, temperature: dict[str, float], flows: HeatFlows) -> float:
    """Heat that oil and surroundings carry away. [W]."""
    out = flows.through_flow - flows.drain_flow
    carried = out * CAPACITY * (temperature["outlet"] - SUPPLY)
    carried += flows.drain_flow * CAPACITY * (temperature["drain"] - SUPPLY)
    ambient = found.to_ambient[found.names.index("casing")]
    return carried + ambient * (temperature["casing"] - found.ambient_temperature)


@pytest.mark.parametrize("conductance", [0.0, 3.0])
def test_all_heat_leaves_with_the_oil_or_to_the_surroundings(conductance: float) -> None:
    found = network(settings=replace(SETTINGS, housing_conductance=conductance))
    assert leaving(found, found.steady(), FLOWS) == pytest.approx(sum(LOSSES.values()), rel=1e-9)


def test_flushing_cools_the_bearings_and_keeps_the_balance() -> None:
    flushed = network(settings=replace(SETTINGS, bearing_flushing=1e-5))
    temperature, dry = flushed.steady(), network().steady()
    assert temperature[journal_node("rotor")] < dry[journal_node("rotor")] - 1.0
    flow = FLOWS.drain_flow + 1e-5 * LIQUID.density
    heat = (FLOWS.through_flow - flow) * CAPACITY * (temperature["outlet"] - SUPPLY)
    heat += flow * CAPACITY * (temperature["drain"] - SUPPLY)
    assert heat == pytest.approx(sum(LOSSES.values()), rel=1e-9)


def test_without_exchange_all_heat_of_bearings_and_faces_stays_in_the_drain() -> None:
    """The bound that a run without the network reports."""
    losses = {k: v for k, v in LOSSES.items() if k not in ("mesh_friction", "shaft_seal")}
    temperature = network(replace(FLOWS, losses=losses), area=0.0).steady()
    rise = temperature["drain"] - temperature["chambers"]
    assert rise == pytest.approx(80.0 / (FLOWS.drain_flow * CAPACITY), rel=1e-4)


def test_bodies_in_much_oil_are_as_warm_as_the_chambers() -> None:
    temperature = network(area=1e6).steady()
    assert temperature["rotor"] == pytest.approx(temperature["chambers"], abs=1e-4)


def test_film_lies_above_its_walls_by_the_conduction_of_a_slab() -> None:
    flows = HeatFlows(150.0, {"journal_viscous": 40.0}, 0.1, 0.0)
    temperature = network(flows).steady()
    area, clearance = 2 * np.pi * 0.018 * 0.018, 10e-6
    walls = 0.5 * (temperature["rotor"] + temperature["casing"])
    rise = 40.0 * clearance / (12.0 * 0.13 * area)
    assert temperature[journal_node("rotor")] - walls == pytest.approx(rise, rel=1e-9)


def test_warming_up_begins_at_the_supply_and_ends_steady() -> None:
    found = network()
    steady = found.steady()
    begin, end = found.after(0.0), found.after(50.0 * found.warm_up_time)
    half = found.after(0.5 * found.warm_up_time)
    for name, value in steady.items():
        assert begin[name] == pytest.approx(SUPPLY, abs=1e-9)
        assert end[name] == pytest.approx(value, abs=1e-6)
        assert SUPPLY - 1e-9 <= half[name] <= value + 1e-9


def test_slowest_warming_is_that_of_the_lumped_masses() -> None:
    """Films and oil follow at once, so body and casing warm up like one mass in the oil."""
    flows = HeatFlows(150.0, {"journal_viscous": 40.0}, 10.0, 0.0)
    found = network(flows, replace(SETTINGS, casing_heat_capacity=46.0))
    one_wall = found.exchange[found.names.index("rotor"), found.names.index("chambers")]
    assert found.warm_up_time == pytest.approx(46.0 / one_wall, rel=0.02)


def test_machine_without_films_has_temperatures() -> None:
    temperature = heat_network(toy_machine(), LIQUID, SUPPLY, FLOWS, SETTINGS).steady()
    assert all(np.isfinite(value) for value in temperature.values())
    assert lateral_node("rotor") not in temperature


def test_heat_transfer_closed_forms() -> None:
    assert film_wall_conductance(0.13, 1e-3, 10e-6) == pytest.approx(78.0)
    faster = turning_body_coefficient(0.13, 0.04, 300.0, 3e-5, 400.0)
    slower = turning_body_coefficient(0.13, 0.04, -150.0, 3e-5, 400.0)
    assert faster / slower == pytest.approx(2.0 ** (2.0 / 3.0))
    # Reynolds number of 300 rad/s, 40 mm and 30 cSt: 8000, of which the 2/3 power is 400
    assert faster == pytest.approx(0.133 * 400.0 * 400.0 ** (1.0 / 3.0) * 0.13 / 0.04)
    wider = turning_body_coefficient(0.26, 0.08, 300.0, 3e-5, 400.0)
    assert wider / faster == pytest.approx(2.0 * 2.0 ** (1.0 / 3.0))
