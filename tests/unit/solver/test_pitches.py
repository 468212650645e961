"""A revolution made of the last pitch is that of marches over whole revolutions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from toothspace.api import prepare
from toothspace.case import load_case
from toothspace.model.assembly import assemble
from toothspace.solver.cyclic import (
    DenseStates,
    RunPlan,
    _turned,
    first_turn_state,
    march_near,
    march_revolutions,
)
from toothspace.solver.outcome import solution_from, window_ledger

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


@pytest.mark.parametrize(
    "name", ["egm12_pump", pytest.param("gerotor_trochoidal", marks=pytest.mark.slow)]
)
def test_one_pitch_seen_closely_tells_what_a_revolution_does(name: str) -> None:
    run = prepare(load_case(name).replace(HELD))
    system = assemble(run.machine, run.fluid, run.condition)
    start = march_near(system, RunPlan()) or march_revolutions(system, RunPlan())
    short = march_revolutions(system, RunPlan(by_pitch=True), None, first_turn_state(start))
    assert short.dense is not None
    assert short.alike == round(2.0 * np.pi / run.machine.pitch_angle)
    # all pitches one after the other, chambers renamed, masses and energies counted on
    pitch, size = run.machine.pitch_angle, system.arrays.size
    parts = [_turned(system, short.dense.states, k * pitch) for k in range(short.alike)]
    gained = short.dense.states[-1, size.core :]
    for k, part in enumerate(parts):
        part[:, size.core :] += k * gained
    states = np.vstack([*(part[:-1] for part in parts), parts[-1][-1:]])
    times = np.linspace(0.0, short.times[-1], len(states))
    whole = replace(short, dense=DenseStates(times, states), alike=1)
    extra = {"fluid_temperature": np.asarray(323.15)}
    found, expected = (solution_from(one, {}, extra, "") for one in (short, whole))
    for key in ("max_chamber_pressure_bar", "min_chamber_pressure_bar", "torque_ripple_percent"):
        assert found.summary()[key] == pytest.approx(expected.summary()[key], rel=1e-6), key
    ripple = "flow_ripple_percent"  # its rate of storage has two more ends
    assert found.summary()[ripple] == pytest.approx(expected.summary()[ripple], rel=5e-3)
    for key, loss in expected.ledger.energy.items():
        assert found.ledger.energy[key] == pytest.approx(loss, rel=1e-4, abs=1e-9), key
    assert found.data["lost_flow"].values == pytest.approx(
        expected.data["lost_flow"].values, rel=1e-3, abs=1e-10
    )
    angle = found.data["dense_angle"].values
    assert angle == pytest.approx(expected.data["dense_angle"].values, abs=1e-9)
    if "contact_loaded_share" in expected.data:
        loaded = (float(one.data["contact_loaded_share"].sum()) for one in (found, expected))
        assert next(loaded) == pytest.approx(next(loaded), rel=1e-2)
