"""Equilibrium of the floating bearing at chamber pressures between those of two lumped runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.core.types import Array
from toothspace.floating.heat import SettledBearing
from toothspace.floating.housing_friction import HousingFriction
from toothspace.floating.motion import Balance, Loads, balance_force
from toothspace.floating.problem import LateralProblem, numbers_of
from toothspace.floating.stack import HoldingSpring, MovingBearing, Snapshot

_LEAKAGE, _MOST_PLACES = 3e-3, 8
"""Difference of the logarithm of two leakages that agree, and most steps to it. [-]"""
_FORCE, _LEFT_FORCE = 1e-6, 1e-4
"""Force left over that behind the bearing: on films alone, and where chambers respond too. [-]"""
_MOST_SHARES = 16
_APART = 3e-3
"""Difference of the logarithm of two leakages that gives a stiffness. [-]"""
_LEFT = "films and chambers leave {:.3g} N on the bearing"
_LEAST_STEP = 0.5
"""Smallest part to which one change of the holding spring may take a gap. [-]"""


@final
@dataclass(frozen=True, eq=False)
class Trial:
    """A lumped run whose lateral paths leak by a factor more."""

    log_leakage_factor: float
    """Logarithm of the factor. [-]"""
    leakage: float
    """Leakage of the lateral paths. [m3/s]"""
    problem: LateralProblem
    """Films at its pressures."""
    position: Array
    """Where bearings and gears were found. [m, rad]"""
    excess: float
    """Positive if the bearing lifts further than the leakage of the paths fits."""
    sense: int
    """Sense in which the bearing has moved: 1 away from the gears."""
    held: SettledBearing | None = None
    """Bearing held at the opening that leaks as the paths do, once it is known."""


Settle = Callable[[LateralProblem, Balance, Array | None], SettledBearing]
"""Equilibrium of a problem from a state and temperatures of its films, if they are known. [K]"""


@final
class InterpolatedEquilibrium:
    """Bearing held at pressures between two trials, linear in the logarithm of their leakage.

    A wider gap drains the chambers that lift the bearing. At given pressures the films have next
    to no stiffness, so a little less leakage sends the bearing to its cover. A spring therefore
    holds it where films and paths leak alike, and the pressures are sought that leave no force
    on it.

    Parameters
    ----------
    low : Trial
        Films push the bearing further than its paths leak.
    high : Trial
        The bearing stays nearer than its paths leak.
    settle : callable
        Equilibrium of a problem from a state.
    stiffness : float
        Response of the chambers to a wider opening that is known from trials further apart. [N/m]
    """

    def __init__(self, low: Trial, high: Trial, settle: Settle, stiffness: float = 0.0) -> None:
        self._ends, self._settle, self._known_stiffness = (low, high), settle, stiffness
        self._temperatures: Array | None = None
        self._scale = balance_force(low.problem.stack, low.problem.loads.back)
        senses = {low.sense, high.sense} - {0}
        self._sense = senses.pop() if len(senses) == 1 else 0

    def at(self, share: float, position: Array) -> SettledBearing:
        """Bearing at the opening that leaks as the paths do, from a position. [m, rad].

        Parameters
        ----------
        share : float
            Part of the way from the first trial to the second. [-]
        position : ndarray
            Where the search starts.
        """
        low, high = self._ends
        wanted = (1.0 - share) * np.log(low.leakage) + share * np.log(high.leakage)
        # films at pressures between the trials
        first, second = (end.problem for end in self._ends)

        def between(a: Array, b: Array) -> Array:
            return np.asarray((1.0 - share) * a + share * b)

        snapshots: tuple[Snapshot, ...] = tuple(
            s._replace(node_pressure=between(s.node_pressure, t.node_pressure))
            for s, t in zip(first.snapshots, second.snapshots, strict=True)
        )
        problem = replace(
            (first, second)[round(share)],
            snapshots=snapshots,
            node_pressure=lambda angle: between(
                first.node_pressure(angle), second.node_pressure(angle)
            ),
        )
        place = float(problem.stack.opening @ position)
        known: tuple[float, float] | None = None
        for _ in range(_MOST_PLACES):
            guided = problem.held_at(place)
            spring = guided.stack.holding_spring
            assert spring is not None
            found = self._settle(guided, guided.continued(position), self._temperatures)
            self._temperatures = found.temperatures
            opened = float(guided.stack.opening @ found.balance.position)
            pull = spring.stiffness * (place - opened)
            excess = (-self._sense * self._friction - pull) / self._scale
            held = replace(found, excess=excess)
            error = float(np.log(max(held.numbers.leakage, 1e-30)) - wanted)
            if abs(error) <= _LEAKAGE or not held.equilibrium.settled:
                break
            position = held.balance.position
            step = _step(_room(held), (place, error), known)
            known, place = (place, error), place + step
        return held

    def equilibrium(self, position: Array) -> tuple[float, SettledBearing]:
        """Share at which the films leave no force on the holding spring, and the state there.

        Regula falsi, the force of an end that stays halved (Illinois).
        """
        ends = [end.held or self.at(float(k), position) for k, end in enumerate(self._ends)]
        (a, fa), (b, fb) = (0.0, ends[0].excess), (1.0, ends[1].excess)
        share, held = (0.0, ends[0]) if abs(fa) < abs(fb) else (1.0, ends[1])
        stiffness = self._stiffness(*ends)
        # friction, or the chambers that answer to a wider gap, take what is left
        goal = _LEFT_FORCE if self._friction > 0.0 or stiffness > 0.0 else _FORCE
        for _ in range(_MOST_SHARES if fa > 0.0 > fb else 0):
            share = (a * fb - b * fa) / (fb - fa)
            # from the state before, whose films are nearly those of this share
            held = self.at(share, held.balance.position)
            if abs(held.excess) <= goal or not held.equilibrium.settled:
                break
            if held.excess > 0.0:
                a, fa, fb = share, held.excess, 0.5 * fb
            else:
                b, fb, fa = share, held.excess, 0.5 * fa
        return share, self._freed(share, held, stiffness, abs(held.excess) <= goal)

    def _stiffness(self, first: SettledBearing, second: SettledBearing) -> float:
        """Response of the force of chambers and films to a wider opening. [N/m].

        Leakage grows with the cube of the gaps.
        """
        low, high = self._ends
        apart = float(np.log(high.leakage / low.leakage))
        if abs(apart) < _APART:
            return self._known_stiffness
        force = self._scale * (first.excess - second.excess)
        return max(3.0 * force / (apart * _room(second)), 0.0)

    def _freed(
        self, share: float, held: SettledBearing, stiffness: float, balanced: bool
    ) -> SettledBearing:
        """State with friction and the response of the chambers in place of the holding spring.

        There is no equilibrium if a force is left on the holding spring.
        """
        # loads change little between the ends: those of the nearer one
        loads = self._ends[round(share)].problem.loads
        place = float(held.problem.stack.opening @ held.balance.position)
        stack = replace(held.problem.stack, holding_spring=HoldingSpring(place, stiffness))
        problem = replace(held.problem, stack=stack, loads=loads)
        friction = [
            self._sense * part.sign * law.coulomb_force * law.holds
            for part, law in self._laws(loads)
        ]
        states = tuple(replace(s, stack=stack) for s in held.balance.states)
        left = 0.0 if self._friction > 0.0 else abs(held.excess)
        balance = replace(
            held.balance,
            states=states,
            friction=np.array(friction),
            residual=max(held.balance.residual, left),
        )
        if self._friction == 0.0 < stiffness and balanced:
            return self._settle(problem, problem.continued(balance.position), held.temperatures)
        found = replace(held.equilibrium, balance=balance)
        if not balanced and found.settled:
            found = replace(found, settled=False, reason=_LEFT.format(held.excess * self._scale))
        return replace(
            held, problem=problem, equilibrium=found, numbers=numbers_of(problem, balance)
        )

    def _laws(self, loads: Loads) -> list[tuple[MovingBearing, HousingFriction]]:
        moving_bearings = self._ends[0].problem.stack.moving_bearings
        return [(part, loads.law(k)) for k, part in enumerate(moving_bearings)]

    @property
    def _friction(self) -> float:
        """Force with which the housing holds all bearings while they slide. [N]."""
        laws = self._laws(self._ends[1].problem.loads)
        return sum(law.coulomb_force for _, law in laws if law.holds) * abs(self._sense)


def _room(held: SettledBearing) -> float:
    """Opening that closes all gaps. [m]."""
    sides = 1.0 if held.problem.stack.two_floating else 2.0
    return sides * float(held.numbers.gaps.mean())


def _step(room: float, now: tuple[float, float], known: tuple[float, float] | None) -> float:
    """Change of the opening that corrects the leakage, at first by the cube of the gaps. [m]."""
    place, error = now
    step = room * float(np.expm1(-error / 3.0))
    if known is not None and known[1] != error:
        secant = -error * (place - known[0]) / (error - known[1])
        step = secant if secant * error < 0.0 else step
    return float(np.clip(step, -_LEAST_STEP * room, room / _LEAST_STEP))
