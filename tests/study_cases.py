"""Cases and stand-ins for tests of studies: a machine that answers at once."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from toothspace.case import Case
from toothspace.core.status import Status

REPOSITORY = Path(__file__).resolve().parents[1]


def case_with_study(study: str, name: str = "egm12_motor") -> Case:
    """A case of the repository with a table ``[study]``."""
    text = (REPOSITORY / "cases" / f"{name}.toml").read_text(encoding="utf-8")
    return Case.from_toml(f"{text}\n[study]\n{study}", REPOSITORY / "cases", name)


def answer(case: Case) -> dict[str, Any]:
    """Summary numbers as simple functions of clearance (um), speed and temperature."""
    clearance = case.machine.casing.radial_clearance * 1e6
    point = case.operating_point
    assert point is not None
    assert case.fluid is not None
    return {
        "volumetric_efficiency": 1.0 - 1e-4 * clearance**2,
        "hydromechanical_efficiency": 0.9,
        "overall_efficiency": 0.9 - 1e-4 * clearance**2,
        "mean_flow_L_per_min": point.shaft_speed * 0.05 + 0.01 * clearance,
        "mean_torque_N_m": (point.inlet_pressure - point.outlet_pressure) * 1e-6,
        "outlet_temperature_degC": case.fluid.temperature - 273.15,
        "status": "done",
        "wall_time_s": 0.0,
    }


class Answer:
    """Stand-in of a solution that has nothing to tell."""

    status = Status.DONE
    warnings = ()

    def __init__(self, numbers: Mapping[str, Any]) -> None:
        self.numbers = numbers

    def summary(self) -> Mapping[str, Any]:
        return self.numbers
