"""Units of a whole machine by FMPy: cost of a revolution, a start against the program, tables.

python -m benchmarks.bench_units            # prints the tables
python -m benchmarks.bench_units --store    # and writes them beside the other results
"""

from __future__ import annotations

import argparse
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import fmpy
import numpy as np

import toothspace as ts
from toothspace import api
from toothspace.circuit.shaft_loads import FreeShaft
from toothspace.core.types import Array
from toothspace.model.assembly import System, assemble
from toothspace.run.run import warmed_through
from toothspace.solver.compiled_model import observe
from toothspace.solver.initial import start_state
from toothspace.solver.integrator import start_march
from toothspace.solver.transient import TimePlan, TransientMarch

STORE = Path(__file__).parent / "results" / "units.md"
REVOLUTIONS = 8
STEPS = (1e-3, 1e-4, 2e-5)
LOAD = 8.0
START = 0.1
POINTS = ((1400.0, 199.0), (850.0, 110.0), (300.0, 50.0))
"""Shaft speed [rpm] and pressure difference [bar] of the comparison with tables."""


class Unit:
    """A unit of FMI 2.0 in its place on disk; ``open`` makes an instance."""

    def __init__(self, path: Path) -> None:
        self.about = fmpy.read_model_description(path)
        self.folder = fmpy.extract(path)
        self.numbers = {v.name: v.valueReference for v in self.about.modelVariables}

    def open(self, given: dict[str, float]) -> Any:
        """Return an instance that has begun with some inputs."""
        unit = fmpy.fmi2.FMU2Slave(
            guid=self.about.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.about.coSimulation.modelIdentifier,
            instanceName="unit",
        )
        unit.instantiate()
        unit.setupExperiment()
        unit.setReal([self.numbers[name] for name in given], list(given.values()))
        unit.enterInitializationMode()
        unit.exitInitializationMode()
        return unit

    def run(self, given: dict[str, float], step: float, steps: int, names: list[str]) -> Array:
        """Values after every step. Shape (steps, names)."""
        unit, rows = self.open(given), []
        references = [self.numbers[name] for name in names]
        for k in range(steps):
            unit.doStep(k * step, step)
            rows.append(unit.getReal(references))
        unit.terminate()
        unit.freeInstance()
        return np.array(rows)


def held(case: str, shaft: FreeShaft | None) -> System:
    """Machine with ports at constant pressure, as in the unit."""
    run = warmed_through(api.prepare(api.load_case(case)).worn().with_films())
    condition = replace(run.condition, load_area=0.0, circuit=None)
    if shaft is not None:
        condition = replace(condition, shaft_speed=0.0, free_shaft=shaft)
    return assemble(run.machine, run.fluid, condition)


def cost(folder: Path) -> list[str]:
    """Time of a revolution of the pump, by the program and by its unit."""
    system = held("egm12_pump", None)
    duration = REVOLUTIONS * 2.0 * np.pi / system.condition.shaft_speed
    own = []
    for _ in range(3):
        march = start_march(system, start_state(system))
        began = time.perf_counter()
        for times in np.split(np.linspace(0.0, duration, 720 * REVOLUTIONS + 1)[1:], REVOLUTIONS):
            observe(system.arrays, march.advance(times).states, times)
        own.append((time.perf_counter() - began) / REVOLUTIONS)
    path = folder / "pump.fmu"
    ts.export_machine("egm12_pump", path)
    unit = Unit(path)
    lines = ["| master step | ms a revolution | over the program |", "|---|---|---|"]
    lines.append(f"| the program, 720 samples a revolution | {1e3 * min(own):.1f} | 1 |")
    for step in STEPS:
        steps, found = round(duration / step), []
        for _ in range(3):
            instance = unit.open({})
            began = time.perf_counter()
            for k in range(steps):
                instance.doStep(k * step, step)
            found.append((time.perf_counter() - began) / REVOLUTIONS)
            instance.freeInstance()
        ratio = min(found) / min(own)
        lines.append(f"| {step:g} s | {1e3 * min(found):.1f} | {ratio:.2f} |")
    return lines


def start(folder: Path) -> list[str]:
    """A motor that starts from rest, by the program and by its unit."""
    path = folder / "motor.fmu"
    ts.export_machine("egm12_motor", path, drive="torque")
    unit = Unit(path)
    system = held(
        "egm12_motor", FreeShaft(inertia=1e-3, load_history=np.array([[0.0, LOAD], [9.0, LOAD]]))
    )
    names = [f"chamber_pressure[{label}]" for label in system.description.chamber_labels]
    lines = [
        "| master step | largest error of a tooth-space pressure | of the speed |",
        "|---|---|---|",
    ]
    for step in (1e-4, 1e-3):
        steps = round(START / step)
        march = TransientMarch(system, TimePlan(START, cells=steps, samples_per_cell=1))
        parts = list(march.chunks())
        states = np.vstack([states for _, states in parts])
        times = np.concatenate([times for times, _ in parts])
        pressures = observe(system.arrays, states, times).pressure[:, : len(names)]
        found = unit.run({"load_torque": LOAD}, step, steps, ["shaft_speed", *names])
        error = np.abs(found[:, 1:] - pressures).max() / system.condition.inlet_pressure
        speed = np.abs(found[:, 0] / states[:, 1] - 1.0).max()
        lines.append(f"| {step:g} s | {error:.1e} of the high pressure | {speed:.1e} |")
    return lines


def tables(folder: Path) -> list[str]:
    """Unit of tables against that of the whole machine, at points and for a pressure that jumps."""
    path = folder / "tables.fmu"
    ts.export_fmu("egm12_pump", path)
    of_tables, full = Unit(path), Unit(folder / "pump.fmu")
    names = ["outlet_flow_rate", "shaft_torque"]
    lines = [
        "| point | mean outlet flow | mean torque | ripple of the torque |",
        "|---|---|---|---|",
    ]
    for speed, bar in POINTS:
        omega = speed * np.pi / 30.0
        given = {"inlet_pressure": 1e5, "outlet_pressure": 1e5 * (1.0 + bar), "shaft_speed": omega}
        step = 2.0 * np.pi / omega / 360
        rows = [one.run(given, step, 360 * 4, names)[-720:] for one in (of_tables, full)]
        mean = rows[0].mean(axis=0) / rows[1].mean(axis=0) - 1.0
        ripple = np.std(rows[0][:, 1]) / np.std(rows[1][:, 1]) - 1.0
        lines.append(
            f"| {speed:.0f} rpm, {bar:.0f} bar | {100 * mean[0]:.2f} % | {100 * mean[1]:.2f} % "
            f"| {100 * ripple:.1f} % |"
        )
    return [*lines, "", jump(of_tables, full)]


def jump(of_tables: Unit, full: Unit) -> str:
    """Oil that a jump of the outlet pressure drives through the machine while it fills."""
    omega, step, moved = 1500.0 * np.pi / 30.0, 1e-4, []
    for unit in (of_tables, full):
        given = {"inlet_pressure": 1e5, "outlet_pressure": 100e5, "shaft_speed": omega}
        instance = unit.open(given)
        reference, volume = [unit.numbers["outlet_flow_rate"]], []
        for k in range(1200):
            if k == 800:
                instance.setReal([unit.numbers["outlet_pressure"]], [200e5])
            instance.doStep(k * step, step)
            volume.append(instance.getReal(reference)[0] * step)
        instance.freeInstance()
        moved.append(np.array(volume))
    change = float(np.sum((moved[0] - moved[1])[800:840])) * 1e6
    return f"Outlet from 100 to 200 bar at once: the unit of tables delivers {change:.2f} cm3 more"


def report() -> list[str]:
    """All tables."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        return [
            "## Cost of a revolution of egm12_pump at 1500 rpm",
            "",
            *cost(folder),
            "",
            f"## A start of egm12_motor in {START:g} s against {LOAD:g} N m",
            "",
            *start(folder),
            "",
            "## Tables against the whole machine, egm12_pump",
            "",
            *tables(folder),
        ]


def main() -> None:
    """Print the tables, and store them if that is asked."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.bench_units")
    parser.add_argument("--store", action="store_true")
    lines = report()
    print("\n".join(lines))
    if parser.parse_known_args()[0].store:
        STORE.write_text("\n".join(["# Units of a whole machine", "", *lines, ""]), "utf-8")


if __name__ == "__main__":
    main()
