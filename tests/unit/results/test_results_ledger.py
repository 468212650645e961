from __future__ import annotations

import pytest

from tests.fake_solution import TURN, fake_ledger
from toothspace.results.ledger import Ledger, ledger_from, loss_causes, power_ledger


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


def test_powers_and_shares_by_hand() -> None:
    """100 J in 2 s: 50 W from the shaft, 5 J of friction are 2.5 W or a twentieth."""
    rows = {row.name: row for row in power_ledger(pump())}
    assert (rows["shaft"].power, rows["shaft"].share) == pytest.approx((50.0, 1.0))
    assert (rows["ports"].power, rows["ports"].share) == pytest.approx((45.0, 0.9))
    assert rows["journal_viscous"].power == pytest.approx(2.5)
    assert rows["journal_viscous"].share == pytest.approx(0.05)


def test_a_window_without_length_or_supply_has_no_power_but_its_energies() -> None:
    still = ledger_from({"coupling": 3.0, "stored_change": -3.0}, 0.0, 0.0)
    rows = {row.name: row for row in power_ledger(still)}
    assert (rows["coupling"].power, rows["coupling"].share) == (0.0, 3.0)
    (cause,) = loss_causes(still)
    assert (cause.power, cause.share) == (3.0, 3.0)


def test_an_external_load_on_the_shaft_and_supply_pumps_take_part() -> None:
    """A motor: 40 J of the fluid, of which supply pumps bring 6 J, and 5 J of the load."""
    energy = {"shaft": -30.0, "radial_load": 5.0, "port_inlet": 60.0, "port_outlet": 26.0}
    motor = Ledger(1.0, TURN, {}, energy | {"supply": 6.0, "shaft_seal": 15.0})
    assert motor.port_energy == pytest.approx(-34.0)
    assert motor.fluid_energy == pytest.approx(-40.0)
    assert motor.energy_remainder == pytest.approx(0.0, abs=1e-12)
    rows = {row.name: row for row in power_ledger(motor)}
    assert (rows["ports"].kind, rows["ports"].power) == ("supplied", pytest.approx(40.0))
    assert (rows["shaft"].kind, rows["shaft"].share) == ("delivered", pytest.approx(0.75))
    assert rows["radial_load"].power == pytest.approx(-5.0)
    assert rows["shaft_seal"].share == pytest.approx(0.375)


def test_the_mass_error_is_over_the_largest_mass() -> None:
    masses = {"inlet": 2.0, "outlet": 1.5, "drain": 0.1, "stored_change": 0.3}
    assert Ledger(1.0, TURN, masses, {}).mass_balance_error == pytest.approx(0.05)
    assert Ledger(1.0, TURN, {}, {}).mass_balance_error == 0.0
    assert Ledger(1.0, TURN, {}, {}).energy_balance_error == 0.0


def test_what_is_throttled_while_a_chamber_is_sealed_is_trapping() -> None:
    """Of 7 J in a groove 2 J are trapped; of 3 J in a gap nothing. 4 s, 50 J supplied."""
    energy = {"shaft": 50.0, "groove": 7.0, "trapped_groove": 2.0, "gap": 3.0}
    paths = {"groove": "throttling, groove", "gap": "leakage, tips"}
    causes = loss_causes(Ledger(4.0, TURN, {}, energy | {"trapped_volume": 2.0}, paths))
    found = {one.label: (one.power, one.share) for one in causes}
    assert found["groove"] == pytest.approx((1.25, 0.1))
    assert found["tips"] == pytest.approx((0.75, 0.06))
    assert found["fluid shut in the mesh"] == pytest.approx((0.5, 0.04))


def test_entries_with_an_unknown_mass_or_part_of_a_path_are_refused() -> None:
    with pytest.raises(KeyError, match="oil"):
        ledger_from({"mass_oil": 1.0, "shaft": 1.0}, 1.0, TURN)
    Ledger(1.0, TURN, {}, {"trapped_gap": 1.0}, {"gap": "leakage, tips"})
    with pytest.raises(KeyError, match="trapped_tip"):
        Ledger(1.0, TURN, {}, {"trapped_tip": 1.0}, {"gap": "leakage, tips"})
