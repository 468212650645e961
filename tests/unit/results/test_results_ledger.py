from __future__ import annotations

import pytest

from tests.fake_solution import TURN, fake_ledger
from toothspace.results.ledger import Ledger, ledger_from, power_ledger


def pump(remainder: float = 0.0) -> Ledger:
    """A pump that takes 100 J: 90 J into the fluid, 8 J losses, 2 J stored."""
    energy = {
        "shaft": 100.0 + remainder,
        "port_inlet": 5.0,
        "port_outlet": 94.0,
        "port_drain": 1.0,
        "rotor_gap": 3.0,
        "journal_viscous": 5.0,
        "stored_change": 2.0,
        "load_orifice": 94.0,
    }
    mass = {"inlet": 1.0, "outlet": 0.9, "drain": 0.1}
    return Ledger(2.0, TURN, mass, energy, {"rotor_gap": "leakage, gap of the rotor"})


def test_losses_of_paths_have_the_labels_of_their_machine() -> None:
    rows = {row.name: row.label for row in power_ledger(pump())}
    assert rows["rotor_gap"] == "leakage, gap of the rotor"


def test_balance_closes_by_hand() -> None:
    assert pump().energy_remainder == pytest.approx(0.0, abs=1e-12)
    assert pump().mass_balance_error == pytest.approx(0.0, abs=1e-12)


def test_error_is_over_the_larger_power() -> None:
    assert pump(remainder=1.0).energy_balance_error == pytest.approx(1.0 / 101.0)


def test_what_is_stored_counts_where_nothing_is_driven() -> None:
    """Gas relaxes in fluid at rest: 55 mJ come from the store, 1 mJ passes a port."""
    energy = {"gas_relaxation": 0.055, "stored_change": -0.054, "port_outlet": -0.001 + 5e-8}
    still = ledger_from({**energy, "mass_stored_change": 1e-3, "mass_outlet": 0.0}, 0.1, 0.0)
    assert still.energy_balance_error == pytest.approx(5e-8 / 0.054, rel=1e-3)
    assert still.mass_balance_error == 1.0


@pytest.mark.parametrize("ledger", [pump(), pump(3.0), fake_ledger(0.04, TURN)])
def test_table_closes(ledger: Ledger) -> None:
    rows = power_ledger(ledger)
    supplied = [r.power for r in rows if r.kind == "supplied"]
    rest = [r.power for r in rows if r.kind != "supplied"]
    assert sum(supplied) == pytest.approx(sum(rest), rel=1e-12)
    assert all(r.power > 0.0 for r in rows if r.kind in {"supplied", "delivered", "loss"})


def test_supply_of_a_motor_is_the_fluid() -> None:
    assert power_ledger(fake_ledger(0.04, TURN))[0].name == "ports"
    assert power_ledger(pump())[0].name == "shaft"


def test_flat_mapping_is_sorted_into_masses_and_energies() -> None:
    ledger = ledger_from({"mass_inlet": 1.0, "shaft": 2.0}, 1.0, TURN)
    assert (ledger.mass, ledger.energy) == ({"inlet": 1.0}, {"shaft": 2.0})


def test_unknown_entry_is_refused() -> None:
    with pytest.raises(KeyError, match="heat"):
        ledger_from({"heat": 1.0}, 1.0, TURN)
