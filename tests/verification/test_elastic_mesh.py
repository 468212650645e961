"""External gears on compliant teeth: agreement with the rigid mesh, either flank, balances."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.external_gear_designs import egm12, fuel14
from toothspace.gearing.flank_contacts import tooth_stiffness
from toothspace.machines.external_gear import MACHINE
from toothspace.machines.external_gear.assembly import assemble as assemble_gears
from toothspace.machines.external_gear.gear_bodies import flank_pair
from toothspace.model.assembly import assemble
from toothspace.model.description import MachineDescription
from toothspace.model.fluid import GasModel, fluid_law
from toothspace.model.operating_point import OperatingCondition
from toothspace.solver.compiled_model import Observation, observe
from toothspace.solver.cyclic import History, RunPlan, march_revolutions
from toothspace.solver.outcome import window_ledger

HIGH, LOW = 150e5, 5e5
TEETH = 12
PLAN = RunPlan(revolutions=3, samples_per_revolution=720)


@pytest.fixture(scope="module")
def machine() -> MachineDescription:
    return MACHINE.describe(egm12("pump"), 480)


def run(machine: MachineDescription, *, compliant: bool, reversed_load: bool = False) -> History:
    inlet, outlet = (HIGH, LOW) if reversed_load else (LOW, HIGH)
    condition = OperatingCondition(
        shaft_speed=157.0,
        inlet_pressure=inlet,
        outlet_pressure=outlet,
        compliant_mesh=compliant,
        relative_tolerance=1e-6,
    )
    fluid = fluid_law("iso_vg_46", 323.15, GasModel(dissolved_air_fraction=0.08))
    return march_revolutions(assemble(machine, fluid, condition), PLAN)


def stiffened(machine: MachineDescription) -> MachineDescription:
    """Teeth a hundred times as stiff, touching within a hundredth of their roughness."""
    pairs = tuple(
        replace(
            pair,
            law="linear",
            structure_stiffness=100.0 * pair.structure_stiffness,
            onset=0.01 * pair.roughness,
        )
        for pair in machine.contacts
    )
    return replace(machine, contacts=pairs)


def seen(history: History) -> Observation:
    return observe(history.system.arrays, history.states)


@pytest.fixture(scope="module")
def rigid(machine: MachineDescription) -> History:
    return run(machine, compliant=False)


@pytest.fixture(scope="module")
def elastic(machine: MachineDescription) -> History:
    return run(machine, compliant=True)


@pytest.mark.slow
def test_stiff_teeth_are_a_rigid_mesh(machine: MachineDescription, rigid: History) -> None:
    """Flow, torque, leakage and mean contact force of the constraint come back in the limit."""
    stiff = run(stiffened(machine), compliant=True)
    before, after = window_ledger(rigid), window_ledger(stiff)
    assert after.mass["outlet"] == pytest.approx(before.mass["outlet"], rel=1e-3)
    assert after.energy["shaft"] == pytest.approx(before.energy["shaft"], rel=3e-3)
    assert after.energy["flank"] == pytest.approx(before.energy["flank"], rel=0.06)
    force = [seen(each).contact_force.sum(axis=1).mean() for each in (rigid, stiff)]
    assert force[1] == pytest.approx(force[0], rel=0.01)


def test_elastic_teeth_change_the_means_little(rigid: History, elastic: History) -> None:
    """Deflection widens the gap at the back of the trapped space: less throttling there."""
    before, after = window_ledger(rigid), window_ledger(elastic)
    assert after.mass["outlet"] == pytest.approx(before.mass["outlet"], rel=3e-3)
    assert after.energy["shaft"] == pytest.approx(before.energy["shaft"], rel=0.03)
    assert after.energy["flank"] < before.energy["flank"]


def test_balances_close(elastic: History) -> None:
    ledger = window_ledger(elastic)
    assert ledger.mass_balance_error < 1e-10
    assert ledger.energy_balance_error < 1e-5


def test_contact_force_carries_the_torque_of_the_driven_gear(elastic: History) -> None:
    """Mean over the revolution: pressure torque plus film and flank friction over base radius."""
    system = elastic.system
    observed = seen(elastic)
    turning = len(system.free_motions) - 1
    assert system.description.motions[system.free_motions[turning]].axis == "rotation"
    torque = observed.pressure_force[:, turning].mean() + observed.film_force[:, turning].mean()
    base_radius = 0.5 * TEETH * 2.75e-3 * np.cos(np.deg2rad(20.0))
    force = observed.contact_force.sum(axis=1).mean()
    assert force * base_radius == pytest.approx(abs(torque), rel=0.03)


def test_two_pairs_share_where_two_are_in_mesh(elastic: History) -> None:
    """Contact ratio 1.31: two pairs carry for about a third of the time, by deflection longer."""
    force = seen(elastic).contact_force
    carrying = np.count_nonzero(force[:, :TEETH] > 1.0, axis=1)
    assert carrying.min() == 1
    assert 0.28 < np.mean(carrying == 2) < 0.45
    assert force[:, TEETH:].max() == 0.0


def test_load_reversal_takes_the_other_flank(machine: MachineDescription) -> None:
    """Pressure drives the gears; grooves timed for a pump let them rattle once a pitch."""
    history = run(machine, compliant=True, reversed_load=True)
    force = seen(history).contact_force
    drive, coast = force[:, :TEETH].sum(axis=1), force[:, TEETH:].sum(axis=1)
    assert coast.mean() > 4.0 * drive.mean()
    assert np.mean(coast > 0.0) > 0.7
    assert not np.any((coast > 1.0) & (drive > 1.0))
    lost = [event.label for event in history.events if event.kind == "contact_lost"]
    assert sum(label.startswith("coast_flank") for label in lost) >= TEETH
    assert window_ledger(history).energy_balance_error < 1e-5


@pytest.mark.slow
def test_a_pump_on_thin_fuel_rattles() -> None:
    """Where the rigid mesh of the fuel pump pulls, elastic teeth part, cross over and hit."""
    machine = MACHINE.describe(fuel14(), 480)
    fluid = fluid_law("jet_a1", 333.15, GasModel(dissolved_air_fraction=0.14))
    runs = []
    for compliant in (False, True):
        condition = OperatingCondition(
            shaft_speed=489.6,
            inlet_pressure=7.2e5,
            outlet_pressure=77.6e5,
            compliant_mesh=compliant,
            relative_tolerance=1e-7,
        )
        runs.append(march_revolutions(assemble(machine, fluid, condition), PLAN))
    rigid, elastic = (seen(each).contact_force for each in runs)
    assert rigid.sum(axis=1).min() < -500.0
    assert elastic.min() == 0.0
    assert np.mean(elastic.sum(axis=1) < 1.0) > 0.3
    assert elastic[:, 14:].max() > 500.0
    assert elastic.max() > 1.1 * rigid.max()
    made = [event for event in runs[1].events if event.kind == "contact_made"]
    assert len(made) >= 3 * 14
    assert window_ledger(runs[1]).energy_balance_error < 1e-5


def test_tooth_stiffness_by_the_standard() -> None:
    """ISO 6336-1 for 12 and 12 teeth, x = 0.3: c' = 0.8/0.0709 = 11.3 N/(mm um), by hand."""
    gears = assemble_gears(egm12("pump"))
    kappa = tooth_stiffness(gears, flank_pair(gears))
    flattening = 1.0 / 11.29e9 - 1.0 / kappa
    assert 1.0 / flattening == pytest.approx(42e9, rel=0.05)
