"""Every kind of advice is followed here, and it helps: the finding is gone, or much smaller."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from toothspace import api
from toothspace.case import Case
from toothspace.core.status import Status
from toothspace.results.solution import STANDING, Solution

CASES = Path(__file__).resolve().parents[3] / "cases"
GROOVES = {
    "closing_side_offset": "3.4 mm",
    "opening_side_offset": "3.4 mm",
    "width": "10 mm",
    "radial_extent": "10 mm",
    "depth": "1.5 mm",
}
QUICK = {
    "run.samples_per_revolution": 180,
    "heat.model": "network",
}
FIXED = {**QUICK, "operating_point.outlet_load": "fixed_pressure"}
JET = {"fluid.name": "jet_a1", "operating_point.shaft_speed": "3000 rpm"}
FAST = {"operating_point.shaft_speed": "9000 rpm"}
SLOW = pytest.mark.slow

LARGE_MOTOR = {
    "schema": 1,
    "title": "29 teeth at 6580 rpm with little backlash and no relief grooves",
    "machine": {
        "type": "external_gear",
        "mode": "motor",
        "gears": {
            "tooth_count": 29,
            "module": "2.808 mm",
            "pressure_angle": "20 deg",
            "profile_shift": -0.079,
            "dedendum": 1.25,
            "tip_diameter": "87.257 mm",
            "tip_rounding": "0.0842 mm",
            "face_width": "21.345 mm",
            "normal_backlash": "0.0254 mm",
        },
        "casing": {
            "radial_clearance": "38.55 um",
            "inlet_angle": "99.1 deg",
            "outlet_angle": "87.6 deg",
        },
        "journal_bearings": {
            "diameter": "47.931 mm",
            "length": "50.028 mm",
            "radial_clearance": "41.89 um",
        },
        "lateral": {"side_gap": "5.14 um"},
        "inlet": {"volume": "479 cm^3"},
        "outlet": {"volume": "242 cm^3"},
    },
    "fluid": {"name": "iso_vg_46", "temperature": "24.1 degC", "dissolved_air_fraction": 0.0},
    "operating_point": {
        "shaft_speed": "6579.6 rpm",
        "inlet_pressure": "4.2193 bar",
        "outlet_pressure": "1 bar",
    },
    "run": {"fidelity": "lumped", "until": "cyclic", "samples_per_revolution": 180},
}
TIGHT_MOTOR = {
    "schema": 1,
    "title": "Cycloidal motor of 8 and 9 lobes in cold oil with tip gaps of 8 um",
    "machine": {
        "type": "gerotor",
        "mode": "motor",
        "rotors": {
            "kind": "cycloidal",
            "inner_tooth_count": 8,
            "eccentricity": "4.8941 mm",
            "face_width": "23.2051 mm",
            "tip_clearance": "7.57 um",
        },
        "housing": {
            "outer_rotor_diameter": "102.8445 mm",
            "radial_clearance": "92.2 um",
            "end_condition": "no_flow",
        },
        "ports": {
            "timing": "kinematic",
            "inner_radius": "24.7834 mm",
            "outer_radius": "38.2507 mm",
        },
        "lateral": {"side_gap": "12 um"},
        "inlet": {"volume": "60 cm^3"},
        "outlet": {"volume": "60 cm^3"},
    },
    "fluid": {
        "name": "iso_vg_32",
        "temperature": "-9.6 degC",
        "free_air_fraction": 0.002,
        "dissolved_air_fraction": 0.08,
    },
    "operating_point": {
        "shaft_speed": "1732 rpm",
        "inlet_pressure": "7.127 bar",
        "outlet_pressure": "0.3677 bar",
    },
    "run": {"fidelity": "lumped", "until": "cyclic", "samples_per_revolution": 180},
}
WIDE_ROTORS = {
    "schema": 1,
    "title": "Rotors of 0.2 mm tip clearance and 0.4 mm eccentricity",
    "machine": {
        "type": "gerotor",
        "mode": "motor",
        "rotors": {
            "kind": "trochoidal",
            "inner_tooth_count": 8,
            "eccentricity": "0.4359 mm",
            "generating_radius": "7.7783 mm",
            "lobe_radius": "1.8438 mm",
            "face_width": "300 mm",
            "tip_clearance": "205.51 um",
        },
        "housing": {
            "outer_rotor_diameter": "16.6128 mm",
            "radial_clearance": "201.97 um",
            "end_condition": "pressure",
        },
        "ports": {
            "timing": "kinematic",
            "inner_radius": "5.6085 mm",
            "outer_radius": "6.7383 mm",
        },
        "lateral": {"side_gap": "223.33 um"},
        "journal_bearings": {
            "diameter": "6.598 mm",
            "length": "6.666 mm",
            "radial_clearance": "4.95 um",
        },
        "inlet": {"volume": "186.574 cm^3"},
        "outlet": {"volume": "20.173 cm^3"},
    },
    "fluid": {"name": "iso_vg_68", "temperature": "31.4 degC"},
    "operating_point": {
        "shaft_speed": "6941.257 rpm",
        "inlet_pressure": "48.8865 bar",
        "outlet_pressure": "1 bar",
    },
    "run": {"fidelity": "lumped", "until": "cyclic", "samples_per_revolution": 180},
}


@dataclass(frozen=True)
class Advice:
    """A run that is told something, and what it is advised to change."""

    told: str
    """Quantity of the finding; empty if only the status tells."""
    words: str
    """Words of the advice that is followed."""
    bad: dict[str, Any]
    better: dict[str, Any]
    case: Any = "egm12_pump"
    status: Status = Status.DONE
    remains: float = 0.0
    """Largest share of the number that may remain; zero if the finding must be gone. [-]"""
    marks: tuple[Any, ...] = field(default=())


TEMPERATURE = "Temperature, range of the fluid"
PRESSURE = "Highest pressure, range of the fluid"
CAVITATION = "Cavitation damage index: power of collapsing vapour"
TIGHT = {
    **FIXED,
    "machine.journal_bearings.radial_clearance": "1 um",
    "operating_point.shaft_speed": "8000 rpm",
}
FUEL = {
    **FIXED,
    "fluid.name": "jet_a1",
    "operating_point.shaft_speed": "8000 rpm",
    "machine.journal_bearings.radial_clearance": "100 um",
}
SEALED = {
    **FIXED,
    "machine.relief_grooves": None,
    "machine.gears.normal_backlash": "0.005 mm",
}
APART = {**GROOVES, "closing_side_offset": "7 mm", "opening_side_offset": "7 mm"}
SHUT_POCKETS = {
    "machine.rotors.tip_clearance": "7 um",
    "machine.ports.inner_radius": "13.5 mm",
    "machine.ports.outer_radius": "19 mm",
    "fluid.temperature": "-10 degC",
    "heat.model": None,
    "operating_point.shaft_speed": "3000 rpm",
    "operating_point.outlet_load": "fixed_pressure",
}
IDLE = {**QUICK, "operating_point.inlet_pressure": "2 bar"}
STEEP = {
    **FIXED,
    "operating_point.outlet_pressure": "1000 bar",
    "machine.casing.wear_in": None,
    "machine.casing.radial_clearance": "80 um",
}
LEAKING = {
    **FIXED,
    "operating_point.shaft_speed": "10 rpm",
    "machine.casing.radial_clearance": "120 um",
    "machine.lateral.side_gap": "40 um",
}

FOLLOWED = {
    "grooves let enclosed fluid out": Advice(
        PRESSURE, "machine.relief_grooves", SEALED, {"machine.relief_grooves": GROOVES}, remains=0.4
    ),
    "backlash lets enclosed fluid out": Advice(
        PRESSURE, "widen backlash", SEALED, {"machine.gears.normal_backlash": "0.2 mm"}, remains=0.7
    ),
    "grooves nearer together let enclosed fluid out": Advice(
        PRESSURE,
        "edges of machine.relief_grooves nearer together",
        {**SEALED, "machine.relief_grooves": APART},
        {"machine.relief_grooves": GROOVES},
        remains=0.4,
        marks=(SLOW,),
    ),
    "tip gaps let enclosed pockets out": Advice(
        PRESSURE,
        "widen machine.rotors.tip_clearance",
        SHUT_POCKETS,
        {"machine.rotors.tip_clearance": "100 um"},
        "gerotor_cycloidal",
        remains=0.2,
        marks=(SLOW,),
    ),
    "grooves of a motor that fails": Advice(
        PRESSURE,
        "machine.relief_grooves",
        {},
        {"machine.relief_grooves": GROOVES},
        LARGE_MOTOR,
        Status.FLUID_ENCLOSED,
        0.1,
        (SLOW,),
    ),
    "tip gaps of a motor that fails": Advice(
        PRESSURE,
        "widen machine.rotors.tip_clearance",
        {},
        {"machine.rotors.tip_clearance": "100 um"},
        TIGHT_MOTOR,
        Status.FLUID_ENCLOSED,
    ),
    "teeth that do not skip": Advice(
        "Turning out of the mesh",
        "machine.rotors.tip_clearance",
        {},
        {"machine.rotors.tip_clearance": "30 um"},
        WIDE_ROTORS,
        Status.OUT_OF_MESH,
    ),
    "wider bearings are cooler": Advice(
        TEMPERATURE,
        "wider gaps and bearings",
        TIGHT,
        {"machine.journal_bearings.radial_clearance": "20 um"},
        remains=0.2,
    ),
    "slower bearings are cooler": Advice(
        TEMPERATURE, "lower speed", TIGHT, {"operating_point.shaft_speed": "1500 rpm"}, remains=0.2
    ),
    "narrower bearings are laminar": Advice(
        "Taylor number of the journal bearings",
        "narrow the clearance",
        FUEL,
        {"machine.journal_bearings.radial_clearance": "20 um"},
    ),
    "thicker oil is laminar": Advice(
        "Reynolds number of the gaps", "thicker oil", FUEL, {"fluid.name": "iso_vg_46"}
    ),
    "warm oil fills": Advice(
        "Kinematic viscosity of the liquid",
        "Raise fluid.temperature",
        {**FIXED, "fluid.temperature": "-25 degC", "operating_point.shaft_speed": "100 rpm"},
        {"fluid.temperature": "20 degC"},
    ),
    "clearances let the machine hold its pressure": Advice(
        "Volumetric efficiency",
        "clearances",
        LEAKING,
        {"machine.casing.radial_clearance": "35 um", "machine.lateral.side_gap": "4 um"},
        remains=0.01,
    ),
    "speed beats leakage": Advice(
        "Volumetric efficiency",
        "the speed",
        {**FIXED, "operating_point.shaft_speed": "10 rpm"},
        {"operating_point.shaft_speed": "1500 rpm"},
    ),
    "pressure turns the motor": Advice(
        "Overall efficiency",
        "Raise the pressure difference",
        IDLE,
        {"operating_point.inlet_pressure": "200 bar"},
        "egm12_motor",
    ),
    "an elastic mesh does not pull": Advice(
        "Pull of the rigid mesh",
        "run.mesh",
        IDLE,
        {"run.mesh": "elastic"},
        "egm12_motor",
        marks=(SLOW,),
    ),
    "blocks follow their load": Advice(
        "Place of the bearing blocks",
        "machine.bearing_blocks.motion",
        IDLE,
        {"machine.bearing_blocks.motion": "free"},
        "egm12_motor",
        marks=(SLOW,),
    ),
    "a wider casing is not cut": Advice(
        "Cut of the tips, tooth tip drive",
        "machine.casing.radial_clearance",
        {**FIXED, "machine.casing.wear_in": None, "machine.casing.radial_clearance": "10 um"},
        {"machine.casing.radial_clearance": "50 um"},
    ),
    "slower tips fill": Advice(
        "Speed of the tips", "Lower the speed", {**FIXED, **FAST}, {**FIXED, **JET}
    ),
    "inlet pressure fills": Advice(
        "Speed of the tips",
        "raise the inlet pressure",
        {**FIXED, **FAST},
        {"operating_point.inlet_pressure": "6 bar"},
    ),
    "inlet pressure ends cavitation": Advice(
        CAVITATION,
        "raise the inlet pressure",
        {**FIXED, **FAST},
        {"operating_point.inlet_pressure": "6 bar"},
        remains=0.3,
    ),
    "a slower pump drains cooler": Advice(
        "Drain temperature",
        "lower pressure and speed",
        {**FIXED, "operating_point.shaft_speed": "4000 rpm"},
        {"operating_point.shaft_speed": "1000 rpm"},
    ),
    "thicker oil floats": Advice(
        "Film over roughness, bearing of drive gear",
        "thicker oil",
        {**FIXED, **JET},
        {"fluid.name": "iso_vg_46"},
    ),
    "a larger bearing carries": Advice(
        "Bearing of drive gear, p v without a full film",
        "larger bearing",
        {**FIXED, **JET},
        {"machine.journal_bearings.length": "60 mm"},
    ),
    "less pressure on flanks": Advice(
        "Contact pressure, drive flank",
        "Lower the pressure",
        STEEP,
        {"operating_point.outlet_pressure": "200 bar"},
    ),
    "peaks at the mesh": Advice(
        "Highest chamber pressure",
        "relief grooves",
        SEALED,
        {"machine.relief_grooves": GROOVES},
        remains=0.4,
    ),
    "more revolutions": Advice(
        "",
        "run.max_revolutions",
        {**FIXED, "run.max_revolutions": 2},
        {"run.max_revolutions": 60},
        status=Status.NOT_CYCLIC,
    ),
    "more steps": Advice(
        "",
        "run.max_steps",
        {**FIXED, "run.max_steps": 500},
        {"run.max_steps": None},
        status=Status.MAX_STEPS,
    ),
    "a longer start": Advice(
        STANDING,
        "circuit.duration",
        {"circuit.duration": "50 ms", "run.time_samples": 100},
        {"circuit.duration": "7 s"},
        "startup_fan_drive",
        marks=(SLOW,),
    ),
}

ELSEWHERE = {
    Status.STEP_TOO_SMALL: "no machine is known that ends so at pressures that a liquid stands",
    Status.NOT_REPEATING: "unit/solver/test_accuracy: more revolutions tell means",
    Status.NOT_CONVERGED: "verification: films on finer grids and from nearby conditions",
    Status.NOT_STORED: "unit/results: streams on a full disk",
    Status.NOT_REACHED: "unit/run: test_load_orifice and test_asked_and_reached",
    Status.RUNAWAY: "unit/films: films whose viscosity runs away",
    Status.POINTS_FAILED: "unit/studies: studies that are resumed",
    Status.INTERRUPTED: "nothing to follow",
}
"""Statuses whose advice is followed by other tests."""


def number(solution: Solution, quantity: str) -> float | None:
    """Size of the number in the finding on a quantity; None without one."""
    found = [finding.found for finding in solution.findings if finding.quantity == quantity]
    if not found:
        return None
    match = re.search(r"-?[\d.]+(e[+-]?\d+)?", found[0])
    return abs(float(match[0])) if match else 1.0


@pytest.mark.slow
@pytest.mark.parametrize(
    "advice", [pytest.param(x, id=name, marks=x.marks) for name, x in FOLLOWED.items()]
)
def test_advice_that_is_followed_helps(advice: Advice) -> None:
    source = CASES / f"{advice.case}.toml" if isinstance(advice.case, str) else advice.case
    case: Case = api.load_case(source).replace(advice.bad)
    bad = api.simulate(case)
    assert bad.status is advice.status
    told = [finding.advice for finding in bad.findings if finding.quantity == advice.told]
    assert advice.words in (told[0] if advice.told else bad.status.value)
    better = api.simulate(case.replace(advice.better))
    assert better.status is Status.DONE
    if advice.told:
        before, after = number(bad, advice.told), number(better, advice.told) or 0.0
        assert before is not None
        assert after <= advice.remains * before


def test_every_status_has_its_advice_followed() -> None:
    followed = {advice.status for advice in FOLLOWED.values()} | {Status.DONE}
    assert followed | set(ELSEWHERE) == set(Status)
