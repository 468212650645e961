"""Volumes with soft walls: they hold far more than at rest, at the pressure that they have."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.unit.circuit.test_circuit_ledger import HOSE, PLACES, motor
from toothspace import api
from toothspace.case import Case
from toothspace.closures.density import mixture_density, mixture_pressure
from toothspace.core.errors import CaseError
from toothspace.model import arrays as col
from toothspace.model.chambers import update_volume, wall_volume

SOFTEST = 1e-7  # relative growth per Pa


@pytest.mark.parametrize("pressure", [1e5, 20e5, 119e5, 300e5])
@pytest.mark.parametrize("start", [0.5, 1.5, 50.0])
def test_a_soft_wall_finds_its_volume(pressure: float, start: float) -> None:
    fluid = api.fluid_of(motor(PLACES["inlet"], {"x": {"kind": "orifice", "diameter": "3 mm"}}))
    node = np.zeros(col.NODE_COLUMNS)
    node[col.REST_VOLUME], node[col.WALL_COMPLIANCE] = 1e-5, 1e-5 * SOFTEST
    expected, _ = wall_volume(node, pressure)
    mass = expected * float(mixture_density(pressure, 1e-6, fluid))
    node[col.VOLUME] = start * 1e-5
    update_volume(node, mass, 1e-6, fluid)
    assert node[col.VOLUME] == pytest.approx(expected, rel=1e-9)
    assert mixture_pressure(node[col.VOLUME] / mass, 1e-6, fluid)[0] == pytest.approx(pressure)


def hot(**wall: Any) -> Case:
    """A hose at 110 degC, before the inlet."""
    joints = [["high", "y"], ["y", "x"], ["x", "machine.inlet"], ["machine.outlet", "low"]]
    hose = {"kind": "hose", "length": HOSE["length"], "bore": HOSE["bore"], **wall}
    return motor(joints, {"x": hose}).replace({"fluid.temperature": "110 degC"})


def test_a_line_without_a_wall_is_rigid() -> None:
    solution = api.simulate(hot())
    assert solution.status.name == "DONE"


def test_a_line_stiffer_than_its_liquid_is_refused_by_name() -> None:
    case = hot(effective_bulk_modulus="4 GPa")
    with pytest.raises(CaseError, match=r"circuit\.x\.effective_bulk_modulus: found 4 GPa.*rigid"):
        api.simulate(case)


def test_half_a_wall_is_refused() -> None:
    with pytest.raises(CaseError, match=r"wall_thickness: found nothing"):
        hot(wall_modulus="1 GPa")
    with pytest.raises(CaseError, match=r"wall_stiffening: found 2.*rigid"):
        hot(wall_stiffening=2.0)
