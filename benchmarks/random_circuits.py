"""Random circuits round a motor, a pump or a gerotor: how many runs finish, how well they balance.

``python -m benchmarks.random_circuits --count 500 -o circuits.csv`` draws circuits with up to four
restrictions and stores on the way to the inlet, from the outlet and at an external drain, with
elements between any two places, tanks of one or several pressures, loads on the shaft, 20 to 110
degC, and runs each in a process of its own, one after another, which is ended at ``--limit``
seconds of processor time. ``--only SEED`` prints the case of one circuit. A command that was
stopped goes on where it was.
"""

from __future__ import annotations

import random
import time
from collections import Counter
from typing import Any

import numpy as np

from benchmarks.random_designs import (
    CASES,
    ENERGY_LIMIT,
    MASS_LIMIT,
    good,
    log_uniform,
    run_seeds,
    tables_of,
    warnings_in,
)
from toothspace.api import simulate
from toothspace.case import Case
from toothspace.case.document import document_text

MACHINES = ("egm12_motor", "startup_fan_drive", "egm12_pump", "gerotor_trochoidal")
_NUMBERS = ("status", "mass_balance_error", "energy_balance_error")
_COLUMNS = ("seed", "machine", "elements", "run_s", "processor_s", *_NUMBERS, "warnings")
_OVER_TIME = (0.0, 0.3, 0.6, 1.0)


class Drawing:
    """A circuit while it is drawn: its elements by name and what is joined."""

    def __init__(self, seed: int) -> None:
        self.draw = random.Random(seed)
        self.elements: dict[str, dict[str, Any]] = {}
        self.joints: list[list[str]] = []
        self.duration = self.draw.uniform(0.1, 0.6)
        self.places: list[str] = []

    def add(self, kind: str, **keys: Any) -> str:
        """Add an element and return its name."""
        name = f"{kind}_{len(self.elements)}"
        self.elements[name] = {"kind": kind, **keys}
        return name

    def history(self, low: float, high: float, unit: str) -> list[list[Any]]:
        """Values at some times of the run, from between two bounds."""
        values = [self.draw.uniform(low, high) for _ in _OVER_TIME]
        return [
            [f"{share * self.duration:.4g} s", f"{value:.4g} {unit}" if unit else round(value, 3)]
            for share, value in zip(_OVER_TIME, values, strict=True)
        ]

    def tank(self) -> str:
        """A tank at low pressure: one of those there are, or another."""
        known = [name for name, keys in self.elements.items() if keys["kind"] == "tank"]
        if known and self.draw.random() < 0.6:
            return self.draw.choice(known)
        return self.add("tank", pressure=f"{self.draw.uniform(1.0, 3.0):.3g} bar")

    def restriction(self) -> str:
        """An element with two ends."""
        draw = self.draw
        kind = draw.choice(
            ("orifice", "check_valve", "proportional_valve", "cooler", "relief_valve", "hose")
        )
        if kind == "orifice":
            return self.add(kind, diameter=f"{log_uniform(draw, 1.5, 10.0):.3g} mm")
        if kind == "check_valve":
            return self.add(kind, opening_pressure=f"{draw.uniform(0.0, 1.0):.3g} bar")
        if kind == "proportional_valve":
            opening = self.history(0.1, 1.0, "")
            return self.add(kind, area=f"{log_uniform(draw, 3.0, 60.0):.3g} mm^2", opening=opening)
        if kind == "cooler":
            drop = f"{draw.uniform(0.2, 5.0):.3g} bar"
            return self.add(kind, pressure_drop=drop, flow_rate=f"{draw.uniform(2, 30):.3g} L/min")
        if kind == "relief_valve":
            return self.add(kind, opening_pressure=f"{log_uniform(draw, 0.5, 20.0):.3g} bar")
        return self.line(model="transmission_line", cells=draw.randint(2, 8))

    def line(self, **keys: Any) -> str:
        """A line: rigid, with a wall, or with an effective bulk modulus."""
        draw = self.draw
        wall = draw.choice(
            (
                {},
                {"effective_bulk_modulus": f"{draw.uniform(0.3, 1.2):.3g} GPa"},
                {
                    "wall_thickness": "2 mm",
                    "wall_modulus": f"{log_uniform(draw, 0.1, 200):.3g} GPa",
                },
            )
        )
        length = f"{log_uniform(draw, 0.1, 4.0):.3g} m"
        return self.add("hose", length=length, bore=f"{draw.uniform(5, 20):.3g} mm", **wall, **keys)

    def store(self) -> str:
        """An element with one end that holds fluid."""
        draw, kind = self.draw, self.draw.choice(("volume", "hose", "hose", "accumulator"))
        if kind == "volume":
            return self.add(kind, volume=f"{log_uniform(draw, 5.0, 500.0):.3g} cm^3")
        if kind == "hose":
            return self.line()
        charge = {"gas_volume": f"{log_uniform(draw, 10.0, 500.0):.3g} cm^3"}
        return self.add(kind, **charge, precharge=f"{log_uniform(draw, 1.0, 40.0):.3g} bar")

    def way(self, first: str, last: str, most: int) -> None:
        """Join two places in the direction of flow by restrictions with stores between."""
        count = self.draw.randint(1, most)
        here = first
        for k in range(count):
            through = self.restriction()
            there = last if k == count - 1 else self.store()
            self.joints += [[here, through], [through, there]]
            if there != last:
                self.places.append(there)
            here = there

    def supply(self) -> str:
        """Pump into a store, with a relief valve to a tank; return the store."""
        draw = self.draw
        speed = self.history(50.0, 1500.0, "rpm")
        efficiency = {"offset": 0.97, "per_100_bar": -0.03}
        displacement = f"{draw.uniform(3, 12):.3g} cm^3"
        pump = self.add("pump_map", displacement=displacement, speed=speed)
        self.elements[pump]["volumetric_efficiency"] = efficiency
        store = self.store()
        if draw.random() < 0.5:
            self.joints.append([self.tank(), pump])
        relief = self.add("relief_valve", opening_pressure=f"{draw.uniform(20, 150):.3g} bar")
        self.joints += [[pump, store], [store, relief], [relief, self.tank()]]
        return store

    def load(self) -> None:
        """Prescribed speed, or loads on a free shaft."""
        draw = self.draw
        fan = {"quadratic": f"{log_uniform(draw, 1e-7, 1e-5):.3g} N m/rpm^2"}
        self.add("fan", inertia=f"{log_uniform(draw, 5e-4, 2e-2):.3g} kg m^2", **fan)
        if draw.random() < 0.4:
            self.add("inertia", inertia=f"{log_uniform(draw, 5e-4, 1e-2):.3g} kg m^2")
        if draw.random() < 0.4:
            self.add("torque_source", torque=self.history(0.0, 1.0, "N m"))
        if draw.random() < 0.3:
            stiffness = f"{log_uniform(draw, 20.0, 2000.0):.3g} N m/rad"
            self.add("coupling", stiffness=stiffness, damping="0.02 N m s/rad")


def tables_for(seed: int) -> dict[str, Any]:
    """Case of a seed as tables."""
    name = MACHINES[seed % len(MACHINES)]
    tables, drawing = tables_of(name), Drawing(seed)
    draw = drawing.draw
    tables.pop("operating_point", None)
    motor = tables["machine"]["mode"] == "motor"
    if motor and draw.random() < 0.8:
        source = drawing.supply()
    elif motor:
        source = drawing.add("tank", pressure=f"{draw.uniform(20, 150):.3g} bar")
    else:
        source = drawing.tank()
    if draw.random() < 0.5:
        drawing.way(source, "machine.inlet", 2)
    else:
        drawing.joints.append([source, "machine.inlet"])
    direct = motor and draw.random() < 0.3
    if direct:
        drawing.joints.append(["machine.outlet", drawing.tank()])
    else:
        drawing.way("machine.outlet", drawing.tank(), 3)
    if draw.random() < 0.3:
        tables["machine"] |= {"drain": "external", "drain_pressure": "1 bar"}
        drawing.joints.append(["machine.drain", drawing.store()])
        drawing.way(drawing.joints[-1][1], drawing.tank(), 2)
    if draw.random() < 0.3 and len(drawing.places) > 1:
        drawing.way(*draw.sample(drawing.places, 2), 1)
    if motor and draw.random() < 0.7:
        drawing.load()
    else:
        drawing.add("speed_source", speed=drawing.history(100.0, 1500.0, "rpm"))
    temperature = f"{draw.uniform(20.0, 110.0):.1f} degC"
    fluid = {"temperature": temperature, "free_air_fraction": round(draw.uniform(0.0, 0.01), 4)}
    tables["fluid"] |= fluid
    tables["circuit"] = {
        "duration": f"{drawing.duration:.4g} s",
        "connections": drawing.joints,
        **drawing.elements,
    }
    tables["run"] = {"fidelity": "lumped", "time_samples": 400}
    tables["title"] = f"random circuit {seed}, {name}"
    return tables


def row_of(seed: int) -> dict[str, Any]:
    """Run one circuit; what came out as one row."""
    tables = tables_for(seed)
    started = time.perf_counter(), time.process_time()
    row: dict[str, Any] = {
        "seed": seed,
        "machine": MACHINES[seed % len(MACHINES)],
        "elements": " ".join(
            keys["kind"] for keys in tables["circuit"].values() if isinstance(keys, dict)
        ),
    }
    try:
        solution = simulate(Case.from_toml(document_text(tables), CASES))
    except Exception as error:  # what a circuit may never do is a row of its own
        return row | {"status": f"{type(error).__name__}: {error}"}
    numbers = solution.summary()
    row |= {name: numbers[name] for name in _NUMBERS}
    row["run_s"] = time.perf_counter() - started[0]
    row["processor_s"] = time.process_time() - started[1]
    row["warnings"] = warnings_in(solution)
    return row


def report(rows: list[dict[str, Any]]) -> None:
    """Print the table of all rows, and the seeds of those to look at."""
    finished = [row for row in rows if "mass_balance_error" in row]
    print(f"{len(rows)} circuits; statuses {dict(Counter(row['status'] for row in rows))}")
    done = [row for row in finished if row["status"] == "done"]
    for name, limit in (("mass", MASS_LIMIT), ("energy", ENERGY_LIMIT)):
        errors = np.array([row[f"{name}_balance_error"] for row in done])
        above = [int(row["seed"]) for row, error in zip(done, errors, strict=True) if error > limit]
        print(
            f"{name} error of those done: median {np.median(errors):.1e}, "
            f"worst {errors.max():.1e}, above {limit:g}: {above}"
        )
    times = [row["processor_s"] for row in finished]
    print(f"processor: median {np.median(times):.2f} s, longest {max(times):.1f} s")
    print(f"to look at: {[int(row['seed']) for row in rows if row not in done or not good(row)]}")


def main() -> None:
    run_seeds(
        "random_circuits", __doc__, row_of, report,
        lambda seed: document_text(tables_for(seed)), _COLUMNS, 500,
    )  # fmt: skip


if __name__ == "__main__":
    main()
