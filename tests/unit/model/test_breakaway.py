"""Breakaway torque that follows from the boundary friction of the interfaces."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from toothspace import api
from toothspace.case import load_case
from toothspace.core.errors import CaseError
from toothspace.model import arrays as col
from toothspace.model.assembly import System, assemble
from toothspace.solver.compiled_model import hold_shaft
from toothspace.solver.initial import start_state

FAN_DRIVE = Path(__file__).resolve().parents[3] / "cases" / "startup_fan_drive.toml"
INTERFACES = {
    "machine.startup.breakaway": "interfaces",
    "machine.startup.breakaway_torque": None,
}
LEVEL, RADIUS, SEAL = 0.04486 + 0.0006507, 9e-3, 0.15
"""Eq 2.7 at rest, radius of the journals and torque of the seal. [-], [m], [N m]"""


def _held(pressure: float) -> tuple[System, float]:
    """Machine that stands still with a pressure at its inlet, and what holds it. [Pa], [N m]."""
    case = load_case(FAN_DRIVE).replace(
        {**INTERFACES, "circuit.initial_pressure": f"{pressure / 1e5} bar"}
    )
    run = api.prepare(case)
    system = assemble(run.machine, run.fluid, run.condition)
    hold_shaft(system.arrays, start_state(system), 0.0)
    return system, float(system.arrays.drive[col.HOLDING_TORQUE])


def test_journals_teeth_and_seal_hold_the_shaft_at_their_boundary_levels() -> None:
    system, held = _held(50e5)
    journal = system.arrays.journal
    force = np.hypot(journal[:, col.FILM_X], journal[:, col.FILM_Y])
    gears = np.abs(journal[:, col.SPEED_RATIO]) > 0.0
    journals = LEVEL * RADIUS * float(force[gears].sum())
    teeth = held - journals - SEAL
    assert held > SEAL + journals
    assert 0.0 <= teeth < 0.1 * held + 0.05


def test_given_torque_and_interfaces_exclude_each_other() -> None:
    case = load_case(FAN_DRIVE)
    with pytest.raises(CaseError, match="breakaway_torque"):
        case.replace({"machine.startup.breakaway": "interfaces"})
    with pytest.raises(CaseError, match="breakaway_torque"):
        case.replace({"machine.startup.breakaway_torque": None})


def test_torque_of_the_interfaces_does_not_depend_on_what_is_tried() -> None:
    _, first = _held(20e5)
    _, again = _held(20e5)
    assert math.isclose(first, again, rel_tol=1e-12)
