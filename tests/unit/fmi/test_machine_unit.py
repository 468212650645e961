"""The whole machine as a unit: the numbers of the march, states, events, versions of FMI, C."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from toothspace import api
from toothspace.circuit.shaft_loads import FreeShaft
from toothspace.core.compilation.library import Way, chosen
from toothspace.core.types import Array
from toothspace.fmi.machine_unit import export_machine
from toothspace.model.assembly import assemble
from toothspace.run.run import warmed_through
from toothspace.solver.compiled_model import observe
from toothspace.solver.transient import TimePlan, TransientMarch

fmpy = pytest.importorskip("fmpy")
validate_fmu = pytest.importorskip("fmpy.validation").validate_fmu

REPOSITORY = Path(__file__).resolve().parents[3]
PUMP, MOTOR = (REPOSITORY / "cases" / f"egm12_{mode}.toml" for mode in ("pump", "motor"))
HOST = Path(__file__).parent / "data" / "fmu_host.c"
LOAD = 8.0

pytestmark = pytest.mark.skipif(chosen()[0] != Way.LIBRARY, reason=chosen()[1])


@dataclass
class Unit:
    """An instance of a unit of either version."""

    fmu: Any
    numbers: Mapping[str, int]
    version: str
    time: float = 0.0

    def get(self, *names: str) -> list[float]:
        references = [self.numbers[name] for name in names]
        read = self.fmu.getReal if self.version == "2" else self.fmu.getFloat64
        return [float(value) for value in read(references)]

    def set(self, **values: float) -> None:
        write = self.fmu.setReal if self.version == "2" else self.fmu.setFloat64
        write([self.numbers[name] for name in values], list(values.values()))

    def step(self, step: float) -> bool:
        """Step; whether an event ended it."""
        event = False
        if self.version == "2":
            self.fmu.doStep(self.time, step)
            self.time += step
        else:
            event, _, _, self.time = self.fmu.doStep(self.time, step)
        return event

    def derivative(self, of: str, by: str) -> float:
        give = getattr(self.fmu, "getDirectionalDerivative", None)
        arguments = ([self.numbers[of]], [self.numbers[by]], [1.0])
        assert give is not None
        return float(give(*arguments)[0])


@pytest.fixture(scope="module")
def units(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[..., Unit]]:
    """Makes instances; every archive is written once."""
    folder, made = tmp_path_factory.mktemp("units"), list[Any]()

    @cache
    def written(case: Path, fmi: str, drive: str, flows: tuple[str, ...]) -> tuple[Any, str]:
        path = folder / f"{case.stem}-{fmi}-{drive}-{len(flows)}.fmu"
        export_machine(case, path, drive=drive, flows=flows, fmi=fmi)
        return fmpy.read_model_description(path), fmpy.extract(path)

    def make(
        case: Path,
        fmi: str = "2",
        drive: str = "speed",
        flows: tuple[str, ...] = (),
        start: float = 0.0,
        events: bool = False,
    ) -> Unit:
        about, unpacked = written(case, fmi, drive, flows)
        given = {
            "unzipDirectory": unpacked,
            "modelIdentifier": about.coSimulation.modelIdentifier,
            "instanceName": "unit",
        }
        if fmi == "2":
            fmu = fmpy.fmi2.FMU2Slave(guid=about.guid, **given)
            fmu.instantiate()
            fmu.setupExperiment(startTime=start)
            fmu.enterInitializationMode()
        else:
            fmu = fmpy.fmi3.FMU3Slave(guid=about.guid, **given)
            fmu.instantiate(eventModeUsed=events, earlyReturnAllowed=events)
            fmu.enterInitializationMode(startTime=start)
        fmu.exitInitializationMode()
        if events:
            fmu.enterStepMode()
        made.append(fmu)
        numbers = {v.name: v.valueReference for v in about.modelVariables}
        return Unit(fmu, numbers, fmi, start)

    yield make
    for fmu in made:
        fmu.terminate()
        fmu.freeInstance()


@pytest.mark.parametrize(("fmi", "case"), [("2", PUMP), ("3", PUMP), ("3", MOTOR)])
def test_the_description_is_that_of_the_standard(fmi: str, case: Path, tmp_path: Path) -> None:
    path = tmp_path / "unit.fmu"
    drive = "torque" if case == MOTOR else "speed"
    export_machine(case, path, drive=drive, fmi=fmi)
    assert validate_fmu(str(path)) == []


def start_up(steps: int, step: float) -> tuple[Array, Array, list[str]]:
    """Speeds and chamber pressures of the start of the motor as the program runs it."""
    run = warmed_through(api.prepare(api.load_case(MOTOR)).worn().with_films())
    history = np.array([[0.0, LOAD], [10.0, LOAD]])
    condition = replace(
        run.condition,
        load_area=0.0,
        circuit=None,
        shaft_speed=0.0,
        free_shaft=FreeShaft(inertia=1e-3, load_history=history),
    )
    system = assemble(run.machine, run.fluid, condition)
    march = TransientMarch(system, TimePlan(steps * step, cells=steps, samples_per_cell=1))
    parts = list(march.chunks())
    states = np.vstack([states for _, states in parts])
    times = np.concatenate([times for times, _ in parts])
    labels = [f"chamber_pressure[{label}]" for label in run.machine.chamber_labels]
    return states[:, 1], observe(system.arrays, states, times).pressure[:, : len(labels)], labels


@pytest.mark.parametrize("fmi", ["2", "3"])
def test_a_start_is_that_of_the_program(units: Callable[..., Unit], fmi: str) -> None:
    """Within a millionth of the pressure scale, at steps that the program knows nothing of."""
    steps, step = 50, 4e-4
    speeds, pressures, labels = start_up(steps, step)
    motor = units(MOTOR, fmi, "torque")
    motor.set(load_torque=LOAD)
    (scale,) = motor.get("inlet_pressure")
    for k in range(steps):
        motor.step(step)
        (speed,) = motor.get("shaft_speed")
        assert speed == pytest.approx(speeds[k], rel=1e-6, abs=1e-6)
        np.testing.assert_allclose(motor.get(*labels), pressures[k], rtol=0.0, atol=1e-6 * scale)
    assert speeds[-1] > 30.0


def test_large_and_small_master_steps_agree(units: Callable[..., Unit]) -> None:
    """A motor that starts under a fan, whose speed in the middle of a step the master guesses."""
    ends = []
    for step in (1e-4, 1e-3):
        motor, before = units(MOTOR, drive="torque"), 0.0
        motor.set(shaft_inertia=5e-3)
        for _ in range(round(0.1 / step)):
            (speed,) = motor.get("shaft_speed")
            middle, before = 1.5 * speed - 0.5 * before, speed
            motor.set(load_torque=3.0 + 4e-4 * middle**2)
            motor.step(step)
        ends.append(motor.get("shaft_speed", "shaft_angle"))
    assert ends[1] == pytest.approx(ends[0], rel=1e-3)
    assert ends[0][0] > 100.0


@pytest.mark.parametrize("fmi", ["2", "3"])
def test_a_state_is_put_back_and_instances_share_nothing(
    units: Callable[..., Unit], fmi: str
) -> None:
    one, other = units(PUMP, fmi), units(PUMP, fmi)
    names = ("outlet_flow_rate", "shaft_torque", "shaft_angle")
    keep = one.fmu.getFMUstate if fmi == "2" else one.fmu.getFMUState
    put_back = one.fmu.setFMUstate if fmi == "2" else one.fmu.setFMUState
    one.step(1e-3)
    kept, time = keep(), one.time
    one.set(outlet_pressure=100e5)
    one.step(1e-3)
    changed = one.get(*names)
    put_back(kept)
    one.time = time
    assert one.get("outlet_pressure") == other.get("outlet_pressure")
    one.step(1e-3)
    other.step(1e-3)
    other.step(1e-3)
    assert one.get(*names) == pytest.approx(other.get(*names), rel=1e-9)
    assert changed[1] < 0.9 * one.get("shaft_torque")[0]
    one.fmu.reset()
    one.time = 0.0
    if fmi == "2":
        one.fmu.setupExperiment(startTime=0.0)
    one.fmu.enterInitializationMode()
    one.fmu.exitInitializationMode()
    assert one.get("shaft_angle") == [0.0]


def test_a_flow_that_nobody_gives_is_that_of_the_displacement(units: Callable[..., Unit]) -> None:
    case = api.load_case(PUMP)
    ideal = api.describe(case).displacement * case.operating_point.shaft_speed
    assert units(PUMP, flows=("outlet",)).get("outlet_flow_rate") == [pytest.approx(ideal)]


def test_a_flow_is_given_and_a_pressure_follows(units: Callable[..., Unit]) -> None:
    """An orifice behind the outlet: the mean pressure is that at which its flow is the pump's."""
    throat = 0.7 * 1.06e-6 * np.sqrt(2.0 / 860.0)
    means = []
    for flows in ((), ("outlet",)):
        pump = units(PUMP, flows=flows)
        pressure, step, seen = pump.get("outlet_pressure")[0], 2e-5, []
        for _ in range(2500):
            flow = throat * np.sqrt(pressure - 1e5)
            if flows:
                pump.set(outlet_flow_rate=flow)
            else:
                pump.set(outlet_pressure=pressure)
            pump.step(step)
            if flows:
                (pressure,) = pump.get("outlet_pressure")
            else:
                given = pump.get("outlet_flow_rate")[0]
                pressure += step * 1.5e9 / 20e-6 * (given - flow)
            seen.append(pressure)
        means.append(np.mean(seen[-1250:]))
    assert means[1] == pytest.approx(means[0], rel=5e-3)


@pytest.mark.parametrize("fmi", ["2", "3"])
def test_a_derivative_tells_the_next_step(units: Callable[..., Unit], fmi: str) -> None:
    pump = units(PUMP, fmi)
    for _ in range(20):
        pump.step(5e-4)
    slope = pump.derivative("shaft_torque", "outlet_pressure")
    torques = []
    for change in (0.0, 4e5):
        keep = pump.fmu.getFMUstate if fmi == "2" else pump.fmu.getFMUState
        put_back = pump.fmu.setFMUstate if fmi == "2" else pump.fmu.setFMUState
        kept, time = keep(), pump.time
        pump.set(outlet_pressure=pump.get("outlet_pressure")[0] + change)
        pump.step(5e-4)
        torques.append(pump.get("shaft_torque")[0])
        put_back(kept)
        pump.time = time
    assert slope == pytest.approx((torques[1] - torques[0]) / 4e5, rel=0.03)
    assert slope > 0.0


def test_a_step_ends_where_the_shaft_stops(units: Callable[..., Unit]) -> None:
    motor = units(MOTOR, "3", "torque", events=True)
    motor.set(load_torque=5.0)
    event = motor.step(5e-3)
    while event:
        event = motor.step(5e-3)
    assert motor.get("shaft_speed")[0] > 1.0
    motor.set(load_torque=80.0, inlet_pressure=1.2e5)
    begun = motor.time
    assert motor.step(0.1)
    assert begun < motor.time < begun + 0.1
    assert motor.get("shaft_speed") == [0.0]
    assert motor.get("time") == [pytest.approx(motor.time)]


def test_time_begins_where_the_master_says(units: Callable[..., Unit]) -> None:
    pump, late = units(PUMP), units(PUMP, start=7.0)
    for one in (pump, late):
        one.step(1e-3)
    assert late.get("shaft_angle") == pytest.approx(pump.get("shaft_angle"), rel=1e-9)


def test_an_output_cannot_be_set_and_time_does_not_go_back(units: Callable[..., Unit]) -> None:
    pump = units(PUMP)
    with pytest.raises(fmpy.fmi1.FMICallException):
        pump.set(shaft_torque=1.0)
    with pytest.raises(fmpy.fmi1.FMICallException):
        pump.step(-1e-3)
