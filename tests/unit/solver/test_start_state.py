"""Start of a run: bodies that contacts hold stand where these carry the pressures."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from toothspace import api
from toothspace.model import arrays as col
from toothspace.model.assembly import assemble
from toothspace.model.quasi_static import mean_force
from toothspace.solver.compiled_model import evaluate_state, find_contacts
from toothspace.solver.initial import start_state
from toothspace.solver.integrator import start_march

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


@pytest.mark.parametrize("speed", [50.0, 400.0])
def test_steps_are_no_longer_than_a_fortieth_of_a_radian(speed: float) -> None:
    """However fast the shaft; the shortest goes with its speed too."""
    run = api.prepare(api.load_case(GEROTOR))
    system = assemble(run.machine, run.fluid, replace(run.condition, shaft_speed=speed))
    march = start_march(system, start_state(system))
    assert march.settings.max_step * speed == pytest.approx(1.0 / 40.0)
    assert march.settings.min_step * speed == pytest.approx(1e-16, rel=1e-6, abs=0.0)
    # cavitation in every chamber, every body at its stop, every contact
    size = system.arrays.size
    watched = size.chambers + size.journals + size.compliant
    assert size.journals > 0 < size.compliant
    assert march.settings.event_actions.size == watched


def test_a_body_of_a_map_starts_at_the_same_share_of_any_clearance() -> None:
    """On the side to which the pressures press it."""
    case = api.load_case(GEROTOR)
    shares = []
    for clearance in ("30 um", "90 um"):
        run = api.prepare(case.replace({"machine.housing.radial_clearance": clearance}))
        system = assemble(run.machine, run.fluid, run.condition)
        place = start_state(system)[system.arrays.size.position :][:2]
        shares.append(float(np.hypot(*place)) / float(clearance.split()[0]) * 1e6)
    assert shares[0] == pytest.approx(shares[1], rel=1e-6)
    assert 0.1 < shares[0] < 1.0


@pytest.mark.parametrize("blocks", ["seated", "free"])
def test_journals_start_at_nine_tenths_of_their_clearance_along_their_load(blocks: str) -> None:
    """Free blocks carry the journals in them and lean against the bore with both their loads."""
    case = api.load_case("egm12_pump").replace({"machine.bearing_blocks.motion": blocks})
    run = api.prepare(case)
    system = assemble(run.machine, run.fluid, run.condition)
    place = start_state(system)[system.arrays.size.position :]
    force = mean_force(run.machine, run.condition) @ system.motion_map
    carried = 0
    for journal in system.arrays.journal:
        own = [int(journal[column]) for column in (col.MOTION_X, col.MOTION_Y)]
        load, held = force[own].copy(), np.array([journal[col.BUSH_X], journal[col.BUSH_Y]])
        for other in system.arrays.journal:
            if other[col.CARRIER_X] == own[0] and own[0] != other[col.MOTION_X]:
                load += force[[int(other[col.MOTION_X]), int(other[col.MOTION_Y])]]
        if journal[col.CARRIER_X] >= 0.0:
            held = held + place[[int(journal[col.CARRIER_X]), int(journal[col.CARRIER_Y])]]
            carried += 1
        away = (place[own] - held) / journal[col.JOURNAL_CLEARANCE]
        np.testing.assert_allclose(away, 0.9 * load / np.hypot(*load), rtol=1e-9)
    assert carried == (2 if blocks == "free" else 0)
    # no film is warmer than the oil, that round the blocks neither
    np.testing.assert_array_equal(system.arrays.journal[:, col.JOURNAL_VISCOSITY], 1.0)
