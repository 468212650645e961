"""Start of a run: bodies that contacts hold stand where these carry the pressures."""

from __future__ import annotations

from pathlib import Path

import pytest

from toothspace import api
from toothspace.model import arrays as col
from toothspace.model.assembly import assemble
from toothspace.solver.compiled_model import evaluate_state, find_contacts
from toothspace.solver.initial import start_state

GEROTOR = Path(__file__).resolve().parents[3] / "cases" / "gerotor_trochoidal.toml"


@pytest.mark.parametrize("high", ["inlet", "outlet"])
def test_contacts_carry_the_torque_of_the_pressures_at_the_start(high: str) -> None:
    """Whichever flanks the pressures turn the outer rotor on."""
    low = "outlet" if high == "inlet" else "inlet"
    case = api.load_case(GEROTOR).replace(
        {
            "machine.mode": "motor" if high == "inlet" else "pump",
            f"operating_point.{high}_pressure": "60 bar",
            f"operating_point.{low}_pressure": "1 bar",
            "operating_point.outlet_load": "fixed_pressure",
        }
    )
    run = api.prepare(case)
    system = assemble(run.machine, run.fluid, run.condition)
    state, arrays = start_state(system), system.arrays
    evaluate_state(arrays, state)
    [turning] = [
        k for k, m in enumerate(system.free_motions) if run.machine.motions[m].axis == "rotation"
    ]
    pressure = arrays.node[: arrays.size.chambers, col.PRESSURE]
    torque = float(pressure @ arrays.chamber_values[:, col.CHANNEL_MOTION + turning])
    state[1] = 0.0
    find_contacts(arrays, state)
    carried = float(arrays.motion[turning, col.CONTACT_LOAD])
    assert abs(torque) > 0.1
    assert carried == pytest.approx(-torque, rel=1e-6)
