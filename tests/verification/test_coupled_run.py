"""Chambers and lateral films of whole machines brought to agreement, pumps and motors."""

from __future__ import annotations

from pathlib import Path

import pytest

from toothspace import api
from toothspace.case import load_case
from toothspace.core.status import Status
from toothspace.floating.coupling import NEGLIGIBLE

CASES = Path(__file__).parents[2] / "cases"
COARSE = [
    "run.fidelity=elastic",
    "run.samples_per_revolution=180",
    "run.relative_tolerance=1e-5",
    "run.film_grid=[84,10]",
    "run.film_angles_per_pitch=2",
    "run.film_steps_per_revolution=84",
]
FUEL_MOTOR = [
    "run.deformation=winkler",
    "machine.mode=motor",
    'machine.floating_bearing.nose.center=["20 mm","31.53 mm"]',
    'machine.casing.inlet_angle="55 deg"',
    'machine.casing.outlet_angle="70 deg"',
    'operating_point.inlet_pressure="77.6 bar"',
    'operating_point.outlet_pressure="7.2 bar"',
]
UPRIGHT = [
    "machine.floating_bearing.motion=full",
    'machine.floating_bearing.wall_stiffness="1e6 N m/rad"',
    'machine.floating_bearing.shaft_stiffness="1e6 N m/rad"',
]
BUSHINGS = ['machine.lateral.arrangement="symmetric"']


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "changes", "play"),
    [
        ("fuel14_pump", FUEL_MOTOR, 100.0),
        ("fuel14_pump", [*FUEL_MOTOR, *UPRIGHT], 100.0),
        ("egm12_pump", BUSHINGS, 100.0),
    ],
    ids=["motor, lifts", "motor, all motions", "pump, two bushings"],
)
def test_films_and_chambers_agree_about_leakage_and_torque(
    name: str, changes: list[str], play: float
) -> None:
    """At single chamber pressures these bearings either close their gaps or go to the cover."""
    solution = api.simulate(load_case(CASES / f"{name}.toml", [*COARSE, *changes]))
    assert solution.status is Status.DONE
    found = solution.summary()
    leakage = found["leakage_lateral_L_per_min"] + found["leakage_drain_L_per_min"]  # type: ignore[operator]
    # to 2 %, or a fifth of what the coupling calls negligible beside the displaced flow
    displaced = found["displacement_cm3_per_rev"] * found["shaft_speed_rpm"] * 1e-3  # type: ignore[operator]
    near = pytest.approx(leakage, rel=0.02, abs=0.2 * NEGLIGIBLE * displaced)
    assert found["lateral_leakage_L_per_min"] == near
    friction = found["torque_loss_lateral_viscous_N_m"] + found["torque_loss_lateral_asperity_N_m"]  # type: ignore[operator]
    drag = float(solution.data["drag_torque"].sel(path=["lateral", "drain"]).sum("path").mean())
    assert friction + drag == pytest.approx(found["lateral_torque_N_m"], rel=0.03)
    assert abs(found["energy_balance_error"]) < 1e-3  # type: ignore[arg-type]
    warmest = found["highest_film_temperature_degC"]
    assert found["inlet_temperature_degC"] < found["drain_temperature_degC"] <= warmest + 0.1  # type: ignore[operator]
    assert warmest < 100.0  # type: ignore[operator]
    # the march stays where the search found it, because chambers that a gap drains let it close
    position = solution.data["bearing_position"]
    assert float(position.max() - position.min()) < 5e-6
    assert float(position.max()) < play * 1e-6
