"""Runs of chambers that a wide gap drains, and rests of the bearing, in turn until both agree."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import xarray as xr

from tests.lateral_stack import HIGH, loads, pressures, ring_stack
from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.status import Status
from toothspace.floating.coupling import PointRequest, couple_point
from toothspace.floating.equilibrium import snapshots_over_pitch
from toothspace.floating.problem import LateralProblem, LateralSettings

SPEED, FLOW = 100.0, 4e-4
LEAKAGE = 4e-7
"""Leakage of the paths as they are. [m3/s]"""
MODULE = "toothspace.floating.coupling"


def _problem(factor: float, coulomb: float) -> LateralProblem:
    """Spaces round the ring keep 75 bar until the paths leak some thirty times as much."""
    rim = 30e5 + 45e5 / (1.0 + factor / 30.0)
    stack = ring_stack(high_share=0.45, approach=5e-13, cells=(12, 6), speed=SPEED)
    snapshots = snapshots_over_pitch(stack, lambda _: pressures(rim), 1)
    return LateralProblem(
        stack, snapshots, loads(HIGH, coulomb), lambda _: pressures(rim), LateralSettings(angles=1)
    )


@dataclass(frozen=True)
class _Machine:
    displacement: float = FLOW / SPEED
    lateral_table: None = None


class _Chambers:
    """Stands for lumped runs, whose machine is the factor by which the paths leak more."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, coulomb: float = 0.0) -> None:
        self.factors: list[float] = []
        self.machine = cast(Any, _Machine())
        self.torque = 0.0
        stand_ins: dict[str, Any] = {
            "with_lateral_leakage": self._log_leakage_factor,
            "lateral_problem": lambda *args: _problem(self.factors[-1], coulomb),
            "with_film_torque": self._dragged,
            "lumped_torque": lambda data: self.torque,
        }
        for name, stand_in in stand_ins.items():
            monkeypatch.setattr(f"{MODULE}.{name}", stand_in)

    def _log_leakage_factor(self, machine: Any, factor: float) -> Any:
        self.factors.append(factor)
        return machine

    def _dragged(self, machine: Any, viscosity: float, data: Any, balance: Any) -> Any:
        lost = [film.losses for film in balance.states[0].films]
        self.torque = sum(x.shear + x.asperity for x in lost) / SPEED
        return machine

    def __call__(self, machine: Any) -> Any:
        factor = self.factors[-1]
        paths = np.array([[LEAKAGE * factor / (1.0 + factor / 300.0), 0.0]])
        data = xr.Dataset(
            {"equivalent_leakage": (("sample", "path"), paths)},
            coords={"path": ["lateral", "drain"]},
        )
        return SimpleNamespace(data=data, status=Status.DONE)


def _fluid() -> FluidLaw:
    return cast(Any, SimpleNamespace(dynamic_viscosity=1e-3))


def _request(gap: float) -> PointRequest:
    return PointRequest(settings=LateralSettings(angles=1), start=gap)


@pytest.mark.slow
def test_bearing_that_jumps_between_single_runs_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    chambers = _Chambers(monkeypatch)
    point = couple_point(chambers.machine, _fluid(), chambers, _request(5e-6))
    assert point.status is Status.DONE
    assert 3 < len(chambers.factors) < 9
    assert abs(point.leakage_mismatch) * FLOW < 0.02 * point.numbers.leakage
    assert point.problem.stack.holding_spring is not None
    assert point.equilibrium.balance.residual < 5e-6


def test_bearing_that_friction_holds_stays_where_it_began(monkeypatch: pytest.MonkeyPatch) -> None:
    chambers = _Chambers(monkeypatch, coulomb=4e3)
    point = couple_point(chambers.machine, _fluid(), chambers, _request(5e-6))
    assert point.status is Status.DONE
    assert point.numbers.position == pytest.approx(10e-6)
    assert abs(point.leakage_mismatch) * FLOW < 0.02 * point.numbers.leakage
