r"""Where the flow goes that the volumetric efficiency lacks, in parts that sum to it.

Every node has a share :math:`w` of the way from the low to the high side of the machine: 1 at the
working port and in chambers that are open to it, 0 at the other port, in chambers open to that and
in an external drain, and in between where a chamber is sealed, by its pressure. With the mass flow
:math:`\dot m_{ab}` of every path the balances of all nodes, each times its share, sum to the mass
flow of the working port

.. math:: \dot m_{work} = \sum_{ab} \dot m_{ab} (w_b - w_a)
    - \sum_i w_i \left(\rho_0 \dot V_i + \dot\mu_i\right), \qquad \mu_i = (\rho_i - \rho_0) V_i,

whatever the shares are. Its negative first term is leakage, of each path by pressure and by the
drag of walls. The second is what the chambers displace, geometric displacement and timing; the
third is what they keep or give back by compression, and by free gas and vapour.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.closures.aeration import gas_volume_fraction, vapour_fraction
from toothspace.closures.density import mixture_density
from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.model import arrays as col
from toothspace.model.description import MachineDescription
from toothspace.model.path_category import LEAKAGES, PathRole
from toothspace.numerics.periodic_table import PeriodicTable
from toothspace.results.ledger import TRAPPED
from toothspace.results.performance import COMPRESSION, DRAG, EXCHANGE, GAS, PORT_VOLUMES, PRESSURE
from toothspace.solver.compiled_model import Observation, observe
from toothspace.solver.cyclic import SEEN, History

_TRAPPED: tuple[PathRole, ...] = ("inlet_groove", "outlet_groove", "mesh")
"""Roles of the paths through which a chamber that is sealed from both ports still flows."""

_PORTS: tuple[PathRole, ...] = (
    "inlet_port",
    "outlet_port",
    "drain",
    "inlet_groove",
    "outlet_groove",
)
"""Roles of openings in the order of the dimension ``port``."""


@final
@dataclass(frozen=True)
class Look:
    """States of a revolution and everything seen there."""

    history: History
    """Its samples are the states looked at."""
    seen: Observation
    """Pressures, flows and forces there."""
    openings: Array
    """Areas by which chambers are open to ports and grooves. [m2]"""
    trapped: BoolArray
    """Paths in grooves and mesh at an end of which a chamber is sealed from both ports."""
    copies: int = 1
    """Parts like this one, with other chambers, that make the revolution. [-]"""

    def trapped_losses(self) -> dict[str, float]:
        """Throttling of trapped fluid in grooves and mesh as entries of the ledger. [J]."""
        lost = np.where(self.trapped, self.seen.path_loss, 0.0)
        power = self.copies * np.trapezoid(lost, self.history.times, axis=0)
        account = self.history.system.arrays.path_index[:, col.CATEGORY]
        parts = {
            TRAPPED + category.account: float(power[account == k].sum())
            for k, category in enumerate(self.history.system.categories)
            if category.role in _TRAPPED
        }
        return {**parts, "trapped_volume": sum(parts.values())}


def look_at(history: History) -> Look:
    """Look at the samples of a history."""
    system = history.system
    seen = observe(system.arrays, history.states)
    opened = openings(system.description, history.states[:, 0])
    # flows of trapped fluid: through paths inside the mesh at chambers closed to both ports
    size = system.arrays.size
    sealed = np.zeros((history.times.size, size.nodes), dtype=bool)
    sealed[:, : size.chambers] = opened[..., :2].max(axis=2) <= 0.0
    roles = np.array([category.role in _TRAPPED for category in system.categories])
    inside = roles[system.arrays.path_index[:, col.CATEGORY]]
    first = sealed[:, system.arrays.path_index[:, col.NODE_A]]
    second = np.take_along_axis(sealed, seen.path_partner, axis=1)
    trapped = np.asarray(inside & (first | second) & (seen.path_flow != 0.0))
    return Look(history, seen, opened, trapped)


def looks_at(history: History) -> tuple[Look, Look]:
    """Look at the samples of a revolution, and at close states of it whatever its samples are."""
    dense = history.dense
    if dense is None or dense.times.size <= SEEN:
        samples = look_at(history)
        return samples, samples
    close = look_at(
        replace(history, times=dense.times[::SEEN], states=dense.states[::SEEN], dense=None)
    )
    if history.alike > 1:
        return look_at(history), replace(close, copies=history.alike)
    rows = np.searchsorted(close.history.times, history.times)
    rows = np.minimum(rows, close.history.times.size - 1)
    if np.array_equal(close.history.times[rows], history.times):
        part = {name: values[rows] for name, values in close.seen._asdict().items()}
        seen = close.seen._replace(**part)
        return Look(history, seen, close.openings[rows], close.trapped[rows]), close
    return look_at(history), close


def openings(description: MachineDescription, shaft_angle: Array) -> Array:
    """Areas by which every chamber is open to each port and groove, over the angle. [m2]."""
    area = np.zeros((shaft_angle.size, description.chamber_count, len(_PORTS)))
    for path in description.paths:
        if path.kind != "orifice" or path.category.role not in _PORTS:
            continue
        angles = path.phases + path.angle_ratio * shaft_angle[:, None]
        table = path.geometry
        areas = PeriodicTable(table.period, table.values[:, :1], table.slopes[:, :1])
        open_area = path.multiplicity * areas(angles)[..., 0]
        port = _PORTS.index(path.category.role)
        area[:, path.nodes_a, port] += np.maximum(open_area, 0.0)
    # a sample at the very edge of a port is closed, whichever way round-off falls
    area[area < _ROUND_OFF * area.max(initial=0.0)] = 0.0
    return area


_ROUND_OFF = 1e-9
"""Part of the largest opening below which a chamber is closed. [-]"""

_MOST_VOID = 0.999


def shares(look: Look) -> Array:
    """Share of the way from the low to the high side at which every node stands. [-].

    1 at the working port, outlet of a pump and inlet of a motor, shape (samples, nodes).
    """
    system, seen = look.history.system, look.seen
    description, chambers = system.description, system.arrays.size.chambers
    ports = [description.inlet_node, description.outlet_node]
    other, work = ports[::-1] if description.mode == "motor" else ports
    base, top = seen.pressure[:, [other]], seen.pressure[:, [work]]
    span = top - base
    found = np.full_like(seen.pressure, 0.5)
    np.divide(seen.pressure - base, span, out=found, where=span != 0.0)
    np.clip(found, 0.0, 1.0, out=found)
    opened = look.openings > 0.0
    at = {"inlet": opened[..., 0], "outlet": opened[..., 1]}
    near, far = ("inlet", "outlet") if description.mode == "motor" else ("outlet", "inlet")
    inside = found[:, :chambers]
    inside[at[near] & ~at[far]] = 1.0
    inside[at[far] & ~at[near]] = 0.0
    found[:, work], found[:, other], found[:, description.drain_node] = 1.0, 0.0, 0.0
    return found


def path_leakage(look: Look, share: Array) -> tuple[Array, Array]:
    """Mass flow from the high to the low side by pressure and by drag, by category. [kg/s].

    A flow counts with the part of the way that it falls. What trapped chambers exchange with one
    another is no leakage.

    Returns
    -------
    pressure, drag : ndarray, shape (samples, categories)
        Their sum is all that paths leak; drag against the pressure is negative.
    """
    system = look.history.system
    row, path, _, pressure, drag = _leaks(look, share)
    kinds = len(system.categories)
    place = row * kinds + system.arrays.path_index[path, col.CATEGORY]
    shape = (len(look.seen.path_flow), kinds)
    by_pressure, by_drag = (
        np.bincount(place, values, shape[0] * shape[1]).astype(float).reshape(shape)
        for values in (pressure, drag)
    )
    return by_pressure, by_drag


def chamber_leakage(history: History) -> Array:
    """Flow that leaks out of every chamber, counted as in :func:`path_leakage`.

    At the density at the inlet, shape (samples, chambers). [m3/s]
    """
    look = look_at(history)
    row, _, source, pressure, drag = _leaks(look, shares(look))
    chambers = history.system.arrays.size.chambers
    inside, shape = source < chambers, (len(history.states), chambers)
    place, leaking = (row * chambers + source)[inside], (pressure + drag)[inside]
    total = np.bincount(place, leaking, shape[0] * shape[1]).astype(float).reshape(shape)
    return total / look.seen.density[:, [history.system.description.inlet_node]]


def _leaks(look: Look, share: Array) -> tuple[IntArray, IntArray, IntArray, Array, Array]:
    """Flows through gaps: sample, path, node that each leaves, and the mass flow that falls.

    The latter by pressure and by drag. [kg/s]
    """
    system, seen = look.history.system, look.seen
    index = system.arrays.path_index
    leaks = np.array([category.role in LEAKAGES for category in system.categories])
    counts = leaks[index[:, col.CATEGORY]] & (seen.path_flow != 0.0) & ~look.trapped
    # few of all paths are open at a time
    row, path = np.nonzero(counts)
    first, second = index[path, col.NODE_A], seen.path_partner[row, path]
    fall, flow = share[row, first] - share[row, second], seen.path_flow[row, path]
    source = np.where(flow > 0.0, first, second)
    walls = seen.density[row, source] * look.history.states[row, 1]
    drag = walls * (seen.path_drag[row, path] - seen.path_carried[row, path])
    pressure = flow - walls * seen.path_drag[row, path]
    return row, path, source, pressure * fall, drag * fall


def lost_flow_parts(close: Look, lost: float) -> dict[str, float]:
    """Parts of the lost flow at the density of the inlet, by name; they sum to it. [m3/s].

    Parameters
    ----------
    close : Look
        Close states of a whole number of revolutions, or of a part after which all chambers stand
        where others stood.
    lost : float
        Flow that the volumetric efficiency lacks, from the ledger. [m3/s]

    Notes
    -----
    What meshing chambers exchange is the rest of the mass balance; by the first equation of this
    module it is also timing of the swept volumes and flows through ports, grooves and the mesh.
    """
    history, seen = close.history, close.seen
    system, times = history.system, history.times
    if times.size < 2:
        return {EXCHANGE: lost}
    share = shares(close)
    leakage = path_leakage(close, share)
    fluid, node = system.arrays.fluid, system.description.inlet_node
    mean = float(seen.pressure[:, node].mean())
    density = float(mixture_density(mean, fluid.feed_gas_mass_fraction, fluid))
    scale = 1.0 / (density * (times[-1] - times[0]))
    parts: dict[str, float] = {}
    for name, flows in zip((PRESSURE, DRAG), leakage, strict=True):
        masses = np.asarray(np.trapezoid(flows, times, axis=0))
        for k, category in enumerate(system.categories):
            if category.role in LEAKAGES:
                parts[name + category.name] = scale * float(masses[k])
    # liquid that is compressed beyond the inlet, and (negative) what gas and vapour displace
    inside, law = slice(0, system.arrays.size.chambers), system.arrays.fluid
    pressure, free = seen.pressure[:, inside], seen.gas[:, inside]
    own, volume = seen.density[:, inside], seen.volume[:, inside]
    void = gas_volume_fraction(pressure, free, law)
    void = np.minimum(void + vapour_fraction(1.0 / own, pressure, free, law), _MOST_VOID)
    inlet = float(seen.pressure[:, system.description.inlet_node].mean())
    fed = float(gas_volume_fraction(inlet, law.feed_gas_mass_fraction, law))
    missing = -(void - fed) * own / (1.0 - void) * volume
    mass = (own - density) * volume
    between = 0.5 * (share[1:, inside] + share[:-1, inside])
    of_gas = float(np.sum(between * np.diff(missing, axis=0)))
    liquid, gas = float(np.sum(between * np.diff(mass, axis=0))) - of_gas, of_gas
    parts[COMPRESSION], parts[GAS] = scale * liquid, scale * gas
    # mass that volumes and lines on the working side took up. [kg]
    size, description = system.arrays.size, system.description
    away = description.outlet_node if description.mode == "motor" else description.inlet_node
    places = system.arrays.dynamic_index[size.chambers :]
    nodes = np.arange(size.chambers, size.chambers + places.size)
    held = places[(places >= 0) & (nodes != away)]
    masses = history.states[:, size.mass : size.gas]
    parts[PORT_VOLUMES] = scale * float((masses[-1, held] - masses[0, held]).sum())
    parts[EXCHANGE] = lost - sum(parts.values())
    return parts
