"""Electric drive on the shaft: limits, losses, controller, and energy of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from toothspace import api
from toothspace.case import Case
from toothspace.circuit.electric_drive import ElectricDrive, ElectricMotor, SpeedController
from toothspace.core.errors import CaseError

CASES = Path(__file__).resolve().parents[3] / "cases"
MOTOR: dict[str, Any] = {
    "peak_torque": "30 N m",
    "corner_speed": "2000 rpm",
    "no_load_speed": "3200 rpm",
    "copper_loss": "900 W",
    "iron_loss": "120 W",
    "inverter_loss": "150 W",
    "standby_loss": "25 W",
}
RPM = np.pi / 30.0


def axle(**changes: Any) -> Case:
    """The pump on a motor that holds 600 rpm against an orifice, without running-in."""
    tables = api.load_case(CASES / "electric_axle.toml").to_dict()
    del tables["machine"]["casing"]["wear_in"]
    circuit = tables["circuit"]
    circuit |= {"duration": "0.04 s", "initial_shaft_speed": "600 rpm"}
    circuit["load"]["opening"] = [["0 s", 1.0]]
    circuit["drive"]["speed"] = [["0 s", "600 rpm"]]
    circuit |= changes
    tables["run"] = {"fidelity": "lumped", "time_samples": 100, "relative_tolerance": 1e-8}
    return Case.from_dict({k: v for k, v in tables.items() if v is not None})


def test_voltage_limits_the_torque_along_a_line() -> None:
    """A direct-current machine: what resistance and back-EMF leave of the voltage."""
    motor = ElectricMotor(**MOTOR)
    speeds = np.array([0.0, 2000.0, 2600.0, 3200.0, 4000.0]) * RPM
    assert motor.torque_limit(speeds) == pytest.approx([30.0, 30.0, 15.0, 0.0, 0.0], abs=1e-9)
    # U = R T / k + k w with the same k at three quarters of the voltage
    low = ElectricMotor(**MOTOR, voltage_ratio=0.75)
    assert low.torque_limit(1800.0 * RPM) == pytest.approx(15.0)
    assert motor.limited(50.0, 2600.0 * RPM) == pytest.approx(15.0)
    assert motor.limited(-50.0, 2600.0 * RPM) == -30.0
    assert motor.limited(-50.0, -2600.0 * RPM) == pytest.approx(-15.0)


def test_losses_by_hand_and_by_a_table(tmp_path: Path) -> None:
    motor = ElectricMotor(**MOTOR)
    found = motor.powers(15.0, 1000.0 * RPM)
    assert found.motor_loss == pytest.approx(900.0 / 4.0 + 120.0 / 4.0)
    assert found.inverter_loss == pytest.approx(25.0 + 75.0)
    assert found.electric == pytest.approx(15.0 * 1000.0 * RPM + 355.0)
    path = tmp_path / "losses.csv"
    rows = ["speed [rpm],torque [N m],loss [W]", "0,0,10", "0,30,110", "2000,0,50", "2000,30,250"]
    path.write_text("\n".join(rows), encoding="utf-8")
    bare = {k: MOTOR[k] for k in ("peak_torque", "corner_speed", "no_load_speed")}
    table = ElectricMotor(**bare, losses=path).powers(np.array([15.0, -15.0]), 1000.0 * RPM)
    assert table.motor_loss == pytest.approx(105.0)
    assert table.electric[1] == pytest.approx(-15.0 * 1000.0 * RPM + 105.0)


def test_the_controller_does_not_store_what_the_limit_cuts_off() -> None:
    speed = ((0.0, 1500.0 * RPM),)
    drive = ElectricDrive(
        **MOTOR,
        speed=speed,
        inertia="0.002 kg m^2",
        proportional="1 N m s/rad",
        integral="100 N m/rad",
    )
    controller = SpeedController(drive)
    held = [controller.step(1e-3 * k, [0.0])[0] for k in range(1000)]
    assert held == [-30.0] * 1000
    # at the wanted speed the torque is gone in one sample
    assert abs(controller.step(1.0, [1500.0 * RPM])[0]) < 1.0


def test_energy_of_a_drive_closes() -> None:
    """What the supply gives is work on the shaft and loss; the run keeps all of the work."""
    solution = api.simulate(axle())
    data, ledger = solution.data, solution.ledger
    assert solution.status.name == "DONE"
    assert ledger.mass_balance_error < 1e-7
    assert ledger.energy_balance_error < 1e-5
    work = data["drive_torque"] * data["shaft_speed"]
    lost = data["drive_motor_loss"] + data["drive_inverter_loss"]
    # means of cells of a product against products of means
    ratio = float(data["electric_power"].mean() / (work + lost).mean())
    assert ratio == pytest.approx(1.0, abs=1e-5)
    assert data["drive_torque"].values == pytest.approx(-data["load_torque"].values)
    numbers = solution.summary()
    assert numbers["drive_loss_energy_J"] > 0.0
    # the machine's account of what it took, and of what its rotor holds
    taken = -numbers["shaft_energy_J"]
    given = numbers["electric_energy_J"] - numbers["drive_loss_energy_J"]
    assert given == pytest.approx(taken, rel=1e-4)


def test_the_drive_holds_its_speed_against_the_load() -> None:
    changes = {"duration": "0.15 s"}
    solution = api.simulate(axle(**changes))
    late = solution.data["time"].values > 0.12
    speed = float(solution.data["shaft_speed"].values[late].mean())
    assert speed == pytest.approx(600.0 * RPM, rel=0.01)
    torque = solution.data["drive_torque"].values[late].mean()
    assert torque == pytest.approx(solution.data["shaft_torque"].values[late].mean(), rel=0.02)


@pytest.mark.parametrize(
    ("other", "message"),
    [
        ({"kind": "torque_source", "torque": [["0 s", "1 N m"]]}, "a torque source and an elect"),
        ({"kind": "coupling", "stiffness": "1 N m/rad"}, "a coupling and an electric drive"),
        ({"kind": "speed_source", "speed": [["0 s", "1 rpm"]]}, "an electric drive and a speed"),
    ],
)
def test_what_a_drive_excludes(other: dict[str, Any], message: str) -> None:
    with pytest.raises(CaseError, match=message):
        api.simulate(axle(other=other))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"no_load_speed": "1000 rpm"}, "a speed above corner_speed"),
        ({"peak_torque": None}, "peak_torque: found nothing"),
        ({"proportional": None, "integral": None}, "a gain, here or as integral"),
    ],
)
def test_bad_drives(change: dict[str, Any], message: str) -> None:
    tables = api.load_case(CASES / "electric_axle.toml").to_dict()
    drive = tables["circuit"]["drive"] | change
    tables["circuit"]["drive"] = {k: v for k, v in drive.items() if v is not None}
    with pytest.raises(CaseError, match=message):
        Case.from_dict(tables)


def test_a_map_with_a_drive_is_pump_times_motor(tmp_path: Path) -> None:
    from toothspace.studies import run_study

    tables = api.load_case(CASES / "efficiency_map_electric.toml").to_dict()
    del tables["machine"]["casing"]["wear_in"]
    tables["run"] |= {"fidelity": "ideal"}
    tables["study"] |= {"shaft_speed": ["1000 rpm", "3000 rpm"]}
    tables["study"] |= {"pressure_difference": ["50 bar", "200 bar"]}
    data = run_study(Case.from_dict(tables), tmp_path / "map").data
    motor = ElectricMotor(**MOTOR)
    torque = 4.9504e-6 * 50e5 / (2.0 * np.pi)
    power = torque * 1000.0 * RPM
    expected = power / float(motor.powers(torque, 1000.0 * RPM).electric)
    assert float(data["drive_efficiency"][0, 0]) == pytest.approx(expected, rel=1e-3)
    whole = data["overall_efficiency"] * data["drive_efficiency"]
    assert data["efficiency_with_drive"].values == pytest.approx(
        whole.values, rel=1e-6, nan_ok=True
    )
    # 200 bar need 15.8 N m, of which the voltage leaves 5 N m at 3000 rpm
    assert np.isnan(data["efficiency_with_drive"][1, 1])
    tables["machine"]["mode"] = "motor"
    del tables["operating_point"]["outlet_load"]
    tables["operating_point"] |= {"inlet_pressure": "200 bar", "outlet_pressure": "1 bar"}
    with pytest.raises(CaseError, match=r"study\.drive"):
        run_study(Case.from_dict(tables), tmp_path / "motor")
