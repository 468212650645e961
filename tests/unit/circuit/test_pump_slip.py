"""Laminar slip of a supply pump from one point of its catalogue."""

from __future__ import annotations

import math
from typing import Any

import pytest

from toothspace.circuit.pumps import EfficiencyLine, PumpMap, RatedPoint
from toothspace.core.errors import CaseError

RPM = 2.0 * math.pi / 60.0
RATED = RatedPoint(
    shaft_speed=1500.0 * RPM,
    pressure_difference=200e5,
    volumetric_efficiency=0.95,
    dynamic_viscosity=0.026,
)


def _pump(**more: Any) -> PumpMap:
    return PumpMap(displacement=4.95e-6 / (2.0 * math.pi), speed=((0.0, 1.0), (1.0, 1.0)), **more)


def _rated_efficiency(pump: PumpMap) -> float:
    line = pump.volumetric_efficiency
    return line.offset + 2.0 * line.per_100_bar - pump.slip * 200e5 / (0.026 * 1500.0 * RPM)


@pytest.mark.parametrize("line", [EfficiencyLine(offset=1.0), EfficiencyLine(offset=0.97)])
def test_pump_has_the_rated_efficiency_at_the_rated_point(line: EfficiencyLine) -> None:
    pump = _pump(rated_point=RATED, volumetric_efficiency=line)
    assert _rated_efficiency(pump) == pytest.approx(0.95)


def test_pump_that_loses_five_percent_has_a_coefficient_of_1e_8() -> None:
    assert _pump(rated_point=RATED).slip == pytest.approx(1.02e-8, rel=0.01)


def test_slip_is_given_once() -> None:
    assert _pump(slip_coefficient=2e-8).slip == 2e-8
    with pytest.raises(CaseError, match="rated_point"):
        _pump(slip_coefficient=2e-8, rated_point=RATED)


def test_line_may_not_lose_more_than_the_rated_point() -> None:
    with pytest.raises(CaseError, match="leaves"):
        _pump(rated_point=RATED, volumetric_efficiency=EfficiencyLine(offset=0.9))
