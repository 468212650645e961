"""A result outside the range of its models says so."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tests.fake_solution import fake_solution
from tests.tank_circuit import pump_between_tanks
from toothspace.api import load_case, simulate
from toothspace.case import Case
from toothspace.core.status import Status
from toothspace.model.fluid import highest_pressure
from toothspace.results.credibility import with_warnings
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
    assert "give machine.relief_grooves" in found


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
