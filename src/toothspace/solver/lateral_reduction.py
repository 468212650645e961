"""Lateral films of a machine over the axial load on its bearing, for tables."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, final

import numpy as np

from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.types import Array, BoolArray
from toothspace.films.lateral_gap.motion import Balance
from toothspace.model.description import MachineDescription
from toothspace.model.films import lateral_torque_coefficient
from toothspace.model.lateral_balance import FloatingBearing, LateralBalance
from toothspace.model.lateral_table import axial_load, chamber_pressures, closed_form_leakage
from toothspace.model.operating_point import OperatingCondition
from toothspace.solver.lateral_gap import (
    LateralSettings,
    balance_of,
    lateral_problem,
    numbers_of,
)

if TYPE_CHECKING:
    import xarray as xr

CLOSING = (0.30, 0.25, 0.20, 0.17, 0.145, 0.13)
"""Forces towards the gears over the force of the high-pressure area. [-]"""
TILTING = (-0.006, -0.003, 0.0, 0.003, 0.006)
"""Moments over the force of the high-pressure area times the tip radius. [-]"""
_SAMPLES = 180


@final
@dataclass(frozen=True, eq=False)
class LateralReduction:
    """Films beside the gears over force and moment on the bearing.

    Parameters
    ----------
    force, moment : ndarray
        Unbalanced force [N] and moment [N m], see :func:`axial_load`.
    torque : ndarray, shape (n, m)
        Torque of all films at the shaft, asperities included. [N m]
    extra_torque : ndarray, shape (n, m)
        Torque less that of the closed form. [N m]
    leakage_factor : ndarray, shape (n, m)
        Leakage over that of the closed form. [-]
    smallest_gap : ndarray, shape (n, m)
        Smallest gap. [m]
    converged : ndarray of bool, shape (n, m)
        Whether the bearing came to rest.
    """

    force: Array
    moment: Array
    torque: Array
    extra_torque: Array
    leakage_factor: Array
    smallest_gap: Array
    converged: BoolArray


def reduce_lateral(
    description: MachineDescription,
    fluid: FluidLaw,
    condition: OperatingCondition,
    settings: LateralSettings,
    loads: tuple[Sequence[float], Sequence[float]] = (CLOSING, TILTING),
    progress: Callable[[float], None] | None = None,
) -> LateralReduction:
    """Solve the films at rest under forces and moments that are added to the bearing.

    Parameters
    ----------
    description : MachineDescription
        Machine with a pressed bearing.
    fluid : FluidLaw
        Fluid.
    condition : OperatingCondition
        Speed and pressures.
    settings : LateralSettings
        Grids and laws.
    loads : tuple of sequences
        Closing forces and moments, over the force of the high-pressure area. [-]
    progress : callable, optional
        Called with the finished share.

    Raises
    ------
    CaseError
        If the machine has no pressed bearing.

    Notes
    -----
    Without friction in the housing, and with a split bearing in one piece. Bearings and gears that
    may not tilt (``motion = "axial"``) do not feel the moment: the table has the one of the
    condition. Every column of one moment begins with the largest force, each point with the
    positions of the one before.
    """
    balance = balance_of(description)
    data = _quasi_static_data(description, condition)
    base = axial_load(balance, chamber_pressures(description, condition))
    span = abs(condition.outlet_pressure - condition.inlet_pressure)
    scale = balance.floating.high_pressure.area * span
    reach = balance.interfaces[0].outer_radius
    force = -np.sort(loads[0])[::-1] * scale
    tilts = balance.motion == "full"
    moment = np.sort(loads[1]) * scale * reach if tilts else np.array([base[1]])
    shape = (force.size, moment.size)
    table = np.full((4, *shape), np.nan)
    for j, m in enumerate(moment):
        now: Balance | None = None
        for i, f in enumerate(force):
            moved = _loaded(balance, float(f) - base[0], float(m) - base[1])
            machine = replace(description, lateral_balance=moved)
            problem = lateral_problem(machine, fluid, data, settings)
            start = problem.started(_START_GAP) if now is None else problem.continued(now.position)
            found = problem.settle(start)
            numbers = numbers_of(problem, found.balance)
            now = found.balance if found.rests else None
            torque = numbers.viscous_torque + numbers.asperity_torque
            table[:, i, j] = torque, numbers.leakage, numbers.smallest_gap, found.rests
            if progress:
                progress((j * shape[0] + i + 1) / table[0].size)
    viscosity = fluid.dynamic_viscosity
    plain = lateral_torque_coefficient(description) * viscosity * condition.shaft_speed
    leakage = closed_form_leakage(description, condition, viscosity)
    return LateralReduction(
        force=force,
        moment=moment,
        torque=table[0],
        extra_torque=table[0] - plain,
        leakage_factor=table[1] / leakage,
        smallest_gap=table[2],
        converged=table[3] > 0.0,
    )


_START_GAP = 3e-6
"""Gap that every column of a table begins with. [m]"""


def _loaded(balance: LateralBalance, force: float, moment: float) -> LateralBalance:
    """Bearing with a force away from the gears and a moment more, without friction."""
    bearing = balance.floating
    x, y = bearing.preload_center
    preload = bearing.preload - force
    about_x = bearing.preload * y - moment - force * bearing.face.center[1]
    # the force stands where high pressure presses, so that it does not tilt about y
    about_y = bearing.preload * x - force * bearing.high_pressure.center[0]
    center = (about_y / preload, about_x / preload)
    housing = replace(bearing.housing, friction_coefficient=0.0)
    moved: FloatingBearing = replace(
        bearing, preload=preload, preload_center=center, housing=housing
    )
    return replace(balance, floating=moved, halves=())


def _quasi_static_data(
    description: MachineDescription, condition: OperatingCondition
) -> xr.Dataset:
    """Chamber and port pressures over a revolution, as a lumped solution holds them."""
    import xarray as xr

    angle = 2.0 * np.pi * np.arange(_SAMPLES) / _SAMPLES
    pressures = chamber_pressures(description, condition)
    chambers = np.array([pressures(float(a))[: description.chamber_count] for a in angle])
    return xr.Dataset(
        {
            "shaft_speed": ("shaft_angle", np.full(_SAMPLES, condition.shaft_speed)),
            "chamber_pressure": (("shaft_angle", "chamber"), chambers),
            "inlet_pressure": ("shaft_angle", np.full(_SAMPLES, condition.inlet_pressure)),
            "outlet_pressure": ("shaft_angle", np.full(_SAMPLES, condition.outlet_pressure)),
            "journal_force": (("shaft_angle", "body", "axis"), np.zeros((_SAMPLES, 2, 2))),
        },
        {"shaft_angle": angle},
    )
