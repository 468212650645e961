"""Lateral films of a machine over the axial load on its bearing, for tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.progress import Progress, tell
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.floating.coupling import (
    CoupledPoint,
    LumpedRun,
    PointRequest,
    couple_point,
    path_leakage,
)
from toothspace.floating.motion import Balance
from toothspace.floating.problem import (
    LateralSettings,
    balance_of,
    lateral_problem,
    numbers_of,
)
from toothspace.floating.stack import Stack, leaning, stop_forces
from toothspace.floating.torque import pressure_torque
from toothspace.model.description import MachineDescription
from toothspace.model.floating_bearing import AxialForce, FloatingBearing, LateralBalance
from toothspace.model.lateral_load import axial_load
from toothspace.model.lumped_films import lateral_torque_coefficient
from toothspace.model.path_category import LATERAL_PATHS

_CLOSING = (0.28, 0.2, 0.14, 0.1, 0.07, 0.045, 0.03, 0.02, 0.01, 0.005)
"""Closing forces that are added, over the force of the high-pressure area. [-]"""
_OPENING = (0.005, 0.01, 0.02)
"""Opening forces that are added, over the force of the high-pressure area. [-]"""
_TILTING = (0.003, 0.006)
"""Moments that are added both ways, over that force times the tip radius. [-]"""
_FORCE_STEP, _MOMENT_STEP = 0.01, 0.003
"""Longest steps between the loads of different conditions. [-]"""
COLUMNS: Mapping[str, tuple[str, str]] = {
    "torque": ("N m", "Torque of the lateral films at the shaft"),
    "pressure_torque": ("N m", "Part of the torque that viscosity and speed do not change"),
    "asperity_torque": ("N m", "Part of that by asperities"),
    "leakage_factor": ("1", "Leakage over that of the closed form"),
    "lag": ("s", "Time in which the gap follows the load"),
    "smallest_gap": ("m", "Smallest gap"),
    "converged": ("1", "Whether the bearing is in equilibrium"),
    "lifted": ("1", "Whether the force lifts it off: all else is that of the largest before"),
}
"""What is solved for: unit and meaning."""
_START_GAP = 5e-6
"""Gap that the search begins with. [m]"""


@final
@dataclass(frozen=True, eq=False)
class LoadedCondition:
    """Chambers and films that agree at a condition, and the load on the bearing."""

    point: CoupledPoint
    """Chambers and films."""
    load: tuple[float, float]
    """Force [N] and moment [N m] on the bearing."""
    force_unit: float
    """Pressure difference on the high-pressure area, the force of share one. [N]"""
    reach: float
    """Tip radius, the arm of moment share one. [m]"""

    @property
    def shares(self) -> tuple[float, float]:
        """Force and moment over those of share one. [-]."""
        return self.load[0] / self.force_unit, self.load[1] / (self.force_unit * self.reach)


@final
@dataclass(frozen=True, eq=False)
class LateralReduction:
    """Films beside the faces over force and moment on the bearing at one condition."""

    condition: LoadedCondition
    """The condition, where nothing is added to the load."""
    closed_torque: float
    """Torque of the closed form there. [N m]"""
    columns: Mapping[str, Array]
    """One value for each force and moment, see :data:`COLUMNS`; the lag is damping over stiffness
    of the films where a force lifts the bearing.
    """


def loaded_condition(
    description: MachineDescription, fluid: FluidLaw, run: LumpedRun, settings: LateralSettings
) -> LoadedCondition:
    """Bring chambers and films to agreement, so that tables hold what the coupled run finds.

    Raises CaseError if the machine has no floating bearing.

    Parameters
    ----------
    description : MachineDescription
        Machine with a floating bearing, here without friction in the housing and, if it is split,
        in one piece.
    run : callable
        Lumped solution of a changed machine at the condition.
    """
    balance = balance_of(description)
    free = replace(description, lateral_table=None).with_balance(_loaded(balance, 0.0, 0.0))
    point = couple_point(free, fluid, run, PointRequest(settings=settings, start=_START_GAP))
    back = point.problem.loads.back
    return LoadedCondition(
        point,
        axial_load(balance, point.problem.node_pressure),
        balance.floating.high_pressure.area * (back.high - back.low),
        balance.interfaces[0].face.outer_radius,
    )


def load_shares(conditions: Sequence[LoadedCondition]) -> tuple[Array, Array]:
    """Forces and moments to solve at, as shares: those of all conditions, and beyond them. [-].

    Bearings and gears that may not tilt (``motion = "axial"``) do not feel the moment: one is
    enough.
    """
    forces, moments = zip(*(condition.shares for condition in conditions), strict=True)
    force = np.concatenate(
        [
            min(forces) - np.array(_CLOSING),
            _steps_between(min(forces), max(forces), _FORCE_STEP),
            max(forces) + np.array(_OPENING),
        ]
    )
    if balance_of(conditions[0].point.description).motion != "full":
        return force, np.array(moments[:1])
    tilting, between = np.array(_TILTING), _steps_between(min(moments), max(moments), _MOMENT_STEP)
    return force, np.concatenate([min(moments) - tilting[::-1], between, max(moments) + tilting])


def _steps_between(low: float, high: float, longest: float) -> Array:
    return np.linspace(low, high, 1 + int(np.ceil((high - low) / longest)))


def reduce_lateral(
    condition: LoadedCondition,
    description: MachineDescription,
    fluid: FluidLaw,
    shares: tuple[Array, Array],
    progress: Progress | None = None,
) -> LateralReduction:
    """Solve the films in equilibrium at the pressures of a condition, under other loads.

    Parameters
    ----------
    condition : LoadedCondition
        Chambers and films in agreement.
    description : MachineDescription
        Machine with the gaps of the closed form.
    shares : tuple of ndarray
        Forces and moments to solve at, as shares. [-]
    progress : callable, optional
        Called with the finished share and a short text.

    Notes
    -----
    A force step moves the lift q of bearing and gears by :math:`x = K^{-1} l`, K the stiffness of
    films and stops and l the lever of the lift; the lag is :math:`x^T D x / l^T x` with the
    films' damping D, for one motion D/K.
    """
    point, unit, here = condition.point, condition.force_unit, condition.shares
    added, turned = unit * (shares[0] - here[0]), unit * condition.reach * (shares[1] - here[1])
    tilting = balance_of(point.description).motion == "full"
    table = np.full((len(COLUMNS), added.size, turned.size), np.nan)
    for j, moment in enumerate(turned if tilting else np.zeros(1)):
        tell(progress, j / turned.size, f"moment {j + 1} of {turned.size}")
        table[:, :, j] = _column(point, fluid, added, float(moment))
    # closed forms leak with the cube of the height
    wide, plain = (
        next(p for p in machine.paths if p.category in LATERAL_PATHS).geometry.values[:, 0].max()
        for machine in (point.description, description)
    )
    found = dict(zip(COLUMNS, table, strict=True))
    found["leakage_factor"] *= float(wide / plain) ** 3 / path_leakage(point.solution)
    found["converged"] = (found["converged"] > 0.0) & (point.status is Status.DONE)
    found["lifted"] = found["lifted"] > 0.0
    closed = lateral_torque_coefficient(description) * fluid.dynamic_viscosity
    return LateralReduction(condition, closed * point.problem.stack.shaft_speed, found)


def _column(point: CoupledPoint, fluid: FluidLaw, added: Array, moment: float) -> Array:
    """Numbers over the forces that are added, one row for each of the columns."""
    found = np.full((len(COLUMNS), added.size), np.nan)
    middle = int(np.argmin(np.abs(added)))
    for way in (range(middle, -1, -1), range(middle + 1, added.size)):
        now = point.equilibrium
        for k in way:
            moved = _loaded(balance_of(point.description), float(added[k]), moment)
            machine = point.description.with_balance(moved)
            problem = lateral_problem(machine, fluid, point.solution.data, point.problem.settings)
            rest = problem.settle(problem.continued(now.balance.position), now)
            numbers = numbers_of(problem, rest.balance)
            held = rest.settled and not leaning(problem.stack, rest.balance.position)
            found[:, k] = (
                numbers.viscous_torque + numbers.asperity_torque,
                pressure_torque(rest.balance),
                numbers.asperity_torque,
                numbers.leakage,
                squeeze_lag(problem.stack, rest.balance) if held else np.nan,
                numbers.smallest_gap,
                held,
                0.0,
            )
            if k > middle and not held:
                found[:, k] = found[:, k - 1]
                found[-1, k] = 1.0
            now = rest if held else now
    return found


def squeeze_lag(stack: Stack, balance: Balance) -> float:
    """Time in which bearing and bodies follow a force on the bearing by squeezing films. [s].

    The first moment of their step response, see :func:`reduce_lateral`.
    """
    assert balance.jacobian is not None
    free = stack.free
    lever = (stack.opening / stack.arms)[free]
    scale = np.outer(stack.arms, stack.arms)
    stiffness = balance.jacobian[0] + stop_forces(stack, balance.position)[1]
    stiffness, damping = ((m / scale)[np.ix_(free, free)] for m in (stiffness, balance.jacobian[1]))
    moved = np.linalg.lstsq(stiffness, lever, rcond=None)[0]
    return float(moved @ damping @ moved / (lever @ moved))


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
