r"""Temperatures of oil, bodies and films of a machine, and how they thin the oil.

They follow from a small network of heat flows. Oil enters at the temperature of the supply, takes
up what is throttled in the chambers and what the bodies give to it, and leaves through the outlet.
A part leaks beside the faces, flows on through the bearings and is the drain. Films conduct to the
two bodies between which they lie, teeth and walls exchange heat with the oil in the chambers:

.. math::

    C_i \dot T_i = Q_i + \sum_j G_{ij} (T_j - T_i) + \sum_j \dot m_{ji} c\, (T_j - T_i)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import final

import numpy as np

from toothspace.case import Case
from toothspace.case.conditions import HeatSettings
from toothspace.closures.heat_transfer import film_wall_conductance, turning_body_coefficient
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.core.units import ZERO_CELSIUS
from toothspace.films.thermal import FilmHeating, HeatBalance
from toothspace.model.description import MachineDescription
from toothspace.model.fluid import LiquidState, liquid_at, temperature_range
from toothspace.model.lumped_films import lateral_face_torque
from toothspace.model.path_category import DRAIN, LATERAL, LATERAL_PATHS
from toothspace.numerics.acceleration import Mixing
from toothspace.numerics.roots import root_between
from toothspace.results.ledger import Ledger
from toothspace.results.performance import drain_flow
from toothspace.results.solution import Solution
from toothspace.results.variables import dataset_from
from toothspace.run.condition import fluid_keys
from toothspace.solver.cyclic import History
from toothspace.solver.outcome import drain_of, window_ledger

_AGREED = 0.1
"""Change of a film temperature between two rounds that is left. [K]"""
_ROUNDS, _NEAR_ROUNDS = 12, 6
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
OIL, WALLS, DRAIN_OIL, OUTLET = "chambers", "casing", "drain", "outlet"
"""Nodes besides the bodies and their films."""
_LEAST = 1e-6
"""Conductance that gives oil at rest and dry bodies a temperature. [W/K]"""
STEEL_HEAT_CAPACITY = 460.0
"""Specific heat capacity of steel. [J/(kg K)]"""


@final
class HeatSearch:
    """Temperatures with which films give off the heat that warms them.

    Films of a ``coupled`` case thin with their heat and then leave less of it; a run with each
    guess leads to the next one. Other films keep the temperature of the fluid.

    Parameters
    ----------
    case : Case
        Case with an operating point and ``[heat]``.
    description : MachineDescription
        Its machine, with films as cold as the fluid.
    """

    def __init__(self, case: Case, description: MachineDescription) -> None:
        self.machine = description
        """The machine with films as warm as the present guess."""
        self._case, self._description = case, description
        self._supply = fluid_keys(case).temperature
        self._warning = ""
        self._heat: tuple[HeatNetwork, dict[str, float]] | None = None
        self._cold: tuple[Solution, tuple[HeatNetwork, dict[str, float]]] | None = None
        self._begin_cold()

    @cached_property
    def _highest(self) -> float:
        # a table is read for it
        return temperature_range(fluid_keys(self._case).source)[1]

    def _begin_cold(self) -> None:
        self.machine, self._rounds, self._mixing = self._description, 0, Mixing(_REMEMBERED)
        self._tried = np.zeros(0)

    def come_near(self, turned: Callable[[MachineDescription], History]) -> None:
        """Find temperatures from single revolutions, so that few runs to a cyclic state follow.

        Parameters
        ----------
        turned : callable
            Marches a machine for one revolution from where the last one ended.
        """
        if self._case.heat.model != "coupled":
            return
        change = np.inf
        while change >= _AGREED and self._rounds < _NEAR_ROUNDS:
            history = turned(self.machine)
            if history.status is not Status.DONE:
                break
            ledger = window_ledger(history)
            _, temperature = self._warmth(ledger, drain_of(history, ledger))
            if max(temperature.values()) > self._highest:
                break
            change = self._follow(temperature)
        if change >= _AGREED:
            self._begin_cold()

    def agree_with(self, found: Solution) -> bool:
        """Whether films are as warm as a run makes them, or no better guess is to be had."""
        case, self._solution = self._case, found
        if case.heat.model == "adiabatic" or found.status is not Status.DONE:
            self._heat = None
            return True
        self._heat = self._warmth(found.ledger, drain_flow(found.data, found.ledger))
        if case.heat.model != "coupled":
            return True
        temperature = self._heat[1]
        reached, highest = np.array(list(temperature.values())), self._highest
        if self._rounds == 0:
            self._cold = found, self._heat
        tried = self._tried if self._rounds else np.full(reached.size, self._supply)
        change = float(np.abs(reached - tried).max())
        if change < _AGREED:
            return True
        if self._rounds == _ROUNDS:
            self._warning = _NOT_AGREED.format(change)
            return True
        if tried.max() >= highest and reached.max() > highest:
            if self._cold is None:
                self._begin_cold()
                return False
            self._solution, self._heat = self._cold
            self._warning = _TOO_WARM.format(reached.max() - ZERO_CELSIUS, highest - ZERO_CELSIUS)
            return True
        self._follow(temperature)
        return False

    def _warmth(self, ledger: Ledger, drain: float) -> tuple[HeatNetwork, dict[str, float]]:
        """Network of the heat flows of a revolution, and its temperatures."""
        case, heat = self._case, self._case.heat
        flows = HeatFlows(
            shaft_speed=ledger.shaft_angle / ledger.duration,
            losses={name: ledger.energy.get(name, 0.0) / ledger.duration for name in ledger.losses},
            through_flow=abs(ledger.mass.get("inlet", 0.0)) / ledger.duration,
            drain_flow=drain,
        )
        network = heat_network(self._description, liquid_of(case), self._supply, flows, heat)
        time = heat.running_time
        return network, network.steady() if time is None else network.after(time)

    def _follow(self, temperature: Mapping[str, float]) -> float:
        """Guess the next temperatures from those that a guess led to; returns the change. [K]."""
        case, supply, highest = self._case, self._supply, self._highest
        reached = np.array(list(temperature.values()))
        if self._rounds == 0:
            self._tried = np.full(reached.size, supply)
        change = float(np.abs(reached - self._tried).max())
        following = self._mixing.following(self._tried, reached - self._tried)
        if self._rounds == 0:
            # share of a rise with cold films that is left if all heat follows the viscosity
            warmest, cold = float(reached.max()), liquid_of(case).dynamic_viscosity

            def surplus(share: float) -> float:
                at_share = liquid_of(case, supply + share * (warmest - supply))
                return at_share.dynamic_viscosity / cold - share

            most = min(1.0, (highest - supply) / max(warmest - supply, _AGREED))
            left = most if surplus(most) >= 0.0 else root_between(surplus, 0.0, most)
            following = supply + left * (reached - supply)
        self._tried, self._rounds = np.clip(following, supply, highest), self._rounds + 1
        # lateral and journal films have the viscosity of their temperatures
        cold, machine = liquid_of(case).dynamic_viscosity, self._description
        warm = dict(zip(temperature, self._tried, strict=True))

        def ratio(node: str) -> float:
            return liquid_of(case, warm[node]).dynamic_viscosity / cold

        laterals = tuple(
            replace(f, viscosity_ratio=ratio(lateral_node(f.body))) for f in machine.laterals
        )
        journals = tuple(
            replace(j, viscosity_ratio=ratio(journal_node(j.body))) for j in machine.journals
        )
        beside = float(np.mean([f.viscosity_ratio for f in laterals])) if laterals else 1.0
        paths = tuple(
            replace(path, viscosity_ratio=beside) if path.category in LATERAL_PATHS else path
            for path in machine.paths
        )
        self.machine = replace(machine, laterals=laterals, journals=journals, paths=paths)
        return change

    @property
    def solution(self) -> Solution:
        """The last run with the temperatures that its powers and flows give."""
        if self._heat is None:
            return self._solution
        network, temperature = self._heat
        values = {"temperature": list(temperature.values())}
        nodes = dataset_from(values, {"heat_node": list(temperature)})
        data = self._solution.data.merge(nodes, combine_attrs="override")
        told = replace(self._solution, data=data)
        return told.with_note(warm_up_time=network.warm_up_time).short_of(self._warning)


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
        supply_temperature=fluid_keys(case).temperature,
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


def lateral_node(body: str) -> str:
    """Name of the film beside the faces of a body."""
    return f"lateral_film.{body}"


def journal_node(body: str) -> str:
    """Name of the film in the bearings of a body."""
    return f"journal_film.{body}"


@final
@dataclass(frozen=True)
class HeatFlows:
    """Mean powers and flows of a run that heat and carry heat."""

    shaft_speed: float
    """Mean speed of the shaft. [rad/s]"""
    losses: Mapping[str, float]
    """Dissipated power by the accounts of the energy ledger. [W]"""
    through_flow: float
    """Mass that enters by the supply port per time. [kg/s]"""
    drain_flow: float
    """Mass that leaks from the chambers to the drain per time. [kg/s]"""


@final
@dataclass(frozen=True, eq=False)
class HeatNetwork:
    """Linear balance of heat flows between the nodes of a machine."""

    names: tuple[str, ...]
    """Nodes."""
    power: Array
    """Heat produced in each node. [W]"""
    exchange: Array
    """Conductance between two nodes, symmetric. Shape (nodes, nodes). [W/K]"""
    streams: Array
    """Heat capacity of the oil that flows from one node (row) to another (column). Shape (nodes,
    nodes). [W/K]
    """
    from_supply: Array
    """The same from the supply to each node. [W/K]"""
    supply_temperature: float
    """Temperature of the supply. [K]"""
    to_ambient: Array
    """Conductance to the surroundings. [W/K]"""
    ambient_temperature: float
    """Temperature of the surroundings. [K]"""
    heat_capacity: Array
    """Heat capacity of each node. [J/K]"""

    def _balance(self) -> tuple[Array, Array]:
        """Matrix and right-hand side of ``C dT/dt = b - A T``. [W/K], [W]."""
        into = self.streams.sum(axis=0) + self.from_supply + self.to_ambient
        matrix = np.diag(self.exchange.sum(axis=1) + into) - self.exchange - self.streams.T
        given = self.power + self.from_supply * self.supply_temperature
        return matrix, given + self.to_ambient * self.ambient_temperature

    def steady(self) -> dict[str, float]:
        """Temperatures that last. [K]."""
        matrix, given = self._balance()
        return dict(zip(self.names, np.linalg.solve(matrix, given).tolist(), strict=True))

    def after(self, duration: float) -> dict[str, float]:
        """Temperatures a time after the machine was as warm as its supply. [K].

        Parameters
        ----------
        duration : float
            Time at the same powers and flows. [s]
        """
        from scipy.linalg import expm

        matrix, given = self._balance()
        lasting = np.linalg.solve(matrix, given)
        fading = expm(-matrix / self.heat_capacity[:, None] * duration)
        temperature = lasting + fading @ (self.supply_temperature - lasting)
        return dict(zip(self.names, temperature.tolist(), strict=True))

    @property
    def warm_up_time(self) -> float:
        """Time constant of the slowest part of warming up. [s]."""
        matrix, _ = self._balance()
        rates = np.linalg.eigvals(matrix / self.heat_capacity[:, None])
        return float(1.0 / np.min(rates.real))


def heat_network(
    description: MachineDescription,
    liquid: LiquidState,
    supply_temperature: float,
    flows: HeatFlows,
    settings: HeatSettings,
) -> HeatNetwork:
    """Network of a machine at the mean powers and flows of a run.

    Nodes: oil of the chambers, bodies, casing with bearing blocks, films, drain, outlet.

    Parameters
    ----------
    liquid : LiquidState
        Its oil at the temperature of the supply.
    supply_temperature : float
        Temperature of the oil that enters. [K]
    settings : HeatSettings
        ``[heat]`` of the case.

    Notes
    -----
    Throttling and the shear of tip gaps heat the oil of the chambers, contacts heat all bodies,
    the seal heats the shaft. Lateral and journal losses are shared among the bodies as their
    drag is. The walls round the chambers have the wetted area of the bodies. A body and the
    casing have one temperature each, so temperatures within them are left out.
    """
    capacity = liquid.density * liquid.specific_heat_capacity
    bodies = [body.name for body in description.bodies]
    faces = [film.body for film in description.laterals]
    bearings = [journal.body for journal in description.journals]
    names = (
        OIL, OUTLET, DRAIN_OIL, WALLS, *bodies, *map(lateral_node, faces),
        *map(journal_node, bearings),
    )  # fmt: skip
    place = {name: k for k, name in enumerate(names)}
    conductance, streams = np.zeros((2, len(names), len(names)))
    power, supply, ambient, heat_capacity = np.zeros((4, len(names)))

    def join(first: str, second: str, value: float) -> None:
        conductance[place[first], place[second]] += value
        conductance[place[second], place[first]] += value

    losses = dict(flows.losses)
    seal, contact = losses.pop("shaft_seal", 0.0), 0.0
    for account in ("mesh_friction", "contact_friction", "contact_damping"):
        contact += losses.pop(account, 0.0)
    beside = sum(losses.pop(k, 0.0) for k in ("lateral_viscous", "lateral_asperity"))
    beside += losses.pop(LATERAL.account, 0.0) + losses.pop(DRAIN.account, 0.0)
    journals = sum(losses.pop(k, 0.0) for k in ("journal_viscous", "journal_asperity"))
    for outside in ("circuit", "coupling", "startup"):
        losses.pop(outside, None)
    power[place[OIL]] = sum(losses.values()) + (0.0 if faces else beside)
    power[place[DRAIN_OIL]] = 0.0 if bearings else journals

    number = liquid.dynamic_viscosity * liquid.specific_heat_capacity / settings.oil_conductivity
    for body in description.bodies:
        power[place[body.name]] = contact / len(bodies) + (seal if body.role == "shaft" else 0.0)
        heat_capacity[place[body.name]] = STEEL_HEAT_CAPACITY * body.mass
        wetted = _LEAST
        if body.wetted_area > 0.0:
            wetted += body.wetted_area * turning_body_coefficient(
                settings.oil_conductivity,
                _diameter(description, body.name),
                body.speed_ratio * flows.shaft_speed,
                liquid.dynamic_viscosity / liquid.density,
                number,
            )
        join(body.name, OIL, wetted)
        join(WALLS, OIL, wetted)
    ambient[place[WALLS]] = settings.housing_conductance
    heat_capacity[place[WALLS]] = settings.casing_heat_capacity

    ratio = {body.name: abs(body.speed_ratio) for body in description.bodies}
    drag = [f.faces * lateral_face_torque(f) * ratio[f.body] ** 2 for f in description.laterals]
    for film, share in zip(description.laterals, _shares(drag), strict=True):
        node = lateral_node(film.body)
        full = np.pi * (film.root_radius**2 - film.inner_radius**2)
        teeth = film.tooth_area_fraction * np.pi * (film.outer_radius**2 - film.root_radius**2)
        area = film.faces * (full + teeth)
        wall = film_wall_conductance(settings.oil_conductivity, area, film.height)
        join(node, film.body, wall)
        join(node, WALLS, wall)
        power[place[node]] = share * beside
        heat_capacity[place[node]] = capacity * area * film.height
    shear = [
        j.count * j.length * j.diameter**3 / j.radial_clearance * ratio[j.body] ** 2
        for j in description.journals
    ]
    for journal, share in zip(description.journals, _shares(shear), strict=True):
        node = journal_node(journal.body)
        area = journal.count * np.pi * journal.diameter * journal.length
        clearance = journal.radial_clearance
        wall = film_wall_conductance(settings.oil_conductivity, area, clearance)
        join(node, journal.body, wall)
        join(node, WALLS, wall)
        power[place[node]] = share * journals
        heat_capacity[place[node]] = capacity * area * clearance

    leak = max(flows.drain_flow, 0.0) * liquid.specific_heat_capacity
    flushing = settings.bearing_flushing * capacity
    for name in faces:
        part, node = leak / len(faces), lateral_node(name)
        streams[place[OIL], place[node]] += part
        streams[place[node], place[journal_node(name) if name in bearings else DRAIN_OIL]] += part
    for name in bearings:
        node = journal_node(name)
        supply[place[node]] = flushing / len(bearings)
        streams[place[node], place[DRAIN_OIL]] = streams[:, place[node]].sum() + supply[place[node]]
    drained = streams[:, place[DRAIN_OIL]].sum()
    through = flows.through_flow * liquid.specific_heat_capacity
    supply[place[OIL]] = max(through - flushing, 0.0)
    leaves = through - (drained if description.drain != "inlet" else 0.0)
    streams[place[OIL], place[OUTLET]] = max(leaves, 0.0)
    if description.drain != "external":
        target = OIL if description.drain == "inlet" else OUTLET
        streams[place[DRAIN_OIL], place[target]] = drained
    volumes = (family.volume(family.phases)[..., 0].sum() for family in description.families)
    heat_capacity[place[OIL]] = capacity * sum(volumes)
    heat_capacity[place[OUTLET]] = capacity * description.port_volumes[1]
    heat_capacity[place[DRAIN_OIL]] = heat_capacity[place[OIL]] if drained > 0.0 else _LEAST
    join(OUTLET, OIL, _LEAST)
    join(DRAIN_OIL, WALLS, _LEAST)
    return HeatNetwork(
        names=names,
        power=power,
        exchange=conductance,
        streams=streams,
        from_supply=supply,
        supply_temperature=supply_temperature,
        to_ambient=ambient,
        ambient_temperature=settings.ambient_temperature,
        heat_capacity=heat_capacity,
    )


def _shares(weights: list[float]) -> Array:
    total = sum(weights)
    return np.asarray(weights) / total if total > 0.0 else np.full(len(weights), 0.0)


def _diameter(description: MachineDescription, body: str) -> float:
    """Diameter at the teeth of a body, or of what it wets if it has no film beside it. [m]."""
    for film in description.laterals:
        if film.body == body:
            return 2.0 * film.outer_radius
    outline = description.outlines[body]
    return 2.0 * float(np.hypot(*outline.T).max())
