"""Temperatures of a machine and of films, and how they thin the oil."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from toothspace.case import Case
from toothspace.core.constants import ZERO_CELSIUS
from toothspace.core.status import Status
from toothspace.films.thermal import FilmHeating, HeatBalance
from toothspace.model.description import MachineDescription
from toothspace.model.fluid import LiquidState, liquid_at, temperature_range
from toothspace.model.path_category import LATERAL_PATHS
from toothspace.numerics.acceleration import Mixing
from toothspace.numerics.roots import root_between
from toothspace.results.performance import drain_flow
from toothspace.results.solution import Solution
from toothspace.results.variables import dataset_from
from toothspace.run.condition import fluid_keys, fluid_temperature
from toothspace.run.heat_network import (
    HeatFlows,
    HeatNetwork,
    heat_network,
    journal_node,
    lateral_node,
)

_AGREED = 0.1
"""Change of a film temperature between two rounds that is left. [K]"""
_ROUNDS = 12
_REMEMBERED = 1
"""Former rounds from which the next temperatures are extrapolated."""
_TOO_WARM = (
    "Films that thin with their heat would reach {:.0f} degC, beyond the {:.0f} degC to which the "
    "fluid is known: the numbers are those of films at the temperature of the fluid. Open the "
    "clearances, lower operating_point.shaft_speed, or cool the bearings with "
    "heat.bearing_flushing."
)
_NOT_AGREED = (
    "Temperatures still change by {:.2g} K from round to round: the viscosities in the films are "
    'not those of the temperatures shown. Set heat.model = "network" for temperatures that the '
    "films do not feel, or change clearances or operating_point.shaft_speed a little."
)


def with_heat(
    case: Case,
    description: MachineDescription,
    solution: Solution,
    march: Callable[[MachineDescription], Solution],
) -> Solution:
    """Solution with the temperatures of oil, bodies and films, which ``coupled`` films feel.

    Parameters
    ----------
    case : Case
        Case with an operating point and ``[heat]``.
    description : MachineDescription
        Its machine, with films as cold as the fluid.
    solution : Solution
        That of this machine.
    march : callable
        Solution of a machine whose films have other viscosities.
    """
    if case.heat.model != "coupled" or solution.status is not Status.DONE:
        return with_temperatures(case, description, solution)
    cold, found = solution, _temperatures(case, description, solution)
    supply, mixing = np.full(len(found[1]), fluid_temperature(case)), Mixing(_REMEMBERED)
    highest = temperature_range(fluid_keys(case).source)[1]
    tried = supply
    for done in range(_ROUNDS + 1):
        reached = np.array(list(found[1].values()))
        change = float(np.abs(reached - tried).max())
        if change < _AGREED or done == _ROUNDS:
            break
        if tried.max() >= highest and reached.max() > highest:
            told = _TOO_WARM.format(reached.max() - ZERO_CELSIUS, highest - ZERO_CELSIUS)
            return with_temperatures(case, description, cold).short_of(told)
        following = mixing.following(tried, reached - tried)
        if done == 0:
            following = supply + _sheared_share(case, reached.max(), highest) * (reached - supply)
        tried = np.clip(following, supply, highest)
        warm = _warmed(case, description, dict(zip(found[1], tried, strict=True)))
        solution = march(warm)
        if solution.status is not Status.DONE:
            return solution
        found = _temperatures(case, description, solution)
    missed = "" if change < _AGREED else _NOT_AGREED.format(change)
    return _told(solution, *found).short_of(missed)


def with_temperatures(case: Case, description: MachineDescription, solution: Solution) -> Solution:
    """Solution with the temperatures that its powers and flows give, which it does not feel.

    Parameters
    ----------
    case : Case
        Case with an operating point and ``[heat]``.
    description : MachineDescription
        Machine of the solution.
    solution : Solution
        Finished or not; only a finished one of a case that is not adiabatic has temperatures.
    """
    if case.heat.model == "adiabatic" or solution.status is not Status.DONE:
        return solution
    return _told(solution, *_temperatures(case, description, solution))


def _sheared_share(case: Case, reached: float, highest: float) -> float:
    """Share of a rise with cold films that is left if all heat follows the viscosity. [-]."""
    supply, cold = fluid_temperature(case), liquid_of(case).dynamic_viscosity

    def surplus(share: float) -> float:
        warm = liquid_of(case, supply + share * (reached - supply))
        return warm.dynamic_viscosity / cold - share

    most = min(1.0, (highest - supply) / max(reached - supply, _AGREED))
    return most if surplus(most) >= 0.0 else root_between(surplus, 0.0, most)


def _temperatures(
    case: Case, description: MachineDescription, solution: Solution
) -> tuple[HeatNetwork, dict[str, float]]:
    """Network at the mean powers and flows of a solution, and its temperatures. [K]."""
    heat, ledger = case.heat, solution.ledger
    flows = HeatFlows(
        shaft_speed=ledger.shaft_angle / ledger.duration,
        losses={name: ledger.energy.get(name, 0.0) / ledger.duration for name in ledger.losses},
        through_flow=abs(ledger.mass.get("inlet", 0.0)) / ledger.duration,
        drain_flow=drain_flow(solution.data, ledger),
    )
    liquid, supply = liquid_of(case), fluid_temperature(case)
    network = heat_network(description, liquid, supply, flows, heat)
    if heat.running_time is None:
        return network, network.steady()
    return network, network.after(heat.running_time)


def _warmed(
    case: Case, description: MachineDescription, temperature: Mapping[str, float]
) -> MachineDescription:
    """Machine whose lateral and journal films have the viscosity of their temperatures."""
    cold = liquid_of(case).dynamic_viscosity

    def ratio(node: str) -> float:
        return liquid_of(case, temperature[node]).dynamic_viscosity / cold

    laterals = tuple(
        replace(film, viscosity_ratio=ratio(lateral_node(film.body)))
        for film in description.laterals
    )
    journals = tuple(
        replace(journal, viscosity_ratio=ratio(journal_node(journal.body)))
        for journal in description.journals
    )
    beside = float(np.mean([film.viscosity_ratio for film in laterals])) if laterals else 1.0
    paths = tuple(
        replace(path, viscosity_ratio=beside) if path.category in LATERAL_PATHS else path
        for path in description.paths
    )
    return replace(description, laterals=laterals, journals=journals, paths=paths)


def _told(solution: Solution, network: HeatNetwork, temperature: Mapping[str, float]) -> Solution:
    found = dataset_from(
        {"temperature": list(temperature.values())}, {"heat_node": list(temperature)}
    )
    data = solution.data.merge(found, combine_attrs="override")
    return replace(solution, data=data).with_note(warm_up_time=network.warm_up_time)


def lateral_heating(case: Case) -> FilmHeating | None:
    """How lateral films of a machine warm up, None where they keep the temperature of the fluid.

    Parameters
    ----------
    case : Case
        Case with a fluid and ``run.film_oil_share``.
    """
    share = case.run.film_oil_share
    return film_heating(case, share) if share > 0.0 else None


def film_heating(case: Case, oil_share: float) -> FilmHeating:
    """Heat balance of a film in the fluid of a case.

    Parameters
    ----------
    case : Case
        Case with a fluid.
    oil_share : float
        Part of the dissipated power that the oil carries away. [-]
    """
    liquid = liquid_of(case)
    balance = HeatBalance(
        supply_temperature=fluid_temperature(case),
        density=liquid.density,
        heat_capacity=liquid.specific_heat_capacity,
        oil_share=oil_share,
        highest_temperature=temperature_range(fluid_keys(case).source)[1],
    )
    return FilmHeating(balance, lambda temperature: liquid_of(case, temperature).dynamic_viscosity)


def liquid_of(case: Case, temperature: float | None = None) -> LiquidState:
    """Liquid of a case at a temperature [K], that of the case if not given."""
    choice = fluid_keys(case)
    given = choice.temperature if temperature is None else temperature
    return liquid_at(choice.source, given)
