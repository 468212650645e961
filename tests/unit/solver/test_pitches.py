"""A revolution made of the last pitch is that of marches over whole revolutions."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.api import prepare
from toothspace.case import load_case
from toothspace.model.assembly import assemble
from toothspace.solver.cyclic import RunPlan, first_turn_state, march_near, march_revolutions
from toothspace.solver.outcome import window_ledger

HELD = {"operating_point.outlet_load": "fixed_pressure", "heat": None}


@pytest.mark.slow
@pytest.mark.parametrize("name", ["egm12_pump", "gerotor_trochoidal"])
def test_a_pitch_is_enough_where_teeth_are_alike(name: str) -> None:
    run = prepare(load_case(name).replace(HELD))
    system = assemble(run.machine, run.fluid, run.condition)
    whole = march_revolutions(system, RunPlan())
    short = march_revolutions(system, RunPlan(by_pitch=True), None, first_turn_state(whole))
    assert short.statistics["rhs"] < 0.5 * whole.statistics["rhs"]
    assert short.times == pytest.approx(whole.times - whole.times[0], abs=1e-12)
    # pockets come back to their place in another order
    inside = slice(system.arrays.size.mass, system.arrays.size.gas)
    found, exact = (np.sort(history.states[:, inside], axis=1) for history in (short, whole))
    mass = np.abs(found - exact) / exact
    # in an opening chamber a sample differs by what the step that reaches it leaves
    assert np.median(mass) < 2e-5
    ledger, expected = window_ledger(short), window_ledger(whole)
    assert ledger.mass["outlet"] == pytest.approx(expected.mass["outlet"], rel=5e-4)
    assert ledger.mass_balance_error < 2e-4  # changes that pressures may show, in the gas


def test_near_the_cyclic_state_flows_and_losses_are_those_of_whole_revolutions() -> None:
    run = prepare(load_case("egm12_pump").replace(HELD))
    system = assemble(run.machine, run.fluid, run.condition)
    near = march_near(system, RunPlan())
    assert near is not None
    whole = march_revolutions(system, RunPlan(), None, first_turn_state(near))
    assert whole.revolutions == 2  # nothing is left to settle
    found, expected = window_ledger(near), window_ledger(whole)
    assert found.mass["outlet"] == pytest.approx(expected.mass["outlet"], rel=1e-3)
    assert found.energy["shaft"] == pytest.approx(expected.energy["shaft"], rel=1e-3)
    for loss in expected.losses:
        share = (found.energy[loss] - expected.energy[loss]) / expected.energy["shaft"]
        assert abs(share) < 1e-3, loss
