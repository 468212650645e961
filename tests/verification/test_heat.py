"""Temperatures in runs: films thin their oil, the heat balance closes, misuse is refused."""

from __future__ import annotations

import numpy as np
import pytest

import toothspace as ts
from toothspace.case.shipped import shipped_case
from toothspace.core.errors import CaseError
from toothspace.core.units import ZERO_CELSIUS
from toothspace.model.fluid import library_liquid
from toothspace.run.heating import HeatSearch

CASE = shipped_case("egm12_motor")
QUICK = ["run.samples_per_revolution=180", "run.relative_tolerance=1e-5"]


def summary(*overrides: str):
    solution = ts.simulate(ts.load_case(CASE, [*QUICK, *overrides]))
    return solution, solution.summary()


@pytest.fixture(scope="module")
def network():
    return summary("heat.model=network")


@pytest.fixture(scope="module")
def coupled():
    return summary("heat.model=coupled")


def test_network_leaves_the_run_as_it_is(network) -> None:
    _, numbers = network
    solution, adiabatic = summary("heat.model=adiabatic")
    assert "temperature" not in solution.data
    assert numbers["overall_efficiency"] == adiabatic["overall_efficiency"]
    outlet = numbers["outlet_temperature_degC"]
    assert outlet == pytest.approx(adiabatic["outlet_temperature_degC"], abs=5e-3)
    assert numbers["drain_temperature_degC"] < adiabatic["drain_temperature_degC"] - 10.0


@pytest.mark.slow
def test_oil_stays_within_the_temperatures_of_real_machines(coupled) -> None:
    _, numbers = coupled
    assert 55.0 < numbers["drain_temperature_degC"] < 80.0
    assert 55.0 < numbers["highest_film_temperature_degC"] < 80.0


@pytest.mark.slow
def test_warm_films_are_thinner_in_friction_and_leakage(network, coupled) -> None:
    cold, warm = network[1], coupled[1]
    film = warm["highest_film_temperature_degC"] + ZERO_CELSIUS
    ratio = library_liquid("iso_vg_46", film).dynamic_viscosity
    ratio /= library_liquid("iso_vg_46", 50.0 + ZERO_CELSIUS).dynamic_viscosity
    lateral = warm["torque_loss_lateral_viscous_N_m"] / cold["torque_loss_lateral_viscous_N_m"]
    assert lateral == pytest.approx(ratio, rel=0.01)
    leakage = warm["leakage_drain_L_per_min"] / cold["leakage_drain_L_per_min"]
    # dynamic head of the flow takes part of the drop; pressures of the spaces move by 1 %
    assert (1.0 / ratio) ** 0.8 < leakage < 1.01 / ratio
    assert warm["hydromechanical_efficiency"] > cold["hydromechanical_efficiency"]
    assert warm["volumetric_efficiency"] < cold["volumetric_efficiency"]


@pytest.mark.slow
def test_films_that_would_be_too_hot_with_cold_oil_are_found() -> None:
    fast = ("operating_point.shaft_speed=6000 rpm", "operating_point.inlet_pressure=21 bar")
    _, cold = summary(*fast, "heat.model=network")
    solution, numbers = summary(*fast, "heat.model=coupled")
    assert cold["highest_film_temperature_degC"] > 140.0
    assert 70.0 < numbers["highest_film_temperature_degC"] < 100.0
    assert not any("still change" in told.sentence for told in solution.warnings)


def test_soon_after_the_start_films_are_as_cold_as_the_supply(network) -> None:
    solution, numbers = summary("heat.model=network", "heat.running_time='1 ms'")
    assert numbers["highest_film_temperature_degC"] == pytest.approx(50.0, abs=1.0)
    assert solution.statistics["warm_up_time"] == network[0].statistics["warm_up_time"]


@pytest.mark.parametrize(
    ("case", "overrides"),
    [
        ("egm12_motor", ["run.fidelity=ideal", "heat.oil_conductivity='0.12 W/(m K)'"]),
        ("startup_blocked", ["heat.bearing_flushing='0.1 L/min'"]),
        ("egm12_motor", ["run.fidelity=elastic", "run.film_oil_share=0.5"]),
    ],
)
def test_heat_is_refused_where_it_would_be_ignored(case: str, overrides: list[str]) -> None:
    with pytest.raises(CaseError, match=r"(heat|run\.film_oil_share): found"):
        ts.load_case(shipped_case(case), overrides)


@pytest.mark.slow
def test_single_revolutions_lead_to_the_temperatures_of_whole_runs(
    monkeypatch: pytest.MonkeyPatch, coupled
) -> None:
    begun = []

    def never(search: HeatSearch, turned) -> None:
        begun.append(search)

    monkeypatch.setattr(HeatSearch, "come_near", never)
    whole, numbers = summary("heat.model=coupled")
    assert begun
    near, also = coupled
    apart = np.abs(near.data["temperature"].values - whole.data["temperature"].values)
    assert apart.max() < 0.2
    for name in ("mean_torque_N_m", "volumetric_efficiency", "hydromechanical_efficiency"):
        assert also[name] == pytest.approx(numbers[name], rel=5e-4)
