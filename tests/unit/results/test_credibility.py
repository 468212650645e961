"""A result outside the range of its models says so."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.fake_solution import fake_solution
from tests.tank_circuit import pump_between_tanks
from toothspace.api import load_case, simulate
from toothspace.case import Case
from toothspace.core.finding import Finding
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.model.fluid import highest_pressure
from toothspace.results.credibility import temperatures_beyond, temperatures_of, with_warnings
from toothspace.results.solution import Solution
from toothspace.run import run as lumped

CASES = Path(__file__).resolve().parents[3] / "cases"


def warnings(solution: Solution, highest: float = 1e8) -> str:
    return "\n".join(told.sentence for told in with_warnings(solution, highest).warnings)


def test_a_plausible_result_has_no_warning() -> None:
    assert warnings(fake_solution()) == ""


def test_pressures_beyond_the_fluid_are_told() -> None:
    found = warnings(fake_solution(), 100e5)
    assert "the properties of the fluid are known to 100 bar only" in found
    highest = float(fake_solution().data["chamber_pressure"].max())
    assert f"Pressures reach {highest / 1e5:.4g} bar" in found
    assert "give machine.relief_grooves" in found


def test_enclosed_fluid_is_let_out_of_what_the_machine_has() -> None:
    """Grooves that are there are moved, and pockets of rotors have none."""
    solution = fake_solution()
    grooved = {"case_toml": "[machine.relief_grooves]\ndepth = 1"}
    found = warnings(replace(solution, provenance=grooved), 100e5)
    assert "move the edges of machine.relief_grooves" in found
    labels = [f"pocket_{k}" for k in range(solution.data.sizes["chamber"])]
    rotors = solution.data.assign_coords(chamber=labels)
    found = warnings(replace(solution, data=rotors), 100e5)
    assert "widen machine.rotors.tip_clearance" in found
    assert "relief_grooves" not in found


@pytest.mark.parametrize(
    ("name", "factor", "part"),
    [
        ("mass", 0.9, "Volumetric efficiency is"),
        ("mass", 1.5, "Hydromechanical efficiency is"),
        ("energy", 1.5, "Overall efficiency is"),
        ("mass", -0.9, "the mean flow runs backwards"),
        ("energy", -0.5, "The shaft is driven from outside"),
    ],
)
def test_an_efficiency_above_one_or_below_nought_is_told(
    name: str, factor: float, part: str
) -> None:
    solution = fake_solution()
    entry = {"mass": "inlet", "energy": "shaft"}[name]
    accounts = dict(getattr(solution.ledger, name))
    accounts[entry] *= factor
    ledger = replace(solution.ledger, **{name: accounts})
    assert part in warnings(replace(solution, ledger=ledger))


@pytest.mark.parametrize(
    ("sign", "reason"), [(-1.0, "moving walls drag"), (1.0, "Look at the timing of the ports")]
)
def test_a_small_surplus_names_its_cause(sign: float, reason: str) -> None:
    """Thick oil at low pressure: walls carry more through the gaps than leaks back."""
    solution = fake_solution()
    factor = float(solution.summary()["volumetric_efficiency"]) / 1.002
    mass = {**solution.ledger.mass, "inlet": factor * solution.ledger.mass["inlet"]}
    data = solution.data.assign(leakage=sign * solution.data["leakage"])
    found = warnings(replace(solution, data=data, ledger=replace(solution.ledger, mass=mass)))
    assert "is 1.0020, above 1" in found
    assert reason in found


def test_a_run_that_was_cut_off_is_not_blamed_on_its_tolerance() -> None:
    whole = fake_solution()
    accounts = {**whole.ledger.energy, "shaft": 1.1 * whole.ledger.energy["shaft"]}
    poor = replace(whole, ledger=replace(whole.ledger, energy=accounts))
    assert "Tighten run.relative_tolerance" in warnings(poor)
    assert "Energy balance" not in warnings(replace(poor, status=Status.NOT_STORED))


def test_range_of_fluids(tmp_path: Path) -> None:
    assert highest_pressure("iso_vg_46", 323.15) == 1e8
    assert highest_pressure("jet_a1", 323.15) == 5e7
    rows = [f"{t},{p},{800.0 + 0.1 * p},2.0" for t in (20, 60) for p in (1, 100, 200 + t)]
    table = tmp_path / "fluid.csv"
    header = "temperature [degC],pressure [bar],density [kg/m3],dynamic_viscosity [mPa s]"
    table.write_text("\n".join([header, *rows]), encoding="utf-8")
    assert highest_pressure(table, 313.15) == pytest.approx(220e5)


def test_every_simulated_case_is_checked(monkeypatch: pytest.MonkeyPatch) -> None:
    case = load_case(CASES / "egm12_motor.toml")

    monkeypatch.setattr(lumped, "simulate", lambda *_: fake_solution())
    assert not simulate(case).warnings
    monkeypatch.setattr("toothspace.api.fluid_limits", lambda _: (100e5, (0.0, 1e3)))
    (told,) = simulate(case).warnings
    assert "known to 100 bar" in told.sentence


@pytest.mark.parametrize(
    ("speed", "high", "mesh", "parts"),
    [
        ("1500 rpm", "outlet", "rigid", []),
        ("-1500 rpm", "inlet", "rigid", ["The rigid mesh pulls"]),
        ("-1500 rpm", "inlet", "elastic", []),
        ("1500 rpm", "inlet", "elastic", ["The bearing blocks lean"]),
    ],
)
def test_a_machine_that_runs_another_way_is_told(
    speed: str, high: str, mesh: str, parts: list[str]
) -> None:
    """Backwards the other flanks carry; driven as a motor it is loaded from the other side."""
    run = {"mesh": mesh, "time_samples": 100}
    tables = pump_between_tanks(speed, "40 ms", high=high) | {"run": run}
    told = simulate(Case.from_dict(tables, CASES)).warnings
    found = " ".join(one.sentence for one in told)
    for part in ("The rigid mesh pulls", "The bearing blocks lean"):
        assert (part in found) == (part in parts), found


def told_of(quantity: str, *, contact_model: str = "rigid", **variables: Any) -> list[Finding]:
    """Warnings about one quantity of the made-up result with other variables."""
    data = fake_solution().data.drop_vars("running_in_depth").assign(variables)
    solution = replace(fake_solution(), data=data, provenance={"contact_model": contact_model})
    found = with_warnings(solution, 1e8).warnings
    return [one for one in found if isinstance(one, Finding) and one.quantity == quantity]


def contact_forces(*values: float) -> tuple[tuple[str, str], Array]:
    """Force of one contact that goes evenly between values over the samples, of twelve."""
    force = np.zeros((360, 12))
    force[:, 3] = np.repeat(values, 360 // len(values))
    return ("shaft_angle", "contact"), force


@pytest.mark.parametrize(("pull", "count"), [(49.0, 0), (51.0, 1)])
def test_a_rigid_mesh_may_pull_with_a_twentieth_of_its_push(pull: float, count: int) -> None:
    force = contact_forces(1000.0, -pull)
    told = told_of("Pull of the rigid mesh", contact_force=force)
    assert len(told) == count
    assert all((one.found, one.allowed) == ("51 N", "up to 50 N") for one in told)


@pytest.mark.parametrize(("least", "count"), [(510.0, 0), (490.0, 1)])
def test_a_blow_is_more_than_half_of_the_largest_force(least: float, count: int) -> None:
    force = contact_forces(1000.0, least)
    name = "Change of the contact force from one sample to the next"
    told = told_of(name, contact_model="compliant", contact_force=force)
    assert len(told) == count
    assert all((one.found, one.allowed) == ("510 N", "up to 500 N") for one in told)
    assert all("come from 360 states of a revolution" in one.text + one.advice for one in told)


@pytest.mark.parametrize(("depth", "count"), [(0.49e-6, 0), (0.52e-6, 1)])
def test_tips_may_cut_half_a_micrometre(depth: float, count: int) -> None:
    told = told_of("Cut of the tips, driven gear", tip_gap_minimum=("body", [1e-6, -depth]))
    assert len(told) == count
    assert all((one.found, one.allowed) == ("0.52 µm", "up to 0.5 µm") for one in told)


@pytest.mark.parametrize(("sense", "count"), [(-1.0, 0), (1.0, 1)])
def test_blocks_lean_away_from_what_journals_press_them_to(sense: float, count: int) -> None:
    """Journals are carried by forces away from where their blocks are seated."""
    force = fake_solution().data["journal_force"].mean("shaft_angle")
    assert len(told_of("Place of the bearing blocks", seat_position=sense * force)) == count


def test_a_body_out_of_mesh_is_named_with_half_a_pitch() -> None:
    solution = fake_solution()
    turned = np.zeros((360, 2))
    turned[-1] = np.deg2rad([3.0, -20.0])
    data = solution.data.assign(body_rotation=(("shaft_angle", "body"), turned))
    solution = replace(solution, data=data, status=Status.OUT_OF_MESH)
    (told,) = (one for one in with_warnings(solution, 1e8).warnings if "mesh" in one.quantity)
    assert "Driven gear has turned by 20 deg" in told.text
    assert "at a tooth pitch of 30 deg" in told.text
    assert told.allowed == "up to 15 deg"


def test_the_place_farthest_out_of_the_range_of_the_fluid_is_named() -> None:
    """Oil comes with 50 degC, and a film is 80 K warmer."""
    solution = fake_solution()
    solution = replace(
        solution, statistics={**solution.statistics, "lateral_temperature_rise": 80.0}
    )
    places = temperatures_of(solution)
    assert places["lateral film"] == pytest.approx(403.15)
    assert places["outlet"] == pytest.approx(solution.summary()["outlet_temperature_degC"] + 273.15)
    (hot,) = temperatures_beyond(solution, 273.15, 353.15)
    assert (hot.found, hot.allowed) == ("130 °C (lateral film)", "0 to 80 °C")
    (cold,) = temperatures_beyond(solution, 473.15, 573.15)
    assert cold.allowed == "200 to 300 °C"
    coldest = min(places, key=lambda place: places[place])
    assert cold.found == f"{places[coldest] - 273.15:.4g} °C ({coldest})"
    assert not list(temperatures_beyond(solution, 273.15, 473.15))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("case", "hits"), [("gerotor_cycloidal", True), ("gerotor_trochoidal", False)]
)
def test_contacts_made_with_a_blow_are_told(case: str, hits: bool) -> None:
    """With 20 um at tips and faces a cycloidal lobe comes back with 60 mm/s; others slide."""
    gaps = "machine.rotors.tip_clearance=20 um", "machine.lateral.side_gap=20 um"
    solution = simulate(load_case(CASES / f"{case}.toml", gaps))
    assert any("made with a blow" in told.sentence for told in solution.warnings) == hits
    assert solution.provenance["contact_model"] == "compliant"
