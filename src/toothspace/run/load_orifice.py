r"""A load orifice sized so that the mean outlet pressure is the one asked for.

A machine that delivers the mean mass flow :math:`\dot m(p)` against a mean pressure :math:`p`
above that of the load settles where its orifice passes as much,

.. math:: \dot m(p) = A\, C \sqrt{2 \rho p} .

The flow at the asked pressure is known from a run with that pressure held; without any there is no
orifice. From then on every round measures pressure and both flows of a periodic state, takes the
line from its flow to that of a machine that does not leak for :math:`\dot m(p)`, and gives the
orifice the area and the outlet volume the pressure at which both flows agree.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.case.case_tables import LEAST_LOAD
from toothspace.closures.density import mixture_density
from toothspace.closures.orifice import (
    DISCHARGE_COEFFICIENT,
    inertial_laminar_flow,
    orifice_conductance,
)
from toothspace.closures.viscosity import dynamic_viscosity
from toothspace.core.progress import UNKNOWN, Progress, part, tell
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.core.units import format_si
from toothspace.model import arrays as col
from toothspace.model.assembly import System, node_places
from toothspace.model.chambers import wall_volume
from toothspace.model.operating_point import OperatingCondition
from toothspace.numerics.roots import root_between
from toothspace.run.running_in import CUT_SHORT
from toothspace.solver.accuracy import balanced
from toothspace.solver.compiled_model import observe
from toothspace.solver.cyclic import (
    SEEN,
    History,
    RunPlan,
    first_turn_state,
    march_near,
    march_revolutions,
)
from toothspace.solver.initial import start_state

LOAD_MATCH = 2e-3
"""Difference between reached and asked pressure drop that counts as none. [-]"""

_ROUNDS = 10
_EVERY = 32
"""Every so many of the dense states count to the mean pressure."""
_SEARCHES = 3
_MOST_MARCHES = 2
"""Revolutions of all rounds over the most that are marched to a cyclic state, before the last."""
_HARDLY = 0.05
"""Change of the pressure, over what it misses, that shows an orifice without effect."""
_LARGEST_CHANGE = 5.0
"""Largest factor on the area in one round. [-]"""
_OF_THE_WAY = 0.8
"""Part of the way to an area that asks for a change in the other sense that is gone at most."""
_MARGIN = 0.9
"""Advised pressure over the one at which a machine that leaks in proportion delivers nothing."""
_LEAST_PRESSURE = 0.5
"""Smallest pressure that a round begins with, over the one before. [-]"""

_TAKES_BACK = (
    "The outlet pressure of {asked} is not reached: against it more leaks back than the machine "
    "displaces at {speed}, and no load orifice holds it. The numbers are those with this pressure "
    "held at the outlet. {advice}"
)
_HOLDS = (
    "Lower operating_point.outlet_pressure to {holds}, which it holds, raise "
    "operating_point.shaft_speed, or make the gaps smaller."
)
_HOLDS_NOTHING = "Raise operating_point.shaft_speed, or make the gaps smaller."
_MISSED = (
    "The mean outlet pressure is {found} where {asked} was asked: no area of the load orifice was "
    "found at which both agree within {match:g} % of the pressure difference. "
    'Set operating_point.outlet_load = "fixed_pressure", or ask for {found}.'
)


@final
@dataclass(frozen=True)
class OutletBalance:
    """Mean pressure and mass flows at the outlet over one revolution."""

    pressure: float
    """Pressure above that of the load. [Pa]"""
    delivered: float
    """Mass flow that the machine delivers. [kg/s]"""
    passed: float
    """Mass flow through the orifice. [kg/s]"""
    slope: float
    """Change of the delivered mass flow with the pressure, not positive. [kg/(s Pa)]"""

    def after(self, before: OutletBalance | None) -> OutletBalance:
        """Balance with the slope of the flow from another round to this one, if it tells one."""
        if before is None or abs(self.pressure - before.pressure) <= LOAD_MATCH * self.pressure:
            return self
        slope = (self.delivered - before.delivered) / (self.pressure - before.pressure)
        return replace(self, slope=min(slope, 0.0))

    def meets(self, wanted: float) -> bool:
        """Whether the pressure is the wanted one [Pa] and stays there."""
        if self.pressure <= 0.0 or self.passed <= 0.0:
            return False
        # pressure by which the state would still move until both flows agree
        stiffness = self.passed / (2.0 * self.pressure) - self.slope
        drift = (self.delivered - self.passed) / stiffness if stiffness > 0.0 else np.inf
        return max(abs(self.pressure - wanted), abs(drift)) <= LOAD_MATCH * wanted

    def change_of_area(self, wanted: float) -> float:
        """Factor on the area that leads to the wanted pressure [Pa]. [-]."""
        flow = self.delivered + self.slope * (wanted - self.pressure)
        if flow <= 0.0 or self.passed <= 0.0 or self.pressure <= 0.0:
            return 1.0 / _LARGEST_CHANGE
        factor = flow / self.passed * np.sqrt(self.pressure / wanted)
        return float(np.clip(factor, 1.0 / _LARGEST_CHANGE, _LARGEST_CHANGE))


def march_against_orifice(
    system: System,
    plan: RunPlan,
    last: History | None,
    progress: Progress | None,
    loaded: System | None = None,
) -> tuple[History, str]:
    """March against a load orifice with which the mean outlet pressure is the asked one.

    Parameters
    ----------
    system : System
        Machine at its operating point; an area of its orifice does not count.
    plan : RunPlan
        How long to march in every round.
    last : History, optional
        A former run of the same machine or of one that differs little, to begin with: against an
        orifice, or with the outlet held.
    progress : callable, optional
        Called with the finished share and a short text.
    loaded : System, optional
        The machine with the orifice of the former run, where it is known.

    Returns
    -------
    history : History
        The last revolution; ``not_reached`` where the mean pressure is another than the asked one.
    told : str
        What was not reached, and what to do; empty if nothing.
    """
    wanted = system.condition.outlet_pressure - system.condition.load_pressure
    held = last
    if last is not None and last.system.condition.load_area > 0.0:
        loaded = loaded or system.at(load_area=last.system.condition.load_area)
        history, told = _sized(loaded, wanted, plan, first_turn_state(last), progress)
        if not told:
            return history, told
        held = None
    if held is None:
        condition = with_held_outlet(system.condition)
        under = system.under(condition)
        held = march_near(under, plan, progress)
        if held is None or outlet_balance(held).delivered <= 0.0:
            held = march_held(under, plan, progress)
    if held.status in CUT_SHORT:
        return held, ""
    balance = outlet_balance(held)
    if balance.delivered <= 0.0:
        advice = _takes_back(system, balance, plan, progress)
        return replace(held, status=Status.NOT_REACHED), advice
    loaded = system.at(load_area=first_area(held.system, balance))
    return _sized(loaded, wanted, plan, _carried(held, loaded), progress)


def _sized(
    system: System, wanted: float, plan: RunPlan, state: Array, progress: Progress | None
) -> tuple[History, str]:
    """March, and size again until the pressure above that of the load is the wanted one. [Pa]."""
    load_pressure = system.condition.load_pressure
    tried: list[tuple[float, float]] = []
    before: OutletBalance | None = None
    marched = 0
    for done in range(_ROUNDS):
        history = march_revolutions(system, plan, progress, state)
        balance, marched = outlet_balance(history).after(before), marched + history.revolutions
        # one revolution of a machine that does not repeat itself tells no mean pressure
        differs = history.status is Status.NOT_REPEATING
        if differs or (history.status not in CUT_SHORT and balance.meets(wanted)):
            history = balanced(history, plan, progress)
            balance = outlet_balance(history).after(before)
        if history.status in CUT_SHORT or balance.meets(wanted):
            return history, ""
        found = format_si(balance.pressure + load_pressure, "bar")
        if marched > _MOST_MARCHES * plan.max_revolutions or _stuck(tried, balance, before, wanted):
            break
        if done < _ROUNDS - 1:
            area = system.condition.load_area
            tried.append((math.log(area), math.log(balance.change_of_area(wanted))))
            system, before = system.at(load_area=math.exp(_following(tried))), balance
            # the last state with another pressure in its outlet volume and line
            change = wanted - balance.pressure
            own, state = history.system, first_turn_state(history)
            arrays, size = own.arrays, own.arrays.size
            seen = observe(arrays, state[None])
            for node in _outlet_nodes(own):
                mass, gas = (first + arrays.dynamic_index[node] for first in (size.mass, size.gas))
                former = float(seen.pressure[0, node])
                after = max(former + change, _LEAST_PRESSURE * former)
                row, share = arrays.node[node], state[gas] / state[mass]
                volume = row[col.VOLUME]
                if row[col.REST_VOLUME] > 0.0:
                    volume = wall_volume(row, after)[0]
                state[mass] = float(mixture_density(after, share, arrays.fluid)) * volume
                state[gas] = share * state[mass]
            tell(progress, UNKNOWN, f"load orifice, {found} with its last area")
    asked = format_si(wanted + load_pressure, "bar")
    told = _MISSED.format(found=found, asked=asked, match=100.0 * LOAD_MATCH)
    settled = history.status in (Status.DONE, Status.NOT_REPEATING)
    return replace(history, status=Status.NOT_REACHED if settled else history.status), told


def _following(tried: list[tuple[float, float]]) -> float:
    """Next logarithm of the area, from those tried and the changes that each asks for. [-]."""
    place, change = tried[-1]
    opposite = [other - place for other, its_change in tried if its_change * change < 0.0]
    if opposite:
        nearest = min(opposite, key=abs)
        if abs(change) > _OF_THE_WAY * abs(nearest):
            change = 0.5 * nearest
    return place + change


def _stuck(
    tried: list[tuple[float, float]],
    balance: OutletBalance,
    before: OutletBalance | None,
    wanted: float,
) -> bool:
    """Whether the last change of the area, by more than two, hardly changed the pressure."""
    if before is None or abs(tried[-1][1]) < math.log(2.0):
        return False
    moved = abs(balance.pressure - before.pressure)
    return moved < _HARDLY * abs(balance.pressure - wanted)


def with_held_outlet(
    condition: OperatingCondition, pressure: float | None = None
) -> OperatingCondition:
    """Condition whose outlet is held at a pressure, without a line behind it.

    Parameters
    ----------
    pressure : float, optional
        The pressure asked for if not given. [Pa]
    """
    return replace(
        condition,
        outlet_pressure=condition.outlet_pressure if pressure is None else pressure,
        circuit=condition.circuit if condition.load_node == "outlet" else None,
        load_node="outlet",
        load_area=0.0,
    )


def march_held(held: System, plan: RunPlan, progress: Progress | None) -> History:
    """March a system with a held outlet until it repeats, with progress that names the reason."""
    sizing = part(progress, "load orifice")
    return march_revolutions(held, replace(plan, revolutions=None), sizing)


def _takes_back(
    system: System, balance: OutletBalance, plan: RunPlan, progress: Progress | None
) -> str:
    """What to say where nothing is delivered, with a pressure at which something is."""
    condition = system.condition
    least = max(condition.load_pressure + LEAST_LOAD, condition.inlet_pressure)
    holds, tried = 0.0, balance
    for _ in range(_SEARCHES):
        if tried.slope == 0.0:
            break
        nothing = tried.pressure - tried.delivered / tried.slope
        pressure = condition.load_pressure + _MARGIN * nothing
        digit = 10.0 ** (math.floor(math.log10(pressure)) - 1)
        asked = digit * math.floor(pressure / digit)
        if asked < least:
            break
        history = march_held(system.under(with_held_outlet(condition, asked)), plan, progress)
        tried = outlet_balance(history)
        if tried.delivered > 0.0 and history.status not in CUT_SHORT:
            holds = asked
            break
    advice = _HOLDS.format(holds=format_si(holds, "bar")) if holds else _HOLDS_NOTHING
    return _TAKES_BACK.format(
        asked=format_si(condition.outlet_pressure, "bar"),
        speed=format_si(condition.shaft_speed, "rpm"),
        advice=advice,
    )


def outlet_balance(history: History) -> OutletBalance:
    """Mean pressure and flows at the outlet over the last revolution of a march."""
    system, condition = history.system, history.system.condition
    description, places = system.description, node_places(system.description, condition)
    # dense states, so that the orifice does not hang on the samples
    every = _EVERY if history.alike == 1 else SEEN
    states = history.states if history.dense is None else history.dense.states[::every]
    seen = observe(system.arrays, states[: max(len(states) - 1, 1)])
    pressure = float(seen.pressure[:, description.outlet_node].mean())
    change = history.states[-1] - history.states[0]
    duration = max(float(history.times[-1] - history.times[0]), 1e-300)
    gained = change[system.arrays.balance[:, 0]] / duration
    passed = gained[places["load"]]
    delivered = passed + gained[_outlet_nodes(system)].sum()
    ideal = description.displacement * condition.shaft_speed
    ideal *= float(seen.density[:, description.inlet_node].mean())
    rise = pressure - condition.inlet_pressure
    slope = (delivered - ideal) / rise if rise != 0.0 else 0.0
    return OutletBalance(
        pressure - condition.load_pressure, float(delivered), float(passed), min(float(slope), 0.0)
    )


def _outlet_nodes(system: System) -> list[int]:
    """Outlet volume and nodes of the line between it and the orifice."""
    condition, places = system.condition, node_places(system.description, system.condition)
    names = {"outlet"}
    if condition.load_node != "outlet" and condition.circuit is not None:
        names |= {node.name for node in condition.circuit.nodes}
    return [places[name] for name in sorted(names)]


def first_area(system: System, balance: OutletBalance) -> float:
    """Area of the orifice that passes what a machine delivers at a pressure. [m2]."""
    fluid, load = system.arrays.fluid, system.condition.load_pressure
    upstream = load + balance.pressure
    density = float(mixture_density(upstream, fluid.feed_gas_mass_fraction, fluid))
    ends = dynamic_viscosity(upstream, fluid) * dynamic_viscosity(load, fluid)
    viscosity = math.sqrt(float(ends))  # a path sees the geometric mean of its ends

    def excess(logarithm: float) -> float:
        area = float(np.exp(logarithm))
        conductance = orifice_conductance(area, np.sqrt(4.0 * area / np.pi), viscosity)
        discharge = DISCHARGE_COEFFICIENT * area
        flow, _, _ = inertial_laminar_flow(balance.pressure, conductance, discharge, density)
        return float(np.log(density * flow / balance.delivered))

    jet = DISCHARGE_COEFFICIENT * np.sqrt(2.0 * density * balance.pressure)
    least = widest = float(np.log(balance.delivered / jet))
    while excess(widest) < 0.0:
        widest += 1.0
    return float(np.exp(root_between(excess, least, widest)))


def _carried(held: History, system: System) -> Array:
    """State of a system with another outlet that begins where a run with a held one ended."""
    before, last, state = held.system, first_turn_state(held), start_state(system)
    old, new = before.arrays.size, system.arrays.size
    places = node_places(system.description, system.condition)
    known = node_places(before.description, before.condition)
    pairs = [(k, k) for k in range(new.chambers)]
    pairs += [(node, places[name]) for name, node in known.items() if name in places]
    for node, place in pairs:
        source, target = before.arrays.dynamic_index[node], system.arrays.dynamic_index[place]
        if source >= 0 and target >= 0:
            state[new.mass + target] = last[old.mass + source]
            state[new.gas + target] = last[old.gas + source]
    state[0] = last[0]
    state[new.position : new.column] = last[old.position : old.column]
    if system.condition.load_node == "outlet":
        state[new.column : new.film] = last[old.column : old.film]
    else:
        # a line that carries the mean flow, with friction in balance
        density = float(system.arrays.node[system.description.outlet_node, col.DENSITY])
        state[new.column : new.film] = outlet_balance(held).delivered / density
    state[new.film : new.load] = last[old.film : old.load]
    return state
