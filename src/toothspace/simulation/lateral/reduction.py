"""Lateral films of a machine over the axial load on its bearing, for tables."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.progress import UNKNOWN, Progress, tell
from toothspace.core.status import Status
from toothspace.core.types import Array, BoolArray
from toothspace.films.lateral.stops import leaning
from toothspace.model.description import MachineDescription
from toothspace.model.films import lateral_torque_coefficient
from toothspace.model.lateral_balance import AxialForce, FloatingBearing, LateralBalance
from toothspace.model.lateral_load import axial_load
from toothspace.model.path_category import LATERAL_PATHS
from toothspace.simulation.lateral.coupling import (
    CoupledPoint,
    LumpedRun,
    PointRequest,
    couple_point,
    path_leakage,
)
from toothspace.simulation.lateral.problem import (
    LateralSettings,
    balance_of,
    lateral_problem,
    numbers_of,
)
from toothspace.simulation.lateral.torque import pressure_torque

_CLOSING = (0.28, 0.2, 0.14, 0.1, 0.07, 0.045, 0.03, 0.02, 0.01, 0.005)
"""Closing forces that are added, over the force of the high-pressure area. [-]"""
_OPENING = (0.005, 0.01, 0.02)
"""Opening forces that are added, over the force of the high-pressure area. [-]"""
_TILTING = (-0.006, -0.003, 0.0, 0.003, 0.006)
"""Moments that are added, over the force of the high-pressure area times the tip radius. [-]"""
_START_GAP = 5e-6
"""Gap that the search begins with. [m]"""


@final
@dataclass(frozen=True, eq=False)
class LateralReduction:
    """Films beside the gears over force and moment on the bearing.

    Parameters
    ----------
    force, moment : ndarray
        Unbalanced force [N] and moment [N m], see :func:`axial_load`.
    load : tuple of float
        Force [N] and moment [N m] at the condition, where nothing is added.
    closed_torque : float
        Torque of the closed form at the condition. [N m]
    torque : ndarray, shape (n, m)
        Torque of all films at the shaft, asperities included. [N m]
    extra_torque : ndarray, shape (n, m)
        Torque less that of the closed form. [N m]
    pressure_torque : ndarray, shape (n, m)
        Part of the torque that does not depend on viscosity and speed. [N m]
    leakage_factor : ndarray, shape (n, m)
        Leakage over that of the closed form. [-]
    smallest_gap : ndarray, shape (n, m)
        Smallest gap. [m]
    converged : ndarray of bool, shape (n, m)
        Whether the bearing is in equilibrium.
    """

    force: Array
    moment: Array
    load: tuple[float, float]
    closed_torque: float
    torque: Array
    extra_torque: Array
    pressure_torque: Array
    leakage_factor: Array
    smallest_gap: Array
    converged: BoolArray


def reduce_lateral(
    description: MachineDescription,
    fluid: FluidLaw,
    run: LumpedRun,
    settings: LateralSettings,
    progress: Progress | None = None,
) -> LateralReduction:
    """Solve the films in equilibrium at the pressures of a condition, with added loads.

    Parameters
    ----------
    description : MachineDescription
        Machine with a floating bearing.
    run : callable
        Lumped solution of a changed machine at the condition.
    progress : callable, optional
        Told how many columns of the table are done.

    Raises
    ------
    CaseError
        If the machine has no floating bearing.

    Notes
    -----
    Chambers and films are brought to agreement first, so that the table holds what the coupled
    run finds at the condition. Without friction in the housing, and with a split bearing in one
    piece. Bearings and gears that may not tilt (``motion = "axial"``) do not feel the moment: the
    table has the one of the condition. Opening forces that lift the bearing off its films for any
    moment are left out.
    """
    balance = balance_of(description)
    free = replace(description, lateral_balance=_loaded(balance, 0.0, 0.0), lateral_table=None)
    tell(progress, UNKNOWN, "films and chambers at the condition")
    point = couple_point(free, fluid, run, PointRequest(settings=settings, start=_START_GAP))
    back = point.problem.loads.back
    load = axial_load(balance, point.problem.node_pressure)
    scale = balance.floating.high_pressure.area * (back.high - back.low)
    added = scale * np.concatenate([-np.array(_CLOSING), [0.0], _OPENING])
    reach = balance.interfaces[0].face.outer_radius
    tilts = np.array(_TILTING) if balance.motion == "full" else np.zeros(1)
    turned = tilts * scale * reach
    table = np.full((5, added.size, turned.size), np.nan)
    for j, moment in enumerate(turned):
        tell(progress, j / turned.size, f"moment {j + 1} of {turned.size}")
        table[:, :, j] = _column(point, fluid, added, float(moment))
    found = (table[3] > 0.0) & (point.status is Status.DONE)
    kept = found.all(axis=1) | (added <= 0.0)
    torque = lateral_torque_coefficient(description) * fluid.dynamic_viscosity
    torque *= point.problem.stack.shaft_speed
    # closed forms leak with the cube of the height
    wide, plain = (
        next(p for p in machine.paths if p.category in LATERAL_PATHS).geometry.values[:, 0].max()
        for machine in (point.description, description)
    )
    leakage = path_leakage(point.solution) / float(wide / plain) ** 3
    return LateralReduction(
        force=load[0] + added[kept],
        moment=load[1] + turned,
        load=load,
        closed_torque=torque,
        torque=table[0][kept],
        extra_torque=table[0][kept] - torque,
        pressure_torque=table[4][kept],
        leakage_factor=table[1][kept] / leakage,
        smallest_gap=table[2][kept],
        converged=found[kept],
    )


def _column(point: CoupledPoint, fluid: FluidLaw, added: Array, moment: float) -> Array:
    """Numbers over the forces that are added.

    Torque, leakage, smallest gap, whether it is in equilibrium, and torque that pressure causes.
    """
    found = np.full((5, added.size), np.nan)
    middle = int(np.argmin(np.abs(added)))
    for way in (range(middle, -1, -1), range(middle + 1, added.size)):
        now = point.equilibrium.balance
        for k in way:
            moved = _loaded(balance_of(point.description), float(added[k]), moment)
            machine = replace(point.description, lateral_balance=moved)
            problem = lateral_problem(machine, fluid, point.solution.data, point.problem.settings)
            rest = problem.settle(problem.continued(now.position))
            numbers = numbers_of(problem, rest.balance)
            held = rest.settled and not leaning(problem.stack, rest.balance.position)
            torque = numbers.viscous_torque + numbers.asperity_torque
            still = pressure_torque(rest.balance)
            found[:, k] = torque, numbers.leakage, numbers.smallest_gap, held, still
            now = rest.balance if held else now
    return found


def _loaded(balance: LateralBalance, force: float, moment: float) -> LateralBalance:
    """Bearing with a force away from the gears and a moment more, without friction."""
    bearing = balance.floating
    push, about_x, about_y = bearing.preload.moments
    about_x -= moment + force * bearing.face.center[1]
    # the force stands where high pressure presses, so that it does not tilt about y
    about_y += force * bearing.high_pressure.center[0]
    push -= force
    preload = AxialForce(push, (-about_y / push, about_x / push))
    housing = replace(bearing.housing, friction_coefficient=0.0)
    moved: FloatingBearing = replace(bearing, preload=preload, housing=housing)
    return replace(balance, floating=moved, halves=())
