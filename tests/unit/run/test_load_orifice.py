"""Load orifices sized for the mean pressure that is asked, or a status with advice that works."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.toy_machine import toy_machine, toy_system
from toothspace.closures.orifice import DISCHARGE_COEFFICIENT
from toothspace.core.status import Status
from toothspace.model.assembly import System
from toothspace.run import load_orifice
from toothspace.run.load_orifice import (
    LOAD_MATCH,
    OutletBalance,
    march_against_orifice,
    outlet_balance,
)
from toothspace.solver.cyclic import History, RunPlan, march_revolutions

PLAN = RunPlan(max_revolutions=40, samples_per_revolution=180)


def pump(speed: float, pressure: float) -> System:
    """Toy pump with an outlet volume at a speed [rad/s] and an outlet pressure [Pa]."""
    machine = replace(toy_machine(), port_volumes=(1e-5, 1e-5))
    return toy_system(machine, shaft_speed=speed, outlet_pressure=pressure)


@pytest.mark.parametrize("pressure", [3e5, 50e5, 150e5])
@pytest.mark.parametrize("speed", [20.0, 150.0])
def test_the_mean_pressure_is_the_asked_one_and_stays(speed: float, pressure: float) -> None:
    machine = pump(speed, pressure)
    history, told = march_against_orifice(machine, PLAN, None, None)
    balance = outlet_balance(history)
    assert (history.status, told) == (Status.DONE, "")
    assert balance.pressure == pytest.approx(pressure - 1e5, rel=LOAD_MATCH)
    assert balance.delivered == pytest.approx(balance.passed, rel=5e-3)


def test_a_pressure_at_which_all_leaks_back_is_a_status_whose_advice_works() -> None:
    history, told = march_against_orifice(pump(1.0, 300e5), PLAN, None, None)
    assert history.status is Status.NOT_REACHED
    assert "more leaks back" in told
    advised = re.search(r"to ([\d.]+) bar", told)
    assert advised
    history, told = march_against_orifice(pump(1.0, float(advised[1]) * 1e5), PLAN, None, None)
    assert (history.status, told) == (Status.DONE, "")


def test_a_later_run_begins_with_the_orifice_of_the_first(monkeypatch: pytest.MonkeyPatch) -> None:
    machine = pump(150.0, 50e5)
    first, _ = march_against_orifice(machine, PLAN, None, None)
    monkeypatch.setattr(load_orifice, "march_held", None)
    again, told = march_against_orifice(machine, PLAN, first, None)
    assert (again.status, told) == (Status.DONE, "")
    assert again.system.condition.load_area == first.system.condition.load_area


def test_rounds_end_with_what_was_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(OutletBalance, "change_of_area", lambda *_: 1.5)
    monkeypatch.setattr(load_orifice, "first_area", lambda *_: 3e-6)
    history, told = march_against_orifice(pump(150.0, 50e5), PLAN, None, None)
    assert history.status is Status.NOT_REACHED
    found = re.search(r"pressure is ([\d.]+) bar where 50 bar was asked", told)
    assert found
    assert float(found[1]) == pytest.approx(outlet_balance(history).pressure / 1e5 + 1.0)


def test_a_balance_leads_to_the_area_of_a_jet() -> None:
    """A machine that leaks in proportion, and a jet: one change of area is exact."""
    density, leak, ideal = 850.0, 1e-9, 0.2
    area, wanted, pressure = 2e-6, 80e5, 50e5

    def jet(area: float, pressure: float) -> float:
        return float(DISCHARGE_COEFFICIENT * area * np.sqrt(2.0 * density * pressure))

    balance = OutletBalance(pressure, ideal - leak * pressure, jet(area, pressure), -leak)
    changed = area * balance.change_of_area(wanted)
    assert jet(changed, wanted) == pytest.approx(ideal - leak * wanted)


def test_the_first_area_passes_what_the_model_lets_pass() -> None:
    """An orifice so fine that viscosity counts: flow of the area against the march with it."""
    asked = 250e5
    machine = pump(2.5, asked)
    condition = load_orifice.with_held_outlet(machine.condition)
    held = load_orifice.march_held(machine.under(condition), PLAN, None)
    balance = outlet_balance(held)
    area = load_orifice.first_area(held.system, balance)
    loaded = pump(2.5, asked).at(load_area=area)
    begun = load_orifice._carried(held, loaded)
    found = outlet_balance(march_revolutions(loaded, PLAN, None, begun))
    assert found.pressure == pytest.approx(asked - 1e5, rel=2e-3)


def test_a_state_that_drifts_does_not_meet_its_pressure() -> None:
    flow, wanted = 0.1, 50e5
    still = OutletBalance(wanted, flow, flow, -1e-9)
    assert still.meets(wanted)
    assert not replace(still, delivered=1.01 * flow).meets(wanted)
    assert not replace(still, pressure=1.003 * wanted).meets(wanted)


def test_a_change_stays_short_of_an_area_that_was_too_wide() -> None:
    assert load_orifice._following([(0.0, 0.5)]) == pytest.approx(0.5)
    assert load_orifice._following([(1.0, -0.9), (0.0, 0.5)]) == pytest.approx(0.5)
    assert load_orifice._following([(1.0, -0.9), (0.0, 3.0)]) == pytest.approx(0.5)
    assert load_orifice._following([(1.0, -0.9), (0.0, 0.1)]) == pytest.approx(0.1)


def test_an_orifice_without_effect_ends_the_rounds() -> None:
    narrow = OutletBalance(90e5, 0.1, 0.1, -1e-9)
    wider = replace(narrow, pressure=89.9e5)
    assert load_orifice._stuck([(0.0, 1.6)], wider, narrow, 3e5)
    assert not load_orifice._stuck([(0.0, 0.1)], wider, narrow, 3e5)
    assert not load_orifice._stuck([(0.0, 1.6)], replace(narrow, pressure=40e5), narrow, 3e5)
    assert not load_orifice._stuck([], narrow, None, 3e5)


@pytest.mark.parametrize(("miss", "status"), [(0.0, Status.DONE), (0.1, Status.NOT_REACHED)])
def test_mean_pressures_of_a_machine_that_differs_are_those_of_several_revolutions(
    miss: float, status: Status, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What one of its revolutions tells decides on nothing; a pressure that is missed is missed."""
    alone = set()

    def differing(*given: Any) -> History:
        history = replace(march_revolutions(*given), status=Status.NOT_REPEATING)
        alone.add(id(history))
        return history

    def seen(history: History) -> OutletBalance:
        balance = outlet_balance(history)
        off = 0.5 if id(history) in alone else miss
        return replace(balance, pressure=(1.0 + off) * 49e5)

    def several(history: History, *_: Any) -> History:
        return replace(history, status=Status.DONE)

    monkeypatch.setattr(load_orifice, "march_revolutions", differing)
    monkeypatch.setattr(load_orifice, "balanced", several)
    monkeypatch.setattr(load_orifice, "outlet_balance", seen)
    plan = replace(PLAN, revolutions=2)
    history, told = march_against_orifice(pump(150.0, 50e5), plan, None, None)
    assert history.status is status
    assert bool(told) == (status is Status.NOT_REACHED)
