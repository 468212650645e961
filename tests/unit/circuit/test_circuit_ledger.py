"""Masses and energies of a circuit close with every element in every place."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from toothspace import api
from toothspace.case import Case
from toothspace.circuit.elements import ELEMENTS
from toothspace.results.solution import Solution

CASES = Path(__file__).resolve().parents[3] / "cases"
TANK = {"kind": "tank", "pressure": "1 bar"}
STORE = {"kind": "volume", "volume": "20 cm^3"}
RESTRICTIONS: dict[str, dict[str, Any]] = {
    "orifice": {"diameter": "3 mm"},
    "relief_valve": {"opening_pressure": "2 bar"},
    "check_valve": {},
    "proportional_valve": {"area": "5 mm^2", "opening": [["0 s", 0.2], ["0.01 s", 1.0]]},
    "cooler": {"pressure_drop": "1 bar", "flow_rate": "10 L/min"},
    "hose": {"length": "1 m", "bore": "8 mm", "model": "transmission_line", "cells": 4},
}
"""Elements with two ends that flow passes."""
HOSE = {"length": "1 m", "bore": "8 mm", "effective_bulk_modulus": "0.6 GPa"}
STORES: dict[str, dict[str, Any]] = {
    "volume": {"volume": "50 cm^3"},
    "hose": HOSE,
    "accumulator": {"gas_volume": "20 cm^3", "precharge": "10 bar"},
    "relaxing": {"kind": "hose", **HOSE, "wall_stiffening": 2.0},
}
"""Elements with one end."""
LOADS: dict[str, dict[str, Any]] = {
    "fan": {"linear": "0.0002 N m/rpm", "inertia": "0.0035 kg m^2"},
    "blower": {
        "kind": "fan", "inertia": "0.0035 kg m^2", "linear": "0.0001 N m/rpm",
        "quadratic": "3e-7 N m/rpm^2", "cubic": "1e-9 N m/rpm^3",
    },
    "inertia": {"inertia": "0.002 kg m^2"},
    "torque_source": {"torque": [["0 s", "0.2 N m"], ["0.01 s", "0.4 N m"]]},
    "coupling": {"stiffness": "100 N m/rad", "damping": "0.01 N m s/rad"},
}  # fmt: skip
ELSEWHERE = {
    "electric_drive": "test_electric_drive.py",
    "flow_source": "test_foreign_units.py",
    "fmu": "test_foreign_units.py",
}
"""Elements whose masses and energies are balanced in another file."""
SPIN = {"kind": "speed_source", "speed": [["0 s", "300 rpm"]]}
PLACES: dict[str, list[list[str]]] = {
    "inlet": [["high", "x"], ["x", "machine.inlet"], ["machine.outlet", "low"]],
    "outlet": [["high", "machine.inlet"], ["machine.outlet", "x"], ["x", "low"]],
    "between": [
        ["high", "machine.inlet"],
        ["machine.outlet", "y"],
        ["y", "store"],
        ["store", "x"],
        ["x", "low"],
    ],
    "beside": [
        ["high", "machine.inlet"],
        ["machine.outlet", "low"],
        ["machine.inlet", "x"],
        ["x", "machine.outlet"],
    ],
    "across": [
        ["high", "y"],
        ["y", "machine.inlet"],
        ["machine.outlet", "store"],
        ["store", "z"],
        ["z", "low"],
        ["machine.inlet", "x"],
        ["x", "store"],
    ],
    "drain": [
        ["high", "machine.inlet"],
        ["machine.outlet", "low"],
        ["machine.drain", "store"],
        ["store", "x"],
        ["x", "low"],
    ],
}


def motor(connections: list[list[str]], elements: dict[str, Any], pressure: str = "20 bar") -> Case:
    """The motor of the fan drive between a tank at a pressure and one at 1 bar."""
    tables = api.load_case(CASES / "startup_fan_drive.toml").to_dict()
    del tables["machine"]["casing"]["wear_in"]
    if any("machine.drain" in pair for pair in connections):
        tables["machine"] |= {"drain": "external", "drain_pressure": "1 bar"}
    known = {
        "high": {"kind": "tank", "pressure": pressure},
        "low": TANK,
        "store": STORE,
        "y": {"kind": "orifice", "diameter": "4 mm"},
        "z": {"kind": "cooler", **RESTRICTIONS["cooler"]},
        "spin": SPIN,
    }
    named = {name for pair in connections for name in pair}
    present = {k: v for k, v in known.items() if k in named or k == "spin"} | elements
    tables["circuit"] = {"duration": "0.02 s", "connections": connections, **present}
    tables["circuit"] = {k: v for k, v in tables["circuit"].items() if v is not None}
    tables["run"] = {"fidelity": "lumped", "time_samples": 50, "relative_tolerance": 1e-8}
    return Case.from_dict(tables)


def check(solution: Solution) -> None:
    assert solution.status.name == "DONE"
    assert solution.ledger.mass_balance_error < 1e-7
    assert solution.ledger.energy_balance_error < 1e-5


def test_every_kind_of_element_is_balanced() -> None:
    here = {*RESTRICTIONS, *STORES, *LOADS, "pump_map", "speed_source", "tank"}
    here -= {"relaxing", "blower"}
    assert here | set(ELSEWHERE) == set(ELEMENTS)
    for kind, file in ELSEWHERE.items():
        text = Path(__file__).with_name(file).read_text(encoding="utf-8")
        assert kind in text
        assert "energy_balance_error" in text or "check(" in text


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("kind", RESTRICTIONS)
def test_a_restriction_anywhere_keeps_mass_and_energy(kind: str, place: str) -> None:
    solution = api.simulate(motor(PLACES[place], {"x": {"kind": kind, **RESTRICTIONS[kind]}}))
    check(solution)
    passed = solution.ledger.mass["outlet"] + solution.ledger.mass["drain"]
    assert passed > 0.5 * solution.ledger.mass["inlet"] > 0.0


@pytest.mark.parametrize("port", ["machine.inlet", "machine.outlet", "store"])
@pytest.mark.parametrize("kind", STORES)
def test_a_store_anywhere_keeps_mass_and_energy(kind: str, port: str) -> None:
    joints = [
        ["high", "y"],
        ["y", "machine.inlet"],
        ["machine.outlet", "z"],
        ["z", "store"],
        ["store", "w"],
        ["w", "low"],
        [port, "x"],
    ]
    elements = {"x": {"kind": kind, **STORES[kind]}, "w": {"kind": "orifice", "diameter": "4 mm"}}
    check(api.simulate(motor(joints, elements)))


@pytest.mark.parametrize("returned", ["tank", "cooler"])
@pytest.mark.parametrize("suction", ["none", "tank", "volume"])
def test_a_supply_pump_anywhere_keeps_mass_and_energy(suction: str, returned: str) -> None:
    """A pump with a tank of its own, from the common tank, or through a suction line."""
    joints = [["pump", "store"], ["store", "machine.inlet"], ["store", "x"], ["x", "low"]]
    joints += [["machine.outlet", "z"], ["z", "low"]] if returned == "cooler" else []
    joints += [["machine.outlet", "low"]] if returned == "tank" else []
    if suction != "none":
        joints = [["low" if suction == "tank" else "suction", "pump"], *joints]
    if suction == "volume":
        joints += [["low", "y"], ["y", "suction"]]
    elements: dict[str, Any] = {
        "pump": {
            "kind": "pump_map",
            "displacement": "10 cm^3",
            "speed": [["0 s", "300 rpm"], ["0.01 s", "600 rpm"]],
        },
        "x": {"kind": "relief_valve", "opening_pressure": "30 bar"},
    }
    if suction == "volume":
        elements["suction"] = STORE
    solution = api.simulate(motor(joints, elements))
    check(solution)
    assert solution.ledger.mass["inlet"] > 0.0
    assert solution.ledger.mass["outlet"] > 0.0


@pytest.mark.parametrize("kind", LOADS)
def test_a_load_on_the_shaft_keeps_energy(kind: str) -> None:
    elements = {"spin": None, "x": {"kind": "orifice", "diameter": "3 mm"}}
    elements |= {"load": {"kind": kind, **LOADS[kind]}}
    if kind in ("torque_source", "coupling"):
        elements["wheel"] = {"kind": "inertia", **LOADS["inertia"]}
    case = motor(PLACES["outlet"], elements, pressure="60 bar")
    solution = api.simulate(case.replace({"circuit.initial_shaft_speed": "300 rpm"}))
    check(solution)
    # what the load is said to take is what it takes, on average over rows
    taken = solution.data["load_torque"] * solution.data["shaft_speed"]
    power = -solution.ledger.energy["shaft"] / solution.ledger.duration
    assert float(taken.mean()) == pytest.approx(power, rel=0.02, abs=1e-9)


def test_one_tank_that_gives_and_takes_shows_both() -> None:
    """What a pump takes from a tank and returns to it does not cancel."""
    tables = api.load_case(CASES / "egm12_pump.toml").to_dict()
    del tables["operating_point"]
    tables["circuit"] = {
        "duration": "0.02 s",
        "connections": [["tank", "machine.inlet"], ["machine.outlet", "x"], ["x", "tank"]],
        "tank": TANK,
        "x": {"kind": "orifice", "diameter": "2 mm"},
        "spin": {"kind": "speed_source", "speed": [["0 s", "600 rpm"]]},
    }
    solution = api.simulate(Case.from_dict(tables))
    check(solution)
    mass = solution.ledger.mass
    assert mass["outlet"] == pytest.approx(mass["inlet"], rel=0.2)
    assert solution.data["node_pressure"].sizes["node"] == 2


def test_a_run_whose_energies_do_not_balance_is_made_at_a_tighter_tolerance() -> None:
    case = motor(PLACES["outlet"], {"x": {"kind": "orifice", **RESTRICTIONS["orifice"]}})
    solution = api.simulate(case.replace({"run.relative_tolerance": 1e-5}))
    check(solution)
    assert solution.statistics["relative_tolerance"] < 1e-5
