"""Lateral films whose viscosity follows the heat that they dissipate."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from toothspace.core.types import Array
from toothspace.floating.equilibrium import Equilibrium
from toothspace.floating.motion import Balance
from toothspace.floating.problem import LateralNumbers, LateralProblem, numbers_of

_AGREEMENT = 0.2
"""Difference of temperatures at which heat and viscosity agree. [K]"""
_MOST_ROUNDS = 20
_RELAXATION = 0.7
"""Part of a change of temperature that one round takes over. [-]"""


@dataclass(frozen=True, eq=False, kw_only=True)
class SettledBearing:
    """Bearing in equilibrium between films."""

    problem: LateralProblem
    """Films and loads, with the viscosity of the films' temperatures."""
    equilibrium: Equilibrium
    """Equilibrium of bearing and gears."""
    numbers: LateralNumbers
    """Mean numbers of the films."""
    temperatures: Array | None = None
    """Mean temperature of every film; None at the temperature of the fluid. [K]"""
    warm: bool = True
    """Whether temperatures agree with the power dissipated, within what the fluid is known for."""
    excess: float = 0.0
    """Force on the holding spring over that behind the bearing: positive if the films push the
    bearing off. [-]
    """

    @property
    def balance(self) -> Balance:
        """Films and positions."""
        return self.equilibrium.balance


def settle_bearing(
    problem: LateralProblem,
    start: Balance,
    begin: Array | None = None,
    known: Equilibrium | None = None,
) -> SettledBearing:
    """Find the equilibrium; films that are to warm up get the viscosity that their heat gives.

    Parameters
    ----------
    problem : LateralProblem
        Films at the temperature of the supply.
    start : Balance
        Where bearings and gears start, in every round.
    begin : ndarray, optional
        Temperatures that the films begin with; default that of the supply. [K]
    known : Equilibrium, optional
        What settled from the same start at nearly the same pressures.

    Notes
    -----
    Every film has one temperature, from its own power and its own flow, means over a tooth pitch.
    Oil that teeth drag from one tooth space to the next counts as flow through the film. The
    temperatures are found round by round; a film whose temperature would lie above the range of the
    fluid data keeps the highest one, and the point counts as not agreed.
    """
    heating = problem.settings.heating
    if heating is None:
        found = problem.settle(start, known)
        numbers = numbers_of(problem, found.balance)
        return SettledBearing(problem=problem, equilibrium=found, numbers=numbers)
    supply = heating.balance.supply_temperature
    now = np.full(len(problem.stack.grids), supply) if begin is None else begin
    for _ in range(_MOST_ROUNDS):
        laws = []
        for law, temperature in zip(problem.stack.laws, now, strict=True):
            ratio = heating.viscosity(float(temperature)) / heating.viscosity(supply)
            thinned = replace(law.fluid, dynamic_viscosity=law.fluid.dynamic_viscosity * ratio)
            laws.append(law._replace(fluid=thinned))
        heated = replace(problem, stack=replace(problem.stack, laws=tuple(laws)))
        found = known = heated.settle(start, known)
        # mean temperature of every film from its dissipated power and its flow. [K]
        own, count = heating.balance, len(found.balance.states)
        power, flow = np.zeros((2, len(found.balance.states[0].films)))
        for state in found.balance.states:
            for k, film in enumerate(state.films):
                lost = film.losses
                power[k] += (lost.dissipation + lost.asperity) / count
                flow[k] += film.plane.exchange.outflow / count
        carried = own.density * own.heat_capacity * flow
        rise = np.divide(
            own.oil_share * power, carried, out=np.full_like(power, np.inf), where=carried > 0.0
        )
        asked = np.asarray(own.supply_temperature + 0.5 * np.where(power > 0.0, rise, 0.0))
        within = np.minimum(asked, heating.balance.highest_temperature)
        agreed = float(np.abs(within - now).max()) <= _AGREEMENT
        if agreed:
            break
        now = now + _RELAXATION * (within - now)
    return SettledBearing(
        problem=heated,
        equilibrium=found,
        numbers=numbers_of(heated, found.balance),
        temperatures=now,
        warm=agreed and bool(np.all(within == asked)),
    )
