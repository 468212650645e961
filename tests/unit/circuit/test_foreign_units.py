"""Units of other programs in a circuit: when they step, what they set, what is refused."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.unit.circuit.test_circuit_ledger import PLACES, STORE, check, motor
from toothspace import api
from toothspace.case import Case
from toothspace.circuit.fmu import LinkedUnit
from toothspace.core.compilation.library import Way, chosen
from toothspace.core.errors import CaseError
from toothspace.fmi.machine_unit import export_machine
from toothspace.solver import co_simulation

PUMP = Path(__file__).resolve().parents[3] / "cases" / "egm12_pump.toml"
WHEEL = {"kind": "inertia", "inertia": "0.002 kg m^2"}
ORIFICE = {"kind": "orifice", "diameter": "3 mm"}
SOURCE = {"kind": "torque_source", "torque": [["0 s", "0 N m"]]}
FAN = {"kind": "fan", "linear": "0.10471975511965977 N m/rpm"}  # 1 N m s/rad
MOVED = {"kind": "proportional_valve", "area": "7 mm^2", "opening": [["0 s", 0.5]]}


class Stand:
    """Unit in Python: gives back what it is told, times a factor."""

    factor = 1.0
    steps: list[tuple[float, list[float]]]

    def __init__(self, unit: LinkedUnit) -> None:
        Stand.steps = []

    def step(self, time: float, values: Sequence[float]) -> list[float]:
        Stand.steps.append((time, list(values)))
        return [self.factor * value for value in values]

    def close(self) -> None:
        pass


@pytest.fixture
def stand(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A file in place of a unit, which is not opened."""
    monkeypatch.setattr(co_simulation, "Instance", Stand)
    monkeypatch.setattr(Stand, "factor", 1.0)
    path = tmp_path / "unit.fmu"
    path.write_bytes(b"unit")
    return path


def linked(file: Path, step: str, told: str, set_key: str, **more: Any) -> dict[str, Any]:
    unit = {"kind": "fmu", "file": str(file), "step": step}
    return unit | {"inputs": [["u", told]], "outputs": [["y", set_key]]} | more


def loaded(unit: dict[str, Any] | None) -> Case:
    """Motor against a load that grows with speed, by a unit or as an element."""
    elements = {"spin": None, "x": ORIFICE, "wheel": WHEEL}
    load = {"load": FAN} if unit is None else {"load": SOURCE, "unit": unit}
    return motor(PLACES["outlet"], elements | load, pressure="60 bar")


def test_a_load_by_a_unit_tends_to_that_of_the_program(stand: Path) -> None:
    """The unit knows the speed of the last point: an error of first order in its step."""
    expected = api.simulate(loaded(None)).data
    errors = []
    for step in ("1 ms", "0.5 ms"):
        found = api.simulate(loaded(linked(stand, step, "shaft.speed", "load.torque")))
        check(found)
        speed = found.data["shaft_speed"].values
        errors.append(float(np.abs(speed - expected["shaft_speed"].values).max()))
        torque, times = found.data["load_torque"].values, found.data["time"].values
        told = np.array([(time, values[0]) for time, values in Stand.steps])
        behind = np.interp(times, told[1:, 0], told[:-1, 1])
        # means of cells against points of lines
        assert torque[5:] == pytest.approx(behind[5:], rel=0.05, abs=0.05)
    assert errors[1] == pytest.approx(0.5 * errors[0], rel=0.15)
    warnings = [finding.text for finding in found.warnings]
    assert "circuit.unit is native code of unit.fmu" in " ".join(warnings)


def test_points_are_met_once_and_in_time(stand: Path) -> None:
    api.simulate(loaded(linked(stand, "0.7 ms", "shaft.angle", "load.torque")))
    times = [time for time, _ in Stand.steps]
    assert times == pytest.approx(0.7e-3 * np.arange(29), abs=1e-12)


def test_a_controller_moves_a_valve(stand: Path) -> None:
    """The opening falls to what the pressure says, and so does the flow."""
    Stand.factor = 1e-8
    elements = {"x": MOVED, "unit": linked(stand, "1 ms", "machine.outlet.pressure", "x.opening")}
    found = api.simulate(motor(PLACES["outlet"], elements, pressure="60 bar"))
    check(found)
    still = api.simulate(motor(PLACES["outlet"], {"x": MOVED}, pressure="60 bar"))
    ends = [float(s.data["outlet_pressure"].values[-1]) for s in (found, still)]
    assert ends[0] > 1.2 * ends[1]


def test_a_unit_drives_the_shaft(stand: Path) -> None:
    Stand.factor = 1e-5
    spin = {"kind": "speed_source", "speed": [["0 s", "300 rpm"]]}
    unit = linked(stand, "2 ms", "machine.inlet.pressure", "spin.speed")
    found = api.simulate(motor(PLACES["outlet"], {"spin": spin, "x": ORIFICE, "unit": unit}))
    check(found)
    speed = found.data["shaft_speed"].values
    # the first cell of 0.4 ms, on the line of 2 ms
    assert speed[0] == pytest.approx(10.0 * np.pi - 0.1 * (10.0 * np.pi - 20.0), rel=0.01)
    assert speed[-1] == pytest.approx(20.0, rel=1e-6)  # 20 bar times the factor


@pytest.mark.parametrize("flow", ["6 L/min", "-2 L/min"])
def test_a_flow_source_keeps_mass_and_energy(flow: str) -> None:
    joints = [["source", "store"], ["store", "x"], ["x", "low"]]
    elements = {
        "source": {"kind": "flow_source", "flow": [["0 s", "2 L/min"], ["0.01 s", flow]]},
        "x": {"kind": "orifice", "diameter": "1 mm"},
        "store": STORE,
    }
    found = api.simulate(motor([*PLACES["outlet"][:1], *_rest(), *joints], elements))
    check(found)


def _rest() -> list[list[str]]:
    return [["high", "machine.inlet"], ["machine.outlet", "y"], ["y", "low"]]


@pytest.mark.skipif(chosen()[0] != Way.LIBRARY, reason=chosen()[1])
def test_a_pump_of_the_program_feeds_a_motor(tmp_path: Path) -> None:
    """The whole machine, as a unit that another program could have made."""
    pytest.importorskip("fmpy")
    path = tmp_path / "pump.fmu"
    export_machine(PUMP, path)
    unit = {
        "kind": "fmu",
        "file": str(path),
        "step": "0.1 ms",
        "parameters": [["shaft_speed", 60.0]],
        "inputs": [["outlet_pressure", "store.pressure"]],
        "outputs": [["outlet_flow_rate", "supply.flow"]],
    }
    elements = {
        "supply": {"kind": "flow_source", "flow": [["0 s", "2.8 L/min"]]},
        "unit": unit,
        "relief": {"kind": "relief_valve", "opening_pressure": "40 bar"},
        "spin": None,
        "load": {"kind": "torque_source", "torque": [["0 s", "1 N m"]]},
        "wheel": WHEEL,
    }
    joints = [["supply", "store"], ["store", "machine.inlet"], ["machine.outlet", "low"]]
    joints += [["store", "relief"], ["relief", "low"]]
    found = api.simulate(motor(joints, elements))
    check(found)
    passed = found.ledger.mass["inlet"]
    assert passed > 0.0
    assert found.data["shaft_speed"].values[-1] > 1.0


def test_what_cannot_be_joined_is_refused(stand: Path, tmp_path: Path) -> None:
    for told, target, where in (
        ("shaft.force", "load.torque", "unit.inputs: found 'shaft.force'"),
        ("nothing.pressure", "load.torque", "unit.inputs: found 'nothing.pressure'"),
        ("shaft.speed", "x.opening", "unit.outputs: found 'x.opening'"),
        ("shaft.speed", "torque", "unit.outputs: found 'torque'"),
    ):
        with pytest.raises(CaseError, match=where):
            loaded(linked(stand, "1 ms", told, target))


def test_a_file_that_is_no_unit_is_refused(tmp_path: Path) -> None:
    pytest.importorskip("fmpy")
    path = tmp_path / "unit.fmu"
    path.write_bytes(b"no archive")
    case = loaded(linked(path, "1 ms", "shaft.speed", "load.torque"))
    with pytest.raises(CaseError, match=r"circuit.unit.file: found unit.fmu, which cannot be used"):
        api.simulate(case)
